//! Equations of motion of the driven shaft in the free coordinates, in the frame that turns with the drive or
//! in the inertial one, with the solver for Newton corrections.
//!
//! With a node turning by Theta(t), `q = (I (x) R(Theta)) s`, Omega = dTheta/dt and `J s = e_x x s`:
//!
//! ```text
//!     M (s'' + 2 Omega J s' + (dOmega/dt J + Omega^2 J^2) s) + alpha M v + F(s, s') + bearings + rub = R^T f
//! ```
//!
//! In the rotating frame every node turns; in the inertial frame only the driven ones do, whose constraints
//! are then constant in their own turned coordinates. Both are exact. Source: docs/theory/motion.md, docs/theory/loads.md
//! and docs/theory/rub.md.

mod newton_matrix;
mod support_forces;

use crate::linalg::dot;
pub use newton_matrix::NewtonMatrix;

use crate::error::Result;
use crate::linalg::chain::{Chain, Layout, Terms};
use crate::model::{Frame, Model, Stator, SupportKind};
use crate::results::RubContact;
use crate::shaft::assembly::{Assembly, Parts};
use crate::shaft::attachments::{Contribution, bearing_rows, drives};
use crate::shaft::drive::{Drive, Turn};
use crate::shaft::internal_forces::{Forces, ScalarMass, Workspace};
use crate::shaft::loads::{Loads, Turned, Which};
use crate::shaft::stator_ring::{Rub, StatorRing};
use faer::{Mat, MatRef, Scale};
use nalgebra::{Matrix3, Vector3};

/// How a Newton matrix follows the motion of a node's section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Following {
    /// The whole rotation of the section.
    Rotation,
    /// Its rotation about the shaft axis: a support holds the rest.
    Spin,
    /// The matrix stays as it is: constraints hold single components, which no rotation leaves as they are.
    Nothing,
}

/// Where a node's coordinates are and how they turn.
struct NodePlace {
    start: usize,
    end: usize,
    /// True where the coordinates of the node turn with the drive in the frame of the unknowns.
    turned: bool,
    following: Following,
}

/// A linear bearing: what it resists as rows over the coordinates, and whether that turns with a turning frame.
struct BearingLaw {
    rows: [Vec<(usize, f64)>; 2],
    across: bool,
    stiffness: [[f64; 2]; 2],
    damping: [[f64; 2]; 2],
}

/// What happened at the last evaluation of the equations.
#[derive(Debug, Clone, Copy, Default)]
pub struct Powers {
    /// Torque of the drive about x (with that of any other constraint), N m.
    pub torque: f64,
    /// Power of the internal forces, W; computed with material damping only.
    pub internal: f64,
    /// Power absorbed by external damping, W.
    pub external: f64,
    /// Power absorbed by the bearings, W.
    pub bearings: f64,
    /// Power that friction at stators takes, W.
    pub friction: f64,
    /// Power of the loads that have no potential, those whose forces depend on the place, W.
    pub loads: f64,
}

/// Energies and momentum of a state.
#[derive(Debug, Clone, Copy, Default)]
pub struct MotionState {
    /// Kinetic energy of shaft and disks as seen from space, J.
    pub kinetic: f64,
    /// Strain energy of elements and hubs, J.
    pub strain: f64,
    /// Potential of gravity and of loads fixed in space, zero in the undeformed shaft at angle zero, J.
    pub potential: f64,
    /// Potential of penetrated stators, J.
    pub stators: f64,
    /// Angular momentum about x, kg m^2/s.
    pub angular_momentum: f64,
}

/// How often forces were evaluated and matrices factorised.
#[derive(Debug, Clone, Copy, Default)]
pub struct MotionCounts {
    /// Evaluations of the nonlinear forces.
    pub force_evaluations: usize,
    /// Newton matrices that were built and factorised.
    pub factorizations: usize,
    /// How many of these were made of the tangent of a deformed state.
    pub tangents: usize,
}

