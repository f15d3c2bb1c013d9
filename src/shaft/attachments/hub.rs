//! Hubs: stiff springs that keep a triad of vectors upright, so that a section carries a rigid body.
//!
//! A triad is `(n, r_,y, r_,z)`: two vectors that turn and stretch with the section and, for a disk thicker than thin,
//! its normal n, an unknown of its own. With `E_ab = (a . b - delta_ab)/2` of its unit vectors the energy is
//!
//! ```text
//!     k/2 (E_yy^2 + E_zz^2 + 2 E_yz^2) + k_n/2 (E_nn^2 + 2 E_ny^2 + 2 E_nz^2)
//! ```
//!
//! the first part for rigid hubs, the second for normals. It does not change when the triad turns as a whole, and the
//! mass of the normal is constant, so that the equations keep their form in every frame. Source: docs/theory/supports.md#disks.

use crate::model::{ActsOn, Hub, Model, SectionHold, SupportKind};
use crate::shaft::attachments::{Contribution, Numbering, affine_rows};
use faer::Mat;
use nalgebra::{Matrix3, Vector3};

/// Stiffness of a hub, `k = HUB E R^3` (N m). A normal has `k_n = k min(1, (Id - Jp/2) / (Jp/2))`: with little inertia it
/// needs no more to follow, and would only add a vibration that is faster than all others. A shaft of length L that a normal tilts is
/// `4e-4 R / L` too flexible by it.
const HUB: f64 = 4000.0;

/// A vector of a triad as a sum over vectors of the shaft: first coordinate and weight of each.
type HubRow = Vec<(usize, f64)>;

/// One hub: its vectors, times the reference length R, and what holds them.
#[derive(Debug, Clone)]
struct Triad {
    /// n, r_,y and r_,z; n is empty where there is no normal.
    rows: [HubRow; 3],
    /// Stiffness on each strain, `dU = sum k_ab E_ab dE_ab`, N m.
    moduli: Matrix3<f64>,
}

/// All hubs of a shaft.
#[derive(Debug, Clone)]
pub struct Hubs {
    triads: Vec<Triad>,
    reference_length: f64,
}

