//! Functions of a ring section: Legendre polynomials across the wall times harmonics around it.
//!
//! A tube, or a hollow ellipse with a similar bore, is the image of the ring `k <= rho <= 1` under
//! `y = c_y rho cos(theta)`, `z = c_z rho sin(theta)`. With the wall coordinate `s = (2 rho - 1 - k) / (1 - k)` its
//! functions are `P_a(s) cos(m theta)` and `P_a(s) sin(m theta)`. Integrands of constant matrices are polynomials in
//! rho and 1/rho times harmonics: equal angles are exact, and as many Gauss points go across the wall as rounding
//! resolves. Source: docs/theory/rings.md#functions.

use crate::element::quadrature::gauss;
use crate::section::basis::{RingFunction, ring_functions};
use crate::section::{Section, Shape};
use faer::Mat;
use std::f64::consts::PI;

/// Share of the Cauchy-Schwarz bound below which an integral is rounding error.
const INTEGRAL_ROUNDING: f64 = 1e-14;

/// Shape of a ring in units of its outer semi-axes.
#[derive(Debug, Clone, Copy)]
pub struct RingFunctions {
    /// Outer semi-axes `[c_y, c_z]`, m.
    pub outer: [f64; 2],
    /// Mean radius `(1 + k) / 2`.
    pub mean: f64,
    /// Half the wall, `(1 - k) / 2`.
    pub half: f64,
}

/// A function at a point: value, and derivatives by rho and by theta over rho.
#[derive(Debug, Clone, Copy)]
pub struct Polar {
    /// Value of the function f.
    pub value: f64,
    /// Its derivative by the radius, `df/drho`.
    pub radial: f64,
    /// `df/dtheta / rho`.
    pub hoop: f64,
}

impl RingFunctions {
    /// The ring that a hollow section is; the bore of an ellipse is taken as similar to its outline.
    pub fn new(section: &Section) -> Self {
        let ([c, _], [i, _]) = (section.outer, section.inner);
        Self { outer: section.outer, mean: (c + i) / (2.0 * c), half: (c - i) / (2.0 * c) }
    }

    /// Radii and weights of Gauss points across the wall: `(rho, s, weight by rho)`.
    pub fn across(&self, points: usize) -> Vec<(f64, f64, f64)> {
        let at = |(s, w): (f64, f64)| (self.mean + self.half * s, s, self.half * w);
        gauss(points).into_iter().map(at).collect()
    }

    /// Gauss points across the wall that leave of a polynomial of a degree over rho a share of `error`:
    /// with its pole on the axis the rule converges like `((1 + sqrt k) / (1 - sqrt k))^-2n`.
    pub fn points(&self, degree: usize, error: f64) -> usize {
        let root = (self.mean - self.half).max(0.0).sqrt();
        let rate = ((1.0 + root).powi(2) / (2.0 * self.half)).ln();
        (degree / 2 + 1).max((-error.ln() / (2.0 * rate) + degree as f64 / 2.0).ceil().min(1000.0) as usize)
    }

    /// Wall coordinate and angle of a point.
    pub fn coordinates(&self, y: f64, z: f64) -> (f64, f64) {
        let (eta, zeta) = (y / self.outer[0], z / self.outer[1]);
        (eta.hypot(zeta), zeta.atan2(eta))
    }

    /// All functions at a point; y and z count in units of `reference_length`.
    pub fn functions(
        &self,
        list: &[RingFunction],
        reference_length: f64,
        rho: f64,
        theta: f64,
    ) -> Vec<Polar> {
        let s = (rho - self.mean) / self.half;
        let top = list.iter().filter_map(|f| f.degree).max().unwrap_or(0);
        let legendre = legendre(top, s);
        list.iter()
            .map(|f| {
                let (radial, slope) = match f.degree {
                    Some(a) => (legendre[a].0, legendre[a].1 / self.half),
                    None => {
                        let scale = self.outer[usize::from(f.sine)] / reference_length;
                        (scale * rho, scale)
                    }
                };
                let m = f.waves as f64;
                let (sin, cos) = (m * theta).sin_cos();
                let (wave, turn) = if f.sine { (sin, m * cos) } else { (cos, -m * sin) };
                Polar { value: radial * wave, radial: slope * wave, hoop: radial * turn / rho }
            })
            .collect()
    }

