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
//! give force and tangent. A section rule with points only replaces H. Source: derived in docs/theory/elements.md#nonlinear-forces.

mod force;
mod section_polynomials;
mod tangent;

use crate::element::continuum::lame;
use crate::element::kernel::pair_stiffness::{Expansion, place};
use crate::element::kernel::simd::Scratch;
use crate::element::kernel::stations::Stations;
use crate::element::kernel::vectorised::Vectorised;
use crate::element::quadrature::{gauss, section_rule};
use crate::element::taper;
use crate::instructions::Instructions;
use crate::model::{ElementKind, Law, Material, Quadrature};
use crate::section::Section;
use crate::section::basis::exponents;
use crate::section::kinks::Kinks;
use nalgebra::Matrix3;
use pulp::{Arch, Simd};
use section_polynomials::{Class, count, place_on_grid};
use tangent::PolynomialTables;

/// Degree of the products of each pair of directions xx yy zz xy xz yz, as an index of [`Class::counts`].
const DEGREE: [usize; 6] = [2, 0, 0, 1, 1, 0];

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
        let ks = section.shear_correction(nu);
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

/// `int eta^a zeta^b dA` over a section, m^2, by exact moments or by points.
fn section_moments(
    section: &Section,
    r: f64,
    quadrature: Quadrature,
) -> impl Fn(usize, usize) -> f64 + use<> {
    let scaled = Section {
        shape: section.shape,
        outer: section.outer.map(|c| c / r),
        inner: section.inner.map(|c| c / r),
    };
    let rule = quadrature.section.map(|points| section_rule(&scaled, points));
    move |a: usize, b: usize| match &rule {
        _ if a % 2 == 1 || b % 2 == 1 => 0.0,
        None => scaled.moment(a, b) * r * r,
        Some(rule) => {
            rule.iter().map(|(y, z, w)| w * y.powi(a as i32) * z.powi(b as i32)).sum::<f64>() * r * r
        }
    }
}

/// The coefficients of F_x, F_y and F_z that a vector of a node enters, with their factors.
type Roles = [Option<(usize, f64)>; 3];

