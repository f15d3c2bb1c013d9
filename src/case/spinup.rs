//! Settings of a run-up, as written.

use crate::units::{Length, Moment, Speed, Stiffness, Time};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Run up to speed.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Spinup")]
pub struct SpinupInput {
    /// Phases of the drive, from one speed to the next, from `start_speed` at t = 0.
    #[serde(default)]
    pub drive: Vec<DrivePhase>,
    /// Torque of the drive over its speed in place of phases: straight between the points, constant beyond. The speed
    /// follows from it.
    #[serde(default)]
    pub torque: Vec<TorquePoint>,
    /// Speed at t = 0, default 0; the shaft starts from its steady state there.
    pub start_speed: Option<Speed>,
    /// End of the simulation, default the end of the last phase.
    pub until: Option<Time>,
    /// WhirlFrame of the unknowns, default rotating.
    #[serde(default)]
    pub frame: Frame,
    /// Integrator, default implicit.
    #[serde(default)]
    pub integrator: IntegratorInput,
    /// Tolerance of a step relative to the largest displacement, default 1e-4.
    #[serde(default = "default_rtol")]
    pub rtol: f64,
    /// Tolerance of a step on displacements over the reference length, default 1e-7.
    #[serde(default = "default_atol")]
    pub atol: f64,
    /// Spectral radius of generalized-alpha at infinite frequency: 1 no numerical damping, 0 the most; default 0.9.
    pub rho_infinity: Option<f64>,
    /// Fixed step instead of error control.
    pub step: Option<Time>,
    /// Most steps, default 1000000.
    #[serde(default = "default_max_steps")]
    pub max_steps: u64,
    /// Number of equally spaced times in the history, default 201.
    #[serde(default = "default_output_count")]
    pub output: u32,
    /// Only the equilibrium at the last speed.
    #[serde(default)]
    pub steady: bool,
    /// Position of a section that the drive turns and holds in no other way: its mean rotation follows the drive. It is
    /// what turns a rotor on bearings.
    pub driven_at: Option<Length>,
    /// Rings that limit the motion of the shaft.
    #[serde(default)]
    pub stators: Vec<StatorInput>,
}

/// A rigid ring at rest around the shaft, centred on the undeformed axis.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Stator")]
pub struct StatorInput {
    /// Position along the shaft: an element end where the section is round.
    pub at: Length,
    /// Radial play of the shaft's axis.
    pub clearance: Length,
    /// Force per penetration.
    pub stiffness: Stiffness,
    /// Coefficient of friction on the shaft's surface, default 0.
    #[serde(default)]
    pub friction: f64,
}

fn default_rtol() -> f64 {
    1e-4
}

fn default_atol() -> f64 {
    1e-7
}

fn default_max_steps() -> u64 {
    1_000_000
}

fn default_output_count() -> u32 {
    201
}

/// End of a phase of the drive.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DrivePhase {
    /// Time at which the phase ends.
    pub until: Time,
    /// Speed reached there; negative turns backward.
    pub speed: Speed,
    /// How it is reached, default along half a cosine.
    #[serde(default)]
    pub shape: RampShape,
}

/// How the speed changes over a phase of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RampShape {
    /// Half a cosine: the acceleration grows from zero and returns to it.
    #[default]
    Cosine,
    /// A straight line.
    Linear,
}

/// A point of the drive's torque over its speed.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorquePoint {
    /// Speed.
    pub speed: Speed,
    /// Torque about x: positive drives in the positive sense.
    pub torque: Moment,
}

/// WhirlFrame of a transient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Frame {
    /// Turning with the drive.
    #[default]
    Rotating,
    /// Fixed in space.
    Inertial,
}

/// Integrator of a transient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(rename = "Integrator")]
pub enum IntegratorInput {
    /// The default implicit one: esdirk.
    #[default]
    Implicit,
    /// Implicit Runge-Kutta of order 4, error-controlled.
    Esdirk,
    /// Generalized-alpha, order 2, robust.
    GeneralizedAlpha,
    /// Explicit Adams predictor and corrector of variable order and step: follows the fastest vibration.
    Adams,
}
