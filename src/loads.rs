//! Dead loads as forces on all coordinates: forces and moments at nodes, tractions on the surface, gravity.
//!
//! A force on a section or a boundary of it is spread over that evenly, a moment as the linear traction with that resultant;
//! "axis" loads act on r, r_,y and r_,z alone. Tractions and pressures act on the undeformed surface. Source: docs/theory.md
//! section 7.

use crate::element::basis::{evaluate, lagrange};
use crate::element::outline::{LinePoint, line};
use crate::element::quadrature::gauss;
use crate::forces::ScalarMass;
use crate::model::{Element, Field, Load, LoadKind, Model, SurfaceLoad, Traction};
use crate::section::Surface;
use crate::support::{Numbering, Region, displacement_weights, functions};

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

/// Tractions `t = m_x / (I_yy + I_zz) (0, -z, y) + (m_y z / I_zz - m_z y / I_yy, 0, 0)` over the section or a boundary, with
/// `I_yy = int y^2`; on the axis the same moments by couples on r_,y and r_,z.
fn add_moment(model: &Model, numbering: &Numbering, load: &Load, m: [f64; 3], force: &mut [f64]) {
    let r = model.reference_length;
    let mut add = |k: usize, c: usize, value: f64| force[numbering.index(load.node, k, c)] += value;
    let Some(region) = Region::new(model, load.node, load.acts_on) else {
        add(1, 2, m[0] / (2.0 * r));
        add(2, 1, -m[0] / (2.0 * r));
        add(2, 0, m[1] / r);
        add(1, 0, -m[2] / r);
        return;
    };
    let (yy, zz) = (region.moment(2, 0), region.moment(0, 2));
    let (with_y, with_z) = (region.integrals(1, 0), region.integrals(0, 1));
    for (k, (with_y, with_z)) in with_y.into_iter().zip(with_z).enumerate() {
        add(k, 0, m[1] * with_z / zz - m[2] * with_y / yy);
        add(k, 1, -m[0] * with_z / (yy + zz));
        add(k, 2, m[0] * with_y / (yy + zz));
    }
}

fn add_traction(model: &Model, numbering: &Numbering, e: &Element, t: &Traction, force: &mut [f64]) {
    let line = line(&model.sections[e.section], t.surface);
    let along: Vec<f64> = lagrange(e.kind.axial_degree)
        .iter()
        .map(|l| gauss(e.kind.axial_degree).iter().map(|&(xi, w)| w * evaluate(l, xi) * e.length / 2.0).sum())
        .collect();
    let functions = functions(model, Field { basis: e.kind.basis, section: e.section });
    // halves are not symmetric about z
    let whole = matches!(t.surface, Surface::Bore | Surface::Rim);
    let around = |odd: [bool; 2], weight: &dyn Fn(&LinePoint) -> f64| {
        if whole { functions.along(&line, odd, weight) } else { functions.along_any(&line, weight) }
    };
    let length = |p: &LinePoint| p.length;
    let components: [Vec<f64>; 3] = match t.load {
        SurfaceLoad::Traction(t) => {
            let around = around([false, false], &length);
            t.map(|t| around.iter().map(|a| t * a).collect())
        }
        SurfaceLoad::Pressure(p) => [
            vec![0.0; e.kind.n_vectors()],
            around([true, false], &|point| -p * point.normal[0]),
            around([false, true], &|point| -p * point.normal[1]),
        ],
    };
    for (c, around) in components.into_iter().enumerate() {
        for (k, around) in around.into_iter().enumerate() {
            for (i, length) in along.iter().enumerate() {
                force[numbering.of_element(e, i) + 3 * k + c] += around * length;
            }
        }
    }
}
