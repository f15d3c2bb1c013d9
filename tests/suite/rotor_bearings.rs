//! Bearings, seals and housings against closed forms: what is resisted, added mass, negative stiffness, tables, loss factors.
//!
//! The rotor of the closed forms is a rigid body: a disk on a stub that is stiff and light beside everything else.

use crate::common::{campbell, case, frequencies, model, with};
use rotor::analysis::modes::modes;
use rotor::case::LoadedCase;
use rotor::results::Whirl;
use serde_json::{Value, json};

const MASS: f64 = 10.0;
const POLAR: f64 = 0.02;
const DIAMETRAL: f64 = 0.015;

/// A disk in the middle of a stub of 0.2 m, with the given support there and any number of elements.
fn rigid(support: Value, element: &str, elements: usize) -> LoadedCase {
    let value = json!({
        "title": "rigid",
        "materials": { "light": { "E": 2e15, "nu": 0.3, "rho": 1e-3 } },
        "sections": { "stub": { "shape": "circle", "radius": 0.05 } },
        "shaft": { "element": element, "segments": [{ "length": 0.2, "elements": elements, "section": "stub", "material": "light" }] },
        "disks": [{ "at": 0.1, "mass": MASS, "polar_inertia": POLAR, "diametral_inertia": DIAMETRAL }],
        "supports": [support],
        "modes": { "count": 8 },
    });
    LoadedCase::from_value("rigid.json", value).unwrap_or_else(|e| panic!("{e}"))
}

/// A bearing that resists everything.
fn all_round() -> Value {
    json!({ "at": 0.1, "kind": "bearing", "stiffness": [[2e5, 0], [0, 5e5]], "axial_stiffness": 3e5,
            "tilt_stiffness": 4e3, "torsional_stiffness": 6e2 })
}

/// Frequencies of a rigid body on that bearing, ascending.
fn closed_form() -> Vec<f64> {
    let mut list: Vec<f64> =
        [2e5 / MASS, 5e5 / MASS, 3e5 / MASS, 4e3 / DIAMETRAL, 4e3 / DIAMETRAL, 6e2 / POLAR]
            .iter()
            .map(|square: &f64| square.sqrt())
            .collect();
    list.sort_by(f64::total_cmp);
    list
}

fn close(ours: f64, right: f64, rtol: f64, what: &str) {
    assert!((ours / right - 1.0).abs() < rtol, "{what}: {ours} for {right}");
}

#[test]
fn each_spring_resists_its_own_motion() {
    let found = frequencies(&rigid(all_round(), "34X3", 2));
    for (ours, right) in found.iter().zip(closed_form()) {
        close(*ours, right, 1e-6, "rigid body");
    }
}

/// A grip on a mean has a limit: neither the number of elements nor the order of the section nor a short neighbour counts.
#[test]
fn springs_have_a_limit_under_refinement() {
    for (element, elements) in [("34X3", 10), ("34X3", 40), ("34X3", 320), ("34X2", 10), ("34X4", 10)] {
        let found = frequencies(&rigid(all_round(), element, elements));
        for (ours, right) in found.iter().zip(closed_form()) {
            close(*ours, right, 1e-5, element);
        }
    }
    let short =
        with(&rigid(all_round(), "34X3", 10), json!({ "loads": [{ "at": 0.10002, "force": [0, 1, 0] }] }));
    assert!(model(&short).elements.iter().any(|e| e.length < 3e-5));
    for (ours, right) in frequencies(&short).iter().zip(closed_form()) {
        close(*ours, right, 1e-5, "short neighbour");
    }
}

