//! Implicit integrators of `M z'' = g(t, z, z')` in second-order form: every system solved is n x n.
//!
//! - ESDIRK4(3), the six-stage method `ARK4(3)6L[2]SA` of Kennedy and Carpenter (Appl. Numer. Math. 44, 2003): order 4,
//!   embedded order 3, L-stable, stiffly accurate; its own error estimate.
//! - Generalized-alpha of Chung and Hulbert (J. Appl. Mech. 60, 1993): order 2, numerical damping set by the
//!   spectral radius at infinity; error from the change of acceleration.
//!
//! Newton's method is modified: a factorised matrix serves until steps, speed or convergence ask for another.

mod anderson;
mod newton;

use crate::error::Result;
use crate::integrate::{Course, Flows, IntegratorSettings, Moment, OnStep, Progress, Step, failed};
use crate::shaft::motion::Dynamics;
use newton::{Newton, Stage};

const GAMMA: f64 = 0.25;
const STAGES: usize = 6;
const C: [f64; STAGES] = [0.0, 0.5, 83.0 / 250.0, 31.0 / 50.0, 17.0 / 20.0, 1.0];
const A: [[f64; 5]; STAGES] = [
    [0.0; 5],
    [0.25, 0.0, 0.0, 0.0, 0.0],
    [8611.0 / 62500.0, -1743.0 / 31250.0, 0.0, 0.0, 0.0],
    [5012029.0 / 34652500.0, -654441.0 / 2922500.0, 174375.0 / 388108.0, 0.0, 0.0],
    [
        15267082809.0 / 155376265600.0,
        -71443401.0 / 120774400.0,
        730878875.0 / 902184768.0,
        2285395.0 / 8070912.0,
        0.0,
    ],
    [82889.0 / 524892.0, 0.0, 15625.0 / 83664.0, 69875.0 / 102672.0, -2260.0 / 8211.0],
];
/// Weights of the step, which are the last stage's.
const B: [f64; STAGES] =
    [82889.0 / 524892.0, 0.0, 15625.0 / 83664.0, 69875.0 / 102672.0, -2260.0 / 8211.0, GAMMA];
/// Weights of the embedded method of order 3.
const EMBEDDED: [f64; STAGES] = [
    4586570599.0 / 29645900160.0,
    0.0,
    178811875.0 / 945068544.0,
    814220225.0 / 1159782912.0,
    -3700637.0 / 11593932.0,
    61727.0 / 225920.0,
];

/// Factor by which the bound on the step grows with every step after a failure set it.
const STEP_BOUND_GROWTH: f64 = 1.01;
/// Which of the implicit methods integrates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// ESDIRK4(3) of Kennedy and Carpenter: six stages, order four, an embedded method of order three for the
    /// error.
    Esdirk,
    /// Generalized-alpha with that spectral radius at infinite frequency.
    GeneralizedAlpha {
        /// 1 for no numerical damping, 0 for the most.
        rho_infinity: f64,
    },
}

/// The next step over one of that error, which is within the tolerance; `laborious`: it took many iterations.
fn next_over_last(error: f64, exponent: f64, laborious: bool) -> f64 {
    let factor = (0.9 * error.max(1e-10).powf(-exponent)).clamp(0.2, 3.0);
    // shorter steps are cheaper than many iterations, or than tangents
    let factor = factor.min(if laborious { 0.8 } else { 3.0 });
    // a step that is nearly right keeps its matrix
    if (0.9..1.3).contains(&factor) { 1.0 } else { factor }
}

