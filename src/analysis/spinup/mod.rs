//! `rotor spinup`: run up to speed along the drive, and the equilibrium at a speed.
//!
//! The transient starts from static equilibrium under gravity and dead loads. Before it runs, the equilibrium of
//! the balanced rotor at the highest speed is checked: beyond burst there is none.

pub mod orbit;
pub mod rub_recorder;

use crate::accuracy::coarse_bending::bending_remark;
use crate::accuracy::locking_and_rounding::{refuse_dependent, refuse_tiny_bore, slow_remark};
use crate::accuracy::pressure_stress::pressure_remarks;
use crate::accuracy::radial_growth::{basis_error, closed_form};
use crate::analysis::Watch;
use crate::analysis::campbell::campbell;
use crate::analysis::equilibrium::{Balance, Equilibrium, NewtonSettings};
use crate::analysis::probes::{
    Centre, displacement, element_at, growth_in, largest_strain, probe_states, profile,
};
use crate::analysis::section_forces::{ForceReader, probe_section};
use crate::analysis::spinup::orbit::Orbit;
use crate::analysis::spinup::rub_recorder::RubRecorder;
use crate::analysis::statics::{hub_remark, newton_summary, pinned_remark, strain_remark};
use crate::analysis::stations::{Station, growth_along, headline, section_growth};
use crate::analysis::{Outcome, model_remarks, nonlinear_summary, quadrature_name};
use crate::error::{Error, Refusal, Result};
use crate::integrate::implicit::Scheme;
use crate::integrate::{self, Flows, Method, Moment, Progress, Settings, Step};
use crate::linalg::factor::Ldlt;
use crate::linalg::sparse::{combine, symmetric_part};
use crate::model::{
    CampbellSettings, Form, Frame, Gyroscopic, Integrator, Law, Model, Reading, SpinupSettings, Traction,
    WhirlFrame,
};
use crate::results::{
    Diagnostic, EnergyBalance, Extremes, History, IntegratorSummary, LeftOut, ModelSummary, Modelled,
    OrbitSummary, SectionForces, SpinState, Spinup,
};
use crate::section::Surface;
use crate::section::basis::SectionBasis;
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::drives;
use crate::shaft::drive::Drive;
use crate::shaft::loads::Which;
use crate::shaft::motion::{Dynamics, State};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Newton's method for equilibria.
const NEWTON: NewtonSettings = NewtonSettings { load_steps: 1, max_iterations: 40, tolerance: 1e-20 };
/// Halvings that locate the speed of lost equilibrium.
const BISECTIONS: usize = 20;
/// Points of the orbit in every step.
const ORBIT_POINTS: usize = 6;
/// Most turn of the drive between points of the orbit, rad.
const ORBIT_TURN: f64 = 0.1;
/// Most points of the orbit in a run.
const ORBIT: f64 = 20_000.0;
/// Longest time among the outputs of a step without asking whether to go on.
const PAUSE: Duration = Duration::from_millis(100);
/// First step over the shortest phase.
const FIRST_STEP: f64 = 1e-3;
/// Error of the growth of a hollow section that calls for a warning.
const POOR_GROWTH: f64 = 1e-3;

/// Times over one turn of a periodic motion.
const TURN: usize = 360;
/// Branches and basis of the linear equations that tell whether a steady state is stable.
const STABILITY_MODES: usize = 12;
const STABILITY_BASIS: usize = 60;

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
    fits(model, settings)?;
    let model = &model.with_drive(settings);
    let drive = Drive::of(settings);
    let fastest = settings.largest_speed();
    let mut diagnostics = Vec::new();
    refuse_dependent(model)?;
    refuse_tiny_bore(model)?;
    growth_remarks(model, &mut diagnostics);
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
    let start = rest.solve(NEWTON, None)?;
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
    let mut recorder = Recorder::new(&assembly, settings, &mut dynamics, &begin)?;
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
    recorder: &mut Recorder<'_>,
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
    let integration = Settings {
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

/// The steady state at a speed: an equilibrium in the turning frame where all that acts is constant there, else a periodic
/// motion.
fn steady(
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
        let state = balance.solve(NEWTON, None)?;
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
        let start = balance.solve(NEWTON, None).ok().filter(|state| state.load_factor == 1.0);
        let orbit = orbit::periodic(assembly, speed, start.map(|state| state.z))?;
        let (harmonics, truncation) = (orbit.harmonics, orbit.truncation);
        summary.modelled.push(Modelled::PeriodicMotion { harmonics, truncation });
        one_turn(assembly, settings, speed, &orbit)?
    };
    clear_remark(&results.last, &mut diagnostics);
    strain_remark(results.last.largest_strain, &mut diagnostics);
    if assembly.has_material_damping() || model.bearings.iter().any(|b| b.damping != [[0.0; 2]; 2]) {
        summary.modelled.push(Modelled::DampingOfMotion);
    }
    summary.left_out.push(LeftOut::Time { periodic: results.orbit.is_some() });
    stability(model, speed, &mut summary, &mut diagnostics);
    Ok(Outcome { results, model: summary, diagnostics })
}

