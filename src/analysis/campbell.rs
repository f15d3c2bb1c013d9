//! `rotor campbell`: whirl frequencies over spin speed, and critical speeds.
//!
//! The frames and forms are those of [`super::operators`]. The sweep runs on a reduced basis whose error is
//! measured against the unreduced problem at the highest speed; critical speeds are solved directly and
//! cross-checked with the sweep. Source: docs/theory.md section 6.

use super::character::Character;
use super::critical::{self, Criticals};
use super::estimates::{refuse_dependent, refuse_tiny_bore};
use super::operators::Operators;
use super::reduced::{Reduced, Solution, Whirling};
use super::remarks::{describe_model, offset_remark, refusal, speed_remarks};
use super::spectrum::{Flexibility, Spectrum};
use super::stiffening::{Stiffening, burst};
use super::tracking::{Continuation, follow};
use super::{Outcome, ignored_input, model_remarks, summary};
use crate::assembly::Assembly;
use crate::error::{Error, Result};
use crate::linalg::factor::Ldlt;
use crate::linalg::sparse::combine;
use crate::model::{CampbellSettings, Form, Gyroscopic, Model, WhirlFrame};
use crate::results::{Branch, Campbell, Diagnostic, ModeKind, Reduction, Whirl};
use faer::c64;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Branches followed beyond those reported, to name the critical speeds they pass.
const SPARE: usize = 8;
/// Share of a circular orbit's angular momentum from which a motion counts as a whirl.
const WHIRLING: f64 = 1e-3;
/// Energy norm of the imbalance at which an unreduced motion counts as solved; its frequency's error is
/// the square.
const BALANCE: f64 = 1e-6;
/// Imbalance above which the check of the reduced model is in doubt.
const ACCEPTED: f64 = 1e-4;
/// Share of the basis used for static corrections.
const CORRECTED: f64 = 0.4;

/// Progress of a sweep: called with the number of speeds done.
pub type Progress<'a> = &'a (dyn Fn(usize) + Sync);

