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
//! the section's matrix, then the nodes once. Equal angles are exact; Gauss points across the wall leave 1e-10 of the
//! terms in 1/r. Stations lie side by side in SIMD lanes. Source: docs/theory.md section 9.

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
const WALL_ERROR: f64 = 1e-10;
/// The pairs of directions x, rho, theta: xx, rho rho, theta theta, x rho, x theta, rho theta.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Place of component ij among the six of a symmetric tensor, in the order of [`PAIRS`].
const SIX: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];
/// First entry of each pair's moduli among the 45: six of a symmetric pair, nine of the others.
const MODULI: [usize; 7] = [0, 6, 12, 18, 27, 36, 45];
/// The 45 moduli, padded.
const PLACES: usize = 48;

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
    /// `cos m theta`, m = 0 .. 2 h, and `sin m theta`.
    cos: Vec<f64>,
    sin: Vec<f64>,
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
        let n_angles = if round { 4 * harmonics + 2 } else { 4 * harmonics + 6 };
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
        let angles = (0..=n_angles / 2)
            .map(|j| {
                let theta = 2.0 * PI * j as f64 / n_angles as f64;
                let (sin, cos) = theta.sin_cos();
                Angle {
                    both: j > 0 && 2 * j < n_angles,
                    cos: (0..=2 * harmonics).map(|m| (m as f64 * theta).cos()).collect(),
                    sin: (0..=2 * harmonics).map(|m| (m as f64 * theta).sin()).collect(),
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
            harmonic: list.iter().map(|f| if f.sine { harmonics + f.waves } else { f.waves }).collect(),
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
        let (h, zero) = (self.harmonics, simd.splat_f64s(0.0));
        let mut even = [harmonics[0][0], harmonics[1][0], [zero; 3]];
        let mut odd = [[zero; 3]; 3];
        for m in 1..=h {
            let (cos, sin) = (simd.splat_f64s(angle.cos[m]), simd.splat_f64s(angle.sin[m]));
            let number = m as f64;
            let turned = [simd.splat_f64s(number * angle.cos[m]), simd.splat_f64s(-number * angle.sin[m])];
            for c in 0..3 {
                for alpha in 0..2 {
                    even[alpha][c] = simd.mul_add_e_f64s(cos, harmonics[alpha][m][c], even[alpha][c]);
                    odd[alpha][c] = simd.mul_add_e_f64s(sin, harmonics[alpha][h + m][c], odd[alpha][c]);
                }
                even[2][c] = simd.mul_add_e_f64s(turned[0], harmonics[2][h + m][c], even[2][c]);
                odd[2][c] = simd.mul_add_e_f64s(turned[1], harmonics[2][m][c], odd[2][c]);
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
        let m = angle.stretch_at(side).map(|row| row.map(|v| simd.splat_f64s(v)));
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
        let m = angle.stretch_at(side).map(|row| row.map(|v| simd.splat_f64s(v)));
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

/// Takes `count` values of a type made of floats from the front of a pool.
#[inline(always)]
fn take<'a, T: Pod>(pool: &mut &'a mut [f64], count: usize) -> &'a mut [T] {
    let (front, rest) = std::mem::take(pool).split_at_mut(count * size_of::<T>() / size_of::<f64>());
    *pool = rest;
    cast_slice_mut(front)
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[S::f64s; 3], b: &[S::f64s; 3]) -> S::f64s {
    simd.mul_add_e_f64s(a[0], b[0], simd.mul_add_e_f64s(a[1], b[1], simd.mul_f64s(a[2], b[2])))
}

/// Twice the strains E, or the stresses for them, in the order of [`PAIRS`].
#[inline(always)]
fn double_strains<S: Simd>(simd: S, f: &[[S::f64s; 3]; 3]) -> [S::f64s; 6] {
    let one = simd.splat_f64s(1.0);
    PAIRS.map(|(a, b)| {
        let product = dot(simd, &f[a], &f[b]);
        if a == b { simd.sub_f64s(product, one) } else { product }
    })
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
        scratch.values.resize(S::F64_LANES * 3 * (6 * n + 9 * n_harmonics), 0.0);
        let mut pool = &mut scratch.values[..];
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
        let viscosity = simd.splat_f64s(element.viscosity);
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
                    let [even, odd] = element.at_angle(simd, angle, &parts);
                    let rate = velocity.map(|_| element.at_angle(simd, angle, &rates));
                    // forces of the point at theta and of that at -theta
                    let mut forces = [[[zero; 3]; 3]; 2];
                    for (side, p) in [1.0, -1.0].into_iter().zip(&mut forces) {
                        if side < 0.0 && !angle.both {
                            continue;
                        }
                        let sign = simd.splat_f64s(side);
                        let mut f = mirrored(simd, sign, &even, &odd);
                        element.stretched(simd, angle, side, &mut f);
                        let mut double = double_strains(simd, &f);
                        if let Some([even, odd]) = &rate {
                            let mut g = mirrored(simd, sign, even, odd);
                            element.stretched(simd, angle, side, &mut g);
                            for (double, (a, b)) in double.iter_mut().zip(PAIRS) {
                                let rate = simd.add_f64s(dot(simd, &f[a], &g[b]), dot(simd, &g[a], &f[b]));
                                *double = simd.mul_add_e_f64s(viscosity, rate, *double);
                            }
                        }
                        let stress = stresses(simd, &double, half_lambda, mu);
                        // S : 2E, off-diagonal terms twice
                        let normal =
                            dot(simd, &[stress[0], stress[1], stress[2]], &[double[0], double[1], double[2]]);
                        let shear =
                            dot(simd, &[stress[3], stress[4], stress[5]], &[double[3], double[4], double[5]]);
                        density = simd.add_f64s(density, simd.add_f64s(normal, simd.add_f64s(shear, shear)));
                        for a in 0..3 {
                            for c in 0..3 {
                                let mut sum = simd.mul_f64s(stress[SIX[a][0]], f[0][c]);
                                sum = simd.mul_add_e_f64s(stress[SIX[a][1]], f[1][c], sum);
                                p[a][c] = simd.mul_add_e_f64s(stress[SIX[a][2]], f[2][c], sum);
                            }
                        }
                        element.gathered(simd, angle, side, p);
                    }
                    element.add_at_angle(simd, angle, &forces, &mut sums);
                }
                for k in 0..n {
                    let t = element.harmonic[k];
                    let value = simd.splat_f64s(radius.values[k]);
                    let [slope, hoop] = [radius.slopes[k], radius.hoops[k]].map(|v| simd.splat_f64s(v));
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
    side: S::f64s,
    even: &[[S::f64s; 3]; 3],
    odd: &[[S::f64s; 3]; 3],
) -> [[S::f64s; 3]; 3] {
    let mut f = *even;
    for a in 0..3 {
        for c in 0..3 {
            f[a][c] = simd.mul_add_e_f64s(side, odd[a][c], even[a][c]);
        }
    }
    f
}

impl RingElement {
    /// The transpose of [`Self::at_angle`]: adds the forces at theta and -theta to those on harmonics.
    #[inline(always)]
    fn add_at_angle<S: Simd>(
        &self,
        simd: S,
        angle: &Angle,
        forces: &[[[S::f64s; 3]; 3]; 2],
        sums: &mut [&mut [[S::f64s; 3]]; 3],
    ) {
        let h = self.harmonics;
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
        for m in 1..=h {
            let (cos, sin) = (simd.splat_f64s(angle.cos[m]), simd.splat_f64s(angle.sin[m]));
            let number = m as f64;
            let turned = [simd.splat_f64s(number * angle.cos[m]), simd.splat_f64s(-number * angle.sin[m])];
            for c in 0..3 {
                for alpha in 0..2 {
                    sums[alpha][m][c] = simd.mul_add_e_f64s(cos, even[alpha][c], sums[alpha][m][c]);
                    sums[alpha][h + m][c] = simd.mul_add_e_f64s(sin, odd[alpha][c], sums[alpha][h + m][c]);
                }
                sums[2][h + m][c] = simd.mul_add_e_f64s(turned[0], even[2][c], sums[2][h + m][c]);
                sums[2][m][c] = simd.mul_add_e_f64s(turned[1], odd[2][c], sums[2][m][c]);
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
        let m = angle.stretch_at(side).map(|row| row.map(|v| simd.splat_f64s(v)));
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
        let turned = |left: usize, right: usize, e: usize| {
            let mut sum = zero;
            for a in 0..2 {
                for b in 0..2 {
                    let factor = simd.mul_f64s(m[a][left], m[b][right]);
                    sum = simd.mul_add_e_f64s(factor, full[a][b][e], sum);
                }
            }
            sum
        };
        for (place, (i, j)) in PAIRS.into_iter().enumerate() {
            moduli[MODULI[1] + place] = turned(0, 0, 3 * i + j);
            moduli[MODULI[2] + place] = turned(1, 1, 3 * i + j);
        }
        for e in 0..9 {
            moduli[MODULI[5] + e] = turned(0, 1, e);
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
        let products = take::<[S::f64s; PLACES]>(&mut pool, n_harmonics * n_harmonics);
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
                        let mut f = mirrored(simd, simd.splat_f64s(side), &even, &odd);
                        self.stretched(simd, angle, side, &mut f);
                        self.moduli(simd, &f, radius.weight, geometric, &mut moduli[..]);
                        self.gathered_moduli(simd, angle, side, &mut moduli[..]);
                    }
                    for e in 0..MODULI[6] {
                        let (a, b) = (sides[0][e], sides[1][e]);
                        (sides[0][e], sides[1][e]) = (simd.add_f64s(a, b), simd.sub_f64s(a, b));
                    }
                    for p in 0..=2 * h {
                        let factor = simd.splat_f64s(angle.cos[p]);
                        for (sum, even) in spectrum[p].iter_mut().zip(&sides[0]) {
                            *sum = simd.mul_add_e_f64s(factor, *even, *sum);
                        }
                    }
                    for p in 1..=2 * h {
                        let factor = simd.splat_f64s(angle.sin[p]);
                        for (sum, odd) in spectrum[2 * h + p].iter_mut().zip(&sides[1]) {
                            *sum = simd.mul_add_e_f64s(factor, *odd, *sum);
                        }
                    }
                }
                self.products_of_harmonics(simd, spectrum, products);
                self.add_radius(simd, radius, products, matrix);
            }
            for (entry, value) in matrix.iter().enumerate() {
                stations[entry * width + batch] = *value;
            }
        }
    }

    /// Integrals of the moduli times two harmonics (or their derivatives by theta) around the section.
    #[inline(always)]
    fn products_of_harmonics<S: Simd>(
        &self,
        simd: S,
        spectrum: &[[S::f64s; PLACES]],
        products: &mut [[S::f64s; PLACES]],
    ) {
        let (count, h) = (self.n_harmonics(), self.harmonics);
        // d cos m = -m sin m, d sin m = m cos m
        let turned = |t: usize| if t <= h { (h + t, -(t as f64)) } else { (t - h, (t - h) as f64) };
        for t in 0..count {
            for u in 0..count {
                let target = &mut products[t * count + u];
                for place in 0..6 {
                    let (a, b) = PAIRS[place];
                    let (range, zero) = (MODULI[place]..MODULI[place + 1], simd.splat_f64s(0.0));
                    // the constant has no derivative
                    if (a == 2 && t == 0) || (b == 2 && u == 0) {
                        target[range].fill(zero);
                        continue;
                    }
                    let ((t, f), (u, g)) = (
                        if a == 2 { turned(t) } else { (t, 1.0) },
                        if b == 2 { turned(u) } else { (u, 1.0) },
                    );
                    let [(x, p), (y, r)] = self.products[t * count + u];
                    let (x, y) = (simd.splat_f64s(f * g * x), simd.splat_f64s(f * g * y));
                    for e in range {
                        target[e] = simd.mul_add_e_f64s(x, spectrum[p][e], simd.mul_f64s(y, spectrum[r][e]));
                    }
                }
            }
        }
    }

    /// Adds a radius to the section's matrix.
    #[inline(always)]
    fn add_radius<S: Simd>(
        &self,
        simd: S,
        radius: &Radius,
        products: &[[S::f64s; PLACES]],
        matrix: &mut [S::f64s],
    ) {
        let (n, count) = (self.n_vectors, self.n_harmonics());
        let entries = self.entries();
        let (xx, rest) = matrix.split_at_mut(entries[0]);
        let (xv, vv) = rest.split_at_mut(entries[1]);
        let mut pair = 0;
        for k in 0..n {
            let (t, vk) = (self.harmonic[k], radius.values[k]);
            for l in 0..n {
                let product = &products[t * count + self.harmonic[l]];
                let [by_rho, by_theta] =
                    [vk * radius.slopes[l], vk * radius.hoops[l]].map(|v| simd.splat_f64s(v));
                let target = &mut xv[9 * (k * n + l)..9 * (k * n + l) + 9];
                for (e, sum) in target.iter_mut().enumerate() {
                    *sum = simd.mul_add_e_f64s(by_rho, product[MODULI[3] + e], *sum);
                    *sum = simd.mul_add_e_f64s(by_theta, product[MODULI[4] + e], *sum);
                }
            }
            for l in k..n {
                let u = self.harmonic[l];
                let (product, exchanged) = (&products[t * count + u], &products[u * count + t]);
                let value = simd.splat_f64s(vk * radius.values[l]);
                for (e, sum) in xx[6 * pair..6 * pair + 6].iter_mut().enumerate() {
                    *sum = simd.mul_add_e_f64s(value, product[MODULI[0] + e], *sum);
                }
                let factors = [
                    radius.slopes[k] * radius.slopes[l],
                    radius.hoops[k] * radius.hoops[l],
                    radius.slopes[k] * radius.hoops[l],
                    radius.hoops[k] * radius.slopes[l],
                ];
                let [rr, tt, rt, tr] = factors.map(|v| simd.splat_f64s(v));
                let target = &mut vv[9 * pair..9 * pair + 9];
                for i in 0..3 {
                    for j in 0..3 {
                        let mut sum = target[3 * i + j];
                        sum = simd.mul_add_e_f64s(rr, product[MODULI[1] + SIX[i][j]], sum);
                        sum = simd.mul_add_e_f64s(tt, product[MODULI[2] + SIX[i][j]], sum);
                        sum = simd.mul_add_e_f64s(rt, product[MODULI[5] + 3 * i + j], sum);
                        target[3 * i + j] = simd.mul_add_e_f64s(tr, exchanged[MODULI[5] + 3 * j + i], sum);
                    }
                }
                pair += 1;
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
        let row = |entry: usize| &at_stations[entry * padded..entry * padded + self.stations.count];
        let mut values = [0.0; NODE_PAIRS];
        let mut pair = 0;
        for k in 0..n {
            for l in k..n {
                for i in 0..3 {
                    for j in 0..3 {
                        // factors L_i' L_j', L_i' L_j, L_i L_j', L_i L_j
                        let rows = [
                            row(xx + 6 * pair + SIX[i][j]),
                            row(xv + 9 * (k * n + l) + 3 * i + j),
                            row(xv + 9 * (l * n + k) + 3 * j + i),
                            row(vv + 9 * pair + 3 * i + j),
                        ];
                        for v in 0..vectors {
                            let mut sums = [simd.splat_f64s(0.0); 2];
                            for s in 0..self.stations.count {
                                for (p, row) in rows.iter().enumerate() {
                                    let table = tables[3 - p][s * vectors + v];
                                    let moment = simd.splat_f64s(row[s]);
                                    sums[p % 2] = simd.mul_add_e_f64s(moment, table, sums[p % 2]);
                                }
                            }
                            S::as_mut_simd_f64s(&mut values).0[v] = simd.add_f64s(sums[0], sums[1]);
                        }
                        for node in 0..self.n_nodes {
                            for other in 0..self.n_nodes {
                                let (a, b) = (3 * (node * n + k) + i, 3 * (other * n + l) + j);
                                let value = values[4 * node + other];
                                tangent[b * size + a] = value;
                                tangent[a * size + b] = value;
                            }
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
        let points =
            6 * n + 9 * n_harmonics + PLACES * (4 * element.harmonics + 3 + n_harmonics * n_harmonics);
        scratch.values.resize(S::F64_LANES * (points + entries) + entries * element.stations.padded, 0.0);
        let (at_stations, pool) = scratch.values.split_at_mut(entries * element.stations.padded);
        element.section_matrix(simd, q, geometric, pool, at_stations);
        element.expand(simd, at_stations, tangent);
    }
}
