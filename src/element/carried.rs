//! What a segment carries: mass on its centre line, and the initial stress of an axial force or a torque.
//!
//! Source: docs/theory/elements.md#added-mass and docs/theory/linear-rotordynamics.md#initial-stress.

use crate::element::ElementMatrices;
use crate::element::basis::{AxialProducts, SectionProducts};
use crate::element::inertia::add_kronecker;
use crate::model::Carried;
use crate::section::Section;
use faer::Mat;
use nalgebra::Matrix3;

/// Adds a mass per length m' (kg/m) that moves with the mean displacement of the section, `T = m'/2 int |w_k q_k'|^2 dx` with
/// the means w of the functions, and what spin makes of it: `2 m' w (x) t` to G and `m' t (x) t` to N with the means t of
/// `d_theta m_k`, which vanish on round sections.
pub fn add_mass(
    mass_per_length: f64,
    axial: &AxialProducts,
    plane: &SectionProducts,
    into: &mut ElementMatrices,
) {
    // the first function is 1
    let n = plane.plain().nrows();
    let mean: Vec<f64> = (0..n).map(|k| plane.plain()[(k, 0)] / plane.area).collect();
    let turned: Vec<f64> = (0..n).map(|k| plane.rotation[(0, k)] / plane.area).collect();
    let block = Matrix3::identity() * mass_per_length;
    let lengths = axial.get(false, false);
    let products = |a: &[f64], b: &[f64], factor: f64| Mat::from_fn(n, n, |k, l| factor * a[k] * b[l]);
    add_kronecker(&mut into.mass, lengths, &products(&mean, &mean, 1.0), &block);
    add_kronecker(&mut into.gyroscopic, lengths, &products(&mean, &turned, 2.0), &block);
    add_kronecker(&mut into.spin_softening, lengths, &products(&turned, &turned, 1.0), &block);
}

/// Geometric stiffness `int S_ab u_,a . v_,b dV` of the initial stress: of an axial force `P/A int u_,x . v_,x dA`, of a torque
/// `T/J int (u_,x . d_theta v + d_theta u . v_,x) dA`. `None` without initial stress.
pub fn initial_stress(
    carried: &Carried,
    section: &Section,
    axial: &AxialProducts,
    plane: &SectionProducts,
) -> Option<Mat<f64>> {
    if (carried.axial_force, carried.torque) == (0.0, 0.0) {
        return None;
    }
    let size = 3 * axial.get(false, false).nrows() * plane.plain().nrows();
    let mut matrix = Mat::zeros(size, size);
    let tension = Matrix3::identity() * (carried.axial_force / plane.area);
    add_kronecker(&mut matrix, axial.get(true, true), plane.plain(), &tension);
    let polar = section.moment(2, 0) + section.moment(0, 2);
    let shear = Matrix3::identity() * (carried.torque / polar);
    add_kronecker(&mut matrix, axial.get(true, false), &plane.rotation, &shear);
    add_kronecker(&mut matrix, axial.get(false, true), &plane.rotation.transpose().to_owned(), &shear);
    Some(matrix)
}
