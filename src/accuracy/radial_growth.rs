//! Radial growth of long spinning bodies: the closed form, and how much of it a polynomial section reaches.
//!
//! A long circle or tube with free ends, linear elasticity: plane strain plus a uniform axial strain
//! `e = -nu rho W^2 (a^2 + b^2) / (2 E)`. Source: derived in docs/theory/growth.md#closed-form.

use crate::element::basis::SectionProducts;
use crate::element::continuum::lame;
use crate::element::fields::SectionFunctions;
use crate::model::Material;
use crate::section::Section;
use crate::section::basis::SectionBasis;
use nalgebra::{DMatrix, DVector};

/// Radial displacement (m) at radius r (m) of a long circle or tube that spins with `speed` (rad/s).
pub fn closed_form(section: &Section, material: &Material, speed: f64, r: f64) -> Option<f64> {
    if !section.is_axisymmetric() {
        return None;
    }
    let (a, b) = (section.inner[0], section.outer[0]);
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let load = material.density * speed * speed;
    let n = nu / (1.0 - nu);
    let hollow = if a > 0.0 { (1.0 + n) * (3.0 + n) * (a * b / r).powi(2) } else { 0.0 };
    let plane_strain = load * (1.0 - nu * nu) / (8.0 * e)
        * r
        * ((3.0 + n) * (1.0 - n) * (a * a + b * b) + hollow - (1.0 - n * n) * r * r);
    let axial = -nu * load * (a * a + b * b) / (2.0 * e);
    Some(plane_strain - nu * axial * r)
}

/// In-plane displacements of every function, u_y before u_z, and the uniform axial strain of a long body under forces on
/// its functions (N/m): the linear problem in the functions of a basis. With the functions themselves.
pub fn long_body(
    section: &Section,
    material: &Material,
    basis: SectionBasis,
    forces: impl Fn(&SectionFunctions) -> [Vec<f64>; 2],
) -> Option<(SectionFunctions, DVector<f64>)> {
    let (lambda, mu) = lame(material);
    let b = section.outer[0];
    let products = SectionProducts::new(basis, section, b);
    let functions = SectionFunctions::new(basis, section, b);
    let pull = forces(&functions);
    let n = basis.count();
    // unknowns: u_y and u_z of every vector, and the uniform axial strain
    let size = 2 * n + 1;
    let mut k = DMatrix::zeros(size, size);
    let mut f = DVector::zeros(size);
    for i in 0..2 * n {
        for j in 0..2 * n {
            k[(i, j)] = products.plane_stiffness((lambda, mu), i, j);
        }
    }
    for i in 0..n {
        for c in 0..2 {
            f[2 * i + c] = pull[c][i];
            let coupling = lambda * products.gradient(0, c + 1)[(0, i)];
            k[(2 * i + c, size - 1)] = coupling;
            k[(size - 1, 2 * i + c)] = coupling;
        }
    }
    k[(size - 1, size - 1)] = (lambda + 2.0 * mu) * products.area;
    // translations and the rotation carry no load
    for (vector, component) in [(0, 0), (0, 1), (1, 1)] {
        let at = 2 * vector + component;
        k[(at, at)] += material.youngs_modulus;
    }
    // a thin wall is stiff across: each unknown in its own measure
    let scale = k.diagonal().map(|d| 1.0 / d.sqrt());
    let scaled = DMatrix::from_fn(size, size, |i, j| k[(i, j)] * scale[i] * scale[j]);
    let u = scaled.cholesky()?.solve(&f.component_mul(&scale)).component_mul(&scale);
    Some((functions, u))
}

/// Relative error of the radial displacement at radius r of a long body with the functions of a basis over its
/// section: the solution of the same linear problem in these functions over the closed form.
pub fn basis_error(section: &Section, material: &Material, basis: SectionBasis, r: f64) -> Option<f64> {
    let exact = closed_form(section, material, 1.0, r)?;
    let pull = |functions: &SectionFunctions| {
        [(1, 0), (0, 1)].map(|(a, b)| {
            functions.integrals(section, a, b).into_iter().map(|f| material.density * f).collect()
        })
    };
    let (functions, u) = long_body(section, material, basis, pull)?;
    let ours: f64 = functions.at(r, 0.0).iter().enumerate().map(|(i, f)| f[0] * u[2 * i]).sum();
    Some(ours / exact - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material {
        youngs_modulus: 2.1e11,
        poisson_ratio: 0.3,
        density: 7850.0,
        stiffness_damping: 0.0,
        loss_factor: 0.0,
        mass_damping: 0.0,
    };

    #[test]
    fn the_closed_form_has_the_known_values() {
        // three-dimensional reference for a long cylinder, radius 0.1, 15000 rpm, micrometres at k R/8
        let known = [0.0, 3.0715, 6.0426, 8.8129, 11.2822, 13.350, 14.916, 15.880, 16.1409];
        for (k, u) in known.into_iter().enumerate() {
            let r = 0.1 * k as f64 / 8.0;
            let ours = closed_form(&Section::circle(0.1), &STEEL, 1570.796, r).unwrap() * 1e6;
            assert!((ours - u).abs() < 6e-4, "{k}: {ours} {u}");
        }
    }

    #[test]
    fn polynomials_reach_circles_but_not_bores() {
        let error = |section: &Section, order| {
            basis_error(section, &STEEL, SectionBasis::Monomials(order), section.outer[0]).unwrap()
        };
        for order in 3..=5 {
            assert!(error(&Section::circle(0.1), order).abs() < 1e-12);
        }
        // numpy model, same problem: cubic section, tubes of three walls
        for (inner, expected, tolerance) in [(0.15, -0.139, 5e-4), (0.1, -0.26, 5e-3), (0.19, -0.007, 5e-4)] {
            let e = error(&Section::tube(0.2, inner), 3);
            assert!((e - expected).abs() < tolerance, "{inner}: {e}");
        }
        assert!(error(&Section::tube(0.2, 0.15), 5).abs() < 0.01);
    }
}
