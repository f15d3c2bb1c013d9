//! What a run models and what it leaves out: one variant an effect, worded when it is written.

use serde::{Serialize, Serializer};
use std::fmt::{Display, Formatter, Result};

/// An effect that is part of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Modelled {
    /// Small displacements about the undeformed shaft.
    LinearElasticity,
    /// Large displacements of a shaft.
    FiniteDisplacements,
    /// Large displacements of the bodies of a scene.
    FiniteDisplacementsOfBodies,
    /// Names of the element members.
    Elements(Vec<String>),
    /// How many disks have each kind of hub, by name.
    Disks(Vec<(usize, &'static str)>),
    /// Number of bearings.
    Bearings(usize),
    /// Number of housings.
    Housings(usize),
    /// Number of masses beside the axis.
    UnbalanceMasses(usize),
    /// Number of excitations at a frequency of their own.
    Excitations(usize),
    /// Mass of segments that carries no load.
    AddedMass,
    /// Axial forces and torques of segments.
    InitialStress,
    /// Bearings beside the undeformed axis.
    BearingOffsets,
    /// Rule by which the internal forces are integrated.
    InternalForces(String),
    /// Gravity acts.
    Gravity,
    /// Loads in a static analysis: at points, on surfaces, and whether they follow the shaft's places.
    StaticLoads {
        /// Number of point loads.
        points: usize,
        /// Number of loads on surfaces.
        surfaces: usize,
        /// Whether a load depends on where the shaft is.
        moving: bool,
    },
    /// Loads of a run-up.
    Loads,
    /// Loads of a scene.
    BodyLoads {
        /// All of them.
        count: usize,
        /// Pressures that follow the surface.
        pressures: usize,
    },
    /// Coriolis terms in the rotating frame.
    CoriolisTerms,
    /// Gyroscopic terms of shaft and disks.
    GyroscopicTerms,
    /// Gyroscopic terms of the disks alone.
    GyroscopicTermsOfDisks,
    /// The tangent at the spinning equilibrium.
    SpinStiffening,
    /// Damping in a linear analysis.
    Damping,
    /// Damping in a steady state.
    DampingOfMotion,
    /// Skew bearing stiffness.
    CrossCoupling,
    /// Circulatory forces of damping that turns with the shaft.
    CirculatoryForces,
    /// Disk offsets in the mass matrix.
    DiskOffset {
        /// Whether they are exact in the frame of the analysis.
        exact: bool,
    },
    /// The turning equilibrium of a steady state.
    CentrifugalLoad,
    /// A periodic motion by harmonic balance.
    PeriodicMotion {
        /// Number of harmonics.
        harmonics: usize,
        /// Change by the last harmonics, over the motion.
        truncation: f64,
    },
    /// A stability check that found no growing motion.
    StableSmallMotions,
    /// Inertia of a turning shaft.
    TurningInertia,
    /// Unbalance of disk offsets and of masses beside the axis.
    Unbalance,
    /// Kelvin-Voigt damping of the material.
    MaterialDamping,
    /// Damping against space.
    ExternalDamping,
    /// Tangents that were rebuilt at deformed states.
    DeformedTangents,
    /// Rub in a ring at a place, m.
    Rub(f64),
    /// Number of speeds of the Campbell diagram.
    CampbellSpeeds(usize),
    /// Number of rings that a run-up may rub in.
    Rings(usize),
    /// Contact by penalty springs, N/m^3.
    PenaltyContact(f64),
    /// Contact by complementarity, all contacts of a step together.
    Complementarity,
    /// Contact by complementarity, one contact of a step.
    ScalarComplementarity,
    /// Contact by an active set.
    ActiveSet,
    /// Motion of a scene in equal steps.
    Steps {
        /// Name of the integrator in words.
        integrator: &'static str,
        /// Length of a step, s.
        step_s: f64,
    },
    /// Settings of a trade-off study.
    Study {
        /// Number of settings.
        settings: usize,
        /// Name of the analysis.
        analysis: &'static str,
    },
    /// As the report of another run says it.
    Told(String),
}

/// An effect that a run leaves out, with the reason.
#[derive(Debug, Clone, PartialEq)]
pub enum LeftOut {
    /// The case has no disks.
    Disks,
    /// The case has no bearings.
    Bearings,
    /// The case has no gravity.
    Gravity,
    /// Gravity in a linear analysis.
    GravityInLinear,
    /// The case has no loads.
    Loads,
    /// The case has no loads: of a run-up.
    LoadsOfRunUp,
    /// Loads in a linear analysis.
    LoadsInLinear,
    /// Bearings beside the undeformed axis, in a linear analysis.
    OffsetsInLinear,
    /// Contact of a shaft with anything.
    ContactOfShaft,
    /// Time in a static analysis.
    Motion,
    /// Spin in modes at rest.
    SpinOfModes,
    /// Spin without a sweep in the case.
    Spin,
    /// Damping in undamped modes.
    DampingOfModes,
    /// The case has no damping.
    Damping,
    /// Gyroscopic terms, which the case switches off or which do not act at rest.
    GyroscopicTerms,
    /// Stiffening by spin in the classical form.
    SpinStiffening,
    /// The bend by disk offsets in the consistent form.
    BendOfOffsets,
    /// Time before a steady state.
    Time {
        /// Whether the state is a periodic motion.
        periodic: bool,
    },
    /// Stability of small motions, with the reason.
    Stability(String),
    /// The case has no disk offsets.
    Unbalance,
    /// The case has no Kelvin-Voigt damping.
    MaterialDamping,
    /// The case has no external damping.
    ExternalDamping,
    /// Tangents of deformed states, which were not needed.
    DeformedTangents,
    /// The ring at a place (m), which was never touched.
    Ring(f64),
    /// Contact of a scene that is switched off.
    Contact,
    /// Contact of a scene in which nothing came near.
    ContactForces,
    /// Friction between bodies.
    Friction,
    /// Ends of spatial bodies.
    EndsOfBodies,
    /// Contact of a body with itself.
    SelfContact,
    /// Time in an equilibrium of a scene.
    MotionOfBodies,
    /// As the report of another run says it.
    Told(String),
}

impl Display for Modelled {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Elements(names) => write!(f, "elements {}", names.join(", ")),
            Self::Disks(hubs) => {
                let hubs: Vec<String> = hubs.iter().map(|(n, hub)| format!("{n} with {hub} hub")).collect();
                write!(f, "disks ({})", hubs.join(", "))
            }
            Self::Bearings(count) => write!(f, "{count} linear bearings"),
            Self::UnbalanceMasses(count) => write!(f, "unbalance at {count} places"),
            Self::Excitations(count) => write!(f, "{count} harmonic excitations"),
            Self::Housings(1) => f.write_str("1 housing with its mass"),
            Self::Housings(count) => write!(f, "{count} housings with their masses"),
            Self::InternalForces(rule) => write!(f, "internal forces integrated: {rule}"),
            Self::StaticLoads { points, surfaces, moving: true } => {
                write!(f, "{points} point loads and {surfaces} on surfaces, where the shaft is")
            }
            Self::StaticLoads { points, surfaces, moving: false } => {
                write!(f, "{points} point loads and {surfaces} surface tractions, dead")
            }
            Self::BodyLoads { count, pressures } => {
                write!(f, "{count} loads, {pressures} follower pressures among them")
            }
            Self::DiskOffset { exact } => {
                let how = if *exact { "exact" } else { "approximate" };
                write!(f, "disk offset in the mass matrix ({how})")
            }
            Self::PeriodicMotion { harmonics, truncation } => write!(
                f,
                "what is fixed in space, in a periodic motion of {harmonics} harmonics (harmonic balance, truncation \
                 {truncation:.1e})"
            ),
            Self::Rub(at) => write!(f, "rub at the ring at {at} m: penalty and Coulomb friction"),
            Self::CampbellSpeeds(count) => write!(f, "campbell: {count} speeds"),
            Self::Rings(count) => write!(f, "spinup: rub (rings: {count})"),
            Self::PenaltyContact(penalty) => {
                write!(f, "contact by penalty, {penalty:.4e} N/m^3 along lines")
            }
            Self::Steps { integrator, step_s } => {
                write!(f, "inertia; {integrator} steps of {step_s:.4e} s")
            }
            Self::Study { settings, analysis } => write!(f, "{settings} settings run with {analysis}"),
            Self::Told(text) => f.write_str(text),
            Self::AddedMass => {
                f.write_str("added mass of segments on the mean displacement of their sections")
            }
            Self::InitialStress => f.write_str("initial stress of the segments' axial forces and torques"),
            Self::LinearElasticity => f.write_str("linear elasticity"),
            Self::FiniteDisplacements => f.write_str("finite displacements, St. Venant-Kirchhoff material"),
            Self::FiniteDisplacementsOfBodies => f.write_str("finite displacements"),
            Self::Gravity => f.write_str("gravity"),
            Self::Loads => f.write_str("loads"),
            Self::BearingOffsets => f.write_str("offsets of bearings"),
            Self::CoriolisTerms => f.write_str("Coriolis terms of shaft and disks (rotating frame)"),
            Self::GyroscopicTerms => f.write_str("gyroscopic terms of shaft and disks"),
            Self::GyroscopicTermsOfDisks => f.write_str("gyroscopic terms of the disks"),
            Self::SpinStiffening => {
                f.write_str("centrifugal stiffening (tangent at the spinning equilibrium) and spin softening")
            }
            Self::Damping => f.write_str("damping of bearings and material"),
            Self::DampingOfMotion => f.write_str("damping of bearings, of space and of the material"),
            Self::CrossCoupling => f.write_str("cross-coupled bearing stiffness"),
            Self::CirculatoryForces => f.write_str("circulatory forces of rotating damping"),
            Self::CentrifugalLoad => f.write_str("centrifugal load, co-rotating equilibrium"),
            Self::StableSmallMotions => {
                f.write_str("stability of small motions: no root with a positive real part")
            }
            Self::TurningInertia => f.write_str("inertia with Coriolis and centrifugal effects, exact"),
            Self::Unbalance => f.write_str("unbalance of disk offsets"),
            Self::MaterialDamping => f.write_str("material damping (Kelvin-Voigt)"),
            Self::ExternalDamping => f.write_str("external damping"),
            Self::DeformedTangents => f.write_str("tangents of deformed states"),
            Self::Complementarity => f.write_str(
                "contact by complementarity at nodes and corners, all contacts of a step together",
            ),
            Self::ScalarComplementarity => {
                f.write_str("contact by scalar complementarity, one contact of a step: for comparison")
            }
            Self::ActiveSet => f.write_str("contact by a primal-dual active set at nodes and corners"),
        }
    }
}

