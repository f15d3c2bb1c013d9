//! Plot of `rotor harmonic`: amplitude and phase over frequency.

use crate::draw::panels::{Curve, Panel, Surroundings, figure};
use crate::error::Result;
use crate::plot::response::{MOST_STATIONS, curve, phases, rpm, unit};
use crate::results::{Figures, HarmonicResponse, Report};
use std::f64::consts::TAU;

/// harmonic.svg.
///
/// # Errors
/// A failure of the drawing library.
pub fn svg(report: &Report<HarmonicResponse>) -> Result<Figures> {
    let results = &report.results;
    let stations = || results.stations.iter().take(MOST_STATIONS).enumerate();
    let hertz = |w: &f64| w / TAU;
    let largest = stations().flat_map(|(_, s)| &s.amplitude_m).fold(0.0, |m: f64, v| m.max(*v));
    let (unit, factor) = unit(largest);
    let frequencies = &results.frequencies_rad_s;
    let amplitude: Vec<Curve> = stations()
        .map(|(k, s)| {
            let points = frequencies.iter().zip(&s.amplitude_m).map(|(w, v)| (hertz(w), factor * v));
            curve(k, &s.name, points.collect())
        })
        .collect();
    let phase: Vec<Curve> = stations()
        .flat_map(|(k, s)| {
            let points: Vec<(f64, f64)> =
                frequencies.iter().zip(&s.phase_rad).map(|(w, v)| (hertz(w), *v)).collect();
            phases(k, "", points.into_iter())
        })
        .collect();
    let up = if results.amplitude == "peak-to-peak" {
        "Amplitude, peak to peak"
    } else {
        "Amplitude, zero to peak"
    };
    let across = ("Frequency", "Hz");
    let panels = [
        Panel { across, up: (up, unit), curves: amplitude, height: 330.0, ..Panel::default() },
        Panel { across, up: ("Phase (a lag is negative)", "deg"), curves: phase, ..Panel::default() },
    ];
    let remarks = format!("Rotor at {:.1} rpm; absolute displacements.", rpm(results.spin_speed_rad_s));
    let around = Surroundings::new(report, "Harmonic response", remarks);
    Ok(vec![("harmonic.svg".to_owned(), figure(&around, &panels, 1)?)])
}