/// Equations of motion with their memory.
pub struct Dynamics<'a> {
    /// Numbering, constraints and matrices of the shaft.
    pub assembly: &'a Assembly<'a>,
    /// Angle and speed over time, or the torque from which they follow.
    pub drive: Drive,
    /// Frame of the unknowns.
    pub frame: Frame,
    /// Work done so far.
    pub counts: MotionCounts,
    /// Powers at the last evaluation.
    pub powers: Powers,
    forces: Forces<'a>,
    mass: ScalarMass,
    external: Option<ScalarMass>,
    viscous: bool,
    bearings: Vec<BearingLaw>,
    rub: Rub,
    reference: Vec<f64>,
    loads: Loads,
    nodes: Vec<NodePlace>,
    linear: Linear,
    mass_factor: Chain,
    work: Workspace,
    memory: Memory,
}

/// Matrices to be summed and factorised.
struct Linear {
    layout: Layout,
    element_type: Vec<usize>,
    /// What no state changes: `M`; `alpha M` and the bearings' damping; their stiffness; in the rotating frame also
    /// `M J`, `M J^2` and `alpha M J`.
    constant: Vec<Parts>,
    /// Stiffness `K0` of elements and hubs about the undeformed state.
    elastic: Parts,
    /// Kelvin-Voigt factor of every distinct element, s.
    viscosity: Vec<f64>,
}

impl Linear {
    fn new(assembly: &Assembly<'_>, rotating: bool) -> Self {
        let [stiffness, mut damping] = assembly.mean_bearings();
        damping.elements = assembly.external_parts().elements;
        let mut constant = vec![assembly.mass_parts(), damping, stiffness];
        if rotating {
            let momentum = || assembly.mass_parts().times_cross();
            constant.extend([momentum(), momentum().times_cross(), assembly.external_parts().times_cross()]);
        }
        Self {
            layout: assembly.chain(),
            element_type: (0..assembly.model.elements.len()).map(|e| assembly.element_type(e)).collect(),
            constant,
            elastic: assembly.elastic_parts(),
            viscosity: assembly.viscosities(),
        }
    }

    /// The sum of the constant matrices; missing factors are zero.
    fn terms(&self, factors: &[f64]) -> Terms<'_> {
        let mut elements: Vec<Mat<f64>> =
            self.elastic.elements.iter().map(|a| Mat::zeros(a.nrows(), a.ncols())).collect();
        let mut nodal = Vec::new();
        for (&factor, parts) in factors.iter().zip(&self.constant).filter(|(factor, _)| **factor != 0.0) {
            elements.iter_mut().zip(&parts.elements).for_each(|(sum, a)| *sum += Scale(factor) * a);
            nodal.extend(scaled(factor, &parts.nodal));
        }
        Terms { elements, element_type: self.element_type.clone(), nodal }
    }
}

fn scaled(factor: f64, nodal: &[Contribution]) -> impl Iterator<Item = (f64, &[usize], MatRef<'_, f64>)> {
    nodal.iter().map(move |n| (factor, &n.coordinates[..], n.matrix.as_ref()))
}

/// All coordinates at the last evaluation.
#[derive(Default)]
struct Memory {
    /// Position in the unknowns' own coordinates, in the frame, their rates and accelerations.
    own: Vec<f64>,
    position: Vec<f64>,
    rate: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    residual: Vec<f64>,
    inertia: Vec<f64>,
    damping: Vec<f64>,
    frames: Vec<Matrix3<f64>>,
    /// Sine and cosine of the drive's angle.
    turned: (f64, f64),
    turn: Turn,
    /// Torque that the motion needs less the torque that the drive gives, N m; zero in balance.
    out_of_torque: f64,
}

