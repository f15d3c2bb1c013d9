//! Newton matrices of the equations of motion: their parts, the border of a drive by torque, and corrections.

use crate::error::Result;
use crate::linalg::chain::Chain;
use crate::linalg::dot;
use crate::model::Frame;
use crate::shaft::attachments::Contribution;
use crate::shaft::drive::Turn;
use crate::shaft::motion::{Dynamics, Following, scaled, turn_pair, turn_vectors};
use crate::shaft::stator_ring::{self, RubTouch};
use faer::{Mat, Scale};
use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3};

/// Angle (rad) by which a contact may move on its section before the Newton matrix is made anew.
const TURNED_DIRECTION: f64 = 0.1;

/// A factorised Newton matrix `c_a M + c_v C + c_k K`.
pub struct NewtonMatrix {
    factor: Chain,
    /// Built from the undeformed shaft: turns with each node's section.
    follows: bool,
    /// Its coefficients (c_k, c_v, c_a) and the spin speed it was made for.
    pub made_for: ([f64; 3], f64),
    border: Option<Border>,
    /// Rings in contact and where on the section, as [`Dynamics::contact_directions`] tells.
    contacts: Vec<(usize, Vector3<f64>)>,
}

/// Row and column of the angle of a drive by its torque beside a factorised matrix A, which changes the forces by b and has
/// the derivatives c of the torque.
pub(super) struct Border {
    /// `c`, on the free coordinates.
    row: Vec<f64>,
    /// The answer `A^-1 b` of the free coordinates to the angle's unknown.
    answer: Vec<f64>,
    /// Derivative of the torque by the angle's unknown, less `c . A^-1 b`.
    pivot: f64,
}

impl Border {
    /// Completes `x = -A^-1 g` (its last entry is the angle's) for a torque out of balance.
    pub(super) fn apply(&self, out_of_torque: f64, x: &mut [f64]) {
        let n = self.row.len();
        let angle = (-out_of_torque - dot(&self.row, &x[..n])) / self.pivot;
        x[..n].iter_mut().zip(&self.answer).for_each(|(x, u)| *x -= angle * u);
        x[n] = angle;
    }
}

