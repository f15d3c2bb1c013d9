//! Pressure on the surface as it is now, and tractions that turn with it.
//!
//! On a line of the lateral surface with the tangent t (counterclockwise about x) the area of a piece `ds dx` is
//! `a = (r_,y t_y + r_,z t_z) x r_,x`, along the normal to the right of t; a pressure p exerts `-p a`. A traction that follows
//! is given per undeformed area along the axes of the section, turned with it. Source: docs/theory/loads.md#loads.

use crate::element::basis::{derivative, evaluate, lagrange};
use crate::element::boundary_curve::{LinePoint, line};
use crate::element::quadrature::gauss;
use crate::model::{ActsOn, Element, Model, SurfaceLoad, Traction};
use crate::shaft::attachments::{Contribution, Numbering, Region, functions};
use crate::shaft::loads::section::{frame, turn};
use faer::Mat;
use nalgebra::{SMatrix, SVector};
use num_dual::jacobian;

/// A place along the element: weight times length, and values and derivatives by x of the axial functions.
struct Station {
    weight: f64,
    value: Vec<f64>,
    slope: Vec<f64>,
}

/// A point around the section: weights of the vectors in the position and in its derivative along the line, times the length
/// it stands for.
struct Around {
    value: Vec<f64>,
    tangent: Vec<f64>,
}

/// What acts on the surface: a pressure, or a traction that follows the section.
enum ActingLoad {
    /// Pressure, Pa, on these points.
    Pressure(f64, Vec<Around>),
    /// Traction along the section's axes, Pa; lengths times functions summed over the line, the rows of d_y and d_z, and the
    /// weights of the rotation.
    Traction([f64; 3], Vec<f64>, [Vec<f64>; 2], [f64; 2]),
}

/// A load on the surface of one element.
pub struct ElementSurface {
    /// First coordinate of the vectors of every node of the element.
    starts: Vec<usize>,
    /// Number of vectors of a node.
    vectors: usize,
    stations: Vec<Station>,
    acting: ActingLoad,
}

impl ElementSurface {
    /// Prepares a load on an element.
    pub fn new(model: &Model, numbering: &Numbering, e: &Element, load: &Traction) -> Self {
        let degree = e.kind.axial_degree;
        let polynomials = lagrange(degree);
        // r_,s x r_,x . dr is of degree 3 p - 1 in x
        let stations = gauss((3 * degree).div_ceil(2))
            .into_iter()
            .map(|(xi, w)| Station {
                weight: w * e.length / 2.0,
                value: polynomials.iter().map(|l| evaluate(l, xi)).collect(),
                slope: polynomials.iter().map(|l| evaluate(&derivative(l), xi) * 2.0 / e.length).collect(),
            })
            .collect();
        let section = &model.sections[e.section];
        let field = e.field();
        let (functions, line) = (functions(model, field), line(section, load.surface));
        let acting = match load.load {
            SurfaceLoad::Pressure(p) => {
                let around = |point: &LinePoint| {
                    let at = functions.at(point.y, point.z);
                    let [n_y, n_z] = point.normal;
                    Around {
                        value: at.iter().map(|f| f[0]).collect(),
                        tangent: at.iter().map(|f| n_y * f[2] - n_z * f[1]).collect(),
                    }
                };
                ActingLoad::Pressure(p, line.iter().map(around).collect())
            }
            SurfaceLoad::Traction(t) => {
                let length = functions.along_any(&line, |p| p.length);
                let mean = Region::of_field(model, field, ActsOn::Section);
                let (rows, weights) = mean.map_or_else(
                    || ([Vec::new(), Vec::new()], [1.0; 2]),
                    |region| {
                        let [_, y, z] = region.affine(model.reference_length);
                        ([y, z], [1.0, region.moment(0, 2) / region.moment(2, 0)])
                    },
                );
                ActingLoad::Traction(t, length, rows, weights)
            }
        };
        let starts = (0..=degree).map(|i| numbering.of_element(e, i)).collect();
        Self { starts, vectors: e.n_vectors(), stations, acting }
    }

    /// `sum_i axial_i q_ik` of every vector k.
    fn vectors_at(&self, q: &[f64], axial: &[f64]) -> Vec<[f64; 3]> {
        let one = |k: usize| {
            let sum = |c: usize| {
                self.starts.iter().zip(axial).map(|(start, s)| s * q[start + 3 * k + c]).sum::<f64>()
            };
            [sum(0), sum(1), sum(2)]
        };
        (0..self.vectors).map(one).collect()
    }

