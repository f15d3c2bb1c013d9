//! Ranges of speed in which a motion grows, their ends refined, and the lowest of them.

use crate::analysis::campbell::branch_tracking::most_like;
use crate::analysis::campbell::branches::Tracked;
use crate::analysis::campbell::reduced_basis::{Solution, Whirling};
use crate::analysis::campbell::sweep::WhirlSolver;
use crate::error::Result;
use crate::results::{Diagnostic, ModeKind, UnstableRange};
use std::f64::consts::PI;

/// Relative width of the bracket of an end.
const END: f64 = 1e-7;
/// Steps of the search for the largest growth rate.
const SEARCH: usize = 24;
/// Error of the threshold, relative, above which it is not told.
const KNOWN: f64 = 1e-3;
/// Name of a range of motions that creep away.
pub(super) const NOT_OSCILLATING: &str = "not oscillating";
/// Name of a range of oscillations that no branch follows.
pub(super) const BEYOND: &str = "beyond the branches";

/// A motion that may grow, at every speed of the sweep.
type RootPath<'a> = Vec<Option<&'a Whirling>>;

impl WhirlSolver<'_> {
    /// The unstable ranges of all motions, by ascending speed: of the branches, and of what none of them follows.
    ///
    /// # Errors
    /// When a speed can't be solved.
    pub(super) fn unstable_ranges(
        &self,
        sweep: &[Solution],
        branches: &[Tracked],
    ) -> Result<Vec<UnstableRange>> {
        let mut ranges = Vec::new();
        for tracked in branches {
            let path = (0..sweep.len()).map(|k| tracked.motions[k].map(|i| &sweep[k].motions[i])).collect();
            self.ranges_along(&path, sweep, &tracked.branch.name, &mut ranges)?;
        }
        for (name, oscillates) in [(NOT_OSCILLATING, false), (BEYOND, true)] {
            let path = (0..sweep.len()).map(|k| {
                let claimed: Vec<usize> = branches.iter().filter_map(|t| t.motions[k]).collect();
                let free = (0..sweep[k].motions.len())
                    .filter(|i| !claimed.contains(i) && (*i < sweep[k].oscillating) == oscillates)
                    .map(|i| &sweep[k].motions[i])
                    .filter(|m| m.grows());
                free.max_by(|a, b| a.lambda.re.total_cmp(&b.lambda.re))
            });
            self.ranges_along(&path.collect(), sweep, name, &mut ranges)?;
        }
        ranges.sort_by(|a, b| a.from_rad_s.total_cmp(&b.from_rad_s));
        Ok(ranges)
    }

    fn ranges_along(
        &self,
        path: &RootPath<'_>,
        sweep: &[Solution],
        name: &str,
        ranges: &mut Vec<UnstableRange>,
    ) -> Result<()> {
        // standstill may be there only for the names
        let asked = self.settings.speeds.first().copied().unwrap_or(0.0);
        let grows = |k: usize| sweep[k].speed >= asked && path[k].is_some_and(Whirling::grows);
        let mut k = 0;
        while k < sweep.len() {
            if !grows(k) {
                k += 1;
                continue;
            }
            let start = k;
            while k + 1 < sweep.len() && grows(k + 1) {
                k += 1;
            }
            let (Some(first), Some(last)) = (path[start], path[k]) else { break };
            let from = match start.checked_sub(1).filter(|&before| sweep[before].speed >= asked) {
                Some(before) => self.end((sweep[before].speed, path[before]), (sweep[start].speed, first))?,
                None => sweep[start].speed,
            };
            let to = match sweep.get(k + 1) {
                Some(after) => self.end((after.speed, path[k + 1]), (sweep[k].speed, last))?,
                None => sweep[k].speed,
            };
            let known: Vec<(f64, &Whirling)> =
                (start..=k).filter_map(|k| Some((sweep[k].speed, path[k]?))).collect();
            ranges.push(UnstableRange {
                from_rad_s: from,
                to_rad_s: to,
                from_rpm: from * 30.0 / PI,
                to_rpm: to * 30.0 / PI,
                branch: name.to_owned(),
                largest_growth_rate_1_s: self.largest_growth((from, to), &known)?,
            });
            k += 1;
        }
        Ok(())
    }

    /// The lowest speed at which a motion grows; `None` where none does, or where rounding hides it, which is told.
    pub(super) fn threshold(
        &self,
        ranges: &[UnstableRange],
        sweep: &[Solution],
        branches: &[Tracked],
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let hidden = branches.iter().filter(|t| t.branch.kind == ModeKind::Bending).find_map(|tracked| {
            let motions: Vec<&Whirling> =
                (0..sweep.len()).filter_map(|k| tracked.motions[k].map(|i| &sweep[k].motions[i])).collect();
            let noise = motions.iter().map(|m| m.noise).fold(0.0, f64::max);
            let rate = motions.iter().map(|m| m.lambda.re.abs()).fold(0.0, f64::max);
            // what does not decay at all has nothing to hide
            let told = noise > KNOWN * rate
                && noise > 1e-9 * motions.iter().map(|m| m.lambda.norm()).fold(0.0, f64::max);
            told.then(|| (tracked.branch.name.clone(), rate, noise))
        });
        if let Some((name, rate, noise)) = hidden {
            diagnostics.push(Diagnostic::warning(
                "decay-rounded",
                format!(
                    "rounding of {noise:.1e} 1/s hides whether branch {name}, whose rate is {rate:.1e} 1/s at most, decays or \
                     grows: no stability threshold is given"
                ),
            ));
            return None;
        }
        ranges.first().map(|r| r.from_rad_s)
    }

    /// The motion at a speed that is most like another.
    fn alike(&self, speed: f64, motion: &Whirling) -> Result<Option<Whirling>> {
        Ok(most_like(&self.solve(speed)?, motion).cloned())
    }

    /// Speed between a stable and an unstable one at which the motion begins to grow: by false position where it decays on
    /// the stable side (with Illinois' halving), else by bisection.
    fn end(&self, stable: (f64, Option<&Whirling>), unstable: (f64, &Whirling)) -> Result<f64> {
        let (mut a, mut b) = (stable.0, unstable.0);
        let mut motion = unstable.1.clone();
        let mut rates = [stable.1.map_or(0.0, |m| m.lambda.re), motion.lambda.re];
        let mut last_grew: Option<bool> = None;
        while (b - a).abs() > END * b.abs().max(a.abs()) {
            let share = if rates[0] < 0.0 { rates[0] / (rates[0] - rates[1]) } else { 0.5 };
            // not nearer to an end than the bracket asked for
            let least = (0.5 * END * b.abs().max(a.abs()) / (b - a).abs()).min(0.5);
            let middle = a + (b - a) * share.clamp(least, 1.0 - least);
            let here = self.alike(middle, &motion)?;
            let rate = here.as_ref().map_or(0.0, |m| m.lambda.re);
            match here.filter(|m| if rates[0] < 0.0 { rate > 0.0 } else { m.grows() }) {
                Some(found) => {
                    if last_grew == Some(true) {
                        rates[0] /= 2.0;
                    }
                    (b, rates[1], motion, last_grew) = (middle, rate, found, Some(true));
                }
                None => {
                    if last_grew == Some(false) {
                        rates[1] /= 2.0;
                    }
                    (a, rates[0], last_grew) = (middle, if rates[0] < 0.0 { rate } else { 0.0 }, Some(false));
                }
            }
        }
        Ok((a + b) / 2.0)
    }

    /// Largest growth rate between two speeds, by golden sections around the fastest known; a rate that is largest at an end
    /// of the sweep is taken from there.
    fn largest_growth(&self, (from, to): (f64, f64), known: &[(f64, &Whirling)]) -> Result<f64> {
        let fastest = (0..known.len()).max_by(|&a, &b| known[a].1.lambda.re.total_cmp(&known[b].1.lambda.re));
        let Some(at) = fastest else { return Ok(0.0) };
        let mut largest = known[at].1.lambda.re;
        if (at + 1 == known.len() && known[at].0 == to) || (at == 0 && known[at].0 == from) {
            return Ok(largest);
        }
        let mut low = if at > 0 { known[at - 1].0 } else { from };
        let mut high = known.get(at + 1).map_or(to, |k| k.0);
        let mut rate = |speed: f64| -> Result<f64> {
            let growth = self.alike(speed, known[at].1)?.map_or(0.0, |m| m.lambda.re);
            largest = largest.max(growth);
            Ok(growth)
        };
        let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
        let (mut at_a, mut at_b) = (rate(a)?, rate(b)?);
        for _ in 0..SEARCH {
            if at_a > at_b {
                (high, b, at_b) = (b, a, at_a);
                a = high - golden * (high - low);
                at_a = rate(a)?;
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = low + golden * (high - low);
                at_b = rate(b)?;
            }
        }
        Ok(largest)
    }
}
