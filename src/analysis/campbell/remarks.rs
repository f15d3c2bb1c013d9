//! What a sweep over speed refuses, models, leaves out and remarks.

use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::unstable_ranges::{BEYOND, NOT_OSCILLATING};
use crate::model::{Bearing, CampbellSettings, Form, Gyroscopic, Law, Model, SupportKind, WhirlFrame};
use crate::results::{Diagnostic, ModelSummary, UnstableRange};

/// A case that a frame or form does not fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// JSON path of what does not fit.
    pub path: String,
    /// Why.
    pub reason: &'static str,
    /// What would.
    pub remedy: &'static str,
}

/// Why a rotor cannot be analysed in the frame and form of the settings, if so.
pub fn refusal(model: &Model, settings: &CampbellSettings) -> Option<Refusal> {
    let refused = |path: &str, reason, remedy| Some(Refusal { path: path.to_owned(), reason, remedy });
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
        _ => None,
    }
}

/// True when every support looks the same at every angle: laws `c I + skew`, r held in y and z alike.
fn is_isotropic(model: &Model) -> bool {
    let turns = |[[a, b], [c, d]]: [[f64; 2]; 2]| {
        let size = a.abs().max(b.abs()).max(c.abs()).max(d.abs());
        (a - d).abs() <= 1e-12 * size && (b + c).abs() <= 1e-12 * size
    };
    let even = |b: &Bearing| turns(b.stiffness) && turns(b.damping);
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
    settings: &CampbellSettings,
    operators: &Operators,
    summary: &mut ModelSummary,
) {
    let spins = settings.speeds.iter().any(|s| *s > 0.0);
    let offset = model.disks.iter().any(|d| d.offset != [0.0, 0.0]);
    match (settings.gyroscopic, spins, operators.gyroscopic.is_some()) {
        (_, true, _) if operators.is_rotating() => {
            summary.modelled.push("Coriolis terms of shaft and disks (rotating frame)".to_owned());
        }
        (Gyroscopic::All, true, _) => summary.modelled.push("gyroscopic terms of shaft and disks".to_owned()),
        (Gyroscopic::Disks, true, true) => summary.modelled.push("gyroscopic terms of the disks".to_owned()),
        _ => summary.left_out.push("gyroscopic terms".to_owned()),
    }
    match settings.form {
        Form::Classical => {
            summary.left_out.push("centrifugal stiffening and spin softening: classical form".to_owned());
        }
        Form::Consistent => {
            summary.modelled.push(
                "centrifugal stiffening (tangent at the spinning equilibrium) and spin softening".to_owned(),
            );
            if offset {
                summary.left_out.push(
                    "the bend that offset disks cause: the equilibrium is that of the balanced rotor"
                        .to_owned(),
                );
            }
        }
    }
    if operators.damping.is_some() {
        summary.modelled.push("damping of bearings and material".to_owned());
    } else {
        summary.left_out.push("damping: none given".to_owned());
    }
    if operators.cross_coupling.is_some() {
        summary.modelled.push("cross-coupled bearing stiffness".to_owned());
    }
    if operators.circulatory.is_some() {
        summary.modelled.push("circulatory forces of rotating damping".to_owned());
    }
    if offset {
        let how = if operators.is_rotating() { "exact" } else { "approximate" };
        summary.modelled.push(format!("disk offset in the mass matrix ({how})"));
    }
}
