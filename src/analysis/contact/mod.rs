//! `rotor contact`: equilibrium and motion of beams in contact.

mod check;
mod equilibrium;
mod motion;
mod recorder;

use crate::analysis::Outcome;
use crate::analysis::Watch;
use crate::error::Result;
use crate::model::scene::{Action, ContactSettings, Enforcement, Scene, Stepping, Unused};
use crate::results::{BodyState, Contact, Diagnostic, LeftOut, ModelSummary, Modelled, PairState};
use crate::scene::bodies::{Bodies, assemblies};
use crate::scene::penalty::ContactSpring;
use crate::scene::planar::probes::{Key, PlanarSearch, SearchCounts};
use crate::scene::spatial;
pub use check::check;
use equilibrium::SceneEquilibrium;
use motion::Motion;
use recorder::{SceneRecorder, due, kind, pairs, views};
use std::time::Instant;

/// Overlap at the start that is rounding, over the height.
const OVERLAP_ROUNDING_HEIGHTS: f64 = 1e-6;

/// Gain of energy, over the largest kinetic energy, that is warned of.
const GAINED: f64 = 0.01;

/// Detection of planar or spatial bodies, in equilibrium.
pub enum Detector {
    /// Detection between planar bodies of elements 2322s.
    Planar(Box<PlanarSearch>),
    /// 3333s and 34X3.
    Spatial(Box<spatial::SpatialSearch>),
}

/// Bodies that overlap at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Indices of the two bodies that overlap.
    pub bodies: (usize, usize),
    /// Depth of the overlap, m.
    pub depth: f64,
}

impl Detector {
    fn new(bodies: &Bodies<'_>) -> Self {
        if bodies.scene.is_planar() {
            Self::Planar(Box::new(PlanarSearch::new(bodies)))
        } else {
            Self::Spatial(Box::new(spatial::SpatialSearch::new(bodies)))
        }
    }

    /// Looks for near pairs where the last ones may be out of date.
    fn update(&mut self, bodies: &Bodies<'_>, q: &[f64]) {
        match self {
            _ if bodies.scene.contact.method == Enforcement::None => {}
            Self::Planar(search) => {
                search.prepare(bodies, q, &vec![0.0; q.len()], 1.0);
                search.choose(bodies, q);
            }
            Self::Spatial(search) => search.update(bodies, q),
        }
    }

    fn any(&self) -> bool {
        match self {
            Self::Planar(search) => search.any(),
            Self::Spatial(search) => search.any(),
        }
    }

    /// Cuts the integration segments anew; returns the largest change of a probe's place.
    fn cut(&mut self, bodies: &Bodies<'_>, q: &[f64]) -> f64 {
        match self {
            Self::Planar(search) => search.cut(bodies.scene, q),
            Self::Spatial(_) => 0.0,
        }
    }

    fn springs(&mut self, bodies: &Bodies<'_>, q: &[f64], limit: f64) -> Vec<(Key, ContactSpring)> {
        match self {
            Self::Planar(search) => search.springs(bodies, q, limit),
            Self::Spatial(search) => search.springs(bodies, q, limit),
        }
    }

    /// Smallest gap between two bodies.
    fn distance(&self, bodies: &Bodies<'_>, pair: (usize, usize), q: &[f64]) -> Option<f64> {
        match self {
            Self::Planar(search) => search.distance(bodies, pair, q),
            Self::Spatial(search) => search.distance(bodies, pair, q),
        }
    }

    fn angle(&self, pair: (usize, usize)) -> Option<f64> {
        match self {
            Self::Planar(_) => None,
            Self::Spatial(search) => search.angle(pair),
        }
    }

    fn counts(&self) -> SearchCounts {
        match self {
            Self::Planar(search) => search.counts,
            Self::Spatial(search) => search.counts,
        }
    }
}

/// The deepest overlap of the bodies as they are placed, if any.
///
/// # Errors
/// An element without nonlinear form.
pub fn overlap(scene: &Scene) -> Result<Option<Overlap>> {
    if scene.contact.method == Enforcement::None {
        return Ok(None);
    }
    let found = if scene.is_planar() {
        crate::scene::planar::overlap::rectangles(scene)
    } else {
        let shafts = assemblies(scene);
        let bodies = Bodies::new(scene, &shafts)?;
        let mut search = spatial::SpatialSearch::new(&bodies);
        search.update(&bodies, bodies.reference());
        search.overlap(&bodies, bodies.reference()).map(|(a, b, gap)| (a, b, -gap))
    };
    let limit =
        |a: usize, b: usize| OVERLAP_ROUNDING_HEIGHTS * scene.bodies[a].height.min(scene.bodies[b].height);
    Ok(found
        .filter(|&(a, b, depth)| depth > limit(a, b))
        .map(|(a, b, depth)| Overlap { bodies: (a, b), depth }))
}

