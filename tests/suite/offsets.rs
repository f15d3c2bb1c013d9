//! Sag on supports, bearings that stand beside the axis, and a run-up on bearings, against closed forms and an integration that
//! knows no beams.

use crate::common::{frequencies, model, shaft, with};
use rotor::analysis::modes::modes;
use rotor::analysis::spinup::spinup;
use rotor::analysis::statics::statics;
use rotor::case::LoadedCase;
use rotor::model::Model;
use rotor::results::{Spinup, Static};
use serde_json::{Value, json};
use std::f64::consts::PI;

const E: f64 = 2.1e11;
const NU: f64 = 0.3;
const DENSITY: f64 = 7850.0;
const RADIUS: f64 = 0.03;
const GRAVITY: f64 = 9.81;

fn near(ours: f64, right: f64, rtol: f64, what: &str) {
    assert!((ours - right).abs() <= rtol * right.abs(), "{what}: {ours:e} instead of {right:e}");
}

fn hold(case: &LoadedCase) -> Static {
    let found = statics(&model(case)).unwrap_or_else(|e| panic!("{e}")).results;
    assert!(found.converged);
    found
}

fn run(case: &LoadedCase) -> Spinup {
    let model = model(case);
    let settings = model.spinup.as_ref().expect("spinup");
    spinup(&model, settings, &|_, _| true).unwrap_or_else(|e| panic!("{e}")).results
}

/// A round shaft of steel with a mesh of many kinds: so many elements, another order, or a neighbour 1000 times shorter.
fn meshes(length: f64, more: &Value) -> Vec<(String, LoadedCase)> {
    let segment = |length: f64, elements: u64, kind: &str| json!({ "length": length, "elements": elements, "section": "s", "material": "m", "element": kind });
    let mut list: Vec<(String, Value)> =
        [(10, "34X3"), (80, "34X3"), (320, "34X3"), (16, "34X2"), (16, "34X4")]
            .map(|(n, kind)| (format!("{n} {kind}"), json!([segment(length, n, kind)])))
            .to_vec();
    // beside the middle, where supports and probes stand
    let tenth = length / 20.0;
    let short = json!([
        segment(length / 2.0, 10, "34X3"),
        segment(1e-3 * tenth, 1, "34X3"),
        segment(length / 2.0 - 1e-3 * tenth, 10, "34X3")
    ]);
    list.push(("a short neighbour".to_owned(), short));
    let steel =
        json!({ "materials": { "m": { "E": E, "nu": NU, "rho": DENSITY } }, "gravity": [0, -GRAVITY, 0] });
    let round = json!({ "shape": "circle", "radius": RADIUS });
    let whole = |segments: Value| {
        let case = shaft(round.clone(), length, 10, steel.clone());
        let set = more.as_object().expect("keys").clone();
        let case = with(&case, json!({ "shaft.segments": segments }));
        case.with(&set).unwrap_or_else(|e| panic!("{e}"))
    };
    list.into_iter().map(|(name, segments)| (name, whole(segments))).collect()
}

fn bending_stiffness() -> f64 {
    E * PI * RADIUS.powi(4) / 4.0
}

/// Shear stiffness with Cowper's coefficient, `k G A`.
fn shear_stiffness() -> f64 {
    6.0 * (1.0 + NU) / (7.0 + 6.0 * NU) * E / (2.0 * (1.0 + NU)) * PI * RADIUS * RADIUS
}

/// Weight of a metre, N/m.
fn weight() -> f64 {
    PI * RADIUS * RADIUS * DENSITY * GRAVITY
}

