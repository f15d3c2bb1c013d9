//! First-order form of the reduced equations at one speed.
//!
//! Rigid motions deform with the shaft: at a speed they are the vectors N with `K(Omega) N = 0`, known from the
//! equilibria. The reduced coordinates are turned so that N and an orthonormal complement Q part, and the state
//! is (v, s): the velocities, and `s = S^T q` for the coordinates q along Q. With `S S^T = Q^T K Q` the state
//! matrix of an undamped rotor is skew and its eigenvectors orthonormal. In the rotating frame K is indefinite
//! above a critical speed; there S holds the frequencies at rest.

use crate::analysis::campbell::changing_bearings::{Change, add};
use crate::analysis::campbell::reduced_basis::Reduced;
use crate::analysis::campbell::spin_stiffening::burst;
use crate::error::Result;
use crate::linalg::dense::{cholesky, over_lower};
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

/// One of the laws of a change.
type LawOf = fn(&Change) -> &[[f64; 2]; 2];

/// Steps of inverse iteration.
const SHARPENING: usize = 5;

/// The reduced equations at one speed.
pub struct FirstOrderForm<'a> {
    reduced: &'a Reduced,
    speed: f64,
    /// The motion for which the laws hold.
    lambda: c64,
    /// What changing bearings add: their rows, turned, and their laws at this speed.
    bearings: Vec<(Mat<f64>, Change)>,
    /// `[N, Q]`, orthonormal; `None` for the identity.
    turn: Option<Mat<f64>>,
    /// `Q^T K Q`.
    pub stiffness: Mat<f64>,
    /// `S`, lower triangular.
    root: Mat<f64>,
    /// True for `S S^T = Q^T K Q`.
    factored: bool,
}

impl<'a> FirstOrderForm<'a> {
    /// Turns the coordinates; bearings have the law that they have on a motion `exp(lambda t)`.
    ///
    /// # Errors
    /// A stiffness that is not positive in the stationary frame: the shaft bursts.
    pub fn new(reduced: &'a Reduced, speed: f64, lambda: c64) -> Result<Self> {
        let (n, r) = (reduced.size(), reduced.n_rigid);
        let w = &reduced.frequencies;
        let weights = reduced.weights(speed);
        let mut stiffness = Mat::from_fn(n, n, |i, j| if i == j { w[i] * w[i] } else { 0.0 });
        for (weight, part) in weights.iter().zip(&reduced.varying) {
            stiffness += part * faer::Scale(*weight);
        }
        let turn = (r > 0 && !reduced.turned.is_empty()).then(|| turn(reduced, &weights));
        if let Some(turn) = &turn {
            stiffness = turn.transpose() * stiffness * turn;
        }
        let bearings: Vec<(Mat<f64>, Change)> = reduced
            .changing
            .iter()
            .map(|b| (turn.as_ref().map_or_else(|| b.rows.clone(), |t| b.turned(t)), b.change(speed, lambda)))
            .collect();
        bearings.iter().for_each(|(rows, change)| add(rows, &change.stiffness, &mut stiffness));
        let stiffness =
            Mat::from_fn(n - r, n - r, |i, j| (stiffness[(i + r, j + r)] + stiffness[(j + r, i + r)]) / 2.0);
        let diagonal = || Mat::from_fn(n - r, n - r, |i, j| if i == j { w[i + r] } else { 0.0 });
        let changed = bearings.iter().any(|(_, change)| change.stiffness != [[0.0; 2]; 2]);
        let (root, factored) = if (reduced.varying.is_empty() || speed == 0.0) && !changed {
            (diagonal(), true)
        } else if changed {
            // a bearing may have so little stiffness left that the shaft is not held
            cholesky(stiffness.as_ref())
                .filter(|_| !reduced.rotating)
                .map_or((diagonal(), false), |root| (root, true))
        } else if reduced.rotating {
            (diagonal(), false)
        } else {
            let root = cholesky(stiffness.as_ref())
                .ok_or_else(|| burst(speed, "K_T - Omega^2 N, which is no longer positive definite"))?;
            (root, true)
        };
        Ok(Self { reduced, speed, lambda, bearings, turn, stiffness, root, factored })
    }

