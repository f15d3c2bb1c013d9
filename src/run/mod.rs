//! Runs one analysis of a loaded case from model to report, plots and table: the whole pipeline, without
//! touching a file.
//!
//! What the program knows of an analysis stands in its file here, as an [`Entry`]: commands, help, trade-off studies and error
//! texts read it there.

mod campbell;
mod check;
mod contact;
mod harmonic;
mod map;
mod modes;
mod spinup;
mod statics;
mod unbalance;

pub use crate::case::Analysis;
pub(crate) use contact::scene_without_overlap;

use crate::analysis::{Counter, Outcome, Watch, plausibility};
use crate::case::{CaseKind, LoadedCase};
use crate::check::memory::memory;
use crate::error::{Error, Refusal, Result};
use crate::model::Model;
use crate::report::{printable, table};
use crate::results::{CaseInfo, Diagnostic, Figures, Report};
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// An analysis as the program offers it.
#[derive(Debug)]
pub struct Entry {
    /// Name of the analysis.
    pub analysis: Analysis,
    /// What it does, in the list of commands.
    pub about: &'static str,
    /// Command lines that show its use.
    pub examples: &'static [&'static str],
    /// What it can be run on.
    pub kinds: &'static [CaseKind],
    /// Whether displacements are small: gravity, loads and rules of integration then do nothing.
    pub linear: bool,
    /// An example of the block of the case that it can't do without.
    pub block: Option<&'static str>,
    /// Keys of its results that numbers for a trade-off study stand under; a study of an analysis without any makes no sense.
    pub result_keys: &'static [&'static str],
    /// How its progress is told.
    steps: fn(&LoadedCase) -> Result<Steps>,
    /// Runs the analysis of a case.
    run: fn(&LoadedCase, &Host<'_>) -> Result<Finished>,
}

/// What the program knows of an analysis.
pub fn entry(analysis: Analysis) -> &'static Entry {
    match analysis {
        Analysis::Check => &check::ENTRY,
        Analysis::Modes => &modes::ENTRY,
        Analysis::Campbell => &campbell::ENTRY,
        Analysis::Unbalance => &unbalance::ENTRY,
        Analysis::Harmonic => &harmonic::ENTRY,
        Analysis::Map => &map::ENTRY,
        Analysis::Static => &statics::ENTRY,
        Analysis::Spinup => &spinup::ENTRY,
        Analysis::Contact => &contact::ENTRY,
    }
}

/// How the progress of a run is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steps {
    /// The run is short.
    None,
    /// By the number of speeds that are done.
    Speeds(usize),
    /// By the share of the time that is done; the run can be stopped and then reports what it has.
    Share,
}

/// Who waits for a run.
pub struct Host<'a> {
    /// Whether figures are drawn.
    pub plots: bool,
    /// Receives the number of speeds that were done.
    pub progress: Counter<'a>,
    /// Receives the share of a transient that is done, and stops it by returning false.
    pub watch: Watch<'a>,
}

impl Host<'static> {
    /// Nobody: no figures, no progress, no interrupt.
    pub fn silent() -> Self {
        Self { plots: false, progress: &|_| (), watch: &|_, _| true }
    }
}

impl Host<'_> {
    /// The figures, if they are wanted.
    fn figures(&self, draw: impl FnOnce() -> Result<Figures>) -> Result<Figures> {
        if self.plots { draw() } else { Ok(Vec::new()) }
    }
}

/// A finished run, not yet written.
#[derive(Debug)]
pub struct Finished {
    /// The report (see [`Report`]).
    pub json: Value,
    /// Figures of the run.
    pub plots: Figures,
    /// Table for the terminal.
    pub table: String,
    /// Remarks, also in the report.
    pub diagnostics: Vec<Diagnostic>,
    /// Time by phase, where the analysis measures it; differs from run to run, so it stands beside the report.
    pub cost: Option<Value>,
}

/// Runs an analysis of a case.
///
/// # Errors
/// Bad input, or an analysis that does not succeed.
pub fn run(loaded: &LoadedCase, analysis: Analysis, host: &Host<'_>) -> Result<Finished> {
    // what is refused in a run is a fault of the case
    (entry(analysis).run)(loaded, host).map_err(|error| loaded.locate(error))
}

