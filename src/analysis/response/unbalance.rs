//! `rotor unbalance`: steady vibration in step with the rotation, by masses beside the axis.
//!
//! A mass m at the radius e and the angle alpha exerts `m e Omega^2 (cos(Omega t + alpha), sin(Omega t + alpha))`, the force
//! `m e Omega^2 exp(i alpha) (1, -i)` in complex amplitudes. Source: docs/theory/response.md#unbalance.

use crate::accuracy::locking_and_rounding::{refuse_dependent, refuse_tiny_bore};
use crate::analysis::campbell::remarks::describe_model;
use crate::analysis::campbell::synchronous::critical_speeds;
use crate::analysis::margins;
use crate::analysis::response::frame;
use crate::analysis::response::readings::Readings;
use crate::analysis::response::vibration::{Place, Vibration};
use crate::analysis::{Counter, Outcome, model_remarks, operating_range, summary, table_remarks};
use crate::error::{Refusal, Result};
use crate::model::{Form, Gyroscopic, Model, OperatingSpeed, Station, Unbalance, UnbalanceSettings};
use crate::results::{DeflectedShape, Margin, Modelled, Peak, UnbalanceMass, UnbalanceResponse, Verdict};
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::place_rows;
use faer::c64;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Relative distances from a critical speed at which the response is looked at for a peak.
const AROUND: [f64; 9] = [0.0, 1e-5, 1e-4, 1e-3, 3e-3, 0.01, 0.02, 0.04, 0.08];
/// Relative difference of two speeds that is none.
const SAME_SPEED: f64 = 2e-6;
/// Circularity from which a motion is a forward one.
const LEAST_CIRCULARITY: f64 = 0.01;
/// Share of the largest amplitude of a station below which a maximum is none.
const LEAST_PEAK: f64 = 1e-9;
/// Speeds over the whole range at which the few vectors are held against the basis.
const SPREAD: usize = 48;
/// Peaks at which the reduced response is checked.
const CHECKED_PEAKS: usize = 6;

/// A peak with what the standard says of it.
type JudgedPeak = (Peak, Option<Verdict>);

/// Solves for the response over speed, its peaks and what bearings carry.
///
/// # Errors
/// No speeds, no unbalance, a rotor without a frame of constant coefficients, or equations that can't be solved.
pub fn unbalance(
    model: &Model,
    settings: &UnbalanceSettings,
    progress: Counter<'_>,
) -> Result<Outcome<UnbalanceResponse>> {
    let highest = highest_speed(settings)?;
    let frame = frame(model, "unbalance")?;
    refuse_dependent(model)?;
    if settings.form == Form::Consistent {
        refuse_tiny_bore(model)?;
    }
    let assembly = Assembly::new(model);
    let mut diagnostics = model_remarks(model, &assembly);
    table_remarks(model, &settings.speeds, &mut diagnostics);
    let rows: Vec<_> = settings.masses.iter().flat_map(|m| across(&assembly, m)).collect();
    let mut vibration = Vibration::new(&assembly, (settings.form, frame), highest, &rows)?;
    let criticals = undamped(&vibration, highest)?;
    let measured_error = settle(&mut vibration, settings, &criticals, highest)?;
    let vibration = vibration;
    // clearances are stations that are not told
    let mut stations = settings.stations.clone();
    stations.extend(model.clearances.iter().map(|c| Station { name: c.name.clone(), x: c.x, angle: None }));
    let readings = Readings::new(&vibration, &stations);
    let response = |speed: f64| vibration.solve(speed, speed, &shares(&settings.masses, speed));
    let solve_all = |speeds: &[f64], told: bool| -> Result<Vec<Vec<c64>>> {
        let one = |speed: &f64| {
            let found =
                if *speed > 0.0 { response(*speed) } else { Ok(vec![c64::new(0.0, 0.0); vibration.size()]) };
            progress(usize::from(told));
            found
        };
        speeds.par_iter().map(one).collect()
    };
    let all = solve_all(&settings.speeds, true)?;

    let fine_speeds = looks(settings, &criticals);
    let fine = solve_all(&fine_speeds, false)?;
    let factor = settings.amplitude.factor();
    let operating = model.operating_speed.map(|o| [o.minimum, o.maximum]);
    let (mut peaks, mut curves, mut margins) = (Vec::new(), Vec::new(), Vec::new());
    for (i, station) in settings.stations.iter().enumerate() {
        let told = |q: &[c64]| readings.told(i, q) * factor;
        let here: Vec<c64> = fine.iter().map(|q| told(q)).collect();
        let at = |speed: f64| response(speed).map_or(c64::new(0.0, 0.0), |q| told(&q));
        let (found, curve) = peaks_of(station, operating, &fine_speeds, &here, &at);
        for (peak, verdict) in found {
            margins.extend(verdict.map(|verdict| Margin { subject: station.name.clone(), verdict }));
            peaks.push(peak);
        }
        curves.push(curve);
    }
    peaks.sort_by(|a, b| a.speed_rad_s.total_cmp(&b.speed_rad_s).then(a.at.total_cmp(&b.at)));
    margins.extend(operating_margins(model, settings, (&vibration, &readings), &fine_speeds, &fine)?);
    let stability_threshold_rad_s = vibration.threshold(highest, &mut diagnostics)?;

    let mut summary =
        summary(model, assembly.size(), crate::analysis::mass_properties::properties(model).mass());
    describe_model(model, (Gyroscopic::All, settings.form, true), &vibration.operators, &mut summary);
    summary.modelled.push(Modelled::UnbalanceMasses(settings.masses.len()));
    let at: Vec<(f64, f64)> = settings.speeds.iter().map(|s| (*s, *s)).collect();
    let results = UnbalanceResponse {
        form: settings.form.name(),
        amplitude: settings.amplitude.name(),
        masses: masses(settings),
        operating_speed: operating_range(model),
        stations: readings.stations(settings.stations.len(), &all, &[], factor, true),
        shapes: shapes(settings, &peaks, &readings, &response)?,
        peaks,
        margins,
        bearing_forces_n: readings.forces(&all, &at).into_iter().collect(),
        stability_threshold_rad_s,
        measured_error,
        fine: curves,
        speeds_rad_s: settings.speeds.clone(),
    };
    Ok(Outcome { results, model: summary, diagnostics })
}

