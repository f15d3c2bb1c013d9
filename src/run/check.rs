//! `rotor check`.

use crate::analysis::{self, contact};
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::model::Model;
use crate::report::table;
use crate::results::Diagnostic;
use crate::run::{Entry, Finished, Host, Steps, checked, finish, report, scene_without_overlap};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Check,
    about: "Say what will be modelled and left out, with size, mass, inertia, memory and time",
    examples: &["rotor check cases/jeffcott.json"],
    kinds: &[CaseKind::Shaft, CaseKind::Scene],
    linear: true,
    block: None,
    result_keys: &[],
    steps: |_| Ok(Steps::None),
    run,
};

fn run(loaded: &LoadedCase, _: &Host<'_>) -> Result<Finished> {
    if loaded.case.kind() == CaseKind::Scene {
        let report = report(loaded, contact::check(&scene_without_overlap(loaded)?)?);
        return finish(&report, Vec::new(), table::scene(&report.results));
    }
    let model = Model::new(loaded)?;
    let mut outcome = analysis::check::check(&model)?;
    if let Some(block) = &loaded.case.tradeoff {
        let points = block.grid.count();
        let name = block.analysis.name();
        let words = format!("the case has a study of {name} over {points} settings: `rotor tradeoff`");
        outcome.diagnostics.push(Diagnostic::info("study", words));
    }
    let report = checked(loaded, &model, outcome);
    finish(&report, Vec::new(), table::check(&report.results))
}
