//! `rotor spinup`: run up to speed along the drive, and the equilibrium at a speed.
//!
//! The transient starts from static equilibrium under gravity and dead loads. Before it runs, the equilibrium of
//! the balanced rotor at the highest speed is checked: beyond burst there is none.

pub mod orbit;
mod recorder;
mod remarks;
pub mod rub_recorder;
mod steady;

use crate::accuracy::locking_and_rounding::{refuse_dependent, refuse_tiny_bore, slow_remark};
use crate::accuracy::pressure_stress::pressure_remarks;
use crate::accuracy::radial_growth::closed_form;
use crate::analysis::Watch;
use crate::analysis::equilibrium::{Balance, Equilibrium, NewtonSettings};
use crate::analysis::probes::{largest_strain, probe_states, profile};
use crate::analysis::statics::{hub_remark, pinned_remark};
use crate::analysis::stations::{GrowthStation, headline, section_growth};
use crate::analysis::steps::stress_remarks;
use crate::analysis::{Outcome, model_remarks, refuse_initial_stress};
use crate::error::{Error, Refusal, Result};
use crate::integrate::implicit::Scheme;
use crate::integrate::{self, IntegratorSettings, Method, Moment, Progress, Step};
use crate::linalg::factor::Ldlt;
use crate::linalg::sparse::{combine, symmetric_part};
use crate::model::{Frame, Integrator, Model, Reading, Resists, SpinupSettings, Traction};
use crate::results::{SpinState, Spinup};
use crate::section::Surface;
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::drives;
use crate::shaft::drive::Drive;
use crate::shaft::loads::Which;
use crate::shaft::motion::Dynamics;
use recorder::RunRecorder;
use remarks::growth_remarks;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use steady::steady;

/// Newton's method for equilibria.
const EQUILIBRIUM_NEWTON: NewtonSettings =
    NewtonSettings { load_steps: 1, max_iterations: 40, tolerance: 1e-20 };
/// Halvings that locate the speed of lost equilibrium.
const BISECTIONS: usize = 20;
/// First step over the shortest phase.
const FIRST_STEP: f64 = 1e-3;
/// Whether a run-up can be integrated with the settings.
///
/// In the inertial frame a driven section turns in its own coordinates; where components across the axis are free
/// there, as on a plane section, the mass matrix turns with it, and an explicit method would factorise it at each step.
///
/// Loads that hold on to points of the undeformed shaft mean nothing once it turns.
///
/// # Errors
/// Why not, and what would fit.
pub fn fits(model: &Model, settings: &SpinupSettings) -> std::result::Result<(), Refusal> {
    let dead = model.loads.iter().find(|load| load.reading == Reading::Dead).map(|load| &load.path);
    let dead = dead
        .or_else(|| model.tractions.iter().find(|load| load.reading == Reading::Dead).map(|load| &load.path));
    if let Some(path) = dead {
        return Err(Refusal::at(
            format!("{path}.dead"),
            "a dead moment or pressure holds on to the undeformed shaft and means nothing on a shaft that turns",
            "no \"dead\": a moment about axes fixed in space, a pressure on the surface as it is",
        ));
    }
    let half = |t: &&Traction| {
        t.reading == Reading::FixedInSpace && matches!(t.surface, Surface::Top | Surface::Bottom)
    };
    if let Some(traction) = model.tractions.iter().find(half) {
        return Err(Refusal::at(
            format!("{}.traction", traction.path),
            "half of the surface turns with the shaft: a traction fixed in space does not stay on it",
            "\"follower\": true for a traction that turns with the shaft, or a force in space, or the whole rim",
        ));
    }
    if model.materials.iter().any(|m| m.loss_factor > 0.0) {
        return Err(Refusal::at(
            "materials",
            "a loss factor belongs to one frequency, and a run-up has none",
            "\"damping\": { \"stiffness\": beta } with beta = eta / w at the frequency w that matters",
        ));
    }
    if let Some(bearing) = model.bearings.iter().find(|b| b.table.is_some()) {
        return Err(Refusal::at(
            bearing.path.clone(),
            "tables of bearings are not part of run-ups",
            "one stiffness and damping; campbell, unbalance and harmonic have tables",
        ));
    }
    if let Some(bearing) = model.bearings.iter().find(|b| !b.holds_shaft() || b.mass != [[0.0; 2]; 2]) {
        return Err(Refusal::at(
            bearing.path.clone(),
            "couplings, housings and the added mass of bearings are not part of run-ups",
            "a shaft in one piece on bearings without mass and housing; campbell, unbalance and harmonic have all of them",
        ));
    }
    if let Some(bearing) =
        model.bearings.iter().find(|b| matches!(b.resists, Resists::Tilt | Resists::Torsion))
    {
        return Err(Refusal::at(
            bearing.path.clone(),
            "springs against turning are not part of run-ups",
            "no tilt or torsional stiffness and damping; campbell, unbalance and harmonic have both",
        ));
    }
    if settings.steady || settings.integrator != Integrator::Adams || settings.frame != Frame::Inertial {
        return Ok(());
    }
    let model = &model.with_drive(settings);
    let assembly = Assembly::new(model);
    let across = |node: usize| {
        let range = assembly.numbering.of_node(node);
        let start = range.start;
        assembly.free_among(range).into_iter().any(|i| !(i - start).is_multiple_of(3))
    };
    if (0..model.nodes.len()).any(|node| drives(model, node) && across(node)) {
        return Err(Refusal::at(
            "spinup.integrator",
            "in the inertial frame a driven plane section turns the mass matrix, which the explicit method needs constant",
            "\"section\": \"rigid\" on the driven supports, \"frame\": \"rotating\", or an implicit integrator",
        ));
    }
    Ok(())
}

