//! The case file exactly as written: keys, defaults, units; no meaning yet (that is [`crate::model`]).
//! Unknown keys are errors. The documentation of each key is also that of the JSON Schema.

mod analysis;
mod bearing_table;
mod paths;
mod reading;
mod response;
mod scene;
mod schema;
mod settings;
mod shaft;
mod spinup;
pub mod strict_json;
mod table_file;
mod tradeoff;
mod words;

pub use analysis::{Analysis, CaseKind};
pub(crate) use bearing_table::grid;
pub use bearing_table::{TableFileInput, TableInput, TableRowInput};
pub(crate) use paths::shown;
pub use response::*;
pub use scene::*;
pub use schema::schema;
pub use settings::*;
pub use shaft::*;
pub use spinup::*;
pub use tradeoff::*;
pub use words::nearest;

use crate::case::strict_json::Strict;
use crate::error::{Error, Refusal, Result};
use crate::units::Acceleration;
use paths::{at, replace, short};
use reading::{other_container, whole_numbers};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;
use table_file::read_tables;
use words::{input_error, syntax_words};

/// A rotor and what to do with it.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Address of the schema (`rotor schema`), for editors; the program does not read it.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// One line that names the case; it heads reports and plots.
    pub title: String,
    /// What the case shows.
    #[serde(default)]
    pub description: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// Materials by name.
    #[serde(default)]
    pub materials: BTreeMap<String, MaterialInput>,
    /// Cross-sections by name.
    #[serde(default)]
    pub sections: BTreeMap<String, SectionInput>,
    /// The shaft, segment by segment from x = 0; contact scenes have `bodies` instead.
    pub shaft: Option<Shaft>,
    /// Beams that may touch each other or themselves (rotor contact).
    #[serde(default)]
    pub bodies: Vec<BodyInput>,
    /// Contact between the bodies.
    pub contact: Option<ContactInput>,
    /// Rigid disks.
    #[serde(default)]
    pub disks: Vec<DiskInput>,
    /// Supports and bearings. A shaft without any is legal.
    #[serde(default)]
    pub supports: Vec<SupportInput>,
    /// Couplings: places where nothing but springs joins the shaft.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub couplings: Vec<CouplingInput>,
    /// Housings that bearings share, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub housings: BTreeMap<String, SharedHousingInput>,
    /// Gravity vector, m/s^2 (linear analyses leave it out).
    #[serde(default)]
    pub gravity: Option<[Acceleration; 3]>,
    /// Loads (linear analyses leave them out).
    #[serde(default)]
    pub loads: Vec<LoadInput>,
    /// Places where displacements are read.
    #[serde(default)]
    pub probes: Vec<ProbeInput>,
    /// Natural modes.
    #[serde(default)]
    pub modes: ModesInput,
    /// Sweep of the spin speed.
    #[serde(default)]
    pub campbell: Option<CampbellInput>,
    /// Static equilibrium under the loads and gravity.
    #[serde(default, rename = "static")]
    pub statics: Statics,
    /// Speeds at which the machine runs: shaded in plots, and what margins are held against.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operating_speed: Option<OperatingSpeedInput>,
    /// Gaps between the rotor and its surroundings, held against amplitudes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clearances: Vec<ClearanceInput>,
    /// Unbalance, and the steady vibration that it makes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unbalance: Option<UnbalanceInput>,
    /// Steady vibration by excitations at a frequency of their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub harmonic: Option<HarmonicInput>,
    /// Undamped critical speeds over the stiffness of supports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<MapInput>,
    /// Run up to speed, or the steady state at speed.
    #[serde(default)]
    pub spinup: Option<SpinupInput>,
    /// Study of cost and error over a grid of settings.
    pub tradeoff: Option<TradeoffInput>,
    /// Values that `rotor validate` checks.
    #[serde(default)]
    pub expected: Vec<Expected>,
}

/// A value that `rotor validate` checks: |ours - value| <= atol + rtol |value|.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expected {
    /// Overrides for this check, JSON path to value, as with --set.
    pub set: Option<Map<String, Value>>,
    /// Analysis: check, modes or campbell (default campbell if the case has such a block, else modes).
    pub analysis: Option<Analysis>,
    /// Path of the value in the report; `*` stands for the entries of a list.
    pub path: String,
    /// Which entries of the list at `*`.
    #[serde(rename = "where")]
    pub filter: Option<Filter>,
    /// Reference: a number, or a list of numbers for the entries at `*`.
    pub value: Value,
    /// Relative tolerance.
    pub rtol: Option<f64>,
    /// Absolute tolerance.
    pub atol: Option<f64>,
    /// What the source prints, shown beside.
    pub published: Option<Value>,
    /// Where the reference comes from.
    pub source: String,
}

