//! A checked contact scene: beams, what holds and loads them, and how contact is enforced.

use super::Model;
use nalgebra::{Matrix3, Vector3};

/// Stiffness and inertia per length of a planar beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSection {
    /// EA, N.
    pub axial: f64,
    /// ks GA, N.
    pub shear: f64,
    /// EI, N m^2.
    pub bending: f64,
    /// EA_t, against the change of height, N.
    pub thickness: f64,
    /// rho A, kg/m.
    pub mass: f64,
    /// rho I, kg m.
    pub inertia: f64,
}

/// What a body is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Beam {
    /// 2322s.
    Planar(PlanarSection),
    /// 3333s or 34X3: a shaft along its own x axis, of one segment.
    Spatial(Box<Model>),
}

/// Kind of a body's support.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// All vectors of the section.
    Clamped,
    /// The axis.
    Pinned,
    /// The axis in x only.
    PinnedX,
    /// The axis in y only.
    PinnedY,
}

impl Hold {
    /// True when both hold the same component.
    pub fn meets(self, other: Self) -> bool {
        !matches!((self, other), (Self::PinnedX, Self::PinnedY) | (Self::PinnedY, Self::PinnedX))
    }
}

/// A face of a planar body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    /// y = -H/2.
    Bottom,
    /// The end face at the end.
    End,
    /// y = H/2.
    Top,
    /// The end face at the start.
    Start,
}

/// What a load does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Dead force on the axis at a node, N.
    Force(usize, Vector3<f64>),
    /// Moment on the section at a node of a planar body, N m, counter-clockwise.
    Moment(usize, f64),
    /// Pressure on a face of a planar body, Pa, on its present area and against its present normal.
    Pressure(Face, f64),
}

/// A load on a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyLoad {
    /// What it does.
    pub action: Action,
    /// Time until which it acts, s.
    pub until: f64,
}

/// A beam of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in reports.
    pub name: String,
    /// Name of its element.
    pub element: String,
    /// What it is made of.
    pub beam: Beam,
    /// m.
    pub length: f64,
    /// Number of elements.
    pub elements: usize,
    /// Height H in the plane, of a circle the diameter, m.
    pub height: f64,
    /// Width across the plane, m.
    pub width: f64,
    /// Young's modulus that a default penalty goes by, Pa.
    pub modulus: f64,
    /// Place of the axis at its start, m.
    pub start: Vector3<f64>,
    /// Columns are the body's own axes.
    pub frame: Matrix3<f64>,
    /// m/s.
    pub velocity: Vector3<f64>,
    /// Whether gravity acts on it.
    pub gravity: bool,
    /// Nodes that are held.
    pub supports: Vec<(usize, Hold)>,
    /// Loads.
    pub loads: Vec<BodyLoad>,
}

impl Body {
    /// Nodes of an element less one.
    pub fn degree(&self) -> usize {
        match &self.beam {
            Beam::Planar(_) => 2,
            Beam::Spatial(model) => model.elements.first().map_or(3, |e| e.kind.axial_degree),
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.degree() * self.elements + 1
    }
}

/// How contact is enforced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Enforcement {
    /// Springs on penetration.
    Penalty,
    /// Complementarity of gap velocity and impulse, all contacts together.
    Lcp,
    /// One contact at a time, gap over step: for comparison.
    LcpSingle,
    /// Exact constraints in equilibrium.
    ActiveSet,
    /// No contact.
    None,
}

impl Enforcement {
    /// Name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Penalty => "penalty",
            Self::Lcp => "lcp",
            Self::LcpSingle => "lcp-single",
            Self::ActiveSet => "active-set",
            Self::None => "none",
        }
    }
}

/// Step in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stepping {
    /// Midpoint with discrete gradients.
    EnergyConsistent,
    /// Semi-implicit Euler.
    SemiImplicit,
}

impl Stepping {
    /// Name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::EnergyConsistent => "energy-consistent",
            Self::SemiImplicit => "semi-implicit-euler",
        }
    }
}

/// Settings of the contact analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSettings {
    /// Enforcement.
    pub method: Enforcement,
    /// Pressure per penetration along lines, N/m^3.
    pub penalty: f64,
    /// Force per penetration at corners, by body, N/m.
    pub point_penalty: Vec<f64>,
    /// Integration segments per slave element.
    pub segments: usize,
    /// Whether they are cut where master elements end.
    pub cut: bool,
    /// End of the motion, s; `None` for equilibrium.
    pub until: Option<f64>,
    /// s.
    pub step: f64,
    /// Step in time.
    pub stepping: Stepping,
    /// Contact of a body with itself.
    pub with_itself: bool,
    /// Points in the history.
    pub output: usize,
    /// Snapshots in the plot.
    pub snapshots: usize,
    /// Load steps of an equilibrium.
    pub load_steps: usize,
    /// Angle between surfaces above which a corner is a contact of its own, rad.
    pub corner_angle: f64,
}

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Beams.
    pub bodies: Vec<Body>,
    /// m/s^2.
    pub gravity: Vector3<f64>,
    /// Contact.
    pub contact: ContactSettings,
    /// What is written in the case without being of use.
    pub unused: Vec<Unused>,
}

/// Keys of a case that its analysis has no use for.
#[derive(Debug, Clone, PartialEq)]
pub struct Unused {
    /// JSON paths.
    pub paths: Vec<String>,
    /// Why.
    pub reason: &'static str,
}

impl Scene {
    /// True when all bodies are planar.
    pub fn is_planar(&self) -> bool {
        self.bodies.iter().all(|b| matches!(b.beam, Beam::Planar(_)))
    }
}
