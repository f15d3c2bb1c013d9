//! Forces of supports and bearings, and what passes through the sections of a shaft.

use serde::Serialize;
use std::collections::BTreeMap;

/// What supports, bearings and rings do, each once, by its JSON path: `[x, y, z]` in one state, or lists of these over time.
///
/// Directions are fixed in space. In a steady state that is an equilibrium of the frame which turns with the shaft, forces
/// turn with it: then they are those at the instant at which the axes of that frame are those of the space.
#[derive(Debug, Clone, Default, Serialize)]
pub struct SupportForces<T> {
    /// Force on the shaft, along what a support holds.
    #[serde(rename = "support_forces_N")]
    pub forces_n: BTreeMap<String, T>,
    /// Moment of every kinematic support on the shaft about the axis' point of its section: about x what holds or drives
    /// rotation, about y and z what holds tilt. Where the drive turns the section of another support, the torque is the drive's.
    #[serde(rename = "support_moments_N_m")]
    pub moments_n_m: BTreeMap<String, T>,
    /// Positions along the undeformed shaft, m.
    #[serde(skip)]
    pub at_m: BTreeMap<String, f64>,
}

/// Force and moment that the part of the shaft beyond a section (at larger x) exerts there on the part before it, at both ends of
/// every element: just inside, so that each inner end stands twice, left and right of what acts there. Between two ends of an
/// element no force is concentrated.
///
/// Components are along x, y and z, not along the tilted section; moments are about its point of the axis. Directions are those of
/// [`SupportForces`].
#[derive(Debug, Clone, Default, Serialize)]
pub struct SectionForces {
    /// Positions along the undeformed shaft.
    pub x_m: Vec<f64>,
    /// Along x, positive in tension.
    #[serde(rename = "axial_force_N")]
    pub axial_force_n: Vec<f64>,
    /// Shear force along y.
    #[serde(rename = "shear_y_N")]
    pub shear_y_n: Vec<f64>,
    /// Shear force along z.
    #[serde(rename = "shear_z_N")]
    pub shear_z_n: Vec<f64>,
    /// Torque about x.
    #[serde(rename = "torque_N_m")]
    pub torque_n_m: Vec<f64>,
    /// Bending moment about y.
    #[serde(rename = "moment_y_N_m")]
    pub moment_y_n_m: Vec<f64>,
    /// Bending moment about z.
    #[serde(rename = "moment_z_N_m")]
    pub moment_z_n_m: Vec<f64>,
}
