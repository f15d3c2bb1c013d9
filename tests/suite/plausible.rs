//! Slips of units are doubted in every analysis, with the unit that was probably meant; real machines are not.

use crate::common::{case_files, shaft, with};
use rotor::analysis::plausibility::plausibility;
use rotor::case::{Case, LoadedCase};
use rotor::model::Model;
use rotor::run::{Analysis, Host, run};
use serde_json::{Value, json};

fn rotor() -> LoadedCase {
    let more = json!({
        "supports": [{ "at": 0, "kind": "revolute" }, { "at": 1, "kind": "cylindrical" }],
        "loads": [{ "at": 0.5, "force": [0, 1, 0] }],
        "campbell": { "speeds": { "to": 10, "count": 3 }, "modes": 2 },
        "spinup": { "drive": [{ "until": 1, "speed": 10 }], "steady": true }
    });
    shaft(json!({ "shape": "circle", "radius": 0.05 }), 1.0, 2, more)
}

fn doubts(case: &LoadedCase) -> Vec<String> {
    let model = Model::new(case).unwrap_or_else(|e| panic!("{e}"));
    plausibility(&model).into_iter().map(|d| d.message).collect()
}

#[test]
fn slips_of_units_are_doubted() {
    assert_eq!(doubts(&rotor()), Vec::<String>::new());
    let table: [(Value, &[&str]); 12] = [
        (json!({ "materials.m.E": 210 }), &["`materials.m.E`", "\"210 GPa\""]),
        (json!({ "materials.m.E": 210_000 }), &["`materials.m.E`", "\"210000 MPa\""]),
        (json!({ "materials.m.E": 2.1e14 }), &["`materials.m.E`", "diamond"]),
        (json!({ "materials.m.rho": 7.85 }), &["`materials.m.rho`", "\"7.85 g/cm^3\""]),
        (json!({ "materials.m.rho": 7.8e6 }), &["`materials.m.rho`", "denser"]),
        (json!({ "sections.s.radius": 5 }), &["`sections.s`", "10 m across", "shaft of 1 m"]),
        (
            json!({ "sections.s.radius": 25, "materials.m.rho": 100 }),
            &["`sections.s`", "\"25 mm\" of radius"],
        ),
        (json!({ "campbell.speeds.to": 20_000 }), &["`campbell.speeds.to`", "1000 m/s", "\"20000 rpm\""]),
        (
            json!({ "campbell.speeds.to": 200_000, "sections.s.radius": 0.001 }),
            &["`campbell.speeds.to`", "a million rpm"],
        ),
        (json!({ "spinup.drive.0.speed": 30_000 }), &["`spinup.drive`", "\"30000 rpm\""]),
        (
            json!({ "disks": [{ "at": 0.5, "mass": 1.5e10, "polar_inertia": 1, "diametral_inertia": 1 }] }),
            &["`shaft`", "1.500e7 t"],
        ),
        (json!({ "gravity": [0, -9810, 0] }), &["`gravity`", "\"9810 mm/s^2\""]),
    ];
    for (set, words) in table {
        let found = doubts(&with(&rotor(), set.clone()));
        assert_eq!(found.len(), 1, "{set}: {found:?}");
        for word in words {
            assert!(found[0].contains(word), "{set}: no {word} in {}", found[0]);
        }
    }
}

#[test]
fn real_and_light_rotors_are_not_doubted() {
    for path in case_files() {
        let case = Case::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(doubts(&case), Vec::<String>::new(), "{}", path.display());
    }
}

/// `check` and every other analysis say it.
#[test]
fn every_analysis_tells_its_doubts() {
    let case = with(&rotor(), json!({ "materials.m.rho": 7.85 }));
    for analysis in [Analysis::Check, Analysis::Modes, Analysis::Campbell, Analysis::Static, Analysis::Spinup]
    {
        let finished = run(&case, analysis, &Host::silent()).unwrap_or_else(|e| panic!("{e}"));
        let told = finished.diagnostics.iter().filter(|d| d.code == "implausible").count();
        assert_eq!(told, 1, "{}: {:?}", analysis.name(), finished.diagnostics);
        assert!(finished.table.contains("7.85 g/cm^3") && finished.json.to_string().contains("implausible"));
    }
}
