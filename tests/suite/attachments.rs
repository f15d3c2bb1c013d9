//! What supports, bearings, loads and disks take hold of: section, bore or rim; pressures against Lame's tube.

use crate::common::{frequencies, model, shaft, with};
use faer::Mat;
use nalgebra::Vector3;
use rotor::case::LoadedCase;
use rotor::model::{ActsOn, Model};
use rotor::results::{ModeKind, Static};
use rotor::section::Section;
use rotor::shaft::assembly::Assembly;
use rotor::shaft::attachments::{displacement_weights, functions_at};
use rotor::shaft::internal_forces::{Forces, ScalarMass};
use rotor::shaft::loads::{Loads, Turned, Which};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Forces of the loads on all coordinates of the undeformed shaft.
fn loads_at_rest(assembly: &Assembly<'_>) -> Vec<f64> {
    let model = assembly.model;
    let q = Forces::new(assembly).expect("forces").reference();
    let loads = Loads::new(model, &assembly.numbering, &ScalarMass::new(model), Which::All);
    let mut force = vec![0.0; q.len()];
    loads.add(&q, Turned::NOT, 1.0, &mut force);
    force
}

fn tube(outer: f64, inner: f64) -> Value {
    json!({ "shape": "tube", "outer_radius": outer, "inner_radius": inner })
}

fn ellipse(outer: [f64; 2], inner: [f64; 2]) -> Value {
    json!({ "shape": "ellipse", "semi_axis_y": outer[0], "semi_axis_z": outer[1],
            "inner_semi_axis_y": inner[0], "inner_semi_axis_z": inner[1] })
}

