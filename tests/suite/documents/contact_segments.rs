//! How many integration segments a line of contact needs: 34X3 against 3333s, two cantilevers along each other.

use crate::common::{case, draw, with};
use crate::documents::convergence_figure::{Panel, svg};
use rotor::analysis::contact::contact;
use rotor::model::scene::Scene;
use serde_json::json;

const SEGMENTS: [usize; 6] = [1, 2, 3, 4, 6, 8];
/// Segments of the reference.
const REFERENCE: usize = 16;

/// Largest penetration (m) and force (N) between the cantilevers of four such elements with so many segments.
fn met(element: &str, segments: usize) -> [f64; 2] {
    let loaded = with(
        &case("parallel-cantilevers"),
        json!({
            "bodies.0.element": element, "bodies.1.element": element, "contact.segments": segments,
            "contact.load_steps": 1
        }),
    );
    let scene = Scene::new(&loaded).unwrap_or_else(|e| panic!("{e}"));
    let results = contact(&scene, &|_, _| true).expect("runs").results;
    assert!(results.converged && results.pairs[0].kind == Some("line-to-line"), "{element} {segments}");
    [results.largest_penetration_m, results.pairs[0].force_n[1].abs()]
}

/// The source's claim: 34X3 reaches a given error of the penetration with fewer segments. So it does down to what the largest of
/// some places of Gauss points can tell, a third of a percent.
#[test]
#[ignore = "long"]
fn a_line_needs_fewer_segments_of_34x3() {
    let (mut depths, mut forces) = (Vec::new(), Vec::new());
    let mut needed = Vec::new();
    for element in ["34X3", "3333s"] {
        let reference = met(element, REFERENCE);
        let errors = SEGMENTS.map(|n| {
            let [depth, force] = met(element, n);
            [depth / reference[0] - 1.0, force / reference[1] - 1.0]
        });
        let curve = |k: usize| (element.to_owned(), errors.iter().map(|e| e[k]).collect::<Vec<f64>>());
        depths.push(curve(0));
        forces.push(curve(1));
        let least = |bound: f64| {
            let last = errors.iter().rposition(|e| e[0].abs() > bound).map_or(0, |i| i + 1);
            SEGMENTS[last]
        };
        needed.push([0.03, 0.01, 0.004].map(least));
    }
    assert_eq!(needed, [[1, 2, 2], [3, 3, 3]], "{depths:?}");
    assert!(forces[0].1[0].abs() < forces[1].1[0].abs(), "{forces:?}");
    let panel = |title, curves, range| Panel {
        title,
        across: "integration segments per element",
        places: SEGMENTS.map(|n| n as f64).to_vec(),
        curves,
        range,
        slope: None,
    };
    let figure = svg(
        "Segments of a line of contact, against sixteen",
        &[panel("largest penetration", depths, [-4.0, -1.0]), panel("contact force", forces, [-6.0, -2.0])],
    );
    draw("docs/figures/contact-segments.svg", &figure);
}
