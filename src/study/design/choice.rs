//! The Pareto front of cost and error, and the choice of a point.

use crate::results::{TradeoffChoice, TradeoffPoint, Trust};
use crate::study::design::{Axis, is_finer, refined_axes};
use std::cmp::Ordering;

/// Orders points by time, then unknowns, then place in the grid.
pub(super) fn by_cost(points: &[TradeoffPoint], a: usize, b: usize) -> Ordering {
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
pub(super) fn finer_points(points: &[TradeoffPoint], of: usize) -> Vec<usize> {
    (0..points.len())
        .filter(|&i| points[i].error.is_some() && is_finer(&points[i].settings, &points[of].settings))
        .collect()
}

pub(super) fn trust(points: &[TradeoffPoint], of: usize, finer: &[usize], target: f64) -> Trust {
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