/// The last of the speeds asked for; refuses settings without speeds or masses.
fn highest_speed(settings: &UnbalanceSettings) -> Result<f64> {
    let Some(&highest) = settings.speeds.last() else {
        return Err(Refusal::at(
            "unbalance.speeds",
            "the unbalance has no speeds",
            r#"for example "speeds": { "from": 0, "to": "12000 rpm", "count": 601 }"#,
        )
        .into());
    };
    if settings.masses.is_empty() {
        return Err(Refusal::at(
            "unbalance.masses",
            "nothing is out of balance",
            "masses with their moments, a grade, or disks with an offset",
        )
        .into());
    }
    Ok(highest)
}

/// Peaks of a station among the responses `here` at some speeds, `at` any speed, with what is asked of them; and its curve, speed,
/// amplitude and phase.
fn peaks_of(
    station: &Station,
    operating: Option<[f64; 2]>,
    speeds: &[f64],
    here: &[c64],
    at: &dyn Fn(f64) -> c64,
) -> (Vec<JudgedPeak>, Vec<[f64; 3]>) {
    let mut curve: Vec<[f64; 3]> = speeds.iter().zip(here).map(|(s, z)| [*s, z.norm(), z.arg()]).collect();
    let largest = here.iter().fold(0.0, |m: f64, z| m.max(z.norm()));
    let found = margins::peaks(&|speed| at(speed).norm(), speeds);
    let mut peaks = Vec::new();
    for peak in found.into_iter().filter(|p| p.amplitude > LEAST_PEAK * largest) {
        let phase_rad = at(peak.speed_rad_s).arg();
        curve.push([peak.speed_rad_s, peak.amplitude, phase_rad]);
        let verdict = operating.map(|range| margins::separation(&peak, range));
        let told = Peak {
            station: station.name.clone(),
            at: station.x,
            speed_rad_s: peak.speed_rad_s,
            speed_rpm: peak.speed_rad_s * 30.0 / PI,
            amplitude_m: peak.amplitude,
            phase_rad,
            half_power_rad_s: [peak.lower_speed_rad_s, peak.upper_speed_rad_s],
            amplification_factor: peak.amplification_factor,
            separation_margin_percent: verdict.as_ref().and_then(|v| v.value),
            required_percent: verdict.as_ref().and_then(|v| v.limit),
            pass: verdict.as_ref().map(|v| v.pass),
        };
        peaks.push((told, verdict));
    }
    curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    (peaks, curve)
}

