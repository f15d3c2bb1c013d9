//! Steps of the diameter from hardly any to ten times, and integral disks from a twentieth of their radius, against solids.

use super::cell::{Cell, cell};
use super::linear::lowest;
use crate::cubic_solid::{Solid, SolidSegment};
use crate::kinks::{STEEL_NUMBERS, stepped};
use rotor::results::ModeKind;
use serde_json::json;

/// First bending frequency of a free solid, rad/s.
fn solid(pieces: &[[f64; 3]]) -> f64 {
    let [youngs_modulus, poisson_ratio, density] = STEEL_NUMBERS;
    let segments =
        pieces.iter().map(|&[length, outer, inner]| SolidSegment { length, outer, inner }).collect();
    let solid = Solid { youngs_modulus, poisson_ratio, density, segments, end_springs: [0.0; 2] };
    solid.bending_frequencies(1)[0] * std::f64::consts::TAU
}

pub fn steps() -> Vec<Cell> {
    let mut list = Vec::new();
    let mut add = |family, name: String, pieces: &[[f64; 3]], elements: &[&str]| {
        let exact = solid(pieces);
        for element in elements {
            let case = stepped(pieces, element, 4, STEEL_NUMBERS, json!({ "modes": { "count": 12 } }));
            let name = format!("{name}, {element}");
            let bending = lowest(ModeKind::Bending);
            list.push(cell(family, name, "1st bending, solid", &case, bending, -1, (exact, 6e-3)));
        }
    };
    for ratio in [1.02, 1.1, 1.3, 2.0, 4.0, 10.0] {
        let pieces = [[0.3, 0.02, 0.0], [0.2 * ratio, 0.02 * ratio, 0.0], [0.3, 0.02, 0.0]];
        add("step R_2 / R_1", format!("{ratio}"), &pieces, &["34X3", "auto"]);
    }
    for share in [0.05, 0.2, 1.0] {
        let pieces = [[0.3, 0.02, 0.0], [0.08 * share, 0.08, 0.0], [0.3, 0.02, 0.0]];
        add("disk length / R_2", format!("{share}"), &pieces, &["34X3", "auto"]);
    }
    list
}
