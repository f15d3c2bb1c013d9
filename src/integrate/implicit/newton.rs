//! The equations of a stage, solved by Newton iterations whose matrix serves several steps.

use crate::error::Result;
use crate::integrate::implicit::anderson::Secants;
use crate::shaft::motion::{Dynamics, NewtonMatrix};

/// Share of the step's tolerance left to the Newton iteration.
const NEWTON_TOLERANCE_SHARE: f64 = 0.03;

/// Least ratio of two corrections that is remembered: no iteration is trusted to converge faster.
const FASTEST_RATE: f64 = 0.02;
/// Most iterations of a stage.
const MOST_ITERATIONS: usize = 15;
/// Size of a correction over the length of the shaft below which it is rounding and the iteration has
/// converged.
const ROUNDING_PER_LENGTH: f64 = 1e-12;
/// Convergence rate from which a fresh matrix is worth its price.
const SLOW_RATE: f64 = 0.25;
/// Iterations of a stage that make a shorter step cheaper.
const LABORIOUS_ITERATIONS: usize = 4;
/// Steps cut in halves before the tangent of the present state is tried.
const HALVINGS_BEFORE_TANGENT: usize = 4;
/// Steps that a tangent serves before the undeformed shaft's matrix is tried again.
const STEPS_OF_A_TANGENT: usize = 20;
/// Largest relative change of its coefficients, by step or speed, with which a factorised matrix may still serve.
const SERVING_MATRIX_RTOL: f64 = 0.1;
/// Relative change of the coefficients below which a new matrix would be as good as the same.
const SAME_MATRIX_RTOL: f64 = 0.01;

/// The equations of a stage: `z + c_k x`, `v + c_v x`, `a + c_a x` at time t balance the forces.
pub(super) struct Stage<'a> {
    pub(super) t: f64,
    pub(super) z: &'a [f64],
    pub(super) v: &'a [f64],
    pub(super) a: &'a [f64],
    pub(super) coefficients: [f64; 3],
}

/// Newton's method with a matrix that is kept as long as it serves.
pub(super) struct Newton {
    matrix: Option<NewtonMatrix>,
    /// The undeformed shaft's matrix did not serve: use the present tangent.
    present: bool,
    /// Steps accepted with the present tangent.
    served: usize,
    /// Stages and iterations of this step.
    effort: (usize, usize),
    /// The last stage converged slowly.
    slow: bool,
    rate: f64,
    z: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    change: Vec<f64>,
    secants: Secants,
}

impl Newton {
    pub(super) fn new(n: usize) -> Self {
        let zero = || vec![0.0; n];
        Self {
            matrix: None,
            present: false,
            served: 0,
            effort: (0, 0),
            slow: false,
            rate: 1.0,
            z: zero(),
            v: zero(),
            a: zero(),
            change: zero(),
            secants: Secants::default(),
        }
    }

    /// After a step: goes back to the undeformed shaft's matrix when the present tangent has served a while.
    pub(super) fn accepted(&mut self) {
        self.effort = (0, 0);
        if self.present {
            self.served += 1;
            if self.served >= STEPS_OF_A_TANGENT {
                (self.present, self.matrix, self.served) = (false, None, 0);
            }
        }
    }

    /// After a step whose iteration failed: shorter steps first, then the tangent of the present state.
    pub(super) fn rejected(&mut self, failures: usize, fixed: bool) {
        self.effort = (0, 0);
        self.present |= fixed || failures >= HALVINGS_BEFORE_TANGENT;
    }

    /// True when the stages of this step took many iterations.
    pub(super) fn laborious(&self) -> bool {
        self.effort.1 > LABORIOUS_ITERATIONS * self.effort.0
    }

