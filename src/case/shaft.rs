//! What a shaft is made of, as written: materials, sections, segments, disks, supports, loads, probes.

use crate::case::bearing_table::TableInput;
use crate::section::Surface;
use crate::units::{
    Damping, Density, Force, Inertia, Length, LinearDensity, Mass, Matrix, Moment, Rate, Stiffness, Stress,
    TiltDamping, TiltStiffness, Time,
};
use schemars::JsonSchema;
use serde::de::{self, IntoDeserializer};
use serde::{Deserialize, Serialize};

/// Isotropic elastic material.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Material")]
pub struct MaterialInput {
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
    #[serde(default = "default_stiffness_damping")]
    pub stiffness: Time,
    /// External damping alpha: force -alpha M v, 1/s.
    #[serde(default = "default_mass_damping")]
    pub mass: Rate,
    /// Loss factor eta of the turning material: a stress that alternates at any frequency lags its strain, S = C : E (1 + i eta).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub loss_factor: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Default for MaterialDamping {
    fn default() -> Self {
        Self { stiffness: default_stiffness_damping(), mass: default_mass_damping(), loss_factor: 0.0 }
    }
}

fn default_stiffness_damping() -> Time {
    Time(0.0)
}

fn default_mass_damping() -> Rate {
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
#[schemars(rename = "Section")]
pub struct SectionInput {
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
    pub quadrature: QuadratureInput,
}

/// Integration of nonlinear forces.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Quadrature")]
pub enum QuadratureInput {
    /// A rule by name.
    Named(QuadratureName),
    /// Numbers of Gauss points.
    Points(QuadraturePoints),
}

impl<'de> Deserialize<'de> for QuadratureInput {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        d.deserialize_any(QuadratureVisitor)
    }
}

struct QuadratureVisitor;

impl<'de> de::Visitor<'de> for QuadratureVisitor {
    type Value = QuadratureInput;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(r#""exact", "reduced", or { "axial": .., "section": .. }"#)
    }
    fn visit_str<E: de::Error>(self, name: &str) -> std::result::Result<QuadratureInput, E> {
        QuadratureName::deserialize(name.into_deserializer()).map(QuadratureInput::Named)
    }
    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> std::result::Result<QuadratureInput, A::Error> {
        QuadraturePoints::deserialize(de::value::MapAccessDeserializer::new(map)).map(QuadratureInput::Points)
    }
}

impl Default for QuadratureInput {
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
    /// Name of the section at the right end of a taper: all lengths go linearly from those of `section` to those of this one,
    /// which has the same shape (circle and tube are one). Elements 34X1 .. 34X5; by default `section` all along.
    pub to_section: Option<String>,
    /// Name of a material.
    pub material: String,
    /// Element of this segment, when it differs from the shaft's.
    pub element: Option<String>,
    /// Mass per length that carries no load (laminations, windings, sleeves): it moves with the mean displacement of each
    /// section and has no inertia about axes within it. External damping of the material acts on it, too.
    pub added_mass_per_length: Option<LinearDensity>,
    /// Axial force that the segment carries at rest, tension positive: uniform initial stress P/A in modes and campbell. Its
    /// direction stays. Refused by static and spinup: there forces are loads.
    pub axial_force: Option<Force>,
    /// Torque that a segment of round sections carries at rest, that of its right face along +x positive: initial shear T r/J in
    /// modes and campbell, the shear on its faces keeps its direction (semi-tangential). Refused by static and spinup.
    pub torque: Option<Moment>,
    /// How its left end meets the segment before: as one body where their sections overlap (default), or by a thin "face" that
    /// stays plane and undistorted and may widen as a whole, for sections that need not overlap.
    pub joint: Option<JointInput>,
}