fn masses(settings: &UnbalanceSettings) -> Vec<UnbalanceMass> {
    let one = |m: &Unbalance| UnbalanceMass {
        at: m.x,
        moment_kg_m: m.moment,
        angle_rad: m.angle,
        path: m.path.clone(),
    };
    settings.masses.iter().map(one).collect()
}

/// Displacement along y and z of the section where a mass is.
fn across(assembly: &Assembly<'_>, mass: &Unbalance) -> [Vec<(usize, f64)>; 2] {
    let [_, y, z, ..] = place_rows(assembly.model, &assembly.numbering, mass.x);
    [y, z]
}

/// Complex amplitudes of the forces along y and z of every mass.
pub fn shares(masses: &[Unbalance], speed: f64) -> Vec<c64> {
    let force = |m: &Unbalance| c64::from_polar(m.moment * speed * speed, m.angle);
    masses.iter().flat_map(|m| [force(m), force(m) * c64::new(0.0, -1.0)]).collect()
}

/// Critical speeds without damping: where peaks may be.
fn undamped(vibration: &Vibration<'_>, highest: f64) -> Result<Vec<f64>> {
    let found = critical_speeds(&vibration.operators, &vibration.spectrum, highest)?;
    Ok(found.list.into_iter().map(|c| c.speed).collect())
}

/// Checks the basis at the highest speed and beside critical speeds, and chooses few vectors for all speeds; returns the difference
/// to the unreduced response.
fn settle(
    vibration: &mut Vibration<'_>,
    settings: &UnbalanceSettings,
    criticals: &[f64],
    highest: f64,
) -> Result<f64> {
    let place = |s: f64| -> Place { (s, s, shares(&settings.masses, s)) };
    // where an undamped response still has a bound
    let beside = criticals.iter().take(CHECKED_PEAKS).map(|s| 0.99 * s);
    let checked: Vec<Place> = std::iter::once(highest).chain(beside).map(place).collect();
    let error = vibration.check(&checked)?;
    let lowest = settings.speeds.iter().copied().find(|s| *s > 0.0).unwrap_or(highest);
    let spread = (0..SPREAD).map(|k| lowest + (highest - lowest) * k as f64 / (SPREAD - 1) as f64);
    let near =
        criticals.iter().filter(|s| **s > lowest).flat_map(|s| [0.97 * s, 0.997 * s, 1.003 * s, 1.03 * s]);
    let mut speeds: Vec<f64> = spread.chain(near).filter(|s| *s <= highest).collect();
    speeds.sort_by(f64::total_cmp);
    vibration.condense(&speeds.into_iter().map(place).collect::<Vec<_>>())?;
    Ok(error)
}

/// The speeds asked for and those around critical speeds.
fn looks(settings: &UnbalanceSettings, criticals: &[f64]) -> Vec<f64> {
    let (first, last) = (settings.speeds[0], settings.speeds[settings.speeds.len() - 1]);
    let mut list = settings.speeds.clone();
    for critical in criticals {
        list.extend(AROUND.iter().flat_map(|d| [critical * (1.0 - d), critical * (1.0 + d)]));
    }
    list.retain(|s| *s > 0.0 && (first..=last).contains(s));
    list.sort_by(f64::total_cmp);
    // between neighbours that are one by rounding there is no peak
    list.dedup_by(|b, a| *b - *a <= SAME_SPEED * *b);
    list
}

/// Everything that the standards ask of a machine with operating speeds, beside the margins of its peaks.
fn operating_margins(
    model: &Model,
    settings: &UnbalanceSettings,
    (vibration, readings): (&Vibration<'_>, &Readings<'_>),
    speeds: &[f64],
    all: &[Vec<c64>],
) -> Result<Vec<Margin>> {
    let Some(operating) = model.operating_speed else { return Ok(Vec::new()) };
    let stations = settings.stations.len() + model.clearances.len();
    let orbits = |i: usize| all.iter().map(|q| readings.orbit(i, q).major()).collect();
    let majors: Vec<Vec<f64>> = (0..stations).map(orbits).collect();
    let mut list = limits(model, settings, operating, speeds, &majors);
    list.extend(level_one(vibration, operating)?);
    Ok(list)
}

