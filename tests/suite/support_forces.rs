//! Forces of supports, bearings and rings, and what passes through the sections of a shaft, against closed forms.

use crate::common::{case, model, shaft, with};
use crate::steady::{ECCENTRICITY, MASS, STIFFNESS, jeffcott};
use faer::c64 as Complex;
use rotor::analysis::spinup::spinup;
use rotor::analysis::statics::statics;
use rotor::case::LoadedCase;
use rotor::results::{SectionForces, Spinup, Static};
use serde_json::{Value, json};
use std::f64::consts::PI;

const DENSITY: f64 = 7800.0;
const RADIUS: f64 = 0.05;
const GRAVITY: f64 = 9.81;

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

fn round() -> Value {
    json!({ "shape": "circle", "radius": RADIUS })
}

/// Weight of a metre of the shaft, N/m.
fn weight() -> f64 {
    PI * RADIUS * RADIUS * DENSITY * GRAVITY
}

fn sum<'a>(forces: impl Iterator<Item = &'a [f64; 3]>) -> [f64; 3] {
    forces.fold([0.0; 3], |s, f| [s[0] + f[0], s[1] + f[1], s[2] + f[2]])
}

fn near(ours: f64, right: f64, scale: f64, tolerance: f64, what: &str) {
    assert!((ours - right).abs() <= tolerance * scale, "{what}: {ours:e} instead of {right:e} ({scale:e})");
}

/// Uneven bearings with cross-coupling carry weight and loads; each by its stiffness times what it feels.
#[test]
fn bearings_carry_weight_and_loads() {
    let laws = [[[2e7, 0.0], [0.0, 3e7]], [[1e7, 6e6], [-6e6, 4e7]], [[5e7, -2e6], [8e6, 5e6]]];
    let places = [0.1, 0.7, 1.0];
    let bearing =
        |k: usize| json!({ "at": places[k], "kind": "bearing", "stiffness": laws[k], "acts_on": "axis" });
    let probe = |k: usize| json!({ "name": k.to_string(), "at": places[k], "y": 0, "z": 0 });
    let load = [30.0, 700.0, -400.0];
    let found = hold(&shaft(
        round(),
        1.0,
        10,
        json!({
            "supports": [bearing(0), bearing(1), { "at": 0, "fix": ["r.x"] }, bearing(2)],
            "disks": [{ "at": 0.4, "mass": 12, "polar_inertia": 0.1, "diametral_inertia": 0.06 }],
            "gravity": [0, -GRAVITY, 0],
            "loads": [{ "at": 0.3, "force": load }],
            "probes": [probe(0), probe(1), probe(2)]
        }),
    ));
    let forces = &found.support_forces.forces_n;
    assert_eq!(forces.keys().collect::<Vec<_>>(), ["supports.0", "supports.1", "supports.2", "supports.3"]);
    assert_eq!(found.support_forces.moments_n_m.keys().collect::<Vec<_>>(), ["supports.2"]);
    let carried = weight() + 12.0 * GRAVITY;
    let right = [-load[0], carried - load[1], -load[2]];
    let all = sum(forces.values());
    (0..3).for_each(|c| near(all[c], right[c], carried, 1e-9, "the sum"));
    for (k, path) in ["supports.0", "supports.1", "supports.3"].into_iter().enumerate() {
        let [_, y, z] = found.probes[k].point.as_ref().expect("point").displacement_m;
        let force = forces[path];
        for c in 0..2 {
            near(force[1 + c], -(laws[k][c][0] * y + laws[k][c][1] * z), carried, 1e-9, path);
        }
        assert_eq!(force[0], 0.0);
    }
    // held along x only
    let [_, y, z] = forces["supports.2"];
    assert_eq!([y, z], [0.0; 2]);
    for force in found.support_forces.moments_n_m.values() {
        assert_eq!(*force, [0.0; 3]);
    }
}