/// Finds the equilibrium of a scene, or its motion.
///
/// # Errors
/// An element without nonlinear form, or matrices that can't be factorised at the start. A run that ends early is no error: its
/// results say so (`converged`), with a diagnostic.
pub fn contact(scene: &Scene, watch: Watch<'_>) -> Result<Outcome<Contact>> {
    let start = Instant::now();
    let shafts = assemblies(scene);
    let bodies = Bodies::new(scene, &shafts)?;
    let mut outcome = match scene.contact.until {
        Some(until) => moving(&bodies, until, watch)?,
        None => resting(&bodies, watch)?,
    };
    outcome.results.cost.total_s = start.elapsed().as_secs_f64();
    outcome.diagnostics.splice(0..0, unused_input(scene));
    Ok(outcome)
}

/// Steps of a motion, and the size of which a whole number fits, s.
fn steps(settings: &ContactSettings, until: f64) -> (usize, f64) {
    let steps = (until / settings.step).round().max(1.0) as usize;
    (steps, until / steps as f64)
}

/// Remarks on input that this analysis does not use.
fn unused_input(scene: &Scene) -> Vec<Diagnostic> {
    let remark = |unused: &Unused| {
        let words = format!("not used: {}; {}", unused.paths.join(", "), unused.reason);
        Diagnostic::info("unused-input", words)
    };
    scene.unused.iter().map(remark).collect()
}

fn moving(bodies: &Bodies<'_>, until: f64, watch: Watch<'_>) -> Result<Outcome<Contact>> {
    let (scene, settings) = (bodies.scene, &bodies.scene.contact);
    let mut motion = Motion::new(bodies, PlanarSearch::new(bodies))?;
    if settings.method != Enforcement::None {
        motion.search.prepare(bodies, &motion.q, &motion.v, settings.step);
        motion.search.cut(scene, &motion.q);
    }
    let energies = motion.energies(0.0);
    let mut recorder = SceneRecorder::new(bodies, energies);
    recorder.row(bodies, &motion.search, (0.0, &motion.q, &motion.v), &energies);
    recorder.snapshot(bodies, 0.0, &motion.q);
    let mut diagnostics = Vec::new();
    let mut converged = true;
    let (steps, step) = steps(settings, until);
    let rows = (settings.output - 1).min(steps);
    let shots = settings.snapshots.saturating_sub(1).max(1);
    let (mut row, mut shot) = (1, 1);
    for k in 1..=steps {
        let target = until * k as f64 / steps as f64;
        if let Err(error) = motion.advance(target - motion.t, &mut recorder) {
            converged = false;
            diagnostics.push(Diagnostic::error("not-converged", error.to_string().replace('\n', ";")));
        }
        let t = motion.t;
        // a step that failed at once leaves the state of the last row
        let last = (k == steps || !converged) && recorder.history.time_s.last() != Some(&t);
        if last || due(t, until * row as f64 / rows as f64, step) {
            let energies = *recorder.last();
            recorder.row(bodies, &motion.search, (t, &motion.q, &motion.v), &energies);
            while row <= rows && due(t, until * row as f64 / rows as f64, step) {
                row += 1;
            }
        }
        if last || due(t, until * shot as f64 / shots as f64, step) {
            recorder.snapshot(bodies, t, &motion.q);
            while shot <= shots && due(t, until * shot as f64 / shots as f64, step) {
                shot += 1;
            }
        }
        if !converged {
            break;
        }
        let line = format!("{t:.4} s, {} contacts", recorder.events.len());
        if !watch(t / until, &line) {
            converged = false;
            diagnostics.push(Diagnostic::error(
                "stopped",
                format!("the run was stopped at {t:.6} s of {until} s; this report holds what was done"),
            ));
            break;
        }
    }
    Ok(moved(bodies, motion, recorder, converged, diagnostics))
}

