//! Frequencies and displacements settle as elements shrink, whatever holds or loads the shaft; on points of the axis
//! they do not, and the run says so.

use crate::common::{case, frequencies, model, shaft, with};
use rotor::analysis::modes::modes;
use rotor::analysis::statics::statics;
use rotor::case::LoadedCase;
use serde_json::{Value, json};

fn near(ours: f64, right: f64, rtol: f64, what: &str) {
    assert!((ours / right - 1.0).abs() <= rtol, "{what}: {ours} instead of {right}");
}

fn meshed(case: &LoadedCase, elements: u64) -> LoadedCase {
    with(case, json!({ "shaft.segments.0.elements": elements }))
}

/// The headline case at rest, 10 to 320 elements: within 1 % of the limit from the start, and each finer mesh nearer to it.
#[test]
fn the_headline_case_converges() {
    let base = with(&case("bauchau"), json!({ "modes.count": 9, "expected": [] }));
    let list: Vec<Vec<f64>> = [10, 20, 40, 80, 320]
        .map(|n| frequencies(&meshed(&base, n)).into_iter().filter(|w| *w > 1.0).collect())
        .to_vec();
    let limit = &list[4];
    for k in 0..limit.len() {
        let error = |i: usize| (list[i][k] / limit[k] - 1.0).abs();
        assert!(error(0) < 1e-2 && error(3) < 3e-4, "{k}: {list:?}");
        // torsion and axial motions are exact at once
        assert!((0..3).all(|i| error(i + 1) < error(i) || error(i) < 1e-6), "{k}: {list:?}");
    }
}

/// The ends of the source: the first bending mode falls by 4 % from 16 to 320 elements, and the run says why.
#[test]
fn ends_on_points_do_not_converge_and_say_so() {
    let base = with(&case("table11-points"), json!({ "modes.count": 4, "expected": [] }));
    let first = |n: u64| {
        let found = modes(&model(&meshed(&base, n))).unwrap_or_else(|e| panic!("{e}"));
        assert!(found.diagnostics.iter().any(|d| d.code == "point-support"), "{n}");
        found.results.modes.iter().map(|m| m.frequency_rad_s).find(|w| *w > 1.0).expect("a mode")
    };
    let (coarse, fine, finest) = (first(16), first(80), first(320));
    assert!(fine < 0.99 * coarse && finest < 0.995 * fine, "{coarse} {fine} {finest}");
}

/// Everything that holds a shaft: the name, the section with two members, and the keys of the case.
fn attachments() -> Vec<(&'static str, Value, [&'static str; 2], Value)> {
    let solid = || json!({ "shape": "circle", "radius": 0.04 });
    let tube = || json!({ "shape": "tube", "outer_radius": 0.05, "inner_radius": 0.03 });
    let law = |k: f64| json!([[k, 0], [0, k]]);
    let ends = |a: Value, b: Value| json!({ "supports": [a, b] });
    let bearing = |at: f64, acts_on: &str| json!({ "at": at, "kind": "bearing", "stiffness": law(2e7), "acts_on": acts_on });
    let solids = ["34X2", "34X3"];
    let rings = ["34R12", "34R23"];
    vec![
        ("clamped", solid(), solids, json!({ "supports": [{ "at": 0, "kind": "clamped" }] })),
        (
            "revolute and cylindrical",
            solid(),
            solids,
            ends(
                json!({ "at": 0, "kind": "revolute" }),
                json!({ "at": 1.2, "kind": "cylindrical", "driven": false }),
            ),
        ),
        (
            "rigid ends that spin free",
            solid(),
            solids,
            ends(
                json!({ "at": 0, "kind": "revolute", "section": "rigid" }),
                json!({ "at": 1.2, "kind": "cylindrical", "section": "rigid", "driven": false }),
            ),
        ),
        (
            "pinned and roller",
            solid(),
            solids,
            ends(json!({ "at": 0.4, "kind": "pinned" }), json!({ "at": 1.2, "kind": "roller" })),
        ),
        (
            "pinned and roller on rim and bore",
            tube(),
            rings,
            ends(
                json!({ "at": 0.4, "kind": "pinned", "acts_on": "rim" }),
                json!({ "at": 1.2, "kind": "roller", "acts_on": "bore" }),
            ),
        ),
        ("bearings", solid(), solids, ends(bearing(0.4, "section"), bearing(1.2, "section"))),
        ("bearings on rim and bore", tube(), rings, ends(bearing(0.4, "rim"), bearing(1.2, "bore"))),
    ]
}

/// The first two pairs of frequencies that are not those of rigid motions.
fn lowest(case: &LoadedCase) -> Vec<f64> {
    frequencies(case).into_iter().filter(|w| *w > 1.0).take(4).collect()
}

