//! What bearings, housings and couplings feel of the shaft: rows over the coordinates, and the matrices of their laws.

use super::{Contribution, Numbering, Region, affine_rows, displacement_weights, mean_rotation};
use crate::element::basis::{evaluate, lagrange};
use crate::model::{ActsOn, Bearing, Between, Element, Model, Node, Resists};
use faer::Mat;

/// A 2 x 2 law between what bearings resist (or its rate) and their forces.
pub fn bearing_contributions(
    model: &Model,
    numbering: &Numbering,
    law: impl Fn(&Bearing) -> [[f64; 2]; 2],
) -> Vec<Contribution> {
    let acts = |b: &&Bearing| law(b).iter().flatten().any(|&v| v != 0.0);
    let contribution = |bearing: &Bearing| {
        let (law, rows) = (law(bearing), bearing_rows(model, numbering, bearing));
        let mut coordinates: Vec<usize> = rows.iter().flatten().map(|entry| entry.0).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        let entry = |row: &[(usize, f64)], at: usize| row.iter().find(|e| e.0 == at).map(|e| e.1);
        let matrix = Mat::from_fn(coordinates.len(), coordinates.len(), |i, j| {
            let mut sum = 0.0;
            for (k, row) in rows.iter().enumerate() {
                for (l, column) in rows.iter().enumerate() {
                    if let (Some(a), Some(b)) = (entry(row, coordinates[i]), entry(column, coordinates[j])) {
                        sum += a * b * law[k][l];
                    }
                }
            }
            sum
        });
        Contribution { coordinates, matrix }
    };
    model.bearings.iter().filter(acts).map(contribution).collect()
}

/// Mean displacement along x, y, z and mean turn about x, y, z of the section at any position (m), interpolated as its element
/// does: six rows over the coordinates.
pub fn place_rows(model: &Model, numbering: &Numbering, x: f64) -> [Vec<(usize, f64)>; 6] {
    let Some((element, region)) = region_at(model, x) else { return Default::default() };
    section_motion(&region, model.reference_length, &shapes_at(numbering, element, x))
}

/// The element at a position and its whole section.
pub(super) fn region_at(model: &Model, x: f64) -> Option<(&Element, Region)> {
    let inside = |e: &&Element| x <= e.x + e.length * (1.0 + 1e-9);
    let element = model.elements.iter().find(inside).or(model.elements.last())?;
    Some((element, Region::of_field(model, element.field(), ActsOn::Section)?))
}

/// First coordinates of the vectors of an element with the values of their shape functions at a position; those that vanish are
/// left out.
pub(super) fn shapes_at(numbering: &Numbering, element: &Element, x: f64) -> Vec<(usize, f64)> {
    let xi = (2.0 * (x - element.x) / element.length - 1.0).clamp(-1.0, 1.0);
    let shapes = lagrange(element.kind.axial_degree);
    let nodes = shapes.iter().enumerate().map(|(i, n)| (numbering.of_element(element, i), evaluate(n, xi)));
    // at an element end the others vanish but for rounding
    nodes.filter(|(_, n)| n.abs() > 1e-12).collect()
}

/// Mean displacement along x, y, z and mean turn about x, y, z of a region whose vectors start at the given coordinates, with factors.
fn section_motion(region: &Region, r: f64, starts: &[(usize, f64)]) -> [Vec<(usize, f64)>; 6] {
    let [mean, along_y, along_z] = region.affine(r);
    let size = [region.moment(2, 0), region.moment(0, 2)];
    // int (y u_z - z u_y) / int (y^2 + z^2) by the slopes int y f / int y^2
    let share = |k: usize| size[k] / (size[0] + size[1]) / r;
    let row = |parts: &[(&Vec<f64>, usize, f64)]| -> Vec<(usize, f64)> {
        let mut row = Vec::new();
        for (start, factor) in starts {
            for (weights, component, scale) in parts {
                let used = weights.iter().enumerate().filter(|(_, w)| **w != 0.0);
                row.extend(used.map(|(k, w)| (start + 3 * k + component, factor * scale * w)));
            }
        }
        row
    };
    [
        row(&[(&mean, 0, 1.0)]),
        row(&[(&mean, 1, 1.0)]),
        row(&[(&mean, 2, 1.0)]),
        row(&[(&along_y, 2, share(0)), (&along_z, 1, -share(1))]),
        row(&[(&along_z, 0, 1.0 / r)]),
        row(&[(&along_y, 0, -1.0 / r)]),
    ]
}

