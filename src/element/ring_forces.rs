//! Internal force and tangent of the ring members 34Rdh by sum factorisation in polar points.
//!
//! At an axial station the nodes collapse to the vectors and their slopes along x, at a radius these to harmonics
//! `A_m, B_m, C_m` of the three derivatives, and only then do angles follow:
//!
//! ```text
//!     F_x = sum_m T_m(theta) A_m,   F_rho = sum_m T_m(theta) B_m,   F_theta = sum_m T_m'(theta) C_m
//! ```
//!
//! with `T = cos m theta, sin m theta`. Points theta and -theta share the sums over cosines and over sines. St.
//! Venant-Kirchhoff's law is isotropic, so a round section needs no Cartesian directions; an ellipse is stretched to
//! them at every point. Force: the same sums transposed. Tangent: harmonics of the 45 moduli at a radius, from them
//! the section's matrix, then the nodes once. Equal angles are exact; Gauss points across the wall leave less than
//! 1e-8 of the terms in 1/r. Stations lie side by side in SIMD lanes. Source: docs/theory.md section 10.

use super::continuum::lame;
use super::ring::{Ring, legendre};
use super::stations::{NODE_PAIRS, Stations};
use crate::model::{ElementKind, Material, Quadrature};
use crate::section::Section;
use crate::vectors::{SectionBasis, ring_functions};
use pulp::bytemuck::{Pod, cast_slice_mut};
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::PI;

/// Share of the terms in 1/r that the points across the wall leave out.
const WALL_ERROR: f64 = 1e-8;
/// Bytes of a cache line.
const LINE: usize = 64;
/// The pairs of directions x, rho, theta: xx, rho rho, theta theta, x rho, x theta, rho theta.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Place of component ij among the six of a symmetric tensor, in the order of [`PAIRS`].
const SIX: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];
/// First entry of each pair's moduli among the 45: six of a symmetric pair, nine of the others.
const MODULI: [usize; 7] = [0, 6, 12, 18, 27, 36, 45];
/// Directions and first entry of the moduli once they are spread: xx with six entries, then x rho, x theta, rho rho,
/// theta theta, rho theta and theta rho with nine.
const SPREAD: [(usize, usize, usize); 7] =
    [(0, 0, 0), (0, 1, 6), (0, 2, 15), (1, 1, 24), (2, 2, 33), (1, 2, 42), (2, 1, 51)];
/// The 60 spread moduli, padded.
const PLACES: usize = 64;

/// Radial factors of all vectors at a radius.
#[derive(Debug, Clone)]
struct Radius {
    /// Weight of each of its points, m^2.
    weight: f64,
    values: Vec<f64>,
    /// By rho (round: by r, 1/m).
    slopes: Vec<f64>,
    /// Value over rho (round: over r, 1/m).
    hoops: Vec<f64>,
}

/// An angle, or the two angles theta and -theta.
#[derive(Debug, Clone)]
struct Angle {
    /// True for theta and -theta.
    both: bool,
    /// `cos m theta, sin m theta, m cos m theta, -m sin m theta`, m = 1 .. h.
    waves: Vec<[f64; 4]>,
    /// `cos p theta`, p = 0 .. 2 h, then `sin p theta`, p = 1 .. 2 h.
    moduli: Vec<f64>,
    /// Ellipse: `d(rho, theta)/d(y, z)` with theta's derivative times rho: `[[y_rho, y_theta], [z_rho, z_theta]]`.
    stretch: [[f64; 2]; 2],
}

/// A product of two harmonics as `sum of two factors times harmonics of the moduli`.
type Product = [(f64, usize); 2];

/// The tables of one type of element: everything that does not depend on its coordinates.
#[derive(Debug, Clone)]
pub struct RingElement {
    lambda: f64,
    mu: f64,
    /// Kelvin-Voigt factor, s.
    viscosity: f64,
    n_nodes: usize,
    n_vectors: usize,
    round: bool,
    harmonics: usize,
    /// Harmonic of each vector: m for cos m theta, h + m for sin m theta.
    harmonic: Vec<usize>,
    /// Vectors with each harmonic.
    with_harmonic: Vec<Vec<usize>>,
    radii: Vec<Radius>,
    angles: Vec<Angle>,
    /// Products of harmonics t, u at `t * (2 h + 1) + u`.
    products: Vec<Product>,
    stations: Stations,
}

