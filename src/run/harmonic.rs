//! `rotor harmonic`.

use crate::analysis::response::harmonic::harmonic;
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::model::Model;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, affordable, checked, finish, needed};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Harmonic,
    about: "Steady vibration by a force, a moment or a motion of the ground at a frequency of its own",
    examples: &["rotor harmonic cases/base-motion.json"],
    kinds: &[CaseKind::Shaft],
    linear: true,
    block: Some(
        r#"{ "frequencies": { "from": "1 Hz", "to": "200 Hz", "count": 400 }, "excitations": [ { "at": 0.5, "force": [0, 1, 0] } ] }"#,
    ),
    result_keys: &["frequencies_rad_s", "stations", "bearing_forces_N", "stability_threshold_rad_s"],
    steps: |loaded| {
        let count = Model::new(loaded)?.harmonic.map_or(0, |settings| settings.frequencies.len());
        Ok(Steps::Speeds(count))
    },
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let model = affordable(loaded)?;
    let settings = needed(model.harmonic.as_ref(), &ENTRY)?;
    let report = checked(loaded, &model, harmonic(&model, settings, host.progress)?);
    let figures = host.figures(|| plot::harmonic::svg(&report))?;
    finish(&report, figures, table::harmonic(&report.results))
}
