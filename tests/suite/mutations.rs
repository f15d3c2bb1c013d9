//! Mutated cases: accepted or refused, never a panic, a hang or a number that is none.
//!
//! Every case of the repository is changed at random, as JSON and as text. `MUTATIONS=1000000` sets how many are
//! tried, `PROPTEST_RNG_SEED=2` another sequence. A failure prints the text; it goes to `tests/corpus`, as do those
//! that the fuzzer of `tests/fuzz` finds.

use crate::common::{case_files, scene_files};
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::RngSeed;
use rotor::analysis::check::check;
use rotor::analysis::contact;
use rotor::analysis::mass_properties::properties;
use rotor::case::{Case, LoadedCase};
use rotor::model::Model;
use rotor::model::scene::Scene;
use rotor::run::{Analysis, Host, run};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// No input may take longer.
const HANG: Duration = Duration::from_secs(5);

/// How many mutations are tried, unless the environment says otherwise.
pub fn count(default: u32) -> u32 {
    std::env::var("MUTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

/// The same sequence in each run, so that a change is not blamed for what another sequence finds.
pub fn config(cases: u32) -> ProptestConfig {
    let seed = std::env::var("PROPTEST_RNG_SEED").ok().and_then(|n| n.parse().ok()).unwrap_or(1);
    let rng_seed = RngSeed::Fixed(seed);
    ProptestConfig { cases, rng_seed, failure_persistence: None, ..ProptestConfig::default() }
}

/// The cases of the repository, two elements to a segment.
pub static CASES: LazyLock<Vec<Value>> =
    LazyLock::new(|| case_files().iter().map(|path| small(path, "/shaft/segments", 2)).collect());

/// The contact scenes of the repository, four elements to a body.
pub static SCENES: LazyLock<Vec<Value>> =
    LazyLock::new(|| scene_files().iter().map(|path| small(path, "/bodies", 4)).collect());

/// A case with so many elements in each entry of a list.
fn small(path: &Path, list: &str, elements: u32) -> Value {
    let mut value = Case::load(path, &[]).unwrap_or_else(|e| panic!("{e}")).value;
    let list = value.pointer_mut(list).and_then(Value::as_array_mut);
    list.into_iter().flatten().for_each(|entry| entry["elements"] = json!(elements));
    // prose and long lists of what is expected would take most of the changes
    value["description"] = json!("");
    value["expected"].as_array_mut().into_iter().for_each(|list| list.truncate(1));
    value
}

/// What `rotor check` does with a text, without files: an error of exit code 2, or a report of numbers; without its
/// estimates, which take most of the time, where not all is asked for.
fn feed(text: &str, all: bool) -> Option<LoadedCase> {
    let started = Instant::now();
    let loaded = Case::parse("mutated.json", text, &[]).and_then(|loaded| {
        let model = Model::new(&loaded)?;
        assert!(model.length.is_finite() && model.reference_length > 0.0, "no size: {text}");
        let p = properties(&model);
        assert!(p.mass().is_finite() && p.diametral.iter().all(|i| i.is_finite()), "not a number: {text}");
        if all {
            let outcome = check(&model)?;
            finite(&serde_json::to_value(&outcome.results).unwrap_or_else(|e| panic!("{e}: {text}")), text);
        }
        Ok(loaded)
    });
    assert!(started.elapsed() < HANG, "{:?}: {text}", started.elapsed());
    loaded.map_err(|error| assert_eq!(error.exit_code(), 2, "{error}: {text}")).ok()
}

/// The same of a contact scene.
fn feed_scene(text: &str, all: bool) -> Option<LoadedCase> {
    let started = Instant::now();
    let loaded = Case::parse("mutated.json", text, &[]).and_then(|loaded| {
        let scene = Scene::new(&loaded)?;
        if let Some(overlap) = contact::overlap(&scene)? {
            assert!(overlap.depth.is_finite() && overlap.bodies.0 < overlap.bodies.1, "{overlap:?}: {text}");
        }
        if all {
            let results = contact::check(&scene)?.results;
            assert!(results.pairs.iter().all(|p| p.gap_m.is_none_or(f64::is_finite)), "not a number: {text}");
            finite(&json!(results.bodies), text);
            finite(&json!(results.penalty_n_m3), text);
        }
        Ok(loaded)
    });
    assert!(started.elapsed() < HANG, "{:?}: {text}", started.elapsed());
    loaded.map_err(|error| assert_eq!(error.exit_code(), 2, "{error}: {text}")).ok()
}

/// JSON turns numbers that are none into null; a check holds no other nulls.
fn finite(value: &Value, text: &str) {
    match value {
        Value::Object(map) => map.values().for_each(|v| finite(v, text)),
        Value::Array(list) => list.iter().for_each(|v| finite(v, text)),
        other => assert!(!other.is_null(), "not a number: {text}"),
    }
}

/// Pointers to every value of a case.
fn places(value: &Value, at: &str, into: &mut Vec<String>) {
    into.push(at.to_owned());
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| places(v, &format!("{at}/{k}"), into)),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| places(v, &format!("{at}/{i}"), into));
        }
        _ => {}
    }
}