/// Sections, members on them, and what there is to take hold of.
fn sections() -> Vec<(Value, &'static str, &'static [&'static str])> {
    let every = &["section", "bore", "rim"];
    vec![
        (tube(0.2, 0.15), "34R23", every),
        (tube(0.2, 0.05), "34R34", every),
        (ellipse([0.15, 0.2], [0.105, 0.14]), "34R23", every),
        (tube(0.2, 0.15), "34X3", every),
        (ellipse([0.1, 0.2], [0.05, 0.12]), "34X5", every),
        (json!({ "shape": "circle", "radius": 0.1 }), "34X3", &["section", "rim"]),
        (
            json!({ "shape": "ellipse", "semi_axis_y": 0.1, "semi_axis_z": 0.004 }),
            "34X2",
            &["section", "rim"],
        ),
        (json!({ "shape": "rectangle", "height": 0.4, "width": 0.1 }), "34X4", &["section", "rim"]),
    ]
}

/// Points `(y, z, length)` of a boundary of a section, of its own making: many short chords.
fn chords(section: &Section, acts_on: ActsOn) -> Vec<(f64, f64, f64)> {
    let [cy, cz] = if acts_on == ActsOn::Bore { section.inner } else { section.outer };
    let n = 40_000;
    let at = |k: f64| {
        let angle = 2.0 * PI * k / n as f64;
        (cy * angle.cos(), cz * angle.sin())
    };
    let chord = |k: usize| {
        let ((a, b), (c, d)) = (at(k as f64), at(k as f64 + 1.0));
        let (y, z) = at(k as f64 + 0.5);
        (y, z, (a - c).hypot(b - d))
    };
    (0..n).map(chord).collect()
}

/// The rigid motion `t + w x r` on all coordinates.
fn rigid(model: &Model, t: Vector3<f64>, w: Vector3<f64>) -> Vec<f64> {
    let assembly = Assembly::unconstrained(model);
    let mut q = vec![0.0; assembly.numbering.len()];
    for (node, at) in model.nodes.iter().enumerate() {
        let r = model.reference_length;
        let vectors = [
            t + w.cross(&Vector3::new(at.x, 0.0, 0.0)),
            w.cross(&Vector3::new(0.0, r, 0.0)),
            w.cross(&Vector3::new(0.0, 0.0, r)),
        ];
        for (k, v) in vectors.iter().enumerate() {
            for c in 0..3 {
                q[assembly.numbering.index(node, k, c)] = v[c];
            }
        }
    }
    q
}

/// Whatever it acts on, a force and a moment do the work of force and moment on every rigid motion.
#[test]
fn resultants_are_those_asked_for() {
    let (force, moment) = (Vector3::new(3.0, -2.0, 5.0), Vector3::new(7.0, 11.0, -13.0));
    for (section, element, holds) in sections() {
        for acts_on in holds {
            let load = json!([{ "at": 0.5, "acts_on": acts_on, "force": force.as_slice(), "moment": moment.as_slice() }]);
            let more = json!({ "shaft": { "element": element }, "loads": load });
            let model = model(&shaft(section.clone(), 1.0, 2, more));
            let assembly = Assembly::unconstrained(&model);
            let loads = loads_at_rest(&assembly);
            for axis in 0..3 {
                let e = Vector3::ith(axis, 1.0);
                let work = |q: Vec<f64>| -> f64 { q.iter().zip(&loads).map(|(q, f)| q * f).sum() };
                let about = (Vector3::new(0.5, 0.0, 0.0).cross(&force) + moment)[axis];
                let (pushed, turned) = (work(rigid(&model, e, e * 0.0)), work(rigid(&model, e * 0.0, e)));
                assert!((pushed - force[axis]).abs() < 1e-12, "{element} {acts_on}: {pushed} {axis}");
                assert!((turned - about).abs() < 1e-11, "{element} {acts_on}: {turned} {about}");
            }
        }
    }
}

/// The weights are means over the arc length of the boundary.
#[test]
fn weights_are_means_over_the_boundary() {
    for (section, element, holds) in sections() {
        if section["shape"] == "rectangle" {
            continue;
        }
        let model = model(&shaft(section, 1.0, 2, json!({ "shaft": { "element": element } })));
        let boundaries: &[ActsOn] =
            if holds.len() == 2 { &[ActsOn::Rim] } else { &[ActsOn::Bore, ActsOn::Rim] };
        for &acts_on in boundaries {
            let functions = functions_at(&model, 0);
            let mut sums = vec![0.0; model.nodes[0].n_vectors()];
            let points = chords(&model.sections[0], acts_on);
            let length: f64 = points.iter().map(|p| p.2).sum();
            for (y, z, ds) in points {
                sums.iter_mut().zip(functions.at(y, z)).for_each(|(s, f)| *s += f[0] * ds / length);
            }
            for (a, b) in displacement_weights(&model, 0, acts_on).iter().zip(&sums) {
                assert!((a - b).abs() < 1e-8, "{element} {acts_on:?}: {a} {b}");
            }
        }
    }
    // in closed form: P_1 is -1 on the bore and 1 on the rim, and the mean of y^2 on a circle is half its square
    let of = |element: &str, acts_on| {
        let case = shaft(tube(0.2, 0.15), 1.0, 1, json!({ "shaft": { "element": element } }));
        displacement_weights(&model(&case), 0, acts_on)
    };
    let ring = [of("34R23", ActsOn::Bore), of("34R23", ActsOn::Rim)];
    let expected = [[1.0, 0.0, 0.0, -1.0, 1.0, 0.0], [1.0, 0.0, 0.0, 1.0, 1.0, 0.0]];
    for (weights, expected) in ring.iter().zip(expected) {
        assert!(weights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{weights:?}");
    }
    let polynomial = of("34X3", ActsOn::Bore);
    for k in [4, 5] {
        assert!((polynomial[k] - 0.75f64.powi(2) / 4.0).abs() < 1e-15, "{polynomial:?}");
    }
    // a rectangle 0.4 x 0.1: mean of y^2 over its perimeter, (b h^2 / 2 + h^3 / 6) / (2 (b + h))
    let bar = json!({ "shape": "rectangle", "height": 0.4, "width": 0.1 });
    let weights = displacement_weights(&model(&shaft(bar, 1.0, 1, json!({}))), 0, ActsOn::Rim);
    let yy = (0.1 * 0.4f64.powi(2) / 2.0 + 0.4f64.powi(3) / 6.0) / 1.0;
    assert!((weights[4] - yy / 2.0 / 0.2f64.powi(2)).abs() < 1e-14, "{weights:?}");
}

/// A plane end on a boundary holds its mean displacement across and its mean rotation.
#[test]
fn a_plane_end_holds_mean_and_turn_of_the_boundary() {
    for (section, element) in
        [(ellipse([0.15, 0.2], [0.105, 0.14]), "34R23"), (ellipse([0.1, 0.2], [0.05, 0.12]), "34X4")]
    {
        for (word, acts_on) in [("bore", ActsOn::Bore), ("rim", ActsOn::Rim)] {
            let support = json!([{ "at": 0, "kind": "cylindrical", "acts_on": word }]);
            let more = json!({ "shaft": { "element": element }, "supports": support });
            let model = model(&shaft(section.clone(), 1.0, 2, more));
            let rows = rotor::shaft::attachments::constraint_rows(&model, 0);
            let (functions, points) = (functions_at(&model, 0), chords(&model.sections[0], acts_on));
            let length: f64 = points.iter().map(|p| p.2).sum();
            let mut expected = vec![vec![0.0; rows[0].len()]; 3];
            for (y, z, ds) in points {
                for (k, f) in functions.at(y, z).into_iter().enumerate() {
                    let share = f[0] * ds / length;
                    expected[0][3 * k + 1] += share;
                    expected[1][3 * k + 2] += share;
                    expected[2][3 * k + 1] -= share * z / model.reference_length;
                    expected[2][3 * k + 2] += share * y / model.reference_length;
                }
            }
            for (row, expected) in [&rows[0], &rows[1], &rows[rows.len() - 1]].into_iter().zip(&expected) {
                assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8), "{element} {word}");
            }
        }
    }
}

