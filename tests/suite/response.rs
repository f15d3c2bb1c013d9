//! Steady vibration: unbalance and harmonic excitation against closed forms, other formulations and refined meshes; the map of
//! critical speeds; bad input.

use crate::common::{case, model, with};
use rotor::analysis::critical_map::critical_map;
use rotor::analysis::response::harmonic::harmonic;
use rotor::analysis::response::unbalance::unbalance;
use rotor::analysis::spinup::spinup;
use rotor::case::LoadedCase;
use rotor::model::Model;
use rotor::results::{CriticalMap, Diagnostic, HarmonicResponse, UnbalanceResponse, Whirl};
use serde_json::{Value, json};

fn unbalanced(case: &LoadedCase) -> UnbalanceResponse {
    told(case).0
}

fn told(case: &LoadedCase) -> (UnbalanceResponse, Vec<Diagnostic>) {
    let model = model(case);
    let settings = model.unbalance.as_ref().expect("unbalance");
    let outcome = unbalance(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}"));
    (outcome.results, outcome.diagnostics)
}

fn excited(case: &LoadedCase) -> HarmonicResponse {
    let model = model(case);
    let settings = model.harmonic.as_ref().expect("harmonic");
    harmonic(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}")).results
}

fn map(case: &LoadedCase) -> CriticalMap {
    let model = model(case);
    let settings = model.map.as_ref().expect("map");
    critical_map(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}")).results
}

fn close(ours: f64, right: f64, rtol: f64, what: &str) {
    assert!((ours - right).abs() < rtol * right.abs(), "{what}: {ours} for {right}");
}

/// A rigid rotor whose centre of mass lies between unequal bearings, out of balance in two planes: amplitude and phase at both
/// bearings from the two equations of motion of a rigid body,
/// `(K - W^2 M + i W C) u = W^2 f` with `M = diag(m, Id - Jp)` of forward whirl.
#[test]
fn a_rigid_rotor_on_unequal_bearings() {
    let (m, polar, diametral) = (10.0, 0.05, 0.09);
    let (places, k, c) = ([0.0, 0.4], [3e5, 5e5], [300.0, 80.0]);
    let centre = 0.15;
    let planes = [(0.1, 2e-4, 0.3), (0.3, 1e-4, 2.0)];
    let speeds = [60.0, 200.0, 230.0, 500.0, 1500.0];
    let bearing =
        |i: usize| json!({ "at": places[i], "kind": "bearing", "stiffness": k[i], "damping": c[i] });
    let value = json!({
        "title": "rigid",
        "materials": { "light": { "E": 2e15, "nu": 0.3, "rho": 1e-3 } },
        "sections": { "stub": { "shape": "circle", "radius": 0.05 } },
        "shaft": { "segments": [{ "length": 0.4, "elements": 4, "section": "stub", "material": "light" }] },
        "disks": [{ "at": centre, "mass": m, "polar_inertia": polar, "diametral_inertia": diametral }],
        "supports": [bearing(0), bearing(1)],
        "unbalance": {
            "speeds": speeds, "amplitude": "zero-to-peak", "form": "classical",
            "masses": planes.map(|(at, moment, angle)| json!({ "at": at, "moment": moment, "angle": angle })),
            "stations": places.map(|at| json!({ "at": at })),
        },
    });
    let results = unbalanced(&LoadedCase::from_value("rigid.json", value).unwrap());
    use faer::c64;
    for (n, w) in speeds.into_iter().enumerate() {
        // translation of the centre and tilt of the axis, as forward circles
        let mut z = [[c64::new(0.0, 0.0); 2]; 2];
        for i in 0..2 {
            let arm = [1.0, places[i] - centre];
            for a in 0..2 {
                for b in 0..2 {
                    z[a][b] += c64::new(k[i], w * c[i]) * (arm[a] * arm[b]);
                }
            }
        }
        z[0][0] -= c64::new(m * w * w, 0.0);
        z[1][1] -= c64::new((diametral - polar) * w * w, 0.0);
        let mut f = [c64::new(0.0, 0.0); 2];
        for (at, moment, angle) in planes {
            let force = c64::from_polar(moment * w * w, angle);
            f[0] += force;
            f[1] += force * (at - centre);
        }
        let det = z[0][0] * z[1][1] - z[0][1] * z[1][0];
        let u = [(f[0] * z[1][1] - f[1] * z[0][1]) / det, (f[1] * z[0][0] - f[0] * z[1][0]) / det];
        for (i, station) in results.stations.iter().enumerate() {
            let right = u[0] + u[1] * (places[i] - centre);
            close(station.amplitude_m[n], right.norm(), 1e-5, "amplitude");
            close(station.minor_axis_m[n], right.norm(), 1e-5, "circle");
            let turn = c64::from_polar(1.0, station.phase_rad[n] - right.arg()).arg();
            assert!(turn.abs() < 1e-5, "phase {} for {}", station.phase_rad[n], right.arg());
            assert_eq!(station.whirl[n], Whirl::Forward);
            let force = &results.bearing_forces_n[&format!("supports.{i}")];
            close(force.major_n[n], (right * c64::new(k[i], w * c[i])).norm(), 1e-5, "force");
        }
    }
}

