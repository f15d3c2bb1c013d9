//! Plots of `rotor unbalance`: amplitude and phase over speed, bearing forces, deflected shaft and orbits at the peaks.

use crate::draw::clip::Point;
use crate::draw::palette::{self, Marker};
use crate::draw::panels::{Curve, Mark, Panel, Surroundings, figure};
use crate::error::Result;
use crate::plot::response::{MOST_STATIONS, curve, operation, operation_words, phases, rpm, unit};
use crate::results::{DeflectedShape, Figures, OperatingRange, Report, UnbalanceResponse};
use std::f64::consts::TAU;

/// Points of an orbit.
const ORBIT_POINTS: usize = 73;
/// Most shapes that are drawn.
const MOST_SHAPES: usize = 5;

/// unbalance.svg, and where there is something to draw unbalance-forces.svg and unbalance-shapes.svg.
///
/// # Errors
/// A failure of the drawing library.
pub fn svg(report: &Report<UnbalanceResponse>) -> Result<Figures> {
    let mut figures = vec![("unbalance.svg".to_owned(), bode(report)?)];
    if !report.results.bearing_forces_n.is_empty() {
        figures.push(("unbalance-forces.svg".to_owned(), forces(report)?));
    }
    if !report.results.shapes.is_empty() {
        figures.push(("unbalance-shapes.svg".to_owned(), shapes(report)?));
    }
    Ok(figures)
}

/// Stretches of operation for the background.
fn bands(operating: Option<OperatingRange>) -> Vec<(f64, f64)> {
    operating.iter().map(operation).collect()
}

fn bode(report: &Report<UnbalanceResponse>) -> Result<String> {
    let results = &report.results;
    let drawn = results.stations.len().min(MOST_STATIONS);
    let curves = || results.fine.iter().zip(&results.stations).take(drawn).enumerate();
    let largest = curves().flat_map(|(_, (c, _))| c).fold(0.0, |m: f64, p| m.max(p[1]));
    let (unit, factor) = unit(largest);
    let name = |k: usize| {
        let station = &results.stations[k];
        station.angle_rad.map_or_else(
            || format!("{} (major axis)", station.name),
            |a| format!("{} at {:.0} deg", station.name, a * 360.0 / TAU),
        )
    };
    let amplitude: Vec<Curve> = curves()
        .map(|(k, (c, _))| curve(k, &name(k), c.iter().map(|p| (rpm(p[0]), factor * p[1])).collect()))
        .collect();
    let phase: Vec<Curve> =
        curves().flat_map(|(k, (c, _))| phases(k, "", c.iter().map(|p| (rpm(p[0]), p[2])))).collect();
    let drawn_names: Vec<&String> = results.stations.iter().take(drawn).map(|s| &s.name).collect();
    let marks = results
        .peaks
        .iter()
        .filter(|p| drawn_names.contains(&&p.station))
        .map(|p| Mark {
            name: String::new(),
            marker: Marker::Disc,
            color: palette::BLACK,
            at: (rpm(p.speed_rad_s), factor * p.amplitude_m),
        })
        .collect();
    let up = if results.amplitude == "peak-to-peak" {
        "Amplitude, peak to peak"
    } else {
        "Amplitude, zero to peak"
    };
    let across = ("Speed", "rpm");
    let panels = [
        Panel {
            across,
            up: (up, unit),
            curves: amplitude,
            marks,
            bands: bands(results.operating_speed),
            height: 330.0,
            ..Panel::default()
        },
        Panel {
            across,
            up: ("Phase (a lag is negative)", "deg"),
            curves: phase,
            bands: bands(results.operating_speed),
            ..Panel::default()
        },
    ];
    let moments: Vec<String> = results
        .masses
        .iter()
        .take(4)
        .map(|m| {
            format!("{:.4} g mm at {:.4} m, {:.0} deg", m.moment_kg_m * 1e6, m.at, m.angle_rad * 360.0 / TAU)
        })
        .collect();
    let more = if results.masses.len() > 4 {
        format!(" and {} more", results.masses.len() - 4)
    } else {
        String::new()
    };
    let remarks = format!(
        "Unbalance {}{more}. Angles from y towards z, phase against the rotation mark.{}",
        moments.join("; "),
        operation_words(results.operating_speed)
    );
    figure(&Surroundings::new(report, "Unbalance response", remarks), &panels, 1)
}