/// The tables of one type of element: everything that does not depend on its coordinates.
#[derive(Debug, Clone)]
pub struct NonlinearElement {
    law: StressLaw,
    n_vectors: usize,
    /// What the vectors of a node do.
    vectors: Vec<Roles>,
    /// Monomials of F_x, of F_y and F_z.
    fields: [usize; 3],
    /// Places of the monomials of F_x on the grid; those of F_y and F_z are the first.
    places: Vec<usize>,
    /// Number of places on the grid.
    grid: usize,
    classes: [Class; 4],
    area: f64,
    stations: Stations,
    tangent: PolynomialTables,
    /// Kelvin-Voigt factor, s.
    viscosity: f64,
    /// Vector instructions that the kernels use.
    arch: Arch,
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
        let moment = section_moments(section, reference_length, quadrature);
        let classes = Class::all(kind.polynomial_order(), &moment);
        // the integrand holds four factors of the axial degree
        let count = quadrature.axial.unwrap_or(2 * kind.axial_degree + 1);
        let stations = Stations::new(kind.axial_degree, length, count);
        let law = (StressLaw::new(kind.law, section, material), moment(0, 0));
        Self::with_classes(kind, law, material.stiffness_damping, reference_length, (classes, stations))
    }

    /// Tables for an element of the continuum members whose section changes linearly between its faces. Source:
    /// docs/theory/elements.md#tapers.
    pub fn tapered(
        kind: ElementKind,
        faces: [&Section; 2],
        material: &Material,
        length: f64,
        reference_length: f64,
        quadrature: Quadrature,
    ) -> Self {
        let count = quadrature.axial.unwrap_or(taper::nonlinear_stations(kind, &Kinks::NONE));
        let stations = Stations::new(kind.axial_degree, length, count);
        let moments: Vec<_> = gauss(count)
            .into_iter()
            .map(|(xi, _)| section_moments(&taper::at(faces, xi), reference_length, quadrature))
            .collect();
        let moment = |station: usize, a: usize, b: usize| moments[station](a, b);
        let classes = Class::along(kind.polynomial_order(), (stations.count, stations.padded), moment);
        let law = (StressLaw::new(kind.law, faces[0], material), 0.0);
        Self::with_classes(kind, law, material.stiffness_damping, reference_length, (classes, stations))
    }

    fn with_classes(
        kind: ElementKind,
        (law, area): (StressLaw, f64),
        viscosity: f64,
        r: f64,
        (classes, stations): ([Class; 4], Stations),
    ) -> Self {
        let order = kind.polynomial_order();
        let list = exponents(order);
        let (n_vectors, n_slopes) = (count(order), count(order - 1));
        let factorial = |(a, b): (usize, usize)| (1..=a).chain(1..=b).map(|k| k as f64).product::<f64>();
        let vectors: Vec<Roles> = list
            .iter()
            .enumerate()
            .map(|(k, &(a, b))| {
                let slope = |lower: Option<(usize, usize)>| {
                    let e = list.iter().position(|e| Some(*e) == lower)?;
                    Some((e, 1.0 / (factorial(list[e]) * r)))
                };
                let plain = Some((k, 1.0 / factorial((a, b))));
                [plain, slope(a.checked_sub(1).map(|a| (a, b))), slope(b.checked_sub(1).map(|b| (a, b)))]
            })
            .collect();
        Self {
            law,
            n_vectors,
            fields: [n_vectors, n_slopes, n_slopes],
            places: list.iter().map(|&m| place_on_grid(order, m)).collect(),
            grid: place_on_grid(order, (2 * order, 0)) + 1,
            area,
            tangent: PolynomialTables::new(order, &classes, &vectors, &stations),
            vectors,
            classes,
            stations,
            viscosity,
            arch: Instructions::Widest.arch().unwrap_or(Arch::Scalar),
        }
    }

    /// Computes with other vector instructions; those it had stay on a processor without the ones asked for.
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.arch = instructions.arch().unwrap_or(self.arch);
        self
    }

    /// Floating point operations of one force, counting a multiply-add as two.
    pub fn force_operations(&self) -> usize {
        let [x, y, _] = self.fields;
        let fields = x + 2 * y;
        // a square takes the pairs of different coefficients once, and a factor for those of equal ones
        let squares = |n: usize| 3 * (n * (n + 1) + n);
        let products = squares(x) + 2 * squares(y) + 6 * (2 * x * y + y * y);
        let of_class = |class: &Class| {
            let [low, mid, all] = class.counts;
            let law = all * (2 * 9 + 3);
            let moments = 2 * (all * all + 2 * low * all + 2 * mid * mid + low * low);
            let energy = 2 * (all + 2 * mid + 3 * low);
            law + moments + energy
        };
        let classes: usize = self.classes.iter().map(of_class).sum();
        let contraction = 2 * 3 * fields * fields;
        // node by node: value and slope of F, then the force of both; factors of the coefficients
        let nodes = 2 * 3 * (2 + 2) * self.stations.n_nodes() * self.n_vectors + 3 * (1 + 2) * fields;
        self.stations.count * (products + classes + contraction + nodes)
    }

    /// What belongs to the coefficients of F_x, F_y and F_z, which lie one after the other.
    fn columns<'a, T>(&self, f: &'a [T]) -> [&'a [T]; 3] {
        let (x, rest) = f.split_at(self.fields[0]);
        let (y, z) = rest.split_at(self.fields[1]);
        [x, y, z]
    }

    /// Coefficients of F, three components each, at a batch of stations: as many as a vector holds.
    #[inline(always)]
    fn gradient<S: Simd>(&self, simd: S, q: &[f64], batch: usize, f: &mut [[S::f64s; 3]]) {
        let starts = [0, self.fields[0], self.fields[0] + self.fields[1]];
        for (k, roles) in self.vectors.iter().enumerate() {
            let [value, slope] = self.stations.collapse(simd, q, (k, self.n_vectors), batch);
            for alpha in 0..3 {
                let Some((e, factor)) = roles[alpha] else { continue };
                let along = if alpha == 0 { &slope } else { &value };
                for i in 0..3 {
                    f[starts[alpha] + e][i] = simd.mul_f64s(simd.splat_f64s(factor), along[i]);
                }
            }
        }
    }

    /// Normal stress on the axis (3333c) times the area: a moment of the constant monomial.
    #[inline(always)]
    fn axis_stress<S: Simd>(&self, simd: S, law: [f64; 3], strain: [S::f64s; 3]) -> S::f64s {
        let mut sum = simd.splat_f64s(0.0);
        for (modulus, strain) in law.into_iter().zip(strain) {
            sum = simd.mul_add_e_f64s(simd.splat_f64s(self.area * modulus), strain, sum);
        }
        sum
    }
}

impl Vectorised for NonlinearElement {
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