/// A shaft of 1.2 m on two pins sags by 44.198 um, `5 q L^4/384 EI + q L^2/8 k G A`, and each pin carries half.
#[test]
fn a_shaft_on_pins_sags_as_the_closed_form() {
    let length = 1.2;
    let more = json!({
        "supports": [{ "at": 0, "kind": "pinned" }, { "at": length, "kind": "roller" }],
        "probes": [{ "name": "middle", "at": length / 2.0, "y": 0 }]
    });
    for (name, case) in meshes(length, &more) {
        let found = hold(&case);
        let [_, y, z] = found.probes[0].point.as_ref().expect("point").displacement_m;
        near(-y, 4.41984785e-5, 1e-3, &name);
        assert!(z.abs() < 1e-9 * y.abs(), "{name}");
        for path in ["supports.0", "supports.1"] {
            near(found.support_forces.forces_n[path][1], 130.641842, 1e-6, &name);
        }
    }
}

const LENGTH: f64 = 2.0;
const SPRING: f64 = 1e8;

/// Three bearings, the middle one beside the axis.
fn three_bearings(offset: [f64; 2]) -> Value {
    let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": SPRING });
    let mut middle = bearing(LENGTH / 2.0);
    middle["offset"] = json!(offset);
    json!({ "supports": [bearing(0.0), middle, bearing(LENGTH)] })
}

/// Force of the middle bearing along one direction, with the weight `q L` against it: the middle of the beam rises by d less the
/// give of its bearing, `R (f + 1/k + 1/2k) = d + sag + q L/2k`.
fn middle_force(offset: f64, weight: f64) -> f64 {
    let (ei, ga, l) = (bending_stiffness(), shear_stiffness(), LENGTH);
    let give = l.powi(3) / (48.0 * ei) + l / (4.0 * ga);
    let sag = weight * (5.0 * l.powi(4) / (384.0 * ei) + l * l / (8.0 * ga));
    (offset + sag + weight * l / (2.0 * SPRING)) / (give + 1.5 / SPRING)
}

/// The middle of three bearings, raised and moved aside: forces by three moments, the same on every mesh.
#[test]
fn a_raised_bearing_carries_by_three_moments() {
    for offset in [[2e-4, -1e-4], [-3e-5, 0.0], [0.0, 0.0]] {
        let mut all = Vec::new();
        for (name, case) in meshes(LENGTH, &three_bearings(offset)) {
            let found = hold(&case);
            let force = |path: &str| found.support_forces.forces_n[path];
            let middle = force("supports.1");
            let right = [middle_force(offset[0], weight()), middle_force(offset[1], 0.0)];
            near(middle[1], right[0], 1e-3, &format!("{name} {offset:?}"));
            assert!(
                (middle[2] - right[1]).abs() <= 1e-3 * right[1].abs() + 1e-6,
                "{name}: {middle:?} {right:?}"
            );
            // both ends share the rest
            let whole = weight() * LENGTH;
            for path in ["supports.0", "supports.2"] {
                near(force(path)[1], (whole - middle[1]) / 2.0, 1e-5, &name);
                assert!((force(path)[2] + middle[2] / 2.0).abs() < 1e-5 * whole, "{name}");
            }
            all.push(middle[1]);
        }
        all.iter().for_each(|f| near(*f, all[2], 1e-3, "all meshes"));
    }
}

/// A balanced shaft that turns on the same bearings is bent as at rest: each bearing carries what it carried, all the way round.
#[test]
fn a_raised_bearing_carries_the_same_while_the_shaft_turns() {
    let offset = [2e-4, -1e-4];
    let (_, case) = meshes(LENGTH, &three_bearings(offset)).swap_remove(0);
    let still = hold(&case).support_forces.forces_n;
    let turning = with(
        &case,
        json!({ "spinup": { "drive": [{ "until": 1, "speed": 40 }], "driven_at": 0, "steady": true } }),
    );
    let found = run(&turning);
    let history = found.history.expect("a turn of a periodic motion");
    for (path, right) in &still {
        for force in &history.support_forces.forces_n[path] {
            for c in 1..3 {
                assert!(
                    (force[c] - right[c]).abs() < 2e-3 * right[1].abs().max(right[2].abs()),
                    "{path}: {force:?} {right:?}"
                );
            }
        }
    }
    // run up from rest, too: it starts from this equilibrium
    let set = json!({ "spinup.steady": false, "spinup.drive": [{ "until": 0.05, "speed": 20 }], "spinup.output": 6 });
    let start = run(&with(&turning, set)).history.expect("a run").support_forces.forces_n;
    for (path, right) in &still {
        (1..3).for_each(|c| assert!((start[path][0][c] - right[c]).abs() < 1e-5 * right[1].abs(), "{path}"));
    }
}

