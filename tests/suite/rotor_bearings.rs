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
        "materials": { "light": { "E": 2e13, "nu": 0.3, "rho": 1e-3 } },
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
        close(*ours, right, 1e-5, "rigid body");
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
        ("34X3", 10, false, 3e-4),
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
            // the stub itself gives way by a few parts in a million
            let count = found.iter().filter(|f| (*f / right - 1.0).abs() < 1e-5).count();
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
        // the stub gives way between its bearings
        let count = found.iter().filter(|f| (*f / right - 1.0).abs() < 5e-5).count();
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
    let one = |b: &rotor::results::Branch| Some((b.frequency_rad_s[0]?, b.log_decrement[0].unwrap_or(0.0)));
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
            json!({ "speed": 1, "whirl": w, "stiffness": k - added * w * w, "damping": 0.5 * w })
        })
        .collect();
    // m (s^2 - w^2) + c s + k - a w^2 = 0 and 2 m s w + c w = 0 with c = w/2
    let w = (k / (MASS + added + 0.25 / (4.0 * MASS))).sqrt();
    for speed in [1.0, 90.0, 1000.0] {
        for (ours, decay) in on_table(json!(rows), speed) {
            // the table's cubic meets the parabola to its third order
            close(ours, w, 2e-5, "frequency over whirl");
            close(decay, std::f64::consts::TAU * 0.5 / (2.0 * MASS), 1e-5, "decay over whirl");
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
    // the beam has no hubs
    let case = with(&case("two-disk-table"), json!({ "disks.0.hub": "soft", "disks.1.hub": "soft" }));
    for row in reference["at_table_speeds"].as_array().unwrap() {
        let speed = row["speed"].as_f64().unwrap();
        let speeds = json!({ "from": speed, "to": speed, "count": 1 });
        let results = campbell(&with(&case, json!({ "campbell.speeds": speeds, "campbell.modes": 18 })));
        for mode in row["modes"].as_array().unwrap() {
            // higher motions tilt the disks, and what their hubs hold of the shaft counts; so it does for motions that a
            // damper stops within a few turns
            if mode["freq"].as_f64().unwrap() > 5000.0 || mode["logdec"].as_f64().unwrap() > 3.0 {
                continue;
            }
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

/// Rigid disks on stubs of 0.1 m each, joined by couplings.
fn coupled(disks: &[(f64, f64, f64)], couplings: &[Value], element: &str, elements: usize) -> LoadedCase {
    let segment = |_: &(f64, f64, f64)| json!({ "length": 0.1, "elements": elements, "section": "stub", "material": "light" });
    let disk = |(i, (m, polar, diametral)): (usize, &(f64, f64, f64))| json!({ "at": 0.05 + 0.1 * i as f64, "mass": m, "polar_inertia": polar, "diametral_inertia": diametral });
    let coupling = |(i, c): (usize, &Value)| {
        let mut c = c.clone();
        c["at"] = json!(0.1 * (i + 1) as f64);
        c
    };
    let value = json!({
        "title": "coupled",
        "materials": { "light": { "E": 2e13, "nu": 0.3, "rho": 1e-3 } },
        "sections": { "stub": { "shape": "circle", "radius": 0.05 } },
        "shaft": { "element": element, "segments": disks.iter().map(segment).collect::<Vec<_>>() },
        "disks": disks.iter().enumerate().map(disk).collect::<Vec<_>>(),
        "couplings": couplings.iter().enumerate().map(coupling).collect::<Vec<_>>(),
        "modes": { "count": 6 * disks.len() },
    });
    LoadedCase::from_value("coupled.json", value).unwrap_or_else(|e| panic!("{e}"))
}

fn coupling(lateral: f64, axial: f64, tilt: f64, torsional: f64) -> Value {
    json!({ "stiffness": lateral, "axial_stiffness": axial, "tilt_stiffness": tilt, "torsional_stiffness": torsional })
}

/// Two and three inertias with torsional springs between (values of 3x3 eigenproblems), and two masses along the axis.
#[test]
fn couplings_are_springs_between_inertias() {
    for (element, elements) in [("34X3", 1), ("34X3", 10), ("34X3", 80), ("34X4", 4)] {
        let two = coupled(
            &[(10.0, 0.5, 0.3), (25.0, 1.2, 0.7)],
            &[coupling(3e6, 5e6, 7e5, 2e4)],
            element,
            elements,
        );
        let found = frequencies(&two);
        for right in [238.047614, (5e6_f64 * (1.0 / 10.0 + 1.0 / 25.0)).sqrt()] {
            assert_eq!(
                found.iter().filter(|f| (*f / right - 1.0).abs() < 5e-4).count(),
                1,
                "{right} in {found:?}"
            );
        }
        // u1, tilt1, u2, tilt2 in one plane
        let mass = [10.0, 0.3, 25.0, 0.7];
        let lateral = [1.0, 0.05, -1.0, 0.05];
        let tilt = [0.0, 1.0, 0.0, -1.0];
        let matrix = nalgebra::DMatrix::from_fn(4, 4, |i, j| {
            let k = 3e6 * lateral[i] * lateral[j] + 7e5 * tilt[i] * tilt[j];
            k / f64::sqrt(mass[i] * mass[j])
        });
        let mut squares: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
        squares.sort_by(f64::total_cmp);
        for square in &squares[2..] {
            let right = square.sqrt();
            assert_eq!(
                found.iter().filter(|f| (*f / right - 1.0).abs() < 5e-4).count(),
                2,
                "{right} in {found:?}"
            );
        }
    }
    let three = coupled(
        &[(10.0, 0.4, 0.3), (25.0, 0.9, 0.7), (10.0, 0.25, 0.2)],
        &[coupling(3e8, 5e8, 7e7, 5e4), coupling(3e8, 5e8, 7e7, 3e4)],
        "34X3",
        2,
    );
    let found = frequencies(&three);
    for right in [349.012955, 460.520191] {
        assert_eq!(
            found.iter().filter(|f| (*f / right - 1.0).abs() < 5e-4).count(),
            1,
            "{right} in {found:?}"
        );
    }
}

/// A coupling far stiffer than the shaft is none.
#[test]
fn a_stiff_coupling_joins_a_shaft() {
    let shaft = |more: Value| {
        let mut value = json!({
            "title": "shaft",
            "materials": { "steel": { "E": 2.1e11, "nu": 0.3, "rho": 7850 } },
            "sections": { "shaft": { "shape": "circle", "radius": 0.02 } },
            "shaft": { "segments": [{ "length": 1, "elements": 10, "section": "shaft", "material": "steel" }] },
            "supports": [{ "at": 0, "kind": "pinned" }, { "at": 1, "kind": "roller" }],
            "gravity": [0, -9.81, 0],
            "modes": { "count": 8 },
        });
        value.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        LoadedCase::from_value("shaft.json", value).unwrap()
    };
    let mut stiff = coupling(1e13, 1e13, 1e11, 1e11);
    stiff["at"] = json!(0.4);
    let (joined, whole) = (shaft(json!({ "couplings": [stiff] })), shaft(json!({})));
    // the sections at the joint may deform apart from each other
    for (a, b) in frequencies(&joined).iter().zip(frequencies(&whole)).filter(|(a, _)| **a > 1.0) {
        close(*a, b, 2e-3, "stiff coupling");
    }
    let sag = |case: &LoadedCase| {
        let results =
            rotor::analysis::statics::statics(&model(case)).unwrap_or_else(|e| panic!("{e}")).results;
        results.axis.iter().map(|u| u[1]).fold(0.0, f64::min)
    };
    close(sag(&joined), sag(&whole), 2e-3, "sag");
}

#[test]
fn couplings_at_wrong_places_are_refused() {
    let two = coupled(&[(10.0, 0.5, 0.3), (25.0, 1.2, 0.7)], &[coupling(3e6, 5e6, 7e5, 2e4)], "34X3", 1);
    for (set, words) in [
        (json!({ "couplings.0.at": 0.0 }), "can't stand at an end"),
        (json!({ "couplings.0.at": 0.05 }), "of which half is not said"),
        (json!({ "couplings.0.at": 0.3 }), "off the shaft"),
        (json!({ "couplings.0.torsional_stiffness": 0 }), "lets go"),
        (json!({ "couplings.0.stiffness": [[1e6, 2e6], [2e6, 1e6]] }), "lets go"),
    ] {
        let error = rotor::model::Model::new(&with(&two, set.clone())).expect_err("refused").to_string();
        assert!(error.contains(words), "{set}\n{error}");
    }
}

/// With the coefficients straight between the rows, as the reference takes them: threshold of stability and damped critical speeds.
#[test]
fn the_threshold_of_oil_film_bearings() {
    let text = include_str!("../reference/rotor/a1_bearing_table_two_disk.json");
    let reference: Value = serde_json::from_str(text).unwrap();
    let mut value = case("two-disk-table").value;
    let rows = value["supports"][0]["table"].as_array().unwrap().clone();
    let number = |v: &Value| v.as_f64().unwrap();
    let mut straight = Vec::new();
    for pair in rows.windows(2) {
        for k in 0..8 {
            let share = f64::from(k) / 8.0;
            let between = |a: &Value, b: &Value| number(a) * (1.0 - share) + number(b) * share;
            let matrix =
                |key: &str| [0, 1].map(|i| [0, 1].map(|j| between(&pair[0][key][i][j], &pair[1][key][i][j])));
            straight.push(json!({ "speed": between(&pair[0]["speed"], &pair[1]["speed"]),
                                  "stiffness": matrix("stiffness"), "damping": matrix("damping") }));
        }
    }
    straight.push(rows[rows.len() - 1].clone());
    for support in value["supports"].as_array_mut().unwrap() {
        support["table"] = json!(straight);
    }
    let results = campbell(&LoadedCase::from_value("straight.json", value).unwrap());
    close(
        results.stability_threshold_rad_s.unwrap(),
        number(&reference["stability_threshold_rad_s"]),
        5e-3,
        "threshold",
    );
    for right in reference["damped_1x_crossings_rad_s"].as_array().unwrap() {
        let near = |c: &rotor::results::CriticalSpeed| (c.speed_rad_s / number(right) - 1.0).abs() < 5e-3;
        assert!(results.critical_speeds.iter().any(near), "{right}");
    }
}
