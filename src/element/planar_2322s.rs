//! The planar element 2322s: three nodes along x, at each the position r and the section vector `r_,y`.
//!
//! ```text
//!     r = sum_i L_i(xi) (r_i + y r_,y,i),  xi = 2 x/l:   L = xi (xi - 1)/2,  1 - xi^2,  xi (xi + 1)/2
//!     b = r_,y, c = b', n = |b|:   Gamma_1 = (r' x b)/n - 1,  Gamma_2 = r'.b/n,  kappa = (b x c)/n^2,
//!     U = 1/2 int EA Gamma_1^2 + ks GA Gamma_2^2 + EI kappa^2 dx + 1/2 int EA_t ((b.b - 1)/2)^2 dx
//! ```
//!
//! with `a x b = a_1 b_2 - a_2 b_1`. The first integral takes two Gauss points, the second three Lobatto points (the nodes);
//! more points lock. Coordinates: node by node `r_x, r_y, b_x, b_y`. Source: docs/theory/contact.md.

use crate::element::Kernel;
use crate::element::kernel::simd::Scratch;
use crate::model::scene::PlanarSection;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

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
struct PlanarStation {
    /// Weight of the station in an integral along the element, m.
    weight: f64,
    values: [f64; NODES],
    /// Slopes of the shape functions at the station, 1/m.
    slopes: [f64; NODES],
    /// Of the second integral.
    thickness: bool,
}

/// Internal force, tangent and mass of 2322s.
#[derive(Debug, Clone)]
pub struct PlanarElement {
    section: PlanarSection,
    length: f64,
    stations: [PlanarStation; 5],
}

/// Shape functions `L_i(xi)` of the three nodes, xi from -1 to 1.
pub fn values(xi: f64) -> [f64; NODES] {
    [xi * (xi - 1.0) / 2.0, 1.0 - xi * xi, xi * (xi + 1.0) / 2.0]
}

/// Their slopes `dL_i/dxi`.
pub fn slopes(xi: f64) -> [f64; NODES] {
    [xi - 0.5, -2.0 * xi, xi + 0.5]
}

/// Their second derivatives `d^2 L_i/dxi^2`, which are constant.
pub const CURVATURES: [f64; NODES] = [1.0, -2.0, 1.0];

/// `r'`, b and c.
type Quantities = SVector<f64, QUANTITIES>;
/// Second derivatives by them.
type Curvature = SMatrix<f64, QUANTITIES, QUANTITIES>;

