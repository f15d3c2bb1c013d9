//! What the figures of steady vibration share.

use crate::draw::clip::Point;
use crate::draw::panels::{Curve, STROKES};
use crate::results::OperatingRange;
use std::f64::consts::{PI, TAU};

/// Most stations that are drawn in one panel.
pub const MOST_STATIONS: usize = 5;

/// A length unit with its factor that suits a largest value in metres.
pub fn unit(largest: f64) -> (&'static str, f64) {
    if largest >= 0.02 {
        ("m", 1.0)
    } else if largest >= 2e-5 {
        ("mm", 1e3)
    } else {
        ("um", 1e6)
    }
}

/// A curve of the k-th station.
pub fn curve(k: usize, name: &str, points: Vec<Point>) -> Curve {
    Curve { name: name.to_owned(), stroke: STROKES[k % STROKES.len()], points }
}

/// Degrees by which a phase may be ahead before it counts as a lag of almost a turn.
const AHEAD: f64 = 30.0;

/// Phases in degrees between -330 and 30, so that a lag falls; broken where they pass an end.
pub fn phases(k: usize, name: &str, points: impl Iterator<Item = Point>) -> Vec<Curve> {
    let mut parts: Vec<Vec<Point>> = vec![Vec::new()];
    for (x, phase) in points {
        let degrees = AHEAD - (AHEAD - phase * 360.0 / TAU).rem_euclid(360.0);
        let last = parts.last().and_then(|part| part.last()).copied();
        if last.is_some_and(|(_, before): Point| (degrees - before).abs() > 180.0) {
            parts.push(Vec::new());
        }
        parts.iter_mut().last().into_iter().for_each(|part| part.push((x, degrees)));
    }
    let mut name = name.to_owned();
    parts.into_iter().map(|points| curve(k, &std::mem::take(&mut name), points)).collect()
}

/// The speeds of operation, from the minimum to the trip, rpm.
pub fn operation(o: &OperatingRange) -> (f64, f64) {
    (rpm(o.minimum_rad_s), rpm(o.trip_rad_s.unwrap_or(o.maximum_rad_s)))
}

/// What the shaded speeds are, in words.
pub fn operation_words(operating: Option<OperatingRange>) -> String {
    operating.map_or(String::new(), |o| {
        let trip = o.trip_rad_s.map_or(String::new(), |t| format!(", trip at {:.0}", rpm(t)));
        format!(" Shaded: operation, {:.0} to {:.0} rpm{trip}.", rpm(o.minimum_rad_s), rpm(o.maximum_rad_s))
    })
}

/// A speed in rpm.
pub fn rpm(speed: f64) -> f64 {
    speed * 30.0 / PI
}
