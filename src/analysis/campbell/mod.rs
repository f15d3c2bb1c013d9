//! `rotor campbell`: whirl frequencies over spin speed, and critical speeds.
//!
//! The frames and forms are those of `operators.rs`. The sweep runs on a reduced basis whose error is
//! measured against the unreduced problem at the highest speed; critical speeds are solved directly and
//! cross-checked with the sweep. Source: docs/theory/linear-rotordynamics.md.

pub mod branch_tracking;
mod branches;
pub mod changing_bearings;
mod crossings;
pub mod first_order;
pub mod hysteresis;
pub mod operators;
pub mod reduced_basis;
pub mod remarks;
pub mod spin_stiffening;
mod sweep;
pub mod synchronous;
mod unstable_ranges;
mod whirl_solver;

use crate::accuracy::locking_and_rounding::{refuse_dependent, refuse_tiny_bore};
use crate::analysis::Counter;
use crate::analysis::campbell::branches::mostly;
use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::reduced_basis::{Reduced, Solution};
use crate::analysis::campbell::remarks::{describe_model, fits, offset_remark, speed_remarks};
use crate::analysis::campbell::spin_stiffening::{Stiffening, burst, burst_of};
use crate::analysis::campbell::sweep::WhirlSolver;
use crate::analysis::campbell::synchronous::Criticals;
use crate::analysis::character::Character;
use crate::analysis::{Outcome, ignored_input, model_remarks, operating_range, summary, table_remarks};
use crate::error::{Refusal, Result};
use crate::model::{CampbellSettings, DEFAULT_BASIS, Form, Model, SPARE_BASIS, WhirlFrame};
use crate::results::{Branch, Campbell, Diagnostic, Reduction};
use crate::shaft::assembly::Assembly;
use crate::shaft::spectrum::{Flexibility, Spectrum};
use faer::c64;

/// A motion so slow that it feels the stiffness alone.
const SLOW: c64 = c64::new(0.0, 0.0);
/// Share of the basis used for static corrections.
const STATIC_CORRECTION_SHARE: f64 = 0.4;

/// Sweeps the spin speed and solves for critical speeds.
///
/// # Errors
/// A rotor that the frame or the form does not fit, a shaft that bursts, or an eigenvalue solver that does not
/// converge.
pub fn campbell(
    model: &Model,
    settings: &CampbellSettings,
    progress: Counter<'_>,
) -> Result<Outcome<Campbell>> {
    let mut diagnostics = ignored_input(model);
    fits(model, settings)?;
    refuse_dependent(model)?;
    if settings.form == Form::Consistent && settings.speeds.iter().any(|s| *s > 0.0) {
        refuse_tiny_bore(model)?;
    }
    let assembly = Assembly::new(model);
    diagnostics.extend(model_remarks(model, &assembly));
    table_remarks(model, &settings.speeds, &mut diagnostics);
    let basis = settings.reduction.unwrap_or(DEFAULT_BASIS).max(settings.modes + SPARE_BASIS);
    let corrected = (STATIC_CORRECTION_SHARE * basis as f64).ceil() as usize;
    let spectrum = Spectrum::new(&assembly, basis - corrected)?;
    if !spectrum.complete {
        diagnostics.push(Diagnostic::error(
            "sturm-count",
            "a mode of the basis may be missing (Sturm count at rest)",
        ));
    }
    refuse_supports(&assembly, &spectrum, settings)?;
    let highest = settings.speeds.last().copied().unwrap_or(0.0);
    let operators = operators(&assembly, &spectrum, settings, highest)?;
    let reduced = Reduced::new(&operators, &spectrum, basis - corrected, corrected)?
        .following(settings.modes + SPARE_BASIS);
    // with a law that changes, each speed has a stiffness of its own: critical speeds are crossings of the sweep
    let solvable = operators.changing.is_empty() && (operators.is_conservative() || operators.is_rotating());
    let criticals = if highest > 0.0 && solvable {
        Some(synchronous::critical_speeds(&operators, &spectrum, highest)?)
    } else {
        None
    };
    let speeds = speeds(settings, &operators, criticals.as_ref());
    let solver =
        WhirlSolver { operators: &operators, spectrum: &spectrum, reduced: &reduced, settings, speeds };

    let sweep = solver.sweep(progress)?;
    diagnostics.extend(unsettled_remark(&sweep));
    let character = Character::new(&assembly)?;
    let branches = solver.track(&sweep, &character, &mut diagnostics)?;

    let axisymmetric = model.is_axisymmetric();
    let critical_speeds =
        solver.critical_speeds(criticals, axisymmetric, &sweep, &branches, &character, &mut diagnostics)?;
    let unstable_ranges = solver.unstable_ranges(&sweep, &branches)?;
    let stability_threshold_rad_s = solver.threshold(&unstable_ranges, &sweep, &branches, &mut diagnostics);
    let measured_error = solver.measured_error(&sweep, &mut diagnostics)?;
    offset_remark(model, settings, &mut diagnostics);
    speed_remarks(model, highest, &unstable_ranges, &mut diagnostics);

    let mass = crate::analysis::mass_properties::properties(model).mass();
    let mut model_summary = summary(model, assembly.size(), mass);
    let spins = settings.speeds.iter().any(|s| *s > 0.0);
    describe_model(model, (settings.gyroscopic, settings.form, spins), &operators, &mut model_summary);
    let reported: Vec<Branch> =
        branches.into_iter().take(settings.modes).map(|t| solver.at_asked_speeds(t.branch)).collect();
    diagnostics.extend(few_remark(settings.modes, reported.len()));
    let results = Campbell {
        frame: settings.frame.name(),
        form: settings.form.name(),
        gyroscopic: settings.gyroscopic.name(),
        speeds_rad_s: settings.speeds.clone(),
        branches: reported,
        critical_speeds,
        orders: settings.orders.clone(),
        operating_speed: operating_range(model),
        unstable_ranges,
        stability_threshold_rad_s,
        reduction: Reduction {
            basis: settings.reduction.map(|_| reduced.size()),
            measured_error,
            stiffening_error: operators.stiffening.as_ref().map(|s| s.error),
        },
    };
    Ok(Outcome { results, model: model_summary, diagnostics })
}

