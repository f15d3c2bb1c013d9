//! Equilibrium of a scene under its loads, with penalty springs or exact constraints.

use crate::analysis::contact::Detector;
use crate::error::Result;
use crate::linalg::lu::{Entries, LuSolver};
use crate::model::scene::Enforcement;
use crate::results::{ContactCost, ContactSolver};
use crate::scene::bodies::Bodies;
use crate::scene::gap::product;
use crate::scene::penalty::{self, ContactSpring};
use crate::scene::planar::probes::Key;
use nalgebra::DMatrix;
use std::collections::BTreeMap;
use std::time::Instant;

/// Newton iterations of a load step.
const MOST_ITERATIONS: usize = 60;
/// Correction of a converged state, over the height.
const CONVERGED_PER_HEIGHT: f64 = 1e-11;
/// Correction over the height from which, after some iterations, nothing leads back.
const LOST_PER_HEIGHT: f64 = 1e6;
/// Number of iterations after which a correction beyond [`LOST_PER_HEIGHT`] ends the load step.
const SETTLING: usize = 5;
/// Times that a load step is halved.
const MOST_HALVINGS: i32 = 10;
/// Largest correction of an iteration, over the height, while something is near.
const LARGEST_CORRECTION_HEIGHTS: f64 = 0.5;
/// Gap over the height up to which a spring has its stiffness although it is not compressed.
const TOUCHING_HEIGHTS: f64 = 1e-12;
/// Correction over the height up to which two states that take turns are one equilibrium: a node that rests on the kink between two
/// elements is pushed to and fro by their normals.
const TURNS: f64 = 1e-4;
/// What two corrections miss to be opposite, over their size.
const OPPOSITE: f64 = 1e-2;
/// Compliance that keeps coincident constraints apart, over that of the penalty of a point; it is iterated away.
const COMPLIANCE_SHARE: f64 = 1e-3;

/// A state of a scene at rest, with the share of the loads that it carries.
pub struct SceneState {
    /// Coordinates of all bodies, one body after the other.
    pub q: Vec<f64>,
    /// Share of the loads.
    pub factor: f64,
    /// Contacts that act; for constraints the force is in `forces`.
    pub springs: Vec<ContactSpring>,
    /// Force of each, N, pushing apart.
    pub forces: Vec<f64>,
    /// How it went.
    pub stats: ContactSolver,
    /// Where the time went.
    pub cost: ContactCost,
    /// What stopped it, if the whole load was not reached.
    pub stopped: Option<String>,
}

/// Finds the equilibrium step by step.
pub struct SceneEquilibrium<'a> {
    bodies: &'a Bodies<'a>,
    detector: Detector,
    solver: LuSolver,
    stats: ContactSolver,
    cost: ContactCost,
    height: f64,
    /// Multipliers of the active probes, N.
    multipliers: BTreeMap<Key, f64>,
}

impl<'a> SceneEquilibrium<'a> {
    /// Of these bodies.
    pub fn new(bodies: &'a Bodies<'a>, detector: Detector) -> Self {
        let height = bodies.scene.bodies.iter().map(|b| b.height).fold(f64::INFINITY, f64::min);
        Self {
            bodies,
            detector,
            solver: LuSolver::default(),
            stats: ContactSolver::default(),
            cost: ContactCost::default(),
            height,
            multipliers: BTreeMap::new(),
        }
    }

    /// Loads in steps, each cut in halves where Newton's method does not converge. `watch` sees the share of the loads and stops
    /// by false.
    pub fn solve(mut self, watch: crate::analysis::Watch<'_>) -> (SceneState, Detector) {
        let mut q = self.bodies.reference().to_vec();
        let step = 1.0 / self.bodies.scene.contact.load_steps as f64;
        let (mut factor, mut size) = (0.0, step);
        let mut stopped = None;
        while factor < 1.0 {
            let next = if factor + size > 1.0 - 1e-9 { 1.0 } else { factor + size };
            if !watch(factor, &format!("{:.3} of the load", factor)) {
                stopped = Some("stopped".to_owned());
                break;
            }
            let multipliers = self.multipliers.clone();
            match self.step(&q, next) {
                Ok(found) => {
                    self.stats.steps += 1;
                    (q, factor) = (found, next);
                    size = (size * 2.0).min(step);
                }
                Err(why) => {
                    self.multipliers = multipliers;
                    self.stats.cut += 1;
                    size /= 2.0;
                    if size < step * 2.0_f64.powi(-MOST_HALVINGS) {
                        stopped = Some(why);
                        break;
                    }
                }
            }
        }
        let limit = TOUCHING_HEIGHTS * self.height;
        let (springs, forces) = match self.bodies.scene.contact.method {
            Enforcement::ActiveSet => {
                let all = self.detector.springs(self.bodies, &q, f64::INFINITY);
                let acting = all.into_iter().filter(|(k, _)| self.multiplier(*k) > 0.0);
                acting.map(|(k, spring)| (spring, self.multiplier(k))).unzip()
            }
            _ => {
                let list = self.detector.springs(self.bodies, &q, limit);
                list.into_iter().map(|(_, s)| (s.weight * s.penetration(), s)).map(|(f, s)| (s, f)).unzip()
            }
        };
        self.stats.searches = self.detector.counts().searches;
        self.cost.search_s = self.detector.counts().seconds;
        let state = SceneState { q, factor, springs, forces, stats: self.stats, cost: self.cost, stopped };
        (state, self.detector)
    }

