//! `rotor map`: undamped critical speeds over the stiffness of the supports, and decay over a cross-coupling.
//!
//! Synchronous whirl without damping, `K(k) u = Omega^2 (M - i G) u` with the stiffness k along y and z at the supports in place of
//! their bearings, on a basis of natural modes at a low, a middle and a high stiffness with the static answers to the forces of
//! the supports. Source: docs/theory/response.md#map.

use crate::accuracy::locking_and_rounding::refuse_dependent;
use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::reduced_basis::Reduced;
use crate::analysis::campbell::synchronous::critical_speeds;
use crate::analysis::response::vibration::Vibration;
use crate::analysis::{Counter, Outcome, ignored_input, model_remarks, operating_range, summary};
use crate::error::{Refusal, Result};
use crate::linalg::dense::{cholesky, self_adjoint};
use crate::model::{
    Bearing, CrossCoupling, DEFAULT_BASIS, Form, Gyroscopic, MapSettings, Model, Resists, WhirlFrame,
};
use crate::results::{
    BearingCurve, CriticalMap, CrossCouplingCurve, Diagnostic, Intersection, LeftOut, MapCurve, Modelled,
    Whirl,
};
use crate::section::Section;
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::bearing_rows;
use crate::shaft::spectrum::Spectrum;
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Natural modes of each of the three stiffnesses in the basis.
const MODES: usize = 24;
/// Relative difference of speeds up to which their shapes may be mixtures.
const MIXED_RTOL: f64 = 1e-9;
/// Circularity from which a motion has a sense.
const LEAST_CIRCULARITY: f64 = 0.01;
/// Stiffness over the highest of the map that counts as rigid.
const RIGID: f64 = 1e6;
/// Points of a bearing's curve between two rows of its table.
const POINTS_PER_ROW: usize = 8;
/// Relative width of the bracket of an intersection or threshold.
const BRACKET: f64 = 1e-10;
/// Difference to the unreduced speeds above which the map is in doubt.
const DOUBTFUL: f64 = 1e-3;

/// Critical speeds of each sense, ascending, rad/s.
type Senses = [Vec<f64>; 2];

/// The rotor on supports of any stiffness.
struct Supported {
    reduced: Reduced,
    /// Displacements along y and z at the supports, on the basis.
    rows: Mat<f64>,
    /// Stiffness of the supports in the frequencies of the basis.
    middle: f64,
}

impl Supported {
    fn new(model: &Model, settings: &MapSettings) -> Result<Self> {
        let (first, last) = (settings.stiffness[0], settings.stiffness[settings.stiffness.len() - 1]);
        let middle = (first * last).sqrt();
        let supported = model.on_stiffness(&settings.bearings, middle);
        let assembly = Assembly::new(&supported);
        let spectrum = Spectrum::new(&assembly, MODES)?;
        let operators = Operators::new(&assembly, &spectrum, WhirlFrame::Stationary, Gyroscopic::All, None);
        let held = supported.bearings.iter().filter(|b| is_chosen(b, settings));
        let rows: Vec<Vec<f64>> = held
            .flat_map(|b| bearing_rows(&supported, &assembly.numbering, b))
            .map(|row| assembly.force(&row))
            .collect();
        let rows = Mat::from_fn(assembly.size(), rows.len(), |i, j| rows[j][i]);
        let answers = spectrum.flexibility.solve(rows.clone());
        let mut reduced = Reduced::new(&operators, &spectrum, MODES, MODES)?;
        reduced = reduced.with(&operators, &spectrum, answers.as_ref())?;
        for stiffness in [first, last] {
            let model = model.on_stiffness(&settings.bearings, stiffness);
            let other = Spectrum::new(&Assembly::new(&model), MODES)?;
            reduced = reduced.with(&operators, &spectrum, other.vectors.as_ref())?;
        }
        let rows = reduced.basis.transpose() * rows;
        Ok(Self { reduced, rows, middle })
    }

