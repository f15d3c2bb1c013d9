//! Whirl branches: which motions of the speeds belong together, what they are called, and in which sense they whirl.
//!
//! Branches start at standstill, wherever the sweep begins, so that names depend on neither of its ends. A motion that does
//! not oscillate there (overdamped, or rigid) has a branch too, which waits until an oscillation appears that no branch
//! accounts for. Source: docs/theory/linear-rotordynamics.md#overdamped.

use crate::analysis::campbell::branch_tracking::{Continuation, follow};
use crate::analysis::campbell::reduced_basis::{Solution, Whirling};
use crate::analysis::campbell::sweep::WhirlSolver;
use crate::analysis::character::Character;
use crate::error::Result;
use crate::model::SPARE_BASIS;
use crate::results::{Branch, Diagnostic, ModeKind, Whirl};
use faer::c64;
use std::f64::consts::TAU;

/// Circularity below which a whirl is mixed.
const LEAST_CIRCULARITY: f64 = 0.01;
/// Relative difference of frequencies at standstill that is none: their order is that of kinds and senses.
const SAME_FREQUENCY_RTOL: f64 = 1e-6;

/// A branch with the motions that it consists of, one for each speed.
pub(super) struct Tracked {
    pub branch: Branch,
    pub motions: Vec<Option<usize>>,
    /// Waves around the axis.
    pub waves: usize,
    /// Place among branches of equal frequency: which of its sense, and the sense.
    order: (usize, usize),
}

/// What a branch is at standstill.
#[derive(Clone, Copy, PartialEq)]
enum Origin {
    /// It oscillates: the motion.
    Oscillating(usize),
    /// It creeps: the slower of its two motions.
    Overdamped(usize),
    /// It is rigid, and whirls with the spin.
    Rigid,
}

/// A branch while it is followed.
struct Trail {
    origin: Origin,
    /// Frequency at standstill, rad/s; that of an overdamped motion without its damping.
    start: f64,
    /// The oscillating motion at each speed.
    places: Vec<Option<usize>>,
    /// Whether it creeps, at each speed.
    creeps: Vec<bool>,
    /// Where it was seen last: speed and motion; `None` while it creeps.
    seen: Option<(usize, usize)>,
    /// What it was like when it was seen last.
    last: Option<Whirling>,
}

impl Trail {
    fn waits(&self) -> bool {
        self.seen.is_none()
    }
}

/// Remarks on the way.
#[derive(Default)]
struct Remarks {
    extra: usize,
    unclear: Vec<(usize, f64)>,
}