fn bearings(acts_on: &str, k: f64) -> Value {
    let one =
        |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[k, 0], [0, k]], "acts_on": acts_on });
    json!([one(0.0), one(2.0)])
}

fn on_bearings(section: Value, element: &str, modulus: f64, acts_on: &str, k: f64) -> LoadedCase {
    let more = json!({
        "materials": { "m": { "E": modulus, "nu": 0.3, "rho": 7800 } },
        "shaft": { "element": element },
        "supports": bearings(acts_on, k),
        "modes": { "count": 40 }
    });
    shaft(section, 2.0, 4, more)
}

/// A body that does not deform feels no difference; one that does, feels it in bending only: the mean over a boundary
/// sees nothing of ovalling.
#[test]
fn bearings_on_a_boundary_feel_the_mean_motion_only() {
    let thick = || tube(0.2, 0.1);
    let of = |acts_on: &str, modulus: f64, k: f64| {
        frequencies(&on_bearings(thick(), "34R23", modulus, acts_on, k))
    };
    let stiff = ["section", "bore", "rim"].map(|a| of(a, 2.1e17, 1e8));
    // bounce and tilt on two springs, in two planes
    let mass = 7800.0 * PI * (0.04 - 0.01) * 2.0;
    let bounce = (2e8 / mass).sqrt();
    let diametral = mass * ((0.04 + 0.01) / 4.0 + 4.0 / 12.0);
    let tilt = (2e8f64 / diametral).sqrt();
    for list in &stiff {
        let rigid: Vec<f64> = list.iter().copied().filter(|w| *w > 1.0).take(4).collect();
        for (ours, exact) in rigid.iter().zip([bounce, bounce, tilt, tilt]) {
            assert!((ours / exact - 1.0).abs() < 1e-6, "{rigid:?} {bounce} {tilt}");
        }
    }
    let kinds = |acts_on: &str| {
        let case = on_bearings(tube(0.2, 0.15), "34R23", 2.1e11, acts_on, 1e11);
        let found = rotor::analysis::modes::modes(&model(&case)).expect("modes").results.modes;
        let of = |kind: ModeKind, waves: usize| -> Vec<f64> {
            let of = found.iter().filter(|m| m.kind == kind && m.circumferential_order == waves);
            of.map(|m| m.frequency_rad_s).collect()
        };
        (of(ModeKind::Bending, 1), of(ModeKind::Section, 2))
    };
    let (bore, section, rim) = (kinds("bore"), kinds("section"), kinds("rim"));
    assert!(section.1.len() >= 6);
    for other in [&bore, &rim] {
        for (a, b) in section.1.iter().zip(&other.1) {
            assert!((a / b - 1.0).abs() < 1e-10, "{a} {b}");
        }
        assert!((section.0[0] / other.0[0] - 1.0).abs() > 1e-5, "{section:?} {other:?}");
    }
}

fn points_around(y: f64, z: f64, at: f64, count: usize) -> Vec<Value> {
    let point = |k: usize| {
        let angle = 2.0 * PI * k as f64 / count as f64;
        json!({ "name": format!("p{k}"), "at": at, "y": y * angle.cos(), "z": z * angle.sin() })
    };
    (0..count).map(point).collect()
}

fn statics(case: &LoadedCase) -> Static {
    rotor::analysis::statics::statics(&model(case)).unwrap_or_else(|e| panic!("{e}")).results
}

fn mean_displacement(found: &Static) -> [f64; 3] {
    let points: Vec<[f64; 3]> =
        found.probes.iter().map(|p| p.point.as_ref().expect("a point").displacement_m).collect();
    std::array::from_fn(|c| points.iter().map(|u| u[c]).sum::<f64>() / points.len() as f64)
}

