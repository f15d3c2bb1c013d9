//! Parts that are nearly copies of each other, and hubs that the wall does not carry.

use crate::common::{model, shaft, with};
use rotor::results::{Campbell, Level, ModeKind};
use serde_json::{Value, json};

fn run(case: &rotor::case::LoadedCase) -> (Campbell, Vec<String>) {
    let model = model(case);
    let settings = model.campbell.as_ref().expect("a campbell block");
    let outcome =
        rotor::analysis::campbell::campbell(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}"));
    // the thin shaft is a step of the section, whose error is another matter
    let bad = outcome.diagnostics.iter().filter(|d| d.level != Level::Info && d.code != "step");
    (outcome.results, bad.map(|d| format!("{}: {}", d.code, d.message)).collect())
}

/// Two equal rotors, each on bearings of its own, joined by a shaft of 1 or 2 mm: every bending critical of one of them
/// occurs twice, and their relative torsion and axial motion once.
#[test]
fn two_equal_rotors_on_a_thin_shaft_have_every_critical_twice() {
    let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[1e7, 0], [0, 1e7]] });
    let disk = |at: f64| json!({ "at": at, "mass": 20, "polar_inertia": 0.2, "diametral_inertia": 0.1 });
    let sections = |thin: f64| json!({ "s": { "shape": "circle", "radius": 0.025 }, "thin": { "shape": "circle", "radius": thin } });
    let segment = |length: f64, elements: usize, section: &str| json!({ "length": length, "elements": elements, "section": section, "material": "m" });
    let campbell = json!({ "speeds": { "to": "20000 rpm", "count": 5 }, "modes": 12, "form": "classical" });
    let alone = shaft(
        json!({ "shape": "circle", "radius": 0.025 }),
        0.5,
        6,
        json!({ "supports": [bearing(0.0), bearing(0.5)], "disks": [disk(0.25)], "campbell": campbell }),
    );
    let bending = |found: &Campbell| -> Vec<f64> {
        found.critical_speeds.iter().filter(|c| c.kind == ModeKind::Bending).map(|c| c.speed_rad_s).collect()
    };
    let one = bending(&run(&alone).0);
    assert!(one.len() >= 3, "{one:?}");
    for (thin, length) in [(0.0005, 0.02), (0.0005, 0.2), (0.001, 0.2)] {
        let segments: Value = json!([segment(0.5, 6, "s"), segment(length, 2, "thin"), segment(0.5, 6, "s")]);
        let more = json!({
            "sections": sections(thin),
            "shaft": { "segments": segments },
            "supports": [bearing(0.0), bearing(0.5), bearing(0.5 + length), bearing(1.0 + length)],
            "disks": [disk(0.25), disk(0.75 + length)],
            "campbell": campbell
        });
        let case = shaft(json!({ "shape": "circle", "radius": 0.025 }), 1.0, 1, more);
        let (found, bad) = run(&case);
        assert!(bad.is_empty(), "{thin} {length}: {bad:?}");
        let both = bending(&found);
        for exact in &one {
            let copies = both.iter().filter(|w| (*w / exact - 1.0).abs() < 4e-3).count();
            let expected = 2 * one.iter().filter(|w| (*w / exact - 1.0).abs() < 4e-3).count();
            assert_eq!(copies, expected, "{thin} {length}: {exact} of {both:?}, alone {one:?}");
        }
        for kind in [ModeKind::Torsion, ModeKind::Axial] {
            assert_eq!(found.critical_speeds.iter().filter(|c| c.kind == kind).count(), 1, "{kind:?}");
        }
    }
}

/// Three disks with soft hubs on a thin tube: their pull bursts the wall, which a rigid hub would not let them do.
#[test]
fn a_soft_hub_that_the_wall_does_not_carry_is_refused_with_its_remedy() {
    let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[1e7, 0], [0, 1e7]] });
    let disk = |at: f64| json!({ "at": at, "mass": 5, "polar_inertia": 0.05, "diametral_inertia": 0.025, "hub": "soft" });
    let case = shaft(
        json!({ "shape": "tube", "outer_radius": 0.1, "inner_radius": 0.098 }),
        1.0,
        12,
        json!({
            "shaft": { "element": "34X3" },
            "disks": [disk(0.25), disk(0.5), disk(0.75)],
            "supports": [bearing(0.0), bearing(1.0)],
            "campbell": { "speeds": { "to": "12000 rpm", "count": 5 }, "modes": 8 }
        }),
    );
    let refused = |case: &rotor::case::LoadedCase| {
        let model = model(case);
        let settings = model.campbell.as_ref().expect("a campbell block");
        rotor::analysis::campbell::campbell(&model, settings, &|_| ())
            .err()
            .map(|e| (e.exit_code(), e.to_string()))
    };
    let (code, text) = refused(&case).expect("refused");
    assert_eq!(code, 1);
    assert!(text.contains("\"hub\": \"rigid\"") && text.contains("disks.0.hub"), "{text}");
    assert!(!text.contains("lower `campbell"), "{text}");
    let rigid = json!({ "disks.0.hub": "rigid", "disks.1.hub": "rigid", "disks.2.hub": "rigid" });
    assert_eq!(refused(&with(&case, rigid)), None, "the remedy works");
}
