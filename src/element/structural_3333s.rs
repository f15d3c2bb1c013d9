//! The structural comparison element 3333s (solid circle): strains of a shear-deformable beam.
//!
//! With the frame `t1 ~ r_,y x r_,z`, `t3 = r_,z / |r_,z|`, `t2 = t3 x t1` of the section
//!
//! ```text
//!     Gamma_i = t_i . r' - delta_i1,  kappa_i = 1/2 eps_ijk t_k . t_j',  E_ab = (r_,a . r_,b - delta_ab)/2
//! ```
//!
//! and the energy per length is half of `EA G1^2 + ks GA (G2^2 + G3^2) + GJ k1^2 + EI (k2^2 + k3^2) +
//! EA E_yy^2 + EA E_zz^2 + 2 GA E_yz^2`. About the undeformed state, with u the axis displacement and v, w
//! the changes of r_,y and r_,z,
//!
//! ```text
//!     Gamma = (u_x', u_y' + v_x, u_z' + w_x),  kappa = (-w_y', w_x', -v_x'),
//!     E_yy = v_y,  E_zz = w_z,  E_yz = (w_y + v_z)/2
//! ```
//!
//! The stiffness about that state is integrated exactly. Source: docs/theory/elements.md#element-3333s.

use crate::element::Kernel;
use crate::element::basis::{AxialProducts, derivative, evaluate, lagrange};
use crate::element::continuum::lame;
use crate::element::kernel::simd::Scratch;
use crate::element::quadrature::gauss;
use crate::model::Material;
use crate::section::Section;
use faer::Mat;
use nalgebra::SVector;
use num_dual::{DualNum, gradient, hessian};

/// Gauss points along an element when the case names none. The integrand is no polynomial; in the undeformed
/// state three points are exact, and with finite strains a fourth leaves an error far below that of the mesh.
pub const AXIAL_POINTS: usize = 4;
/// Degree of the axial polynomials.
const DEGREE: usize = 2;
/// Nodes of an element.
const NODES: usize = DEGREE + 1;
/// Coordinates of an element.
const SIZE: usize = 9 * NODES;
/// Components of the section quantities.
const QUANTITIES: usize = 3 * SOURCES.len();
/// The section quantities r', r_,y, r_,z, r_,y', r_,z': vector of the node, and whether derived by x.
const SOURCES: [(usize, bool); 5] = [(0, true), (1, false), (2, false), (1, true), (2, true)];

/// Moduli of `G1 G2 G3 k1 k2 k3 E_yy E_zz E_yz`.
fn moduli(section: &Section, material: &Material) -> [f64; 9] {
    let e = material.youngs_modulus;
    let (_, g) = lame(material);
    let (area, inertia) = (section.area(), section.moment(2, 0));
    let shear = section.shear_correction(material.poisson_ratio) * g * area;
    let (axial, bending) = (e * area, e * inertia);
    [axial, shear, shear, g * 2.0 * inertia, bending, bending, axial, axial, 2.0 * g * area]
}

/// A vector whose components may carry derivatives.
type DualVector<T> = [T; 3];

