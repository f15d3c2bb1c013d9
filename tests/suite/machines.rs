//! What must not depend on the machine: every word that a report keeps, whatever rounding does to its numbers.
//!
//! Another processor sums in another order. Two things stand in for it: the kernels' vector instructions, which can be chosen, and
//! inputs that are moved by a few units in the last place.

use crate::common::{case, case_files, model, report_json, scene_files, shaken, with};
use rotor::analysis::spinup::spinup;
use rotor::case::{Case, LoadedCase};
use rotor::instructions::Instructions;
use rotor::results::Spinup;
use rotor::run::{Analysis, Host, run};
use serde_json::{Value, json};

/// What rounding may change in a report: numbers, and how an iteration went.
const PATHS: [&str; 9] = [
    "newton",
    "integrator",
    "message",
    "sha256",
    "case",
    "gap_checks",
    "contact_evaluations",
    "solver",
    "events",
];

/// Fails where words, labels, counts or codes differ.
fn same_words(path: &str, a: &Value, b: &Value) {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            let keys = |m: &serde_json::Map<String, Value>| m.keys().cloned().collect::<Vec<_>>();
            assert_eq!(keys(a), keys(b), "{path}");
            for (key, value) in a.iter().filter(|(key, _)| !PATHS.contains(&key.as_str())) {
                same_words(&format!("{path}.{key}"), value, &b[key]);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| same_words(&format!("{path}.{i}"), a, b));
        }
        (Value::Number(_), Value::Number(_)) => {}
        // sentences carry numbers: what stands before the first digit is compared
        (Value::String(a), Value::String(b)) => {
            let words =
                |text: &str| text.split(|c: char| c.is_ascii_digit()).next().unwrap_or_default().to_owned();
            assert_eq!(words(a), words(b), "{path}");
        }
        _ => assert_eq!(a, b, "{path}"),
    }
}

fn report(case: &LoadedCase, analysis: Analysis) -> Value {
    run(case, analysis, &Host::silent()).unwrap_or_else(|e| panic!("{}: {e}", case.file)).json
}

/// Labels, names, counts, senses, kinds, codes: the same for every case when its inputs move by a few units in the last place.
#[test]
#[ignore = "long"]
fn words_survive_rounding_of_the_inputs() {
    for (k, path) in case_files().into_iter().enumerate() {
        let loaded = Case::load(&path, &[]).expect("case");
        for analysis in [Analysis::Check, Analysis::Modes, Analysis::Campbell, Analysis::Static] {
            let wanted = match analysis {
                Analysis::Campbell => loaded.case.campbell.is_some(),
                Analysis::Static => !loaded.case.loads.is_empty(),
                _ => true,
            };
            if wanted {
                let what = format!("{} {}", path.display(), analysis.name());
                same_words(
                    &what,
                    &report_json(&loaded, analysis),
                    &report(&shaken(&loaded, 1 + k as u64), analysis),
                );
            }
        }
    }
}

/// The same of steady states, short run-ups and equilibria of scenes.
#[test]
#[ignore = "long"]
fn words_of_nonlinear_analyses_survive_rounding_of_the_inputs() {
    for (k, path) in case_files().into_iter().enumerate() {
        let loaded = Case::load(&path, &[]).expect("case");
        let Some(spin) = &loaded.case.spinup else { continue };
        // a run through a resonance with rings repeats to the integrator's tolerance only
        if !spin.stators.is_empty() {
            continue;
        }
        let steady = with(&loaded, json!({ "spinup.steady": true }));
        let what = format!("{} steady", path.display());
        let attempt = |case: &LoadedCase| run(case, Analysis::Spinup, &Host::silent());
        match (attempt(&steady), attempt(&shaken(&steady, 7 + k as u64))) {
            (Ok(a), Ok(b)) => same_words(&what, &a.json, &b.json),
            (Err(a), Err(b)) => assert_eq!(a.exit_code(), b.exit_code(), "{what}"),
            (a, b) => panic!("{what}: {:?} {:?}", a.err(), b.err()),
        }
    }
    for path in scene_files() {
        let loaded = Case::load(&path, &[]).expect("case");
        if loaded.case.contact.as_ref().is_some_and(|c| c.until.is_none()) {
            let what = path.display().to_string();
            same_words(
                &what,
                &report_json(&loaded, Analysis::Contact),
                &report(&shaken(&loaded, 3), Analysis::Contact),
            );
        }
    }
}

fn run_up(case: &LoadedCase, instructions: Instructions) -> Spinup {
    let mut model = model(case);
    model.instructions = instructions;
    let settings = model.spinup.clone().expect("spinup");
    spinup(&model, &settings, &|_, _| true).unwrap_or_else(|e| panic!("{e}")).results
}

/// Run-ups, steady states and energies with every set of vector instructions that the processor has.
#[test]
#[ignore = "long"]
fn every_vector_width_tells_the_same() {
    let sets: Vec<Instructions> = Instructions::NAMED.into_iter().filter(|s| s.are_available()).collect();
    assert!(sets.len() >= 2);
    let cases = [
        with(&case("table8-spin-circle"), json!({ "spinup.output": 11 })),
        with(&case("tube-growth"), json!({ "spinup.output": 11 })),
        with(&case("table9-spin-ellipse"), json!({ "spinup.steady": true })),
    ];
    for case in &cases {
        let widest = run_up(case, Instructions::Widest);
        for &set in sets.iter().filter(|set| **set != Instructions::Widest) {
            let ours = run_up(case, set);
            let (a, b) = (ours.last.growth_m, widest.last.growth_m);
            let size = b[0].abs().max(b[1].abs());
            assert!((0..2).all(|i| (a[i] - b[i]).abs() < 1e-6 * size), "{}: {set:?} {a:?} {b:?}", case.file);
            assert_eq!(ours.last.growth_at_m, widest.last.growth_at_m);
            if let (Some(a), Some(b)) = (&ours.energy, &widest.energy) {
                assert!((a.drive_work_j / b.drive_work_j - 1.0).abs() < 1e-6, "{}: {set:?}", case.file);
            }
        }
    }
}
