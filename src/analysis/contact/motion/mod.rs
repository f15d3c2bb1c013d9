//! Motion of a planar scene: an energy-consistent step with penalty springs, and the semi-implicit Euler step with penalty
//! springs or complementarity of gap velocity and impulse.

mod semi_implicit;

use crate::analysis::contact::recorder::{ContactTouch, Energies, SceneRecorder};
use crate::error::{Error, Result};
use crate::linalg::factor::Ldlt;
use crate::linalg::lu::{Entries, LuSolver};
use crate::model::scene::{Enforcement, Stepping};
use crate::results::{ContactCost, ContactSolver};
use crate::scene::bodies::Bodies;
use crate::scene::gap::Hit;
use crate::scene::penalty::{self, GapGradient, SpringStroke, Sums};
use crate::scene::planar::probes::PlanarSearch;
use std::time::Instant;

/// Newton iterations of a step.
const MOST_ITERATIONS: usize = 25;
/// Correction of a converged step, over the height.
const CONVERGED_PER_HEIGHT: f64 = 1e-11;
/// What is left of a correction from one iteration to the next, beyond which the matrix of an earlier state has served.
const SERVING_RATE: f64 = 0.05;
/// Springs that close or open in place of one, at most, for a matrix to serve on: one of so many.
const SPRINGS_PER_CHANGED_ONE: usize = 16;
/// Error over the height that converging corrections may leave.
const LEFT_PER_HEIGHT: f64 = 1e-13;
/// Times that a step is halved.
const MOST_HALVINGS: usize = 10;
/// Penetration in heights that a step may not reach.
const DEEPEST_HEIGHTS: f64 = 0.25;
/// Parts that a step may be cut into beforehand.
const MOST_PARTS: usize = 10_000;
/// Remedy of a step whose equations are not solved.
const REMEDY_OF_STIFFNESS: &str = "take a smaller contact.step, a smaller contact.penalty or more elements";
/// Share of the stability limit `2/w` of the semi-implicit step that is advised: elements stiffen while they are pressed.
const ADVISED_STABLE_SHARE: f64 = 0.8;
/// A scene in motion.
pub struct Motion<'a> {
    /// The bodies that move.
    pub bodies: &'a Bodies<'a>,
    /// Detection of near pairs, with the probes whose gaps are watched.
    pub search: PlanarSearch,
    /// Coordinates at the present time.
    pub q: Vec<f64>,
    /// Their rates, 1/s.
    pub v: Vec<f64>,
    /// Time since the start of the run, s.
    pub t: f64,
    /// How it went.
    pub stats: ContactSolver,
    /// Where the time went.
    pub cost: ContactCost,
    /// Work of the loads so far, J.
    work: f64,
    /// Impulse and moment impulse of the loads so far.
    impulse: [f64; 3],
    mass: Option<Ldlt<f64>>,
    /// Internal force and strain energy at `q`.
    internal: (Vec<f64>, f64),
    solver: LuSolver,
    entries: Entries,
    /// Derivatives of the springs, between the curves that have met since the last search.
    springs: Sums,
    /// Number of that search.
    searched: usize,
    /// What the matrix was factorised for; `None` where it has served.
    factored: Option<Factored>,
    height: f64,
}

/// What the matrix of an energy-consistent step belongs to: it serves further iterations and steps as long as they converge.
struct Factored {
    /// Length of the step that the matrix was made for, s.
    dt: f64,
    /// Probes whose springs are compressed at either end of the step, and whether they are at the second.
    closed: Vec<(usize, bool)>,
}

impl Factored {
    /// Whether it may serve a state: few of its springs are others.
    fn serves(&self, here: &Self) -> bool {
        let others =
            |a: &Self, b: &Self| a.closed.iter().filter(|c| b.closed.binary_search(c).is_err()).count();
        let fewer = self.closed.len().min(here.closed.len());
        self.dt == here.dt && SPRINGS_PER_CHANGED_ONE * (others(self, here) + others(here, self)) <= fewer
    }
}