/// Working memory, one for each thread.
#[derive(Debug, Clone, Default)]
pub struct RingScratch {
    values: Vec<f64>,
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
        let (lambda, mu) = lame(material);
        let (ring, round) = (Ring::new(section), section.is_axisymmetric());
        let list = ring_functions(degree, harmonics);
        let [cy, cz] = ring.outer;
        // four factors F, of h harmonics each (of h + 1 along y and z)
        let n_angles = if round { 4 * harmonics + 1 } else { 4 * harmonics + 5 };
        let across = (2 * degree + 1).max(degree + ring.points(0, WALL_ERROR));
        let scale = if round { 1.0 / cy } else { 1.0 };
        let radii = ring
            .across(quadrature.section.unwrap_or(across))
            .into_iter()
            .map(|(rho, s, w)| {
                let polynomials = legendre(degree, s);
                let factors: Vec<(f64, f64)> = list
                    .iter()
                    .map(|f| match f.degree {
                        Some(a) => (polynomials[a].0, polynomials[a].1 / ring.half),
                        None => {
                            let scale = ring.outer[usize::from(f.sine)] / reference_length;
                            (scale * rho, scale)
                        }
                    })
                    .collect();
                Radius {
                    weight: w * rho * cy * cz * 2.0 * PI / n_angles as f64,
                    values: factors.iter().map(|f| f.0).collect(),
                    slopes: factors.iter().map(|f| f.1 * scale).collect(),
                    hoops: factors.iter().map(|f| f.0 / rho * scale).collect(),
                }
            })
            .collect();
        let harmonic: Vec<usize> =
            list.iter().map(|f| if f.sine { harmonics + f.waves } else { f.waves }).collect();
        let angles = (0..=n_angles / 2)
            .map(|j| {
                let theta = 2.0 * PI * j as f64 / n_angles as f64;
                let (sin, cos) = theta.sin_cos();
                Angle {
                    both: j > 0 && 2 * j < n_angles,
                    waves: (1..=harmonics)
                        .map(|m| {
                            let number = m as f64;
                            let (sin, cos) = (number * theta).sin_cos();
                            [cos, sin, number * cos, -number * sin]
                        })
                        .collect(),
                    moduli: (0..=2 * harmonics)
                        .map(|p| (p as f64 * theta).cos())
                        .chain((1..=2 * harmonics).map(|p| (p as f64 * theta).sin()))
                        .collect(),
                    stretch: [[cos / cy, -sin / cy], [sin / cz, cos / cz]],
                }
            })
            .collect();
        Some(Self {
            lambda,
            mu,
            viscosity: material.stiffness_damping,
            n_nodes: kind.n_nodes(),
            n_vectors: list.len(),
            round,
            harmonics,
            with_harmonic: (0..=2 * harmonics)
                .map(|t| (0..list.len()).filter(|&k| harmonic[k] == t).collect())
                .collect(),
            harmonic,
            radii,
            angles,
            products: products(harmonics),
            // the integrand holds four factors of the axial degree
            stations: Stations::new(
                kind.axial_degree,
                length,
                quadrature.axial.unwrap_or(2 * kind.axial_degree + 1),
            ),
        })
    }

    /// Kelvin-Voigt factor beta of the material, s.
    pub fn viscosity(&self) -> f64 {
        self.viscosity
    }

    /// Number of coordinates.
    pub fn size(&self) -> usize {
        3 * self.n_nodes * self.n_vectors
    }

    /// Internal force `dW/dq` (N, one for each scaled coordinate) into `force`; returns the strain energy W (J).
    ///
    /// With velocities the Kelvin-Voigt stress `beta C : dE/dt` is added to the force (and no energy is returned).
    pub fn internal_force(
        &self,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut RingScratch,
    ) -> f64 {
        let velocity = velocity.filter(|_| self.viscosity != 0.0);
        Arch::new().dispatch(Force { element: self, q, velocity, force, scratch })
    }

    /// Tangent `d force / dq` (N/m), symmetric, by columns into `tangent` (both triangles).
    pub fn tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut RingScratch) {
        Arch::new().dispatch(Tangent { element: self, q, geometric: true, tangent, scratch });
    }

    /// The part of the tangent that stems from the law alone, without stress: `beta` times it is the derivative of
    /// the Kelvin-Voigt force by the velocities.
    pub fn material_tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut RingScratch) {
        Arch::new().dispatch(Tangent { element: self, q, geometric: false, tangent, scratch });
    }

    /// Harmonics `2 h + 1`.
    fn n_harmonics(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Vectors and their slopes along x at a batch of stations.
    #[inline(always)]
    fn collapse<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        batch: usize,
        values: &mut [[S::f64s; 3]],
        slopes: &mut [[S::f64s; 3]],
    ) {
        let width = self.stations.padded / S::F64_LANES;
        let [l, dl] = [&self.stations.axial[0], &self.stations.axial[1]].map(|t| S::as_simd_f64s(t).0);
        for (k, (value, slope)) in values.iter_mut().zip(slopes).enumerate() {
            let (mut v, mut d) = ([simd.splat_f64s(0.0); 3], [simd.splat_f64s(0.0); 3]);
            for i in 0..self.n_nodes {
                let at = 3 * (i * self.n_vectors + k);
                let (weight, slope) = (l[i * width + batch], dl[i * width + batch]);
                for c in 0..3 {
                    let q = simd.splat_f64s(q[at + c]);
                    v[c] = simd.mul_add_e_f64s(q, weight, v[c]);
                    d[c] = simd.mul_add_e_f64s(q, slope, d[c]);
                }
            }
            (*value, *slope) = (v, d);
        }
    }

    /// Harmonics of the derivatives by x, rho and theta at a radius.
    #[inline(always)]
    fn harmonics<S: Simd>(
        &self,
        simd: S,
        radius: &Radius,
        values: &[[S::f64s; 3]],
        slopes: &[[S::f64s; 3]],
        harmonics: &mut [&mut [[S::f64s; 3]]; 3],
    ) {
        for list in harmonics.iter_mut() {
            list.fill([simd.splat_f64s(0.0); 3]);
        }
        for k in 0..self.n_vectors {
            let t = self.harmonic[k];
            let factors = [radius.values[k], radius.slopes[k], radius.hoops[k]];
            for (alpha, factor) in factors.into_iter().enumerate() {
                let (factor, source) =
                    (simd.splat_f64s(factor), if alpha == 0 { &slopes[k] } else { &values[k] });
                for (sum, v) in harmonics[alpha][t].iter_mut().zip(source) {
                    *sum = simd.mul_add_e_f64s(factor, *v, *sum);
                }
            }
        }
    }

    /// Derivatives at an angle: the parts even and odd in theta of `F_x`, `F_rho` and `F_theta`.
    #[inline(always)]
    fn at_angle<S: Simd>(
        &self,
        simd: S,
        angle: &Angle,
        harmonics: &[&mut [[S::f64s; 3]]; 3],
    ) -> [[[S::f64s; 3]; 3]; 2] {
        let zero = simd.splat_f64s(0.0);
        let mut even = [harmonics[0][0], harmonics[1][0], [zero; 3]];
        let mut odd = [[zero; 3]; 3];
        let [(xc, xs), (rc, rs), (tc, ts)] = [0, 1, 2].map(|a| harmonics[a][1..].split_at(self.harmonics));
        let first = xc.iter().zip(xs).zip(rc.iter().zip(rs)).zip(tc.iter().zip(ts));
        for (wave, (((xc, xs), (rc, rs)), (tc, ts))) in angle.waves.iter().zip(first) {
            let [cos, sin, turned_cos, turned_sin] = splat4(simd, wave);
            for c in 0..3 {
                even[0][c] = simd.mul_add_e_f64s(cos, xc[c], even[0][c]);
                odd[0][c] = simd.mul_add_e_f64s(sin, xs[c], odd[0][c]);
                even[1][c] = simd.mul_add_e_f64s(cos, rc[c], even[1][c]);
                odd[1][c] = simd.mul_add_e_f64s(sin, rs[c], odd[1][c]);
                even[2][c] = simd.mul_add_e_f64s(turned_cos, ts[c], even[2][c]);
                odd[2][c] = simd.mul_add_e_f64s(turned_sin, tc[c], odd[2][c]);
            }
        }
        [even, odd]
    }

    /// From derivatives by rho and theta to those by y and z (ellipse); `side` is -1 at -theta.
    #[inline(always)]
    fn stretched<S: Simd>(&self, simd: S, angle: &Angle, side: f64, f: &mut [[S::f64s; 3]; 3]) {
        if self.round {
            return;
        }
        let [[a, b], [c, d]] = angle.stretch_at(side);
        let [a, b, c, d] = splat4(simd, &[a, b, c, d]);
        let m = [[a, b], [c, d]];
        for c in 0..3 {
            let (rho, theta) = (f[1][c], f[2][c]);
            f[1][c] = simd.mul_add_e_f64s(m[0][0], rho, simd.mul_f64s(m[0][1], theta));
            f[2][c] = simd.mul_add_e_f64s(m[1][0], rho, simd.mul_f64s(m[1][1], theta));
        }
    }

    /// The transpose of [`Self::stretched`], on forces.
    #[inline(always)]
    fn gathered<S: Simd>(&self, simd: S, angle: &Angle, side: f64, p: &mut [[S::f64s; 3]; 3]) {
        if self.round {
            return;
        }
        let [[a, b], [c, d]] = angle.stretch_at(side);
        let [a, b, c, d] = splat4(simd, &[a, b, c, d]);
        let m = [[a, b], [c, d]];
        for c in 0..3 {
            let (y, z) = (p[1][c], p[2][c]);
            p[1][c] = simd.mul_add_e_f64s(m[0][0], y, simd.mul_f64s(m[1][0], z));
            p[2][c] = simd.mul_add_e_f64s(m[0][1], y, simd.mul_f64s(m[1][1], z));
        }
    }
}

