//! Cost against error over a grid of settings: the points of the grid, the errors, the front, the choice. It takes
//! points that someone has measured; it runs nothing.

use crate::case::{Analysis, Grid};
use crate::results::{
    Diagnostic, Machine, Tradeoff, TradeoffChoice, TradeoffPoint, TradeoffReference, Trust,
};
use serde_json::{Map, Value};
use std::cmp::Ordering;

/// Settings of a point: values by path.
pub type Settings = Map<String, Value>;

/// A finer point's error counts as larger from this factor on.
const CLEARLY: f64 = 1.01;

/// Error that an automatic choice aims at.
const AUTOMATIC: f64 = 1e-3;

/// Share of a target that the reference's own error may be.
const SHARE: f64 = 1.0 / 3.0;

/// Warnings of a run that do not speak of how accurate its numbers are.
const NOT_OF_ACCURACY: [&str; 8] = [
    "few-modes",
    "few-branches",
    "no-loads",
    "cross-coupling-ignored",
    "campbell-refused",
    "unstable",
    "unstable-equilibrium",
    "times-disturbed",
];

/// True for the code of a warning that puts the accuracy of a run's numbers in doubt.
pub fn is_of_accuracy(code: &str) -> bool {
    !NOT_OF_ACCURACY.contains(&code)
}

/// What a setting refines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// Number of elements.
    Mesh,
    /// Order of the section functions.
    Order,
    /// Tolerances and steps in time.
    Tolerance,
    /// Size of the reduced basis.
    Reduction,
    /// Points of an integration rule.
    Quadrature,
}

impl Axis {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Order => "section order",
            Self::Tolerance => "tolerance",
            Self::Reduction => "reduction",
            Self::Quadrature => "quadrature",
        }
    }

    /// What the setting at a path refines, if anything.
    pub fn of(path: &str) -> Option<Self> {
        match path.rsplit('.').next()? {
            "elements" | "mesh" => Some(Self::Mesh),
            "element" => Some(Self::Order),
            "rtol" | "atol" | "tolerance" | "step" => Some(Self::Tolerance),
            "reduction" => Some(Self::Reduction),
            "axial" => Some(Self::Quadrature),
            "section" if path.starts_with("shaft.quadrature") => Some(Self::Quadrature),
            _ => None,
        }
    }

    /// What can be refined in an analysis, quadrature aside, which is exact unless a case asks for less.
    fn all_of(analysis: Analysis, transient: bool) -> Vec<Self> {
        let mut list = vec![Self::Mesh, Self::Order];
        if transient {
            list.push(Self::Tolerance);
        }
        if analysis == Analysis::Campbell {
            list.push(Self::Reduction);
        }
        list
    }
}

/// What a run of a point gave.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measurement {
    /// The quantity.
    pub value: f64,
    /// Wall times of the runs, s.
    pub wall_s: Vec<f64>,
    /// Peak memory, MB.
    pub peak_memory_mb: Option<f64>,
    /// Unknowns after constraints.
    pub degrees_of_freedom: u64,
    /// Steps of a transient.
    pub steps: Option<u64>,
    /// Estimate of the error of automatically chosen section functions.
    pub estimated_error: Option<f64>,
    /// Warnings of its run that touch accuracy, `code: message`.
    pub warnings: Vec<String>,
    /// What its run modelled.
    pub modelled: Vec<String>,
    /// What its run left out.
    pub left_out: Vec<String>,
}

/// A point that was run: its measurement, or why there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Its settings.
    pub settings: Settings,
    /// What it gave.
    pub outcome: std::result::Result<Measurement, String>,
}

/// What the quantity is compared with.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// A number of the tradeoff block.
    Number(f64),
    /// A number that the case expects, and its source.
    Expected(f64, String),
    /// The point with the most unknowns.
    Finest,
}

/// What a study is about, besides its points.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Analysis of every point.
    pub analysis: Analysis,
    /// The quantity, by its place in the report.
    pub quantity: String,
    /// Where the times were taken.
    pub machine: Machine,
    /// Runs of a point.
    pub repeats: u32,
    /// Points at a time.
    pub points_at_a_time: usize,
    /// What the quantity is compared with.
    pub reference: Reference,
    /// Largest relative error allowed.
    pub target: Option<f64>,
}

