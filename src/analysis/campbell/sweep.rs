//! Motions at all speeds of a sweep: on the reduced basis, or corrected until they satisfy the unreduced equations; and what vouches
//! for them.

use crate::analysis::Counter;
use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::reduced_basis::{Reduced, Solution, Whirling};
use crate::error::Result;
use crate::linalg::factor::Ldlt;
use crate::linalg::sparse::combine;
use crate::model::{CampbellSettings, SPARE_BASIS};
use crate::results::Diagnostic;
use crate::shaft::spectrum::{Flexibility, Spectrum};
use faer::c64;
use rayon::prelude::*;

/// Energy norm of the imbalance at which an unreduced motion counts as solved; its frequency's error is
/// the square.
const SOLVED_IMBALANCE: f64 = 1e-6;

/// Imbalance above which the check of the reduced model is in doubt.
const DOUBTFUL_IMBALANCE: f64 = 1e-4;

pub(super) struct WhirlSolver<'a> {
    pub operators: &'a Operators,
    pub spectrum: &'a Spectrum,
    pub reduced: &'a Reduced,
    pub settings: &'a CampbellSettings,
    /// Speeds of the sweep, those asked for among them.
    pub speeds: Vec<f64>,
}

impl WhirlSolver<'_> {
    /// Motions at one speed, reduced or corrected until they satisfy the unreduced equations.
    pub fn solve(&self, speed: f64) -> Result<Solution> {
        match self.settings.reduction {
            Some(_) => self.reduced.solve(speed),
            None => Ok(self.unreduced(speed)?.0),
        }
    }

    /// Extends the basis by static answers to the imbalance of the motions until it is below
    /// [`SOLVED_IMBALANCE`]; also returns the imbalance that remains.
    pub(super) fn unreduced(&self, speed: f64) -> Result<(Solution, f64)> {
        let wanted = self.settings.modes + SPARE_BASIS;
        let mut solution = self.reduced.solve(speed)?;
        let mut refined: Option<Reduced> = None;
        let mut before: Option<(Solution, Option<Reduced>)> = None;
        let mut imbalance = f64::INFINITY;
        for _ in 0..6 {
            let current = refined.as_ref().unwrap_or(self.reduced);
            let targets: Vec<Whirling> =
                solution.motions.iter().take(wanted.min(solution.oscillating)).cloned().collect();
            let (next, left) = current.refined(self.operators, self.spectrum, speed, &targets)?;
            // what no longer shrinks is rounding, and corrections of it would be noise in the basis
            let stalled = left > imbalance / 2.0 && left <= DOUBTFUL_IMBALANCE;
            if let (true, Some(before)) = (stalled && left > imbalance, before.take()) {
                (solution, refined) = before;
            } else {
                imbalance = left;
            }
            if stalled || imbalance <= SOLVED_IMBALANCE {
                break;
            }
            let solved = next.solve(speed)?;
            before = Some((std::mem::replace(&mut solution, solved), refined.replace(next)));
        }
        // back to the common basis, so that motions of different speeds can be compared
        if let Some(refined) = &refined {
            solution = refined.onto(self.reduced, self.operators, solution)?;
        }
        Ok((solution, imbalance))
    }

    /// The motions at every speed.
    pub(super) fn sweep(&self, progress: Counter<'_>) -> Result<Vec<Solution>> {
        let speeds = &self.speeds;
        if !self.operators.depends_on_speed() {
            let solution = self.solve(speeds[0])?;
            progress(speeds.len());
            return Ok(speeds.iter().map(|&speed| Solution { speed, ..solution.clone() }).collect());
        }
        speeds
            .par_iter()
            .map(|&speed| {
                let solution = self.solve(speed);
                progress(usize::from(self.settings.speeds.contains(&speed)));
                solution
            })
            .collect()
    }

    /// Largest relative difference of a reported frequency to the unreduced one at the highest speed, and
    /// a count of the frequencies below the last one there.
    pub(super) fn measured_error(
        &self,
        sweep: &[Solution],
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Result<Option<f64>> {
        let Some(last) = sweep.last() else { return Ok(None) };
        let (exact, imbalance) = self.unreduced(last.speed)?;
        if imbalance > DOUBTFUL_IMBALANCE {
            diagnostics.push(Diagnostic::warning(
                "unreduced-check",
                format!("the unreduced problem at the highest speed was solved to an imbalance of {imbalance:.1e} only"),
            ));
        }
        let count = self.settings.modes.min(last.oscillating).min(exact.oscillating);
        if self.operators.is_conservative() && !self.operators.is_implicit() && count > 0 {
            let (below, expected) = self.count(&exact, count, last.speed)?;
            if below != Some(expected) {
                diagnostics.push(Diagnostic::error(
                    "sturm-count-at-speed",
                    "at the highest speed an inertia count disagrees with the number of frequencies found",
                ));
            }
        }
        if self.settings.reduction.is_none() {
            return Ok(None);
        }
        // in the rotating frame a frequency near zero is one near the speed, seen from there
        let shift = if self.operators.is_rotating() { last.speed } else { 0.0 };
        let error = |i: usize| {
            let (ours, exact) = (last.motions[i].lambda.im, exact.motions[i].lambda.im);
            ((ours - exact) / exact.max(shift)).abs()
        };
        Ok(Some((0..count).map(error).fold(0.0, f64::max)))
    }

    /// Number of negative pivots of `K + i w Omega G - w^2 M` at a frequency w in the widest gap after the
    /// `count` lowest, and the number expected: what K itself has, and one more or less for each frequency
    /// passed on the way from zero, by the sign of its energy.
    pub(super) fn count(&self, exact: &Solution, count: usize, speed: f64) -> Result<(Option<usize>, usize)> {
        let frequency = |i: usize| exact.motions[i].lambda.im;
        let candidates =
            (count..(count + SPARE_BASIS).min(exact.oscillating)).filter(|&a| frequency(a - 1) > 0.0);
        let widest = candidates
            .max_by(|&a, &b| (frequency(a) / frequency(a - 1)).total_cmp(&(frequency(b) / frequency(b - 1))));
        let Some(at) = widest else { return Ok((Some(0), 0)) };
        let w = (frequency(at - 1) * frequency(at)).sqrt();
        let real = |v: f64| c64::new(v, 0.0);
        let stiffness = self.operators.stiffness_at(speed, c64::new(0.0, w));
        let mut terms = vec![(real(1.0), &stiffness), (real(-w * w), &self.operators.mass)];
        if let Some(g) = &self.operators.gyroscopic {
            terms.push((c64::new(0.0, w * speed), g));
        }
        let mut expected = at as isize;
        if self.operators.is_rotating() {
            let rigid = self.spectrum.flexibility.rigid.clone();
            let pinned = Flexibility::new(&stiffness, &self.operators.mass, rigid)?;
            // with growing motions left aside: they never pass a real frequency
            let passed = exact.motions[..at].iter().filter(|m| m.lambda.re == 0.0 && m.lambda.im > 0.0);
            let signs = passed.map(|m| if self.reduced.energy_sign(m, speed) { 1 } else { -1 });
            expected = pinned.unstable_directions() as isize + signs.sum::<isize>();
        }
        expected += self.reduced.zero_frequencies(speed)? as isize;
        let expected = usize::try_from(expected).unwrap_or(usize::MAX);
        Ok((Ldlt::new(&combine(&terms))?.negative_pivots(), expected))
    }
}
