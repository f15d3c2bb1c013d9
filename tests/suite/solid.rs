//! Solids of revolution by harmonics: nine-node quadratic elements in (x, r), the oracle of steps in a section.
//!
//! `u_x = W cos n t, u_r = U cos n t, u_t = V sin n t` (n = 1 bending; n = 0 axial motion in W, U and torsion in V).
//! The grid is a product of lines graded into the corners of the steps. Nothing of the program is used.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use std::f64::consts::PI;

/// E (Pa), nu, rho (kg/m^3).
#[derive(Debug, Clone, Copy)]
pub struct Matter(pub f64, pub f64, pub f64);

/// Length, inner and outer radius of a piece, m.
pub type Piece = [f64; 3];

/// What an end face carries: bending moment, axial force or torque of one, distributed as in a long rod.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pull {
    Bending,
    Axial,
    Torsion,
}

/// Stiffness and mass of one harmonic, in lower bands.
pub struct Solid {
    harmonic: usize,
    x: Vec<f64>,
    r: Vec<f64>,
    /// Unknown and sign of (W, U, V) of every node of the grid; none where nothing is.
    places: Vec<[Option<(usize, f64)>; 3]>,
    size: usize,
    band: usize,
    /// First column of every row.
    first: Vec<usize>,
    /// Eigenvalue far below those of motions with strain, 1/s^2.
    shift: f64,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

const GAUSS: [(f64, f64); 3] =
    [(-0.7745966692414834, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.7745966692414834, 5.0 / 9.0)];

/// Values and slopes of the three quadratics at s.
fn quadratics(s: f64) -> [[f64; 2]; 3] {
    [[s * (s - 1.0) / 2.0, s - 0.5], [1.0 - s * s, -2.0 * s], [s * (s + 1.0) / 2.0, s + 0.5]]
}

/// Nodes of lines through the marks: cells no longer than `fine` plus half their distance to a corner, nor than `most`.
fn lines(marks: &[f64], corners: &[f64], fine: f64, most: f64) -> Vec<f64> {
    let mut cells: Vec<[f64; 2]> = marks.windows(2).map(|m| [m[0], m[1]]).rev().collect();
    let mut nodes = vec![marks[0]];
    while let Some([a, b]) = cells.pop() {
        let away = |c: &f64| (c - a).abs().min((c - b).abs());
        let distance = corners.iter().map(away).fold(f64::INFINITY, f64::min);
        if b - a > (fine + 0.5 * distance).min(most) {
            cells.extend([[(a + b) / 2.0, b], [a, (a + b) / 2.0]]);
        } else {
            nodes.extend([(a + b) / 2.0, b]);
        }
    }
    nodes
}

fn distinct(mut list: Vec<f64>) -> Vec<f64> {
    list.sort_by(f64::total_cmp);
    list.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    list
}

impl Solid {
    /// Pieces laid end to end; `fine` is the size of the cells at the corners over the smallest radius.
    pub fn new(pieces: &[Piece], matter: Matter, harmonic: usize, fine: f64) -> Self {
        let mut ends = vec![0.0];
        pieces.iter().for_each(|p| ends.push(ends[ends.len() - 1] + p[0]));
        let radii = distinct(pieces.iter().flat_map(|p| [p[1], p[2]]).collect());
        let least = pieces.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min);
        let wall = pieces.iter().map(|p| p[2] - p[1]).fold(f64::INFINITY, f64::min);
        let kinks = |p: &&[Piece]| p[0][1..] != p[1][1..];
        let steps: Vec<&[Piece]> = pieces.windows(2).filter(kinks).collect();
        let differ = |i: usize| move |p: &&[Piece]| (p[0][i] != p[1][i]).then_some([p[0][i], p[1][i]]);
        let corners: Vec<f64> =
            steps.iter().flat_map(|p| [1, 2].map(|i| differ(i)(p))).flatten().flatten().collect();
        let x = lines(&ends, &ends[1..ends.len() - 1], fine * least, 1.5 * least);
        let r = lines(&radii, &corners, fine * least, (least / 2.0).min(wall));
        let (nx, nr) = (x.len(), r.len());
        let full = |i: usize, j: usize| {
            let (x, r) = (x[2 * i + 1], r[2 * j + 1]);
            let at = ends[1..].iter().position(|e| x < *e).expect("on the shaft");
            r > pieces[at][1] && r < pieces[at][2]
        };
        let cells: Vec<(usize, usize)> =
            (0..nx / 2).flat_map(|i| (0..nr / 2).map(move |j| (i, j))).filter(|&(i, j)| full(i, j)).collect();
        let mut there = vec![false; nx * nr];
        for &(i, j) in &cells {
            (0..9).for_each(|k| there[(2 * i + k / 3) * nr + 2 * j + k % 3] = true);
        }
        let (mut size, mut places) = (0, Vec::new());
        for (node, there) in there.iter().enumerate() {
            let mut place = [None; 3];
            let mut next = || {
                size += 1;
                Some((size - 1, 1.0))
            };
            match (there, r[node % nr] == 0.0, harmonic) {
                (false, ..) => {}
                (true, false, _) => place = [next(), next(), next()],
                // on the axis a motion has one value: along x for n = 0, across (U = -V) for n = 1
                (true, true, 0) => place[0] = next(),
                (true, true, _) => {
                    place[1] = next();
                    place[2] = place[1].map(|(at, _)| (at, -1.0));
                }
            }
            places.push(place);
        }
        let band = 2 * 3 * nr + 3 * 3;
        let shift = 1e-2 * matter.0 / matter.2 * least.powi(2) / ends[ends.len() - 1].powi(4);
        let mut solid = Self {
            harmonic,
            x,
            r,
            places,
            size,
            band,
            shift,
            first: (0..size).collect(),
            stiffness: vec![0.0; size * (band + 1)],
            mass: vec![0.0; size * (band + 1)],
        };
        cells.iter().for_each(|&(i, j)| solid.add_cell(i, j, matter));
        solid
    }