/// Every combination of a grid's values; the last path varies fastest. Combinations that are there already are left out.
pub fn expand(grid: &Grid) -> Vec<Settings> {
    let mut points: Vec<Settings> = Vec::new();
    for axes in grid.products() {
        let mut product = vec![Settings::new()];
        for (path, values) in axes {
            let values = values.as_array().map_or(&[][..], Vec::as_slice);
            product = product
                .into_iter()
                .flat_map(|point| {
                    values.iter().map(move |value| {
                        let mut longer = point.clone();
                        longer.insert(path.clone(), value.clone());
                        longer
                    })
                })
                .collect();
        }
        for point in product {
            if !points.contains(&point) {
                points.push(point);
            }
        }
    }
    points
}

/// Names of the points: the values of what varies among them.
pub fn names(points: &[&Settings]) -> Vec<String> {
    let mut paths: Vec<&String> = Vec::new();
    for path in points.iter().flat_map(|point| point.keys()) {
        if !paths.contains(&path) {
            paths.push(path);
        }
    }
    paths.retain(|path| points.iter().any(|point| point.get(*path) != points[0].get(*path)));
    let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
    let word = |path: &str, value: &Value| {
        let alone = paths.iter().filter(|other| last(other) == last(path)).count() == 1;
        match (last(path).as_str(), value) {
            ("elements", value) if alone => format!("{} el.", plain(value)),
            ("mesh", value) => format!("mesh x{}", plain(value)),
            (_, Value::String(text)) if alone => text.clone(),
            (key, value) if alone => format!("{key} {}", plain(value)),
            (_, value) => format!("{path} {}", plain(value)),
        }
    };
    let name = |point: &&Settings| {
        let words = paths.iter().filter_map(|path| point.get(*path).map(|value| word(path, value)));
        let words = words.collect::<Vec<_>>().join(", ");
        if words.is_empty() { "as the case".to_owned() } else { words }
    };
    points.iter().map(name).collect()
}

/// A value in few characters.
fn plain(value: &Value) -> String {
    match (value, value.as_f64()) {
        (Value::String(text), _) => text.clone(),
        (_, Some(x)) if x != 0.0 && x.abs() < 0.01 => format!("{x:e}"),
        _ => value.to_string(),
    }
}

/// The middle of the values; the mean of the two middle ones of an even number.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (half, odd) = (sorted.len() / 2, sorted.len() % 2);
    match odd {
        1 => sorted.get(half).copied(),
        _ => Some((sorted.get(half.checked_sub(1)?)? + sorted.get(half)?) / 2.0),
    }
}

/// Compares two values of a setting that refines: `Greater` when `a` is finer. None for settings without order.
fn fineness(path: &str, a: &Value, b: &Value) -> Option<Ordering> {
    let size = |value: &Value| match value.as_str() {
        Some("none") => Some(f64::INFINITY),
        Some(_) => None,
        None => value.as_f64(),
    };
    let axis = Axis::of(path)?;
    if axis == Axis::Order {
        return richness(a.as_str()?, b.as_str()?);
    }
    let order = size(a)?.partial_cmp(&size(b)?)?;
    Some(if axis == Axis::Tolerance { order.reverse() } else { order })
}

/// Compares two members of the element family: `Greater` when the section functions of `a` hold those of `b`.
fn richness(a: &str, b: &str) -> Option<Ordering> {
    let digits = |name: &str, family: &str| -> Option<Vec<u32>> {
        name.strip_prefix(family)?.chars().map(|c| c.to_digit(10)).collect()
    };
    if let (Some(a), Some(b)) = (digits(a, "34X"), digits(b, "34X")) {
        return a.partial_cmp(&b);
    }
    let (a, b) = (digits(a, "34R")?, digits(b, "34R")?);
    let [d, h] = [0, 1].map(|i| a.get(i).zip(b.get(i)).map(|(a, b)| a.cmp(b)));
    match (d?, h?) {
        (d, h) if d == h || h == Ordering::Equal => Some(d),
        (Ordering::Equal, h) => Some(h),
        _ => None,
    }
}

/// The axes along which `a` is finer than `b`.
fn refined_axes(a: &Settings, b: &Settings) -> Vec<Axis> {
    let finer = |(path, value): (&String, &Value)| {
        let other = b.get(path)?;
        (fineness(path, value, other) == Some(Ordering::Greater)).then(|| Axis::of(path)).flatten()
    };
    let mut axes: Vec<Axis> = a.iter().filter_map(finer).collect();
    axes.sort_unstable();
    axes.dedup();
    axes
}

