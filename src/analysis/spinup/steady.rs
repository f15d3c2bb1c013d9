//! Steady states: an equilibrium in the turning frame, or a periodic motion of what is fixed in space; and their stability.

use crate::accuracy::coarse_bending::bending_remark;
use crate::analysis::campbell::campbell;
use crate::analysis::equilibrium::{Balance, Equilibrium};
use crate::analysis::section_forces::ForceReader;
use crate::analysis::spinup::orbit;
use crate::analysis::spinup::orbit::Orbit;
use crate::analysis::spinup::recorder::{RunRecorder, sections_at};
use crate::analysis::spinup::remarks::clear_remark;
use crate::analysis::spinup::{EQUILIBRIUM_NEWTON, spin_state};
use crate::analysis::statics::{newton_summary, pinned_remark, strain_remark};
use crate::analysis::stations::growth_along;
use crate::analysis::{Outcome, nonlinear_summary};
use crate::error::{Error, Result};
use crate::integrate::{Flows, Moment};
use crate::model::{CampbellSettings, Form, Frame, Gyroscopic, Model, SpinupSettings, WhirlFrame};
use crate::results::{Diagnostic, LeftOut, Modelled, OrbitSummary, Spinup};
use crate::shaft::assembly::Assembly;
use crate::shaft::drive::Drive;
use crate::shaft::loads::Which;
use crate::shaft::motion::Dynamics;
use std::f64::consts::PI;

/// Times over one turn of a periodic motion.
const ANGLES_OF_A_TURN: usize = 360;
/// Branches and basis of the linear equations that tell whether a steady state is stable.
const STABILITY_MODES: usize = 12;
const STABILITY_BASIS: usize = 60;

/// The steady state at a speed: an equilibrium in the turning frame where all that acts is constant there, else a periodic
/// motion.
pub(super) fn steady(
    assembly: &Assembly<'_>,
    settings: &SpinupSettings,
    speed: f64,
    mut diagnostics: Vec<Diagnostic>,
) -> Result<Outcome<Spinup>> {
    let model = assembly.model;
    let mut summary = nonlinear_summary(model, assembly.size());
    let results = if speed == 0.0 || orbit::is_constant_in_turning_frame(model) {
        let which = if speed == 0.0 { Which::All } else { Which::ConstantInTurningFrame };
        let balance = Balance::new(assembly, which, speed)?;
        let state = balance.solve(EQUILIBRIUM_NEWTON, None)?;
        if state.load_factor < 1.0 {
            return Err(no_steady_state(speed, &state));
        }
        pinned_remark(&balance, &mut diagnostics);
        summary.modelled.push(Modelled::CentrifugalLoad);
        let q = balance.coordinates(&state.z);
        let (reader, acting) = (ForceReader::new(assembly), balance.acting(&state.z, 1.0));
        bending_remark(assembly, &q, &mut diagnostics);
        Spinup {
            complete: true,
            last: spin_state(assembly, &q, None, speed),
            growth: growth_along(assembly, &q),
            support_forces: Some(reader.supports(&acting)),
            sections: reader.sections(&acting),
            extremes: None,
            history: None,
            energy: None,
            rub: None,
            integrator: None,
            newton: Some(newton_summary(&state)),
            orbit: None,
        }
    } else {
        // what is constant in the turning frame is a good start, where bearings let it stand
        let balance = Balance::new(assembly, Which::ConstantInTurningFrame, speed)?;
        let start = balance.solve(EQUILIBRIUM_NEWTON, None).ok().filter(|state| state.load_factor == 1.0);
        let orbit = orbit::periodic(assembly, speed, start.map(|state| state.z))?;
        let (harmonics, truncation) = (orbit.harmonics, orbit.truncation);
        summary.modelled.push(Modelled::PeriodicMotion { harmonics, truncation });
        one_turn(assembly, settings, speed, &orbit)?
    };
    clear_remark(&results.last, &mut diagnostics);
    strain_remark(results.last.largest_strain, &mut diagnostics);
    if assembly.has_material_damping() || model.bearings.iter().any(|b| b.damps()) {
        summary.modelled.push(Modelled::DampingOfMotion);
    }
    summary.left_out.push(LeftOut::Time { periodic: results.orbit.is_some() });
    stability(model, speed, &mut summary, &mut diagnostics);
    Ok(Outcome { results, model: summary, diagnostics })
}

