//! The periodic motion of a shaft at constant speed by harmonic balance, seen from the frame that turns with it.
//!
//! What is fixed in space (gravity, forces, uneven bearings) comes back every turn. With the angle theta of the drive,
//!
//! ```text
//!     z(theta) = c_0 + sum_h (a_h cos h theta + b_h sin h theta),    h = 1 .. H,
//! ```
//!
//! and the forces out of balance at equally spaced angles have no part along any of these functions. Newton's matrix has the
//! tangent of the mean state, and of the bearings all; harmonics are doubled until the motion settles, which measures what
//! is left out. Source: docs/theory/motion.md#steady-states.

use crate::error::{Error, Result};
use crate::linalg::lu::SparseLu;
use crate::linalg::sparse::{Sparse, combine, from_columns};
use crate::model::{Bearing, Frame, Model};
use crate::shaft::assembly::{Assembly, dragged};
use crate::shaft::drive::Drive;
use crate::shaft::internal_forces::{Forces, ScalarMass};
use crate::shaft::loads::{Loads, Turned, Which};
use crate::shaft::motion::Dynamics;
use faer::Scale;
use std::f64::consts::TAU;

/// Harmonics of the first solution; linear equations with gravity and uneven bearings need no more.
const FIRST_HARMONICS: usize = 2;
/// Largest number of harmonics that is tried.
const MOST_HARMONICS: usize = 16;
/// Relative change by more harmonics at which the motion has settled.
const SETTLED_RTOL: f64 = 1e-9;
/// Relative change by more harmonics that is still an answer.
const ACCEPTED_RTOL: f64 = 1e-3;
/// Relative correction at which Newton's iteration ends.
const NEWTON_RTOL: f64 = 1e-12;
/// Shortest share of a correction that is gone, and relative size of one that is gone wholly.
const SHORTEST_STEP_SHARE: f64 = 1e-3;
const WHOLE_STEP_RTOL: f64 = 1e-6;
/// Correction over the motion that may no longer shrink: the forces of a small motion are rounding to this.
const STALLED_RTOL: f64 = 1e-7;
/// The same over what rounding of the internal forces moves.
const STALLED_OVER_ROUNDING: f64 = 10.0;
/// Most Newton iterations.
const MOST_ITERATIONS: usize = 60;
/// Convergence rate from which a fresh matrix is worth its price.
const SLOW_RATE: f64 = 0.2;

/// A periodic motion.
pub struct Orbit {
    /// Number of harmonics H of the motion.
    pub harmonics: usize,
    /// Change of the motion by the last harmonics, over its largest coordinate.
    pub truncation: f64,
    /// Newton iterations in all.
    pub iterations: usize,
    /// Coefficients in the free coordinates: c_0, a_1, b_1, a_2, ...
    coefficients: Vec<Vec<f64>>,
}

impl Orbit {
    /// Position, velocity and acceleration (per rad and rad^2 of the drive) at an angle.
    pub fn at(&self, theta: f64) -> [Vec<f64>; 3] {
        let n = self.coefficients[0].len();
        let mut list = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        for (k, coefficient) in self.coefficients.iter().enumerate() {
            for (derivative, target) in list.iter_mut().enumerate() {
                let factor = function(k, theta, derivative);
                target.iter_mut().zip(coefficient).for_each(|(t, c)| *t += factor * c);
            }
        }
        list
    }

    /// The mean position, seen from the turning frame.
    pub fn mean(&self) -> &[f64] {
        &self.coefficients[0]
    }
}

/// The k-th of 1, cos theta, sin theta, cos 2 theta, ..., or a derivative of it.
fn function(k: usize, theta: f64, derivative: usize) -> f64 {
    let h = k.div_ceil(2) as f64;
    let factor = h.powi(derivative as i32);
    let quarter = if k.is_multiple_of(2) && k > 0 { -1.0 } else { 0.0 };
    // cos(x + n pi / 2) is the n-th derivative of cos x
    let angle = h * theta + (quarter + derivative as f64) * TAU / 4.0;
    if k == 0 { f64::from(derivative == 0) } else { factor * angle.cos() }
}

/// True when everything that acts is constant in the turning frame, so that the steady state is an equilibrium there.
pub fn is_constant_in_turning_frame(model: &Model) -> bool {
    let even = |b: &Bearing| [b.stiffness, b.damping].iter().all(|law| uneven(b, *law) == [0.0; 2]);
    model.bearings.iter().all(even)
        && [model.gravity[1], model.gravity[2]] == [0.0; 2]
        && !model.has_bearing_offsets()
        && model.loads.iter().all(|load| load.is_constant_in_turning_frame())
        && model.tractions.iter().all(|load| load.is_constant_in_turning_frame())
}

