//! Internal force and tangent of the ring members 34Rdh, without points across the wall.
//!
//! At an axial station the three columns of the deformation gradient are polynomials in the wall coordinate s times
//! waves around the section, over powers of rho:
//!
//! ```text
//!     F_a = rho^-n_a sum_e s^e sum_t F_a[e,t] wave_t(theta),    n_x = 0
//! ```
//!
//! For a circle the other directions are rho (n = 0) and theta (n = 1), for an ellipse y and z (n = 1 both): orthonormal
//! in any case, so the isotropic law is the same at every angle. Angles are points, equal ones are exact, theta and
//! -theta are evaluated together; across the wall strains are polynomials, and the moments
//! `H_n[g] = int s^g rho^(1-n) drho` give those of stress, `T_ab[g] = int s^g rho^-n_ab S_ab rho drho`, and of the
//! moduli. Source: derived in docs/theory/rings.md#forces.

mod force;
mod tangent;

use crate::element::continuum::lame;
use crate::element::kernel::pair_stiffness::{Expansion, PAIRS, place};
use crate::element::kernel::simd::Scratch;
use crate::element::kernel::stations::Stations;
use crate::element::kernel::vectorised::Vectorised;
use crate::element::ring_functions::{RingFunctions, Term};
use crate::instructions::Instructions;
use crate::model::{ElementKind, Material, Quadrature};
use crate::section::Section;
use crate::section::basis::SectionBasis;
use pulp::{Arch, Simd};
use std::f64::consts::PI;
use tangent::RingTables;

/// Share of the moments that the points across the wall may leave out.
const LEFT_OUT_MOMENT_SHARE: f64 = 1e-17;

/// A ring and functions over it.
#[derive(Debug)]
pub struct Over<'a> {
    /// A hollow section.
    pub section: &'a Section,
    /// Largest power of the wall coordinate.
    pub degree: usize,
    /// Largest number of waves.
    pub harmonics: usize,
    /// What the vectors of a node multiply, each a sum of terms.
    pub functions: Vec<Vec<Term>>,
}

/// A coefficient of F that a vector enters, with its factor.
#[derive(Debug, Clone, Copy)]
struct Role {
    /// Power of s.
    power: usize,
    /// Wave: m for cos m theta, h + m for sin m theta, h the harmonics of the direction.
    wave: usize,
    factor: f64,
}

/// One column of the deformation gradient.
#[derive(Debug, Clone)]
struct Direction {
    /// Powers of s: 0 up to below.
    count: usize,
    /// Powers of rho it is divided by.
    over: usize,
    /// Number of harmonics of this direction.
    harmonics: usize,
    /// Sign of the direction under theta -> -theta.
    mirrored: f64,
    /// Half of the square of the undeformed column, as a polynomial in s.
    half_square: Vec<f64>,
    /// First coefficient among those of all directions.
    first: usize,
    /// First power among those of all directions.
    set: usize,
}

impl Direction {
    fn waves(&self) -> usize {
        2 * self.harmonics + 1
    }
}

/// The angles 0 .. pi, each with its negative.
#[derive(Debug, Clone)]
struct Angles {
    /// Number of powers of the radius in this direction.
    count: usize,
    /// `cos p theta` and `sin p theta`, `[p][angle]`.
    waves: [Vec<f64>; 2],
    /// The same times the weight: 1, and 1/2 for the angle 0, which is its own negative.
    weighted: [Vec<f64>; 2],
}

impl Angles {
    /// Equal angles, an odd number around the section; waves up to a harmonic.
    fn new(around: usize, harmonics: usize) -> Self {
        let count = around / 2 + 1;
        let angle = |p: usize, j: usize| 2.0 * PI * (p * j % around) as f64 / around as f64;
        let table = |wave: fn(f64) -> f64, half: f64| -> Vec<f64> {
            let row = |p: usize| (0..count).map(move |j| (p, j));
            (0..=harmonics)
                .flat_map(row)
                .map(|(p, j)| wave(angle(p, j)) * if j == 0 { half } else { 1.0 })
                .collect()
        };
        Self {
            count,
            waves: [table(f64::cos, 1.0), table(f64::sin, 1.0)],
            weighted: [table(f64::cos, 0.5), table(f64::sin, 0.5)],
        }
    }

