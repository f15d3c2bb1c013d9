//! The checked model: what a case file means, free of units, names and optional keys.
//! Every number is finite, SI, and in its allowed range; every position is a node.

mod attachments;
mod bearing_table;
pub mod scene;
mod settings;

pub use attachments::*;
pub use bearing_table::*;
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
    /// Index into [`Model::sections`].
    pub section: usize,
    /// Index into [`Model::materials`].
    pub material: usize,
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
    /// Linear bearings at nodes.
    pub bearings: Vec<Bearing>,
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

    /// Largest estimate of the relative error that the functions of automatically chosen elements leave.
    pub fn estimated_error(&self) -> Option<f64> {
        self.choices.iter().map(|choice| choice.estimated_error).reduce(f64::max)
    }

    /// True when sections and disks look the same at every angle.
    pub fn is_axisymmetric(&self) -> bool {
        self.sections.iter().all(Section::is_axisymmetric)
            && self.disks.iter().all(|d| d.offset == [0.0, 0.0])
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
