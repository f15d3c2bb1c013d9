//! Explicit Adams method of variable order and step for `z'' = a(t, z, z')`: predict, evaluate, correct, evaluate.
//!
//! With `y = (z, v)`, `y' = f = (v, a)` and the modified divided differences
//! `phi_0(n) = f_n, phi_(j+1)(n) = phi_j(n) - phi*_j(n-1), phi*_j(n) = beta_j(n) phi_j(n)`:
//!
//! ```text
//!     p = y_n + h sum_(j<k) g_j phi*_j(n)        y_(n+1) = p + h g_k phi_k(n+1)
//! ```
//!
//! Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, sections III.5 and III.7; the choice of
//! order and step is that of Shampine and Gordon (Computer Solution of Ordinary Differential Equations, 1975).

use crate::error::Result;
use crate::integrate::{Course, Flows, IntegratorSettings, Moment, OnStep, Progress, Step, failed};
use crate::shaft::motion::Dynamics;

/// Highest order of the predictor; the corrector is one order higher.
const HIGHEST: usize = 12;
/// Error coefficients `gamma*_j` of the Adams-Moulton formulas with constant steps.
const MOULTON: [f64; HIGHEST + 2] = moulton();
/// Failures of one step after which the method starts anew with order one.
const RESTART: usize = 3;
/// Failures of one step after which the run is given up.
const HOPELESS: usize = 60;

/// `gamma*_0 = 1, gamma*_m = - sum_(j<m) gamma*_j / (m + 1 - j)`.
const fn moulton() -> [f64; HIGHEST + 2] {
    let mut gamma = [1.0; HIGHEST + 2];
    let mut m = 1;
    while m < gamma.len() {
        let (mut sum, mut j) = (0.0, 0);
        while j < m {
            sum -= gamma[j] / (m + 1 - j) as f64;
            j += 1;
        }
        gamma[m] = sum;
        m += 1;
    }
    gamma
}

/// Integrates from `start` to the last stop. The method starts anew at every stop and where a ring is touched.
///
/// # Errors
/// As [`crate::integrate::integrate`].
pub fn integrate(
    dynamics: &mut Dynamics<'_>,
    start: Moment,
    settings: &IntegratorSettings,
    on_step: &mut OnStep<'_>,
) -> Result<Progress> {
    let mut run = AdamsRun::new(dynamics, start);
    let mut course = Course::new(settings, dynamics, &run.now);
    let mut progress = Progress::default();
    run.restart(dynamics, settings);
    while run.now.t < course.until {
        let stop = course.stop_after(run.now.t);
        let left = stop - run.now.t;
        let last = run.h >= left * (1.0 - 1e-9);
        // the last two steps before a stop share what is left
        let taken = if last { left } else { run.h.min(left / 2.0) };
        course.resolve(taken, run.now.t, progress)?;
        if !run.attempt(dynamics, taken, settings) {
            progress.rejected += 1;
            if run.failures > HOPELESS {
                return Err(failed(
                    format!("no step has a tolerable error at t = {:.6e} s", run.now.t),
                    format!("a step of {taken:.3e} s with order 1"),
                ));
            }
            continue;
        }
        if !course.stands(dynamics, &run.now, &run.next, taken) {
            progress.rejected += 1;
            continue;
        }
        progress.steps += 1;
        run.next.t = if last { stop } else { run.now.t + taken };
        run.accept(dynamics);
        if on_step(dynamics, &run.finished(dynamics), progress)?.is_break() {
            return Ok(progress);
        }
        run.advance();
        course.prepare(dynamics, &run.now);
        course.count(taken, run.now.t, progress.steps)?;
        if last {
            if dynamics.drive.begin_phase(run.now.t) {
                run.begin_phase(dynamics);
            }
            run.restart(dynamics, settings);
        }
    }
    Ok(progress)
}

/// Errors of a step over its tolerance, for the orders two and one below, its own and the one above.
#[derive(Debug, Clone, Copy)]
struct Errors {
    below: [f64; 2],
    own: f64,
    above: f64,
}

