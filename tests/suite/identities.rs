//! Identities that hold exactly: mass and its moments, symmetry, rigid motions, joints.

use crate::common::{model, shaft, with};
use faer::Mat;
use proptest::prelude::*;
use rotor::analysis::mass_properties::properties;
use rotor::analysis::matrices::matrices;
use rotor::element::ElementMatrices;
use rotor::model::{ElementKind, Law, Material};
use rotor::section::Section;
use rotor::section::basis::SectionBasis;
use rotor::shaft::assembly::Assembly;
use rotor::shaft::spectrum::Spectrum;
use serde_json::{Value, json};

const MATERIAL: Material = Material {
    youngs_modulus: 2.1e11,
    poisson_ratio: 0.3,
    density: 7800.0,
    stiffness_damping: 0.0,
    mass_damping: 0.0,
    loss_factor: 0.0,
};

fn members() -> Vec<ElementKind> {
    let cubic = (1..=5).map(|n| ElementKind {
        axial_degree: 3,
        basis: SectionBasis::Monomials(n),
        law: Law::Continuum,
    });
    let compared = [Law::Split, Law::Structural].map(|law| ElementKind {
        axial_degree: 2,
        basis: SectionBasis::Monomials(1),
        law,
    });
    cubic.chain(compared).collect()
}

fn sections(kind: ElementKind) -> Vec<Section> {
    let circle = Section::circle(0.1);
    match kind.law {
        Law::Continuum => vec![
            circle,
            Section::tube(0.1, 0.07),
            Section::ellipse(0.1, 0.06),
            Section { inner: [0.05, 0.04], ..Section::ellipse(0.1, 0.06) },
            Section::rectangle(0.2, 0.1),
        ],
        Law::Split => vec![circle, Section::rectangle(0.2, 0.1)],
        Law::Structural => vec![circle],
    }
}

/// Element coordinates of the field `position -> r` that is linear in y and z: `(axis, r_,y, r_,z)` at x.
fn field(kind: ElementKind, length: f64, r: f64, at: impl Fn(f64) -> [[f64; 3]; 3]) -> Vec<f64> {
    let mut q = vec![0.0; 3 * kind.n_nodes() * kind.n_vectors()];
    for node in 0..kind.n_nodes() {
        let [axis, y, z] = at(length * node as f64 / kind.axial_degree as f64);
        for c in 0..3 {
            let start = 3 * node * kind.n_vectors();
            q[start + c] = axis[c];
            q[start + 3 + c] = y[c] * r;
            q[start + 6 + c] = z[c] * r;
        }
    }
    q
}

fn energy(a: &Mat<f64>, p: &[f64], q: &[f64]) -> f64 {
    (0..p.len()).map(|i| (0..q.len()).map(|j| p[i] * a[(i, j)] * q[j]).sum::<f64>()).sum()
}

