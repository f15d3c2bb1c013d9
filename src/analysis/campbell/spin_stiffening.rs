//! The tangent stiffness K_T(Omega) at the equilibrium of the spinning, balanced, unloaded shaft.
//!
//! K_T is smooth in Omega^2, so the equilibrium is solved at a few speeds only and K_T interpolated between
//! them as a polynomial in Omega^2 (Chebyshev-Lobatto nodes, rest among them); the error is measured at a speed
//! that is none of them. An offset mass is an unbalance: it bends the shaft, and without bound at a critical
//! speed, so it takes no part in this equilibrium. Source: docs/theory/linear-rotordynamics.md#stiffness-at-speed.

use crate::analysis::equilibrium::{Balance, NewtonSettings};
use crate::error::{Error, Result};
use crate::linalg::sparse::{Sparse, combine, from_columns, multiply};
use crate::model::{Hub, Model, Quadrature};
use crate::shaft::assembly::Assembly;
use crate::shaft::loads::Which;
use crate::shaft::spectrum::{Flexibility, Spectrum};
use faer::Mat;
use std::f64::consts::PI;

/// Degrees of the polynomial that are tried until the error is below [`WANTED`].
const DEGREES: [usize; 3] = [3, 5, 8];
/// Relative error of a mode's stiffness to aim at.
const WANTED: f64 = 1e-10;
/// `(Omega / highest)^2` where the interpolation is checked: no node of any degree.
const CHECK: f64 = 0.4162;
/// Displacement over the reference length below which the linear answer is exact to rounding, and below
/// which Newton's method would see only rounding errors.
const LINEAR_PER_LENGTH: f64 = 1e-8;
const EQUILIBRIUM_NEWTON: NewtonSettings =
    NewtonSettings { load_steps: 1, max_iterations: 25, tolerance: 1e-20 };

/// Nodes of an interpolation over speed.
#[derive(Debug, Clone)]
pub struct Nodes {
    /// Highest speed, rad/s.
    highest: f64,
    /// `(Omega / highest)^2`, rest first.
    squares: Vec<f64>,
}

impl Nodes {
    fn new(highest: f64, degree: usize) -> Self {
        let square = |j: usize| (1.0 - (j as f64 * PI / degree as f64).cos()) / 2.0;
        Self { highest, squares: (0..=degree).map(square).collect() }
    }

    /// Highest speed, rad/s.
    pub fn highest(&self) -> f64 {
        self.highest
    }

    /// Lagrange weight at a speed of every node but rest.
    pub fn weights(&self, speed: f64) -> Vec<f64> {
        let (x, nodes) = ((speed / self.highest).powi(2), &self.squares);
        let lagrange = |j: usize| -> f64 {
            let others = (0..nodes.len()).filter(|&k| k != j);
            others.map(|k| (x - nodes[k]) / (nodes[j] - nodes[k])).product()
        };
        (1..nodes.len()).map(lagrange).collect()
    }
}

/// `K_T(Omega) = K_0 + sum_j weight_j(Omega^2) change_j`.
pub struct Stiffening {
    /// Where the equilibria were solved.
    pub nodes: Nodes,
    /// `K_T - K_0` at every node but rest.
    pub changes: Vec<Sparse>,
    /// Displacement in free coordinates at every node but rest.
    pub states: Vec<Vec<f64>>,
    /// Largest relative error of the stiffness of a natural mode at the speed of the check.
    pub error: f64,
}