/// Sweeps the spin speed and solves for critical speeds.
///
/// # Errors
/// A rotor that the frame or the form does not fit, a shaft that bursts, or an eigenvalue solver that does not
/// converge.
pub fn campbell(
    model: &Model,
    settings: &CampbellSettings,
    progress: Progress<'_>,
) -> Result<Outcome<Campbell>> {
    let mut diagnostics = ignored_input(model);
    if let Some(refused) = refusal(model, settings) {
        return Err(Error::Usage(format!("{}; remedy: {}", refused.reason, refused.remedy)));
    }
    refuse_dependent(model)?;
    if settings.form == Form::Consistent && settings.speeds.iter().any(|s| *s > 0.0) {
        refuse_tiny_bore(model)?;
    }
    let assembly = Assembly::new(model);
    diagnostics.extend(model_remarks(model, &assembly));
    let basis = settings.reduction.unwrap_or(60).max(settings.modes + SPARE);
    let corrected = (CORRECTED * basis as f64).ceil() as usize;
    let spectrum = Spectrum::new(&assembly, basis - corrected)?;
    if !spectrum.complete {
        diagnostics.push(Diagnostic::error(
            "sturm-count",
            "a mode of the basis may be missing (Sturm count at rest)",
        ));
    }
    refuse_supports(&assembly, &spectrum, settings)?;
    let highest = settings.speeds.last().copied().unwrap_or(0.0);
    let stiffening = match settings.form {
        Form::Consistent if highest > 0.0 => Some(Stiffening::new(model, &spectrum, highest)?),
        _ => None,
    };
    let operators = Operators::new(&assembly, &spectrum, settings.frame, settings.gyroscopic, stiffening);
    refuse_burst(&operators, &spectrum, highest)?;
    let reduced = Reduced::new(&operators, &spectrum, basis - corrected, corrected)?;
    let criticals = if highest > 0.0 && (operators.is_conservative() || operators.is_rotating()) {
        Some(critical::critical_speeds(&operators, &spectrum, highest)?)
    } else {
        None
    };
    let speeds = speeds(settings, &operators, criticals.as_ref());
    let solver = Solver { operators: &operators, spectrum: &spectrum, reduced: &reduced, settings, speeds };

    let sweep = solver.sweep(progress)?;
    let mut branches = solver.track(&sweep, &mut diagnostics)?;
    let character = Character::new(&assembly)?;
    solver.describe(&sweep, &mut branches, &character)?;

    let axisymmetric = model.is_axisymmetric();
    let critical_speeds =
        solver.critical_speeds(criticals, axisymmetric, &sweep, &branches, &character, &mut diagnostics)?;
    let unstable_ranges = match settings.form {
        Form::Classical => None,
        Form::Consistent => Some(solver.unstable_ranges(&sweep, &branches)?),
    };
    let measured_error = solver.measured_error(&sweep, &mut diagnostics)?;
    offset_remark(model, settings, &mut diagnostics);
    speed_remarks(model, highest, &branches, unstable_ranges.as_deref(), &mut diagnostics);

    let mass = super::check::properties(model).mass();
    let mut model_summary = summary(model, assembly.size(), mass);
    describe_model(model, settings, &operators, &mut model_summary);
    let reported: Vec<Branch> =
        branches.into_iter().take(settings.modes).map(|t| solver.at_asked_speeds(t.branch)).collect();
    if reported.len() < settings.modes {
        diagnostics.push(Diagnostic::warning(
            "few-branches",
            format!("{} branches were asked for; the basis holds only {}", settings.modes, reported.len()),
        ));
    }
    let results = Campbell {
        frame: match settings.frame {
            WhirlFrame::Stationary => "stationary",
            WhirlFrame::Rotating => "rotating",
        },
        form: match settings.form {
            Form::Classical => "classical",
            Form::Consistent => "consistent",
        },
        gyroscopic: match settings.gyroscopic {
            Gyroscopic::All => "all",
            Gyroscopic::Disks => "disks",
            Gyroscopic::None => "none",
        },
        speeds_rad_s: settings.speeds.clone(),
        branches: reported,
        critical_speeds,
        orders: settings.orders.clone(),
        unstable_ranges,
        reduction: Reduction {
            basis: settings.reduction.map(|_| reduced.size()),
            measured_error,
            stiffening_error: operators.stiffening.as_ref().map(|s| s.error),
        },
    };
    Ok(Outcome { results, model: model_summary, diagnostics })
}

/// Supports whose spinning rotor has no steady state to linearise about.
fn refuse_supports(assembly: &Assembly<'_>, spectrum: &Spectrum, settings: &CampbellSettings) -> Result<()> {
    let rigid =
        |axes: &[&str]| spectrum.rigid_names.iter().find(|n| axes.iter().any(|axis| n.contains(axis)));
    let across = ["along y", "along z", "about y", "about z"];
    if let (WhirlFrame::Rotating, Some(motion)) = (settings.frame, rigid(&across)) {
        return Err(Error::Usage(format!(
            "the rotating frame needs a rotor that is held across its axis, but nothing resists {motion}; remedy: add \
             bearings, or take \"frame\": \"stationary\""
        )));
    }
    if settings.form == Form::Consistent && rigid(&["about x"]).is_some() && assembly.holds_stretch_one_way()
    {
        return Err(Error::Usage(
            "a support holds the stretch of a section in a direction fixed in space while the shaft is free to turn: \
             spinning, it would press against that support unevenly; remedy: a support of a kind (revolute, \
             cylindrical, pinned, roller, bearing), one that holds all in-plane components alike, or \"form\": \"classical\""
                .to_owned(),
        ));
    }
    Ok(())
}

/// In the stationary frame a stiffness that is not positive any more is the end of the shaft.
fn refuse_burst(operators: &Operators, spectrum: &Spectrum, highest: f64) -> Result<()> {
    if operators.stiffening.is_none() || operators.is_rotating() {
        return Ok(());
    }
    let holds = |speed: f64| -> Result<bool> {
        let rigid = spectrum.flexibility.rigid.clone();
        let k = Flexibility::new(&operators.stiffness_at(speed), &operators.mass, rigid)?;
        Ok(k.unstable_directions() == 0)
    };
    if holds(highest)? {
        return Ok(());
    }
    let (mut low, mut high) = (0.0, highest);
    for _ in 0..20 {
        let middle = (low + high) / 2.0;
        if holds(middle)? { low = middle } else { high = middle }
    }
    Err(burst(low, "K_T - Omega^2 N, which is no longer positive definite"))
}