/// Results of a motion, as far as it came.
fn moved(
    bodies: &Bodies<'_>,
    mut motion: Motion<'_>,
    mut recorder: SceneRecorder<'_>,
    converged: bool,
    mut diagnostics: Vec<Diagnostic>,
) -> Outcome<Contact> {
    let (scene, settings) = (bodies.scene, &bodies.scene.contact);
    let change = recorder.energy_change();
    if let Some((_, gained)) = change.filter(|(_, gained)| *gained > GAINED) {
        diagnostics.push(Diagnostic::warning(
            "energy-gain",
            format!(
                "the motion gains {gained:.1e} of its largest kinetic energy: take a smaller contact.step, or the \
                 energy-consistent integrator with the method penalty"
            ),
        ));
    }
    let residuals = recorder.momentum_residuals();
    let mut stats = motion.stats;
    stats.searches = motion.search.counts.searches;
    motion.cost.search_s = motion.search.counts.seconds;
    let mut model = summary(bodies);
    if stats.gaps == 0 && settings.method != Enforcement::None {
        model.left_out.push(LeftOut::ContactForces);
    }
    let results = Contact {
        method: settings.method.name(),
        integrator: Some(settings.stepping.name()),
        penalty_n_m3: scene.largest_penalty(),
        converged,
        time_s: Some(motion.t),
        load_factor: None,
        bodies: body_states(bodies, &motion.q),
        pairs: recorder.pair_states(bodies, &motion.search, &motion.q),
        events: std::mem::take(&mut recorder.events),
        largest_penetration_m: recorder.penetration,
        energy_error: change.map(|c| c.0),
        energy_change: change.map(|c| c.1),
        momentum_residual: residuals.map(|r| r[0]),
        angular_momentum_residual: residuals.map(|r| r[1]),
        solver: stats,
        history: Some(recorder.history),
        energy_j: Some(recorder.energy),
        snapshots: recorder.snapshots,
        cost: motion.cost,
    };
    Outcome { results, model, diagnostics }
}

fn resting(bodies: &Bodies<'_>, watch: Watch<'_>) -> Result<Outcome<Contact>> {
    let scene = bodies.scene;
    let (state, detector) = SceneEquilibrium::new(bodies, Detector::new(bodies)).solve(watch);
    let mut diagnostics = Vec::new();
    if let Some(why) = &state.stopped {
        diagnostics.push(Diagnostic::error(
            "not-converged",
            format!(
                "no equilibrium was found beyond {:.4} of the loads ({}); this report holds the last state found. Support \
                 every body, raise contact.load_steps, or lower contact.penalty{}",
                state.factor,
                why.replace('\n', ";"),
                if state.factor == 0.0 { apart(bodies) } else { String::new() }
            ),
        ));
    }
    let model = summary(bodies);
    let deepest = state.springs.iter().map(ContactSpring::penetration).fold(0.0, f64::max);
    let mut snapshots = views(bodies, bodies.reference(), "undeformed");
    snapshots.extend(views(bodies, &state.q, "equilibrium"));
    let results = Contact {
        method: scene.contact.method.name(),
        integrator: None,
        penalty_n_m3: scene.largest_penalty(),
        converged: state.factor == 1.0,
        time_s: None,
        load_factor: Some(state.factor),
        bodies: body_states(bodies, &state.q),
        pairs: resting_pairs(bodies, &detector, &state),
        events: Vec::new(),
        largest_penetration_m: deepest,
        energy_error: None,
        energy_change: None,
        momentum_residual: None,
        angular_momentum_residual: None,
        solver: state.stats,
        history: None,
        energy_j: None,
        snapshots,
        cost: state.cost,
    };
    Ok(Outcome { results, model, diagnostics })
}

/// What to do about the nearest bodies that do not touch as they are placed.
fn apart(bodies: &Bodies<'_>) -> String {
    let list = check::gaps(bodies).into_iter().filter_map(|check| Some((check.gap_m?, check.pair)));
    match list.filter(|(gap, _)| *gap > 0.0).min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((gap, [a, b])) => format!(
            "; if contact alone is to hold `{a}` or `{b}`, place them so that they touch: they start {gap:.1e} m apart"
        ),
        None => String::new(),
    }
}

/// Penalty of a pair that has another one than the largest of the scene.
fn own_penalty(scene: &Scene, (a, b): (usize, usize)) -> Option<f64> {
    let penalty = scene.penalty(a, b);
    (penalty != scene.largest_penalty()).then_some(penalty)
}