    /// True when nothing takes or feeds energy.
    pub fn is_conservative(&self) -> bool {
        let reduced = self.reduced;
        let none = [[0.0; 2]; 2];
        reduced.damping.is_none()
            && reduced.cross_coupling.is_none()
            && reduced.circulatory.is_none()
            && reduced.hysteresis.is_none()
            && self.bearings.iter().all(|(_, change)| change.damping == none && change.turning == none)
    }

    /// True when the state matrix of an undamped rotor is skew.
    pub fn is_skew(&self) -> bool {
        self.factored
    }

    /// `[N, Q]^T A [N, Q]`.
    fn turned(&self, a: &Mat<f64>) -> Mat<f64> {
        self.turn.as_ref().map_or_else(|| a.clone(), |t| t.transpose() * a * t)
    }

    /// Sum of operators with factors, turned, and of a law of the changing bearings.
    fn sum(&self, parts: &[(f64, &Option<Mat<f64>>)], law: Option<LawOf>) -> Option<Mat<f64>> {
        let mut sum: Option<Mat<f64>> = None;
        for (factor, part) in parts {
            if let Some(part) = part {
                let scaled = part * faer::Scale(*factor);
                sum = Some(sum.map_or_else(|| scaled.clone(), |s| s + &scaled));
            }
        }
        let mut sum = sum.map(|s| self.turned(&s));
        for (rows, law) in
            law.iter().flat_map(|law| self.bearings.iter().map(|(rows, change)| (rows, law(change))))
        {
            if *law != [[0.0; 2]; 2] {
                add(rows, law, sum.get_or_insert_with(|| Mat::zeros(rows.nrows(), rows.nrows())));
            }
        }
        sum
    }

    /// State matrix for `(v, s)`: `v' = -(C + Omega G) v - (K + X + Omega H) q`, `s' = S^T q'`.
    pub fn state_matrix(&self) -> Mat<f64> {
        let (n, r) = (self.reduced.size(), self.reduced.n_rigid);
        let [on_velocity, turning] = self.forms();
        let mut force = if self.factored { self.root.clone() } else { self.stiffness.clone() };
        if !self.factored {
            force = over_lower(&force, self.root.as_ref());
        }
        let turning = turning.map(|x| over_lower(&x.get(.., r..).to_owned(), self.root.as_ref()));
        let entry = |a: &Option<Mat<f64>>, i: usize, j: usize| a.as_ref().map_or(0.0, |a| a[(i, j)]);
        Mat::from_fn(2 * n - r, 2 * n - r, |i, j| match (i < n, j < n) {
            (true, true) => -entry(&on_velocity, i, j),
            (true, false) => {
                let elastic = if i >= r { force[(i - r, j - n)] } else { 0.0 };
                -elastic - entry(&turning, i, j - n)
            }
            (false, true) if j >= r => self.root[(j - r, i - n)],
            _ => 0.0,
        })
    }

    /// Frequency near `guess` that balances a motion of velocities v (turned) in the mean: a root of
    /// `w^2 v^H v - w Omega i v^H G v - v^H K v = 0`. Its error is the square of the motion's.
    pub fn rayleigh(&self, state: &[c64], guess: f64) -> f64 {
        let (n, r) = (self.reduced.size(), self.reduced.n_rigid);
        let v = &state[..n];
        let form = |a: &Mat<f64>, v: &[c64]| -> c64 {
            let row = |i: usize| (0..v.len()).map(|j| v[j] * a[(i, j)]).sum::<c64>();
            (0..v.len()).map(|i| v[i].conj() * row(i)).sum()
        };
        let mass: f64 = v.iter().map(|v| v.norm_sqr()).sum();
        let stiffness = form(&self.stiffness, &v[r..]).re;
        let gyroscopic = self.sum(&[(self.speed, &self.reduced.gyroscopic)], None);
        let turning = gyroscopic.map_or(0.0, |g| -form(&g, v).im);
        let root = (turning * turning + 4.0 * mass * stiffness).sqrt();
        let candidates = [(turning + root) / (2.0 * mass), (turning - root) / (2.0 * mass)];
        let near = |w: &f64| (w - guess).abs();
        let best =
            candidates.into_iter().filter(|w| w.is_finite()).min_by(|a, b| near(a).total_cmp(&near(b)));
        best.filter(|w| near(w) <= 1e-3 * guess.abs()).unwrap_or(guess)
    }

