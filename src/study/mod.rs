//! A study of cost and error: every point of the grid in a process of its own, so that its time and memory are its own;
//! finished points are kept, so that a study that was broken off goes on where it was.
//!
//! [`plan`] checks the case's `tradeoff` block, [`measure`] runs what is not kept yet, [`finish`] makes the report.

pub mod design;
mod process;
mod store;

use crate::analysis::{Outcome, check, contact};
use crate::case::{Analysis, CaseKind, LoadedCase, TradeoffInput, shown};
use crate::error::{Error, Refusal, Result};
use crate::model::Model;
use crate::model::scene::Scene;
use crate::plot;
use crate::report::table;
use crate::results::{LeftOut, Machine, ModelSummary, Modelled};
use crate::run::{self, Finished};
use crate::study::design::{ComparedWith, Measured, PointSettings, Subject};
use crate::validate::filter_name;
use process::{Ended, Task};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use store::Store;

/// Most points of a grid.
const MOST_POINTS: usize = 5000;
/// A point that takes longer than this is run once, s.
const RUN_ONCE_SECONDS: f64 = 10.0;

/// One point: its settings and the case they make.
#[derive(Debug, Clone)]
pub struct PlannedPoint {
    /// Settings by path.
    pub settings: PointSettings,
    /// The case with these settings, without the study.
    pub case: Value,
    /// What it is kept under.
    key: String,
}

/// A checked study.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The block of the case.
    block: TradeoffInput,
    reference: ComparedWith,
    machine: Machine,
    file: String,
    /// The points, in the order of the grid.
    pub points: Vec<PlannedPoint>,
}

/// Points that were run or found, in the order of the grid.
#[derive(Debug, Clone)]
pub struct Measurements {
    /// One for each point of the plan.
    pub points: Vec<Measured>,
    /// How many were kept from an earlier run.
    pub reused: usize,
}

/// How a study is run.
#[derive(Debug, Clone)]
pub struct Conditions {
    /// Path of this program, which runs every point.
    pub program: PathBuf,
    /// Folder of the kept points.
    pub folder: PathBuf,
    /// Points at a time.
    pub at_a_time: usize,
    /// Whether kept points are measured anew.
    pub fresh: bool,
}

/// Checks the `tradeoff` block of a case and lays out its points.
///
/// # Errors
/// No block, an unknown path or a value of the wrong type in the grid, settings that the analysis does not read, a
/// reference that is not there.
pub fn plan(loaded: &LoadedCase) -> Result<Plan> {
    let block = loaded.case.tradeoff.clone().ok_or_else(|| missing_block(loaded))?;
    if !(1..=1000).contains(&block.repeats) {
        return Err(loaded.fault("tradeoff.repeats", "no such number of runs", "1 to 1000"));
    }
    if let Some(error) = block.error {
        check_target(error).map_err(|problem| loaded.fault("tradeoff.error", problem, TARGETS))?;
    }
    let number = block.grid.count();
    if number > MOST_POINTS {
        let problem = format!("the grid has {number} points");
        return Err(loaded.fault("tradeoff.grid", problem, format!("at most {MOST_POINTS} points")));
    }
    let analysis = block.analysis.name();
    let entry = run::entry(block.analysis);
    let kind = loaded.case.kind();
    let fits = |entry: &run::Entry| !entry.result_keys.is_empty() && entry.kinds.contains(&kind);
    if !fits(entry) {
        let problem = match kind {
            CaseKind::Scene => "the case is a contact scene",
            CaseKind::Shaft => "the case is a shaft",
        };
        let allowed = Analysis::all().map(run::entry).filter(|entry| fits(entry));
        let allowed: Vec<String> = allowed.map(|entry| format!("\"{}\"", entry.analysis.name())).collect();
        return Err(loaded.fault("tradeoff.analysis", problem, allowed.join(", ")));
    }
    if !block.quantity.path().starts_with("results.") {
        return Err(loaded.fault(
            "tradeoff.quantity",
            "the quantity is no place in the results",
            format!("a path that starts with \"results.\", as in {analysis}.json"),
        ));
    }
    let key = block.quantity.path().split('.').nth(1).unwrap_or_default();
    let keys = entry.result_keys;
    if !keys.contains(&key) {
        return Err(loaded.fault(
            "tradeoff.quantity",
            format!("the results of {analysis} have no number under `{key}`"),
            format!("results. with one of {}, and the path below it as in {analysis}.json", keys.join(", ")),
        ));
    }
    let reference = reference(loaded, &block)?;
    let machine = machine();
    let mut points = Vec::new();
    let mut unfit = Unfit::default();
    for settings in design::expand(&block.grid) {
        let changed = with(loaded, block.analysis, &settings)?;
        unfit.look(&changed, &settings);
        let mut case = changed.value;
        if let Value::Object(map) = &mut case {
            map.shift_remove("tradeoff");
        }
        let key = store::key(&case, analysis, &block, &machine.processor);
        points.push(PlannedPoint { settings, case, key });
    }
    unfit.refuse(loaded)?;
    Ok(Plan { block, reference, machine, file: loaded.file.clone(), points })
}

