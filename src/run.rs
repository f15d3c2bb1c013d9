//! Runs one analysis of a loaded case from model to report, plots and table: the whole pipeline, without
//! touching a file.

use crate::analysis::{self, Outcome};
use crate::case::LoadedCase;
use crate::check::memory::memory;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::scene::Scene;
use crate::plot;
use crate::report::{printable, table};
use crate::results::{CaseInfo, Diagnostic, Report};
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// Steps of the progress of a transient.
pub const TICKS: usize = 1000;

/// The analyses that write a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Analysis {
    /// Size and mass properties.
    Check,
    /// Natural modes at rest.
    Modes,
    /// Whirl frequencies over speed and critical speeds.
    Campbell,
    /// Equilibrium under loads.
    Static,
    /// Run up to speed.
    Spinup,
    /// Beams in contact.
    Contact,
}

/// All of them, by rising cost.
const ANALYSES: [Analysis; 6] = [
    Analysis::Check,
    Analysis::Modes,
    Analysis::Campbell,
    Analysis::Static,
    Analysis::Spinup,
    Analysis::Contact,
];

impl Analysis {
    /// Name on the command line and of the report.
    pub fn name(self) -> &'static str {
        match self {
            Analysis::Check => "check",
            Analysis::Modes => "modes",
            Analysis::Campbell => "campbell",
            Analysis::Static => "static",
            Analysis::Spinup => "spinup",
            Analysis::Contact => "contact",
        }
    }

    /// The analysis of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        ANALYSES.into_iter().find(|a| a.name() == name)
    }
}

/// A finished run, not yet written.
#[derive(Debug)]
pub struct Finished {
    /// The report (see [`Report`]).
    pub json: Value,
    /// Plots as `(file name, SVG text)`.
    pub plots: Vec<(String, String)>,
    /// Table for the terminal.
    pub table: String,
    /// Remarks, also in the report.
    pub diagnostics: Vec<Diagnostic>,
    /// Time by phase, where the analysis measures it; differs from run to run, so it stands beside the report.
    pub cost: Option<Value>,
}

/// Runs an analysis. `progress` receives the number of speeds done, out of [`steps`]; `watch` the share of a
/// transient that is done, and stops it by returning false.
///
/// # Errors
/// Bad input, or an analysis that does not succeed.
pub fn run(
    loaded: &LoadedCase,
    analysis: Analysis,
    plots: bool,
    progress: analysis::campbell::Progress<'_>,
    watch: analysis::spinup::Watch<'_>,
) -> Result<Finished> {
    if analysis == Analysis::Contact {
        return contact(loaded, plots, watch);
    }
    if analysis == Analysis::Check && is_scene(loaded) {
        let report = report(loaded, analysis::contact::check(&apart(loaded)?)?);
        return finish(&report, Vec::new(), table::scene(&report.results));
    }
    let model = Model::new(loaded)?;
    if analysis != Analysis::Check {
        afford(memory(&model).iter().map(|share| share.bytes).sum())?;
    }
    match analysis {
        Analysis::Check | Analysis::Contact => {
            let mut outcome = analysis::check::check(&model)?;
            if let Some(block) = &loaded.case.tradeoff {
                let points = block.grid.count();
                let words = format!(
                    "the case has a study of {} over {points} settings: `rotor tradeoff`",
                    block.analysis.name()
                );
                outcome.diagnostics.push(Diagnostic::info("study", words));
            }
            let report = checked(loaded, &model, outcome);
            finish(&report, Vec::new(), table::check(&report.results))
        }
        Analysis::Modes => {
            let report = checked(loaded, &model, analysis::modes::modes(&model)?);
            let svg =
                if plots { vec![("modes.svg".to_owned(), plot::modes::svg(&report)?)] } else { Vec::new() };
            finish(&report, svg, table::modes(&report.results))
        }
        Analysis::Campbell => {
            let settings = model.campbell.as_ref().ok_or_else(|| missing_block(loaded, "campbell"))?;
            // what the analysis refuses about the model is a fault of the case
            if let Some(refused) = analysis::campbell::remarks::refusal(&model, settings) {
                return Err(loaded.fault(&refused.path, refused.reason, refused.remedy));
            }
            let outcome =
                analysis::campbell::campbell(&model, settings, progress).map_err(|e| refused(loaded, e))?;
            let report = checked(loaded, &model, outcome);
            let svg = if plots {
                vec![("campbell.svg".to_owned(), plot::campbell::svg(&report)?)]
            } else {
                Vec::new()
            };
            finish(&report, svg, table::campbell(&report.results))
        }
        Analysis::Static => {
            let outcome = analysis::statics::statics(&model).map_err(|e| refused(loaded, e))?;
            let report = checked(loaded, &model, outcome);
            let svg = if plots { plot::statics::svg(&report)? } else { Vec::new() };
            finish(&report, svg, table::statics(&report.results))
        }
        Analysis::Spinup => {
            let settings = model.spinup.as_ref().ok_or_else(|| missing_block(loaded, "spinup"))?;
            if let Some(refused) = analysis::spinup::refusal(&model, settings) {
                return Err(loaded.fault(&refused.path, refused.reason, refused.remedy));
            }
            let outcome =
                analysis::spinup::spinup(&model, settings, watch).map_err(|e| refused(loaded, e))?;
            let report = checked(loaded, &model, outcome);
            let svg = if plots { plot::spinup::svg(&report)? } else { Vec::new() };
            finish(&report, svg, table::spinup(&report.results))
        }
    }
}