impl Angle {
    fn stretch_at(&self, side: f64) -> [[f64; 2]; 2] {
        let [[a, b], [c, d]] = self.stretch;
        [[a, side * b], [side * c, d]]
    }
}

/// Harmonics of a product of two, as harmonics p = 0 .. 2 h of cosines, then 1 .. 2 h of sines.
fn products(h: usize) -> Vec<Product> {
    let count = 2 * h + 1;
    let of = |t: usize| if t <= h { (t, false) } else { (t - h, true) };
    let sine = |p: isize, factor: f64| match p {
        0 => (0.0, 0),
        p => (factor * p.signum() as f64, 2 * h + p.unsigned_abs()),
    };
    let mut list = Vec::with_capacity(count * count);
    for t in 0..count {
        for u in 0..count {
            let ((m, a), (n, b)) = (of(t), of(u));
            let (sum, difference) = ((m + n) as isize, m as isize - n as isize);
            list.push(match (a, b) {
                (false, false) => [(0.5, difference.unsigned_abs()), (0.5, m + n)],
                (true, true) => [(0.5, difference.unsigned_abs()), (-0.5, m + n)],
                (true, false) => [sine(sum, 0.5), sine(difference, 0.5)],
                (false, true) => [sine(sum, 0.5), sine(-difference, 0.5)],
            });
        }
    }
    list
}

/// `count` floats that start on a cache line: registers as wide as one are loaded and stored at once.
#[inline(always)]
fn aligned(values: &mut Vec<f64>, count: usize) -> &mut [f64] {
    values.resize(count + LINE / size_of::<f64>(), 0.0);
    let offset = values.as_ptr().align_offset(LINE).min(LINE / size_of::<f64>());
    &mut values[offset..offset + count]
}

/// Harmonic and factor of the derivative of a harmonic by theta: `d cos m = -m sin m, d sin m = m cos m`.
fn turned(h: usize, t: usize) -> (usize, f64) {
    if t <= h { (h + t, -(t as f64)) } else { (t - h, (t - h) as f64) }
}

/// Takes `count` values of a type made of floats from the front of a pool.
#[inline(always)]
fn take<'a, T: Pod>(pool: &mut &'a mut [f64], count: usize) -> &'a mut [T] {
    let (front, rest) = std::mem::take(pool).split_at_mut(count * size_of::<T>() / size_of::<f64>());
    *pool = rest;
    cast_slice_mut(front)
}