/// A tube bent far: supports hold the mean of the boundary they are given, bearings push with its stiffness.
#[test]
fn large_displacements_keep_the_mean_of_the_boundary() {
    for element in ["34R23", "34X3"] {
        for (acts_on, radius) in [("bore", 0.075), ("rim", 0.1)] {
            let case = |end: Value| {
                let more = json!({
                    "materials": { "m": { "E": 2.1e9, "nu": 0.3, "rho": 7800 } },
                    "shaft": { "element": element },
                    "supports": [{ "at": 0, "kind": "clamped", "section": "plane", "acts_on": acts_on }, end],
                    "loads": [{ "at": 1, "force": [0, -1e5, 2e4], "moment": [5e3, 0, 0], "acts_on": acts_on }],
                    "probes": points_around(radius, radius, 2.0, 24)
                });
                shaft(tube(0.1, 0.075), 2.0, 4, more)
            };
            let found = statics(&case(json!({ "at": 2, "kind": "roller", "acts_on": acts_on })));
            let u = mean_displacement(&found);
            assert!(found.converged && found.largest_strain > 1e-3);
            assert!(u[1].hypot(u[2]) < 1e-13, "{element} {acts_on} {u:?}");
            let end = [found.reactions[0].force_n, found.reactions[1].force_n];
            for (c, load) in [0.0, -1e5, 2e4].into_iter().enumerate() {
                assert!((end[0][c] + end[1][c] + load).abs() < 1e-3, "{end:?}");
            }
            let law = [[2e6, 3e5], [-1e5, 1e6]];
            let bearing = json!({ "at": 2, "kind": "bearing", "stiffness": law, "acts_on": acts_on });
            let found = statics(&case(bearing));
            let u = mean_displacement(&found);
            let clamp = found.reactions[0].force_n;
            for (c, load) in [(1, -1e5), (2, 2e4)] {
                let felt = law[c - 1][0] * u[1] + law[c - 1][1] * u[2];
                assert!((clamp[c] + load - felt).abs() < 1e-5 * 1e5, "{element} {acts_on} {clamp:?} {u:?}");
            }
            assert!(u[1].abs() > 5e-3);
            // Newton's method converges as with a consistent tangent
            assert!(found.newton.iterations <= 12, "{:?}", found.newton);
        }
    }
}

fn disk(hub: &str) -> Value {
    json!([{ "at": 0.5, "mass": 60, "polar_inertia": 2, "diametral_inertia": 1.3, "offset": [0.01, -0.02], "hub": hub }])
}

/// The kinetic energy of a disk on a boundary is that of its mean affine motion.
#[test]
fn a_disk_on_a_boundary_moves_with_its_mean() {
    for (section, element) in [
        (tube(0.2, 0.15), "34R23"),
        (ellipse([0.15, 0.2], [0.105, 0.14]), "34R23"),
        (tube(0.2, 0.15), "34X3"),
    ] {
        for (hub, acts_on) in [("bore", ActsOn::Bore), ("rim", ActsOn::Rim)] {
            let case = |disks: Value| {
                shaft(section.clone(), 1.0, 2, json!({ "shaft": { "element": element }, "disks": disks }))
            };
            let (bare, carrying) = (model(&with(&case(json!([])), json!({}))), model(&case(disk(hub))));
            let (bare_mass, mass) =
                (Assembly::unconstrained(&bare).mass(), Assembly::unconstrained(&carrying).mass());
            // the normal of the disk follows the vectors of its node
            let normal = Assembly::unconstrained(&carrying).numbering.normal(0).expect("a thick disk");
            let n = mass.ncols();
            assert_eq!(n, bare_mass.ncols() + 3);
            let v = Mat::from_fn(n, 1, |i, _| (0.7 * i as f64 + 0.2).sin());
            let of_shaft = Mat::from_fn(n - 3, 1, |i, _| v[(if i < normal { i } else { i + 3 }, 0)]);
            let twice = |m: &rotor::linalg::sparse::Sparse, v: &Mat<f64>| (v.transpose() * (m * v))[(0, 0)];
            let ours = (twice(&mass, &v) - twice(&bare_mass, &of_shaft)) / 2.0;
            // mean motion from chords
            let node = carrying.disks[0].node;
            let numbering = &Assembly::unconstrained(&carrying).numbering;
            let functions = functions_at(&carrying, node);
            let points = chords(&carrying.sections[0], acts_on);
            let felt = |node: usize, weight: &dyn Fn(f64, f64) -> f64| -> Vector3<f64> {
                let mut sum = vec![0.0; carrying.nodes[node].n_vectors()];
                for &(y, z, ds) in &points {
                    sum.iter_mut().zip(functions.at(y, z)).for_each(|(s, f)| *s += f[0] * ds * weight(y, z));
                }
                let each = sum.iter().enumerate().map(|(k, w)| {
                    let at = numbering.index(node, k, 0);
                    Vector3::new(v[(at, 0)], v[(at + 1, 0)], v[(at + 2, 0)]) * *w
                });
                each.sum()
            };
            let integral =
                |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| f(p.0, p.1) * p.2).sum::<f64>();
            let length = integral(&|_, _| 1.0);
            let r = felt(node, &|_, _| 1.0) / length;
            let y = felt(node, &|y, _| y) / integral(&|y, _| y * y);
            let z = felt(node, &|_, z| z) / integral(&|_, z| z * z);
            let centre = r + y * 0.01 - z * 0.02;
            let r = carrying.reference_length;
            let n = Vector3::new(v[(normal, 0)], v[(normal + 1, 0)], v[(normal + 2, 0)]) / r;
            let energy = 30.0 * centre.norm_squared()
                + 0.5 * (y.norm_squared() + z.norm_squared())
                + 0.15 * n.norm_squared();
            assert!((ours / energy - 1.0).abs() < 1e-7, "{element} {hub}: {ours} {energy}");
        }
    }
}