/// Whether `a` is finer than `b`: all else equal, more elements, points or vectors, or smaller tolerances.
pub fn is_finer(a: &Settings, b: &Settings) -> bool {
    let mut finer = false;
    for (path, value) in a {
        match b.get(path) {
            Some(other) if other == value => {}
            Some(other) => match fineness(path, value, other) {
                Some(Ordering::Greater) => finer = true,
                Some(Ordering::Equal) => {}
                _ => return false,
            },
            None => return false,
        }
    }
    finer && a.len() == b.len()
}

/// Tolerances of a point, for ties of the finest: the product of all, 1 without any.
fn tolerance(settings: &Settings) -> f64 {
    let of = |(path, value): (&String, &Value)| {
        let name = path.rsplit('.').next().unwrap_or_default();
        if ["rtol", "atol", "tolerance", "step"].contains(&name) { value.as_f64() } else { None }
    };
    settings.iter().filter_map(of).product()
}

/// The finest of the points that have a value without a warning of accuracy: most unknowns, then smallest tolerances,
/// then the last.
fn finest(points: &[Measured]) -> Option<usize> {
    let mut best: Option<(usize, u64, f64)> = None;
    for (index, point) in points.iter().enumerate() {
        let Ok(found) = &point.outcome else { continue };
        if !found.warnings.is_empty() {
            continue;
        }
        let (size, tolerance) = (found.degrees_of_freedom, tolerance(&point.settings));
        if best.is_none_or(|(_, s, t)| size > s || (size == s && tolerance <= t)) {
            best = Some((index, size, tolerance));
        }
    }
    best.map(|(index, ..)| index)
}

/// Orders points by time, then unknowns, then place in the grid.
fn by_cost(points: &[TradeoffPoint], a: usize, b: usize) -> Ordering {
    let time = |i: usize| points[i].wall_s.unwrap_or(f64::INFINITY);
    let size = |i: usize| points[i].degrees_of_freedom.unwrap_or(u64::MAX);
    time(a).total_cmp(&time(b)).then(size(a).cmp(&size(b))).then(a.cmp(&b))
}