/// Two bearings share a force by its distances, three kinematic supports report moments.
#[test]
fn two_bearings_share_by_the_lever() {
    let soft = json!({ "at": 0, "kind": "bearing", "stiffness": 1e7 });
    let stiff = json!({ "at": 2, "kind": "bearing", "stiffness": 4e8 });
    for at in [0.25, 1.0, 1.75] {
        let more = json!({
            "supports": [soft, stiff, { "at": 0, "fix": ["r.x"] }],
            "loads": [{ "at": at, "force": [0, -0.01, 0.02] }]
        });
        let forces = hold(&shaft(round(), 2.0, 8, more)).support_forces.forces_n;
        let share = at / 2.0;
        for (path, share) in [("supports.0", 1.0 - share), ("supports.1", share)] {
            near(forces[path][1], 0.01 * share, 0.02, 1e-8, path);
            near(forces[path][2], -0.02 * share, 0.02, 1e-8, path);
        }
    }
}

/// The orbit of a Jeffcott rotor: each bearing carries `|k + i c W| r / 2`, and drag of the orbit `c W r^2` is the drive's torque.
#[test]
fn bearings_of_a_steady_orbit_carry_stiffness_and_damping() {
    for (damping, speed) in [(10.0, 90.0), (60.0, 100.0), (200.0, 200.0)] {
        let law = [[damping, 0.0], [0.0, damping]];
        let found = run(&jeffcott([[STIFFNESS, 0.0], [0.0, STIFFNESS]], law, speed, json!({})));
        let dynamic = Complex::new(STIFFNESS - MASS * speed * speed, damping * speed);
        let radius = MASS * ECCENTRICITY * speed * speed / dynamic.norm();
        let right = Complex::new(STIFFNESS, damping * speed).norm() * radius / 2.0;
        let all = found.support_forces.expect("an equilibrium");
        for path in ["supports.0", "supports.1"] {
            let [_, y, z] = all.forces_n[path];
            near(y.hypot(z), right, right, 2e-4, path);
        }
        let torque = all.moments_n_m["supports.2"][0];
        near(torque, damping * speed * radius * radius, torque.abs(), 1e-3, "the torque");
        // nothing passes through the free ends; the mass between takes what both bearings give
        let s = &found.sections;
        let last = s.x_m.len() - 1;
        let outside: Vec<f64> = [(0, "supports.0"), (last, "supports.1")]
            .into_iter()
            .map(|(k, path)| {
                s.shear_y_n[k].hypot(s.shear_z_n[k]) / all.forces_n[path][1].hypot(all.forces_n[path][2])
            })
            .collect();
        assert!((outside[0] - 1.0).abs() < 1e-6 && (outside[1] - 1.0).abs() < 1e-6, "{outside:?}");
    }
}

/// Over a turn of a periodic motion momentum comes back: the mean of all forces is the weight.
#[test]
fn a_periodic_motion_carries_the_weight_on_average() {
    let case = jeffcott(
        [[STIFFNESS, 0.0], [0.0, 2.25 * STIFFNESS]],
        [[20.0, 0.0], [0.0, 40.0]],
        80.0,
        json!({ "gravity": [0, -GRAVITY, 0] }),
    );
    let found = run(&case);
    assert!(found.support_forces.is_none());
    let forces = found.history.expect("one turn").support_forces.forces_n;
    let steps = forces["supports.0"].len() - 1;
    let mean = sum(forces.values().flat_map(|list| &list[..steps])).map(|f| f / steps as f64);
    let weight = GRAVITY * (MASS + 1e-3 * 0.4 * PI * RADIUS * RADIUS);
    [0.0, weight, 0.0].into_iter().zip(mean).for_each(|(right, f)| near(f, right, weight, 1e-6, "the mean"));
}