fn forces(report: &Report<UnbalanceResponse>) -> Result<String> {
    let results = &report.results;
    let curves = results.bearing_forces_n.iter().take(MOST_STATIONS).enumerate().map(|(k, (path, f))| {
        let points = results.speeds_rad_s.iter().zip(&f.major_n).map(|(s, v)| (rpm(*s), *v)).collect();
        curve(k, path, points)
    });
    let panel = Panel {
        across: ("Speed", "rpm"),
        up: ("Largest force, zero to peak", "N"),
        curves: curves.collect(),
        bands: bands(results.operating_speed),
        height: 330.0,
        ..Panel::default()
    };
    let remarks = format!(
        "What the shaft exerts on bearings, and housings on the ground.{}",
        operation_words(results.operating_speed)
    );
    figure(&Surroundings::new(report, "Bearing forces", remarks), &[panel], 1)
}

/// The major semi-axis along the shaft, and the orbit where it is largest.
fn shapes(report: &Report<UnbalanceResponse>) -> Result<String> {
    let results = &report.results;
    let mut list: Vec<&DeflectedShape> = results.shapes.iter().collect();
    list.sort_by(|a, b| a.speed_rad_s.total_cmp(&b.speed_rad_s));
    list.truncate(MOST_SHAPES);
    let largest_of = |s: &DeflectedShape| s.major_m.iter().copied().fold(0.0, f64::max);
    let name = |s: &DeflectedShape| {
        let what = if s.at_peak { " (peak)" } else { "" };
        format!("{:.0} rpm{what}, largest {:.2e} m", rpm(s.speed_rad_s), largest_of(s))
    };
    let over = |s: &DeflectedShape| if largest_of(s) > 0.0 { 1.0 / largest_of(s) } else { 0.0 };
    let along = list.iter().enumerate().map(|(k, s)| {
        curve(k, &name(s), s.x_m.iter().zip(&s.major_m).map(|(x, v)| (*x, v * over(s))).collect())
    });
    let across = list.iter().enumerate().map(|(k, s)| {
        let at = (0..s.x_m.len()).max_by(|&i, &j| s.major_m[i].total_cmp(&s.major_m[j])).unwrap_or(0);
        let point = |t: f64| -> Point {
            let real = |[re, im]: [f64; 2]| (re * t.cos() - im * t.sin()) * over(s);
            // z to the right, y up: seen along +x
            (real(s.z_m[at]), real(s.y_m[at]))
        };
        let points = (0..ORBIT_POINTS).map(|i| point(TAU * i as f64 / (ORBIT_POINTS - 1) as f64)).collect();
        curve(k, "", points)
    });
    let marks = list.iter().map(|s| {
        let at = (0..s.x_m.len()).max_by(|&i, &j| s.major_m[i].total_cmp(&s.major_m[j])).unwrap_or(0);
        Mark {
            name: String::new(),
            marker: Marker::Disc,
            color: palette::BLACK,
            at: (s.z_m[at][0] * over(s), s.y_m[at][0] * over(s)),
        }
    });
    let panels = [
        Panel {
            across: ("Position along the shaft", "m"),
            up: ("Major axis over its largest", "-"),
            curves: along.collect(),
            inside: vec![(0.0, 0.0)],
            height: 330.0,
            ..Panel::default()
        },
        Panel {
            across: ("z over the largest", "-"),
            up: ("y over the largest", "-"),
            marks: marks.collect(),
            curves: across.collect(),
            equal: true,
            height: 420.0,
            ..Panel::default()
        },
    ];
    let remarks = "Orbits where the shaft moves most, seen along +x; the dot is the place at angle zero of the rotation.";
    figure(&Surroundings::new(report, "Deflected shaft", remarks.to_owned()), &panels, 1)
}