/// Integrates from `start` to the last stop.
///
/// # Errors
/// As [`crate::integrate::integrate`].
pub fn integrate(
    dynamics: &mut Dynamics<'_>,
    start: Moment,
    scheme: Scheme,
    settings: &IntegratorSettings,
    on_step: &mut OnStep<'_>,
) -> Result<Progress> {
    let mut run = ImplicitRun::new(dynamics, start, scheme, settings);
    let mut course = Course::new(settings, dynamics, &run.now);
    let mut progress = Progress::default();
    let mut h = settings.step.unwrap_or(settings.first_step).min(course.until);
    let mut failures = 0;
    // steps at which Newton's method fails are not tried again for a while
    let mut longest = f64::INFINITY;
    while run.now.t < course.until {
        let stop = course.stop_after(run.now.t);
        // the last two steps before a stop share what is left
        let left = stop - run.now.t;
        // times of many fixed steps add up to within their rounding
        let last = h >= left * (1.0 - 1e-6);
        let taken = if last {
            left
        } else if settings.step.is_none() && 2.0 * h > left {
            left / 2.0
        } else {
            h
        };
        course.resolve(taken, run.now.t, progress)?;
        let error = run.step(dynamics, taken, settings)?;
        match error {
            Some(error) if error <= 1.0 || run.fixed => {
                if !course.stands(dynamics, &run.now, &run.next, taken) {
                    progress.rejected += 1;
                    continue;
                }
                failures = 0;
                progress.steps += 1;
                run.next.t = if last { stop } else { run.now.t + taken };
                let step = run.accept(dynamics, taken);
                if on_step(dynamics, &step, progress)?.is_break() {
                    return Ok(progress);
                }
                run.advance();
                if last && dynamics.drive.begin_phase(run.now.t) {
                    run.begin_phase(dynamics);
                }
                course.prepare(dynamics, &run.now);
                let laborious = run.newton.laborious();
                run.newton.accepted();
                if settings.step.is_none() {
                    let factor = next_over_last(error, run.exponent, laborious);
                    longest *= STEP_BOUND_GROWTH;
                    h = (if taken < h && factor >= 1.0 { h } else { taken * factor }).min(longest);
                }
                course.count(taken, run.now.t, progress.steps)?;
            }
            Some(error) => {
                progress.rejected += 1;
                h = taken * (0.9 * error.powf(-run.exponent)).clamp(0.1, 0.9);
            }
            None => {
                progress.rejected += 1;
                failures += 1;
                if failures > 12 || (settings.step.is_some() && failures > 1) {
                    return Err(failed(
                        format!("Newton's method does not converge at t = {:.6e} s", run.now.t),
                        format!("a step of {taken:.3e} s, with the tangent of the present state"),
                    ));
                }
                run.newton.rejected(failures, run.fixed);
                if settings.step.is_none() {
                    h = taken / 2.0;
                    longest = 0.7 * taken;
                }
            }
        }
    }
    Ok(progress)
}

/// An integration under way.
struct ImplicitRun {
    scheme: Scheme,
    now: Moment,
    next: Moment,
    flows: [Flows; 2],
    torque: [f64; 2],
    /// Time and powers of the last evaluation.
    last_powers: (f64, Flows),
    /// Flows counted beyond the last evaluation, by extrapolation (generalized-alpha).
    beyond: Flows,
    /// True for steps of fixed size, which are accepted whatever their error.
    fixed: bool,
    newton: Newton,
    /// Velocities and accelerations of the stages.
    stages: Vec<(Vec<f64>, Vec<f64>)>,
    /// Times and accelerations of the step before, for extrapolation.
    history: Vec<(f64, Vec<f64>)>,
    x: Vec<f64>,
    exponent: f64,
}

impl ImplicitRun {
    fn new(
        dynamics: &mut Dynamics<'_>,
        start: Moment,
        scheme: Scheme,
        settings: &IntegratorSettings,
    ) -> Self {
        let n = start.z.len();
        let zero = || vec![0.0; n];
        dynamics.evaluate(start.t, &start.z, &start.v, &start.a);
        let powers = Flows::of(dynamics, start.t);
        Self {
            flows: [Flows::default(); 2],
            torque: [dynamics.powers.torque; 2],
            last_powers: (start.t, powers),
            next: start.clone(),
            beyond: Flows::default(),
            fixed: settings.step.is_some(),
            newton: Newton::new(n),
            stages: (0..STAGES).map(|_| (zero(), zero())).collect(),
            history: vec![(start.t, start.a.clone())],
            now: start,
            x: zero(),
            exponent: if scheme == Scheme::Esdirk { 0.25 } else { 1.0 / 3.0 },
            scheme,
        }
    }