impl<'a> Dynamics<'a> {
    /// Prepares the equations of a model with its drive.
    ///
    /// # Errors
    /// An element without nonlinear form, or a singular mass matrix.
    pub fn new(assembly: &'a Assembly<'a>, drive: Drive, frame: Frame) -> Result<Self> {
        let (model, numbering) = (assembly.model, &assembly.numbering);
        let forces = Forces::new(assembly)?;
        let mass = ScalarMass::new(model);
        let loads = Loads::new(model, numbering, &mass, Which::All);
        let nodes = (0..model.nodes.len())
            .map(|node| {
                let range = numbering.of_node(node);
                let turned = frame == Frame::Inertial && drives(model, node);
                NodePlace { start: range.start, end: range.end, turned, following: following(model, node) }
            })
            .collect();
        let bearings = model
            .bearings
            .iter()
            .map(|b| BearingLaw {
                rows: bearing_rows(model, numbering, b),
                across: b.is_across(),
                stiffness: b.stiffness,
                damping: b.damping,
            })
            .collect();
        let linear = Linear::new(assembly, frame == Frame::Rotating);
        let alpha = model.materials.iter().any(|m| m.mass_damping != 0.0);
        let external = alpha.then(|| ScalarMass::external_damping(model));
        Ok(Self {
            reference: forces.reference(),
            mass_factor: Chain::new(&linear.layout, &linear.terms(&[1.0]))?,
            viscous: model.materials.iter().any(|m| m.stiffness_damping != 0.0),
            assembly,
            drive,
            frame,
            counts: MotionCounts::default(),
            powers: Powers::default(),
            forces,
            mass,
            external,
            bearings,
            rub: Rub::default(),
            loads,
            nodes,
            linear,
            work: Workspace::default(),
            memory: Memory::default(),
        })
    }

    /// Puts rings around the shaft, which turns with at most that speed, rad/s.
    pub fn surround(&mut self, stators: &[Stator], fastest: f64) {
        self.rub.rings = stators.iter().map(|s| StatorRing::new(self.assembly, s, fastest)).collect();
    }

    /// The rings around the shaft and what they took.
    pub fn rub(&self) -> &Rub {
        &self.rub
    }

    /// The rings around the shaft, to be changed: an integrator chooses which of them act.
    pub fn rub_mut(&mut self) -> &mut Rub {
        &mut self.rub
    }

    /// Gap at every stator in a state, and force and slip at those that act.
    pub fn contacts(&mut self, t: f64, z: &[f64], v: &[f64]) -> Vec<RubContact> {
        let zero = vec![0.0; z.len()];
        self.move_to(self.turn(t, z, v, &zero), z, v, &zero);
        self.present_contacts()
    }

    /// The same in the state of the last evaluation or [`Self::state`].
    pub fn present_contacts(&self) -> Vec<RubContact> {
        self.rub.contacts(&self.memory.position, &self.memory.velocity)
    }

    /// Number of unknowns: the free coordinates, and the angle of a drive by its torque.
    pub fn size(&self) -> usize {
        self.assembly.size() + usize::from(self.drive.is_torque())
    }

    /// Rotation of the drive in a state.
    fn turn(&self, t: f64, z: &[f64], v: &[f64], a: &[f64]) -> Turn {
        if !self.drive.is_torque() {
            return self.drive.at(t);
        }
        let n = self.assembly.size();
        Turn { angle: z[n], speed: v[n], acceleration: a[n] }
    }

    /// Speed of the drive at the time of the last evaluation, rad/s.
    pub fn speed_at(&self, t: f64) -> f64 {
        if self.drive.is_torque() { self.memory.turn.speed } else { self.drive.at(t).speed }
    }

    /// Angle of the drive at the time of the last evaluation, rad.
    fn angle_at(&self, t: f64) -> f64 {
        if self.drive.is_torque() { self.memory.turn.angle } else { self.drive.at(t).angle }
    }

    /// Records the rotation at the end of a step, where a torque drives.
    pub fn record(&mut self, t: f64, [z, v, a]: [&[f64]; 3]) {
        let turn = self.turn(t, z, v, a);
        self.drive.record(t, turn);
    }