    fn multiplier(&self, probe: Key) -> f64 {
        self.multipliers.get(&probe).copied().unwrap_or(0.0)
    }

    fn step(&mut self, start: &[f64], factor: f64) -> std::result::Result<Vec<f64>, String> {
        let exact = self.bodies.scene.contact.method == Enforcement::ActiveSet;
        let mut q = start.to_vec();
        let (mut last, mut before) = (f64::INFINITY, Vec::new());
        for iteration in 1..=MOST_ITERATIONS {
            self.stats.iterations += 1;
            self.stats.most_iterations = self.stats.most_iterations.max(iteration);
            let begin = Instant::now();
            self.detector.update(self.bodies, &q);
            self.cost.search_s += begin.elapsed().as_secs_f64();
            let (delta, settled) = if exact { self.constrained(&q, factor) } else { self.sprung(&q, factor) }
                .map_err(|e| e.to_string())?;
            let size = largest(&delta);
            if !size.is_finite() {
                return Err("a correction is not finite".to_owned());
            }
            if iteration >= SETTLING && size > LOST_PER_HEIGHT * self.height {
                return Err(format!("Newton's method is lost: a correction of {size:.1e} m"));
            }
            let turns = settled && iteration > SETTLING && size <= TURNS * self.height;
            if turns && opposite(&delta, &before) {
                let half: Vec<f64> = delta.iter().map(|d| d / 2.0).collect();
                self.correct(&mut q, &half);
                return Ok(q);
            }
            self.correct(&mut q, &delta);
            // a correction at the rounding error of the system is the end as well
            let stalled = iteration > 10 && size < 1e-8 * self.height && size >= last / 2.0;
            if settled && (size <= CONVERGED_PER_HEIGHT * self.height || stalled) {
                return Ok(q);
            }
            (last, before) = (size, delta);
        }
        Err(format!("{MOST_ITERATIONS} Newton iterations, last correction {last:.1e} m"))
    }

    /// Internal forces less loads, and their tangent.
    fn balance(&mut self, q: &[f64], factor: f64, entries: &mut Entries) -> Vec<f64> {
        let start = Instant::now();
        let n = self.bodies.len();
        let (mut force, mut load) = (vec![0.0; n], vec![0.0; n]);
        self.bodies.internal_force(q, &mut force);
        self.bodies.add_tangent(q, entries);
        self.bodies.loads(q, 0.0, factor, &mut load, Some((entries, 1.0)));
        force.iter_mut().zip(&load).for_each(|(f, l)| *f -= l);
        self.cost.elements_s += start.elapsed().as_secs_f64();
        force
    }

    fn solve_system(&mut self, n: usize, entries: &Entries, x: &mut [f64]) -> Result<()> {
        let start = Instant::now();
        let solved = self.solver.solve(n, entries, x);
        self.cost.solve_s += start.elapsed().as_secs_f64();
        self.stats.entries += entries.len();
        self.stats.orderings = self.solver.orderings;
        solved
    }

    /// Moves the state by a correction, shortened while something is near.
    fn correct(&self, q: &mut [f64], delta: &[f64]) {
        let size = largest(delta);
        let limit = LARGEST_CORRECTION_HEIGHTS * self.height;
        let share = if self.detector.any() && size > limit { limit / size } else { 1.0 };
        self.bodies.free().iter().zip(delta).for_each(|(&k, d)| q[k] += share * d);
    }