    /// Critical speeds of forward and of backward whirl with a stiffness at the supports.
    fn critical_speeds(&self, stiffness: f64) -> Result<Senses> {
        let (n, r) = (self.reduced.size(), self.reduced.n_rigid);
        let m = n - r;
        let w = &self.reduced.frequencies;
        let change = stiffness - self.middle;
        let k = Mat::from_fn(m, m, |i, j| {
            let own = if i == j { w[i + r] * w[i + r] } else { 0.0 };
            let held: f64 =
                (0..self.rows.ncols()).map(|c| self.rows[(i + r, c)] * self.rows[(j + r, c)]).sum();
            own + change * held
        });
        let Some(l) = cholesky(k.as_ref()) else {
            return Err(Refusal::at(
                "map.stiffness.from",
                "so low a stiffness is lost in the rounding of the shaft's",
                "a higher lowest stiffness",
            )
            .into());
        };
        let gyroscopic =
            |i: usize, j: usize| self.reduced.gyroscopic.as_ref().map_or(0.0, |g| g[(i + r, j + r)]);
        let lower = Mat::from_fn(m, m, |i, j| c64::new(l[(i, j)], 0.0));
        let inertia = Mat::from_fn(m, m, |i, j| c64::new(f64::from(i == j), -gyroscopic(i, j)));
        let half = lower.as_ref().partial_piv_lu();
        // L^-1 (M - i G) L^-T
        let left = half.solve(&inertia);
        let both = half.solve(left.transpose().to_owned()).transpose().to_owned();
        let hermitian = Mat::from_fn(m, m, |i, j| (both[(i, j)] + both[(j, i)].conj()) / 2.0);
        let (values, vectors) = self_adjoint(hermitian.as_ref())?;
        let upper = Mat::from_fn(m, m, |i, j| lower[(j, i)]);
        let shapes = upper.partial_piv_lu().solve(vectors);
        let mut found: Vec<(f64, usize)> =
            (0..m).filter(|&i| values[i] > 0.0).map(|i| (1.0 / values[i].sqrt(), i)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut senses = Senses::default();
        for equal in found.chunk_by(|a, b| b.0 - a.0 <= MIXED_RTOL * b.0) {
            for (circularity, speed) in
                self.circularities(&shapes, equal)?.into_iter().zip(equal.iter().map(|e| e.0))
            {
                if circularity > LEAST_CIRCULARITY {
                    senses[0].push(speed);
                } else if circularity < -LEAST_CIRCULARITY {
                    senses[1].push(speed);
                }
            }
        }
        Ok(senses)
    }

    /// How far the motions of equal speeds travel around the axis: -1 to 1, from backward to forward.
    fn circularities(&self, shapes: &Mat<c64>, equal: &[(f64, usize)]) -> Result<Vec<f64>> {
        let r = self.reduced.n_rigid;
        let travel = self.reduced.travel();
        let n = shapes.nrows();
        let form = |a: usize, b: usize, by: &dyn Fn(usize, usize) -> f64| -> c64 {
            let mut sum = c64::new(0.0, 0.0);
            for i in 0..n {
                for j in 0..n {
                    let factor = by(i, j);
                    if factor != 0.0 {
                        sum += shapes[(i, a)].conj() * shapes[(j, b)] * factor;
                    }
                }
            }
            sum
        };
        let k = equal.len();
        let mass = Mat::from_fn(k, k, |a, b| form(equal[a].1, equal[b].1, &|i, j| f64::from(i == j)));
        let turning = Mat::from_fn(k, k, |a, b| {
            form(equal[a].1, equal[b].1, &|i, j| travel[(i + r, j + r)]) * c64::new(0.0, -1.0)
        });
        if k == 1 {
            return Ok(vec![turning[(0, 0)].re / mass[(0, 0)].re]);
        }
        let (sizes, axes) = self_adjoint(mass.as_ref())?;
        if !(sizes[0] > 0.0) {
            return Ok(vec![0.0; k]);
        }
        let half = Mat::from_fn(k, k, |i, j| axes[(i, j)] / sizes[j].sqrt());
        Ok(self_adjoint((half.adjoint() * turning * &half).as_ref())?.0)
    }
}

fn is_chosen(bearing: &Bearing, settings: &MapSettings) -> bool {
    bearing.resists == Resists::Lateral && bearing.holds_shaft() && settings.bearings.contains(&bearing.path)
}

/// Solves for the curves, their meetings with those of the bearings, and the decay over a cross-coupling.
///
/// # Errors
/// Sections that are not round, or equations that can't be solved.
pub fn critical_map(
    model: &Model,
    settings: &MapSettings,
    progress: Counter<'_>,
) -> Result<Outcome<CriticalMap>> {
    if !model.sections.iter().all(Section::is_axisymmetric) {
        return Err(Refusal::at(
            "map",
            "a section is not round: its critical speeds are not those of one stiffness",
            "circle and tube sections; `rotor campbell` in the rotating frame takes any section",
        )
        .into());
    }
    refuse_dependent(model)?;
    let supported = Supported::new(model, settings)?;
    let one = |k: &f64| {
        let found = supported.critical_speeds(*k);
        progress(1);
        found
    };
    let all: Vec<Senses> = settings.stiffness.par_iter().map(one).collect::<Result<_>>()?;
    let rigid = supported.critical_speeds(RIGID * settings.stiffness[settings.stiffness.len() - 1])?;
    let mut curves = Vec::new();
    for (sense, whirl) in [Whirl::Forward, Whirl::Backward].into_iter().enumerate() {
        for n in 0..settings.curves {
            let critical_rad_s: Vec<Option<f64>> = all.iter().map(|s| s[sense].get(n).copied()).collect();
            if critical_rad_s.iter().any(Option::is_some) {
                let rigid_rad_s = rigid[sense].get(n).copied();
                curves.push(MapCurve { whirl, n: n + 1, critical_rad_s, rigid_rad_s });
            }
        }
    }
    let highest = curves.iter().flat_map(|c| &c.critical_rad_s).flatten().fold(0.0, |m: f64, v| m.max(*v));
    let bearing_curves = bearing_curves(model, settings, highest);
    let intersections = intersections(&supported, &curves, &bearing_curves, model)?;
    let measured_error = measured_error(model, settings, &all)?;
    let assembly = Assembly::new(model);
    let mut diagnostics = ignored_input(model);
    diagnostics.extend(model_remarks(model, &assembly));
    if measured_error > DOUBTFUL {
        diagnostics.push(Diagnostic::warning(
            "map-reduced",
            format!(
                "the critical speeds of the map differ by up to {measured_error:.1e} from the unreduced ones"
            ),
        ));
    }
    let cross_coupling = match &settings.cross_coupling {
        Some(q) => Some(decay(model, q)?),
        None => None,
    };
    let mut summary =
        summary(model, assembly.size(), crate::analysis::mass_properties::properties(model).mass());
    summary.modelled.push(Modelled::GyroscopicTerms);
    let undamped = "damping and cross-coupling: the map is that of undamped critical speeds".to_owned();
    summary.left_out.extend([LeftOut::Told(undamped), LeftOut::SpinStiffening]);
    let results = CriticalMap {
        stiffness_n_m: settings.stiffness.clone(),
        bearings: settings.bearings.clone(),
        curves,
        bearing_curves,
        intersections,
        cross_coupling,
        operating_speed: operating_range(model),
        measured_error,
    };
    Ok(Outcome { results, model: summary, diagnostics })
}

/// The direct stiffnesses of the bearings of the case.
fn bearing_curves(model: &Model, settings: &MapSettings, highest: f64) -> Vec<BearingCurve> {
    let mut list = Vec::new();
    for bearing in model.bearings.iter().filter(|b| is_chosen(b, settings)) {
        let speeds: Vec<f64> = match &bearing.table {
            Some(table) => {
                let [first, last] = table.speeds();
                let count = POINTS_PER_ROW * table.rows().len().max(2);
                (0..=count).map(|k| first + (last - first) * k as f64 / count as f64).collect()
            }
            None => vec![0.0, highest],
        };
        for (i, direction) in ["yy", "zz"].into_iter().enumerate() {
            let stiffness = |s: &f64| stiffness_at(bearing, *s, i);
            let stiffness_n_m = speeds.iter().map(stiffness).collect();
            list.push(BearingCurve {
                bearing: bearing.path.clone(),
                direction,
                speed_rad_s: speeds.clone(),
                stiffness_n_m,
            });
        }
    }
    list
}

/// Direct stiffness of a bearing at a speed, along y (0) or z (1), of whirl in step with the rotation.
fn stiffness_at(bearing: &Bearing, speed: f64, direction: usize) -> f64 {
    let law = bearing.table.as_ref().map_or_else(|| bearing.at_rest(), |t| t.at(speed, speed));
    law.stiffness[direction][direction]
}

/// Speeds at which a bearing has the stiffness at which they are critical: by bisection where the difference changes its sign.
fn intersections(
    supported: &Supported,
    curves: &[MapCurve],
    bearings: &[BearingCurve],
    model: &Model,
) -> Result<Vec<Intersection>> {
    let mut list = Vec::new();
    for of in bearings {
        let Some(bearing) =
            model.bearings.iter().find(|b| b.path == of.bearing && b.resists == Resists::Lateral)
        else {
            continue;
        };
        let direction = usize::from(of.direction == "zz");
        let critical = |speed: f64| -> Result<Option<Senses>> {
            let k = stiffness_at(bearing, speed, direction);
            if k > 0.0 { supported.critical_speeds(k).map(Some) } else { Ok(None) }
        };
        let along: Vec<Option<Senses>> =
            of.speed_rad_s.par_iter().map(|s| critical(*s)).collect::<Result<_>>()?;
        for curve in curves {
            let sense = usize::from(curve.whirl == Whirl::Backward);
            let value = |senses: &Option<Senses>, speed: f64| {
                senses.as_ref().and_then(|s| s[sense].get(curve.n - 1)).map(|c| c - speed)
            };
            for i in 1..along.len() {
                let (mut low, mut high) = (of.speed_rad_s[i - 1], of.speed_rad_s[i]);
                let (Some(a), Some(b)) = (value(&along[i - 1], low), value(&along[i], high)) else {
                    continue;
                };
                if a * b > 0.0 || (b == 0.0 && i + 1 < along.len()) {
                    continue;
                }
                while high - low > BRACKET * high {
                    let middle = (low + high) / 2.0;
                    match value(&critical(middle)?, middle) {
                        Some(c) if c * a > 0.0 => low = middle,
                        _ => high = middle,
                    }
                }
                let speed_rad_s = (low + high) / 2.0;
                list.push(Intersection {
                    whirl: curve.whirl,
                    n: curve.n,
                    bearing: of.bearing.clone(),
                    direction: of.direction,
                    speed_rad_s,
                    stiffness_n_m: stiffness_at(bearing, speed_rad_s, direction),
                });
            }
        }
    }
    list.sort_by(|a, b| a.speed_rad_s.total_cmp(&b.speed_rad_s));
    Ok(list)
}

/// Largest relative difference of the reduced critical speeds to unreduced ones at the ends and in the middle of the stiffnesses.
fn measured_error(model: &Model, settings: &MapSettings, all: &[Senses]) -> Result<f64> {
    let last = settings.stiffness.len() - 1;
    let mut worst = 0.0_f64;
    for at in [0, last / 2, last] {
        let supported = model.on_stiffness(&settings.bearings, settings.stiffness[at]);
        let assembly = Assembly::new(&supported);
        let spectrum = Spectrum::new(&assembly, DEFAULT_BASIS / 2)?;
        let operators = Operators::new(&assembly, &spectrum, WhirlFrame::Stationary, Gyroscopic::All, None);
        let ours: Vec<f64> = all[at].iter().flat_map(|s| s.iter().take(settings.curves)).copied().collect();
        let Some(highest) = ours.iter().copied().reduce(f64::max) else { continue };
        let exact = critical_speeds(&operators, &spectrum, highest * (1.0 + DOUBTFUL))?;
        for speed in ours {
            let apart = |c: f64| (c / speed - 1.0).abs();
            worst = worst.max(exact.list.iter().map(|c| apart(c.speed)).fold(f64::INFINITY, f64::min));
        }
    }
    Ok(if worst.is_finite() { worst } else { 1.0 })
}

/// Log decrement of the first forward motion over a cross-coupled stiffness at one place.
fn decay(model: &Model, q: &CrossCoupling) -> Result<CrossCouplingCurve> {
    let assembly = Assembly::new(model);
    let [_, y, z, ..] = crate::shaft::attachments::place_rows(model, &assembly.numbering, q.x);
    let vibration = Vibration::new(
        &assembly,
        (Form::Consistent, WhirlFrame::Stationary),
        q.speed,
        &[y.clone(), z.clone()],
    )?;
    let rows = [vibration.row(&y), vibration.row(&z)];
    let n = vibration.reduced.size();
    let least = |stiffness: f64| -> Result<Option<f64>> {
        let mut reduced = vibration.reduced.clone();
        let own = Mat::from_fn(n, n, |i, j| stiffness * (rows[0][i] * rows[1][j] - rows[1][i] * rows[0][j]));
        reduced.cross_coupling = Some(match &reduced.cross_coupling {
            Some(there) => there + own,
            None => own,
        });
        let solution = reduced.solve(q.speed)?;
        let mut moves = solution.motions[..solution.oscillating].iter();
        let forward = moves.find(|m| reduced.travel_of(m) > LEAST_CIRCULARITY && m.lambda.im > 0.0);
        Ok(forward.map(|m| -TAU * m.lambda.re / m.lambda.im))
    };
    let log_decrement: Vec<Option<f64>> = q.stiffness.par_iter().map(|k| least(*k)).collect::<Result<_>>()?;
    let mut threshold_n_m = None;
    for i in 1..log_decrement.len() {
        let (Some(a), Some(b)) = (log_decrement[i - 1], log_decrement[i]) else { continue };
        if a >= 0.0 && b < 0.0 {
            let (mut low, mut high) = (q.stiffness[i - 1], q.stiffness[i]);
            while high - low > BRACKET * high {
                let middle = (low + high) / 2.0;
                if least(middle)?.is_some_and(|d| d < 0.0) { high = middle } else { low = middle }
            }
            threshold_n_m = Some((low + high) / 2.0);
            break;
        }
    }
    Ok(CrossCouplingCurve {
        at: q.x,
        speed_rad_s: q.speed,
        stiffness_n_m: q.stiffness.clone(),
        log_decrement,
        threshold_n_m,
    })
}
