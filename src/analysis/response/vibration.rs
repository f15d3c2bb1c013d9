//! Steady vibration of a spinning rotor, `Z(Omega, w) q = f` with
//!
//! ```text
//!     Z = K(Omega) + X + Omega H + i w (C + Omega G) - w^2 M
//! ```
//!
//! It is solved three times. The unreduced equations say at a few places what is right. The basis of the Campbell diagram, which
//! holds the static answer to the forces too, is extended by their solutions where the two differ. And the responses of that
//! basis at some places, chosen where the others describe them worst, span the few vectors on which all the others are
//! computed. Source: docs/theory/response.md#equations.

use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::reduced_basis::Reduced;
use crate::analysis::campbell::spin_stiffening::{Stiffening, burst_of};
use crate::analysis::response::compact::Compact;
use crate::error::{Error, Result};
use crate::linalg::lu::SparseLu;
use crate::model::{DEFAULT_BASIS, Form, Gyroscopic, WhirlFrame};
use crate::shaft::assembly::Assembly;
use crate::shaft::spectrum::Spectrum;
use faer::{Mat, c64};
use rayon::prelude::*;

/// Share of the basis used for static corrections.
const STATIC_CORRECTION_SHARE: f64 = 0.4;
/// Difference of the reduced and the unreduced response, relative to the latter, below which the basis is good.
const AGREEING: f64 = 1e-7;
/// Difference of a response on few vectors to that on the basis, relative to the latter, below which they are enough.
const ENOUGH: f64 = 1e-9;
/// Responses that join the few vectors at a time, and how often.
const JOINING: usize = 4;
const ROUNDS: usize = 12;
/// Share of a response that is new beside those before, below which it is none.
const NEW: f64 = 1e-12;

/// A place of the response: spin speed, frequency (rad/s) and complex shares of the unit forces.
pub type Place = (f64, f64, Vec<c64>);

/// The equations with the basis on which they are solved.
pub struct Vibration<'a> {
    /// The shaft.
    pub assembly: &'a Assembly<'a>,
    /// Natural modes at rest.
    pub spectrum: Spectrum,
    /// The matrices.
    pub operators: Operators,
    /// The same on the basis.
    pub reduced: Reduced,
    /// Unit forces in columns, in free coordinates.
    forces: Mat<f64>,
    /// The equations on the whole basis.
    whole: Compact,
    /// Few vectors, orthonormal, on the basis, and the equations on them.
    few: Option<(Mat<f64>, Compact)>,
}

/// A row over coordinates before constraints on the vectors in use.
pub type ReducedRow = Vec<f64>;

impl<'a> Vibration<'a> {
    /// The equations up to the highest speed, for combinations of the given unit forces (rows over coordinates before
    /// constraints).
    ///
    /// # Errors
    /// A shaft that bursts, or an eigenvalue solver that does not converge.
    pub fn new(
        assembly: &'a Assembly<'a>,
        (form, frame): (Form, WhirlFrame),
        highest: f64,
        forces: &[Vec<(usize, f64)>],
    ) -> Result<Self> {
        let corrected = (STATIC_CORRECTION_SHARE * DEFAULT_BASIS as f64).ceil() as usize;
        let spectrum = Spectrum::new(assembly, DEFAULT_BASIS - corrected)?;
        let stiffening = match form {
            Form::Consistent if highest > 0.0 => Some(
                Stiffening::new(assembly.model, &spectrum, highest)
                    .map_err(|error| burst_of(assembly.model, error, highest))?,
            ),
            _ => None,
        };
        let operators = Operators::new(assembly, &spectrum, frame, Gyroscopic::All, stiffening);
        let columns: Vec<Vec<f64>> = forces.iter().map(|row| assembly.force(row)).collect();
        let forces = Mat::from_fn(assembly.size(), columns.len(), |i, j| columns[j][i]);
        let reduced = Reduced::new(&operators, &spectrum, DEFAULT_BASIS - corrected, corrected)?;
        let answers = spectrum.flexibility.solve(spectrum.without_low_modes(&forces));
        let reduced = reduced.with(&operators, &spectrum, answers.as_ref())?;
        let whole = Compact::whole(&reduced, reduced.basis.transpose() * &forces);
        Ok(Self { assembly, spectrum, operators, reduced, forces, whole, few: None })
    }

    /// What a row over coordinates before constraints makes of the vectors in use.
    pub fn row(&self, row: &[(usize, f64)]) -> ReducedRow {
        let force = self.assembly.force(row);
        let column = Mat::from_fn(force.len(), 1, |i, _| force[i]);
        let on_basis = self.reduced.basis.transpose() * column;
        let used = match &self.few {
            Some((v, _)) => v.transpose() * on_basis,
            None => on_basis,
        };
        used.col(0).iter().copied().collect()
    }

    /// Number of vectors in use.
    pub fn size(&self) -> usize {
        self.few.as_ref().map_or(self.reduced.size(), |(v, _)| v.ncols())
    }

