//! Spin-up: frames, integrators, energies and torques against each other and against closed forms.

use crate::common::{model, shaft, with};
use rotor::analysis::Outcome;
use rotor::analysis::spinup::spinup;
use rotor::case::LoadedCase;
use rotor::error::Error;
use rotor::results::{History, Spinup};
use serde_json::{Value, json};

fn run(case: &LoadedCase) -> Outcome<Spinup> {
    attempt(case).unwrap_or_else(|e| panic!("{e}"))
}

fn attempt(case: &LoadedCase) -> Result<Outcome<Spinup>, Error> {
    let model = model(case);
    spinup(&model, model.spinup.as_ref().expect("spinup"), &|_, _| true)
}

fn history(outcome: &Outcome<Spinup>) -> &History {
    outcome.results.history.as_ref().expect("history")
}

/// A short shaft with an unbalanced disk and gravity, run up to 200 rad/s in 0.1 s.
fn unbalanced(section: &str, more: Value) -> LoadedCase {
    let base = shaft(
        json!({ "shape": "circle", "radius": 0.02 }),
        1.0,
        2,
        json!({
            "disks": [{ "at": 0.5, "mass": 20, "polar_inertia": 0.2, "diametral_inertia": 0.1, "offset": [0.003, 0] }],
            "supports": [{ "at": 0, "kind": "revolute", "section": section },
                         { "at": 1, "kind": "cylindrical", "section": section, "driven": section == "rigid" }],
            "gravity": [0, -9.81, 0],
            "probes": [{ "name": "rim", "at": 0.5, "y": 0.02 }],
            "spinup": { "drive": [{ "until": 0.1, "speed": 200 }], "until": 0.15, "rtol": 3e-7, "atol": 3e-10, "output": 16 }
        }),
    );
    with(&base, more)
}

fn largest_difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let each = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs());
    each.fold(0.0, f64::max)
}

#[test]
#[ignore = "long"]
fn both_frames_tell_the_same_story() {
    for section in ["plane", "rigid"] {
        let rotating = run(&unbalanced(section, json!({})));
        let inertial = run(&unbalanced(section, json!({ "spinup.frame": "inertial" })));
        let (a, b) = (history(&rotating), history(&inertial));
        let size = a.mid_span_m.iter().flatten().fold(0.0, |m: f64, u| m.max(u.abs()));
        assert!(size > 1e-4, "{section}: {size}");
        let difference = largest_difference(&a.mid_span_m, &b.mid_span_m);
        assert!(difference < 1e-4 * size, "{section} orbit {difference:e} of {size:e}");
        let difference = largest_difference(&a.probes["rim"], &b.probes["rim"]);
        assert!(difference < 1e-4 * size, "{section} rim {difference:e} of {size:e}");
        let torque = a.drive_torque_n_m.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
        for (a, b) in a.drive_torque_n_m.iter().zip(&b.drive_torque_n_m) {
            assert!((a - b).abs() < 2e-3 * torque, "{section} torque {a} {b} of {torque}");
        }
        for (path, forces) in &a.reactions_n {
            let size = forces.iter().flatten().fold(0.0, |m: f64, f| m.max(f.abs()));
            let difference = largest_difference(forces, &b.reactions_n[path]);
            assert!(difference < 2e-2 * size, "{section} {path} {difference:e} of {size:e}");
        }
    }
}

#[test]
fn energy_is_balanced_without_numerical_damping() {
    let tight = run(&unbalanced("rigid", json!({ "spinup.rtol": 1e-8, "spinup.atol": 1e-11 })));
    let energy = tight.results.energy.as_ref().expect("energy");
    assert!(energy.drive_work_j > 1.0 && energy.relative_error.abs() < 1e-6, "{energy:?}");
    // generalized-alpha without numerical damping: second order in the step
    let error = |step: f64| {
        let set = json!({ "spinup.integrator": "generalized-alpha", "spinup.rho_infinity": 1.0, "spinup.step": step,
                          "spinup.rtol": 1e-10, "spinup.atol": 1e-13 });
        run(&unbalanced("rigid", set)).results.energy.as_ref().expect("energy").relative_error.abs()
    };
    assert!(error(5e-5) < 1e-6, "{:e}", error(5e-5));
    // and with it the loss is told: a short ramp excites fast vibrations, which numerical damping absorbs
    let lost = |rho: f64| {
        let set = json!({ "spinup.integrator": "generalized-alpha", "spinup.rho_infinity": rho, "spinup.step": 2.5e-4,
                          "spinup.drive.0.until": 0.02 });
        run(&unbalanced("rigid", set)).results.energy.as_ref().expect("energy").relative_error
    };
    assert!(lost(0.0) > 0.0 && lost(0.0) > 3.0 * lost(1.0).abs(), "{:e} {:e}", lost(0.0), lost(1.0));
}

