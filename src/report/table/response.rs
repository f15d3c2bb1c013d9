//! Tables of steady vibration.

use crate::report::table::{columns, short};
use crate::results::{CriticalMap, HarmonicResponse, StationResponse, UnbalanceResponse};
use std::f64::consts::PI;

/// Peaks, amplitudes at the ends of the sweep, and the largest bearing forces.
pub fn unbalance(results: &UnbalanceResponse) -> String {
    let mut text = format!("  stationary frame, {} form; amplitudes {}\n\n", results.form, results.amplitude);
    text += "  peaks\n";
    if results.peaks.is_empty() {
        text += "  none within the sweep\n";
    } else {
        let rows: Vec<Vec<String>> = results
            .peaks
            .iter()
            .map(|p| {
                vec![
                    format!("{:.2}", p.speed_rpm),
                    format!("{:.5e}", p.amplitude_m),
                    format!("{:.1}", p.phase_rad * 180.0 / PI),
                    p.amplification_factor.map_or("-".to_owned(), |f| format!("{f:.2}")),
                    short(p.at),
                    p.station.clone(),
                ]
            })
            .collect();
        text += &columns(&["rpm", "amplitude (m)", "phase (deg)", "AF", "at (m)", "station"], &rows);
    }
    if !results.margins.is_empty() {
        text += "\n  margins (operating speed)\n";
        let rows: Vec<Vec<String>> = results
            .margins
            .iter()
            .map(|m| {
                let pass = if m.verdict.pass { "pass" } else { "FAIL" };
                vec![
                    pass.to_owned(),
                    m.verdict.rule.to_owned(),
                    format!("{}: {}", m.subject, m.verdict.reason),
                ]
            })
            .collect();
        text += &columns(&["", "rule", "why"], &rows);
        let mut editions: Vec<String> = Vec::new();
        for m in &results.margins {
            let line = format!("  {}: {} ({})\n", m.verdict.rule, m.verdict.formula, m.verdict.edition);
            if !editions.contains(&line) {
                editions.push(line);
            }
        }
        text += &editions.concat();
    }
    let last = results.speeds_rad_s.last().copied().unwrap_or(0.0);
    text += &format!("\n  response at {:.2} rpm\n", last * 30.0 / PI);
    text += &stations(&results.stations);
    let rows: Vec<Vec<String>> = results
        .bearing_forces_n
        .iter()
        .map(|(path, f)| {
            let largest = f.major_n.iter().copied().fold(0.0, f64::max);
            let at = f.major_n.iter().position(|v| *v == largest).unwrap_or(0);
            let speed = results.speeds_rad_s.get(at).copied().unwrap_or(0.0);
            vec![
                format!("{largest:.5e}"),
                format!("{:.1}", speed * 30.0 / PI),
                format!("{:.5e}", f.major_n.last().copied().unwrap_or(0.0)),
                path.clone(),
            ]
        })
        .collect();
    if !rows.is_empty() {
        text += "\n  bearing forces, zero to peak\n";
        text += &columns(&["largest (N)", "at rpm", "at last speed (N)", "bearing"], &rows);
    }
    text
}

/// The response of every station at its largest.
pub fn harmonic(results: &HarmonicResponse) -> String {
    let mut text = format!(
        "  {} form; amplitudes {}; rotor at {:.2} rpm\n\n",
        results.form,
        results.amplitude,
        results.spin_speed_rad_s * 30.0 / PI
    );
    let rows: Vec<Vec<String>> = results
        .stations
        .iter()
        .map(|s| {
            let largest = s.amplitude_m.iter().copied().fold(0.0, f64::max);
            let at = s.amplitude_m.iter().position(|v| *v == largest).unwrap_or(0);
            let frequency = results.frequencies_rad_s.get(at).copied().unwrap_or(0.0);
            vec![
                format!("{largest:.5e}"),
                format!("{:.4}", frequency / (2.0 * PI)),
                format!("{:.1}", s.phase_rad.get(at).copied().unwrap_or(0.0) * 180.0 / PI),
                short(s.at),
                s.name.clone(),
            ]
        })
        .collect();
    text += &columns(&["largest (m)", "at Hz", "phase (deg)", "at (m)", "station"], &rows);
    text
}

/// The curves at the ends of the stiffnesses, and where bearings meet them.
pub fn map(results: &CriticalMap) -> String {
    let rpm = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{:.2}", v * 30.0 / PI));
    let rows: Vec<Vec<String>> = results
        .curves
        .iter()
        .map(|c| {
            let ends = [c.critical_rad_s.first(), c.critical_rad_s.last()].map(|v| rpm(v.copied().flatten()));
            let [first, last] = ends;
            vec![c.n.to_string(), first, last, rpm(c.rigid_rad_s), c.whirl.name().to_owned()]
        })
        .collect();
    let ends = [results.stiffness_n_m.first(), results.stiffness_n_m.last()];
    let [first, last] = ends.map(|k| k.copied().unwrap_or(0.0));
    let mut text =
        format!("  critical speeds on supports of {first:.3e} and {last:.3e} N/m, and on rigid ones\n");
    text += &columns(&["no.", "rpm, softest", "rpm, stiffest", "rpm, rigid", "whirl"], &rows);
    if !results.intersections.is_empty() {
        let rows: Vec<Vec<String>> = results
            .intersections
            .iter()
            .map(|i| {
                vec![
                    format!("{:.2}", i.speed_rad_s * 30.0 / PI),
                    format!("{:.4e}", i.stiffness_n_m),
                    i.n.to_string(),
                    i.whirl.name().to_owned(),
                    format!("{} {}", i.bearing, i.direction),
                ]
            })
            .collect();
        text += "\n  where the bearings meet them\n";
        text += &columns(&["rpm", "N/m", "no.", "whirl", "bearing"], &rows);
    }
    if let Some(q) = &results.cross_coupling {
        text += &match q.threshold_n_m {
            Some(k) => {
                format!("\n  cross-coupling at {} m: a motion grows from {k:.5e} N/m on\n", short(q.at))
            }
            None => format!("\n  cross-coupling at {} m: no motion grows\n", short(q.at)),
        };
    }
    text
}

fn stations(list: &[StationResponse]) -> String {
    let last = |v: &[f64]| v.last().copied().unwrap_or(0.0);
    let rows: Vec<Vec<String>> = list
        .iter()
        .map(|s| {
            vec![
                format!("{:.5e}", last(&s.amplitude_m)),
                format!("{:.1}", last(&s.phase_rad) * 180.0 / PI),
                format!("{:.5e}", last(&s.major_axis_m)),
                format!("{:.5e}", last(&s.minor_axis_m)),
                s.whirl.last().map_or("-", |w| w.name()).to_owned(),
                short(s.at),
                s.name.clone(),
            ]
        })
        .collect();
    columns(&["amplitude (m)", "phase (deg)", "major (m)", "minor (m)", "whirl", "at (m)", "station"], &rows)
}