    /// Takes over the powers of a step of length h and what serves the guesses of the next one.
    fn accept(&mut self, dynamics: &mut Dynamics<'_>, h: f64) -> Step<'_> {
        self.torque[1] = dynamics.powers.torque;
        let t0 = self.now.t;
        match self.scheme {
            Scheme::Esdirk => {
                self.last_powers = (t0 + h, Flows::of(dynamics, t0 + h));
                // the stages in the second half serve the next extrapolation
                self.history.clear();
                self.history.extend([3, 4, 5].map(|j| (t0 + C[j] * h, self.stages[j].1.clone())));
            }
            Scheme::GeneralizedAlpha { rho_infinity } => {
                // powers are known between the ends: a trapezoid from one evaluation to the next, then on to the end
                let t = t0 + (1.0 - rho_infinity / (rho_infinity + 1.0)) * h;
                let power = Flows::of(dynamics, t);
                let (before, old) = self.last_powers;
                let (span, rest) = (t - before, t0 + h - t);
                let slope = power.plus(-1.0, old);
                let beyond = Flows::default().plus(rest, power).plus(rest * rest / (2.0 * span), slope);
                let reached =
                    self.flows[0].plus(-1.0, self.beyond).plus(span / 2.0, power).plus(span / 2.0, old);
                self.flows[1] = reached.plus(1.0, beyond);
                self.beyond = beyond;
                self.last_powers = (t, power);
                self.history = vec![(t0, self.now.a.clone())];
            }
        }
        dynamics.record(t0 + h, self.next.lists());
        let speeds = [self.now.t, self.next.t].map(|t| dynamics.drive.at(t).speed);
        let power = [0, 1].map(|i| self.torque[i] * speeds[i]);
        Step { start: &self.now, end: &self.next, flows: self.flows, torque: self.torque, power }
    }

    fn advance(&mut self) {
        std::mem::swap(&mut self.now, &mut self.next);
        self.flows[0] = self.flows[1];
        self.torque[0] = self.torque[1];
    }

    /// At a jump of the drive's acceleration: that of the shaft jumps with it, and what went before tells nothing.
    fn begin_phase(&mut self, dynamics: &mut Dynamics<'_>) {
        let now = &mut self.now;
        let (z, v) = (now.z.clone(), now.v.clone());
        dynamics.acceleration(now.t, &z, &v, &mut now.a);
        dynamics.evaluate(now.t, &now.z, &now.v, &now.a);
        self.last_powers = (now.t, Flows::of(dynamics, now.t));
        self.beyond = Flows::default();
        self.torque[0] = dynamics.powers.torque;
        self.history = vec![(now.t, now.a.clone())];
    }

    /// Tries a step; its error over the tolerance, or nothing when Newton's method failed.
    fn step(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        h: f64,
        settings: &IntegratorSettings,
    ) -> Result<Option<f64>> {
        let tolerance = settings.step_tolerance(dynamics, &self.now, h);
        let angle = settings.rtol;
        match self.scheme {
            Scheme::Esdirk => self.esdirk(dynamics, h, [tolerance, angle]),
            Scheme::GeneralizedAlpha { rho_infinity } => {
                self.generalized_alpha(dynamics, h, [tolerance, angle], rho_infinity)
            }
        }
    }

    fn esdirk(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        h: f64,
        [tolerance, angle]: [f64; 2],
    ) -> Result<Option<f64>> {
        let n = self.x.len();
        let g = GAMMA * h;
        let (t0, now) = (self.now.t, &self.now);
        self.stages[0].0.clone_from(&now.v);
        self.stages[0].1.clone_from(&now.a);
        let mut flows = self.flows[0].plus(h * B[0], self.last_powers.1);
        let (mut z0, mut v0, zero) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for i in 1..STAGES {
            let t = t0 + C[i] * h;
            for k in 0..n {
                let (mut dz, mut dv) = (0.0, 0.0);
                for j in 0..i {
                    dz += A[i][j] * self.stages[j].0[k];
                    dv += A[i][j] * self.stages[j].1[k];
                }
                v0[k] = now.v[k] + h * dv;
                z0[k] = now.z[k] + h * dz + g * v0[k];
            }
            let known: Vec<_> = (0..i).map(|j| (t0 + C[j] * h, &self.stages[j].1)).collect();
            extrapolate(&known, &self.history, t, &mut self.x);
            self.x.iter_mut().for_each(|x| *x *= g * g);
            let stage = Stage { t, z: &z0, v: &v0, a: &zero, coefficients: [1.0, 1.0 / g, 1.0 / (g * g)] };
            if !self.newton.solve(dynamics, &stage, &mut self.x, tolerance)? {
                return Ok(None);
            }
            let (v, a) = &mut self.stages[i];
            for k in 0..n {
                a[k] = self.x[k] / (g * g);
                v[k] = v0[k] + g * a[k];
            }
            flows = flows.plus(h * B[i], Flows::of(dynamics, t));
            if i == STAGES - 1 {
                for k in 0..n {
                    self.next.z[k] = z0[k] + self.x[k];
                }
                self.next.v.clone_from(v);
                self.next.a.clone_from(a);
            }
        }
        let size = dynamics.assembly.size();
        let of = |k: usize| -> f64 {
            let e: f64 = (0..STAGES).map(|j| (B[j] - EMBEDDED[j]) * self.stages[j].0[k]).sum();
            (h * e).abs()
        };
        let mut error: f64 = 0.0;
        for k in 0..size {
            error = error.max(of(k));
        }
        self.flows[1] = flows;
        // the angle of a drive by its torque has a tolerance of its own, rad
        let error = (size..n).fold(error / tolerance, |m: f64, k| m.max(of(k) / angle));
        Ok(error.is_finite().then_some(error))
    }

    fn generalized_alpha(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        h: f64,
        [tolerance, angle]: [f64; 2],
        rho: f64,
    ) -> Result<Option<f64>> {
        let (alpha_m, alpha_f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
        let gamma = 0.5 - alpha_m + alpha_f;
        let beta = (1.0 - alpha_m + alpha_f).powi(2) / 4.0;
        let (n, now) = (self.x.len(), &self.now);
        // x = z_(n+1) - z_n; everything at the evaluation points is affine in x
        let c_a = 1.0 / (beta * h * h);
        let c_v = gamma / (beta * h);
        let (kf, km) = (1.0 - alpha_f, 1.0 - alpha_m);
        let (mut v0, mut a0) = (vec![0.0; n], vec![0.0; n]);
        // constants of a_(n+1) = c_a x + a_c and v_(n+1) = c_v x + v_c
        let constants = |k: usize| {
            let a_c = -now.v[k] / (beta * h) - (0.5 / beta - 1.0) * now.a[k];
            (a_c, now.v[k] + h * ((1.0 - gamma) * now.a[k] + gamma * a_c))
        };
        for k in 0..n {
            let (a_c, v_c) = constants(k);
            v0[k] = kf * v_c + alpha_f * now.v[k];
            a0[k] = km * a_c + alpha_m * now.a[k];
        }
        let t = now.t + kf * h;
        extrapolate(&[(now.t, &now.a)], &self.history, now.t + h, &mut self.x);
        for k in 0..n {
            self.x[k] = h * now.v[k] + h * h * ((0.5 - beta) * now.a[k] + beta * self.x[k]);
        }
        let stage = Stage { t, z: &now.z, v: &v0, a: &a0, coefficients: [kf, kf * c_v, km * c_a] };
        if !self.newton.solve(dynamics, &stage, &mut self.x, tolerance)? {
            return Ok(None);
        }
        let now = &self.now;
        let size = dynamics.assembly.size();
        let mut change: f64 = 0.0;
        for k in 0..n {
            let (a_c, v_c) = (
                -now.v[k] / (beta * h) - (0.5 / beta - 1.0) * now.a[k],
                now.v[k] + h * (1.0 - gamma) * now.a[k],
            );
            let a = c_a * self.x[k] + a_c;
            self.next.z[k] = now.z[k] + self.x[k];
            self.next.a[k] = a;
            self.next.v[k] = v_c + h * gamma * a;
            let own = if k < size { 1.0 } else { tolerance / angle };
            change = change.max(own * (a - now.a[k]).abs());
        }
        // local error of the displacement: the algorithm's acceleration lags by (alpha_f - alpha_m) h
        let error = h * h * (beta + (alpha_f - alpha_m) / 2.0 - 1.0 / 6.0).abs() * change / tolerance;
        Ok(error.is_finite().then_some(error))
    }
}

/// Polynomial through the most recent accelerations at different times (at most four), at time t.
fn extrapolate(known: &[(f64, &Vec<f64>)], history: &[(f64, Vec<f64>)], t: f64, a: &mut [f64]) {
    let mut points: Vec<(f64, &Vec<f64>)> = history.iter().map(|(t, a)| (*t, a)).collect();
    for &(at, values) in known {
        points.retain(|(other, _)| *other != at);
        points.push((at, values));
    }
    // those nearest to t are the best; equal times can't be told apart
    points.sort_by(|p, q| (p.0 - t).abs().total_cmp(&(q.0 - t).abs()));
    points.truncate(4);
    a.fill(0.0);
    for (i, (ti, values)) in points.iter().enumerate() {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        let weight: f64 = others.map(|(_, (tj, _))| (t - tj) / (ti - tj)).product();
        a.iter_mut().zip(*values).for_each(|(a, v)| *a += weight * v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_satisfy_the_order_conditions() {
        let full = |i: usize, j: usize| {
            if i == j && i > 0 {
                GAMMA
            } else if j < 5 {
                A[i][j]
            } else {
                0.0
            }
        };
        let row = |i: usize, f: &dyn Fn(usize) -> f64| (0..STAGES).map(|j| full(i, j) * f(j)).sum::<f64>();
        let sum = |b: &[f64; STAGES], f: &dyn Fn(usize) -> f64| (0..STAGES).map(|i| b[i] * f(i)).sum::<f64>();
        for i in 1..STAGES {
            assert!((row(i, &|_| 1.0) - C[i]).abs() < 1e-14);
            // stage order two
            assert!((row(i, &|j| C[j]) - C[i] * C[i] / 2.0).abs() < 1e-14, "{i}");
        }
        for (b, order) in [(&B, 4), (&EMBEDDED, 3)] {
            let conditions = [
                (1, sum(b, &|_| 1.0) - 1.0),
                (2, sum(b, &|i| C[i]) - 0.5),
                (3, sum(b, &|i| C[i] * C[i]) - 1.0 / 3.0),
                (3, sum(b, &|i| row(i, &|j| C[j])) - 1.0 / 6.0),
                (4, sum(b, &|i| C[i].powi(3)) - 0.25),
                (4, sum(b, &|i| C[i] * row(i, &|j| C[j])) - 0.125),
                (4, sum(b, &|i| row(i, &|j| C[j] * C[j])) - 1.0 / 12.0),
                (4, sum(b, &|i| row(i, &|j| row(j, &|k| C[k]))) - 1.0 / 24.0),
            ];
            for (of, defect) in conditions.iter().filter(|c| c.0 <= order) {
                assert!(defect.abs() < 1e-13, "order {of}: {defect:e}");
            }
        }
    }
}
