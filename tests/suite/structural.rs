//! The nonlinear form of the comparison elements 3333s and 3333c.

use crate::common::{case, model, with};
use nalgebra::{Rotation3, Vector3};
use rotor::analysis::{spinup::spinup, statics::statics};
use rotor::element::ElementMatrices;
use rotor::element::Kernel;
use rotor::element::kernel::simd::Scratch;
use rotor::element::structural_3333s::{AXIAL_POINTS, StructuralElement};
use rotor::model::{ElementKind, Law, Material};
use rotor::section::Section;
use rotor::section::basis::SectionBasis;
use serde_json::json;

const KIND: ElementKind =
    ElementKind { axial_degree: 2, basis: SectionBasis::Monomials(1), law: Law::Structural };
const SIZE: usize = 27;
const LENGTH: f64 = 0.7;
const R: f64 = 0.25;

fn steel() -> Material {
    Material {
        youngs_modulus: 2.07e11,
        poisson_ratio: 0.3,
        density: 7850.0,
        stiffness_damping: 0.0,
        mass_damping: 0.0,
        loss_factor: 0.0,
    }
}

fn element(points: usize) -> StructuralElement {
    StructuralElement::new(&Section::circle(R), &steel(), LENGTH, R, points)
}

fn undeformed() -> Vec<f64> {
    let mut q = vec![0.0; SIZE];
    for node in 0..3 {
        q[9 * node] = LENGTH * node as f64 / 2.0;
        q[9 * node + 4] = R;
        q[9 * node + 8] = R;
    }
    q
}

/// A state of large strains: every coordinate moved by up to 0.15 R.
fn deformed() -> Vec<f64> {
    undeformed().iter().enumerate().map(|(i, v)| v + 0.15 * R * (1.0 + 2.7 * i as f64).sin()).collect()
}

fn turned(vectors: &[f64]) -> Vec<f64> {
    let rotation = Rotation3::from_scaled_axis(Vector3::new(0.9, -1.4, 0.6));
    let turn = |v: &[f64]| rotation * Vector3::new(v[0], v[1], v[2]);
    vectors.chunks_exact(3).flat_map(|v| <[f64; 3]>::from(turn(v))).collect()
}

fn evaluate(element: &StructuralElement, q: &[f64]) -> (f64, Vec<f64>) {
    let mut force = vec![f64::NAN; SIZE];
    let energy = element.internal_force(q, None, &mut force, &mut Scratch::default());
    (energy, force)
}

fn tangent(q: &[f64]) -> Vec<f64> {
    let mut tangent = vec![f64::NAN; SIZE * SIZE];
    element(AXIAL_POINTS).tangent(q, &mut tangent, &mut Scratch::default());
    tangent
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| v.abs().max(m))
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| (a - b).abs().max(m))
}

#[test]
fn force_and_tangent_are_the_derivatives_of_the_energy() {
    let (element, q) = (element(AXIAL_POINTS), deformed());
    let (_, force) = evaluate(&element, &q);
    let matrix = tangent(&q);
    let step = 1e-6 * R;
    let (mut slope, mut columns) = (Vec::new(), Vec::new());
    for j in 0..SIZE {
        let [(plus, force_plus), (minus, force_minus)] = [step, -step].map(|h| {
            let mut moved = q.clone();
            moved[j] += h;
            evaluate(&element, &moved)
        });
        slope.push((plus - minus) / (2.0 * step));
        columns.extend(force_plus.iter().zip(force_minus).map(|(p, m)| (p - m) / (2.0 * step)));
    }
    assert!(difference(&slope, &force) < 1e-6 * largest(&force));
    assert!(difference(&columns, &matrix) < 1e-6 * largest(&matrix));
    for i in 0..SIZE {
        for j in 0..i {
            assert_eq!(matrix[i * SIZE + j], matrix[j * SIZE + i]);
        }
    }
}

#[test]
fn tangent_of_the_undeformed_state_is_the_linear_stiffness() {
    let linear = ElementMatrices::new(KIND, &Section::circle(R), &steel(), LENGTH, R).stiffness;
    let linear: Vec<f64> = (0..SIZE * SIZE).map(|at| linear[(at % SIZE, at / SIZE)]).collect();
    assert!(difference(&tangent(&undeformed()), &linear) < 1e-10 * largest(&linear));
}