impl PlanarElement {
    /// An element of that length, m.
    pub fn new(section: PlanarSection, length: f64) -> Self {
        let station = |xi: f64, weight: f64, thickness| PlanarStation {
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

    /// Energy per length psi, J/m, and `d psi/dv`.
    fn slope(&self, thickness: bool, v: &Quantities) -> (f64, Quantities) {
        if thickness {
            let (strain, b) = stretch_across(v);
            let stiffness = self.section.thickness;
            return (0.5 * stiffness * strain * strain, in_place(b * (stiffness * strain), 2));
        }
        let mut sum = (0.0, Quantities::zeros());
        for (stiffness, strain) in self.stiffnesses().into_iter().zip(strains(v)) {
            sum.0 += 0.5 * stiffness * strain.value * strain.value;
            sum.1 += strain.slope * (stiffness * strain.value);
        }
        sum
    }

    /// Second derivatives `d^2 psi/dv^2` of the energy per length by the section quantities.
    fn curvature(&self, thickness: bool, v: &Quantities) -> Curvature {
        let mut sum = Curvature::zeros();
        if thickness {
            let (strain, b) = stretch_across(v);
            let block = (Matrix2::identity() * strain + b * b.transpose()) * self.section.thickness;
            sum.fixed_view_mut::<2, 2>(2, 2).copy_from(&block);
        } else {
            let strains = strains(v).into_iter().zip(strain_curvatures(v));
            for (stiffness, (strain, curvature)) in self.stiffnesses().into_iter().zip(strains) {
                sum += (strain.slope * strain.slope.transpose() + curvature * strain.value) * stiffness;
            }
        }
        sum
    }

    /// Stiffnesses of [`strains`].
    fn stiffnesses(&self) -> [f64; 3] {
        [self.section.axial, self.section.shear, self.section.bending]
    }

    /// Strain energy U, J.
    pub fn energy(&self, q: &[f64]) -> f64 {
        self.stations.iter().map(|s| s.weight * self.slope(s.thickness, &s.quantities(q)).0).sum()
    }

    /// Force between two states whose work is exactly the change of the strain energy, `f . (q1 - q0) = U1 - U0`, and, where it
    /// is wanted, its derivative by `q1`: at every station the discrete gradient of Gonzalez (J. Nonlinear Sci. 6, 1996) in the section
    /// quantities v, which translations do not change:
    ///
    /// `psi_v(mid) + a S dv`, `a = (psi_1 - psi_0 - psi_v(mid).dv)/(dv.S dv)`, S giving c its length.
    pub fn average_force(&self, q0: &[f64], q1: &[f64], force: &mut [f64], mut tangent: Option<&mut [f64]>) {
        force.fill(0.0);
        if let Some(tangent) = tangent.as_deref_mut() {
            tangent.fill(0.0);
        }
        let radius = self.section.inertia / self.section.mass;
        let scale = Quantities::from([1.0, 1.0, 1.0, 1.0, radius, radius]);
        for s in &self.stations {
            let (v0, v1) = (s.quantities(q0), s.quantities(q1));
            let (middle, change) = ((v0 + v1) / 2.0, v1 - v0);
            let (_, slope) = self.slope(s.thickness, &middle);
            let (first, _) = self.slope(s.thickness, &v0);
            let (last, slope1) = self.slope(s.thickness, &v1);
            let scaled = change.component_mul(&scale);
            let size = change.dot(&scaled);
            let defect = last - first - slope.dot(&change);
            let moved = size > NO_CHANGE;
            let factor = if moved { defect / size } else { 0.0 };
            s.scatter(&(slope + scaled * factor), force);
            let Some(tangent) = tangent.as_deref_mut() else { continue };
            let curvature = self.curvature(s.thickness, &middle);
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

    /// Length of the undeformed element, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Stiffnesses and masses of its section.
    pub fn section(&self) -> &PlanarSection {
        &self.section
    }
}

impl Kernel for PlanarElement {
    fn size(&self) -> usize {
        SIZE
    }

    fn internal_force(&self, q: &[f64], _: Option<&[f64]>, force: &mut [f64], _: &mut Scratch) -> f64 {
        force.fill(0.0);
        let mut energy = 0.0;
        for s in &self.stations {
            let (density, slope) = self.slope(s.thickness, &s.quantities(q));
            energy += s.weight * density;
            s.scatter(&slope, force);
        }
        energy
    }

    fn tangent(&self, q: &[f64], tangent: &mut [f64], _: &mut Scratch) {
        tangent.fill(0.0);
        for s in &self.stations {
            let curvature = self.curvature(s.thickness, &s.quantities(q));
            s.scatter_matrix(&curvature, tangent);
        }
    }
}

/// Force on the section vector b of a moment M (N m, counter-clockwise): `M (-b_2, b_1)/|b|^2`.
pub fn moment_on_vector(moment: f64, b: [f64; 2]) -> [f64; 2] {
    let squared = b[0] * b[0] + b[1] * b[1];
    [-moment * b[1] / squared, moment * b[0] / squared]
}

impl PlanarStation {
    fn quantities(&self, q: &[f64]) -> Quantities {
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

    fn scatter(&self, slope: &Quantities, force: &mut [f64]) {
        for i in 0..NODES {
            for c in 0..2 {
                force[PER_NODE * i + c] += self.weight * self.slopes[i] * slope[c];
                force[PER_NODE * i + 2 + c] +=
                    self.weight * (self.values[i] * slope[2 + c] + self.slopes[i] * slope[4 + c]);
            }
        }
    }

    /// Adds `weight B^T m B` by columns, B being the derivative of the quantities by the coordinates.
    fn scatter_matrix(&self, m: &Curvature, tangent: &mut [f64]) {
        // weight B^T m
        let mut left = [[0.0; QUANTITIES]; SIZE];
        for i in 0..NODES {
            let (value, slope) = (self.weight * self.values[i], self.weight * self.slopes[i]);
            for c in 0..2 {
                for l in 0..QUANTITIES {
                    left[PER_NODE * i + c][l] = slope * m[(c, l)];
                    left[PER_NODE * i + 2 + c][l] = value * m[(2 + c, l)] + slope * m[(4 + c, l)];
                }
            }
        }
        for j in 0..NODES {
            let (value, slope) = (self.values[j], self.slopes[j]);
            for c in 0..2 {
                let place = PER_NODE * j + c;
                for (row, left) in left.iter().enumerate() {
                    tangent[SIZE * place + row] += left[c] * slope;
                    tangent[SIZE * (place + 2) + row] += left[2 + c] * value + left[4 + c] * slope;
                }
            }
        }
    }
}

/// A strain and its derivative by the section quantities.
struct Strain {
    value: f64,
    slope: Quantities,
}

/// A vector at a place of the section quantities.
fn in_place(part: Vector2<f64>, at: usize) -> Quantities {
    let mut v = Quantities::zeros();
    v[at] = part.x;
    v[at + 1] = part.y;
    v
}

/// `r'`, b and c.
fn vectors(v: &Quantities) -> [Vector2<f64>; 3] {
    [0, 2, 4].map(|k| Vector2::new(v[k], v[k + 1]))
}

/// `(b.b - 1)/2` and b.
fn stretch_across(v: &Quantities) -> (f64, Vector2<f64>) {
    let [_, b, _] = vectors(v);
    ((b.norm_squared() - 1.0) / 2.0, b)
}

/// `(a_2, -a_1)`, so that `x . turned(a)` is the product `x x a` of the plane.
fn turned(a: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(a.y, -a.x)
}

/// `Gamma_1, Gamma_2, kappa`.
fn strains(v: &Quantities) -> [Strain; 3] {
    let [s, b, c] = vectors(v);
    let n2 = b.norm_squared();
    let n = n2.sqrt();
    let (across, along, bent) = (s.dot(&turned(b)), s.dot(&b), b.dot(&turned(c)));
    let per_length = |x: f64, by_s: Vector2<f64>, by_b: Vector2<f64>| {
        in_place(by_s / n, 0) + in_place(by_b / n - b * (x / (n * n2)), 2)
    };
    let by_b = turned(c) / n2 - b * (2.0 * bent / (n2 * n2));
    [
        Strain { value: across / n - 1.0, slope: per_length(across, turned(b), -turned(s)) },
        Strain { value: along / n, slope: per_length(along, b, s) },
        Strain { value: bent / n2, slope: in_place(by_b, 2) - in_place(turned(b) / n2, 4) },
    ]
}

/// Second derivatives of [`strains`].
fn strain_curvatures(v: &Quantities) -> [Curvature; 3] {
    let [s, b, c] = vectors(v);
    let n2 = b.norm_squared();
    let n = n2.sqrt();
    let (one, turn) = (Matrix2::identity(), Matrix2::new(0.0, 1.0, -1.0, 0.0));
    let both = b * b.transpose();
    // of x/|b|^p by b twice, x being linear in b
    let by_b = |x: f64, slope: Vector2<f64>, p: f64, length: f64| {
        let mixed = slope * b.transpose();
        (mixed + mixed.transpose() + one * x) * (-p / (length * n2))
            + both * (p * (p + 2.0) * x / (length * n2 * n2))
    };
    let (across, along, bent) = (s.dot(&turned(b)), s.dot(&b), b.dot(&turned(c)));
    let mut list = [Curvature::zeros(); 3];
    let mut set = |strain: usize, row: usize, column: usize, block: Matrix2<f64>| {
        list[strain].fixed_view_mut::<2, 2>(row, column).copy_from(&block);
        list[strain].fixed_view_mut::<2, 2>(column, row).copy_from(&block.transpose());
    };
    set(0, 0, 2, turn / n - turned(b) * b.transpose() / (n * n2));
    set(0, 2, 2, by_b(across, -turned(s), 1.0, n));
    set(1, 0, 2, one / n - both / (n * n2));
    set(1, 2, 2, by_b(along, s, 1.0, n));
    set(2, 2, 4, turn / n2 + b * turned(b).transpose() * (2.0 / (n2 * n2)));
    set(2, 2, 2, by_b(bent, turned(c), 2.0, n2));
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slope and curvature of the energy against differences of it, at states with every strain.
    #[test]
    fn derivatives_are_those_of_the_energy() {
        let section = PlanarSection {
            mass: 3.0,
            inertia: 0.02,
            axial: 70.0,
            shear: 30.0,
            bending: 2.0,
            thickness: 50.0,
        };
        let element = PlanarElement::new(section, 0.7);
        for state in 0..4 {
            let part = |k: usize| 0.2 * (f64::from(state) * 1.7 + k as f64).sin();
            let v = Quantities::from([1.1 + part(0), part(1), part(2), 0.9 + part(3), part(4), part(5)]);
            for thickness in [false, true] {
                let ((_, slope), curvature) =
                    (element.slope(thickness, &v), element.curvature(thickness, &v));
                for k in 0..QUANTITIES {
                    let h = 1e-5;
                    let at = |step: f64| {
                        let mut moved = v;
                        moved[k] += step * h;
                        element.slope(thickness, &moved)
                    };
                    let (ahead, behind) = (at(1.0), at(-1.0));
                    let by_energy = (ahead.0 - behind.0) / (2.0 * h);
                    assert!((by_energy - slope[k]).abs() < 1e-7, "{state} {k}: {by_energy} {}", slope[k]);
                    let by_slope = (ahead.1 - behind.1) / (2.0 * h);
                    let miss = (by_slope - curvature.column(k)).amax();
                    assert!(miss < 1e-7, "{state} {k}: {miss:e}");
                }
            }
        }
    }
}