/// A rigid rotor run up, supported at both ends: all forces make `m e (W^2, alpha)` and carry the weight; the torque through a
/// section is what lies beyond times alpha.
#[test]
fn forces_of_a_run_up_are_the_rate_of_momentum() {
    const SPEED: f64 = 40.0;
    const UNTIL: f64 = 2.0;
    let (mass, e, polar) = (5.0, 2e-3, 0.2);
    let found = run(&shaft(
        round(),
        0.4,
        8,
        json!({
            "disks": [{ "at": 0.2, "mass": mass, "polar_inertia": polar, "diametral_inertia": 0.1, "offset": [e, 0] }],
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 0.4, "kind": "cylindrical", "driven": false }],
            "gravity": [0, -GRAVITY, 0],
            "spinup": { "drive": [{ "until": UNTIL, "speed": SPEED }], "until": UNTIL,
                        "rtol": 1e-6, "atol": 1e-10, "output": 41 },
            "probes": [{ "name": "before", "at": 0.11, "y": 0 }, { "name": "beyond", "at": 0.29, "y": 0 }]
        }),
    ));
    let history = found.history.expect("a run");
    assert_eq!(history.probe_section_x_m["before"], 0.1);
    near(history.probe_section_x_m["beyond"], 0.3, 1.0, 1e-12, "the section");
    let force = mass * e * SPEED * SPEED;
    let per_length = DENSITY * PI * RADIUS.powi(4) / 2.0;
    let accelerates = SPEED * PI / (2.0 * UNTIL);
    let carried = 0.4 * weight() + mass * GRAVITY;
    for (i, &t) in history.time_s.iter().enumerate() {
        let phase = PI * t / UNTIL;
        let (speed, alpha) = (SPEED * (1.0 - phase.cos()) / 2.0, accelerates * phase.sin());
        let (sin, cos) = (SPEED / 2.0 * (t - UNTIL / PI * phase.sin())).sin_cos();
        let right = [
            carried - mass * e * (speed * speed * cos + alpha * sin),
            mass * e * (alpha * cos - speed * speed * sin),
        ];
        let all = sum(history.support_forces.forces_n.values().map(|list| &list[i]));
        near(all[1], right[0], force, 2e-3, &format!("along y at {t}"));
        near(all[2], right[1], force, 2e-3, &format!("along z at {t}"));
        // of the weight and of the offset the drive feels the lever
        let lever = -mass * e * GRAVITY * sin;
        let before = (per_length * 0.3 + polar + mass * e * e) * alpha + lever;
        let largest = (per_length * 0.3 + polar) * accelerates;
        near(-history.probe_torque_n_m["before"][i], before, largest, 2e-3, &format!("before at {t}"));
        let beyond = per_length * 0.1 * alpha;
        near(-history.probe_torque_n_m["beyond"][i], beyond, largest, 1e-4, &format!("beyond at {t}"));
        let drive = history.support_forces.moments_n_m["supports.0"][i][0];
        near(drive, before + per_length * 0.1 * alpha, largest, 2e-3, &format!("the drive at {t}"));
    }
}

/// Both frames tell the forces of bearings, and the support that drives takes the torque of the drive.
#[test]
fn frames_tell_the_same_forces() {
    let [rotating, inertial] = ["rotating", "inertial"].map(|frame| {
        let more = json!({ "spinup.steady": false, "spinup.frame": frame, "spinup.until": 0.6, "spinup.output": 31,
                           "spinup.rtol": 1e-6, "spinup.atol": 1e-10, "gravity": [0, -GRAVITY, 0] });
        let law = [[STIFFNESS, 2e3], [-2e3, 1.5 * STIFFNESS]];
        run(&jeffcott(law, [[20.0, 0.0], [0.0, 30.0]], 60.0, more)).history.expect("a run")
    });
    let largest = GRAVITY * MASS;
    for path in ["supports.0", "supports.1"] {
        let lists = [&rotating, &inertial].map(|h| &h.support_forces.forces_n[path]);
        for (i, (a, b)) in lists[0].iter().zip(lists[1]).enumerate() {
            (0..3).for_each(|c| near(a[c], b[c], largest, 1e-4, &format!("{path}, {i}")));
        }
    }
    for h in [rotating, inertial] {
        let force = &h.support_forces;
        for (i, drive) in h.drive_torque_n_m.iter().enumerate() {
            let ours = force.moments_n_m["supports.2"][i][0];
            near(ours, *drive, largest * 1e-2, 1e-5, &format!("the torque, {i}"));
        }
    }
}

/// A ring's force is its normal force and its friction.
#[test]
fn a_ring_counts_among_the_supports() {
    let short = json!({ "spinup.until": 1.2, "spinup.stators.0.friction": 0.1 });
    let history = run(&with(&case("rub-ring"), short)).history.expect("a run");
    let forces = &history.support_forces.forces_n["spinup.stators.0"];
    let ring = &history.stators[0];
    let mut touched = 0;
    for (force, (normal, friction)) in
        forces.iter().zip(ring.normal_force_n.iter().zip(&ring.friction_force_n))
    {
        near(force[1].hypot(force[2]), normal.hypot(*friction), normal.abs().max(1e-12), 1e-9, "the ring");
        touched += usize::from(*normal > 0.0);
    }
    assert!(touched > 5, "{touched}");
}

