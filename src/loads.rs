//! Dead loads as forces on all coordinates: forces and moments at nodes, tractions on the surface, gravity.
//!
//! A force on a section is spread over it evenly, a moment as the linear traction with that resultant; "axis"
//! loads act on r, r_,y and r_,z alone. Tractions act on the undeformed surface. Source: docs/theory.md
//! section 7.

use crate::element::basis::{evaluate, lagrange};
use crate::element::quadrature::gauss;
use crate::forces::ScalarMass;
use crate::model::{ActsOn, Element, Field, Load, LoadKind, Model, Traction};
use crate::section::{Section, Shape};
use crate::support::{Numbering, displacement_weights, functions, functions_at, section_at};
use std::f64::consts::PI;

/// Gauss points over a half circumference or a face, and along an element.
const POINTS: usize = 32;

/// Forces, moments and tractions on all coordinates, N.
pub fn dead_loads(model: &Model, numbering: &Numbering) -> Vec<f64> {
    let mut force = vec![0.0; numbering.len()];
    for load in &model.loads {
        match load.kind {
            LoadKind::Force(f) => {
                let weights = displacement_weights(model, load.node, load.acts_on);
                for (k, w) in weights.into_iter().enumerate() {
                    for c in 0..3 {
                        force[numbering.index(load.node, k, c)] += w * f[c];
                    }
                }
            }
            LoadKind::Moment(m) => add_moment(model, numbering, load, m, &mut force),
        }
    }
    for traction in &model.tractions {
        for element in &model.elements {
            add_traction(model, numbering, element, traction, &mut force);
        }
    }
    force
}

/// Weight of shaft and disks on all coordinates, N.
pub fn weight(model: &Model, numbering: &Numbering, mass: &ScalarMass) -> Vec<f64> {
    let mut acceleration = vec![0.0; numbering.len()];
    for node in 0..model.nodes.len() {
        for first in numbering.fields(node) {
            acceleration[first..first + 3].copy_from_slice(&model.gravity);
        }
    }
    let mut force = vec![0.0; numbering.len()];
    mass.multiply(&acceleration, &mut force);
    force
}

/// Tractions `t = m_x / (I_yy + I_zz) (0, -z, y) + (m_y z / I_zz - m_z y / I_yy, 0, 0)` over the section, with
/// `I_yy = int y^2 dA`; on the axis the same moments by couples on r_,y and r_,z.
fn add_moment(model: &Model, numbering: &Numbering, load: &Load, m: [f64; 3], force: &mut [f64]) {
    let r = model.reference_length;
    let mut add = |k: usize, c: usize, value: f64| force[numbering.index(load.node, k, c)] += value;
    let section = match (load.acts_on, section_at(model, load.node)) {
        (ActsOn::Section, Some(section)) => section,
        _ => {
            add(1, 2, m[0] / (2.0 * r));
            add(2, 1, -m[0] / (2.0 * r));
            add(2, 0, m[1] / r);
            add(1, 0, -m[2] / r);
            return;
        }
    };
    let (yy, zz) = (section.moment(2, 0), section.moment(0, 2));
    let functions = functions_at(model, load.node);
    let (with_y, with_z) = (functions.integrals(&section, 1, 0), functions.integrals(&section, 0, 1));
    for (k, (with_y, with_z)) in with_y.into_iter().zip(with_z).enumerate() {
        add(k, 0, m[1] * with_z / zz - m[2] * with_y / yy);
        add(k, 1, -m[0] * with_z / (yy + zz));
        add(k, 2, m[0] * with_y / (yy + zz));
    }
}

fn add_traction(model: &Model, numbering: &Numbering, e: &Element, t: &Traction, force: &mut [f64]) {
    let line = surface_line(&model.sections[e.section], t.top);
    let along: Vec<f64> = lagrange(e.kind.axial_degree)
        .iter()
        .map(|l| gauss(e.kind.axial_degree).iter().map(|&(xi, w)| w * evaluate(l, xi) * e.length / 2.0).sum())
        .collect();
    let functions = functions(model, Field { basis: e.kind.basis, section: e.section });
    let mut around = vec![0.0; e.kind.n_vectors()];
    for (y, z, w) in line {
        around.iter_mut().zip(functions.at(y, z)).for_each(|(sum, f)| *sum += w * f[0]);
    }
    for (k, around) in around.into_iter().enumerate() {
        for (i, length) in along.iter().enumerate() {
            let first = numbering.of_element(e, i) + 3 * k;
            for c in 0..3 {
                force[first + c] += t.traction[c] * around * length;
            }
        }
    }
}

/// Points `(y, z, weight)` of the upper or lower half of the outline; the weights sum to its length (m).
pub fn surface_line(section: &Section, top: bool) -> Vec<(f64, f64, f64)> {
    let [cy, cz] = section.outer;
    let side = if top { 1.0 } else { -1.0 };
    gauss(POINTS)
        .into_iter()
        .map(|(s, w)| match section.shape {
            Shape::Rectangle => (side * cy, cz * s, cz * w),
            Shape::Ellipse => {
                let (sin, cos) = (PI / 2.0 * s).sin_cos();
                (side * cy * cos, cz * sin, w * PI / 2.0 * (cy * sin).hypot(cz * cos))
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_have_their_length() {
        let length = |s: &Section| surface_line(s, true).iter().map(|p| p.2).sum::<f64>();
        assert!((length(&Section::circle(0.3)) - 0.3 * PI).abs() < 1e-14);
        assert!((length(&Section::rectangle(0.4, 0.7)) - 0.7).abs() < 1e-14);
        // half the circumference of an ellipse with semi-axes 1 and 2
        assert!((length(&Section::ellipse(1.0, 2.0)) - 9.688448220547675 / 2.0).abs() < 1e-10);
    }
}
