//! The planar element 2322s: three nodes along x, at each the position r and the section vector `r_,y`.
//!
//! ```text
//!     r = sum_i L_i(xi) (r_i + y r_,y,i),  xi = 2 x/l:   L = xi (xi - 1)/2,  1 - xi^2,  xi (xi + 1)/2
//!     b = r_,y, c = b', n = |b|:   Gamma_1 = (r' x b)/n - 1,  Gamma_2 = r'.b/n,  kappa = (b x c)/n^2,
//!     U = 1/2 int EA Gamma_1^2 + ks GA Gamma_2^2 + EI kappa^2 dx + 1/2 int EA_t ((b.b - 1)/2)^2 dx
//! ```
//!
//! with `a x b = a_1 b_2 - a_2 b_1`. The first integral takes two Gauss points, the second three Lobatto points (the nodes);
//! more points lock. Coordinates: node by node `r_x, r_y, b_x, b_y`. Source: docs/theory.md section 13.

use crate::model::scene::PlanarSection;
use nalgebra::SVector;
use num_dual::{DualNum, gradient, hessian};

/// Nodes of an element.
pub const NODES: usize = 3;
/// Coordinates of a node.
pub const PER_NODE: usize = 4;
/// Coordinates of an element.
pub const SIZE: usize = NODES * PER_NODE;
/// Components of the section quantities `r', b, c`.
const QUANTITIES: usize = 6;
/// Squared change of the section quantities below which a discrete gradient is the gradient.
const NO_CHANGE: f64 = 1e-26;

/// A point of a quadrature along the element.
#[derive(Debug, Clone, Copy)]
struct Station {
    /// m.
    weight: f64,
    values: [f64; NODES],
    /// 1/m.
    slopes: [f64; NODES],
    /// Of the second integral.
    thickness: bool,
}

/// Internal force, tangent and mass of 2322s; the derivatives of the energy are exact (dual numbers).
#[derive(Debug, Clone)]
pub struct PlanarElement {
    section: PlanarSection,
    length: f64,
    stations: [Station; 5],
}

/// `L_i(xi)`.
pub fn values(xi: f64) -> [f64; NODES] {
    [xi * (xi - 1.0) / 2.0, 1.0 - xi * xi, xi * (xi + 1.0) / 2.0]
}

/// `dL_i/dxi`.
pub fn slopes(xi: f64) -> [f64; NODES] {
    [xi - 0.5, -2.0 * xi, xi + 0.5]
}

/// `d^2 L_i/dxi^2`.
pub const CURVATURES: [f64; NODES] = [1.0, -2.0, 1.0];

type Quantities<T> = SVector<T, QUANTITIES>;

impl PlanarElement {
    /// An element of that length, m.
    pub fn new(section: PlanarSection, length: f64) -> Self {
        let station = |xi: f64, weight: f64, thickness| Station {
            weight: weight * length / 2.0,
            values: values(xi),
            slopes: slopes(xi).map(|s| s * 2.0 / length),
            thickness,
        };
        let gauss = 1.0 / 3.0_f64.sqrt();
        let stations = [
            station(-gauss, 1.0, false),
            station(gauss, 1.0, false),
            station(-1.0, 1.0 / 3.0, true),
            station(0.0, 4.0 / 3.0, true),
            station(1.0, 1.0 / 3.0, true),
        ];
        Self { section, length, stations }
    }

    /// Energy per length, J/m.
    fn density<T: DualNum<f64> + Copy>(&self, thickness: bool, v: &Quantities<T>) -> T {
        let [slope, b, c] = [0, 2, 4].map(|k| [v[k], v[k + 1]]);
        let squared = b[0] * b[0] + b[1] * b[1];
        if thickness {
            let strain = (squared - 1.0) * 0.5;
            return strain * strain * (0.5 * self.section.thickness);
        }
        let per_length = squared.sqrt().recip();
        let stretch = (slope[0] * b[1] - slope[1] * b[0]) * per_length - 1.0;
        let shear = (slope[0] * b[0] + slope[1] * b[1]) * per_length;
        let curvature = (b[0] * c[1] - b[1] * c[0]) / squared;
        stretch * stretch * (0.5 * self.section.axial)
            + shear * shear * (0.5 * self.section.shear)
            + curvature * curvature * (0.5 * self.section.bending)
    }

    /// Strain energy U, J.
    pub fn energy(&self, q: &[f64]) -> f64 {
        self.stations.iter().map(|s| s.weight * self.density(s.thickness, &s.quantities(q))).sum()
    }

    /// Internal force `dU/dq` (N on r, N m on b) into `force`; returns the strain energy U, J.
    pub fn internal_force(&self, q: &[f64], force: &mut [f64; SIZE]) -> f64 {
        force.fill(0.0);
        let mut energy = 0.0;
        for s in &self.stations {
            let (density, slope) = gradient(|v| self.density(s.thickness, &v), &s.quantities(q));
            energy += s.weight * density;
            s.scatter(&slope, force);
        }
        energy
    }

    /// Tangent `d force/dq`, symmetric, row by row.
    pub fn tangent(&self, q: &[f64]) -> [[f64; SIZE]; SIZE] {
        let mut tangent = [[0.0; SIZE]; SIZE];
        for s in &self.stations {
            let (_, _, curvature) = hessian(|v| self.density(s.thickness, &v), &s.quantities(q));
            s.scatter_matrix(&curvature, &mut tangent);
        }
        tangent
    }

