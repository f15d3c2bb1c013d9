//! `rotor campbell`: whirl frequencies over spin speed, and critical speeds.
//!
//! Stationary frame, classical form (docs/theory.md section 6), axisymmetric rotors on any linear
//! bearings. The sweep runs on a reduced basis whose error is measured against the unreduced problem at
//! the highest speed; critical speeds are solved directly and cross-checked with the sweep.

use super::character::Character;
use super::critical::{self, Critical};
use super::reduced::{Operators, Reduced, Solution, Whirling};
use super::spectrum::Spectrum;
use super::tracking::{Continuation, follow, likeness};
use super::{Outcome, ignored_input, summary};
use crate::assembly::Assembly;
use crate::error::{Error, Result};
use crate::linalg::factor::Ldlt;
use crate::linalg::sparse::combine;
use crate::model::{CampbellSettings, Gyroscopic, Model};
use crate::results::{Branch, Campbell, CriticalSpeed, Diagnostic, ModeKind, Reduction, Whirl};
use faer::c64;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Branches followed beyond those reported, to name the critical speeds they pass.
const SPARE: usize = 8;
/// Share of a circular orbit's angular momentum from which a motion counts as a whirl.
const WHIRLING: f64 = 1e-3;
/// Relative difference between a direct critical speed and a branch's crossing that calls for a remark.
const MISMATCH: f64 = 1e-5;
/// Energy norm of the imbalance at which an unreduced motion counts as solved; its frequency's error is
/// the square.
const BALANCE: f64 = 1e-6;
/// Share of the basis used for static corrections.
const CORRECTED: f64 = 0.4;

/// Progress of a sweep: called with the number of speeds done.
pub type Progress<'a> = &'a (dyn Fn(usize) + Sync);

/// Sweeps the spin speed and solves for critical speeds.
///
/// # Errors
/// A section that is not axisymmetric at speed, or an eigenvalue solver that does not converge.
pub fn campbell(
    model: &Model,
    settings: &CampbellSettings,
    progress: Progress<'_>,
) -> Result<Outcome<Campbell>> {
    let mut diagnostics = ignored_input(model);
    refuse_asymmetric(model, settings)?;
    let assembly = Assembly::new(model);
    let basis = settings.reduction.unwrap_or(60).max(settings.modes + SPARE);
    let corrected = (CORRECTED * basis as f64).ceil() as usize;
    let spectrum = Spectrum::new(&assembly, basis - corrected)?;
    if !spectrum.complete {
        diagnostics.push(Diagnostic::error(
            "sturm-count",
            "a mode of the basis may be missing (Sturm count at rest)",
        ));
    }
    let operators = Operators::new(&assembly, &spectrum, settings.gyroscopic);
    let reduced = Reduced::new(&operators, &spectrum, basis - corrected, corrected)?;
    let solver = Solver { operators: &operators, spectrum: &spectrum, reduced: &reduced, settings };

    let sweep = solver.sweep(progress)?;
    let mut branches = solver.track(&sweep, &mut diagnostics)?;
    let character = Character::new(&assembly)?;
    solver.describe(&sweep, &mut branches, &character)?;

    let highest = settings.speeds.last().copied().unwrap_or(0.0);
    let critical_speeds = solver.critical_speeds(&sweep, &branches, &character, &mut diagnostics)?;
    let measured_error = solver.measured_error(&sweep, &mut diagnostics)?;
    offset_remark(model, &mut diagnostics);
    speed_remarks(model, highest, &branches, &mut diagnostics);

    let mass = super::check::properties(model).mass();
    let mut model_summary = summary(model, assembly.size(), mass);
    describe_model(model, settings, &operators, &mut model_summary);
    let reported: Vec<Branch> = branches.into_iter().take(settings.modes).map(|t| t.branch).collect();
    if reported.len() < settings.modes {
        diagnostics.push(Diagnostic::warning(
            "few-branches",
            format!("{} branches were asked for; the basis holds only {}", settings.modes, reported.len()),
        ));
    }
    let results = Campbell {
        frame: "stationary",
        form: "classical",
        gyroscopic: match settings.gyroscopic {
            Gyroscopic::All => "all",
            Gyroscopic::Disks => "disks",
            Gyroscopic::None => "none",
        },
        speeds_rad_s: settings.speeds.clone(),
        branches: reported,
        critical_speeds,
        orders: settings.orders.clone(),
        reduction: Reduction { basis: settings.reduction.map(|_| reduced.size()), measured_error },
    };
    Ok(Outcome { results, model: model_summary, diagnostics })
}

