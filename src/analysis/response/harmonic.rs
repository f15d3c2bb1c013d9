//! `rotor harmonic`: steady vibration by forces, moments or a motion of the ground at a frequency of its own.
//!
//! With the ground moving by `d exp(i w t)` the displacement relative to it, `u - R d` with R the translations of the whole
//! shaft along y and z, sees the inertia forces `w^2 M R d`; what is told is absolute. Source: docs/theory/response.md#harmonic.

use crate::accuracy::locking_and_rounding::{refuse_dependent, refuse_tiny_bore};
use crate::analysis::campbell::remarks::describe_model;
use crate::analysis::response::frame;
use crate::analysis::response::readings::Readings;
use crate::analysis::response::vibration::{Place, Vibration};
use crate::analysis::{Counter, Outcome, model_remarks, summary, table_remarks};
use crate::error::Result;
use crate::model::{Excitation, Form, Gyroscopic, HarmonicSettings, Model};
use crate::results::{Diagnostic, HarmonicResponse, Modelled};
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::place_rows;
use faer::c64;
use rayon::prelude::*;

/// Frequencies over the whole range at which the few vectors are held against the basis.
const SPREAD: usize = 96;
/// Number of frequencies up to which the basis itself is used.
const FEW: usize = 2 * SPREAD;

/// Solves for the response over frequency.
///
/// # Errors
/// A rotor without a frame of constant coefficients, or equations that can't be solved.
pub fn harmonic(
    model: &Model,
    settings: &HarmonicSettings,
    progress: Counter<'_>,
) -> Result<Outcome<HarmonicResponse>> {
    let frame = frame(model, "harmonic")?;
    refuse_dependent(model)?;
    let speed = settings.spin_speed;
    if settings.form == Form::Consistent && speed > 0.0 {
        refuse_tiny_bore(model)?;
    }
    let assembly = Assembly::new(model);
    let mut diagnostics = model_remarks(model, &assembly);
    table_remarks(model, &[speed], &mut diagnostics);
    let rows = settings.excitations.iter().flat_map(|(e, _)| rows(&assembly, e)).collect::<Vec<_>>();
    let mut vibration = Vibration::new(&assembly, (settings.form, frame), speed, &rows)?;
    let shares = |w: f64| -> Vec<c64> {
        settings.excitations.iter().flat_map(|(e, phase)| amplitudes(e, w, *phase)).collect()
    };
    let measured_error = settle(&mut vibration, settings, &shares)?;
    let vibration = vibration;
    let readings = Readings::new(&vibration, &settings.stations);
    let one = |w: &f64| {
        let found = vibration.solve(speed, *w, &shares(*w));
        progress(1);
        found
    };
    let all: Vec<Vec<c64>> = settings.frequencies.par_iter().map(one).collect::<Result<_>>()?;
    let ground: Vec<[c64; 2]> = settings.frequencies.iter().map(|w| ground(settings, *w)).collect();
    let stability_threshold_rad_s =
        if speed > 0.0 { vibration.threshold(speed, &mut diagnostics)? } else { None };
    if speed == 0.0 && vibration.operators.is_conservative() {
        diagnostics.push(Diagnostic::warning(
            "undamped-response",
            "nothing damps this rotor: at a natural frequency the response has no bound",
        ));
    }
    let mut summary =
        summary(model, assembly.size(), crate::analysis::mass_properties::properties(model).mass());
    describe_model(model, (Gyroscopic::All, settings.form, speed > 0.0), &vibration.operators, &mut summary);
    summary.modelled.push(Modelled::Excitations(settings.excitations.len()));
    let at: Vec<(f64, f64)> = settings.frequencies.iter().map(|w| (speed, *w)).collect();
    let results = HarmonicResponse {
        form: settings.form.name(),
        amplitude: settings.amplitude.name(),
        spin_speed_rad_s: speed,
        stations: readings.stations(
            settings.stations.len(),
            &all,
            &ground,
            settings.amplitude.factor(),
            false,
        ),
        bearing_forces_n: readings.forces(&all, &at).into_iter().collect(),
        stability_threshold_rad_s,
        measured_error,
        frequencies_rad_s: settings.frequencies.clone(),
    };
    Ok(Outcome { results, model: summary, diagnostics })
}

/// The unit forces that an excitation combines.
fn rows(assembly: &Assembly<'_>, excitation: &Excitation) -> Vec<Vec<(usize, f64)>> {
    let place = |x: f64| place_rows(assembly.model, &assembly.numbering, x);
    match excitation {
        Excitation::Force(_, x) => place(*x)[..3].to_vec(),
        Excitation::Moment(_, x) => place(*x)[3..].to_vec(),
        Excitation::BaseDisplacement(_) | Excitation::BaseAcceleration(_) => {
            [1, 2].map(|c| assembly.inertia_of_translation(c)).to_vec()
        }
    }
}

/// Complex amplitudes of these forces at a frequency.
fn amplitudes(excitation: &Excitation, w: f64, phase: f64) -> Vec<c64> {
    let turned = |v: f64| c64::from_polar(1.0, phase) * v;
    match excitation {
        Excitation::Force(list, _) | Excitation::Moment(list, _) => list.iter().map(|v| turned(*v)).collect(),
        Excitation::BaseDisplacement(list) => list.iter().map(|v| turned(*v * w * w)).collect(),
        // the acceleration of d exp(i w t) is -w^2 d
        Excitation::BaseAcceleration(list) => list.iter().map(|v| turned(-*v)).collect(),
    }
}

/// Displacement of the ground along y and z.
fn ground(settings: &HarmonicSettings, w: f64) -> [c64; 2] {
    let mut sum = [c64::new(0.0, 0.0); 2];
    for (excitation, phase) in &settings.excitations {
        let list = match excitation {
            Excitation::BaseDisplacement(d) => *d,
            Excitation::BaseAcceleration(a) if w > 0.0 => a.map(|a| -a / (w * w)),
            _ => continue,
        };
        (0..2).for_each(|k| sum[k] += c64::from_polar(1.0, *phase) * list[k]);
    }
    sum
}

/// Checks the basis over the frequencies, and chooses few vectors for all of them; returns the difference to the unreduced response.
fn settle(
    vibration: &mut Vibration<'_>,
    settings: &HarmonicSettings,
    shares: &(dyn Fn(f64) -> Vec<c64> + Sync),
) -> Result<f64> {
    let list: Vec<f64> = settings.frequencies.iter().copied().filter(|w| *w > 0.0).collect();
    if list.is_empty() {
        return Ok(0.0);
    }
    let place = |w: f64| -> Place { (settings.spin_speed, w, shares(w)) };
    let at = |k: usize, of: usize| place(list[k * (list.len() - 1) / of]);
    // the ends, the middle, and what lies between
    let error = vibration.check(&[8, 3, 5, 0, 4, 1, 7, 2, 6].map(|k| at(k, 8)))?;
    if list.len() > FEW {
        let spread = (0..SPREAD).map(|k| at(k, SPREAD - 1));
        vibration.condense(&spread.collect::<Vec<_>>())?;
    }
    Ok(error)
}