/// Whether a case is a contact scene.
pub(crate) fn is_scene(loaded: &LoadedCase) -> bool {
    let case = &loaded.case;
    case.shaft.is_none() && (!case.bodies.is_empty() || case.contact.is_some())
}

/// The scene of a case, whose bodies must not overlap at the start.
fn apart(loaded: &LoadedCase) -> Result<Scene> {
    let scene = Scene::new(loaded)?;
    if let Some(overlap) = analysis::contact::overlap(&scene)? {
        let (a, b) = overlap.bodies;
        let names = [a, b].map(|i| &scene.bodies[i].name);
        return Err(loaded.fault(
            &format!("bodies.{b}.start"),
            format!("`{}` and `{}` overlap by {:.6e} m at the start", names[0], names[1], overlap.depth),
            "bodies apart or touching",
        ));
    }
    Ok(scene)
}

/// A scene of beams in contact.
fn contact(loaded: &LoadedCase, plots: bool, watch: analysis::spinup::Watch<'_>) -> Result<Finished> {
    let scene = apart(loaded)?;
    let report = report(loaded, analysis::contact::contact(&scene, watch)?);
    let svg = if plots { plot::contact::svg(&report)? } else { Vec::new() };
    let mut finished = finish(&report, svg, table::contact(&report.results))?;
    finished.cost = serde_json::to_value(report.results.cost).ok();
    Ok(finished)
}

/// Steps of an analysis that reports progress.
///
/// # Errors
/// Bad input.
pub fn steps(loaded: &LoadedCase, analysis: Analysis) -> Result<usize> {
    if analysis == Analysis::Contact {
        return Ok(TICKS);
    }
    if analysis == Analysis::Check {
        return Ok(0);
    }
    let model = Model::new(loaded)?;
    Ok(match analysis {
        Analysis::Campbell => model.campbell.as_ref().map_or(0, |c| c.speeds.len()),
        Analysis::Spinup => TICKS,
        _ => 0,
    })
}

/// What an analysis refuses about the model or its start is a fault of the case.
fn refused(loaded: &LoadedCase, error: Error) -> Error {
    match error {
        Error::Case { path, problem, allowed } => loaded.fault(&path, problem, allowed),
        other => other,
    }
}

/// The report of an outcome, with doubts about the values of the case.
fn checked<R>(loaded: &LoadedCase, model: &Model, mut outcome: Outcome<R>) -> Report<R> {
    outcome.diagnostics.extend(analysis::plausibility::plausibility(model));
    report(loaded, outcome)
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

fn missing_block(loaded: &LoadedCase, name: &str) -> Error {
    Error::Input {
        file: loaded.file.clone(),
        path: name.to_owned(),
        value: "missing".to_owned(),
        problem: format!("the case has no `{name}` block"),
        allowed: match name {
            "spinup" => r#"for example "spinup": { "drive": [ { "until": 1.0, "speed": "15000 rpm" } ] }"#,
            _ => r#"for example "campbell": { "speeds": { "from": 0, "to": "10000 rpm", "count": 101 } }"#,
        }
        .to_owned(),
    }
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
pub(crate) fn finish<R: Serialize>(
    report: &Report<R>,
    plots: Vec<(String, String)>,
    results: String,
) -> Result<Finished> {
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
