//! `rotor spinup`.

use crate::analysis::spinup::spinup;
use crate::case::{Analysis, CaseKind, LoadedCase};
use crate::error::Result;
use crate::plot;
use crate::report::table;
use crate::run::{Entry, Finished, Host, Steps, affordable, checked, finish, needed};

pub const ENTRY: Entry = Entry {
    analysis: Analysis::Spinup,
    about: "Run up to speed: growth, stresses, orbit, torque, energies and rub in rings over time",
    examples: &[
        "rotor spinup cases/table8-spin-circle.json",
        "rotor spinup cases/rub-ring.json --set spinup.stators.0.friction=0.02",
    ],
    kinds: &[CaseKind::Shaft],
    linear: false,
    block: Some(r#"{ "drive": [ { "until": 1.0, "speed": "15000 rpm" } ] }"#),
    result_keys: &[
        "final",
        "extremes",
        "growth",
        "history",
        "energy",
        "rub",
        "integrator",
        "newton",
        "support_forces_N",
        "support_moments_N_m",
        "sections",
    ],
    steps: |_| Ok(Steps::Share),
    run,
};

fn run(loaded: &LoadedCase, host: &Host<'_>) -> Result<Finished> {
    let model = affordable(loaded)?;
    let settings = needed(model.spinup.as_ref(), &ENTRY)?;
    let report = checked(loaded, &model, spinup(&model, settings, host.watch)?);
    let figures = host.figures(|| plot::spinup::svg(&report))?;
    finish(&report, figures, table::spinup(&report.results))
}