    /// Largest displacement of a free coordinate from where the drive carries the undeformed shaft, m.
    pub fn largest_displacement(&self, t: f64, z: &[f64]) -> f64 {
        let largest = |m: f64, z: f64| m.max(z.abs());
        if self.frame == Frame::Rotating {
            return z[..self.assembly.size()].iter().copied().fold(0.0, largest);
        }
        let q = self.coordinates(t, z);
        q.iter().zip(&self.reference).map(|(q, q0)| q - q0).fold(0.0, largest)
    }

    /// True when the equations dissipate: material, external or bearing damping.
    pub fn is_damped(&self) -> bool {
        self.viscous || self.external.is_some() || !self.bearings.is_empty()
    }

    /// True when there is material damping.
    pub fn is_viscous(&self) -> bool {
        self.viscous
    }

    /// Position, velocity and acceleration of all coordinates in the frame of evaluation.
    fn move_to(&mut self, turn: Turn, z: &[f64], v: &[f64], a: &[f64]) {
        let m = &mut self.memory;
        let n = self.reference.len();
        for list in [&mut m.own, &mut m.rate, &mut m.acceleration] {
            list.resize(n, 0.0);
        }
        self.assembly.expand_into(z, &mut m.own);
        self.assembly.expand_into(v, &mut m.rate);
        self.assembly.expand_into(a, &mut m.acceleration);
        m.own.iter_mut().zip(&self.reference).for_each(|(s, q0)| *s += q0);
        m.position.clone_from(&m.own);
        m.velocity.clone_from(&m.rate);
        let Turn { angle, speed, acceleration } = turn;
        let (sin, cos) = angle.sin_cos();
        m.turned = (sin, cos);
        m.turn = turn;
        let rotating = self.frame == Frame::Rotating;
        for node in self.nodes.iter().filter(|n| rotating || n.turned) {
            for at in (node.start..node.end).step_by(3) {
                let (y, z) = (m.own[at + 1], m.own[at + 2]);
                let (vy, vz) = (m.rate[at + 1], m.rate[at + 2]);
                m.velocity[at + 1] -= speed * z;
                m.velocity[at + 2] += speed * y;
                let square = speed * speed;
                m.acceleration[at + 1] -= 2.0 * speed * vz + acceleration * z + square * y;
                m.acceleration[at + 2] += 2.0 * speed * vy + acceleration * y - square * z;
                if node.turned {
                    for list in [&mut m.position, &mut m.velocity, &mut m.acceleration] {
                        turn_pair(&mut list[at..], sin, cos);
                    }
                }
            }
        }
        if !rotating {
            m.rate.clone_from(&m.velocity);
        }
    }