/// How a segment meets the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(rename = "Joint")]
pub enum JointInput {
    /// By a thin face that keeps both sections plane.
    Face,
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
#[schemars(rename = "Disk")]
pub struct DiskInput {
    /// Position along the shaft.
    pub at: Length,
    /// Mass (with polar_inertia and diametral_inertia; alone it is a point mass).
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
#[schemars(rename = "SupportKind")]
pub enum SupportKindInput {
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
    /// Linear springs and dampers.
    Bearing,
    /// As a bearing that carries no static load: `rotor static` leaves it out. A negative stiffness is usual.
    Seal,
}

/// How a clamped, revolute or cylindrical support holds the section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(rename = "SectionHold")]
pub enum SectionHoldInput {
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
#[schemars(rename = "Support")]
pub struct SupportInput {
    /// Position along the shaft.
    pub at: Length,
    /// Kind of support.
    pub kind: Option<SupportKindInput>,
    /// Exactly these components: vector names (r, y, z, yz, yy, zz, ..; "all") or components ("y.x").
    pub fix: Option<Vec<String>>,
    /// Clamped, revolute, cylindrical: how the section is held.
    pub section: Option<SectionHoldInput>,
    /// Revolute, cylindrical: rotation prescribed by the drive (default) or free.
    pub driven: Option<bool>,
    /// Pinned, roller, bearing, seal: the mean displacement of the section (default), its bore or its rim, or the axis vector;
    /// clamped, revolute, cylindrical with a plane section: what is held in the plane (mean displacement and turn of
    /// section, bore or rim; by default the axis vector and the section's turn, on ring elements those of the section).
    pub acts_on: Option<ActsOn>,
    /// Bearing, seal: [[kyy, kyz], [kzy, kzz]], or one number for the same in y and z.
    pub stiffness: Option<Matrix<Stiffness>>,
    /// Bearing, seal: [[cyy, cyz], [czy, czz]], or one number for the same in y and z; default zero.
    pub damping: Option<Matrix<Damping>>,
    /// Bearing, seal: its coefficients over speed, in place of stiffness and damping: a list of rows, or a file.
    pub table: Option<TableInput>,
    /// Bearing, seal: added mass [[myy, myz], [myz, mzz]] of what moves with the shaft, or one number; default zero.
    pub mass: Option<Matrix<Mass>>,
    /// Bearing, seal: stiffness along the axis, to the ground.
    pub axial_stiffness: Option<Stiffness>,
    /// Bearing, seal: damping along the axis.
    pub axial_damping: Option<Damping>,
    /// Bearing, seal: moments about y and z by the section's turn about y and z, [[kyy, kyz], [kzy, kzz]] or one number; to the
    /// ground.
    pub tilt_stiffness: Option<Matrix<TiltStiffness>>,
    /// Bearing, seal: the same by the rate of that turn.
    pub tilt_damping: Option<Matrix<TiltDamping>>,
    /// Bearing, seal: moment about x by the section's turn beside the steady rotation; to the ground.
    pub torsional_stiffness: Option<TiltStiffness>,
    /// Bearing, seal: the same by the rate of that turn.
    pub torsional_damping: Option<TiltDamping>,
    /// Bearing, seal: how far along y and z it stands from the undeformed axis (raised, misaligned), default 0; acts in static
    /// and spinup.
    pub offset: Option<[Length; 2]>,
    /// Bearing, seal: what stands between the lateral springs and the ground.
    pub housing: Option<HousingInput>,
}

/// The housing of a bearing: its own, by mass and springs to the ground, or one of `housings` by name.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Housing")]
pub struct HousingInput {
    /// Name of a housing in `housings`, which several bearings may share.
    #[serde(rename = "ref")]
    pub name: Option<String>,
    /// Mass that moves along y and z, [[myy, myz], [myz, mzz]] or one number.
    pub mass: Option<Matrix<Mass>>,
    /// Stiffness to the ground, [[kyy, kyz], [kzy, kzz]] or one number.
    pub stiffness: Option<Matrix<Stiffness>>,
    /// Damping to the ground, default zero.
    pub damping: Option<Matrix<Damping>>,
}

/// A housing (pedestal, frame) that bearings share: it moves along y and z and does not turn.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "SharedHousing")]
pub struct SharedHousingInput {
    /// Mass, [[myy, myz], [myz, mzz]] or one number.
    pub mass: Matrix<Mass>,
    /// Stiffness to the ground, [[kyy, kyz], [kzy, kzz]] or one number.
    pub stiffness: Matrix<Stiffness>,
    /// Damping to the ground, default zero.
    pub damping: Option<Matrix<Damping>>,
}

/// A coupling: springs and dampers in six directions between the section to the left and that to the right.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Coupling")]
pub struct CouplingInput {
    /// Position along the shaft.
    pub at: Length,
    /// Against displacement along y and z, [[kyy, kyz], [kzy, kzz]] or one number.
    pub stiffness: Matrix<Stiffness>,
    /// Damping of that, default zero.
    pub damping: Option<Matrix<Damping>>,
    /// Against displacement along the axis.
    pub axial_stiffness: Stiffness,
    /// Damping of that, default zero.
    pub axial_damping: Option<Damping>,
    /// Against turns about y and z, [[kyy, kyz], [kzy, kzz]] or one number.
    pub tilt_stiffness: Matrix<TiltStiffness>,
    /// Damping of that, default zero.
    pub tilt_damping: Option<Matrix<TiltDamping>>,
    /// Against turns about the axis.
    pub torsional_stiffness: TiltStiffness,
    /// Damping of that, default zero.
    pub torsional_damping: Option<TiltDamping>,
}

/// A load: force or moment at a position, or traction or pressure on a surface.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Load")]
pub struct LoadInput {
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
#[schemars(rename = "Probe")]
pub struct ProbeInput {
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
