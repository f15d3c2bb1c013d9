//! Internal force and tangent of the continuum members 34X1 .. 34X5 and of 3333c, without section points.
//!
//! At an axial station the three columns of the deformation gradient are polynomials in the section,
//! `F_alpha = sum_e F_alpha[e] eta^a zeta^b`, hence so are `E = (F^T F - I)/2`, `S = C : E` and every integrand.
//! With the section moments `H[g,h] = int g h dA` of monomials g, h:
//!
//! ```text
//!     T_ab[g]     = int g S_ab dA                 P_a[e]       = sum_b sum_f T_ab[e+f] F_b[f]
//!     A_ab,ij[g]  = int g (S_ab delta_ij + F_ic C_acbd F_jd) dA
//! ```
//!
//! give force and tangent by look-ups. A section rule with points only replaces H. Stations lie side by
//! side in SIMD lanes. Source: derived in docs/theory.md section 3.

use super::basis::{derivative, evaluate, lagrange};
use super::continuum::{lame, shear_correction};
use super::quadrature::{gauss, section_rule};
use crate::model::{ElementKind, Law, Material, Quadrature};
use crate::section::Section;
use crate::vectors::exponents;
use nalgebra::Matrix3;
use pulp::bytemuck::{Pod, cast_slice, cast_slice_mut};
use pulp::{Arch, Simd, WithSimd};

/// Stations are padded to a multiple of the widest SIMD register.
const LANES: usize = 8;
/// Pairs of nodes of an element, padded: 4 x 4.
const NODE_PAIRS: usize = 16;
/// The pairs of directions with their place in lists of six: xx yy zz xy xz yz.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Elastic law `S_aa = sum_b normal_ab E_bb`, `S_ab = 2 shear E_ab`, and what acts on the axis only.
#[derive(Debug, Clone, Copy)]
struct StressLaw {
    normal: [[f64; 3]; 3],
    /// xy, xz, yz.
    shear: [f64; 3],
    /// Poisson coupling of 3333c, on the axis times the area.
    on_axis: Option<[[f64; 3]; 3]>,
}

impl StressLaw {
    fn new(law: Law, section: &Section, material: &Material) -> Self {
        let (lambda, mu) = lame(material);
        let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
        let normal = |diagonal: f64, other: f64| {
            [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { diagonal } else { other }))
        };
        if law == Law::Continuum {
            return Self { normal: normal(lambda + 2.0 * mu, lambda), shear: [mu; 3], on_axis: None };
        }
        let ks = shear_correction(section, nu);
        Self {
            normal: normal(e, 0.0),
            shear: [ks * mu, ks * mu, mu],
            on_axis: Some(normal(2.0 * nu * lambda, lambda)),
        }
    }
}

/// Second Piola-Kirchhoff stress (Pa) for a Green-Lagrange strain. Of 3333c the part that acts over the volume; its
/// Poisson coupling belongs to the axis alone. The energy of 3333s knows no stress of points: what is given are its
/// own moduli, E for each normal strain alone, ks G across the section and G in it.
pub fn stress_at(law: Law, section: &Section, material: &Material, strain: &Matrix3<f64>) -> Matrix3<f64> {
    let law = StressLaw::new(law, section, material);
    Matrix3::from_fn(|i, j| {
        if i == j {
            (0..3).map(|k| law.normal[i][k] * strain[(k, k)]).sum()
        } else {
            2.0 * law.shear[place(i, j) - 3] * strain[(i, j)]
        }
    })
}

/// Pairs of monomials by the monomial they multiply to.
#[derive(Debug, Clone)]
struct Products {
    starts: Vec<usize>,
    pairs: Vec<(u16, u16)>,
}

impl Products {
    /// All pairs of the first `left` and first `right` monomials; `index[e][f]` is that of their product.
    fn new(left: usize, right: usize, index: &[Vec<usize>]) -> Self {
        let targets = 1 + (0..left).flat_map(|e| index[e][..right].iter()).max().copied().unwrap_or(0);
        let (mut starts, mut pairs) = (vec![0], Vec::new());
        for g in 0..targets {
            for e in 0..left {
                let found = (0..right).filter(|&f| index[e][f] == g);
                pairs.extend(found.map(|f| (e as u16, f as u16)));
            }
            starts.push(pairs.len());
        }
        Self { starts, pairs }
    }

    /// The same for squares: pairs with `e < f` once, then the pair of equals if there is one.
    fn squares(&self) -> Self {
        let (mut starts, mut pairs) = (vec![0], Vec::new());
        for g in 0..self.starts.len() - 1 {
            pairs.extend(self.of(g).iter().copied().filter(|(e, f)| e < f));
            pairs.extend(self.of(g).iter().copied().filter(|(e, f)| e == f));
            starts.push(pairs.len());
        }
        Self { starts, pairs }
    }