impl WhirlSolver<'_> {
    /// Follows the lowest motions at standstill through all speeds.
    ///
    /// # Errors
    /// When an extra speed can't be solved.
    pub(super) fn track(
        &self,
        sweep: &[Solution],
        character: &Character<'_>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Result<Vec<Tracked>> {
        let Some(first) = sweep.first() else { return Ok(Vec::new()) };
        let mut remarks = Remarks::default();
        let mut trails = self.starts(sweep, &mut remarks)?;
        for k in 1..sweep.len() {
            let crept = self.continue_to(&mut trails, sweep, k, &mut remarks)?;
            if crept || sweep[k].oscillating != sweep[k - 1].oscillating {
                self.emerge(&mut trails, sweep, k, &mut remarks)?;
            }
        }
        remarks.tell(diagnostics);
        trails.sort_by(|a, b| a.start.total_cmp(&b.start));
        let mut branches: Vec<(f64, Tracked)> =
            trails.into_iter().map(|trail| (trail.start, self.tracked(trail, sweep, character))).collect();
        self.arrange(&mut branches, first);
        Ok(self.in_order(branches))
    }

    /// The branches by ascending frequency at the first speed asked for; where equal, as they are named.
    fn in_order(&self, branches: Vec<(f64, Tracked)>) -> Vec<Tracked> {
        let asked = self.first_asked();
        let mut list: Vec<(f64, usize, Tracked)> = branches
            .into_iter()
            .enumerate()
            .map(|(place, (start, tracked))| {
                let frequency = tracked.branch.frequency_rad_s.get(asked).copied().flatten();
                (frequency.unwrap_or(start), place, tracked)
            })
            .collect();
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        for equal in list.chunk_by_mut(|a, b| b.0 - a.0 <= SAME_FREQUENCY_RTOL * b.0) {
            equal.sort_by_key(|(_, place, _)| *place);
        }
        list.into_iter().map(|(_, _, tracked)| tracked).collect()
    }

    /// Index of the first speed asked for; before it there is at most standstill.
    fn first_asked(&self) -> usize {
        let first = self.settings.speeds.first().copied().unwrap_or(0.0);
        self.speeds.iter().position(|speed| *speed >= first).unwrap_or(0)
    }

    /// The lowest motions at standstill, those that are overdamped among them, and as many more as it takes to hold the lowest
    /// ones of the first speed asked for.
    fn starts(&self, sweep: &[Solution], remarks: &mut Remarks) -> Result<Vec<Trail>> {
        let (first, asked) = (&sweep[0], &sweep[self.first_asked()]);
        let few = self.settings.modes + SPARE_BASIS;
        let oscillating = (0..first.oscillating).filter(|&i| first.motions[i].lambda.im > 0.0);
        let mut starts: Vec<(f64, Origin)> =
            oscillating.map(|i| (first.motions[i].lambda.im, Origin::Oscillating(i))).collect();
        starts.extend(first.overdamped.iter().map(|o| (o.frequency, Origin::Overdamped(o.slow))));
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut count = few;
        if asked.speed > first.speed {
            let lowest: Vec<usize> = (0..asked.oscillating.min(few)).collect();
            let back = follow(&|speed| self.solve(speed), asked, first, &lowest)?;
            remarks.extra += back.extra;
            let place = |i: usize| starts.iter().position(|(_, origin)| *origin == Origin::Oscillating(i));
            count = back.to.into_iter().flatten().filter_map(place).map(|at| at + 1).fold(few, usize::max);
        }
        starts.truncate(count);
        let trail = |(start, origin): (f64, Origin)| {
            let place = if let Origin::Oscillating(i) = origin { Some(i) } else { None };
            Trail {
                origin,
                start,
                places: vec![place],
                creeps: vec![place.is_none()],
                seen: place.map(|i| (0, i)),
                last: match origin {
                    Origin::Oscillating(_) | Origin::Rigid => None,
                    Origin::Overdamped(slow) => first.motions.get(slow).cloned(),
                },
            }
        };
        Ok(starts.into_iter().map(trail).collect())
    }

    /// Continues every branch that oscillates to speed `k`; true when one of them is not found among the oscillating motions.
    fn continue_to(
        &self,
        trails: &mut [Trail],
        sweep: &[Solution],
        k: usize,
        remarks: &mut Remarks,
    ) -> Result<bool> {
        let to = &sweep[k];
        let mut found: Vec<Option<usize>> = vec![None; trails.len()];
        for from in 0..k {
            let here: Vec<(usize, usize)> = (0..trails.len())
                .filter_map(|b| trails[b].seen.filter(|seen| seen.0 == from).map(|seen| (b, seen.1)))
                .collect();
            if here.is_empty() {
                continue;
            }
            let followed: Vec<usize> = here.iter().map(|(_, motion)| *motion).collect();
            let Continuation { to: places, unclear, extra } =
                follow(&|speed| self.solve(speed), &sweep[from], to, &followed)?;
            remarks.extra += extra;
            for ((&(b, _), place), doubt) in here.iter().zip(places).zip(unclear) {
                found[b] = place.filter(|p| !found.contains(&Some(*p)));
                let creeps = found[b].is_some_and(|p| p >= to.oscillating);
                if doubt && !creeps && b < self.settings.modes {
                    remarks.unclear.push((b, to.speed));
                }
            }
        }
        let mut missing = false;
        for (trail, found) in trails.iter_mut().zip(found) {
            let oscillates = found.filter(|&p| p < to.oscillating);
            let creeps =
                trail.waits() && trail.origin != Origin::Rigid || found.is_some() && oscillates.is_none();
            missing |= oscillates.is_none();
            trail.places.push(oscillates);
            trail.creeps.push(creeps);
            if let (true, Some((from, place))) = (creeps, trail.seen) {
                trail.last = Some(sweep[from].motions[place].clone());
            }
            trail.seen = match oscillates {
                Some(place) => Some((k, place)),
                None if creeps => None,
                None => trail.seen,
            };
        }
        Ok(missing)
    }

    /// Gives the oscillations of speed `k` that no branch accounts for, and that did not exist at the speed before, to the
    /// branches that wait, or to a branch of their own where they are rigid.
    fn emerge(
        &self,
        trails: &mut Vec<Trail>,
        sweep: &[Solution],
        k: usize,
        remarks: &mut Remarks,
    ) -> Result<()> {
        let (before, to) = (&sweep[k - 1], &sweep[k]);
        let claimed: Vec<usize> = trails.iter().filter_map(|t| t.places[k]).collect();
        let highest = claimed.iter().map(|&i| to.motions[i].lambda.im).fold(0.0, f64::max);
        let few = self.settings.modes + SPARE_BASIS;
        let free: Vec<usize> = (0..to.oscillating)
            .filter(|i| !claimed.contains(i) && to.motions[*i].lambda.im > 0.0)
            .filter(|&i| to.motions[i].lambda.im <= highest || i < few)
            .collect();
        if free.is_empty() {
            return Ok(());
        }
        let back = follow(&|speed| self.solve(speed), to, before, &free)?;
        remarks.extra += back.extra;
        for ((&i, place), doubt) in free.iter().zip(back.to).zip(back.unclear) {
            let earlier = place.filter(|&p| p < before.oscillating && !doubt);
            if let Some(p) = earlier {
                // a branch that was lost on the way here, or a motion that came down from above
                if let Some(lost) =
                    trails.iter_mut().find(|t| t.places[k].is_none() && t.places[k - 1] == Some(p))
                {
                    (lost.places[k], lost.creeps[k], lost.seen) = (Some(i), false, Some((k, i)));
                }
                continue;
            }
            if self.reduced.is_rigid(&to.motions[i]) {
                let mut places = vec![None; k];
                places.push(Some(i));
                trails.push(Trail {
                    origin: Origin::Rigid,
                    start: 0.0,
                    places,
                    creeps: vec![false; k + 1],
                    seen: Some((k, i)),
                    last: None,
                });
                continue;
            }
            let likeness = |t: &Trail| t.last.as_ref().map_or(0.0, |m| self.overlap(m, &to.motions[i]));
            let waiting = (0..trails.len()).filter(|&t| trails[t].waits() && trails[t].places[k].is_none());
            // among equals the first
            let best = waiting
                .map(|t| (likeness(&trails[t]), t))
                .reduce(|a, b| if b.0 > a.0 * (1.0 + SAME_FREQUENCY_RTOL) { b } else { a });
            if let Some((_, t)) = best {
                (trails[t].places[k], trails[t].creeps[k], trails[t].seen) = (Some(i), false, Some((k, i)));
            }
        }
        Ok(())
    }

    /// Share of a shape in another: 1 for the same, a half for a plane in a circle.
    fn overlap(&self, a: &Whirling, b: &Whirling) -> f64 {
        let n = self.reduced.size();
        let (a, b) = (&a.right[..n], &b.right[..n]);
        let size = |v: &[c64]| v.iter().map(|v| v.norm_sqr()).sum::<f64>();
        let product: c64 = a.iter().zip(b).map(|(a, b)| a.conj() * b).sum();
        product.norm_sqr() / (size(a) * size(b))
    }

    /// The values of a branch.
    fn tracked(&self, trail: Trail, sweep: &[Solution], character: &Character<'_>) -> Tracked {
        let start = match trail.origin {
            Origin::Oscillating(i) | Origin::Overdamped(i) => sweep.first().map(|s| &s.motions[i]),
            Origin::Rigid => None,
        };
        let (kind, waves) = start.map_or((ModeKind::Rigid, 1), |m| self.kind(m, character));
        let motion = |k: usize| trail.places[k].map(|i| &sweep[k].motions[i]).filter(|m| m.lambda.im > 0.0);
        let all = || (0..sweep.len()).map(motion);
        let whirl =
            |k: usize| trail.places[k].map(|i| self.sense(&sweep[k].motions[i], sweep[k].speed, waves));
        let creeps = |k: &usize| trail.creeps[*k];
        let branch = Branch {
            name: String::new(),
            whirl: Whirl::None,
            whirl_at_speed: (0..sweep.len()).map(|k| whirl(k).unwrap_or(Whirl::None)).collect(),
            kind,
            overdamped: (0..sweep.len()).filter(creeps).map(|k| sweep[k].speed).collect(),
            frequency_rad_s: all().map(|m| m.map(|m| m.lambda.im)).collect(),
            log_decrement: all().map(|m| m.and_then(decrement)).collect(),
        };
        Tracked { branch, motions: trail.places, waves, order: (0, 0) }
    }

    /// Kind of a motion, and its waves around the axis.
    fn kind(&self, motion: &Whirling, character: &Character<'_>) -> (ModeKind, usize) {
        let shape = self.reduced.shapes(std::slice::from_ref(motion));
        let (_, kind, waves) = character.of(&shape.col(0).iter().copied().collect::<Vec<_>>());
        (kind, travelling_waves(kind, waves))
    }

    /// Sense of a motion as seen from space.
    pub(super) fn sense(&self, motion: &Whirling, speed: f64, waves: usize) -> Whirl {
        if waves == 0 {
            return Whirl::None;
        }
        sense(self.circularity(motion, speed, waves))
    }

    /// 1 for a pattern that travels with the spin, -1 for one that travels against it, as seen from space.
    fn circularity(&self, motion: &Whirling, speed: f64, waves: usize) -> f64 {
        let n = waves as f64;
        let seen = self.reduced.travel_of(motion) / n;
        if !self.operators.is_rotating() {
            return seen;
        }
        let (forward, backward) = ((1.0 + seen) / 2.0, (1.0 - seen) / 2.0);
        let (fast, slow) = (motion.lambda.im + n * speed, motion.lambda.im - n * speed);
        let size = fast * forward + slow.abs() * backward;
        if size > 0.0 { (fast * forward - slow * backward) / size } else { 0.0 }
    }

    /// Orders the branches by frequency, where frequencies are equal by kind, backward and forward in turn, and names them.
    fn arrange(&self, branches: &mut [(f64, Tracked)], first: &Solution) {
        let rotating = self.operators.is_rotating();
        let circularity = |tracked: &Tracked| {
            let motion = tracked.motions[0].map(|i| &first.motions[i]);
            motion
                .filter(|_| tracked.waves > 0)
                .map_or(0.0, |m| self.reduced.travel_of(m) / tracked.waves as f64)
        };
        let mut counts = SenseCounts::default();
        for equal in branches.chunk_by_mut(|a, b| b.0 - a.0 <= SAME_FREQUENCY_RTOL * b.0) {
            equal.sort_by_key(|(_, t)| (rank(t.branch.kind), t.waves));
            for alike in
                equal.chunk_by_mut(|a, b| a.1.branch.kind == b.1.branch.kind && a.1.waves == b.1.waves)
            {
                // the k-th backward one, then the k-th forward one
                let mut seen = [0, 0];
                for (_, tracked) in alike.iter_mut() {
                    let forward = usize::from(circularity(tracked) > 0.0);
                    seen[forward] += 1;
                    tracked.order = (seen[forward], forward);
                }
                alike.sort_by_key(|(_, tracked)| tracked.order);
                for i in 0..alike.len() {
                    let paired = |i: usize| circularity(&alike[i].1).abs() > 0.5;
                    let forward = (paired(i) && alike.len() > 1).then(|| circularity(&alike[i].1) > 0.0);
                    let name = counts.name(&alike[i].1.branch, forward, rotating);
                    alike[i].1.branch.name = name;
                }
            }
        }
        for (_, tracked) in branches {
            tracked.branch.whirl = mostly(&tracked.branch.whirl_at_speed);
        }
    }
}