/// What a relative error may be.
pub const TARGETS: &str = "a relative error above 0 and below 1, e.g. 1e-3";

/// Refuses what is no relative error.
///
/// # Errors
/// The problem in words.
pub fn check_target(error: f64) -> std::result::Result<(), &'static str> {
    if error > 0.0 && error < 1.0 { Ok(()) } else { Err("no such relative error") }
}

fn missing_block(loaded: &LoadedCase) -> Error {
    loaded.fault(
        "tradeoff",
        "the case has no `tradeoff` block",
        r#"for example "tradeoff": { "analysis": "modes", "quantity": { "path": "results.modes.*.frequency_hz", "where": { "kind": "bending", "n": 1 } }, "reference": "finest", "grid": { "shaft.segments.0.elements": [2, 4, 8, 16] } }"#,
    )
}

/// The case with the settings of a point.
fn with(loaded: &LoadedCase, analysis: Analysis, settings: &PointSettings) -> Result<LoadedCase> {
    for (path, value) in settings {
        if let Some(why) = without_effect(path, analysis) {
            return Err(grid_fault(loaded, path, value, why, "paths of what the analysis computes with"));
        }
    }
    let settings = &written_out(loaded, settings)?;
    let whole = match loaded.with(settings) {
        Ok(changed) => return Ok(changed),
        Err(error) => error,
    };
    // the path that is wrong on its own, else the first of the combination
    for (path, value) in settings {
        let alone = PointSettings::from_iter([(path.clone(), value.clone())]);
        if let Err(error) = loaded.with(&alone) {
            return Err(in_grid(loaded, path, value, error));
        }
    }
    match settings.iter().next() {
        Some((path, value)) => Err(in_grid(loaded, path, value, whole)),
        None => Err(whole),
    }
}

/// Values of the grid whose every combination makes a case that is refused.
#[derive(Default)]
struct Unfit {
    /// Path, value and, while no combination with it was fit, the first refusal.
    values: Vec<(String, Value, Option<Error>)>,
}

impl Unfit {
    /// Builds the model of a point, which costs nothing beside its run.
    fn look(&mut self, case: &LoadedCase, settings: &PointSettings) {
        let built = if case.case.kind() == CaseKind::Scene {
            Scene::new(case).map(drop)
        } else {
            Model::new(case).map(drop)
        };
        let refusal = built.err();
        for (path, value) in settings {
            match self.values.iter_mut().find(|(p, v, _)| p == path && v == value) {
                None => self.values.push((path.clone(), value.clone(), refusal.clone())),
                Some(known) if refusal.is_none() => known.2 = None,
                Some(_) => {}
            }
        }
    }

