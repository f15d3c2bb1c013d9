//! The analyses by name, as a case names them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An analysis that writes a report: what the program knows of each stands in [`crate::run::entry`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Analysis {
    /// Size and mass properties.
    Check,
    /// Natural modes at rest.
    Modes,
    /// Whirl frequencies over speed and critical speeds.
    Campbell,
    /// Steady vibration by unbalance.
    Unbalance,
    /// Steady vibration by excitations at a frequency of their own.
    Harmonic,
    /// Undamped critical speeds over the stiffness of the supports.
    Map,
    /// Equilibrium under loads.
    Static,
    /// Run up to speed.
    Spinup,
    /// Beams in contact.
    Contact,
}

/// What a case describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaseKind {
    /// One shaft with what is attached to it.
    Shaft,
    /// Bodies that may touch.
    Scene,
}

/// All of them, by rising cost, with their names on the command line, in the case and of the report.
const NAMES: [(Analysis, &str); 9] = [
    (Analysis::Check, "check"),
    (Analysis::Modes, "modes"),
    (Analysis::Campbell, "campbell"),
    (Analysis::Unbalance, "unbalance"),
    (Analysis::Harmonic, "harmonic"),
    (Analysis::Map, "map"),
    (Analysis::Static, "static"),
    (Analysis::Spinup, "spinup"),
    (Analysis::Contact, "contact"),
];

impl Analysis {
    /// All of them, by rising cost.
    pub fn all() -> impl Iterator<Item = Self> {
        NAMES.into_iter().map(|(analysis, _)| analysis)
    }

    /// Name on the command line, of the block with its settings and of its report.
    pub fn name(self) -> &'static str {
        NAMES.into_iter().find(|(analysis, _)| *analysis == self).map_or("", |(_, name)| name)
    }

    /// The analysis of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        NAMES.into_iter().find(|(_, known)| *known == name).map(|(analysis, _)| analysis)
    }
}
