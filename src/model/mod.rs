//! The checked model: what a case file means, free of units, names and optional keys.
//! Every number is finite, SI, and in its allowed range; every position is a node.

pub mod scene;

use crate::instructions::Instructions;
use crate::section::basis::SectionBasis;
use crate::section::{Section, Surface};

/// Isotropic linear elastic material with Kelvin-Voigt and external damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson_ratio: f64,
    /// Density, kg/m^3.
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
    /// Elastic law.
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
    /// Length, m.
    pub length: f64,
    /// Index of its left node.
    pub first_node: usize,
    /// Member of the family.
    pub kind: ElementKind,
    /// Index into [`Model::sections`].
    pub section: usize,
    /// Index into [`Model::materials`].
    pub material: usize,
    /// At its left and right end: whether its vectors follow those of the neighbour, see [`Node::follower`].
    pub follows: [bool; 2],
}

/// Functions of one section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// Which functions.
    pub basis: SectionBasis,
    /// Of which section: index into [`Model::sections`].
    pub section: usize,
}

/// A node on the axis with its vectors. Where two elements of different functions meet, those of the richer side
/// follow: they are the projection of the node's own field on the area that both sides share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position, m.
    pub x: f64,
    /// What its own vectors multiply.
    pub field: Field,
    /// What the vectors of the neighbour that follows multiply.
    pub follower: Option<Field>,
}

impl Node {
    /// Its own vectors.
    pub fn n_vectors(&self) -> usize {
        self.field.basis.count()
    }

    /// For each of its vectors, followers after its own, whether the function it multiplies changes its sign under
    /// y -> -y and under z -> -z.
    pub fn odd(&self) -> Vec<[bool; 2]> {
        let mut list = self.field.basis.odd();
        list.extend(self.follower.iter().flat_map(|f| f.basis.odd()));
        list
    }
}

/// How a disk holds the section it sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hub {
    /// The section stays plane and undeformed.
    Rigid,
    /// The inertia acts on r, r_,y and r_,z only; the section may deform.
    Soft,
    /// The inertia acts on the mean affine motion of the inner boundary; the section may deform.
    Bore,
    /// The same of the outer boundary.
    Rim,
}

impl Hub {
    /// What the disk's inertia acts on.
    pub fn acts_on(self) -> ActsOn {
        match self {
            Self::Rigid | Self::Soft => ActsOn::Axis,
            Self::Bore => ActsOn::Bore,
            Self::Rim => ActsOn::Rim,
        }
    }

    /// Name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Soft => "soft",
            Self::Bore => "bore",
            Self::Rim => "rim",
        }
    }
}

/// A rigid disk at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// Node it sits on.
    pub node: usize,
    /// kg.
    pub mass: f64,
    /// kg m^2.
    pub polar_inertia: f64,
    /// kg m^2, at least half the polar inertia.
    pub diametral_inertia: f64,
    /// Offset of the centre of mass along the section's y and z, m.
    pub offset: [f64; 2],
    /// How it holds the shaft.
    pub hub: Hub,
}

impl Disk {
    /// `Id - Jp/2`, what the thickness adds to the diametral inertia of a thin disk, kg m^2; zero within rounding.
    pub fn thickness_inertia(&self) -> f64 {
        let excess = self.diametral_inertia - self.polar_inertia / 2.0;
        if excess > 1e-12 * self.diametral_inertia { excess } else { 0.0 }
    }
}

/// What a support or load takes hold of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsOn {
    /// The whole section (mean displacement, mean rotation).
    Section,
    /// The axis vector r only.
    Axis,
    /// The inner boundary (its mean displacement, its mean rotation).
    Bore,
    /// The outer boundary.
    Rim,
}

impl ActsOn {
    /// The line it is, if any.
    pub fn surface(self) -> Option<Surface> {
        match self {
            Self::Section | Self::Axis => None,
            Self::Bore => Some(Surface::Bore),
            Self::Rim => Some(Surface::Rim),
        }
    }
}

/// A linear spring-damper bearing at a node, in the fixed y, z directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Bearing {
    /// Node it holds.
    pub node: usize,
    /// `[[kyy, kyz], [kzy, kzz]]`, N/m; the symmetric part is positive semi-definite.
    pub stiffness: [[f64; 2]; 2],
    /// `[[cyy, cyz], [czy, czz]]`, N s/m.
    pub damping: [[f64; 2]; 2],
    /// What it holds.
    pub acts_on: ActsOn,
    /// JSON path, for reports.
    pub path: String,
}

/// How an end section of a kinematic support behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionHold {
    /// Stays plane; may expand in its plane, in which this is held.
    Plane(ActsOn),
    /// Keeps its shape entirely.
    Rigid,
}