/// What a coupling resists: mean displacements and turns of the section to its left less those of the one to its right.
fn coupling_rows(model: &Model, numbering: &Numbering, bearing: &Bearing) -> [Vec<(usize, f64)>; 2] {
    let Node { field, follower: Some(follower), .. } = model.nodes[bearing.node] else {
        return Default::default();
    };
    let starts: Vec<usize> = numbering.fields(bearing.node).collect();
    let mut rows: [Vec<(usize, f64)>; 6] = Default::default();
    for (side, (field, factor)) in [(field, 1.0), (follower, -1.0)].into_iter().enumerate() {
        let (Some(region), Some(&start)) =
            (Region::of_field(model, field, ActsOn::Section), starts.get(side))
        else {
            return Default::default();
        };
        let own = section_motion(&region, model.reference_length, &[(start, factor)]);
        rows.iter_mut().zip(own).for_each(|(row, own)| row.extend(own));
    }
    let [x, y, z, about_x, about_y, about_z] = rows;
    match bearing.resists {
        Resists::Lateral => [y, z],
        Resists::Tilt => [about_y, about_z],
        Resists::Axial => [x, Vec::new()],
        Resists::Torsion => [about_x, Vec::new()],
    }
}

/// Added mass of bearings and the mass of housings, on whole vectors.
pub fn bearing_mass(model: &Model, numbering: &Numbering) -> Vec<Contribution> {
    let whole = |part: Contribution| {
        let first = |i: usize| i - (i - numbering.start_of(i)) % 3;
        let mut vectors: Vec<usize> = part.coordinates.iter().map(|&i| first(i)).collect();
        vectors.dedup();
        let coordinates: Vec<usize> = vectors.iter().flat_map(|&v| [v, v + 1, v + 2]).collect();
        let place = |i: usize| part.coordinates.iter().position(|&c| c == coordinates[i]);
        let matrix = Mat::from_fn(coordinates.len(), coordinates.len(), |i, j| {
            place(i).zip(place(j)).map_or(0.0, |(i, j)| part.matrix[(i, j)])
        });
        Contribution { coordinates, matrix }
    };
    bearing_contributions(model, numbering, |b| b.mass).into_iter().map(whole).collect()
}

/// What a bearing resists, as two rows over the shaft's coordinates (the second empty along and about the axis): the mean
/// displacement of the section (or of what the bearing holds of it) in y and z, less that of the housing; the mean turn
/// about y and z, `int z u_x / int z^2` and `-int y u_x / int y^2`; the mean displacement along x; the mean turn about x,
/// `int (y u_z - z u_y) / int (y^2 + z^2)`.
pub fn bearing_rows(model: &Model, numbering: &Numbering, bearing: &Bearing) -> [Vec<(usize, f64)>; 2] {
    let Bearing { node, acts_on, .. } = *bearing;
    if bearing.between == Between::Halves {
        return coupling_rows(model, numbering, bearing);
    }
    let component = |rows: Vec<(usize, f64)>, c: usize, by: f64| -> Vec<(usize, f64)> {
        rows.into_iter().map(|(at, w)| (at + c, by * w)).collect()
    };
    match bearing.resists {
        Resists::Lateral => {
            let weights = match bearing.between {
                Between::HousingAndGround(_) => Vec::new(),
                _ => displacement_weights(model, node, acts_on),
            };
            let housing = match bearing.between {
                Between::ShaftAndGround | Between::Halves => None,
                Between::ShaftAndHousing(h) => Some((numbering.of_housing[h], -1.0)),
                Between::HousingAndGround(h) => Some((numbering.of_housing[h], 1.0)),
            };
            [1, 2].map(|c| {
                let entries = weights.iter().enumerate().filter(|(_, w)| **w != 0.0);
                let shaft = entries.map(|(k, w)| (numbering.index(node, k, c), *w));
                shaft.chain(housing.map(|(at, w)| (at + c, w))).collect()
            })
        }
        Resists::Tilt => {
            let per_length = 1.0 / model.reference_length;
            let [_, along_y, along_z] = affine_rows(model, numbering, node, acts_on);
            [component(along_z, 0, per_length), component(along_y, 0, -per_length)]
        }
        Resists::Axial => {
            let [mean, ..] = affine_rows(model, numbering, node, acts_on);
            [mean, Vec::new()]
        }
        Resists::Torsion => {
            let row = mean_rotation(model, node, acts_on);
            let turned =
                Region::new(model, node, if acts_on == ActsOn::Axis { ActsOn::Section } else { acts_on });
            let size = turned.map_or(1.0, |r| {
                (r.moment(2, 0) + r.moment(0, 2)) / (r.moment(0, 0) * model.reference_length)
            });
            let first = numbering.index(node, 0, 0);
            let entries = row.into_iter().enumerate().filter(|(_, w)| *w != 0.0);
            [entries.map(|(i, w)| (first + i, w / size)).collect(), Vec::new()]
        }
    }
}
