//! What reports hold and where they go: the case as run, one case to a folder, the files of one run together.

use crate::cli::{files, read, rotor, text, workplace};
use serde_json::Value;
use std::path::Path;

fn json(path: &Path) -> Value {
    serde_json::from_str(&read(path.to_owned())).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn run(folder: &Path, arguments: &[&str]) {
    let got = rotor(folder, arguments);
    assert!(got.status.success(), "{arguments:?}: {}", text(&got.stderr));
}

/// The case within a report is the one that was run: it gives the report again, digit by digit.
#[test]
fn a_report_holds_the_case_that_was_run() {
    let folder = workplace();
    let set = [
        ["--set", "shaft.segments.0.elements=2"],
        ["--set", "materials.light.nu=0.29926108374384236"],
        ["--set", "sections.shaft.radius=6 mm"],
    ];
    let case = ["modes", "cases/jeffcott.json", "--quiet", "--out", "a"];
    run(folder.path(), &[&case[..], &set.concat()].concat());
    let report = json(&folder.path().join("a/modes.json"));
    let overrides = &report["case"]["overrides"];
    assert_eq!(overrides["shaft.segments.0.elements"], 2);
    assert_eq!(overrides["sections.shaft.radius"], "6 mm");
    assert_eq!(overrides.as_object().map(|map| map.len()), Some(3));
    let effective = &report["case"]["effective"];
    assert_eq!(effective["materials"]["light"]["nu"], 0.29926108374384236);
    std::fs::write(folder.path().join("again.json"), effective.to_string()).expect("written");
    run(folder.path(), &["modes", "again.json", "--quiet", "--out", "b"]);
    let again = json(&folder.path().join("b/modes.json"));
    assert_eq!(report["results"], again["results"]);
    assert_eq!(report["model"], again["model"]);
    // the drawing names the report it belongs to
    let sha = report["case"]["sha256"].as_str().expect("a hash");
    assert!(read(folder.path().join("a/modes.svg")).contains(sha));
}

/// Two case files of one name: the reports of the first are not replaced in silence.
#[test]
fn reports_of_another_case_are_not_replaced() {
    let folder = workplace();
    for name in ["one", "two"] {
        std::fs::create_dir(folder.path().join(name)).expect("folder");
        std::fs::copy(folder.path().join("cases/jeffcott.json"), folder.path().join(name).join("rotor.json"))
            .expect("copy");
    }
    run(folder.path(), &["modes", "one/rotor.json", "--quiet"]);
    let kept = read(folder.path().join("reports/rotor/modes.json"));
    for analysis in ["modes", "check"] {
        let got = rotor(folder.path(), &[analysis, "two/rotor.json", "--set", "modes.count=4"]);
        let message = text(&got.stderr);
        assert_eq!(got.status.code(), Some(2), "{message}");
        for words in ["reports/rotor", "one/rotor.json", "--out reports/two-rotor"] {
            assert!(message.contains(words), "{words}: {message}");
        }
    }
    assert_eq!(read(folder.path().join("reports/rotor/modes.json")), kept);
    assert!(!folder.path().join("reports/rotor/check.json").exists());
    // a folder that was asked for is used, and what goes is said
    let got = rotor(folder.path(), &["modes", "two/rotor.json", "--out", "reports/rotor"]);
    let message = text(&got.stderr);
    assert!(
        got.status.success() && message.contains("note:") && message.contains("one/rotor.json"),
        "{message}"
    );
    // the same case again, changed or not, and a case that was moved
    run(folder.path(), &["modes", "two/../two/rotor.json", "--set", "modes.count=5"]);
    std::fs::rename(folder.path().join("two"), folder.path().join("three")).expect("moved");
    run(folder.path(), &["modes", "three/rotor.json", "--quiet"]);
}

/// A name of dots leads nowhere else.
#[test]
fn reports_stay_in_their_folder() {
    let folder = workplace();
    for name in ["...json", "..json"] {
        std::fs::copy(folder.path().join("cases/jeffcott.json"), folder.path().join(name)).expect("copy");
        run(folder.path(), &["modes", name, "--quiet"]);
        assert!(folder.path().join("reports").join(name).join("modes.json").exists(), "{name}");
    }
    assert_eq!(files(folder.path()), ["...json", "..json", "cases", "reports"]);
    assert_eq!(files(&folder.path().join("reports")), ["...json", "..json"]);
}

/// The plots of a run go with its report.
#[test]
fn plots_of_an_earlier_run_do_not_stay_beside_a_new_report() {
    let folder = workplace();
    let out = folder.path().join("o");
    run(folder.path(), &["modes", "cases/jeffcott.json", "--quiet", "--out", "o"]);
    std::fs::write(out.join("mine.svg"), "").expect("written");
    run(folder.path(), &["check", "cases/jeffcott.json", "--quiet", "--out", "o"]);
    assert!(out.join("modes.svg").exists());
    run(folder.path(), &["modes", "cases/jeffcott.json", "--quiet", "--no-plots", "--out", "o"]);
    assert_eq!(files(&out), ["check.cost.json", "check.json", "mine.svg", "modes.cost.json", "modes.json"]);
}