/// Runs the shaft up to speed.
///
/// # Errors
/// No equilibrium at the highest speed, an integration that fails, or a model that the frame or the integrator
/// can't treat.
pub fn spinup(model: &Model, settings: &SpinupSettings, watch: Watch<'_>) -> Result<Outcome<Spinup>> {
    refuse_initial_stress(model)?;
    fits(model, settings)?;
    let model = &model.with_drive(settings).with_unbalance();
    let drive = Drive::of(settings);
    let fastest = settings.largest_speed();
    let mut diagnostics = Vec::new();
    refuse_dependent(model)?;
    refuse_tiny_bore(model)?;
    growth_remarks(model, &mut diagnostics);
    stress_remarks(model, &mut diagnostics);
    pressure_remarks(model, &mut diagnostics);
    hub_remark(model, &mut diagnostics);
    slow_remark(model, fastest, &mut diagnostics);
    refuse_beyond_burst(model, fastest)?;
    let assembly = Assembly::new(model);
    diagnostics.extend(model_remarks(model, &assembly));
    if settings.steady {
        return steady(&assembly, settings, drive.last_speed(), diagnostics);
    }
    // at speed from the steady state of what is constant there
    let which = if settings.start_speed == 0.0 { Which::All } else { Which::ConstantInTurningFrame };
    let rest = Balance::new(&assembly, which, settings.start_speed)?;
    pinned_remark(&rest, &mut diagnostics);
    let start = rest.solve(EQUILIBRIUM_NEWTON, None)?;
    if start.load_factor < 1.0 {
        return Err(Error::analysis(
            "the shaft finds no static equilibrium under gravity and loads to start from",
            format!("{:.4} of the load was carried", start.load_factor),
            "run `rotor static` on the case",
        ));
    }
    let mut dynamics = Dynamics::new(&assembly, drive, settings.frame)?;
    dynamics.surround(&settings.stators, fastest);
    let n = dynamics.size();
    let mut begin = Moment { t: 0.0, z: start.z, v: vec![0.0; n], a: vec![0.0; n] };
    begin.z.resize(n, 0.0);
    if dynamics.drive.is_torque() {
        begin.v[n - 1] = settings.start_speed;
    }
    let (z, v) = (begin.z.clone(), begin.v.clone());
    dynamics.acceleration(0.0, &z, &v, &mut begin.a);
    dynamics.record(0.0, begin.lists());
    let mut recorder = RunRecorder::new(&assembly, settings, &mut dynamics, &begin)?;
    let result = run(&mut dynamics, begin, settings, &mut recorder, watch)?;
    Ok(recorder.finish(model, &mut dynamics, result, diagnostics))
}

/// What the integration took and whether it came to the end.
struct RunResult {
    progress: Progress,
    complete: bool,
}