    /// Sums over the ring of products of n functions, polynomials across the wall whose products have a degree and with
    /// waves up to a number.
    pub fn sums(
        &self,
        n: usize,
        degree: usize,
        harmonics: usize,
        functions: &dyn Fn(f64, f64) -> Vec<Polar>,
    ) -> Sums {
        let [cy, cz] = self.outer;
        // two derivatives by y or z make two more harmonics
        let angles = 2 * harmonics + 4;
        // columns: value, by y, by z, d_theta
        let mut sums = [(); 16].map(|()| vec![0.0; n * n]);
        for (rho, _, w) in self.across(self.points(degree, 1e-17)) {
            for j in 0..angles {
                let theta = 2.0 * PI * j as f64 / angles as f64;
                let (sin, cos) = theta.sin_cos();
                let weight = w * rho * cy * cz * 2.0 * PI / angles as f64;
                let mut at = [(); 4].map(|()| Vec::with_capacity(n));
                for f in functions(rho, theta) {
                    let turn = f.radial * sin * cos * (cy / cz - cz / cy)
                        + f.hoop * (cos * cos * cy / cz + sin * sin * cz / cy);
                    let by_y = (cos * f.radial - sin * f.hoop) / cy;
                    let by_z = (sin * f.radial + cos * f.hoop) / cz;
                    let values = [f.value, by_y, by_z, rho * turn];
                    at.iter_mut().zip(values).for_each(|(list, value)| list.push(value));
                }
                for (pair, sum) in sums.iter_mut().enumerate() {
                    let (a, b) = (pair / 4, pair % 4);
                    // symmetric ones and those of d_theta are needed only
                    if a == 3 && b != 3 || b == 3 && a != 3 && a != 0 || a > b {
                        continue;
                    }
                    for (column, right) in sum.chunks_exact_mut(n).zip(&at[b]) {
                        let right = weight * right;
                        column.iter_mut().zip(&at[a]).for_each(|(sum, left)| *sum += left * right);
                    }
                }
            }
        }
        sums.map(|sum| Mat::from_fn(n, n, |k, l| sum[l * n + k]))
    }
}

/// Legendre polynomials `P_0 .. P_top` and their derivatives at s.
pub fn legendre(top: usize, s: f64) -> Vec<(f64, f64)> {
    let mut list = vec![(1.0, 0.0), (s, 1.0)];
    for a in 2..=top {
        let (n, (p, _), (q, dq)) = (a as f64, list[a - 1], list[a - 2]);
        // P_a' = P_(a-2)' + (2 a - 1) P_(a-1)
        list.push((((2.0 * n - 1.0) * s * p - (n - 1.0) * q) / n, dq + (2.0 * n - 1.0) * p));
    }
    list
}

/// Coefficients of the Legendre polynomials `P_0 .. P_top` in ascending powers.
pub fn monomials(top: usize) -> Vec<Vec<f64>> {
    let mut list = vec![vec![1.0], vec![0.0, 1.0]];
    for a in 2..=top {
        let n = a as f64;
        let at = |p: &[f64], e: usize| p.get(e).copied().unwrap_or(0.0);
        let (p, q) = (&list[a - 1], &list[a - 2]);
        let next = |e: usize| {
            let higher = if e > 0 { (2.0 * n - 1.0) * p[e - 1] } else { 0.0 };
            (higher - (n - 1.0) * at(q, e)) / n
        };
        list.push((0..=a).map(next).collect());
    }
    list
}

