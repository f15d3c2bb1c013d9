//! Critical speeds: solved directly, compared with what the sweep shows, and named by their branches.

use crate::analysis::campbell::branch_tracking::{follow, most_like};
use crate::analysis::campbell::branches::{Tracked, sense, travelling_waves};
use crate::analysis::campbell::reduced_basis::{Solution, Whirling};
use crate::analysis::campbell::sweep::WhirlSolver;
use crate::analysis::campbell::synchronous::{self, Critical, Criticals};
use crate::analysis::character::Character;
use crate::error::Result;
use crate::results::{CriticalSpeed, Diagnostic, ModeKind, Whirl};
use std::f64::consts::PI;

/// Relative difference between a direct critical speed and a branch's crossing that calls for a remark.
const CROSSING_MISMATCH_RTOL: f64 = 1e-5;
/// Relative difference of two speeds that is none.
const SAME_SPEED_RTOL: f64 = 1e-8;
/// Imbalance of a critical motion that calls for a remark.
const IMBALANCE: f64 = 1e-3;

impl WhirlSolver<'_> {
    /// Critical speeds within the sweep, from the synchronous eigenproblem where it is defined, else from
    /// the branches' crossings with the 1x line.
    pub(super) fn critical_speeds(
        &self,
        criticals: Option<Criticals>,
        axisymmetric: bool,
        sweep: &[Solution],
        branches: &[Tracked],
        character: &Character<'_>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Result<Vec<CriticalSpeed>> {
        let Some(first) = self.settings.speeds.first().copied() else { return Ok(Vec::new()) };
        if self.settings.speeds.last().is_none_or(|last| *last == 0.0) {
            return Ok(Vec::new());
        }
        if let Some(found) = &criticals {
            doubts(found, diagnostics);
        }
        if self.operators.is_rotating() {
            let list = criticals.map_or_else(Vec::new, |c| c.list);
            return self.standing_criticals(list, axisymmetric, (sweep, branches), character, diagnostics);
        }
        let crossings = self.crossings(sweep, branches)?;
        let Some(criticals) = criticals else {
            let message = if self.settings.speeds.len() > 1 {
                "critical speeds are crossings of damped frequencies with 1x (damping or cross-coupling is present)"
            } else {
                "no critical speed is listed: with damping or cross-coupling they are crossings of the frequencies with 1x, which \
                 a single speed does not show; sweep `campbell.speeds` over a range"
            };
            diagnostics.push(Diagnostic::info("damped-criticals", message));
            return Ok(crossings
                .into_iter()
                .map(|c| critical_speed(c.speed, Some(&c), c.whirl, c.kind, true, None))
                .collect());
        };
        let mut open: Vec<Option<Crossing>> = crossings.into_iter().map(Some).collect();
        let mut result = Vec::new();
        for Critical { speed, shape } in criticals.list.into_iter().filter(|c| c.speed >= first) {
            let (_, kind, waves) = character.of(&shape);
            let whirl = match travelling_waves(kind, waves) {
                0 => Whirl::None,
                n => sense(synchronous::travel_of(self.operators, &shape) / n as f64),
            };
            let distance = |c: &Crossing| (c.speed / speed - 1.0).abs();
            // of crossings equally near, the one of the same sense
            let nearest = (0..open.len()).filter_map(|i| open[i].as_ref().map(|c| (i, c))).min_by(|a, b| {
                let rank = |c: &Crossing| (distance(c) > 1e-3, c.whirl != whirl, distance(c));
                let ((fa, wa, da), (fb, wb, db)) = (rank(a.1), rank(b.1));
                fa.cmp(&fb).then(wa.cmp(&wb)).then(da.total_cmp(&db))
            });
            let partner = match nearest {
                Some((i, c)) if distance(c) < 1e-3 => open[i].take(),
                _ => None,
            };
            let difference = partner.as_ref().map(|c| c.speed / speed - 1.0);
            if difference.is_some_and(|d| d.abs() > CROSSING_MISMATCH_RTOL)
                || partner.as_ref().is_some_and(|c| opposite(c.whirl, whirl))
            {
                diagnostics.push(Diagnostic::warning(
                    "critical-mismatch",
                    format!(
                        "the critical speed {speed:.6} rad/s and the crossing of its branch do not agree"
                    ),
                ));
            }
            result.push(critical_speed(speed, partner.as_ref(), whirl, kind, false, difference));
        }
        for left in open.into_iter().flatten() {
            diagnostics.push(Diagnostic::warning(
                "critical-mismatch",
                format!(
                    "branch {} crosses 1x at {:.6} rad/s without a critical speed there",
                    left.name, left.speed
                ),
            ));
        }
        self.count_nameless(&result, diagnostics);
        Ok(result)
    }

    fn count_nameless(&self, result: &[CriticalSpeed], diagnostics: &mut Vec<Diagnostic>) {
        let nameless = result.iter().filter(|c| c.branch.is_none()).count();
        if nameless > 0 {
            diagnostics.push(Diagnostic::info(
                "unnamed-criticals",
                format!(
                    "{nameless} critical speeds lie on branches beyond the {} reported",
                    self.settings.modes
                ),
            ));
        }
    }

    /// Critical speeds of the rotating frame, where they are motions that stand still: compared with the speeds at
    /// which the stiffness of the reduced model loses a direction, and named by the branch that comes to rest.
    fn standing_criticals(
        &self,
        list: Vec<Critical>,
        axisymmetric: bool,
        (sweep, branches): (&[Solution], &[Tracked]),
        character: &Character<'_>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Result<Vec<CriticalSpeed>> {
        if !self.operators.is_conservative() {
            diagnostics.push(Diagnostic::info(
                "undamped-criticals",
                "critical speeds in the rotating frame are those of the rotor without damping and cross-coupling",
            ));
        }
        let mut result: Vec<CriticalSpeed> = Vec::new();
        for (i, Critical { speed, shape }) in list.into_iter().enumerate() {
            // an axisymmetric rotor bends in either plane alike: one critical speed
            let again = |c: &CriticalSpeed| (c.speed_rad_s / speed - 1.0).abs() < 1e-8;
            if speed < self.settings.speeds[0] || (axisymmetric && result.last().is_some_and(again)) {
                continue;
            }
            let (_, kind, waves) = character.of(&shape);
            let difference = self.reduced_critical(i, speed)?.map(|found| found / speed - 1.0);
            if difference.is_none_or(|d| d.abs() > CROSSING_MISMATCH_RTOL) {
                diagnostics.push(Diagnostic::warning(
                    "critical-mismatch",
                    format!("the critical speed {speed:.6} rad/s and that of the reduced model do not agree"),
                ));
            }
            let partner = self.resting_branch(speed, sweep, branches)?.map(|at| Crossing {
                speed,
                name: branches[at].branch.name.clone(),
                whirl: Whirl::Forward,
                kind,
            });
            // it stands still on the shaft, so it travels with the spin
            let whirl = if travelling_waves(kind, waves) > 0 { Whirl::Forward } else { Whirl::None };
            result.push(critical_speed(speed, partner.as_ref(), whirl, kind, false, difference));
        }
        self.count_nameless(&result, diagnostics);
        Ok(result)
    }

    /// The speed near `guess` at which the reduced model gains its critical speed of index `i` (from 0).
    fn reduced_critical(&self, i: usize, guess: f64) -> Result<Option<f64>> {
        let (mut low, mut high) = (guess * (1.0 - 1e-3), guess * (1.0 + 1e-3));
        if self.reduced.criticals_below(low)? > i || self.reduced.criticals_below(high)? <= i {
            return Ok(None);
        }
        while high - low > 1e-10 * high {
            let middle = (low + high) / 2.0;
            if self.reduced.criticals_below(middle)? > i { high = middle } else { low = middle }
        }
        Ok(Some((low + high) / 2.0))
    }

    /// The branch whose motion comes to rest in the rotating frame at a critical speed.
    fn resting_branch(&self, speed: f64, sweep: &[Solution], branches: &[Tracked]) -> Result<Option<usize>> {
        let near = self.solve(speed * (1.0 - 1e-6))?;
        let slow = |m: &Whirling| m.lambda.norm();
        let Some(resting) = (0..near.motions.len())
            .min_by(|&a, &b| slow(&near.motions[a]).total_cmp(&slow(&near.motions[b])))
        else {
            return Ok(None);
        };
        let before = sweep.iter().rposition(|s| s.speed <= near.speed).unwrap_or(0);
        let alive: Vec<usize> =
            (0..branches.len()).filter(|&b| branches[b].motions[before].is_some()).collect();
        let followed: Vec<usize> = alive.iter().filter_map(|&b| branches[b].motions[before]).collect();
        let there = follow(&|speed| self.solve(speed), &sweep[before], &near, &followed)?;
        Ok(alive.into_iter().zip(there.to).find(|(_, to)| *to == Some(resting)).map(|(branch, _)| branch))
    }

    /// Speeds at which a branch's frequency equals the spin speed, ascending.
    fn crossings(&self, sweep: &[Solution], branches: &[Tracked]) -> Result<Vec<Crossing>> {
        let mut found: Vec<(usize, Crossing)> = Vec::new();
        for (place, tracked) in branches.iter().enumerate() {
            let excess: Vec<Option<f64>> = tracked
                .branch
                .frequency_rad_s
                .iter()
                .zip(sweep)
                .map(|(frequency, solution)| frequency.map(|f| f - solution.speed))
                .collect();
            for k in 1..sweep.len() {
                let (Some(a), Some(b)) = (excess[k - 1], excess[k]) else { continue };
                if (a > 0.0) == (b > 0.0) {
                    continue;
                }
                let Some(motion) = tracked.motions[k] else { continue };
                let (speed, motion) =
                    self.crossing([(sweep[k - 1].speed, a), (sweep[k].speed, b)], &sweep[k].motions[motion])?;
                if speed < self.settings.speeds[0] {
                    continue;
                }
                let crossing = Crossing {
                    speed,
                    name: tracked.branch.name.clone(),
                    whirl: self.sense(&motion, speed, tracked.waves),
                    kind: tracked.branch.kind,
                };
                found.push((place, crossing));
            }
        }
        found.sort_by(|a, b| a.1.speed.total_cmp(&b.1.speed));
        // what is equal up to rounding stands in the order of the branches
        for equal in found.chunk_by_mut(|a, b| b.1.speed / a.1.speed - 1.0 <= SAME_SPEED_RTOL) {
            equal.sort_by_key(|(place, _)| *place);
        }
        Ok(found.into_iter().map(|(_, crossing)| crossing).collect())
    }

    /// Root of frequency minus speed between two speeds, on the branch of `motion`, and the motion there.
    fn crossing(&self, bracket: [(f64, f64); 2], motion: &Whirling) -> Result<(f64, Whirling)> {
        let [(mut a, mut fa), (mut b, mut fb)] = bracket;
        let mut speed = b;
        let mut found = motion.clone();
        for _ in 0..30 {
            let next = (a * fb - b * fa) / (fb - fa);
            if (next - speed).abs() <= 1e-9 * next {
                return Ok((next, found));
            }
            speed = next;
            let solution = self.solve(speed)?;
            let Some(here) = most_like(&solution, motion) else { break };
            found = here.clone();
            let f = here.lambda.im - speed;
            if f == 0.0 {
                break;
            }
            if (f > 0.0) == (fa > 0.0) {
                (a, fa) = (speed, f);
            } else {
                (b, fb) = (speed, f);
            }
        }
        Ok((speed, found))
    }
}

