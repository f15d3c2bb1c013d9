//! The checked model: what a case file means, free of units, names and optional keys.
//! Every number is finite, SI, and in its allowed range; every position is a node.

mod attachments;
mod bearing_table;
mod response;
pub mod scene;
mod settings;

pub use attachments::*;
pub use bearing_table::*;
pub use response::*;
pub use settings::*;

pub use crate::case::{ActsOn, Form, Frame, Gyroscopic, Hub, RampShape, WhirlFrame};
use crate::instructions::Instructions;
use crate::section::Section;
use crate::section::basis::SectionBasis;
use crate::section::kinks::Kinks;

/// Isotropic linear elastic material with Kelvin-Voigt and external damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson_ratio: f64,
    /// Density of the material, kg/m^3.
    pub density: f64,
    /// Kelvin-Voigt factor beta of `S = C : (E + beta dE/dt)`, s.
    pub stiffness_damping: f64,
    /// External damping alpha: force `-alpha M v`, 1/s.
    pub mass_damping: f64,
    /// Loss factor eta of the turning material.
    pub loss_factor: f64,
}

/// Elastic law of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Three-dimensional St. Venant-Kirchhoff (34X1 .. 34X5).
    Continuum,
    /// Continuum with Poisson coupling on the axis only (3333c).
    Split,
    /// Structural strains of a shear-deformable beam (3333s).
    Structural,
}

/// A member of the element family: data, not code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementKind {
    /// Degree p of the axial Lagrange polynomials; p + 1 nodes.
    pub axial_degree: usize,
    /// Functions of the section, as many as a node has vectors.
    pub basis: SectionBasis,
    /// Elastic law of the member.
    pub law: Law,
}

impl ElementKind {
    /// Vectors at each node of the element.
    pub fn n_vectors(&self) -> usize {
        self.basis.count()
    }

    /// Total degree of its section polynomials; of a ring the radial degree.
    pub fn polynomial_order(&self) -> usize {
        match self.basis {
            SectionBasis::Monomials(order) => order,
            SectionBasis::Ring { degree, .. } => degree,
        }
    }

    /// Name in case files.
    pub fn name(&self) -> String {
        match self.law {
            Law::Continuum => self.basis.member(),
            Law::Split => "3333c".to_owned(),
            Law::Structural => "3333s".to_owned(),
        }
    }

    /// Nodes of the element: p + 1.
    pub fn n_nodes(&self) -> usize {
        self.axial_degree + 1
    }
}

/// What a segment carries beside the mass and the stiffness of its section.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Carried {
    /// Mass per length that moves with the mean displacement of the section, kg/m.
    pub added_mass: f64,
    /// Axial force P of the initial stress `P/A`, tension positive, N.
    pub axial_force: f64,
    /// Torque T of the initial shear `T r/J`, about +x on a face that looks along +x, N m.
    pub torque: f64,
}

/// One beam element; it occupies the nodes `first_node ..= first_node + axial_degree`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Position of its left end, m.
    pub x: f64,
    /// Length of the element, m.
    pub length: f64,
    /// Index of its left node.
    pub first_node: usize,
    /// Member of the family.
    pub kind: ElementKind,
    /// Kinked functions beside those of the member, near a step.
    pub kinks: Kinks,
    /// Index into [`Model::sections`]; of a tapered element the section halfway.
    pub section: usize,
    /// Sections of its left and right end, between which all lengths change linearly.
    pub faces: [usize; 2],
    /// Index into [`Model::materials`].
    pub material: usize,
    /// Added mass and initial stress.
    pub carried: Carried,
    /// At its left and right end: whether its vectors follow those of the neighbour, see [`Node::follower`].
    pub follows: [bool; 2],
}

impl Element {
    /// The functions of its section.
    pub fn field(&self) -> Field {
        Field { basis: self.kind.basis, kinks: self.kinks, section: self.section }
    }

    /// Vectors at each of its nodes.
    pub fn n_vectors(&self) -> usize {
        self.field().count()
    }

    /// The section of its end at a node; `None` where it does not end.
    pub fn face_at(&self, node: usize) -> Option<usize> {
        let ends = [self.first_node, self.first_node + self.kind.axial_degree];
        ends.iter().position(|end| *end == node).map(|end| self.faces[end])
    }

    /// True when its section changes along it.
    pub fn is_tapered(&self) -> bool {
        self.faces[0] != self.faces[1]
    }
}