    fn refuse(self, loaded: &LoadedCase) -> Result<()> {
        match self.values.into_iter().find_map(|(path, value, refusal)| Some((path, value, refusal?))) {
            Some((path, value, refusal)) => Err(in_grid(loaded, &path, &value, refusal)),
            None => Ok(()),
        }
    }
}

/// The settings that a case knows: `mesh` as the numbers of elements of all segments or bodies.
fn written_out(loaded: &LoadedCase, settings: &PointSettings) -> Result<PointSettings> {
    let mut all = PointSettings::new();
    for (path, value) in settings {
        if path != "mesh" {
            all.insert(path.clone(), value.clone());
            continue;
        }
        let Some(factor) = value.as_u64().filter(|f| (1..=10_000).contains(f)) else {
            return Err(grid_fault(
                loaded,
                path,
                value,
                "the mesh has no such factor",
                "whole numbers from 1 to 10000",
            ));
        };
        let segments = loaded.case.shaft.iter().flat_map(|s| &s.segments).map(|s| s.elements);
        let bodies = loaded.case.bodies.iter().map(|b| b.elements);
        let list: [(&str, Vec<u64>); 2] =
            [("shaft.segments", segments.collect()), ("bodies", bodies.collect())];
        for (i, (place, elements)) in list.iter().flat_map(|(p, l)| l.iter().map(move |n| (p, n))).enumerate()
        {
            all.insert(format!("{place}.{i}.elements"), Value::from(elements.saturating_mul(factor)));
        }
    }
    Ok(all)
}

/// Why a setting would change nothing that the analysis computes, if so.
fn without_effect(path: &str, analysis: Analysis) -> Option<&'static str> {
    let head = path.split('.').next().unwrap_or_default();
    let linear = run::entry(analysis).linear;
    match head {
        "title" | "description" | "source" | "expected" | "tradeoff" => {
            Some("it changes nothing that is computed")
        }
        head if Analysis::from_name(head).is_some_and(|other| other != analysis) => {
            Some("it belongs to another analysis than the study's")
        }
        "shaft" if linear && path.starts_with("shaft.quadrature") => {
            Some("linear analyses integrate exactly; rules of points act in static and spinup")
        }
        "gravity" | "loads" if linear => Some("it does not act in a linear analysis"),
        _ => None,
    }
}

fn grid_fault(loaded: &LoadedCase, path: &str, value: &Value, problem: &str, allowed: &str) -> Error {
    Error::Refused(Refusal {
        file: Some(loaded.file.clone()),
        found: Some(value.to_string()),
        ..Refusal::at(shown(&format!("tradeoff.grid.{path}")), problem, allowed)
    })
}

/// A fault that a value of the grid makes, told at its place in the grid.
fn in_grid(loaded: &LoadedCase, path: &str, value: &Value, error: Error) -> Error {
    match error {
        Error::Refused(Refusal { path: inner, problem, allowed, .. }) => {
            let problem = if inner == path { problem } else { format!("{problem} (at `{inner}`)") };
            grid_fault(loaded, path, value, &problem, &allowed)
        }
        Error::Usage(problem) => {
            grid_fault(loaded, path, value, &problem, "paths of the case, as with --set (see `rotor schema`)")
        }
        other => other,
    }
}