impl Stiffening {
    /// Solves the equilibria up to `highest` (rad/s, above zero).
    ///
    /// # Errors
    /// No equilibrium up to that speed, or an element without nonlinear form.
    pub fn new(model: &Model, spectrum: &Spectrum, highest: f64) -> Result<Self> {
        let mut balanced = model.clone();
        balanced.disks.iter_mut().for_each(|d| d.offset = [0.0, 0.0]);
        balanced.quadrature = Quadrature::EXACT;
        let assembly = Assembly::new(&balanced);
        let spinning = Spinning::new(&assembly)?;
        let (at_check, _) = spinning.at(CHECK.sqrt() * highest, None)?;
        let mut best: Option<Self> = None;
        for degree in DEGREES {
            let nodes = Nodes::new(highest, degree);
            let mut next = Self { nodes, changes: Vec::new(), states: Vec::new(), error: 0.0 };
            for j in 1..=degree {
                let before = next.states.last().map(Vec::as_slice);
                let (change, state) = spinning.at(next.nodes.squares[j].sqrt() * highest, before)?;
                next.changes.push(change);
                next.states.push(state);
            }
            next.error = next.distance(&at_check, spectrum);
            let enough = next.error <= WANTED;
            if best.as_ref().is_none_or(|b| next.error < b.error) {
                best = Some(next);
            }
            if enough {
                break;
            }
        }
        best.ok_or_else(|| Error::analysis("no tangent stiffness", "interpolation", "report this"))
    }

    /// Largest relative difference of a natural mode's stiffness to `change` at the speed of the check.
    fn distance(&self, change: &Sparse, spectrum: &Spectrum) -> f64 {
        let weights = self.nodes.weights(CHECK.sqrt() * self.nodes.highest);
        let mut terms = vec![(1.0, change)];
        terms.extend(weights.iter().zip(&self.changes).map(|(w, change)| (-w, change)));
        let x = &spectrum.vectors;
        let images = multiply(&combine(&terms), x.as_ref());
        let of = |j: usize| -> f64 { x.col(j).transpose() * images.col(j) };
        (0..x.ncols()).map(|j| (of(j) / spectrum.values[j]).abs()).fold(0.0, f64::max)
    }
}

/// Equilibria of one shaft.
struct Spinning<'a> {
    assembly: &'a Assembly<'a>,
    at_rest: Sparse,
    mass: Sparse,
    centrifugal: Sparse,
    /// For every free coordinate whether it changes its sign under y -> -y and under z -> -z.
    mirror: Vec<[bool; 2]>,
}

impl<'a> Spinning<'a> {
    fn new(assembly: &'a Assembly<'a>) -> Result<Self> {
        let balance = Balance::new(assembly, Which::None, 0.0)?;
        Ok(Self {
            at_rest: balance.tangent(&vec![0.0; assembly.size()]),
            mass: assembly.mass(),
            centrifugal: assembly.centrifugal(),
            mirror: assembly.mirror_signs(),
            assembly,
        })
    }

    /// `K_T - K_0` and the displacement at a speed.
    fn at(&self, speed: f64, start: Option<&[f64]>) -> Result<(Sparse, Vec<f64>)> {
        let balance = Balance::new(self.assembly, Which::None, speed)?;
        let linear = self.linear(&balance, speed)?;
        let largest = linear.iter().fold(0.0, |m: f64, z| m.max(z.abs()));
        let found = if largest <= LINEAR_PER_LENGTH * self.assembly.model.reference_length {
            linear
        } else {
            let found = balance.solve(EQUILIBRIUM_NEWTON, start)?;
            if found.load_factor < 1.0 {
                let reached = speed * found.load_factor.sqrt();
                return Err(burst(reached, "Newton's method with halved steps in Omega^2"));
            }
            found.z
        };
        // Sections, supports and pull are symmetric about both planes, so the state is too: what rounding
        // added across them would couple bending to stretch.
        let symmetric = |signs: &[bool; 2]| *signs == [false, false];
        let state: Vec<f64> =
            found.iter().zip(&self.mirror).map(|(z, m)| if symmetric(m) { *z } else { 0.0 }).collect();
        let tangent = balance.tangent(&state);
        // A singular matrix on symmetric motions is the loss of equilibrium; on others it is a critical speed.
        let held = self.filtered(
            &combine(&[(1.0, &tangent), (speed * speed, &self.centrifugal)]),
            |i, j| i == j || (symmetric(&self.mirror[i]) && self.mirror[i] == self.mirror[j]),
            |i| if symmetric(&self.mirror[i]) { None } else { Some(self.scale(i)) },
        );
        let motions = self.assembly.rigid_motions().1;
        if Flexibility::new(&held, &self.mass, motions)?.unstable_directions() > 0 {
            return Err(burst(speed, "the tangent stiffness of the spinning state on its symmetric motions"));
        }
        let change = combine(&[(1.0, &tangent), (-1.0, &self.at_rest)]);
        Ok((self.filtered(&change, |i, j| self.mirror[i] == self.mirror[j], |_| None), state))
    }