/// Vibration limit and scaled clearances, and the unbalance, against the rules of the standards: amplitudes are whole major axes.
fn limits(
    model: &Model,
    settings: &UnbalanceSettings,
    operating: OperatingSpeed,
    speeds: &[f64],
    majors: &[Vec<f64>],
) -> Vec<Margin> {
    const MICROMETRES: f64 = 1e6;
    let trip = operating.trip.unwrap_or(operating.maximum);
    let largest = |i: usize, from: f64, to: f64| {
        let within = speeds.iter().zip(&majors[i]).filter(|(s, _)| (from..=to).contains(*s));
        within.fold(0.0, |m: f64, (_, v)| m.max(2.0 * v * MICROMETRES))
    };
    let mut list = Vec::new();
    if !speeds.iter().any(|s| (operating.minimum..=trip).contains(s)) {
        return list;
    }
    let mut most = 0.0_f64;
    for (i, station) in settings.stations.iter().enumerate() {
        let amplitude = largest(i, operating.minimum, trip);
        most = most.max(amplitude);
        let verdict = margins::vibration(amplitude, operating.maximum);
        list.push(Margin { subject: station.name.clone(), verdict });
    }
    let scale = margins::scale_factor(margins::amplitude_limit_um(operating.maximum), most);
    for (k, clearance) in model.clearances.iter().enumerate() {
        let amplitude = largest(settings.stations.len() + k, 0.0, trip);
        let verdict = margins::clearance(amplitude, scale, 2.0 * clearance.gap * MICROMETRES);
        list.push(Margin { subject: clearance.name.clone(), verdict });
    }
    let moments: f64 = settings.masses.iter().map(|m| m.moment).sum();
    let mass = crate::analysis::mass_properties::properties(model).mass();
    let verdict = margins::residual_unbalance(moments * 1e6, mass, operating.maximum);
    list.push(Margin { subject: "all masses, whole rotor".to_owned(), verdict });
    list
}

/// Log decrement of the first forward motion at the highest speed of operation.
fn level_one(vibration: &Vibration<'_>, operating: OperatingSpeed) -> Result<Option<Margin>> {
    let solution = vibration.reduced.solve(operating.maximum)?;
    let mut moving = solution.motions[..solution.oscillating].iter();
    let forward = moving.find(|m| vibration.reduced.travel_of(m) > LEAST_CIRCULARITY);
    Ok(forward.map(|m| {
        let verdict = margins::stability(-TAU * m.lambda.re / m.lambda.im);
        let subject = format!("forward motion at {:.2} Hz", m.lambda.im / TAU);
        Margin { subject, verdict }
    }))
}

/// The deflected shaft at the speeds asked for and at the peaks of any station.
fn shapes(
    settings: &UnbalanceSettings,
    peaks: &[Peak],
    readings: &Readings<'_>,
    response: &dyn Fn(f64) -> Result<Vec<c64>>,
) -> Result<Vec<DeflectedShape>> {
    let mut speeds: Vec<(f64, bool)> = settings.shapes.iter().map(|s| (*s, false)).collect();
    // stations share a peak within a thousandth
    for peak in peaks {
        if !speeds.iter().any(|(s, at_peak)| *at_peak && (s / peak.speed_rad_s - 1.0).abs() < 1e-3) {
            speeds.push((peak.speed_rad_s, true));
        }
    }
    let one = |(speed, at_peak): (f64, bool)| -> Result<DeflectedShape> {
        let orbits = readings.shape(&response(speed)?);
        let parts = |v: c64| [v.re, v.im];
        Ok(DeflectedShape {
            speed_rad_s: speed,
            at_peak,
            x_m: orbits.iter().map(|o| o.0).collect(),
            major_m: orbits.iter().map(|o| o.1.major()).collect(),
            minor_m: orbits.iter().map(|o| o.1.minor()).collect(),
            y_m: orbits.iter().map(|o| parts(o.1.y)).collect(),
            z_m: orbits.iter().map(|o| parts(o.1.z)).collect(),
        })
    };
    speeds.into_iter().map(one).collect()
}
