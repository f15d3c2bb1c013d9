//! Nonlinear forces and static equilibrium: derivatives, rigid motions, objectivity, patches, published values.

use crate::common::{model, shaft, with};
use nalgebra::{Rotation3, Vector3};
use rotor::analysis::statics::statics;
use rotor::element::ElementMatrices;
use rotor::element::Kernel;
use rotor::element::kernel::simd::Scratch;
use rotor::element::polynomial::NonlinearElement;
use rotor::instructions::Instructions;
use rotor::model::{ElementKind, Law, Material, Quadrature};
use rotor::results::Static;
use rotor::section::Section;
use rotor::section::basis::{SectionBasis, exponents, vector_name};
use serde_json::{Value, json};

const MATERIAL: Material = Material {
    youngs_modulus: 2.1e11,
    poisson_ratio: 0.3,
    density: 7850.0,
    stiffness_damping: 1e-5,
    mass_damping: 0.0,
    loss_factor: 0.0,
};
const LENGTH: f64 = 0.4;
const R: f64 = 0.2;

/// Members, sections and quadratures whose forces are checked.
fn elements() -> Vec<(String, ElementKind, Section, Quadrature)> {
    let hollow = Section { inner: [0.05, 0.1], ..Section::ellipse(0.15, 0.2) };
    let cheap = Quadrature { axial: Some(4), section: Some(4) };
    let mut list = Vec::new();
    for order in 1..=5 {
        let kind =
            ElementKind { axial_degree: 3, basis: SectionBasis::Monomials(order), law: Law::Continuum };
        list.push((format!("34X{order} ellipse"), kind, hollow, Quadrature::EXACT));
        list.push((format!("34X{order} rectangle"), kind, Section::rectangle(0.3, 0.4), cheap));
    }
    let split = ElementKind { axial_degree: 2, basis: SectionBasis::Monomials(1), law: Law::Split };
    list.push(("3333c".to_owned(), split, Section::rectangle(0.3, 0.4), Quadrature::EXACT));
    list
}

fn element(kind: ElementKind, section: &Section, quadrature: Quadrature) -> NonlinearElement {
    NonlinearElement::new(kind, section, &MATERIAL, LENGTH, R, quadrature)
}

/// Undeformed coordinates.
fn straight(kind: ElementKind) -> Vec<f64> {
    let n = kind.n_vectors();
    let mut q = vec![0.0; 3 * n * kind.n_nodes()];
    for node in 0..kind.n_nodes() {
        q[3 * n * node] = LENGTH * node as f64 / kind.axial_degree as f64;
        q[3 * (n * node + 1) + 1] = R;
        q[3 * (n * node + 2) + 2] = R;
    }
    q
}

/// A state with strains of some per cent; every coordinate moves.
fn deformed(kind: ElementKind) -> Vec<f64> {
    straight(kind).iter().enumerate().map(|(i, q)| q + 0.004 * (1.7 * i as f64 + 0.3).sin()).collect()
}

