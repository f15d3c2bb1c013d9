//! Mass, gyroscopic and spin-softening matrices: Kronecker products of axial and section integrals.
//!
//! ```text
//!     M = rho   [int L_i L_j dx] (x) [int m_k m_l dA]                   (x) I3
//!     G = 2 rho [int L_i L_j dx] (x) [int m_k (d_theta m_l) dA]         (x) I3
//!     N = rho   [int L_i L_j dx] (x) [int (d_theta m_k)(d_theta m_l) dA] (x) I3
//! ```
//!
//! Stationary frame, spin about +x; source: docs/theory/elements.md#matrices.

use crate::element::basis::{AxialProducts, SectionProducts};
use faer::Mat;
use nalgebra::Matrix3;

/// Constant consistent mass matrix, kg.
pub fn mass(density: f64, axial: &AxialProducts, section: &SectionProducts) -> Mat<f64> {
    with_identity(density, axial, section.plain())
}

/// Gyroscopic matrix per unit spin speed, kg.
pub fn gyroscopic(density: f64, axial: &AxialProducts, section: &SectionProducts) -> Mat<f64> {
    with_identity(2.0 * density, axial, &section.rotation)
}

/// Spin-softening matrix per unit spin speed squared, kg.
pub fn spin_softening(density: f64, axial: &AxialProducts, section: &SectionProducts) -> Mat<f64> {
    with_identity(density, axial, &section.rotation_rotation)
}

fn with_identity(factor: f64, axial: &AxialProducts, section: &Mat<f64>) -> Mat<f64> {
    let lengths = axial.get(false, false);
    let size = 3 * lengths.nrows() * section.nrows();
    let mut matrix = Mat::zeros(size, size);
    add_kronecker(&mut matrix, lengths, section, &(Matrix3::identity() * factor));
    matrix
}

/// `matrix += axial (x) section (x) block`, in the coordinate order of the element.
pub fn add_kronecker(matrix: &mut Mat<f64>, axial: &Mat<f64>, section: &Mat<f64>, block: &Matrix3<f64>) {
    let n_vectors = section.nrows();
    for j in 0..axial.ncols() {
        for l in 0..n_vectors {
            for i in 0..axial.nrows() {
                for k in 0..n_vectors {
                    let factor = axial[(i, j)] * section[(k, l)];
                    if factor == 0.0 {
                        continue;
                    }
                    let (row, column) = ((i * n_vectors + k) * 3, (j * n_vectors + l) * 3);
                    for c in 0..3 {
                        for d in 0..3 {
                            matrix[(row + c, column + d)] += factor * block[(c, d)];
                        }
                    }
                }
            }
        }
    }
}

/// `D_theta - J` on element coordinates: what spin adds to the rate of strain, per unit speed.
pub fn convection(size: usize, turn: &Mat<f64>) -> Mat<f64> {
    let n_vectors = turn.nrows();
    Mat::from_fn(size, size, |i, j| {
        let (vi, vj) = (i / 3, j / 3);
        if vi / n_vectors != vj / n_vectors {
            return 0.0;
        }
        let (k, l, c, d) = (vi % n_vectors, vj % n_vectors, i % 3, j % 3);
        let moved = if c == d { turn[(k, l)] } else { 0.0 };
        let turned = if k != l {
            0.0
        } else {
            match (c, d) {
                (1, 2) => -1.0,
                (2, 1) => 1.0,
                _ => 0.0,
            }
        };
        moved - turned
    })
}
