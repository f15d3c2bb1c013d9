//! `rotor static`: equilibrium under loads and gravity, with finite displacements.

use crate::accuracy::coarse_bending::bending_remark;
use crate::accuracy::locking_and_rounding::{refuse_dependent, refuse_tiny_bore};
use crate::accuracy::pressure_stress::pressure_remarks;
use crate::analysis::equilibrium::{Balance, Equilibrium, NewtonSettings};
use crate::analysis::probes::in_rigid_hub;
use crate::analysis::probes::{axis_displacement, largest_strain, probe_states, profile};
use crate::analysis::section_forces::ForceReader;
use crate::analysis::stations::headline;
use crate::analysis::steps::stress_remarks;
use crate::analysis::{Outcome, model_remarks, nonlinear_summary, refuse_initial_stress};
use crate::error::{Error, Result};
use crate::linalg::dot;
use crate::model::Model;
use crate::results::{Diagnostic, LeftOut, Modelled, NewtonSummary, Reaction, Static};
use crate::shaft::assembly::Assembly;
use crate::shaft::internal_forces::Workspace;
use crate::shaft::loads::{Turned, Which};

/// Strain beyond which St. Venant-Kirchhoff is no longer the engineer's linear elasticity.
pub const LARGE_STRAIN: f64 = 0.05;
/// Relative size of a load along a motion that nothing resists.
const UNBALANCED: f64 = 1e-9;
/// Points of the drawn axis.
const AXIS_POINTS: usize = 201;

/// Solves for static equilibrium. When the full load is not reached, the results hold the last state found
/// (`converged` false) and the diagnostics say what was tried.
///
/// # Errors
/// A load along a motion that no support resists, or an element without nonlinear form.
pub fn statics(model: &Model) -> Result<Outcome<Static>> {
    let mut diagnostics: Vec<Diagnostic> = seal_remark(model).into_iter().collect();
    let model = &model.without_seals();
    refuse_initial_stress(model)?;
    refuse_dependent(model)?;
    refuse_tiny_bore(model)?;
    let assembly = Assembly::new(model);
    let balance = Balance::new(&assembly, Which::All, 0.0)?;
    refuse_unbalanced(&balance)?;
    let settings = NewtonSettings {
        load_steps: model.statics.load_steps,
        max_iterations: model.statics.max_iterations,
        tolerance: model.statics.tolerance,
    };
    let state = balance.solve(settings, None)?;
    let q = balance.coordinates(&state.z);
    diagnostics.extend(model_remarks(model, &assembly));
    if !model.has_gravity() && !model.has_loads() && !model.has_bearing_offsets() {
        diagnostics
            .push(Diagnostic::warning("no-loads", "the case has no loads and no gravity: nothing moves"));
    }
    if model.spinup.is_some() {
        diagnostics
            .push(Diagnostic::info("drive-ignored", "the drive of the spinup block does not act here"));
    }
    pinned_remark(&balance, &mut diagnostics);
    hub_remark(model, &mut diagnostics);
    pressure_remarks(model, &mut diagnostics);
    stress_remarks(model, &mut diagnostics);
    bending_remark(&assembly, &q, &mut diagnostics);
    let station = headline(model);
    let largest = largest_strain(&assembly, &q);
    strain_remark(largest, &mut diagnostics);
    let converged = state.load_factor == 1.0;
    if converged && state.unstable > 0 {
        diagnostics.push(Diagnostic::warning(
            "unstable-equilibrium",
            format!(
                "the equilibrium is unstable in {} directions: the load is beyond a buckling load",
                state.unstable
            ),
        ));
    }
    if !converged {
        diagnostics.push(not_reached(&state, model.statics.max_iterations));
    }
    let mut force = vec![0.0; q.len()];
    let strain_energy_j = balance.forces.internal_force(&q, None, &mut force, &mut Workspace::default());
    let axis = (0..AXIS_POINTS)
        .map(|k| model.length * k as f64 / (AXIS_POINTS - 1) as f64)
        .map(|x| axis_displacement(&assembly, &q, x))
        .collect();
    let mut summary = nonlinear_summary(model, assembly.size());
    if model.has_gravity() {
        summary.modelled.push(Modelled::Gravity);
    }
    if model.has_loads() {
        let (points, surfaces) = (model.loads.len(), model.tractions.len());
        let moving = balance.loads.depend_on_place();
        summary.modelled.push(Modelled::StaticLoads { points, surfaces, moving });
    }
    summary.left_out.push(LeftOut::Motion);
    let (reader, acting) = (ForceReader::new(&assembly), balance.acting(&state.z, state.load_factor));
    let results = Static {
        converged,
        load_factor: state.load_factor,
        probes: probe_states(&assembly, &q),
        profile: profile(&assembly, &q, station.x, &station.section),
        reactions: reactions(&balance, &state),
        support_forces: reader.supports(&acting),
        sections: reader.sections(&acting),
        strain_energy_j,
        largest_strain: largest,
        newton: newton_summary(&state),
        axis,
    };
    Ok(Outcome { results, model: summary, diagnostics })
}