/// An integration under way.
struct AdamsRun {
    now: Moment,
    next: Moment,
    flows: [Flows; 2],
    torque: [f64; 2],
    /// Step to take next, and order of its predictor.
    h: f64,
    order: usize,
    /// True in the starting phase, in which order and step are raised after every step.
    starting: bool,
    failures: usize,
    /// Steps of the same size taken in a row.
    equal: usize,
    /// Times before the present one, the latest first.
    times: Vec<f64>,
    /// Differences `phi_j` of (v, a) at the present time, and of the powers.
    phi: Vec<Vec<f64>>,
    phi_powers: [Flows; HIGHEST + 2],
    /// How many of the differences belong to steps that were taken.
    valid: usize,
    /// `beta_j` and `g_j` of the step under way.
    beta: [f64; HIGHEST + 2],
    g: [f64; HIGHEST + 2],
    /// `f(p) - sum phi*_j`, the last difference at the new time.
    last: Vec<f64>,
    slope: Vec<f64>,
    errors: Errors,
}

impl AdamsRun {
    fn new(dynamics: &mut Dynamics<'_>, start: Moment) -> Self {
        let n = start.z.len();
        dynamics.evaluate(start.t, &start.z, &start.v, &start.a);
        let mut phi = vec![vec![0.0; 2 * n]; HIGHEST + 2];
        phi[0][..n].copy_from_slice(&start.v);
        phi[0][n..].copy_from_slice(&start.a);
        let mut phi_powers = [Flows::default(); HIGHEST + 2];
        phi_powers[0] = Flows::of(dynamics, start.t);
        Self {
            next: start.clone(),
            now: start,
            flows: [Flows::default(); 2],
            torque: [dynamics.powers.torque; 2],
            h: 0.0,
            order: 1,
            starting: true,
            failures: 0,
            equal: 0,
            times: Vec::with_capacity(HIGHEST + 3),
            phi,
            phi_powers,
            valid: 1,
            beta: [1.0; HIGHEST + 2],
            g: [1.0; HIGHEST + 2],
            last: vec![0.0; 2 * n],
            slope: vec![0.0; 2 * n],
            errors: Errors { below: [0.0; 2], own: 0.0, above: f64::INFINITY },
        }
    }

    /// At a jump of the drive's acceleration: that of the shaft jumps with it.
    fn begin_phase(&mut self, dynamics: &mut Dynamics<'_>) {
        let n = self.now.z.len();
        let (z, v) = (self.now.z.clone(), self.now.v.clone());
        dynamics.acceleration(self.now.t, &z, &v, &mut self.now.a);
        dynamics.evaluate(self.now.t, &z, &v, &self.now.a);
        self.phi[0][n..].copy_from_slice(&self.now.a);
        self.phi_powers[0] = Flows::of(dynamics, self.now.t);
        self.torque[0] = dynamics.powers.torque;
    }

    /// Forgets the past: order one, a step whose error is a sixteenth of the tolerance if accelerations last.
    fn restart(&mut self, dynamics: &Dynamics<'_>, settings: &IntegratorSettings) {
        let n = self.now.z.len();
        let fastest = self.phi[0][n..].iter().fold(0.0, |m: f64, a| m.max(a.abs()));
        let modest = 0.25 * (settings.tolerance(dynamics, &self.now) / fastest.max(f64::MIN_POSITIVE)).sqrt();
        (self.h, self.order, self.starting) = (settings.first_step.min(modest), 1, true);
        (self.valid, self.equal, self.failures) = (1, 0, 0);
        self.times.clear();
    }

    /// `beta_j` and `g_j` for a step of size h from the present time.
    fn coefficients(&mut self, h: f64) {
        let k = self.order;
        let t = self.now.t;
        let end = t + h;
        // x_(n-j), x_n being the present time
        let past = |j: usize| if j == 0 { t } else { self.times[j - 1] };
        self.beta[0] = 1.0;
        for j in 1..=k.min(self.times.len()) {
            self.beta[j] = self.beta[j - 1] * (end - past(j - 1)) / (t - past(j));
        }
        let mut c: [f64; HIGHEST + 3] = std::array::from_fn(|q| 1.0 / (q + 1) as f64);
        self.g[0] = 1.0;
        for j in 1..=k {
            for q in 0..=k + 1 - j {
                c[q] = if j == 1 {
                    1.0 / ((q + 1) * (q + 2)) as f64
                } else {
                    c[q] - c[q + 1] * h / (end - past(j - 1))
                };
            }
            self.g[j] = c[0];
        }
    }