/// A change of a case.
#[derive(Debug, Clone)]
enum Change {
    /// Another value in its place.
    Replace(Value),
    /// A number times a factor.
    Scale(f64),
    /// Gone.
    Remove,
    /// An entry of a list once more.
    Repeat,
    /// A value of this case or another one in its place.
    Copy(Index, Index),
}

fn changes() -> impl Strategy<Value = Change> {
    let numbers = [0.0, -0.0, -1.0, 1e308, -1e308, 1e-308, 5e-324, 1e16, 0.5, 1e-12].map(|x| json!(x));
    let words =
        ["", "1e400 m", "-3 mm", "1 furlong", "all", "34X5", "34R23", "34R99", "3333c", "none", "\u{0}"];
    let others = [
        json!(null),
        json!(true),
        json!([]),
        json!({}),
        json!(u64::MAX),
        json!(i64::MIN),
        json!([[0, 0], [0, 0]]),
    ];
    let fixed: Vec<Value> = numbers.into_iter().chain(words.map(|w| json!(w))).chain(others).collect();
    prop_oneof![
        4 => prop::sample::select(fixed).prop_map(Change::Replace),
        2 => any::<f64>().prop_filter("finite", |x| x.is_finite()).prop_map(|x| Change::Replace(json!(x))),
        1 => any::<u32>().prop_map(|x| Change::Replace(json!(x))),
        4 => (-20i32..21).prop_map(|e| Change::Scale(10f64.powi(e))),
        2 => Just(Change::Remove),
        1 => Just(Change::Repeat),
        3 => any::<(Index, Index)>().prop_map(|(a, b)| Change::Copy(a, b)),
    ]
}

fn apply(value: &mut Value, place: &Index, change: &Change, cases: &[Value]) {
    let mut list = Vec::new();
    places(value, "", &mut list);
    let at = &list[place.index(list.len())];
    // the case as a whole cannot be removed
    let Some((parent, key)) = at.rsplit_once('/') else { return };
    match change {
        Change::Remove | Change::Repeat => match (value.pointer_mut(parent), change) {
            (Some(Value::Object(map)), Change::Remove) => drop(map.shift_remove(key)),
            (Some(Value::Array(list)), _) => {
                let i: usize = key.parse().expect("a place in a list");
                match change {
                    Change::Repeat => list.push(list[i].clone()),
                    _ => drop(list.remove(i)),
                }
            }
            _ => {}
        },
        Change::Replace(new) => *value.pointer_mut(at).expect("a place") = new.clone(),
        Change::Scale(factor) => {
            let value = value.pointer_mut(at).expect("a place");
            if let Some(x) = value.as_f64().map(|x| x * factor).filter(|x| x.is_finite()) {
                *value = json!(x);
            }
        }
        Change::Copy(case, from) => {
            let other = &cases[case.index(cases.len())];
            let mut list = Vec::new();
            places(other, "", &mut list);
            let new = other.pointer(&list[from.index(list.len())]).cloned();
            *value.pointer_mut(at).expect("a place") = new.expect("a place");
        }
    }
}

