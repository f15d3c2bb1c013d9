//! Time integration of the equations of motion `M z'' = g(t, z, z')`: what integrators share, and the choice of one.

pub mod adams;
pub mod implicit;

use crate::error::{Error, Result};
use crate::model::Frame;
use crate::shaft::drive::quintic;
use crate::shaft::motion::{Dynamics, Powers};
use std::ops::ControlFlow;

/// Least share of the tolerance that a step keeps in the inertial frame, however little it turns.
const LEAST_TURN: f64 = 1e-3;
/// Steps after which the number still needed is estimated.
const STEPS_BEFORE_ESTIMATE: usize = 200;
/// Times that a step is cut at a ring before the ring acts from its start.
const CUTS: usize = 8;
/// Share of a step that is not worth a step of its own before or after a touch.
const SLIVER: f64 = 1e-3;

/// Which method integrates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// An implicit method, which solves for the end of each step.
    Implicit(implicit::Scheme),
    /// Adams PECE of variable order and step, explicit.
    Adams,
}

/// How to integrate: the method, its tolerances and steps, and where steps must end.
#[derive(Debug, Clone)]
pub struct IntegratorSettings {
    /// The method that integrates.
    pub method: Method,
    /// Tolerance of a step relative to the largest displacement.
    pub rtol: f64,
    /// Absolute tolerance of the error of a step in displacements, m.
    pub atol: f64,
    /// Fixed step, s; `None` for error control.
    pub step: Option<f64>,
    /// Length of the first step that is tried, s.
    pub first_step: f64,
    /// Number of steps after which the run is given up.
    pub max_steps: usize,
    /// Times that steps must end at, ascending; the last one ends the run.
    pub stops: Vec<f64>,
}

impl IntegratorSettings {
    /// Tolerance of a step from a state, m: relative to the displacement from where the drive carries the undeformed shaft.
    fn tolerance(&self, dynamics: &Dynamics<'_>, now: &Moment) -> f64 {
        self.atol + self.rtol * dynamics.largest_displacement(now.t, &now.z)
    }
}

impl IntegratorSettings {
    /// Tolerance of a step of length h. In the inertial frame the rotation itself is integrated, by many more steps than the
    /// vibration asks for: their errors add up, so each has its share per radian turned.
    fn step_tolerance(&self, dynamics: &Dynamics<'_>, now: &Moment, h: f64) -> f64 {
        let turned = dynamics.drive.at(now.t + h).angle - dynamics.drive.at(now.t).angle;
        let share = if dynamics.frame == Frame::Inertial { turned.abs().clamp(LEAST_TURN, 1.0) } else { 1.0 };
        self.tolerance(dynamics, now) * share
    }
}

/// Displacement, velocity and acceleration at a time.
#[derive(Debug, Clone, Default)]
pub struct Moment {
    /// Time since the start of the run, s.
    pub t: f64,
    /// Displacements of the free coordinates from the undeformed shaft, in the coordinates of the unknowns, m.
    pub z: Vec<f64>,
    /// Rates of these displacements, m/s.
    pub v: Vec<f64>,
    /// Second derivatives of these displacements by time, m/s^2.
    pub a: Vec<f64>,
}

/// Energies that flowed since the start, J; as powers, W.
#[derive(Debug, Clone, Copy, Default)]
pub struct Flows {
    /// Work of the drive.
    pub drive: f64,
    /// Work of the internal forces (strain energy plus material damping), with material damping only.
    pub internal: f64,
    /// Energy that external damping (`alpha M`) absorbed.
    pub external: f64,
    /// Energy that the dampers of the bearings absorbed.
    pub bearings: f64,
    /// Taken by friction at stators.
    pub friction: f64,
    /// Work of the loads that have no potential.
    pub loads: f64,
}

/// A step that was accepted, with what flowed in it.
pub struct Step<'a> {
    /// State at the start of the step.
    pub start: &'a Moment,
    /// State at the end of the step.
    pub end: &'a Moment,
    /// Energies that flowed from the start of the run to the start and to the end of the step, J.
    pub flows: [Flows; 2],
    /// Torque of the drive at start and end, N m.
    pub torque: [f64; 2],
    /// Power of the drive at start and end, W.
    pub power: [f64; 2],
}