/// What of a bearing's law changes with the angle: a and b of `[[a, b], [b, -a]]`; rounding beside the rest is none.
fn uneven(bearing: &Bearing, [[yy, yz], [zy, zz]]: [[f64; 2]; 2]) -> [f64; 2] {
    if !bearing.is_across() {
        return [0.0; 2];
    }
    let size = [yy, yz, zy, zz].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let told = |v: f64| if v.abs() > 1e-12 * size { v } else { 0.0 };
    [told((yy - zz) / 2.0), told((yz + zy) / 2.0)]
}

/// Solves for the periodic motion at a speed (rad/s), from a mean position or from the undeformed shaft.
///
/// # Errors
/// An element without nonlinear form, a Newton iteration that does not converge, or harmonics that do not settle.
pub fn periodic(assembly: &Assembly<'_>, speed: f64, start: Option<Vec<f64>>) -> Result<Orbit> {
    let mut dynamics = Dynamics::new(assembly, Drive::constant(speed), Frame::Rotating)?;
    let mut system = System::new(assembly, speed)?;
    let mut orbit = Orbit {
        harmonics: FIRST_HARMONICS,
        truncation: f64::INFINITY,
        iterations: 0,
        coefficients: vec![vec![0.0; assembly.size()]; 2 * FIRST_HARMONICS + 1],
    };
    if let Some(mean) = start {
        orbit.coefficients[0] = mean;
    }
    system.rounding = STALLED_OVER_ROUNDING * system.moved_by_rounding(&orbit)?;
    system.solve(&mut dynamics, &mut orbit)?;
    while orbit.harmonics < MOST_HARMONICS {
        let before = orbit.coefficients.clone();
        orbit.harmonics *= 2;
        orbit.coefficients.resize(2 * orbit.harmonics + 1, vec![0.0; assembly.size()]);
        system.solve(&mut dynamics, &mut orbit)?;
        let size = largest(orbit.coefficients.iter().flatten().copied());
        let changes = orbit.coefficients.iter().enumerate().flat_map(|(k, now)| {
            let then = before.get(k);
            now.iter().enumerate().map(move |(i, c)| c - then.map_or(0.0, |t| t[i]))
        });
        // changes that are rounding tell nothing of harmonics
        let change = largest(changes);
        orbit.truncation = if change <= system.rounding { 0.0 } else { change / size };
        if orbit.truncation <= SETTLED_RTOL {
            break;
        }
    }
    if orbit.truncation > ACCEPTED_RTOL {
        return Err(Error::analysis(
            "the periodic motion has too many harmonics",
            format!(
                "{MOST_HARMONICS} harmonics, the last of which still changed it by {:.1e}",
                orbit.truncation
            ),
            "run the transient: leave out `spinup.steady`",
        ));
    }
    Ok(orbit)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// The matrices of Newton's method.
struct System<'a> {
    assembly: &'a Assembly<'a>,
    speed: f64,
    forces: Forces<'a>,
    loads: Loads,
    /// What may be rounding in the coefficients of a motion, m.
    rounding: f64,
    mass: Sparse,
    /// `C + 2 Omega M J`, on velocities.
    on_velocity: Sparse,
    /// Bearings, `Omega^2 M J^2` and what damping feels of the rotation, on displacements.
    on_place: Sparse,
    /// Parts of the bearings that turn as cos 2 theta and sin 2 theta: on displacements and on velocities.
    turning: [[Sparse; 2]; 2],
    uneven: bool,
}

