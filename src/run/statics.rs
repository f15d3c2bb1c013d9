//! `rotor static`.

use crate::analysis::statics::statics;
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, affordable, checked, finish};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Static,
    about: "Equilibrium under loads and gravity, with finite displacements",
    examples: &["rotor static cases/table5-cantilever.json --set shaft.segments.0.elements=16"],
    kinds: &[CaseKind::Shaft],
    linear: false,
    block: None,
    result_keys: &[
        "load_factor",
        "probes",
        "profile",
        "reactions",
        "strain_energy_j",
        "largest_strain",
        "newton",
        "support_forces_N",
        "support_moments_N_m",
        "sections",
    ],
    steps: |_| Ok(Steps::None),
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let model = affordable(loaded)?;
    let report = checked(loaded, &model, statics(&model)?);
    let figures = host.figures(|| plot::statics::svg(&report))?;
    finish(&report, figures, table::statics(&report.results))
}
