//! Results of `rotor contact`.

use serde::Serialize;

/// Results of `rotor contact`: an equilibrium or a motion of beams in contact.
#[derive(Debug, Clone, Serialize)]
pub struct Contact {
    /// "penalty", "lcp", "lcp-single", "active-set" or "none".
    pub method: &'static str,
    /// Of a motion "energy-consistent" or "semi-implicit-euler"; null in equilibrium.
    pub integrator: Option<&'static str>,
    /// Pressure per penetration along lines, of all pairs of bodies the largest.
    #[serde(rename = "penalty_N_m3")]
    pub penalty_n_m3: f64,
    /// Whether the whole load or the whole time was reached.
    pub converged: bool,
    /// Time reached; null in equilibrium.
    pub time_s: Option<f64>,
    /// Share of the loads reached; null in motion.
    pub load_factor: Option<f64>,
    /// The bodies in their last state.
    pub bodies: Vec<BodyState>,
    /// Contact between bodies in the last state.
    pub pairs: Vec<PairState>,
    /// Contacts one after the other (of a motion).
    pub events: Vec<ContactEvent>,
    /// Largest penetration of the run.
    pub largest_penetration_m: f64,
    /// Change of the total energy less the work of the loads, largest over the run, over the largest kinetic energy.
    pub energy_error: Option<f64>,
    /// The same at the end, with its sign: negative is a loss.
    pub energy_change: Option<f64>,
    /// Change of the momentum less the impulse of loads and supports, of scenes that nothing holds, over the largest sum of
    /// the bodies' momenta.
    pub momentum_residual: Option<f64>,
    /// The same of the angular momentum about the origin.
    pub angular_momentum_residual: Option<f64>,
    /// How the solvers went.
    pub solver: ContactSolver,
    /// A motion over time.
    pub history: Option<ContactHistory>,
    /// Its energies, at the instants of the history.
    #[serde(rename = "energy_J")]
    pub energy_j: Option<ContactEnergy>,
    /// Shapes for drawing.
    #[serde(skip)]
    pub snapshots: Vec<Snapshot>,
    /// Where the time went; differs from run to run, so it is no part of the report.
    #[serde(skip)]
    pub cost: ContactCost,
}

/// Results of `rotor check` on a contact scene.
#[derive(Debug, Clone, Serialize)]
pub struct SceneCheck {
    /// The bodies as they are placed.
    pub bodies: Vec<BodyCheck>,
    /// Unknowns before supports.
    pub unconstrained_degrees_of_freedom: usize,
    /// Gaps at the start, of a scene of few bodies.
    pub pairs: Vec<PairCheck>,
    /// As in [`Contact`].
    pub method: &'static str,
    /// Pressure per penetration along lines, of all pairs of bodies the largest.
    #[serde(rename = "penalty_N_m3")]
    pub penalty_n_m3: f64,
    /// Of a motion, as in [`Contact`].
    pub integrator: Option<&'static str>,
    /// End of a motion; null in equilibrium.
    pub until_s: Option<f64>,
    /// Step of a motion, so that a whole number of them fits.
    pub step_s: Option<f64>,
    /// Steps in time or load, unless they have to be cut.
    pub steps: usize,
}

/// A body as it is placed.
#[derive(Debug, Clone, Serialize)]
pub struct BodyCheck {
    /// Name of the body.
    pub name: String,
    /// Name of its element.
    pub element: String,
    /// Number of elements.
    pub elements: usize,
    /// Unknowns that its supports leave.
    pub degrees_of_freedom: usize,
    /// Mass of the body.
    pub mass_kg: f64,
    /// Undeformed length of the body.
    pub length_m: f64,
    /// Height in the plane, of a circle the diameter.
    pub height_m: f64,
    /// Place of the axis at its start.
    pub start_m: [f64; 3],
    /// Place of the axis at its end.
    pub end_m: [f64; 3],
    /// Velocity at the start.
    pub velocity_m_s: [f64; 3],
    /// Force per penetration at its corners, or at a point contact, with the largest penalty of the scene.
    pub point_penalty_n_m: f64,
    /// Number of its supports.
    pub supports: usize,
    /// Number of its loads.
    pub loads: usize,
}

/// Two bodies as they are placed.
#[derive(Debug, Clone, Serialize)]
pub struct PairCheck {
    /// Names of the two bodies.
    pub pair: [String; 2],
    /// Smallest gap: at nodes of either boundary, of spatial bodies between the nearest places of their axes; null where an
    /// end of one is what is nearest.
    pub gap_m: Option<f64>,
    /// Pressure per penetration along lines, where it is not the largest of the scene.
    #[serde(rename = "penalty_N_m3", skip_serializing_if = "Option::is_none")]
    pub penalty_n_m3: Option<f64>,
}

/// A body in its last state.
#[derive(Debug, Clone, Serialize)]
pub struct BodyState {
    /// Name of the body.
    pub name: String,
    /// Name of its element.
    pub element: String,
    /// Number of elements.
    pub elements: usize,
    /// Place of the axis at its start.
    pub start_m: [f64; 3],
    /// Displacement of its start.
    pub start_displacement_m: [f64; 3],
    /// Place of the axis at its end.
    pub end_m: [f64; 3],
    /// Displacement of its end.
    pub end_displacement_m: [f64; 3],
}