impl<'a> System<'a> {
    fn new(assembly: &'a Assembly<'a>, speed: f64) -> Result<Self> {
        let model = assembly.model;
        // the mean law of a bearing is what the turning shaft feels all the time
        let mut mean = model.clone();
        for bearing in &mut mean.bearings {
            let even = |law| {
                let ([a, b], [[yy, yz], [zy, zz]]) = (uneven(bearing, law), law);
                [[yy - a, yz - b], [zy - b, zz + a]]
            };
            (bearing.stiffness, bearing.damping) = (even(bearing.stiffness), even(bearing.damping));
        }
        let even = Assembly::new(&mean);
        let on_velocity = combine(&[(1.0, &even.damping()), (2.0 * speed, &even.angular_momentum())]);
        let on_place = combine(&[
            (1.0, &even.bearing_stiffness()),
            (speed * speed, &even.centrifugal()),
            (speed, &even.rotating_damping()),
        ]);
        let turning = [0, 1].map(|part| {
            // R^T [[a, b], [b, -a]] R = cos 2 theta [[a, b], [b, -a]] + sin 2 theta [[b, -a], [-a, -b]]
            let law = |[a, b]: [f64; 2]| {
                if part == 0 { [[a, b], [b, -a]] } else { [[b, -a], [-a, -b]] }
            };
            let stiffness = assembly.bearing_matrix(|b| law(uneven(b, b.stiffness)));
            let damping = assembly.bearing_matrix(|b| law(uneven(b, b.damping)));
            let dragged = assembly.bearing_matrix(|b| dragged(b, law(uneven(b, b.damping))));
            [combine(&[(1.0, &stiffness), (speed, &dragged)]), damping]
        });
        Ok(Self {
            assembly,
            speed,
            forces: Forces::new(assembly)?,
            loads: Loads::new(model, &assembly.numbering, &ScalarMass::new(model), Which::All),
            rounding: 0.0,
            mass: assembly.mass(),
            on_velocity,
            on_place,
            uneven: turning.iter().flatten().any(|a| a.compute_nnz() > 0),
            turning,
        })
    }

    /// Newton's method for the coefficients of an orbit.
    fn solve(&self, dynamics: &mut Dynamics<'_>, orbit: &mut Orbit) -> Result<()> {
        let mut factor: Option<SparseLu<f64>> = None;
        let mut previous = f64::INFINITY;
        let (mut size, mut change) = (0.0, f64::INFINITY);
        for _ in 0..MOST_ITERATIONS {
            orbit.iterations += 1;
            let residual = self.residual(dynamics, orbit);
            let lu = match factor.take() {
                Some(lu) => lu,
                None => SparseLu::new(&self.matrix(orbit))?,
            };
            let correction = lu.solve(&residual)?;
            change = largest(correction.iter().copied());
            let whole = self.step(dynamics, orbit, &residual, &correction);
            size = largest(orbit.coefficients.iter().flatten().copied());
            if !change.is_finite() || !size.is_finite() {
                break;
            }
            let stalled = change > previous / 2.0 && change <= (STALLED_RTOL * size).max(self.rounding);
            if change <= NEWTON_RTOL * size || stalled {
                return Ok(());
            }
            // a matrix that serves is kept
            factor = (whole && change < SLOW_RATE * previous && previous.is_finite()).then_some(lu);
            previous = change;
        }
        Err(Error::analysis(
            format!("no periodic motion was found at {:.6} rad/s", self.speed),
            format!(
                "Newton's method with {} harmonics and the tangent of the mean state; its last correction was {:.1e} of the motion",
                orbit.harmonics,
                if size > 0.0 { change / size } else { f64::MAX }
            ),
            "more damping, another speed, or the transient: leave out `spinup.steady`",
        ))
    }

    /// Largest coefficient (m) of the motion that rounding of the internal forces makes: each is a sum of terms `K_ij q_j`, q the
    /// places in space, which rounds to `eps sum |K_ij| |q_j|`, one way or the other.
    fn moved_by_rounding(&self, orbit: &Orbit) -> Result<f64> {
        let reference = self.forces.reference();
        let (stiffness, places) = (self.forces.tangent(&reference), self.assembly.restrict(&reference));
        let mut rounded = vec![0.0; places.len()];
        for (j, place) in places.iter().enumerate() {
            for (&i, k) in stiffness.row_idx_of_col_raw(j).iter().zip(stiffness.val_of_col(j)) {
                rounded[i] += f64::EPSILON * (k * place).abs();
            }
        }
        // signs without a pattern
        let sign = |i: usize| if (i.wrapping_mul(0x9E37_79B9) >> 7) & 1 == 0 { 1.0 } else { -1.0 };
        let size = rounded.len() * orbit.coefficients.len();
        let force: Vec<f64> = (0..size).map(|i| sign(i) * rounded[i % rounded.len()]).collect();
        Ok(largest(SparseLu::new(&self.matrix(orbit))?.solve(&force)?.into_iter()))
    }

    /// Goes along a correction as far as the work of the forces out of balance along it falls; true for the whole way.
    fn step(
        &self,
        dynamics: &mut Dynamics<'_>,
        orbit: &mut Orbit,
        residual: &[f64],
        correction: &[f64],
    ) -> bool {
        let n = self.assembly.size();
        let start = orbit.coefficients.clone();
        let work = |force: &[f64]| force.iter().zip(correction).map(|(f, d)| f * d).sum::<f64>().abs();
        let before = work(residual);
        let mut share = 1.0;
        loop {
            for ((coefficient, start), d) in
                orbit.coefficients.iter_mut().zip(&start).zip(correction.chunks_exact(n))
            {
                coefficient.iter_mut().zip(start).zip(d).for_each(|((c, s), d)| *c = s - share * d);
            }
            let size = largest(orbit.coefficients.iter().flatten().copied());
            if share < SHORTEST_STEP_SHARE || largest(correction.iter().copied()) <= WHOLE_STEP_RTOL * size {
                return share == 1.0;
            }
            let after = work(&self.residual(dynamics, orbit));
            if after.is_finite() && after <= 0.9 * before {
                return share == 1.0;
            }
            share /= 2.0;
        }
    }

