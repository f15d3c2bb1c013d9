//! Settings of steady vibration, as written: unbalance and harmonic excitation, operating speeds, clearances.

use crate::case::{Form, SpeedRange};
use crate::units::{Acceleration, Angle, Force, Length, Mass, Moment, MomentOfMass, Speed, Stiffness};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, de};

/// Speeds at which the machine runs.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "OperatingSpeed")]
pub struct OperatingSpeedInput {
    /// Lowest speed of continuous operation.
    pub minimum: Speed,
    /// Highest speed of continuous operation; by default the lowest.
    pub maximum: Option<Speed>,
    /// Speed at which the machine is stopped.
    pub trip: Option<Speed>,
}

/// A gap between the rotor and its surroundings.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Clearance")]
pub struct ClearanceInput {
    /// Name in reports.
    pub name: String,
    /// Position along the shaft.
    pub at: Length,
    /// Radial gap at standstill.
    pub gap: Length,
}

/// How amplitudes are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(rename = "Amplitude")]
pub enum AmplitudeInput {
    /// From one extreme to the other (default); axes of an orbit are whole axes.
    #[default]
    PeakToPeak,
    /// From the middle to an extreme; axes of an orbit are semi-axes.
    ZeroToPeak,
}

/// Where a response is read.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Station")]
pub struct StationInput {
    /// Name in reports, by default the position.
    pub name: Option<String>,
    /// Position along the shaft.
    pub at: Length,
    /// Direction in which a sensor looks, from y towards z; without it the major axis of the orbit is told.
    pub angle: Option<Angle>,
}

/// A mass beside the axis, by its moment or by mass and radius.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "UnbalanceMass")]
pub struct UnbalanceMassInput {
    /// Position along the shaft.
    pub at: Length,
    /// Mass times radius.
    pub moment: Option<MomentOfMass>,
    /// Mass (with radius).
    pub mass: Option<Mass>,
    /// Distance from the axis.
    pub radius: Option<Length>,
    /// Direction at angle zero of the rotation, from y towards z; default 0.
    pub angle: Option<Angle>,
}

/// How a balance grade is spread over the disks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// All in the same direction (default).
    #[default]
    InPhase,
    /// Neighbours in opposite directions.
    Alternating,
}

/// Stiffnesses, equally spaced by their logarithms.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StiffnessRange {
    /// Lowest stiffness.
    pub from: Stiffness,
    /// Highest stiffness.
    pub to: Stiffness,
    /// Number of stiffnesses, default 41.
    #[serde(default = "default_stiffness_count")]
    pub count: u32,
}

fn default_stiffness_count() -> u32 {
    41
}

fn default_curve_count() -> u32 {
    4
}

/// Undamped critical speeds over the stiffness of supports.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Map")]
pub struct MapInput {
    /// Stiffnesses, the same along y and z.
    pub stiffness: StiffnessRange,
    /// Which of `supports` take them, by their numbers from 0; by default all bearings (seals keep theirs).
    pub bearings: Option<Vec<u32>>,
    /// Curves of each sense of whirl, default 4.
    #[serde(default = "default_curve_count")]
    pub modes: u32,
    /// Decay over a cross-coupled stiffness at one place, [[0, Q], [-Q, 0]] (API 684, level 1).
    pub cross_coupling: Option<CrossCouplingInput>,
}

/// A cross-coupled stiffness that grows.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "CrossCoupling")]
pub struct CrossCouplingInput {
    /// Where it acts, default the middle of the shaft.
    pub at: Option<Length>,
    /// Speed of the rotor, default operating_speed.maximum.
    pub speed: Option<Speed>,
    /// Largest cross-coupling.
    pub to: Stiffness,
    /// Number of values from 0 on, default 41.
    #[serde(default = "default_stiffness_count")]
    pub count: u32,
}

/// Steady vibration by unbalance.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Unbalance")]
pub struct UnbalanceInput {
    /// Speeds of `rotor unbalance`.
    pub speeds: Option<FrequenciesInput>,
    /// Masses beside the axis; offset disks add theirs.
    #[serde(default)]
    pub masses: Vec<UnbalanceMassInput>,
    /// Grade of ISO 21940-11, "G2.5": moments U = G m / Omega at the highest speed, spread over the disks by their masses.
    pub grade: Option<String>,
    /// How a grade is spread.
    #[serde(default)]
    pub distribution: Distribution,
    /// Where the response is read; by default at every disk and bearing.
    #[serde(default)]
    pub stations: Vec<StationInput>,
    /// How amplitudes are told.
    #[serde(default)]
    pub amplitude: AmplitudeInput,
    /// Speeds at which the deflected shaft is told besides those of the peaks.
    #[serde(default)]
    pub shapes: Vec<Speed>,
    /// Form of the equations, default consistent.
    pub form: Option<Form>,
}

/// Frequencies: equally spaced, or a list.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Frequencies")]
pub enum FrequenciesInput {
    /// One by one, ascending.
    List(Vec<Speed>),
    /// Equally spaced.
    Range(SpeedRange),
}

impl<'de> Deserialize<'de> for FrequenciesInput {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        d.deserialize_any(FrequenciesVisitor)
    }
}

struct FrequenciesVisitor;

impl<'de> de::Visitor<'de> for FrequenciesVisitor {
    type Value = FrequenciesInput;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(r#"a list of values, or { "from": .., "to": .., "count": .. }"#)
    }
    fn visit_seq<A: de::SeqAccess<'de>>(self, list: A) -> std::result::Result<FrequenciesInput, A::Error> {
        Vec::deserialize(de::value::SeqAccessDeserializer::new(list)).map(FrequenciesInput::List)
    }
    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> std::result::Result<FrequenciesInput, A::Error> {
        SpeedRange::deserialize(de::value::MapAccessDeserializer::new(map)).map(FrequenciesInput::Range)
    }
}

/// What excites at a frequency of its own.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Excitation")]
pub struct ExcitationInput {
    /// Position along the shaft, for force and moment.
    pub at: Option<Length>,
    /// Amplitude of a force along x, y and z.
    pub force: Option<[Force; 3]>,
    /// Amplitude of a moment about x, y and z.
    pub moment: Option<[Moment; 3]>,
    /// Motion of the ground under all supports instead of a load.
    pub base: Option<BaseInput>,
    /// Phase ahead of the others, default 0.
    pub phase: Option<Angle>,
}

/// Motion of the ground along y and z, by amplitude.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Base")]
pub struct BaseInput {
    /// Displacement along y and z.
    pub displacement: Option<[Length; 2]>,
    /// Acceleration along y and z.
    pub acceleration: Option<[Acceleration; 2]>,
}

/// Steady vibration by excitations at a frequency of their own.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Harmonic")]
pub struct HarmonicInput {
    /// Speed at which the rotor turns, default 0.
    pub spin_speed: Option<Speed>,
    /// Frequencies of the excitation.
    pub frequencies: FrequenciesInput,
    /// What excites, all at the same frequency.
    pub excitations: Vec<ExcitationInput>,
    /// Where the response is read; by default at every disk and bearing.
    #[serde(default)]
    pub stations: Vec<StationInput>,
    /// How amplitudes are told.
    #[serde(default)]
    pub amplitude: AmplitudeInput,
    /// Form of the equations, default consistent.
    pub form: Option<Form>,
}