/// Nodes with a rigid hub: disks, and rigid ends that spin free.
fn rigid_hubs(model: &Model) -> Vec<usize> {
    let rigid_disks = model.disks.iter().filter(|d| d.hub == Hub::Rigid).map(|d| d.node);
    let free_ends = model.supports.iter().filter(|s| {
        matches!(
            s.kind,
            SupportKind::Revolute { hold: SectionHold::Rigid, driven: false }
                | SupportKind::Cylindrical { hold: SectionHold::Rigid, driven: false }
        )
    });
    let mut nodes: Vec<usize> = rigid_disks.chain(free_ends.map(|s| s.node)).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

impl Hubs {
    /// The hubs of rigid disks and ends, and the normals of thick disks.
    pub fn new(model: &Model, numbering: &Numbering) -> Self {
        let scale = |node: usize| {
            let meet = model.elements.iter().filter(|e| e.face_at(node).is_some());
            let moduli = meet.map(|e| model.materials[e.material].youngs_modulus);
            moduli.fold(0.0, f64::max) * model.reference_length.powi(3)
        };
        let rows = |node: usize, acts_on: ActsOn, normal: Option<usize>| {
            let [_, y, z] = affine_rows(model, numbering, node, acts_on);
            [normal.map_or_else(Vec::new, |at| vec![(at, 1.0)]), y, z]
        };
        let rigid = |node: usize| Triad {
            rows: rows(node, ActsOn::Axis, None),
            moduli: Matrix3::from_fn(|i, j| if i > 0 && j > 0 { HUB * scale(node) } else { 0.0 }),
        };
        let mut triads: Vec<Triad> = rigid_hubs(model).into_iter().map(rigid).collect();
        for (i, disk) in model.disks.iter().enumerate() {
            let Some(normal) = numbering.normal(i) else { continue };
            // a soft hub tilts with its section as a whole
            let carrier = match disk.hub {
                Hub::Rigid => ActsOn::Axis,
                Hub::Soft => ActsOn::Section,
                Hub::Bore | Hub::Rim => disk.hub.acts_on(),
            };
            let share = (2.0 * disk.thickness_inertia() / disk.polar_inertia).min(1.0);
            let stiffness = HUB * share * scale(disk.node);
            triads.push(Triad {
                rows: rows(disk.node, carrier, Some(normal)),
                moduli: Matrix3::from_fn(|i, j| if i == 0 || j == 0 { stiffness } else { 0.0 }),
            });
        }
        Self { triads, reference_length: model.reference_length }
    }

    /// Adds the forces on all coordinates q (N); returns the energy (J).
    pub fn add_force(&self, q: &[f64], force: &mut [f64]) -> f64 {
        let mut energy = 0.0;
        for triad in &self.triads {
            let vectors = triad.vectors(q).map(|v| v / self.reference_length);
            let strains = triad.stresses(&vectors);
            energy += strains.0;
            let on_vectors = triad_forces(&vectors, &strains.1);
            for (row, f) in triad.rows.iter().zip(on_vectors) {
                let f = f / self.reference_length;
                for &(at, weight) in row {
                    force[at..at + 3].iter_mut().zip(f.iter()).for_each(|(t, f)| *t += weight * f);
                }
            }
        }
        energy
    }

    /// Derivative of the forces by the coordinates, at q.
    pub fn tangents(&self, q: &[f64]) -> Vec<Contribution> {
        self.triads.iter().map(|triad| triad.tangent(triad.vectors(q), self.reference_length)).collect()
    }

    /// The tangent of the undeformed shaft.
    pub fn stiffness(&self) -> Vec<Contribution> {
        let upright = Matrix3::identity() * self.reference_length;
        let vectors = [0, 1, 2].map(|i| upright.column(i).into_owned());
        self.triads.iter().map(|triad| triad.tangent(vectors, self.reference_length)).collect()
    }
}

impl Triad {
    /// `R n`, `R r_,y`, `R r_,z` for coordinates q; zero for a normal that does not exist.
    fn vectors(&self, q: &[f64]) -> [Vector3<f64>; 3] {
        [0, 1, 2]
            .map(|k| self.rows[k].iter().map(|&(at, w)| Vector3::new(q[at], q[at + 1], q[at + 2]) * w).sum())
    }

    /// Energy of a hub (J) and its stresses `S_ab = k_ab E_ab` (N m).
    fn stresses(&self, vectors: &[Vector3<f64>; 3]) -> (f64, Matrix3<f64>) {
        let strain =
            Matrix3::from_fn(|i, j| (vectors[i].dot(&vectors[j]) - f64::from(u8::from(i == j))) / 2.0);
        let stress = self.moduli.component_mul(&strain);
        (stress.component_mul(&strain).sum() / 2.0, stress)
    }

    fn tangent(&self, vectors: [Vector3<f64>; 3], reference_length: f64) -> Contribution {
        let vectors = vectors.map(|v| v / reference_length);
        let (moduli, stress) = (self.moduli, self.stresses(&vectors).1);
        // d(sum_b S_ab v_b)/dv_c = S_ac 1 + sum_b k_ab/2 v_b (delta_ac v_b + delta_bc v_a)^T
        let block = |a: usize, c: usize| {
            let mut sum = Matrix3::identity() * stress[(a, c)];
            sum += vectors[c] * vectors[a].transpose() * (moduli[(a, c)] / 2.0);
            if a == c {
                for b in 0..3 {
                    sum += vectors[b] * vectors[b].transpose() * (moduli[(a, b)] / 2.0);
                }
            }
            sum / reference_length.powi(2)
        };
        let blocks: [[Matrix3<f64>; 3]; 3] = std::array::from_fn(|a| std::array::from_fn(|c| block(a, c)));
        let rows = &self.rows;
        let mut starts: Vec<usize> = rows.iter().flatten().map(|entry| entry.0).collect();
        starts.sort_unstable();
        starts.dedup();
        let weight = |k: usize, start: usize| -> f64 {
            rows[k].iter().filter(|entry| entry.0 == start).map(|entry| entry.1).sum()
        };
        let weights: Vec<[f64; 3]> = starts.iter().map(|&s| [0, 1, 2].map(|k| weight(k, s))).collect();
        let entry = |i: usize, j: usize| {
            let (wi, wj) = (weights[i / 3], weights[j / 3]);
            let mut sum = 0.0;
            for a in 0..3 {
                for c in 0..3 {
                    sum += wi[a] * wj[c] * blocks[a][c][(i % 3, j % 3)];
                }
            }
            sum
        };
        let n = 3 * starts.len();
        Contribution {
            coordinates: starts.iter().flat_map(|s| (0..3).map(move |c| s + c)).collect(),
            matrix: Mat::from_fn(n, n, entry),
        }
    }
}

/// Forces `sum_b S_ab v_b` on the three vectors.
fn triad_forces(vectors: &[Vector3<f64>; 3], stress: &Matrix3<f64>) -> [Vector3<f64>; 3] {
    [0, 1, 2].map(|a| (0..3).map(|b| vectors[b] * stress[(a, b)]).sum())
}