/// The same springs at the end of a shaft that bends: the first frequencies have a limit, too.
#[test]
fn springs_on_a_flexible_shaft_have_a_limit() {
    let found = |element: &str, elements: usize, near: bool| -> Vec<f64> {
        let mut value = rigid(all_round(), element, elements).value;
        value["materials"]["light"] = json!({ "E": 2.1e11, "nu": 0.3, "rho": 7850 });
        value["sections"]["stub"]["radius"] = json!(0.01);
        value["supports"][0]["at"] = json!(0.0);
        if near {
            value["loads"] = json!([{ "at": 2e-5, "force": [0, 1, 0] }]);
        }
        frequencies(&LoadedCase::from_value("flexible.json", value).unwrap())
    };
    let finest = found("34X3", 320, false);
    for (element, elements, near, rtol) in [
        ("34X3", 10, false, 1e-4),
        ("34X3", 40, false, 1e-4),
        ("34X3", 40, true, 1e-4),
        ("34X4", 40, false, 1e-3),
    ] {
        for (ours, right) in found(element, elements, near).iter().zip(&finest).take(6) {
            close(*ours, *right, rtol, &format!("{element} {elements}"));
        }
    }
}

#[test]
fn added_mass_goes_along() {
    let mut support = all_round();
    support["stiffness"] = json!(2e5);
    support["mass"] = json!([[3.0, 0], [0, 7.0]]);
    let found = frequencies(&rigid(support, "34X3", 2));
    for added in [3.0, 7.0] {
        let right = (2e5_f64 / (MASS + added)).sqrt();
        assert!(found.iter().any(|f| (f / right - 1.0).abs() < 1e-6), "{right} among {found:?}");
    }
}

/// `m x'' + k (x - h) = 0`, `M h'' + K h - k (x - h) = 0`.
#[test]
fn a_housing_is_a_second_mass() {
    let (k, below, housing) = (2e5, 9e5, 4.0);
    let mut support = all_round();
    support["stiffness"] = json!(k);
    support["housing"] = json!({ "mass": housing, "stiffness": below });
    let (a, b, c) = (k / MASS, (k + below) / housing, k * k / (MASS * housing));
    let root = (((a - b) / 2.0).powi(2) + c).sqrt();
    for (element, elements) in [("34X3", 2), ("34X3", 40), ("34X2", 10)] {
        let found = frequencies(&rigid(support.clone(), element, elements));
        for right in [((a + b) / 2.0 - root).sqrt(), ((a + b) / 2.0 + root).sqrt()] {
            let count = found.iter().filter(|f| (*f / right - 1.0).abs() < 1e-6).count();
            assert_eq!(count, 2, "{right} among {found:?}");
        }
    }
}

/// Two bearings in one frame: where both ends move alike the frame goes along, where they move against each other it stands still.
#[test]
fn bearings_share_a_frame() {
    let (k, below, frame, arm) = (1e5, 9e5, 4.0, 0.08);
    let bearing =
        |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": k, "housing": { "ref": "frame" } });
    let mut value = rigid(bearing(0.1 - arm), "34X3", 10).value;
    value["supports"] = json!([bearing(0.1 - arm), bearing(0.1 + arm)]);
    value["housings"] = json!({ "frame": { "mass": frame, "stiffness": below } });
    let case = LoadedCase::from_value("frame.json", value).unwrap();
    let found = frequencies(&case);
    let (a, b, c) = (2.0 * k / MASS, (2.0 * k + below) / frame, 4.0 * k * k / (MASS * frame));
    let root = (((a - b) / 2.0_f64).powi(2) + c).sqrt();
    let tilt = (2.0 * k * arm * arm / DIAMETRAL).sqrt();
    for right in [((a + b) / 2.0 - root).sqrt(), ((a + b) / 2.0 + root).sqrt(), tilt] {
        let count = found.iter().filter(|f| (*f / right - 1.0).abs() < 1e-5).count();
        assert_eq!(count, 2, "{right} among {found:?}");
    }
}