fn force(element: &NonlinearElement, q: &[f64]) -> (f64, Vec<f64>) {
    let mut f = vec![0.0; q.len()];
    let energy = element.internal_force(q, None, &mut f, &mut Scratch::default());
    (energy, f)
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

#[test]
fn force_is_the_derivative_of_energy_and_tangent_that_of_force() {
    for (name, kind, section, quadrature) in elements() {
        let element = element(kind, &section, quadrature);
        let q = deformed(kind);
        let n = q.len();
        let (_, f) = force(&element, &q);
        let mut k = vec![0.0; n * n];
        element.tangent(&q, &mut k, &mut Scratch::default());
        let h = 1e-6;
        for i in 0..n {
            let moved = |step: f64| {
                let mut q = q.clone();
                q[i] += step;
                force(&element, &q)
            };
            let ((e1, f1), (e0, f0)) = (moved(h), moved(-h));
            let slope = (e1 - e0) / (2.0 * h);
            assert!((slope - f[i]).abs() < 1e-6 * largest(&f), "{name} {i}: {slope} {}", f[i]);
            let column: Vec<f64> = f1.iter().zip(&f0).map(|(a, b)| (a - b) / (2.0 * h)).collect();
            for j in 0..n {
                let ours = k[i * n + j];
                assert!((column[j] - ours).abs() < 1e-6 * largest(&column), "{name} {i} {j}");
                assert!(ours == k[j * n + i], "{name} symmetry {i} {j}");
            }
        }
    }
}

#[test]
fn the_tangent_of_the_undeformed_state_is_the_linear_stiffness() {
    for (name, kind, section, _) in elements() {
        let element = element(kind, &section, Quadrature::EXACT);
        let linear = ElementMatrices::new(kind, &section, &MATERIAL, LENGTH, R).stiffness;
        let n = element.size();
        let mut k = vec![0.0; n * n];
        element.tangent(&straight(kind), &mut k, &mut Scratch::default());
        for i in 0..n {
            for j in 0..n {
                let scale = (linear[(i, i)] * linear[(j, j)]).sqrt();
                assert!((k[i * n + j] - linear[(i, j)]).abs() < 1e-10 * scale, "{name} {i} {j}");
            }
        }
    }
}

/// `R q + translation`.
fn moved(q: &[f64], kind: ElementKind, rotation: &Rotation3<f64>, shift: Vector3<f64>) -> Vec<f64> {
    let n = kind.n_vectors();
    q.chunks_exact(3)
        .enumerate()
        .flat_map(|(k, v)| {
            let turned = rotation * Vector3::new(v[0], v[1], v[2]);
            let moved = if k % n == 0 { turned + shift } else { turned };
            [moved.x, moved.y, moved.z]
        })
        .collect()
}

#[test]
fn rigid_motions_cost_nothing_and_rotations_turn_the_force() {
    let rotation = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let shift = Vector3::new(0.3, -0.8, 0.5);
    for (name, kind, section, quadrature) in elements() {
        let element = element(kind, &section, quadrature);
        let scale = largest(&force(&element, &deformed(kind)).1);
        let (energy, f) = force(&element, &moved(&straight(kind), kind, &rotation, shift));
        assert!(largest(&f) < 1e-12 * scale && energy.abs() < 1e-12 * scale, "{name}: {energy:e}");
        let (e0, f0) = force(&element, &deformed(kind));
        let (e1, f1) = force(&element, &moved(&deformed(kind), kind, &rotation, shift));
        let turned = moved(&f0, kind, &rotation, Vector3::zeros());
        assert!((e1 / e0 - 1.0).abs() < 1e-12, "{name}");
        for (a, b) in f1.iter().zip(&turned) {
            assert!((a - b).abs() < 1e-12 * scale, "{name}");
        }
    }
}

#[test]
fn kelvin_voigt_forces_dissipate_and_ignore_rotation() {
    for (name, kind, section, quadrature) in elements() {
        let element = element(kind, &section, quadrature);
        let (q, n) = (deformed(kind), element.size());
        let (_, f0) = force(&element, &q);
        let viscous = |v: &[f64]| {
            let mut f = vec![0.0; n];
            element.internal_force(&q, Some(v), &mut f, &mut Scratch::default());
            f.iter().zip(&f0).map(|(a, b)| a - b).collect::<Vec<f64>>()
        };
        let v: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).cos()).collect();
        let f = viscous(&v);
        let power: f64 = f.iter().zip(&v).map(|(f, v)| f * v).sum();
        assert!(power > 0.0, "{name}");
        // a spin about x: v = J q
        let spin: Vec<f64> = q.chunks_exact(3).flat_map(|q| [0.0, -q[2], q[1]]).collect();
        assert!(largest(&viscous(&spin)) < 1e-10 * largest(&f), "{name}");
        let mut c = vec![0.0; n * n];
        element.viscous_tangent(&q, &mut c, &mut Scratch::default());
        for i in 0..n {
            let sum: f64 = (0..n).map(|j| c[j * n + i] * v[j]).sum();
            assert!((sum - f[i]).abs() < 1e-10 * largest(&f), "{name} {i}: {sum} {}", f[i]);
        }
        // without stress the tangent is the law alone: beta times it
        let (straight, mut k) = (straight(kind), vec![0.0; n * n]);
        element.viscous_tangent(&straight, &mut c, &mut Scratch::default());
        element.tangent(&straight, &mut k, &mut Scratch::default());
        let error: Vec<f64> = c.iter().zip(&k).map(|(c, k)| c - MATERIAL.stiffness_damping * k).collect();
        assert!(largest(&error) < 1e-12 * largest(&c), "{name}: {:e}", largest(&error) / largest(&c));
    }
}

