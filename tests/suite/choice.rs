//! What `"element": "auto"` and cases that name no element get: within 1e-3, by the closed form and finer members.

use crate::common::{frequencies, model, shaft, with};
use rotor::accuracy::locking_and_rounding::{bending_excess, torsion_excess};
use rotor::accuracy::radial_growth::{basis_error, closed_form};
use rotor::analysis::spinup::spinup;
use rotor::case::LoadedCase;
use rotor::check::element_choice::{Demands, choose};
use rotor::model::Material;
use rotor::section::Section;
use serde_json::{Value, json};

const AIM: f64 = 1e-3;

fn tube(outer: f64, inner: f64) -> Value {
    json!({ "shape": "tube", "outer_radius": outer, "inner_radius": inner })
}

fn steel(poisson_ratio: f64) -> Material {
    Material {
        youngs_modulus: 2.1e11,
        poisson_ratio,
        density: 7800.0,
        stiffness_damping: 0.0,
        mass_damping: 0.0,
        loss_factor: 0.0,
    }
}

/// Growth of rim and bore against the closed form of a long tube (Lame's terms in r, r^3 and 1/r), bending and torsion.
#[test]
fn chosen_rings_are_within_their_aim_from_narrow_to_wide_bores() {
    for share in [0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98] {
        let section = Section::tube(0.2, 0.2 * share);
        for material in [0.0, 0.2, 0.3, 0.35].map(steel) {
            let poisson_ratio = material.poisson_ratio;
            let choice =
                choose(&section, Demands { length: 10.0, half_waves: 3.0, spins_up: true, poisson_ratio });
            assert!(choice.basis.is_ring() && choice.estimate <= AIM, "{share}: {choice:?}");
            for r in [0.2, 0.2 * share] {
                let error = basis_error(&section, &material, choice.basis, r).expect("a tube");
                assert!(
                    error.abs() < AIM,
                    "{share} {r} nu {}: {error:e} with {}",
                    material.poisson_ratio,
                    choice.basis.member()
                );
            }
            assert!(bending_excess(&section, &material, choice.basis).expect("regular").abs() < AIM);
            assert!(torsion_excess(&section, choice.basis).expect("regular").abs() < AIM);
        }
    }
}

/// The same in a whole run, at the narrowest bore and at a wide one.
#[test]
fn a_spinning_tube_of_auto_grows_as_in_the_closed_form() {
    for share in [0.1, 0.6] {
        let more = json!({
            "shaft": { "element": "auto" },
            "spinup": { "drive": [{ "until": 1, "speed": 50 }], "steady": true },
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 8, "kind": "cylindrical" }],
            "probes": [{ "name": "rim", "at": 4, "y": 0.2 }, { "name": "bore", "at": 4, "y": 0.2 * share }]
        });
        let case = shaft(tube(0.2, 0.2 * share), 8.0, 4, more);
        let model = model(&case);
        let found =
            spinup(&model, model.spinup.as_ref().expect("a drive"), &|_, _| true).expect("a state").results;
        for (probe, r) in found.last.probes.iter().zip([0.2, 0.2 * share]) {
            let exact = closed_form(&model.sections[0], &model.materials[0], 50.0, r).expect("a tube");
            let error = probe.point.as_ref().expect("a point").displacement_m[1] / exact - 1.0;
            assert!(error.abs() < AIM, "{share} {r}: {error:e}");
        }
    }
}

/// Who names no element gets rings on walls and 34X3 on solids.
#[test]
fn a_case_without_an_element_takes_rings_on_walls() {
    let names = |case: &LoadedCase| -> Vec<String> {
        let model = model(case);
        model.elements.iter().map(|e| e.kind.name()).collect()
    };
    let hollow = shaft(tube(0.2, 0.15), 2.0, 2, json!({}));
    assert_eq!(names(&hollow), ["34R23"; 2]);
    assert_eq!(names(&with(&hollow, json!({ "shaft.element": "34X3" }))), ["34X3"; 2]);
    let solid = shaft(json!({ "shape": "circle", "radius": 0.1 }), 2.0, 2, json!({}));
    assert_eq!(names(&solid), ["34X3"; 2]);
    assert!(model(&solid).choices.is_empty() && model(&hollow).choices.len() == 1);
    let rectangle = json!({ "shape": "ellipse", "semi_axis_y": 0.1, "semi_axis_z": 0.2, "inner_semi_axis_y": 0.05, "inner_semi_axis_z": 0.05 });
    assert_eq!(names(&shaft(rectangle, 2.0, 2, json!({}))), ["34X5"; 2]);
}

fn two(left: (Value, &str), right: (Value, &str)) -> LoadedCase {
    let segment = |section: &str, element: &str| json!({ "length": 0.5, "elements": 3, "section": section, "material": "m", "element": element });
    let value = json!({
        "title": "two tubes",
        "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7800 } },
        "sections": { "a": left.0, "b": right.0 },
        "shaft": { "segments": [segment("a", left.1), segment("b", right.1)] },
        "modes": { "count": 14 }
    });
    LoadedCase::from_value("two.json", value).unwrap_or_else(|e| panic!("{e}"))
}

/// Rings that meet under "auto" take one degree, and a wide side of higher degree follows a thin one smoothly: its joint is
/// not stiffer than one that shares all functions but for a percent (3 % when it was kept small outside the shared area).
#[test]
fn joints_of_rings_of_unlike_degree_are_not_stiff() {
    let (thin, wide) = (tube(0.04, 0.015), tube(0.08, 0.015));
    let case = two((thin.clone(), "auto"), (wide.clone(), "auto"));
    let auto = model(&case);
    assert!(auto.elements.windows(2).all(|e| e[0].kind == e[1].kind), "{:?}", auto.choices);
    let of = |left: &str, right: &str| frequencies(&two((thin.clone(), left), (wide.clone(), right)));
    let shared = of("34R63", "34R63");
    for (left, right) in [("34R43", "34R63"), ("34R63", "34R43"), ("34R23", "34R33")] {
        for (a, b) in of(left, right)[6..].iter().zip(&shared[6..]) {
            assert!((a / b - 1.0).abs() < 0.016, "{left} {right}: {a} {b}");
        }
    }
}
