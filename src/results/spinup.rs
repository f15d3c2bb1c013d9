//! Results of the nonlinear analyses: states at points, static equilibrium, spin-up.

use crate::results::RubContact;
use crate::results::{SectionForces, SupportForces};
use serde::Serialize;
use std::collections::BTreeMap;

/// State of a material point. Tensors are listed as xx, yy, zz, xy, xz, yz.
#[derive(Debug, Clone, Serialize)]
pub struct PointState {
    /// True within half a radius of a rigid hub or end: the stress there is that of the constraint, not of a part.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub in_rigid_hub: bool,
    /// Place in the undeformed section.
    pub y_m: f64,
    /// Place in the undeformed section.
    pub z_m: f64,
    /// Displacement `[x, y, z]`, in the frame that turns with the shaft.
    pub displacement_m: [f64; 3],
    /// Green-Lagrange strain.
    pub strain: [f64; 6],
    /// Second Piola-Kirchhoff stress.
    pub second_piola_pa: [f64; 6],
    /// Cauchy stress and its measures.
    pub stress_pa: Stress,
}

/// Cauchy stress; invariants `I1 = tr`, `I2 = (tr^2 - tr(sigma^2)) / 2`, `I3 = det` in powers of Pa.
#[derive(Debug, Clone, Serialize)]
pub struct Stress {
    /// Components xx, yy, zz, xy, xz, yz.
    pub cauchy: [f64; 6],
    /// Von Mises stress.
    pub von_mises: f64,
    /// First invariant, Pa.
    #[serde(rename = "I1")]
    pub i1: f64,
    /// Second invariant, Pa^2.
    #[serde(rename = "I2")]
    pub i2: f64,
    /// Third invariant, Pa^3.
    #[serde(rename = "I3")]
    pub i3: f64,
}

/// A probe: one point, or the points of a line.
#[derive(Debug, Clone, Serialize)]
pub struct ProbeState {
    /// Name given in the case.
    pub name: String,
    /// Position along the undeformed shaft.
    pub at_m: f64,
    /// The state of a single point.
    #[serde(flatten)]
    pub point: Option<PointState>,
    /// The states along a line.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<PointState>,
    /// Growth of the section that the probe stands in, of a spinning shaft.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<SectionGrowth>,
}

/// Growth of a section's half extents `[along y, along z]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SectionGrowth {
    /// Of the outline.
    pub rim_m: [f64; 2],
    /// Of the bore; null for a solid section.
    pub bore_m: Option<[f64; 2]>,
}

/// Growth along the whole shaft, half extents `[along y, along z]`; at a joint of two sections x stands twice.
#[derive(Debug, Clone, Default, Serialize)]
pub struct GrowthAlong {
    /// Positions along the undeformed shaft.
    pub x_m: Vec<f64>,
    /// Growth of the outline.
    pub rim_m: Vec<[f64; 2]>,
    /// Growth of the bore; null where the section is solid.
    pub bore_m: Vec<Option<[f64; 2]>>,
    /// Largest growth of the outline in either direction.
    pub largest_rim_m: f64,
    /// Where it is.
    pub largest_rim_at_m: f64,
}

/// States along the axes of one section, for plots and reports.
#[derive(Debug, Clone, Serialize)]
pub struct Profile {
    /// Position along the undeformed shaft.
    pub at_m: f64,
    /// From the bore (or centre) to the surface along y.
    pub along_y: Vec<PointState>,
    /// From the bore (or centre) to the surface along z.
    pub along_z: Vec<PointState>,
    /// Outer and inner outline, undeformed `[y, z]`, closed.
    #[serde(skip)]
    pub outlines: Vec<Vec<[f64; 2]>>,
    /// Displacement `[y, z]` of the same points, without that of the section's centre.
    #[serde(skip)]
    pub outline_displacements: Vec<Vec<[f64; 2]>>,
}

