//! Record of a rub: gaps and forces at the stators over a run-up, when they touched and how hard.

use crate::dynamics::Dynamics;
use crate::error::{Error, Result};
use crate::integrate::Step;
use crate::model::Stator;
use crate::results::{
    Diagnostic, ModelSummary, RubEvent, RubEventKind, RubSummary, StatorHistory, StatorSummary,
};
use crate::rub::Contact;

/// Points of a step with possible contact that are looked at for the record.
const POINTS: usize = 6;
/// Most points of a curve that is drawn.
const DRAWN: f64 = 20_000.0;
/// Events of a stator that are listed; all are counted.
const LISTED: usize = 1000;

/// Collects what happens at the stators.
pub struct RubRecorder {
    stators: Vec<StatorSummary>,
    histories: Vec<StatorHistory>,
    /// Time and gap at the last point, and the time at which the present contact was made.
    last: Vec<(f64, f64, Option<f64>)>,
    /// Time of the last point drawn, and the shortest time to the next.
    drawn: (f64, f64),
}

impl RubRecorder {
    /// A record that begins with the state at the start.
    ///
    /// # Errors
    /// A shaft that penetrates a stator before it moves.
    pub fn new(stators: &[Stator], until: f64, start: &[Contact]) -> Result<Self> {
        let overlap = stators.iter().zip(start).find(|(_, contact)| contact.gap < 0.0);
        if let Some((stator, contact)) = overlap {
            return Err(Error::Case {
                path: format!("{}.clearance", stator.path),
                problem: format!(
                    "the shaft at rest under gravity and loads sags {:e} m there and already penetrates the ring",
                    stator.clearance - contact.gap
                ),
                allowed: format!("more than {:e} m", stator.clearance - contact.gap),
            });
        }
        let summary = |(stator, contact): (&Stator, &Contact)| StatorSummary {
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
            last: start.iter().map(|contact| (0.0, contact.gap, None)).collect(),
            drawn: (f64::NEG_INFINITY, until / DRAWN),
        })
    }

    /// Takes up an output time.
    pub fn sample(&mut self, t: f64, contacts: &[Contact]) {
        for ((history, stator), contact) in self.histories.iter_mut().zip(&mut self.stators).zip(contacts) {
            history.gap_m.push(contact.gap);
            history.normal_force_n.push(contact.normal_force);
            history.friction_force_n.push(contact.friction_force);
            history.drawn.push((t, *contact));
            keep_extremes(stator, t, contact);
        }
    }

    /// Takes up a step: contact is made and lost between its points, and where the gap passes zero between two of them
    /// is interpolated.
    pub fn record(&mut self, dynamics: &mut Dynamics<'_>, step: &Step<'_>) {
        if !dynamics.rub().near {
            return;
        }
        let n = step.end.z.len();
        let (mut z, mut v, mut a) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..=POINTS {
            let t = step.start.t + (step.end.t - step.start.t) * k as f64 / POINTS as f64;
            step.interpolate(t, &mut z, &mut v, &mut a);
            let contacts = dynamics.contacts(t, &z, &v);
            let draw = t - self.drawn.0 >= self.drawn.1;
            for (i, contact) in contacts.iter().enumerate() {
                self.point(i, t, contact);
                if draw {
                    self.histories[i].drawn.push((t, *contact));
                }
            }
            if draw {
                self.drawn.0 = t;
            }
        }
    }

    fn point(&mut self, i: usize, t: f64, contact: &Contact) {
        let (stator, (before, gap, since)) = (&mut self.stators[i], self.last[i]);
        keep_extremes(stator, t, contact);
        let crossing = if gap == contact.gap { t } else { before + (t - before) * gap / (gap - contact.gap) };
        let since = match (since, contact.gap < 0.0) {
            (None, true) => {
                stator.touched = true;
                stator.contacts += 1;
                stator.first_contact_s = stator.first_contact_s.or(Some(crossing));
                list(stator, crossing, RubEventKind::Contact);
                Some(crossing)
            }
            (Some(made), false) => {
                end_contact(stator, crossing - made);
                list(stator, crossing, RubEventKind::Release);
                None
            }
            (since, _) => since,
        };
        self.last[i] = (t, contact.gap, since);
    }

    /// The record, with what was modelled and left out.
    pub fn finish(
        mut self,
        dynamics: &Dynamics<'_>,
        end: f64,
        model: &mut ModelSummary,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> (RubSummary, Vec<StatorHistory>) {
        if self.stators.iter().any(|s| s.touched) {
            model.left_out.retain(|text| !text.starts_with("contact"));
        }
        for (stator, (.., since)) in self.stators.iter_mut().zip(&self.last) {
            since.iter().for_each(|made| end_contact(stator, end - made));
            if stator.touched {
                model
                    .modelled
                    .push(format!("rub at the ring at {} m: penalty and Coulomb friction", stator.at_m));
            } else {
                model.left_out.push(format!(
                    "contact forces of the ring at {} m: the shaft never touched it",
                    stator.at_m
                ));
            }
        }
        let rub = dynamics.rub();
        if rub.missed > 0.0 {
            diagnostics.push(Diagnostic::warning(
                "late-contact",
                format!(
                    "the shaft was found {:.3e} m inside a ring that it should not have reached yet: shorter steps (tighter rtol and atol) meet it in time",
                    rub.missed
                ),
            ));
        }
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

fn keep_extremes(stator: &mut StatorSummary, t: f64, contact: &Contact) {
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
    if stator.events.len() < LISTED {
        stator.events.push(RubEvent { time_s, kind });
    }
}