    /// Solves a stage from the guess in x; false when no matrix makes the iteration converge.
    pub(super) fn solve(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        stage: &Stage<'_>,
        x: &mut [f64],
        tolerance: f64,
    ) -> Result<bool> {
        let guess = x.to_vec();
        let mut fresh = false;
        loop {
            let [c_k, c_v, c_a] = stage.coefficients;
            let stale = self.matrix.as_ref().map_or(f64::INFINITY, |m| {
                let ([k, _, a], speed) = m.made_for;
                // the Coriolis terms count beside the mass
                let turned = 2.0 * (dynamics.speed_at(stage.t) - speed).abs() * c_v / c_a;
                (c_a / c_k / (a / k) - 1.0).abs().max(turned)
            });
            // slow convergence with the right coefficients is for the secants, unless the tangent itself has aged
            let limit = if !self.slow || fresh {
                SERVING_MATRIX_RTOL
            } else if self.present {
                0.0
            } else {
                SAME_MATRIX_RTOL
            };
            if stale >= limit && !(fresh && stale <= SAME_MATRIX_RTOL) {
                self.update(stage, x);
                let state = self.present.then_some(&self.z[..]);
                self.matrix = Some(dynamics.newton_matrix(stage.t, stage.coefficients, state)?);
                (fresh, self.slow, self.rate) = (true, false, 1.0);
                self.secants.clear();
            }
            if self.iterate(dynamics, stage, x, tolerance, false) {
                return Ok(true);
            }
            x.copy_from_slice(&guess);
            // where the last iterate touched says nothing about the guess
            dynamics.rub_mut().touching.clear();
            if fresh && self.present {
                // the last resort: a tangent in every iteration
                self.secants.clear();
                if self.iterate(dynamics, stage, x, tolerance, true) {
                    return Ok(true);
                }
            }
            if fresh || (stale <= SAME_MATRIX_RTOL && !self.present) {
                self.matrix = None;
                return Ok(false);
            }
            self.slow = true;
        }
    }

    pub(super) fn update(&mut self, stage: &Stage<'_>, x: &[f64]) {
        let [c_k, c_v, c_a] = stage.coefficients;
        for k in 0..x.len() {
            self.z[k] = stage.z[k] + c_k * x[k];
            self.v[k] = stage.v[k] + c_v * x[k];
            self.a[k] = stage.a[k] + c_a * x[k];
        }
    }

    /// Iterates from x; `full`: with the tangent of every iterate.
    pub(super) fn iterate(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        stage: &Stage<'_>,
        x: &mut [f64],
        tolerance: f64,
        full: bool,
    ) -> bool {
        let (mut before, mut stalls) = (f64::INFINITY, 0);
        self.effort.0 += 1;
        for iteration in 0..MOST_ITERATIONS {
            self.effort.1 += 1;
            self.update(stage, x);
            dynamics.evaluate(stage.t, &self.z, &self.v, &self.a);
            if iteration == 0 {
                dynamics.follow_sections();
            }
            let moved = self.matrix.as_ref().is_some_and(|matrix| dynamics.contact_moved(matrix));
            if full || moved {
                let z = (full || self.present).then_some(&self.z[..]);
                // an iterate far off may have none
                let Ok(matrix) = dynamics.newton_matrix(stage.t, stage.coefficients, z) else { return false };
                self.matrix = Some(matrix);
            }
            if moved {
                // another contact is another problem: what was learnt of the last one does not hold
                self.secants.clear();
                (before, stalls, self.rate) = (f64::INFINITY, 0, 1.0);
            }
            let Some(matrix) = &self.matrix else { return false };
            dynamics.correct(matrix, &mut self.change);
            if !full {
                self.secants.improve(&mut self.change, iteration > 0);
            }
            let size =
                self.change.iter().fold(0.0, |m: f64, d| if d.abs() >= m { d.abs() } else { m + d * 0.0 });
            let size = size / tolerance;
            if !size.is_finite() {
                return false;
            }
            x.iter_mut().zip(&self.change).for_each(|(x, d)| *x += d);
            if iteration > 0 {
                self.rate = (size / before).max(0.3 * self.rate).max(FASTEST_RATE);
                self.slow = size / before > SLOW_RATE;
                stalls = if size / before > 0.9 { stalls + 1 } else { 0 };
                // corrections that no longer shrink are rounding, or no solution
                if stalls > 1 || (size > 2.0 * before && !full) {
                    return size * tolerance < ROUNDING_PER_LENGTH * dynamics.assembly.model.length;
                }
            }
            let rate = self.rate.min(0.9);
            if size * rate / (1.0 - rate) < NEWTON_TOLERANCE_SHARE {
                return true;
            }
            before = size;
        }
        false
    }
}