/// Results of `rotor static`.
#[derive(Debug, Clone, Serialize)]
pub struct Static {
    /// True when the full load is carried.
    pub converged: bool,
    /// Share of the load that is carried.
    pub load_factor: f64,
    /// States at the probes.
    pub probes: Vec<ProbeState>,
    /// A section: the nearest to mid-length that stands two radii clear of ends, disks, supports and joints.
    pub profile: Profile,
    /// Forces of the supports.
    pub reactions: Vec<Reaction>,
    /// Forces and moments of supports and bearings on the shaft.
    #[serde(flatten)]
    pub support_forces: SupportForces<[f64; 3]>,
    /// Forces and moments that pass through the shaft.
    pub sections: SectionForces,
    /// Strain energy of the shaft.
    pub strain_energy_j: f64,
    /// Largest principal Green-Lagrange strain, by size, on a grid of points in every element.
    pub largest_strain: f64,
    /// How Newton's method went.
    pub newton: NewtonSummary,
    /// Displaced axis `[x, y, z]` of the shaft, for drawing.
    #[serde(skip)]
    pub axis: Vec<[f64; 3]>,
}

/// Force of a support.
#[derive(Debug, Clone, Serialize)]
pub struct Reaction {
    /// JSON path of the support.
    pub support: String,
    /// Position along the shaft.
    pub at_m: f64,
    /// Resultant `[x, y, z]`, fixed directions.
    #[serde(rename = "force_N")]
    pub force_n: [f64; 3],
}

/// How Newton's method went.
#[derive(Debug, Clone, Serialize)]
pub struct NewtonSummary {
    /// Load steps taken.
    pub load_steps: usize,
    /// Load steps that were cut in halves.
    pub cuts: usize,
    /// Iterations in all.
    pub iterations: usize,
    /// Energy of the last correction over that of the state.
    pub residual: f64,
    /// Directions in which the state is unstable.
    pub unstable_directions: usize,
}

/// Results of `rotor spinup`.
#[derive(Debug, Clone, Serialize)]
pub struct Spinup {
    /// False when the run was interrupted; what follows ends there.
    pub complete: bool,
    /// State at the end, or the equilibrium at the last speed.
    #[serde(rename = "final")]
    pub last: SpinState,
    /// Largest values met; null for the equilibrium alone.
    pub extremes: Option<Extremes>,
    /// Growth along the shaft in that state.
    pub growth: GrowthAlong,
    /// Forces and moments of supports and bearings on the shaft; for the equilibrium alone.
    #[serde(flatten)]
    pub support_forces: Option<SupportForces<[f64; 3]>>,
    /// Forces and moments that pass through the shaft at the end.
    pub sections: SectionForces,
    /// Values over time; null for the equilibrium alone.
    pub history: Option<History>,
    /// Energy over the whole run; null for the equilibrium alone.
    pub energy: Option<EnergyBalance>,
    /// What happened at the stators; only with stators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rub: Option<RubSummary>,
    /// What the integration took; null for the equilibrium alone.
    pub integrator: Option<IntegratorSummary>,
    /// How Newton's method went, for the equilibrium alone.
    pub newton: Option<NewtonSummary>,
    /// How the periodic motion was found; only for a steady state that is one. The history is then one turn of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orbit: Option<OrbitSummary>,
}

/// A periodic motion, found by harmonic balance.
#[derive(Debug, Clone, Serialize)]
pub struct OrbitSummary {
    /// Harmonics of the turning frame.
    pub harmonics: usize,
    /// Change of the motion by the last half of them, over its largest coordinate.
    pub truncation: f64,
    /// Newton iterations in all.
    pub iterations: usize,
}

/// The shaft at one speed, seen from the frame that turns with it.
#[derive(Debug, Clone, Serialize)]
pub struct SpinState {
    /// Time; null for the equilibrium alone.
    pub time_s: Option<f64>,
    /// Spin speed.
    pub speed_rad_s: f64,
    /// Spin speed in turns per minute.
    pub speed_rpm: f64,
    /// States at the probes.
    pub probes: Vec<ProbeState>,
    /// The section whose growth is `growth_m`.
    pub profile: Profile,
    /// Growth of the outer half extents along y and z of one section: the nearest to mid-length that stands two radii
    /// clear of ends, disks, supports and joints.
    pub growth_m: [f64; 2],
    /// Where that section is.
    pub growth_at_m: f64,
    /// False when no section is so clear; then it is the one farthest from all of these.
    pub growth_is_clear: bool,
    /// Growth of a long body of that section with free ends, linear elasticity; circles and tubes only.
    pub closed_form_growth_m: Option<f64>,
    /// Largest principal Green-Lagrange strain, by size.
    pub largest_strain: f64,
}

/// Largest values of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Extremes {
    /// Largest distance of the axis at mid-length from its place at rest.
    pub radius_m: f64,
    /// Time at which the radius is largest.
    pub radius_time_s: f64,
    /// Largest torque of the drive, by size.
    #[serde(rename = "torque_N_m")]
    pub torque_n_m: f64,
    /// Time at which the torque is largest.
    pub torque_time_s: f64,
}

