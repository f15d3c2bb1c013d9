//! Drives: ramps, reversal, torque over speed, run-down; frames against each other; closed forms and an integration of our own.

use crate::common::{fieldtest, model, shaft, with};
use ode_solvers::{Dopri5, OutputType, System, Vector6};
use rotor::analysis::spinup::spinup;
use rotor::case::LoadedCase;
use rotor::error::Error;
use rotor::results::Spinup;
use serde_json::{Value, json};
use std::f64::consts::PI;

fn attempt(case: &LoadedCase) -> Result<Spinup, Error> {
    let model = model(case);
    spinup(&model, model.spinup.as_ref().expect("spinup"), &|_, _| true).map(|outcome| outcome.results)
}

fn run(case: &LoadedCase) -> Spinup {
    attempt(case).unwrap_or_else(|e| panic!("{e}"))
}

/// Both frames tell the orbit of a run through a critical speed alike, at the same tolerance, to ten times of it.
#[test]
fn both_frames_keep_the_tolerance_of_the_vibration() {
    let rtol = 1e-4;
    let in_frame = |frame: &str| {
        let set = json!({
            "spinup.frame": frame, "spinup.rtol": rtol, "spinup.until": 1.2, "spinup.output": 121
        });
        run(&with(&fieldtest("runup_inertial_frame"), set)).history.expect("history").mid_span_m
    };
    let (rotating, inertial) = (in_frame("rotating"), in_frame("inertial"));
    let size = rotating.iter().flatten().fold(0.0, |m: f64, u| m.max(u.abs()));
    assert!(size > 3e-3, "{size}");
    let pairs = rotating.iter().flatten().zip(inertial.iter().flatten());
    let apart = pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(apart < 10.0 * rtol * size, "{apart} of {size}");
}

/// A short stiff shaft, driven at one end.
fn stiff(spinup: Value) -> LoadedCase {
    let more = json!({
        "supports": [{ "at": 0, "kind": "revolute" }, { "at": 0.2, "kind": "cylindrical", "driven": false }],
        "spinup": spinup
    });
    shaft(json!({ "shape": "circle", "radius": 0.05 }), 0.2, 2, more)
}

/// Polar inertia of that shaft.
fn inertia() -> f64 {
    7800.0 * PI * 0.05_f64.powi(4) / 2.0 * 0.2
}

/// Along a straight ramp the torque is `J alpha` in the mean, and its work the kinetic energy; through a reversal too.
#[test]
fn straight_ramps_and_reversal() {
    for (frame, integrator) in [("rotating", "implicit")] {
        let found = run(&stiff(json!({
            "drive": [{ "until": 0.02, "speed": 100, "shape": "linear" }, { "until": 0.05, "speed": -50, "shape": "linear" },
                      { "until": 0.06, "speed": -50 }],
            "rtol": 1e-4, "atol": 1e-8, "output": 41, "frame": frame, "integrator": integrator
        })));
        let history = found.history.as_ref().expect("history");
        for (t, speed) in history.time_s.iter().zip(&history.speed_rad_s) {
            let right = if *t <= 0.02 {
                5000.0 * t
            } else if *t <= 0.05 {
                100.0 - 5000.0 * (t - 0.02)
            } else {
                -50.0
            };
            assert!((speed - right).abs() < 1e-9, "{t}: {speed} {right}");
        }
        // the angular momentum is J Omega but for the torsional vibration that the jump starts
        for (momentum, speed) in history.angular_momentum_kg_m2_s.iter().zip(&history.speed_rad_s) {
            assert!((momentum - inertia() * speed).abs() < 0.02 * inertia() * 100.0, "{momentum} {speed}");
        }
        let energy = found.energy.expect("energy");
        assert!(energy.relative_error.abs() < 1e-3, "{frame} {integrator}: {energy:?}");
    }
}