    /// Forces out of balance in the unknowns' own coordinates, kept for [`Self::correct`].
    pub fn evaluate(&mut self, t: f64, z: &[f64], v: &[f64], a: &[f64]) {
        let turn = self.turn(t, z, v, a);
        self.move_to(turn, z, v, a);
        self.counts.force_evaluations += 1;
        let m = &mut self.memory;
        let n = self.reference.len();
        for list in [&mut m.residual, &mut m.inertia, &mut m.damping] {
            list.resize(n, 0.0);
        }
        let rate = self.viscous.then_some(&m.rate[..]);
        self.forces.internal_force(&m.position, rate, &mut m.residual, &mut self.work);
        self.powers.internal = if self.viscous { dot(&m.rate, &m.residual) } else { 0.0 };
        // everything but the internal forces, which carry no moment
        self.mass.multiply(&m.acceleration, &mut m.inertia);
        self.powers.external = 0.0;
        if let Some(external) = &self.external {
            external.multiply(&m.velocity, &mut m.damping);
            self.powers.external = dot(&m.velocity, &m.damping);
            m.inertia.iter_mut().zip(&m.damping).for_each(|(f, d)| *f += d);
        }
        let (sin, cos) = if self.frame == Frame::Rotating { turn.angle.sin_cos() } else { (0.0, 1.0) };
        self.powers.bearings = 0.0;
        for bearing in &self.bearings {
            let (sin, cos) = if bearing.across { (sin, cos) } else { (0.0, 1.0) };
            let felt = |list: &[f64]| {
                let sum = |row: usize| bearing.rows[row].iter().map(|(at, w)| w * list[*at]).sum::<f64>();
                // in the fixed directions
                let (y, z) = (sum(0), sum(1));
                [cos * y - sin * z, sin * y + cos * z]
            };
            let (p, v) = (felt(&m.position), felt(&m.velocity));
            let (k, c) = (&bearing.stiffness, &bearing.damping);
            let force = [0, 1].map(|i| (0..2).map(|j| k[i][j] * p[j] + c[i][j] * v[j]).sum::<f64>());
            self.powers.bearings += force[0] * v[0] + force[1] * v[1];
            let force = [cos * force[0] + sin * force[1], cos * force[1] - sin * force[0]];
            for (row, force) in bearing.rows.iter().zip(force) {
                row.iter().for_each(|&(at, w)| m.inertia[at] += w * force);
            }
        }
        self.powers.friction = self.rub.add(&m.position, &m.velocity, &mut m.inertia);
        let axes = Turned { sin, cos };
        self.loads.add(&m.position, axes, -1.0, &mut m.inertia);
        self.powers.loads = if self.loads.depend_on_place() {
            self.loads.power_without_potential(&m.position, &m.velocity, axes)
        } else {
            0.0
        };
        self.powers.torque = moment(&m.position, &m.inertia);
        m.out_of_torque = self.powers.torque - self.drive.torque_at(turn.speed).0;
        m.residual.iter_mut().zip(&m.inertia).for_each(|(r, f)| *r += f);
        let (sin, cos) = turn.angle.sin_cos();
        for node in self.nodes.iter().filter(|n| n.turned) {
            for at in (node.start..node.end).step_by(3) {
                turn_pair(&mut m.residual[at..], -sin, cos);
            }
        }
    }

    /// Forces out of balance at the last evaluation, on the free coordinates, N.
    pub fn imbalance(&self, force: &mut [f64]) {
        self.assembly.project(&self.memory.residual, force);
    }

    /// Power of every load at the last evaluation, W, with its path in the case.
    pub fn load_powers(&self) -> Vec<(&str, f64)> {
        let m = &self.memory;
        let (sin, cos) = if self.frame == Frame::Rotating { m.turned } else { (0.0, 1.0) };
        self.loads.powers(&m.position, &m.velocity, Turned { sin, cos })
    }

    /// True when some load has no potential.
    pub fn has_loads_without_potential(&self) -> bool {
        self.loads.depend_on_place()
    }

    /// Accelerations that balance the forces: `z'' = -M^-1 g(t, z, z', 0)`.
    pub fn acceleration(&mut self, t: f64, z: &[f64], v: &[f64], a: &mut [f64]) {
        a.fill(0.0);
        self.evaluate(t, z, v, a);
        self.mass_factor.solve_in_place(&mut self.memory.residual);
        self.assembly.restrict_into(&self.memory.residual, a);
        a.iter_mut().for_each(|a| *a = -*a);
        if let Some(border) = self.border(&self.mass_factor, [0.0, 0.0, 1.0]) {
            border.apply(self.memory.out_of_torque, a);
        }
    }

    /// Adds the inertia of accelerations to the forces of the last evaluation, which was made without them.
    pub fn add_acceleration(&mut self, t: f64, a: &[f64]) {
        let m = &mut self.memory;
        self.assembly.expand_into(a, &mut m.acceleration);
        let (sin, cos) = self.drive.at(t).angle.sin_cos();
        for node in self.nodes.iter().filter(|n| n.turned) {
            for at in (node.start..node.end).step_by(3) {
                turn_pair(&mut m.acceleration[at..], sin, cos);
            }
        }
        self.mass.multiply(&m.acceleration, &mut m.damping);
        self.powers.torque += moment(&m.position, &m.damping);
    }

