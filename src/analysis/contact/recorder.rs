//! What a motion leaves behind: events, history, energies, snapshots.

use crate::model::scene::{Body, Face, Scene};
use crate::results::{ContactEnergy, ContactEvent, ContactHistory, PairState, Snapshot};
use crate::scene::bodies::{Bodies, RigidMotion as Momenta};
use crate::scene::penalty::ContactModel;
use crate::scene::planar::boundary::{faces, on_curve};
use crate::scene::planar::probes::PlanarSearch;
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// Points of a drawn curve and of a drawn section.
const DRAWN: usize = 4;
const CIRCLE: usize = 48;
/// Share of its length below which a body's axis is seen end on.
const END_ON: f64 = 0.2;
/// Bodies of a scene all of whose pairs are followed; of larger ones the pairs that have touched.
const FOLLOWED_BODIES: usize = 6;
/// Share of a step that a time may miss an output by.
const OUTPUT_TIME_SHARE: f64 = 1e-6;

/// Energies and momenta of a state.
#[derive(Debug, Clone, Copy)]
pub struct Energies {
    /// Kinetic energy, J, and momenta.
    pub motion: Momenta,
    /// Strain energy of all bodies, J.
    pub strain: f64,
    /// In springs, J.
    pub contact: f64,
    /// Potential energy of gravity, J.
    pub gravity: f64,
    /// That the loads have done, J.
    pub work: f64,
    /// Impulse of the loads (N s) and moment impulse about the origin (N m s).
    pub impulse: [f64; 3],
}

impl Energies {
    /// All energies less the work, J.
    pub fn total(&self) -> f64 {
        self.motion.kinetic + self.strain + self.contact + self.gravity - self.work
    }
}

/// A probe in contact within a step.
#[derive(Debug, Clone, Copy)]
pub struct ContactTouch {
    /// Slave and master.
    pub bodies: (usize, usize),
    /// Along the axes of both, m.
    pub positions: [f64; 2],
    /// What meets what.
    pub model: ContactModel,
    /// Penetration of the touching point, m.
    pub penetration: f64,
    /// On the slave over the step, as the integrator takes it, N.
    pub force: Vector3<f64>,
    /// Share of the step at which it closes and opens: 0 and 1 when it lasts all of it.
    pub within: [f64; 2],
}

impl ContactTouch {
    /// Its bodies, the smaller index first.
    pub fn pair(&self) -> (usize, usize) {
        (self.bodies.0.min(self.bodies.1), self.bodies.0.max(self.bodies.1))
    }

    /// Share of a step in which a gap is closed, of its values at both ends.
    pub fn within(before: f64, after: f64) -> [f64; 2] {
        let zero = before / (before - after);
        [if before > 0.0 { zero } else { 0.0 }, if after > 0.0 { zero } else { 1.0 }]
    }
}

/// Pairs of bodies that are followed from the start, the smaller index first: all of a small scene.
pub fn pairs(scene: &Scene) -> Vec<(usize, usize)> {
    let count = scene.bodies.len();
    if count > FOLLOWED_BODIES {
        return Vec::new();
    }
    (0..count)
        .flat_map(|a| (a..count).map(move |b| (a, b)))
        .filter(|(a, b)| a != b || scene.contact.with_itself)
        .collect()
}

/// Shares of a contact by model.
pub type Shares = [f64; ContactModel::ALL.len()];

/// The model that carries most, if any does.
pub fn kind(shares: &Shares) -> Option<&'static str> {
    let most =
        ContactModel::ALL.into_iter().max_by(|a, b| shares[*a as usize].total_cmp(&shares[*b as usize]))?;
    (shares[most as usize] > 0.0).then(|| most.name())
}

/// A pair of bodies in the course of the motion.
struct BodyPair {
    bodies: (usize, usize),
    names: [String; 2],
    /// Event that goes on.
    open: Option<usize>,
    /// Impulse of that event by model, N s.
    shares: Shares,
    /// On the first body in the last step, N.
    force: Vector3<f64>,
    /// On the first body since the last row of the history, N s.
    impulse: Vector3<f64>,
    penetration: f64,
    points: usize,
    /// When the last of its probes opened, s.
    opened: f64,
}

impl BodyPair {
    /// Smallest gap: between nodes, or the penetration.
    fn gap(&self, between: Option<f64>) -> Option<f64> {
        if self.penetration > 0.0 { Some(between.unwrap_or(0.0).min(-self.penetration)) } else { between }
    }
}

