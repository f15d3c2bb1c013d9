//! What the analyses return: plain data, no maths, no drawing. Reports and plots see only this.
//! Units are in the field names; `None` stands for "not defined here" (JSON null), never NaN.

mod contact;
mod effects;
mod forces;
mod map;
mod margins;
mod matrices;
mod response;
mod rub_contact;
mod spinup;
mod tradeoff;

pub use contact::*;
pub use effects::*;
pub use forces::*;
pub use map::*;
pub use margins::*;
pub use matrices::*;
pub use response::*;
pub use rub_contact::*;
use serde::Serialize;
use serde_json::{Map, Value};
pub use spinup::*;
pub use tradeoff::*;

/// A finished analysis with everything its report says.
#[derive(Debug, Clone, Serialize)]
pub struct Report<R> {
    /// Version of this program.
    pub rotor: &'static str,
    /// The case that was analysed.
    pub case: CaseInfo,
    /// What was modelled.
    pub model: ModelSummary,
    /// The analysis' own results.
    pub results: R,
    /// Remarks, warnings and failed cross-checks.
    pub diagnostics: Vec<Diagnostic>,
}

/// Identity of the case file.
#[derive(Debug, Clone, Serialize)]
pub struct CaseInfo {
    /// Title given in the case.
    pub title: String,
    /// File name (without folders, so that reports do not depend on where they were made).
    pub file: String,
    /// SHA-256 of the case as analysed, overrides included.
    pub sha256: String,
    /// The overrides (`--set`), path to value.
    pub overrides: Map<String, Value>,
    /// The case as analysed, overrides included, but for `expected`: written to a file it is the case of this report.
    pub effective: Value,
}

/// Size and content of the model.
#[derive(Debug, Clone, Serialize)]
pub struct ModelSummary {
    /// Unknowns after constraints.
    pub degrees_of_freedom: usize,
    /// Number of beam elements.
    pub elements: usize,
    /// Mass of shaft and disks.
    pub mass_kg: f64,
    /// Effects that are part of this run.
    pub modelled: Vec<Modelled>,
    /// Effects that were left out, each with the reason.
    pub left_out: Vec<LeftOut>,
    /// Estimate of the relative error that the section functions of automatically chosen elements leave.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimated_error: Option<f64>,
}

/// How much a diagnostic matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Good to know.
    Info,
    /// The result holds with a restriction.
    Warning,
    /// A check failed; the result should not be used unread.
    Error,
}

/// One remark about a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnostic {
    /// How much it matters.
    pub level: Level,
    /// Stable identifier for scripts.
    pub code: &'static str,
    /// One sentence for the engineer.
    pub message: String,
}

impl Diagnostic {
    /// A remark that is good to know.
    pub fn info(code: &'static str, message: impl Into<String>) -> Self {
        Self { level: Level::Info, code, message: message.into() }
    }
    /// A remark that restricts a result.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self { level: Level::Warning, code, message: message.into() }
    }
    /// A failed check.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self { level: Level::Error, code, message: message.into() }
    }
}

/// What a mode mainly moves, by its share of kinetic energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ModeKind {
    /// Motion without strain, frequency zero.
    Rigid,
    /// Translation and tilt of the sections across the axis.
    Bending,
    /// Rotation of the sections about the axis.
    Torsion,
    /// Translation of the sections along the axis.
    Axial,
    /// Deformation of the sections themselves (breathing, ovalling, warping).
    Section,
}

impl ModeKind {
    /// Name in reports and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Bending => "bending",
            Self::Torsion => "torsion",
            Self::Axial => "axial",
            Self::Section => "section",
        }
    }
}

impl Whirl {
    /// Name in reports and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
            Self::Mixed => "mixed",
            Self::None => "none",
        }
    }
}

/// Sense of the orbit relative to the spin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Whirl {
    /// With the spin.
    Forward,
    /// Against the spin.
    Backward,
    /// Partly with and partly against it, or in a plane: the circularity is below a hundredth.
    Mixed,
    /// No waves around the axis that could travel (torsion, axial motion, breathing), or no oscillation.
    None,
}

