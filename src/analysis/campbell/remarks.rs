//! What a sweep over speed refuses, models, leaves out and remarks.

use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::unstable_ranges::{BEYOND, NOT_OSCILLATING};
use crate::error::Refusal;
use crate::model::{Bearing, CampbellSettings, Form, Gyroscopic, Law, Model, SupportKind, WhirlFrame};
use crate::results::{Diagnostic, LeftOut, ModelSummary, Modelled, UnstableRange};

/// Whether a rotor can be analysed in the frame and form of the settings.
///
/// # Errors
/// Why not, and what would fit.
pub fn fits(model: &Model, settings: &CampbellSettings) -> Result<(), Refusal> {
    let refused = |path, problem, remedy| Err(Refusal::at(path, problem, remedy));
    let spins = settings.speeds.iter().any(|s| *s > 0.0) && settings.gyroscopic != Gyroscopic::None;
    let round = model.sections.iter().all(|s| s.is_axisymmetric());
    let even = is_isotropic(model);
    if settings.form == Form::Consistent && model.elements.iter().any(|e| e.kind.law == Law::Structural) {
        return refused(
            "campbell.form",
            "the element 3333s has no nonlinear form, so no tangent stiffness at the spinning state",
            "\"form\": \"classical\", or another element",
        );
    }
    if spins && !round && !even {
        return refused(
            "supports",
            "a section is not axisymmetric and a support is not isotropic: seen from either frame the equations \
             change periodically with the angle, and no eigenvalue problem holds for them",
            "circle and tube sections, or bearings with [[k, c], [-c, k]] and supports that hold r.y and r.z alike",
        );
    }
    let lossy = model.materials.iter().any(|m| m.loss_factor > 0.0);
    if lossy && (!round || settings.frame == WhirlFrame::Rotating) {
        return refused(
            "materials",
            "a loss factor needs motions of one frequency in space, of a round shaft in the stationary frame",
            "circle and tube sections and \"frame\": \"stationary\"; or \"damping\": { \"stiffness\": .. } instead",
        );
    }
    match settings.frame {
        WhirlFrame::Stationary if spins && !round => refused(
            "shaft.segments",
            "a section is not axisymmetric (ellipse or rectangle): seen from the stationary frame its stiffness \
             changes with the angle",
            "\"campbell.frame\": \"rotating\", or circle and tube sections, or `rotor modes` at rest",
        ),
        WhirlFrame::Rotating if !even => refused(
            "campbell.frame",
            "a support is not isotropic: seen from the rotating frame it changes with the angle",
            "\"stationary\", or bearings with [[k, c], [-c, k]] and supports that hold r.y and r.z alike",
        ),
        _ => Ok(()),
    }
}

/// True when every support looks the same at every angle: laws `c I + skew`, r held in y and z alike.
fn is_isotropic(model: &Model) -> bool {
    let turns = |[[a, b], [c, d]]: [[f64; 2]; 2]| {
        let size = a.abs().max(b.abs()).max(c.abs()).max(d.abs());
        (a - d).abs() <= 1e-12 * size && (b + c).abs() <= 1e-12 * size
    };
    let even = |b: &Bearing| {
        let laws = b.table.iter().flat_map(|t| t.rows()).copied().chain([b.at_rest()]);
        !b.is_across() || laws.flat_map(|c| [c.stiffness, c.damping, c.mass]).all(turns)
    };
    let held = |c: usize, node: usize| {
        let holds = |kind: &SupportKind| match kind {
            SupportKind::Fix(list) => list.contains(&(0, c)),
            _ => false,
        };
        model.supports.iter().any(|s| s.node == node && holds(&s.kind))
    };
    model.bearings.iter().all(even) && model.supports.iter().all(|s| held(1, s.node) == held(2, s.node))
}

/// An offset disk in the stationary frame.
pub fn offset_remark(model: &Model, settings: &CampbellSettings, diagnostics: &mut Vec<Diagnostic>) {
    let offset = model.disks.iter().any(|d| d.offset != [0.0, 0.0]);
    if offset && settings.frame == WhirlFrame::Stationary {
        diagnostics.push(Diagnostic::warning(
            "offset-disk",
            "an offset disk is not axisymmetric: its offset enters the mass matrix as if it stood still, \
             which is approximate in the stationary frame",
        ));
    }
}

/// Ends that spin, and motions that grow.
pub(super) fn speed_remarks(
    model: &Model,
    highest: f64,
    ranges: &[UnstableRange],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let clamped = model.supports.iter().any(|s| matches!(s.kind, crate::model::SupportKind::Clamped(_)));
    if clamped && highest > 0.0 {
        diagnostics.push(Diagnostic::info(
            "clamped-spins",
            "a clamped end of a spinning shaft is read as a driven revolute end (no tilt, no torsional vibration)",
        ));
    }
    diagnostics.extend(ranges.iter().map(|r| {
        let (branch, from, to) = (&r.branch, r.from_rad_s, r.to_rad_s);
        let what = match branch.as_str() {
            NOT_OSCILLATING => "a motion that does not oscillate".to_owned(),
            BEYOND => "a motion beyond the branches".to_owned(),
            name => format!("branch {name}"),
        };
        Diagnostic::warning(
            "unstable",
            format!(
                "{what} is unstable from {from:.6} to {to:.6} rad/s, growing by up to {:.4e} 1/s",
                r.largest_growth_rate_1_s
            ),
        )
    }));
}

/// What was modelled and left out.
pub fn describe_model(
    model: &Model,
    (gyroscopic, form, spins): (Gyroscopic, Form, bool),
    operators: &Operators,
    summary: &mut ModelSummary,
) {
    let offset = model.disks.iter().any(|d| d.offset != [0.0, 0.0]);
    match (gyroscopic, spins, operators.gyroscopic.is_some()) {
        (_, true, _) if operators.is_rotating() => {
            summary.modelled.push(Modelled::CoriolisTerms);
        }
        (Gyroscopic::All, true, _) => summary.modelled.push(Modelled::GyroscopicTerms),
        (Gyroscopic::Disks, true, true) => summary.modelled.push(Modelled::GyroscopicTermsOfDisks),
        _ => summary.left_out.push(LeftOut::GyroscopicTerms),
    }
    match form {
        Form::Classical => {
            summary.left_out.push(LeftOut::SpinStiffening);
        }
        Form::Consistent => {
            summary.modelled.push(Modelled::SpinStiffening);
            if offset {
                summary.left_out.push(LeftOut::BendOfOffsets);
            }
        }
    }
    if operators.damping.is_some() || !operators.hysteresis.is_none() || !operators.changing.is_empty() {
        summary.modelled.push(Modelled::Damping);
    } else {
        summary.left_out.push(LeftOut::Damping);
    }
    if operators.cross_coupling.is_some() {
        summary.modelled.push(Modelled::CrossCoupling);
    }
    if operators.circulatory.is_some() {
        summary.modelled.push(Modelled::CirculatoryForces);
    }
    if offset {
        summary.modelled.push(Modelled::DiskOffset { exact: operators.is_rotating() });
    }
}