/// Why a step of this size did not succeed; a smaller one may.
enum StepFailure {
    /// What happened, and the remedy when the smallest step fails too.
    Smaller(String, &'static str),
    Final(Error),
}

/// Springs that give way too much.
fn sunk(depth: f64) -> StepFailure {
    StepFailure::Smaller(
        format!("a penetration of {depth:.1e} m"),
        "take a larger contact.penalty: the springs are too soft for this impact; or a smaller contact.step",
    )
}

/// Newton's iterations ended with that correction, m.
fn not_converged(last: f64) -> StepFailure {
    StepFailure::Smaller(
        match last.is_finite() {
            true => format!("Newton's method did not converge (last correction {last:.1e} m)"),
            false => "Newton's method is lost: its first correction leaves all bounds".to_owned(),
        },
        REMEDY_OF_STIFFNESS,
    )
}

impl From<Error> for StepFailure {
    fn from(error: Error) -> Self {
        Self::Final(error)
    }
}

/// What a step found.
struct Stepped {
    q: Vec<f64>,
    v: Vec<f64>,
    internal: (Vec<f64>, f64),
    contact: f64,
    work: f64,
    impulse: [f64; 3],
    touches: Vec<ContactTouch>,
}

impl<'a> Motion<'a> {
    /// A scene at its start.
    ///
    /// # Errors
    /// A mass matrix that can't be factorised.
    pub fn new(bodies: &'a Bodies<'a>, search: PlanarSearch) -> Result<Self> {
        let scene = bodies.scene;
        let mass = match scene.contact.stepping {
            Stepping::SemiImplicit => Some(Ldlt::new(&bodies.mass()?)?),
            Stepping::EnergyConsistent => None,
        };
        let mut force = vec![0.0; bodies.len()];
        let q = bodies.reference().to_vec();
        let energy = bodies.internal_force(&q, &mut force);
        Ok(Self {
            bodies,
            search,
            v: bodies.initial_velocity(),
            q,
            t: 0.0,
            stats: ContactSolver::default(),
            cost: ContactCost::default(),
            work: 0.0,
            impulse: [0.0; 3],
            mass,
            internal: (force, energy),
            solver: LuSolver::default(),
            entries: Entries::default(),
            springs: Sums::default(),
            searched: 0,
            factored: None,
            height: scene.bodies.iter().map(|b| b.height).fold(f64::INFINITY, f64::min),
        })
    }

    /// Steps from `self.t` by `dt` as [`Self::try_advance`]. The error of a semi-implicit step that the elements' own vibrations make
    /// grow, whatever it runs into, names the step at which they do not: two digits below 0.8 of `2/w`.
    ///
    /// # Errors
    /// As there.
    pub fn advance(&mut self, dt: f64, recorder: &mut SceneRecorder<'_>) -> Result<()> {
        self.try_advance(dt, recorder).map_err(|error| {
            let fastest = self.bodies.fastest_vibration();
            let explicit = self.bodies.scene.contact.stepping == Stepping::SemiImplicit;
            let stable = digits_below(ADVISED_STABLE_SHARE * 2.0 / fastest);
            // in the first step nothing has grown yet
            let grows = explicit && stable < dt && self.stats.steps > 0;
            match error {
                Error::Analysis { what, tried, .. } if grows => Error::analysis(
                    what,
                    format!("{tried}; the elements vibrate with up to {fastest:.3e} rad/s"),
                    format!("take a contact.step of {stable:e} s: semi-implicit steps beyond 2/w let vibrations grow"),
                ),
                error => error,
            }
        })
    }