/// What the quantity is compared with.
fn reference(loaded: &LoadedCase, block: &TradeoffInput) -> Result<ComparedWith> {
    use crate::case::StudyReference as Wanted;
    let fault = |problem: String, allowed: &str| Err(loaded.fault("tradeoff.reference", problem, allowed));
    let found = match block.reference {
        Wanted::Finest => return Ok(ComparedWith::Finest),
        Wanted::Value(value) => ComparedWith::Number(value),
        Wanted::Expected => {
            let analysis = block.analysis;
            let fits = loaded.case.expected.iter().filter(|e| {
                e.set.is_none()
                    && e.analysis.unwrap_or_else(|| loaded.case.default_analysis()) == analysis
                    && e.path == block.quantity.path()
                    && e.filter.as_ref() == block.quantity.filter()
            });
            let numbers: Vec<(f64, &String)> =
                fits.filter_map(|e| e.value.as_f64().map(|value| (value, &e.source))).collect();
            match numbers.as_slice() {
                [] => {
                    return fault(
                        format!("the case expects no number of {} for that quantity", analysis.name()),
                        "an entry of `expected` with the same analysis, path and where, one number and no `set`; or a number",
                    );
                }
                [(value, source), rest @ ..] if rest.iter().all(|(other, _)| other == value) => {
                    ComparedWith::Expected(*value, (*source).clone())
                }
                several => {
                    let values: Vec<String> = several.iter().map(|(v, _)| v.to_string()).collect();
                    return fault(
                        format!("the case expects several numbers for that quantity: {}", values.join(", ")),
                        "the number itself",
                    );
                }
            }
        }
    };
    match found {
        ComparedWith::Number(0.0) | ComparedWith::Expected(0.0, _) => {
            fault("no error is relative to zero".to_owned(), "a number other than zero, or another quantity")
        }
        found => Ok(found),
    }
}

/// The computer that takes the times.
fn machine() -> Machine {
    let named = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|l| l.starts_with("model name"))?;
        line.split_once(':').map(|(_, name)| name.trim().to_owned())
    });
    Machine {
        processor: named.unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
    }
}

/// Runs the points that are not kept yet. `progress` gets the number of finished points and the name of one that
/// starts; `stop` ends the running processes, what is finished stays kept.
///
/// # Errors
/// Folders that can't be written, a program that can't be run, or an interrupt.
pub fn measure(
    plan: &Plan,
    conditions: &Conditions,
    stop: &AtomicBool,
    progress: &(dyn Fn(usize, &str) + Sync),
) -> Result<Measurements> {
    let store = Store::open(&conditions.folder)?;
    let settings: Vec<&PointSettings> = plan.points.iter().map(|p| &p.settings).collect();
    let names = design::names(&settings);
    let enough = |runs: &[f64]| {
        runs.len() >= plan.block.repeats as usize || runs.first().is_some_and(|w| *w > RUN_ONCE_SECONDS)
    };
    let kept = |point: &PlannedPoint| {
        let found = if conditions.fresh { None } else { store.read(&point.key) };
        found.filter(|found| found.as_ref().map_or(true, |m| enough(&m.wall_s)))
    };
    let outcomes: Vec<_> = plan.points.iter().map(kept).collect();
    let reused = outcomes.iter().flatten().count();
    let waiting: Vec<usize> = (0..outcomes.len()).filter(|&i| outcomes[i].is_none()).collect();
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(reused));
    let outcomes = Mutex::new(outcomes);
    let fault = Mutex::new(None);
    let hold = |error: Error| {
        fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        // nothing new is begun
        next.store(waiting.len(), Ordering::Relaxed);
    };
    let work = || {
        while let Some(&index) = waiting.get(next.fetch_add(1, Ordering::Relaxed).min(waiting.len())) {
            let point = &plan.points[index];
            progress(done.load(Ordering::Relaxed), &names[index]);
            let task = Task {
                program: &conditions.program,
                analysis: plan.block.analysis.name(),
                case: &case_text(&point.case),
                file: &plan.file,
                quantity: &plan.block.quantity,
                repeats: plan.block.repeats,
                slow: RUN_ONCE_SECONDS,
            };
            let outcome = match process::point(&task, stop) {
                Ok(Ended::Stopped) => return,
                Ok(Ended::Crashed(reason)) => Err(reason),
                Ok(Ended::Done(outcome)) => match store.write(&point.key, &point.settings, &outcome) {
                    Ok(()) => outcome,
                    Err(error) => return hold(error),
                },
                Err(error) => return hold(error),
            };
            outcomes.lock().unwrap_or_else(PoisonError::into_inner)[index] = Some(outcome);
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, &names[index]);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..conditions.at_a_time.clamp(1, waiting.len().max(1)) {
            scope.spawn(work);
        }
    });
    if let Some(error) = fault.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let outcomes = outcomes.into_inner().unwrap_or_else(PoisonError::into_inner);
    let finished = outcomes.iter().flatten().count();
    let points: Vec<Measured> = plan
        .points
        .iter()
        .zip(outcomes)
        .filter_map(|(point, outcome)| Some(Measured { settings: point.settings.clone(), outcome: outcome? }))
        .collect();
    if points.len() < plan.points.len() {
        return Err(Error::analysis(
            format!("interrupted: {finished} of {} points are finished", plan.points.len()),
            format!("they are kept in {}", conditions.folder.display()),
            "run the same command again to go on",
        ));
    }
    Ok(Measurements { points, reused })
}