    /// The matrices on velocities and (besides K) on displacements, turned.
    pub fn forms(&self) -> [Option<Mat<f64>>; 2] {
        let reduced = self.reduced;
        let [on_velocity, on_place] =
            [0, 1].map(|part| reduced.hysteresis.matrix(part, self.speed, self.lambda));
        [
            self.sum(
                &[(1.0, &reduced.damping), (self.speed, &reduced.gyroscopic), (1.0, &on_velocity)],
                Some(|c| &c.damping),
            ),
            self.sum(
                &[(1.0, &reduced.cross_coupling), (self.speed, &reduced.circulatory), (1.0, &on_place)],
                Some(|c| &c.turning),
            ),
        ]
    }

    /// The root near `guess` of `y^H (lambda^2 + lambda D + K) x = 0`, x and y being the velocities of the right and left
    /// states (turned) within `reach` of its size, and what rounding may have made of its real part. The root's error is the product of those of x and
    /// y, while that of the eigenvalue solver is a rounding of the largest eigenvalue.
    pub fn quotient(
        &self,
        forms: &[Option<Mat<f64>>; 2],
        states: (&[c64], &[c64]),
        guess: c64,
        reach: f64,
    ) -> (c64, f64) {
        let (n, r) = (self.reduced.size(), self.reduced.n_rigid);
        let (x, y) = (&states.0[..n], &states.1[..n]);
        let zero = c64::new(0.0, 0.0);
        let form = |a: &Mat<f64>, first: usize, rows: usize| -> (c64, f64) {
            let (mut sum, mut size) = (zero, 0.0);
            for j in 0..a.ncols() {
                for i in 0..a.nrows() {
                    let term = y[i + rows].conj() * x[j + first] * a[(i, j)];
                    sum += term;
                    size += term.norm();
                }
            }
            (sum, size)
        };
        let mass: c64 = x.iter().zip(y).map(|(x, y)| y.conj() * x).sum();
        let (stiffness, mut size) = form(&self.stiffness, r, r);
        let on_velocity = forms[0].as_ref().map_or((zero, 0.0), |a| form(a, 0, 0));
        let turning = forms[1].as_ref().map(|a| a.get(.., r..).to_owned());
        let turning = turning.map_or((zero, 0.0), |a| form(&a, r, 0));
        let (d, k) = (on_velocity.0, stiffness + turning.0);
        let root = (d * d - mass * k * 4.0).sqrt();
        let candidates = [(-d + root) / (mass * 2.0), (-d - root) / (mass * 2.0)];
        let far = |z: &c64| (z - guess).norm();
        let best = candidates.into_iter().filter(|z| z.is_finite()).min_by(|a, b| far(a).total_cmp(&far(b)));
        let largest = self.reduced.frequencies.iter().copied().fold(0.0, f64::max);
        let Some(lambda) = best.filter(|z| far(z) <= reach * guess.norm() + 1e-10 * largest) else {
            return (guess, guess.norm());
        };
        size += lambda.norm() * on_velocity.1 + turning.1;
        let strain = |v: &[c64]| -> f64 {
            v.iter().zip(&self.reduced.strain_noise).map(|(v, noise)| v.norm() * noise).sum()
        };
        let rounding = f64::EPSILON * size + strain(x) * strain(y) * (lambda.norm() + self.speed.abs());
        let slope = (mass * lambda * 2.0 + d).norm();
        (lambda, if slope > 0.0 { rounding / slope } else { f64::EPSILON * largest })
    }