#[test]
fn a_negative_stiffness_is_held_or_refused() {
    let seal = |k: f64| {
        let mut value = rigid(all_round(), "34X3", 2).value;
        value["supports"][0]["stiffness"] = json!(2e5);
        value["supports"].as_array_mut().unwrap().push(json!({ "at": 0.1, "kind": "seal", "stiffness": -k }));
        LoadedCase::from_value("seal.json", value).unwrap()
    };
    let right = (1.5e5_f64 / MASS).sqrt();
    let found = frequencies(&seal(5e4));
    assert_eq!(found.iter().filter(|f| (*f / right - 1.0).abs() < 1e-6).count(), 2, "{found:?}");
    let error = modes(&model(&seal(2.5e5))).expect_err("unstable").to_string();
    assert!(error.contains("statically unstable") && error.contains("supports.1.stiffness"), "{error}");
}

/// Whirl of the rigid body with a tilt spring: `Id w^2 -+ Jp Omega w - k = 0`.
#[test]
fn tilt_springs_and_gyroscopic_moments() {
    let mut value = rigid(all_round(), "34X3", 4).value;
    value["supports"][0]["stiffness"] = json!(2e5);
    value["campbell"] =
        json!({ "speeds": { "from": 0, "to": 800, "count": 5 }, "modes": 6, "form": "classical" });
    let results = campbell(&LoadedCase::from_value("tilt.json", value).unwrap());
    for (k, speed) in results.speeds_rad_s.iter().enumerate() {
        let gyroscopic = POLAR * speed / (2.0 * DIAMETRAL);
        let root = (gyroscopic * gyroscopic + 4e3 / DIAMETRAL).sqrt();
        for (right, whirl) in [(root - gyroscopic, Whirl::Backward), (root + gyroscopic, Whirl::Forward)] {
            let is_there = |b: &&rotor::results::Branch| {
                b.frequency_rad_s[k].is_some_and(|f| (f / right - 1.0).abs() < 1e-5)
                    && (*speed == 0.0 || b.whirl_at_speed[k] == whirl)
            };
            assert!(results.branches.iter().any(|b| is_there(&b)), "{right} at {speed}");
        }
    }
}

/// The rigid body on a bearing with the table, at one speed.
fn on_table(table: Value, speed: f64) -> Vec<(f64, f64)> {
    let mut value = rigid(all_round(), "34X3", 2).value;
    value["supports"] = json!([
        { "at": 0.1, "kind": "bearing", "table": table },
        { "at": 0.1, "kind": "bearing", "axial_stiffness": 3e7, "tilt_stiffness": 4e6, "torsional_stiffness": 6e6 }
    ]);
    value["campbell"] =
        json!({ "speeds": { "from": speed, "to": speed, "count": 1 }, "modes": 2, "form": "classical" });
    let results = campbell(&LoadedCase::from_value("table.json", value).unwrap());
    let one = |b: &rotor::results::Branch| Some((b.frequency_rad_s[0]?, b.log_decrement[0]?));
    let mut list: Vec<(f64, f64)> = results.branches.iter().filter_map(one).collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list
}

/// Frequency and log decrement of `m x'' + c x' + k x = 0`.
fn oscillator(m: f64, c: f64, k: f64) -> (f64, f64) {
    let (rate, square) = (c / (2.0 * m), k / m);
    let w = (square - rate * rate).sqrt();
    (w, std::f64::consts::TAU * rate / w)
}

#[test]
fn a_table_over_speed_holds_at_each_speed() {
    let row = |speed: f64, k: f64, c: f64, m: f64| json!({ "speed": speed, "stiffness": k, "damping": c, "mass": m });
    let table = json!([row(100.0, 2e5, 80.0, 1.0), row(300.0, 3e5, 200.0, 2.0), row(700.0, 2.5e5, 0.0, 6.0)]);
    for (speed, k, c, m) in [(50.0, 2e5, 80.0, 1.0), (300.0, 3e5, 200.0, 2.0), (700.0, 2.5e5, 0.0, 6.0)] {
        let (w, decrement) = oscillator(MASS + m, c, k);
        let found = on_table(table.clone(), speed);
        assert_eq!(found.len(), 2);
        for (ours, decay) in found {
            close(ours, w, 1e-6, "frequency on a table");
            assert!((decay - decrement).abs() < 1e-6 + 1e-5 * decrement, "{decay} for {decrement}");
        }
    }
}