/// Size and content of the case as it stands.
fn case_summary(loaded: &LoadedCase) -> Result<ModelSummary> {
    if loaded.case.kind() == CaseKind::Scene {
        return Ok(contact::check(&Scene::new(loaded)?)?.model);
    }
    Ok(check::check(&Model::new(loaded)?)?.model)
}

/// A case as the text of a file, every digit kept.
pub fn case_text(case: &Value) -> String {
    format!("{case:#}\n")
}

/// A finished study: its report, and the case file of the chosen settings, if a choice was asked for and made.
#[derive(Debug)]
pub struct Concluded {
    /// Report, plot, table.
    pub finished: Finished,
    /// The case with the chosen settings.
    pub chosen: Option<Value>,
    /// Largest error that was asked for.
    pub target: Option<f64>,
}

/// Report, plot, table and choice of a measured study.
///
/// # Errors
/// A case that is wrong as it stands, or a failure of the drawing library.
pub fn finish(
    loaded: &LoadedCase,
    plan: &Plan,
    measured: &Measurements,
    target: Option<f64>,
    at_a_time: usize,
    plots: bool,
) -> Result<Concluded> {
    let block = &plan.block;
    let quantity = match block.quantity.filter() {
        None => block.quantity.path().to_owned(),
        Some(filter) => block.quantity.path().replacen('*', &filter_name(filter, 0), 1),
    };
    let subject = Subject {
        analysis: block.analysis,
        quantity,
        machine: plan.machine.clone(),
        repeats: block.repeats,
        points_at_a_time: at_a_time,
        reference: plan.reference.clone(),
        target: target.or(block.error),
    };
    let (results, diagnostics) = design::tradeoff(&subject, &measured.points);
    let chosen = results.choice.as_ref().map(|choice| plan.points[choice.point].case.clone());
    let mut model = case_summary(loaded)?;
    // what the studied analysis models, as its runs said it
    let points = measured.points.iter().filter_map(|m| m.outcome.as_ref().ok());
    if let Some(found) = points.max_by_key(|found| found.degrees_of_freedom) {
        model.modelled = found.modelled.iter().cloned().map(Modelled::Told).collect();
        model.left_out = found.left_out.iter().cloned().map(LeftOut::Told).collect();
    }
    model
        .modelled
        .push(Modelled::Study { settings: results.points.len(), analysis: subject.analysis.name() });
    let report = run::report(loaded, Outcome { results, model, diagnostics });
    let svg = if plots { plot::tradeoff::svg(&report)? } else { Vec::new() };
    let counts = format!(
        "  {} points: {} kept from an earlier run, {} measured now\n",
        measured.points.len(),
        measured.reused,
        measured.points.len() - measured.reused
    );
    let finished = run::finish(&report, svg, counts + &table::tradeoff(&report.results))?;
    Ok(Concluded { finished, chosen, target: subject.target })
}
