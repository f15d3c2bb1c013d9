//! `rotor contact`.

use crate::analysis::contact::{contact, overlap};
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::{Refusal, Result};
use crate::model::scene::Scene;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, finish, report};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Contact,
    about: "Equilibrium or motion of beams in contact: gaps, forces, energies, events",
    examples: &["rotor contact cases/side-to-side.json"],
    kinds: &[CaseKind::Scene],
    linear: false,
    block: None,
    result_keys: &[
        "time_s",
        "load_factor",
        "bodies",
        "pairs",
        "events",
        "largest_penetration_m",
        "energy_error",
        "energy_change",
        "momentum_residual",
        "angular_momentum_residual",
        "solver",
        "history",
        "energy_J",
        "penalty_N_m3",
    ],
    steps: |_| Ok(Steps::Share),
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let report = report(loaded, contact(&scene_without_overlap(loaded)?, host.watch)?);
    let figures = host.figures(|| plot::contact::svg(&report))?;
    let mut finished = finish(&report, figures, table::contact(&report.results))?;
    finished.cost = serde_json::to_value(report.results.cost).ok();
    Ok(finished)
}

/// The scene of a case, whose bodies must not overlap at the start.
pub fn scene_without_overlap(loaded: &LoadedCase) -> Result<Scene> {
    let scene = Scene::new(loaded)?;
    without_overlap(&scene)?;
    Ok(scene)
}

/// Refuses bodies that overlap at the start.
///
/// # Errors
/// The pair, and by how much it overlaps.
fn without_overlap(scene: &Scene) -> Result<()> {
    let Some(overlap) = overlap(scene)? else { return Ok(()) };
    let (a, b) = overlap.bodies;
    let names = [a, b].map(|i| &scene.bodies[i].name);
    let problem =
        format!("`{}` and `{}` overlap by {:.6e} m at the start", names[0], names[1], overlap.depth);
    Err(Refusal::at(format!("bodies.{b}.start"), problem, "bodies apart or touching").into())
}