/// A term `p(s) cos(m theta)` or `p(s) sin(m theta)` of a function over a ring.
#[derive(Debug, Clone)]
pub struct Term {
    /// Coefficients of p in ascending powers of the wall coordinate s.
    pub value: Vec<f64>,
    /// Those of its derivative by rho.
    pub slope: Vec<f64>,
    /// Waves m around the axis.
    pub waves: usize,
    /// Sine instead of cosine.
    pub sine: bool,
}

impl RingFunctions {
    /// A term of the given polynomial in s.
    pub fn term(&self, value: Vec<f64>, waves: usize, sine: bool) -> Term {
        let slope = value.iter().enumerate().skip(1).map(|(e, c)| e as f64 * c / self.half).collect();
        Term { value, slope, waves, sine }
    }

    /// A polynomial in s times rho.
    pub fn times_rho(&self, p: &[f64]) -> Vec<f64> {
        let at = |e: usize| p.get(e).copied().unwrap_or(0.0);
        (0..=p.len()).map(|e| self.mean * at(e) + if e > 0 { self.half * at(e - 1) } else { 0.0 }).collect()
    }

    /// The functions of a ring as terms; y and z count in units of `reference_length`.
    pub fn terms(&self, degree: usize, harmonics: usize, reference_length: f64) -> Vec<Term> {
        let legendre = monomials(degree);
        let of = |f: RingFunction| match f.degree {
            Some(a) => self.term(legendre[a].clone(), f.waves, f.sine),
            None => {
                let scale = self.outer[usize::from(f.sine)] / reference_length;
                Term { slope: vec![scale], ..self.term(self.times_rho(&[scale]), f.waves, f.sine) }
            }
        };
        ring_functions(degree, harmonics).into_iter().map(of).collect()
    }

    /// Functions that are sums of terms, at a point.
    pub fn of_terms(&self, functions: &[Vec<Term>], rho: f64, theta: f64) -> Vec<Polar> {
        let s = (rho - self.mean) / self.half;
        let sum = |p: &[f64]| p.iter().rev().fold(0.0, |sum, c| sum * s + c);
        let of = |terms: &Vec<Term>| {
            let mut polar = Polar { value: 0.0, radial: 0.0, hoop: 0.0 };
            for term in terms {
                let m = term.waves as f64;
                let (sin, cos) = (m * theta).sin_cos();
                let (wave, turn) = if term.sine { (sin, m * cos) } else { (cos, -m * sin) };
                let value = sum(&term.value);
                polar.value += value * wave;
                polar.radial += sum(&term.slope) * wave;
                polar.hoop += value * turn / rho;
            }
            polar
        };
        functions.iter().map(of).collect()
    }
}

/// Integrals of products of functions over a section: `gradients[a][b] = int f_k,a f_l,b dA` with a, b in {none, y, z},
/// `int f_k (d_theta f_l) dA` and `int (d_theta f_k)(d_theta f_l) dA`.
pub type Products = ([[Mat<f64>; 3]; 3], Mat<f64>, Mat<f64>);

/// Sums `int f_k,a f_l,b dA` at `[4 a + b]` with a, b = 0 for the value, 1 and 2 for the derivatives by y and z, 3 for
/// d_theta; those that are needed: a <= b.
pub type Sums = [Mat<f64>; 16];

/// [`Products`] of the functions of a ring, as in [`crate::element::basis::SectionProducts`].
pub fn products(degree: usize, harmonics: usize, section: &Section, reference_length: f64) -> Products {
    let ring = RingFunctions::new(section);
    let list = ring_functions(degree, harmonics);
    let at = |rho, theta| ring.functions(&list, reference_length, rho, theta);
    let sums = ring.sums(list.len(), 2 * degree + 2, harmonics, &at);
    let odd = crate::section::basis::SectionBasis::Ring { degree, harmonics }.odd();
    clean(&sums, &odd, section.is_axisymmetric())
}