    /// Tries a step; false when its error is too large, after order and step have been lowered.
    fn attempt(&mut self, dynamics: &mut Dynamics<'_>, h: f64, settings: &IntegratorSettings) -> bool {
        let (n, k) = (self.now.z.len(), self.order);
        if h != self.h {
            (self.equal, self.h) = (0, h);
        }
        self.coefficients(h);
        let end = self.now.t + h;
        self.last.fill(0.0);
        self.slope.fill(0.0);
        for j in 0..k {
            let (b, gb) = (self.beta[j], h * self.g[j] * self.beta[j]);
            for ((sum, last), phi) in self.slope.iter_mut().zip(&mut self.last).zip(&self.phi[j]) {
                *sum += gb * phi;
                *last -= b * phi;
            }
        }
        for i in 0..n {
            self.next.z[i] = self.now.z[i] + self.slope[i];
            self.next.v[i] = self.now.v[i] + self.slope[n + i];
        }
        dynamics.acceleration(end, &self.next.z, &self.next.v, &mut self.next.a);
        for i in 0..n {
            self.last[i] += self.next.v[i];
            self.last[n + i] += self.next.a[i];
        }
        self.errors = self.estimate(h, settings.step_tolerance(dynamics, &self.now, h));
        if self.errors.own <= 1.0 {
            let g = h * self.g[k];
            for i in 0..n {
                self.next.z[i] += g * self.last[i];
                self.next.v[i] += g * self.last[n + i];
            }
            return true;
        }
        self.starting = false;
        self.failures += 1;
        self.equal = 0;
        if self.failures <= RESTART {
            self.order = self.lower().unwrap_or(k);
            self.h = h / 2.0;
        } else {
            // an error that is no number says nothing about the step
            let share = if self.errors.own.is_finite() { (0.5 / self.errors.own).sqrt() } else { 0.1 };
            (self.order, self.valid) = (1, 1);
            self.h = h * share.clamp(0.05, 0.5);
            self.times.clear();
        }
        false
    }

    /// Errors of the displacements, and of the velocities times the step, over the tolerance.
    fn estimate(&self, h: f64, tolerance: f64) -> Errors {
        let (n, k) = (self.now.z.len(), self.order);
        let (mut own, mut below, mut above) = (0.0_f64, [0.0_f64; 2], 0.0_f64);
        let has_above = self.equal >= k && k < HIGHEST && self.valid > k;
        for i in 0..2 * n {
            let weight = if i < n { 1.0 } else { h };
            let difference = self.last[i];
            // a value that is no number must not get lost in a maximum
            own = if difference.is_finite() { own.max(weight * difference.abs()) } else { f64::INFINITY };
            if !own.is_finite() {
                break;
            }
            if k > 1 {
                let one = difference + self.beta[k - 1] * self.phi[k - 1][i];
                below[1] = below[1].max(weight * one.abs());
                if k > 2 {
                    let two = one + self.beta[k - 2] * self.phi[k - 2][i];
                    below[0] = below[0].max(weight * two.abs());
                }
            }
            if has_above {
                above = above.max(weight * (difference - self.beta[k] * self.phi[k][i]).abs());
            }
        }
        let scale = h / tolerance;
        let moulton = |j: usize| scale * MOULTON[j].abs();
        Errors {
            own: own * scale * (self.g[k] - self.g[k - 1]).abs(),
            below: [
                if k > 2 { moulton(k - 2) * below[0] } else { 0.0 },
                if k > 1 { moulton(k - 1) * below[1] } else { f64::INFINITY },
            ],
            above: if has_above { moulton(k + 1) * above } else { f64::INFINITY },
        }
    }

    /// The order below, where its error is no larger.
    fn lower(&self) -> Option<usize> {
        let Errors { below: [two, one], own, .. } = self.errors;
        let better = match self.order {
            1 => false,
            2 => one <= 0.5 * own,
            _ => two.max(one) <= own,
        };
        better.then(|| self.order - 1)
    }