/// The speeds asked for and, in the rotating frame, one between neighbouring critical speeds that have none:
/// a rotor may be unstable there.
fn speeds(settings: &CampbellSettings, operators: &Operators, criticals: Option<&Criticals>) -> Vec<f64> {
    let mut speeds = settings.speeds.clone();
    if let (true, Some(criticals), [first, .., last]) =
        (operators.is_rotating(), criticals, &settings.speeds[..])
    {
        for pair in criticals.list.windows(2) {
            let (a, b) = (pair[0].speed, pair[1].speed);
            let inside = |s: f64| a < s && s < b;
            let middle = (a + b) / 2.0;
            if b > a * (1.0 + 1e-8)
                && *first < middle
                && middle < *last
                && !settings.speeds.iter().any(|s| inside(*s))
            {
                speeds.push(middle);
            }
        }
        speeds.sort_by(f64::total_cmp);
    }
    speeds
}

/// A branch with the motions that it consists of, one for each speed.
pub(super) struct Tracked {
    pub branch: Branch,
    pub motions: Vec<Option<usize>>,
}

pub(super) struct Solver<'a> {
    pub operators: &'a Operators,
    pub spectrum: &'a Spectrum,
    pub reduced: &'a Reduced,
    pub settings: &'a CampbellSettings,
    /// Speeds of the sweep, those asked for among them.
    pub speeds: Vec<f64>,
}