/// Published rotor: peaks have a limit as the mesh is refined, whatever the order of the section.
#[test]
fn peaks_have_a_limit_under_refinement() {
    let base = with(
        &case("lalanne-ferraris"),
        json!({ "unbalance.speeds": { "from": 300, "to": 1300, "count": 101 }, "unbalance.form": "classical" }),
    );
    let peaks = |set: Value| -> Vec<(f64, f64)> {
        let results = unbalanced(&with(&base, set));
        let first = results.stations[0].name.clone();
        results.peaks.iter().filter(|p| p.station == first).map(|p| (p.speed_rad_s, p.amplitude_m)).collect()
    };
    // what a rigid hub holds reaches a radius into the shaft: meshes coarser than that see it only in part
    let finest = peaks(json!({ "shaft.segments.0.elements": 160 }));
    assert!(finest.len() >= 4);
    for (set, rtol) in [
        (json!({ "shaft.segments.0.elements": 10 }), 3e-3),
        (json!({ "shaft.segments.0.elements": 40 }), 5e-4),
        (json!({ "shaft.segments.0.elements": 40, "loads": [{ "at": 0.500025, "force": [0, 1, 0] }] }), 5e-4),
        (json!({ "shaft.segments.0.elements": 40, "shaft.element": "34X4" }), 1e-3),
    ] {
        let found = peaks(set.clone());
        assert_eq!(found.len(), finest.len(), "{set}");
        for ((speed, amplitude), (right, largest)) in found.iter().zip(&finest) {
            close(*speed, *right, rtol, "speed of a peak");
            close(*amplitude, *largest, 20.0 * rtol, "peak");
        }
    }
}

/// The steady orbit of the nonlinear equations in the turning frame is the linear response, where it is small.
#[test]
fn linear_response_is_the_steady_orbit() {
    let mut value = case("friswell-unbalance").value;
    value["unbalance"] = json!({ "speeds": [60.0], "amplitude": "zero-to-peak", "masses": [] });
    value["disks"][0]["offset"] = json!([1e-6, 0]);
    value["shaft"]["segments"][0]["elements"] = json!(8);
    value["probes"] = json!([{ "name": "disk", "at": 0.5 }]);
    value["spinup"] =
        json!({ "drive": [{ "until": 1, "speed": 60.0 }], "until": 1, "steady": true, "driven_at": 0.0 });
    let case = LoadedCase::from_value("steady.json", value).unwrap();
    let linear = unbalanced(&case).stations[0].amplitude_m[0];
    let model = model(&case);
    let steady =
        spinup(&model, model.spinup.as_ref().unwrap(), &|_, _| true).unwrap_or_else(|e| panic!("{e}"));
    let [_, y, z] = steady.results.last.probes[0].point.as_ref().unwrap().displacement_m;
    close(y.hypot(z), linear, 5e-3, "steady orbit");
}

