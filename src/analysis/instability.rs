//! Ranges of speed in which a branch grows, their ends refined by bisection.

use super::campbell::{Solver, Tracked};
use super::reduced::{Solution, Whirling};
use super::state::AtSpeed;
use super::tracking::likeness;
use crate::error::Result;
use crate::results::UnstableRange;
use std::f64::consts::PI;

/// Relative width of the bracket of an end.
const END: f64 = 1e-7;
/// Steps of the search for the largest growth rate.
const SEARCH: usize = 24;

impl Solver<'_> {
    /// The unstable ranges of all branches followed, by ascending speed.
    ///
    /// # Errors
    /// When a speed can't be solved.
    pub fn unstable_ranges(&self, sweep: &[Solution], branches: &[Tracked]) -> Result<Vec<UnstableRange>> {
        let mut ranges = Vec::new();
        for tracked in branches {
            let motion = |k: usize| tracked.motions[k].map(|i| &sweep[k].motions[i]);
            let grows = |k: usize| motion(k).is_some_and(AtSpeed::grows);
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
                let (Some(first), Some(last)) = (motion(start), motion(k)) else { break };
                let from = match start.checked_sub(1) {
                    Some(before) => self.end(sweep[before].speed, sweep[start].speed, first)?,
                    None => sweep[start].speed,
                };
                let to = match sweep.get(k + 1) {
                    Some(after) => self.end(after.speed, sweep[k].speed, last)?,
                    None => sweep[k].speed,
                };
                let known = (start..=k).filter_map(motion).map(|m| m.lambda.re).fold(0.0, f64::max);
                let largest = self.largest_growth(
                    from,
                    to,
                    (start..=k).filter_map(|k| Some((sweep[k].speed, motion(k)?))),
                )?;
                ranges.push(UnstableRange {
                    from_rad_s: from,
                    to_rad_s: to,
                    from_rpm: from * 30.0 / PI,
                    to_rpm: to * 30.0 / PI,
                    branch: tracked.branch.name.clone(),
                    largest_growth_rate_1_s: largest.max(known),
                });
                k += 1;
            }
        }
        ranges.sort_by(|a, b| a.from_rad_s.total_cmp(&b.from_rad_s));
        Ok(ranges)
    }

    /// The motion at a speed that is most like another.
    fn alike(&self, speed: f64, motion: &Whirling) -> Result<Option<Whirling>> {
        let solution = self.solve(speed)?;
        let best = solution.motions.into_iter().map(|m| (likeness(&m, motion), m));
        Ok(best.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, m)| m))
    }

    /// Speed between a stable and an unstable one at which the motion begins to grow.
    fn end(&self, mut stable: f64, mut unstable: f64, motion: &Whirling) -> Result<f64> {
        let mut motion = motion.clone();
        while (unstable - stable).abs() > END * unstable {
            let middle = (stable + unstable) / 2.0;
            match self.alike(middle, &motion)?.filter(AtSpeed::grows) {
                Some(here) => (unstable, motion) = (middle, here),
                None => stable = middle,
            }
        }
        Ok((stable + unstable) / 2.0)
    }

    /// Largest growth rate between two speeds, by golden sections around the fastest known.
    fn largest_growth<'m>(
        &self,
        from: f64,
        to: f64,
        known: impl Iterator<Item = (f64, &'m Whirling)>,
    ) -> Result<f64> {
        let known: Vec<(f64, &Whirling)> = known.collect();
        let fastest = (0..known.len()).max_by(|&a, &b| known[a].1.lambda.re.total_cmp(&known[b].1.lambda.re));
        let Some(at) = fastest else { return Ok(0.0) };
        let mut low = if at > 0 { known[at - 1].0 } else { from };
        let mut high = known.get(at + 1).map_or(to, |k| k.0);
        let mut largest = known[at].1.lambda.re;
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