/// What turns backward is the mirror image of what turns forward: an unbalanced rotor on bearings.
#[test]
fn a_backward_run_is_the_mirror_image() {
    let in_sense = |sign: f64, steady: bool| {
        let set = json!({
            "spinup.drive": [{ "until": 0.3, "speed": sign * 80.0 }], "spinup.until": 0.5, "spinup.rtol": 1e-7,
            "spinup.output": 26, "spinup.steady": steady,
            "probes": [{ "name": "disk", "at": 0.2, "y": 0 }]
        });
        run(&with(&fieldtest("steady_orbit_on_damped_bearings"), set))
    };
    let (forward, backward) = (in_sense(1.0, false), in_sense(-1.0, false));
    let paths = [&forward, &backward].map(|f| &f.history.as_ref().expect("history").mid_span_m);
    let size = paths[0].iter().flatten().fold(0.0, |m: f64, u| m.max(u.abs()));
    for (a, b) in paths[0].iter().zip(paths[1]) {
        assert!((a[1] - b[1]).abs() < 1e-5 * size && (a[2] + b[2]).abs() < 1e-5 * size, "{a:?} {b:?}");
    }
    let place = |found: &Spinup| found.last.probes[0].point.as_ref().expect("point").displacement_m;
    let (a, b) = (place(&in_sense(1.0, true)), place(&in_sense(-1.0, true)));
    assert!(
        a[2].abs() > 1e-5 && (a[1] / b[1] - 1.0).abs() < 1e-9 && (a[2] / b[2] + 1.0).abs() < 1e-9,
        "{a:?} {b:?}"
    );
}

/// A disk of mass m and polar inertia J, off centre by e, on a spring and a damper, driven by a torque: x, y, theta and their
/// rates.
#[derive(Clone)]
struct Jeffcott {
    m: f64,
    e: f64,
    k: f64,
    c: f64,
    j: f64,
    torque: f64,
}

impl System<f64, Vector6<f64>> for Jeffcott {
    fn system(&self, _: f64, s: &Vector6<f64>, d: &mut Vector6<f64>) {
        let Self { m, e, k, c, j, torque } = *self;
        let (sin, cos) = s[2].sin_cos();
        let w = s[5];
        let ax = (-k * s[0] - c * s[3]) / m + e * w * w * cos;
        let ay = (-k * s[1] - c * s[4]) / m + e * w * w * sin;
        // the disk's own acceleration e alpha taken out of the moment of the springs
        let alpha = (torque - m * e * (ay * cos - ax * sin)) / j;
        for i in 0..3 {
            d[i] = s[3 + i];
        }
        (d[3], d[4], d[5]) = (ax + e * alpha * sin, ay - e * alpha * cos, alpha);
    }
}

/// The Sommerfeld effect: a weak motor hangs at the critical speed (100 rad/s), a stronger one passes; speeds as those of an
/// independent integration.
#[test]
fn a_weak_motor_stalls_at_the_critical_speed() {
    let (j, until) = (2e-4, 2.0);
    let mut last = Vec::new();
    for torque in [0.02, 0.08] {
        let set = json!({
            "materials.light.rho": 1e-3,
            "disks.0.polar_inertia": j, "disks.0.diametral_inertia": j / 2.0,
            "spinup": {
                "torque": [{ "speed": 0, "torque": torque }], "until": until, "rtol": 1e-6, "atol": 1e-9, "output": 21
            }
        });
        let found = run(&with(&fieldtest("steady_orbit_on_damped_bearings"), set));
        let history = found.history.as_ref().expect("history");
        let own = Jeffcott { m: 1.0, e: 5e-4, k: 1e4, c: 10.0, j, torque };
        let step = until / 20.0;
        // a step further: the last output of the solver is not a dense one
        let mut solver = Dopri5::from_param(
            own,
            0.0,
            until + step,
            step,
            Vector6::zeros(),
            1e-10,
            1e-12,
            0.9,
            0.0,
            0.2,
            10.0,
            until,
            1e-5,
            1_000_000,
            1000,
            OutputType::Dense,
        );
        solver.integrate().expect("integrated");
        for (k, (t, speed)) in history.time_s.iter().zip(&history.speed_rad_s).enumerate() {
            let at = solver.x_out().iter().position(|x| (x - t).abs() < 1e-9).expect("a time of both");
            let right = solver.y_out()[at][5];
            assert!((speed - right).abs() < 2e-3 * right.abs().max(1.0), "{torque} at {k}: {speed} {right}");
            let given = history.drive_torque_n_m[k];
            assert!((given - torque).abs() < 1e-3 * torque, "{torque} at {k}: {given}");
        }
        assert!(found.energy.expect("energy").relative_error.abs() < 1e-4);
        last.push(history.speed_rad_s[20]);
    }
    assert!(last[0] < 100.0 && last[1] > 200.0, "{last:?}");
}