#[test]
fn integrators_converge_with_their_order() {
    let set = |integrator: &str, step: f64| json!({ "spinup.integrator": integrator, "spinup.step": step, "spinup.rtol": 1e-8, "spinup.atol": 1e-11 });
    let exact = run(&unbalanced("rigid", json!({ "spinup.rtol": 1e-9, "spinup.atol": 1e-12 })));
    let exact = history(&exact);
    for (integrator, coarse, order) in [("esdirk", 2.5e-3, 4.0), ("generalized-alpha", 2.5e-4, 2.0)] {
        let error = |step: f64| {
            let run = run(&unbalanced("rigid", set(integrator, step)));
            largest_difference(&history(&run).mid_span_m, &exact.mid_span_m)
        };
        let slope = (error(coarse) / error(coarse / 2.0)).log2();
        assert!((slope - order).abs() < 0.45, "{integrator}: {slope}, {:e}", error(coarse));
    }
}

/// Steady whirl of a rigid rotor on isotropic bearings: `r = e W^2 / |k/m - W^2 + i c W/m|`.
#[test]
fn an_unbalanced_rotor_on_bearings_whirls_as_jeffcott_says() {
    let (k, c, mass, e, speed) = (2e5, 1600.0, 40.0, 1e-4, 120.0);
    let law = |v: f64| json!([[v / 2.0, 0.0], [0.0, v / 2.0]]);
    for (frame, rtol) in [("rotating", 1e-5), ("inertial", 1e-4)] {
        let case = shaft(
            json!({ "shape": "circle", "radius": 0.05 }),
            0.4,
            2,
            json!({
                "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 1e-3 } },
                "disks": [{ "at": 0.2, "mass": mass, "polar_inertia": 0.8, "diametral_inertia": 0.4, "offset": [e, 0] }],
                "supports": [
                    { "at": 0, "kind": "bearing", "stiffness": law(k), "damping": law(c) },
                    { "at": 0.4, "kind": "bearing", "stiffness": law(k), "damping": law(c) },
                    { "at": 0.2, "fix": ["r.x", "y.z"] }
                ],
                "spinup": { "drive": [{ "until": 0.2, "speed": speed }], "until": 0.7, "output": 71, "frame": frame,
                            "rtol": rtol, "atol": 1e-3 * rtol }
            }),
        );
        let outcome = run(&case);
        let end = history(&outcome).mid_span_m.last().copied().expect("end");
        let radius = end[1].hypot(end[2]);
        let (a, b) = (k / mass - speed * speed, c * speed / mass);
        let exact = e * speed * speed / a.hypot(b);
        assert!((radius / exact - 1.0).abs() < 5e-3, "{radius:e} {exact:e}");
        let energy = outcome.results.energy.as_ref().expect("energy");
        assert!(energy.bearings_j > 0.0 && energy.relative_error.abs() < 1e-4, "{energy:?}");
    }
}