/// Values at the times of the output grid.
#[derive(Debug, Clone, Default, Serialize)]
pub struct History {
    /// Output times.
    pub time_s: Vec<f64>,
    /// Speed of the drive.
    pub speed_rad_s: Vec<f64>,
    /// Displacement `[x, y, z]` of every probe (the last point of a line) in the turning frame.
    pub probes: BTreeMap<String, Vec<[f64; 3]>>,
    /// Displacement `[x, y, z]` of the axis at mid-length in fixed directions.
    pub mid_span_m: Vec<[f64; 3]>,
    /// The same path `[y, z]` with several points of every step, for drawing.
    #[serde(skip)]
    pub orbit_m: Vec<[f64; 2]>,
    /// Growth along y and z of the section that `final.growth_at_m` names.
    pub growth_m: Vec<[f64; 2]>,
    /// Growth of the outline at every probe.
    pub probe_growth_m: BTreeMap<String, Vec<[f64; 2]>>,
    /// Growth of a long body with free ends at that speed; circles and tubes only.
    pub closed_form_growth_m: Vec<f64>,
    /// Energies at each output time.
    #[serde(rename = "energy_J")]
    pub energy_j: EnergyHistory,
    /// Power of every load, by JSON path; only with loads.
    #[serde(rename = "load_power_W", skip_serializing_if = "BTreeMap::is_empty")]
    pub load_power_w: BTreeMap<String, Vec<f64>>,
    /// Angular momentum about x.
    pub angular_momentum_kg_m2_s: Vec<f64>,
    /// Torque of the drive.
    #[serde(rename = "drive_torque_N_m")]
    pub drive_torque_n_m: Vec<f64>,
    /// Force `[x, y, z]` of every support in fixed directions, by JSON path.
    #[serde(rename = "reactions_N")]
    pub reactions_n: BTreeMap<String, Vec<[f64; 3]>>,
    /// Forces and moments of supports, bearings and rings on the shaft.
    #[serde(flatten)]
    pub support_forces: SupportForces<Vec<[f64; 3]>>,
    /// Torque that passes through the section at `probe_section_x_m` of every probe, as in [`SectionForces`]; only with probes.
    #[serde(rename = "probe_torque_N_m", skip_serializing_if = "BTreeMap::is_empty")]
    pub probe_torque_n_m: BTreeMap<String, Vec<f64>>,
    /// Shear `[along y, along z]` there, in fixed directions; only with probes.
    #[serde(rename = "probe_shear_N", skip_serializing_if = "BTreeMap::is_empty")]
    pub probe_shear_n: BTreeMap<String, Vec<[f64; 2]>>,
    /// Where that is: the nearer end of the element in which the probe stands, just inside; only with probes.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub probe_section_x_m: BTreeMap<String, f64>,
    /// Gap and forces of every stator in the order of the case.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stators: Vec<StatorHistory>,
}

/// A stator over time.
#[derive(Debug, Clone, Default, Serialize)]
pub struct StatorHistory {
    /// Clearance less radial displacement of the shaft's axis, positive when open.
    pub gap_m: Vec<f64>,
    /// Force of the ring on the shaft towards its centre, as it acted in the equations that were integrated.
    #[serde(rename = "normal_force_N")]
    pub normal_force_n: Vec<f64>,
    /// Friction on the surface of the shaft in the sense of positive rotation: negative while it brakes the spin.
    #[serde(rename = "friction_force_N")]
    pub friction_force_n: Vec<f64>,
    /// The same with several points of every step near the ring, for drawing.
    #[serde(skip)]
    pub drawn: Vec<(f64, RubContact)>,
}

/// What happened at the stators.
#[derive(Debug, Clone, Serialize)]
pub struct RubSummary {
    /// Looks at gaps: steps whose path could reach a ring, and evaluations with a ring that acts.
    pub gap_checks: usize,
    /// Evaluations of the equations with contact.
    pub contact_evaluations: usize,
    /// Every stator in the order of the case.
    pub stators: Vec<StatorSummary>,
}