/// A periodic motion over one turn of the shaft.
pub(super) fn one_turn(
    assembly: &Assembly<'_>,
    settings: &SpinupSettings,
    speed: f64,
    orbit: &Orbit,
) -> Result<Spinup> {
    let period = 2.0 * PI / speed.abs();
    let mut dynamics = Dynamics::new(assembly, Drive::constant(speed), Frame::Rotating)?;
    let moment = |t: f64| {
        let [z, mut v, mut a] = orbit.at(speed * t);
        v.iter_mut().for_each(|v| *v *= speed);
        a.iter_mut().for_each(|a| *a *= speed * speed);
        Moment { t, z, v, a }
    };
    let turn = SpinupSettings { until: period, output: ANGLES_OF_A_TURN + 1, ..settings.clone() };
    let begin = moment(0.0);
    let mut recorder = RunRecorder::new(assembly, &turn, &mut dynamics, &begin)?;
    let (mut flows, mut before) = (Flows::default(), Flows::of(&dynamics, 0.0));
    let mut end = begin;
    for k in 1..=ANGLES_OF_A_TURN {
        end = moment(period * k as f64 / ANGLES_OF_A_TURN as f64);
        dynamics.evaluate(end.t, &end.z, &end.v, &end.a);
        let power = Flows::of(&dynamics, end.t);
        let half = period / ANGLES_OF_A_TURN as f64 / 2.0;
        flows = flows.plus(half, before).plus(half, power);
        before = power;
        let torque = dynamics.powers.torque.abs();
        if torque > recorder.extremes.torque_n_m {
            (recorder.extremes.torque_n_m, recorder.extremes.torque_time_s) = (torque, end.t);
        }
        recorder.sample(&mut dynamics, end.t, &end.z, &end.v, &end.a, flows);
        let [_, y, z] = recorder.extreme(&dynamics, end.t, &end.z);
        recorder.draw(&dynamics, end.t, [y, z]);
    }
    recorder.last = (end.clone(), flows);
    let (mut results, _) = recorder.results(&mut dynamics, true);
    results.sections = sections_at(&mut dynamics, &end);
    let orbit = OrbitSummary {
        harmonics: orbit.harmonics,
        truncation: orbit.truncation,
        iterations: orbit.iterations,
    };
    Ok(Spinup { integrator: None, orbit: Some(orbit), ..results })
}

/// Tells a motion that grows about the steady state, where something may feed one: by its root.
pub(super) fn stability(
    model: &Model,
    speed: f64,
    summary: &mut crate::results::ModelSummary,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let round = model.sections.iter().all(crate::section::Section::is_axisymmetric);
    let feeds = model.materials.iter().any(|m| m.stiffness_damping != 0.0)
        || model.bearings.iter().any(|b| b.couples());
    if speed == 0.0 || (round && !feeds) {
        return;
    }
    // seen from the other end, a shaft that turns backward turns forward
    let mut mirrored = model.clone();
    if speed < 0.0 {
        for bearing in &mut mirrored.bearings {
            for law in [&mut bearing.stiffness, &mut bearing.damping] {
                (law[0][1], law[1][0]) = (-law[0][1], -law[1][0]);
            }
        }
    }
    let settings = CampbellSettings {
        speeds: vec![speed.abs()],
        modes: STABILITY_MODES,
        frame: if round { WhirlFrame::Stationary } else { WhirlFrame::Rotating },
        form: Form::Consistent,
        reduction: Some(STABILITY_BASIS),
        gyroscopic: Gyroscopic::All,
        orders: Vec::new(),
    };
    match campbell(&mirrored, &settings, &|_| ()) {
        Ok(outcome) => {
            let worst = outcome
                .results
                .unstable_ranges
                .into_iter()
                .max_by(|a, b| a.largest_growth_rate_1_s.total_cmp(&b.largest_growth_rate_1_s));
            if let Some(range) = worst {
                diagnostics.push(Diagnostic::error(
                    "unstable-motion",
                    format!(
                        "the steady state is unstable: a motion about it ({}) grows with {:.6e} 1/s (linear equations); it is \
                         not reached in practice. More damping by bearings, less by the material, or a lower speed",
                        range.branch, range.largest_growth_rate_1_s
                    ),
                ));
            } else {
                summary.modelled.push(Modelled::StableSmallMotions);
            }
        }
        Err(error) => {
            let reason = error.to_string();
            let first = reason.lines().next().unwrap_or_default();
            summary.left_out.push(LeftOut::Stability(first.to_owned()));
        }
    }
}

pub(super) fn no_steady_state(speed: f64, state: &Equilibrium) -> Error {
    Error::analysis(
        format!(
            "no steady state was found at {speed:.6} rad/s ({:.1} rpm), though the balanced shaft holds there",
            speed * 30.0 / PI
        ),
        format!(
            "{} load steps, {} cuts, {} Newton iterations; {:.4} of the load was carried",
            state.steps, state.cuts, state.iterations, state.load_factor
        ),
        "more damping, less unbalance, a speed off the critical ones (`rotor campbell`), or the transient: leave out \
         `spinup.steady`",
    )
}
