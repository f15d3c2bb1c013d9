//! Loads on shafts that bend far, twist far and turn: against closed forms, and their derivatives.

use crate::common::{fieldtest, model, shaft, with};
use rotor::analysis::spinup::{fits, spinup};
use rotor::analysis::statics::statics;
use rotor::case::LoadedCase;
use rotor::results::{Spinup, Static};
use rotor::shaft::assembly::Assembly;
use rotor::shaft::internal_forces::{Forces, ScalarMass};
use rotor::shaft::loads::{Loads, Turned, Which};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn solve(case: &LoadedCase) -> Static {
    let outcome = statics(&model(case)).unwrap_or_else(|e| panic!("{e}"));
    assert!(outcome.results.converged, "{:?}", outcome.results.newton);
    outcome.results
}

fn run(case: &LoadedCase) -> Spinup {
    let model = model(case);
    let settings = model.spinup.as_ref().expect("spinup");
    spinup(&model, settings, &|_, _| true).unwrap_or_else(|e| panic!("{e}")).results
}

fn displacement(found: &Static, probe: &str) -> [f64; 3] {
    let probe = found.probes.iter().find(|p| p.name == probe).expect("probe");
    probe.point.as_ref().expect("point").displacement_m
}

/// A clamped shaft of radius r and length 1 m with probes at its free end.
fn cantilever(r: f64, elements: usize, element: &str, more: Value) -> LoadedCase {
    let base = shaft(
        json!({ "shape": "circle", "radius": r }),
        1.0,
        elements,
        json!({
            "supports": [{ "at": 0, "kind": "clamped" }],
            "probes": [{ "name": "axis", "at": 1.0, "y": 0 }, { "name": "rim", "at": 1.0, "y": r }],
            "static": { "load_steps": 1, "max_iterations": 100 }
        }),
    );
    with(&with(&base, json!({ "shaft.element": element })), more)
}

const E: f64 = 2.1e11;
const G: f64 = E / 2.6;

fn second_moment(r: f64) -> f64 {
    PI * r.powi(4) / 4.0
}

/// A torque twists by `M L / (G J)`, however far: 45 degrees (a rotor from outside) and 90 degrees, over meshes.
#[test]
fn a_torque_twists_as_far_as_it_should() {
    let outside = solve(&fieldtest("static_torque_45_degrees"));
    let [_, y, z] = displacement(&outside, "a");
    let angle = z.atan2(0.005 + y).to_degrees();
    assert!((angle - 45.0).abs() < 5e-3, "{angle}");
    let r = 0.005;
    let torque = G * 2.0 * second_moment(r) * PI / 2.0;
    for elements in [2, 10] {
        let loads = json!({ "loads": [{ "at": 1, "moment": [torque, 0, 0] }], "static.load_steps": 4 });
        let [_, y, z] = displacement(&solve(&cantilever(r, elements, "34X3", loads)), "rim");
        let angle = z.atan2(r + y).to_degrees();
        // an untwisted fibre grows by (r theta)^2 / 2 L^2 = 3e-5
        assert!((angle - 90.0).abs() < 1e-2, "{elements}: {angle}");
    }
}

/// An end moment about axes fixed in space bends a shaft into an arc of curvature `M / (E I)`, whatever the angle: the tip is
/// where the arc ends, with an error that falls with the mesh; a dead moment stays behind.
#[test]
fn a_shaft_rolls_up_to_a_full_circle() {
    let r = 0.004;
    let rolled = |turn: f64, elements: usize, element: &str, dead: bool| {
        let moment = E * second_moment(r) * turn;
        let steps = (turn / 0.35).ceil() as usize;
        let loads = json!({
            "loads": [{ "at": 1, "moment": [0, 0, moment], "dead": dead }], "static.load_steps": steps
        });
        let [x, y, _] = displacement(&solve(&cantilever(r, elements, element, loads)), "axis");
        let arc = [turn.sin() / turn - 1.0, (1.0 - turn.cos()) / turn];
        (x - arc[0]).hypot(y - arc[1])
    };
    // the law of the material changes the stiffness by about (r kappa)^2: 6e-4 at a full circle
    let errors = [6, 12].map(|n| rolled(2.0 * PI, n, "34X3", false));
    assert!(errors[1] < 2e-3, "{errors:?}");
    let order = (errors[0] / errors[1]).log2();
    assert!(order > 4.0, "order {order}: {errors:?}");
    for element in ["34X2", "34X4"] {
        assert!(rolled(PI / 2.0, 4, element, false) < 2e-3, "{element}");
    }
    assert!(rolled(PI / 6.0, 8, "34X3", true) > 2e-2 && rolled(PI / 6.0, 8, "34X3", false) < 1e-3);
}