    fn angle(&self) -> f64 {
        if self.harmonic == 0 { 2.0 * PI } else { PI }
    }

    fn add_cell(&mut self, i: usize, j: usize, Matter(e, nu, rho): Matter) {
        let (lambda, mu) = (e * nu / (1.0 + nu) / (1.0 - 2.0 * nu), e / 2.0 / (1.0 + nu));
        let mut law = SMatrix::<f64, 6, 6>::zeros();
        for a in 0..6 {
            (0..3).for_each(|b| {
                if a < 3 {
                    law[(a, b)] = lambda
                }
            });
            law[(a, a)] += if a < 3 { 2.0 * mu } else { mu };
        }
        let (hx, hr) = (self.x[2 * i + 2] - self.x[2 * i], self.r[2 * j + 2] - self.r[2 * j]);
        let n = self.harmonic as f64;
        let (mut k, mut m) = (SMatrix::<f64, 27, 27>::zeros(), SMatrix::<f64, 27, 27>::zeros());
        for (s, ws) in GAUSS {
            for (t, wt) in GAUSS {
                let r = self.r[2 * j + 1] + t * hr / 2.0;
                let weight = self.angle() * ws * wt * hx * hr / 4.0 * r;
                let (fx, fr) = (quadratics(s), quadratics(t));
                let mut strain = SMatrix::<f64, 6, 27>::zeros();
                let mut values = SVector::<f64, 9>::zeros();
                for a in 0..9 {
                    let ([px, dx], [pr, dr]) = (fx[a / 3], fr[a % 3]);
                    let (f, x, rr) = (px * pr, dx * pr * 2.0 / hx, px * dr * 2.0 / hr);
                    values[a] = f;
                    let (w, u, v) = (3 * a, 3 * a + 1, 3 * a + 2);
                    for (row, column, value) in [
                        (0, w, x),
                        (1, u, rr),
                        (2, u, f / r),
                        (2, v, n * f / r),
                        (3, u, x),
                        (3, w, rr),
                        (4, v, x),
                        (4, w, -n * f / r),
                        (5, v, rr - f / r),
                        (5, u, -n * f / r),
                    ] {
                        strain[(row, column)] += value;
                    }
                }
                k += strain.transpose() * law * strain * weight;
                for (a, b) in (0..9).flat_map(|a| (0..9).map(move |b| (a, b))) {
                    (0..3).for_each(|c| m[(3 * a + c, 3 * b + c)] += rho * weight * values[a] * values[b]);
                }
            }
        }
        let nr = self.r.len();
        let places: Vec<Option<(usize, f64)>> =
            (0..9).flat_map(|a| self.places[(2 * i + a / 3) * nr + 2 * j + a % 3]).collect();
        for (a, row) in places.iter().enumerate() {
            for (b, column) in places.iter().enumerate() {
                if let (Some((p, x)), Some((q, y))) = (row, column)
                    && q <= p
                {
                    let at = p * (self.band + 1) + p - q;
                    self.first[*p] = self.first[*p].min(*q);
                    self.stiffness[at] += x * y * k[(a, b)];
                    self.mass[at] += x * y * m[(a, b)];
                }
            }
        }
    }