pub fn mutated(cases: &'static LazyLock<Vec<Value>>) -> impl Strategy<Value = String> {
    let list = prop::collection::vec((any::<Index>(), changes()), 1..5);
    (any::<Index>(), list).prop_map(|(case, list)| {
        let mut value = cases[case.index(cases.len())].clone();
        list.iter().for_each(|(place, change)| apply(&mut value, place, change, cases));
        value.to_string()
    })
}

proptest! {
    #![proptest_config(config(count(40_000)))]

    #[test]
    fn mutated_cases_are_built_or_refused(text in mutated(&CASES)) {
        feed(&text, false);
    }
}

proptest! {
    #![proptest_config(config(count(40_000) / 50))]

    #[test]
    fn mutated_cases_are_checked_or_refused(text in mutated(&CASES)) {
        feed(&text, true);
    }
}

proptest! {
    #![proptest_config(config(count(40_000) / 10))]

    /// The text itself cut and overwritten.
    #[test]
    fn damaged_texts_are_refused(
        case in any::<Index>(),
        edits in prop::collection::vec((any::<Index>(), 0usize..6, "[ -~]{0,3}|[\\[\\]{}\",:.eE+-]{1,4}"), 1..4),
    ) {
        let mut text: Vec<char> = CASES[case.index(CASES.len())].to_string().chars().collect();
        for (at, removed, new) in edits {
            let at = at.index(text.len());
            text.splice(at..(at + removed).min(text.len()), new.chars());
        }
        feed(&text.into_iter().collect::<String>(), false);
    }
}

proptest! {
    #![proptest_config(config(count(40_000) / 500))]

    /// Whole analyses of what is accepted: a report of numbers, or an error that says what failed.
    #[test]
    fn mutated_cases_are_analysed_or_refused(text in mutated(&CASES)) {
        let Some(loaded) = feed(&text, true) else { return Ok(()) };
        for analysis in [Analysis::Modes, Analysis::Campbell, Analysis::Static, Analysis::Spinup] {
            // a transient is ended after some steps
            let calls = AtomicUsize::new(0);
            let watch = |_: f64, _: &str| calls.fetch_add(1, Ordering::Relaxed) < 50;
            if let Err(error) = run(&loaded, analysis, &Host { plots: true, progress: &|_| (), watch: &watch }) {
                assert!([1, 2].contains(&error.exit_code()) && !error.to_string().contains("NaN"), "{error}: {text}");
            }
        }
    }
}

proptest! {
    #![proptest_config(config(count(40_000) / 10))]

    #[test]
    fn mutated_scenes_are_built_or_refused(text in mutated(&SCENES)) {
        feed_scene(&text, false);
    }
}

proptest! {
    #![proptest_config(config(count(40_000) / 100))]

    #[test]
    fn mutated_scenes_are_checked_or_refused(text in mutated(&SCENES)) {
        feed_scene(&text, true);
    }
}

proptest! {
    #![proptest_config(config(count(40_000) / 500))]

    /// A few steps of what is accepted.
    #[test]
    fn mutated_scenes_are_run_or_refused(text in mutated(&SCENES)) {
        let Some(loaded) = feed_scene(&text, true) else { return Ok(()) };
        // under absurd loads bodies in space take seconds for a load step
        if loaded.case.bodies.iter().any(|body| body.element != "2322s") {
            return Ok(());
        }
        let calls = AtomicUsize::new(0);
        let watch = |_: f64, _: &str| calls.fetch_add(1, Ordering::Relaxed) < 3;
        let started = Instant::now();
        match run(&loaded, Analysis::Contact, &Host { plots: true, progress: &|_| (), watch: &watch }) {
            Ok(finished) => assert!(!finished.json.to_string().contains("NaN"), "{text}"),
            Err(error) => {
                assert!([1, 2].contains(&error.exit_code()) && !error.to_string().contains("NaN"), "{error}: {text}");
            }
        }
        assert!(started.elapsed() < 4 * HANG, "{:?}: {text}", started.elapsed());
    }
}

/// Texts that once failed.
#[test]
fn what_once_failed_fails_no_more() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let mut read = 0;
    for entry in std::fs::read_dir(folder).expect("corpus") {
        let text = std::fs::read(entry.expect("entry").path()).expect("text");
        feed(&String::from_utf8_lossy(&text), true);
        read += 1;
    }
    assert!(read > 0);
}