/// Collects what a motion leaves behind.
pub struct SceneRecorder<'a> {
    scene: &'a Scene,
    /// Masses of the bodies, kg.
    masses: Vec<f64>,
    pairs: Vec<BodyPair>,
    /// Contacts that were made and lost so far.
    pub events: Vec<ContactEvent>,
    /// What is written at each output time.
    pub history: ContactHistory,
    /// Energies over time.
    pub energy: ContactEnergy,
    /// Outlines of the bodies at chosen times, for drawing.
    pub snapshots: Vec<Snapshot>,
    /// Largest penetration, m.
    pub penetration: f64,
    start: Energies,
    last: Energies,
    /// Largest change of the total, largest kinetic energy, last change, J.
    change: [f64; 3],
    /// Largest sum of the bodies' momenta and largest residuals.
    momenta: [f64; 3],
    largest: [f64; 2],
}

impl<'a> SceneRecorder<'a> {
    /// A record in which nothing has happened yet, with the energies at the start.
    pub fn new(bodies: &Bodies<'a>, start: Energies) -> Self {
        let scene = bodies.scene;
        let history = ContactHistory {
            ends_m: vec![Vec::new(); scene.bodies.len()],
            velocity_m_s: vec![Vec::new(); scene.bodies.len()],
            ..ContactHistory::default()
        };
        let mut recorder = Self {
            scene,
            masses: (0..scene.bodies.len()).map(|i| bodies.mass_of(i)).collect(),
            pairs: Vec::new(),
            events: Vec::new(),
            history,
            energy: ContactEnergy::default(),
            snapshots: Vec::new(),
            penetration: 0.0,
            start,
            last: start,
            change: [0.0; 3],
            momenta: [0.0; 3],
            largest: [0.0; 2],
        };
        pairs(scene).into_iter().for_each(|pair| recorder.follow(pair));
        recorder
    }

    /// Follows a pair from now on.
    fn follow(&mut self, (a, b): (usize, usize)) {
        let names = [a, b].map(|i| self.scene.bodies[i].name.clone());
        let rows = self.history.time_s.len();
        self.history.pairs.push(names.clone());
        self.history.gap_m.push(vec![None; rows]);
        self.history.force_n.push(vec![0.0; rows]);
        self.history.touches.push(Vec::new());
        self.pairs.push(BodyPair {
            bodies: (a, b),
            names,
            open: None,
            shares: [0.0; 3],
            force: Vector3::zeros(),
            impulse: Vector3::zeros(),
            penetration: 0.0,
            points: 0,
            opened: 0.0,
        });
    }

