//! Settings of the analyses, checked.

use crate::case::{Form, Frame, Gyroscopic, RampShape, WhirlFrame};

/// Size of a modal basis where a case names none.
pub const DEFAULT_BASIS: usize = 60;
/// Vectors of a basis beyond the branches that are asked for: the motions that neighbours of the last branch are found among.
pub const SPARE_BASIS: usize = 8;

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

/// End of a phase of the drive: the speed changes from that of the phase before along half a cosine,
/// `Omega(t) = a + (b - a) (1 - cos(pi (t - t0) / (until - t0))) / 2`, or linearly. The first phase starts at t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Time at which the phase ends, s.
    pub until: f64,
    /// Speed at the end, rad/s; negative against the positive sense about x.
    pub speed: f64,
    /// How it gets there.
    pub shape: RampShape,
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
    /// Method of integration.
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
    /// JSON path of the ring, for reports.
    pub path: String,
}

impl WhirlFrame {
    /// Name in cases and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stationary => "stationary",
            Self::Rotating => "rotating",
        }
    }
}

impl Form {
    /// Name in cases and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Classical => "classical",
            Self::Consistent => "consistent",
        }
    }
}

impl Gyroscopic {
    /// Name in cases and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Disks => "disks",
            Self::None => "none",
        }
    }
}