    fn of(&self, target: usize) -> &[(u16, u16)] {
        &self.pairs[self.starts[target]..self.starts[target + 1]]
    }
}

/// The tables of one type of element: everything that does not depend on its coordinates.
#[derive(Debug, Clone)]
pub struct NonlinearElement {
    law: StressLaw,
    n_nodes: usize,
    n_vectors: usize,
    /// Monomials of F_x, of F_y and F_z.
    fields: [usize; 3],
    /// Monomials of the products of two fields, by place in [`PAIRS`].
    targets: [usize; 6],
    /// Vector and factor of every monomial of every field.
    sources: [Vec<(usize, f64)>; 3],
    /// Pairs for xx; xy and xz; yy, yz and zz.
    products: [Products; 3],
    /// Squares for xx; for yy and zz.
    squares: [Products; 2],
    /// Monomial of the product of monomials e and f at `e * fields[0] + f`.
    sum: Vec<u16>,
    /// Nonzero moments of each monomial: `(other monomial, int g h dA)`, ascending.
    moments: Vec<Vec<(u16, f64)>>,
    area: f64,
    n_stations: usize,
    padded: usize,
    /// `L_i` and `dL_i/dx` at the stations, `[derivative][node * padded + station]`.
    axial: [Vec<f64>; 2],
    /// The same times the weights of the stations.
    weighted: [Vec<f64>; 2],
    /// Weights of the stations, m.
    weights: Vec<f64>,
    /// `w L_i^(a) L_j^(b)` at `[2 a + b][station * 16 + node pair]`, node pair `4 i + j`.
    axial_pairs: [Vec<f64>; 4],
    /// Kelvin-Voigt factor, s.
    viscosity: f64,
}

/// Working memory, one for each thread.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    values: Vec<f64>,
}

impl NonlinearElement {
    /// Tables for an element of the given length (m); `reference_length` is R (m). Laws: continuum and split.
    pub fn new(
        kind: ElementKind,
        section: &Section,
        material: &Material,
        length: f64,
        reference_length: f64,
        quadrature: Quadrature,
    ) -> Self {
        let (order, r) = (kind.polynomial_order(), reference_length);
        let list = exponents(2 * order);
        let index_of = |e: (usize, usize)| list.iter().position(|m| *m == e);
        let count = |degree: usize| (degree + 1) * (degree + 2) / 2;
        let (n_vectors, n_slopes) = (count(order), count(order - 1));
        let index: Vec<Vec<usize>> = list[..n_vectors]
            .iter()
            .map(|e| list[..n_vectors].iter().filter_map(|f| index_of((e.0 + f.0, e.1 + f.1))).collect())
            .collect();
        let factorial = |(a, b): (usize, usize)| (1..=a).chain(1..=b).map(|k| k as f64).product::<f64>();
        let plain = list[..n_vectors].iter().enumerate().map(|(k, &e)| (k, 1.0 / factorial(e))).collect();
        let slopes = |step: (usize, usize)| {
            let of = |e: &(usize, usize)| index_of((e.0 + step.0, e.1 + step.1)).unwrap_or(0);
            list[..n_slopes].iter().map(|e| (of(e), 1.0 / (factorial(*e) * r))).collect()
        };
        let scaled = Section {
            shape: section.shape,
            outer: section.outer.map(|c| c / r),
            inner: section.inner.map(|c| c / r),
        };
        let rule = quadrature.section.map(|points| section_rule(&scaled, points));
        let moment = |a: usize, b: usize| match &rule {
            _ if a % 2 == 1 || b % 2 == 1 => 0.0,
            None => scaled.moment(a, b) * r * r,
            Some(rule) => {
                rule.iter().map(|(y, z, w)| w * y.powi(a as i32) * z.powi(b as i32)).sum::<f64>() * r * r
            }
        };
        let moments = list
            .iter()
            .map(|g| {
                let row = list.iter().enumerate().map(|(h, f)| (h as u16, moment(g.0 + f.0, g.1 + f.1)));
                row.filter(|(_, value)| *value != 0.0).collect()
            })
            .collect();
        let polynomials = lagrange(kind.axial_degree);
        // the integrand holds four factors of the axial degree
        let stations = gauss(quadrature.axial.unwrap_or(2 * kind.axial_degree + 1));
        let padded = stations.len().next_multiple_of(LANES);
        let n_nodes = kind.n_nodes();
        let mut axial = [vec![0.0; n_nodes * padded], vec![0.0; n_nodes * padded]];
        let mut weighted = axial.clone();
        let mut weights: Vec<f64> = stations.iter().map(|(_, w)| w * length / 2.0).collect();
        weights.resize(padded, 0.0);
        for (i, l) in polynomials.iter().enumerate() {
            let slope = derivative(l);
            for (s, &(xi, w)) in stations.iter().enumerate() {
                let values = [evaluate(l, xi), evaluate(&slope, xi) * 2.0 / length];
                for (a, value) in values.into_iter().enumerate() {
                    axial[a][i * padded + s] = value;
                    weighted[a][i * padded + s] = value * w * length / 2.0;
                }
            }
        }
        let axial_pairs = [0, 1, 2, 3].map(|pair| {
            let (left, right) = (&weighted[pair / 2], &axial[pair % 2]);
            let mut table = vec![0.0; padded * NODE_PAIRS];
            for s in 0..stations.len() {
                for i in 0..n_nodes {
                    for j in 0..n_nodes {
                        table[s * NODE_PAIRS + 4 * i + j] = left[i * padded + s] * right[j * padded + s];
                    }
                }
            }
            table
        });
        let products = [(n_vectors, n_vectors), (n_vectors, n_slopes), (n_slopes, n_slopes)]
            .map(|(left, right)| Products::new(left, right, &index));
        Self {
            law: StressLaw::new(kind.law, section, material),
            n_nodes,
            n_vectors,
            fields: [n_vectors, n_slopes, n_slopes],
            targets: [(2, 0), (2, 2), (2, 2), (2, 1), (2, 1), (2, 2)]
                .map(|(f, less)| count(f * order - less)),
            sources: [plain, slopes((1, 0)), slopes((0, 1))],
            squares: [products[0].squares(), products[2].squares()],
            products,
            sum: index.iter().flatten().map(|&g| g as u16).collect(),
            moments,
            area: moment(0, 0),
            n_stations: stations.len(),
            padded,
            axial,
            weighted,
            weights,
            axial_pairs,
            viscosity: material.stiffness_damping,
        }
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
    /// With velocities the Kelvin-Voigt stress `beta C : dE/dt` is added to the force (not to the energy).
    pub fn internal_force(
        &self,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64 {
        let velocity = velocity.filter(|_| self.viscosity != 0.0);
        Arch::new().dispatch(Force { element: self, q, velocity, force, scratch })
    }

    /// Tangent `d force / dq` (N/m), symmetric, by columns into `tangent` (both triangles).
    pub fn tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut Scratch) {
        Arch::new().dispatch(Tangent { element: self, q, geometric: true, tangent, scratch });
    }

    /// The part of the tangent that stems from the law alone, without stress: `beta` times it is the
    /// derivative of the Kelvin-Voigt force by the velocities.
    pub fn material_tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut Scratch) {
        Arch::new().dispatch(Tangent { element: self, q, geometric: false, tangent, scratch });
    }