/// On a body that hardly deforms every hub is the same, and gyroscopic and centrifugal terms fit each other.
#[test]
#[ignore = "long"]
fn hubs_agree_on_a_stiff_body_and_in_both_frames() {
    let case = |hub: &str, modulus: f64| {
        let mut disks = disk(hub);
        disks[0]["offset"] = json!([0, 0]);
        disks[0]["at"] = json!(0.8);
        let more = json!({ "disks": disks });
        let mut value = on_bearings(tube(0.2, 0.15), "34R12", modulus, "section", 1e8).value.clone();
        value["shaft"]["segments"][0]["elements"] = json!(2);
        value["disks"] = more["disks"].clone();
        LoadedCase::from_value("hub.json", value).unwrap_or_else(|e| panic!("{e}"))
    };
    let lowest = |hub: &str| -> Vec<f64> {
        frequencies(&case(hub, 2.1e17)).into_iter().filter(|w| *w > 1.0).take(4).collect()
    };
    let rigid = lowest("rigid");
    for hub in ["bore", "rim"] {
        for (a, b) in lowest(hub).iter().zip(&rigid) {
            assert!((a / b - 1.0).abs() < 1e-6, "{hub}: {a} {b}");
        }
        let speed = 300.0;
        let whirls = |frame: &str, modes: usize| -> Vec<f64> {
            let campbell = json!({ "speeds": { "from": speed, "to": speed, "count": 1 }, "modes": modes,
                                   "frame": frame, "reduction": "none" });
            let found = crate::common::campbell(&with(&case(hub, 2.1e11), json!({ "campbell": campbell })));
            found.branches.iter().filter_map(|b| b.frequency_rad_s[0]).collect()
        };
        let (stationary, rotating) = (whirls("stationary", 12), whirls("rotating", 24));
        assert!(stationary.len() >= 10);
        for w in stationary {
            let seen = (-3..=3)
                .flat_map(|k| rotating.iter().map(move |r| ((r + f64::from(k) * speed).abs() - w).abs()));
            let nearest = seen.fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-6 * w, "{hub} {w}: {nearest:e} {rotating:?}");
        }
    }
}

/// A turning shaft feels bearings on its rim the same in both frames.
#[test]
fn a_run_up_on_the_rim_is_the_same_in_both_frames() {
    let end = |frame: &str| {
        let more = json!({
            "materials": { "m": { "E": 2.1e9, "nu": 0.3, "rho": 7800 } },
            "shaft": { "element": "34R12" },
            "supports": [{ "at": 0, "kind": "revolute", "section": "rigid" },
                         { "at": 1, "kind": "bearing", "stiffness": [[3e5, 1e5], [-1e5, 2e5]],
                           "damping": [[300, 0], [0, 200]], "acts_on": "rim" }],
            "disks": [{ "at": 1, "mass": 2, "polar_inertia": 0.02, "diametral_inertia": 0.012,
                        "offset": [0.002, 0.001], "hub": "bore" }],
            "gravity": [0, -9.81, 0],
            "probes": [{ "name": "tip", "at": 1, "y": 0.05 }],
            "spinup": { "drive": [{ "until": 0.02, "speed": 40 }], "until": 0.03, "frame": frame,
                        "rtol": 1e-7, "atol": 1e-10, "output": 4 }
        });
        let model = model(&shaft(tube(0.05, 0.04), 1.0, 2, more));
        let found =
            rotor::analysis::spinup::spinup(&model, model.spinup.as_ref().expect("spinup"), &|_, _| true);
        found.unwrap_or_else(|e| panic!("{e}")).results.last.probes[0]
            .point
            .as_ref()
            .expect("a point")
            .displacement_m
    };
    let (turning, fixed) = (end("rotating"), end("inertial"));
    let size = turning.iter().map(|u| u * u).sum::<f64>().sqrt();
    assert!(size > 1e-4, "{turning:?}");
    for (a, b) in turning.iter().zip(fixed) {
        println!("{:.1e}", (a - b).abs() / size);
        assert!((a - b).abs() < 1e-4 * size, "{turning:?} {fixed:?}");
    }
}