/// Total mass, centre and second moments from the mass matrix equal those of the body.
#[test]
fn mass_and_its_moments() {
    let (length, r) = (0.5, 0.1);
    for kind in members() {
        for section in sections(kind) {
            let m = ElementMatrices::new(kind, &section, &MATERIAL, length, r).mass;
            let mass = MATERIAL.density * section.area() * length;
            let moved = field(kind, length, r, |_| [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
            let along = field(kind, length, r, |x| [[x, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
            let in_y = field(kind, length, r, |_| [[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]]);
            let in_z = field(kind, length, r, |_| [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]]);
            let close = |a: f64, b: f64| {
                assert!((a - b).abs() <= 1e-12 * b.abs().max(1e-9 * mass), "{kind:?} {a} {b}")
            };
            close(energy(&m, &moved, &moved), mass);
            close(energy(&m, &moved, &along), mass * length / 2.0);
            close(energy(&m, &along, &along), mass * length * length / 3.0);
            close(energy(&m, &in_y, &in_y), MATERIAL.density * section.moment(2, 0) * length);
            close(energy(&m, &in_z, &in_z), MATERIAL.density * section.moment(0, 2) * length);
            close(energy(&m, &in_y, &in_z), 0.0);
        }
    }
}

/// M and K0 are symmetric, M positive; G is skew and N symmetric for round sections.
#[test]
fn symmetry() {
    for kind in members() {
        for section in sections(kind) {
            let e = ElementMatrices::new(kind, &section, &MATERIAL, 0.5, 0.1);
            let odd = |a: &Mat<f64>| (a - a.transpose()).norm_max() / a.norm_max();
            assert!(odd(&e.mass) < 1e-15 && odd(&e.stiffness) < 1e-15 && odd(&e.spin_softening) < 1e-15);
            assert!(e.mass.llt(faer::Side::Lower).is_ok(), "{kind:?} {section:?}");
            if section.is_axisymmetric() {
                let even = (&e.gyroscopic + e.gyroscopic.transpose()).norm_max() / e.gyroscopic.norm_max();
                assert!(even < 1e-15, "{kind:?} {even:.1e}");
            }
        }
    }
}

/// Translations and small rotations cost no energy: the force they cause is rounding error.
#[test]
fn rigid_motions_give_no_force() {
    let (length, r) = (0.5, 0.1);
    for kind in members() {
        for section in sections(kind) {
            let k = ElementMatrices::new(kind, &section, &MATERIAL, length, r).stiffness;
            for motion in 0..6 {
                let q = field(kind, length, r, |x| match motion {
                    0..=2 => [std::array::from_fn(|c| f64::from(c == motion)), [0.0; 3], [0.0; 3]],
                    3 => [[0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
                    4 => [[0.0, 0.0, -x], [0.0; 3], [1.0, 0.0, 0.0]],
                    _ => [[0.0, x, 0.0], [-1.0, 0.0, 0.0], [0.0; 3]],
                });
                for i in 0..q.len() {
                    let force: f64 = (0..q.len()).map(|j| k[(i, j)] * q[j]).sum();
                    let scale: f64 = (0..q.len()).map(|j| (k[(i, j)] * q[j]).abs()).sum();
                    assert!(
                        force.abs() <= 1e-13 * scale.max(k.norm_max() * 1e-3),
                        "{kind:?} motion {motion}"
                    );
                }
            }
        }
    }
}

/// Uniaxial tension on an uneven mesh, every order: constant strain, so no force anywhere but at the ends.
#[test]
fn patch_of_uneven_elements() {
    let segment = |length: f64| json!({ "length": length, "elements": 1, "section": "s", "material": "m" });
    for section in [
        json!({ "shape": "circle", "radius": 0.1 }),
        json!({ "shape": "rectangle", "height": 0.2, "width": 0.1 }),
    ] {
        for element in ["34X1", "34X2", "34X3", "34X4", "34X5", "3333c"] {
            let segments = json!([segment(0.3), segment(0.1), segment(0.45), segment(0.15)]);
            let case = with(
                &shaft(section.clone(), 1.0, 1, json!({})),
                json!({ "shaft.segments": segments, "shaft.element": element }),
            );
            let model = model(&case);
            let assembly = Assembly::unconstrained(&model);
            let (r, nu) = (model.reference_length, 0.3);
            // a stretch of one along x with the lateral contraction nu, which needs no lateral forces
            let mut q = vec![0.0; assembly.size()];
            for (node, at) in model.nodes.iter().enumerate() {
                q[assembly.numbering.index(node, 0, 0)] = at.x;
                q[assembly.numbering.index(node, 1, 1)] = -nu * r;
                q[assembly.numbering.index(node, 2, 2)] = -nu * r;
            }
            let column = Mat::from_fn(q.len(), 1, |i, _| q[i]);
            let force = rotor::linalg::sparse::multiply(&assembly.stiffness(), column.as_ref());
            let last = model.nodes.len() - 1;
            let ends: Vec<usize> =
                assembly.numbering.of_node(0).chain(assembly.numbering.of_node(last)).collect();
            let scale = MATERIAL.youngs_modulus * model.sections[0].area();
            for i in (0..q.len()).filter(|i| !ends.contains(i)) {
                assert!(force[(i, 0)].abs() <= 1e-12 * scale, "{element} {i}: {}", force[(i, 0)] / scale);
            }
            let pull = force[(assembly.numbering.index(last, 0, 0), 0)];
            assert!((pull / scale - 1.0).abs() < 1e-12, "E A {pull}");
        }
    }
}

/// The mass matrix of a rotor with disks and steps moves as the body that `check` describes.
#[test]
fn check_agrees_with_the_matrices() {
    for stem in ["bauchau", "two-disk-stepped", "friswell-591"] {
        let model = model(&crate::common::case(stem));
        let p = properties(&model);
        let (rows, list) = matrices(&model);
        let m = list.iter().find(|m| m.name == "M").expect("M");
        let unit: Vec<f64> = rows.iter().map(|r| f64::from(r.vector == "r" && r.component == "y")).collect();
        let turn: Vec<f64> = rows
            .iter()
            .map(|r| match (r.vector.as_str(), r.component) {
                ("y", "z") => 1.0,
                ("z", "y") => -1.0,
                _ => 0.0,
            })
            .collect();
        let product = |a: &[f64], b: &[f64]| m.entries.iter().map(|&(i, j, v)| a[i] * v * b[j]).sum::<f64>();
        assert!((product(&unit, &unit) / p.mass() - 1.0).abs() < 1e-12);
        assert!(
            (product(&turn, &turn) / p.polar - 1.0).abs() < 1e-12,
            "{stem}: {} {}",
            product(&turn, &turn),
            p.polar
        );
    }
}

fn random_case(
    radius: f64,
    bore: f64,
    length: f64,
    elements: usize,
    order: usize,
    more: Value,
) -> rotor::case::LoadedCase {
    let section = if bore > 0.0 {
        json!({ "shape": "tube", "outer_radius": radius, "inner_radius": bore * radius })
    } else {
        json!({ "shape": "circle", "radius": radius })
    };
    let case = shaft(section, length, elements, more);
    with(&case, json!({ "shaft.element": format!("34X{order}"), "modes.count": 14 }))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Random shafts: real frequencies, proved complete; rigid motions found as such; more support never
    /// lowers a frequency; a reversed spin reverses the whirl.
    #[test]
    fn random_shafts(
        radius in 0.01..0.2f64, bore in prop_oneof![Just(0.0), 0.3..0.9f64], slenderness in 4.0..60.0f64,
        elements in 1usize..6, order in 1usize..5, k in 3.0..10.0f64, extra in 3.0..10.0f64, place in 0.0..1.0f64,
    ) {
        let length = slenderness * radius;
        let bearing = |at: f64, k: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[k, 0], [0, 0.7 * k]] });
        let (k, extra) = (10f64.powf(k), 10f64.powf(extra));
        let two = json!([bearing(0.0, k), bearing(length, k)]);
        let three = json!([bearing(0.0, k), bearing(length, k), bearing(0.0, extra)]);
        let loose = random_case(radius, bore, length, elements, order, json!({ "supports": two }));
        let tight = random_case(radius, bore, length, elements, order, json!({ "supports": three }));
        let free = random_case(radius, bore, length, elements, order, json!({}));
        for (case, rigid) in [(&free, 6), (&loose, 2)] {
            let model = model(case);
            let found = rotor::analysis::modes::modes(&model).unwrap().results;
            prop_assert_eq!(found.rigid_modes, rigid);
            prop_assert!(found.sturm_count_agrees);
            prop_assert!(found.modes[rigid..].iter().all(|m| m.frequency_rad_s > 0.0 && m.relative_residual <= 1e-10));
        }
        for (a, b) in crate::common::frequencies(&loose).iter().zip(crate::common::frequencies(&tight)) {
            prop_assert!(b >= a * (1.0 - 1e-7), "{} {}", a, b);
        }
        let speed = place * 1000.0;
        let model = model(&loose);
        let assembly = Assembly::new(&model);
        let spectrum = Spectrum::new(&assembly, 16).unwrap();
        let (frame, all) = (rotor::model::WhirlFrame::Stationary, rotor::model::Gyroscopic::All);
        let operators = rotor::analysis::campbell::operators::Operators::new(&assembly, &spectrum, frame, all, None);
        let reduced = rotor::analysis::campbell::reduced_basis::Reduced::new(&operators, &spectrum, 16, 8).unwrap();
        let (a, b) = (reduced.solve(speed).unwrap(), reduced.solve(-speed).unwrap());
        for (p, q) in a.motions.iter().zip(&b.motions).take(8) {
            prop_assert!((p.lambda.im - q.lambda.im).abs() <= 1e-7 * p.lambda.im);
        }
        let whirl = |s: &rotor::analysis::campbell::reduced_basis::Solution| -> f64 {
            s.motions.iter().take(8).map(|m| reduced.travel_of(m).abs()).sum()
        };
        prop_assert!((whirl(&a) - whirl(&b)).abs() < 1e-3);
    }
}
