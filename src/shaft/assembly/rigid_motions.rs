//! Motions without deformation that nothing resists, with their names.

use crate::shaft::assembly::elimination::reduce;
use crate::shaft::assembly::{Assembly, ZERO_ROW_RTOL};
use crate::shaft::attachments::{self};
use faer::Mat;
use nalgebra::DMatrix;

/// Combinations of six motions that every row leaves at zero, as simple as possible.
pub(super) fn null_space(rows: &[[f64; 6]]) -> Vec<[f64; 6]> {
    let scaled: Vec<f64> = rows
        .iter()
        .filter_map(|row| {
            let norm = row.iter().map(|v| v * v).sum::<f64>().sqrt();
            (norm > ZERO_ROW_RTOL * ZERO_ROW_RTOL).then(|| row.map(|v| v / norm))
        })
        .flatten()
        .collect();
    let matrix = DMatrix::from_row_slice(scaled.len() / 6, 6, &scaled);
    // The Gram matrix would square the conditioning; the row echelon form of a QR's R does not.
    let r = matrix.qr().unpack_r();
    let rows = (0..r.nrows()).map(|i| r.row(i).iter().copied().collect()).collect();
    let reduced = reduce(rows);
    (0..6)
        .filter(|i| !reduced.iter().any(|(pivot, _)| pivot == i))
        .map(|i| {
            let mut motion = [0.0; 6];
            motion[i] = 1.0;
            for (pivot, row) in &reduced {
                motion[*pivot] = -row[i];
            }
            motion
        })
        .collect()
}

/// A motion without deformation: shares of the translations along x, y, z and of the rotations about x, y, z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion(pub [f64; 6]);

impl RigidMotion {
    /// Whether it has a share of one of these motions, by their places 0 to 5.
    pub fn has(&self, motions: &[usize]) -> bool {
        motions.iter().any(|&m| self.0[m].abs() > ZERO_ROW_RTOL)
    }
}

impl std::fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const NAMES: [&str; 6] = [
            "translation along x",
            "translation along y",
            "translation along z",
            "rotation about x",
            "rotation about y",
            "rotation about z",
        ];
        let parts: Vec<&str> = (0..6).filter(|&m| self.has(&[m])).map(|m| NAMES[m]).collect();
        f.write_str(&parts.join(" with "))
    }
}