    /// Displacement under the centrifugal pull on the undeformed shaft, by the stiffness at rest.
    fn linear(&self, balance: &Balance<'_>, speed: f64) -> Result<Vec<f64>> {
        let mut turning = balance.reference.clone();
        turning.iter_mut().step_by(3).for_each(|x| *x = 0.0);
        let (mut pull, mut force) = (vec![0.0; turning.len()], vec![0.0; self.assembly.size()]);
        balance.mass.multiply(&turning, &mut pull);
        self.assembly.project(&pull, &mut force);
        let motions = self.assembly.rigid_motions().1;
        let flexibility = Flexibility::new(&self.at_rest, &self.mass, motions)?;
        let answer = flexibility.solve(Mat::from_fn(force.len(), 1, |i, _| speed * speed * force[i]));
        Ok(answer.col(0).iter().copied().collect())
    }

    fn scale(&self, i: usize) -> f64 {
        let rows = self.at_rest.row_idx_of_col_raw(i);
        rows.iter().position(|&row| row == i).map_or(1.0, |at| self.at_rest.val_of_col(i)[at])
    }

    /// The entries of a matrix that `keep` names, with some diagonal entries replaced.
    fn filtered(
        &self,
        a: &Sparse,
        keep: impl Fn(usize, usize) -> bool,
        diagonal: impl Fn(usize) -> Option<f64>,
    ) -> Sparse {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..a.ncols() {
            for (&i, &value) in a.row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)) {
                if keep(i, j) {
                    rows.push(i);
                    values.push(if i == j { diagonal(i).unwrap_or(value) } else { value });
                }
            }
            starts.push(rows.len());
        }
        from_columns(a.ncols(), starts, rows, values)
    }
}

/// The error of a shaft that bursts; where it is soft hubs whose load the wall does not carry, rigid ones are the remedy.
pub fn burst_of(model: &Model, error: Error, highest: f64) -> Error {
    let Error::Analysis { what, tried, .. } = &error else { return error };
    let mut rigid = model.clone();
    rigid.disks.iter_mut().filter(|d| d.hub == Hub::Soft).for_each(|d| d.hub = Hub::Rigid);
    let soft: Vec<String> = (0..model.disks.len())
        .filter(|&i| model.disks[i].hub == Hub::Soft)
        .map(|i| format!("`disks.{i}.hub`"))
        .collect();
    let assembly = Assembly::new(&rigid);
    let holds = || Spinning::new(&assembly).and_then(|spinning| spinning.at(highest, None)).is_ok();
    if soft.is_empty() || !holds() {
        return error;
    }
    Error::analysis(
        format!("{what}: the section does not carry the centrifugal load of the disks with a soft hub"),
        tried.clone(),
        format!(
            "\"hub\": \"rigid\" at {} (a disk that carries its own load), with which the shaft holds at this speed",
            soft.join(", ")
        ),
    )
}

/// The error of a shaft that bursts before the highest speed.
pub fn burst(speed: f64, tried: &str) -> Error {
    Error::analysis(
        format!(
            "the spinning shaft has no stable equilibrium beyond about {speed:.6} rad/s: it bursts or buckles"
        ),
        tried,
        "lower `campbell.speeds.to`, or take \"form\": \"classical\", which leaves centrifugal effects out",
    )
}
