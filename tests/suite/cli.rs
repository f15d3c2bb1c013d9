//! The program as its users run it: help, files, repeatability, exit codes, the commands of the README.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs the program in a folder of its own that has the cases.
pub fn rotor(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rotor")).args(arguments).current_dir(folder).output().expect("runs")
}

pub fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("folder");
    std::fs::create_dir(folder.path().join("cases")).expect("folder");
    for entry in std::fs::read_dir(project().join("cases")).expect("cases") {
        let path = entry.expect("entry").path();
        std::fs::copy(&path, folder.path().join("cases").join(path.file_name().expect("name")))
            .expect("copy");
    }
    folder
}

pub fn files(folder: &Path) -> Vec<String> {
    let mut list: Vec<String> = std::fs::read_dir(folder)
        .map(|entries| {
            entries.map(|e| e.expect("entry").file_name().to_string_lossy().into_owned()).collect()
        })
        .unwrap_or_default();
    list.sort();
    list
}

pub fn read(path: PathBuf) -> String {
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn help_names_every_command_with_examples() {
    let got = rotor(project(), &["--help"]);
    let help = text(&got.stdout);
    assert!(got.status.success());
    for word in [
        "check",
        "modes",
        "campbell",
        "static",
        "spinup",
        "contact",
        "tradeoff",
        "matrices",
        "validate",
        "schema",
        "Examples:",
        "Exit codes",
    ] {
        assert!(help.contains(word), "{word}");
    }
    let help = text(&rotor(project(), &["campbell", "--help"]).stdout);
    for word in ["--out", "--set", "--threads", "--quiet", "--no-plots"] {
        assert!(help.contains(word), "{word}");
    }
}

#[test]
fn usage_faults_exit_with_2() {
    for arguments in [
        &["spin"][..],
        &["campbell"],
        &["campbell", "cases/bauchau.json", "--frobnicate"],
        &["campbell", "cases/bauchau.json", "--threads", "0"],
        &["campbell", "cases/bauchau.json", "--set", "modes"],
        &["campbell", "cases/table1-square.json"],
        &[],
    ] {
        let got = rotor(project(), arguments);
        assert_eq!(got.status.code(), Some(2), "{arguments:?}");
        assert!(!got.stderr.is_empty(), "{arguments:?}");
    }
}

#[test]
fn campbell_writes_its_report_and_plot() {
    let folder = workplace();
    let got = rotor(folder.path(), &["campbell", "cases/bauchau.json"]);
    assert!(got.status.success(), "{}", text(&got.stderr));
    let out = folder.path().join("reports/bauchau");
    assert_eq!(files(&out), ["campbell.cost.json", "campbell.json", "campbell.svg"]);
    let table = text(&got.stdout);
    assert!(table.contains("631.392") && table.contains("reports/bauchau/campbell.svg"), "{table}");
    let report: Value = serde_json::from_str(&read(out.join("campbell.json"))).expect("JSON");
    assert_eq!(report["results"]["branches"].as_array().expect("list").len(), 12);
    assert_eq!(report["results"]["speeds_rad_s"].as_array().expect("list").len(), 101);
    let error = report["results"]["reduction"]["measured_error"].as_f64().expect("number");
    assert!(error > 0.0 && error < 1e-6);
    for word in ["modelled", "left_out"] {
        assert!(!report["model"][word].as_array().expect("list").is_empty());
    }
}

/// The same case gives the same bytes, whatever the number of threads.
#[test]
fn reports_repeat_byte_by_byte() {
    let folder = workplace();
    let run = |case: &str, threads: &str| {
        let got =
            rotor(folder.path(), &["campbell", case, "--threads", threads, "--out", threads, "--quiet"]);
        assert!(got.status.success() && got.stdout.is_empty(), "{}", text(&got.stderr));
        ["campbell.json", "campbell.svg"].map(|name| read(folder.path().join(threads).join(name)))
    };
    for case in ["cases/bauchau.json", "cases/two-disk-stepped.json"] {
        assert!(run(case, "1") == run(case, "2"));
    }
}

#[test]
fn overrides_and_no_plots() {
    let folder = workplace();
    let set = ["--set", "shaft.segments.0.elements=2", "--set", "modes.count=8", "--no-plots", "--out", "o"];
    let got = rotor(folder.path(), &[&["modes", "cases/table2-circle.json"][..], &set].concat());
    assert!(got.status.success(), "{}", text(&got.stderr));
    assert_eq!(files(&folder.path().join("o")), ["modes.cost.json", "modes.json"]);
    let report: Value = serde_json::from_str(&read(folder.path().join("o/modes.json"))).expect("JSON");
    assert_eq!(report["model"]["elements"], 2);
    assert_eq!(report["results"]["modes"].as_array().expect("list").len(), 8);
}

/// The Matrix Market files hold what the assembly holds: total mass, and zero force for a translation.
#[test]
fn matrices_are_written_with_their_rows() {
    let folder = workplace();
    let got = rotor(folder.path(), &["matrices", "cases/two-disk-stepped.json", "--out", "m"]);
    assert!(got.status.success(), "{}", text(&got.stderr));
    assert_eq!(
        files(&folder.path().join("m")),
        ["G.mtx", "K0.mtx", "M.mtx", "N.mtx", "matrices.cost.json", "matrices.json"]
    );
    let sidecar: Value = serde_json::from_str(&read(folder.path().join("m/matrices.json"))).expect("JSON");
    let rows = sidecar["rows"].as_array().expect("rows");
    let mut mass = 0.0;
    let file = read(folder.path().join("m/M.mtx"));
    let mut lines = file.lines().filter(|l| !l.starts_with('%'));
    let sizes: Vec<usize> =
        lines.next().expect("sizes").split(' ').map(|n| n.parse().expect("number")).collect();
    assert_eq!((sizes[0], sizes[1]), (rows.len(), rows.len()));
    let moves = |i: usize| rows[i - 1]["vector"] == "r" && rows[i - 1]["component"] == "x";
    let mut count = 0;
    for line in lines {
        let mut parts = line.split(' ');
        let mut index = || parts.next().expect("index").parse::<usize>().expect("index");
        let (i, j) = (index(), index());
        if moves(i) && moves(j) {
            mass += parts.next().expect("value").parse::<f64>().expect("value");
        }
        count += 1;
    }
    assert_eq!(count, sizes[2]);
    assert!((mass - 99.289879).abs() < 1e-6, "{mass}");
}

#[test]
fn validate_fails_when_a_value_is_out() {
    let folder = workplace();
    let got = rotor(folder.path(), &["validate", "cases/jeffcott.json"]);
    assert!(got.status.success() && text(&got.stdout).contains("5 of 5 values within tolerance"));
    let path = folder.path().join("cases/jeffcott.json");
    std::fs::write(&path, read(path.clone()).replace("22.24177547", "22.25177547")).expect("write");
    let got = rotor(folder.path(), &["validate", "cases/jeffcott.json"]);
    assert_eq!(got.status.code(), Some(1));
    assert!(text(&got.stdout).contains("OUT"));
}

#[test]
fn schema_is_json_and_describes_the_keys() {
    let got = rotor(project(), &["schema"]);
    let schema: Value = serde_json::from_slice(&got.stdout).expect("JSON");
    for key in [
        "title",
        "materials",
        "sections",
        "shaft",
        "disks",
        "supports",
        "modes",
        "campbell",
        "bodies",
        "contact",
        "expected",
    ] {
        assert!(schema["properties"][key].is_object(), "{key}");
    }
    assert!(schema.to_string().contains("mm, um, km, in"));
}

/// A scene is described without being run: bodies, unknowns, mass, gaps, method and steps.
#[test]
fn check_describes_a_scene() {
    let folder = workplace();
    let got = rotor(folder.path(), &["check", "cases/bar-impact.json", "--out", "o"]);
    assert!(got.status.success(), "{}", text(&got.stderr));
    assert_eq!(files(&folder.path().join("o")), ["check.cost.json", "check.json"]);
    let table = text(&got.stdout);
    for words in [
        "16 2322s",
        "78.500000",
        "left - right  1.000000e-3",
        "penalty, 4.1400e9 N/m^3",
        "250 steps of 2.0000e-4 s",
    ] {
        assert!(table.contains(words), "{words}: {table}");
    }
    let report: Value = serde_json::from_str(&read(folder.path().join("o/check.json"))).expect("JSON");
    let results = &report["results"];
    // four coordinates at each of 33 nodes
    assert_eq!(results["bodies"][1]["degrees_of_freedom"], 132);
    assert_eq!(report["model"]["degrees_of_freedom"], 264);
    assert_eq!(results["bodies"][1]["end_m"].as_array().map(Vec::len), Some(3));
    let mass = results["bodies"][0]["mass_kg"].as_f64().expect("a number");
    assert!((mass - 7850.0 * 0.01).abs() < 1e-9, "{mass}");
    let words = |key: &str| report["model"][key].to_string();
    assert!(words("modelled").contains("contact by penalty") && words("left_out").contains("friction"));
    // an equilibrium in space, and a body that nothing holds
    let set = ["--set", "bodies.1.supports=[]", "--quiet"];
    let got = rotor(
        folder.path(),
        &[&["check", "cases/crossing-cantilevers.json", "--out", "o"][..], &set].concat(),
    );
    assert!(got.status.success(), "{}", text(&got.stderr));
    let report: Value = serde_json::from_str(&read(folder.path().join("o/check.json"))).expect("JSON");
    assert!(
        report["results"]["until_s"].is_null() && report["results"]["steps"] == 4,
        "{}",
        report["results"]
    );
    assert!((report["results"]["pairs"][0]["gap_m"].as_f64().expect("a gap") - 1e-3).abs() < 1e-12);
    assert!(report["diagnostics"].to_string().contains("nothing but contact holds `upper`"));
    // what a run would refuse
    let overlapping = ["check", "cases/bar-impact.json", "--out", "p", "--set", "bodies.1.start=[0.9,0]"];
    let got = rotor(folder.path(), &overlapping);
    let message = text(&got.stderr);
    assert_eq!(got.status.code(), Some(2), "{message}");
    assert!(
        message.contains("at `bodies.1.start`: `left` and `right` overlap by 1.000000e-1 m"),
        "{message}"
    );
    assert!(!folder.path().join("p").exists());
}

/// A command on the other kind of case says which one fits, and writes nothing.
#[test]
fn commands_that_do_not_fit_say_which_do() {
    let folder = workplace();
    for command in ["modes", "campbell", "static", "spinup", "matrices"] {
        let got = rotor(folder.path(), &[command, "cases/bar-impact.json", "--out", "o"]);
        let message = text(&got.stderr);
        assert_eq!(got.status.code(), Some(2), "{command}: {message}");
        assert!(message.contains("at `bodies`: the case is a contact scene"), "{command}: {message}");
        assert!(message.contains("`rotor contact` or `rotor check`"), "{command}: {message}");
    }
    let got = rotor(folder.path(), &["contact", "cases/jeffcott.json", "--out", "o"]);
    let message = text(&got.stderr);
    assert_eq!(got.status.code(), Some(2), "{message}");
    for word in ["at `bodies`: the case is a shaft", "`campbell`", "`spinup`", "spinup.stators"] {
        assert!(message.contains(word), "{word}: {message}");
    }
    assert!(!folder.path().join("o").exists());
    let got = rotor(folder.path(), &["validate", "cases/bar-impact.json", "cases/crossing-cantilevers.json"]);
    assert!(got.status.success() && text(&got.stdout).contains("2 of 2 values within tolerance"));
}

/// A run that fails on the way leaves the earlier report as it was.
#[test]
fn a_failed_run_leaves_old_reports() {
    let folder = workplace();
    let case = ["modes", "cases/jeffcott.json", "--out", "o", "--quiet"];
    assert!(rotor(folder.path(), &case).status.success());
    let before = read(folder.path().join("o/modes.json"));
    let broken = [&case[..], &["--set", "materials.light.nu=0.7"]].concat();
    assert_eq!(rotor(folder.path(), &broken).status.code(), Some(2));
    assert_eq!(read(folder.path().join("o/modes.json")), before);
    assert!(files(&folder.path().join("o")).iter().all(|f| !f.contains("tmp")));
}

/// A load that nothing carries: exit 1, the last state found and what was tried are kept.
#[test]
fn a_collapse_keeps_the_last_state() {
    let folder = workplace();
    let run = ["static", "cases/table7-compression.json", "--out", "o"];
    let set = [
        ["--set", "loads.0.traction=[0,-1e11,0]"],
        ["--set", "loads.1.traction=[0,1e11,0]"],
        ["--set", "shaft.segments.0.elements=2"],
    ];
    let got = rotor(folder.path(), &[&run[..], &set.concat()].concat());
    assert_eq!(got.status.code(), Some(1), "{}", text(&got.stderr));
    assert!(text(&got.stderr).contains("no equilibrium was found beyond"), "{}", text(&got.stderr));
    let report: Value = serde_json::from_str(&read(folder.path().join("o/static.json"))).expect("JSON");
    let reached = report["results"]["load_factor"].as_f64().expect("a load factor");
    assert!(reached > 0.0 && reached < 1.0 && report["results"]["converged"] == false, "{reached}");
}

/// The first interrupt ends a run-up with what is done: a whole report, marked incomplete, exit 1.
#[cfg(unix)]
#[test]
fn an_interrupted_run_up_reports_what_is_done() {
    let folder = workplace();
    let arguments =
        ["spinup", "cases/table8-spin-circle.json", "--out", "o", "--set", "spinup.integrator=adams"];
    let mut run = Command::new(env!("CARGO_BIN_EXE_rotor"))
        .args(arguments)
        .current_dir(folder.path())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("runs");
    // a minute of work: it is far from done when the signal comes
    std::thread::sleep(std::time::Duration::from_secs(2));
    let signal = Command::new("kill").args(["-INT", &run.id().to_string()]).status().expect("kill");
    assert!(signal.success());
    let status = run.wait().expect("ends");
    assert_eq!(status.code(), Some(1));
    let report: Value = serde_json::from_str(&read(folder.path().join("o/spinup.json"))).expect("JSON");
    assert_eq!(report["results"]["complete"], false);
    let reached = report["results"]["final"]["time_s"].as_f64().expect("a time");
    assert!(reached > 0.0 && reached < 1.0, "{reached}");
    let codes: Vec<&str> =
        report["diagnostics"].as_array().expect("list").iter().filter_map(|d| d["code"].as_str()).collect();
    assert!(codes.contains(&"interrupted"), "{codes:?}");
    assert!(files(&folder.path().join("o")).contains(&"energy.svg".to_owned()));
}

/// Every `rotor ...` line of the README's console blocks works.
#[test]
#[ignore = "long"]
fn commands_of_the_readme_run() {
    let folder = workplace();
    let study = Path::new("studies/tradeoff");
    std::fs::create_dir_all(folder.path().join(study)).expect("folder");
    for name in files(&project().join(study)) {
        std::fs::copy(project().join(study).join(&name), folder.path().join(study).join(&name))
            .expect("copy");
    }
    let readme = read(project().join("README.md"));
    let mut commands = 0;
    for line in readme.lines().filter_map(|l| l.strip_prefix("$ ")) {
        let command = line.strip_prefix("cargo run --release -- ").or_else(|| line.strip_prefix("rotor "));
        let Some(command) = command.filter(|c| *c != "validate") else { continue };
        let mut arguments: Vec<&str> = command.split_whitespace().collect();
        if arguments[0] == "tradeoff" {
            // what is repeated is the measurement of time
            arguments.extend(["--set", "tradeoff.repeats=1"]);
        }
        let got = rotor(folder.path(), &arguments);
        assert!(got.status.success(), "{line}: {}", text(&got.stderr));
        commands += 1;
    }
    assert!(commands >= 5, "only {commands} commands found");
    // git ignores what they write: everything is in reports/, where only a page is kept
    assert_eq!(files(folder.path()), ["cases", "reports", "studies"]);
    assert_eq!(files(&folder.path().join("cases")), files(&project().join("cases")));
    assert_eq!(files(&folder.path().join(study)), files(&project().join(study)));
    let ignored = read(project().join(".gitignore"));
    assert!(
        ignored.lines().any(|l| l == "/reports/*") && ignored.lines().any(|l| l == "!/reports/README.md")
    );
    assert!(!folder.path().join("reports/README.md").exists());
}

/// Narrower vector instructions give the same numbers to rounding; a set that no processor has is refused.
#[test]
fn vector_instructions_can_be_chosen() {
    let folder = tempfile::tempdir().expect("folder");
    let run = |set: &str, out: &str| {
        let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/table9-spin-ellipse.json");
        Command::new(env!("CARGO_BIN_EXE_rotor"))
            .args([
                "spinup",
                case.to_str().expect("path"),
                "--set",
                "spinup.steady=true",
                "--no-plots",
                "--quiet",
            ])
            .args(["--instructions", set, "--out", out])
            .current_dir(folder.path())
            .output()
            .expect("run")
    };
    let growth = |set: &str| {
        let got = run(set, set);
        assert!(got.status.success(), "{}", String::from_utf8_lossy(&got.stderr));
        let text = std::fs::read_to_string(folder.path().join(set).join("spinup.json")).expect("report");
        let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        report["results"]["final"]["growth_m"][1].as_f64().expect("growth")
    };
    assert!((growth("none") / growth("widest") - 1.0).abs() < 1e-8);
    let got = run("sse9", "wrong");
    assert_eq!(got.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&got.stderr).contains("this processor has widest"));
}