/// A moment turns a shaft in any direction alike, on a step, and beside an element 1000 times shorter.
#[test]
fn a_moment_bends_alike_on_all_meshes() {
    let r = 0.01;
    let moment = E * second_moment(r);
    let tip = |segments: Value, m: [f64; 3]| {
        let set = json!({ "shaft.segments": segments, "loads": [{ "at": 1, "moment": m }], "static.load_steps": 4 });
        displacement(&solve(&cantilever(r, 8, "34X3", set)), "axis")
    };
    let part = |length: f64, elements: usize| json!({ "length": length, "elements": elements, "section": "s", "material": "m" });
    let arc = [1.0_f64.sin() - 1.0, 1.0 - 1.0_f64.cos()];
    for segments in [
        json!([part(1.0, 10)]),
        json!([part(1.0, 40)]),
        json!([part(0.9, 9), part(1e-4, 1), part(0.0999, 1)]),
    ] {
        let [x, y, z] = tip(segments.clone(), [0.0, 0.0, moment]);
        assert!((x - arc[0]).hypot(y - arc[1]) < 1e-3 && z.abs() < 1e-9, "{x} {y} {z}");
        let [x, y, z] = tip(segments, [0.0, -moment, 0.0]);
        assert!((x - arc[0]).hypot(z - arc[1]) < 1e-3 && y.abs() < 1e-9, "{x} {y} {z}");
    }
}

/// A moment that follows keeps bending about the section's own axis: after a twist by a quarter turn it bends the other plane.
#[test]
fn a_following_moment_turns_with_its_section() {
    let r = 0.005;
    let torque = G * 2.0 * second_moment(r) * PI / 2.0;
    let bend = E * second_moment(r) * 0.02;
    let tip = |follower: bool| {
        let loads = json!({
            "loads": [{ "at": 1, "moment": [torque, 0, 0] }, { "at": 1, "moment": [0, 0, bend], "follower": follower }],
            "static.load_steps": 8
        });
        displacement(&solve(&cantilever(r, 8, "34X3", loads)), "axis")
    };
    let (fixed, follows) = (tip(false), tip(true));
    // a torque fixed in space of this size bends with the deflection, by the same factor in both; about z: up, about y: to -z
    let angle = |a: [f64; 3]| a[2].atan2(a[1]).to_degrees();
    let turned = (angle(follows) - angle(fixed)).rem_euclid(360.0);
    assert!((turned - 90.0).abs() < 1.0, "{fixed:?} {follows:?} {turned}");
}

/// Planar bodies and shafts understand a moment alike: both bend into the same arc.
#[test]
fn planar_bodies_and_shafts_agree_on_a_moment() {
    let (side, turn): (f64, f64) = (0.02, 1.2);
    let moment = E * side.powi(4) / 12.0 * turn;
    let material = json!({ "m": { "E": E, "nu": 0, "rho": 7800 } });
    let section = json!({ "s": { "shape": "rectangle", "height": side, "width": side } });
    let arc = [f64::sin(turn) / turn - 1.0, (1.0 - f64::cos(turn)) / turn];
    let more = json!({
        "sections": section, "materials": material, "loads": [{ "at": 1, "moment": [0, 0, moment] }],
        "static.load_steps": 4
    });
    let [x, y, _] = displacement(&solve(&cantilever(side / 2.0, 16, "34X3", more)), "axis");
    assert!((x - arc[0]).hypot(y - arc[1]) < 1e-3, "{x} {y} {arc:?}");
    let scene = json!({
        "title": "cantilever",
        "materials": material,
        "sections": section,
        "bodies": [{
            "name": "beam", "length": 1, "elements": 32, "section": "s", "material": "m",
            "start": [0, 0], "supports": [{ "at": 0, "kind": "clamped" }], "loads": [{ "at": 1, "moment": moment }]
        }],
        "contact": { "method": "penalty", "load_steps": 4 }
    });
    let loaded = LoadedCase::from_value("scene.json", scene).unwrap_or_else(|e| panic!("{e}"));
    let scene = rotor::model::scene::Scene::new(&loaded).unwrap_or_else(|e| panic!("{e}"));
    let found = rotor::analysis::contact::contact(&scene, &|_, _| true).unwrap_or_else(|e| panic!("{e}"));
    let [x, y, _] = found.results.bodies[0].end_displacement_m;
    assert!((x - arc[0]).hypot(y - arc[1]) < 2e-3, "{x} {y} {arc:?}");
}