fn dot<T: DualNum<f64> + Copy>(a: DualVector<T>, b: DualVector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<T: DualNum<f64> + Copy>(a: DualVector<T>, b: DualVector<T>) -> DualVector<T> {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

/// `G1 G2 G3 k1 k2 k3 E_yy E_zz E_yz` of the section quantities.
fn strains<T: DualNum<f64> + Copy>(v: &SVector<T, QUANTITIES>) -> [T; 9] {
    let [slope, y, z, y_slope, z_slope] = [0, 1, 2, 3, 4].map(|k| [v[3 * k], v[3 * k + 1], v[3 * k + 2]]);
    let normal = cross(y, z);
    let (per_normal, per_z) = (dot(normal, normal).sqrt().recip(), dot(z, z).sqrt().recip());
    let (t1, t3) = (normal.map(|c| c * per_normal), z.map(|c| c * per_z));
    let t2 = cross(t3, t1);
    // of t1' and t3' only what is normal to t1 and t3 counts: the change of their lengths drops out
    let (turn_y, turn_z) = (cross(y_slope, z), cross(y, z_slope));
    let t1_slope = [0, 1, 2].map(|i| (turn_y[i] + turn_z[i]) * per_normal);
    let t3_slope = z_slope.map(|c| c * per_z);
    [
        dot(t1, slope) - 1.0,
        dot(t2, slope),
        dot(t3, slope),
        -dot(t2, t3_slope),
        dot(t1, t3_slope),
        dot(t2, t1_slope),
        (dot(y, y) - 1.0) * 0.5,
        (dot(z, z) - 1.0) * 0.5,
        dot(y, z) * 0.5,
    ]
}

/// A Gauss point along the element.
#[derive(Debug, Clone)]
struct StructuralStation {
    /// Weight of the station in an integral along the element, m.
    weight: f64,
    /// Section quantity by coordinate: `[quantity][node]`.
    factors: [[f64; NODES]; SOURCES.len()],
}

/// Internal force and tangent of 3333s, integrated with Gauss points along the axis. The derivatives of the
/// energy by the section quantities are exact (dual numbers).
#[derive(Debug, Clone)]
pub struct StructuralElement {
    moduli: [f64; 9],
    stations: Vec<StructuralStation>,
}

impl StructuralElement {
    /// An element of the given length (m); `reference_length` is R (m), [`AXIAL_POINTS`] the usual points.
    pub fn new(
        section: &Section,
        material: &Material,
        length: f64,
        reference_length: f64,
        axial_points: usize,
    ) -> Self {
        let polynomials = lagrange(DEGREE);
        let station = |(xi, w): (f64, f64)| StructuralStation {
            weight: w * length / 2.0,
            factors: SOURCES.map(|(vector, derived)| {
                let scale = if vector == 0 { 1.0 } else { 1.0 / reference_length };
                std::array::from_fn(|i| match derived {
                    true => scale * evaluate(&derivative(&polynomials[i]), xi) * 2.0 / length,
                    false => scale * evaluate(&polynomials[i], xi),
                })
            }),
        };
        Self {
            moduli: moduli(section, material),
            stations: gauss(axial_points).into_iter().map(station).collect(),
        }
    }

    /// Strain energy per length, J/m.
    fn density<T: DualNum<f64> + Copy>(&self, v: &SVector<T, QUANTITIES>) -> T {
        strains(v).into_iter().zip(self.moduli).map(|(s, modulus)| s * s * (0.5 * modulus)).sum()
    }
}

impl Kernel for StructuralElement {
    fn size(&self) -> usize {
        SIZE
    }

    fn internal_force(&self, q: &[f64], _: Option<&[f64]>, force: &mut [f64], _: &mut Scratch) -> f64 {
        force.fill(0.0);
        let mut energy = 0.0;
        for station in &self.stations {
            let (density, slopes) = gradient(|v| self.density(&v), &quantities(station, q));
            energy += station.weight * density;
            for (k, (vector, _)) in SOURCES.into_iter().enumerate() {
                for i in 0..NODES {
                    let factor = station.weight * station.factors[k][i];
                    for c in 0..3 {
                        force[coordinate(i, vector, c)] += factor * slopes[3 * k + c];
                    }
                }
            }
        }
        energy
    }

    fn tangent(&self, q: &[f64], tangent: &mut [f64], _: &mut Scratch) {
        tangent.fill(0.0);
        for station in &self.stations {
            let (_, _, curvature) = hessian(|v| self.density(&v), &quantities(station, q));
            for (k, (vector, _)) in SOURCES.into_iter().enumerate() {
                for (l, (other, _)) in SOURCES.into_iter().enumerate() {
                    for i in 0..NODES {
                        for j in 0..NODES {
                            let factor = station.weight * station.factors[k][i] * station.factors[l][j];
                            for c in 0..3 {
                                for d in 0..3 {
                                    let (row, column) = (coordinate(i, vector, c), coordinate(j, other, d));
                                    tangent[column * SIZE + row] +=
                                        factor * curvature[(3 * k + c, 3 * l + d)];
                                }
                            }
                        }
                    }
                }
            }
        }
        // sums in another order differ by rounding
        for row in 0..SIZE {
            for column in 0..row {
                tangent[row * SIZE + column] = tangent[column * SIZE + row];
            }
        }
    }
}

fn coordinate(node: usize, vector: usize, component: usize) -> usize {
    (node * 3 + vector) * 3 + component
}

/// The section quantities of the coordinates q.
fn quantities(station: &StructuralStation, q: &[f64]) -> SVector<f64, QUANTITIES> {
    SVector::from_fn(|at, _| {
        let (k, c) = (at / 3, at % 3);
        (0..NODES).map(|i| station.factors[k][i] * q[coordinate(i, SOURCES[k].0, c)]).sum()
    })
}

/// One term `factor * (d/dx)^derived of component of vector`.
struct StiffnessTerm {
    vector: usize,
    component: usize,
    derived: bool,
    factor: f64,
}

/// Stiffness about the undeformed state in scaled coordinates, N/m.
pub fn stiffness(
    section: &Section,
    material: &Material,
    axial: &AxialProducts,
    reference_length: f64,
) -> Mat<f64> {
    let scale = 1.0 / reference_length;
    let [u, v, w] = [(0, 1.0), (1, scale), (2, scale)];
    let [x, y, z] = [0, 1, 2];
    let term = |(vector, scale): (usize, f64), component, derived, factor: f64| StiffnessTerm {
        vector,
        component,
        derived,
        factor: factor * scale,
    };
    let strains = [
        vec![term(u, x, true, 1.0)],
        vec![term(u, y, true, 1.0), term(v, x, false, 1.0)],
        vec![term(u, z, true, 1.0), term(w, x, false, 1.0)],
        vec![term(w, y, true, -1.0)],
        vec![term(w, x, true, 1.0)],
        vec![term(v, x, true, -1.0)],
        vec![term(v, y, false, 1.0)],
        vec![term(w, z, false, 1.0)],
        vec![term(w, y, false, 0.5), term(v, z, false, 0.5)],
    ];
    let n_nodes = axial.get(false, false).nrows();
    let mut matrix = Mat::zeros(9 * n_nodes, 9 * n_nodes);
    for (modulus, terms) in moduli(section, material).into_iter().zip(&strains) {
        for p in terms {
            for q in terms {
                let lengths = axial.get(p.derived, q.derived);
                for i in 0..n_nodes {
                    for j in 0..n_nodes {
                        let row = coordinate(i, p.vector, p.component);
                        let column = coordinate(j, q.vector, q.component);
                        matrix[(row, column)] += modulus * p.factor * q.factor * lengths[(i, j)];
                    }
                }
            }
        }
    }
    matrix
}