/// External damping at constant speed takes the torque `alpha J_p Omega`; material damping none, but it absorbs.
#[test]
fn damping_takes_torque_and_energy() {
    let damped = |damping: Value| {
        let case = shaft(
            json!({ "shape": "circle", "radius": 0.05 }),
            1.0,
            2,
            json!({
                "materials": { "m": { "damping": damping } },
                "supports": [{ "at": 0, "kind": "revolute" }, { "at": 1, "kind": "cylindrical" }],
                "spinup": { "drive": [{ "until": 0.2, "speed": 300 }], "until": 0.4, "rtol": 1e-6, "atol": 1e-10, "output": 41 }
            }),
        );
        run(&case)
    };
    let outcome = damped(json!({ "mass": 2.0 }));
    let polar = 7800.0 * std::f64::consts::PI * 0.05f64.powi(4) / 2.0;
    // work, not torque: a torque swings with the vibrations that the end of the ramp, or rounding, leaves
    let spun = polar * 300.0 * 300.0 / 2.0;
    // of w (1 - cos(pi t / T)) / 2 the mean square over the ramp is 3/8 w^2
    let dissipated = 2.0 * polar * 300.0 * 300.0 * (0.375 * 0.2 + 0.2);
    let energy = outcome.results.energy.as_ref().expect("energy");
    assert!((energy.external_damping_j / dissipated - 1.0).abs() < 1e-5, "{energy:?} {dissipated}");
    assert!((energy.drive_work_j / (spun + dissipated) - 1.0).abs() < 1e-5, "{energy:?} {spun}");
    assert!(energy.relative_error.abs() < 1e-5, "{energy:?}");
    // angular momentum J_p Omega
    let momentum = history(&outcome).angular_momentum_kg_m2_s.last().copied().expect("end");
    assert!((momentum / (polar * 300.0) - 1.0).abs() < 1e-5);
    let outcome = damped(json!({ "stiffness": 1e-4 }));
    let energy = outcome.results.energy.as_ref().expect("energy");
    assert!(energy.material_damping_j >= 0.0 && energy.relative_error.abs() < 1e-6, "{energy:?}");
    let torque = history(&outcome).drive_torque_n_m.last().copied().expect("end");
    assert!(torque.abs() < 0.1, "{torque}");
}

/// Growth of long solid cylinders within 0.5 % of the closed form; tubes by order within the error of a polynomial.
#[test]
fn long_bodies_grow_as_the_closed_form_says() {
    let growth = |section: Value, member: &str| {
        let case = shaft(
            section,
            4.0,
            8,
            json!({
                "shaft": { "element": member },
                "supports": [{ "at": 0, "kind": "revolute" }, { "at": 4, "kind": "cylindrical" }],
                "spinup": { "drive": [{ "until": 1, "speed": 200 }], "steady": true }
            }),
        );
        let outcome = run(&case);
        let warned = outcome.diagnostics.iter().any(|d| d.code == "hollow-growth");
        (
            outcome.results.last.growth_m[0] / outcome.results.last.closed_form_growth_m.expect("circle")
                - 1.0,
            warned,
        )
    };
    for member in ["34X3", "34X4", "34X5"] {
        let (error, warned) = growth(json!({ "shape": "circle", "radius": 0.2 }), member);
        assert!(error.abs() < 5e-3 && !warned, "{member} {error}");
    }
    for (inner, cubic) in [(0.15, -0.139), (0.1, -0.26)] {
        let tube = json!({ "shape": "tube", "outer_radius": 0.2, "inner_radius": inner });
        let (error, warned) = growth(tube.clone(), "34X3");
        assert!((error - cubic).abs() < 5e-3 && warned, "{inner} {error}");
        let (error, _) = growth(tube, "34X5");
        assert!(error.abs() < if inner == 0.15 { 0.01 } else { 0.13 }, "{inner} 34X5 {error}");
    }
}

#[test]
fn hard_cases_end_with_a_reason() {
    // burst: a soft shaft far beyond its strength
    let soft = shaft(
        json!({ "shape": "circle", "radius": 0.1 }),
        1.0,
        2,
        json!({
            "materials": { "m": { "E": 1e6, "rho": 2000 } },
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 1, "kind": "cylindrical" }],
            "spinup": { "drive": [{ "until": 0.1, "speed": 3000 }] }
        }),
    );
    let error = attempt(&soft).expect_err("burst");
    assert_eq!(error.exit_code(), 1);
    let text = error.to_string();
    assert!(text.contains("no stable equilibrium at 3000") && text.contains("it is lost at"), "{text}");
    // more steps than allowed: told early
    let long = unbalanced("rigid", json!({ "spinup.step": 1e-6, "spinup.max_steps": 1000 }));
    let text = attempt(&long).expect_err("steps").to_string();
    assert!(text.contains("would take about 1.5e5 steps") && text.contains("max_steps"), "{text}");
    // an interrupted run keeps what is done
    let case = unbalanced("rigid", json!({}));
    let model = model(&case);
    let outcome =
        spinup(&model, model.spinup.as_ref().expect("spinup"), &|share, _| share < 0.5).expect("partial");
    assert!(!outcome.results.complete && outcome.diagnostics.iter().any(|d| d.code == "interrupted"));
    let last = history(&outcome).time_s.last().copied().expect("times");
    assert!(last > 0.02 && last < 0.15, "{last}");
}

