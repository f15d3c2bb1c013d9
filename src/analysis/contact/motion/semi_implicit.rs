//! The semi-implicit Euler step with penalty springs, or with complementarity of gap velocity and impulse.

use crate::analysis::contact::motion::{DEEPEST_HEIGHTS, Motion, StepFailure, Stepped, sunk};
use crate::analysis::contact::recorder::ContactTouch;
use crate::error::{Error, Result};
use crate::linalg::lcp::lemke;
use crate::model::scene::Enforcement;
use crate::scene::gap::Gap;
use crate::scene::gap::Hit;
use crate::scene::penalty::{self, ContactModel, ContactSpring};
use crate::scene::planar::probes::ContactProbe;
use faer::Mat;
use std::time::Instant;

/// Gap in heights up to which a contact takes part in the complementarity problem at least.
const CLOSE_HEIGHTS: f64 = 1e-3;
/// Pivots of a complementarity problem per contact.
const PIVOTS_PER_CONTACT: usize = 50;
/// Position projections of a step.
const MOST_PROJECTIONS: usize = 5;
/// Penetration in heights that position projection leaves.
const PROJECTED_HEIGHTS: f64 = 1e-9;

/// A contact of a complementarity problem.
pub(super) struct GapConstraint {
    bodies: (usize, usize),
    positions: [f64; 2],
    model: ContactModel,
    gap: Gap,
    gradient: Vec<(usize, f64)>,
}