    /// `angle int f_k g r dr` over an end face for a component, g the power of r.
    fn face(&self, right: bool, component: usize, power: i32) -> DVector<f64> {
        let (nr, mut sum) = (self.r.len(), DVector::zeros(self.size));
        let first = if right { (self.x.len() - 1) * nr } else { 0 };
        // a cell of a face is there where its middle node is
        for j in (0..nr / 2).filter(|j| self.places[first + 2 * j + 1][0].is_some()) {
            let h = self.r[2 * j + 2] - self.r[2 * j];
            for (t, weight) in GAUSS {
                let r = self.r[2 * j + 1] + t * h / 2.0;
                for (b, f) in quadratics(t).iter().enumerate() {
                    if let Some((at, sign)) = self.places[first + 2 * j + b][component] {
                        sum[at] += sign * self.angle() * weight * h / 2.0 * r.powi(power + 1) * f[0];
                    }
                }
            }
        }
        sum
    }

    /// Springs (N/m) on the mean displacement across the end faces, of n = 1.
    pub fn hold(&mut self, stiffness: [f64; 2]) {
        for (right, k) in [(false, stiffness[0]), (true, stiffness[1])] {
            // mean of u_y = u_r cos t - u_t sin t
            let (by_u, by_v) = (self.face(right, 1, 0), self.face(right, 2, 0));
            let sum: f64 = self.face(right, 0, 0).iter().map(|v| v.abs()).sum();
            let row = (by_u - by_v) / (2.0 * sum);
            let touched: Vec<usize> = (0..self.size).filter(|&i| row[i] != 0.0).collect();
            for &p in &touched {
                self.first[p] = self.first[p].min(touched[0]);
                touched
                    .iter()
                    .filter(|&&q| q <= p)
                    .for_each(|&q| self.stiffness[p * (self.band + 1) + p - q] += k * row[p] * row[q]);
            }
        }
    }

    /// `2 U` under a load of one on both ends (N m or N), in balance: the compliance of the whole.
    pub fn compliance(&self, pull: Pull, ends: [Piece; 2]) -> f64 {
        let (component, power) = match pull {
            Pull::Bending => (0, 1),
            Pull::Axial => (0, 0),
            Pull::Torsion => (2, 1),
        };
        let [left, right] = ends.map(|[_, a, b]| match pull {
            Pull::Bending => PI / 4.0 * (b.powi(4) - a.powi(4)),
            Pull::Axial => PI * (b * b - a * a),
            Pull::Torsion => PI / 2.0 * (b.powi(4) - a.powi(4)),
        });
        let f = self.face(true, component, power) / right - self.face(false, component, power) / left;
        let mut k = self.stiffness.clone();
        let rim = |right: bool| {
            let first = if right { self.x.len() - 1 } else { 0 } * self.r.len();
            (0..self.r.len())
                .rev()
                .find(|j| self.places[first + j][0].is_some())
                .map(|j| self.places[first + j])
                .expect("a rim")
        };
        // statically determinate pins carry nothing
        let pins = if self.harmonic == 0 {
            vec![rim(false)[0], rim(false)[2]]
        } else {
            vec![rim(false)[1], rim(true)[1]]
        };
        pins.into_iter().flatten().for_each(|(at, _)| k[at * (self.band + 1)] *= 2.0);
        let u = self.solve(&self.factor(k), f.clone());
        f.dot(&u)
    }

