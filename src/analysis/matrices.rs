//! `rotor matrices`: the unconstrained system matrices in physical units.

use crate::linalg::sparse::Sparse;
use crate::model::{Field, Gyroscopic, Model, Node};
use crate::results::{MatrixRow, PhysicalMatrix};
use crate::shaft::assembly::Assembly;

/// `M`, `G`, `N`, `K0` of the unconstrained shaft with disks, hubs and bearings, and the meaning of their
/// rows. Unknowns are the derivatives themselves (not scaled by the reference length).
pub fn matrices(model: &Model) -> (Vec<MatrixRow>, Vec<PhysicalMatrix>) {
    let assembly = Assembly::unsupported(model);
    let mut rows = Vec::new();
    let mut scale = Vec::new();
    for (node, at) in model.nodes.iter().enumerate() {
        for (vector, power) in free_vectors(&assembly, node) {
            for component in ["x", "y", "z"] {
                rows.push(MatrixRow { node: node + 1, x_m: at.x, vector: vector.clone(), component });
                scale.push(model.reference_length.powi(power));
            }
        }
        for disk in (0..model.disks.len())
            .filter(|&d| model.disks[d].node == node && assembly.numbering.normal(d).is_some())
        {
            for component in ["x", "y", "z"] {
                rows.push(MatrixRow {
                    node: node + 1,
                    x_m: at.x,
                    vector: format!("normal{}", disk + 1),
                    component,
                });
                scale.push(model.reference_length);
            }
        }
    }
    let physical = |name, description, a: &Sparse| {
        let mut entries = Vec::with_capacity(a.compute_nnz());
        for j in 0..a.ncols() {
            for (&i, value) in a.row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)) {
                entries.push((i, j, value * scale[i] * scale[j]));
            }
        }
        PhysicalMatrix { name, description, size: a.nrows(), entries }
    };
    let list = vec![
        physical("M", "mass, kg (times m per derivative)", &assembly.mass()),
        physical(
            "G",
            "gyroscopic per unit spin speed, stationary frame",
            &assembly.gyroscopic(Gyroscopic::All),
        ),
        physical(
            "N",
            "spin softening per unit spin speed squared, stationary frame",
            &assembly.spin_softening(),
        ),
        physical(
            "K0",
            "stiffness about the undeformed state at rest, with hubs and the symmetric part of bearings",
            &assembly.stiffness(),
        ),
    ];
    (rows, list)
}

/// Names of the vectors of a node whose coordinates are free, and the powers of the reference length in them: its own, and
/// kinked ones of a neighbour.
fn free_vectors(assembly: &Assembly<'_>, node: usize) -> Vec<(String, i32)> {
    let Node { field, follower, .. } = assembly.model.nodes[node];
    let of = |field: Field| {
        let kinks = field.kinks.names().into_iter().map(|name| (name, 0));
        field.basis.names().into_iter().zip(field.basis.scales()).chain(kinks).collect::<Vec<_>>()
    };
    let mut list = of(field);
    list.extend(follower.map(of).unwrap_or_default());
    let free = assembly.free_among(assembly.numbering.of_node(node));
    let start = assembly.numbering.index(node, 0, 0);
    let is_free = |vector: usize| free.contains(&(start + 3 * vector));
    list.into_iter().enumerate().filter(|(vector, _)| is_free(*vector)).map(|(_, of)| of).collect()
}
