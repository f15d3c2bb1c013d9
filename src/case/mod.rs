//! The case file exactly as written: keys, defaults, units; no meaning yet (that is [`crate::model`]).
//! Unknown keys are errors. The documentation of each key is also that of the JSON Schema.

mod analysis;
mod paths;
mod reading;
mod scene;
mod schema;
pub mod strict_json;
mod tradeoff;
mod words;

pub use analysis::{Analysis, CaseKind};
pub(crate) use paths::shown;
pub use scene::*;
pub use schema::schema;
pub use tradeoff::*;
pub use words::nearest;

use crate::case::strict_json::Strict;
use crate::error::{Error, Refusal, Result};
use crate::units::{
    Acceleration, Damping, Density, Force, Inertia, Length, Mass, Matrix, Moment, Rate, Speed, Stiffness,
    Stress, Time,
};
use paths::{at, replace, short};
use reading::{other_container, whole_numbers};
use schemars::JsonSchema;
use serde::de::{self, IntoDeserializer};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;
use words::{input_error, syntax_words};

/// A rotor and what to do with it.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Address of the schema (`rotor schema`), for editors; the program does not read it.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// One line that names the case; it heads reports and plots.
    pub title: String,
    /// What the case shows.
    #[serde(default)]
    pub description: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// Materials by name.
    #[serde(default)]
    pub materials: BTreeMap<String, Material>,
    /// Cross-sections by name.
    #[serde(default)]
    pub sections: BTreeMap<String, Section>,
    /// The shaft, segment by segment from x = 0; contact scenes have `bodies` instead.
    pub shaft: Option<Shaft>,
    /// Beams that may touch each other or themselves (rotor contact).
    #[serde(default)]
    pub bodies: Vec<Body>,
    /// Contact between the bodies.
    pub contact: Option<Contact>,
    /// Rigid disks.
    #[serde(default)]
    pub disks: Vec<Disk>,
    /// Supports and bearings. A shaft without any is legal.
    #[serde(default)]
    pub supports: Vec<Support>,
    /// Gravity vector, m/s^2 (linear analyses leave it out).
    #[serde(default)]
    pub gravity: Option<[Acceleration; 3]>,
    /// Loads (linear analyses leave them out).
    #[serde(default)]
    pub loads: Vec<Load>,
    /// Places where displacements are read.
    #[serde(default)]
    pub probes: Vec<Probe>,
    /// Natural modes.
    #[serde(default)]
    pub modes: Modes,
    /// Sweep of the spin speed.
    #[serde(default)]
    pub campbell: Option<Campbell>,
    /// Static equilibrium under the loads and gravity.
    #[serde(default, rename = "static")]
    pub statics: Statics,
    /// Run up to speed, or the steady state at speed.
    #[serde(default)]
    pub spinup: Option<Spinup>,
    /// Study of cost and error over a grid of settings.
    pub tradeoff: Option<Tradeoff>,
    /// Values that `rotor validate` checks.
    #[serde(default)]
    pub expected: Vec<Expected>,
}

/// Isotropic elastic material.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus.
    #[serde(rename = "E")]
    pub youngs_modulus: Stress,
    /// Poisson's ratio, between -1 and 0.5.
    pub nu: f64,
    /// Density.
    pub rho: Density,
    /// Material damping.
    #[serde(default)]
    pub damping: MaterialDamping,
}

/// Damping of a material.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialDamping {
    /// Kelvin-Voigt factor beta of S = C : (E + beta dE/dt), s.
    #[serde(default = "no_time")]
    pub stiffness: Time,
    /// External damping alpha: force -alpha M v, 1/s.
    #[serde(default = "no_rate")]
    pub mass: Rate,
}

impl Default for MaterialDamping {
    fn default() -> Self {
        Self { stiffness: no_time(), mass: no_rate() }
    }
}

fn no_time() -> Time {
    Time(0.0)
}

fn no_rate() -> Rate {
    Rate(0.0)
}

/// Shape of a cross-section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SectionShape {
    /// `radius` or `diameter`
    Circle,
    /// `outer_radius` or `outer_diameter`, `inner_radius` or `inner_diameter`
    Tube,
    /// `semi_axis_y`, `semi_axis_z`, optionally `inner_semi_axis_y` and `inner_semi_axis_z`
    Ellipse,
    /// `height` along y, `width` along z
    Rectangle,
}