    /// Force between two states whose work is exactly the change of the strain energy, `f . (q1 - q0) = U1 - U0`, and its
    /// derivative by `q1`: at every station the discrete gradient of Gonzalez (J. Nonlinear Sci. 6, 1996) in the section
    /// quantities v, which translations do not change:
    ///
    /// `psi_v(mid) + a S dv`, `a = (psi_1 - psi_0 - psi_v(mid).dv)/(dv.S dv)`, S giving c its length.
    pub fn average_force(
        &self,
        q0: &[f64],
        q1: &[f64],
        force: &mut [f64; SIZE],
        tangent: &mut [[f64; SIZE]; SIZE],
    ) {
        force.fill(0.0);
        *tangent = [[0.0; SIZE]; SIZE];
        let radius = self.section.inertia / self.section.mass;
        let scale = Quantities::from([1.0, 1.0, 1.0, 1.0, radius, radius]);
        for s in &self.stations {
            let (v0, v1) = (s.quantities(q0), s.quantities(q1));
            let (middle, change) = ((v0 + v1) / 2.0, v1 - v0);
            let density = |v: &Quantities<f64>| self.density(s.thickness, v);
            let (_, slope, curvature) = hessian(|v| self.density(s.thickness, &v), &middle);
            let (last, slope1) = gradient(|v| self.density(s.thickness, &v), &v1);
            let scaled = change.component_mul(&scale);
            let size = change.dot(&scaled);
            let defect = last - density(&v0) - slope.dot(&change);
            let moved = size > NO_CHANGE;
            let factor = if moved { defect / size } else { 0.0 };
            s.scatter(&(slope + scaled * factor), force);
            let mut matrix = curvature * 0.5;
            if moved {
                for k in 0..QUANTITIES {
                    matrix[(k, k)] += factor * scale[k];
                }
                let row = slope1 - slope - curvature * change * 0.5 - scaled * (2.0 * factor);
                matrix += scaled * row.transpose() / size;
            }
            s.scatter_matrix(&matrix, tangent);
        }
    }

    /// Mass between the vectors of two nodes: `[on r, on b]`, kg and kg m^2, the same for both components.
    pub fn mass(&self) -> [[[f64; 2]; NODES]; NODES] {
        // int L_i L_j dx / l
        const PRODUCTS: [[f64; NODES]; NODES] = [[4.0, 2.0, -1.0], [2.0, 16.0, 2.0], [-1.0, 2.0, 4.0]];
        PRODUCTS.map(|row| {
            row.map(|p| {
                let share = p * self.length / 30.0;
                [self.section.mass * share, self.section.inertia * share]
            })
        })
    }

    /// Length, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Its section.
    pub fn section(&self) -> &PlanarSection {
        &self.section
    }
}

/// Force on the section vector b of a moment M (N m, counter-clockwise): `M (-b_2, b_1)/|b|^2`.
pub fn moment_on_vector(moment: f64, b: [f64; 2]) -> [f64; 2] {
    let squared = b[0] * b[0] + b[1] * b[1];
    [-moment * b[1] / squared, moment * b[0] / squared]
}

impl Station {
    fn quantities(&self, q: &[f64]) -> Quantities<f64> {
        let mut v = Quantities::zeros();
        for i in 0..NODES {
            for c in 0..2 {
                let (r, b) = (q[PER_NODE * i + c], q[PER_NODE * i + 2 + c]);
                v[c] += self.slopes[i] * r;
                v[2 + c] += self.values[i] * b;
                v[4 + c] += self.slopes[i] * b;
            }
        }
        v
    }

    fn scatter(&self, slope: &Quantities<f64>, force: &mut [f64; SIZE]) {
        for i in 0..NODES {
            for c in 0..2 {
                force[PER_NODE * i + c] += self.weight * self.slopes[i] * slope[c];
                force[PER_NODE * i + 2 + c] +=
                    self.weight * (self.values[i] * slope[2 + c] + self.slopes[i] * slope[4 + c]);
            }
        }
    }

    /// Factors of the coordinates `(node, vector)` in the section quantities, as `(quantity, factor)`.
    fn factors(&self, node: usize, vector: usize) -> [(usize, f64); 2] {
        match vector {
            0 => [(0, self.slopes[node]), (0, 0.0)],
            _ => [(2, self.values[node]), (4, self.slopes[node])],
        }
    }

    fn scatter_matrix(
        &self,
        m: &nalgebra::SMatrix<f64, QUANTITIES, QUANTITIES>,
        tangent: &mut [[f64; SIZE]; SIZE],
    ) {
        for row in 0..SIZE {
            let (i, a) = (row / PER_NODE, row % PER_NODE);
            for column in 0..SIZE {
                let (j, b) = (column / PER_NODE, column % PER_NODE);
                let mut sum = 0.0;
                for (k, f) in self.factors(i, a / 2) {
                    for (l, g) in self.factors(j, b / 2) {
                        sum += f * g * m[(k + a % 2, l + b % 2)];
                    }
                }
                tangent[row][column] += self.weight * sum;
            }
        }
    }
}