    /// Adds a factor times the forces in a place q.
    pub fn add(&self, q: &[f64], factor: f64, force: &mut [f64]) {
        for station in &self.stations {
            let values = self.vectors_at(q, &station.value);
            let mut on_vectors = vec![[0.0; 3]; self.vectors];
            match &self.acting {
                ActingLoad::Pressure(p, points) => {
                    let slopes = self.vectors_at(q, &station.slope);
                    for point in points {
                        let (along, axial) = (sum(&point.tangent, &values), sum(&point.value, &slopes));
                        let area = cross(along, axial);
                        for (f, value) in on_vectors.iter_mut().zip(&point.value) {
                            (0..3).for_each(|c| f[c] -= p * value * area[c]);
                        }
                    }
                }
                ActingLoad::Traction(t, lengths, [y, z], weights) => {
                    let t = turn(&frame(sum(y, &values), sum(z, &values), *weights), *t);
                    for (f, length) in on_vectors.iter_mut().zip(lengths) {
                        (0..3).for_each(|c| f[c] += length * t[c]);
                    }
                }
            }
            for (start, axial) in self.starts.iter().zip(&station.value) {
                for (k, f) in on_vectors.iter().enumerate() {
                    (0..3).for_each(|c| force[start + 3 * k + c] += factor * station.weight * axial * f[c]);
                }
            }
        }
    }

    /// Derivative of the forces by the coordinates, `d force / d q`; without symmetry.
    pub fn tangent(&self, q: &[f64]) -> Contribution {
        let n = 3 * self.vectors * self.starts.len();
        let mut matrix = Mat::<f64>::zeros(n, n);
        for station in &self.stations {
            let values = self.vectors_at(q, &station.value);
            // d (force on vector k) / d (vector l), by its value and by its slope
            let (by_value, by_slope) = match &self.acting {
                ActingLoad::Pressure(p, points) => {
                    self.pressure_tangent(*p, points, &values, &self.vectors_at(q, &station.slope))
                }
                ActingLoad::Traction(t, lengths, rows, weights) => {
                    (traction_tangent(*t, lengths, rows, *weights, &values), Mat::zeros(0, 0))
                }
            };
            let m = 3 * self.vectors;
            for (i, row) in station.value.iter().enumerate() {
                for j in 0..self.starts.len() {
                    let (v, s) =
                        (station.weight * row * station.value[j], station.weight * row * station.slope[j]);
                    for b in 0..m {
                        for a in 0..m {
                            matrix[(m * i + a, m * j + b)] += v * by_value[(a, b)];
                            if by_slope.nrows() > 0 {
                                matrix[(m * i + a, m * j + b)] += s * by_slope[(a, b)];
                            }
                        }
                    }
                }
            }
        }
        let coordinates = self.starts.iter().flat_map(|&s| s..s + 3 * self.vectors).collect();
        Contribution { coordinates, matrix }
    }

    fn pressure_tangent(
        &self,
        p: f64,
        points: &[Around],
        values: &[[f64; 3]],
        slopes: &[[f64; 3]],
    ) -> (Mat<f64>, Mat<f64>) {
        let m = 3 * self.vectors;
        let (mut by_value, mut by_slope) = (Mat::<f64>::zeros(m, m), Mat::<f64>::zeros(m, m));
        for point in points {
            // d (along x axial) = - axial x d along + along x d axial
            let across_axial = skew(sum(&point.value, slopes));
            let across_along = skew(sum(&point.tangent, values));
            for (l, (tangent, function)) in point.tangent.iter().zip(&point.value).enumerate() {
                for (k, value) in point.value.iter().enumerate() {
                    for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                        by_value[(3 * k + a, 3 * l + b)] += p * value * tangent * across_axial[a][b];
                        by_slope[(3 * k + a, 3 * l + b)] -= p * value * function * across_along[a][b];
                    }
                }
            }
        }
        (by_value, by_slope)
    }
}

fn traction_tangent(
    t: [f64; 3],
    lengths: &[f64],
    rows: &[Vec<f64>; 2],
    weights: [f64; 2],
    values: &[[f64; 3]],
) -> Mat<f64> {
    let [y, z] = [0, 1].map(|k| sum(&rows[k], values));
    let images = SVector::<f64, 6>::from([y[0], y[1], y[2], z[0], z[1], z[2]]);
    let (_, turning): (SVector<f64, 3>, SMatrix<f64, 3, 6>) = jacobian(
        |d| SVector::from(turn(&frame([d[0], d[1], d[2]], [d[3], d[4], d[5]], weights), t)),
        &images,
    );
    let m = 3 * lengths.len();
    Mat::from_fn(m, m, |a, b| {
        let by = |k: usize| turning[(a % 3, 3 * k + b % 3)] * rows[k][b / 3];
        lengths[a / 3] * (by(0) + by(1))
    })
}

/// Weighted sum of the vectors of a node, `sum_k weight_k vector_k`.
fn sum(weights: &[f64], vectors: &[[f64; 3]]) -> [f64; 3] {
    let mut total = [0.0; 3];
    for (w, v) in weights.iter().zip(vectors) {
        (0..3).for_each(|c| total[c] += w * v[c]);
    }
    total
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The matrix A of the cross product, `A b = a x b`.
fn skew(a: [f64; 3]) -> [[f64; 3]; 3] {
    [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]
}