/// A branch meeting the 1x line.
struct Crossing {
    speed: f64,
    name: String,
    whirl: Whirl,
    kind: ModeKind,
}

fn critical_speed(
    speed: f64,
    partner: Option<&Crossing>,
    whirl: Whirl,
    kind: ModeKind,
    damped: bool,
    crossing_difference: Option<f64>,
) -> CriticalSpeed {
    CriticalSpeed {
        speed_rad_s: speed,
        speed_rpm: speed * 30.0 / PI,
        branch: partner.map(|c| c.name.clone()),
        whirl,
        kind,
        damped,
        crossing_difference,
    }
}

fn opposite(a: Whirl, b: Whirl) -> bool {
    matches!((a, b), (Whirl::Forward, Whirl::Backward) | (Whirl::Backward, Whirl::Forward))
}

/// Says what critical speeds leave in doubt.
fn doubts(found: &Criticals, diagnostics: &mut Vec<Diagnostic>) {
    if !found.complete {
        diagnostics.push(Diagnostic::error(
            "critical-count",
            "the number of critical speeds found disagrees with the inertia count, or exceeds the limit of 200",
        ));
    }
    if found.imbalance > IMBALANCE {
        diagnostics.push(Diagnostic::warning(
            "critical-imbalance",
            format!(
                "a critical motion was solved to an imbalance of {:.1e} only; its speed errs by about the square",
                found.imbalance
            ),
        ));
    }
}
