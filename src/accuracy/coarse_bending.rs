//! How far each element turns from end to end, and what that costs: the error of large bending on coarse meshes.
//!
//! The polynomials of an element can't follow a bent axis without stretching it. That strain takes an energy of its own,
//! which grows with the length of the element over the radius of gyration i of its section: the element is too stiff.
//! With theta the angle between the normals of the sections at its ends and l its length an element adds its share, weighted by
//! theta^2, of
//!
//! ```text
//!     quadratic along x (3333s):   e = s a / (1 + s a),   a = 3.5e-3 theta^2 (l/i)^2
//!     cubic along x (34Xn, 34Rdh): e = s / (1 / a + 1 / b),   a = 0.5 theta^2,   b = 4.5e-4 theta^2 g^2 (l/i)^2
//! ```
//!
//! g is the change of theta from element to element over twice its mean (1/n on a cantilever). s = exp(-0.75 phi^2), phi the
//! largest turn of a section up to 1.5: a force loses its leverage on a bent shaft, and its displacement hardly depends on the
//! stiffness any more; under moments alone s = 1. Constants are measured on cantilevers: docs/theory/estimates.md#coarse-bending.

use crate::model::{ActsOn, Element, LoadKind, Model};
use crate::results::Diagnostic;
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::affine_rows;
use nalgebra::Vector3;

/// Error of the displacement that calls for a warning.
const COARSE: f64 = 1e-2;
/// Factor of `theta^2 (l/i)^2` in the error of elements that are quadratic along x.
const QUADRATIC_FACTOR: f64 = 3.5e-3;
/// Factors of `theta^2` and of `theta^2 g^2 (l/i)^2` in the error of elements that are cubic along x.
const CUBIC_FACTORS: [f64; 2] = [0.5, 4.5e-4];
/// Exponent of the leverage that a turned section loses, and the turn up to which it was measured, rad.
const LEVERAGE: (f64, f64) = (0.75, 1.5);

/// Normals (of any length) of the sections at the two ends of every element, for coordinates q.
fn normals(assembly: &Assembly<'_>, q: &[f64]) -> Vec<[Vector3<f64>; 2]> {
    let (model, numbering) = (assembly.model, &assembly.numbering);
    let normal = |node: usize| {
        let [_, y, z] = affine_rows(model, numbering, node, ActsOn::Section).map(|row| {
            row.iter().fold(Vector3::zeros(), |sum: Vector3<f64>, &(at, w)| {
                sum + Vector3::new(q[at], q[at + 1], q[at + 2]) * w
            })
        });
        y.cross(&z)
    };
    let ends = |e: &Element| [normal(e.first_node), normal(e.first_node + e.kind.axial_degree)];
    model.elements.iter().map(ends).collect()
}

fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// What is left of a force's leverage on the bent shaft: `exp(-0.75 phi^2)`; 1 where moments alone bend it.
fn leverage(model: &Model, normals: &[[Vector3<f64>; 2]]) -> f64 {
    let pulled = model.has_gravity()
        || model.has_bearing_offsets()
        || !model.tractions.is_empty()
        || model.loads.iter().any(|l| matches!(l.kind, LoadKind::Force(_)));
    if !pulled {
        return 1.0;
    }
    let turned = normals.iter().flatten().map(|n| angle(&Vector3::x(), n)).fold(0.0, f64::max);
    (-LEVERAGE.0 * turned.min(LEVERAGE.1).powi(2)).exp()
}

/// Estimated relative error of the largest displacement by the bending of single elements, and the largest angle (rad) that
/// an element turns.
pub fn bending_error(assembly: &Assembly<'_>, q: &[f64]) -> (f64, f64) {
    let model = assembly.model;
    let normals = normals(assembly, q);
    let theta: Vec<f64> = normals.iter().map(|[a, b]| angle(a, b)).collect();
    let total: f64 = theta.iter().map(|t| t * t).sum();
    let largest = theta.iter().fold(0.0, |m: f64, t| m.max(*t));
    if total == 0.0 {
        return (0.0, largest);
    }
    let changes: Vec<f64> = theta.windows(2).map(|t| t[1] - t[0]).collect();
    let uneven = if changes.is_empty() {
        1.0
    } else {
        let change = (changes.iter().map(|d| d * d).sum::<f64>() / changes.len() as f64).sqrt();
        let mean = theta.iter().sum::<f64>() / theta.len() as f64;
        (change / (2.0 * mean)).min(1.0)
    };
    let s = leverage(model, &normals);
    let of = |(e, t): (&Element, &f64)| {
        let section = &model.sections[e.section];
        let gyration = section.moment(2, 0).min(section.moment(0, 2)) / section.area();
        let (turn, slender) = (t * t, e.length * e.length / gyration);
        let error = if e.kind.axial_degree == 2 {
            let stiffer = s * QUADRATIC_FACTOR * turn * slender;
            stiffer / (1.0 + stiffer)
        } else {
            // 1 / (1 / a + 1 / b) without the division by an angle of zero
            s * turn * CUBIC_FACTORS[0] * CUBIC_FACTORS[1] * uneven * uneven * slender
                / (CUBIC_FACTORS[0] + CUBIC_FACTORS[1] * uneven * uneven * slender)
        };
        turn / total * error
    };
    (model.elements.iter().zip(&theta).map(of).sum(), largest)
}

/// Warns of elements that turn too far for their length, with the angle.
pub fn bending_remark(assembly: &Assembly<'_>, q: &[f64], diagnostics: &mut Vec<Diagnostic>) {
    let (error, largest) = bending_error(assembly, q);
    if error > COARSE {
        diagnostics.push(Diagnostic::warning(
            "coarse-bending",
            format!(
                "an element turns by {:.1} degrees from end to end, which makes the shaft too stiff: displacements are about {:.0} % \
                 too small (on cantilevers within a factor of 2.3, docs/theory/estimates.md#coarse-bending); more elements{}",
                largest.to_degrees(),
                100.0 * error,
                if assembly.model.elements.iter().any(|e| e.kind.axial_degree == 2) {
                    ", or 34X2, which is cubic along the shaft"
                } else {
                    ""
                }
            ),
        ));
    }
}
