//! `rotor check`: what will be modelled, how big it is, and what it weighs.

use crate::accuracy::locking_and_rounding::slow_remark;
use crate::analysis::campbell::remarks::fits;
use crate::analysis::mass_properties::properties;
use crate::analysis::{Outcome, ignored_input, model_remarks, summary};
use crate::check::memory::memory;
use crate::error::Result;
use crate::model::{Form, Model};
use crate::results::{Check, Diagnostic, LeftOut, Modelled};
use crate::shaft::assembly::Assembly;

/// Time of modes, critical speeds and checks per unknown, s. This and the numbers below are measured on one server core over the
/// cases with a sweep, in both forms, whose times they give within a factor of 1.5.
const TIME_PER_UNKNOWN: f64 = 2.2e-4;
/// Time of one spin speed on a basis of 60, s; grows with the cube of the basis.
const TIME_PER_SPEED: f64 = 7e-3;
/// Equilibria of the consistent form take as long as all that belongs to rest, and static answers to centrifugal terms make its basis
/// so much larger.
const CONSISTENT_BASIS: f64 = 1.4;
/// A speed solved without reduction against one on a basis of 60.
const UNREDUCED: f64 = 20.0;

/// Time of the sweep on one core, s; without a sweep that of modes.
fn estimated_time(model: &Model, unknowns: usize) -> f64 {
    let rest = TIME_PER_UNKNOWN * unknowns as f64;
    let Some(settings) = &model.campbell else { return rest };
    let consistent = settings.form == Form::Consistent && settings.speeds.iter().any(|s| *s > 0.0);
    let grown = if consistent { CONSISTENT_BASIS } else { 1.0 };
    let basis = |n: usize| (grown * n.max(settings.modes) as f64 / 60.0).powi(3);
    let of_speed = TIME_PER_SPEED * settings.reduction.map_or(UNREDUCED, basis);
    rest * if consistent { 2.0 } else { 1.0 } + settings.speeds.len() as f64 * of_speed
}

/// Size, mass properties and what each analysis will model.
///
/// # Errors
/// None at present; the signature is that of every analysis.
pub fn check(model: &Model) -> Result<Outcome<Check>> {
    let assembly = Assembly::new(model);
    let p = properties(model);
    let (rigid_motions, _) = assembly.rigid_motions();
    let unknowns = assembly.size();
    let results = Check {
        nodes: model.nodes.len(),
        unconstrained_degrees_of_freedom: assembly.numbering.len(),
        rigid_motions: rigid_motions.iter().map(ToString::to_string).collect(),
        length_m: model.length,
        shaft_mass_kg: p.shaft,
        disk_mass_kg: p.disks,
        center_of_mass_m: p.center,
        polar_inertia_kg_m2: p.polar,
        inertia_y_kg_m2: p.diametral[0],
        inertia_z_kg_m2: p.diametral[1],
        estimated_memory_mb: memory(model).iter().map(|share| share.bytes).sum::<f64>() / 1e6,
        estimated_time_s: estimated_time(model, unknowns),
    };
    let mut model_summary = summary(model, unknowns, p.mass());
    let mut diagnostics = ignored_input(model);
    match model.campbell.as_ref().map(|settings| (settings, fits(model, settings))) {
        Some((_, Err(refused))) => diagnostics.push(Diagnostic::warning(
            "campbell-refused",
            format!("campbell will be refused: {}; remedy: {}", refused.problem, refused.allowed),
        )),
        Some((settings, Ok(()))) => {
            model_summary.modelled.push(Modelled::CampbellSpeeds(settings.speeds.len()));
        }
        None => model_summary.left_out.push(LeftOut::Spin),
    }
    diagnostics.extend(model_remarks(model, &assembly));
    if let Some(spin) = &model.spinup {
        let fastest = spin.largest_speed();
        slow_remark(model, fastest, &mut diagnostics);
        if !spin.stators.is_empty() {
            model_summary.modelled.push(Modelled::Rings(spin.stators.len()));
        }
    }
    Ok(Outcome { results, model: model_summary, diagnostics })
}
