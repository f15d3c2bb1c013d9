//! The blocks of a contact scene: `bodies` and `contact`.

use crate::units::{
    Angle, Force, Length, LinearDensity, Moment, MomentOfMass, PenaltyModulus, Rigidity, Stiffness, Stress,
    Time, Velocity,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A beam of a contact scene.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Body")]
pub struct BodyInput {
    /// Name in reports.
    pub name: String,
    /// 2322s (planar, default), 3333s or 34X3.
    #[serde(default = "default_body_element")]
    pub element: String,
    /// Length.
    pub length: Length,
    /// Number of elements.
    pub elements: u64,
    /// Name of a section; 2322s takes rectangles, 3333s and 34X3 circles.
    pub section: Option<String>,
    /// Name of a material.
    pub material: Option<String>,
    /// 2322s: stiffness and inertia instead of section and material.
    pub structural: Option<Structural>,
    /// Place of its axis at its start; two numbers in the plane, three in space.
    pub start: Vec<Length>,
    /// Direction of its axis, counter-clockwise from x, in the plane of x and y.
    #[serde(default = "default_angle")]
    pub angle: Angle,
    /// 3333s, 34X3: direction of its axis instead of an angle.
    pub direction: Option<[f64; 3]>,
    /// Velocity of the whole body at the start.
    pub velocity: Option<Vec<Velocity>>,
    /// Whether gravity acts on it, default true.
    #[serde(default = "default_gravity")]
    pub gravity: bool,
    /// What holds it.
    #[serde(default)]
    pub supports: Vec<BodySupport>,
    /// What acts on it.
    #[serde(default)]
    pub loads: Vec<BodyLoadInput>,
}

fn default_body_element() -> String {
    "2322s".to_owned()
}

fn default_angle() -> Angle {
    Angle(0.0)
}

fn default_gravity() -> bool {
    true
}

/// Stiffness and inertia of a planar beam per length.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Structural {
    /// Against stretch.
    #[serde(rename = "EA")]
    pub axial: Force,
    /// Against shear, with its correction.
    #[serde(rename = "GA")]
    pub shear: Force,
    /// Against bending.
    #[serde(rename = "EI")]
    pub bending: Rigidity,
    /// Against a change of height.
    #[serde(rename = "EA_t")]
    pub thickness: Force,
    /// Mass per length.
    #[serde(rename = "rho_A")]
    pub mass: LinearDensity,
    /// Inertia of the section per length.
    #[serde(rename = "rho_I")]
    pub inertia: MomentOfMass,
    /// Height, for contact.
    pub height: Length,
    /// Width across the plane, for contact, default 1 m.
    pub width: Option<Length>,
}

/// What holds a body.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodySupport {
    /// Position along the body; an end or a node.
    pub at: Length,
    /// Kind.
    pub kind: BodySupportKind,
}

/// Kind of a body's support.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BodySupportKind {
    /// All vectors of the section held.
    Clamped,
    /// The axis held, the section free to turn.
    Pinned,
    /// The axis held in x, free in y and to turn.
    PinnedX,
    /// The axis held in y, free in x and to turn.
    PinnedY,
}

/// A load on a body: force or moment at a place, or pressure on a surface.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "BodyLoad")]
pub struct BodyLoadInput {
    /// Position along the body, for force and moment; the nearest node carries it.
    pub at: Option<Length>,
    /// Force, two numbers in the plane, three in space; it keeps its direction.
    pub force: Option<Vec<Force>>,
    /// 2322s: moment, counter-clockwise.
    pub moment: Option<Moment>,
    /// 2322s: the face that a pressure acts on.
    pub face: Option<Face>,
    /// Pressure, which follows the face: on its present area, against its present normal.
    pub pressure: Option<Stress>,
    /// Time until which it acts, default the whole run.
    pub until: Option<Time>,
}

/// A face of a planar body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Face {
    /// y = H/2.
    Top,
    /// y = -H/2.
    Bottom,
    /// The end face at the start.
    Start,
    /// The end face at the end.
    End,
}

/// How contact is enforced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ContactMethod {
    /// Springs that push penetrating surfaces apart.
    #[default]
    Penalty,
    /// Complementarity of gap velocity and impulse, all contacts of a step together (Lemke); in motion only.
    Lcp,
    /// For comparison: one contact of a step at a time, gap over step in the condition; it gains energy.
    LcpSingle,
    /// Exact constraints by a primal-dual active set; in equilibrium only.
    ActiveSet,
    /// Contact switched off.
    None,
}

/// Step in time of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SceneIntegrator {
    /// Midpoint rule with discrete gradients of strain and contact energy: conserves energy (default with penalty).
    EnergyConsistent,
    /// New velocities from old forces, new places from new velocities (default with lcp).
    SemiImplicitEuler,
}

/// Settings of the contact analysis.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Contact")]
pub struct ContactInput {
    /// Enforcement, default penalty.
    #[serde(default)]
    pub method: ContactMethod,
    /// Pressure per penetration along lines, default for each pair of bodies 10 E/H, E the softer modulus and H the smaller height.
    pub penalty: Option<PenaltyModulus>,
    /// Force per penetration at corners, default the penalty times height and width of the body.
    pub point_penalty: Option<Stiffness>,
    /// Integration segments per slave element, default 3; cut further where master elements end.
    #[serde(default = "default_segments")]
    pub segments: u32,
    /// Whether segments are cut where elements of the master end, default true.
    #[serde(default = "default_gravity")]
    pub cut: bool,
    /// End of the motion; without it the equilibrium under the loads.
    pub until: Option<Time>,
    /// Step, default 1e-4 s.
    pub step: Option<Time>,
    /// Step in time.
    pub integrator: Option<SceneIntegrator>,
    /// Contact of a body with itself, default false.
    #[serde(rename = "self", default)]
    pub with_itself: bool,
    /// Points in the history, default 201.
    #[serde(default = "default_output_count")]
    pub output: u32,
    /// Snapshots in the plot of the scene, default 6.
    #[serde(default = "default_corner_angle")]
    pub snapshots: u32,
    /// Load steps of an equilibrium, default 10.
    #[serde(default = "default_load_steps")]
    pub load_steps: u32,
    /// Angle between surfaces above which a corner is a contact of its own; below it the line beside it carries the contact,
    /// default 10 deg.
    pub corner_angle: Option<Angle>,
}

fn default_segments() -> u32 {
    3
}

fn default_output_count() -> u32 {
    201
}

fn default_corner_angle() -> u32 {
    6
}

fn default_load_steps() -> u32 {
    10
}
