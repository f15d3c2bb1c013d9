//! What each feature of a scene costs where it is present, beside the same scene without it: what is absent is not worked
//! on. A 2 m shaft of 8 elements 34X3 on two supports; features of no size keep the numbers and leave the work.

use divan::Bencher;
use rotor::case::LoadedCase;
use rotor::run::{Analysis, Host, run};
use serde_json::{Map, Value, json};

fn main() {
    divan::main();
}

/// Analysis, feature, what it adds to the case by path.
const FEATURES: [(&str, &str); 14] = [
    ("campbell", "nothing"),
    ("campbell", "bearings"),
    ("campbell", "damping"),
    ("campbell", "disk"),
    ("campbell", "no gyroscopic moments"),
    ("static", "nothing"),
    ("static", "gravity"),
    ("static", "load"),
    ("static", "probes"),
    ("spinup", "nothing"),
    ("spinup", "gravity"),
    ("spinup", "damping"),
    ("spinup", "unbalance"),
    ("spinup", "unbalance and rings never near"),
];

fn additions(feature: &str) -> Value {
    let unbalance =
        json!([{ "at": 1, "mass": 20, "polar_inertia": 0.2, "diametral_inertia": 0.1, "offset": [1e-3, 0] }]);
    let ring = |at: f64| json!({ "at": at, "clearance": 0.05, "stiffness": 1e7, "friction": 0.1 });
    match feature {
        "unbalance" => json!({ "disks": unbalance }),
        "unbalance and rings never near" => {
            json!({ "disks": unbalance, "spinup.stators": [ring(0.5), ring(1.0), ring(1.5)] })
        }
        "bearings" => {
            let bearing =
                |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[1e-3, 0], [0, 1e-3]] });
            json!({ "supports.2": bearing(0.5), "supports.3": bearing(1.5) })
        }
        "damping" => json!({ "materials.steel.damping": { "stiffness": 1e-9 } }),
        "disk" => {
            json!({ "disks": [{ "at": 1, "mass": 1e-6, "polar_inertia": 1e-9, "diametral_inertia": 1e-9 }] })
        }
        "no gyroscopic moments" => json!({ "campbell.gyroscopic": "none" }),
        "gravity" => json!({ "gravity": [0, -1e-6, 0] }),
        "load" => json!({ "loads": [{ "at": 1, "force": [0, 1e-6, 0] }] }),
        "probes" => json!({ "probes": [{ "name": "line", "at": 0.7, "line": "y", "points": 9 }] }),
        _ => json!({}),
    }
}

fn scene(feature: &str) -> Result<LoadedCase, rotor::error::Error> {
    let mut base = json!({
        "title": "features",
        "materials": { "steel": { "E": 2.1e11, "nu": 0.3, "rho": 7850 } },
        "sections": { "round": { "shape": "circle", "radius": 0.05 } },
        "shaft": { "segments": [{ "length": 2, "elements": 8, "section": "round", "material": "steel" }] },
        "supports": [{ "at": 0, "kind": "revolute" }, { "at": 2, "kind": "cylindrical" }],
        "campbell": { "speeds": { "from": 0, "to": 300, "count": 31 }, "modes": 8, "form": "classical" },
        "spinup": { "drive": [{ "until": 0.2, "speed": 100 }] }
    });
    let mut overrides = Map::new();
    for (path, value) in additions(feature).as_object().into_iter().flatten() {
        match path.strip_prefix("supports.") {
            Some(_) => base["supports"].as_array_mut().into_iter().for_each(|list| list.push(value.clone())),
            None => drop(overrides.insert(path.clone(), value.clone())),
        }
    }
    LoadedCase::from_value("features.json", base)?.with(&overrides)
}

#[divan::bench(args = FEATURES, sample_count = 20, sample_size = 1)]
fn features(bencher: Bencher<'_, '_>, (name, feature): (&str, &str)) {
    let case = scene(feature).unwrap_or_else(|e| panic!("{e}"));
    let analysis = Analysis::from_name(name).unwrap_or_else(|| panic!("{name} is an analysis"));
    bencher.bench_local(|| {
        run(&case, analysis, &Host::silent()).unwrap_or_else(|e| panic!("{name}, {feature}: {e}"))
    });
}