/// Contact between two bodies, or of a body with itself, in one state.
#[derive(Debug, Clone, Serialize)]
pub struct PairState {
    /// Names of the two bodies.
    pub pair: [String; 2],
    /// "point-to-point", "point-to-segment" or "line-to-line", what carries most; null when they don't touch.
    pub kind: Option<&'static str>,
    /// Probes that are in contact.
    pub points: usize,
    /// Smallest gap: at nodes of either boundary, and wherever contact is enforced.
    pub gap_m: Option<f64>,
    /// Largest penetration where contact is enforced.
    pub penetration_m: f64,
    /// Resultant force on the first body; of a motion its mean over the last step.
    #[serde(rename = "force_N")]
    pub force_n: [f64; 3],
    /// Pressure per penetration along lines, where it is not the largest of the scene.
    #[serde(rename = "penalty_N_m3", skip_serializing_if = "Option::is_none")]
    pub penalty_n_m3: Option<f64>,
    /// Angle between the axes where they are nearest (spatial bodies).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<f64>,
}

/// A contact from its beginning to its end.
#[derive(Debug, Clone, Serialize)]
pub struct ContactEvent {
    /// Names of the two bodies.
    pub pair: [String; 2],
    /// "point-to-point", "point-to-segment" or "line-to-line", what carries most of the impulse.
    pub kind: &'static str,
    /// All kinds that take part.
    pub kinds: Vec<&'static str>,
    /// Beginning: when the first gap closes, interpolated within its step.
    pub time_s: f64,
    /// End: when the last gap opens; null when it lasts.
    pub until_s: Option<f64>,
    /// Place of the first contact along either axis.
    pub positions_m: [f64; 2],
    /// Smallest gap, the largest penetration with a minus.
    pub gap_m: f64,
    /// Largest resultant force, of the means over steps.
    #[serde(rename = "force_N")]
    pub force_n: f64,
    /// Impulse on the first body: `sum F dt`, F the force that acts over the step in the integrator. All events of a body give the
    /// change of its momentum that contact makes.
    #[serde(rename = "impulse_N_s")]
    pub impulse_n_s: [f64; 2],
}

/// How the solvers of a contact analysis went.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ContactSolver {
    /// Steps in time or load.
    pub steps: usize,
    /// Steps that were cut, into smaller ones.
    pub cut: usize,
    /// Newton iterations of all steps.
    pub iterations: usize,
    /// Largest number of them in a step.
    pub most_iterations: usize,
    /// Complementarity problems solved.
    pub complementarity_problems: usize,
    /// Contacts in the largest of them.
    pub largest_problem: usize,
    /// How often near pairs were looked for.
    pub searches: usize,
    /// Number of gaps that were measured.
    pub gaps: usize,
    /// Matrices that were factorised for them.
    #[serde(skip)]
    pub factorisations: usize,
    /// Entries of these; of the elements and of contact.
    #[serde(skip)]
    pub entries: usize,
    /// Patterns of entries that had to be ordered; systems of the same pattern share one.
    #[serde(skip)]
    pub orderings: usize,
}

/// A motion over time; one row per instant.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ContactHistory {
    /// Output times.
    pub time_s: Vec<f64>,
    /// Pairs of bodies of the next two.
    pub pairs: Vec<[String; 2]>,
    /// Smallest gap of each pair.
    pub gap_m: Vec<Vec<Option<f64>>>,
    /// Size of the resultant force of each pair, as a mean since the row before: `|sum F dt|/(t_k - t_(k-1))` over the steps between, F
    /// the force that acts over the step. Zero in the first row.
    #[serde(rename = "force_N")]
    pub force_n: Vec<Vec<f64>>,
    /// Of each pair, for drawing: time and largest penetration of every step in contact, with zeros where it begins and ends.
    #[serde(skip)]
    pub touches: Vec<Vec<[f64; 2]>>,
    /// Ends of the axes: `[body][time]` of `[start x, start y, end x, end y]`.
    pub ends_m: Vec<Vec<[f64; 4]>>,
    /// Mean velocity (momentum over mass) of each body.
    pub velocity_m_s: Vec<Vec<[f64; 2]>>,
}

/// Energies of a motion, one entry per instant of its history, J.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ContactEnergy {
    /// Kinetic energy at each output time.
    pub kinetic: Vec<f64>,
    /// Strain energy at each output time.
    pub strain: Vec<f64>,
    /// Energy in penalty springs.
    pub contact: Vec<f64>,
    /// Potential of gravity, zero at the start.
    pub gravity: Vec<f64>,
    /// Work that the loads have done.
    pub work: Vec<f64>,
    /// Sum of the energies less the work.
    pub total: Vec<f64>,
}

/// The scene at one instant, for drawing.
#[derive(Debug, Clone, Default)]
pub struct Snapshot {
    /// Instant that the shape belongs to, in words.
    pub label: String,
    /// Names of the axes of the plane it is seen in, across and upwards.
    pub axes: [&'static str; 2],
    /// Closed outlines of the bodies, m.
    pub outlines: Vec<Vec<[f64; 2]>>,
}

/// Seconds by phase.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct ContactCost {
    /// Tree of boxes, oriented boxes, clipping.
    pub search_s: f64,
    /// Projections: gaps and their derivatives.
    pub gaps_s: f64,
    /// Internal forces and their tangents.
    pub elements_s: f64,
    /// Systems of equations.
    pub solve_s: f64,
    /// Time spent on complementarity problems.
    pub complementarity_s: f64,
    /// All of the analysis.
    pub total_s: f64,
}
