//! Tapered segments: closed forms of cones, energies by points, steps beside them, and limits under refinement.

use crate::common::{campbell, frequencies, model, of_kind, shaft, with};
use rotor::analysis::mass_properties::properties;
use rotor::analysis::statics::statics;
use rotor::element::kernel::simd::Scratch;
use rotor::element::kinked::KinkedElement;
use rotor::element::polynomial::NonlinearElement;
use rotor::element::quadrature::{gauss, section_rule};
use rotor::element::{ElementMatrices, Kernel, taper};
use rotor::instructions::Instructions;
use rotor::model::{ElementKind, Law, Material, Model, Quadrature};
use rotor::results::ModeKind;
use rotor::section::Section;
use rotor::section::basis::{SectionBasis, exponents};
use rotor::section::kinks::{Kink, Kinks};
use serde_json::{Value, json};
use std::f64::consts::PI;

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

fn kind(order: usize) -> ElementKind {
    ElementKind { axial_degree: 3, basis: SectionBasis::Monomials(order), law: Law::Continuum }
}

fn straight(vectors: usize) -> Vec<f64> {
    let mut q = vec![0.0; 12 * vectors];
    for node in 0..4 {
        q[3 * vectors * node] = LENGTH * node as f64 / 3.0;
        q[3 * (vectors * node + 1) + 1] = R;
        q[3 * (vectors * node + 2) + 2] = R;
    }
    q
}

fn deformed(vectors: usize) -> Vec<f64> {
    let wave = |(i, q): (usize, f64)| q + 0.004 * (1.7 * i as f64 + 0.3).sin();
    straight(vectors).into_iter().enumerate().map(wave).collect()
}

