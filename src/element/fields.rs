//! The functions that a node's vectors multiply, at points of a section and integrated over an area.
//!
//! Field of a node: `u(y, z) = sum_k f_k(y, z) q_k`, f_k the functions of [`SectionBasis`] in scaled coordinates.
//! Source: docs/theory/elements.md#kinematics and docs/theory/rings.md#functions.

use crate::element::boundary_curve::LinePoint;
use crate::element::quadrature::gauss;
use crate::element::ring_functions::{RingFunctions, rule};
use crate::section::Section;
use crate::section::basis::{RingFunction, SectionBasis, exponents, ring_functions};
use crate::section::kinks::{KinkFunction, Kinks};
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Weight of the slopes over the follower's own area beside the values on the shared one: where the shared area alone does
/// not decide, the follower continues as smoothly as it can.
const WHOLE_AREA: f64 = 1e-7;
/// Entries of a projection below this are rounding errors.
const PROJECTION_ROUNDING: f64 = 1e-11;

/// The functions of one section.
#[derive(Debug, Clone)]
pub struct SectionFunctions {
    basis: SectionBasis,
    section: Section,
    reference_length: f64,
    exponents: Vec<(usize, usize)>,
    ring: Vec<RingFunction>,
    kinks: Kinks,
}

impl SectionFunctions {
    /// Functions of `basis` on `section`; `reference_length` is R (m).
    pub fn new(basis: SectionBasis, section: &Section, reference_length: f64) -> Self {
        let (exponents, ring) = match basis {
            SectionBasis::Monomials(order) => (exponents(order), Vec::new()),
            SectionBasis::Ring { degree, harmonics } => (Vec::new(), ring_functions(degree, harmonics)),
        };
        Self { basis, section: *section, reference_length, exponents, ring, kinks: Kinks::NONE }
    }

    /// The same functions and kinked ones behind them.
    pub fn with_kinks(mut self, kinks: Kinks) -> Self {
        self.kinks = kinks;
        self
    }

    /// Number of functions.
    fn count(&self) -> usize {
        self.basis.count() + self.kinks.count()
    }

    /// For every function whether it changes its sign under y -> -y and under z -> -z.
    fn odd(&self) -> Vec<[bool; 2]> {
        self.basis.odd().into_iter().chain(self.kinks.odd()).collect()
    }

    /// Value and derivatives by y and z (1/m) of every function at a point.
    pub fn at(&self, y: f64, z: f64) -> Vec<[f64; 3]> {
        let mut list = self.of_basis(y, z);
        list.extend(self.kinks.functions().iter().map(|f| kinked(f, y, z)));
        list
    }

    fn of_basis(&self, y: f64, z: f64) -> Vec<[f64; 3]> {
        let r = self.reference_length;
        if self.basis.is_ring() {
            let ring = RingFunctions::new(&self.section);
            let (rho, theta) = ring.coordinates(y, z);
            let ((sin, cos), [cy, cz]) = (theta.sin_cos(), ring.outer);
            let functions = ring.functions(&self.ring, r, rho, theta).into_iter();
            let polar = functions.map(|f| {
                let by_y = (cos * f.radial - sin * f.hoop) / cy;
                [f.value, by_y, (sin * f.radial + cos * f.hoop) / cz]
            });
            return polar.collect();
        }
        let (eta, zeta) = (y / r, z / r);
        let power = |base: f64, n: usize| base.powi(n as i32) / factorial(n);
        let lower = |base: f64, n: usize| if n > 0 { power(base, n - 1) / r } else { 0.0 };
        let value = |&(a, b): &(usize, usize)| {
            [power(eta, a) * power(zeta, b), lower(eta, a) * power(zeta, b), power(eta, a) * lower(zeta, b)]
        };
        self.exponents.iter().map(value).collect()
    }

    /// `int f_k y^a z^b dA` over an area, m^(2+a+b).
    pub fn integrals(&self, over: &Section, a: usize, b: usize) -> Vec<f64> {
        self.integrals_per(over, a, b, [1.0, 1.0])
    }

    /// [`Self::integrals`] divided by two numbers.
    pub fn integrals_per(&self, over: &Section, a: usize, b: usize, per: [f64; 2]) -> Vec<f64> {
        let mut list = self.integrals_of_basis(over, a, b, per);
        list.extend(
            self.kinks.functions().iter().map(|f| kinked_integral(f, over, a, b) / (per[0] * per[1])),
        );
        list
    }

