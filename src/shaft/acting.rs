//! What acts on a shaft in one state, and its resultants.
//!
//! Forces f_k on the vectors q_k of a node are conjugate to their motion. Moved and turned with the section as a whole they
//! do the work of
//!
//! ```text
//!     force = sum of f_0 over the fields of the node,    moment about the origin = sum_k q_k x f_k
//! ```
//!
//! Source: docs/theory/supports.md#acts-on.

use crate::shaft::loads::Turned;
use nalgebra::Vector3;
use std::ops::{Add, AddAssign, Sub};

/// A force and its moment about a point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Resultant {
    /// Resultant of the forces (N), in the axes of the frame in use.
    pub force: Vector3<f64>,
    /// Moment of the forces (N m) about the origin, or about the point to which [`Self::about`] moved it.
    pub moment: Vector3<f64>,
}

impl Resultant {
    /// Takes up a force on a vector; `moves` when it is the first of a section, which moves with the section.
    pub fn take(&mut self, vector: Vector3<f64>, force: Vector3<f64>, moves: bool) {
        if moves {
            self.force += force;
        }
        self.moment += vector.cross(&force);
    }

    /// The same force with its moment (N m) about a point (m) instead of the origin.
    pub fn about(self, point: Vector3<f64>) -> Self {
        Self { moment: self.moment - point.cross(&self.force), ..self }
    }

    /// Force and moment in directions fixed in space, from components along turned axes.
    pub fn in_space(self, axes: Turned) -> Self {
        // zero is added so that no zero has a sign
        let turn = |v: Vector3<f64>| Vector3::from(axes.in_space(v.into())) + Vector3::zeros();
        Self { force: turn(self.force), moment: turn(self.moment) }
    }
}

impl Add for Resultant {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }
}

impl AddAssign for Resultant {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Resultant {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { force: self.force - other.force, moment: self.moment - other.moment }
    }
}

/// All coordinates of a shaft and the forces on them, in the axes of one frame.
pub struct Acting {
    /// Position of every coordinate before constraints: vectors scaled by the reference length, m.
    pub position: Vec<f64>,
    /// Velocity as seen from space, m/s.
    pub velocity: Vec<f64>,
    /// Acceleration as seen from space, m/s^2.
    pub acceleration: Vec<f64>,
    /// Loads, gravity, inertia (with a minus sign), damping by space, bearings and rings, N.
    pub outer: Vec<f64>,
    /// What holds the shaft beside these, N: the forces of constraints, and what a solution leaves out of balance.
    pub held: Vec<f64>,
    /// Angle by which the axes of all these lists are turned about x from those fixed in space.
    pub axes: Turned,
    /// Share of loads and gravity that acts.
    pub load: f64,
}