impl Display for LeftOut {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Time { periodic } => {
                let state = if *periodic { "periodic motion" } else { "equilibrium" };
                write!(f, "time: the {state} at the last speed only")
            }
            Self::Stability(reason) => write!(f, "stability of small motions: {reason}"),
            Self::Ring(at) => {
                write!(f, "contact forces of the ring at {at} m: the shaft never touched it")
            }
            Self::Told(text) => f.write_str(text),
            Self::Disks => f.write_str("disks: none given"),
            Self::Bearings => f.write_str("bearings: none given"),
            Self::Gravity => f.write_str("gravity: none given"),
            Self::GravityInLinear => f.write_str("gravity: a linear analysis about the undeformed state"),
            Self::Loads => f.write_str("loads: none given"),
            Self::LoadsOfRunUp => f.write_str("dead loads: none given"),
            Self::LoadsInLinear => f.write_str("loads: a linear analysis about the undeformed state"),
            Self::OffsetsInLinear => {
                f.write_str("offsets of bearings: a linear analysis about the undeformed state")
            }
            Self::ContactOfShaft => f.write_str("contact: none with other bodies (`rotor contact`)"),
            Self::Motion => f.write_str("inertia, spin and damping: a static analysis"),
            Self::SpinOfModes => {
                f.write_str("spin: modes of the shaft at rest (no gyroscopic matrix built)")
            }
            Self::Spin => f.write_str("spin: no `campbell` block"),
            Self::DampingOfModes => f.write_str("damping: undamped natural modes"),
            Self::Damping => f.write_str("damping: none given"),
            Self::GyroscopicTerms => f.write_str("gyroscopic terms"),
            Self::SpinStiffening => {
                f.write_str("centrifugal stiffening and spin softening: classical form")
            }
            Self::BendOfOffsets => f.write_str(
                "the bend that offset disks cause: the equilibrium is that of the balanced rotor",
            ),
            Self::Unbalance => f.write_str("unbalance of disk offsets: no offsets"),
            Self::MaterialDamping => f.write_str("material damping (Kelvin-Voigt): none given"),
            Self::ExternalDamping => f.write_str("external damping: none given"),
            Self::DeformedTangents => f.write_str(
                "tangents of deformed states: the undeformed shaft's, turned with each section, served the whole run",
            ),
            Self::Contact => {
                f.write_str("contact: switched off (contact.method none), nothing is looked for")
            }
            Self::ContactForces => f.write_str("contact forces: nothing came near, no gap was measured"),
            Self::Friction => f.write_str("friction: contact acts along the normal only"),
            Self::EndsOfBodies => f.write_str("ends of bodies: their lateral surfaces meet"),
            Self::SelfContact => f.write_str("contact of a body with itself: contact.self is false"),
            Self::MotionOfBodies => f.write_str("inertia and damping: an equilibrium"),
        }
    }
}

impl Serialize for Modelled {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl Serialize for LeftOut {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Effects in one line, as tables and figures show them.
pub fn listed(effects: &[impl Display]) -> String {
    effects.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}