/// The steady state and the end of a slow ramp agree; micrometres and metres too.
#[test]
fn the_end_of_a_ramp_is_the_steady_state() {
    let case = crate::common::case("table9-spin-ellipse");
    let ramp = run(&with(&case, json!({ "shaft.segments.0.elements": 4 })));
    let steady = run(&with(&case, json!({ "shaft.segments.0.elements": 4, "spinup.steady": true })));
    for i in 0..2 {
        let (a, b) = (ramp.results.last.growth_m[i], steady.results.last.growth_m[i]);
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }
    // from rest to rest nothing remains
    let there_and_back = json!({ "shaft.segments.0.elements": 2, "spinup.drive": [{ "until": 0.5, "speed": 100 }, { "until": 1.0, "speed": 0 }] });
    let outcome = run(&with(&case, there_and_back));
    let growth = outcome.results.last.growth_m;
    assert!(growth[1].abs() < 1e-3 * steady.results.last.growth_m[1], "{growth:?}");
}

/// Timoshenko beams with a drive that only turns: the axis at mid-length reaches 1.34e-6 m on bearings. Driven ends that hold the
/// axis give 4.5e-8 m.
#[test]
fn a_drive_that_only_turns_leaves_a_rotor_on_its_bearings() {
    // the oracle is a beam, whose joints are as stiff as shared functions make them
    let case = with(&crate::common::fieldtest("turbocharger_runup"), json!({ "shaft.element": "autok0" }));
    // without the component that turns the end
    let bearings = case.value["supports"].as_array().expect("supports")[..2].to_vec();
    let case = with(&case, json!({ "supports": bearings }));
    let undriven = rotor::model::Model::new(&case).unwrap_err().to_string();
    assert!(undriven.contains("\"driven_at\""), "{undriven}");
    let run = run(&with(&case, json!({ "spinup.driven_at": 0 })));
    let radius = run.results.extremes.as_ref().expect("transient").radius_m;
    assert!((radius / 1.34e-6 - 1.0).abs() < 0.02, "{radius:e}");
}

/// The drive's torque on a shaft free on bearings is `J dOmega/dt`, in both frames, wherever it turns the shaft.
#[test]
fn a_drive_that_only_turns_gives_the_torque_of_inertia() {
    let law = json!([[1e7, 0], [0, 1e7]]);
    // a balanced shaft does not move: atol alone speaks
    for (at, frame, atol) in [(0.0, "rotating", 1e-10), (0.5, "rotating", 1e-10), (0.3, "inertial", 1e-6)] {
        let case = shaft(
            json!({ "shape": "circle", "radius": 0.03 }),
            1.0,
            4,
            json!({
                "supports": [{ "at": 0, "kind": "bearing", "stiffness": law }, { "at": 1, "kind": "bearing", "stiffness": law }],
                "disks": [{ "at": 0.5, "mass": 20, "polar_inertia": 0.2, "diametral_inertia": 0.15 }],
                "spinup": { "drive": [{ "until": 0.5, "speed": 100 }], "driven_at": at, "frame": frame, "output": 51,
                            "rtol": 1e-6, "atol": atol }
            }),
        );
        let outcome = run(&case);
        let inertia = 0.2 + 7800.0 * std::f64::consts::PI * 0.03f64.powi(4) / 2.0;
        let energy = outcome.results.energy.as_ref().expect("energy");
        assert!(
            (energy.drive_work_j / (inertia * 100.0 * 100.0 / 2.0) - 1.0).abs() < 1e-4,
            "{at} {energy:?}"
        );
        let peak = outcome.results.extremes.as_ref().expect("extremes").torque_n_m;
        let right = inertia * 100.0 * std::f64::consts::PI / (2.0 * 0.5);
        assert!((peak / right - 1.0).abs() < 2e-2, "{at} {frame}: {peak} {right}");
    }
}

