//! Record of a rub: gaps and forces at the stators over a run-up, when they touched and how hard.

use crate::error::{Refusal, Result};
use crate::integrate::Step;
use crate::model::Stator;
use crate::results::{
    LeftOut, ModelSummary, Modelled, RubContact, RubEvent, RubEventKind, RubSummary, StatorHistory,
    StatorSummary,
};
use crate::shaft::motion::Dynamics;
use crate::shaft::stator_ring::AxisPath;

/// Points of a step with a ring that acts or is reached that are looked at for the record.
const POINTS_OF_A_STEP: usize = 6;
/// Most points of a curve that is drawn.
const MOST_DRAWN_POINTS: f64 = 20_000.0;
/// Events of a stator that are listed; all are counted.
const LISTED_EVENTS: usize = 1000;

/// Collects what happens at the stators.
pub struct RubRecorder {
    stators: Vec<StatorSummary>,
    histories: Vec<StatorHistory>,
    /// Times at which the present contacts were made.
    since: Vec<Option<f64>>,
    /// Time of the last point drawn, and the shortest time to the next.
    drawn: (f64, f64),
}

impl RubRecorder {
    /// A record that begins with the state at the start.
    ///
    /// # Errors
    /// A shaft that penetrates a stator before it moves.
    pub fn new(stators: &[Stator], until: f64, start: &[RubContact]) -> Result<Self> {
        let overlap = stators.iter().zip(start).find(|(_, contact)| contact.gap < 0.0);
        if let Some((stator, contact)) = overlap {
            let sag = stator.clearance - contact.gap;
            return Err(Refusal::at(
                format!("{}.clearance", stator.path),
                format!(
                    "the shaft at rest under gravity and loads sags {sag:e} m there and already penetrates the ring"
                ),
                format!("more than {sag:e} m"),
            )
            .into());
        }
        let summary = |(stator, contact): (&Stator, &RubContact)| StatorSummary {
            stator: stator.path.clone(),
            at_m: stator.at,
            clearance_m: stator.clearance,
            surface_radius_m: stator.radius,
            touched: false,
            smallest_gap_m: contact.gap,
            smallest_gap_time_s: 0.0,
            largest_normal_force_n: 0.0,
            largest_friction_force_n: 0.0,
            first_contact_s: None,
            contacts: 0,
            longest_contact_s: 0.0,
            contact_time_s: 0.0,
            events: Vec::new(),
        };
        Ok(Self {
            stators: stators.iter().zip(start).map(summary).collect(),
            histories: vec![StatorHistory::default(); stators.len()],
            since: vec![None; start.len()],
            drawn: (f64::NEG_INFINITY, until / MOST_DRAWN_POINTS),
        })
    }

    /// Takes up an output time.
    pub fn sample(&mut self, t: f64, contacts: &[RubContact]) {
        for ((history, stator), contact) in self.histories.iter_mut().zip(&mut self.stators).zip(contacts) {
            history.gap_m.push(contact.gap);
            history.normal_force_n.push(contact.normal_force);
            history.friction_force_n.push(contact.friction_force);
            history.drawn.push((t, *contact));
            keep_extremes(stator, t, contact);
        }
    }