/// Linear analyses leave offsets out and say so; other supports have none.
#[test]
fn offsets_are_left_out_of_linear_analyses_and_refused_elsewhere() {
    let (_, raised) = meshes(LENGTH, &three_bearings([2e-4, 0.0])).swap_remove(0);
    let (_, level) = meshes(LENGTH, &three_bearings([0.0, 0.0])).swap_remove(0);
    assert_eq!(frequencies(&raised), frequencies(&level));
    let said = |case: &LoadedCase| {
        let found = modes(&model(case)).unwrap_or_else(|e| panic!("{e}"));
        let left_out = found.model.left_out.iter().any(|e| e.to_string().contains("offsets of bearings"));
        (left_out, found.diagnostics.iter().any(|d| d.code == "offsets-ignored"))
    };
    assert_eq!((said(&raised), said(&level)), ((true, true), (false, false)));
    let pinned = with(&level, json!({ "supports": [{ "at": 0, "kind": "pinned", "offset": [1e-4, 0] }] }));
    let error = Model::new(&pinned).expect_err("a pin");
    assert!(error.to_string().contains("supports.0.offset"), "{error}");
}

/// A rigid rotor of 10 kg on soft bearings runs through its critical speed at constant acceleration, driven at its middle and held by
/// nothing else: `m (u'' ) + c u' + k u = m e (W^2 - i alpha) e^(i theta)` integrated by itself (RK45, 1e-9).
#[test]
fn a_run_up_through_the_critical_speed_is_that_of_a_point_mass() {
    let (mass, stiffness, damping, eccentricity) = (10.0, 80_000.0, 35.7770876, 1e-4);
    let natural = 89.4427191;
    let (alpha, peak, at_peak) = (80.0, 0.00113084096, 106.881813);
    let later = [(0.5, 3.28561591e-5), (1.0, 0.000514863533), (1.1, 0.000884943379), (1.5, 0.000342777711)];
    for (elements, driven_at) in [(2, 0.2), (4, 0.0)] {
        let until = 1.6 * natural / alpha;
        let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": stiffness / 2.0, "damping": damping / 2.0 });
        let found = run(&shaft(
            json!({ "shape": "circle", "radius": 0.05 }),
            0.4,
            elements,
            json!({
                "materials": { "m": { "rho": 1e-3 } },
                "disks": [{ "at": 0.2, "mass": mass, "polar_inertia": 0.1, "diametral_inertia": 0.06,
                            "offset": [eccentricity, 0] }],
                "supports": [bearing(0.0), bearing(0.4)],
                "spinup": { "driven_at": driven_at, "drive": [{ "until": until, "speed": 1.6 * natural, "shape": "linear" }],
                            "rtol": 1e-5, "atol": 1e-9, "output": 1601 },
                "probes": [{ "name": "disk", "at": 0.2, "y": 0 }]
            }),
        ));
        let history = found.history.expect("a run");
        let radius: Vec<f64> = history.mid_span_m.iter().map(|[_, y, z]| y.hypot(*z)).collect();
        let what = format!("{elements} elements");
        let top = (0..radius.len()).fold(0, |best, k| if radius[k] > radius[best] { k } else { best });
        near(radius[top], peak, 2e-3, &what);
        near(history.speed_rad_s[top], at_peak, 2e-3, &what);
        for (speed, right) in later {
            let k = (speed / 1.6 * 1600.0_f64).round() as usize;
            near(history.speed_rad_s[k], speed * natural, 1e-3, &what);
            near(radius[k], right, 5e-3, &format!("{what} at {speed}"));
        }
    }
}