// Closures are not compiled for the widest registers: what is done with registers is done in loops.

/// Four numbers, each in all lanes.
#[inline(always)]
fn splat4<S: Simd>(simd: S, v: &[f64; 4]) -> [S::f64s; 4] {
    [simd.splat_f64s(v[0]), simd.splat_f64s(v[1]), simd.splat_f64s(v[2]), simd.splat_f64s(v[3])]
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[S::f64s; 3], b: &[S::f64s; 3]) -> S::f64s {
    simd.mul_add_e_f64s(a[0], b[0], simd.mul_add_e_f64s(a[1], b[1], simd.mul_f64s(a[2], b[2])))
}

/// Rewrites the 45 moduli in the order of [`SPREAD`].
#[inline(always)]
fn spread<V: Copy>(m: &mut [V; PLACES]) {
    let old = *m;
    for i in 0..3 {
        for j in 0..3 {
            let e = 3 * i + j;
            m[SPREAD[1].2 + e] = old[MODULI[3] + e];
            m[SPREAD[2].2 + e] = old[MODULI[4] + e];
            m[SPREAD[3].2 + e] = old[MODULI[1] + SIX[i][j]];
            m[SPREAD[4].2 + e] = old[MODULI[2] + SIX[i][j]];
            m[SPREAD[5].2 + e] = old[MODULI[5] + e];
            m[SPREAD[6].2 + e] = old[MODULI[5] + 3 * j + i];
        }
    }
}

/// Twice the strains E, or the stresses for them, in the order of [`PAIRS`].
#[inline(always)]
fn double_strains<S: Simd>(simd: S, f: &[[S::f64s; 3]; 3]) -> [S::f64s; 6] {
    let one = simd.splat_f64s(1.0);
    let mut double = [one; 6];
    for (place, (a, b)) in PAIRS.into_iter().enumerate() {
        let product = dot(simd, &f[a], &f[b]);
        double[place] = if a == b { simd.sub_f64s(product, one) } else { product };
    }
    double
}

/// Stresses times a weight for twice the strains: `half_lambda` and `mu` are the law's constants times it.
#[inline(always)]
fn stresses<S: Simd>(simd: S, double: &[S::f64s; 6], half_lambda: S::f64s, mu: S::f64s) -> [S::f64s; 6] {
    let trace = simd.add_f64s(double[0], simd.add_f64s(double[1], double[2]));
    let pressure = simd.mul_f64s(half_lambda, trace);
    let mut s = [pressure; 6];
    for place in 0..6 {
        s[place] = if place < 3 {
            simd.mul_add_e_f64s(mu, double[place], pressure)
        } else {
            simd.mul_f64s(mu, double[place])
        };
    }
    s
}

struct Force<'a> {
    element: &'a RingElement,
    q: &'a [f64],
    velocity: Option<&'a [f64]>,
    force: &'a mut [f64],
    scratch: &'a mut RingScratch,
}

impl WithSimd for Force<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { element, q, velocity, force, scratch } = self;
        let (n, n_harmonics) = (element.n_vectors, element.n_harmonics());
        let mut pool = aligned(&mut scratch.values, S::F64_LANES * 3 * (6 * n + 9 * n_harmonics));
        let values = take::<[S::f64s; 3]>(&mut pool, n);
        let slopes = take::<[S::f64s; 3]>(&mut pool, n);
        let value_rates = take::<[S::f64s; 3]>(&mut pool, n);
        let slope_rates = take::<[S::f64s; 3]>(&mut pool, n);
        let on_values = take::<[S::f64s; 3]>(&mut pool, n);
        let on_slopes = take::<[S::f64s; 3]>(&mut pool, n);
        let mut parts = [(); 3].map(|()| take::<[S::f64s; 3]>(&mut pool, n_harmonics));
        let mut rates = [(); 3].map(|()| take::<[S::f64s; 3]>(&mut pool, n_harmonics));
        let mut sums = [(); 3].map(|()| take::<[S::f64s; 3]>(&mut pool, n_harmonics));
        let zero = simd.splat_f64s(0.0);
        let width = element.stations.padded / S::F64_LANES;
        let weighted = [&element.stations.weighted[0], &element.stations.weighted[1]];
        let [node_values, node_slopes] = weighted.map(|t| S::as_simd_f64s(t).0);
        let weights = S::as_simd_f64s(&element.stations.weights).0;
        let mut energy = 0.0;
        force.fill(0.0);
        for batch in 0..element.stations.count.div_ceil(S::F64_LANES) {
            element.collapse(simd, q, batch, values, slopes);
            if let Some(velocity) = velocity {
                element.collapse(simd, velocity, batch, value_rates, slope_rates);
            }
            on_values.fill([zero; 3]);
            on_slopes.fill([zero; 3]);
            let mut density = zero;
            for radius in &element.radii {
                element.harmonics(simd, radius, values, slopes, &mut parts);
                if velocity.is_some() {
                    element.harmonics(simd, radius, value_rates, slope_rates, &mut rates);
                }
                for list in sums.iter_mut() {
                    list.fill([zero; 3]);
                }
                let half_lambda = simd.splat_f64s(radius.weight * element.lambda / 2.0);
                let mu = simd.splat_f64s(radius.weight * element.mu);
                for angle in &element.angles {
                    let mut states = (element.at_angle(simd, angle, &parts), None);
                    if velocity.is_some() {
                        states.1 = Some(element.at_angle(simd, angle, &rates));
                    }
                    // forces of the point at theta and of that at -theta
                    let (first, work) = element.point(simd, angle, 1.0, &states, half_lambda, mu);
                    density = simd.add_f64s(density, work);
                    let mut forces = [first, [[zero; 3]; 3]];
                    if angle.both {
                        let (second, work) = element.point(simd, angle, -1.0, &states, half_lambda, mu);
                        density = simd.add_f64s(density, work);
                        forces[1] = second;
                    }
                    element.add_at_angle(simd, angle, &forces, &mut sums);
                }
                for k in 0..n {
                    let t = element.harmonic[k];
                    let value = simd.splat_f64s(radius.values[k]);
                    let slope = simd.splat_f64s(radius.slopes[k]);
                    let hoop = simd.splat_f64s(radius.hoops[k]);
                    for c in 0..3 {
                        on_slopes[k][c] = simd.mul_add_e_f64s(value, sums[0][t][c], on_slopes[k][c]);
                        let sum = simd.mul_add_e_f64s(slope, sums[1][t][c], on_values[k][c]);
                        on_values[k][c] = simd.mul_add_e_f64s(hoop, sums[2][t][c], sum);
                    }
                }
            }
            if velocity.is_none() {
                energy += 0.25 * simd.reduce_sum_f64s(simd.mul_f64s(weights[batch], density));
            }
            for (i, node) in force.chunks_exact_mut(3 * n).enumerate() {
                let (value, slope) = (node_values[i * width + batch], node_slopes[i * width + batch]);
                let pairs = on_slopes.iter().flatten().zip(on_values.iter().flatten());
                for (target, (a, b)) in node.iter_mut().zip(pairs) {
                    let sum = simd.mul_add_e_f64s(slope, *a, simd.mul_f64s(value, *b));
                    *target += simd.reduce_sum_f64s(sum);
                }
            }
        }
        energy
    }
}

