//! Shared by the tests: cases from the repository or built in place, with overrides.

use rotor::case::{Case, LoadedCase};
use rotor::model::Model;
use rotor::run::{Analysis, Host, run};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

/// Every case of the repository that has a shaft.
pub fn case_files() -> Vec<PathBuf> {
    files(false)
}

/// Every contact scene of the repository.
pub fn scene_files() -> Vec<PathBuf> {
    files(true)
}

fn files(scenes: bool) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
    let is_scene =
        |path: &PathBuf| Case::load(path, &[]).unwrap_or_else(|e| panic!("{e}")).case.contact.is_some();
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("cases")
        .map(|e| e.expect("entry").path())
        .filter(|path| is_scene(path) == scenes)
        .collect();
    files.sort();
    assert!(files.len() >= 7);
    files
}

/// A case of the repository by its stem.
pub fn case(stem: &str) -> LoadedCase {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(format!("{stem}.json"));
    Case::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A rotor from outside, kept in tests/fieldtest/, by its stem.
pub fn fieldtest(stem: &str) -> LoadedCase {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fieldtest").join(format!("{stem}.json"));
    Case::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A report and its drawings.
pub struct Kept {
    pub json: Value,
    pub plots: Vec<(String, String)>,
}

/// By the case as run and the analysis.
static KEPT: LazyLock<Mutex<HashMap<String, Arc<OnceLock<Kept>>>>> = LazyLock::new(Default::default);

/// The report of a case, run once for all tests that ask for it.
pub fn report(case: &LoadedCase, analysis: Analysis) -> Arc<OnceLock<Kept>> {
    let key = format!("{} {} {}", case.file, analysis.name(), case.value);
    let place = Arc::clone(KEPT.lock().expect("reports").entry(key).or_default());
    place.get_or_init(|| {
        let finished = run(case, analysis, &Host { plots: true, ..Host::silent() })
            .unwrap_or_else(|e| panic!("{}: {e}", case.file));
        Kept { json: finished.json, plots: finished.plots }
    });
    place
}

/// Its JSON.
pub fn report_json(case: &LoadedCase, analysis: Analysis) -> Value {
    report(case, analysis).get().expect("a report").json.clone()
}

/// A uniform shaft of steel (E 2.1e11, nu 0.3, rho 7800) with the keys of `more` added or replaced.
pub fn shaft(section: Value, length: f64, elements: usize, more: Value) -> LoadedCase {
    let mut value = json!({
        "title": "test shaft",
        "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7800 } },
        "sections": { "s": section },
        "shaft": { "segments": [{ "length": length, "elements": elements, "section": "s", "material": "m" }] }
    });
    merge(&mut value, more);
    LoadedCase::from_value("test.json", value).unwrap_or_else(|e| panic!("{e}"))
}

fn merge(into: &mut Value, from: Value) {
    match (into, from) {
        (Value::Object(a), Value::Object(b)) => {
            for (key, value) in b {
                merge(a.entry(key).or_insert(Value::Null), value);
            }
        }
        (a, b) => *a = b,
    }
}

/// The case with overrides `path -> value`.
pub fn with(case: &LoadedCase, set: Value) -> LoadedCase {
    let set: Map<String, Value> = set.as_object().expect("overrides").clone();
    case.with(&set).unwrap_or_else(|e| panic!("{e}"))
}

/// The checked model of a case.
pub fn model(case: &LoadedCase) -> Model {
    Model::new(case).unwrap_or_else(|e| panic!("{e}"))
}

/// Natural frequencies, rad/s.
pub fn frequencies(case: &LoadedCase) -> Vec<f64> {
    let found = rotor::analysis::modes::modes(&model(case)).unwrap_or_else(|e| panic!("{e}")).results;
    found.modes.iter().map(|m| m.frequency_rad_s).collect()
}

/// Natural frequencies of one kind, rad/s.
pub fn of_kind(case: &LoadedCase, kind: rotor::results::ModeKind) -> Vec<f64> {
    let found = rotor::analysis::modes::modes(&model(case)).unwrap_or_else(|e| panic!("{e}")).results;
    found.modes.iter().filter(|m| m.kind == kind).map(|m| m.frequency_rad_s).collect()
}

/// The Campbell diagram of a case.
pub fn campbell(case: &LoadedCase) -> rotor::results::Campbell {
    let model = model(case);
    let settings = model.campbell.as_ref().expect("a campbell block");
    rotor::analysis::campbell::campbell(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}")).results
}

/// Critical speeds, rpm.
pub fn criticals_rpm(case: &LoadedCase) -> Vec<f64> {
    campbell(case).critical_speeds.iter().map(|c| c.speed_rpm).collect()
}

/// Compares a document with the one that is kept, or writes it when ROTOR_WRITE_DOCS is set. Words must be equal;
/// numbers may differ by one and a half decades (rounding differs by machine), below 1e-9 by anything; digits, which are
/// decades, by one and a half.
pub fn keep(path: &str, text: &str) {
    /// `log10(1e-9 / eps)`.
    const NOISE_DIGITS: f64 = 6.65;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("ROTOR_WRITE_DOCS").is_some() {
        std::fs::write(&file, text).expect("written");
    }
    let kept = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{path}: {e}"));
    let remake = "remake it with ROTOR_WRITE_DOCS=1";
    assert_eq!(kept.lines().count(), text.lines().count(), "{path}: other rows; {remake}");
    let mut heads: Vec<&str> = Vec::new();
    for (ours, kept) in text.lines().zip(kept.lines()) {
        if ours.contains("digits lost |") {
            heads = ours.split('|').collect();
        }
        for (column, (a, b)) in ours.split('|').zip(kept.split('|')).enumerate() {
            let digits = heads.get(column).is_some_and(|head| head.contains("digits"));
            let near = match (a.trim().parse::<f64>(), b.trim().parse::<f64>()) {
                // the digits that a change of 1e-9 takes: what is below is noise, as in the other columns
                (Ok(x), Ok(y)) if digits => (x.max(NOISE_DIGITS) - y.max(NOISE_DIGITS)).abs() <= 1.5,
                (Ok(x), Ok(y)) => {
                    let small = |v: f64| v.abs().max(1e-9);
                    (small(x) / small(y)).log10().abs() <= 1.5
                }
                // a reason may hold a number that rounding moves
                _ if a.trim().starts_with("exit") => reason(a) == reason(b),
                _ => a == b,
            };
            assert!(near, "{path}: {ours}\nkept {kept}\n{remake}");
        }
        assert_eq!(ours.matches('|').count(), kept.matches('|').count(), "{path}: {remake}");
    }
}

/// The words of a reason without its numbers.
fn reason(text: &str) -> String {
    let is_word = |word: &&str| word.trim_matches([',', ';', ':']).parse::<f64>().is_err();
    text.split_whitespace().filter(is_word).collect::<Vec<_>>().join(" ")
}

/// Writes a figure when documents are made; else it must be there.
pub fn draw(path: &str, svg: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("ROTOR_WRITE_DOCS").is_some() {
        std::fs::write(&file, svg).expect("written");
    }
    let kept = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{path}: {e}"));
    // rounding moves points; the words and the number of shapes are the same
    let shown = |svg: &str| {
        let document = roxmltree::Document::parse(svg).unwrap_or_else(|e| panic!("{path}: {e}"));
        let words = document.descendants().filter_map(|node| node.text()).map(|text| text.trim().to_owned());
        let words: Vec<String> = words.filter(|text| !text.is_empty()).collect();
        let count = |tag: &str| document.descendants().filter(|node| node.has_tag_name(tag)).count();
        (words, ["path", "circle", "text"].map(count))
    };
    assert!(
        !shown(svg).0.is_empty() && shown(svg) == shown(&kept),
        "{path}: remake it with ROTOR_WRITE_DOCS=1"
    );
}

/// Most units in the last place by which an input moves.
const UNITS: u64 = 4;

/// Keys of counts, which are no measured quantities.
const COUNTS: [&str; 17] = [
    "elements",
    "count",
    "modes",
    "points",
    "output",
    "max_steps",
    "max_iterations",
    "load_steps",
    "repeats",
    "orders",
    "segments",
    "reduction",
    "axial",
    "section",
    "n",
    "circumferential_order",
    "tolerance",
];

/// Numbers between 0 and n in an order that a seed fixes (Knuth's multiplicative generator).
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % n
    }
}

