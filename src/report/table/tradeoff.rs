//! The table of a trade-off study.

use crate::report::table::columns;
use crate::results::{Tradeoff, TradeoffPoint, Trust};

/// A study: the front, the other points by time, what failed, and the choice.
pub fn tradeoff(results: &Tradeoff) -> String {
    let reference = &results.reference;
    let mut text = format!(
        "  {} of {}, reference {} ({}{})\n  times on {}, {}\n\n",
        results.quantity,
        results.analysis,
        reference.value.map_or("-".to_owned(), |v| format!("{v:.9e}")),
        match reference.kind {
            "number" => "given",
            "expected" => "expected by the case",
            _ => "the finest point without a warning, no part of the comparison",
        },
        match (&reference.source, reference.error) {
            (Some(source), _) => format!(": {source}"),
            (None, Some(error)) =>
                format!("; itself off by about {error:.1e}, which bounds the errors below"),
            (None, None) => String::new(),
        },
        results.machine.processor,
        match results.repeats {
            1 => "one run each".to_owned(),
            n => format!("median of {n} runs (one where it takes more than 10 s)"),
        },
    );
    let chosen = results.choice.as_ref().map(|c| c.point);
    let row = |i: usize| tradeoff_row(&results.points[i], chosen == Some(i), reference.point == Some(i));
    let mut others: Vec<usize> = (0..results.points.len())
        .filter(|&i| results.points[i].wall_s.is_some() && !results.points[i].pareto)
        .collect();
    let time = |i: usize| results.points[i].wall_s.unwrap_or(f64::INFINITY);
    others.sort_by(|&a, &b| time(a).total_cmp(&time(b)));
    let rows: Vec<Vec<String>> = results.front.iter().chain(&others).map(|&i| row(i)).collect();
    if !rows.is_empty() {
        let steps = results.points.iter().any(|p| p.steps.is_some());
        let keep = |mut row: Vec<String>| {
            if !steps {
                row.remove(STEPS_COLUMN);
            }
            row
        };
        let head = keep(
            ["", "error", "wall (s)", "MB", "unknowns", "steps", "value", "setting"]
                .map(str::to_owned)
                .to_vec(),
        );
        let head: Vec<&str> = head.iter().map(String::as_str).collect();
        text += &columns(&head, &rows.into_iter().map(keep).collect::<Vec<_>>());
    }
    for point in &results.points {
        if let Some(reason) = &point.failed {
            text += &format!("  no value: {}: {reason}\n", point.name);
        }
    }
    if let (Some(choice), Some(target)) = (&results.choice, results.target_error) {
        let trust = match choice.trust {
            Trust::Confirmed => "confirmed by",
            Trust::Unconfirmed => "not confirmed, for want of finer points",
            Trust::Refuted => "by luck: missed by one of",
            Trust::Warned => "its run warned of its accuracy;",
        };
        let finer = match choice.finer.len() {
            0 => String::new(),
            1 => " 1 finer point".to_owned(),
            n => format!(" {n} finer points"),
        };
        let refined = match choice.refined.is_empty() {
            true => String::new(),
            false => format!("; refined: {}", choice.refined.join(", ")),
        };
        let open = match choice.not_refined.is_empty() {
            true => String::new(),
            false => format!("; not refined: {}", choice.not_refined.join(", ")),
        };
        text += &format!(
            "\n  chosen for {target:e}: {}, error {:.2e}, {:.4} s ({trust}{finer}{refined}{open})\n",
            results.points[choice.point].name, choice.error, choice.wall_s
        );
    }
    text
}

/// Column of the steps in [`tradeoff_row`].
const STEPS_COLUMN: usize = 5;

fn tradeoff_row(point: &TradeoffPoint, chosen: bool, reference: bool) -> Vec<String> {
    let number = |n: Option<u64>| n.map_or("-".to_owned(), |n| n.to_string());
    let mut name = point.name.clone();
    if let Some(estimate) = point.estimated_error {
        name += &format!(" (estimated {estimate:.0e})");
    }
    if point.finer_is_worse {
        name += " (a finer point is worse)";
    }
    let codes: Vec<&str> = point.warnings.iter().filter_map(|w| w.split(':').next()).collect();
    if !codes.is_empty() {
        name += &format!(" (warned: {})", codes.join(", "));
    }
    let mark = match (chosen, point.pareto, reference) {
        (true, ..) => "chosen",
        (_, true, _) => "front",
        (_, _, true) => "reference",
        _ => "",
    };
    vec![
        mark.to_owned(),
        point.error.map_or("-".to_owned(), |e| format!("{e:.2e}")),
        point.wall_s.map_or("-".to_owned(), |w| format!("{w:.4}")),
        point.peak_memory_mb.map_or("-".to_owned(), |m| format!("{m:.0}")),
        number(point.degrees_of_freedom),
        number(point.steps),
        point.value.map_or("-".to_owned(), |v| format!("{v:.9e}")),
        name,
    ]
}