/// Derivatives of all forces that depend on the place, against differences; a section of unlike axes, a bore, steps.
#[test]
fn tangents_are_the_derivatives_of_the_forces() {
    for (section, element) in [
        (json!({ "shape": "ellipse", "semi_axis_y": 0.1, "semi_axis_z": 0.15 }), "34X3"),
        (json!({ "shape": "tube", "outer_radius": 0.15, "inner_radius": 0.05 }), "34R33"),
        (json!({ "shape": "rectangle", "height": 0.2, "width": 0.3 }), "34X2"),
    ] {
        let surface = if element == "34R33" { "bore" } else { "top" };
        let base = shaft(
            section,
            1.0,
            2,
            json!({
                "supports": [{ "at": 0, "kind": "clamped" }],
                "loads": [
                    { "at": 1, "moment": [1e3, 2e3, -3e3] },
                    { "at": 0.5, "moment": [2e3, -1e3, 1e3], "follower": true },
                    { "at": 1, "force": [1e3, -2e3, 2e3], "follower": true },
                    { "surface": "rim", "pressure": 1e6 },
                    { "surface": surface, "traction": [1e5, 2e5, -1e5], "follower": true }
                ]
            }),
        );
        let case = with(&base, json!({ "shaft.element": element }));
        let model = model(&case);
        let assembly = Assembly::new(&model);
        let forces = Forces::new(&assembly).expect("forces");
        let loads = Loads::new(&model, &assembly.numbering, &ScalarMass::new(&model), Which::All);
        let wave = |i: usize, k: f64| 0.02 * (k * i as f64 + 0.3).sin();
        let q: Vec<f64> = forces.reference().iter().enumerate().map(|(i, q)| q + wave(i, 1.7)).collect();
        let way: Vec<f64> = (0..q.len()).map(|i| wave(i, 2.3)).collect();
        let axes = Turned { sin: 0.6, cos: 0.8 };
        let at = |h: f64| {
            let q: Vec<f64> = q.iter().zip(&way).map(|(q, d)| q + h * d).collect();
            let mut f = vec![0.0; q.len()];
            loads.add(&q, axes, 1.0, &mut f);
            f
        };
        let h = 1e-4;
        let (ahead, behind) = (at(h), at(-h));
        let mut exact = vec![0.0; q.len()];
        for part in loads.tangents(&q, axes) {
            for (i, &row) in part.coordinates.iter().enumerate() {
                for (j, &column) in part.coordinates.iter().enumerate() {
                    exact[row] += part.matrix[(i, j)] * way[column];
                }
            }
        }
        let size = exact.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        for i in 0..q.len() {
            let difference = (ahead[i] - behind[i]) / (2.0 * h);
            assert!((difference - exact[i]).abs() < 1e-6 * size, "{element} {i}: {difference} {}", exact[i]);
        }
    }
}

/// A moment does the work m . theta' on a turning rigid section, and a pressure on a closed surface none on a rigid motion but
/// that of its ends.
#[test]
fn power_of_loads_on_rigid_motions() {
    let case = shaft(
        json!({ "shape": "ellipse", "semi_axis_y": 0.1, "semi_axis_z": 0.15 }),
        1.0,
        2,
        json!({ "loads": [{ "at": 1, "moment": [100, 200, -300] }, { "surface": "rim", "pressure": 1e6 }] }),
    );
    let model = model(&case);
    let assembly = Assembly::new(&model);
    let q = Forces::new(&assembly).expect("forces").reference();
    let loads = Loads::new(&model, &assembly.numbering, &ScalarMass::new(&model), Which::All);
    let spin = [0.3, -0.5, 0.7];
    let turning: Vec<f64> = q
        .chunks_exact(3)
        .flat_map(|v| {
            [
                spin[1] * v[2] - spin[2] * v[1],
                spin[2] * v[0] - spin[0] * v[2],
                spin[0] * v[1] - spin[1] * v[0],
            ]
        })
        .collect();
    let powers = loads.powers(&q, &turning, Turned { sin: 0.0, cos: 1.0 });
    let right = 100.0 * spin[0] + 200.0 * spin[1] - 300.0 * spin[2];
    assert!((powers[0].1 / right - 1.0).abs() < 1e-12, "{powers:?}");
    assert!(powers[1].1.abs() < 1e-6, "{powers:?}");
}