/// x moved by at most [`UNITS`] units in the last place; zero stays.
fn moved(x: f64, dice: &mut Dice) -> f64 {
    let steps = dice.below(2 * UNITS + 1) as i64 - UNITS as i64;
    let mut x = x;
    for _ in 0..steps.abs() {
        x = if steps > 0 { x.next_up() } else { x.next_down() };
    }
    if x.abs() < f64::MIN_POSITIVE { 0.0 } else { x }
}

/// Moves every quantity of a case; numbers with a unit too.
fn shake(value: &mut Value, key: &str, dice: &mut Dice) {
    match value {
        Value::Object(map) => {
            for (key, value) in map.iter_mut() {
                if !["expected", "tradeoff", "title", "description", "source"].contains(&key.as_str()) {
                    shake(value, key, dice);
                }
            }
        }
        Value::Array(list) => list.iter_mut().for_each(|v| shake(v, key, dice)),
        Value::Number(n) if !COUNTS.contains(&key) => {
            if let Some(x) = n.as_f64().filter(|x| *x != 0.0) {
                *value = json!(moved(x, dice));
            }
        }
        Value::String(text) => {
            let Some((number, unit)) = text.split_once(' ') else { return };
            if let Ok(x) = number.parse::<f64>()
                && x != 0.0
            {
                *value = json!(format!("{:?} {unit}", moved(x, dice)));
            }
        }
        _ => {}
    }
}

/// The case with every quantity moved by a few units in the last place, as a seed says.
pub fn shaken(case: &LoadedCase, seed: u64) -> LoadedCase {
    let mut value = case.value.clone();
    // the block of segments is a list of objects: its key names no count
    shake(&mut value, "", &mut Dice(seed));
    LoadedCase::from_value(&case.file, value).unwrap_or_else(|e| panic!("{e}"))
}