/// Which seals are left out.
fn seal_remark(model: &Model) -> Option<Diagnostic> {
    let mut seals: Vec<&str> = model.bearings.iter().filter(|b| b.seal).map(|b| b.path.as_str()).collect();
    seals.dedup();
    let text = format!("seals carry no static load and are left out: {}", seals.join(", "));
    (!seals.is_empty()).then(|| Diagnostic::info("seals-left-out", text))
}

/// How Newton's method went, for the report.
pub fn newton_summary(state: &Equilibrium) -> NewtonSummary {
    NewtonSummary {
        load_steps: state.steps,
        cuts: state.cuts,
        iterations: state.iterations,
        residual: state.residual,
        unstable_directions: state.unstable,
    }
}

/// Warns of probes inside rigid hubs, whose stresses are those of a constraint.
pub fn hub_remark(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    let inside: Vec<&str> =
        model.probes.iter().filter(|p| in_rigid_hub(model, p.x)).map(|p| p.name.as_str()).collect();
    if !inside.is_empty() {
        diagnostics.push(Diagnostic::warning(
            "probe-in-hub",
            format!(
                "probes within half a radius of a rigid hub or end ({}): growth and stress there are those of the constraint; \
                 read them clear of it, or give the disk \"hub\": \"rim\" or \"bore\"",
                inside.join(", ")
            ),
        ));
    }
}

/// Remark on motions that nothing resists, which are pinned.
pub fn pinned_remark(balance: &Balance<'_>, diagnostics: &mut Vec<Diagnostic>) {
    if !balance.unresisted.is_empty() {
        let motions: Vec<String> = balance.unresisted.iter().map(ToString::to_string).collect();
        diagnostics.push(Diagnostic::info(
            "pinned-motions",
            format!("no support resists {}; pinned for the equilibrium", motions.join(", ")),
        ));
    }
}

/// Warning when strains leave the range the material law is meant for.
pub fn strain_remark(largest: f64, diagnostics: &mut Vec<Diagnostic>) {
    if largest > LARGE_STRAIN {
        diagnostics.push(Diagnostic::warning(
            "large-strain",
            format!(
                "the largest principal strain is {:.1} %: St. Venant-Kirchhoff material is meant for small \
                 strains, other laws would give other answers (docs/theory/growth.md#strain-limit)",
                100.0 * largest
            ),
        ));
    }
}

fn not_reached(state: &Equilibrium, iterations: usize) -> Diagnostic {
    Diagnostic::error(
        "not-converged",
        format!(
            "no equilibrium was found beyond {:.4} of the load ({} load steps, {} cut in halves, {} Newton iterations, \
             at most {iterations} a step); this report holds the last state found. A buckling or collapse load lies \
             there: check the load, or raise static.load_steps",
            state.load_factor, state.steps, state.cuts, state.iterations
        ),
    )
}

/// A static load along a free motion has no equilibrium.
fn refuse_unbalanced(balance: &Balance<'_>) -> Result<()> {
    let mut f = vec![0.0; balance.assembly.size()];
    let mut load = vec![0.0; balance.reference.len()];
    balance.loads.add(&balance.reference, Turned::NOT, 1.0, &mut load);
    balance.assembly.project(&load, &mut f);
    let (names, motions) = balance.assembly.rigid_motions();
    for (j, name) in names.iter().enumerate() {
        let motion: Vec<f64> = motions.col(j).iter().copied().collect();
        let size: f64 = motion.iter().zip(&f).map(|(m, f)| (m * f).abs()).sum();
        if dot(&motion, &f).abs() > UNBALANCED * size {
            return Err(Error::analysis(
                format!("the loads have a resultant along a motion that no support resists: {name}"),
                "supports and loads as given",
                "add a support that holds this motion, or balance the loads",
            ));
        }
    }
    Ok(())
}

fn reactions(balance: &Balance<'_>, state: &Equilibrium) -> Vec<Reaction> {
    let model = balance.assembly.model;
    let mut scaled = balance.reactions_at(&state.z, state.load_factor);
    let mut list: Vec<Reaction> = Vec::new();
    for support in &model.supports {
        // two supports at one node share its reaction: it is listed once
        let mut force_n = [0.0; 3];
        for at in balance.assembly.numbering.fields(support.node) {
            force_n.iter_mut().zip(&mut scaled[at..]).for_each(|(f, part)| *f += std::mem::take(part));
        }
        list.push(Reaction { support: support.path.clone(), at_m: model.nodes[support.node].x, force_n });
    }
    list
}