    /// Sharpens a motion whose eigenvalue is far below the norm of the state matrix A, of which the solver's error is a
    /// rounding: inverse iteration with `P = lambda^2 + lambda D + K`, whose rows and columns are scaled by the frequencies
    /// at rest, for the right and the left vector, and [`Self::quotient`]. Returns what `quotient` does; a noise of the size of
    /// lambda where it does not settle.
    pub fn sharpened(
        &self,
        a: &Mat<f64>,
        forms: &[Option<Mat<f64>>; 2],
        (right, left): (&mut Vec<c64>, &mut Vec<c64>),
        guess: c64,
        reach: f64,
    ) -> (c64, f64) {
        let (n, r) = (self.reduced.size(), self.reduced.n_rigid);
        let mut lambda = guess;
        let mut noise = guess.norm();
        for _ in 0..SHARPENING {
            let scale: Vec<f64> =
                self.reduced.frequencies.iter().map(|w| 1.0 / w.max(lambda.norm())).collect();
            let at = |a: &Option<Mat<f64>>, i: usize, j: usize| a.as_ref().map_or(0.0, |a| a[(i, j)]);
            let p = Mat::from_fn(n, n, |i, j| {
                let elastic = if i >= r && j >= r { self.stiffness[(i - r, j - r)] } else { 0.0 };
                let turning = if j >= r { at(&forms[1], i, j) } else { 0.0 };
                let inertia = if i == j { lambda * lambda } else { c64::new(0.0, 0.0) };
                (inertia + lambda * at(&forms[0], i, j) + elastic + turning) * (scale[i] * scale[j])
            });
            let factor = p.partial_piv_lu();
            let slope = |i: usize, j: usize| {
                let inertia = if i == j { lambda * 2.0 } else { c64::new(0.0, 0.0) };
                inertia + at(&forms[0], i, j)
            };
            let (mut x, mut y) = (Mat::<c64>::zeros(n, 1), Mat::<c64>::zeros(n, 1));
            for i in 0..n {
                x[(i, 0)] = (0..n).map(|j| slope(i, j) * right[j]).sum::<c64>() * scale[i];
                y[(i, 0)] = (0..n).map(|j| slope(j, i).conj() * left[j]).sum::<c64>() * scale[i];
            }
            let (x, y) = (factor.solve(x), factor.solve_adjoint(y));
            let unit = |v: &Mat<c64>| -> Option<Vec<c64>> {
                let v: Vec<c64> = (0..n).map(|i| v[(i, 0)] * scale[i]).collect();
                let size = v.iter().map(|v| v.norm_sqr()).sum::<f64>().sqrt();
                (size.is_finite() && size > 0.0).then(|| v.into_iter().map(|v| v / size).collect())
            };
            // P is singular to the last digit: there is nothing left to sharpen
            let (Some(x), Some(y)) = (unit(&x), unit(&y)) else { break };
            right[..n].copy_from_slice(&x);
            left[..n].copy_from_slice(&y);
            let before = lambda;
            (lambda, noise) = self.quotient(forms, (right, left), lambda, reach);
            if (lambda - before).norm() <= (1e-13 * lambda.norm()).max(noise) {
                break;
            }
            // not settled yet
            noise = noise.max((lambda - before).norm());
        }
        self.complete(a, (right, left), lambda);
        (lambda, noise)
    }

    /// The strain parts of right and left states from their velocities; `left^H right = 1`.
    fn complete(&self, a: &Mat<f64>, (right, left): (&mut [c64], &mut [c64]), lambda: c64) {
        let (n, r) = (self.reduced.size(), self.reduced.n_rigid);
        for i in 0..n - r {
            right[n + i] = (i..n - r).map(|k| right[r + k] * self.root[(k, i)]).sum::<c64>() / lambda;
            left[n + i] = (0..n).map(|k| left[k] * a[(k, n + i)]).sum::<c64>() / lambda.conj();
        }
        let product: c64 = left.iter().zip(right.iter()).map(|(l, r)| l.conj() * r).sum();
        if product.is_finite() && product.norm() > 0.0 {
            left.iter_mut().for_each(|l| *l /= product.conj());
        }
    }

    /// Turns the velocities of a state in the reduced coordinates into those of this form.
    pub fn turn(&self, state: &mut [c64]) {
        if let Some(turn) = &self.turn {
            let turned = product(&turn.transpose().to_owned(), &state[..self.reduced.size()]);
            state[..turned.len()].copy_from_slice(&turned);
        }
    }