    /// Floating point operations of one force, counting a multiply-add as two.
    pub fn force_operations(&self) -> usize {
        let products: usize = [1, 1, 2].iter().map(|&p| self.products[p].pairs.len()).sum::<usize>()
            + self.squares[0].pairs.len()
            + 2 * self.squares[1].pairs.len();
        let sums = |g: usize, h: usize| -> usize {
            self.moments[..g].iter().map(|row| row.iter().filter(|(m, _)| (*m as usize) < h).count()).sum()
        };
        let moments: usize = (0..3).map(|p| sums(self.targets[p], self.targets[0])).sum::<usize>()
            + (3..6).map(|p| sums(self.targets[p], self.targets[p])).sum::<usize>();
        let fields: usize = self.fields.iter().sum();
        let nodes = 4 * 3 * self.n_nodes * self.n_vectors;
        2 * self.n_stations * (3 * products + moments + 3 * fields * fields + nodes)
    }

    /// Coefficients of F at a batch of stations, three components for each monomial of each field.
    #[inline(always)]
    fn gradient<S: Simd>(&self, simd: S, q: &[f64], batch: usize, fields: &mut [&mut [[S::f64s; 3]]; 3]) {
        let width = self.padded / S::F64_LANES;
        let axial = [&self.axial[1], &self.axial[0]].map(|table| S::as_simd_f64s(table).0);
        for (alpha, field) in fields.iter_mut().enumerate() {
            let table = axial[usize::from(alpha > 0)];
            for (coefficient, &(k, factor)) in field.iter_mut().zip(&self.sources[alpha]) {
                let mut sum = [simd.splat_f64s(0.0); 3];
                for i in 0..self.n_nodes {
                    let at = 3 * (i * self.n_vectors + k);
                    let weight = table[i * width + batch];
                    for (sum, q) in sum.iter_mut().zip(&q[at..at + 3]) {
                        *sum = simd.mul_add_e_f64s(simd.splat_f64s(*q), weight, *sum);
                    }
                }
                let factor = simd.splat_f64s(factor);
                for (coefficient, sum) in coefficient.iter_mut().zip(sum) {
                    *coefficient = simd.mul_f64s(sum, factor);
                }
            }
        }
    }