    /// Evaluates the corrected state and brings the differences up to the new time.
    fn accept(&mut self, dynamics: &mut Dynamics<'_>) {
        let (n, k, h) = (self.now.z.len(), self.order, self.h);
        let t = self.now.t + h;
        let (z, v) = (&self.next.z, &self.next.v);
        dynamics.acceleration(t, z, v, &mut self.next.a);
        dynamics.add_acceleration(t, &self.next.a);
        let powers = Flows::of(dynamics, t);
        self.torque[1] = dynamics.powers.torque;
        // the work follows the states and is corrected with their final values
        let mut difference = powers;
        self.flows[1] = self.flows[0];
        for j in 0..k {
            self.flows[1] = self.flows[1].plus(h * self.g[j] * self.beta[j], self.phi_powers[j]);
            difference = difference.plus(-self.beta[j], self.phi_powers[j]);
        }
        self.flows[1] = self.flows[1].plus(h * self.g[k], difference);

        let count = (k + 1).min(self.valid);
        self.slope[..n].copy_from_slice(&self.next.v);
        self.slope[n..].copy_from_slice(&self.next.a);
        let mut carried = powers;
        for j in 0..count {
            let b = self.beta[j];
            for (phi, f) in self.phi[j].iter_mut().zip(&mut self.slope) {
                // phi_j(n+1) replaces phi_j(n); what goes on is phi_(j+1)(n+1)
                let star = b * *phi;
                *phi = *f;
                *f -= star;
            }
            let star = self.phi_powers[j];
            self.phi_powers[j] = carried;
            carried = carried.plus(-b, star);
        }
        self.phi[count].copy_from_slice(&self.slope);
        self.phi_powers[count] = carried;
        self.valid = count + 1;
    }

    fn finished(&self, dynamics: &Dynamics<'_>) -> Step<'_> {
        let speeds = [self.now.t, self.next.t].map(|t| dynamics.drive.at(t).speed);
        let power = [0, 1].map(|i| self.torque[i] * speeds[i]);
        Step { start: &self.now, end: &self.next, flows: self.flows, torque: self.torque, power }
    }

    /// Moves on to the new time and chooses order and step of the next one.
    fn advance(&mut self) {
        self.times.insert(0, self.now.t);
        self.times.truncate(HIGHEST + 1);
        std::mem::swap(&mut self.now, &mut self.next);
        (self.flows[0], self.torque[0]) = (self.flows[1], self.torque[1]);
        self.failures = 0;
        self.equal += 1;
        let (k, errors) = (self.order, self.errors);
        let lower = self.lower();
        let mut error = errors.own;
        if lower.is_some() || k == HIGHEST {
            self.starting = false;
        }
        if self.starting {
            self.order = k + 1;
        } else if lower.is_some() || (k > 1 && errors.below[1] <= errors.own.min(errors.above)) {
            (self.order, error) = (k - 1, errors.below[1]);
        } else if errors.above < if k > 1 { errors.own } else { 0.5 * errors.own } {
            (self.order, error) = (k + 1, errors.above);
        }
        // differences of higher order than the history holds can't be had
        self.order = self.order.min(self.valid - 1).max(1);
        let ratio = 0.5 / error.max(f64::MIN_POSITIVE);
        let power = self.order as i32 + 1;
        let factor = if self.starting || ratio >= 2.0_f64.powi(power) {
            2.0
        } else if ratio >= 1.0 {
            1.0
        } else {
            ratio.powf(1.0 / f64::from(power)).clamp(0.5, 0.9)
        };
        if factor != 1.0 {
            self.equal = 0;
            self.h *= factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_of_equal_steps_are_those_of_adams_and_moulton() {
        let known =
            [1.0, -1.0 / 2.0, -1.0 / 12.0, -1.0 / 24.0, -19.0 / 720.0, -3.0 / 160.0, -863.0 / 60480.0];
        for (ours, known) in MOULTON.iter().zip(known) {
            assert!((ours - known).abs() < 1e-15, "{ours} {known}");
        }
    }
}