/// A force that turns with the rotor is an unbalance; the sum of two bases is a base motion at an angle.
#[test]
fn excitations_add_up() {
    let unbalance = with(
        &case("lalanne-ferraris"),
        json!({ "unbalance.speeds": [700.0], "unbalance.masses": [{ "at": 0.5, "moment": 2e-4, "angle": 0.4 }] }),
    );
    let right = unbalanced(&unbalance);
    let force = 2e-4 * 700.0 * 700.0;
    let mut value = unbalance.value.clone();
    value["harmonic"] = json!({
        "spin_speed": 700.0, "frequencies": [700.0], "amplitude": "zero-to-peak",
        "excitations": [
            { "at": 0.5, "force": [0, force, 0], "phase": 0.4 },
            { "at": 0.5, "force": [0, 0, force], "phase": 0.4 - std::f64::consts::FRAC_PI_2 },
        ],
        "stations": unbalance.value["unbalance"]["stations"],
    });
    let ours = excited(&LoadedCase::from_value("turning.json", value).unwrap());
    for (a, b) in ours.stations.iter().zip(&right.stations) {
        close(a.major_axis_m[0], b.major_axis_m[0], 1e-6, "major axis");
        close(a.minor_axis_m[0], b.minor_axis_m[0], 1e-6, "minor axis");
        close(a.phase_rad[0], b.phase_rad[0], 1e-6, "phase");
    }
}

/// Peak to peak is twice zero to peak, in every displacement and in no force.
#[test]
fn amplitudes_are_what_they_are_called() {
    let zero = with(
        &case("lalanne-ferraris"),
        json!({ "unbalance.speeds": [500.0], "unbalance.amplitude": "zero-to-peak" }),
    );
    let (a, b) =
        (unbalanced(&zero), unbalanced(&with(&zero, json!({ "unbalance.amplitude": "peak-to-peak" }))));
    assert_eq!((a.amplitude, b.amplitude), ("zero-to-peak", "peak-to-peak"));
    close(b.stations[0].amplitude_m[0], 2.0 * a.stations[0].amplitude_m[0], 1e-12, "amplitude");
    close(b.stations[0].major_axis_m[0], 2.0 * a.stations[0].major_axis_m[0], 1e-12, "axis");
    let path = "supports.0";
    close(b.bearing_forces_n[path].major_n[0], a.bearing_forces_n[path].major_n[0], 1e-12, "force");
}

/// A grade leaves G m / Omega altogether, spread by the disks' masses.
#[test]
fn a_grade_is_spread_over_the_disks() {
    let graded = |more: Value| {
        let mut value = case("lalanne-ferraris").value;
        value["unbalance"] = json!({ "speeds": [100.0, 500.0], "grade": "G2.5" });
        value.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        unbalanced(&LoadedCase::from_value("graded.json", value).unwrap()).masses
    };
    let mass = 14.5801315 + 45.9457926 + 55.1349511 + 7800.0 * std::f64::consts::PI * 0.05 * 0.05 * 1.3;
    let total: f64 = graded(json!({})).iter().map(|m| m.moment_kg_m).sum();
    close(total, 2.5e-3 * mass / 500.0, 1e-9, "total");
    let operating = graded(json!({ "operating_speed": { "minimum": 200, "maximum": 250 } }));
    close(
        operating.iter().map(|m| m.moment_kg_m).sum(),
        2.5e-3 * mass / 250.0,
        1e-9,
        "total at the operating speed",
    );
    close(operating[1].moment_kg_m / operating[0].moment_kg_m, 45.9457926 / 14.5801315, 1e-9, "share");
}

/// A disk on a light shaft with internal damping; its sweep follows too few speeds to be a case of its own.
fn internal_damping() -> LoadedCase {
    let text = include_str!("../reference/rotor/internal-damping.json");
    LoadedCase::from_value("internal-damping.json", serde_json::from_str(text).unwrap()).unwrap()
}

/// Viscous: `Omega = w (1 + c_ext / c_int)`; a loss factor drives from the critical speed on where `eta k > c_ext w`.
#[test]
fn thresholds_of_internal_damping() {
    let case = internal_damping();
    assert!(case.case.expected.len() >= 9);
    for expected in &case.case.expected {
        let set = Value::Object(expected.set.clone().unwrap_or_default());
        let results = crate::common::campbell(&with(&case, set.clone()));
        let right = expected.value.as_f64().unwrap();
        close(results.stability_threshold_rad_s.unwrap_or(0.0), right, 1e-4, &set.to_string());
    }
}