/// Cross-section; which keys it takes depends on the shape.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Shape: circle (radius or diameter), tube (outer_radius, inner_radius or the diameters), ellipse (semi_axis_y,
    /// semi_axis_z and inner_semi_axis_y, inner_semi_axis_z), rectangle (height, width).
    pub shape: SectionShape,
    /// Radius of a circle.
    pub radius: Option<Length>,
    /// Diameter of a circle, instead of its radius.
    pub diameter: Option<Length>,
    /// Outer radius of a tube.
    pub outer_radius: Option<Length>,
    /// Outer diameter of a tube, instead of its radius.
    pub outer_diameter: Option<Length>,
    /// Inner radius of a tube.
    pub inner_radius: Option<Length>,
    /// Inner diameter of a tube, instead of its radius.
    pub inner_diameter: Option<Length>,
    /// Outer semi-axis of an ellipse along y.
    pub semi_axis_y: Option<Length>,
    /// Outer semi-axis of an ellipse along z.
    pub semi_axis_z: Option<Length>,
    /// Inner semi-axis of a hollow ellipse along y.
    pub inner_semi_axis_y: Option<Length>,
    /// Inner semi-axis of a hollow ellipse along z.
    pub inner_semi_axis_z: Option<Length>,
    /// Full height of a rectangle along y.
    pub height: Option<Length>,
    /// Full width of a rectangle along z.
    pub width: Option<Length>,
}

/// The shaft.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shaft {
    /// Element of all segments that name none: 34X1 .. 34X5; 34Rdh for walls, with radial degree d (1 to 9) and harmonics
    /// up to h (1 to 9), e.g. 34R23; "auto" for the least that is within 1e-3; 3333c, 3333s. By default 34X3 on solid
    /// sections and the choice of "auto" on hollow ones.
    pub element: Option<String>,
    /// Segments, laid end to end from x = 0.
    pub segments: Vec<Segment>,
    /// Integration of nonlinear forces (static, spinup): "exact" (default), "reduced" (5 Gauss points along an
    /// element), or numbers of points.
    #[serde(default)]
    pub quadrature: Quadrature,
}

/// Integration of nonlinear forces.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Quadrature {
    /// A rule by name.
    Named(QuadratureName),
    /// Numbers of Gauss points.
    Points(QuadraturePoints),
}

impl<'de> Deserialize<'de> for Quadrature {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        d.deserialize_any(QuadratureVisitor)
    }
}

struct QuadratureVisitor;

impl<'de> de::Visitor<'de> for QuadratureVisitor {
    type Value = Quadrature;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(r#""exact", "reduced", or { "axial": .., "section": .. }"#)
    }
    fn visit_str<E: de::Error>(self, name: &str) -> std::result::Result<Quadrature, E> {
        QuadratureName::deserialize(name.into_deserializer()).map(Quadrature::Named)
    }
    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> std::result::Result<Quadrature, A::Error> {
        QuadraturePoints::deserialize(de::value::MapAccessDeserializer::new(map)).map(Quadrature::Points)
    }
}

impl Default for Quadrature {
    fn default() -> Self {
        Self::Named(QuadratureName::Exact)
    }
}

/// Rules by name.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum QuadratureName {
    /// No quadrature error.
    Exact,
    /// 5 Gauss points along an element, exact over the section.
    Reduced,
}

/// Numbers of Gauss points.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuadraturePoints {
    /// Along an element, 2 to 20; as many as exact integration takes by default.
    pub axial: Option<usize>,
    /// In each direction of the section, 2 to 20; exact section moments by default.
    pub section: Option<usize>,
}

/// A stretch of shaft of one section and material.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Length.
    pub length: Length,
    /// Number of elements, at least 1; disks, supports and loads within may add some.
    pub elements: u64,
    /// Name of a section.
    pub section: String,
    /// Name of a material.
    pub material: String,
    /// Element of this segment, when it differs from the shaft's.
    pub element: Option<String>,
}

