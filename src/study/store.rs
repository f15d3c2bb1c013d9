//! Finished points of a study, one file each, under a digest of everything that their numbers depend on.

use crate::case::TradeoffInput;
use crate::error::{Error, Result};
use crate::report::{files, json};
use crate::study::design::{Measurement, PointSettings};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// What became of a point: its measurement, or why there is none.
pub type PointOutcome = std::result::Result<Measurement, String>;

/// SHA-256 over program version, processor, analysis, quantity and the case with its settings, without its words and
/// what it expects.
pub fn key(case: &Value, analysis: &str, block: &TradeoffInput, processor: &str) -> String {
    let mut computed = case.clone();
    if let Value::Object(map) = &mut computed {
        for key in ["title", "description", "source", "expected"] {
            map.shift_remove(key);
        }
    }
    let whole = json!([env!("CARGO_PKG_VERSION"), processor, analysis, block.quantity, computed]);
    Sha256::digest(whole.to_string()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The texts of a list.
pub fn words(list: &Value) -> Vec<String> {
    list.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
}

/// A folder of finished points.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// The points of a folder, which is made if needed.
    ///
    /// # Errors
    /// A folder that can't be made.
    pub fn open(folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create this folder", &e))?;
        Ok(Self { folder: folder.to_owned() })
    }

    fn name(key: &str) -> String {
        format!("{}.json", key.chars().take(32).collect::<String>())
    }

    /// A finished point; none if it is not there or not readable, so that it is measured again.
    pub fn read(&self, key: &str) -> Option<PointOutcome> {
        let text = std::fs::read_to_string(self.folder.join(Self::name(key))).ok()?;
        let value: Value = serde_json::from_str(&text).ok()?;
        if value["key"] != key {
            return None;
        }
        if let Some(reason) = value["failed"].as_str() {
            return Some(Err(reason.to_owned()));
        }
        let wall_s: Vec<f64> = value["wall_s"].as_array()?.iter().filter_map(Value::as_f64).collect();
        (!wall_s.is_empty()).then_some(())?;
        Some(Ok(Measurement {
            value: value["value"].as_f64()?,
            wall_s,
            peak_memory_mb: value["peak_memory_mb"].as_f64(),
            degrees_of_freedom: value["degrees_of_freedom"].as_u64()?,
            steps: value["steps"].as_u64(),
            estimated_error: value["estimated_error"].as_f64(),
            warnings: words(&value["warnings"]),
            modelled: words(&value["modelled"]),
            left_out: words(&value["left_out"]),
        }))
    }

    /// Keeps a finished point.
    ///
    /// # Errors
    /// A file that can't be written.
    pub fn write(&self, key: &str, settings: &PointSettings, outcome: &PointOutcome) -> Result<()> {
        let mut value = json!({ "key": key, "rotor": env!("CARGO_PKG_VERSION"), "settings": settings });
        match outcome {
            Ok(found) => {
                value["value"] = json!(found.value);
                value["wall_s"] = json!(found.wall_s);
                value["peak_memory_mb"] = json!(found.peak_memory_mb);
                value["degrees_of_freedom"] = json!(found.degrees_of_freedom);
                value["steps"] = json!(found.steps);
                value["estimated_error"] = json!(found.estimated_error);
                value["warnings"] = json!(found.warnings);
                value["modelled"] = json!(found.modelled);
                value["left_out"] = json!(found.left_out);
            }
            Err(reason) => value["failed"] = json!(reason),
        }
        files::write_all(&self.folder, &[(Self::name(key), json::text(&value))]).map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_reads_back() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let found = Measurement {
            value: 1.25,
            wall_s: vec![0.5, 0.25],
            peak_memory_mb: Some(30.5),
            degrees_of_freedom: 700,
            steps: Some(16),
            estimated_error: Some(1e-4),
            warnings: vec!["rounding: few digits".to_owned()],
            modelled: vec!["elements 34X3".to_owned()],
            left_out: Vec::new(),
        };
        for outcome in [Ok(found), Err("no convergence".to_owned())] {
            store.write("0123", &PointSettings::new(), &outcome).unwrap();
            assert_eq!(store.read("0123"), Some(outcome));
        }
        assert_eq!(store.read("4567"), None);
        std::fs::write(folder.path().join(Store::name("0123")), "{ \"key\": \"0123\", \"val").unwrap();
        assert_eq!(store.read("0123"), None);
    }
}