impl Assembly<'_> {
    /// The six rigid motions (translations x, y, z; rotations about x, y, z through the left end) in
    /// all coordinates: displacement in m for a unit translation, and for a rotation of one over the length.
    pub(super) fn all_rigid_motions(&self) -> [Vec<f64>; 6] {
        let (r, l) = (self.model.reference_length, self.model.length);
        std::array::from_fn(|motion| {
            let mut q = vec![0.0; self.numbering.len()];
            for (node, at) in self.model.nodes.iter().enumerate() {
                let mut set = |vector: usize, component: usize, value| {
                    self.numbering.fields(node).for_each(|first| q[first + 3 * vector + component] = value);
                };
                match motion {
                    0..=2 => set(0, motion, 1.0),
                    3 => {
                        set(1, 2, r / l);
                        set(2, 1, -r / l);
                    }
                    4 => {
                        set(0, 2, -at.x / l);
                        set(2, 0, r / l);
                    }
                    _ => {
                        set(0, 1, at.x / l);
                        set(1, 0, -r / l);
                    }
                }
            }
            // normals turn like the axis
            for normal in self.numbering.all_normals() {
                match motion {
                    4 => q[normal + 2] = -r / l,
                    5 => q[normal + 1] = r / l,
                    _ => {}
                }
            }
            // housings go along: what holds them holds the motion
            for (node, housing) in self.numbering.all_housings(self.model) {
                let x = self.model.nodes[node].x / l;
                match motion {
                    1 | 2 => q[housing + motion] = 1.0,
                    4 => q[housing + 2] = -x,
                    5 => q[housing + 1] = x,
                    _ => {}
                }
            }
            q
        })
    }

    /// What the rotations of rigid motions (in free coordinates, in columns) make of a displacement z: their turn, which any
    /// section tells, times the displacement.
    pub fn turned_by(&self, motions: &Mat<f64>, z: &[f64]) -> Mat<f64> {
        let q = self.expand(z);
        let r = self.model.reference_length;
        let columns: Vec<Vec<f64>> = motions
            .col_iter()
            .map(|motion| {
                let motion = self.expand(&motion.iter().copied().collect::<Vec<_>>());
                let at =
                    |vector: usize, component: usize| motion[self.numbering.index(0, vector, component)] / r;
                let (x, y, z) = (at(1, 2), at(2, 0), -at(1, 0));
                let turned = q
                    .chunks_exact(3)
                    .flat_map(|u| [y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]]);
                self.restrict(&turned.collect::<Vec<_>>())
            })
            .collect();
        Mat::from_fn(self.size(), columns.len(), |i, j| columns[j][i])
    }

    /// Rigid motions that no constraint and no bearing stiffness resists: their names, and the free
    /// coordinates in columns.
    pub fn rigid_motions(&self) -> (Vec<RigidMotion>, Mat<f64>) {
        let (springs, coupled) = (self.springs(), self.coupled_rows());
        self.rigid_motions_on(&springs.iter().map(|s| &s.row).chain(&coupled).collect::<Vec<_>>())
    }

    /// Displacements that cross-coupling acts between, as rows over coordinates before constraints.
    pub(super) fn coupled_rows(&self) -> Vec<Vec<(usize, f64)>> {
        let coupled = self.model.bearings.iter().filter(|b| b.couples());
        coupled.flat_map(|b| attachments::bearing_rows(self.model, &self.numbering, b)).collect()
    }

    /// Rigid motions that no constraint resists and for which none of the displacements `held` (rows over coordinates
    /// before constraints) is above zero.
    pub fn rigid_motions_on(&self, held: &[&Vec<(usize, f64)>]) -> (Vec<RigidMotion>, Mat<f64>) {
        let motions = self.all_rigid_motions();
        let null = self.rigid_combinations(held);
        let columns: Vec<Vec<f64>> = null
            .iter()
            .map(|c| {
                let q: Vec<f64> =
                    (0..self.numbering.len()).map(|i| (0..6).map(|m| c[m] * motions[m][i]).sum()).collect();
                self.restrict(&q)
            })
            .collect();
        let motions = null.into_iter().map(RigidMotion).collect();
        (motions, Mat::from_fn(self.size(), columns.len(), |i, j| columns[j][i]))
    }

    /// The same as combinations of the six rigid motions.
    pub(super) fn rigid_combinations(&self, held: &[&Vec<(usize, f64)>]) -> Vec<[f64; 6]> {
        let motions = self.all_rigid_motions();
        let mut rows: Vec<[f64; 6]> = Vec::new();
        for (node, row) in &self.constraints {
            let at = self.numbering.of_node(*node);
            rows.push(std::array::from_fn(|m| {
                row.iter().zip(&motions[m][at.clone()]).map(|(a, b)| a * b).sum()
            }));
        }
        let felt = |row: &[(usize, f64)], m: usize| row.iter().map(|&(i, w)| w * motions[m][i]).sum::<f64>();
        rows.extend(held.iter().map(|row| std::array::from_fn(|m| felt(row, m))));
        null_space(&rows)
    }

    /// For every free coordinate whether it changes its sign when the shaft is mirrored, y -> -y and z -> -z.
    pub fn mirror_signs(&self) -> Vec<[bool; 2]> {
        let mut signs = Vec::with_capacity(self.numbering.len());
        for (i, node) in self.model.nodes.iter().enumerate() {
            // a normal is a vector as r is, and so is a housing's displacement
            let others = (self.numbering.normals(i).len() + self.numbering.housings(i).len()) / 3;
            for [y, z] in node.odd().into_iter().chain((0..others).map(|_| [false; 2])) {
                signs.extend([[y, z], [!y, z], [y, !z]]);
            }
        }
        self.free.iter().map(|&i| signs[i]).collect()
    }

    /// True when a node's constraints carry the centrifugal stretch of the section but do not turn with it, as
    /// `y.y` held without `y.z` does.
    pub fn holds_stretch_one_way(&self) -> bool {
        let turned =
            |row: &[f64]| -> Vec<f64> { row.chunks_exact(3).flat_map(|c| [0.0, c[2], -c[1]]).collect() };
        (0..self.model.nodes.len()).any(|node| {
            let odd = self.model.nodes[node].odd();
            let stretches = |row: &[f64]| {
                let mut vectors = odd.iter().zip(row.chunks_exact(3));
                vectors.any(|(odd, c)| {
                    (c[1] != 0.0 && *odd == [true, false]) || (c[2] != 0.0 && *odd == [false, true])
                })
            };
            let rows: Vec<Vec<f64>> =
                self.constraints.iter().filter(|(n, _)| *n == node).map(|(_, row)| row.clone()).collect();
            let mut more = rows.clone();
            more.extend(rows.iter().filter(|row| stretches(row)).map(|row| turned(row)));
            more.len() > rows.len() && reduce(more).len() > reduce(rows).len()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pin at x = 0 and another at x = 2 leave turning about x alone; a pin alone leaves three rotations.
    #[test]
    fn pins_leave_rotations() {
        let pin = |x: f64| {
            [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, x], [0.0, 0.0, 1.0, 0.0, -x, 0.0]]
        };
        let names = |rows: &[[f64; 6]]| -> Vec<String> {
            null_space(rows).into_iter().map(|m| RigidMotion(m).to_string()).collect()
        };
        assert_eq!(names(&pin(0.0)), ["rotation about x", "rotation about y", "rotation about z"]);
        assert_eq!(names(&[pin(0.0), pin(2.0)].concat()), ["rotation about x"]);
        // a pin beside the origin: turning about it moves the origin, too
        assert!(names(&pin(2.0)).contains(&"translation along y with rotation about z".to_owned()));
        assert_eq!(null_space(&[]).len(), 6);
    }
}