/// Results of `rotor modes`.
#[derive(Debug, Clone, Serialize)]
pub struct Modes {
    /// Number of motions without strain among `modes`.
    pub rigid_modes: usize,
    /// Modes by ascending frequency, rigid ones first.
    pub modes: Vec<Mode>,
    /// Modes below the last one proved complete by a Sturm count.
    pub sturm_count_agrees: bool,
}

/// One natural mode of the shaft at rest.
#[derive(Debug, Clone, Serialize)]
pub struct Mode {
    /// Number of the mode, from 1.
    pub number: usize,
    /// Circular frequency of the mode.
    pub frequency_rad_s: f64,
    /// Frequency of the mode.
    pub frequency_hz: f64,
    /// What it mainly moves.
    pub kind: ModeKind,
    /// Dominant number of waves around the axis (0 axial and torsion, 1 bending, 2 ovalling, ..).
    pub circumferential_order: usize,
    /// Shares of the shaft's kinetic energy.
    pub energy_share: EnergyShare,
    /// `|K x - w^2 M x| / | |K| |x| |`.
    pub relative_residual: f64,
    /// For drawing only.
    #[serde(skip)]
    pub shape: ModeShape,
}

/// Shares of the shaft's kinetic energy, summing to one.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct EnergyShare {
    /// Sections moving along the axis.
    pub axial: f64,
    /// Sections moving across the axis and tilting.
    pub bending: f64,
    /// Sections turning about the axis.
    pub torsion: f64,
    /// Share of sections that deform in their plane.
    pub section: f64,
}

/// A mode's motion, scaled so that the largest displacement on the shaft is 1 (dimensionless).
#[derive(Debug, Clone, Default)]
pub struct ModeShape {
    /// Stations along the shaft, m.
    pub x_m: Vec<f64>,
    /// Displacement `[x, y, z]` of the section's centre at each station.
    pub axis: Vec<[f64; 3]>,
    /// Mean rotation of the section about the axis times the outer radius, at each station.
    pub twist: Vec<f64>,
    /// Shaft position of the section drawn below (where the mode moves most), m.
    pub section_x_m: f64,
    /// Outlines (outer, and inner if hollow) of that section at rest, `[y, z]` in m, closed polygons.
    pub outlines: Vec<Vec<[f64; 2]>>,
    /// Displacement `[x, y, z]` of the same outline points.
    pub outline_displacements: Vec<Vec<[f64; 3]>>,
}

/// Results of `rotor campbell`.
#[derive(Debug, Clone, Serialize)]
pub struct Campbell {
    /// "stationary" or "rotating": the frame the frequencies are seen in.
    pub frame: &'static str,
    /// "classical" or "consistent".
    pub form: &'static str,
    /// "all", "disks" or "none": whose gyroscopic terms act.
    pub gyroscopic: &'static str,
    /// Spin speeds of the sweep (refined where tracking needed it).
    pub speeds_rad_s: Vec<f64>,
    /// Whirl branches by ascending frequency at the lowest speed.
    pub branches: Vec<Branch>,
    /// Speeds at which a frequency equals the speed, ascending.
    pub critical_speeds: Vec<CriticalSpeed>,
    /// Excitation orders drawn besides the speed itself, e.g. 2 for 2x.
    pub orders: Vec<f64>,
    /// Speeds at which the machine runs, where the case says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operating_speed: Option<OperatingRange>,
    /// Speeds at which a motion grows.
    pub unstable_ranges: Vec<UnstableRange>,
    /// Lowest speed at which a motion grows; null if none does within the sweep, or if rounding hides it.
    pub stability_threshold_rad_s: Option<f64>,
    /// Accuracy of the reduced model.
    pub reduction: Reduction,
}