/// Indices of the points that no other point beats in both time and error, by rising time; of points that are equal in
/// both, the one with fewer unknowns.
pub fn front(points: &[TradeoffPoint]) -> Vec<usize> {
    let error = |i: usize| points[i].error.unwrap_or(f64::INFINITY);
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| points[i].error.is_some()).collect();
    order.sort_by(|&a, &b| {
        let time = |i: usize| points[i].wall_s.unwrap_or(f64::INFINITY);
        time(a).total_cmp(&time(b)).then(error(a).total_cmp(&error(b))).then(by_cost(points, a, b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = error(i) < least;
        least = least.min(error(i));
        better
    });
    order
}

/// Indices of the points that are finer than this one and have an error.
fn finer_points(points: &[TradeoffPoint], of: usize) -> Vec<usize> {
    (0..points.len())
        .filter(|&i| points[i].error.is_some() && is_finer(&points[i].settings, &points[of].settings))
        .collect()
}

fn trust(points: &[TradeoffPoint], of: usize, finer: &[usize], target: f64) -> Trust {
    match finer {
        _ if !points[of].warnings.is_empty() => Trust::Warned,
        [] => Trust::Unconfirmed,
        _ if finer.iter().all(|&i| points[i].error.is_some_and(|e| e <= target)) => Trust::Confirmed,
        _ => Trust::Refuted,
    }
}

/// The cheapest point within the target: one that finer points confirm before one that has no finer points, and that
/// before one whose error a finer point shows to be small by luck, and any of them before one whose run warned of its
/// accuracy. `refinable` is what could have been refined.
pub fn choose(points: &[TradeoffPoint], target: f64, refinable: &[Axis]) -> Option<TradeoffChoice> {
    let within = (0..points.len()).filter(|&i| points[i].error.is_some_and(|e| e <= target));
    let judged = within.map(|i| {
        let finer = finer_points(points, i);
        (trust(points, i, &finer, target), i, finer)
    });
    let (trust, point, finer) = judged.min_by(|a, b| a.0.cmp(&b.0).then(by_cost(points, a.1, b.1)))?;
    let mut refined: Vec<Axis> =
        finer.iter().flat_map(|&i| refined_axes(&points[i].settings, &points[point].settings)).collect();
    refined.sort_unstable();
    refined.dedup();
    let missing = refinable.iter().filter(|axis| !refined.contains(axis));
    Some(TradeoffChoice {
        point,
        not_refined: missing.map(|axis| axis.name()).collect(),
        refined: refined.iter().map(|axis| axis.name()).collect(),
        settings: points[point].settings.clone(),
        error: points[point].error?,
        wall_s: points[point].wall_s?,
        trust,
        finer,
    })
}

/// Errors, front and choice of measured points, with remarks; a target out of reach is a remark of level error.
pub fn tradeoff(subject: &Subject, measured: &[Measured]) -> (Tradeoff, Vec<Diagnostic>) {
    let reference = reference(&subject.reference, measured);
    let settings: Vec<&Settings> = measured.iter().map(|m| &m.settings).collect();
    let mut points: Vec<TradeoffPoint> = Vec::new();
    for (index, (point, name)) in measured.iter().zip(names(&settings)).enumerate() {
        let found = point.outcome.as_ref().ok();
        let error = |found: &Measurement| {
            let r = reference.value.filter(|r| *r != 0.0 && reference.point != Some(index))?;
            // no point is known better than what it is compared with
            Some(((found.value - r).abs() / r.abs()).max(reference.error.unwrap_or(0.0)))
        };
        points.push(TradeoffPoint {
            name,
            settings: point.settings.clone(),
            value: found.map(|f| f.value),
            error: found.and_then(error),
            wall_s: found.and_then(|f| median(&f.wall_s)),
            runs: found.map_or(0, |f| f.wall_s.len()),
            peak_memory_mb: found.and_then(|f| f.peak_memory_mb),
            degrees_of_freedom: found.map(|f| f.degrees_of_freedom),
            steps: found.and_then(|f| f.steps),
            estimated_error: found.and_then(|f| f.estimated_error),
            pareto: false,
            finer_is_worse: false,
            warnings: found.map_or_else(Vec::new, |f| f.warnings.clone()),
            failed: point.outcome.as_ref().err().cloned(),
        });
    }
    for index in 0..points.len() {
        let worse = |&i: &usize| match (points[i].error, points[index].error) {
            (Some(finer), Some(own)) => finer > CLEARLY * own,
            _ => false,
        };
        points[index].finer_is_worse = finer_points(&points, index).iter().any(worse);
    }
    let front = front(&points);
    front.iter().for_each(|&i| points[i].pareto = true);
    let transient = measured.iter().any(|m| m.outcome.as_ref().is_ok_and(|found| found.steps.is_some()));
    let refinable = Axis::all_of(subject.analysis, transient);
    let fit = |target: f64| reference.error.is_none_or(|error| error <= SHARE * target * (1.0 + 1e-9));
    let choice = subject.target.filter(|t| fit(*t)).and_then(|target| choose(&points, target, &refinable));
    let results = Tradeoff {
        analysis: subject.analysis.name(),
        quantity: subject.quantity.clone(),
        machine: subject.machine.clone(),
        repeats: subject.repeats,
        points_at_a_time: subject.points_at_a_time,
        reference,
        target_error: subject.target,
        points,
        front,
        choice,
    };
    let remarks = remarks(&results);
    (results, remarks)
}

fn reference(wanted: &Reference, measured: &[Measured]) -> TradeoffReference {
    let given = |value: f64, kind, source| TradeoffReference {
        value: Some(value),
        kind,
        source,
        point: None,
        settings: None,
        error: None,
        refined: Vec::new(),
    };
    match wanted {
        Reference::Number(value) => given(*value, "number", None),
        Reference::Expected(value, source) => given(*value, "expected", Some(source.clone())),
        Reference::Finest => {
            let point = finest(measured);
            let of = point.map(|i| &measured[i]);
            let levels = point.map_or_else(Vec::new, |i| coarser_levels(measured, i));
            let error = levels.iter().map(|(_, error)| error).sum::<f64>();
            let mut refined: Vec<Axis> = levels.iter().map(|(axis, _)| *axis).collect();
            refined.sort_unstable();
            refined.dedup();
            TradeoffReference {
                value: of.and_then(|m| m.outcome.as_ref().ok()).map(|f| f.value),
                kind: "finest",
                source: None,
                point,
                settings: of.map(|m| m.settings.clone()),
                error: (!levels.is_empty()).then_some(error),
                refined: refined.iter().map(|axis| axis.name()).collect(),
            }
        }
    }
}

/// What every refining axis leaves of the finest point's error: along each path that refines, the change from the next
/// coarser point that is alike in all else. A third level gives the rate, `d2 / (d1/d2 - 1)`, within the change itself
/// and a fifteenth of it.
fn coarser_levels(measured: &[Measured], finest: usize) -> Vec<(Axis, f64)> {
    let value = |m: &Measured| m.outcome.as_ref().ok().map(|found| found.value);
    let Some(best) = value(&measured[finest]) else { return Vec::new() };
    let settings = &measured[finest].settings;
    let mut list = Vec::new();
    for (path, here) in settings {
        let Some(axis) = Axis::of(path) else { continue };
        let alike = |m: &Measured| {
            m.settings.len() == settings.len()
                && m.settings.iter().all(|(p, v)| p == path || settings.get(p) == Some(v))
        };
        let mut coarser: Vec<(&Value, f64)> = measured
            .iter()
            .filter(|m| alike(m))
            .filter_map(|m| Some((m.settings.get(path)?, value(m)?)))
            .filter(|(at, _)| fineness(path, here, at) == Some(Ordering::Greater))
            .collect();
        coarser.sort_by(|a, b| fineness(path, b.0, a.0).unwrap_or(Ordering::Equal));
        let change = |a: f64, b: f64| (a - b).abs() / best.abs().max(f64::MIN_POSITIVE);
        let error = match coarser[..] {
            [] => continue,
            [(_, next)] => change(best, next),
            [(_, next), (_, after), ..] => {
                let (d2, d1) = (change(best, next), change(next, after));
                if d1 > d2 { (d2 / (d1 / d2.max(f64::MIN_POSITIVE) - 1.0)).clamp(d2 / 15.0, d2) } else { d2 }
            }
        };
        list.push((axis, error));
    }
    list
}

/// What a reader must know about the study.
fn remarks(results: &Tradeoff) -> Vec<Diagnostic> {
    let points = &results.points;
    let name = |i: &usize| points[*i].name.as_str();
    let mut list = Vec::new();
    if let Some(index) = results.reference.point {
        list.push(Diagnostic::info(
            "reference-excluded",
            format!("the finest point ({}) is the reference and no part of the comparison", name(&index)),
        ));
    }
    list.extend(about_reference(results));
    let failed = points.iter().filter(|p| p.failed.is_some()).count();
    if failed > 0 {
        list.push(Diagnostic::info(
            "points-failed",
            format!("{failed} of {} points have no value, each with its reason", points.len()),
        ));
    }
    let lucky: Vec<&str> = results.front.iter().filter(|i| points[**i].finer_is_worse).map(name).collect();
    if !lucky.is_empty() {
        list.push(Diagnostic::warning(
            "error-by-luck",
            format!("a finer point has a larger error than these of the front: {}", lucky.join("; ")),
        ));
    }
    // a coarse mesh adds an error of its own; the finest of the grid does not
    let missed = (0..points.len()).filter(|&i| finer_points(points, i).is_empty()).filter_map(|i| {
        let (error, estimate) = (points[i].error?, points[i].estimated_error?);
        (error > estimate.max(AUTOMATIC))
            .then(|| format!("{}: {error:.1e}, estimated {estimate:.0e}", points[i].name))
    });
    let missed: Vec<String> = missed.collect();
    if !missed.is_empty() {
        list.push(Diagnostic::warning(
            "automatic-choice-missed",
            format!("an automatic choice misses its estimate: {}", missed.join("; ")),
        ));
    }
    if results.points_at_a_time > 1 {
        list.push(Diagnostic::warning(
            "times-disturbed",
            format!("{} points ran at a time: their times disturb each other", results.points_at_a_time),
        ));
    }
    let compared = points.iter().any(|p| p.error.is_some());
    if !compared {
        let why = match (points.iter().all(|p| p.failed.is_some()), results.reference.value) {
            (true, _) => "no point of the grid has a value; the first reason stands in the table",
            (_, Some(0.0)) => "the reference is zero: no error is relative to it",
            (_, None) => {
                "every point's run warned of its accuracy, and none of them can be the reference: add points without the \
                 warnings (for a hollow section the ring family or \"auto\"), or compare with a number from elsewhere"
            }
            _ => "only one point has a value, and it is the reference",
        };
        list.push(Diagnostic::error("nothing-to-compare", why));
    }
    let Some(target) = results.target_error.filter(|_| compared) else { return list };
    match (&results.choice, results.reference.error.filter(|error| *error > SHARE * target * (1.0 + 1e-9))) {
        (Some(choice), _) => list.extend(about_choice(results, choice, target)),
        (None, Some(error)) => list.push(Diagnostic::error(
            "reference-too-coarse",
            format!(
                "the finest point is itself {error:.1e} off, judged by the next coarser ones: it can't tell errors of {target:e}. \
                 Refine the grid beyond it, or ask for {:.0e} or more",
                error / SHARE
            ),
        )),
        (None, None) => list.push(out_of_reach(points, target)),
    }
    list
}

/// What the finest point's own error is and what warnings the points carry.
fn about_reference(results: &Tradeoff) -> Vec<Diagnostic> {
    let mut list = Vec::new();
    let reference = &results.reference;
    match (reference.kind, reference.error, reference.value) {
        ("finest", Some(error), _) => list.push(Diagnostic::info(
            "reference-error",
            format!(
                "the reference is off by about {error:.1e} in {}, judged by the next coarser points; no error of the table is \
                 known better",
                reference.refined.join(", ")
            ),
        )),
        ("finest", None, Some(_)) => list.push(Diagnostic::warning(
            "reference-unchecked",
            "the grid has no coarser point beside the reference that differs in one setting: its own error is unknown",
        )),
        _ => {}
    }
    let mut told: Vec<(&str, Vec<&str>)> = Vec::new();
    for point in &results.points {
        for warning in &point.warnings {
            match told.iter_mut().find(|(text, _)| text == warning) {
                Some((_, names)) => names.push(&point.name),
                None => told.push((warning, vec![&point.name])),
            }
        }
    }
    list.extend(told.into_iter().map(|(text, names)| {
        let of = match names.len() {
            n if n == results.points.len() => "every point".to_owned(),
            1..=3 => names.join("; "),
            n => format!("{n} points, {} first", names[0]),
        };
        Diagnostic::warning("point-warned", format!("{of}: {text}"))
    }));
    list
}

/// Whether finer points confirm the choice, and which cheaper points were passed over.
fn about_choice(results: &Tradeoff, choice: &TradeoffChoice, target: f64) -> Vec<Diagnostic> {
    let points = &results.points;
    let mut list = Vec::new();
    let cheaper = (0..points.len()).filter(|&i| {
        points[i].error.is_some_and(|e| e <= target) && by_cost(points, i, choice.point) == Ordering::Less
    });
    let passed: Vec<&str> = cheaper.map(|i| points[i].name.as_str()).collect();
    if !passed.is_empty() {
        list.push(Diagnostic::info(
            "passed-over",
            format!("cheaper and within the error, but no finer point confirms them: {}", passed.join("; ")),
        ));
    }
    match choice.trust {
        Trust::Confirmed => {}
        Trust::Warned => list.push(Diagnostic::warning(
            "choice-warned",
            format!(
                "the run of the choice warned of its accuracy: {}",
                points[choice.point].warnings.join("; ")
            ),
        )),
        Trust::Unconfirmed => list.push(Diagnostic::warning(
            "choice-unconfirmed",
            "the grid has no finer point beside the choice: add one that confirms its error",
        )),
        Trust::Refuted => list.push(Diagnostic::warning(
            "choice-by-luck",
            "a finer point misses the error: the choice may meet it by luck; add finer points to the grid",
        )),
    }
    list
}

fn out_of_reach(points: &[TradeoffPoint], target: f64) -> Diagnostic {
    let error = |i: &usize| points[*i].error.unwrap_or(f64::INFINITY);
    let least = (0..points.len()).min_by(|a, b| error(a).total_cmp(&error(b)));
    let reached =
        least.map_or(String::new(), |i| format!("; the least is {:.2e}, with {}", error(&i), points[i].name));
    Diagnostic::error(
        "error-out-of-reach",
        format!(
            "no point of the grid has an error of {target:e} or less{reached}. Refine the grid (more elements, another \
             element, smaller tolerances), take a reference that belongs to the model, or allow a larger error"
        ),
    )
}