impl Motion<'_> {
    /// Gives the velocities the impulses of the contacts, so that no gap closes within a step of `dt` (s), and records them.
    fn push(
        &mut self,
        contacts: &[GapConstraint],
        dt: f64,
        v1: &mut [f64],
        touches: &mut Vec<ContactTouch>,
    ) -> Result<()> {
        let single = self.bodies.scene.contact.method == Enforcement::LcpSingle;
        let velocities: Vec<f64> = contacts
            .iter()
            .map(|c| {
                let gap = if single { c.gap.value } else { c.gap.value.max(0.0) };
                penalty::rate(&c.gradient, v1) + gap / dt
            })
            .collect();
        let (impulses, change) = self.impulses(contacts, &velocities)?;
        self.bodies.free().iter().zip(&change).for_each(|(&k, d)| v1[k] += d);
        for (c, impulse) in contacts.iter().zip(&impulses).filter(|(_, i)| **i > 0.0) {
            touches.push(ContactTouch {
                bodies: c.bodies,
                positions: c.positions,
                model: c.model,
                penetration: (-c.gap.value).max(0.0),
                force: c.gap.pull() * (impulse / dt),
                within: [0.0, 1.0],
            });
        }
        Ok(())
    }

    pub(super) fn semi_implicit(
        &mut self,
        dt: f64,
        before: &[Option<Hit>],
    ) -> std::result::Result<Stepped, StepFailure> {
        let (bodies, n) = (self.bodies, self.bodies.len());
        let (method, unknown) = (bodies.scene.contact.method, bodies.unknown());
        let mut load = vec![0.0; n];
        bodies.loads(&self.q, self.t, 1.0, &mut load, None);
        let mut force = self.internal.0.clone();
        let mut touches = Vec::new();
        if method == Enforcement::Penalty {
            let start = Instant::now();
            let closed = |(probe, hit): (&ContactProbe, &Option<Hit>)| {
                hit.filter(|h| h.gap <= 0.0 && !h.at_corner).map(|hit| self.search.spring(probe, &hit))
            };
            let springs: Vec<ContactSpring> =
                self.search.probes.iter().zip(before).filter_map(closed).collect();
            penalty::add(&springs, &self.q, bodies.components(), unknown, &mut force, None);
            touches.extend(springs.iter().filter(|s| s.gap.value < 0.0).map(|s| ContactTouch {
                bodies: s.bodies,
                positions: s.positions,
                model: s.model,
                penetration: s.penetration(),
                force: s.gap.pull() * (s.weight * s.penetration()),
                within: [0.0, 1.0],
            }));
            self.cost.gaps_s += start.elapsed().as_secs_f64();
        }
        let mut kick: Vec<f64> = bodies.free().iter().map(|&k| dt * (load[k] - force[k])).collect();
        let start = Instant::now();
        self.solve_mass(&mut kick);
        self.cost.solve_s += start.elapsed().as_secs_f64();
        let mut v1 = self.v.clone();
        bodies.free().iter().zip(&kick).for_each(|(&k, d)| v1[k] += d);
        let single = method == Enforcement::LcpSingle;
        let mut contacts = Vec::new();
        if method == Enforcement::Lcp || single {
            contacts = self.contacts(before, |gap, gradient| gap + dt * penalty::rate(gradient, &v1));
            if single {
                let predicted = |c: &GapConstraint| c.gap.value / dt + penalty::rate(&c.gradient, &v1);
                contacts.sort_by(|a, b| predicted(a).total_cmp(&predicted(b)));
                contacts.truncate(1);
            }
        }
        if !contacts.is_empty() {
            self.push(&contacts, dt, &mut v1, &mut touches)?;
        }
        let mut q1: Vec<f64> = self.q.iter().zip(&v1).map(|(q, v)| q + dt * v).collect();
        let moved: Vec<f64> = self.q.iter().zip(&q1).map(|(a, b)| b - a).collect();
        let (work, impulse) = self.done(&load, &moved, &self.q, dt);
        if method == Enforcement::Lcp && !contacts.is_empty() {
            self.project(&mut q1)?;
        }
        let mut internal = (self.internal.0.clone(), 0.0);
        let start = Instant::now();
        internal.1 = bodies.internal_force(&q1, &mut internal.0);
        self.cost.elements_s += start.elapsed().as_secs_f64();
        if !internal.1.is_finite() || q1.iter().any(|q| !(q.abs() < 1e12)) {
            return Err(StepFailure::Final(Error::analysis(
                format!("the motion has left all bounds at {:.6} s", self.t),
                format!("semi-implicit Euler steps of {dt:.3e} s"),
                "take a smaller contact.step (it must resolve the fastest wave through an element), or the \
                 energy-consistent integrator",
            )));
        }
        let mut contact = 0.0;
        if method == Enforcement::Penalty {
            let springs = self.springs(&q1);
            contact = springs.iter().map(ContactSpring::energy).sum();
            let deepest = springs.iter().map(ContactSpring::penetration).fold(0.0, f64::max);
            if deepest > DEEPEST_HEIGHTS * self.height {
                return Err(sunk(deepest));
            }
        }
        Ok(Stepped { q: q1, v: v1, internal, contact, work, impulse, touches })
    }

    /// All springs that are compressed in the state `q`.
    pub(super) fn springs(&self, q: &[f64]) -> Vec<ContactSpring> {
        self.search.springs(self.bodies, q, 0.0).into_iter().map(|(_, spring)| spring).collect()
    }

    /// `x := M^-1 x` on the unknowns.
    pub(super) fn solve_mass(&self, x: &mut [f64]) {
        let Some(mass) = &self.mass else { return };
        let mut m = Mat::from_fn(x.len(), 1, |i, _| x[i]);
        mass.solve_in_place(m.as_mut());
        x.iter_mut().zip(m.col(0).iter()).for_each(|(x, m)| *x = *m);
    }

    /// Contacts whose gap, as it will be, is small or none.
    pub(super) fn contacts(
        &mut self,
        hits: &[Option<Hit>],
        later: impl Fn(f64, &[(usize, f64)]) -> f64,
    ) -> Vec<GapConstraint> {
        let start = Instant::now();
        let mut list = Vec::new();
        for (probe, hit) in self.search.probes.iter().zip(hits) {
            let Some(hit) = hit.filter(|h| !h.at_corner) else { continue };
            let spring = self.search.spring(probe, &hit);
            let gradient = spring.gap.gradient(self.bodies.components());
            if later(hit.gap, &gradient) < CLOSE_HEIGHTS * self.height {
                list.push(GapConstraint {
                    bodies: spring.bodies,
                    positions: spring.positions,
                    model: spring.model,
                    gap: spring.gap,
                    gradient,
                });
            }
        }
        self.cost.gaps_s += start.elapsed().as_secs_f64();
        list
    }

    /// Solves `N x + p >= 0, x >= 0, x (N x + p) = 0` with `N = D^T M^-1 D`; returns x and `M^-1 D x`.
    pub(super) fn impulses(&mut self, contacts: &[GapConstraint], p: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let start = Instant::now();
        let (count, unknown) = (contacts.len(), self.bodies.unknown());
        let mut d = Mat::<f64>::zeros(self.bodies.free().len(), count);
        for (j, contact) in contacts.iter().enumerate() {
            for (k, value) in &contact.gradient {
                if let Some(row) = unknown[*k] {
                    d[(row, j)] += value;
                }
            }
        }
        let mut y = d.clone();
        if let Some(mass) = &self.mass {
            mass.solve_in_place(y.as_mut());
        }
        let n = d.transpose() * &y;
        self.stats.complementarity_problems += 1;
        self.stats.largest_problem = self.stats.largest_problem.max(count);
        let x = if self.bodies.scene.contact.method == Enforcement::LcpSingle {
            vec![(-p[0] / n[(0, 0)]).max(0.0)]
        } else {
            lemke(n.as_ref(), p, PIVOTS_PER_CONTACT * count).map_err(|failure| {
                Error::analysis(
                    format!("the complementarity problem of the contacts has no solution at {:.9} s", self.t),
                    format!("Lemke's method on {count} contacts: {failure}"),
                    "free the bodies where they meet (what is held can't be pushed apart), take a smaller contact.step, or the \
                     method penalty",
                )
            })?
        };
        let change = (0..y.nrows()).map(|i| (0..count).map(|j| y[(i, j)] * x[j]).sum()).collect();
        self.cost.complementarity_s += start.elapsed().as_secs_f64();
        Ok((x, change))
    }

    /// Moves the state out of penetration along `M^-1 D`.
    pub(super) fn project(&mut self, q: &mut [f64]) -> Result<()> {
        for _ in 0..MOST_PROJECTIONS {
            let hits = self.hits(q);
            let list = self.contacts(&hits, |gap, _| gap);
            let deepest = list.iter().map(|c| c.gap.value).fold(0.0, f64::min);
            if deepest >= -PROJECTED_HEIGHTS * self.height {
                break;
            }
            let gaps: Vec<f64> = list.iter().map(|c| c.gap.value).collect();
            let (_, change) = self.impulses(&list, &gaps)?;
            self.bodies.free().iter().zip(&change).for_each(|(&k, d)| q[k] += d);
        }
        Ok(())
    }

    /// Gap of every probe that is near something.
    pub(super) fn hits(&mut self, q: &[f64]) -> Vec<Option<Hit>> {
        if !self.search.any() {
            return Vec::new();
        }
        let start = Instant::now();
        let contours = self.search.contours(q);
        let gap = |probe| self.search.gap(self.bodies, probe, &contours);
        let hits: Vec<Option<Hit>> = self.search.probes.iter().map(gap).collect();
        self.stats.gaps += hits.iter().flatten().count();
        self.cost.gaps_s += start.elapsed().as_secs_f64();
        hits
    }
}