    /// Weight of an angle.
    fn weight(&self, j: usize) -> f64 {
        self.weighted[0][j]
    }
}

/// The tables of one type of element: everything that does not depend on its coordinates.
#[derive(Debug, Clone)]
pub struct RingElement {
    mu: f64,
    lambda: f64,
    /// Kelvin-Voigt factor, s.
    viscosity: f64,
    n_vectors: usize,
    /// What the vectors of a node do to the columns.
    vectors: Vec<[Vec<Role>; 3]>,
    directions: [Direction; 3],
    /// Polynomials of the six products of columns: their first coefficients, and the end of the last.
    products: [usize; 7],
    angles: Angles,
    /// Moments of the stress for the strains: normal ones together, then each shear alone; by rows, m^2 Pa.
    law: [Vec<f64>; 4],
    /// Moments `H_n[g]` times the weight of an angle, `[n][g]`, m^2.
    moments: [Vec<f64>; 5],
    stations: Stations,
    tangent: RingTables,
    /// Vector instructions that the kernels use.
    arch: Arch,
}

impl RingElement {
    /// Tables for an element of the given length (m) on a ring section; `reference_length` is R (m). `None` for
    /// a basis that is no ring.
    pub fn new(
        kind: ElementKind,
        section: &Section,
        material: &Material,
        length: f64,
        reference_length: f64,
        quadrature: Quadrature,
    ) -> Option<Self> {
        let SectionBasis::Ring { degree, harmonics } = kind.basis else { return None };
        let terms = RingFunctions::new(section).terms(degree, harmonics, reference_length);
        let functions = terms.into_iter().map(|term| vec![term]).collect();
        let over = Over { section, degree, harmonics, functions };
        // the integrand holds four factors of the axial degree
        let count = quadrature.axial.unwrap_or(2 * kind.axial_degree + 1);
        let stations = Stations::new(kind.axial_degree, length, count);
        Some(Self::of_functions(stations, over, material, quadrature))
    }

    /// Tables for an element, at some stations along it, whose vectors multiply any functions over a ring.
    pub fn of_functions(
        stations: Stations,
        Over { section, degree, harmonics, functions }: Over<'_>,
        material: &Material,
        quadrature: Quadrature,
    ) -> Self {
        let (lambda, mu) = lame(material);
        let (ring, round) = (RingFunctions::new(section), section.is_axisymmetric());
        let directions = directions(&ring, round, degree, harmonics);
        let vectors = vectors(&ring, round, degree, &functions, &directions);
        // four factors F
        let around = 4 * directions[1].harmonics + 1;
        let angles = Angles::new(around, 2 * directions[1].harmonics);
        let mut products = [0; 7];
        for (p, (a, b)) in PAIRS.into_iter().enumerate() {
            products[p + 1] = products[p] + directions[a].count + directions[b].count - 1;
        }
        let weight = ring.outer[0] * ring.outer[1] * 2.0 * PI / around as f64;
        let points = quadrature.section.unwrap_or(ring.points(4 * degree + 2, LEFT_OUT_MOMENT_SHARE));
        let rule = ring.across(points);
        let moments = [0, 1, 2, 3, 4].map(|n| {
            let moment = |g: usize| -> f64 {
                rule.iter().map(|(rho, s, w)| w * s.powi(g as i32) * rho.powi(1 - n)).sum()
            };
            (0..=4 * degree).map(|g| weight * moment(g)).collect::<Vec<f64>>()
        });
        let law = law(&directions, &products, &moments, lambda, mu);
        Self {
            mu,
            lambda,
            viscosity: material.stiffness_damping,
            n_vectors: vectors.len(),
            tangent: RingTables::new(&vectors, &directions, &stations),
            vectors,
            directions,
            products,
            angles,
            law,
            moments,
            stations,
            arch: Instructions::Widest.arch().unwrap_or(Arch::Scalar),
        }
    }