/// Products from their sums: symmetric where they are by definition, zero where parity or rounding says so; `odd` tells
/// of each function whether it changes its sign under y -> -y and under z -> -z.
pub fn clean(sums: &Sums, odd: &[[bool; 2]], axisymmetric: bool) -> Products {
    let n = odd.len();
    let clean = |a: usize, b: usize| {
        let (sum, left, right) = (&sums[4 * a + b], &sums[5 * a], &sums[5 * b]);
        // derivatives by y change the parity in y, d_theta that in both
        let flips = |c: usize| [c == 1 || c == 3, c == 2 || c == 3];
        Mat::from_fn(n, n, |k, l| {
            let even = (0..2).all(|i| (odd[k][i] ^ flips(a)[i]) == (odd[l][i] ^ flips(b)[i]));
            let value = if a == b { (sum[(k, l)] + sum[(l, k)]) / 2.0 } else { sum[(k, l)] };
            let bound = (left[(k, k)] * right[(l, l)]).sqrt();
            if even && value.abs() > INTEGRAL_ROUNDING * bound { value } else { 0.0 }
        })
    };
    let gradients = [0, 1, 2]
        .map(|a| [0, 1, 2].map(|b| if a <= b { clean(a, b) } else { clean(b, a).transpose().to_owned() }));
    let mut rotation = clean(0, 3);
    if axisymmetric {
        // skew but for rounding
        rotation = Mat::from_fn(n, n, |k, l| (rotation[(k, l)] - rotation[(l, k)]) / 2.0);
    }
    (gradients, rotation, clean(3, 3))
}

/// Matrix T of d_theta on the functions of a round ring, `d_theta f_l = sum_k T_kl f_k`.
pub fn rotation_matrix(degree: usize, harmonics: usize) -> Mat<f64> {
    let list = ring_functions(degree, harmonics);
    Mat::from_fn(list.len(), list.len(), |k, l| {
        let (f, g) = (list[k], list[l]);
        if (f.degree, f.waves) != (g.degree, g.waves) || f.sine == g.sine {
            return 0.0;
        }
        if f.sine { -(f.waves as f64) } else { f.waves as f64 }
    })
}

/// Points `(y, z, weight)` of a rule over a section for functions of the ring `own`: between the boundaries of an
/// ellipse, and of a rectangle those points that lie outside the bore of `own`.
pub fn rule(over: &Section, own: &Section, degree: usize, harmonics: usize) -> Vec<(f64, f64, f64)> {
    if over.shape == Shape::Rectangle {
        let ring = RingFunctions::new(own);
        let inside = |p: &(f64, f64, f64)| {
            let (rho, _) = ring.coordinates(p.0, p.1);
            rho >= ring.mean - ring.half
        };
        return crate::element::quadrature::section_rule(over, 48).into_iter().filter(inside).collect();
    }
    let similar = over.outer[0] * own.outer[1] == over.outer[1] * own.outer[0]
        && over.outer[0] * over.inner[1] == over.outer[1] * over.inner[0];
    let angles = if similar { 2 * harmonics + 8 } else { 2 * harmonics + 64 };
    let count = (RingFunctions::new(own).points(2 * degree + 4, 1e-17)).max(degree + 4);
    let mut list = Vec::with_capacity(count * angles);
    for (t, w) in gauss(count) {
        let share = (1.0 + t) / 2.0;
        let [a, b] = [0, 1].map(|i| over.inner[i] + share * (over.outer[i] - over.inner[i]));
        let [da, db] = [0, 1].map(|i| (over.outer[i] - over.inner[i]) / 2.0);
        for j in 0..angles {
            let (sin, cos) = (2.0 * PI * j as f64 / angles as f64).sin_cos();
            let area = (da * b * cos * cos + a * db * sin * sin) * w * 2.0 * PI / angles as f64;
            list.push((a * cos, b * sin, area));
        }
    }
    list
}