/// The frequencies of other sections change with the angle they stand at.
fn refuse_asymmetric(model: &Model, settings: &CampbellSettings) -> Result<()> {
    let spins = settings.speeds.iter().any(|s| *s > 0.0) && settings.gyroscopic != Gyroscopic::None;
    if spins && model.sections.iter().any(|s| !s.is_axisymmetric()) {
        return Err(Error::Usage(
            "a section is not axisymmetric (ellipse or rectangle): seen from the stationary frame its stiffness changes \
             with the angle, and the rotating frame that such a rotor needs is not part of this version"
                .to_owned(),
        ));
    }
    Ok(())
}

/// A branch with the motions that it consists of, one for each speed.
struct Tracked {
    branch: Branch,
    motions: Vec<Option<usize>>,
}

struct Solver<'a> {
    operators: &'a Operators,
    spectrum: &'a Spectrum,
    reduced: &'a Reduced,
    settings: &'a CampbellSettings,
}

impl Solver<'_> {
    /// Motions at one speed, reduced or corrected until they satisfy the unreduced equations.
    fn solve(&self, speed: f64) -> Result<Solution> {
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
        let mut imbalance = f64::INFINITY;
        for _ in 0..6 {
            let current = refined.as_ref().unwrap_or(self.reduced);
            let targets: Vec<Whirling> = solution.motions.iter().take(wanted).cloned().collect();
            let (next, left) = current.refined(self.operators, self.spectrum, speed, &targets)?;
            imbalance = left;
            if imbalance <= BALANCE {
                break;
            }
            solution = next.solve(speed)?;
            refined = Some(next);
        }
        // back to the common basis, so that motions of different speeds can be compared
        if let Some(refined) = &refined {
            solution = refined.onto(self.reduced, self.operators, solution);
        }
        Ok((solution, imbalance))
    }

    /// The motions at every speed.
    fn sweep(&self, progress: Progress<'_>) -> Result<Vec<Solution>> {
        let speeds = &self.settings.speeds;
        if !self.operators.depends_on_speed() {
            let solution = self.solve(speeds[0])?;
            progress(speeds.len());
            return Ok(speeds.iter().map(|&speed| Solution { speed, ..solution.clone() }).collect());
        }
        speeds
            .par_iter()
            .map(|&speed| {
                let solution = self.solve(speed);
                progress(1);
                solution
            })
            .collect()
    }

    /// Follows the lowest motions of the first speed through all others.
    fn track(&self, sweep: &[Solution], diagnostics: &mut Vec<Diagnostic>) -> Result<Vec<Tracked>> {
        let Some(first) = sweep.first() else { return Ok(Vec::new()) };
        let count = (self.settings.modes + SPARE).min(first.motions.len());
        let mut places: Vec<Vec<Option<usize>>> = (0..count).map(|i| vec![Some(i)]).collect();
        // where each branch was seen last: (speed index, motion)
        let mut seen: Vec<(usize, usize)> = (0..count).map(|i| (0, i)).collect();
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
                let motion = |k: usize| motions[k].map(|i| &sweep[k].motions[i]);
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
            let moments: Vec<f64> = tracked
                .motions
                .iter()
                .zip(sweep)
                .filter_map(|(place, solution)| place.map(|i| self.reduced.momentum(&solution.motions[i])))
                .collect();
            if let Some(i) = tracked.motions[0] {
                tracked.branch.kind = self.kind(&sweep[0].motions[i], character);
            }
            let strongest =
                moments.iter().copied().fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m });
            tracked.branch.whirl = sense(strongest, tracked.branch.kind);
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

    fn kind(&self, motion: &Whirling, character: &Character<'_>) -> ModeKind {
        let shape = self.reduced.shapes(std::slice::from_ref(motion));
        character.of(&shape.col(0).iter().copied().collect::<Vec<_>>()).1
    }

    /// Critical speeds within the sweep, from the synchronous eigenproblem where it is defined, else from
    /// the branches' crossings with the 1x line.
    fn critical_speeds(
        &self,
        sweep: &[Solution],
        branches: &[Tracked],
        character: &Character<'_>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Result<Vec<CriticalSpeed>> {
        let (Some(first), Some(last)) = (self.settings.speeds.first(), self.settings.speeds.last()) else {
            return Ok(Vec::new());
        };
        if *last == 0.0 {
            return Ok(Vec::new());
        }
        let crossings = self.crossings(sweep, branches)?;
        if !self.operators.is_conservative() {
            diagnostics.push(Diagnostic::info(
                "damped-criticals",
                "critical speeds are crossings of damped frequencies with 1x (damping or cross-coupling is present)",
            ));
            return Ok(crossings
                .into_iter()
                .map(|c| critical_speed(c.speed, Some(&c), c.whirl, c.kind, true, None))
                .collect());
        }
        let (criticals, agrees) = critical::critical_speeds(self.operators, self.spectrum, *last)?;
        if !agrees {
            diagnostics.push(Diagnostic::error(
                "critical-count",
                "the number of critical speeds found disagrees with the inertia count, or exceeds the limit of 200",
            ));
        }
        let mut open: Vec<Option<Crossing>> = crossings.into_iter().map(Some).collect();
        let mut result = Vec::new();
        for Critical { speed, shape } in criticals.into_iter().filter(|c| c.speed >= *first) {
            let (_, kind, _) = character.of(&shape);
            let whirl = sense(critical::momentum(self.operators, &shape), kind);
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
            if difference.is_some_and(|d| d.abs() > MISMATCH)
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
        Ok(result)
    }

    /// Speeds at which a branch's frequency equals the spin speed, ascending.
    fn crossings(&self, sweep: &[Solution], branches: &[Tracked]) -> Result<Vec<Crossing>> {
        let mut found = Vec::new();
        for tracked in branches {
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
                let Some(place) = tracked.motions[k] else { continue };
                let speed =
                    self.crossing([(sweep[k - 1].speed, a), (sweep[k].speed, b)], &sweep[k].motions[place])?;
                found.push(Crossing {
                    speed,
                    name: tracked.branch.name.clone(),
                    whirl: tracked.branch.whirl,
                    kind: tracked.branch.kind,
                });
            }
        }
        found.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        Ok(found)
    }

    /// Root of frequency minus speed between two speeds, on the branch of `motion`.
    fn crossing(&self, bracket: [(f64, f64); 2], motion: &Whirling) -> Result<f64> {
        let [(mut a, mut fa), (mut b, mut fb)] = bracket;
        let mut speed = b;
        for _ in 0..30 {
            let next = (a * fb - b * fa) / (fb - fa);
            if (next - speed).abs() <= 1e-9 * next {
                return Ok(next);
            }
            speed = next;
            let solution = self.solve(speed)?;
            let alike = |m: &Whirling| likeness(m, motion);
            let Some(here) = solution.motions.iter().max_by(|p, q| alike(p).total_cmp(&alike(q))) else {
                break;
            };
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
        Ok(speed)
    }

    /// Largest relative difference of a reported frequency to the unreduced one at the highest speed, and
    /// a count of the frequencies below the last one there.
    fn measured_error(&self, sweep: &[Solution], diagnostics: &mut Vec<Diagnostic>) -> Result<Option<f64>> {
        let Some(last) = sweep.last() else { return Ok(None) };
        let (exact, imbalance) = self.unreduced(last.speed)?;
        if imbalance > BALANCE {
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
        let error = (0..count)
            .map(|i| (last.motions[i].lambda.im / exact.motions[i].lambda.im - 1.0).abs())
            .fold(0.0, f64::max);
        Ok(Some(error))
    }

    /// Number of negative pivots of `K + i w Omega G - w^2 M` at a frequency w in the widest gap after the
    /// `count` lowest, and the number expected.
    fn count(&self, exact: &Solution, count: usize, speed: f64) -> Result<(Option<usize>, usize)> {
        let frequency = |i: usize| exact.motions[i].lambda.im;
        let candidates = count..(count + SPARE).min(exact.motions.len());
        let widest = candidates
            .max_by(|&a, &b| (frequency(a) / frequency(a - 1)).total_cmp(&(frequency(b) / frequency(b - 1))));
        let (w, mut expected) = match widest {
            Some(at) => ((frequency(at - 1) * frequency(at)).sqrt(), at),
            None => return Ok((Some(0), 0)),
        };
        let real = |v: f64| c64::new(v, 0.0);
        let mut terms = vec![(real(1.0), &self.operators.stiffness), (real(-w * w), &self.operators.mass)];
        if let Some(g) = &self.operators.gyroscopic {
            terms.push((c64::new(0.0, w * speed), g));
        }
        expected += self.reduced.zero_frequencies(speed)?;
        Ok((Ldlt::new(&combine(&terms))?.negative_pivots(), expected))
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

/// Sense of the orbit; torsional and axial motions have none (spin couples them to breathing of the
/// section, which carries some angular momentum).
fn sense(momentum: f64, kind: ModeKind) -> Whirl {
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

fn offset_remark(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    if model.disks.iter().any(|d| d.offset != [0.0, 0.0]) {
        diagnostics.push(Diagnostic::warning(
            "offset-disk",
            "an offset disk is not axisymmetric: its offset enters the mass matrix as if it stood still, \
             which is approximate in the stationary frame",
        ));
    }
}

fn speed_remarks(model: &Model, highest: f64, branches: &[Tracked], diagnostics: &mut Vec<Diagnostic>) {
    let clamped = model.supports.iter().any(|s| matches!(s.kind, crate::model::SupportKind::Clamped(_)));
    if clamped && highest > 0.0 {
        diagnostics.push(Diagnostic::info(
            "clamped-spins",
            "a clamped end of a spinning shaft is read as a driven revolute end (no tilt, no torsional vibration)",
        ));
    }
    for tracked in branches {
        let unstable = tracked.branch.log_decrement.iter().flatten().filter(|d| **d < -1e-9).count();
        if unstable > 0 {
            diagnostics.push(Diagnostic::warning(
                "unstable",
                format!("branch {} is unstable at {unstable} of the speeds", tracked.branch.name),
            ));
        }
    }
}

fn describe_model(
    model: &Model,
    settings: &CampbellSettings,
    operators: &Operators,
    summary: &mut crate::results::ModelSummary,
) {
    let spins = settings.speeds.iter().any(|s| *s > 0.0);
    match (settings.gyroscopic, spins, operators.gyroscopic.is_some()) {
        (Gyroscopic::All, true, _) => summary.modelled.push("gyroscopic terms of shaft and disks".to_owned()),
        (Gyroscopic::Disks, true, true) => summary.modelled.push("gyroscopic terms of the disks".to_owned()),
        _ => summary.left_out.push("gyroscopic terms".to_owned()),
    }
    summary.left_out.push("centrifugal stiffening and spin softening: classical form".to_owned());
    if operators.damping.is_some() {
        summary.modelled.push("damping of bearings and material".to_owned());
    } else {
        summary.left_out.push("damping: none given".to_owned());
    }
    if operators.cross_coupling.is_some() {
        summary.modelled.push("cross-coupled bearing stiffness".to_owned());
    }
    if operators.circulatory.is_some() {
        summary.modelled.push("circulatory forces of rotating damping".to_owned());
    }
    if model.disks.iter().any(|d| d.offset != [0.0, 0.0]) {
        summary.modelled.push("disk offset in the mass matrix (approximate)".to_owned());
    }
}
