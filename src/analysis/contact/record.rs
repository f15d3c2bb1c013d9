//! What a motion leaves behind: events, history, energies, snapshots.

use crate::contact::bodies::{Bodies, Motion as Momenta};
use crate::contact::boundary::{faces, on_curve};
use crate::contact::search::Search;
use crate::model::scene::{Face, Scene};
use crate::results::{ContactEvent, ContactHistory, PairState, Snapshot};
use nalgebra::Vector3;

/// Points of a drawn curve.
const DRAWN: usize = 4;
/// Bodies of a scene all of whose pairs are followed; of larger ones the pairs that have touched.
const FOLLOWED: usize = 6;
/// Share of a step that a time may miss an output by.
const ROUNDING: f64 = 1e-6;

/// Energies and momenta of a state.
#[derive(Debug, Clone, Copy)]
pub struct Energies {
    /// Kinetic energy, J, and momenta.
    pub motion: Momenta,
    /// J.
    pub strain: f64,
    /// In springs, J.
    pub contact: f64,
    /// Potential, J.
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
pub struct Touch {
    /// Slave and master.
    pub bodies: (usize, usize),
    /// Along the axes of both, m.
    pub positions: [f64; 2],
    /// Of a line, not a point.
    pub line: bool,
    /// m.
    pub penetration: f64,
    /// On the slave, N.
    pub force: Vector3<f64>,
    /// Share of the step at which it closes and opens: 0 and 1 when it lasts all of it.
    pub within: [f64; 2],
}

impl Touch {
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
    if count > FOLLOWED {
        return Vec::new();
    }
    (0..count)
        .flat_map(|a| (a..count).map(move |b| (a, b)))
        .filter(|(a, b)| a != b || scene.contact.with_itself)
        .collect()
}

/// "line", "point", "line and point" or "none".
pub fn kind(line: bool, point: bool) -> &'static str {
    match (line, point) {
        (true, true) => "line and point",
        (true, false) => "line",
        (false, true) => "point",
        (false, false) => "none",
    }
}

/// A pair of bodies in the course of the motion.
struct Pair {
    bodies: (usize, usize),
    names: [String; 2],
    /// Event that goes on.
    open: Option<usize>,
    /// Line and point probes of that event.
    kinds: [bool; 2],
    /// On the first body in the last step, N.
    force: Vector3<f64>,
    penetration: f64,
    points: usize,
    /// When the last of its probes opened, s.
    opened: f64,
}

impl Pair {
    /// Smallest gap: between nodes, or the penetration.
    fn gap(&self, between: Option<f64>) -> Option<f64> {
        if self.penetration > 0.0 { Some(between.unwrap_or(0.0).min(-self.penetration)) } else { between }
    }
}

/// Collects what a motion leaves behind.
pub struct Recorder<'a> {
    scene: &'a Scene,
    /// kg.
    masses: Vec<f64>,
    pairs: Vec<Pair>,
    /// Contacts.
    pub events: Vec<ContactEvent>,
    /// Over time.
    pub history: ContactHistory,
    /// Shapes.
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

