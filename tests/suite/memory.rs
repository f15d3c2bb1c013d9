//! Memory: estimated with sweep, basis, histories and probes, refused beforehand, and never a cause to abort.

use crate::cli::{read, rotor, text, workplace};
use crate::common::case;
use rotor::case::LoadedCase;
use rotor::check::memory::memory;
use rotor::model::Model;
use serde_json::{Value, json};
use std::path::Path;

fn refusal(case: &LoadedCase, set: Value) -> String {
    let changed = case.with(set.as_object().expect("overrides")).unwrap_or_else(|e| panic!("{e}"));
    let error = Model::new(&changed).err().unwrap_or_else(|| panic!("{set} was accepted"));
    assert_eq!(error.exit_code(), 2, "{error}");
    error.to_string()
}

/// What needs more than 12 GB is refused by what takes the most of it.
#[test]
fn all_that_takes_memory_is_counted() {
    let sweep = refusal(&case("bauchau"), json!({ "campbell.speeds.count": 100_000 }));
    assert!(sweep.contains("at `campbell.speeds.count`") && sweep.contains("sweep"), "{sweep}");
    let basis = refusal(
        &case("bauchau"),
        json!({ "campbell.reduction": 5000, "campbell.speeds.count": 3, "shaft.segments.0.elements": 400 }),
    );
    assert!(basis.contains("at `campbell.reduction`"), "{basis}");
    let probes: Vec<Value> = (0..400)
        .map(|i| json!({ "name": format!("p{i}"), "at": 0.5, "line": "y", "points": 10_000 }))
        .collect();
    let points: Vec<Value> = (0..40).map(|i| json!({ "name": format!("p{i}"), "at": 0.5 })).collect();
    let history =
        refusal(&case("table8-spin-circle"), json!({ "spinup.output": 1_000_000, "probes": points }));
    assert!(history.contains("at `spinup.output`") && history.contains("history"), "{history}");
    let lines = refusal(&case("table8-spin-circle"), json!({ "probes": probes }));
    assert!(lines.contains("at `probes`"), "{lines}");
    // what machines have is let in
    for (name, set) in [
        ("bauchau", json!({ "campbell.speeds.count": 10_000 })),
        ("table8-spin-circle", json!({ "spinup.output": 100_000 })),
    ] {
        let changed = case(name).with(set.as_object().expect("overrides")).expect("a case");
        Model::new(&changed).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Peak memory of a run over the estimate.
fn share(folder: &Path, analysis: &str, name: &str, set: &[&str]) -> f64 {
    let path = format!("cases/{name}.json");
    let got =
        rotor(folder, &[&[analysis, &path, "--quiet", "--threads", "2", "--out", "o"][..], set].concat());
    assert!(got.status.success(), "{}", text(&got.stderr));
    let cost: Value =
        serde_json::from_str(&read(folder.join(format!("o/{analysis}.cost.json")))).expect("JSON");
    let mut changed = case(name);
    for pair in set.chunks(2) {
        let (path, value) = pair[1].split_once('=').expect("an override");
        let value = serde_json::from_str(value).expect("JSON");
        changed = changed.with(&[(path.to_owned(), value)].into_iter().collect()).expect("a case");
    }
    let model = Model::new(&changed).unwrap_or_else(|e| panic!("{e}"));
    let estimate: f64 = memory(&model).iter().map(|share| share.bytes).sum();
    cost["peak_memory_mb"].as_f64().expect("a number") * 1048576.0 / estimate
}

/// Sweep, history and probes, each so large that it decides: within a factor of two.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "long"]
fn estimates_are_within_a_factor_of_two() {
    let folder = workplace();
    let probes = r#"probes=[{"name":"a","at":0.5,"line":"y","points":10000},{"name":"b","at":0.4,"line":"z","points":10000}]"#;
    for (analysis, name, set) in [
        (
            "campbell",
            "bauchau",
            vec![
                "--set",
                "campbell.speeds.count=801",
                "--set",
                "campbell.reduction=40",
                "--set",
                "shaft.segments.0.elements=2",
            ],
        ),
        ("spinup", "table8-spin-circle", vec!["--set", "spinup.output=20001"]),
        ("static", "table5-cantilever", vec!["--set", probes]),
    ] {
        let share = share(folder.path(), analysis, name, &set);
        assert!((0.5..=2.0).contains(&share), "{analysis} {name}: {share:.2} of the estimate");
    }
}

/// A process that is allowed less than the run needs says so before it starts: exit 1, nothing written.
#[cfg(target_os = "linux")]
#[test]
fn too_little_memory_is_no_abort() {
    let folder = workplace();
    for run in [
        "campbell cases/bauchau.json --set campbell.speeds.count=20000",
        "modes cases/bauchau.json --set shaft.segments.0.elements=5000",
        "spinup cases/table8-spin-circle.json --set spinup.output=800000",
    ] {
        // a thread's stack and the program itself take some of it
        let line = format!("ulimit -v 1500000; $0 {run} --threads 2 --out o");
        let got = std::process::Command::new("bash")
            .args(["-c", &line, env!("CARGO_BIN_EXE_rotor")])
            .current_dir(folder.path())
            .output()
            .expect("runs");
        let message = text(&got.stderr);
        assert_eq!(got.status.code(), Some(1), "{run}: {message}");
        assert!(message.contains("not enough memory") && message.contains("remedy:"), "{run}: {message}");
        assert!(!folder.path().join("o").exists(), "{run}");
    }
}
