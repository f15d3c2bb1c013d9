//! Linear stiffness of the structural comparison element 3333s (solid circle).
//!
//! With u the axis displacement and v, w the changes of r_,y and r_,z, the strains of the theory become
//!
//! ```text
//!     Gamma = (u_x', u_y' + v_x, u_z' + w_x),  kappa = (-w_y', w_x', -v_x'),
//!     E_yy = v_y,  E_zz = w_z,  E_yz = (w_y + v_z)/2
//! ```
//!
//! and the energy per length is half of `EA G1^2 + ks GA (G2^2 + G3^2) + GJ k1^2 + EI (k2^2 + k3^2) +
//! EA E_yy^2 + EA E_zz^2 + 2 GA E_yz^2`. Integrated exactly. Source: docs/theory.md section 4.

use super::basis::AxialProducts;
use super::continuum::{lame, shear_correction};
use crate::model::Material;
use crate::section::Section;
use faer::Mat;

/// One term `factor * (d/dx)^derived of component of vector`.
struct Term {
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
    let e = material.youngs_modulus;
    let (_, g) = lame(material);
    let area = section.area();
    let inertia = section.moment(2, 0);
    let ks = shear_correction(section, material.poisson_ratio);
    let scale = 1.0 / reference_length;
    let [u, v, w] = [(0, 1.0), (1, scale), (2, scale)];
    let [x, y, z] = [0, 1, 2];
    let term = |(vector, scale): (usize, f64), component, derived, factor: f64| Term {
        vector,
        component,
        derived,
        factor: factor * scale,
    };
    let strains = [
        (e * area, vec![term(u, x, true, 1.0)]),
        (ks * g * area, vec![term(u, y, true, 1.0), term(v, x, false, 1.0)]),
        (ks * g * area, vec![term(u, z, true, 1.0), term(w, x, false, 1.0)]),
        (g * 2.0 * inertia, vec![term(w, y, true, -1.0)]),
        (e * inertia, vec![term(w, x, true, 1.0)]),
        (e * inertia, vec![term(v, x, true, -1.0)]),
        (e * area, vec![term(v, y, false, 1.0)]),
        (e * area, vec![term(w, z, false, 1.0)]),
        (2.0 * g * area, vec![term(w, y, false, 0.5), term(v, z, false, 0.5)]),
    ];
    let n_nodes = axial.get(false, false).nrows();
    let mut matrix = Mat::zeros(9 * n_nodes, 9 * n_nodes);
    for (modulus, terms) in &strains {
        for p in terms {
            for q in terms {
                let lengths = axial.get(p.derived, q.derived);
                for i in 0..n_nodes {
                    for j in 0..n_nodes {
                        let (row, column) =
                            ((i * 3 + p.vector) * 3 + p.component, (j * 3 + q.vector) * 3 + q.component);
                        matrix[(row, column)] += modulus * p.factor * q.factor * lengths[(i, j)];
                    }
                }
            }
        }
    }
    matrix
}