/// `even + side odd`: the derivatives at theta or at -theta.
#[inline(always)]
fn mirrored<S: Simd>(
    simd: S,
    side: f64,
    even: &[[S::f64s; 3]; 3],
    odd: &[[S::f64s; 3]; 3],
) -> [[S::f64s; 3]; 3] {
    let mut f = *even;
    for a in 0..3 {
        for c in 0..3 {
            f[a][c] = if side > 0.0 {
                simd.add_f64s(even[a][c], odd[a][c])
            } else {
                simd.sub_f64s(even[a][c], odd[a][c])
            };
        }
    }
    f
}

/// Parts even and odd in theta of the derivatives at an angle, and of their rates.
type AtAngle<V> = ([[[V; 3]; 3]; 2], Option<[[[V; 3]; 3]; 2]>);

impl RingElement {
    /// Forces `P_a = sum_b S_ab F_b` of a point at theta (`side` 1) or -theta (-1) times its weight, and `S : 2 E`.
    #[inline(always)]
    fn point<S: Simd>(
        &self,
        simd: S,
        angle: &Angle,
        side: f64,
        ([even, odd], rate): &AtAngle<S::f64s>,
        half_lambda: S::f64s,
        mu: S::f64s,
    ) -> ([[S::f64s; 3]; 3], S::f64s) {
        let mut f = mirrored(simd, side, even, odd);
        self.stretched(simd, angle, side, &mut f);
        let mut double = double_strains(simd, &f);
        if let Some([even, odd]) = rate {
            let viscosity = simd.splat_f64s(self.viscosity);
            let mut g = mirrored(simd, side, even, odd);
            self.stretched(simd, angle, side, &mut g);
            for (double, (a, b)) in double.iter_mut().zip(PAIRS) {
                let rate = simd.add_f64s(dot(simd, &f[a], &g[b]), dot(simd, &g[a], &f[b]));
                *double = simd.mul_add_e_f64s(viscosity, rate, *double);
            }
        }
        let stress = stresses(simd, &double, half_lambda, mu);
        // off-diagonal terms twice
        let normal = dot(simd, &[stress[0], stress[1], stress[2]], &[double[0], double[1], double[2]]);
        let shear = dot(simd, &[stress[3], stress[4], stress[5]], &[double[3], double[4], double[5]]);
        let work = simd.add_f64s(normal, simd.add_f64s(shear, shear));
        let [xx, rr, tt, xr, xt, rt] = stress;
        let mut p = f;
        for (a, [x, r, t]) in [[xx, xr, xt], [xr, rr, rt], [xt, rt, tt]].into_iter().enumerate() {
            for c in 0..3 {
                let sum = simd.mul_add_e_f64s(r, f[1][c], simd.mul_f64s(x, f[0][c]));
                p[a][c] = simd.mul_add_e_f64s(t, f[2][c], sum);
            }
        }
        self.gathered(simd, angle, side, &mut p);
        (p, work)
    }