/// Internal damping above its threshold: the response is told with the error that it is never reached.
#[test]
fn an_unstable_rotor_is_told() {
    let mut value = internal_damping().value;
    value["unbalance"] = json!({ "speeds": { "from": 10, "to": 300, "count": 30 }, "form": "classical",
                                 "masses": [{ "at": 0.5, "moment": 1e-4 }] });
    let (results, diagnostics) = told(&LoadedCase::from_value("unstable.json", value).unwrap());
    close(results.stability_threshold_rad_s.expect("threshold"), 111.803399, 1e-3, "threshold");
    assert!(diagnostics.iter().any(|d| d.code == "unstable-response"));
}

/// Curves of the map meet the bearings' own: a bearing of constant stiffness meets a curve at the critical speed on that stiffness.
#[test]
fn a_map_meets_its_bearings() {
    let mut value = case("two-disk-table").value;
    for support in value["supports"].as_array_mut().unwrap() {
        *support = json!({ "at": support["at"], "kind": "bearing", "stiffness": 1e8 });
    }
    let results = map(&LoadedCase::from_value("map.json", value).unwrap());
    assert!(results.measured_error < 1e-6, "{}", results.measured_error);
    for (whirl, n, right) in [
        // tests/reference of the case, 1e8 N/m
        (Whirl::Forward, 1, 743.033766),
        (Whirl::Backward, 1, 733.583097),
        (Whirl::Forward, 2, 2167.7246),
        (Whirl::Backward, 2, 2009.16942),
    ] {
        let found =
            results.intersections.iter().find(|i| i.whirl == whirl && i.n == n && i.direction == "yy");
        close(found.expect("intersection").speed_rad_s, right, 0.01, "intersection");
    }
    let rigid = results.curves.iter().find(|c| c.whirl == Whirl::Forward && c.n == 1).unwrap();
    close(rigid.rigid_rad_s.unwrap(), 857.0, 0.01, "rigid supports");
}

/// The cross-coupling at which a rigid rotor begins to grow is `c w`, with its damping c and frequency w.
#[test]
fn a_cross_coupling_has_a_threshold() {
    let mut value = case("jeffcott-unbalance").value;
    value["map"] = json!({
        "stiffness": { "from": 1e5, "to": 1e6, "count": 5 },
        "cross_coupling": { "at": 0.05, "speed": 100, "to": 1e5, "count": 11 },
    });
    let results = map(&LoadedCase::from_value("cross.json", value).unwrap());
    let threshold = results.cross_coupling.unwrap().threshold_n_m.expect("threshold");
    close(threshold, 223.606798 * (5e5_f64 / 10.0).sqrt(), 1e-5, "threshold");
}

fn refusal(case: &LoadedCase) -> String {
    Model::new(case).expect_err("refused").to_string()
}