#[test]
#[ignore = "long"]
fn every_support_settles_under_refinement() {
    for (name, section, members, keys) in attachments() {
        for (order, member) in members.into_iter().enumerate() {
            let build = |segments: Value| {
                let mut keys = keys.clone();
                keys["shaft"] = json!({ "element": member, "segments": segments });
                keys["modes"] = json!({ "count": 10 });
                lowest(&shaft(section.clone(), 1.2, 1, keys))
            };
            let piece = |length: f64, elements: u64| json!({ "length": length, "elements": elements, "section": "s", "material": "m" });
            let uniform = |n: u64| build(json!([piece(1.2, n)]));
            let what = |words: &str| format!("{name}, {member}, {words}");
            let (coarse, fine) = (uniform(10), uniform(40));
            for (a, b) in coarse.iter().zip(&fine) {
                near(*a, *b, 2e-2, &what("10 elements"));
            }
            // one order goes all the way
            if order == 0 {
                for (a, b) in uniform(320).iter().zip(&fine) {
                    near(*a, *b, 4e-3, &what("320 elements"));
                }
            }
            // beside what holds the shaft at 0.4 m, or at its left end
            let short = 3e-5;
            for mesh in [
                json!([piece(0.4, 13), piece(short, 1), piece(0.8 - short, 27)]),
                json!([piece(short, 1), piece(1.2 - short, 40)]),
            ] {
                for (a, b) in build(mesh).iter().zip(&fine) {
                    near(*a, *b, 4e-3, &what("a neighbour 1000 times shorter"));
                }
            }
        }
    }
}

/// Forces and moments on a section: what they move away from the place where they act.
#[test]
fn every_load_settles_under_refinement() {
    for (load, axis) in [
        (json!({ "at": 0.8, "force": [0, -1e3, 0] }), 1),
        (json!({ "at": 0.8, "moment": [0, 0, 200] }), 1),
        (json!({ "at": 0.8, "force": [1e5, 0, 0] }), 0),
    ] {
        for member in ["34X2", "34X3"] {
            let tip = |segments: Value| {
                let keys = json!({
                    "shaft": { "element": member, "segments": segments },
                    "supports": [{ "at": 0, "kind": "clamped" }],
                    "loads": [load],
                    "probes": [{ "name": "tip", "at": 1.2, "y": 0, "z": 0 }]
                });
                let case = shaft(json!({ "shape": "circle", "radius": 0.04 }), 1.2, 1, keys);
                let found = statics(&model(&case)).unwrap_or_else(|e| panic!("{e}")).results;
                found.probes[0].point.as_ref().expect("a point").displacement_m[axis]
            };
            let piece = |length: f64, elements: u64| json!({ "length": length, "elements": elements, "section": "s", "material": "m" });
            let fine = tip(json!([piece(1.2, 60)]));
            near(tip(json!([piece(1.2, 12)])), fine, 2e-3, &format!("{load} {member}, 12 elements"));
            let short = 2e-5;
            let beside = json!([piece(0.8, 40), piece(short, 1), piece(0.4 - short, 20)]);
            near(tip(beside), fine, 1e-3, &format!("{load} {member}, a short neighbour"));
        }
    }
}

/// A ring around the shaft: the orbit of a full annular rub, on meshes from 4 to 32 elements.
#[test]
fn the_rub_in_a_ring_settles_under_refinement() {
    let base = with(&case("rub-ring"), json!({ "expected": [] }));
    let elements = base.value["shaft"]["segments"][0]["elements"].as_u64().expect("elements");
    let radius = |factor: u64| {
        let model = model(&meshed(&base, elements * factor));
        let settings = model.spinup.as_ref().expect("spinup");
        let found =
            rotor::analysis::spinup::spinup(&model, settings, &|_, _| true).unwrap_or_else(|e| panic!("{e}"));
        let mid = found.results.history.expect("history").mid_span_m;
        let [_, y, z] = mid[mid.len() - 1];
        y.hypot(z)
    };
    near(radius(2), radius(4), 2e-4, "twice the elements");
}

/// Plane ends of every kind beside an element a thousand times shorter than its neighbour: nothing moves.
#[test]
fn one_short_element_moves_nothing() {
    let base = case("bauchau");
    let whole = with(&base, json!({ "disks": [], "expected": [], "modes.count": 14 }));
    let cut = with(
        &whole,
        json!({ "shaft.segments": [
        { "length": 0.0004, "elements": 1, "section": "shaft", "material": "steel" },
        { "length": 5.9996, "elements": 16, "section": "shaft", "material": "steel" }
    ] }),
    );
    for (a, b) in frequencies(&whole).iter().zip(frequencies(&cut)).filter(|(a, _)| **a > 1.0) {
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }
}