impl Remarks {
    fn tell(self, diagnostics: &mut Vec<Diagnostic>) {
        if self.extra > 0 {
            diagnostics.push(Diagnostic::info(
                "refined-speeds",
                format!(
                    "{} extra speeds were solved between those of the sweep to follow the branches",
                    self.extra
                ),
            ));
        }
        if let Some(&(branch, speed)) = self.unclear.first() {
            diagnostics.push(Diagnostic::warning(
                "tracking-unclear",
                format!(
                    "the continuation of a branch stayed unclear at {} places, first branch {} near {speed:.6} rad/s",
                    self.unclear.len(),
                    branch + 1
                ),
            ));
        }
    }
}

/// How many branches of each kind have a name.
#[derive(Default)]
struct SenseCounts {
    bending: usize,
    torsion: usize,
    axial: usize,
    section: usize,
    rigid: usize,
    /// True after the first of a pair of section motions.
    half_pair: bool,
}

impl SenseCounts {
    /// "1B" and "1F" for the first bending pair: in order of frequency, or by their sense (`forward`) where frequencies at
    /// standstill are equal. Seen from the shaft, it is the forward one that falls. Else "T1", "A2", "S1", "S2b", "R1".
    fn name(&mut self, branch: &Branch, forward: Option<bool>, rotating: bool) -> String {
        let next = |count: &mut usize| {
            *count += 1;
            *count
        };
        match branch.kind {
            ModeKind::Bending => {
                let (number, second) = (1 + self.bending / 2, self.bending % 2 == 1);
                self.bending += 1;
                let letter = if forward.unwrap_or(second != rotating) { "F" } else { "B" };
                format!("{number}{letter}")
            }
            ModeKind::Torsion => format!("T{}", next(&mut self.torsion)),
            ModeKind::Axial => format!("A{}", next(&mut self.axial)),
            ModeKind::Rigid => format!("R{}", next(&mut self.rigid)),
            ModeKind::Section => {
                let second = forward.is_some() && self.half_pair;
                self.half_pair = forward.is_some() && !self.half_pair;
                let number = if second { self.section } else { next(&mut self.section) };
                match forward {
                    Some(forward) => format!("S{number}{}", if forward { "f" } else { "b" }),
                    None => format!("S{number}"),
                }
            }
        }
    }
}