/// Kinematic supports, see docs/theory/supports.md#kinds.
#[derive(Debug, Clone, PartialEq)]
pub enum SupportKind {
    /// No displacement, no tilt, no rotation.
    Clamped(SectionHold),
    /// As clamped, spinning: its mean rotation follows the drive, or is free when not driven.
    Revolute {
        /// How the section is held.
        hold: SectionHold,
        /// Rotation prescribed by the drive.
        driven: bool,
    },
    /// As revolute, free along the axis.
    Cylindrical {
        /// How the section is held.
        hold: SectionHold,
        /// Rotation prescribed by the drive.
        driven: bool,
    },
    /// Mean displacement held in x, y and z; tilt free.
    Pinned(ActsOn),
    /// Mean displacement held in y and z; tilt free.
    Roller(ActsOn),
    /// Nothing held but the mean rotation of the section, which the drive prescribes.
    Turned,
    /// Exactly these components: `(vector index, component)`, in the order of the element's vectors.
    Fix(Vec<(usize, usize)>),
}

/// A kinematic support at a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Node it holds.
    pub node: usize,
    /// What it holds.
    pub kind: SupportKind,
    /// JSON path, for messages.
    pub path: String,
}

/// Where displacements are read.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name in reports.
    pub name: String,
    /// Position along the shaft, m.
    pub x: f64,
    /// Points `[y, z]` in the section, m.
    pub points: Vec<[f64; 2]>,
}

/// Whose gyroscopic terms act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gyroscopic {
    /// Shaft and disks.
    All,
    /// Disks only.
    Disks,
    /// None.
    None,
}

/// Frame in which whirl frequencies are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhirlFrame {
    /// Fixed in space.
    Stationary,
    /// Turning with the shaft.
    Rotating,
}

/// What the linear equations of a spinning shaft contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Stiffness at rest; no centrifugal effect.
    Classical,
    /// Tangent stiffness at the spinning equilibrium, with spin softening.
    Consistent,
}

/// Settings of the sweep over speed.
#[derive(Debug, Clone, PartialEq)]
pub struct CampbellSettings {
    /// Speeds as asked for, ascending, rad/s.
    pub speeds: Vec<f64>,
    /// Branches to report.
    pub modes: usize,
    /// Frame of the frequencies.
    pub frame: WhirlFrame,
    /// Form of the equations.
    pub form: Form,
    /// Size of the modal basis; `None` for the unreduced problem.
    pub reduction: Option<usize>,
    /// Whose gyroscopic terms act.
    pub gyroscopic: Gyroscopic,
    /// Excitation orders to draw besides 1x.
    pub orders: Vec<f64>,
}

/// How the nonlinear force and tangent are integrated over an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quadrature {
    /// Gauss points along the element; `None` for as many as exact integration takes.
    pub axial: Option<usize>,
    /// Gauss points of the section rule in each direction; `None` for exact section moments.
    pub section: Option<usize>,
}

impl Quadrature {
    /// No quadrature error.
    pub const EXACT: Self = Self { axial: None, section: None };
}

/// What a load at a node does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadKind {
    /// Force `[x, y, z]`, N.
    Force([f64; 3]),
    /// Moment about `[x, y, z]`, N m.
    Moment([f64; 3]),
}

/// What happens to a load when the shaft moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// Axes fixed in space: a force on the section where it is, a moment on its rotation, a traction per undeformed area.
    FixedInSpace,
    /// Axes that turn with the section; pressure on the surface as it is.
    Following,
    /// The tractions that the load is on the undeformed shaft, in size and direction, whatever the motion.
    Dead,
}

/// A load at a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Node it acts on.
    pub node: usize,
    /// Force or moment.
    pub kind: LoadKind,
    /// What it takes hold of.
    pub acts_on: ActsOn,
    /// How it moves.
    pub reading: Reading,
    /// JSON path, for messages and reports.
    pub path: String,
}

impl Load {
    /// True when it does not change as seen from the turning shaft: it follows, or acts along or about x alone.
    pub fn is_constant_in_turning_frame(&self) -> bool {
        let (axial, turns) = match self.kind {
            LoadKind::Force([_, y, z]) => ([y, z] == [0.0; 2], true),
            LoadKind::Moment([_, y, z]) => ([y, z] == [0.0; 2], self.reading != Reading::Dead),
        };
        self.reading == Reading::Following || (axial && turns)
    }
}

/// Force per area of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceLoad {
    /// Force per undeformed area `[x, y, z]`, Pa.
    Traction([f64; 3]),
    /// Against the surface, Pa.
    Pressure(f64),
}

/// A load on a part of the lateral surface of the whole shaft, of its bore where it has one.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Where.
    pub surface: Surface,
    /// How much.
    pub load: SurfaceLoad,
    /// How it moves; pressure follows or is dead.
    pub reading: Reading,
    /// JSON path, for messages and reports.
    pub path: String,
}