/// All components at both ends of every element are the closed form.
fn compare(s: &SectionForces, right: impl Fn(f64) -> [f64; 6], sizes: [f64; 6], tolerance: f64, what: &str) {
    let lists =
        [&s.axial_force_n, &s.shear_y_n, &s.shear_z_n, &s.torque_n_m, &s.moment_y_n_m, &s.moment_z_n_m];
    for (i, &x) in s.x_m.iter().enumerate() {
        let right = right(x);
        for c in 0..6 {
            near(lists[c][i], right[c], sizes[c], tolerance, &format!("{what}: {c} at {x}"));
        }
    }
}

/// A cantilever under its weight, a force and a moment at its end and a traction on its rim; uniform meshes, and with one element
/// a thousand times shorter than its neighbours; clamped at either end.
#[test]
fn cantilevers_pass_loads_on_by_the_closed_forms() {
    const LENGTH: f64 = 1.0;
    for element in ["34X2", "34X3", "34R23"] {
        for (left, right) in [(true, 2), (true, 5), (true, 40), (false, 2), (false, 40)] {
            for short in [false, true] {
                if element == "34R23" && right == 40 {
                    continue;
                }
                // small, so that places stay, and for the clamp larger than what rounding makes of its forces
                let scale = if left { 1.0 } else { 100.0 };
                let [force, moment, traction] = [[0.3, 0.2, -0.1], [0.05, 0.03, -0.02], [0.2, -0.4, 0.1]]
                    .map(|vector| vector.map(|v| scale * v));
                let g = scale * 1e-3;
                let per_length = PI * RADIUS * RADIUS * DENSITY * g;
                let line = traction.map(|t| t * 2.0 * PI * RADIUS);
                let section = match element {
                    "34R23" => json!({ "shape": "tube", "outer_radius": RADIUS, "inner_radius": 0.02 }),
                    _ => round(),
                };
                let tube = if element == "34R23" { 1.0 - 0.16 } else { 1.0 };
                let segment = |length: f64, elements: usize| json!({ "length": length, "elements": elements, "section": "s", "material": "m" });
                let piece = LENGTH / right as f64 / 1000.0;
                let half = right / 2;
                let segments = match short {
                    false => vec![segment(LENGTH, right)],
                    true => vec![
                        segment(LENGTH * half as f64 / right as f64, half),
                        segment(piece, 1),
                        segment(LENGTH - LENGTH * half as f64 / right as f64 - piece, right - half),
                    ],
                };
                let (clamp, end) = if left { (0.0, LENGTH) } else { (LENGTH, 0.0) };
                let found = hold(&shaft(
                    section,
                    LENGTH,
                    right,
                    json!({
                        "shaft": { "element": element, "segments": segments },
                        "supports": [{ "at": clamp, "kind": "clamped" }],
                        "gravity": [0, -g, 0],
                        "loads": [{ "at": end, "force": force }, { "at": end, "moment": moment },
                                  { "surface": "rim", "traction": traction, "follower": right == 5 }]
                    }),
                ));
                // what lies between a section and the free end
                let closed = |x: f64| {
                    let reach = end - x;
                    let (span, sign) = (reach.abs(), if left { 1.0 } else { -1.0 });
                    let y = line[1] - per_length * tube;
                    let all = [force[0] + line[0] * span, force[1] + y * span, force[2] + line[2] * span];
                    let [lever_y, lever_z] = [
                        force[1] * reach + y * span * reach / 2.0,
                        force[2] * reach + line[2] * span * reach / 2.0,
                    ];
                    [all[0], all[1], all[2], moment[0], moment[1] - lever_z, moment[2] + lever_y]
                        .map(|v| sign * v)
                };
                let what = format!("{element}, {right} elements, clamped at {clamp}, short {short}");
                let tolerance = if left { 1e-7 } else { 1e-5 };
                let sizes = [0.5 * scale; 6];
                compare(&found.sections, closed, sizes, tolerance, &what);
                // the clamp holds what passes beside it
                let (at, sign) = if left { (0, -1.0) } else { (found.sections.x_m.len() - 1, 1.0) };
                let s = &found.sections;
                let held = found.support_forces.moments_n_m["supports.0"];
                let passes = [s.torque_n_m[at], s.moment_y_n_m[at], s.moment_z_n_m[at]];
                (0..3).for_each(|c| near(held[c], sign * passes[c], sizes[c], 1e-4, &what));
                let held = found.support_forces.forces_n["supports.0"];
                let passes = [s.axial_force_n[at], s.shear_y_n[at], s.shear_z_n[at]];
                (0..3).for_each(|c| near(held[c], sign * passes[c], sizes[c], 1e-4, &what));
            }
        }
    }
}