/// A rim under pressure shrinks as a long body does, however it turns: `(1 - nu) p R / E` at the rim, stretching by `2 nu p / E`.
#[test]
fn pressure_turns_with_the_surface() {
    let found = run(&with(
        &fieldtest("pressure_on_turning_rim"),
        json!({ "spinup.rtol": 1e-6, "spinup.atol": 1e-12 }),
    ));
    let history = found.history.as_ref().expect("history");
    let right = -0.7 * 1e7 * 0.02 / E;
    for (growth, t) in history.growth_m.iter().zip(&history.time_s) {
        assert!(
            (growth[0] / right - 1.0).abs() < 2e-3 && (growth[1] / right - 1.0).abs() < 2e-3,
            "{t}: {growth:?} {right}"
        );
    }
    // J alpha: the largest acceleration of a half cosine is pi / 2 times the mean
    let inertia = 7800.0 * PI * 0.02_f64.powi(4) / 2.0 * 0.5;
    let largest = inertia * 20.0 / 0.5 * PI / 2.0;
    let torque = history.drive_torque_n_m.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
    assert!((torque / largest - 1.0).abs() < 1e-2, "{torque} {largest}");
    let energy = found.energy.expect("energy");
    assert!(energy.relative_error.abs() < 1e-3, "{energy:?}");
}

/// Bending by a moment about an axis fixed in space stays where it is while the shaft turns under it.
#[test]
fn a_moment_in_space_stays_there() {
    let found = run(&fieldtest("bending_moment_on_turning_shaft"));
    let history = found.history.as_ref().expect("history");
    // M x^2 / (2 E I) at 0.25 m
    let right = 50.0 * 0.25 * 0.25 / (2.0 * E * second_moment(0.02));
    for u in &history.mid_span_m {
        assert!((u[1] / right - 1.0).abs() < 1e-3 && u[2].abs() < 1e-4 * right, "{u:?} {right}");
    }
}

/// A load torque on a driven shaft: the drive gives `-M + J alpha`, and their works are the kinetic energy.
#[test]
fn a_load_torque_is_met_by_the_drive() {
    let more = json!({
        "supports": [{ "at": 0, "kind": "revolute" }, { "at": 1, "kind": "cylindrical", "driven": false }],
        "loads": [{ "at": 1, "moment": [-40, 0, 0] }],
        "spinup": { "drive": [{ "until": 0.5, "speed": 100 }], "until": 1.0, "rtol": 1e-7, "atol": 1e-11, "output": 41 }
    });
    let found = run(&shaft(json!({ "shape": "circle", "radius": 0.05 }), 1.0, 2, more));
    let history = found.history.as_ref().expect("history");
    let inertia = 7800.0 * PI * 0.05_f64.powi(4) / 2.0;
    for (k, t) in history.time_s.iter().enumerate() {
        let alpha = if *t < 0.5 { 100.0 / 0.5 * PI / 2.0 * (PI * t / 0.5).sin() } else { 0.0 };
        let right = 40.0 + inertia * alpha;
        assert!(
            (history.drive_torque_n_m[k] - right).abs() < 0.02 * right,
            "{t}: {} {right}",
            history.drive_torque_n_m[k]
        );
        let power = history.load_power_w["loads.0"][k];
        assert!((power + 40.0 * history.speed_rad_s[k]).abs() < 2.0, "{t}: {power}");
    }
    let energy = found.energy.as_ref().expect("energy");
    let turned = 100.0 * 0.25 + 100.0 * 0.5;
    let load = energy.load_work_j.expect("work of the load");
    assert!((load / (-40.0 * turned) - 1.0).abs() < 1e-5, "{energy:?}");
    assert!(energy.relative_error.abs() < 1e-6, "{energy:?}");
    let drive = 40.0 * turned + inertia * 100.0 * 100.0 / 2.0;
    assert!((energy.drive_work_j / drive - 1.0).abs() < 1e-5, "{} {drive}", energy.drive_work_j);
}

