//! `rotor campbell`.

use crate::analysis::campbell::campbell;
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::model::Model;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, affordable, checked, finish, needed};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Campbell,
    about: "Whirl frequencies over spin speed, and critical speeds",
    examples: &[
        "rotor campbell cases/bauchau.json",
        "rotor campbell cases/bauchau.json --set shaft.segments.0.elements=32 --out reports/bauchau-32",
    ],
    kinds: &[CaseKind::Shaft],
    linear: true,
    block: Some(r#"{ "speeds": { "from": 0, "to": "10000 rpm", "count": 101 } }"#),
    result_keys: &[
        "speeds_rad_s",
        "branches",
        "critical_speeds",
        "unstable_ranges",
        "reduction",
        "stability_threshold_rad_s",
    ],
    steps: |loaded| {
        let speeds = Model::new(loaded)?.campbell.map_or(0, |settings| settings.speeds.len());
        Ok(Steps::Speeds(speeds))
    },
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let model = affordable(loaded)?;
    let settings = needed(model.campbell.as_ref(), &ENTRY)?;
    let report = checked(loaded, &model, campbell(&model, settings, host.progress)?);
    let figures = host.figures(|| plot::campbell::svg(&report))?;
    finish(&report, figures, table::campbell(&report.results))
}
