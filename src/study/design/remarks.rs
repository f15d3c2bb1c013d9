//! Remarks on the results of a study.

use crate::results::{Diagnostic, Tradeoff, TradeoffChoice, TradeoffPoint, Trust};
use crate::study::design::REFERENCE_ERROR_SHARE;
use crate::study::design::choice::{by_cost, finer_points};
use std::cmp::Ordering;

/// Error that an automatic choice aims at.
const AUTOMATIC_ERROR_FLOOR: f64 = 1e-3;

/// What a reader must know about the study.
pub(super) fn remarks(results: &Tradeoff) -> Vec<Diagnostic> {
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
        (error > estimate.max(AUTOMATIC_ERROR_FLOOR))
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
    match (&results.choice, results.reference.error.filter(|error| *error > REFERENCE_ERROR_SHARE * target * (1.0 + 1e-9))) {
        (Some(choice), _) => list.extend(about_choice(results, choice, target)),
        (None, Some(error)) => list.push(Diagnostic::error(
            "reference-too-coarse",
            format!(
                "the finest point is itself {error:.1e} off, judged by the next coarser ones: it can't tell errors of {target:e}. \
                 Refine the grid beyond it, or ask for {:.0e} or more",
                error / REFERENCE_ERROR_SHARE
            ),
        )),
        (None, None) => list.push(out_of_reach(points, target)),
    }
    list
}

/// What the finest point's own error is and what warnings the points carry.
pub(super) fn about_reference(results: &Tradeoff) -> Vec<Diagnostic> {
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
pub(super) fn about_choice(results: &Tradeoff, choice: &TradeoffChoice, target: f64) -> Vec<Diagnostic> {
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

pub(super) fn out_of_reach(points: &[TradeoffPoint], target: f64) -> Diagnostic {
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