/// Loads that hold on to the undeformed shaft are refused on one that turns, with the path and the remedy.
#[test]
fn loads_that_do_not_fit_a_turning_shaft_are_refused() {
    let case = |load: Value| {
        let more = json!({
            "supports": [{ "at": 0, "kind": "revolute" }],
            "loads": [load],
            "spinup": { "drive": [{ "until": 0.5, "speed": 100 }], "until": 1.0 }
        });
        let model = model(&shaft(json!({ "shape": "circle", "radius": 0.05 }), 1.0, 2, more));
        fits(&model, model.spinup.as_ref().expect("spinup")).err()
    };
    let half = case(json!({ "surface": "top", "traction": [0, -1e5, 0] })).expect("refused");
    assert!(half.path == "loads.0.traction" && half.allowed.contains("follower"));
    let dead = case(json!({ "at": 1, "moment": [0, 0, 50], "dead": true })).expect("refused");
    assert_eq!(dead.path, "loads.0.dead");
    assert!(case(json!({ "surface": "rim", "pressure": 1e5, "dead": true })).is_some());
    for load in [
        json!({ "surface": "top", "traction": [0, -1e5, 0], "follower": true }),
        json!({ "surface": "top", "pressure": 1e5 }),
        json!({ "at": 1, "moment": [0, 0, 50] }),
    ] {
        assert!(case(load.clone()).is_none(), "{load}");
    }
    let wrong = |load: Value| {
        let mut value = json!({
            "title": "t",
            "materials": { "m": { "E": E, "nu": 0.3, "rho": 7800 } },
            "sections": { "s": { "shape": "circle", "radius": 0.05 } },
            "shaft": { "segments": [{ "length": 1, "elements": 2, "section": "s", "material": "m" }] }
        });
        value["loads"] = json!([load]);
        let loaded = LoadedCase::from_value("t.json", value).expect("case");
        rotor::model::Model::new(&loaded).expect_err("refused").to_string()
    };
    let text = wrong(json!({ "surface": "rim", "pressure": 1e5, "follower": false }));
    assert!(text.contains("loads.0.follower") && text.contains("dead"), "{text}");
    let text = wrong(json!({ "at": 1, "force": [0, 1, 0], "dead": true }));
    assert!(text.contains("loads.0.dead"), "{text}");
}

/// Pressure and traction over meshes of 10 to 320 elements, beside a neighbour 1000 times shorter and in other members: a rim
/// under pressure shrinks by `(1 - nu) p R / E`, a rim pulled along x lengthens by `t L^2 / (R E)`.
#[test]
#[ignore = "long"]
fn surface_loads_do_not_change_with_the_mesh() {
    let (r, length, p) = (0.02, 0.5, 1e7);
    let part = |length: f64, elements: usize| json!({ "length": length, "elements": elements, "section": "s", "material": "m" });
    let short = json!([part(0.25, 5), part(5e-5, 1), part(0.24995, 5)]);
    for (segments, element) in [
        (json!([part(length, 10)]), "34X3"),
        (json!([part(length, 320)]), "34X3"),
        (short, "34X3"),
        (json!([part(length, 10)]), "34X2"),
        (json!([part(length, 10)]), "34X5"),
    ] {
        let base = shaft(
            json!({ "shape": "circle", "radius": r }),
            length,
            2,
            json!({
                "supports": [{ "at": 0, "kind": "clamped" }],
                "probes": [{ "name": "rim", "at": 0.2, "y": r }, { "name": "end", "at": length, "y": 0 }]
            }),
        );
        let case = with(&base, json!({ "shaft.segments": segments, "shaft.element": element }));
        let under = |load: Value| solve(&with(&case, json!({ "loads": [load] })));
        let shrunk = displacement(&under(json!({ "surface": "rim", "pressure": p })), "rim")[1];
        let right = -0.7 * p * r / E;
        assert!((shrunk / right - 1.0).abs() < 1e-3, "{element} {segments}: {shrunk} {right}");
        for follower in [false, true] {
            let pull = json!({ "surface": "rim", "traction": [1e5, 0, 0], "follower": follower });
            let longer = displacement(&under(pull), "end")[0];
            let right = 1e5 * length * length / (r * E);
            assert!((longer / right - 1.0).abs() < 2e-3, "{element} {segments}: {longer} {right}");
        }
    }
}