    fn integrals_of_basis(&self, over: &Section, a: usize, b: usize, per: [f64; 2]) -> Vec<f64> {
        let r = self.reference_length;
        if let SectionBasis::Ring { degree, harmonics } = self.basis {
            let mut sums = vec![0.0; self.ring.len()];
            for (y, z, weight) in rule(over, &self.section, degree + (a + b) / 2, harmonics + a + b) {
                let weight = weight * y.powi(a as i32) * z.powi(b as i32);
                for (sum, f) in sums.iter_mut().zip(self.of_basis(y, z)) {
                    *sum += weight * f[0];
                }
            }
            // odd ones vanish
            for (sum, odd) in sums.iter_mut().zip(self.basis.odd()) {
                if odd != [a % 2 == 1, b % 2 == 1] {
                    *sum = 0.0;
                }
            }
            let size = over.area() * over.outer_size().powi((a + b) as i32);
            sums.iter_mut()
                .for_each(|s| *s = if s.abs() < 1e-14 * size { 0.0 } else { *s / (per[0] * per[1]) });
            return sums;
        }
        let scale =
            |i: usize, j: usize| factorial(i) * factorial(j) * r.powi((i + j) as i32) * per[0] * per[1];
        self.exponents.iter().map(|&(i, j)| over.moment(i + a, j + b) / scale(i, j)).collect()
    }

    /// Mean value of every function over an area: the weights of a load or a bearing that acts on it.
    pub fn means(&self, over: &Section) -> Vec<f64> {
        if !self.basis.is_ring() {
            return self.integrals_per(over, 0, 0, [over.area(), 1.0]);
        }
        let sums = self.integrals(over, 0, 0);
        // the first function is 1
        let area = sums[0];
        sums.into_iter().map(|s| s / area).collect()
    }

    /// `int f_k weight ds` along a line that is symmetric about both axes, `weight` odd or even in y and z as told, m
    /// times its unit.
    pub fn along(&self, line: &[LinePoint], odd: [bool; 2], weight: impl Fn(&LinePoint) -> f64) -> Vec<f64> {
        let size: f64 = line.iter().map(|p| weight(p).abs()).sum();
        let sums = self.along_any(line, &weight);
        let parities = self.odd().into_iter();
        let rounding = if self.basis.is_ring() { 1e-14 * size } else { 0.0 };
        let clean = |(s, parity): (f64, _)| if parity != odd || s.abs() < rounding { 0.0 } else { s };
        sums.into_iter().zip(parities).map(clean).collect()
    }

    /// `int f_k weight ds` along any line.
    pub fn along_any(&self, line: &[LinePoint], weight: impl Fn(&LinePoint) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.count()];
        for point in line {
            let weight = weight(point);
            sums.iter_mut().zip(self.at(point.y, point.z)).for_each(|(sum, f)| *sum += weight * f[0]);
        }
        sums
    }

    /// Matrix P of the vectors that make this field the projection of another one on a shared area,
    /// `q_k = sum_l P_kl other_l`. Monomials of a lower order are continued exactly; 1, y and z always are. Kinked functions
    /// that both fields have are the same; other ones of this field are zero, or free: see [`Self::free_on`].
    pub fn following(&self, other: &Self, shared: &Section) -> Mat<f64> {
        let mut p = self.basis_following(other, shared);
        let (n, m) = (self.basis.count(), other.basis.count());
        for (k, f) in self.kinks.functions().iter().enumerate() {
            for (l, g) in other.kinks.functions().iter().enumerate() {
                if f.kink.is_at(&g.kink) && (f.power, f.waves, f.sine) == (g.power, g.waves, g.sine) {
                    p[(n + k, m + l)] = (f.kink.scale / g.kink.scale).powi(f.power as i32);
                    // not through the functions of the member as well
                    (0..n).for_each(|k| p[(k, m + l)] = 0.0);
                }
            }
        }
        p
    }

    /// For each function whether it is free where this field meets another one on a shared area: kinked functions that
    /// vanish there.
    pub fn free_on(&self, shared: &Section) -> Vec<bool> {
        let vanishes = |f: KinkFunction| f.kink.vanishes_on(shared.inner[0], shared.outer[0]);
        let kinked = self.kinks.functions().into_iter().map(vanishes);
        std::iter::repeat_n(false, self.basis.count()).chain(kinked).collect()
    }

    /// For each function whether a neighbour that follows can follow it on the shared area: those of the member, kinked ones
    /// that the neighbour has, too, and others where the neighbour's functions are those of a ring.
    pub fn followed_by(&self, follower: &Self, shared: &Section) -> Vec<bool> {
        let p = follower.following(self, shared);
        (0..self.count())
            .map(|l| l < self.basis.count() || (0..p.nrows()).any(|k| p[(k, l)] != 0.0))
            .collect()
    }

    /// True when the members' functions of both fields are the same.
    fn has_basis_of(&self, other: &Self) -> bool {
        self.basis == other.basis && (!self.basis.is_ring() || self.section == other.section)
    }

    /// [`Self::following`] for the functions of the member; those of the other field are all that it has.
    fn basis_following(&self, other: &Self, shared: &Section) -> Mat<f64> {
        let (n, m) = (self.basis.count(), other.count());
        let mut p =
            Mat::from_fn(self.count(), m, |k, l| f64::from(k == l && k < n && k < other.basis.count()));
        if !self.basis.is_ring() && !other.basis.is_ring() || self.has_basis_of(other) {
            return p;
        }
        let points = |over: &Section| {
            let ring = if self.basis.is_ring() { self } else { other };
            match ring.basis {
                SectionBasis::Ring { degree, harmonics } => {
                    rule(over, &ring.section, degree + 5, harmonics + 5)
                }
                SectionBasis::Monomials(_) => Vec::new(),
            }
        };
        let mut gram = DMatrix::<f64>::zeros(n, n);
        let mut mixed = DMatrix::<f64>::zeros(n, m);
        let area = shared.area();
        for (y, z, w) in points(shared) {
            let f = DVector::from_iterator(n, self.of_basis(y, z).into_iter().map(|f| f[0]));
            let g = DVector::from_iterator(m, other.at(y, z).into_iter().map(|g| g[0]));
            gram.ger(w / area, &f, &f, 1.0);
            mixed.ger(w / area, &f, &g, 1.0);
        }
        let size = self.section.outer_size();
        for (y, z, w) in points(&self.section) {
            let values = self.of_basis(y, z);
            for slope in [1, 2] {
                let f = DVector::from_iterator(n, values.iter().map(|f| size * f[slope]));
                gram.ger(WHOLE_AREA * w / self.section.area(), &f, &f, 1.0);
            }
        }
        let scale = DVector::from_iterator(n, (0..n).map(|k| 1.0 / gram[(k, k)].sqrt()));
        let scaled = DMatrix::from_fn(n, n, |i, j| gram[(i, j)] * scale[i] * scale[j]);
        let right = DMatrix::from_fn(n, m, |i, j| mixed[(i, j)] * scale[i]);
        let Some(cholesky) = scaled.cholesky() else { return p };
        let solved = cholesky.solve(&right);
        let (odd, other_odd) = (self.basis.odd(), other.odd());
        for l in 3..m {
            for k in 0..n {
                let value = solved[(k, l)] * scale[k];
                let kept = odd[k] == other_odd[l] && value.abs() > PROJECTION_ROUNDING;
                p[(k, l)] = if kept { value } else { 0.0 };
            }
        }
        p
    }
}