/// Functions of one section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Functions across the section.
    pub basis: SectionBasis,
    /// Kinked functions behind them.
    pub kinks: Kinks,
    /// Of which section: index into [`Model::sections`].
    pub section: usize,
}

impl Field {
    /// Number of functions, hence of vectors.
    pub fn count(&self) -> usize {
        self.basis.count() + self.kinks.count()
    }

    /// For each function whether it changes its sign under y -> -y and under z -> -z.
    pub fn odd(&self) -> Vec<[bool; 2]> {
        let mut list = self.basis.odd();
        list.extend(self.kinks.odd());
        list
    }
}

/// A node on the axis with its vectors. Where two elements of different functions meet, those of the richer side
/// follow: they are the projection of the node's own field on the area that both sides share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position of the node along the shaft, m.
    pub x: f64,
    /// What its own vectors multiply.
    pub field: Field,
    /// What the vectors of the neighbour that follows multiply.
    pub follower: Option<Field>,
    /// Joined by a thin face: plane and undistorted, it may widen as a whole.
    pub face: bool,
    /// Joined by the springs of a coupling alone: own vectors are those of the left side, and those of the right side, the follower's,
    /// are free.
    pub coupled: bool,
}

impl Node {
    /// Its own vectors.
    pub fn n_vectors(&self) -> usize {
        self.field.count()
    }

    /// For each of its vectors, followers after its own, whether the function it multiplies changes its sign under
    /// y -> -y and under z -> -z.
    pub fn odd(&self) -> Vec<[bool; 2]> {
        let mut list = self.field.odd();
        list.extend(self.follower.iter().flat_map(|f| f.odd()));
        list
    }
}

/// An element that the program chose (`"element": "auto"`).
#[derive(Debug, Clone, PartialEq)]
pub struct ElementChoice {
    /// Member, reason and estimate in words; the same for segments that are alike.
    pub text: String,
    /// Number of the segment, from 0.
    pub segment: usize,
    /// Estimate of the relative error that its section functions leave.
    pub estimated_error: f64,
}

/// A checked case.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Reference length R of the scaled unknowns: the largest half extent of any section, m.
    pub reference_length: f64,
    /// Length of the shaft, m.
    pub length: f64,
    /// Materials in use.
    pub materials: Vec<Material>,
    /// Sections in use.
    pub sections: Vec<Section>,
    /// What the case calls them.
    pub names: Names,
    /// JSON path of the first axial force or torque of a segment.
    pub initial_stress: Option<String>,
    /// Elements that the program chose itself (`"element": "auto"`), and why.
    pub choices: Vec<ElementChoice>,
    /// Places that stood beside an element end by rounding and were moved onto it, in words.
    pub snapped: Vec<String>,
    /// Elements from left to right.
    pub elements: Vec<Element>,
    /// Nodes from left to right.
    pub nodes: Vec<Node>,
    /// Rigid disks at nodes.
    pub disks: Vec<Disk>,
    /// Linear bearings at nodes, and the springs of housings.
    pub bearings: Vec<Bearing>,
    /// Housings between bearings and the ground.
    pub housings: Vec<Housing>,
    /// Supports that hold components of the motion.
    pub supports: Vec<Support>,
    /// Places where displacements and stresses are read.
    pub probes: Vec<Probe>,
    /// Gravity, m/s^2; zero when none is given (ignored by linear analyses about the unloaded state).
    pub gravity: [f64; 3],
    /// Loads at nodes (ignored by linear analyses about the unloaded state).
    pub loads: Vec<Load>,
    /// Loads on the lateral surface.
    pub tractions: Vec<Traction>,
    /// Integration of nonlinear forces.
    pub quadrature: Quadrature,
    /// Vector instructions of the force kernels.
    pub instructions: Instructions,
    /// Modes to report.
    pub modes: usize,
    /// Sweep, when the case has one.
    pub campbell: Option<CampbellSettings>,
    /// Settings of the static analysis.
    pub statics: StaticSettings,
    /// Speeds at which the machine runs, when the case says so.
    pub operating_speed: Option<OperatingSpeed>,
    /// Gaps that amplitudes are held against.
    pub clearances: Vec<Clearance>,
    /// Unbalance, when the case has one.
    pub unbalance: Option<UnbalanceSettings>,
    /// Masses beside the axis that are part of the mass matrix, as in a run-up.
    pub spinning_masses: Vec<Unbalance>,
    /// Harmonic excitation, when the case has one.
    pub harmonic: Option<HarmonicSettings>,
    /// Map of critical speeds, when the case has one.
    pub map: Option<MapSettings>,
    /// Spin-up, when the case has one.
    pub spinup: Option<SpinupSettings>,
}

