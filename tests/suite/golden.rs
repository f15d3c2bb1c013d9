//! Every case against the reports in `tests/baselines/` (made by its `remake.sh`), numbers with a tolerance.

use crate::common::report;
use rotor::case::Case;
use rotor::run::Analysis;
use serde_json::Value;
use std::path::Path;

/// What no report need repeat, with the reason.
const NOISE: [(&str, &str); 13] = [
    ("relative_residual", "what rounding leaves of an equation"),
    ("residual", "what rounding leaves of an equation"),
    ("crossing_difference", "the difference of two ways to the same speed: rounding"),
    ("measured_error", "the difference of two solutions that agree: rounding"),
    ("interpolation_error", "the difference of two solutions that agree: rounding"),
    ("newton", "counts of an iteration, decided at a threshold"),
    ("integrator", "counts of steps and iterations, decided at a threshold"),
    ("solver", "counts of steps and iterations, decided at a threshold"),
    ("gap_checks", "a count that follows the steps"),
    ("contact_evaluations", "a count that follows the steps"),
    ("relative_error", "the energy that is missing, far below the integrator's tolerance"),
    ("torque_time_s", "where a flat or vibrating curve is largest"),
    ("radius_time_s", "where a flat or vibrating curve is largest"),
];

/// Torques carry a vibration that rounding starts: processors differ by 1.2e-3 of the largest.
const VIBRATION: f64 = 5.0;

/// Blocks whose numbers are compared by the largest of the block: a small energy is a difference of large ones.
const TOGETHER: [&str; 2] = ["energy_J", "energy"];

/// Largest number of a list or block, by size.
fn size(value: &Value) -> f64 {
    match value {
        Value::Array(list) => list.iter().map(size).fold(0.0, f64::max),
        Value::Object(map) => map.values().map(size).fold(0.0, f64::max),
        Value::Number(n) => n.as_f64().expect("number").abs(),
        _ => 0.0,
    }
}

/// Numbers may differ by `rtol` of their size or of the largest number in their list.
fn compare(path: &str, ours: &Value, kept: &Value, rtol: f64, floor: f64) {
    match (ours, kept) {
        (Value::Object(a), Value::Object(b)) => {
            // reactions that vanish are what rounding leaves of internal forces; the energy (over 1 m) gives their size
            // reactions of a balanced shaft that runs up do the same: hundredths of a newton, which processors share in no digit
            let energy = b.get("strain_energy_j").map_or(0.0, size);
            let motion = b.get("energy_J").map_or(0.0, size);
            // forces and moments that supports and sections carry are sums of these
            let whole = b.get("energy").map_or(0.0, size);
            let keys = |m: &serde_json::Map<String, Value>| m.keys().cloned().collect::<Vec<_>>();
            assert_eq!(keys(a), keys(b), "{path}");
            for (key, value) in a {
                // invariants of a stress are compared by the size that its components give them
                let power =
                    ["I1", "I2", "I3"].iter().position(|name| name == key).map_or(0, |p| p as i32 + 1);
                let unit = a.get("cauchy").map_or(0.0, size);
                let floor = match key.as_str() {
                    _ if power > 0 => rtol * unit.powi(power),
                    "reactions" => floor.max(1e-11 * energy),
                    "reactions_N" => floor.max(rtol * motion),
                    "support_forces_N"
                    | "support_moments_N_m"
                    | "sections"
                    | "probe_torque_N_m"
                    | "probe_shear_N" => floor.max(1e-11 * energy).max(rtol * motion.max(whole)),
                    key if TOGETHER.contains(&key) => floor.max(rtol * size(value)),
                    _ => floor,
                };
                let rtol = if key.ends_with("torque_N_m") { VIBRATION * rtol } else { rtol };
                if !NOISE.iter().any(|(noise, _)| noise == key) {
                    compare(&format!("{path}.{key}"), value, &b[key], rtol, floor);
                }
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            let floor = floor.max(rtol * size(kept));
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&format!("{path}.{i}"), a, b, rtol, floor);
            }
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().expect("number"), b.as_f64().expect("number"));
            assert!((a - b).abs() <= rtol * b.abs() + floor, "{path}: {a} instead of {b}");
        }
        _ => assert_eq!(ours, kept, "{path}"),
    }
}