/// Called after every accepted step; Break ends the run.
pub type OnStep<'a> = dyn FnMut(&mut Dynamics<'_>, &Step<'_>, Progress) -> Result<ControlFlow<()>> + 'a;

/// What the integration took.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// Number of accepted steps.
    pub steps: usize,
    /// Rejected steps (error, convergence, or a ring passed on the way).
    pub rejected: usize,
}

impl Moment {
    /// Displacements, velocities and accelerations.
    pub fn lists(&self) -> [&[f64]; 3] {
        [&self.z, &self.v, &self.a]
    }
}

impl Step<'_> {
    /// Displacements, velocities and accelerations within the step: the quintic that meets both ends.
    pub fn interpolate(&self, t: f64, z: &mut [f64], v: &mut [f64], a: &mut [f64]) {
        let (start, end) = (self.start, self.end);
        let h = end.t - start.t;
        let s = ((t - start.t) / h).clamp(0.0, 1.0);
        let [value, slope, curvature] = quintic(s);
        let scale = [1.0, h, h * h, 1.0, h, h * h];
        for i in 0..z.len() {
            let ends = [start.z[i], start.v[i], start.a[i], end.z[i], end.v[i], end.a[i]];
            let blend = |p: &[f64; 6]| (0..6).map(|k| p[k] * scale[k] * ends[k]).sum::<f64>();
            (z[i], v[i], a[i]) = (blend(&value), blend(&slope) / h, blend(&curvature) / (h * h));
        }
    }

    /// Flows up to a time within the step: linear between the ends, the drive's work with its power at both.
    pub fn flows_at(&self, t: f64) -> Flows {
        let h = self.end.t - self.start.t;
        let s = ((t - self.start.t) / h).clamp(0.0, 1.0);
        let [a, b] = &self.flows;
        let between = |x: f64, y: f64| x + s * (y - x);
        // cubic through work and power of the drive
        let rise = b.drive - a.drive;
        let (p, q) = (h * self.power[0] - rise, h * self.power[1] - rise);
        Flows {
            drive: between(a.drive, b.drive) + s * (1.0 - s) * ((1.0 - s) * p - s * q),
            internal: between(a.internal, b.internal),
            external: between(a.external, b.external),
            bearings: between(a.bearings, b.bearings),
            friction: between(a.friction, b.friction),
            loads: between(a.loads, b.loads),
        }
    }
}

impl Flows {
    /// Powers at the last evaluation.
    pub fn of(dynamics: &Dynamics<'_>, t: f64) -> Self {
        let p = &dynamics.powers;
        let drive = p.torque * dynamics.speed_at(t);
        let Powers { internal, external, bearings, friction, loads, .. } = *p;
        Self { drive, internal, external, bearings, friction, loads }
    }

    /// `self + factor * other`.
    pub fn plus(self, factor: f64, other: Self) -> Self {
        Self {
            drive: self.drive + factor * other.drive,
            internal: self.internal + factor * other.internal,
            external: self.external + factor * other.external,
            bearings: self.bearings + factor * other.bearings,
            friction: self.friction + factor * other.friction,
            loads: self.loads + factor * other.loads,
        }
    }
}

/// Integrates from `start` to the last stop.
///
/// # Errors
/// A step below rounding, a Newton iteration that does not converge at any step, more steps than allowed
/// (as soon as the estimate says so), or what `on_step` returns.
pub fn integrate(
    dynamics: &mut Dynamics<'_>,
    start: Moment,
    settings: &IntegratorSettings,
    on_step: &mut OnStep<'_>,
) -> Result<Progress> {
    match settings.method {
        Method::Implicit(scheme) => implicit::integrate(dynamics, start, scheme, settings, on_step),
        Method::Adams => adams::integrate(dynamics, start, settings, on_step),
    }
}