/// Names of materials and sections in the case, by their indices in a [`Model`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Names {
    /// Names of [`Model::materials`] in the case.
    pub materials: Vec<String>,
    /// Names of [`Model::sections`] in the case.
    pub sections: Vec<String>,
}

impl Model {
    /// Sections of the ends of an element.
    pub fn faces(&self, e: &Element) -> [&Section; 2] {
        e.faces.map(|face| &self.sections[face])
    }

    /// The section of an element at x (m).
    pub fn section_in(&self, e: &Element, x: f64) -> Section {
        if !e.is_tapered() {
            return self.sections[e.section];
        }
        let [left, right] = self.faces(e);
        left.between(right, ((x - e.x) / e.length).clamp(0.0, 1.0))
    }

    /// The same shaft with the section turned that [`SpinupSettings::driven_node`] names.
    pub fn with_drive(&self, settings: &SpinupSettings) -> Self {
        let mut driven = self.clone();
        driven.supports.extend(settings.driven_node.map(|node| Support {
            node,
            kind: SupportKind::Turned,
            path: "spinup.driven_at".to_owned(),
        }));
        driven
    }

    /// The same shaft with the masses of the unbalance in its mass matrix; those of offset disks are there.
    pub fn with_unbalance(&self) -> Self {
        let mut model = self.clone();
        let masses = self.unbalance.iter().flat_map(|u| &u.masses);
        model.spinning_masses = masses.filter(|m| !m.of_disk).cloned().collect();
        model
    }

    /// The same shaft without its seals, which carry no static load.
    pub fn without_seals(&self) -> Self {
        let bearings = self.bearings.iter().filter(|b| !b.seal).cloned().collect();
        Self { bearings, ..self.clone() }
    }

    /// The same shaft with one stiffness to the ground, in all directions across the axis, in place of the lateral springs of the
    /// bearings with these paths; housings in which no bearing stands any more are left out.
    pub fn on_stiffness(&self, paths: &[String], stiffness: f64) -> Self {
        let mut model = self.clone();
        for bearing in model.bearings.iter_mut().filter(|b| b.resists == Resists::Lateral) {
            if paths.contains(&bearing.path) && bearing.holds_shaft() {
                bearing.between = Between::ShaftAndGround;
                bearing.stiffness = [[stiffness, 0.0], [0.0, stiffness]];
                (bearing.damping, bearing.table) = ([[0.0; 2]; 2], None);
            }
        }
        let used = |h: usize| model.bearings.iter().any(|b| b.between == Between::ShaftAndHousing(h));
        let kept: Vec<usize> = (0..model.housings.len()).filter(|h| used(*h)).collect();
        model.housings = kept.iter().map(|&h| self.housings[h].clone()).collect();
        model.bearings.retain_mut(|bearing| {
            let (Between::ShaftAndHousing(h) | Between::HousingAndGround(h)) = &mut bearing.between else {
                return true;
            };
            let place = kept.iter().position(|k| k == h);
            *h = place.unwrap_or(0);
            place.is_some()
        });
        model
    }

    /// Largest estimate of the relative error that the functions of automatically chosen elements leave.
    pub fn estimated_error(&self) -> Option<f64> {
        self.choices.iter().map(|choice| choice.estimated_error).reduce(f64::max)
    }

    /// True when sections and disks look the same at every angle.
    pub fn is_axisymmetric(&self) -> bool {
        self.sections.iter().all(Section::is_axisymmetric)
            && self.disks.iter().all(|d| d.offset == [0.0, 0.0])
            && self.spinning_masses.is_empty()
    }

    /// True when gravity acts.
    pub fn has_gravity(&self) -> bool {
        self.gravity.iter().any(|g| *g != 0.0)
    }

    /// True when a bearing stands beside the undeformed axis.
    pub fn has_bearing_offsets(&self) -> bool {
        self.bearings.iter().any(|b| b.offset != [0.0; 2])
    }

    /// True when forces, moments or tractions act.
    pub fn has_loads(&self) -> bool {
        !self.loads.is_empty() || !self.tractions.is_empty()
    }
}