    /// Steps from `self.t` by `dt`, in parts where the approach is too fast or the step does not succeed.
    ///
    /// # Errors
    /// A step that fails at its smallest size, or a complementarity problem without solution.
    fn try_advance(&mut self, dt: f64, recorder: &mut SceneRecorder<'_>) -> Result<()> {
        let mut parts = 1;
        if self.bodies.scene.contact.method != Enforcement::None {
            parts = self.search.prepare(self.bodies, &self.q, &self.v, dt);
        }
        if parts > MOST_PARTS {
            return Err(Error::analysis(
                format!("the step is too large for the speed at {:.9} s", self.t),
                format!(
                    "a step of {dt:.3e} s would need {parts} parts, so that nothing passes through anything"
                ),
                format!("take a contact.step of {:.1e} s or less", dt * MOST_PARTS as f64 / parts as f64),
            ));
        }
        self.stats.cut += usize::from(parts > 1);
        let end = self.t + dt;
        let mut part = dt / parts as f64;
        let smallest = part / 2.0_f64.powi(MOST_HALVINGS as i32);
        while self.t < end - 1e-9 * dt {
            let now = part.min(end - self.t);
            if parts > 1 {
                self.search.prepare(self.bodies, &self.q, &self.v, now);
            }
            let start = Instant::now();
            let before = self.search.choose(self.bodies, &self.q);
            self.stats.gaps += before.iter().flatten().count();
            self.cost.gaps_s += start.elapsed().as_secs_f64();
            let step = match self.bodies.scene.contact.stepping {
                Stepping::EnergyConsistent => self.consistent(now, &before),
                Stepping::SemiImplicit => self.semi_implicit(now, &before),
            };
            match step.and_then(|step| self.seen(step)) {
                Ok(step) => {
                    self.t = if now < end - self.t { self.t + now } else { end };
                    self.accept(step, now, recorder);
                }
                Err(StepFailure::Final(error)) => return Err(error),
                Err(StepFailure::Smaller(why, remedy)) => {
                    parts = 2;
                    part = now / 2.0;
                    self.stats.cut += 1;
                    if part < smallest {
                        return Err(Error::analysis(
                            format!("no step succeeds at {:.9} s", self.t),
                            format!("a step of {now:.3e} s, after {MOST_HALVINGS} halvings: {why}"),
                            remedy,
                        ));
                    }
                }
            }
        }
        self.t = end;
        Ok(())
    }

    /// A step in which no surface has moved further than detection looks ahead: forces and impacts may move it further than the
    /// velocity at the start of the step says.
    fn seen(&self, step: Stepped) -> std::result::Result<Stepped, StepFailure> {
        if self.bodies.scene.contact.method == Enforcement::None {
            return Ok(step);
        }
        let travel = self.search.travel(self.bodies, &self.q, &step.q);
        // written so that a motion that is no number is none
        if travel <= self.search.reach(&self.q) {
            return Ok(step);
        }
        Err(StepFailure::Smaller(
            format!("a surface moves by {travel:.1e} m within the step and could pass through another"),
            "take a smaller contact.step",
        ))
    }

    fn accept(&mut self, step: Stepped, dt: f64, recorder: &mut SceneRecorder<'_>) {
        self.work += step.work;
        self.impulse.iter_mut().zip(step.impulse).for_each(|(sum, part)| *sum += part);
        (self.q, self.v, self.internal) = (step.q, step.v, step.internal);
        self.stats.steps += 1;
        let energies = self.energies(step.contact);
        recorder.step(self.t, dt, &energies, &step.touches);
    }

    /// Energies of the present state; `contact` in springs, J.
    pub fn energies(&self, contact: f64) -> Energies {
        Energies {
            motion: self.bodies.motion(&self.q, &self.v),
            strain: self.internal.1,
            contact,
            gravity: self.bodies.gravity_potential(&self.q),
            work: self.work,
            impulse: self.impulse,
        }
    }

    /// After a search probes have other numbers, and springs stand between other curves.
    fn renew_springs(&mut self) {
        let searched = self.search.counts.searches;
        if std::mem::replace(&mut self.searched, searched) != searched {
            self.springs = Sums::default();
            // probes have other numbers now
            self.factored = self.factored.take().filter(|factored| factored.closed.is_empty());
        }
    }