fn pairs() -> Vec<(&'static str, [Section; 2])> {
    let hollow = |a, b| Section { inner: [a, b], ..Section::ellipse(0.15, 0.2) };
    vec![
        ("cone", [Section::circle(0.2), Section::circle(0.1)]),
        ("bored cone", [Section::circle(0.2), Section::tube(0.15, 0.1)]),
        ("ellipse", [hollow(0.05, 0.1), Section::ellipse(0.1, 0.12)]),
        ("wedge", [Section::rectangle(0.3, 0.4), Section::rectangle(0.2, 0.1)]),
    ]
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Strain energy, and `q^T M q`, of a tapered element by points along and across it.
fn by_points(order: usize, faces: [&Section; 2], q: &[f64]) -> (f64, f64) {
    let list = exponents(order);
    let n = list.len();
    let factorial = |k: usize| (1..=k).map(|i| i as f64).product::<f64>();
    let power = |x: f64, k: usize| x.powi(k as i32) / factorial(k);
    let lower = |x: f64, k: usize| if k > 0 { power(x, k - 1) / R } else { 0.0 };
    let nodes = [-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0];
    let lagrange = |i: usize, xi: f64| -> f64 {
        (0..4).filter(|j| *j != i).map(|j| (xi - nodes[j]) / (nodes[i] - nodes[j])).product()
    };
    let (e, nu) = (MATERIAL.youngs_modulus, MATERIAL.poisson_ratio);
    let (lambda, mu) = (e * nu / (1.0 + nu) / (1.0 - 2.0 * nu), e / 2.0 / (1.0 + nu));
    let (mut energy, mut square) = (0.0, 0.0);
    for (xi, wx) in gauss(24) {
        let section = faces[0].between(faces[1], (1.0 + xi) / 2.0);
        let h = 1e-3;
        // exact for cubics
        let slope = |i: usize| {
            let d = |h: f64| (lagrange(i, xi + h) - lagrange(i, xi - h)) / (2.0 * h);
            (4.0 * d(h) - d(2.0 * h)) / 3.0 * 2.0 / LENGTH
        };
        let axial: Vec<[f64; 2]> = (0..4).map(|i| [lagrange(i, xi), slope(i)]).collect();
        for (y, z, w) in section_rule(&section, 14) {
            let weight = w * wx * LENGTH / 2.0;
            let mut f = [[0.0; 3]; 3];
            let mut r = [0.0; 3];
            for (i, [l, d]) in axial.iter().enumerate() {
                for (k, &(a, b)) in list.iter().enumerate() {
                    let value = power(y / R, a) * power(z / R, b);
                    let by = [lower(y / R, a) * power(z / R, b), power(y / R, a) * lower(z / R, b)];
                    for c in 0..3 {
                        let q = q[3 * (n * i + k) + c];
                        r[c] += l * value * q;
                        f[0][c] += d * value * q;
                        f[1][c] += l * by[0] * q;
                        f[2][c] += l * by[1] * q;
                    }
                }
            }
            let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let strain = |a: usize, b: usize| (dot(f[a], f[b]) - f64::from(a == b)) / 2.0;
            let trace: f64 = (0..3).map(|a| strain(a, a)).sum();
            let all: f64 = (0..9).map(|k| strain(k / 3, k % 3).powi(2)).sum();
            energy += weight * (lambda / 2.0 * trace * trace + mu * all);
            square += weight * MATERIAL.density * dot(r, r);
        }
    }
    (energy, square)
}

#[test]
fn energy_and_mass_of_tapered_elements_are_those_by_points() {
    for order in [1, 3, 5] {
        for (name, [a, b]) in pairs() {
            let n = kind(order).n_vectors();
            let q = deformed(n);
            let element =
                NonlinearElement::tapered(kind(order), [&a, &b], &MATERIAL, LENGTH, R, Quadrature::EXACT);
            let energy = element.internal_force(&q, None, &mut vec![0.0; q.len()], &mut Scratch::default());
            let (exact, square) = by_points(order, [&a, &b], &q);
            assert!((energy / exact - 1.0).abs() < 1e-9, "{name} {order}: {energy} {exact}");
            let matrices = ElementMatrices::tapered(
                (kind(order), &Kinks::NONE),
                ([&a, &b], &MATERIAL),
                &Default::default(),
                LENGTH,
                R,
            );
            let ours: f64 = (0..q.len())
                .map(|i| (0..q.len()).map(|j| q[i] * matrices.mass[(i, j)] * q[j]).sum::<f64>())
                .sum();
            assert!((ours / square - 1.0).abs() < 1e-11, "{name} {order}: {ours} {square}");
        }
    }
}

/// Force against energy, tangent against force and against the linear stiffness, viscous tangent alike.
fn consistent(name: &str, element: &dyn Kernel, linear: &ElementMatrices) {
    let n = element.size();
    let q = deformed(n / 12);
    let mut scratch = Scratch::default();
    let (mut f, mut k) = (vec![0.0; n], vec![0.0; n * n]);
    element.internal_force(&q, None, &mut f, &mut scratch);
    element.tangent(&q, &mut k, &mut scratch);
    let h = 1e-6;
    for i in (0..n).step_by(7) {
        let mut moved = |step: f64| {
            let mut q = q.clone();
            q[i] += step;
            let mut f = vec![0.0; n];
            (element.internal_force(&q, None, &mut f, &mut scratch), f)
        };
        let ((e1, f1), (e0, f0)) = (moved(h), moved(-h));
        assert!(((e1 - e0) / (2.0 * h) - f[i]).abs() < 1e-6 * largest(&f), "{name} {i}");
        let column: Vec<f64> = f1.iter().zip(&f0).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        for j in 0..n {
            assert!((column[j] - k[i * n + j]).abs() < 1e-6 * largest(&column), "{name} {i} {j}");
        }
    }
    let rest = straight(n / 12);
    let mut viscous = vec![0.0; n * n];
    element.tangent(&rest, &mut k, &mut scratch);
    element.viscous_tangent(&rest, &mut viscous, &mut scratch);
    let size = largest(&k);
    for i in 0..n {
        for j in 0..n {
            let right = linear.stiffness[(i, j)];
            assert!((k[j * n + i] - right).abs() < 1e-11 * size, "{name} at rest {i} {j}");
            let beta = MATERIAL.stiffness_damping;
            assert!(
                (viscous[j * n + i] - beta * right).abs() < 1e-11 * beta * size,
                "{name} viscous {i} {j}"
            );
        }
    }
}

#[test]
fn forces_of_tapered_elements_follow_from_their_energy() {
    for (name, [a, b]) in pairs() {
        let element = NonlinearElement::tapered(kind(3), [&a, &b], &MATERIAL, LENGTH, R, Quadrature::EXACT);
        let linear = ElementMatrices::tapered(
            (kind(3), &Kinks::NONE),
            ([&a, &b], &MATERIAL),
            &Default::default(),
            LENGTH,
            R,
        );
        consistent(name, &element, &linear);
    }
}

#[test]
fn forces_of_kinked_tapers_follow_from_their_energy() {
    let of = |radius: f64, degree, inward| Kink { radius, scale: 0.05, degree, inward };
    let solid = ([Section::circle(0.2), Section::circle(0.15)], Kinks::new(&[of(0.1, 2, false)]));
    let bored = (
        [Section::tube(0.2, 0.02), Section::tube(0.18, 0.04)],
        Kinks::new(&[of(0.08, 1, true), of(0.12, 2, false)]),
    );
    for (name, ([a, b], kinks)) in [("solid", solid), ("bored", bored)] {
        let with = (Quadrature::EXACT, Instructions::Widest);
        let element = KinkedElement::new((kind(2), &kinks), [&a, &b], &MATERIAL, LENGTH, R, with);
        let linear = ElementMatrices::tapered(
            (kind(2), &kinks),
            ([&a, &b], &MATERIAL),
            &Default::default(),
            LENGTH,
            R,
        );
        consistent(name, &element, &linear);
    }
}

#[test]
fn the_stations_of_a_taper_are_the_fewest_that_are_exact() {
    assert_eq!(taper::linear_stations(kind(3), &Kinks::NONE), 8);
    assert_eq!(taper::nonlinear_stations(kind(3), &Kinks::NONE), 12);
    let [a, b] = [Section::circle(0.2), Section::circle(0.02)];
    let q = deformed(10);
    let energy = |axial: Option<usize>| {
        let rule = Quadrature { axial, section: None };
        let element = NonlinearElement::tapered(kind(3), [&a, &b], &MATERIAL, LENGTH, R, rule);
        element.internal_force(&q, None, &mut vec![0.0; q.len()], &mut Scratch::default())
    };
    assert!((energy(None) / energy(Some(20)) - 1.0).abs() < 1e-13);
    assert!((energy(Some(7)) / energy(Some(20)) - 1.0).abs() > 1e-12);
}

/// A cone of steel without Poisson's effect from radius a to b.
fn cone(a: f64, b: f64, length: f64, elements: usize, more: Value) -> rotor::case::LoadedCase {
    let mut case = shaft(json!({ "shape": "circle", "radius": a }), length, elements, more).value;
    case["sections"]["t"] = json!({ "shape": "circle", "radius": b });
    case["shaft"]["segments"][0]["to_section"] = json!("t");
    rotor::case::LoadedCase::from_value("cone.json", case).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn mass_and_inertia_of_a_cone_are_the_closed_forms() {
    let (a, b, l, rho) = (0.03, 0.07, 0.5, 7800.0);
    let p = properties(&model(&cone(a, b, l, 5, json!({}))));
    let near = |ours: f64, right: f64| assert!((ours / right - 1.0).abs() < 1e-12, "{ours} {right}");
    // int r^n dx of a radius that is linear
    let power = |n: i32| l * (b.powi(n + 1) - a.powi(n + 1)) / (f64::from(n + 1) * (b - a));
    near(p.shaft, rho * PI * power(2));
    near(p.polar, rho * PI / 2.0 * power(4));
    // int x r^2 with x = (r - a) / s
    let s = (b - a) / l;
    near(p.center[0], (power(3) - a * power(2)) / s / power(2));
    let about_end = (power(4) - 2.0 * a * power(3) + a * a * power(2)) / (s * s);
    near(p.diametral[0], rho * PI * (power(4) / 4.0 + about_end - p.center[0].powi(2) * power(2)));
}

#[test]
fn a_conical_rod_vibrates_and_stretches_as_in_closed_form() {
    let (a, b, l, e, rho): (f64, f64, f64, f64, f64) = (0.02, 0.04, 2.0, 2.1e11, 7800.0);
    let more = json!({
        "materials": { "m": { "nu": 0.0 } }, "shaft": { "element": "34X2" }, "modes": { "count": 30 },
        "supports": [{ "at": 0, "kind": "clamped" }], "loads": [{ "at": l, "force": [1e3, 0, 0] }],
        "probes": [{ "name": "end", "at": l }]
    });
    let case = cone(a, b, l, 10, more);
    // u = v / r with v'' + k^2 v = 0, clamped at the thin end: tan k l = k b / s
    let s = (b - a) / l;
    let lack = |k: f64| (k * l).sin() * s - (k * l).cos() * k * b;
    let ours = of_kind(&case, ModeKind::Axial);
    for (n, ours) in ours.iter().take(2).enumerate() {
        let (mut low, mut high) = ((n as f64 + 1e-9) * PI / l, (n as f64 + 0.5) * PI / l);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if lack(low) * lack(middle) <= 0.0 { high = middle } else { low = middle }
        }
        let right = low * (e / rho).sqrt();
        assert!((ours / right - 1.0).abs() < 3e-4, "{n}: {ours} {right}");
    }
    let found = statics(&model(&case)).unwrap_or_else(|e| panic!("{e}")).results;
    let end = found.probes[0].point.as_ref().expect("a point").displacement_m[0];
    let right = 1e3 * l / (PI * e * a * b);
    assert!((end / right - 1.0).abs() < 3e-4, "{end} {right}");
}

/// A shaft with a step to a taper, meshed with any numbers of elements.
fn stepped(element: &str, elements: [u64; 3], end: f64) -> rotor::case::LoadedCase {
    let circle = |r: f64| json!({ "shape": "circle", "radius": r });
    let segment = |length: f64, n: u64, section: &str, to: Value| json!({ "length": length, "elements": n, "section": section, "to_section": to, "material": "m" });
    let value = json!({
        "title": "step to a taper", "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7800 } },
        "sections": { "thin": circle(0.02), "thick": circle(0.04), "end": circle(end) },
        "shaft": { "element": element, "segments": [
            segment(0.3, elements[0], "thin", Value::Null),
            segment(0.4, elements[1], "thick", json!("end")),
            segment(0.3, elements[2], "end", Value::Null)
        ] },
        "supports": [{ "at": 0, "kind": "bearing", "stiffness": 1e8 }, { "at": 1, "kind": "bearing", "stiffness": 1e8 }],
        "modes": { "count": 10 }
    });
    rotor::case::LoadedCase::from_value("stepped.json", value).unwrap_or_else(|e| panic!("{e}"))
}

fn bending(case: &rotor::case::LoadedCase) -> Vec<f64> {
    of_kind(case, ModeKind::Bending).into_iter().step_by(2).take(3).collect()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn frequencies_of_a_taper_settle_under_refinement() {
    for element in ["34X2", "34X4"] {
        let list = [10, 40, 320].map(|n| bending(&stepped(element, [n, n, n], 0.025)));
        assert!(apart(&list[0], &list[2]) < 1e-2 && apart(&list[1], &list[2]) < 3e-3, "{element}: {list:?}");
        // a disk of no weight cuts an element a thousand times shorter from the taper
        let point = json!({ "at": 0.3 + 0.04 - 4e-5, "mass": 1e-9 });
        let short =
            with(&stepped(element, [10, 10, 10], 0.025), json!({ "disks": [point], "modes.count": 10 }));
        let soft = with(&short, json!({ "disks.0.hub": "soft" }));
        assert!(apart(&bending(&soft), &list[0]) < 1e-3, "{element}: {:?} {:?}", bending(&soft), list[0]);
    }
}

#[test]
fn a_slight_taper_beside_a_step_is_the_step_of_its_face() {
    for element in ["34X3", "34X3k3", "auto"] {
        let [plain, slight] = [0.04, 0.039_999].map(|end| bending(&stepped(element, [6, 8, 6], end)));
        assert!(apart(&plain, &slight) < 5e-4, "{element}: {plain:?} {slight:?}");
    }
    let kinked = Model::new(&stepped("34X3k3", [6, 8, 6], 0.025)).unwrap_or_else(|e| panic!("{e}"));
    let taper = |e: &&rotor::model::Element| e.is_tapered() && !e.kinks.is_empty();
    assert!(kinked.elements.iter().filter(taper).count() > 0);
    let [with, without] = ["34X3k3", "34X3"].map(|e| bending(&stepped(e, [6, 8, 6], 0.025))[0]);
    assert!(with < 0.999 * without, "{with} {without}");
}

#[test]
fn both_frames_agree_on_a_kinked_taper() {
    let sweep = |frame: &str| {
        let block = json!({ "speeds": { "from": 1000, "to": 2000, "count": 2 }, "modes": 4, "frame": frame });
        campbell(&with(&stepped("34X2k2", [3, 3, 2], 0.025), json!({ "campbell": block })))
    };
    let (still, turning) = (sweep("stationary"), sweep("rotating"));
    let speed = 2000.0;
    let mut seen: Vec<f64> = still.branches.iter().filter_map(|b| b.frequency_rad_s[1]).collect();
    for branch in &turning.branches {
        let Some(w) = branch.frequency_rad_s[1] else { continue };
        let meets = |x: &f64| [w + speed, w - speed, speed - w].iter().any(|v| (v / x - 1.0).abs() < 1e-6);
        seen.retain(|x| !meets(x));
    }
    assert!(seen.len() < still.branches.len() - 1, "{seen:?}");
}

#[test]
fn what_takes_no_taper_is_refused_with_a_remedy() {
    let base = stepped("34X3", [2, 2, 2], 0.025);
    for (set, path, words) in [
        (json!({ "shaft.element": "34R23" }), "section", "solid"),
        (json!({ "shaft.segments.1.element": "34R23" }), "to_section", "34X1 .. 34X5"),
        (json!({ "shaft.segments.1.element": "3333s" }), "to_section", "34X1 .. 34X5"),
        (
            json!({ "sections.end": { "shape": "rectangle", "height": 0.05, "width": 0.05 } }),
            "to_section",
            "shape",
        ),
        (json!({ "shaft.segments.1.to_section": "nothing" }), "to_section", "no section"),
        (json!({ "loads": [{ "surface": "rim", "pressure": 1e5 }] }), "surface", "to_section"),
    ] {
        let error = Model::new(&with(&base, set)).expect_err("refused").to_string();
        assert!(error.contains(path) && error.contains(words), "{error}");
    }
    // a hollow taper that names no element takes 34X5
    let hollow = with(
        &base,
        json!({ "sections.end": { "shape": "tube", "outer_radius": 0.03, "inner_radius": 0.02 }, "shaft.element": null }),
    );
    let members: Vec<String> = model(&hollow).elements.iter().map(|e| e.kind.name()).collect();
    assert_eq!(members, ["34X3", "34X3", "34X5", "34X5", "34R23", "34R23"]);
    assert!(frequencies(&hollow).iter().all(|w| w.is_finite()));
}