/// A periodic motion over one turn of the shaft.
fn one_turn(assembly: &Assembly<'_>, settings: &SpinupSettings, speed: f64, orbit: &Orbit) -> Result<Spinup> {
    let period = 2.0 * PI / speed.abs();
    let mut dynamics = Dynamics::new(assembly, Drive::constant(speed), Frame::Rotating)?;
    let moment = |t: f64| {
        let [z, mut v, mut a] = orbit.at(speed * t);
        v.iter_mut().for_each(|v| *v *= speed);
        a.iter_mut().for_each(|a| *a *= speed * speed);
        Moment { t, z, v, a }
    };
    let turn = SpinupSettings { until: period, output: TURN + 1, ..settings.clone() };
    let begin = moment(0.0);
    let mut recorder = Recorder::new(assembly, &turn, &mut dynamics, &begin)?;
    let (mut flows, mut before) = (Flows::default(), Flows::of(&dynamics, 0.0));
    let mut end = begin;
    for k in 1..=TURN {
        end = moment(period * k as f64 / TURN as f64);
        dynamics.evaluate(end.t, &end.z, &end.v, &end.a);
        let power = Flows::of(&dynamics, end.t);
        let half = period / TURN as f64 / 2.0;
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

/// What passes through the sections at a moment.
fn sections_at(dynamics: &mut Dynamics<'_>, moment: &Moment) -> SectionForces {
    dynamics.evaluate(moment.t, &moment.z, &moment.v, &moment.a);
    ForceReader::new(dynamics.assembly).sections(&dynamics.acting())
}

/// Tells a motion that grows about the steady state, where something may feed one: by its root.
fn stability(
    model: &Model,
    speed: f64,
    summary: &mut crate::results::ModelSummary,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let round = model.sections.iter().all(crate::section::Section::is_axisymmetric);
    let feeds = model.materials.iter().any(|m| m.stiffness_damping != 0.0)
        || model.bearings.iter().any(|b| b.stiffness[0][1] != b.stiffness[1][0]);
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

fn no_steady_state(speed: f64, state: &Equilibrium) -> Error {
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

/// Equilibrium of the balanced, unloaded rotor: its offsets bend the shaft, which is not burst.
fn balanced_equilibrium(model: &Model, speed: f64) -> Result<(Equilibrium, bool)> {
    let mut balanced = model.clone();
    balanced.disks.iter_mut().for_each(|d| d.offset = [0.0; 2]);
    let assembly = Assembly::new(&balanced);
    let balance = Balance::new(&assembly, Which::None, speed)?;
    let state = balance.solve(NEWTON, None)?;
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
    let Station { x, section, material, clearance: _ } = headline(model);
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

/// Warns where no section is clear enough of hubs and joints to speak for the shaft's growth.
fn clear_remark(state: &SpinState, diagnostics: &mut Vec<Diagnostic>) {
    if !state.growth_is_clear {
        diagnostics.push(Diagnostic::warning(
            "growth-disturbed",
            format!(
                "no section stands two radii and two elements clear of ends, disks, supports and joints: the growth at {} m is \
                 changed by them; results.growth has it along the whole shaft; shorter elements leave more of the shaft clear",
                state.growth_at_m
            ),
        ));
    }
}

/// Warns of hollow sections whose growth a polynomial misses, with the error of the same linear problem.
fn growth_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    let mut seen: Vec<(usize, SectionBasis)> = Vec::new();
    for e in &model.elements {
        let key = (e.section, e.kind.basis);
        if seen.contains(&key) || e.kind.law != Law::Continuum {
            continue;
        }
        seen.push(key);
        let (section, material) = (&model.sections[e.section], &model.materials[e.material]);
        let error = |basis| basis_error(section, material, basis, section.outer[0]);
        let Some(now) = error(e.kind.basis).filter(|e| e.abs() > POOR_GROWTH) else { continue };
        let ring = SectionBasis::Ring { degree: 3, harmonics: 3 };
        let better = error(ring).filter(|_| section.is_ring());
        let better =
            better.map_or(String::new(), |b| format!("; 34R33 would miss it by {:+.1e} %", 100.0 * b));
        diagnostics.push(Diagnostic::warning(
            "hollow-growth",
            format!(
                "{} misses the radial growth of the {} {}/{} by {:+.1} % (a polynomial has no 1/r term){better}",
                e.kind.name(),
                if section.is_hollow() { "tube" } else { "circle" },
                section.outer[0],
                section.inner[0],
                100.0 * now
            ),
        ));
    }
}

fn summary(model: &Model, assembly: &Assembly<'_>, dynamics: &Dynamics<'_>) -> ModelSummary {
    let mut summary = nonlinear_summary(model, assembly.size());
    summary.modelled.push(Modelled::TurningInertia);
    let offset = model.disks.iter().any(|d| d.offset != [0.0; 2]);
    let external = model.materials.iter().any(|m| m.mass_damping != 0.0);
    for (present, modelled, left_out) in [
        (model.has_gravity(), Modelled::Gravity, LeftOut::Gravity),
        (model.has_loads(), Modelled::Loads, LeftOut::LoadsOfRunUp),
        (offset, Modelled::Unbalance, LeftOut::Unbalance),
        (dynamics.is_viscous(), Modelled::MaterialDamping, LeftOut::MaterialDamping),
        (external, Modelled::ExternalDamping, LeftOut::ExternalDamping),
        (dynamics.counts.tangents > 0, Modelled::DeformedTangents, LeftOut::DeformedTangents),
    ] {
        if present {
            summary.modelled.push(modelled);
        } else {
            summary.left_out.push(left_out);
        }
    }
    summary
}

/// Collects the history of a run.
struct Recorder<'a> {
    assembly: &'a Assembly<'a>,
    times: Vec<f64>,
    next: usize,
    history: History,
    extremes: Extremes,
    start: State,
    last: (Moment, Flows),
    centre: Centre,
    /// Where growth is read.
    station: Station,
    /// Time of the last point of the orbit, the shortest time to the next, and the point in the turning frame.
    drawn: (f64, f64, [f64; 2]),
    supports: Vec<(String, usize)>,
    reader: ForceReader<'a>,
    /// Path and place of every ring.
    rings: Vec<(String, f64)>,
    frame: Frame,
    /// Only with stators.
    rub: Option<RubRecorder>,
    /// When it was last asked whether to go on.
    asked: Instant,
}

impl<'a> Recorder<'a> {
    fn new(
        assembly: &'a Assembly<'a>,
        settings: &SpinupSettings,
        dynamics: &mut Dynamics<'_>,
        begin: &Moment,
    ) -> Result<Self> {
        let last = settings.output - 1;
        let times = (0..=last).map(|k| settings.until * k as f64 / last as f64).collect();
        let start = dynamics.state(0.0, &begin.z, &begin.v);
        let zero = Extremes { radius_m: 0.0, radius_time_s: 0.0, torque_n_m: 0.0, torque_time_s: 0.0 };
        let middle = assembly.model.length / 2.0;
        let here = assembly.model.sections[element_at(assembly.model, middle).section];
        let supports = assembly.model.supports.iter().map(|s| (s.path.clone(), s.node)).collect();
        let contacts = dynamics.contacts(0.0, &begin.z, &begin.v);
        let rub = || RubRecorder::new(&settings.stators, settings.until, &contacts);
        let mut recorder = Self {
            assembly,
            rub: (!settings.stators.is_empty()).then(rub).transpose()?,
            times,
            next: 0,
            history: History::default(),
            extremes: zero,
            start,
            last: (begin.clone(), Flows::default()),
            centre: Centre::new(assembly, middle, &here),
            station: headline(assembly.model),
            drawn: (0.0, settings.until / ORBIT, [0.0; 2]),
            supports,
            reader: ForceReader::new(assembly),
            rings: settings.stators.iter().map(|s| (s.path.clone(), s.at)).collect(),
            frame: settings.frame,
            asked: Instant::now(),
        };
        recorder.sample(dynamics, 0.0, &begin.z, &begin.v, &begin.a, Flows::default());
        recorder.next = 1;
        let [_, y, z] = recorder.extreme(dynamics, 0.0, &begin.z);
        recorder.drawn.2 = [y, z];
        Ok(recorder)
    }

    /// Takes up a step; false when the run is stopped among its many outputs, at the last of which the record ends.
    fn record(&mut self, dynamics: &mut Dynamics<'_>, step: &Step<'_>, watch: Watch<'_>) -> bool {
        let n = step.end.z.len();
        let (mut z, mut v, mut a) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        while self.next < self.times.len() && self.times[self.next] <= step.end.t * (1.0 + 1e-12) {
            let t = self.times[self.next].min(step.end.t);
            step.interpolate(t, &mut z, &mut v, &mut a);
            self.sample(dynamics, t, &z, &v, &a, step.flows_at(t));
            self.next += 1;
            if self.asked.elapsed() > PAUSE {
                self.asked = Instant::now();
                let until = self.times.last().copied().unwrap_or(t);
                if !watch(t / until, &format!("t = {t:.4} s, output {} of {}", self.next, self.times.len())) {
                    self.last = (Moment { t, z, v, a }, step.flows_at(t));
                    return false;
                }
            }
        }
        for k in 1..=ORBIT_POINTS {
            let t = step.start.t + (step.end.t - step.start.t) * k as f64 / ORBIT_POINTS as f64;
            if t - self.drawn.0 < self.drawn.1 {
                continue;
            }
            step.interpolate(t, &mut z, &mut v, &mut a);
            let [_, y, z] = self.extreme(dynamics, t, &z);
            self.draw(dynamics, t, [y, z]);
        }
        if let Some(rub) = &mut self.rub {
            rub.record(dynamics, step);
        }
        if step.torque[1].abs() > self.extremes.torque_n_m {
            (self.extremes.torque_n_m, self.extremes.torque_time_s) = (step.torque[1].abs(), step.end.t);
        }
        self.last.0.clone_from(step.end);
        self.last.1 = step.flows[1];
        true
    }

    /// Draws the orbit on to a point of the turning frame: straight there, so that a long step of a steady whirl is an
    /// arc in space.
    fn draw(&mut self, dynamics: &Dynamics<'_>, t: f64, to: [f64; 2]) {
        let (before, shortest, from) = self.drawn;
        let turned = dynamics.drive.at(t).angle - dynamics.drive.at(before).angle;
        let parts = (turned / ORBIT_TURN).ceil().min((t - before) / shortest).max(1.0) as usize;
        for k in 1..=parts {
            let share = k as f64 / parts as f64;
            let [y, z] = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
            let (sin, cos) = dynamics.drive.at(before + share * (t - before)).angle.sin_cos();
            self.history.orbit_m.push([cos * y - sin * z, sin * y + cos * z]);
        }
        self.drawn = (t, shortest, to);
    }

    /// Keeps the largest distance of the axis from its place.
    fn extreme(&mut self, dynamics: &Dynamics<'_>, t: f64, z: &[f64]) -> [f64; 3] {
        let centre = self.centre.displacement(&dynamics.coordinates(t, z));
        let radius = centre[1].hypot(centre[2]);
        if radius > self.extremes.radius_m {
            (self.extremes.radius_m, self.extremes.radius_time_s) = (radius, t);
        }
        centre
    }

    fn sample(&mut self, dynamics: &mut Dynamics<'_>, t: f64, z: &[f64], v: &[f64], a: &[f64], flows: Flows) {
        let model = self.assembly.model;
        let turn = dynamics.drive.at(t);
        let Station { x, section, material, .. } = self.station;
        let centre = self.extreme(dynamics, t, z);
        let q = dynamics.coordinates(t, z);
        let (sin, cos) = turn.angle.sin_cos();
        dynamics.evaluate(t, z, v, a);
        let torque = dynamics.powers.torque;
        let reactions = dynamics.reactions(t);
        self.sample_forces(dynamics);
        for (path, power) in dynamics.load_powers() {
            self.history.load_power_w.entry(path.to_owned()).or_default().push(power);
        }
        let state = dynamics.state(t, z, v);
        if let Some(rub) = &mut self.rub {
            rub.sample(t, &dynamics.present_contacts());
            self.history.energy_j.stators.push(state.stators);
        }
        let h = &mut self.history;
        h.time_s.push(t);
        h.speed_rad_s.push(turn.speed);
        for probe in &model.probes {
            let [y, z] = probe.points[probe.points.len() - 1];
            let u = displacement(self.assembly, &q, [probe.x, y, z]);
            h.probes.entry(probe.name.clone()).or_default().push(u);
            let e = element_at(model, probe.x);
            let grown = growth_in(self.assembly, &q, e, probe.x, model.sections[e.section].outer);
            h.probe_growth_m.entry(probe.name.clone()).or_default().push(grown);
        }
        let fixed = [centre[0], cos * centre[1] - sin * centre[2], sin * centre[1] + cos * centre[2]];
        h.mid_span_m.push(fixed);
        h.growth_m.push(section_growth(self.assembly, &q, x).rim_m);
        let exact = closed_form(&section, &model.materials[material], turn.speed, section.outer[0]);
        h.closed_form_growth_m.extend(exact);
        h.drive_torque_n_m.push(torque);
        h.angular_momentum_kg_m2_s.push(state.angular_momentum);
        for (path, node) in &self.supports {
            let force = reactions.iter().find(|(n, _)| n == node).map_or([0.0; 3], |(_, f)| *f);
            h.reactions_n.entry(path.clone()).or_default().push(force);
        }
        let change = energy(&state) - energy(&self.start);
        let absorbed = absorbed(&flows, &state, &self.start, dynamics.is_viscous());
        let e = &mut h.energy_j;
        e.kinetic.push(state.kinetic);
        e.strain.push(state.strain);
        e.potential.push(state.potential);
        e.drive_work.push(flows.drive);
        e.absorbed.push(absorbed.iter().sum());
        e.lost.push(flows.drive + flows.loads - change - absorbed.iter().sum::<f64>());
        if dynamics.has_loads_without_potential() {
            e.load_work.push(flows.loads);
        }
    }

    /// Forces at the last evaluation.
    fn sample_forces(&mut self, dynamics: &Dynamics<'_>) {
        let acting = dynamics.acting();
        let mut now = self.reader.supports(&acting);
        for ((path, at), force) in self.rings.iter().zip(dynamics.ring_forces()) {
            now.forces_n.insert(path.clone(), force);
            now.at_m.insert(path.clone(), *at);
        }
        let h = &mut self.history;
        for (all, now) in [
            (&mut h.support_forces.forces_n, now.forces_n),
            (&mut h.support_forces.moments_n_m, now.moments_n_m),
        ] {
            now.into_iter().for_each(|(path, v)| all.entry(path).or_default().push(v));
        }
        h.support_forces.at_m = now.at_m;
        for (probe, (torque, shear)) in self.assembly.model.probes.iter().zip(self.reader.at_probes(&acting))
        {
            h.probe_torque_n_m.entry(probe.name.clone()).or_default().push(torque);
            h.probe_shear_n.entry(probe.name.clone()).or_default().push(shear);
            let (.., x) = probe_section(self.assembly.model, probe);
            h.probe_section_x_m.insert(probe.name.clone(), x);
        }
    }

    fn finish(
        self,
        model: &Model,
        dynamics: &mut Dynamics<'_>,
        run: RunResult,
        mut diagnostics: Vec<Diagnostic>,
    ) -> Outcome<Spinup> {
        let mut summary = summary(model, self.assembly, dynamics);
        let t = self.last.0.t;
        let frame = self.frame;
        let integrator = model.spinup.as_ref().map(|s| s.integrator);
        let (counts, end) = (dynamics.counts, self.last.0.clone());
        let (assembly, q) = (self.assembly, dynamics.coordinates(t, &self.last.0.z));
        let (mut results, rub) = self.results(dynamics, run.complete);
        if let Some(rub) = rub {
            let (rub, stators) = rub.finish(dynamics, t, &mut summary);
            if let Some(history) = &mut results.history {
                history.stators = stators;
            }
            results.rub = Some(rub);
        }
        results.sections = sections_at(dynamics, &end);
        clear_remark(&results.last, &mut diagnostics);
        strain_remark(results.last.largest_strain, &mut diagnostics);
        bending_remark(assembly, &q, &mut diagnostics);
        if !run.complete {
            diagnostics.push(Diagnostic::error(
                "interrupted",
                format!("the run was interrupted at t = {t:.6} s; the report ends there"),
            ));
        }
        if let Some(error) = results.energy.as_ref().map(|e| e.relative_error).filter(|e| e.abs() > 1e-3) {
            diagnostics.push(Diagnostic::warning(
                "energy-error",
                format!(
                    "the integrator lost {error:.2e} of the energy: tighten rtol and atol, or take shorter steps",
                ),
            ));
        }
        results.integrator = Some(IntegratorSummary {
            name: match integrator {
                Some(Integrator::GeneralizedAlpha) => "generalized-alpha",
                Some(Integrator::Adams) => "adams",
                _ => "esdirk4(3)",
            },
            frame: if frame == Frame::Rotating { "rotating" } else { "inertial" },
            quadrature: quadrature_name(model),
            steps: run.progress.steps,
            rejected: run.progress.rejected,
            force_evaluations: counts.force_evaluations,
            factorizations: counts.factorizations,
            tangents: counts.tangents,
        });
        Outcome { results, model: summary, diagnostics }
    }

    /// What was recorded, without the integrator and the rub, whose record is handed on.
    fn results(self, dynamics: &mut Dynamics<'_>, complete: bool) -> (Spinup, Option<RubRecorder>) {
        let (Moment { t, z, v, .. }, flows) = self.last;
        let state = dynamics.state(t, &z, &v);
        let q = dynamics.coordinates(t, &z);
        let change = energy(&state) - energy(&self.start);
        let [material, external, bearings, friction] =
            absorbed(&flows, &state, &self.start, dynamics.is_viscous());
        let lost = flows.drive + flows.loads - change - material - external - bearings - friction;
        let e = &self.history.energy_j;
        let works = [&state.kinetic, &state.strain, &flows.drive, &flows.loads];
        let scale = e
            .kinetic
            .iter()
            .chain(&e.strain)
            .chain(works)
            .fold(f64::MIN_POSITIVE, |m: f64, e| m.max(e.abs()));
        let results = Spinup {
            complete,
            last: spin_state(self.assembly, &q, Some(t), dynamics.drive.at(t).speed),
            growth: growth_along(self.assembly, &q),
            support_forces: None,
            sections: SectionForces::default(),
            extremes: Some(self.extremes),
            energy: Some(EnergyBalance {
                drive_work_j: flows.drive,
                load_work_j: dynamics.has_loads_without_potential().then_some(flows.loads),
                change_j: change,
                material_damping_j: material,
                external_damping_j: external,
                bearings_j: bearings,
                friction_j: self.rub.is_some().then_some(friction),
                numerical_dissipation_j: lost,
                relative_error: lost / scale,
            }),
            history: Some(self.history),
            rub: None,
            integrator: None,
            newton: None,
            orbit: None,
        };
        (results, self.rub)
    }
}

fn energy(state: &State) -> f64 {
    state.kinetic + state.strain + state.potential + state.stators
}

/// Absorbed by material damping, external damping, bearings and friction at stators. The internal forces' work is strain energy and
/// material damping together.
fn absorbed(flows: &Flows, state: &State, start: &State, viscous: bool) -> [f64; 4] {
    let material = if viscous { flows.internal - (state.strain - start.strain) } else { 0.0 };
    [material, flows.external, flows.bearings, flows.friction]
}