impl Traction {
    /// True when it does not change as seen from the turning shaft: it follows, or acts along x alone.
    pub fn is_constant_in_turning_frame(&self) -> bool {
        self.reading == Reading::Following
            || matches!(self.load, SurfaceLoad::Traction([_, y, z]) if [y, z] == [0.0; 2])
    }
}

/// Settings of the static analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticSettings {
    /// Load steps; each is cut further where Newton's method does not converge.
    pub load_steps: usize,
    /// Most Newton iterations of a step.
    pub max_iterations: usize,
    /// Relative energy of the last correction at which a step counts as converged.
    pub tolerance: f64,
}

/// How the speed changes over a phase of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Along half a cosine.
    Cosine,
    /// Along a straight line: the acceleration jumps at its ends.
    Linear,
}

/// End of a phase of the drive: the speed changes from that of the phase before along half a cosine,
/// `Omega(t) = a + (b - a) (1 - cos(pi (t - t0) / (until - t0))) / 2`, or linearly. The first phase starts at t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// End, s.
    pub until: f64,
    /// Speed at the end, rad/s; negative against the positive sense about x.
    pub speed: f64,
    /// How it gets there.
    pub shape: Shape,
}

/// Frame in which a transient is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// Turning with the drive.
    Rotating,
    /// Fixed in space.
    Inertial,
}

/// Integrator of a transient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// Singly diagonally implicit Runge-Kutta of order 4 with an embedded order 3.
    Esdirk,
    /// Generalized-alpha of Chung and Hulbert, spectral radius at infinity `rho_infinity` of the settings.
    GeneralizedAlpha,
    /// Explicit Adams predictor and corrector of variable order and step.
    Adams,
}

/// Settings of the spin-up.
#[derive(Debug, Clone, PartialEq)]
pub struct SpinupSettings {
    /// Speed at t = 0, rad/s.
    pub start_speed: f64,
    /// Phases of the drive, ends ascending; the last speed is kept. None when a torque drives.
    pub drive: Vec<Phase>,
    /// Torque of the drive over its speed, points (rad/s, N m), speeds ascending; none when the speed is prescribed.
    pub torque: Vec<[f64; 2]>,
    /// End of the simulation, s.
    pub until: f64,
    /// Frame of the unknowns.
    pub frame: Frame,
    /// Integrator.
    pub integrator: Integrator,
    /// Relative tolerance of a step.
    pub rtol: f64,
    /// Absolute tolerance of a step, on displacements over the reference length.
    pub atol: f64,
    /// Spectral radius at infinite frequency of generalized-alpha, in [0, 1].
    pub rho_infinity: f64,
    /// Fixed step, s; `None` for steps chosen by the error estimate.
    pub step: Option<f64>,
    /// Most steps before the run is given up.
    pub max_steps: usize,
    /// Times of the history, equally spaced from 0 to the end, at least 2.
    pub output: usize,
    /// Only the equilibrium at the last speed, no transient.
    pub steady: bool,
    /// Node whose section the drive turns without holding it otherwise.
    pub driven_node: Option<usize>,
    /// Rings around the shaft.
    pub stators: Vec<Stator>,
}

impl SpinupSettings {
    /// Largest speed by size that is named, rad/s.
    pub fn largest_speed(&self) -> f64 {
        let named = self.drive.iter().map(|p| p.speed).chain(self.torque.iter().map(|point| point[0]));
        named.fold(self.start_speed.abs(), |m: f64, w| m.max(w.abs()))
    }
}

/// A rigid ring at rest around the shaft, centred on the undeformed axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Stator {
    /// Node whose axis point moves in it; an element end.
    pub node: usize,
    /// Position along the shaft as written, m.
    pub at: f64,
    /// Radial play of the axis, m.
    pub clearance: f64,
    /// Force per penetration, N/m.
    pub stiffness: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Radius of the shaft's surface there, the larger one at a step, m.
    pub radius: f64,
    /// JSON path.
    pub path: String,
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
    /// Disks.
    pub disks: Vec<Disk>,
    /// Bearings.
    pub bearings: Vec<Bearing>,
    /// Kinematic supports.
    pub supports: Vec<Support>,
    /// Probes.
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
    /// Static analysis.
    pub statics: StaticSettings,
    /// Spin-up, when the case has one.
    pub spinup: Option<SpinupSettings>,
}

/// Names of materials and sections in the case, by their indices in a [`Model`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Names {
    /// Of [`Model::materials`].
    pub materials: Vec<String>,
    /// Of [`Model::sections`].
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

    /// True when forces, moments or tractions act.
    pub fn has_loads(&self) -> bool {
        !self.loads.is_empty() || !self.tractions.is_empty()
    }
}
