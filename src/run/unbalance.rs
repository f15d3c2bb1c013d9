//! `rotor unbalance`.

use crate::analysis::response::unbalance::unbalance;
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::model::Model;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, affordable, checked, finish, needed};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Unbalance,
    about: "Steady vibration by unbalance over speed: amplitudes, phases, orbits, bearing forces, peaks",
    examples: &[
        "rotor unbalance cases/lalanne-ferraris.json",
        "rotor unbalance cases/lalanne-ferraris.json --set unbalance.amplitude=zero-to-peak --out reports/zero-to-peak",
    ],
    kinds: &[CaseKind::Shaft],
    linear: true,
    block: Some(
        r#"{ "speeds": { "from": 0, "to": "10000 rpm", "count": 501 }, "masses": [ { "at": 0.5, "moment": "200 g mm" } ] }"#,
    ),
    result_keys: &[
        "speeds_rad_s",
        "stations",
        "peaks",
        "margins",
        "bearing_forces_N",
        "shapes",
        "stability_threshold_rad_s",
    ],
    steps: |loaded| {
        let speeds = Model::new(loaded)?.unbalance.map_or(0, |settings| settings.speeds.len());
        Ok(Steps::Speeds(speeds))
    },
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let model = affordable(loaded)?;
    let settings = needed(model.unbalance.as_ref(), &ENTRY)?;
    let report = checked(loaded, &model, unbalance(&model, settings, host.progress)?);
    let figures = host.figures(|| plot::unbalance::svg(&report))?;
    finish(&report, figures, table::unbalance(&report.results))
}