/// Damping by space takes `alpha J W` of a shaft that turns in it: the torque falls along the shaft.
#[test]
fn drag_of_space_is_carried_as_torque() {
    let (alpha, speed, length) = (3.0, 200.0, 2.0);
    let found = run(&shaft(
        round(),
        length,
        5,
        json!({
            "materials": { "m": { "damping": { "mass": alpha } } },
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 2, "kind": "cylindrical", "driven": false }],
            "spinup": { "drive": [{ "until": 1, "speed": speed }], "until": 1, "steady": true }
        }),
    ));
    let whole = alpha * speed * DENSITY * PI * RADIUS.powi(4) / 2.0 * length;
    for (x, torque) in found.sections.x_m.iter().zip(&found.sections.torque_n_m) {
        near(*torque, -whole * (1.0 - x / length), whole, 1e-5, &format!("at {x}"));
    }
    let all = found.support_forces.expect("an equilibrium");
    near(all.moments_n_m["supports.0"][0], whole, whole, 1e-5, "the drive");
}

/// Shear jumps at a force and a disk by what acts there.
#[test]
fn sections_stand_left_and_right_of_what_acts() {
    let found = hold(&shaft(
        round(),
        1.0,
        4,
        json!({
            "supports": [{ "at": 0, "kind": "clamped" }, { "at": 1, "kind": "roller" }],
            "disks": [{ "at": 0.5, "mass": 10, "polar_inertia": 0.05, "diametral_inertia": 0.03 }],
            "gravity": [0, -GRAVITY, 0],
            "loads": [{ "at": 0.25, "force": [0, 0, 50] }, { "at": 0.75, "moment": [7, 0, 0] }]
        }),
    ));
    let s = &found.sections;
    assert_eq!(s.x_m, [0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0]);
    let jump = |list: &[f64], k: usize| list[2 * k - 1] - list[2 * k];
    near(jump(&s.shear_z_n, 1), 50.0, 50.0, 1e-9, "the force");
    near(jump(&s.shear_y_n, 2), -10.0 * GRAVITY, 100.0, 1e-9, "the disk");
    near(jump(&s.torque_n_m, 3), 7.0, 7.0, 1e-9, "the moment");
    near(s.torque_n_m[0], 7.0, 7.0, 1e-9, "the torque");
    near(s.torque_n_m[7], 0.0, 7.0, 1e-9, "beyond the moment");
    near(s.moment_z_n_m[7], 0.0, 100.0, 1e-7, "a roller holds no tilt");
}

/// A support that stands where a bearing does tells its own reaction: one that holds x alone carries nothing of the weight.
#[test]
fn a_support_beside_a_bearing_tells_its_own_reaction() {
    let law = json!([[1e7, 2e6], [-2e6, 2e7]]);
    let found = hold(&shaft(
        round(),
        1.0,
        4,
        json!({
            "supports": [{ "at": 0, "fix": ["r.x", "y.z"] }, { "at": 0, "kind": "bearing", "stiffness": law },
                         { "at": 1, "kind": "bearing", "stiffness": law }],
            "gravity": [0, -GRAVITY, 0]
        }),
    ));
    let [_, y, z] = found.reactions[0].force_n;
    near(y.hypot(z), 0.0, weight(), 1e-6, "reaction across");
    near(found.support_forces.forces_n["supports.1"][1], weight() / 2.0, weight(), 1e-6, "bearing");
}
