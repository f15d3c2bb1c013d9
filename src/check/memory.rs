//! How much memory the analyses of a model take: estimates for `check`, and for the refusal of what no machine has.
//!
//! Fitted to the peak memory of runs: matrices to 16 to 512 elements 34X3, the sweep to bases of 20 to 240 vectors, numbers of
//! reports to histories of 1e3 to 1e5 outputs and lines of 10 to 10000 points.

use crate::model::{DEFAULT_BASIS, Model, SPARE_BASIS};

/// Bytes of a number of a report: as a result, in the report's tree, and in its text.
const NUMBER: f64 = 100.0;
/// Numbers that a point of a probe has: place, displacement, strains, stresses with names.
const POINT: f64 = 40.0;
/// Complex matrices of twice the basis' size that one speed takes while it is solved.
const WORK: f64 = 4.0;
/// Speeds that are solved at a time; estimates do not depend on the machine.
const THREADS: f64 = 4.0;

/// A part of the memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Share {
    /// JSON path of what decides it.
    pub path: &'static str,
    /// What it is for.
    pub what: &'static str,
    /// Estimated size, bytes.
    pub bytes: f64,
}

/// Bytes of system matrices, factors and the vectors of the eigenvalue solvers, for a mesh with so many unknowns and so
/// many unknowns a node.
pub fn mesh_memory(unknowns: f64, per_node: f64) -> f64 {
    let half_band = 4.0 * per_node;
    2.5e7 + unknowns * 8.0 * (4.0 * half_band + 760.0)
}

/// Bytes of the matrices of a tapered element, which has no copies: six of them, over four nodes.
pub fn tapered_memory(per_node: f64) -> f64 {
    6.0 * 8.0 * (4.0 * per_node).powi(2)
}

/// What the largest of the analyses of a case takes, part by part.
pub fn memory(model: &Model) -> Vec<Share> {
    let unknowns: f64 = model
        .nodes
        .iter()
        .map(|n| 3.0 * (n.n_vectors() + n.follower.map_or(0, |f| f.kinks.count())) as f64)
        .sum();
    let tapered = model.elements.iter().filter(|e| e.is_tapered());
    let tapered: f64 = tapered.map(|e| tapered_memory(3.0 * e.n_vectors() as f64)).sum();
    let mut list = vec![Share {
        path: "shaft.segments",
        what: "matrices",
        bytes: mesh_memory(unknowns, unknowns / model.nodes.len() as f64) + tapered,
    }];
    if let Some(sweep) = &model.campbell {
        let basis = sweep.reduction.unwrap_or(DEFAULT_BASIS).max(sweep.modes + SPARE_BASIS) as f64;
        let basis = basis.min(unknowns);
        let beyond = (basis - DEFAULT_BASIS as f64).max(0.0);
        // vectors of the basis and of its refinement, dense operators, and the work of every thread
        let dense = 16.0 * (2.0 * basis).powi(2) * WORK * THREADS;
        list.push(Share {
            path: "campbell.reduction",
            what: "basis",
            bytes: 3.0 * 8.0 * unknowns * beyond + dense,
        });
        // a motion and its conjugate for every vector, at every speed
        let bytes = sweep.speeds.len() as f64 * 16.0 * 2.0 * basis * (basis + 4.0);
        list.push(Share { path: "campbell.speeds.count", what: "sweep", bytes });
    }
    let points: usize = model.probes.iter().map(|p| p.points.len()).sum();
    list.push(Share { path: "probes", what: "probes", bytes: points as f64 * POINT * NUMBER });
    if let Some(spin) = model.spinup.as_ref().filter(|s| !s.steady) {
        // scalars of the history, places of mid-span and probes with torque and shear, reactions and forces and moments of
        // supports, forces of bearings, and gaps and forces of rings
        let places = 1 + 2 * model.probes.len() + 3 * model.supports.len() + model.bearings.len();
        let row = 18 + 4 * places + 10 * spin.stators.len();
        list.push(Share {
            path: "spinup.output",
            what: "history",
            bytes: spin.output as f64 * row as f64 * NUMBER,
        });
    }
    list
}

/// Bytes of an instant of the history of a scene with so many bodies: energies, ends and velocities of bodies, gap and force of
/// pairs.
pub fn scene_point(bodies: usize) -> f64 {
    let pairs = bodies * bodies.saturating_sub(1) / 2;
    (8 + 10 * bodies + 2 * pairs) as f64 * NUMBER
}