/// Motions that are told with a law that is not their own.
fn unsettled_remark(sweep: &[Solution]) -> Option<Diagnostic> {
    let unsettled: usize = sweep.iter().map(|s| s.unsettled).sum();
    let text = format!(
        "for {unsettled} motions over all speeds no frequency was found at which the bearings' coefficients are their own: they \
         are told with others"
    );
    (unsettled > 0).then(|| Diagnostic::warning("whirl-unsettled", text))
}

/// Fewer branches than were asked for.
fn few_remark(asked: usize, found: usize) -> Option<Diagnostic> {
    let text = format!("{asked} branches were asked for; the basis holds only {found}");
    (found < asked).then(|| Diagnostic::warning("few-branches", text))
}

/// The matrices of the sweep, in the frame and form of the settings.
///
/// # Errors
/// A shaft that bursts below the highest speed.
fn operators(
    assembly: &Assembly<'_>,
    spectrum: &Spectrum,
    settings: &CampbellSettings,
    highest: f64,
) -> Result<Operators> {
    let bursts = |error| burst_of(assembly.model, error, highest);
    let stiffening = match settings.form {
        Form::Consistent if highest > 0.0 => {
            Some(Stiffening::new(assembly.model, spectrum, highest).map_err(bursts)?)
        }
        _ => None,
    };
    let operators = Operators::new(assembly, spectrum, settings.frame, settings.gyroscopic, stiffening);
    refuse_burst(&operators, spectrum, highest).map_err(bursts)?;
    Ok(operators)
}

/// Supports whose spinning rotor has no steady state to linearise about.
fn refuse_supports(assembly: &Assembly<'_>, spectrum: &Spectrum, settings: &CampbellSettings) -> Result<()> {
    let rigid = |among: &[usize]| spectrum.rigid_motions.iter().find(|motion| motion.has(among));
    // translations along y and z, rotations about y and z
    let across = [1, 2, 4, 5];
    if let (WhirlFrame::Rotating, Some(motion)) = (settings.frame, rigid(&across)) {
        let problem = format!(
            "the rotating frame needs a rotor that is held across its axis, but nothing resists {motion}"
        );
        return Err(Refusal::at("campbell.frame", problem, "\"stationary\"; or more bearings").into());
    }
    if settings.form == Form::Consistent && rigid(&[3]).is_some() && assembly.holds_stretch_one_way() {
        return Err(Refusal::at(
            "supports",
            "a support holds the stretch of a section in a direction fixed in space while the shaft is free to turn: \
             spinning, it would press against that support unevenly",
            "a support of a kind (revolute, cylindrical, pinned, roller, bearing), one that holds all in-plane \
             components alike, or \"form\": \"classical\"",
        )
        .into());
    }
    Ok(())
}

/// In the stationary frame a stiffness that is not positive any more is the end of the shaft.
fn refuse_burst(operators: &Operators, spectrum: &Spectrum, highest: f64) -> Result<()> {
    // a bearing whose stiffness falls makes a motion that creeps away, which is told
    if operators.stiffening.is_none() || operators.is_rotating() || !operators.changing.is_empty() {
        return Ok(());
    }
    let holds = |speed: f64| -> Result<bool> {
        // what soft bearings hold is held
        let loose = spectrum.flexibility.loose_motions();
        let k = Flexibility::new(&operators.stiffness_at(speed, SLOW), &operators.mass, loose)?;
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

/// The speeds asked for, standstill and, in the rotating frame, one speed between neighbouring critical speeds that have none:
/// a rotor may be unstable there.
fn speeds(settings: &CampbellSettings, operators: &Operators, criticals: Option<&Criticals>) -> Vec<f64> {
    let mut speeds = settings.speeds.clone();
    if speeds.first().is_some_and(|first| *first > 0.0) {
        speeds.insert(0, 0.0);
    }
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

impl WhirlSolver<'_> {
    /// The values of a branch at the speeds asked for.
    fn at_asked_speeds(&self, branch: Branch) -> Branch {
        fn keep<T: Copy>(list: &[T], asked: &[bool]) -> Vec<T> {
            list.iter().zip(asked).filter(|(_, asked)| **asked).map(|(value, _)| *value).collect()
        }
        let asked: Vec<bool> = self.speeds.iter().map(|speed| self.settings.speeds.contains(speed)).collect();
        let whirl_at_speed = keep(&branch.whirl_at_speed, &asked);
        Branch {
            whirl: mostly(&whirl_at_speed),
            whirl_at_speed,
            frequency_rad_s: keep(&branch.frequency_rad_s, &asked),
            log_decrement: keep(&branch.log_decrement, &asked),
            overdamped: branch
                .overdamped
                .iter()
                .copied()
                .filter(|s| self.settings.speeds.contains(s))
                .collect(),
            ..branch
        }
    }
}