/// How a disk holds the shaft.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hub {
    /// The section under the disk stays undeformed.
    #[default]
    Rigid,
    /// The disk's inertia acts on r, r_,y and r_,z; the section may deform.
    Soft,
    /// The disk's inertia acts on the mean displacement, tilt and turn of the inner boundary; the section may deform.
    Bore,
    /// The same of the outer boundary: a disk shrunk onto a hollow shaft.
    Rim,
}

/// A rigid disk, given by its inertia or by its geometry.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Disk {
    /// Position along the shaft.
    pub at: Length,
    /// Mass (with polar_inertia and diametral_inertia).
    pub mass: Option<Mass>,
    /// Inertia about the shaft axis.
    pub polar_inertia: Option<Inertia>,
    /// Inertia about a diameter, at least half the polar inertia.
    pub diametral_inertia: Option<Inertia>,
    /// Outer radius (with thickness and rho).
    pub radius: Option<Length>,
    /// Outer diameter, instead of the radius.
    pub diameter: Option<Length>,
    /// Radius of the bore, default 0.
    pub inner_radius: Option<Length>,
    /// Diameter of the bore, instead of its radius.
    pub inner_diameter: Option<Length>,
    /// Thickness.
    pub thickness: Option<Length>,
    /// Density.
    pub rho: Option<Density>,
    /// Whether the thickness adds m t^2/12 to the diametral inertia, default true.
    pub thickness_inertia: Option<bool>,
    /// Offset of the centre of mass along y and z.
    pub offset: Option<[Length; 2]>,
    /// How it holds the shaft: rigid (default), soft, rim, or bore of a hollow section.
    #[serde(default)]
    pub hub: Hub,
}

/// Kind of a support.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SupportKind {
    /// No displacement, tilt or rotation.
    Clamped,
    /// As clamped, rotating with the drive.
    Revolute,
    /// As revolute, free along the axis.
    Cylindrical,
    /// No mean displacement; tilt free.
    Pinned,
    /// No mean displacement in y and z; tilt free.
    Roller,
    /// Linear springs and dampers in y and z.
    Bearing,
}

/// How a clamped, revolute or cylindrical support holds the section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SectionHold {
    /// It stays plane and may expand in its plane (default).
    Plane,
    /// It keeps its shape.
    Rigid,
}

/// What a support or load takes hold of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ActsOn {
    /// The whole section (default).
    Section,
    /// The axis vector only; not on ring elements, whose axis is empty.
    Axis,
    /// The inner boundary of a hollow section.
    Bore,
    /// The outer boundary.
    Rim,
}

/// A support: either a `kind` or `fix`.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Position along the shaft.
    pub at: Length,
    /// Kind of support.
    pub kind: Option<SupportKind>,
    /// Exactly these components: vector names (r, y, z, yz, yy, zz, ..; "all") or components ("y.x").
    pub fix: Option<Vec<String>>,
    /// Clamped, revolute, cylindrical: how the section is held.
    pub section: Option<SectionHold>,
    /// Revolute, cylindrical: rotation prescribed by the drive (default) or free.
    pub driven: Option<bool>,
    /// Pinned, roller, bearing: the mean displacement of the section (default), its bore or its rim, or the axis vector;
    /// clamped, revolute, cylindrical with a plane section: what is held in the plane (mean displacement and turn of
    /// section, bore or rim; by default the axis vector and the section's turn, on ring elements those of the section).
    pub acts_on: Option<ActsOn>,
    /// Bearing: [[kyy, kyz], [kzy, kzz]], or one number for the same in y and z.
    pub stiffness: Option<Matrix<Stiffness>>,
    /// Bearing: [[cyy, cyz], [czy, czz]], or one number for the same in y and z; default zero.
    pub damping: Option<Matrix<Damping>>,
}

/// Which part of the lateral surface a traction acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Surface {
    /// Upper half (or upper face of a rectangle).
    Top,
    /// Lower half (or lower face).
    Bottom,
    /// Inner boundary, of those segments that have one.
    Bore,
    /// Outer boundary.
    Rim,
}