impl Dynamics<'_> {
    /// What the angle adds to a Newton matrix, where a torque drives: at the last evaluation, with the coefficients of
    /// `z, z', z''`.
    ///
    /// The forces change by `M J q` per angular acceleration and `2 M J (v + Omega J q)` per speed, the torque
    /// `(J q)^T (...)` by the same on the other side.
    pub(super) fn border(&self, factor: &Chain, [_, c_v, c_a]: [f64; 3]) -> Option<Border> {
        if !self.drive.is_torque() {
            return None;
        }
        let m = &self.memory;
        let cross =
            |list: &[f64]| -> Vec<f64> { list.chunks_exact(3).flat_map(|v| [0.0, -v[2], v[1]]).collect() };
        let product = |list: &[f64]| {
            let mut image = vec![0.0; list.len()];
            self.mass.multiply(list, &mut image);
            image
        };
        let across = cross(&m.position);
        let (by_acceleration, pull) = (product(&across), product(&cross(&across)));
        let coriolis = product(&cross(&m.rate));
        let speed = m.turn.speed;
        let n = self.assembly.size();
        let mut column: Vec<f64> = (0..across.len())
            .map(|i| c_a * by_acceleration[i] + 2.0 * c_v * (coriolis[i] + speed * pull[i]))
            .collect();
        let row: Vec<f64> =
            (0..across.len()).map(|i| c_a * by_acceleration[i] - 2.0 * c_v * speed * pull[i]).collect();
        let own = c_a * dot(&across, &by_acceleration) + 2.0 * c_v * dot(&across, &coriolis)
            - c_v * self.drive.torque_at(speed).1;
        let (mut on_free, mut answer) = (vec![0.0; n], vec![0.0; n]);
        self.assembly.project(&row, &mut on_free);
        factor.solve_in_place(&mut column);
        self.assembly.restrict_into(&column, &mut answer);
        let pivot = own - dot(&on_free, &answer);
        Some(Border { row: on_free, answer, pivot })
    }

    /// Rings in contact at the last evaluation and the outward normal there in the coordinates of a Newton matrix:
    /// the unknowns', or for one that follows the sections those of the section.
    pub(super) fn contact_directions(&self, follows: bool) -> Vec<(usize, Vector3<f64>)> {
        let direction = |touch: &RubTouch| {
            let normal = Vector3::new(0.0, touch.place[0], touch.place[1]).normalize();
            (touch.ring, self.to_matrix(self.rub.rings[touch.ring].node, follows) * normal)
        };
        self.rub.touching.iter().map(direction).collect()
    }

    /// From the frame of evaluation at the last one to the coordinates of a Newton matrix, at a node.
    pub(super) fn to_matrix(&self, node: usize, follows: bool) -> Matrix3<f64> {
        let (sin, cos) = if self.nodes[node].turned { self.memory.turned } else { (0.0, 1.0) };
        let own = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, sin, 0.0, -sin, cos);
        match self.memory.frames.get(node).filter(|_| follows) {
            Some(frame) => frame.transpose() * own,
            None => own,
        }
    }

    /// True when other rings touch at the last evaluation than those a matrix was made for, or elsewhere on the section.
    pub fn contact_moved(&self, matrix: &NewtonMatrix) -> bool {
        if self.rub.touching.is_empty() && matrix.contacts.is_empty() {
            return false;
        }
        let (now, then) = (self.contact_directions(matrix.follows), &matrix.contacts);
        let apart = |k: usize| now[k].0 != then[k].0 || (now[k].1 - then[k].1).norm() > TURNED_DIRECTION;
        now.len() != then.len() || (0..now.len()).any(apart)
    }

    /// What the rings that touched at the last evaluation add to a Newton matrix.
    pub(super) fn contact_parts(
        &self,
        [c_k, c_v, _]: [f64; 3],
        speed: f64,
        follows: bool,
    ) -> Vec<Contribution> {
        let one = |touch: &RubTouch| {
            let ring = &self.rub.rings[touch.ring];
            let [by_place, by_rate] = ring.law.tangents(&touch.place, &touch.rate);
            // seen from space the coordinates of a turning node move by Omega e_x x q besides their own rate
            let turns = self.frame == Frame::Rotating || self.nodes[ring.node].turned;
            let cross = stator_ring::PlaneMatrix::from_fn(|i, j| match (i / 2 == j / 2, i % 2, j % 2) {
                (true, 0, 1) => -speed,
                (true, 1, 0) => speed,
                _ => 0.0,
            });
            let carried = if turns { by_rate * cross } else { stator_ring::PlaneMatrix::zeros() };
            let plane = -(by_place + carried) * c_k - by_rate * c_v;
            let mut full = SMatrix::<f64, 9, 9>::zeros();
            for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
                full[(3 * (i / 2) + 1 + i % 2, 3 * (j / 2) + 1 + j % 2)] = plane[(i, j)];
            }
            let turn = self.to_matrix(ring.node, follows);
            let mut all = SMatrix::<f64, 9, 9>::zeros();
            (0..3).for_each(|k| all.fixed_view_mut::<3, 3>(3 * k, 3 * k).copy_from(&turn));
            let full = all * full * all.transpose();
            let mut starts: Vec<usize> = ring.rows.iter().flatten().map(|entry| entry.0).collect();
            starts.sort_unstable();
            starts.dedup();
            let weight = |k: usize, start: usize| {
                ring.rows[k].iter().find(|entry| entry.0 == start).map_or(0.0, |entry| entry.1)
            };
            let entry = |i: usize, j: usize| {
                let pairs = (0..3).flat_map(|k| (0..3).map(move |l| (k, l)));
                let part = |(k, l): (usize, usize)| {
                    weight(k, starts[i / 3]) * weight(l, starts[j / 3]) * full[(3 * k + i % 3, 3 * l + j % 3)]
                };
                pairs.map(part).sum::<f64>()
            };
            let n = 3 * starts.len();
            Contribution {
                coordinates: starts.iter().flat_map(|s| (0..3).map(move |c| s + c)).collect(),
                matrix: Mat::from_fn(n, n, entry),
            }
        };
        self.rub.touching.iter().map(one).collect()
    }

    /// Newton matrix for `z = z0 + c_k x, z' = v0 + c_v x, z'' = a0 + c_a x`: of the undeformed shaft, turned with
    /// every node's section, or with the tangent of the state `z` (no rotation, any deformation); with the tangent of
    /// the rings that touched at the last evaluation.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn newton_matrix(
        &mut self,
        t: f64,
        coefficients: [f64; 3],
        state: Option<&[f64]>,
    ) -> Result<NewtonMatrix> {
        let [c_k, c_v, c_a] = coefficients;
        let Turn { speed, acceleration, angle } =
            if self.drive.is_torque() { self.memory.turn } else { self.drive.at(t) };
        self.counts.factorizations += 1;
        let follows = state.is_none();
        let rings = self.contact_parts(coefficients, speed, follows);
        let l = &self.linear;
        let coriolis = 2.0 * speed * c_v + acceleration * c_k;
        let mut terms = l.terms(&[c_a, c_v, c_k, coriolis, speed * speed * c_k, speed * c_k]);
        terms.nodal.extend(scaled(1.0, &rings));
        let factor = match state {
            None => {
                let elastic = l.elastic.elements.iter().zip(&l.viscosity);
                for (sum, (k, beta)) in terms.elements.iter_mut().zip(elastic) {
                    *sum += Scale(c_k + beta * c_v) * k;
                }
                terms.nodal.extend(scaled(c_k, &l.elastic.nodal));
                Chain::new(&l.layout, &terms)?
            }
            Some(z) => {
                self.counts.tangents += 1;
                let mut q = self.assembly.expand(z);
                q.iter_mut().zip(&self.reference).for_each(|(q, q0)| *q += q0);
                let (sin, cos) = angle.sin_cos();
                for node in self.nodes.iter().filter(|n| n.turned) {
                    for at in (node.start..node.end).step_by(3) {
                        turn_pair(&mut q[at..], sin, cos);
                    }
                }
                let mut elements = self.forces.element_tangents(&q);
                for (e, k) in elements.iter_mut().enumerate() {
                    *k = Scale(c_k) * &*k + &terms.elements[l.element_type[e]];
                }
                if self.viscous {
                    let damping = self.forces.viscous_tangents(&q);
                    elements.iter_mut().zip(damping).for_each(|(k, c)| *k += Scale(c_v) * c);
                }
                let hubs = self.forces.hub_tangents(&q);
                terms.element_type = (0..elements.len()).collect();
                terms.elements = elements;
                terms.nodal.extend(scaled(c_k, &hubs));
                Chain::new(&l.layout, &terms)?
            }
        };
        let contacts = self.contact_directions(follows);
        let border = self.border(&factor, coefficients);
        Ok(NewtonMatrix { factor, follows, made_for: (coefficients, speed), contacts, border })
    }

    /// Rotations of the sections at the state of the last evaluation, for the matrices that follow them.
    pub fn follow_sections(&mut self) {
        let own = &self.memory.own;
        let frames = self.nodes.iter().enumerate().map(|(node, place)| match place.following {
            Following::Rotation => self.forces.section_frame(own, node),
            Following::Spin => {
                let [y, z] = [place.start + 3, place.start + 6];
                let twist = (own[y + 2] - own[z + 1]).atan2(own[y + 1] + own[z + 2]);
                Rotation3::from_axis_angle(&Vector3::x_axis(), twist).into_inner()
            }
            Following::Nothing => Matrix3::identity(),
        });
        self.memory.frames = frames.collect();
    }

    /// `x := -A^-1 g` for the forces of the last evaluation.
    pub fn correct(&mut self, matrix: &NewtonMatrix, x: &mut [f64]) {
        let m = &mut self.memory;
        if matrix.follows {
            for (node, frame) in self.nodes.iter().zip(&m.frames) {
                let back = frame.transpose();
                turn_vectors(&mut m.residual[node.start..node.end], &back);
            }
        }
        matrix.factor.solve_in_place(&mut m.residual);
        if matrix.follows {
            for (node, frame) in self.nodes.iter().zip(&m.frames) {
                turn_vectors(&mut m.residual[node.start..node.end], frame);
            }
        }
        self.assembly.restrict_into(&m.residual, x);
        x.iter_mut().for_each(|x| *x = -*x);
        if let Some(border) = &matrix.border {
            border.apply(m.out_of_torque, x);
        }
    }
}