/// The same rotor in micrometres and in metres: frequencies and means do not depend on the unit.
#[test]
fn boundaries_do_not_depend_on_the_unit_of_length() {
    let scaled = |s: f64, hub: &str| {
        let bearing = |at: f64| json!({ "at": at * s, "kind": "bearing", "stiffness": [[1e9 * s, 0], [0, 1e9 * s]], "acts_on": "bore" });
        let more = json!({
            "shaft": { "element": "34R23" },
            "supports": [bearing(0.0), bearing(2.0)],
            "disks": [{ "at": s, "mass": 60.0 * s.powi(3), "polar_inertia": 2.0 * s.powi(5),
                        "diametral_inertia": 1.3 * s.powi(5), "hub": hub }],
            "modes": { "count": 20 }
        });
        frequencies(&shaft(tube(0.2 * s, 0.15 * s), 2.0 * s, 2, more))
    };
    let (large, small) = (scaled(1.0, "rim"), scaled(1e-3, "rim"));
    for (a, b) in large.iter().zip(&small).filter(|(a, _)| **a > 1.0) {
        assert!((a / b * 1e3 - 1.0).abs() < 1e-9, "{a} {b}");
    }
}

/// Lame's tube with free ends: radial displacement, radial and hoop stress at radius r under inner and outer pressure.
fn lame([a, b]: [f64; 2], [inside, outside]: [f64; 2], r: f64) -> [f64; 3] {
    let wall = b * b - a * a;
    let (mean, rest) =
        ((inside * a * a - outside * b * b) / wall, (inside - outside) * (a * b / r).powi(2) / wall);
    [r / 2.1e11 * (0.7 * mean + 1.3 * rest), mean - rest, mean + rest]
}

/// Pressure in and on a tube against Lame, strains of 1e-6 so that finite displacements do not show: displacement at
/// bore and rim, stresses through the wall.
#[test]
fn pressures_meet_lame() {
    let rows = [
        // member, bore, error of displacement, of stress (of the largest)
        ("34R23", 0.15, 3e-4, 5e-2),
        ("34R33", 0.15, 1e-5, 6e-3),
        ("34R43", 0.15, 1e-5, 6e-4),
        ("34R33", 0.1, 8e-4, 1e-1),
        ("34R43", 0.1, 5e-5, 2.5e-2),
        ("34R63", 0.1, 1e-5, 1e-3),
        ("34R23", 0.19, 1e-5, 1.5e-3),
        ("34R33", 0.19, 1e-5, 1e-4),
    ];
    // strains are so small that pressures add up: they are shared out over the rows
    let pressures = [[1e4, 0.0], [0.0, 1e4], [3e4, 1e4]];
    for (k, (element, bore, displacement, stress)) in rows.into_iter().enumerate() {
        let [inside, outside] = pressures[k % 3];
        let more = json!({
            "shaft": { "element": element },
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 1, "kind": "cylindrical" }],
            "loads": [{ "surface": "bore", "pressure": inside }, { "surface": "rim", "pressure": outside }],
            "probes": [{ "name": "wall", "at": 0.4, "line": "y", "points": 9 }]
        });
        let found = statics(&shaft(tube(0.2, bore), 1.0, 2, more));
        let points = &found.probes[0].points;
        let [_, radial, hoop] = lame([bore, 0.2], [inside, outside], bore);
        let peak = radial.abs().max(hoop.abs());
        let mut errors = [0.0f64; 2];
        for (i, p) in points.iter().enumerate() {
            let [u, radial, hoop] = lame([bore, 0.2], [inside, outside], p.y_m);
            if i == 0 || i == 8 {
                errors[0] = errors[0].max((p.displacement_m[1] / u - 1.0).abs());
            }
            let cauchy = p.stress_pa.cauchy;
            errors[1] = errors[1].max((cauchy[1] - radial).abs() / peak).max((cauchy[2] - hoop).abs() / peak);
            errors[1] = errors[1].max(cauchy[0].abs() / peak);
        }
        println!("{element} .2/{bore} {inside} {outside}: {errors:?}");
        assert!(errors[0] < displacement && errors[1] < stress, "{element} {bore} {inside}: {errors:?}");
    }
}