#[test]
fn vector_instructions_of_all_widths_agree() {
    let narrow: Vec<Instructions> =
        Instructions::NAMED.into_iter().filter(|set| set.are_available()).collect();
    for (name, kind, section, quadrature) in elements() {
        let widest = element(kind, &section, quadrature);
        let (q, n) = (deformed(kind), widest.size());
        let v: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).cos()).collect();
        let all = |element: &NonlinearElement| {
            let (scratch, mut results) = (&mut Scratch::default(), [(); 2].map(|()| vec![0.0; n]).to_vec());
            results.extend([(); 2].map(|()| vec![0.0; n * n]));
            let energy = element.internal_force(&q, None, &mut results[0], scratch);
            element.internal_force(&q, Some(&v), &mut results[1], scratch);
            element.tangent(&q, &mut results[2], scratch);
            element.viscous_tangent(&q, &mut results[3], scratch);
            results.push(vec![energy]);
            results
        };
        let expected = all(&widest);
        for &set in &narrow {
            for (ours, expected) in all(&widest.clone().with_instructions(set)).iter().zip(&expected) {
                let scale = largest(expected);
                assert!(
                    ours.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * scale),
                    "{name} {set:?}"
                );
            }
        }
    }
}

fn solve(case: &rotor::case::LoadedCase) -> Static {
    statics(&model(case)).unwrap_or_else(|e| panic!("{e}")).results
}

/// Force on the axis of the free end of a clamped square bar, `0.5 x 0.5 x 2`: two independent programs agree on
/// these tips (x, y) to eight digits.
#[test]
fn the_square_cantilever_of_two_independent_programs() {
    let exact = [
        (62.5e6, 1, -0.00696548, -0.15217309),
        (62.5e6, 2, -0.00730311, -0.15629632),
        (62.5e6, 4, -0.00742662, -0.1578782),
        (62.5e6, 8, -0.00746292, -0.15832395),
        (125e6, 1, -0.02695102, -0.29856734),
        (125e6, 2, -0.02844405, -0.30762853),
        (125e6, 4, -0.02892274, -0.31072875),
        (125e6, 8, -0.02906231, -0.31159524),
    ];
    let gauss = [
        (62.5e6, 1, -0.00696691, -0.15217602),
        (62.5e6, 2, -0.00730276, -0.1562964),
        (62.5e6, 4, -0.00742651, -0.15787824),
        (62.5e6, 8, -0.00746288, -0.15832403),
        (125e6, 1, -0.02695789, -0.29859329),
        (125e6, 2, -0.02844278, -0.30762919),
        (125e6, 4, -0.02892231, -0.31072903),
        (125e6, 8, -0.02906225, -0.31159587),
    ];
    for (quadrature, table) in [(json!("exact"), exact), (json!({ "axial": 4, "section": 4 }), gauss)] {
        for (load, elements, x, y) in table {
            let case = shaft(
                json!({ "shape": "rectangle", "height": 0.5, "width": 0.5 }),
                2.0,
                elements,
                json!({
                    "materials": { "m": { "E": 2.07e11, "nu": 0.3, "rho": 7850 } },
                    "shaft": { "quadrature": quadrature },
                    "supports": [{ "at": 0, "fix": ["all"] }],
                    "loads": [{ "at": 2, "force": [0, -load, 0], "acts_on": "axis" }],
                    "probes": [{ "name": "tip", "at": 2 }]
                }),
            );
            let tip = solve(&case).probes[0].point.as_ref().expect("point").displacement_m;
            assert!((tip[0] / x - 1.0).abs() < 1e-6, "{quadrature} {elements}: {} {x}", tip[0]);
            assert!((tip[1] / y - 1.0).abs() < 1e-6, "{quadrature} {elements}: {} {y}", tip[1]);
        }
    }
}

