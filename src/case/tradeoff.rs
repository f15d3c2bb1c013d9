//! The `tradeoff` block: which settings to vary, which number to read, and what it is compared with.

use crate::case::{Analysis, Filter};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// A study of cost and error over a grid of settings.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Tradeoff")]
pub struct TradeoffInput {
    /// Analysis that each point runs.
    pub analysis: Analysis,
    /// The number of its report that counts: a path ("results.final.growth_m.0"), or { "path", "where" } as in `expected`.
    pub quantity: Quantity,
    /// What the number is compared with: a number, "expected" (the case's own entry for that quantity), or "finest" (the
    /// point with the most unknowns; it is then no part of the comparison).
    pub reference: StudyReference,
    /// Lists of values by path, as with --set; every combination is a point. A list of such objects adds up their points.
    /// "mesh": [1, 2, 4] multiplies the elements of all segments (of all bodies of a scene).
    pub grid: Grid,
    /// Runs of a point, whose median counts, default 3; one run where it takes more than 10 s.
    #[serde(default = "default_repeats")]
    pub repeats: u32,
    /// Largest relative error allowed: the cheapest point within it is chosen (also --error).
    pub error: Option<f64>,
}

fn default_repeats() -> u32 {
    3
}

/// A number of a report.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Quantity {
    /// By its path.
    Path(String),
    /// By a path with `*` and what the entry must be.
    Entry(QuantityEntry),
}

/// A path with `*` for the entries of a list, and which of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuantityEntry {
    /// Path in the report; `*` stands for the entries of a list.
    pub path: String,
    /// Which entry.
    #[serde(rename = "where")]
    pub filter: Option<Filter>,
}

impl Quantity {
    /// The path.
    pub fn path(&self) -> &str {
        match self {
            Self::Path(path) => path,
            Self::Entry(entry) => &entry.path,
        }
    }

    /// Which entries of the list at `*`.
    pub fn filter(&self) -> Option<&Filter> {
        match self {
            Self::Path(_) => None,
            Self::Entry(entry) => entry.filter.as_ref(),
        }
    }
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        match Value::deserialize(d)? {
            Value::String(path) => Ok(Self::Path(path)),
            object @ Value::Object(_) => {
                QuantityEntry::deserialize(object).map(Self::Entry).map_err(serde::de::Error::custom)
            }
            _ => Err(serde::de::Error::custom(
                "no such quantity; a path such as \"results.modes.0.frequency_hz\", or { \"path\": .., \"where\": .. }",
            )),
        }
    }
}

/// What the quantity is compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StudyReference {
    /// A number.
    Value(f64),
    /// The case's own `expected` entry for the analysis and quantity.
    Expected,
    /// The point with the most unknowns.
    Finest,
}

impl Serialize for StudyReference {
    fn serialize<S: serde::Serializer>(&self, s: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Value(value) => s.serialize_f64(*value),
            Self::Expected => s.serialize_str("expected"),
            Self::Finest => s.serialize_str("finest"),
        }
    }
}

impl<'de> Deserialize<'de> for StudyReference {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        let value = Value::deserialize(d)?;
        match (value.as_str(), value.as_f64()) {
            (Some("expected"), _) => Ok(Self::Expected),
            (Some("finest"), _) => Ok(Self::Finest),
            (None, Some(number)) => Ok(Self::Value(number)),
            _ => Err(serde::de::Error::custom(
                "no such reference; a number in the unit of the report, \"expected\", or \"finest\"",
            )),
        }
    }
}

impl JsonSchema for StudyReference {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Reference".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "anyOf": [{ "type": "number" }, { "enum": ["expected", "finest"] }] })
    }
}

/// Lists of values by path: one product, or several.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Grid {
    /// Every combination of these values.
    Product(Axes),
    /// The points of all of these products.
    Union(Vec<Axes>),
}

/// Values by path.
pub type Axes = Map<String, Value>;

impl Grid {
    /// Number of points, saturating, repeated ones included.
    pub fn count(&self) -> usize {
        let lengths = |axes: &Axes| {
            axes.values().map(|v| v.as_array().map_or(0, Vec::len)).fold(1, usize::saturating_mul)
        };
        self.products().iter().map(lengths).fold(0, usize::saturating_add)
    }

    /// The products.
    pub fn products(&self) -> &[Axes] {
        match self {
            Self::Product(axes) => std::slice::from_ref(axes),
            Self::Union(list) => list,
        }
    }
}

impl<'de> Deserialize<'de> for Grid {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        const ALLOWED: &str = "{ \"shaft.segments.0.elements\": [2, 4, 8], .. }, or a list of such objects";
        let fault = |words: String| serde::de::Error::custom(format!("{words}; {ALLOWED}"));
        let axes = |value: Value| match value {
            Value::Object(axes) if axes.is_empty() => Err(fault("nothing is varied".to_owned())),
            Value::Object(axes) => {
                match axes.iter().find(|(_, v)| v.as_array().is_none_or(|l| l.is_empty())) {
                    Some((path, _)) => Err(fault(format!("the values of \"{path}\" are no list, or none"))),
                    None => Ok(axes),
                }
            }
            _ => Err(fault("no such grid".to_owned())),
        };
        match Value::deserialize(d)? {
            Value::Array(list) if list.is_empty() => Err(fault("nothing is varied".to_owned())),
            Value::Array(list) => list.into_iter().map(axes).collect::<Result<_, _>>().map(Self::Union),
            one => axes(one).map(Self::Product),
        }
    }
}