    /// The lowest frequencies with strain, Hz, of one harmonic (n = 0: axial and torsion together), by subspace iteration.
    pub fn frequencies(&self, count: usize) -> Vec<f64> {
        let columns = count + 4;
        let product = |a: &[f64], x: &DVector<f64>| {
            let mut y = DVector::zeros(self.size);
            for p in 0..self.size {
                for q in self.first[p]..=p {
                    let v = a[p * (self.band + 1) + p - q];
                    y[p] += v * x[q];
                    if p != q {
                        y[q] += v * x[p];
                    }
                }
            }
            y
        };
        // a shift far below the frequencies keeps rigid motions away from zero
        let shift = self.shift;
        let shifted: Vec<f64> = self.stiffness.iter().zip(&self.mass).map(|(k, m)| k + shift * m).collect();
        let factor = self.factor(shifted.clone());
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5
        };
        let mut x = DMatrix::from_fn(self.size, columns, |_, _| random());
        let mut values = DVector::zeros(columns);
        for _ in 0..8 {
            for j in 0..columns {
                let mx = product(&self.mass, &x.column(j).into_owned());
                x.set_column(j, &self.solve(&factor, mx));
            }
            let (mut k, mut m) = (DMatrix::zeros(columns, columns), DMatrix::zeros(columns, columns));
            for j in 0..columns {
                let column = x.column(j).into_owned();
                let (kx, mx) = (product(&shifted, &column), product(&self.mass, &column));
                for i in 0..columns {
                    k[(i, j)] = x.column(i).dot(&kx);
                    m[(i, j)] = x.column(i).dot(&mx);
                }
            }
            let scale = DVector::from_fn(columns, |i, _| 1.0 / m[(i, i)].sqrt());
            let scaled = |a: &DMatrix<f64>| {
                DMatrix::from_fn(columns, columns, |i, j| (a[(i, j)] + a[(j, i)]) / 2.0 * scale[i] * scale[j])
            };
            let l = scaled(&m).cholesky().expect("independent shapes").l();
            let half = l.solve_lower_triangular(&scaled(&k)).expect("regular");
            let reduced = l.solve_lower_triangular(&half.transpose()).expect("regular");
            let eigen = reduced.symmetric_eigen();
            let back = l.transpose().solve_upper_triangular(&eigen.eigenvectors).expect("regular");
            x = &x * DMatrix::from_diagonal(&scale) * back;
            values = eigen.eigenvalues;
        }
        let mut list: Vec<f64> = values
            .iter()
            .map(|v| (v - shift).max(0.0))
            .filter(|v| *v > 30.0 * shift)
            .map(|v| v.sqrt() / (2.0 * PI))
            .collect();
        list.sort_by(f64::total_cmp);
        list.truncate(count);
        list
    }

    /// Cholesky factor in the same band.
    fn factor(&self, mut a: Vec<f64>) -> Vec<f64> {
        let w = self.band + 1;
        for p in 0..self.size {
            let from = self.first[p];
            for q in from..=p {
                let start = from.max(self.first[q]);
                // rows are stored backwards from the diagonal: both run over the same columns
                let (rp, rq) = (&a[p * w + p - q..=p * w + p - start], &a[q * w..=q * w + q - start]);
                let sum: f64 = rp[1..].iter().zip(&rq[1..]).map(|(x, y)| x * y).sum();
                let rest = a[p * w + p - q] - sum;
                a[p * w + p - q] = if p == q { rest.sqrt() } else { rest / a[q * w] };
            }
        }
        a
    }

    fn solve(&self, l: &[f64], mut b: DVector<f64>) -> DVector<f64> {
        let w = self.band + 1;
        for p in 0..self.size {
            let sum: f64 = (self.first[p]..p).map(|q| l[p * w + p - q] * b[q]).sum();
            b[p] = (b[p] - sum) / l[p * w];
        }
        for p in (0..self.size).rev() {
            b[p] /= l[p * w];
            (self.first[p]..p).for_each(|q| b[q] -= l[p * w + p - q] * b[p]);
        }
        b
    }
}
