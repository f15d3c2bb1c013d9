//! Cost against error over a grid of settings: the points of the grid, the errors, the front, the choice. It takes
//! points that someone has measured; it runs nothing.

mod choice;
mod remarks;

pub use choice::{choose, front};

use crate::case::{Analysis, Grid};
use crate::results::{Diagnostic, Machine, Tradeoff, TradeoffPoint, TradeoffReference};
use choice::finer_points;
use serde_json::{Map, Value};
use std::cmp::Ordering;

/// Settings of a point: values by path.
pub type PointSettings = Map<String, Value>;

/// A finer point's error counts as larger from this factor on.
const CLEARLY_WORSE_FACTOR: f64 = 1.01;

/// Share of a target that the reference's own error may be.
const REFERENCE_ERROR_SHARE: f64 = 1.0 / 3.0;

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
    /// Name of the axis in words.
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
    /// Value of the quantity.
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
    /// Settings of the point.
    pub settings: PointSettings,
    /// What it gave.
    pub outcome: std::result::Result<Measurement, String>,
}

/// What the quantity is compared with.
#[derive(Debug, Clone, PartialEq)]
pub enum ComparedWith {
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
    pub reference: ComparedWith,
    /// Largest relative error allowed.
    pub target: Option<f64>,
}

/// Every combination of a grid's values; the last path varies fastest. Combinations that are there already are left out.
pub fn expand(grid: &Grid) -> Vec<PointSettings> {
    let mut points: Vec<PointSettings> = Vec::new();
    for axes in grid.products() {
        let mut product = vec![PointSettings::new()];
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
pub fn names(points: &[&PointSettings]) -> Vec<String> {
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
    let name = |point: &&PointSettings| {
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
fn refined_axes(a: &PointSettings, b: &PointSettings) -> Vec<Axis> {
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
pub fn is_finer(a: &PointSettings, b: &PointSettings) -> bool {
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
fn tolerance(settings: &PointSettings) -> f64 {
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

/// Errors, front and choice of measured points, with remarks; a target out of reach is a remark of level error.
pub fn tradeoff(subject: &Subject, measured: &[Measured]) -> (Tradeoff, Vec<Diagnostic>) {
    let reference = reference(&subject.reference, measured);
    let settings: Vec<&PointSettings> = measured.iter().map(|m| &m.settings).collect();
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
            (Some(finer), Some(own)) => finer > CLEARLY_WORSE_FACTOR * own,
            _ => false,
        };
        points[index].finer_is_worse = finer_points(&points, index).iter().any(worse);
    }
    let front = front(&points);
    front.iter().for_each(|&i| points[i].pareto = true);
    let transient = measured.iter().any(|m| m.outcome.as_ref().is_ok_and(|found| found.steps.is_some()));
    let refinable = Axis::all_of(subject.analysis, transient);
    let fit = |target: f64| {
        reference.error.is_none_or(|error| error <= REFERENCE_ERROR_SHARE * target * (1.0 + 1e-9))
    };
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
    let remarks = remarks::remarks(&results);
    (results, remarks)
}

fn reference(wanted: &ComparedWith, measured: &[Measured]) -> TradeoffReference {
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
        ComparedWith::Number(value) => given(*value, "number", None),
        ComparedWith::Expected(value, source) => given(*value, "expected", Some(source.clone())),
        ComparedWith::Finest => {
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