/// Picks entries of a list by the values of their keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Filter {
    /// Which of the matching entries, from 1; without it all.
    pub n: Option<usize>,
    /// Keys and the values they must have.
    #[serde(flatten)]
    pub fields: Map<String, Value>,
}

/// A case with where it came from.
#[derive(Debug, Clone)]
pub struct LoadedCase {
    /// The case as types.
    pub case: Case,
    /// The JSON it was read from, overrides included, with the rows of tables in the place of their files.
    pub value: Value,
    /// File as given on the command line.
    pub file: String,
    /// SHA-256 of the JSON.
    pub sha256: String,
    /// Overrides that the JSON contains, path to value.
    pub overrides: Map<String, Value>,
}

impl Case {
    /// Reads a case file and applies `path=value` overrides.
    ///
    /// # Errors
    /// A file that can't be read, is not JSON, or has unknown keys or wrong types; a bad override.
    pub fn load(path: &Path, set: &[String]) -> Result<LoadedCase> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, "read", &e))?;
        Self::parse(&path.display().to_string(), &text, set)
    }

    /// A case from the text of a file, with overrides; `file` is its name in messages.
    ///
    /// # Errors
    /// Text that is not JSON, or has unknown keys or wrong types; a bad override.
    pub fn parse(file: &str, text: &str, set: &[String]) -> Result<LoadedCase> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let Strict(mut value) = serde_json::from_str(text).map_err(|e| Error::Syntax {
            file: file.to_owned(),
            line: e.line(),
            column: e.column(),
            message: syntax_words(&e.to_string()),
        })?;
        let mut overrides = Map::new();
        for item in set {
            let (path, text) = item.split_once('=').ok_or_else(|| {
                Error::Usage(format!("--set {item}: write PATH=VALUE, e.g. shaft.segments.0.elements=8"))
            })?;
            let new = match serde_json::from_str(text) {
                Ok(Strict(new)) => new,
                Err(_) => Value::String(text.to_owned()),
            };
            replace(&mut value, path, new.clone())?;
            overrides.insert(path.to_owned(), new);
        }
        Ok(LoadedCase { overrides, ..LoadedCase::from_value(file, value)? })
    }
}

impl Case {
    /// What it describes: a contact scene has bodies, or their contact, and no shaft.
    pub fn kind(&self) -> CaseKind {
        let scene = self.shaft.is_none() && (!self.bodies.is_empty() || self.contact.is_some());
        if scene { CaseKind::Scene } else { CaseKind::Shaft }
    }

    /// The analysis of an expected value that names none.
    pub fn default_analysis(&self) -> Analysis {
        if self.campbell.is_some() {
            Analysis::Campbell
        } else if self.contact.is_some() {
            Analysis::Contact
        } else {
            Analysis::Modes
        }
    }
}

impl LoadedCase {
    /// A case from JSON in memory; tables that it names are read from the folder of `file`.
    ///
    /// # Errors
    /// Unknown keys or wrong types, or a table that can't be read.
    pub fn from_value(file: &str, mut value: Value) -> Result<Self> {
        read_tables(file, &mut value)?;
        let case: Case = serde_path_to_error::deserialize(whole_numbers(&value)).map_err(|e| {
            let path = e.path().to_string();
            input_error(file, &value, path.trim_start_matches('.'), &e.into_inner().to_string())
        })?;
        if let Some((path, allowed)) =
            other_container(&value, &serde_json::to_value(&case).unwrap_or_default(), "")
        {
            return Err(input_error(file, &value, &path, &format!("wrong type; {allowed}")));
        }
        let sha256 = Sha256::digest(value.to_string()).iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { case, value, file: file.to_owned(), sha256, overrides: Map::new() })
    }

    /// The same case with overrides.
    ///
    /// # Errors
    /// A bad override.
    pub fn with(&self, set: &Map<String, Value>) -> Result<Self> {
        let (mut value, mut overrides) = (self.value.clone(), self.overrides.clone());
        for (path, new) in set {
            replace(&mut value, path, new.clone())?;
            overrides.insert(path.clone(), new.clone());
        }
        Ok(Self { overrides, ..Self::from_value(&self.file, value)? })
    }

    /// An [`Error::Refused`] about the value at a JSON path.
    pub fn fault(&self, path: &str, problem: impl Into<String>, allowed: impl Into<String>) -> Error {
        self.locate(Refusal::at(path, problem, allowed).into())
    }

    /// Fills in what a refusal does not know: the file, and what stands at its path. Other errors stay as they are.
    pub fn locate(&self, error: Error) -> Error {
        let Error::Refused(mut refusal) = error else { return error };
        if refusal.file.is_none() {
            refusal.file = Some(self.file.clone());
            refusal.found = Some(at(&self.value, &refusal.path).map_or("missing".to_owned(), short));
            refusal.path = shown(&refusal.path);
        }
        refusal.into()
    }
}