/// How the progress of an analysis of a case is told.
///
/// # Errors
/// Bad input.
pub fn steps(loaded: &LoadedCase, analysis: Analysis) -> Result<Steps> {
    (entry(analysis).steps)(loaded)
}

/// The checked model of a run that there is memory for.
pub(crate) fn affordable(loaded: &LoadedCase) -> Result<Model> {
    let model = Model::new(loaded)?;
    afford(memory(&model).iter().map(|share| share.bytes).sum())?;
    Ok(model)
}

/// Refuses a run that needs more memory than there is, before it starts.
fn afford(bytes: f64) -> Result<()> {
    let needed = format!("this run, which takes about {:.2} GB", bytes / 1e9);
    if free_memory().is_some_and(|free| bytes > free) {
        return Err(Error::memory(&needed));
    }
    // what a process is allowed shows when it asks
    let mut room: Vec<u8> = Vec::new();
    let got = room.try_reserve_exact(bytes as usize);
    std::hint::black_box(&mut room);
    got.map_err(|_| Error::memory(&needed))
}

/// Memory that the system can still give, where it says so, bytes.
fn free_memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let kilobytes = |key: &str| {
        let line = text.lines().find(|line| line.starts_with(key))?;
        line.split_whitespace().nth(1)?.parse::<f64>().ok()
    };
    Some(1024.0 * (kilobytes("MemAvailable:")? + kilobytes("SwapFree:").unwrap_or(0.0)))
}

/// The settings in a block of the case that an analysis can't do without.
pub(crate) fn needed<'a, T>(settings: Option<&'a T>, entry: &Entry) -> Result<&'a T> {
    let name = entry.analysis.name();
    settings.ok_or_else(|| {
        let example = format!("for example \"{name}\": {}", entry.block.unwrap_or("{}"));
        Refusal::at(name, format!("the case has no `{name}` block"), example).into()
    })
}

/// An outcome with doubts about the values of the case.
pub(crate) fn doubted<R>(model: &Model, mut outcome: Outcome<R>) -> Outcome<R> {
    outcome.diagnostics.extend(plausibility::plausibility(model));
    outcome
}

/// The report of an outcome, with doubts about the values of the case.
fn checked<R>(loaded: &LoadedCase, model: &Model, outcome: Outcome<R>) -> Report<R> {
    report(loaded, doubted(model, outcome))
}

/// The report of an outcome.
pub(crate) fn report<R>(loaded: &LoadedCase, outcome: Outcome<R>) -> Report<R> {
    let mut effective = loaded.value.clone();
    effective.as_object_mut().map(|case| case.shift_remove("expected"));
    let name = Path::new(&loaded.file).file_name().map(|n| n.to_string_lossy().into_owned());
    Report {
        rotor: env!("CARGO_PKG_VERSION"),
        case: CaseInfo {
            title: loaded.case.title.clone(),
            file: name.unwrap_or_else(|| loaded.file.clone()),
            sha256: loaded.sha256.clone(),
            overrides: loaded.overrides.clone(),
            effective,
        },
        model: outcome.model,
        results: outcome.results,
        diagnostics: outcome.diagnostics,
    }
}

/// A finished run of a report, its plots and the table of its results.
pub(crate) fn finish<R: Serialize>(report: &Report<R>, plots: Figures, results: String) -> Result<Finished> {
    let json = serde_json::to_value(report).map_err(|e| {
        Error::analysis("the report could not be written as JSON", e.to_string(), "report this")
    })?;
    let plots = plots.into_iter().map(|(name, svg)| (name, marked(&svg, &report.case))).collect();
    let table = format!(
        "{}\n{}\n{results}\n{}",
        printable::line(&report.case.title),
        table::model(&report.model),
        table::diagnostics(&report.diagnostics)
    );
    Ok(Finished { json, plots, table, diagnostics: report.diagnostics.clone(), cost: None })
}

/// A drawing that says which report it belongs to: text that is XML whatever names stand in it, with the case.
fn marked(svg: &str, case: &CaseInfo) -> String {
    let svg = printable::lines(svg);
    let mark = format!("<desc>rotor {}, case {}</desc>", env!("CARGO_PKG_VERSION"), case.sha256);
    match svg.find("<svg").and_then(|at| svg[at..].find('>').map(|end| at + end + 1)) {
        Some(at) => format!("{}\n{mark}{}", &svg[..at], &svg[at..]),
        None => svg,
    }
}