    /// Energies and angular momentum of a state.
    pub fn state(&mut self, t: f64, z: &[f64], v: &[f64]) -> MotionState {
        let zero = vec![0.0; z.len()];
        let turn = self.turn(t, z, v, &zero);
        self.move_to(turn, z, v, &zero);
        let m = &mut self.memory;
        let n = self.reference.len();
        m.residual.resize(n, 0.0);
        m.inertia.resize(n, 0.0);
        let strain = self.forces.internal_force(&m.position, None, &mut m.residual, &mut self.work);
        self.mass.multiply(&m.velocity, &mut m.inertia);
        let (sin, cos) = if self.frame == Frame::Rotating { turn.angle.sin_cos() } else { (0.0, 1.0) };
        let mut potential = 0.0;
        for ((q, q0), f) in m
            .position
            .chunks_exact(3)
            .zip(self.reference.chunks_exact(3))
            .zip(self.loads.fixed().chunks_exact(3))
        {
            let (y, z) = (cos * q[1] - sin * q[2], sin * q[1] + cos * q[2]);
            potential -= f[0] * (q[0] - q0[0]) + f[1] * (y - q0[1]) + f[2] * (z - q0[2]);
        }
        MotionState {
            kinetic: dot(&m.velocity, &m.inertia) / 2.0,
            strain,
            potential,
            stators: self.rub.energy(&m.position),
            angular_momentum: moment(&m.position, &m.inertia),
        }
    }

    /// All coordinates of a state in the frame of the unknowns' evaluation (the rotating frame, or the inertial
    /// one) and their displacement from the undeformed shaft turned by the drive's angle, in turned directions.
    pub fn coordinates(&self, t: f64, z: &[f64]) -> Vec<f64> {
        let mut q = self.assembly.expand(z);
        q.iter_mut().zip(&self.reference).for_each(|(q, q0)| *q += q0);
        if self.frame == Frame::Inertial {
            // seen from the turning frame
            let (sin, cos) = self.drive.at(t).angle.sin_cos();
            for node in self.nodes.iter().filter(|n| !n.turned) {
                for at in (node.start..node.end).step_by(3) {
                    turn_pair(&mut q[at..], -sin, cos);
                }
            }
        }
        q
    }
}

/// Turns the y and z components of a vector by an angle.
fn turn_pair(v: &mut [f64], sin: f64, cos: f64) {
    (v[1], v[2]) = (cos * v[1] - sin * v[2], sin * v[1] + cos * v[2]);
}

/// Turns every vector of a node.
fn turn_vectors(vectors: &mut [f64], rotation: &Matrix3<f64>) {
    for v in vectors.chunks_exact_mut(3) {
        let turned = rotation * Vector3::new(v[0], v[1], v[2]);
        v.copy_from_slice(turned.as_slice());
    }
}

/// Which rotations leave the constraints of a node as they are.
fn following(model: &Model, node: usize) -> Following {
    let mut result = Following::Rotation;
    for support in model.supports.iter().filter(|s| s.node == node) {
        result = match support.kind {
            SupportKind::Fix(_) => return Following::Nothing,
            SupportKind::Pinned(_) => result,
            _ => Following::Spin,
        };
    }
    // a rigid hub clears higher vectors, which any rotation respects
    result
}

/// Moment about x of forces (or momenta) on all coordinates, `sum y_k f_z,k - z_k f_y,k`: rotation turns every vector.
fn moment(position: &[f64], force: &[f64]) -> f64 {
    let one = |(s, f): (&[f64], &[f64])| s[1] * f[2] - s[2] * f[1];
    position.chunks_exact(3).zip(force.chunks_exact(3)).map(one).sum()
}