/// A load: force or moment at a position, or traction or pressure on a surface.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Position along the shaft, for force and moment.
    pub at: Option<Length>,
    /// Force.
    pub force: Option<[Force; 3]>,
    /// Moment.
    pub moment: Option<[Moment; 3]>,
    /// Force and moment: on the section (default), its bore or its rim, or on the axis vectors only.
    pub acts_on: Option<ActsOn>,
    /// Part of the lateral surface of the whole shaft, for traction and pressure.
    pub surface: Option<Surface>,
    /// Force per area.
    pub traction: Option<[Stress; 3]>,
    /// Pressure against the surface as it is now.
    pub pressure: Option<Stress>,
    /// Whether the components are along axes that turn with the section, default false: axes fixed in space. A pressure
    /// always follows.
    pub follower: Option<bool>,
    /// Moment and pressure as the tractions that they are on the undeformed shaft, in size and direction, whatever the
    /// motion; default false.
    pub dead: Option<bool>,
}

/// Direction of a line of probe points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Line {
    /// Along y.
    Y,
    /// Along z.
    Z,
}

/// A point of a section, or a line of points across it.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Name in reports.
    pub name: String,
    /// Position along the shaft.
    pub at: Length,
    /// Position in the section, default 0.
    pub y: Option<Length>,
    /// Position in the section, default 0.
    pub z: Option<Length>,
    /// Points from the centre to the surface along y or z instead of one point.
    pub line: Option<Line>,
    /// Number of points of a line, at least 2.
    pub points: Option<u32>,
}

/// Natural modes.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Modes {
    /// Modes to report, rigid ones included.
    #[serde(default = "thirty")]
    pub count: u32,
}

fn thirty() -> u32 {
    30
}

impl Default for Modes {
    fn default() -> Self {
        Self { count: thirty() }
    }
}

/// Frame in which frequencies are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Frame {
    /// Fixed in space.
    Stationary,
    /// Turning with the shaft (consistent form only).
    Rotating,
}

/// Form of the linear equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// Stiffness of the undeformed shaft, gyroscopic terms.
    Classical,
    /// Tangent stiffness at the spinning equilibrium and spin softening.
    Consistent,
}

/// Whose gyroscopic terms act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Gyroscopic {
    /// Shaft and disks.
    #[default]
    All,
    /// Disks only.
    Disks,
    /// None.
    None,
}

/// Sweep of the spin speed.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Campbell {
    /// Speeds.
    pub speeds: SpeedRange,
    /// Whirl branches to report.
    #[serde(default = "twelve")]
    pub modes: u32,
    /// Frame, default stationary for circle and tube sections (and for the classical form), else rotating.
    pub frame: Option<Frame>,
    /// Form, default consistent.
    pub form: Option<Form>,
    /// Size of the modal basis (at least modes + 8), or "none".
    #[serde(default)]
    pub reduction: ReductionSize,
    /// Whose gyroscopic terms act ("disks" and "none" in the classical form only).
    #[serde(default)]
    pub gyroscopic: Gyroscopic,
    /// Excitation orders to draw besides 1x.
    #[serde(default)]
    pub orders: Vec<f64>,
}

fn twelve() -> u32 {
    12
}

/// Equally spaced speeds.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpeedRange {
    /// First speed, default 0.
    #[serde(default = "no_speed")]
    pub from: Speed,
    /// Last speed.
    pub to: Speed,
    /// Number of speeds.
    #[serde(default = "hundred_and_one")]
    pub count: u32,
}

/// Static equilibrium.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Statics {
    /// Load steps, default 1; each is cut further where Newton's method does not converge.
    #[serde(default = "one")]
    pub load_steps: u32,
    /// Most Newton iterations of a step, default 40.
    #[serde(default = "forty")]
    pub max_iterations: u32,
    /// Energy of the last correction over that of the state, default 1e-20 (ten digits of the displacement).
    #[serde(default = "tiny")]
    pub tolerance: f64,
}

impl Default for Statics {
    fn default() -> Self {
        Self { load_steps: one(), max_iterations: forty(), tolerance: tiny() }
    }
}

fn one() -> u32 {
    1
}

fn forty() -> u32 {
    40
}

fn tiny() -> f64 {
    1e-20
}