    fn consistent(&mut self, dt: f64, before: &[Option<Hit>]) -> std::result::Result<Stepped, StepFailure> {
        let (bodies, n) = (self.bodies, self.bodies.len());
        let (q0, v0, unknown) = (self.q.clone(), self.v.clone(), bodies.unknown());
        self.renew_springs();
        // the change of the state is what is solved for: velocities from differences of places would lose digits in small steps
        let mut moved: Vec<f64> = v0.iter().map(|v| dt * v).collect();
        let [mut force, mut load, mut inertia, mut momentum] = std::array::from_fn(|_| vec![0.0; n]);
        bodies.mass_times(&v0, &mut momentum);
        let mut delta = vec![0.0; bodies.free().len()];
        let mut last = f64::INFINITY;
        let mut serves = true;
        for iteration in 1..=MOST_ITERATIONS {
            let q1: Vec<f64> = q0.iter().zip(&moved).map(|(q, d)| q + d).collect();
            let middle: Vec<f64> = q0.iter().zip(&q1).map(|(a, b)| (a + b) / 2.0).collect();
            let start = Instant::now();
            let strokes = self.strokes(before, &q1, &middle);
            self.cost.gaps_s += start.elapsed().as_secs_f64();
            let here = Factored { dt, closed: strokes.iter().map(|s| (s.probe, s.after < 0.0)).collect() };
            let fresh = !serves || !self.factored.as_ref().is_some_and(|factored| factored.serves(&here));
            self.entries.clear();
            let start = Instant::now();
            bodies.average_force(&q0, &q1, &mut force, fresh.then_some(&mut self.entries));
            let entries = fresh.then_some((&mut self.entries, 0.5));
            bodies.loads(&middle, self.t + dt / 2.0, 1.0, &mut load, entries);
            self.cost.elements_s += start.elapsed().as_secs_f64();
            let start = Instant::now();
            let states = [&q0[..], &q1, &middle];
            if fresh {
                self.springs.clear();
            }
            let search = &self.search;
            let gradient_after = |stroke: &SpringStroke| {
                let spring = |hit: Hit| search.spring(&search.probes[stroke.probe], &hit);
                stroke.hit_after.map_or(Vec::new(), |hit| spring(hit).gap.gradient(bodies.components()))
            };
            let tangent = fresh.then_some((&mut self.springs, &gradient_after as GapGradient<'_>));
            penalty::add_average(&strokes, states, bodies.components(), &mut force, tangent);
            self.cost.gaps_s += start.elapsed().as_secs_f64();
            bodies.mass_times(&moved, &mut inertia);
            for (d, &k) in delta.iter_mut().zip(bodies.free()) {
                *d = load[k] - force[k] - (2.0 * inertia[k] / dt - 2.0 * momentum[k]) / dt;
            }
            let start = Instant::now();
            let mut solved = Ok(());
            if fresh {
                self.springs.add_to(unknown, &mut self.entries);
                bodies.add_mass(2.0 / (dt * dt), &mut self.entries);
                self.stats.factorisations += 1;
                self.stats.entries += self.entries.len();
                solved = self.solver.factorise(delta.len(), &self.entries);
                self.stats.orderings = self.solver.orderings;
            }
            let solved = solved.and_then(|()| self.solver.solve_again(&mut delta));
            self.cost.solve_s += start.elapsed().as_secs_f64();
            if fresh || solved.is_err() {
                self.factored = solved.is_ok().then_some(here);
            }
            solved.map_err(|e| StepFailure::Smaller(e.to_string(), REMEDY_OF_STIFFNESS))?;
            let size = delta.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
            for (d, &k) in delta.iter().zip(bodies.free()) {
                moved[k] += d;
            }
            self.stats.iterations += 1;
            self.stats.most_iterations = self.stats.most_iterations.max(iteration);
            if !(size < 1e3 * self.height.max(dt)) || (iteration > 8 && size > 2.0 * last) {
                break;
            }
            let rate = size / last;
            let converged = fresh && size <= CONVERGED_PER_HEIGHT * self.height
                || last.is_finite() && rate <= SERVING_RATE && size * rate <= LEFT_PER_HEIGHT * self.height;
            // a correction that stays at the rounding error of the system is the end as well
            if converged || (fresh && iteration > 6 && size < 1e-9 * self.height && rate >= 0.5) {
                return self.finish(dt, &q0, &moved, &v0, before);
            }
            serves &= fresh || !last.is_finite() || rate <= SERVING_RATE;
            last = size;
        }
        self.factored = None;
        Err(not_converged(last))
    }

    /// The converged end of an energy-consistent step.
    fn finish(
        &mut self,
        dt: f64,
        q0: &[f64],
        moved: &[f64],
        v0: &[f64],
        before: &[Option<Hit>],
    ) -> std::result::Result<Stepped, StepFailure> {
        let (bodies, n) = (self.bodies, self.bodies.len());
        let q1: Vec<f64> = q0.iter().zip(moved).map(|(q, d)| q + d).collect();
        let middle: Vec<f64> = q0.iter().zip(&q1).map(|(a, b)| (a + b) / 2.0).collect();
        let v1: Vec<f64> = (0..n).map(|k| 2.0 * moved[k] / dt - v0[k]).collect();
        let start = Instant::now();
        let strain = bodies.strain_energy(&q1);
        self.cost.elements_s += start.elapsed().as_secs_f64();
        let mut load = vec![0.0; n];
        let strokes = self.strokes(before, &q1, &middle);
        let deepest = strokes.iter().map(|s| s.after).fold(0.0, f64::min);
        if deepest < -DEEPEST_HEIGHTS * self.height {
            return Err(sunk(-deepest));
        }
        let contact = strokes.iter().map(SpringStroke::energy).sum();
        let touch = |stroke: &SpringStroke| ContactTouch {
            bodies: stroke.middle.bodies,
            positions: stroke.middle.positions,
            model: stroke.middle.model,
            penetration: (-stroke.after).max(0.0),
            force: stroke.average(q0, &q1, bodies.components()).force(),
            within: ContactTouch::within(stroke.before, stroke.after),
        };
        let touches = strokes.iter().map(touch).collect();
        bodies.loads(&middle, self.t + dt / 2.0, 1.0, &mut load, None);
        let (work, impulse) = self.done(&load, moved, &middle, dt);
        Ok(Stepped { q: q1, v: v1, internal: (Vec::new(), strain), contact, work, impulse, touches })
    }

    /// Work of the loads other than gravity, and impulse and moment impulse of all.
    fn done(&self, load: &[f64], moved: &[f64], at: &[f64], dt: f64) -> (f64, [f64; 3]) {
        let all: f64 = load.iter().zip(moved).map(|(f, d)| f * d).sum();
        let later: Vec<f64> = self.q.iter().zip(moved).map(|(q, d)| q + d).collect();
        let gravity = self.bodies.gravity_potential(&self.q) - self.bodies.gravity_potential(&later);
        let mut impulse = [0.0; 3];
        for (f, q) in load.chunks_exact(4).zip(at.chunks_exact(4)) {
            impulse[0] += f[0] * dt;
            impulse[1] += f[1] * dt;
            impulse[2] += (q[0] * f[1] - q[1] * f[0] + q[2] * f[3] - q[3] * f[2]) * dt;
        }
        (all - gravity, impulse)
    }

    /// Springs that are compressed at either end of a step.
    fn strokes(&mut self, before: &[Option<Hit>], q1: &[f64], middle: &[f64]) -> Vec<SpringStroke> {
        if before.is_empty() {
            return Vec::new();
        }
        let search = &self.search;
        let [at_end, halfway] = [q1, middle].map(|q| search.contours(q));
        let mut list = Vec::new();
        for (index, (probe, first)) in search.probes.iter().zip(before).enumerate() {
            let after = search.gap(self.bodies, probe, &at_end);
            let closed = |hit: &Option<Hit>| hit.is_some_and(|h| h.gap < 0.0 && !h.at_corner);
            if !closed(first) && !closed(&after) {
                continue;
            }
            self.stats.gaps += 2;
            let between = search.gap(self.bodies, probe, &halfway);
            let Some(hit) = between.filter(|h| !h.at_corner).or(after).or(*first) else { continue };
            let value =
                |hit: &Option<Hit>| hit.map_or(0.0, |h| if h.at_corner { h.gap.max(0.0) } else { h.gap });
            list.push(SpringStroke {
                probe: index,
                middle: search.spring(probe, &hit),
                before: value(first),
                after: value(&after),
                hit_after: after,
            });
        }
        list
    }
}

/// The largest number of two digits that is not above a positive `x`.
fn digits_below(x: f64) -> f64 {
    let unit = 10.0_f64.powf(x.log10().floor() - 1.0);
    // written and read, so that it is the number that the text shows
    let text = format!("{:.1e}", (x / unit).floor() * unit);
    text.parse().unwrap_or(x)
}