fn run(
    dynamics: &mut Dynamics<'_>,
    begin: Moment,
    settings: &SpinupSettings,
    recorder: &mut RunRecorder<'_>,
    watch: Watch<'_>,
) -> Result<RunResult> {
    let until = settings.until;
    let mut stops: Vec<f64> = dynamics.drive.ends().filter(|t| *t < until * (1.0 - 1e-9)).collect();
    stops.push(until);
    let shortest = stops.iter().scan(0.0, |before, t| Some(t - std::mem::replace(before, *t)));
    let first_step = FIRST_STEP * shortest.fold(until, f64::min);
    let mut complete = true;
    let mut on_step = |dynamics: &mut Dynamics<'_>, step: &Step<'_>, progress: Progress| {
        if !recorder.record(dynamics, step, watch) {
            complete = false;
            return Ok(ControlFlow::Break(()));
        }
        let h = step.end.t - step.start.t;
        let line = format!("t = {:.4} s, step {h:.2e} s, {} steps", step.end.t, progress.steps);
        if watch(step.end.t / until, &line) {
            return Ok(ControlFlow::Continue(()));
        }
        complete = false;
        Ok(ControlFlow::Break(()))
    };
    let scale = dynamics.assembly.model.reference_length;
    let method = match settings.integrator {
        Integrator::Esdirk => Method::Implicit(Scheme::Esdirk),
        Integrator::GeneralizedAlpha => {
            Method::Implicit(Scheme::GeneralizedAlpha { rho_infinity: settings.rho_infinity })
        }
        Integrator::Adams => Method::Adams,
    };
    let integration = IntegratorSettings {
        method,
        rtol: settings.rtol,
        atol: settings.atol * scale,
        step: settings.step,
        first_step,
        max_steps: settings.max_steps,
        stops,
    };
    let progress = integrate::integrate(dynamics, begin, &integration, &mut on_step)?;
    Ok(RunResult { progress, complete })
}

/// Equilibrium of the balanced, unloaded rotor: its offsets bend the shaft, which is not burst.
fn balanced_equilibrium(model: &Model, speed: f64) -> Result<(Equilibrium, bool)> {
    let mut balanced = model.clone();
    balanced.disks.iter_mut().for_each(|d| d.offset = [0.0; 2]);
    let assembly = Assembly::new(&balanced);
    let balance = Balance::new(&assembly, Which::None, speed)?;
    let state = balance.solve(EQUILIBRIUM_NEWTON, None)?;
    // burst is a loss of stability within a circumferential harmonic, not at every critical speed
    let axisymmetric = model.sections.iter().all(crate::section::Section::is_axisymmetric);
    let stable = !axisymmetric || state.load_factor < 1.0 || {
        let (k, n) = (balance.tangent(&state.z), assembly.spin_softening());
        let names = assembly.rigid_motions().0;
        // motions that nothing resists count as stable, and those that only bearings do can't burst
        let motions = assembly.rigid_motions_on(&[]).1;
        let mut shifted = combine(&[(1.0, &symmetric_part(&k)), (-speed * speed, &n)]);
        crate::shaft::spectrum::pin(&mut shifted, &motions);
        let negative = Ldlt::new(&shifted)?.negative_pivots();
        negative.is_some_and(|count| count <= names.len())
    };
    Ok((state, stable))
}

fn refuse_beyond_burst(model: &Model, speed: f64) -> Result<()> {
    let holds = |speed: f64| -> Result<(bool, Equilibrium)> {
        let (state, stable) = balanced_equilibrium(model, speed)?;
        Ok((stable && state.load_factor == 1.0, state))
    };
    if speed == 0.0 {
        return Ok(());
    }
    let (fine, state) = holds(speed)?;
    if fine {
        return Ok(());
    }
    let (mut low, mut high) = (0.0, speed);
    for _ in 0..BISECTIONS {
        let middle = (low + high) / 2.0;
        if holds(middle)?.0 { low = middle } else { high = middle }
    }
    Err(no_equilibrium(low, speed, &state))
}

fn no_equilibrium(reached: f64, speed: f64, state: &Equilibrium) -> Error {
    let rpm = |speed: f64| speed * 30.0 / PI;
    Error::analysis(
        format!(
            "the shaft has no stable equilibrium at {speed:.6} rad/s ({:.1} rpm): it is lost at {reached:.6} rad/s ({:.1} rpm)",
            rpm(speed),
            rpm(reached)
        ),
        format!("{} load steps, {} cuts, {} Newton iterations", state.steps, state.cuts, state.iterations),
        "a lower speed, a stiffer shaft or supports; beyond this speed it bursts or collapses",
    )
}

/// The shaft at one speed from all coordinates in the turning frame.
fn spin_state(assembly: &Assembly<'_>, q: &[f64], time_s: Option<f64>, speed: f64) -> SpinState {
    let model = assembly.model;
    let GrowthStation { x, section, material, clearance: _ } = headline(model);
    let mut probes = probe_states(assembly, q);
    probes.iter_mut().for_each(|p| p.growth = Some(section_growth(assembly, q, p.at_m)));
    SpinState {
        time_s,
        speed_rad_s: speed,
        speed_rpm: speed * 30.0 / PI,
        probes,
        profile: profile(assembly, q, x, &section),
        growth_m: section_growth(assembly, q, x).rim_m,
        growth_at_m: x,
        growth_is_clear: headline(model).is_clear(),
        closed_form_growth_m: closed_form(&section, &model.materials[material], speed, section.outer[0]),
        largest_strain: largest_strain(assembly, q),
    }
}