/// Waves around the axis that may travel: one for bending, none for torsion and axial motion, whatever the section adds.
pub(super) fn travelling_waves(kind: ModeKind, waves: usize) -> usize {
    match kind {
        ModeKind::Torsion | ModeKind::Axial => 0,
        ModeKind::Bending | ModeKind::Rigid => 1,
        ModeKind::Section => waves,
    }
}

/// Sense of a circularity.
pub(super) fn sense(circularity: f64) -> Whirl {
    if circularity >= LEAST_CIRCULARITY {
        Whirl::Forward
    } else if circularity <= -LEAST_CIRCULARITY {
        Whirl::Backward
    } else {
        Whirl::Mixed
    }
}

/// The sense at most speeds, among equals the one at the highest of them.
pub(super) fn mostly(list: &[Whirl]) -> Whirl {
    let count = |whirl: Whirl| list.iter().filter(|w| **w == whirl).count();
    let (forward, backward) = (count(Whirl::Forward), count(Whirl::Backward));
    let last = list.iter().rev().copied().find(|w| matches!(w, Whirl::Forward | Whirl::Backward));
    match last {
        None => list.iter().copied().find(|w| *w == Whirl::Mixed).unwrap_or(Whirl::None),
        Some(_) if forward > backward => Whirl::Forward,
        Some(_) if backward > forward => Whirl::Backward,
        Some(last) => last,
    }
}

/// Logarithmic decrement; `None` where rounding hides its sign and more than rounding of the motion.
fn decrement(motion: &Whirling) -> Option<f64> {
    let of = |rate: f64| TAU * rate / motion.lambda.im;
    if motion.lambda.re.abs() > motion.noise {
        // rounding of an undamped motion's decay is no decay
        Some(of(-motion.lambda.re)).map(|d| if d.abs() < 1e-12 { 0.0 } else { d })
    } else {
        (of(motion.noise) < 1e-9).then_some(0.0)
    }
}

fn rank(kind: ModeKind) -> usize {
    match kind {
        ModeKind::Rigid => 0,
        ModeKind::Bending => 1,
        ModeKind::Torsion => 2,
        ModeKind::Axial => 3,
        ModeKind::Section => 4,
    }
}