/// A bar that may contract stretches homogeneously on an uneven mesh, for every member.
#[test]
fn homogeneous_stretch_is_exact_on_uneven_meshes() {
    for member in ["34X1", "34X2", "34X3", "34X4", "34X5"] {
        let traction = 2e9;
        let area = std::f64::consts::PI * 0.01;
        // the section at x = 0 stays plane and may contract
        let order = member.bytes().last().map_or(0, |c| usize::from(c - b'0'));
        let mut fix = vec!["r".to_owned(), "y.z".to_owned()];
        fix.extend(exponents(order).into_iter().skip(1).map(|e| format!("{}.x", vector_name(e))));
        let case = shaft(
            json!({ "shape": "circle", "radius": 0.1 }),
            1.0,
            1,
            json!({
                "shaft": { "element": member, "segments": [
                    { "length": 0.3, "elements": 1, "section": "s", "material": "m" },
                    { "length": 0.7, "elements": 2, "section": "s", "material": "m" }] },
                "supports": [{ "at": 0, "fix": fix }],
                "loads": [{ "at": 1, "force": [traction * area, 0, 0] }],
                "probes": [{ "name": "end", "at": 1, "y": 0.1 }, { "name": "middle", "at": 0.55, "y": 0.04, "z": 0.03 }]
            }),
        );
        let results = solve(&case);
        // P = lambda E (lambda^2 - 1) / 2 with free sides
        let (e, nu) = (2.1e11, 0.3);
        let mut stretch: f64 = 1.0;
        for _ in 0..50 {
            let p = e * (stretch.powi(3) - stretch) / 2.0 - traction;
            stretch -= p / (e * (3.0 * stretch * stretch - 1.0) / 2.0);
        }
        let side = (1.0 - nu * (stretch * stretch - 1.0)).sqrt();
        for probe in &results.probes {
            let point = probe.point.as_ref().expect("point");
            let u = point.displacement_m;
            assert!((u[0] - (stretch - 1.0) * probe.at_m).abs() < 1e-10, "{member} {u:?}");
            assert!((u[1] - (side - 1.0) * point.y_m).abs() < 1e-10, "{member} {u:?}");
            let cauchy = traction / (side * side);
            assert!((point.stress_pa.cauchy[0] / cauchy - 1.0).abs() < 1e-9, "{member}");
            assert!((point.stress_pa.von_mises / cauchy - 1.0).abs() < 1e-9, "{member}");
            assert!((point.stress_pa.i1 / cauchy - 1.0).abs() < 1e-9, "{member}");
        }
        let pull = results.reactions[0].force_n[0];
        assert!((pull / (-traction * area) - 1.0).abs() < 1e-9, "{member}: {pull}");
    }
}

/// Small loads agree with beam theory: tip force, end moments, weight.
#[test]
fn small_loads_agree_with_beam_theory() {
    let (l, r, e) = (2.0, 0.05, 2.1e11);
    let inertia = std::f64::consts::PI * f64::powi(r, 4) / 4.0;
    let area = std::f64::consts::PI * r * r;
    let tip = |more: Value| {
        let base =
            json!({ "supports": [{ "at": 0, "kind": "clamped" }], "probes": [{ "name": "tip", "at": 2 }] });
        let case = with(&shaft(json!({ "shape": "circle", "radius": r }), l, 8, base), json!({}));
        let mut value = case.value.clone();
        for (key, item) in more.as_object().expect("object") {
            value[key] = item.clone();
        }
        let case = rotor::case::LoadedCase::from_value("t.json", value).expect("case");
        solve(&case).probes[0].point.as_ref().expect("point").displacement_m
    };
    let shear = 1.0 + 0.75 * 2.6 / 0.886 * (r / l).powi(2);
    let u = tip(json!({ "loads": [{ "at": 2, "force": [0, -10, 20] }] }));
    let bend = l.powi(3) / (3.0 * e * inertia) * shear;
    assert!((u[1] / (-10.0 * bend) - 1.0).abs() < 1e-3 && (u[2] / (20.0 * bend) - 1.0).abs() < 1e-3, "{u:?}");
    let u = tip(json!({ "loads": [{ "at": 2, "moment": [0, 0, 30] }] }));
    assert!((u[1] / (30.0 * l * l / (2.0 * e * inertia)) - 1.0).abs() < 1e-4, "{u:?}");
    let u = tip(json!({ "loads": [{ "at": 2, "moment": [0, 30, 0], "acts_on": "axis" }] }));
    assert!((u[2] / (-30.0 * l * l / (2.0 * e * inertia)) - 1.0).abs() < 2e-2, "{u:?}");
    let u = tip(json!({ "gravity": [0, -9.81, 0] }));
    let sag = 7800.0 * area * 9.81 * l.powi(4) / (8.0 * e * inertia);
    assert!((u[1] / -sag - 1.0).abs() < 3e-3, "{u:?} {sag}");
    // a torque turns the end by M L / (G J)
    let base = json!({
        "supports": [{ "at": 0, "kind": "clamped" }], "loads": [{ "at": 2, "moment": [50, 0, 0] }],
        "probes": [{ "name": "rim", "at": 2, "y": r }]
    });
    let case = shaft(json!({ "shape": "circle", "radius": r }), l, 8, base);
    let u = solve(&case).probes[0].point.as_ref().expect("point").displacement_m;
    let twist = 50.0 * l / (e / 2.6 * 2.0 * inertia);
    assert!((u[2] / (r * twist) - 1.0).abs() < 1e-4, "{u:?}");
}