    /// Computes with other vector instructions; those it had stay on a processor without the ones asked for.
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.arch = instructions.arch().unwrap_or(self.arch);
        self
    }

    /// Coefficients of F of all directions: powers of s times waves.
    fn coefficients(&self) -> usize {
        self.directions.iter().map(|d| d.count * d.waves()).sum()
    }

    /// Powers of s of all directions.
    fn sets(&self) -> usize {
        self.directions.iter().map(|d| d.count).sum()
    }

    /// Powers of a direction among those of all.
    #[inline(always)]
    fn column<'a, T>(&self, alpha: usize, f: &'a [T]) -> &'a [T] {
        let d = &self.directions[alpha];
        &f[d.set..d.set + d.count]
    }

    /// Coefficients of F at a batch of stations.
    #[inline(always)]
    fn gradient<S: Simd>(&self, simd: S, q: &[f64], batch: usize, f: &mut [[S::f64s; 3]]) {
        f.fill([simd.splat_f64s(0.0); 3]);
        for (k, roles) in self.vectors.iter().enumerate() {
            let [value, slope] = self.stations.collapse(simd, q, (k, self.n_vectors), batch);
            for alpha in 0..3 {
                let d = &self.directions[alpha];
                let along = if alpha == 0 { &slope } else { &value };
                for role in &roles[alpha] {
                    let f = &mut f[d.first + d.waves() * role.power + role.wave];
                    let factor = simd.splat_f64s(role.factor);
                    for i in 0..3 {
                        f[i] = simd.mul_add_e_f64s(factor, along[i], f[i]);
                    }
                }
            }
        }
    }

    /// Coefficients of the powers of s at theta and, mirrored, at -theta.
    #[inline(always)]
    fn at_angle<S: Simd>(
        &self,
        simd: S,
        j: usize,
        coefficients: &[[S::f64s; 3]],
        f: &mut [[[S::f64s; 2]; 3]],
    ) {
        let count = self.angles.count;
        let [cos, sin] = [&self.angles.waves[0][j..], &self.angles.waves[1][j..]];
        for d in &self.directions {
            let of_d = &coefficients[d.first..d.first + d.count * d.waves()];
            for (c, f) in of_d.chunks_exact(d.waves()).zip(&mut f[d.set..d.set + d.count]) {
                // cos 0
                let (mut even, mut odd) = (c[0], [simd.splat_f64s(0.0); 3]);
                for m in 1..=d.harmonics {
                    let cos = simd.splat_f64s(cos[m * count]);
                    let sin = simd.splat_f64s(sin[m * count]);
                    let (a, b) = (&c[m], &c[d.harmonics + m]);
                    for i in 0..3 {
                        even[i] = simd.mul_add_e_f64s(cos, a[i], even[i]);
                        odd[i] = simd.mul_add_e_f64s(sin, b[i], odd[i]);
                    }
                }
                for i in 0..3 {
                    let difference = if d.mirrored > 0.0 {
                        simd.sub_f64s(even[i], odd[i])
                    } else {
                        simd.sub_f64s(odd[i], even[i])
                    };
                    f[i] = [simd.add_f64s(even[i], odd[i]), difference];
                }
            }
        }
    }
}

impl Vectorised for RingElement {
    fn arch(&self) -> Arch {
        self.arch
    }

    fn viscosity(&self) -> f64 {
        self.viscosity
    }

    fn expansion(&self) -> &Expansion {
        &self.tangent.expansion
    }

    #[inline(always)]
    fn force<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64 {
        self.add_up(simd, q, velocity, force, scratch)
    }

    #[inline(always)]
    fn stiffness<S: Simd>(&self, simd: S, q: &[f64], geometric: bool, scratch: &mut Scratch) {
        self.pair_stiffness(simd, q, geometric, scratch);
    }
}

