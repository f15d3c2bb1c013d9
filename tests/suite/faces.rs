//! Segments joined by a thin face: sections that do not overlap keep both sides plane.

use crate::common::{frequencies, model, of_kind, with};
use rotor::analysis::statics::statics;
use rotor::case::LoadedCase;
use rotor::model::Model;
use rotor::results::ModeKind;
use serde_json::{Value, json};
use std::f64::consts::PI;

const E: f64 = 2.1e11;

/// A solid shaft, a coupling tube around nothing of it, and a solid shaft again.
fn coupling(elements: [u64; 3], members: [&str; 2], tube: [f64; 2], more: Value) -> LoadedCase {
    let segment = |length: f64, n: u64, section: &str, element: &str, joint: Value| json!({ "length": length, "elements": n, "section": section, "material": "m", "element": element, "joint": joint });
    let [solid, wall] = members;
    let value = json!({
        "title": "coupling", "materials": { "m": { "E": E, "nu": 0.3, "rho": 7800 } },
        "sections": {
            "solid": { "shape": "circle", "radius": 0.02 },
            "tube": { "shape": "tube", "outer_radius": tube[0], "inner_radius": tube[1] }
        },
        "shaft": { "segments": [
            segment(0.3, elements[0], "solid", solid, Value::Null),
            segment(0.4, elements[1], "tube", wall, json!("face")),
            segment(0.3, elements[2], "solid", solid, json!("face"))
        ] },
        "supports": [{ "at": 0, "kind": "pinned" }, { "at": 1, "kind": "roller" }],
        "modes": { "count": 9 }
    });
    with(&LoadedCase::from_value("coupling.json", value).unwrap_or_else(|e| panic!("{e}")), more)
}

fn close(a: &[f64], b: &[f64], rtol: f64, what: &str) {
    for (a, b) in a.iter().zip(b).filter(|(_, b)| **b > 1.0) {
        assert!((a / b - 1.0).abs() <= rtol, "{what}: {a} {b}");
    }
}

#[test]
fn sections_that_do_not_overlap_need_a_face() {
    let case =
        coupling([2, 2, 2], ["34X3", "34R23"], [0.03, 0.025], json!({ "shaft.segments.1.joint": null }));
    let error = Model::new(&case).expect_err("no overlap").to_string();
    assert!(error.contains("\"joint\": \"face\""), "{error}");
    let first =
        coupling([2, 2, 2], ["34X3", "34R23"], [0.03, 0.025], json!({ "shaft.segments.0.joint": "face" }));
    assert!(Model::new(&first).expect_err("first").to_string().contains("shaft.segments.0.joint"));
}

#[test]
fn a_coupling_bends_as_a_beam_of_its_parts() {
    let supports = json!({
        "supports": [{ "at": 0, "kind": "clamped" }], "loads": [{ "at": 1.0, "force": [0, 10, 0] }],
        "probes": [{ "name": "end", "at": 1.0 }]
    });
    let case = coupling([4, 4, 4], ["34X3", "34R23"], [0.03, 0.025], supports);
    let found = statics(&model(&case)).unwrap_or_else(|e| panic!("{e}")).results;
    let end = found.probes[0].point.as_ref().expect("a point").displacement_m[1];
    let inertia = |a: f64, b: f64| PI / 4.0 * (b.powi(4) - a.powi(4));
    // int M^2 / EI, M = F (1 - x), and shear
    let bend = |from: f64, to: f64, i: f64| ((1.0 - from).powi(3) - (1.0 - to).powi(3)) / 3.0 / (E * i);
    let nu: f64 = 0.3;
    let g = E / 2.6;
    let solid = 6.0 * (1.0 + nu).powi(2) / (7.0 + 12.0 * nu + 4.0 * nu * nu) * g * PI * 0.02 * 0.02;
    let m2 = (0.025f64 / 0.03).powi(2);
    let wall = 6.0 * (1.0 + nu).powi(2) * (1.0 + m2).powi(2)
        / ((7.0 + 12.0 * nu + 4.0 * nu * nu) * (1.0 + m2).powi(2)
            + 4.0 * (5.0 + 6.0 * nu + 2.0 * nu * nu) * m2);
    let wall = wall * g * PI * (0.03 * 0.03 - 0.025 * 0.025);
    let (thin, tube) = (inertia(0.0, 0.02), inertia(0.025, 0.03));
    let right = 10.0
        * (bend(0.0, 0.3, thin) + bend(0.3, 0.7, tube) + bend(0.7, 1.0, thin) + 0.6 / solid + 0.4 / wall);
    // the faces hold the sections beside them, too
    assert!(end < right && end > 0.992 * right, "{end} {right}");
}

#[test]
fn a_face_settles_under_refinement() {
    for (members, name) in
        [(["34X2", "34R12"], "low"), (["34X4", "34R33"], "high"), (["34X3", "34X3"], "one member")]
    {
        let of = |n: u64, more: Value| frequencies(&coupling([n, n, n], members, [0.03, 0.025], more));
        let list = [10, 40, 160].map(|n| of(n, json!({})));
        close(&list[0], &list[2], 4e-3, name);
        close(&list[1], &list[2], 4e-4, name);
        // a neighbour a thousand times shorter
        let short = of(
            10,
            json!({ "loads": [{ "at": 0.3 + 4e-5, "force": [0, 1, 0] }, { "at": 0.3 - 3e-5, "force": [0, 1, 0] }] }),
        );
        close(&short, &list[0], 4e-3, "short");
    }
}

#[test]
fn a_face_is_a_rigid_disk_of_no_weight_but_for_its_width() {
    let tube = [0.03, 0.015];
    let case = coupling([6, 6, 6], ["34X3", "34R33"], tube, json!({}));
    let disk = |at: f64| json!({ "at": at, "mass": 1e-9, "polar_inertia": 0, "diametral_inertia": 0 });
    let joints = json!({
        "shaft.segments.1.joint": null, "shaft.segments.2.joint": null, "disks": [disk(0.3), disk(0.7)]
    });
    let hubs = with(&case, joints);
    for kind in [ModeKind::Bending, ModeKind::Torsion] {
        close(&of_kind(&case, kind), &of_kind(&hubs, kind), 1e-6, "hub");
    }
    // a hub does not widen where the shaft is pressed
    let [face, hub] = [&case, &hubs].map(|case| of_kind(case, ModeKind::Axial));
    assert!(face[0] < hub[0] && face[0] > 0.995 * hub[0], "{face:?} {hub:?}");
}