    /// The parts of the forces out of balance along every function.
    fn residual(&self, dynamics: &mut Dynamics<'_>, orbit: &Orbit) -> Vec<f64> {
        let (n, functions) = (self.assembly.size(), orbit.coefficients.len());
        // cubic forces of H harmonics reach to 3 H
        let samples = 4 * orbit.harmonics + 4;
        let mut sum = vec![0.0; n * functions];
        let mut force = vec![0.0; n];
        for s in 0..samples {
            let theta = TAU * s as f64 / samples as f64;
            let [z, mut v, mut a] = orbit.at(theta);
            v.iter_mut().for_each(|v| *v *= self.speed);
            a.iter_mut().for_each(|a| *a *= self.speed * self.speed);
            dynamics.evaluate(theta / self.speed, &z, &v, &a);
            dynamics.imbalance(&mut force);
            for k in 0..functions {
                let weight = share(k, samples) * function(k, theta, 0);
                sum[k * n..][..n].iter_mut().zip(&force).for_each(|(s, f)| *s += weight * f);
            }
        }
        sum
    }

    /// Newton's matrix: blocks of the coefficients.
    fn matrix(&self, orbit: &Orbit) -> Sparse {
        let (n, functions) = (self.assembly.size(), orbit.coefficients.len());
        let mut q = self.assembly.expand(orbit.mean());
        q.iter_mut().zip(self.forces.reference()).for_each(|(q, q0)| *q += q0);
        let mut loads = self.loads.tangents(&q, Turned::NOT);
        loads.iter_mut().for_each(|part| part.matrix *= Scale(-1.0));
        let elastic = combine(&[
            (1.0, &self.forces.tangent(&q)),
            (1.0, &self.assembly.sum(&[], loads)),
            (1.0, &self.on_place),
        ]);
        // products of functions: what cos 2 theta or sin 2 theta times the k-th, or its derivative, has along the i-th
        let samples = 4 * orbit.harmonics + 4;
        let product = |i: usize, k: usize, derivative: usize, part: usize| -> f64 {
            let one = |s: usize| {
                let theta = TAU * s as f64 / samples as f64;
                function(i, theta, 0) * function(k, theta, derivative) * function(3 + part, theta, 0)
            };
            let sum = share(i, samples) * (0..samples).map(one).sum::<f64>();
            if sum.abs() > 1e-9 { sum } else { 0.0 }
        };
        let block = |i: usize, k: usize| -> Option<Sparse> {
            let h = k.div_ceil(2) as f64 * self.speed;
            let mut terms: Vec<(f64, &Sparse)> = Vec::new();
            if i == k {
                terms.extend([(1.0, &elastic), (-h * h, &self.mass)]);
            }
            // d cos = - h sin, d sin = h cos
            if k > 0 && i.div_ceil(2) == k.div_ceil(2) && i != k {
                terms.push((if i > k { -h } else { h }, &self.on_velocity));
            }
            if self.uneven {
                for (part, [on_place, on_velocity]) in self.turning.iter().enumerate() {
                    for (factor, matrix) in [
                        (product(i, k, 0, part), on_place),
                        (self.speed * product(i, k, 1, part), on_velocity),
                    ] {
                        if factor != 0.0 {
                            terms.push((factor, matrix));
                        }
                    }
                }
            }
            (!terms.is_empty()).then(|| combine(&terms))
        };
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for k in 0..functions {
            let column: Vec<(usize, Sparse)> =
                (0..functions).filter_map(|i| block(i, k).map(|b| (i, b))).collect();
            for j in 0..n {
                for (i, b) in &column {
                    rows.extend(b.row_idx_of_col_raw(j).iter().map(|row| i * n + row));
                    values.extend_from_slice(b.val_of_col(j));
                }
                starts.push(rows.len());
            }
        }
        from_columns(n * functions, starts, rows, values)
    }
}

/// Weight of a sample in the part along the k-th function.
fn share(k: usize, samples: usize) -> f64 {
    if k == 0 { 1.0 / samples as f64 } else { 2.0 / samples as f64 }
}
