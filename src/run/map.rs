//! `rotor map`.

use crate::analysis::critical_map::critical_map;
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::model::Model;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, affordable, checked, finish, needed};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Map,
    about: "Undamped critical speeds over the stiffness of the supports, with the bearings' curves laid over",
    examples: &["rotor map cases/two-disk-table.json"],
    kinds: &[CaseKind::Shaft],
    linear: true,
    block: Some(r#"{ "stiffness": { "from": "1e5 N/m", "to": "1e10 N/m", "count": 41 } }"#),
    result_keys: &["stiffness_N_m", "curves", "bearing_curves", "intersections", "cross_coupling"],
    steps: |loaded| {
        let count = Model::new(loaded)?.map.map_or(0, |settings| settings.stiffness.len());
        Ok(Steps::Speeds(count))
    },
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let model = affordable(loaded)?;
    let settings = needed(model.map.as_ref(), &ENTRY)?;
    let report = checked(loaded, &model, critical_map(&model, settings, host.progress)?);
    let figures = host.figures(|| plot::map::svg(&report))?;
    finish(&report, figures, table::map(&report.results))
}