/// What happened at a stator.
#[derive(Debug, Clone, Serialize)]
pub struct StatorSummary {
    /// JSON path of the stator.
    pub stator: String,
    /// Position along the shaft.
    pub at_m: f64,
    /// Radial clearance between shaft and ring at rest.
    pub clearance_m: f64,
    /// Radius of the shaft's surface, on which friction acts.
    pub surface_radius_m: f64,
    /// True when the shaft touched it.
    pub touched: bool,
    /// Smallest gap found; below zero the largest penetration.
    pub smallest_gap_m: f64,
    /// Time at which the gap is smallest.
    pub smallest_gap_time_s: f64,
    /// Largest force towards the centre.
    #[serde(rename = "largest_normal_force_N")]
    pub largest_normal_force_n: f64,
    /// Largest friction force, by size.
    #[serde(rename = "largest_friction_force_N")]
    pub largest_friction_force_n: f64,
    /// First contact, where the path of the axis within a step meets the ring, not an output time; null when there was none.
    pub first_contact_s: Option<f64>,
    /// Number of contacts made.
    pub contacts: usize,
    /// Duration of the longest one.
    pub longest_contact_s: f64,
    /// Duration of all.
    pub contact_time_s: f64,
    /// Contacts made and lost, the first thousand.
    pub events: Vec<RubEvent>,
}

/// Contact made or lost.
#[derive(Debug, Clone, Serialize)]
pub struct RubEvent {
    /// When the path of the axis within a step meets the ring.
    pub time_s: f64,
    /// Which of both.
    pub kind: RubEventKind,
}

/// Contact made or lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RubEventKind {
    /// Contact was made.
    Contact,
    /// Contact was lost.
    Release,
}

/// Energies over time.
#[derive(Debug, Clone, Default, Serialize)]
pub struct EnergyHistory {
    /// Kinetic energy at each output time.
    pub kinetic: Vec<f64>,
    /// Strain energy at each output time.
    pub strain: Vec<f64>,
    /// Potential of gravity and loads.
    pub potential: Vec<f64>,
    /// Work of the drive since the start.
    pub drive_work: Vec<f64>,
    /// Work of the loads without potential (moments, pressure, what follows) since the start; only with such loads.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub load_work: Vec<f64>,
    /// Potential of penetrated stators; only with stators.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stators: Vec<f64>,
    /// Absorbed by material damping, external damping, bearings and friction at stators since the start.
    pub absorbed: Vec<f64>,
    /// Work of the drive and of the loads without potential less change of energy less absorbed energy: what the integrator
    /// lost.
    pub lost: Vec<f64>,
}

/// Energy over the whole run, J.
#[derive(Debug, Clone, Serialize)]
pub struct EnergyBalance {
    /// Work of the drive.
    #[serde(rename = "drive_work_J")]
    pub drive_work_j: f64,
    /// Work of the loads without potential: moments, pressure, what follows; only with such loads.
    #[serde(rename = "load_work_J", skip_serializing_if = "Option::is_none")]
    pub load_work_j: Option<f64>,
    /// Change of kinetic, strain and potential energy, that of penetrated stators among it.
    #[serde(rename = "change_J")]
    pub change_j: f64,
    /// Absorbed by material damping.
    #[serde(rename = "material_damping_J")]
    pub material_damping_j: f64,
    /// Absorbed by external damping.
    #[serde(rename = "external_damping_J")]
    pub external_damping_j: f64,
    /// Absorbed by bearings.
    #[serde(rename = "bearings_J")]
    pub bearings_j: f64,
    /// Taken by friction at stators; only with stators.
    #[serde(rename = "friction_J", skip_serializing_if = "Option::is_none")]
    pub friction_j: Option<f64>,
    /// What the integrator lost (positive) or made (negative).
    #[serde(rename = "numerical_dissipation_J")]
    pub numerical_dissipation_j: f64,
    /// The same over the larger of the drive's work and the largest energy.
    pub relative_error: f64,
}

/// What the integration took.
#[derive(Debug, Clone, Serialize)]
pub struct IntegratorSummary {
    /// "esdirk4(3)" or "generalized-alpha".
    pub name: &'static str,
    /// "rotating" or "inertial".
    pub frame: &'static str,
    /// Integration of the forces, e.g. "exact".
    pub quadrature: String,
    /// Number of accepted steps.
    pub steps: usize,
    /// Number of steps that were rejected.
    pub rejected: usize,
    /// Evaluations of the nonlinear forces.
    pub force_evaluations: usize,
    /// Number of matrices that were factorised.
    pub factorizations: usize,
    /// How many of these were made of the tangent of a deformed state.
    pub tangents: usize,
}
