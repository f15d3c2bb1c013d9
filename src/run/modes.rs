//! `rotor modes`.

use crate::analysis::modes::modes;
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, affordable, checked, finish};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Modes,
    about: "Natural frequencies and mode shapes at rest",
    examples: &["rotor modes cases/table3-tube.json --set modes.count=12"],
    kinds: &[CaseKind::Shaft],
    linear: true,
    block: None,
    result_keys: &["rigid_modes", "modes"],
    steps: |_| Ok(Steps::None),
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let model = affordable(loaded)?;
    let report = checked(loaded, &model, modes(&model)?);
    let figures = host.figures(|| plot::modes::svg(&report))?;
    finish(&report, figures, table::modes(&report.results))
}