#[test]
fn reports_are_as_kept() {
    let mut compared = 0;
    for path in crate::common::case_files() {
        let stem = path.file_stem().expect("name").to_string_lossy().into_owned();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/baselines").join(&stem);
        let loaded = Case::load(&path, &[]).expect("case");
        let kept = [
            Analysis::Check,
            Analysis::Modes,
            Analysis::Campbell,
            Analysis::Unbalance,
            Analysis::Harmonic,
            Analysis::Map,
            Analysis::Static,
            Analysis::Spinup,
        ];
        for analysis in kept {
            let file = folder.join(format!("{}.json", analysis.name()));
            let wanted = match analysis {
                Analysis::Campbell => loaded.case.campbell.is_some(),
                Analysis::Unbalance => loaded.case.unbalance.is_some(),
                Analysis::Harmonic => loaded.case.harmonic.is_some(),
                Analysis::Map => loaded.case.map.is_some(),
                Analysis::Static => !loaded.case.loads.is_empty(),
                // a run through a resonance repeats to the integrator's tolerance only, but for a steady rub
                Analysis::Spinup => {
                    loaded.case.spinup.is_some() && (loaded.case.disks.is_empty() || stem == "rub-ring")
                }
                _ => true,
            };
            assert_eq!(file.exists(), wanted, "{} (run tests/baselines/remake.sh)", file.display());
            if wanted {
                let text = std::fs::read_to_string(&file).expect("report");
                let kept: Value = serde_json::from_str(&text).expect("JSON");
                let finished = report(&loaded, analysis);
                let finished = finished.get().expect("a report");
                let rtol = match analysis {
                    Analysis::Spinup => 1e-3,
                    Analysis::Static => 1e-6,
                    // a flat maximum says where it is to half of the digits
                    Analysis::Unbalance | Analysis::Harmonic | Analysis::Map => 1e-6,
                    _ => 1e-7,
                };
                compare(&format!("{stem}.{}", analysis.name()), &finished.json, &kept, rtol, 1e-9);
                for (name, svg) in &finished.plots {
                    assert!(folder.join(name).exists() && svg.contains("</svg>"), "{stem} {name}");
                }
                compared += 1;
            }
        }
    }
    assert!(compared >= 20);
}

/// Of contact scenes the equilibria are kept; a motion repeats to what impacts make of rounding errors.
#[test]
fn reports_of_scenes_are_as_kept() {
    let mut compared = 0;
    for path in crate::common::scene_files() {
        let stem = path.file_stem().expect("name").to_string_lossy().into_owned();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/baselines").join(&stem);
        let loaded = Case::load(&path, &[]).expect("case");
        let file = folder.join("contact.json");
        let wanted = loaded.case.contact.as_ref().is_some_and(|c| c.until.is_none());
        assert_eq!(file.exists(), wanted, "{} (run tests/baselines/remake.sh)", file.display());
        if !wanted {
            continue;
        }
        let kept: Value =
            serde_json::from_str(&std::fs::read_to_string(&file).expect("report")).expect("JSON");
        let finished = report(&loaded, Analysis::Contact);
        let finished = finished.get().expect("a report");
        compare(&stem, &finished.json, &kept, 1e-6, 1e-9);
        // what it cost differs from run to run
        for (name, svg) in finished.plots.iter().filter(|(name, _)| name != "contact-cost.svg") {
            assert!(folder.join(name).exists() && svg.contains("</svg>"), "{stem} {name}");
        }
        compared += 1;
    }
    assert!(compared >= 2);
}