    /// A step of `dt` that ends at `t`, s.
    pub fn step(&mut self, t: f64, dt: f64, energies: &Energies, touches: &[ContactTouch]) {
        self.last = *energies;
        let change = energies.total() - self.start.total();
        self.change[0] = self.change[0].max(change.abs());
        self.change[1] = self.change[1].max(energies.motion.kinetic);
        self.change[2] = change;
        let (now, start) = (&energies.motion, &self.start.motion);
        let miss = |c: usize| now.momentum[c] - start.momentum[c] - energies.impulse[c];
        self.momenta[0] = self.momenta[0].max(miss(0).hypot(miss(1)));
        self.momenta[1] =
            self.momenta[1].max((now.angular_momentum - start.angular_momentum - energies.impulse[2]).abs());
        for touch in touches {
            if !self.pairs.iter().any(|pair| pair.bodies == touch.pair()) {
                self.follow(touch.pair());
            }
        }
        for (pair, drawn) in self.pairs.iter_mut().zip(&mut self.history.touches) {
            let (a, b) = pair.bodies;
            let of_pair = |t: &&ContactTouch| t.pair() == (a, b);
            let own: Vec<&ContactTouch> = touches.iter().filter(of_pair).collect();
            pair.force = own.iter().map(|t| if t.bodies.0 == a { t.force } else { -t.force }).sum();
            pair.impulse += pair.force * dt;
            pair.points = own.iter().filter(|t| t.within[1] == 1.0).count();
            let begin = t - dt;
            pair.opened = begin + dt * own.iter().map(|t| t.within[1]).fold(0.0, f64::max);
            pair.penetration = own.iter().map(|t| t.penetration).fold(0.0, f64::max);
            self.penetration = self.penetration.max(pair.penetration);
            let Some(first) = own.first() else {
                if let Some(event) = pair.open.take() {
                    self.events[event].until_s = Some(pair.opened);
                    drawn.push([t, 0.0]);
                }
                continue;
            };
            if pair.open.is_none() {
                drawn.push([begin, 0.0]);
            }
            drawn.push([t, pair.penetration]);
            let index = *pair.open.get_or_insert_with(|| {
                pair.shares = [0.0; 3];
                let [slave, master] = first.positions;
                self.events.push(ContactEvent {
                    pair: pair.names.clone(),
                    kind: first.model.name(),
                    kinds: Vec::new(),
                    time_s: begin + dt * own.iter().map(|t| t.within[0]).fold(1.0, f64::min),
                    until_s: None,
                    positions_m: if first.bodies.0 == a { [slave, master] } else { [master, slave] },
                    gap_m: 0.0,
                    force_n: 0.0,
                    impulse_n_s: [0.0; 2],
                });
                self.events.len() - 1
            });
            own.iter().for_each(|t| pair.shares[t.model as usize] += t.force.norm() * dt);
            let event = &mut self.events[index];
            event.kind = kind(&pair.shares).unwrap_or(event.kind);
            event.kinds = ContactModel::ALL
                .into_iter()
                .filter(|m| pair.shares[*m as usize] > 0.0)
                .map(ContactModel::name)
                .collect();
            event.gap_m = event.gap_m.min(-pair.penetration);
            event.force_n = event.force_n.max(pair.force.norm());
            event.impulse_n_s[0] += pair.force.x * dt;
            event.impulse_n_s[1] += pair.force.y * dt;
        }
    }

    /// A row of the history.
    pub fn row(
        &mut self,
        bodies: &Bodies<'_>,
        search: &PlanarSearch,
        state: (f64, &[f64], &[f64]),
        energies: &Energies,
    ) {
        let (t, q, v) = state;
        let history = &mut self.history;
        let since = history.time_s.last().map_or(0.0, |last| t - last);
        history.time_s.push(t);
        for (i, pair) in self.pairs.iter_mut().enumerate() {
            let gap = search.distance(bodies, pair.bodies, q);
            history.gap_m[i].push(pair.gap(gap));
            let impulse = std::mem::take(&mut pair.impulse).norm();
            history.force_n[i].push(if since > 0.0 { impulse / since } else { 0.0 });
        }
        let list = &mut self.energy;
        list.kinetic.push(energies.motion.kinetic);
        list.strain.push(energies.strain);
        list.contact.push(energies.contact);
        list.gravity.push(energies.gravity);
        list.work.push(energies.work);
        list.total.push(energies.total());
        let mut momentum = vec![0.0; q.len()];
        bodies.mass_times(v, &mut momentum);
        let mut sum = 0.0;
        for (i, body) in self.scene.bodies.iter().enumerate() {
            let (first, last) = (bodies.node(i, 0), bodies.node(i, body.nodes() - 1));
            history.ends_m[i].push([q[first], q[first + 1], q[last], q[last + 1]]);
            let total = |c: usize| (first..=last).step_by(4).map(|k| momentum[k + c]).sum::<f64>();
            let mass = self.masses[i];
            history.velocity_m_s[i].push([total(0) / mass, total(1) / mass]);
            sum += total(0).hypot(total(1));
        }
        self.largest[0] = self.largest[0].max(sum);
        self.largest[1] = self.largest[1].max(energies.motion.angular_momentum.abs());
    }

    /// Energies after the last step.
    pub fn last(&self) -> &Energies {
        &self.last
    }

    /// State of every pair after the last step.
    pub fn pair_states(&self, bodies: &Bodies<'_>, search: &PlanarSearch, q: &[f64]) -> Vec<PairState> {
        let one = |pair: &BodyPair| PairState {
            pair: pair.names.clone(),
            kind: pair.open.map(|event| self.events[event].kind),
            points: pair.points,
            gap_m: pair.gap(search.distance(bodies, pair.bodies, q)),
            penetration_m: pair.penetration,
            force_n: pair.force.into(),
            penalty_n_m3: crate::analysis::contact::own_penalty(self.scene, pair.bodies),
            angle_deg: None,
        };
        self.pairs.iter().map(one).collect()
    }