#[test]
fn bad_input_is_refused_with_its_path() {
    let base = case("lalanne-ferraris");
    for (set, path, words) in [
        (json!({ "unbalance.masses.0.at": 2.0 }), "unbalance.masses.0.at", "off the shaft"),
        (json!({ "unbalance.masses.0.moment": -1e-4 }), "unbalance.masses.0.moment", "negative"),
        (json!({ "unbalance.masses.0.mass": 1.0 }), "unbalance.masses.0.mass", "not both"),
        (json!({ "unbalance.masses": [{ "at": 0.5, "mass": 1.0 }] }), "unbalance.masses.0.radius", "missing"),
        (json!({ "unbalance.masses": [{ "at": 0.5 }] }), "unbalance.masses.0.moment", "missing"),
        (json!({ "unbalance.stations.0.at": -0.1 }), "unbalance.stations.0.at", "off the shaft"),
        (json!({ "unbalance.grade": "2.5" }), "unbalance.grade", "no balance grade"),
        (json!({ "unbalance.speeds": [100.0, 90.0] }), "unbalance.speeds.1", "do not rise"),
        (json!({ "unbalance.distribution": "alternating" }), "unbalance.distribution", "no grade"),
        (
            json!({ "operating_speed": { "minimum": 500, "maximum": 400 } }),
            "operating_speed.maximum",
            "wrong order",
        ),
        (
            json!({ "operating_speed": { "minimum": 300, "maximum": 400, "trip": 350 } }),
            "operating_speed.trip",
            "wrong order",
        ),
        (json!({ "clearances": [{ "name": "seal", "at": 0.2, "gap": 0 }] }), "clearances.0.gap", "positive"),
        (json!({ "supports.0.at": 1.4 }), "supports.0.at", "off the shaft"),
        (json!({ "supports.0.mass": -2 }), "supports.0.mass", "negative"),
        (json!({ "supports.0.mass": [[1, 0.5], [0, 1]] }), "supports.0.mass", "not symmetric"),
        (json!({ "supports.0.housing": { "mass": 10 } }), "supports.0.housing.stiffness", "missing"),
        (json!({ "supports.0.housing": { "ref": "frame" } }), "supports.0.housing.ref", "no housing"),
        (
            json!({ "supports.0.housing": { "mass": 0, "stiffness": 1e6 } }),
            "supports.0.housing.mass",
            "needs mass",
        ),
        (
            json!({ "housings": { "frame": { "mass": 1, "stiffness": 1e6 } } }),
            "housings.frame",
            "no bearing stands",
        ),
        (json!({ "supports.0.table": [] }), "supports.0.stiffness", "not both"),
        (
            json!({ "harmonic": { "frequencies": [10], "excitations": [] } }),
            "harmonic.excitations",
            "nothing excites",
        ),
        (
            json!({ "harmonic": { "frequencies": [10], "excitations": [{ "force": [0, 1, 0] }] } }),
            "harmonic.excitations.0.at",
            "needs its place",
        ),
        (
            json!({ "harmonic": { "frequencies": [10], "excitations": [{ "at": 0.1, "base": { "displacement": [1, 0] } }] } }),
            "harmonic.excitations.0.at",
            "under all supports",
        ),
        (json!({ "map": { "stiffness": { "from": 1e9, "to": 1e5 } } }), "map.stiffness.from", "do not rise"),
        (
            json!({ "map": { "stiffness": { "from": 1e5, "to": 1e9 }, "bearings": [7] } }),
            "map.bearings.0",
            "not the number of a bearing",
        ),
        (
            json!({ "map": { "stiffness": { "from": 1e5, "to": 1e9 }, "cross_coupling": { "to": 1e7 } } }),
            "map.cross_coupling.speed",
            "needs a speed",
        ),
    ] {
        let error = refusal(&with(&base, set.clone()));
        assert!(error.contains(path) && error.contains(words), "{set}\n{error}");
    }
}

/// In a run-up a mass beside the axis acts as a disk's offset does: the same moment gives the same steady orbit.
#[test]
fn masses_beside_the_axis_act_in_run_ups() {
    let steady = |set: Value| -> [f64; 2] {
        let mut value = case("friswell-unbalance").value;
        value["shaft"]["segments"][0]["elements"] = json!(8);
        value["probes"] = json!([{ "name": "disk", "at": 0.5 }]);
        value["spinup"] =
            json!({ "drive": [{ "until": 1, "speed": 60.0 }], "until": 1, "steady": true, "driven_at": 0.0 });
        let case = with(&LoadedCase::from_value("steady.json", value).unwrap(), set);
        let model = model(&case);
        let steady =
            spinup(&model, model.spinup.as_ref().unwrap(), &|_, _| true).unwrap_or_else(|e| panic!("{e}"));
        let [_, y, z] = steady.results.last.probes[0].point.as_ref().unwrap().displacement_m;
        [y, z]
    };
    let disk_mass = 32.5897277;
    let angle: f64 = 0.7;
    let offset = [1e-6 * angle.cos(), 1e-6 * angle.sin()];
    let [y, z] = steady(json!({ "unbalance.masses": [], "disks.0.offset": offset }));
    let mass = json!([{ "at": 0.5, "moment": 1e-6 * disk_mass, "angle": angle }]);
    let [v, w] = steady(json!({ "unbalance.masses": mass }));
    assert!((y - v).hypot(z - w) < 1e-4 * y.hypot(z), "{v} {w} for {y} {z}");
}