/// The way to the end of a run: where steps must stop, and how many are still allowed.
struct Course<'a> {
    settings: &'a IntegratorSettings,
    until: f64,
    /// Time that the last steps took, and their number.
    recent: (f64, usize),
    /// Time at which the step under way reaches a ring, and how often it was cut there.
    touch: (Option<f64>, usize),
}

impl<'a> Course<'a> {
    /// The way from a state.
    fn new(settings: &'a IntegratorSettings, dynamics: &mut Dynamics<'_>, start: &Moment) -> Self {
        let until = settings.stops.last().copied().unwrap_or(0.0);
        let mut course = Self { settings, until, recent: (0.0, 0), touch: (None, 0) };
        course.prepare(dynamics, start);
        course
    }

    /// The next time that a step must end at.
    fn stop_after(&self, t: f64) -> f64 {
        let next = self.settings.stops.iter().copied().find(|&s| s > t + 1e-12 * self.until);
        let next = next.unwrap_or(self.until);
        self.touch.0.map_or(next, |touch| touch.min(next))
    }

    /// Chooses the rings that act in a step from a state.
    fn prepare(&mut self, dynamics: &mut Dynamics<'_>, now: &Moment) {
        self.touch = (None, 0);
        let tolerance = self.settings.tolerance(dynamics, now);
        dynamics.rub_mut().prepare(&now.z, tolerance);
    }

    /// True when a step of length h stands. It does not when it passed a ring that did not act: then it is to be repeated
    /// up to the touch or, where it can't be shortened, with the ring acting from its start.
    fn stands(&mut self, dynamics: &mut Dynamics<'_>, now: &Moment, next: &Moment, h: f64) -> bool {
        let tolerance = self.settings.tolerance(dynamics, now);
        let rub = dynamics.rub_mut();
        let Some((ring, share)) = rub.reached(h, [now.lists(), next.lists()], tolerance) else { return true };
        let (_, cuts) = self.touch;
        let sliver = share.min(1.0 - share) < SLIVER;
        if self.settings.step.is_some() || cuts == CUTS || sliver {
            rub.rings[ring].acts = true;
        } else {
            self.touch = (Some(now.t + share * h), cuts + 1);
        }
        false
    }

    /// Refuses a step that time can't resolve.
    fn resolve(&self, step: f64, t: f64, progress: Progress) -> Result<()> {
        if step >= 1e-13 * self.until {
            return Ok(());
        }
        Err(failed(
            format!("the integrator's step fell to {step:.3e} s at t = {t:.6e} s"),
            format!("{} steps, {} rejected", progress.steps, progress.rejected),
        ))
    }

    /// Counts a step that ended at `t`; an error when the run would need too many of them.
    fn count(&mut self, step: f64, t: f64, steps: usize) -> Result<()> {
        let Self { settings, until, recent, .. } = self;
        *recent = if recent.1 >= STEPS_BEFORE_ESTIMATE { (step, 1) } else { (recent.0 + step, recent.1 + 1) };
        let spent = steps >= settings.max_steps;
        if !spent && (steps <= STEPS_BEFORE_ESTIMATE || recent.1 < STEPS_BEFORE_ESTIMATE / 2) {
            return Ok(());
        }
        let needed = steps as f64 + (*until - t) / (recent.0 / f64::from(recent.1 as u32));
        if needed <= 2.0 * settings.max_steps as f64 && !(spent && t < *until) {
            return Ok(());
        }
        Err(Error::analysis(
            format!(
                "the run would take about {needed:.1e} steps, more than spinup.max_steps = {}",
                settings.max_steps
            ),
            format!("{steps} steps to t = {t:.6e} s of {until:.6e} s"),
            "raise rtol and atol, use the rotating frame with an implicit integrator, or raise max_steps",
        ))
    }
}

fn failed(what: String, tried: String) -> Error {
    Error::analysis(
        what,
        tried,
        "check for a speed beyond burst or an unstable motion; a smaller fixed step or generalized-alpha may go on",
    )
}