/// Value and derivatives by y and z (1/m) of a kinked function.
fn kinked(f: &KinkFunction, y: f64, z: f64) -> [f64; 3] {
    let (rho, theta) = (y.hypot(z), z.atan2(y));
    let (value, slope) = f.radial(rho);
    if value == 0.0 && slope == 0.0 {
        return [0.0; 3];
    }
    let m = f.waves as f64;
    let (sin, cos) = (m * theta).sin_cos();
    let (wave, turn) = if f.sine { (sin, m * cos) } else { (cos, -m * sin) };
    // an inward kink with waves has no limit on the axis; no section with one reaches it
    let (radial, hoop) = (slope * wave, if rho > 0.0 { value * turn / rho } else { 0.0 });
    let (s, c) = theta.sin_cos();
    [value * wave, c * radial - s * hoop, s * radial + c * hoop]
}

/// `int f y^a z^b dA` of a kinked function over a round area, m^(2+a+b).
fn kinked_integral(f: &KinkFunction, over: &Section, a: usize, b: usize) -> f64 {
    let angles = 2 * (f.waves + a + b) + 4;
    let around: f64 = (0..angles)
        .map(|j| {
            let theta = 2.0 * PI * j as f64 / angles as f64;
            let (sin, cos) = theta.sin_cos();
            let waves = (f.waves as f64 * theta).sin_cos();
            let wave = if f.sine { waves.0 } else { waves.1 };
            wave * cos.powi(a as i32) * sin.powi(b as i32)
        })
        .sum::<f64>()
        * 2.0
        * PI
        / angles as f64;
    // the waves of the factors do not meet
    if around.abs() < 1e-12 {
        return 0.0;
    }
    let cells = Kinks::new(&[f.kink]).cells(over.inner[0], over.outer[0]);
    let across = |[inner, outer]: [f64; 2]| -> f64 {
        let (middle, half) = ((inner + outer) / 2.0, (outer - inner) / 2.0);
        // degree p + a + b + 1
        let rule = gauss((f.power + a + b).div_ceil(2) + 1).into_iter();
        let at = |(s, w): (f64, f64)| {
            let rho = middle + half * s;
            half * w * f.radial(rho).0 * rho.powi((a + b + 1) as i32)
        };
        rule.map(at).sum()
    };
    around * cells.into_iter().map(across).sum::<f64>()
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}