/// Growth inside a rigid hub is none; the headline is read clear of it, where it is the closed form's.
#[test]
fn growth_is_read_clear_of_hubs() {
    let case = |disks: Value| {
        let more = json!({
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 4, "kind": "cylindrical" }],
            "disks": disks,
            "probes": [{ "name": "rim", "at": 1.0, "y": 0.2 }, { "name": "hub", "at": 2.0, "y": 0.2 }],
            "spinup": { "drive": [{ "until": 1, "speed": 200 }], "steady": true }
        });
        shaft(json!({ "shape": "circle", "radius": 0.2 }), 4.0, 16, more)
    };
    let hub = run(&case(json!([{ "at": 2.0, "mass": 100, "polar_inertia": 10, "diametral_inertia": 6 }])));
    let last = &hub.results.last;
    let exact = last.closed_form_growth_m.expect("circle");
    assert!((last.growth_at_m - 2.0).abs() >= 0.4 && last.growth_is_clear, "{}", last.growth_at_m);
    assert!((last.growth_m[0] / exact - 1.0).abs() < 1e-2, "{} {exact}", last.growth_m[0]);
    let growth = &hub.results.growth;
    let at = |x: f64| {
        growth.x_m.iter().position(|p| (p - x).abs() < 1e-9).map(|k| growth.rim_m[k][0]).expect("station")
    };
    assert!(at(2.0).abs() < 0.02 * exact, "{}", at(2.0));
    assert!(growth.largest_rim_m >= last.growth_m[0] && growth.bore_m.iter().all(Option::is_none));
    let probe = |name: &str| last.probes.iter().find(|p| p.name == name).expect("probe");
    let grown = |name: &str| probe(name).growth.expect("growth").rim_m[0];
    assert!((grown("rim") / exact - 1.0).abs() < 1e-2 && grown("hub").abs() < 0.02 * exact);
    assert!(probe("hub").point.as_ref().is_some_and(|p| p.in_rigid_hub));
    assert!(hub.diagnostics.iter().any(|d| d.code == "probe-in-hub" && d.message.contains("hub")));
    let bare = run(&case(json!([])));
    assert_eq!(bare.results.last.growth_at_m, 2.0);
    assert!(!bare.diagnostics.iter().any(|d| d.code == "probe-in-hub" || d.code == "growth-disturbed"));
}

/// On elements longer than the end effect of a hub the section functions swing over an element or two: the headline is
/// clear of that too, at every mesh.
#[test]
fn the_headline_is_clear_of_hubs_on_long_elements() {
    for elements in [8, 16, 32, 64] {
        let more = json!({
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 6, "kind": "cylindrical" }],
            "disks": [{ "at": 3.0, "mass": 70, "polar_inertia": 2.0, "diametral_inertia": 1.0 }],
            "spinup": { "drive": [{ "until": 1, "speed": 60 }], "steady": true }
        });
        let last =
            run(&shaft(json!({ "shape": "circle", "radius": 0.05 }), 6.0, elements, more)).results.last;
        let exact = last.closed_form_growth_m.expect("circle");
        let error = last.growth_m[0] / exact - 1.0;
        assert!(last.growth_is_clear && error.abs() < 3e-3, "{elements}: {error:e} at {}", last.growth_at_m);
    }
}

/// Rim and bore of a tube along the shaft against the closed form.
#[test]
fn the_bore_grows_along_a_tube() {
    let set = json!({ "spinup.steady": true, "shaft.element": "34R33" });
    let case = with(&crate::common::case("tube-growth"), set);
    let results = run(&case).results;
    let middle = results.last.growth_at_m;
    let k = results.growth.x_m.iter().position(|x| (x - middle).abs() < 1e-9).expect("station");
    // closed form of a long tube: 0.47778 and 0.51785 um
    let bore = results.growth.bore_m[k].expect("hollow")[0];
    assert!(
        (results.growth.rim_m[k][0] / 0.47778e-6 - 1.0).abs() < 2e-3
            && (bore / 0.51785e-6 - 1.0).abs() < 2e-3
    );
}