/// Run up to speed.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spinup {
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
    /// Frame of the unknowns, default rotating.
    #[serde(default)]
    pub frame: SpinupFrame,
    /// Integrator, default implicit.
    #[serde(default)]
    pub integrator: Integrator,
    /// Tolerance of a step relative to the largest displacement, default 1e-4.
    #[serde(default = "step_rtol")]
    pub rtol: f64,
    /// Tolerance of a step on displacements over the reference length, default 1e-7.
    #[serde(default = "step_atol")]
    pub atol: f64,
    /// Spectral radius of generalized-alpha at infinite frequency: 1 no numerical damping, 0 the most; default 0.9.
    pub rho_infinity: Option<f64>,
    /// Fixed step instead of error control.
    pub step: Option<Time>,
    /// Most steps, default 1000000.
    #[serde(default = "million")]
    pub max_steps: u64,
    /// Number of equally spaced times in the history, default 201.
    #[serde(default = "two_hundred_and_one")]
    pub output: u32,
    /// Only the equilibrium at the last speed.
    #[serde(default)]
    pub steady: bool,
    /// Position of a section that the drive turns and holds in no other way: its mean rotation follows the drive. It is
    /// what turns a rotor on bearings.
    pub driven_at: Option<Length>,
    /// Rings that limit the motion of the shaft.
    #[serde(default)]
    pub stators: Vec<Stator>,
}

/// A rigid ring at rest around the shaft, centred on the undeformed axis.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stator {
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

fn step_rtol() -> f64 {
    1e-4
}

fn step_atol() -> f64 {
    1e-7
}

fn million() -> u64 {
    1_000_000
}

fn two_hundred_and_one() -> u32 {
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

/// Frame of a transient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SpinupFrame {
    /// Turning with the drive.
    #[default]
    Rotating,
    /// Fixed in space.
    Inertial,
}

/// Integrator of a transient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
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

fn no_speed() -> Speed {
    Speed(0.0)
}

fn hundred_and_one() -> u32 {
    101
}

/// Size of the modal basis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReductionSize {
    /// That many vectors.
    Basis(u32),
    /// The unreduced problem.
    None,
}

impl Default for ReductionSize {
    fn default() -> Self {
        Self::Basis(60)
    }
}

impl Serialize for ReductionSize {
    fn serialize<S: serde::Serializer>(&self, s: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Basis(n) => s.serialize_u32(*n),
            Self::None => s.serialize_str("none"),
        }
    }
}

impl<'de> Deserialize<'de> for ReductionSize {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        match Value::deserialize(d)? {
            Value::String(text) if text == "none" => Ok(Self::None),
            Value::Number(n) if n.as_u64().is_some_and(|n| u32::try_from(n).is_ok()) => {
                Ok(Self::Basis(n.as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or(0)))
            }
            other => Err(serde::de::Error::custom(format!(
                "invalid value {other}: expected a whole number or \"none\""
            ))),
        }
    }
}

impl JsonSchema for ReductionSize {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ReductionSize".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "anyOf": [{ "type": "integer", "minimum": 9, "maximum": 5000 }, { "const": "none" }] })
    }
}

/// A value that `rotor validate` checks: |ours - value| <= atol + rtol |value|.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expected {
    /// Overrides for this check, JSON path to value, as with --set.
    pub set: Option<Map<String, Value>>,
    /// Analysis: check, modes or campbell (default campbell if the case has such a block, else modes).
    pub analysis: Option<Analysis>,
    /// Path of the value in the report; `*` stands for the entries of a list.
    pub path: String,
    /// Which entries of the list at `*`.
    #[serde(rename = "where")]
    pub filter: Option<Filter>,
    /// Reference: a number, or a list of numbers for the entries at `*`.
    pub value: Value,
    /// Relative tolerance.
    pub rtol: Option<f64>,
    /// Absolute tolerance.
    pub atol: Option<f64>,
    /// What the source prints, shown beside.
    pub published: Option<Value>,
    /// Where the reference comes from.
    pub source: String,
}

/// Picks entries of a list by the values of their keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Filter {
    /// Which of the matching entries, from 1; without it all.
    pub n: Option<usize>,
    /// Keys and the values they must have.
    #[serde(flatten)]
    pub fields: Map<String, Value>,
}

/// A case with where it came from.
#[derive(Debug, Clone)]
pub struct LoadedCase {
    /// The case.
    pub case: Case,
    /// The JSON it was read from, overrides included.
    pub value: Value,
    /// File as given on the command line.
    pub file: String,
    /// SHA-256 of the JSON.
    pub sha256: String,
    /// Overrides that the JSON contains, path to value.
    pub overrides: Map<String, Value>,
}