fn resting_pairs(
    bodies: &Bodies<'_>,
    detector: &Detector,
    state: &equilibrium::SceneState,
) -> Vec<PairState> {
    let scene = bodies.scene;
    let one = |(a, b): (usize, usize)| {
        let own = |s: &ContactSpring| s.pair() == (a, b);
        let mut pair = PairState {
            pair: [a, b].map(|i| scene.bodies[i].name.clone()),
            kind: None,
            points: 0,
            gap_m: detector.distance(bodies, (a, b), &state.q),
            penetration_m: 0.0,
            force_n: [0.0; 3],
            penalty_n_m3: own_penalty(scene, (a, b)),
            angle_deg: detector.angle((a, b)).map(f64::to_degrees),
        };
        let mut shares = [0.0; 3];
        for (spring, force) in state.springs.iter().zip(&state.forces).filter(|(s, f)| own(s) && **f > 0.0) {
            pair.points += 1;
            shares[spring.model as usize] += force;
            pair.penetration_m = pair.penetration_m.max(spring.penetration());
            let sign = if spring.bodies.0 == a { *force } else { -force };
            (0..3).for_each(|c| pair.force_n[c] += sign * spring.gap.pull()[c]);
        }
        pair.kind = kind(&shares);
        if pair.penetration_m > 0.0 {
            pair.gap_m = Some(pair.gap_m.unwrap_or(0.0).min(-pair.penetration_m));
        }
        pair
    };
    let mut list = pairs(scene);
    for touching in state.springs.iter().map(ContactSpring::pair) {
        if !list.contains(&touching) {
            list.push(touching);
        }
    }
    list.into_iter().map(one).collect()
}

fn body_states(bodies: &Bodies<'_>, q: &[f64]) -> Vec<BodyState> {
    let place = |at: usize, of: &[f64]| {
        let mut x = [0.0; 3];
        (0..bodies.components()).for_each(|c| x[c] = of[at + c]);
        x
    };
    let one = |(i, body): (usize, &crate::model::scene::Body)| {
        let ends = [bodies.node(i, 0), bodies.node(i, body.nodes() - 1)];
        let now = ends.map(|at| place(at, q));
        let then = ends.map(|at| place(at, bodies.reference()));
        let moved = |k: usize| [0, 1, 2].map(|c| now[k][c] - then[k][c]);
        BodyState {
            name: body.name.clone(),
            element: body.element.clone(),
            elements: body.elements,
            start_m: now[0],
            start_displacement_m: moved(0),
            end_m: now[1],
            end_displacement_m: moved(1),
        }
    };
    bodies.scene.bodies.iter().enumerate().map(one).collect()
}

/// What a scene models and leaves out.
fn summary(bodies: &Bodies<'_>) -> ModelSummary {
    let scene = bodies.scene;
    let mut names: Vec<String> = scene.bodies.iter().map(|b| b.element.clone()).collect();
    names.dedup();
    let mut modelled = vec![Modelled::FiniteDisplacementsOfBodies, Modelled::Elements(names)];
    let mut left_out = Vec::new();
    let contact = match scene.contact.method {
        Enforcement::Penalty => Some(Modelled::PenaltyContact(scene.largest_penalty())),
        Enforcement::Lcp => Some(Modelled::Complementarity),
        Enforcement::LcpSingle => Some(Modelled::ScalarComplementarity),
        Enforcement::ActiveSet => Some(Modelled::ActiveSet),
        Enforcement::None => None,
    };
    if let Some(contact) = contact {
        modelled.push(contact);
        left_out.push(LeftOut::Friction);
        if !scene.is_planar() {
            left_out.push(LeftOut::EndsOfBodies);
        }
        if !scene.contact.with_itself {
            left_out.push(LeftOut::SelfContact);
        }
    } else {
        left_out.push(LeftOut::Contact);
    }
    if bodies.has_gravity() {
        modelled.push(Modelled::Gravity);
    } else {
        left_out.push(LeftOut::Gravity);
    }
    let loads: Vec<Action> = scene.bodies.iter().flat_map(|b| &b.loads).map(|l| l.action).collect();
    if loads.is_empty() {
        left_out.push(LeftOut::Loads);
    } else {
        let pressures = loads.iter().filter(|a| matches!(a, Action::Pressure(..))).count();
        modelled.push(Modelled::BodyLoads { count: loads.len(), pressures });
    }
    match scene.contact.until {
        Some(until) => modelled.push(Modelled::Steps {
            integrator: match scene.contact.stepping {
                Stepping::EnergyConsistent => "energy-consistent midpoint",
                Stepping::SemiImplicit => "semi-implicit Euler",
            },
            step_s: steps(&scene.contact, until).1,
        }),
        None => left_out.push(LeftOut::MotionOfBodies),
    }
    ModelSummary {
        degrees_of_freedom: bodies.free().len(),
        elements: scene.bodies.iter().map(|b| b.elements).sum(),
        mass_kg: (0..scene.bodies.len()).map(|i| bodies.mass_of(i)).sum(),
        modelled,
        left_out,
        estimated_error: None,
    }
}
