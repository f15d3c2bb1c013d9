//! Linear stiffness of the continuum members 34X1 .. 34X5 and of the comparison element 3333c.
//!
//! With `u_a,alpha` the displacement gradient and `c = d2W / du_a,alpha du_b,beta`,
//!
//! ```text
//!     K0 = sum_(alpha,beta) [int L^(alpha) L^(beta) dx] (x) [int m_,alpha m_,beta dA] (x) C_alpha_beta
//! ```
//!
//! where alpha = x derives the axial factor and y, z the section factor; `C_alpha_beta[a][b] =
//! D[voigt(a,alpha)][voigt(b,beta)]`. Exact; source: docs/theory/elements.md#matrices and
//! docs/theory/elements.md#element-3333c.

use crate::element::basis::{AxialProducts, SectionProducts};
use crate::element::inertia::add_kronecker;
use crate::model::Material;
use crate::section::Section;
use faer::Mat;
use nalgebra::{Matrix3, Matrix6};

/// Index of a strain in the order 11, 22, 33, 2*23, 2*13, 2*12.
const VOIGT: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// Lame's constants `(lambda, mu)`, Pa.
pub fn lame(material: &Material) -> (f64, f64) {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)))
}

/// Elasticity matrix of an isotropic solid, Pa, strains in the order 11, 22, 33, 2*23, 2*13, 2*12.
pub fn isotropic(material: &Material) -> Matrix6<f64> {
    let (lambda, mu) = lame(material);
    Matrix6::from_fn(|i, j| {
        let normal = if i < 3 && j < 3 { lambda } else { 0.0 };
        let diagonal = if i != j { 0.0 } else { if i < 3 { 2.0 * mu } else { mu } };
        normal + diagonal
    })
}

/// Stiffness about the undeformed state for the elasticity matrix `d`, N/m.
pub fn stiffness(d: &Matrix6<f64>, axial: &AxialProducts, section: &SectionProducts) -> Mat<f64> {
    let size = 3 * axial.get(false, false).nrows() * section.plain().nrows();
    let mut matrix = Mat::zeros(size, size);
    for alpha in 0..3 {
        for beta in 0..3 {
            let block = Matrix3::from_fn(|a, b| d[(VOIGT[a][alpha], VOIGT[b][beta])]);
            let lengths = axial.get(alpha == 0, beta == 0);
            add_kronecker(&mut matrix, lengths, section.gradient(alpha, beta), &block);
        }
    }
    matrix
}

/// Stiffness of 3333c: `diag(E, E, E, G, ks G, ks G)` over the volume, and the Poisson coupling on the
/// axis only (times the area), so that the linear section does not lock.
pub fn split_stiffness(
    section: &Section,
    material: &Material,
    axial: &AxialProducts,
    products: &SectionProducts,
) -> Mat<f64> {
    let (lambda, g) = lame(material);
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let ks = section.shear_correction(nu);
    let mut volume = Matrix6::zeros();
    for (i, modulus) in [e, e, e, g, ks * g, ks * g].into_iter().enumerate() {
        volume[(i, i)] = modulus;
    }
    let mut on_axis = Matrix6::zeros();
    for i in 0..3 {
        for j in 0..3 {
            on_axis[(i, j)] = if i == j { 2.0 * nu * lambda } else { lambda };
        }
    }
    stiffness(&volume, axial, products) + stiffness(&on_axis, axial, &products.on_axis(1))
}