impl Solver<'_> {
    /// Motions at one speed, reduced or corrected until they satisfy the unreduced equations.
    pub fn solve(&self, speed: f64) -> Result<Solution> {
        match self.settings.reduction {
            Some(_) => self.reduced.solve(speed),
            None => Ok(self.unreduced(speed)?.0),
        }
    }

    /// Extends the basis by static answers to the imbalance of the motions until it is below
    /// [`BALANCE`]; also returns the imbalance that remains.
    fn unreduced(&self, speed: f64) -> Result<(Solution, f64)> {
        let wanted = self.settings.modes + SPARE;
        let mut solution = self.reduced.solve(speed)?;
        let mut refined: Option<Reduced> = None;
        let mut before: Option<(Solution, Option<Reduced>)> = None;
        let mut imbalance = f64::INFINITY;
        for _ in 0..6 {
            let current = refined.as_ref().unwrap_or(self.reduced);
            let targets: Vec<Whirling> = solution.motions.iter().take(wanted).cloned().collect();
            let (next, left) = current.refined(self.operators, self.spectrum, speed, &targets)?;
            // what no longer shrinks is rounding, and corrections of it would be noise in the basis
            let stalled = left > imbalance / 2.0 && left <= ACCEPTED;
            if let (true, Some(before)) = (stalled && left > imbalance, before.take()) {
                (solution, refined) = before;
            } else {
                imbalance = left;
            }
            if stalled || imbalance <= BALANCE {
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
    fn sweep(&self, progress: Progress<'_>) -> Result<Vec<Solution>> {
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

    /// Follows the lowest motions of the first speed through all others.
    fn track(&self, sweep: &[Solution], diagnostics: &mut Vec<Diagnostic>) -> Result<Vec<Tracked>> {
        let Some(first) = sweep.first() else { return Ok(Vec::new()) };
        let starts: Vec<usize> = (0..first.motions.len())
            .filter(|&i| first.motions[i].lambda.im > 0.0)
            .take(self.settings.modes + SPARE)
            .collect();
        let count = starts.len();
        let mut places: Vec<Vec<Option<usize>>> = starts.iter().map(|&i| vec![Some(i)]).collect();
        // where each branch was seen last: (speed index, motion)
        let mut seen: Vec<(usize, usize)> = starts.iter().map(|&i| (0, i)).collect();
        let mut extra = 0;
        let mut unclear: Vec<(usize, f64)> = Vec::new();
        for (k, to) in sweep.iter().enumerate().skip(1) {
            let mut found: Vec<Option<usize>> = vec![None; count];
            for from in 0..k {
                let here: Vec<usize> = (0..count).filter(|&b| seen[b].0 == from).collect();
                if here.is_empty() {
                    continue;
                }
                let followed: Vec<usize> = here.iter().map(|&b| seen[b].1).collect();
                let Continuation { to: places, unclear: doubts, extra: more } =
                    follow(&|speed| self.solve(speed), &sweep[from], to, &followed)?;
                extra += more;
                for ((&b, place), doubt) in here.iter().zip(places).zip(doubts) {
                    found[b] = place.filter(|p| !found.contains(&Some(*p)));
                    if doubt && b < self.settings.modes {
                        unclear.push((b, to.speed));
                    }
                }
            }
            for b in 0..count {
                places[b].push(found[b]);
                if let Some(place) = found[b] {
                    seen[b] = (k, place);
                }
            }
        }
        if extra > 0 {
            diagnostics.push(Diagnostic::info(
                "refined-speeds",
                format!("{extra} extra speeds were solved between those of the sweep to follow the branches"),
            ));
        }
        if let Some(&(branch, speed)) = unclear.first() {
            diagnostics.push(Diagnostic::warning(
                "tracking-unclear",
                format!(
                    "the continuation of a branch stayed unclear at {} places, first branch {} near {:.6} rad/s",
                    unclear.len(),
                    branch + 1,
                    speed
                ),
            ));
        }
        Ok(places
            .into_iter()
            .map(|motions| {
                let motion =
                    |k: usize| motions[k].map(|i| &sweep[k].motions[i]).filter(|m| m.lambda.im > 0.0);
                let branch = Branch {
                    name: String::new(),
                    whirl: Whirl::None,
                    kind: ModeKind::Section,
                    frequency_rad_s: (0..sweep.len()).map(|k| motion(k).map(|m| m.lambda.im)).collect(),
                    log_decrement: (0..sweep.len())
                        .map(|k| motion(k).map(|m| clean_zero(-TAU * m.lambda.re / m.lambda.im)))
                        .collect(),
                };
                Tracked { branch, motions }
            })
            .collect())
    }

    /// Kind, whirl sense and name of each branch.
    fn describe(
        &self,
        sweep: &[Solution],
        branches: &mut [Tracked],
        character: &Character<'_>,
    ) -> Result<()> {
        for tracked in branches.iter_mut() {
            if let Some(i) = tracked.motions[0] {
                tracked.branch.kind = self.kind(&sweep[0].motions[i], character);
            }
            let kind = tracked.branch.kind;
            let moments: Vec<f64> = tracked
                .motions
                .iter()
                .zip(sweep)
                .filter_map(|(place, solution)| {
                    place.map(|i| self.momentum(&solution.motions[i], solution.speed, kind))
                })
                .collect();
            // seen from the shaft, branches that veer change their sense: what they mostly do counts
            let mean = moments.iter().sum::<f64>() / moments.len().max(1) as f64;
            let strongest =
                moments.iter().copied().fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m });
            let momentum = if self.operators.is_rotating() { mean } else { strongest };
            tracked.branch.whirl = sense(momentum, tracked.branch.kind);
        }
        let mut counts: Vec<(ModeKind, Whirl, usize)> = Vec::new();
        for tracked in branches.iter_mut() {
            let (kind, whirl) = (tracked.branch.kind, tracked.branch.whirl);
            let number = match counts.iter_mut().find(|c| (c.0, c.1) == (kind, whirl)) {
                Some(entry) => {
                    entry.2 += 1;
                    entry.2
                }
                None => {
                    counts.push((kind, whirl, 1));
                    1
                }
            };
            tracked.branch.name = name(kind, whirl, number);
        }
        Ok(())
    }

    /// Angular momentum of a motion about x as seen from the stationary frame, over that of circular orbits of
    /// the same size, in [-1, 1].
    fn momentum(&self, motion: &Whirling, speed: f64, kind: ModeKind) -> f64 {
        let momentum = self.reduced.momentum(motion);
        if !self.operators.is_rotating() || kind != ModeKind::Bending {
            return momentum;
        }
        let (forward, backward) = ((1.0 + momentum) / 2.0, (1.0 - momentum) / 2.0);
        let (fast, slow) = (motion.lambda.im + speed, motion.lambda.im - speed);
        let size = fast * forward + slow.abs() * backward;
        if size > 0.0 { (fast * forward - slow * backward) / size } else { 0.0 }
    }

    /// The values of a branch at the speeds asked for.
    fn at_asked_speeds(&self, branch: Branch) -> Branch {
        let keep = |list: &[Option<f64>]| -> Vec<Option<f64>> {
            let asked = |speed: &f64| self.settings.speeds.contains(speed);
            list.iter().zip(&self.speeds).filter(|(_, speed)| asked(speed)).map(|(v, _)| *v).collect()
        };
        Branch {
            frequency_rad_s: keep(&branch.frequency_rad_s),
            log_decrement: keep(&branch.log_decrement),
            ..branch
        }
    }

    fn kind(&self, motion: &Whirling, character: &Character<'_>) -> ModeKind {
        let shape = self.reduced.shapes(std::slice::from_ref(motion));
        character.of(&shape.col(0).iter().copied().collect::<Vec<_>>()).1
    }

    /// Largest relative difference of a reported frequency to the unreduced one at the highest speed, and
    /// a count of the frequencies below the last one there.
    fn measured_error(&self, sweep: &[Solution], diagnostics: &mut Vec<Diagnostic>) -> Result<Option<f64>> {
        let Some(last) = sweep.last() else { return Ok(None) };
        let (exact, imbalance) = self.unreduced(last.speed)?;
        if imbalance > ACCEPTED {
            diagnostics.push(Diagnostic::warning(
                "unreduced-check",
                format!("the unreduced problem at the highest speed was solved to an imbalance of {imbalance:.1e} only"),
            ));
        }
        let count = self.settings.modes.min(last.motions.len()).min(exact.motions.len());
        if self.operators.is_conservative() && count > 0 {
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
    fn count(&self, exact: &Solution, count: usize, speed: f64) -> Result<(Option<usize>, usize)> {
        let frequency = |i: usize| exact.motions[i].lambda.im;
        let candidates =
            (count..(count + SPARE).min(exact.motions.len())).filter(|&a| frequency(a - 1) > 0.0);
        let widest = candidates
            .max_by(|&a, &b| (frequency(a) / frequency(a - 1)).total_cmp(&(frequency(b) / frequency(b - 1))));
        let Some(at) = widest else { return Ok((Some(0), 0)) };
        let w = (frequency(at - 1) * frequency(at)).sqrt();
        let real = |v: f64| c64::new(v, 0.0);
        let stiffness = self.operators.stiffness_at(speed);
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

/// Sense of the orbit; torsional and axial motions have none (spin couples them to breathing of the
/// section, which carries some angular momentum).
pub(super) fn sense(momentum: f64, kind: ModeKind) -> Whirl {
    if matches!(kind, ModeKind::Torsion | ModeKind::Axial) {
        Whirl::None
    } else if momentum > WHIRLING {
        Whirl::Forward
    } else if momentum < -WHIRLING {
        Whirl::Backward
    } else {
        Whirl::None
    }
}

/// "1F", "2B" for bending, else "T1", "A2", "S1f".
fn name(kind: ModeKind, whirl: Whirl, number: usize) -> String {
    let (sense, small) = match whirl {
        Whirl::Forward => ("F", "f"),
        Whirl::Backward => ("B", "b"),
        Whirl::None => ("P", ""),
    };
    match kind {
        ModeKind::Bending => format!("{number}{sense}"),
        ModeKind::Torsion => format!("T{number}{small}"),
        ModeKind::Axial => format!("A{number}{small}"),
        ModeKind::Section => format!("S{number}{small}"),
        ModeKind::Rigid => format!("R{number}{small}"),
    }
}

/// Rounding of an undamped motion's decay is no decay.
fn clean_zero(value: f64) -> f64 {
    if value.abs() < 1e-12 { 0.0 } else { value }
}
