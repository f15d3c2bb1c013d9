//! The streams of the program: full, closed, and free of what steers a terminal.

use crate::cli::{files, read, rotor, text, workplace};
use serde_json::{Value, json};
use std::process::{Command, Output};

/// Runs a line of the shell in a folder with the cases; `$0` is the program.
#[cfg(unix)]
fn shell(folder: &std::path::Path, line: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_rotor");
    Command::new("bash").args(["-c", line, program]).current_dir(folder).output().expect("runs")
}

/// Text that a full device takes is lost: exit 1. The reports are written all the same.
#[cfg(target_os = "linux")]
#[test]
fn lost_output_is_a_fault() {
    let folder = workplace();
    for line in [
        "modes cases/jeffcott.json --out o",
        "check cases/jeffcott.json --out o",
        "matrices cases/jeffcott.json --out o",
        "validate cases/jeffcott.json",
        "schema",
        "--help",
        "--version",
        "modes --help",
    ] {
        let got = shell(folder.path(), &format!("$0 {line} >/dev/full"));
        let message = text(&got.stderr);
        assert_eq!(got.status.code(), Some(1), "{line}: {message}");
        assert!(message.contains("standard output cannot be written"), "{line}: {message}");
    }
    for name in ["modes.json", "check.json", "M.mtx"] {
        assert!(files(&folder.path().join("o")).contains(&name.to_owned()), "{name}");
    }
}

/// Messages that can't be written change no exit code of a fault, and nothing panics.
#[cfg(target_os = "linux")]
#[test]
fn lost_messages_do_not_panic() {
    let folder = workplace();
    let absent = "modes absent.json";
    let collapse = "static cases/table7-compression.json --out o --set loads.0.traction=[0,-1e11,0] --set \
                    loads.1.traction=[0,1e11,0] --set shaft.segments.0.elements=2";
    for (line, code) in [(absent, 2), ("modes", 2), ("--frobnicate", 2), (collapse, 1)] {
        let got = shell(folder.path(), &format!("$0 {line} 2>/dev/full"));
        assert_eq!(got.status.code(), Some(code), "{line}: {}", text(&got.stdout));
        let got = shell(folder.path(), &format!("$0 {line} 2>&1 | true; exit ${{PIPESTATUS[0]}}"));
        assert_eq!(got.status.code(), Some(code), "{line}");
    }
}

/// A reader that closed early is no fault of the run.
#[cfg(unix)]
#[test]
fn a_closed_pipe_is_quiet() {
    let folder = workplace();
    for line in ["modes cases/jeffcott.json", "schema", "--help", "validate cases/jeffcott.json"] {
        let got = shell(folder.path(), &format!("(sleep 0.2; $0 {line}) | true; exit ${{PIPESTATUS[0]}}"));
        assert_eq!(got.status.code(), Some(0), "{line}: {}", text(&got.stderr));
        assert!(got.stderr.is_empty(), "{line}: {}", text(&got.stderr));
    }
}

/// Nothing but line ends and tabulators steers.
fn steered(text: &str) -> Option<char> {
    let marks = ['\u{202e}', '\u{2066}', '\u{200f}', '\u{feff}', '\u{9b}'];
    text.chars().find(|c| (c.is_control() && !"\n\t".contains(*c)) || marks.contains(c))
}

/// Titles and names with escape sequences, direction marks and line ends.
#[test]
fn names_do_not_steer_the_terminal() {
    let folder = workplace();
    let evil = "a\u{1b}[2J\u{202e}b\r\u{9b}31m\u{7f}\u{2066}<&>\u{1}";
    let mut case: Value =
        serde_json::from_str(&read(folder.path().join("cases/table5-cantilever.json"))).expect("JSON");
    case["title"] = json!(format!("{evil}\nwrote forged.json"));
    case["probes"][0]["name"] = json!(evil);
    case["expected"] = json!([]);
    case["shaft"]["segments"][0]["elements"] = json!(2);
    let write =
        |case: &Value| std::fs::write(folder.path().join("evil.json"), case.to_string()).expect("written");
    write(&case);
    for analysis in ["check", "modes", "static", "matrices"] {
        let got = rotor(folder.path(), &[analysis, "evil.json", "--out", "o"]);
        assert!(got.status.success(), "{analysis}: {}", text(&got.stderr));
        let table = text(&got.stdout);
        assert_eq!(steered(&table), None, "{analysis}: {table:?}");
        assert!(!table.lines().any(|l| l == "wrote forged.json"), "{table}");
    }
    for name in files(&folder.path().join("o")) {
        let content = read(folder.path().join("o").join(&name));
        if name.ends_with(".mtx") {
            assert_eq!(steered(&content), None, "{name}");
            assert_eq!(content.lines().filter(|l| l.starts_with('%')).count(), 3, "{name}");
        }
        if name.ends_with(".svg") {
            assert_eq!(steered(&content), None, "{name}");
            roxmltree::Document::parse(&content).unwrap_or_else(|e| panic!("{name}: {e}"));
        }
    }
    // messages: names and values of the case
    case["shaft"]["segments"][0]["material"] = json!(evil);
    write(&case);
    let got = rotor(folder.path(), &["check", "evil.json"]);
    assert_eq!((got.status.code(), steered(&text(&got.stderr))), (Some(2), None));
    let got = rotor(folder.path(), &["check", evil.trim_end_matches('\u{1}'), "--set", evil]);
    assert_eq!((got.status.code(), steered(&text(&got.stderr))), (Some(2), None));
}