    /// Takes up a step. Contact is made and lost where the path of the axis in it meets a ring.
    pub fn record(&mut self, dynamics: &mut Dynamics<'_>, step: &Step<'_>) {
        let h = step.end.t - step.start.t;
        let ends = [step.start.lists(), step.end.lists()];
        let rings = &dynamics.rub().rings;
        let paths: Vec<AxisPath> = rings.iter().map(|ring| ring.path(h, ends)).collect();
        // a ring that does not act is touched at the end of a step or not at all
        let concerned =
            |(i, path): (usize, &AxisPath)| rings[i].acts || path.radius(1.0) > self.stators[i].clearance_m;
        let concerned: Vec<usize> = paths.iter().enumerate().filter(|&p| concerned(p)).map(|p| p.0).collect();
        if concerned.is_empty() {
            return;
        }
        for i in concerned {
            self.events(i, &paths[i], step.start.t, h);
        }
        let n = step.end.z.len();
        let (mut z, mut v, mut a) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..=POINTS_OF_A_STEP {
            let t = step.start.t + h * k as f64 / POINTS_OF_A_STEP as f64;
            step.interpolate(t, &mut z, &mut v, &mut a);
            let contacts = dynamics.contacts(t, &z, &v);
            let draw = t - self.drawn.0 >= self.drawn.1;
            for (i, contact) in contacts.iter().enumerate() {
                keep_extremes(&mut self.stators[i], t, contact);
                if draw {
                    self.histories[i].drawn.push((t, *contact));
                }
            }
            if draw {
                self.drawn.0 = t;
            }
        }
    }

    /// Contacts made and lost in a step that begins at t and takes h. A contact is lost before a point at which the gap is open
    /// again, and made anew after that.
    fn events(&mut self, i: usize, path: &AxisPath, t: f64, h: f64) {
        let (stator, since) = (&mut self.stators[i], &mut self.since[i]);
        let clearance = stator.clearance_m;
        let mut share = 0.0;
        for point in (1..=POINTS_OF_A_STEP).map(|k| k as f64 / POINTS_OF_A_STEP as f64) {
            if since.is_none() {
                let Some(made) = path.passes(clearance, share) else { return };
                share = made;
                let time = t + made * h;
                stator.touched = true;
                stator.contacts += 1;
                stator.first_contact_s = stator.first_contact_s.or(Some(time));
                list(stator, time, RubEventKind::Contact);
                *since = Some(time);
            }
            if point > share && path.radius(point) <= clearance {
                share = path.returns(clearance, share, point);
                if let Some(made) = since.take() {
                    let time = t + share * h;
                    end_contact(stator, time - made);
                    list(stator, time, RubEventKind::Release);
                }
            }
        }
    }

    /// The record, with what was modelled and left out.
    pub fn finish(
        mut self,
        dynamics: &Dynamics<'_>,
        end: f64,
        model: &mut ModelSummary,
    ) -> (RubSummary, Vec<StatorHistory>) {
        if self.stators.iter().any(|s| s.touched) {
            model.left_out.retain(|effect| *effect != LeftOut::ContactOfShaft);
        }
        for (stator, since) in self.stators.iter_mut().zip(&self.since) {
            since.iter().for_each(|made| end_contact(stator, end - made));
            if stator.touched {
                model.modelled.push(Modelled::Rub(stator.at_m));
            } else {
                model.left_out.push(LeftOut::Ring(stator.at_m));
            }
        }
        let rub = dynamics.rub();
        for history in &mut self.histories {
            history.drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let summary = RubSummary {
            gap_checks: rub.gap_checks,
            contact_evaluations: rub.contact_evaluations,
            stators: self.stators,
        };
        (summary, self.histories)
    }
}

fn keep_extremes(stator: &mut StatorSummary, t: f64, contact: &RubContact) {
    if contact.gap < stator.smallest_gap_m {
        (stator.smallest_gap_m, stator.smallest_gap_time_s) = (contact.gap, t);
    }
    stator.largest_normal_force_n = stator.largest_normal_force_n.max(contact.normal_force);
    stator.largest_friction_force_n = stator.largest_friction_force_n.max(contact.friction_force.abs());
}

fn end_contact(stator: &mut StatorSummary, duration: f64) {
    stator.contact_time_s += duration;
    stator.longest_contact_s = stator.longest_contact_s.max(duration);
}

fn list(stator: &mut StatorSummary, time_s: f64, kind: RubEventKind) {
    if stator.events.len() < LISTED_EVENTS {
        stator.events.push(RubEvent { time_s, kind });
    }
}