/// An interval of speed in which a branch grows.
#[derive(Debug, Clone, Serialize)]
pub struct UnstableRange {
    /// Lower end, or the first speed of the sweep.
    pub from_rad_s: f64,
    /// Upper end, or the last speed of the sweep.
    pub to_rad_s: f64,
    /// Lower end.
    pub from_rpm: f64,
    /// Upper end.
    pub to_rpm: f64,
    /// Name of the branch; "not oscillating" or "beyond the branches" for what none of them follows.
    pub branch: String,
    /// Largest real part of the eigenvalue inside.
    pub largest_growth_rate_1_s: f64,
}

/// One whirl branch over speed.
#[derive(Debug, Clone, Serialize)]
pub struct Branch {
    /// Short name from its place at standstill, e.g. "1B" or "2F" (number of the bending pair, and which of the pair: the one
    /// that spin makes whirl backward or forward if the supports are the same all around), "T1", "A1", "S1", "R1".
    pub name: String,
    /// Sense at most of the speeds at which it is forward or backward.
    pub whirl: Whirl,
    /// Sense at each speed.
    pub whirl_at_speed: Vec<Whirl>,
    /// What the branch mainly moves at standstill.
    pub kind: ModeKind,
    /// Speeds (rad/s) of the sweep at which it is overdamped: it creeps back to rest, or away from it, without oscillating.
    pub overdamped: Vec<f64>,
    /// Damped frequency at each speed; null where the branch does not oscillate or was lost.
    pub frequency_rad_s: Vec<Option<f64>>,
    /// Logarithmic decrement at each speed; positive when stable, null where rounding hides its sign.
    pub log_decrement: Vec<Option<f64>>,
}

/// A speed at which the spin itself excites a whirl.
#[derive(Debug, Clone, Serialize)]
pub struct CriticalSpeed {
    /// Speed at which the frequency equals the speed.
    pub speed_rad_s: f64,
    /// The same in turns per minute.
    pub speed_rpm: f64,
    /// Name of the branch it lies on, if one of the reported branches passes there.
    pub branch: Option<String>,
    /// Sense of the orbit.
    pub whirl: Whirl,
    /// What it mainly moves.
    pub kind: ModeKind,
    /// True for a crossing of a damped branch, false for the undamped synchronous eigenproblem.
    pub damped: bool,
    /// Difference between the direct solution and the branch's crossing, relative; null when only
    /// one of the two exists.
    pub crossing_difference: Option<f64>,
}

/// The modal reduction and what it costs in accuracy.
#[derive(Debug, Clone, Serialize)]
pub struct Reduction {
    /// Size of the basis; null when unreduced.
    pub basis: Option<usize>,
    /// Largest relative difference of a branch's frequency to the unreduced problem at the highest speed.
    pub measured_error: Option<f64>,
    /// Largest relative error of the interpolated tangent stiffness (of a natural mode's share of it) at a speed
    /// between its nodes; consistent form only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffening_error: Option<f64>,
}

/// Results of `rotor check`.
#[derive(Debug, Clone, Serialize)]
pub struct Check {
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Degrees of freedom before constraints.
    pub unconstrained_degrees_of_freedom: usize,
    /// Motions without strain that the supports leave.
    pub rigid_motions: Vec<String>,
    /// Length of the shaft.
    pub length_m: f64,
    /// Mass of the shaft alone.
    pub shaft_mass_kg: f64,
    /// Mass of the disks.
    pub disk_mass_kg: f64,
    /// Centre of mass `[x, y, z]`.
    pub center_of_mass_m: [f64; 3],
    /// Polar inertia about the shaft axis.
    pub polar_inertia_kg_m2: f64,
    /// Inertia about the y axis through the centre of mass.
    pub inertia_y_kg_m2: f64,
    /// Inertia about the z axis through the centre of mass.
    pub inertia_z_kg_m2: f64,
    /// Estimated peak memory of modes and campbell runs.
    pub estimated_memory_mb: f64,
    /// Estimated time of the campbell run on one core.
    pub estimated_time_s: f64,
}

/// Figures as `(file name, SVG text)`.
pub type Figures = Vec<(String, String)>;