/// A stiffness that falls with the square of the whirl frequency is a mass; damping over frequency counts at the motion's own.
#[test]
fn a_table_over_whirl_holds_at_the_motion_s_own_frequency() {
    let (k, added) = (2e5, 4.0);
    let rows: Vec<Value> = (0..=60)
        .map(|i| {
            let w = 5.0 * f64::from(i);
            json!({ "speed": 0, "whirl": w, "stiffness": k - added * w * w, "damping": 0.5 * w })
        })
        .collect();
    let w = (k / (MASS + added)).sqrt();
    for speed in [0.0, 90.0, 1000.0] {
        for (ours, decay) in on_table(json!(rows), speed) {
            // the table's cubic meets the parabola to its third order
            close(ours, w, 2e-5, "frequency over whirl");
            let right = oscillator(MASS + added, 0.5 * w, k).1;
            close(decay, right, 1e-3, "decay over whirl");
        }
    }
}

/// An anisotropic table with cross-coupling at its own speeds is the bearing with these constants.
#[test]
fn a_row_is_a_bearing_with_constants() {
    let case = case("two-disk-table");
    let table = case.value["supports"][0]["table"].clone();
    for k in [0, 2, 4] {
        let row = &table[k];
        let speed = row["speed"].as_f64().unwrap();
        let speeds = json!({ "from": speed, "to": speed, "count": 1 });
        let tabled = campbell(&with(&case, json!({ "campbell.speeds": speeds, "campbell.modes": 14 })));
        let constant = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": row["stiffness"], "damping": row["damping"] });
        let constants = campbell(&with(
            &case,
            json!({ "campbell.speeds": speeds, "campbell.modes": 14, "supports": [constant(0.1), constant(1.1)] }),
        ));
        let list = |c: &rotor::results::Campbell| {
            let mut all: Vec<(f64, f64)> = c
                .branches
                .iter()
                .filter_map(|b| Some((b.frequency_rad_s[0]?, b.log_decrement[0]?)))
                .filter(|(f, _)| *f < 5000.0)
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all
        };
        let (a, b) = (list(&tabled), list(&constants));
        assert!(!a.is_empty());
        for ((f, d), (g, e)) in a.iter().zip(&b) {
            close(*f, *g, 1e-5, "row");
            assert!((d - e).abs() < 1e-4 * (1.0 + e.abs()), "{d} for {e}");
        }
    }
}

/// Frequencies and log decrements at the speeds of the table against a Timoshenko beam with 160 elements
/// (tests/reference/rotor/a1_bearing_table_two_disk.json).
#[test]
fn oil_film_bearings_against_a_timoshenko_beam() {
    let text = include_str!("../reference/rotor/a1_bearing_table_two_disk.json");
    let reference: Value = serde_json::from_str(text).unwrap();
    let case = case("two-disk-table");
    for row in reference["at_table_speeds"].as_array().unwrap() {
        let speed = row["speed"].as_f64().unwrap();
        let speeds = json!({ "from": speed, "to": speed, "count": 1 });
        let results = campbell(&with(&case, json!({ "campbell.speeds": speeds, "campbell.modes": 18 })));
        for mode in row["modes"].as_array().unwrap() {
            let (f, d) = (mode["freq"].as_f64().unwrap(), mode["logdec"].as_f64().unwrap());
            let fits = |b: &rotor::results::Branch| {
                let (Some(ours), Some(decay)) = (b.frequency_rad_s[0], b.log_decrement[0]) else {
                    return false;
                };
                (ours / f - 1.0).abs() < 0.01 && (decay - d).abs() < 0.01 + 0.03 * d.abs()
            };
            let all: Vec<_> =
                results.branches.iter().map(|b| (b.frequency_rad_s[0], b.log_decrement[0])).collect();
            assert!(results.branches.iter().any(fits), "{f} rad/s, {d} at {speed}: {all:?}");
        }
    }
}