    /// Turns the velocities of a state into the reduced coordinates.
    pub fn restored(&self, state: &mut [c64]) {
        if let Some(turn) = &self.turn {
            let turned = product(turn, &state[..self.reduced.size()]);
            state[..turned.len()].copy_from_slice(&turned);
        }
    }

    /// The state (or its left partner) of displacements (or forces) in the reduced coordinates that belong to
    /// the velocities `v` and, for a left one, the covector `z` of the coordinates.
    pub fn right_of(&self, v: Vec<c64>, lambda: c64) -> Vec<c64> {
        let q: Vec<c64> = v.iter().map(|v| v / lambda).collect();
        let along = self.along(&q);
        let strain = (0..along.len()).map(|i| (i..along.len()).map(|k| along[k] * self.root[(k, i)]).sum());
        v.into_iter().chain(strain.collect::<Vec<c64>>()).collect()
    }

    /// Covector of the reduced coordinates that the strain part of a left state stands for.
    pub fn covector(&self, left: &[c64]) -> Vec<c64> {
        let (n, r) = (self.reduced.size(), self.reduced.n_rigid);
        let strain = &left[n..];
        let along = (0..strain.len()).map(|i| (0..=i).map(|k| strain[k] * self.root[(i, k)]).sum::<c64>());
        let padded: Vec<c64> = std::iter::repeat_n(c64::new(0.0, 0.0), r).chain(along).collect();
        match &self.turn {
            Some(turn) => product(turn, &padded),
            None => padded,
        }
    }

    /// Left state of velocities and a covector.
    pub fn left_of(&self, v: Vec<c64>, covector: &[c64]) -> Vec<c64> {
        let along = self.along(covector);
        let right = Mat::from_fn(along.len(), 2, |i, j| if j == 0 { along[i].re } else { along[i].im });
        let strain = self.root.partial_piv_lu().solve(right);
        v.into_iter().chain((0..along.len()).map(|i| c64::new(strain[(i, 0)], strain[(i, 1)]))).collect()
    }

    /// The elastic part of a vector in the turned basis: `Q^T q` without its rigid entries.
    fn along(&self, q: &[c64]) -> Vec<c64> {
        let r = self.reduced.n_rigid;
        match &self.turn {
            Some(turn) => product(&turn.transpose().to_owned(), q)[r..].to_vec(),
            None => q[r..].to_vec(),
        }
    }
}

fn product(a: &Mat<f64>, x: &[c64]) -> Vec<c64> {
    (0..a.nrows()).map(|i| x.iter().enumerate().map(|(j, x)| x * a[(i, j)]).sum()).collect()
}

/// `[N, Q]`: orthonormal null vectors of the stiffness at a speed, and a complement as near to the other
/// coordinates as can be (triangular factors, which keep graded coordinates apart).
fn turn(reduced: &Reduced, weights: &[f64]) -> Mat<f64> {
    let (n, r) = (reduced.size(), reduced.n_rigid);
    let mut null = Mat::from_fn(n, r, |i, j| if i == j { 1.0 } else { 0.0 });
    // the first of the varying parts is the centrifugal matrix, the others belong to the equilibria
    for (weight, part) in weights.iter().skip(1).zip(&reduced.turned) {
        null += part * faer::Scale(*weight);
    }
    let orthonormal = |x: &Mat<f64>, gram: Mat<f64>| match cholesky(gram.as_ref()) {
        Some(l) => over_lower(x, l.as_ref()),
        None => x.clone(),
    };
    let gram = null.transpose() * &null;
    let null = orthonormal(&null, gram);
    let elastic = null.get(r.., ..);
    let complement =
        Mat::from_fn(n, n - r, |i, j| if i == j + r { 1.0 } else { 0.0 }) - &null * elastic.transpose();
    let gram = Mat::<f64>::identity(n - r, n - r) - elastic * elastic.transpose();
    let complement = orthonormal(&complement, gram);
    Mat::from_fn(n, n, |i, j| if j < r { null[(i, j)] } else { complement[(i, j - r)] })
}