    /// Draws the scene.
    pub fn snapshot(&mut self, bodies: &Bodies<'_>, t: f64, q: &[f64]) {
        self.snapshots.extend(views(bodies, q, &format!("{t:.4} s")));
    }

    /// Largest and last change of the total energy over the largest kinetic energy.
    pub fn energy_change(&self) -> Option<(f64, f64)> {
        (self.change[1] > 0.0).then(|| (self.change[0] / self.change[1], self.change[2] / self.change[1]))
    }

    /// Residuals of momentum and angular momentum over their largest size, when nothing is held.
    pub fn momentum_residuals(&self) -> Option<[f64; 2]> {
        let held = self.scene.bodies.iter().any(|b| !b.supports.is_empty());
        let sizes = self.largest;
        (!held && sizes[0] > 0.0).then(|| {
            // an angular momentum that stays near zero is measured by the momentum at the scene's size
            let arm = self.scene.bodies.iter().map(|b| b.length).fold(0.0, f64::max);
            [self.momenta[0] / sizes[0], self.momenta[1] / sizes[1].max(sizes[0] * arm)]
        })
    }
}

/// The scene as it is drawn: in the plane of x and y, in space also in that of x and z.
pub fn views(bodies: &Bodies<'_>, q: &[f64], label: &str) -> Vec<Snapshot> {
    let snapshot = |axes, outlines| Snapshot { label: label.to_owned(), axes, outlines };
    if bodies.scene.is_planar() {
        return vec![snapshot(["x", "y"], planar_outlines(bodies, q))];
    }
    let along =
        |seen| bodies.scene.bodies.iter().enumerate().map(|(i, _)| strip(bodies, q, i, seen)).collect();
    vec![snapshot(["x", "y"], along([0, 1])), snapshot(["x", "z"], along([0, 2]))]
}

/// Closed outlines of planar bodies.
fn planar_outlines(bodies: &Bodies<'_>, q: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let mut list = vec![Vec::new(); bodies.scene.bodies.len()];
    for face in faces(bodies) {
        let points = face.points(q);
        let drawn = if matches!(face.place, Face::Top | Face::Bottom) { DRAWN } else { 1 };
        for k in 0..drawn {
            let x = on_curve(&points, 2.0 * k as f64 / drawn as f64 - 1.0);
            list[face.body].push([x.x, x.y]);
        }
    }
    list
}

/// Closed outline of a round body seen along an axis of coordinates: a strip of its diameter around its axis; where it is seen
/// end on, the section moved from the start to the end.
fn strip(bodies: &Bodies<'_>, q: &[f64], body: usize, [across, up]: [usize; 2]) -> Vec<[f64; 2]> {
    let Body { height, length, .. } = bodies.scene.bodies[body];
    let half = height / 2.0;
    let places = (0..bodies.scene.bodies[body].nodes()).map(|n| bodies.node(body, n));
    let axis: Vec<[f64; 2]> = places.map(|at| [q[at + across], q[at + up]]).collect();
    let (first, last) = (axis[0], axis[axis.len() - 1]);
    let chord = [last[0] - first[0], last[1] - first[1]];
    if chord[0].hypot(chord[1]) < END_ON * length {
        let towards = chord[1].atan2(chord[0]);
        let point = |k: usize| {
            let angle = towards - PI / 2.0 + TAU * k as f64 / CIRCLE as f64;
            let center = if 2 * k <= CIRCLE { last } else { first };
            [center[0] + half * angle.cos(), center[1] + half * angle.sin()]
        };
        return (0..CIRCLE).map(point).collect();
    }
    let side = |k: usize, sign: f64| {
        let (a, b) = (axis[k.saturating_sub(1)], axis[(k + 1).min(axis.len() - 1)]);
        let t = [b[0] - a[0], b[1] - a[1]];
        let scaled = sign * half / t[0].hypot(t[1]).max(f64::MIN_POSITIVE);
        [axis[k][0] - scaled * t[1], axis[k][1] + scaled * t[0]]
    };
    (0..axis.len()).map(|k| side(k, -1.0)).chain((0..axis.len()).rev().map(|k| side(k, 1.0))).collect()
}

/// Whether a time has come, up to rounding.
pub fn due(t: f64, at: f64, step: f64) -> bool {
    t >= at - OUTPUT_TIME_SHARE * step
}