    /// A Newton step with springs: its correction, and whether their places have settled.
    fn sprung(&mut self, q: &[f64], factor: f64) -> Result<(Vec<f64>, bool)> {
        let mut entries = Entries::default();
        let mut force = self.balance(q, factor, &mut entries);
        let start = Instant::now();
        let recut = self.detector.cut(self.bodies, q);
        let springs = self.detector.springs(self.bodies, q, TOUCHING_HEIGHTS * self.height);
        self.stats.gaps += springs.len();
        let springs: Vec<ContactSpring> = springs.into_iter().map(|(_, s)| s).collect();
        penalty::add(
            &springs,
            q,
            self.bodies.components(),
            self.bodies.unknown(),
            &mut force,
            Some(&mut entries),
        );
        self.cost.gaps_s += start.elapsed().as_secs_f64();
        let mut delta: Vec<f64> = self.bodies.free().iter().map(|&k| -force[k]).collect();
        self.solve_system(delta.len(), &entries, &mut delta)?;
        Ok((delta, recut <= CONVERGED_PER_HEIGHT.sqrt()))
    }

    /// A step of the primal-dual active set: probes with `multiplier - penalty g > 0` are held at g = 0. Its correction, and whether the
    /// set has settled.
    fn constrained(&mut self, q: &[f64], factor: f64) -> Result<(Vec<f64>, bool)> {
        let mut entries = Entries::default();
        let force = self.balance(q, factor, &mut entries);
        let start = Instant::now();
        let list = self.detector.springs(self.bodies, q, f64::INFINITY);
        self.stats.gaps += list.len();
        self.cost.gaps_s += start.elapsed().as_secs_f64();
        let components = self.bodies.components();
        let unknown = self.bodies.unknown();
        let scene = self.bodies.scene;
        let penalty = scene.largest_penalty();
        let scale = (0..scene.bodies.len()).map(|i| scene.point_penalty(i, penalty)).fold(0.0, f64::max);
        let active: Vec<&(Key, ContactSpring)> = list
            .iter()
            .filter(|(k, s)| {
                self.multiplier(*k) - scale * s.gap.value > -scale * TOUCHING_HEIGHTS * self.height
            })
            .collect();
        let n = self.bodies.free().len();
        let mut rhs = vec![0.0; n + active.len()];
        self.bodies.free().iter().enumerate().for_each(|(u, &k)| rhs[u] = -force[k]);
        for (a, (k, spring)) in active.iter().enumerate() {
            let gradient = spring.gap.gradient(components);
            let row = n + a;
            for (coordinate, value) in &gradient {
                if let Some(u) = unknown[*coordinate] {
                    entries.add(u, row, -value);
                    entries.add(row, u, -value);
                }
            }
            let old = self.multiplier(*k);
            let compliance = COMPLIANCE_SHARE / scale;
            entries.add(row, row, -compliance);
            rhs[row] = spring.gap.value - compliance * old;
            let places = spring.gap.coordinates(components);
            let mut block = DMatrix::zeros(places.len(), places.len());
            spring.gap.add_curvature(q, components, -old, &mut block);
            for (i, &r) in places.iter().enumerate() {
                for (j, &c) in places.iter().enumerate() {
                    if let (Some(r), Some(c)) = (unknown[r], unknown[c]) {
                        entries.add(r, c, block[(i, j)]);
                    }
                }
            }
        }
        self.solve_system(rhs.len(), &entries, &mut rhs)?;
        self.multipliers.clear();
        let mut settled = true;
        let mut moved = vec![0.0; self.bodies.len()];
        self.bodies.free().iter().zip(&rhs[..n]).for_each(|(&k, d)| moved[k] = *d);
        for (a, (k, spring)) in active.iter().enumerate() {
            let value = rhs[n + a];
            self.multipliers.insert(*k, value.max(0.0));
            // held without pressure, or pressed without being closed: not the last set
            let closed = spring.gap.value + product(&spring.gap.gradient(components), &moved);
            settled &= value >= -1e-9 * scale * self.height && closed.abs() <= 1e-9 * self.height;
        }
        let penetrating = |(k, s): &&(Key, ContactSpring)| {
            s.gap.value < -1e-9 * self.height && !active.iter().any(|(a, _)| a == k)
        };
        settled &= !list.iter().any(|entry| penetrating(&entry));
        rhs.truncate(n);
        Ok((rhs, settled))
    }
}

/// Largest size of a component.
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0_f64, |m, d| m.max(d.abs()))
}

/// Whether a correction takes back the one before.
fn opposite(delta: &[f64], before: &[f64]) -> bool {
    let missed = delta.iter().zip(before).fold(0.0_f64, |m, (a, b)| m.max((a + b).abs()));
    before.len() == delta.len() && missed <= OPPOSITE * largest(delta)
}