/// Columns x, rho, theta of a circle or x, y, z of an ellipse.
fn directions(ring: &RingFunctions, round: bool, degree: usize, harmonics: usize) -> [Direction; 3] {
    let (mean, half) = (ring.mean, ring.half);
    // rho^2 / 2 for those over rho
    let squares = |over: usize| {
        if over == 0 { vec![0.5] } else { vec![mean * mean / 2.0, mean * half, half * half / 2.0] }
    };
    let counts = if round { [degree + 1, degree, degree + 1] } else { [degree + 1; 3] };
    let overs = if round { [0, 0, 1] } else { [0, 1, 1] };
    let (mut first, mut set) = (0, 0);
    [0, 1, 2].map(|a| {
        let direction = Direction {
            count: counts[a],
            over: overs[a],
            harmonics: if round || a == 0 { harmonics } else { harmonics + 1 },
            mirrored: if a == 2 { -1.0 } else { 1.0 },
            half_square: squares(overs[a]),
            first,
            set,
        };
        first += direction.count * direction.waves();
        set += direction.count;
        direction
    })
}

/// What the vectors of a node do to the columns.
fn vectors(
    ring: &RingFunctions,
    round: bool,
    degree: usize,
    functions: &[Vec<Term>],
    directions: &[Direction; 3],
) -> Vec<[Vec<Role>; 3]> {
    functions
        .iter()
        .map(|terms| {
            let mut roles = [const { Vec::new() }; 3];
            // waves of a negative number are those of its size, but for the sign of sines
            let mut add = |a: usize, polynomial: &[f64], (number, sine): (isize, bool), factor: f64| {
                let (m, h) = (number.unsigned_abs(), directions[a].harmonics);
                let factor = if sine { factor * number.signum() as f64 } else { factor };
                for (power, c) in polynomial.iter().enumerate() {
                    if c * factor != 0.0 {
                        roles[a].push(Role { power, wave: if sine { h + m } else { m }, factor: c * factor });
                    }
                }
            };
            for Term { value, slope, waves, sine } in terms {
                let (m, waves, sine) = (*waves as f64, *waves as isize, *sine);
                let sign = if sine { 1.0 } else { -1.0 };
                add(0, value, (waves, sine), 1.0);
                if round {
                    add(1, slope, (waves, sine), 1.0 / ring.outer[0]);
                    add(2, value, (waves, !sine), sign * m / ring.outer[0]);
                } else {
                    // rho f_y and rho f_z have the waves below and above
                    let radial = ring.times_rho(slope);
                    let both = |factor: f64| -> Vec<f64> {
                        let at = |p: &[f64], e: usize| p.get(e).copied().unwrap_or(0.0);
                        (0..=degree).map(|e| at(&radial, e) + factor * at(value, e)).collect()
                    };
                    let (below, above) = (both(m), both(-m));
                    let [y, z] = ring.outer.map(|c| 0.5 / c);
                    add(1, &below, (waves - 1, sine), y);
                    add(1, &above, (waves + 1, sine), y);
                    add(2, &below, (waves - 1, !sine), sign * z);
                    add(2, &above, (waves + 1, !sine), -sign * z);
                }
            }
            roles
        })
        .collect()
}

/// Moments of the stress for the strains; strains of different directions count twice.
fn law(
    directions: &[Direction; 3],
    products: &[usize; 7],
    moments: &[Vec<f64>; 5],
    lambda: f64,
    mu: f64,
) -> [Vec<f64>; 4] {
    let over = |p: usize| directions[PAIRS[p].0].over + directions[PAIRS[p].1].over;
    let length = |p: usize| products[p + 1] - products[p];
    let rows = |pairs: std::ops::Range<usize>| {
        let mut list = Vec::new();
        for p in pairs.clone() {
            for g in 0..length(p) {
                for q in pairs.clone() {
                    let modulus = match p {
                        0..3 => lambda + if p == q { 2.0 * mu } else { 0.0 },
                        _ => mu,
                    };
                    list.extend((0..length(q)).map(|h| modulus * moments[over(p) + over(q)][g + h]));
                }
            }
        }
        list
    };
    [rows(0..3), rows(3..4), rows(4..5), rows(5..6)]
}

/// First coefficient of the product of two columns.
#[inline(always)]
fn product(products: &[usize; 7], alpha: usize, beta: usize) -> usize {
    products[place(alpha, beta)]
}