impl Case {
    /// Reads a case file and applies `path=value` overrides.
    ///
    /// # Errors
    /// A file that can't be read, is not JSON, or has unknown keys or wrong types; a bad override.
    pub fn load(path: &Path, set: &[String]) -> Result<LoadedCase> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, "read", &e))?;
        Self::parse(&path.display().to_string(), &text, set)
    }

    /// A case from the text of a file, with overrides; `file` is its name in messages.
    ///
    /// # Errors
    /// Text that is not JSON, or has unknown keys or wrong types; a bad override.
    pub fn parse(file: &str, text: &str, set: &[String]) -> Result<LoadedCase> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let Strict(mut value) = serde_json::from_str(text).map_err(|e| Error::Syntax {
            file: file.to_owned(),
            line: e.line(),
            column: e.column(),
            message: syntax_words(&e.to_string()),
        })?;
        let mut overrides = Map::new();
        for item in set {
            let (path, text) = item.split_once('=').ok_or_else(|| {
                Error::Usage(format!("--set {item}: write PATH=VALUE, e.g. shaft.segments.0.elements=8"))
            })?;
            let new = match serde_json::from_str(text) {
                Ok(Strict(new)) => new,
                Err(_) => Value::String(text.to_owned()),
            };
            replace(&mut value, path, new.clone())?;
            overrides.insert(path.to_owned(), new);
        }
        Ok(LoadedCase { overrides, ..LoadedCase::from_value(file, value)? })
    }
}

impl Case {
    /// What it describes: a contact scene has bodies, or their contact, and no shaft.
    pub fn kind(&self) -> CaseKind {
        let scene = self.shaft.is_none() && (!self.bodies.is_empty() || self.contact.is_some());
        if scene { CaseKind::Scene } else { CaseKind::Shaft }
    }

    /// The analysis of an expected value that names none.
    pub fn default_analysis(&self) -> Analysis {
        if self.campbell.is_some() {
            Analysis::Campbell
        } else if self.contact.is_some() {
            Analysis::Contact
        } else {
            Analysis::Modes
        }
    }
}

impl LoadedCase {
    /// A case from JSON in memory.
    ///
    /// # Errors
    /// Unknown keys or wrong types.
    pub fn from_value(file: &str, value: Value) -> Result<Self> {
        let case: Case = serde_path_to_error::deserialize(whole_numbers(&value)).map_err(|e| {
            let path = e.path().to_string();
            input_error(file, &value, path.trim_start_matches('.'), &e.into_inner().to_string())
        })?;
        if let Some((path, allowed)) =
            other_container(&value, &serde_json::to_value(&case).unwrap_or_default(), "")
        {
            return Err(input_error(file, &value, &path, &format!("wrong type; {allowed}")));
        }
        let sha256 = Sha256::digest(value.to_string()).iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { case, value, file: file.to_owned(), sha256, overrides: Map::new() })
    }

    /// The same case with overrides.
    ///
    /// # Errors
    /// A bad override.
    pub fn with(&self, set: &Map<String, Value>) -> Result<Self> {
        let (mut value, mut overrides) = (self.value.clone(), self.overrides.clone());
        for (path, new) in set {
            replace(&mut value, path, new.clone())?;
            overrides.insert(path.clone(), new.clone());
        }
        Ok(Self { overrides, ..Self::from_value(&self.file, value)? })
    }

    /// An [`Error::Refused`] about the value at a JSON path.
    pub fn fault(&self, path: &str, problem: impl Into<String>, allowed: impl Into<String>) -> Error {
        self.locate(Refusal::at(path, problem, allowed).into())
    }

    /// Fills in what a refusal does not know: the file, and what stands at its path. Other errors stay as they are.
    pub fn locate(&self, error: Error) -> Error {
        let Error::Refused(mut refusal) = error else { return error };
        if refusal.file.is_none() {
            refusal.file = Some(self.file.clone());
            refusal.found = Some(at(&self.value, &refusal.path).map_or("missing".to_owned(), short));
            refusal.path = shown(&refusal.path);
        }
        refusal.into()
    }
}
