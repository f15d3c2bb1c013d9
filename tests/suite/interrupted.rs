//! Runs that are killed, find the disk full or the folder closed: earlier reports stay whole. Repeated runs and other
//! numbers of threads give the same bytes.

use crate::cli::{files, read, rotor, text, workplace};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Every file of the folder but costs and what a killed run left under temporary names.
fn reports(folder: &Path) -> Vec<(String, String)> {
    let kept = |name: &String| !name.starts_with('.') && !name.ends_with(".cost.json");
    files(folder).into_iter().filter(kept).map(|name| (name.clone(), read(folder.join(&name)))).collect()
}

/// One case, four analyses: the same bytes again, and with another number of threads.
#[test]
fn every_analysis_repeats_byte_by_byte() {
    let folder = workplace();
    let small = ["--set", "shaft.segments.0.elements=2", "--quiet"];
    let run = |analysis: &str, case: &str, threads: &str, out: &str| {
        let case = format!("cases/{case}.json");
        let list = [analysis, &case, "--threads", threads, "--out", out];
        let got = rotor(folder.path(), &[&list[..], &small].concat());
        assert!(got.status.success(), "{analysis}: {}", text(&got.stderr));
    };
    for (out, threads) in [("a", "1"), ("b", "1"), ("c", "2")] {
        run("check", "bauchau", threads, out);
        run("modes", "bauchau", threads, out);
        run("campbell", "bauchau", threads, out);
        run("static", "table5-cantilever", threads, out);
        run("spinup", "table8-spin-circle", threads, out);
    }
    let [a, b, c] = ["a", "b", "c"].map(|out| reports(&folder.path().join(out)));
    assert!(a.len() >= 10, "{:?}", files(&folder.path().join("a")));
    assert!(a == b && a == c);
}

/// Killed at whatever moment, a run leaves each file as it was or whole and new.
#[cfg(unix)]
#[test]
fn a_killed_run_leaves_whole_reports() {
    let folder = workplace();
    let out = folder.path().join("o");
    let arguments =
        |modes: &'static str| ["modes", "cases/jeffcott.json", "--quiet", "--out", "o", "--set", modes];
    let [old, new] = ["modes.count=4", "modes.count=5"].map(|modes| {
        assert!(rotor(folder.path(), &arguments(modes)).status.success());
        reports(&out)
    });
    assert!(old.len() == 2 && old.iter().zip(&new).all(|(a, b)| a.0 == b.0 && a.1 != b.1));
    let (mut killed, mut finished) = (0, 0);
    for delay in 0..60 {
        let mut run = Command::new(env!("CARGO_BIN_EXE_rotor"))
            .args(arguments(if delay % 2 == 0 { "modes.count=4" } else { "modes.count=5" }))
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("runs");
        std::thread::sleep(Duration::from_millis(delay));
        run.kill().expect("SIGKILL");
        if run.wait().expect("ends").success() {
            finished += 1
        } else {
            killed += 1
        }
        for ((found, a), b) in reports(&out).iter().zip(&old).zip(&new) {
            assert!(found == a || found == b, "{} is neither the old nor the new one", found.0);
        }
    }
    assert!(killed > 0, "{finished} runs were faster than the signal");
    // what killed runs left under temporary names is removed by the next one
    std::fs::write(out.join(".modes.json.4194999.tmp"), "half a report").expect("written");
    assert!(rotor(folder.path(), &arguments("modes.count=4")).status.success());
    assert_eq!(reports(&out), old);
    assert_eq!(files(&out), ["modes.cost.json", "modes.json", "modes.svg"]);
}

/// A file may not grow beyond a kilobyte, as on a full disk: exit 2, the reports are the old ones.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_old_reports() {
    let folder = workplace();
    let out = folder.path().join("o");
    let case = ["modes", "cases/jeffcott.json", "--quiet", "--out", "o"];
    assert!(rotor(folder.path(), &case).status.success());
    let before = reports(&out);
    let script = r#"trap "" XFSZ; ulimit -f 1; exec "$0" "$@""#;
    let more = ["--set", "modes.count=20"];
    let got = Command::new("bash")
        .args(["-c", script, env!("CARGO_BIN_EXE_rotor")])
        .args(case)
        .args(more)
        .current_dir(folder.path())
        .output()
        .expect("runs");
    let message = text(&got.stderr);
    assert_eq!(got.status.code(), Some(2), "{message}");
    assert!(message.contains("modes") && message.contains("write"), "{message}");
    assert_eq!(reports(&out), before);
    assert!(files(&out).iter().all(|name| !name.ends_with(".tmp")), "{:?}", files(&out));
}

