//! Bearings whose coefficients change with the spin speed or the whirl frequency.
//!
//! The constant matrices hold the law at standstill. What a law at the speed Omega and the whirl frequency w has beside it,
//! `f = -(dK u + dC u' + dM u'')` of the two displacements `u = B^T q`, enters as `B dK B^T` and `B dC B^T`. On a motion
//! `exp(lambda t)` added mass is stiffness and damping: `lambda^2 = 2 Re(lambda) lambda - |lambda|^2`.
//! Source: docs/theory/linear-rotordynamics.md#changing-bearings.

use crate::linalg::sparse::Sparse;
use crate::model::{Bearing, BearingTable, Coefficients};
use crate::shaft::assembly::{Assembly, dragged};
use crate::shaft::attachments::bearing_rows;
use faer::{Mat, c64};

/// A 2 x 2 law.
type Law = [[f64; 2]; 2];

/// What a law has beside that at standstill, on a motion.
#[derive(Debug, Clone, Copy)]
pub struct Change {
    /// Symmetric part of the stiffness, N/m.
    pub stiffness: Law,
    /// Skew part of the stiffness and, in a turning frame, what damping feels of the turning, N/m.
    pub turning: Law,
    /// N s/m.
    pub damping: Law,
}

/// A bearing with a table.
#[derive(Debug, Clone)]
pub struct ChangingBearing {
    /// `B`: what it resists, as two columns over the coordinates.
    pub rows: Mat<f64>,
    bearing: Bearing,
    table: BearingTable,
    rotating: bool,
}

impl ChangingBearing {
    /// All of a shaft, in its free coordinates.
    pub fn all(assembly: &Assembly<'_>, rotating: bool) -> Vec<Self> {
        let changing = assembly.model.bearings.iter().filter_map(|b| Some((b, b.table.as_ref()?)));
        let one = |(bearing, table): (&Bearing, &BearingTable)| {
            let rows = bearing_rows(assembly.model, &assembly.numbering, bearing).map(|r| assembly.force(&r));
            Self {
                rows: Mat::from_fn(assembly.size(), 2, |i, k| rows[k][i]),
                bearing: bearing.clone(),
                table: table.clone(),
                rotating,
            }
        };
        changing.map(one).collect()
    }

    /// The same in other coordinates z, `q = basis z`.
    pub fn onto(&self, basis: &Mat<f64>) -> Self {
        Self { rows: basis.transpose() * &self.rows, ..self.clone() }
    }

    /// The same in coordinates that are turned by a matrix.
    pub fn turned(&self, turn: &Mat<f64>) -> Mat<f64> {
        turn.transpose() * &self.rows
    }

    /// True when the law depends on the motion itself: on its frequency, or by added mass that changes.
    pub fn is_implicit(&self) -> bool {
        self.table.depends_on_whirl() || self.table.rows().iter().any(|c| c.mass != self.bearing.mass)
    }

    /// True when it neither damps nor couples at any speed.
    pub fn is_conservative(&self) -> bool {
        let still = |c: &Coefficients| c.damping == Law::default() && c.stiffness[0][1] == c.stiffness[1][0];
        self.table.rows().iter().all(still)
    }

    /// Its change at a spin speed (rad/s) on a motion `exp(lambda t)`.
    pub fn change(&self, speed: f64, lambda: c64) -> Change {
        let (now, then) = (self.table.at(speed, lambda.im), self.bearing.at_rest());
        let each = |f: &dyn Fn(usize, usize) -> f64| -> Law { [0, 1].map(|i| [0, 1].map(|j| f(i, j))) };
        let mass = each(&|i, j| now.mass[i][j] - then.mass[i][j]);
        let on_mass = [-lambda.norm_sqr(), 2.0 * lambda.re];
        let damping = each(&|i, j| now.damping[i][j] - then.damping[i][j] + on_mass[1] * mass[i][j]);
        let stiffness = each(&|i, j| now.stiffness[i][j] - then.stiffness[i][j] + on_mass[0] * mass[i][j]);
        let turned = if self.rotating { dragged(&self.bearing, damping) } else { Law::default() };
        let half = (stiffness[0][1] - stiffness[1][0]) / 2.0;
        let skew = [[0.0, half], [-half, 0.0]];
        Change {
            stiffness: each(&|i, j| stiffness[i][j] - skew[i][j]),
            turning: each(&|i, j| skew[i][j] + speed * turned[i][j]),
            damping,
        }
    }

    /// `B law B^T x` for columns x.
    pub fn product(&self, law: &Law, x: &Mat<f64>) -> Mat<f64> {
        let felt = self.rows.transpose() * x;
        &self.rows * (Mat::from_fn(2, 2, |i, j| law[i][j]) * felt)
    }
}

/// Adds `B law B^T` to a dense matrix in the coordinates of B.
pub fn add(rows: &Mat<f64>, law: &Law, to: &mut Mat<f64>) {
    if *law != Law::default() {
        *to += rows * Mat::from_fn(2, 2, |i, j| law[i][j]) * rows.transpose();
    }
}

/// `sum_kl law_kl E_kl` for the unit laws of a bearing, as terms of a sparse sum.
pub fn units(assembly: &Assembly<'_>) -> Vec<[[Sparse; 2]; 2]> {
    let changing = assembly.model.bearings.iter().filter(|b| b.table.is_some());
    changing.map(|b| [0, 1].map(|k| [0, 1].map(|l| assembly.bearing_unit(b, k, l)))).collect()
}