/// A rigid rotor under a motor's torque T0 (1 - w/w0) reaches `w0 (1 - exp(-T0 t / (J w0)))`, over meshes.
#[test]
fn a_motor_runs_a_rotor_up() {
    for elements in [2, 20] {
        let (strength, fastest) = (20.0, 150.0);
        let set = json!({ "shaft.segments.0.elements": elements });
        let found = run(&with(
            &stiff(json!({
                "torque": [{ "speed": 0, "torque": strength }, { "speed": fastest, "torque": 0 }],
                "until": 0.2, "rtol": 1e-5, "output": 11
            })),
            set,
        ));
        let history = found.history.as_ref().expect("history");
        for (t, speed) in history.time_s.iter().zip(&history.speed_rad_s) {
            let right = fastest * (1.0 - (-strength * t / (inertia() * fastest)).exp());
            assert!((speed - right).abs() < 1e-3 * fastest, "{elements} at {t}: {speed} {right}");
        }
    }
}

/// Without a torque, friction in a ring takes the speed of a rotor that a force presses against it: it takes the energy.
#[test]
fn friction_runs_a_rotor_down() {
    let set = json!({
        "loads": [{ "at": 0.2, "force": [0, -100, 0] }],
        "disks.0.offset": [0, 0],
        "supports.0.damping": 200, "supports.1.damping": 200,
        "spinup": {
            "torque": [{ "speed": 0, "torque": 0 }], "start_speed": 50, "until": 0.6, "atol": 1e-9, "rtol": 1e-5, "output": 31,
            "stators": [{ "at": 0.2, "clearance": 1e-3, "stiffness": 1e6, "friction": 0.1 }]
        }
    });
    let found = run(&with(&fieldtest("steady_orbit_on_damped_bearings"), set));
    let history = found.history.as_ref().expect("history");
    let (first, last) = (history.speed_rad_s[0], history.speed_rad_s[30]);
    assert!(first == 50.0 && last.abs() < 1.0, "{first} {last}");
    let energy = found.energy.expect("energy");
    // 2.5 J of rotation, and a share of what the force gave
    assert!(energy.friction_j.is_some_and(|f| f > 2.4) && energy.drive_work_j.abs() < 1e-4, "{energy:?}");
    assert!(energy.relative_error.abs() < 1e-3, "{energy:?}");
}

/// A run may start at speed from the steady state there: nothing moves.
#[test]
fn a_start_at_speed_is_steady() {
    let set = json!({
        "spinup": { "drive": [{ "until": 0.2, "speed": 80 }], "start_speed": 80, "rtol": 1e-7, "output": 5 },
        "probes": [{ "name": "disk", "at": 0.2, "y": 0 }]
    });
    let found = run(&with(&fieldtest("steady_orbit_on_damped_bearings"), set));
    let path = &found.history.as_ref().expect("history").probes["disk"];
    let size = path[0][1].hypot(path[0][2]);
    assert!((size / 8.6772e-4 - 1.0).abs() < 2e-3, "{size}");
    for u in path {
        assert!((u[1] - path[0][1]).hypot(u[2] - path[0][2]) < 1e-6 * size, "{u:?} {:?}", path[0]);
    }
}

#[test]
fn drives_that_do_not_go_together_are_refused() {
    let refused = |spinup: Value, path: &str, words: &str| {
        let case = stiff(spinup);
        let text = rotor::model::Model::new(&case).expect_err("refused").to_string();
        assert!(text.contains(path) && text.contains(words), "{text}");
    };
    let torque = json!([{ "speed": 0, "torque": 5 }]);
    let ramp = json!([{ "until": 1, "speed": 5 }]);
    refused(json!({ "torque": torque, "drive": ramp, "until": 1 }), "spinup.torque", "speed and a torque");
    refused(json!({ "torque": torque }), "spinup.torque", "until");
    refused(json!({ "torque": torque, "until": 1, "frame": "inertial" }), "spinup.frame", "rotating");
    refused(json!({ "torque": torque, "until": 1, "steady": true }), "spinup.steady", "over time");
    refused(
        json!({ "drive": ramp, "start_speed": 5, "frame": "inertial" }),
        "spinup.start_speed",
        "rotating",
    );
    refused(
        json!({ "torque": [{ "speed": 5, "torque": 5 }, { "speed": 5, "torque": 4 }], "until": 1 }),
        "spinup.torque.1.speed",
        "ascend",
    );
    refused(json!({}), "spinup.drive", "no phase");
}
