//! A checked contact scene: beams, what holds and loads them, and how contact is enforced.

pub use crate::case::Face;
use crate::model::Model;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// Stiffness and inertia per length of a planar beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSection {
    /// Stiffness EA against stretch, N.
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
    /// A planar body of elements 2322s.
    Planar(PlanarSection),
    /// 3333s or 34X3: a shaft along its own x axis, of one segment.
    Spatial(Box<Model>),
}

/// Kind of a body's support.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// All vectors of the section.
    Clamped,
    /// Both components of the axis at a node.
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
    /// Length of the body, m.
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
    /// Velocity of the whole body at the start, m/s.
    pub velocity: Vector3<f64>,
    /// Whether gravity acts on it.
    pub gravity: bool,
    /// Nodes that are held.
    pub supports: Vec<(usize, Hold)>,
    /// Loads on the body.
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
    /// Contact is switched off.
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
    /// The semi-implicit Euler step.
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
    /// How contact is enforced.
    pub method: Enforcement,
    /// Pressure per penetration along lines as written, N/m^3; `None` for that of [`Scene::penalty`].
    pub penalty: Option<f64>,
    /// Force per penetration at corners as written, N/m; `None` for that of [`Scene::point_penalty`].
    pub point_penalty: Option<f64>,
    /// Integration segments per slave element.
    pub segments: usize,
    /// Whether they are cut where master elements end.
    pub cut: bool,
    /// End of the motion, s; `None` for equilibrium.
    pub until: Option<f64>,
    /// Length of a step, s.
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
    /// The bodies of the scene.
    pub bodies: Vec<Body>,
    /// Gravity, m/s^2.
    pub gravity: Vector3<f64>,
    /// Settings of contact between the bodies.
    pub contact: ContactSettings,
    /// What is written in the case without being of use.
    pub unused: Vec<Unused>,
}

/// Keys of a case that its analysis has no use for.
#[derive(Debug, Clone, PartialEq)]
pub struct Unused {
    /// JSON paths of the settings that are not used.
    pub paths: Vec<String>,
    /// Why they are not used.
    pub reason: &'static str,
}

/// `10 E/H` of the softer modulus and the smaller height, N/m^3.
fn default_penalty(a: &Body, b: &Body) -> f64 {
    10.0 * a.modulus.min(b.modulus) / a.height.min(b.height)
}

impl Scene {
    /// True when all bodies are planar.
    pub fn is_planar(&self) -> bool {
        self.bodies.iter().all(|b| matches!(b.beam, Beam::Planar(_)))
    }

    /// Pressure per penetration along lines between two bodies, N/m^3: as written, or `10 E/H` with the modulus of the softer one (what
    /// is pressed together yields as it does) and the smaller height.
    pub fn penalty(&self, a: usize, b: usize) -> f64 {
        self.contact.penalty.unwrap_or_else(|| default_penalty(&self.bodies[a], &self.bodies[b]))
    }

    /// Largest [`Self::penalty`] of two bodies that may meet, N/m^3.
    pub fn largest_penalty(&self) -> f64 {
        // bodies alike meet others alike: one of each kind, and a second one if there is one
        let kind = |body: &Body| (body.modulus.to_bits(), body.height.to_bits());
        let mut kinds: BTreeMap<(u64, u64), Vec<&Body>> = BTreeMap::new();
        for body in &self.bodies {
            let list = kinds.entry(kind(body)).or_default();
            list.truncate(1);
            list.push(body);
        }
        let list: Vec<&Body> = kinds.into_values().flatten().collect();
        let alone = self.contact.with_itself || list.len() == 1;
        let pairs = list
            .iter()
            .enumerate()
            .flat_map(|(k, a)| list[k + usize::from(!alone)..].iter().map(move |b| (a, b)));
        let largest = pairs.map(|(a, b)| default_penalty(a, b)).fold(0.0, f64::max);
        self.contact.penalty.unwrap_or(largest)
    }

    /// Force per penetration at a corner of a body, N/m: as written, or a penalty times its height and width.
    pub fn point_penalty(&self, body: usize, penalty: f64) -> f64 {
        let Body { height, width, .. } = self.bodies[body];
        self.contact.point_penalty.unwrap_or(penalty * height * width)
    }
}