    /// Strains E (tensor components) from F, and from its rate if given: `E + beta dE/dt`.
    #[inline(always)]
    fn strains<S: Simd>(
        &self,
        simd: S,
        f: &[&mut [[S::f64s; 3]]; 3],
        rate: Option<&[&mut [[S::f64s; 3]]; 3]>,
        strains: &mut [&mut [S::f64s]; 6],
    ) {
        let half = simd.splat_f64s(0.5);
        for (place, &(alpha, beta)) in PAIRS.iter().enumerate() {
            let products = self.products_of(place);
            if alpha != beta {
                dot_products(simd, products, &f[alpha][..], &f[beta][..], strains[place]);
            } else {
                square_products(simd, &self.squares[usize::from(alpha > 0)], &f[alpha][..], strains[place]);
                strains[place][0] = simd.sub_f64s(strains[place][0], simd.splat_f64s(1.0));
            }
            if let Some(rate) = rate {
                let viscosity = simd.splat_f64s(self.viscosity);
                add_dot_products(simd, products, viscosity, &f[alpha][..], &rate[beta][..], strains[place]);
                add_dot_products(simd, products, viscosity, &rate[alpha][..], &f[beta][..], strains[place]);
            }
            for e in strains[place].iter_mut() {
                *e = simd.mul_f64s(*e, half);
            }
        }
    }

    /// Stresses S as polynomials; the normal ones have the degree of E_xx.
    #[inline(always)]
    fn stresses<S: Simd>(&self, simd: S, strains: &[&mut [S::f64s]; 6], stresses: &mut [&mut [S::f64s]; 6]) {
        let zero = simd.splat_f64s(0.0);
        for alpha in 0..3 {
            let mut modulus = [zero; 3];
            for (modulus, value) in modulus.iter_mut().zip(self.law.normal[alpha]) {
                *modulus = simd.splat_f64s(value);
            }
            for (h, stress) in stresses[alpha].iter_mut().enumerate() {
                let mut sum = simd.mul_f64s(modulus[0], strains[0][h]);
                for beta in 1..3 {
                    let strain = if h < strains[beta].len() { strains[beta][h] } else { zero };
                    sum = simd.mul_add_e_f64s(modulus[beta], strain, sum);
                }
                *stress = sum;
            }
        }
        for place in 3..6 {
            let modulus = simd.splat_f64s(2.0 * self.law.shear[place - 3]);
            for (stress, strain) in stresses[place].iter_mut().zip(&*strains[place]) {
                *stress = simd.mul_f64s(modulus, *strain);
            }
        }
    }

    /// Normal stresses on the axis (3333c) times the area: a moment of the constant monomial.
    #[inline(always)]
    fn axis_stress<S: Simd>(&self, simd: S, alpha: usize, strains: &[&mut [S::f64s]; 6]) -> S::f64s {
        let zero = simd.splat_f64s(0.0);
        let Some(law) = self.law.on_axis else { return zero };
        let mut sum = zero;
        for beta in 0..3 {
            let modulus = simd.splat_f64s(self.area * law[alpha][beta]);
            sum = simd.mul_add_e_f64s(modulus, strains[beta][0], sum);
        }
        sum
    }

    fn products_of(&self, place: usize) -> &Products {
        &self.products[[0, 2, 2, 1, 1, 2][place]]
    }
}

/// Takes `count` values of a type made of floats from the front of a pool.
#[inline(always)]
fn take<'a, T: Pod>(pool: &mut &'a mut [f64], count: usize) -> &'a mut [T] {
    let (front, rest) = std::mem::take(pool).split_at_mut(count * size_of::<T>() / size_of::<f64>());
    *pool = rest;
    cast_slice_mut(front)
}

/// Place of a pair of directions in [`PAIRS`].
#[inline(always)]
fn place(alpha: usize, beta: usize) -> usize {
    [[0, 3, 4], [3, 1, 5], [4, 5, 2]][alpha][beta]
}

/// `c[g] = sum a[e] . b[f]` over the pairs with e f = g.
#[inline(always)]
fn dot_products<S: Simd>(
    simd: S,
    products: &Products,
    a: &[[S::f64s; 3]],
    b: &[[S::f64s; 3]],
    c: &mut [S::f64s],
) {
    for (g, c) in c.iter_mut().enumerate() {
        // a sum for each component: three chains of operations go side by side
        let mut sum = [simd.splat_f64s(0.0); 3];
        for &(e, f) in products.of(g) {
            let (a, b) = (&a[e as usize], &b[f as usize]);
            for i in 0..3 {
                sum[i] = simd.mul_add_e_f64s(a[i], b[i], sum[i]);
            }
        }
        *c = simd.add_f64s(simd.add_f64s(sum[0], sum[1]), sum[2]);
    }
}

