//! Every case against the reports in `reports/` (made by `reports/remake.sh`), numbers with a tolerance.

mod common;

use rotor::case::Case;
use rotor::run::{Analysis, run};
use serde_json::Value;
use std::path::Path;

/// Rounding errors, which no report need repeat.
const NOISE: [&str; 3] = ["relative_residual", "crossing_difference", "measured_error"];

fn compare(path: &str, ours: &Value, kept: &Value) {
    match (ours, kept) {
        (Value::Object(a), Value::Object(b)) => {
            let keys = |m: &serde_json::Map<String, Value>| m.keys().cloned().collect::<Vec<_>>();
            assert_eq!(keys(a), keys(b), "{path}");
            for (key, value) in a {
                if !NOISE.contains(&key.as_str()) {
                    compare(&format!("{path}.{key}"), value, &b[key]);
                }
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| compare(&format!("{path}.{i}"), a, b));
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().expect("number"), b.as_f64().expect("number"));
            assert!((a - b).abs() <= 1e-7 * b.abs() + 1e-9, "{path}: {a} instead of {b}");
        }
        _ => assert_eq!(ours, kept, "{path}"),
    }
}

#[test]
fn reports_are_as_kept() {
    let mut compared = 0;
    for path in common::case_files() {
        let stem = path.file_stem().expect("name").to_string_lossy().into_owned();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports").join(&stem);
        let loaded = Case::load(&path, &[]).expect("case");
        for analysis in [Analysis::Check, Analysis::Modes, Analysis::Campbell] {
            let file = folder.join(format!("{}.json", analysis.name()));
            let wanted = analysis != Analysis::Campbell || loaded.case.campbell.is_some();
            assert_eq!(file.exists(), wanted, "{} (run reports/remake.sh)", file.display());
            if wanted {
                let text = std::fs::read_to_string(&file).expect("report");
                let kept: Value = serde_json::from_str(&text).expect("JSON");
                let finished =
                    run(&loaded, analysis, true, &|_| (), &|_, _| true).unwrap_or_else(|e| panic!("{e}"));
                compare(&format!("{stem}.{}", analysis.name()), &finished.json, &kept);
                for (name, svg) in finished.plots {
                    assert!(folder.join(&name).exists() && svg.contains("</svg>"), "{stem} {name}");
                }
                compared += 1;
            }
        }
    }
    assert!(compared >= 20);
}