    /// Displacements on the vectors in use at a speed and a frequency (rad/s), for complex shares of the unit forces.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn solve(&self, speed: f64, frequency: f64, shares: &[c64]) -> Result<Vec<c64>> {
        let equations = self.few.as_ref().map_or(&self.whole, |(_, equations)| equations);
        self.solve_on(equations, &(speed, frequency, shares.to_vec()))
    }

    fn solve_on(&self, equations: &Compact, (speed, frequency, shares): &Place) -> Result<Vec<c64>> {
        let at = (*speed, *frequency);
        let found = equations.solve(at, &self.reduced.weights(*speed), shares);
        found.ok_or_else(|| {
            Error::analysis(
                "the response has no bound",
                format!(
                    "the dynamic stiffness at {speed:.6} rad/s and the frequency {frequency:.6} rad/s is singular"
                ),
                "damping (of bearings or material), or another speed",
            )
        })
    }

    /// Displacements in free coordinates by the unreduced equations.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn solve_directly(&self, (speed, frequency, shares): &Place) -> Result<Vec<c64>> {
        let force: Vec<c64> = (0..self.forces.nrows())
            .map(|i| shares.iter().enumerate().map(|(j, s)| s * self.forces[(i, j)]).sum())
            .collect();
        SparseLu::new(&self.operators.dynamic_stiffness(*speed, *frequency))?.solve(&force)
    }

    /// Compares the basis with the unreduced equations at the given places, from the first on; while they differ, the unreduced
    /// responses join the basis, and the next places are looked at. Returns the largest difference, over the largest
    /// displacement, at the places looked at last.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn check(&mut self, places: &[Place]) -> Result<f64> {
        const AT_A_TIME: usize = 2;
        let mut worst = 0.0;
        for at in places.chunks(AT_A_TIME) {
            let direct: Vec<Vec<c64>> =
                at.par_iter().map(|place| self.solve_directly(place)).collect::<Result<_>>()?;
            worst = 0.0;
            for (place, exact) in at.iter().zip(&direct) {
                worst = f64::max(worst, apart(&self.expanded(&self.solve_on(&self.whole, place)?), exact));
            }
            if worst <= AGREEING {
                break;
            }
            let parts = Mat::from_fn(self.forces.nrows(), 2 * direct.len(), |i, j| {
                let value = direct[j / 2][i];
                if j % 2 == 0 { value.re } else { value.im }
            });
            self.reduced = self.reduced.with(&self.operators, &self.spectrum, parts.as_ref())?;
            self.whole = Compact::whole(&self.reduced, self.reduced.basis.transpose() * &self.forces);
        }
        Ok(worst)
    }

    /// Displacements on the basis in free coordinates.
    fn expanded(&self, q: &[c64]) -> Vec<c64> {
        let basis = &self.reduced.basis;
        (0..basis.nrows()).map(|i| q.iter().enumerate().map(|(j, q)| q * basis[(i, j)]).sum()).collect()
    }

    /// Chooses few vectors on which the responses at all of the given places are those of the basis. Where they do not suffice, the
    /// whole basis stays in use.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn condense(&mut self, places: &[Place]) -> Result<()> {
        let exact: Vec<Vec<c64>> =
            places.par_iter().map(|place| self.solve_on(&self.whole, place)).collect::<Result<_>>()?;
        let n = self.reduced.size();
        let mut vectors: Vec<Vec<f64>> = Vec::new();
        let join = |vectors: &mut Vec<Vec<f64>>, response: &[c64]| {
            for part in [|v: &c64| v.re, |v: &c64| v.im] {
                let mut x: Vec<f64> = response.iter().map(part).collect();
                let size = norm(&x);
                for _ in 0..2 {
                    for v in vectors.iter() {
                        let share: f64 = x.iter().zip(v).map(|(x, v)| x * v).sum();
                        x.iter_mut().zip(v).for_each(|(x, v)| *x -= share * v);
                    }
                }
                let left = norm(&x);
                if left > NEW * size {
                    vectors.push(x.iter().map(|x| x / left).collect());
                }
            }
        };
        let count = places.len();
        if count == 0 {
            return Ok(());
        }
        (0..JOINING).for_each(|k| join(&mut vectors, &exact[k * (count - 1) / (JOINING - 1)]));
        for _ in 0..ROUNDS {
            let v = Mat::from_fn(n, vectors.len(), |i, j| vectors[j][i]);
            let equations = self.whole.onto(&v);
            let difference = |k: usize| -> Result<f64> {
                let q = self.solve_on(&equations, &places[k])?;
                let ours: Vec<c64> =
                    (0..n).map(|i| q.iter().enumerate().map(|(j, q)| q * v[(i, j)]).sum()).collect();
                Ok(apart(&ours, &exact[k]))
            };
            let all: Vec<f64> = (0..count).into_par_iter().map(difference).collect::<Result<_>>()?;
            let mut order: Vec<usize> = (0..count).filter(|&k| all[k] > ENOUGH).collect();
            if order.is_empty() {
                self.few = Some((v, equations));
                return Ok(());
            }
            if 2 * vectors.len() > n {
                break;
            }
            order.sort_by(|&a, &b| all[b].total_cmp(&all[a]));
            order.iter().take(JOINING).for_each(|&k| join(&mut vectors, &exact[k]));
        }
        Ok(())
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Largest difference of two responses over the largest displacement of the second.
fn apart(ours: &[c64], exact: &[c64]) -> f64 {
    let size = exact.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let difference = ours.iter().zip(exact).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    if size > 0.0 { difference / size } else { 0.0 }
}