/// `c[g] = sum a[e] . a[f]` over the pairs with e f = g.
#[inline(always)]
fn square_products<S: Simd>(simd: S, squares: &Products, a: &[[S::f64s; 3]], c: &mut [S::f64s]) {
    for (g, c) in c.iter_mut().enumerate() {
        let zero = simd.splat_f64s(0.0);
        let (mut sum, mut equals) = ([zero; 3], [zero; 3]);
        for &(e, f) in squares.of(g) {
            let (x, y) = (&a[e as usize], &a[f as usize]);
            if e == f {
                for i in 0..3 {
                    equals[i] = simd.mul_f64s(x[i], x[i]);
                }
                break;
            }
            for i in 0..3 {
                sum[i] = simd.mul_add_e_f64s(x[i], y[i], sum[i]);
            }
        }
        let pairs = simd.add_f64s(simd.add_f64s(sum[0], sum[1]), sum[2]);
        let equals = simd.add_f64s(simd.add_f64s(equals[0], equals[1]), equals[2]);
        *c = simd.add_f64s(simd.add_f64s(pairs, pairs), equals);
    }
}

/// `c[g] += factor sum a[e] . b[f]`.
#[inline(always)]
fn add_dot_products<S: Simd>(
    simd: S,
    products: &Products,
    factor: S::f64s,
    a: &[[S::f64s; 3]],
    b: &[[S::f64s; 3]],
    c: &mut [S::f64s],
) {
    for (g, c) in c.iter_mut().enumerate() {
        for &(e, f) in products.of(g) {
            let (a, b) = (&a[e as usize], &b[f as usize]);
            for i in 0..3 {
                *c = simd.mul_add_e_f64s(simd.mul_f64s(factor, a[i]), b[i], *c);
            }
        }
    }
}

/// `m[g] = sum_h H[g,h] p[h]` for several polynomials at once.
#[inline(always)]
fn integrate<S: Simd, const C: usize>(
    simd: S,
    moments: &[Vec<(u16, f64)>],
    p: &[[S::f64s; C]],
    m: &mut [[S::f64s; C]],
) {
    for (m, row) in m.iter_mut().zip(moments) {
        let zero = simd.splat_f64s(0.0);
        let row = &row[..row.partition_point(|(h, _)| (*h as usize) < p.len())];
        // two chains of operations go side by side
        let (mut even, mut odd) = ([zero; C], [zero; C]);
        let mut pairs = row.chunks_exact(2);
        for pair in pairs.by_ref() {
            let (x, y) = (simd.splat_f64s(pair[0].1), simd.splat_f64s(pair[1].1));
            let (p, q) = (&p[pair[0].0 as usize], &p[pair[1].0 as usize]);
            for k in 0..C {
                even[k] = simd.mul_add_e_f64s(x, p[k], even[k]);
                odd[k] = simd.mul_add_e_f64s(y, q[k], odd[k]);
            }
        }
        if let [(h, value)] = pairs.remainder() {
            let (value, p) = (simd.splat_f64s(*value), &p[*h as usize]);
            for k in 0..C {
                even[k] = simd.mul_add_e_f64s(value, p[k], even[k]);
            }
        }
        for k in 0..C {
            m[k] = simd.add_f64s(even[k], odd[k]);
        }
    }
}

struct Force<'a> {
    element: &'a NonlinearElement,
    q: &'a [f64],
    velocity: Option<&'a [f64]>,
    force: &'a mut [f64],
    scratch: &'a mut Scratch,
}