/// A folder that takes no files, even of the superuser.
#[cfg(target_os = "linux")]
#[test]
fn a_read_only_folder_is_an_error_with_its_name() {
    let folder = workplace();
    let got =
        rotor(folder.path(), &["modes", "cases/jeffcott.json", "--quiet", "--out", "/proc/self/reports"]);
    assert_eq!(got.status.code(), Some(2));
    assert!(text(&got.stderr).contains("/proc/self/reports"), "{}", text(&got.stderr));
    let closed = folder.path().join("closed");
    std::fs::create_dir(&closed).expect("folder");
    let mut permissions = std::fs::metadata(&closed).expect("folder").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&closed, permissions).expect("permissions");
    // the superuser writes there all the same
    if std::fs::write(closed.join("probe"), "").is_err() {
        let got = rotor(folder.path(), &["modes", "cases/jeffcott.json", "--quiet", "--out", "closed"]);
        assert_eq!(got.status.code(), Some(2));
        assert!(text(&got.stderr).contains("closed") && files(&closed).is_empty());
    }
}

/// The cost of a run stands beside its report, not in it.
#[test]
fn costs_stand_beside_the_reports() {
    let folder = workplace();
    assert!(
        rotor(folder.path(), &["modes", "cases/jeffcott.json", "--quiet", "--out", "o"]).status.success()
    );
    let cost: Value = serde_json::from_str(&read(folder.path().join("o/modes.cost.json"))).expect("JSON");
    assert!(cost["wall_s"].as_f64().is_some_and(|s| s > 0.0), "{cost}");
    assert!(!read(folder.path().join("o/modes.json")).contains("wall_s"));
}

/// A step with a million outputs notices the signal among them: a whole report, marked incomplete, exit 1.
#[cfg(unix)]
#[test]
fn a_run_up_with_many_outputs_stops_when_told() {
    let folder = workplace();
    let set = [
        ["--set", "spinup.output=1000000"],
        ["--set", r#"probes=[{"name":"line","at":0.5,"line":"y","points":10000}]"#],
        ["--set", "materials.steel.nu=0.3"],
    ];
    let arguments =
        [&["spinup", "cases/table8-spin-circle.json", "--out", "o", "--no-plots"][..], &set.concat()]
            .concat();
    let mut run = Command::new(env!("CARGO_BIN_EXE_rotor"))
        .args(arguments)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("runs");
    std::thread::sleep(Duration::from_secs(2));
    let started = Instant::now();
    assert!(Command::new("kill").args(["-TERM", &run.id().to_string()]).status().expect("kill").success());
    let status = run.wait().expect("ends");
    assert_eq!(status.code(), Some(1));
    assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
    let report: Value = serde_json::from_str(&read(folder.path().join("o/spinup.json"))).expect("JSON");
    assert_eq!(report["results"]["complete"], false);
    let times = report["results"]["history"]["time_s"].as_array().expect("times");
    assert!(times.len() > 100 && times.len() < 1_000_000, "{}", times.len());
    // the state at the end is that of the last output
    assert_eq!(times.last(), Some(&report["results"]["final"]["time_s"]));
}

/// Before the motion begins there is nothing to report: a signal ends the run within seconds, a second one at once.
#[cfg(unix)]
#[test]
fn a_run_that_has_nothing_to_report_ends_all_the_same() {
    let folder = workplace();
    let start = || {
        Command::new(env!("CARGO_BIN_EXE_rotor"))
            .args([
                "spinup",
                "cases/table8-spin-circle.json",
                "--out",
                "o",
                "--set",
                "shaft.segments.0.elements=6000",
            ])
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("runs")
    };
    for (signals, most) in [(1, 8.0), (2, 2.0)] {
        let mut run = start();
        std::thread::sleep(Duration::from_millis(500));
        let started = Instant::now();
        for _ in 0..signals {
            let id = run.id().to_string();
            assert!(Command::new("kill").args(["-TERM", &id]).status().expect("kill").success());
            std::thread::sleep(Duration::from_millis(300));
        }
        let status = run.wait().expect("ends");
        assert!(started.elapsed().as_secs_f64() < most, "{:?}", started.elapsed());
        // a fast machine may have begun the motion meanwhile, and reports it
        let begun = folder.path().join("o/spinup.json").exists();
        assert_eq!(status.code(), Some(if begun { 1 } else { 130 }));
    }
}