/// Pressure on a hollow ellipse, a bar and beside a solid half: no resultant; on a rectangle uniform compression.
#[test]
fn pressures_have_no_resultant_and_compress() {
    for (section, element, holds) in sections() {
        let all = json!([{ "surface": "bore", "pressure": 2e6 }, { "surface": "rim", "pressure": 1e6 }]);
        let loads = if holds.len() == 3 { all } else { json!([{ "surface": "rim", "pressure": "1 MPa" }]) };
        let model =
            model(&shaft(section, 1.0, 2, json!({ "shaft": { "element": element }, "loads": loads })));
        let assembly = Assembly::unconstrained(&model);
        let force = loads_at_rest(&assembly);
        let size: f64 = force.iter().map(|f| f.abs()).fold(0.0, f64::max);
        for axis in 0..3 {
            let e = Vector3::ith(axis, 1.0);
            for q in [rigid(&model, e, e * 0.0), rigid(&model, e * 0.0, e)] {
                let work: f64 = q.iter().zip(&force).map(|(q, f)| q * f).sum();
                assert!(work.abs() < 1e-12 * size, "{element} {work} {size}");
            }
        }
    }
    // hydrostatic in the plane: (1 - nu) p / E shrinks every direction across, 2 nu p / E stretches the axis
    for section in [
        json!({ "shape": "rectangle", "height": 0.2, "width": 0.3 }),
        json!({ "shape": "ellipse", "semi_axis_y": 0.1, "semi_axis_z": 0.15 }),
    ] {
        let more = json!({
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 1, "kind": "cylindrical" }],
            "loads": [{ "surface": "rim", "pressure": 1e5 }],
            "probes": [{ "name": "top", "at": 1, "y": 0.1 }, { "name": "side", "at": 0.3, "z": 0.15 }]
        });
        let found = statics(&shaft(section, 1.0, 2, more));
        let u: Vec<[f64; 3]> =
            found.probes.iter().map(|p| p.point.as_ref().expect("a point").displacement_m).collect();
        let strain = 1e5 / 2.1e11;
        for (ours, exact) in
            [(u[0][1], -0.7 * strain * 0.1), (u[1][2], -0.7 * strain * 0.15), (u[0][0], 0.6 * strain)]
        {
            assert!((ours / exact - 1.0).abs() < 1e-5, "{ours} {exact}");
        }
    }
}