/// The unit of length does not matter.
#[test]
fn a_micrometre_cantilever_bends_as_a_metre_one() {
    let tip = |scale: f64| {
        let case = shaft(
            json!({ "shape": "ellipse", "semi_axis_y": 0.1 * scale, "semi_axis_z": 0.2 * scale }),
            2.0 * scale,
            4,
            json!({
                "supports": [{ "at": 0, "kind": "clamped" }],
                "loads": [{ "at": 2.0 * scale, "force": [0, -2e7 * scale * scale, 1e7 * scale * scale] }],
                "probes": [{ "name": "tip", "at": 2.0 * scale, "y": 0.1 * scale }]
            }),
        );
        let results = solve(&case);
        let point = results.probes[0].point.clone().expect("point");
        (point.displacement_m.map(|u| u / scale), point.stress_pa.von_mises)
    };
    let ((large, stress), (small, small_stress)) = (tip(1.0), tip(1e-6));
    for (a, b) in large.iter().zip(&small) {
        assert!((a - b).abs() < 1e-9 * largest(&large), "{large:?} {small:?}");
    }
    assert!((stress / small_stress - 1.0).abs() < 1e-8, "{stress} {small_stress}");
}

/// Euler's load of a column: below it the straight state is stable, above it not; a load that nothing carries ends
/// with the last state found.
#[test]
fn buckling_and_collapse_are_told() {
    let column = |load: f64| {
        let case = shaft(
            json!({ "shape": "circle", "radius": 0.05 }),
            4.0,
            8,
            json!({ "supports": [{ "at": 0, "kind": "clamped" }], "loads": [{ "at": 4, "force": [-load, 0, 0] }] }),
        );
        statics(&model(&case)).unwrap_or_else(|e| panic!("{e}"))
    };
    let inertia = std::f64::consts::PI * 0.05f64.powi(4) / 4.0;
    let euler = std::f64::consts::PI.powi(2) * 2.1e11 * inertia / (4.0 * 16.0);
    assert_eq!(column(0.97 * euler).results.newton.unstable_directions, 0);
    let beyond = column(1.03 * euler);
    assert_eq!(beyond.results.newton.unstable_directions, 2);
    assert!(beyond.diagnostics.iter().any(|d| d.code == "unstable-equilibrium"));
    let collapse = with(
        &crate::common::case("table7-compression"),
        json!({ "loads.0.traction.1": -1e11, "loads.1.traction.1": 1e11, "shaft.segments.0.elements": 2 }),
    );
    let outcome = statics(&model(&collapse)).unwrap_or_else(|e| panic!("{e}"));
    assert!(!outcome.results.converged && outcome.results.load_factor < 1.0);
    assert!(outcome.diagnostics.iter().any(|d| d.code == "not-converged"));
    assert!(outcome.diagnostics.iter().any(|d| d.code == "large-strain"));
}

/// A load along a motion that nothing resists has no equilibrium; one in balance needs no support.
#[test]
fn unsupported_motions_are_pinned_or_refused() {
    let free = |loads: Value| {
        let more = json!({ "loads": loads, "probes": [{ "name": "end", "at": 1 }] });
        statics(&model(&shaft(json!({ "shape": "circle", "radius": 0.05 }), 1.0, 4, more)))
    };
    let error = free(json!([{ "at": 1, "force": [0, 5, 0] }])).expect_err("no equilibrium").to_string();
    assert!(error.contains("translation along y"), "{error}");
    let outcome = free(json!([{ "at": 0, "force": [-1e5, 0, 0] }, { "at": 1, "force": [1e5, 0, 0] }]))
        .expect("balance");
    assert!(outcome.results.converged);
    assert!(outcome.diagnostics.iter().any(|d| d.code == "pinned-motions"));
}