impl<'a> Recorder<'a> {
    /// Nothing yet.
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
        self.pairs.push(Pair {
            bodies: (a, b),
            names,
            open: None,
            kinds: [false; 2],
            force: Vector3::zeros(),
            penetration: 0.0,
            points: 0,
            opened: 0.0,
        });
    }

    /// A step of `dt` that ends at `t`, s.
    pub fn step(&mut self, t: f64, dt: f64, energies: &Energies, touches: &[Touch]) {
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
        for pair in &mut self.pairs {
            let (a, b) = pair.bodies;
            let of_pair = |t: &&Touch| t.pair() == (a, b);
            let own: Vec<&Touch> = touches.iter().filter(of_pair).collect();
            pair.force = own.iter().map(|t| if t.bodies.0 == a { t.force } else { -t.force }).sum();
            pair.points = own.iter().filter(|t| t.within[1] == 1.0).count();
            let begin = t - dt;
            pair.opened = begin + dt * own.iter().map(|t| t.within[1]).fold(0.0, f64::max);
            pair.penetration = own.iter().map(|t| t.penetration).fold(0.0, f64::max);
            self.penetration = self.penetration.max(pair.penetration);
            let Some(first) = own.first() else {
                if let Some(event) = pair.open.take() {
                    self.events[event].until_s = Some(pair.opened);
                }
                continue;
            };
            let index = *pair.open.get_or_insert_with(|| {
                pair.kinds = [false; 2];
                let [slave, master] = first.positions;
                self.events.push(ContactEvent {
                    bodies: pair.names.clone(),
                    kind: "none",
                    from_s: begin + dt * own.iter().map(|t| t.within[0]).fold(1.0, f64::min),
                    until_s: None,
                    positions_m: if first.bodies.0 == a { [slave, master] } else { [master, slave] },
                    penetration_m: 0.0,
                    force_n: 0.0,
                    impulse_n_s: [0.0; 2],
                });
                self.events.len() - 1
            });
            pair.kinds[0] |= own.iter().any(|t| t.line);
            pair.kinds[1] |= own.iter().any(|t| !t.line);
            let event = &mut self.events[index];
            event.kind = kind(pair.kinds[0], pair.kinds[1]);
            event.penetration_m = event.penetration_m.max(pair.penetration);
            event.force_n = event.force_n.max(pair.force.norm());
            event.impulse_n_s[0] += pair.force.x * dt;
            event.impulse_n_s[1] += pair.force.y * dt;
        }
    }

    /// A row of the history.
    pub fn row(
        &mut self,
        bodies: &Bodies<'_>,
        search: &Search,
        state: (f64, &[f64], &[f64]),
        energies: &Energies,
    ) {
        let (t, q, v) = state;
        let history = &mut self.history;
        history.time_s.push(t);
        for (i, pair) in self.pairs.iter().enumerate() {
            let gap = search.distance(bodies, pair.bodies, q);
            history.gap_m[i].push(pair.gap(gap));
            history.force_n[i].push(pair.force.norm());
        }
        history.kinetic_j.push(energies.motion.kinetic);
        history.strain_j.push(energies.strain);
        history.contact_j.push(energies.contact);
        history.gravity_j.push(energies.gravity);
        history.work_j.push(energies.work);
        history.total_j.push(energies.total());
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
    pub fn pair_states(&self, bodies: &Bodies<'_>, search: &Search, q: &[f64]) -> Vec<PairState> {
        let one = |pair: &Pair| PairState {
            bodies: pair.names.clone(),
            kind: pair.open.map_or("none", |event| self.events[event].kind),
            points: pair.points,
            gap_m: pair.gap(search.distance(bodies, pair.bodies, q)),
            penetration_m: pair.penetration,
            force_n: pair.force.into(),
            angle_deg: None,
        };
        self.pairs.iter().map(one).collect()
    }

    /// Draws the scene.
    pub fn snapshot(&mut self, bodies: &Bodies<'_>, t: f64, q: &[f64]) {
        self.snapshots.push(Snapshot { label: format!("{t:.4} s"), outlines: outlines(bodies, q) });
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

/// Closed outlines of all bodies in the plane of x and y; of a spatial body the strip of its height around its axis.
pub fn outlines(bodies: &Bodies<'_>, q: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let scene = bodies.scene;
    let mut list = vec![Vec::new(); scene.bodies.len()];
    if scene.is_planar() {
        for face in faces(bodies) {
            let points = face.points(q);
            let drawn = if matches!(face.place, Face::Top | Face::Bottom) { DRAWN } else { 1 };
            for k in 0..drawn {
                let x = on_curve(&points, 2.0 * k as f64 / drawn as f64 - 1.0);
                list[face.body].push([x.x, x.y]);
            }
        }
        return list;
    }
    for (i, body) in scene.bodies.iter().enumerate() {
        let axis: Vec<[f64; 2]> =
            (0..body.nodes()).map(|n| bodies.node(i, n)).map(|at| [q[at], q[at + 1]]).collect();
        let half = body.height / 2.0;
        let side = |k: usize, sign: f64| {
            let (a, b) = (axis[k.saturating_sub(1)], axis[(k + 1).min(axis.len() - 1)]);
            let t = [b[0] - a[0], b[1] - a[1]];
            let length = t[0].hypot(t[1]);
            // an axis that stands on the plane is seen as a square
            if length < half * 1e-6 {
                return [axis[k][0] + sign * half, axis[k][1] + if k == 0 { half } else { -half }];
            }
            [axis[k][0] - sign * half * t[1] / length, axis[k][1] + sign * half * t[0] / length]
        };
        list[i].extend((0..axis.len()).map(|k| side(k, -1.0)));
        list[i].extend((0..axis.len()).rev().map(|k| side(k, 1.0)));
    }
    list
}

/// Whether a time has come, up to rounding.
pub fn due(t: f64, at: f64, step: f64) -> bool {
    t >= at - ROUNDING * step
}