impl WithSimd for Force<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { element, q, velocity, force, scratch } = self;
        let monomials: usize = element.fields.iter().sum();
        let targets: usize = element.targets.iter().sum::<usize>() + 2 * element.targets[0];
        scratch.values.resize(LANES * (6 * monomials + 3 * targets + 6 * element.n_vectors), 0.0);
        let mut pool = &mut scratch.values[..];
        let mut f = element.fields.map(|n| take::<[S::f64s; 3]>(&mut pool, n));
        let mut rate = element.fields.map(|n| take::<[S::f64s; 3]>(&mut pool, n));
        let mut strains = element.targets.map(|n| take::<S::f64s>(&mut pool, n));
        let normal = element.targets[0];
        let lengths = [normal, normal, normal, element.targets[3], element.targets[4], element.targets[5]];
        let mut stresses = lengths.map(|n| take::<S::f64s>(&mut pool, n));
        let mut t = element.targets.map(|n| take::<S::f64s>(&mut pool, n));
        let [on_slopes, on_values] = [(); 2].map(|()| take::<[S::f64s; 3]>(&mut pool, element.n_vectors));

        let zero = simd.splat_f64s(0.0);
        let width = element.padded / S::F64_LANES;
        let [values, slopes] = [&element.weighted[0], &element.weighted[1]].map(|t| S::as_simd_f64s(t).0);
        let weights = S::as_simd_f64s(&element.weights).0;
        let mut energy = 0.0;
        force.fill(0.0);
        for batch in 0..element.n_stations.div_ceil(S::F64_LANES) {
            element.gradient(simd, q, batch, &mut f);
            if let Some(velocity) = velocity {
                element.gradient(simd, velocity, batch, &mut rate);
            }
            element.strains(simd, &f, velocity.map(|_| &rate), &mut strains);
            element.stresses(simd, &strains, &mut stresses);
            element.stress_moments(simd, &strains, &stresses, &mut t);
            if velocity.is_none() {
                // W = int S : E / 2, off-diagonal terms twice
                let mut density = zero;
                for place in 0..6 {
                    let factor = simd.splat_f64s(if place < 3 { 0.5 } else { 1.0 });
                    let mut sum = zero;
                    for (t, e) in t[place].iter().zip(&*strains[place]) {
                        sum = simd.mul_add_e_f64s(*t, *e, sum);
                    }
                    density = simd.mul_add_e_f64s(factor, sum, density);
                }
                energy += simd.reduce_sum_f64s(simd.mul_f64s(weights[batch], density));
            }
            on_slopes.fill([zero; 3]);
            on_values.fill([zero; 3]);
            for alpha in 0..3 {
                let vectors = if alpha == 0 { &mut *on_slopes } else { &mut *on_values };
                for (e, &(k, factor)) in element.sources[alpha].iter().enumerate() {
                    let row = &element.sum[e * element.n_vectors..(e + 1) * element.n_vectors];
                    let mut sum = [zero; 3];
                    for beta in 0..3 {
                        let t = &*t[place(alpha, beta)];
                        for (index, f) in row.iter().zip(&*f[beta]) {
                            let t = t[*index as usize];
                            for (sum, f) in sum.iter_mut().zip(f) {
                                *sum = simd.mul_add_e_f64s(t, *f, *sum);
                            }
                        }
                    }
                    let factor = simd.splat_f64s(factor);
                    for (target, sum) in vectors[k].iter_mut().zip(sum) {
                        *target = simd.mul_add_e_f64s(factor, sum, *target);
                    }
                }
            }
            for (i, node) in force.chunks_exact_mut(3 * element.n_vectors).enumerate() {
                let (value, slope) = (values[i * width + batch], slopes[i * width + batch]);
                let parts = on_slopes.iter().flatten().zip(on_values.iter().flatten());
                for (target, (a, b)) in node.iter_mut().zip(parts) {
                    let sum = simd.mul_add_e_f64s(slope, *a, simd.mul_f64s(value, *b));
                    *target += simd.reduce_sum_f64s(sum);
                }
            }
        }
        energy
    }
}

struct Tangent<'a> {
    element: &'a NonlinearElement,
    q: &'a [f64],
    geometric: bool,
    tangent: &'a mut [f64],
    scratch: &'a mut Scratch,
}

impl WithSimd for Tangent<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { element, q, geometric, tangent, scratch } = self;
        let monomials: usize = element.fields.iter().sum();
        let targets: usize = element.targets.iter().sum::<usize>();
        let normal = element.targets[0];
        let widest = 9 * normal;
        let moments: usize = (0..6).map(|p| if p < 3 { 6 } else { 9 } * element.targets[p]).sum();
        let phase_one = LANES * (3 * monomials + 2 * targets + 2 * normal + 7 * widest);
        let vectors = NODE_PAIRS / S::F64_LANES;
        scratch.values.resize(phase_one + moments * element.padded + 2 * moments * NODE_PAIRS, 0.0);
        let mut pool = &mut scratch.values[..];
        let at_stations = take::<f64>(&mut pool, moments * element.padded);
        let at_nodes = take::<S::f64s>(&mut pool, 2 * moments * vectors);
        element.tangent_moments(simd, q, geometric, pool, at_stations);
        let blocks = element.along_axis(simd, at_stations, at_nodes);
        element.assemble(simd, blocks, at_nodes, tangent);
    }
}

/// First entries of the moments of each pair of directions, `A_ab`, among those of all node pairs; and of
/// those of `A_ab` with the node pairs exchanged.
struct Blocks {
    first: [usize; 6],
    exchanged: [usize; 6],
}

impl NonlinearElement {
    /// Section moments of stress `T_ab`.
    #[inline(always)]
    fn stress_moments<S: Simd>(
        &self,
        simd: S,
        strains: &[&mut [S::f64s]; 6],
        stresses: &[&mut [S::f64s]; 6],
        t: &mut [&mut [S::f64s]; 6],
    ) {
        for place in 0..6 {
            let (p, m) = (cast_slice(&*stresses[place]), cast_slice_mut(&mut *t[place]));
            integrate::<S, 1>(simd, &self.moments, p, m);
        }
        for alpha in 0..3 {
            t[alpha][0] = simd.add_f64s(t[alpha][0], self.axis_stress(simd, alpha, strains));
        }
    }