#[test]
fn rigid_motion_costs_nothing() {
    let mut q = turned(&undeformed());
    for node in 0..3 {
        for (c, shift) in [0.4, -1.1, 2.3].into_iter().enumerate() {
            q[9 * node + c] += shift;
        }
    }
    let (energy, force) = evaluate(&element(AXIAL_POINTS), &q);
    let scale = largest(&tangent(&undeformed())) * R;
    assert!(energy.abs() < 1e-24 * scale * R, "{energy}");
    assert!(largest(&force) < 1e-12 * scale, "{}", largest(&force));
}

#[test]
fn a_rotation_turns_the_force() {
    let (element, q) = (element(AXIAL_POINTS), deformed());
    let (energy, force) = evaluate(&element, &q);
    let (turned_energy, turned_force) = evaluate(&element, &turned(&q));
    assert!((turned_energy / energy - 1.0).abs() < 1e-12);
    assert!(difference(&turned_force, &turned(&force)) < 1e-12 * largest(&force));
}

/// Tip displacement (m) of the cantilever of Table 5.
fn tip(set: serde_json::Value) -> [f64; 3] {
    let found =
        statics(&model(&with(&case("table5-cantilever"), set))).unwrap_or_else(|e| panic!("{e}")).results;
    assert!(found.converged);
    found.probes[0].point.as_ref().expect("one point").displacement_m
}

fn close(ours: f64, reference: f64, rtol: f64) {
    assert!((ours / reference - 1.0).abs() <= rtol, "{ours} {reference}");
}

/// Published: 3333s (-0.15327, -0.71123), reproduced to every digit; 3333c (-0.15761, -0.7124), of which exact
/// integration is 0.41 % and 0.20 % beyond.
#[test]
fn table_5() {
    let tip_of = |name: &str| tip(json!({ "shaft.element": name, "shaft.segments.0.elements": 32 }));
    let [x, y, z] = tip_of("3333s");
    assert_eq!((format!("{x:.5}"), format!("{y:.5}"), z), ("-0.15327".into(), "-0.71123".into(), 0.0));
    let [x, y, _] = tip_of("3333c");
    close(x, -0.15761, 5e-3);
    close(y, -0.7124, 3e-3);
    close(x, -0.158259, 1e-5);
    close(y, -0.713852, 1e-5);
}

/// Four points against eight where the mesh is coarsest for the bend.
#[test]
fn four_points_along_the_axis_suffice() {
    let tip_of = |quadrature| {
        tip(
            json!({ "shaft.element": "3333s", "shaft.segments.0.elements": 2, "shaft.quadrature": quadrature }),
        )
    };
    let (four, eight) = (tip_of(json!("exact")), tip_of(json!({ "axial": 8 })));
    let finer = tip(json!({ "shaft.element": "3333s", "shaft.segments.0.elements": 4 }));
    assert!(difference(&four, &eight) < 1e-2 * difference(&eight, &finer));
}

/// Growth (mm) at 15000 rpm. Published: 3333s 0.02306, reproduced; 3333c 0.01617, here 0.2 % less.
#[test]
fn table_8() {
    for (name, published, rtol) in [("3333s", 0.02306e-3, 3e-4), ("3333c", 0.01617e-3, 3e-3)] {
        let set = json!({ "shaft.element": name, "shaft.segments.0.elements": 32, "spinup.steady": true });
        let model = model(&with(&case("table8-spin-circle"), set));
        let settings = model.spinup.as_ref().expect("a spinup block");
        let found = spinup(&model, settings, &|_, _| true).unwrap_or_else(|e| panic!("{e}")).results;
        found.last.growth_m.into_iter().for_each(|growth| close(growth, published, rtol));
    }
}

#[test]
fn what_the_element_does_not_offer_is_refused() {
    for (set, text) in [
        (json!({ "materials.steel.damping": { "stiffness": 1e-5 } }), "3333s has no stiffness damping"),
        (json!({ "shaft.quadrature": { "axial": 2 } }), "zero-energy modes"),
    ] {
        let set = with(&with(&case("table5-cantilever"), json!({ "shaft.element": "3333s" })), set);
        let Err(error) = statics(&model(&set)).map(|_| ()) else { panic!("accepted: {text}") };
        assert!(error.to_string().contains(text), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}
