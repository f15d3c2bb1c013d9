//! Collects the history of a run-up.

use crate::accuracy::coarse_bending::bending_remark;
use crate::accuracy::radial_growth::closed_form;
use crate::analysis::Watch;
use crate::analysis::probes::{Centre, displacement, element_at, growth_in};
use crate::analysis::section_forces::{ForceReader, probe_section};
use crate::analysis::spinup::remarks::{clear_remark, summary};
use crate::analysis::spinup::rub_recorder::RubRecorder;
use crate::analysis::spinup::{RunResult, spin_state};
use crate::analysis::statics::strain_remark;
use crate::analysis::stations::{GrowthStation, growth_along, headline, section_growth};
use crate::analysis::{Outcome, quadrature_name};
use crate::error::Result;
use crate::integrate::{Flows, Moment, Step};
use crate::model::{Frame, Integrator, Model, SpinupSettings};
use crate::results::{
    Diagnostic, EnergyBalance, Extremes, History, IntegratorSummary, SectionForces, Spinup,
};
use crate::shaft::assembly::Assembly;
use crate::shaft::motion::{Dynamics, MotionState};
use std::time::{Duration, Instant};

/// Points of the orbit in every step.
const ORBIT_POINTS: usize = 6;
/// Most turn of the drive between points of the orbit, rad.
const ORBIT_TURN: f64 = 0.1;
/// Most points of the orbit in a run.
const ORBIT: f64 = 20_000.0;
/// Longest time among the outputs of a step without asking whether to go on.
const PAUSE: Duration = Duration::from_millis(100);

/// Collects the history of a run.
pub(super) struct RunRecorder<'a> {
    assembly: &'a Assembly<'a>,
    times: Vec<f64>,
    next: usize,
    history: History,
    pub(super) extremes: Extremes,
    start: MotionState,
    pub(super) last: (Moment, Flows),
    centre: Centre,
    /// Where growth is read.
    station: GrowthStation,
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

impl<'a> RunRecorder<'a> {
    pub(super) fn new(
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
        let here = assembly.model.section_in(element_at(assembly.model, middle), middle);
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
    pub(super) fn record(&mut self, dynamics: &mut Dynamics<'_>, step: &Step<'_>, watch: Watch<'_>) -> bool {
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
    pub(super) fn draw(&mut self, dynamics: &Dynamics<'_>, t: f64, to: [f64; 2]) {
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
    pub(super) fn extreme(&mut self, dynamics: &Dynamics<'_>, t: f64, z: &[f64]) -> [f64; 3] {
        let centre = self.centre.displacement(&dynamics.coordinates(t, z));
        let radius = centre[1].hypot(centre[2]);
        if radius > self.extremes.radius_m {
            (self.extremes.radius_m, self.extremes.radius_time_s) = (radius, t);
        }
        centre
    }

    pub(super) fn sample(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        t: f64,
        z: &[f64],
        v: &[f64],
        a: &[f64],
        flows: Flows,
    ) {
        let model = self.assembly.model;
        let turn = dynamics.drive.at(t);
        let GrowthStation { x, section, material, .. } = self.station;
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
            let grown = growth_in(self.assembly, &q, e, probe.x, model.section_in(e, probe.x).outer);
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

    pub(super) fn finish(
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
    pub(super) fn results(
        self,
        dynamics: &mut Dynamics<'_>,
        complete: bool,
    ) -> (Spinup, Option<RubRecorder>) {
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

pub(super) fn energy(state: &MotionState) -> f64 {
    state.kinetic + state.strain + state.potential + state.stators
}

/// Absorbed by material damping, external damping, bearings and friction at stators. The internal forces' work is strain energy and
/// material damping together.
pub(super) fn absorbed(flows: &Flows, state: &MotionState, start: &MotionState, viscous: bool) -> [f64; 4] {
    let material = if viscous { flows.internal - (state.strain - start.strain) } else { 0.0 };
    [material, flows.external, flows.bearings, flows.friction]
}

/// What passes through the sections at a moment.
pub(super) fn sections_at(dynamics: &mut Dynamics<'_>, moment: &Moment) -> SectionForces {
    dynamics.evaluate(moment.t, &moment.z, &moment.v, &moment.a);
    ForceReader::new(dynamics.assembly).sections(&dynamics.acting())
}