    /// Moments `A_ab,ij` at every station, `[moment][station]`; normal pairs hold the six components
    /// ij = 00 11 22 01 02 12, the others nine by rows.
    #[inline(always)]
    fn tangent_moments<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        geometric: bool,
        mut pool: &mut [f64],
        at_stations: &mut [f64],
    ) {
        let mut f = self.fields.map(|n| take::<[S::f64s; 3]>(&mut pool, n));
        let mut strains = self.targets.map(|n| take::<S::f64s>(&mut pool, n));
        let normal = self.targets[0];
        let lengths = [normal, normal, normal, self.targets[3], self.targets[4], self.targets[5]];
        let mut stresses = lengths.map(|n| take::<S::f64s>(&mut pool, n));
        let square = [0, 1, 2].map(|p| take::<[S::f64s; 6]>(&mut pool, self.targets[p]));
        let sums = take::<[S::f64s; 6]>(&mut pool, normal);
        let mixed = take::<[S::f64s; 9]>(&mut pool, normal);
        let blend = take::<[S::f64s; 9]>(&mut pool, normal);
        let six = take::<[S::f64s; 6]>(&mut pool, normal);
        let nine = take::<[S::f64s; 9]>(&mut pool, normal);
        let zero = simd.splat_f64s(0.0);
        let width = self.padded / S::F64_LANES;
        let stations = S::as_mut_simd_f64s(at_stations).0;
        for batch in 0..self.n_stations.div_ceil(S::F64_LANES) {
            self.gradient(simd, q, batch, &mut f);
            self.strains(simd, &f, None, &mut strains);
            self.stresses(simd, &strains, &mut stresses);
            for alpha in 0..3 {
                for (g, target) in square[alpha].iter_mut().enumerate() {
                    let mut sum = [zero; 6];
                    for &(d, e) in self.products_of(alpha).of(g) {
                        let (a, b) = (&f[alpha][d as usize], &f[alpha][e as usize]);
                        for (sum, (i, j)) in sum.iter_mut().zip(PAIRS) {
                            *sum = simd.mul_add_e_f64s(a[i], b[j], *sum);
                        }
                    }
                    *target = sum;
                }
            }
            let mut at = 0;
            for (place, (alpha, beta)) in PAIRS.into_iter().enumerate() {
                let count = self.targets[place];
                let coupling = simd.splat_f64s(self.law.normal[alpha][beta]);
                if alpha == beta {
                    // (lambda + 2 mu) F_a F_a + mu sum of the others, and the stress on the diagonal
                    for (h, target) in sums.iter_mut().enumerate() {
                        let mut sum = [zero; 6];
                        for gamma in 0..3 {
                            let modulus = match gamma {
                                _ if gamma == alpha => coupling,
                                _ => simd.splat_f64s(self.law.shear[self::place(alpha, gamma) - 3]),
                            };
                            let Some(square) = square[gamma].get(h) else { continue };
                            for (sum, f) in sum.iter_mut().zip(square) {
                                *sum = simd.mul_add_e_f64s(modulus, *f, *sum);
                            }
                        }
                        if geometric {
                            for sum in &mut sum[..3] {
                                *sum = simd.add_f64s(*sum, stresses[alpha][h]);
                            }
                        }
                        *target = sum;
                    }
                    integrate(simd, &self.moments[..count], sums, &mut *six);
                    if let Some(law) = self.law.on_axis {
                        let factor = simd.splat_f64s(self.area * law[alpha][alpha]);
                        for (m, (i, j)) in six[0].iter_mut().zip(PAIRS) {
                            let product = simd.mul_f64s(f[alpha][0][i], f[alpha][0][j]);
                            *m = simd.mul_add_e_f64s(factor, product, *m);
                        }
                        if geometric {
                            let stress = self.axis_stress(simd, alpha, &strains);
                            for m in &mut six[0][..3] {
                                *m = simd.add_f64s(*m, stress);
                            }
                        }
                    }
                    for m in six[..count].iter().flatten() {
                        stations[at * width + batch] = *m;
                        at += 1;
                    }
                    continue;
                }
                let shear = simd.splat_f64s(self.law.shear[place - 3]);
                for g in 0..count {
                    let mut sum = [zero; 9];
                    for &(d, e) in self.products_of(place).of(g) {
                        let (a, b) = (&f[alpha][d as usize], &f[beta][e as usize]);
                        for i in 0..3 {
                            for j in 0..3 {
                                sum[3 * i + j] = simd.mul_add_e_f64s(a[i], b[j], sum[3 * i + j]);
                            }
                        }
                    }
                    mixed[g] = sum;
                    for i in 0..3 {
                        for j in 0..3 {
                            let exchanged = simd.mul_f64s(shear, sum[3 * j + i]);
                            blend[g][3 * i + j] = simd.mul_add_e_f64s(coupling, sum[3 * i + j], exchanged);
                        }
                        if geometric {
                            blend[g][4 * i] = simd.add_f64s(blend[g][4 * i], stresses[place][g]);
                        }
                    }
                }
                integrate(simd, &self.moments[..count], &blend[..count], &mut *nine);
                if let Some(law) = self.law.on_axis {
                    let factor = simd.splat_f64s(self.area * law[alpha][beta]);
                    for (m, product) in nine[0].iter_mut().zip(&mixed[0]) {
                        *m = simd.mul_add_e_f64s(factor, *product, *m);
                    }
                }
                for m in nine[..count].iter().flatten() {
                    stations[at * width + batch] = *m;
                    at += 1;
                }
            }
        }
    }

    /// Integrates the moments along the axis against `L_i^(a) L_j^(b)`: all node pairs side by side.
    #[inline(always)]
    fn along_axis<S: Simd>(&self, simd: S, at_stations: &[f64], at_nodes: &mut [S::f64s]) -> Blocks {
        let vectors = NODE_PAIRS / S::F64_LANES;
        let mut blocks = Blocks { first: [0; 6], exchanged: [0; 6] };
        let (mut read, mut write) = (0, 0);
        for (place, (alpha, beta)) in PAIRS.into_iter().enumerate() {
            let entries = if place < 3 { 6 } else { 9 } * self.targets[place];
            // F_x goes with the slopes of the axial polynomials, F_y and F_z with their values
            let derivatives = [usize::from(alpha == 0), usize::from(beta == 0)];
            for exchanged in [false, true] {
                if exchanged {
                    blocks.exchanged[place] = write;
                    if alpha == beta {
                        continue;
                    }
                } else {
                    blocks.first[place] = write;
                }
                let [a, b] = if exchanged { [derivatives[1], derivatives[0]] } else { derivatives };
                let table = S::as_simd_f64s(&self.axial_pairs[2 * a + b]).0;
                for entry in 0..entries {
                    let row = &at_stations[(read + entry) * self.padded..][..self.n_stations];
                    for v in 0..vectors {
                        let mut sum = simd.splat_f64s(0.0);
                        for (moment, weights) in row.iter().zip(table.chunks_exact(vectors)) {
                            sum = simd.mul_add_e_f64s(simd.splat_f64s(*moment), weights[v], sum);
                        }
                        at_nodes[(write + entry) * vectors + v] = sum;
                    }
                }
                write += entries;
            }
            read += entries;
        }
        blocks
    }

    /// Looks up the tangent of every pair of vectors and writes both triangles.
    #[inline(always)]
    fn assemble<S: Simd>(&self, simd: S, blocks: Blocks, at_nodes: &[S::f64s], tangent: &mut [f64]) {
        let (n, size, vectors) = (self.n_vectors, self.size(), NODE_PAIRS / S::F64_LANES);
        // place of component ij among the six of a normal pair
        const SIX: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];
        let mut terms = [(0, 0, 0, 0.0); 9];
        let mut values = [0.0; NODE_PAIRS];
        for k in 0..n {
            for l in 0..=k {
                let mut count = 0;
                for alpha in 0..3 {
                    let Some(e) = self.sources[alpha].iter().position(|s| s.0 == k) else { continue };
                    for beta in 0..3 {
                        let Some(f) = self.sources[beta].iter().position(|s| s.0 == l) else { continue };
                        let factor = self.sources[alpha][e].1 * self.sources[beta][f].1;
                        terms[count] = (alpha, beta, self.sum[e * n + f] as usize, factor);
                        count += 1;
                    }
                }
                for i in 0..3 {
                    for j in 0..3 {
                        for v in 0..vectors {
                            let mut sum = simd.splat_f64s(0.0);
                            for &(alpha, beta, g, factor) in &terms[..count] {
                                let place = place(alpha, beta);
                                let entry = match alpha.cmp(&beta) {
                                    std::cmp::Ordering::Equal => blocks.first[place] + 6 * g + SIX[i][j],
                                    std::cmp::Ordering::Less => blocks.first[place] + 9 * g + 3 * i + j,
                                    std::cmp::Ordering::Greater => {
                                        blocks.exchanged[place] + 9 * g + 3 * j + i
                                    }
                                };
                                let moment = at_nodes[entry * vectors + v];
                                sum = simd.mul_add_e_f64s(simd.splat_f64s(factor), moment, sum);
                            }
                            S::as_mut_simd_f64s(&mut values).0[v] = sum;
                        }
                        for node in 0..self.n_nodes {
                            for other in 0..self.n_nodes {
                                let (row, column) = (3 * (node * n + k) + i, 3 * (other * n + l) + j);
                                let value = values[4 * node + other];
                                tangent[column * size + row] = value;
                                tangent[row * size + column] = value;
                            }
                        }
                    }
                }
            }
        }
    }
}
