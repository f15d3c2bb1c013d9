//! Settings of modes, Campbell diagram and static equilibrium, as written.

use crate::units::Speed;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Natural modes.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Modes")]
pub struct ModesInput {
    /// Modes to report, rigid ones included.
    #[serde(default = "default_mode_count")]
    pub count: u32,
}

fn default_mode_count() -> u32 {
    30
}

impl Default for ModesInput {
    fn default() -> Self {
        Self { count: default_mode_count() }
    }
}

/// WhirlFrame in which frequencies are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum WhirlFrame {
    /// Fixed in space.
    Stationary,
    /// Turning with the shaft (consistent form only).
    Rotating,
}

/// Form of the linear equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// Stiffness of the undeformed shaft, gyroscopic terms.
    Classical,
    /// Tangent stiffness at the spinning equilibrium and spin softening.
    Consistent,
}

/// Whose gyroscopic terms act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Gyroscopic {
    /// Shaft and disks.
    #[default]
    All,
    /// Disks only.
    Disks,
    /// No load, and no gravity.
    None,
}

/// Sweep of the spin speed.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Campbell")]
pub struct CampbellInput {
    /// Speeds.
    pub speeds: SpeedRange,
    /// Whirl branches to report.
    #[serde(default = "default_branch_count")]
    pub modes: u32,
    /// WhirlFrame, default stationary for circle and tube sections (and for the classical form), else rotating.
    pub frame: Option<WhirlFrame>,
    /// Form, default consistent.
    pub form: Option<Form>,
    /// Size of the modal basis (at least modes + 8), or "none".
    #[serde(default)]
    pub reduction: ReductionSize,
    /// Whose gyroscopic terms act ("disks" and "none" in the classical form only).
    #[serde(default)]
    pub gyroscopic: Gyroscopic,
    /// Excitation orders to draw besides 1x.
    #[serde(default)]
    pub orders: Vec<f64>,
}

fn default_branch_count() -> u32 {
    12
}

/// Equally spaced speeds.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpeedRange {
    /// First speed, default 0.
    #[serde(default = "default_lowest_speed")]
    pub from: Speed,
    /// Last speed.
    pub to: Speed,
    /// Number of speeds.
    #[serde(default = "default_speed_count")]
    pub count: u32,
}

/// Static equilibrium.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Statics {
    /// Load steps, default 1; each is cut further where Newton's method does not converge.
    #[serde(default = "default_load_steps")]
    pub load_steps: u32,
    /// Most Newton iterations of a step, default 40.
    #[serde(default = "default_newton_iterations")]
    pub max_iterations: u32,
    /// Energy of the last correction over that of the state, default 1e-20 (ten digits of the displacement).
    #[serde(default = "default_newton_tolerance")]
    pub tolerance: f64,
}

impl Default for Statics {
    fn default() -> Self {
        Self {
            load_steps: default_load_steps(),
            max_iterations: default_newton_iterations(),
            tolerance: default_newton_tolerance(),
        }
    }
}

fn default_load_steps() -> u32 {
    1
}

fn default_newton_iterations() -> u32 {
    40
}

fn default_newton_tolerance() -> f64 {
    1e-20
}

/// Size of the modal basis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReductionSize {
    /// That many vectors.
    Basis(u32),
    /// The unreduced problem.
    None,
}

impl Default for ReductionSize {
    fn default() -> Self {
        Self::Basis(60)
    }
}

impl Serialize for ReductionSize {
    fn serialize<S: serde::Serializer>(&self, s: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Basis(n) => s.serialize_u32(*n),
            Self::None => s.serialize_str("none"),
        }
    }
}

impl<'de> Deserialize<'de> for ReductionSize {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        match Value::deserialize(d)? {
            Value::String(text) if text == "none" => Ok(Self::None),
            Value::Number(n) if n.as_u64().is_some_and(|n| u32::try_from(n).is_ok()) => {
                Ok(Self::Basis(n.as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or(0)))
            }
            other => Err(serde::de::Error::custom(format!(
                "invalid value {other}: expected a whole number or \"none\""
            ))),
        }
    }
}

impl JsonSchema for ReductionSize {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ReductionSize".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "anyOf": [{ "type": "integer", "minimum": 9, "maximum": 5000 }, { "const": "none" }] })
    }
}

fn default_lowest_speed() -> Speed {
    Speed(0.0)
}

fn default_speed_count() -> u32 {
    101
}