#[test]
fn bad_input_is_answered_with_place_and_remedy() {
    let circle = || json!({ "shape": "circle", "radius": 0.1 });
    let refuse = |section: Value, element: &str, more: Value, path: &str, words: &[&str]| {
        let mut value = json!({ "shaft": { "element": element } });
        more.as_object().expect("object").iter().for_each(|(k, v)| value[k] = v.clone());
        let mut whole = json!({
            "title": "bad", "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7800 } }, "sections": { "s": section }
        });
        value.as_object().expect("object").iter().for_each(|(k, v)| whole[k] = v.clone());
        whole["shaft"]["segments"] = json!([{ "length": 1, "elements": 2, "section": "s", "material": "m" }]);
        let case = LoadedCase::from_value("bad.json", whole);
        let error = case.and_then(|case| Model::new(&case)).expect_err(path);
        let text = error.to_string();
        assert_eq!(error.exit_code(), 2, "{text}");
        assert!(text.contains(path), "{path}: {text}");
        words.iter().for_each(|w| assert!(text.contains(w), "{w}: {text}"));
    };
    let bearing = |acts_on: &str| json!({ "supports": [{ "at": 0, "kind": "bearing", "stiffness": [[1, 0], [0, 1]], "acts_on": acts_on }] });
    let force = |acts_on: &str| json!({ "loads": [{ "at": 0.3, "force": [1, 0, 0], "acts_on": acts_on }] });
    let held =
        |kind: &str, acts_on: &str| json!({ "supports": [{ "at": 0, "kind": kind, "acts_on": acts_on }] });
    let hub = |hub: &str| json!({ "disks": [{ "at": 0.5, "mass": 1, "polar_inertia": 1, "diametral_inertia": 1, "hub": hub }] });
    refuse(circle(), "34X3", bearing("bore"), "supports.0.acts_on", &["solid", "\"rim\""]);
    refuse(circle(), "34X3", held("pinned", "bore"), "supports.0.acts_on", &["solid", "\"rim\""]);
    refuse(circle(), "34X3", held("revolute", "bore"), "supports.0.acts_on", &["solid", "\"rim\""]);
    refuse(circle(), "34X3", force("bore"), "loads.0.acts_on", &["solid", "\"rim\""]);
    refuse(circle(), "34X3", hub("bore"), "disks.0.hub", &["solid", "\"rim\""]);
    let rigid = json!({ "supports": [{ "at": 0, "kind": "clamped", "section": "rigid", "acts_on": "rim" }] });
    refuse(circle(), "34X3", rigid, "supports.0.acts_on", &["as a whole", "plane"]);
    for bad in [bearing("axis"), held("roller", "axis"), held("clamped", "axis")] {
        refuse(tube(0.1, 0.07), "34R23", bad, "supports.0.acts_on", &["empty", "\"rim\""]);
    }
    refuse(tube(0.1, 0.07), "34R23", force("axis"), "loads.0.acts_on", &["empty", "\"rim\""]);
    refuse(tube(0.1, 0.07), "34R23", hub("soft"), "disks.0.hub", &["empty", "\"rim\""]);
    refuse(tube(0.1, 0.07), "34R23", bearing("rime"), "supports.0.acts_on", &["did you mean \"rim\""]);
    refuse(tube(0.1, 0.07), "34R23", force("bores"), "loads.0.acts_on", &["did you mean \"bore\""]);
    refuse(tube(0.1, 0.07), "34R23", hub("rimm"), "disks.0.hub", &["did you mean \"rim\""]);
    let surface = |keys: Value| json!({ "loads": [keys] });
    refuse(
        circle(),
        "34X3",
        surface(json!({ "surface": "bore", "pressure": 1 })),
        "loads.0.surface",
        &["no section", "rim"],
    );
    refuse(circle(), "34X3", surface(json!({ "surface": "rim" })), "loads.0", &["incomplete", "pressure"]);
    refuse(
        circle(),
        "34X3",
        surface(json!({ "surface": "rim", "pressure": 1, "traction": [1, 0, 0] })),
        "loads.0",
        &["mixed", "pressure"],
    );
    refuse(circle(), "34X3", surface(json!({ "at": 0, "pressure": 1 })), "loads.0", &["incomplete"]);
    refuse(
        circle(),
        "34X3",
        surface(json!({ "surface": "rim", "pressure": 1e31 })),
        "loads.0.pressure",
        &["extreme"],
    );
    refuse(
        circle(),
        "34X3",
        surface(json!({ "surface": "rim", "pressure": 1, "follower": false })),
        "loads.0.follower",
        &["false"],
    );
    // where a round and a rectangular section meet there is no common boundary
    let step = json!({
        "title": "bad", "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7800 } },
        "sections": { "a": circle(), "b": { "shape": "rectangle", "height": 0.1, "width": 0.1 } },
        "shaft": { "segments": [{ "length": 1, "elements": 1, "section": "a", "material": "m" },
                                { "length": 1, "elements": 1, "section": "b", "material": "m" }] },
        "loads": [{ "at": 1, "force": [1, 0, 0], "acts_on": "rim" }]
    });
    let case = LoadedCase::from_value("bad.json", step).unwrap_or_else(|e| panic!("{e}"));
    let error = Model::new(&case).expect_err("a step");
    assert!(error.to_string().contains("loads.0.acts_on") && error.exit_code() == 2, "{error}");
}

/// A bore beside a solid: the step has the tube's bore and the smaller rim, and holds the mean of both sides.
#[test]
fn a_step_shares_its_boundaries() {
    let case = json!({
        "title": "step", "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7800 } },
        "sections": { "a": { "shape": "circle", "radius": 0.18 }, "b": tube(0.2, 0.15) },
        "shaft": { "segments": [
            { "length": 1, "elements": 2, "section": "a", "material": "m", "element": "34X3" },
            { "length": 1, "elements": 2, "section": "b", "material": "m", "element": "34R23" }] },
        "supports": [{ "at": 0, "kind": "clamped" }, { "at": 1, "kind": "roller", "acts_on": "rim" }],
        "loads": [{ "at": 2, "force": [0, 1e5, 0], "acts_on": "bore" }],
        "probes": points_around(0.18, 0.18, 1.0, 24)
    });
    let loaded = LoadedCase::from_value("step.json", case).unwrap_or_else(|e| panic!("{e}"));
    let found = statics(&loaded);
    let u = mean_displacement(&found);
    assert!(u[1].hypot(u[2]) < 1e-14, "{u:?}");
    let set = |word: &str| with(&loaded, json!({ "supports.1.acts_on": word }));
    let (bore, section) = (statics(&set("bore")), statics(&set("section")));
    let force = |s: &Static| s.reactions[1].force_n[1];
    for other in [&bore, &section] {
        assert!((force(other) / force(&found) - 1.0).abs() < 1e-2, "{} {}", force(other), force(&found));
    }
}