    /// The transpose of [`Self::at_angle`]: adds the forces at theta and -theta to those on harmonics.
    #[inline(always)]
    fn add_at_angle<S: Simd>(
        &self,
        simd: S,
        angle: &Angle,
        forces: &[[[S::f64s; 3]; 3]; 2],
        sums: &mut [&mut [[S::f64s; 3]]; 3],
    ) {
        let (mut even, mut odd) = (forces[0], forces[0]);
        for a in 0..3 {
            for c in 0..3 {
                even[a][c] = simd.add_f64s(forces[0][a][c], forces[1][a][c]);
                odd[a][c] = simd.sub_f64s(forces[0][a][c], forces[1][a][c]);
            }
        }
        for alpha in 0..2 {
            for c in 0..3 {
                sums[alpha][0][c] = simd.add_f64s(sums[alpha][0][c], even[alpha][c]);
            }
        }
        let [x, r, t] = sums;
        let [(xc, xs), (rc, rs), (tc, ts)] = [x, r, t].map(|list| list[1..].split_at_mut(self.harmonics));
        let first = xc.iter_mut().zip(xs).zip(rc.iter_mut().zip(rs)).zip(tc.iter_mut().zip(ts));
        for (wave, (((xc, xs), (rc, rs)), (tc, ts))) in angle.waves.iter().zip(first) {
            let [cos, sin, turned_cos, turned_sin] = splat4(simd, wave);
            for c in 0..3 {
                xc[c] = simd.mul_add_e_f64s(cos, even[0][c], xc[c]);
                xs[c] = simd.mul_add_e_f64s(sin, odd[0][c], xs[c]);
                rc[c] = simd.mul_add_e_f64s(cos, even[1][c], rc[c]);
                rs[c] = simd.mul_add_e_f64s(sin, odd[1][c], rs[c]);
                ts[c] = simd.mul_add_e_f64s(turned_cos, even[2][c], ts[c]);
                tc[c] = simd.mul_add_e_f64s(turned_sin, odd[2][c], tc[c]);
            }
        }
    }

    /// The 45 moduli `A_ab,ij = S_ab delta_ij + F_ic C_acbd F_jd` at a point times its weight.
    #[inline(always)]
    fn moduli<S: Simd>(
        &self,
        simd: S,
        f: &[[S::f64s; 3]; 3],
        weight: f64,
        geometric: bool,
        moduli: &mut [S::f64s],
    ) {
        let zero = simd.splat_f64s(0.0);
        let lambda = simd.splat_f64s(weight * self.lambda);
        let half_lambda = simd.splat_f64s(weight * self.lambda / 2.0);
        let mu = simd.splat_f64s(weight * self.mu);
        let stress = match geometric {
            true => stresses(simd, &double_strains(simd, f), half_lambda, mu),
            false => [zero; 6],
        };
        let mut outer = [zero; 6];
        for (outer, (i, j)) in outer.iter_mut().zip(PAIRS) {
            let sum = simd.mul_add_e_f64s(f[0][i], f[0][j], simd.mul_f64s(f[1][i], f[1][j]));
            *outer = simd.mul_f64s(mu, simd.mul_add_e_f64s(f[2][i], f[2][j], sum));
        }
        let both = simd.add_f64s(lambda, mu);
        for a in 0..3 {
            for (place, (i, j)) in PAIRS.into_iter().enumerate() {
                let product = simd.mul_f64s(f[a][i], f[a][j]);
                let mut value = simd.mul_add_e_f64s(both, product, outer[place]);
                if i == j {
                    value = simd.add_f64s(value, stress[a]);
                }
                moduli[MODULI[a] + place] = value;
            }
        }
        for place in 3..6 {
            let (a, b) = PAIRS[place];
            for i in 0..3 {
                for j in 0..3 {
                    let first = simd.mul_f64s(lambda, simd.mul_f64s(f[a][i], f[b][j]));
                    let mut value = simd.mul_add_e_f64s(mu, simd.mul_f64s(f[b][i], f[a][j]), first);
                    if i == j {
                        value = simd.add_f64s(value, stress[place]);
                    }
                    moduli[MODULI[place] + 3 * i + j] = value;
                }
            }
        }
    }

    /// Moduli by y and z turned into those by rho and theta (ellipse): `A_rho,theta = sum m_a,rho A_ab m_b,theta`.
    #[inline(always)]
    fn gathered_moduli<S: Simd>(&self, simd: S, angle: &Angle, side: f64, moduli: &mut [S::f64s]) {
        if self.round {
            return;
        }
        let [[a, b], [c, d]] = angle.stretch_at(side);
        let [a, b, c, d] = splat4(simd, &[a, b, c, d]);
        let m = [[a, b], [c, d]];
        for e in 0..9 {
            let (y, z) = (moduli[MODULI[3] + e], moduli[MODULI[4] + e]);
            moduli[MODULI[3] + e] = simd.mul_add_e_f64s(m[0][0], y, simd.mul_f64s(m[1][0], z));
            moduli[MODULI[4] + e] = simd.mul_add_e_f64s(m[0][1], y, simd.mul_f64s(m[1][1], z));
        }
        let zero = simd.splat_f64s(0.0);
        let mut full = [[[zero; 9]; 2]; 2];
        for i in 0..3 {
            for j in 0..3 {
                let e = 3 * i + j;
                full[0][0][e] = moduli[MODULI[1] + SIX[i][j]];
                full[1][1][e] = moduli[MODULI[2] + SIX[i][j]];
                full[0][1][e] = moduli[MODULI[5] + e];
                full[1][0][e] = moduli[MODULI[5] + 3 * j + i];
            }
        }
        for (place, left, right) in [(1, 0, 0), (2, 1, 1), (5, 0, 1)] {
            for e in 0..9 {
                let (i, j) = (e / 3, e % 3);
                if place < 5 && i > j {
                    continue;
                }
                let mut sum = zero;
                for a in 0..2 {
                    for b in 0..2 {
                        let factor = simd.mul_f64s(m[a][left], m[b][right]);
                        sum = simd.mul_add_e_f64s(factor, full[a][b][e], sum);
                    }
                }
                moduli[MODULI[place] + if place < 5 { SIX[i][j] } else { e }] = sum;
            }
        }
    }

    /// Entries of the section's matrix: six or nine for each pair of vectors (k, l), of the slopes along x with each
    /// other (k <= l), of slopes with values, and of values with each other (k <= l).
    fn entries(&self) -> [usize; 3] {
        let n = self.n_vectors;
        [6 * n * (n + 1) / 2, 9 * n * n, 9 * n * (n + 1) / 2]
    }

    /// The section's matrix at every station, `[entry][station]`.
    #[inline(always)]
    fn section_matrix<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        geometric: bool,
        mut pool: &mut [f64],
        at_stations: &mut [f64],
    ) {
        let (n, n_harmonics, h) = (self.n_vectors, self.n_harmonics(), self.harmonics);
        let waves = 4 * h + 1;
        let values = take::<[S::f64s; 3]>(&mut pool, n);
        let slopes = take::<[S::f64s; 3]>(&mut pool, n);
        let mut parts = [(); 3].map(|()| take::<[S::f64s; 3]>(&mut pool, n_harmonics));
        let spectrum = take::<[S::f64s; PLACES]>(&mut pool, waves);
        let sides = take::<[S::f64s; PLACES]>(&mut pool, 2);
        let entries = self.entries();
        let matrix = take::<S::f64s>(&mut pool, entries.iter().sum());
        let zero = simd.splat_f64s(0.0);
        let width = self.stations.padded / S::F64_LANES;
        let stations = S::as_mut_simd_f64s(at_stations).0;
        for batch in 0..self.stations.count.div_ceil(S::F64_LANES) {
            self.collapse(simd, q, batch, values, slopes);
            matrix.fill(zero);
            for radius in &self.radii {
                self.harmonics(simd, radius, values, slopes, &mut parts);
                spectrum.fill([zero; PLACES]);
                for angle in &self.angles {
                    let [even, odd] = self.at_angle(simd, angle, &parts);
                    sides[1] = [zero; PLACES];
                    for (side, moduli) in [1.0, -1.0].into_iter().zip(sides.iter_mut()) {
                        if side < 0.0 && !angle.both {
                            continue;
                        }
                        let mut f = mirrored(simd, side, &even, &odd);
                        self.stretched(simd, angle, side, &mut f);
                        self.moduli(simd, &f, radius.weight, geometric, &mut moduli[..]);
                        self.gathered_moduli(simd, angle, side, &mut moduli[..]);
                    }
                    let [even, odd] = sides else { continue };
                    for (even, odd) in even.iter_mut().zip(odd.iter_mut()) {
                        (*even, *odd) = (simd.add_f64s(*even, *odd), simd.sub_f64s(*even, *odd));
                    }
                    for (p, (factor, sums)) in angle.moduli.iter().zip(spectrum.iter_mut()).enumerate() {
                        let (factor, side) =
                            (simd.splat_f64s(*factor), if p <= 2 * h { &*even } else { &*odd });
                        for (sum, value) in sums[..MODULI[6]].iter_mut().zip(&side[..MODULI[6]]) {
                            *sum = simd.mul_add_e_f64s(factor, *value, *sum);
                        }
                    }
                }
                for moduli in spectrum.iter_mut() {
                    spread(moduli);
                }
                self.add_radius(simd, radius, spectrum, matrix);
            }
            for (entry, value) in matrix.iter().enumerate() {
                stations[entry * width + batch] = *value;
            }
        }
    }

    /// Adds a radius to the section's matrix: integrals of the moduli times two harmonics (or their derivatives by
    /// theta) around the section, times the radial factors of all vectors with these harmonics.
    #[inline(always)]
    fn add_radius<S: Simd>(
        &self,
        simd: S,
        radius: &Radius,
        spectrum: &[[S::f64s; PLACES]],
        matrix: &mut [S::f64s],
    ) {
        let (n, count, h) = (self.n_vectors, self.n_harmonics(), self.harmonics);
        let entries = self.entries();
        let (xx, rest) = matrix.split_at_mut(entries[0]);
        let (xv, vv) = rest.split_at_mut(entries[1]);
        let mut product = [simd.splat_f64s(0.0); PLACES];
        for t in 0..count {
            for u in 0..count {
                for (place, (a, b, start)) in SPREAD.into_iter().enumerate() {
                    let range = start..start + if place == 0 { 6 } else { 9 };
                    // the constant has no derivative
                    if (a == 2 && t == 0) || (b == 2 && u == 0) {
                        product[range].fill(simd.splat_f64s(0.0));
                        continue;
                    }
                    let (t, f) = if a == 2 { turned(h, t) } else { (t, 1.0) };
                    let (u, g) = if b == 2 { turned(h, u) } else { (u, 1.0) };
                    let [(x, p), (y, r)] = self.products[t * count + u];
                    let (x, y) = (simd.splat_f64s(f * g * x), simd.splat_f64s(f * g * y));
                    let (left, right) = (&spectrum[p][range.clone()], &spectrum[r][range.clone()]);
                    for (target, (left, right)) in product[range].iter_mut().zip(left.iter().zip(right)) {
                        *target = simd.mul_add_e_f64s(x, *left, simd.mul_f64s(y, *right));
                    }
                }
                for &k in &self.with_harmonic[t] {
                    for &l in &self.with_harmonic[u] {
                        let by_rho = simd.splat_f64s(radius.values[k] * radius.slopes[l]);
                        let by_theta = simd.splat_f64s(radius.values[k] * radius.hoops[l]);
                        let target = xv[9 * (k * n + l)..9 * (k * n + l) + 9].iter_mut();
                        for (sum, (rho, theta)) in target.zip(product[6..15].iter().zip(&product[15..24])) {
                            let first = simd.mul_add_e_f64s(by_rho, *rho, *sum);
                            *sum = simd.mul_add_e_f64s(by_theta, *theta, first);
                        }
                        if k > l {
                            continue;
                        }
                        let pair = k * (2 * n + 1 - k) / 2 + l - k;
                        let value = simd.splat_f64s(radius.values[k] * radius.values[l]);
                        for (sum, xx) in xx[6 * pair..6 * pair + 6].iter_mut().zip(&product[..6]) {
                            *sum = simd.mul_add_e_f64s(value, *xx, *sum);
                        }
                        let factors = [
                            radius.slopes[k] * radius.slopes[l],
                            radius.hoops[k] * radius.hoops[l],
                            radius.slopes[k] * radius.hoops[l],
                            radius.hoops[k] * radius.slopes[l],
                        ];
                        let [rr, tt, rt, tr] = splat4(simd, &factors);
                        let normal = product[24..33].iter().zip(&product[33..42]);
                        let mixed = product[42..51].iter().zip(&product[51..60]);
                        let target = vv[9 * pair..9 * pair + 9].iter_mut();
                        for (sum, ((a, b), (c, d))) in target.zip(normal.zip(mixed)) {
                            let first = simd.mul_add_e_f64s(tt, *b, simd.mul_add_e_f64s(rr, *a, *sum));
                            *sum = simd.mul_add_e_f64s(tr, *d, simd.mul_add_e_f64s(rt, *c, first));
                        }
                    }
                }
            }
        }
    }

    /// Expands the section's matrix to the nodes and writes both triangles.
    #[inline(always)]
    fn expand<S: Simd>(&self, simd: S, at_stations: &[f64], tangent: &mut [f64]) {
        let (n, size, padded) = (self.n_vectors, self.size(), self.stations.padded);
        let vectors = NODE_PAIRS / S::F64_LANES;
        let entries = self.entries();
        let (xx, xv, vv) = (0, entries[0], entries[0] + entries[1]);
        let tables = [0, 1, 2, 3].map(|p| S::as_simd_f64s(&self.stations.pairs[p]).0);
        let count = self.stations.count;
        // for L_i' L_j', L_i' L_j, L_i L_j' and L_i L_j the nine components at every station
        let mut moments = vec![[0.0; 9]; 4 * count];
        let mut values = [[0.0; NODE_PAIRS]; 9];
        let mut pair = 0;
        for k in 0..n {
            for l in k..n {
                for i in 0..3 {
                    for j in 0..3 {
                        let entries = [
                            xx + 6 * pair + SIX[i][j],
                            xv + 9 * (k * n + l) + 3 * i + j,
                            xv + 9 * (l * n + k) + 3 * j + i,
                            vv + 9 * pair + 3 * i + j,
                        ];
                        for (entry, moments) in entries.into_iter().zip(moments.chunks_exact_mut(count)) {
                            let row = &at_stations[entry * padded..entry * padded + count];
                            for (moment, value) in moments.iter_mut().zip(row) {
                                moment[3 * i + j] = *value;
                            }
                        }
                    }
                }
                for start in (0..vectors).step_by(2) {
                    let mut sums = [[simd.splat_f64s(0.0); 2]; 9];
                    for (p, moments) in moments.chunks_exact(count).enumerate() {
                        for (moment, table) in moments.iter().zip(tables[3 - p].chunks_exact(vectors)) {
                            let (x, y) = (table[start], table[start + 1]);
                            for e in 0..9 {
                                let moment = simd.splat_f64s(moment[e]);
                                sums[e][0] = simd.mul_add_e_f64s(moment, x, sums[e][0]);
                                sums[e][1] = simd.mul_add_e_f64s(moment, y, sums[e][1]);
                            }
                        }
                    }
                    for (values, sums) in values.iter_mut().zip(&sums) {
                        S::as_mut_simd_f64s(values).0[start..start + 2].copy_from_slice(sums);
                    }
                }
                if k == l {
                    // symmetric to the last digit
                    for (i, j) in [(1, 0), (2, 0), (2, 1)] {
                        for at in 0..NODE_PAIRS {
                            values[3 * i + j][at] = values[3 * j + i][4 * (at % 4) + at / 4];
                        }
                    }
                }
                for node in 0..self.n_nodes {
                    for other in 0..self.n_nodes {
                        let (a, b, at) = (3 * (node * n + k), 3 * (other * n + l), 4 * node + other);
                        for j in 0..3 {
                            let target = &mut tangent[(b + j) * size + a..(b + j) * size + a + 3];
                            target.copy_from_slice(&[values[j][at], values[3 + j][at], values[6 + j][at]]);
                        }
                        for i in 0..3 {
                            let target = &mut tangent[(a + i) * size + b..(a + i) * size + b + 3];
                            let row = &values[3 * i..3 * i + 3];
                            target.copy_from_slice(&[row[0][at], row[1][at], row[2][at]]);
                        }
                    }
                }
                pair += 1;
            }
        }
    }
}

struct Tangent<'a> {
    element: &'a RingElement,
    q: &'a [f64],
    geometric: bool,
    tangent: &'a mut [f64],
    scratch: &'a mut RingScratch,
}

impl WithSimd for Tangent<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { element, q, geometric, tangent, scratch } = self;
        let (n, n_harmonics) = (element.n_vectors, element.n_harmonics());
        let entries: usize = element.entries().iter().sum();
        let points = 6 * n + 9 * n_harmonics + PLACES * (4 * element.harmonics + 3);
        let count = S::F64_LANES * (points + entries) + entries * element.stations.padded;
        let (at_stations, pool) =
            aligned(&mut scratch.values, count).split_at_mut(entries * element.stations.padded);
        element.section_matrix(simd, q, geometric, pool, at_stations);
        element.expand(simd, at_stations, tangent);
    }
}
