//! `rotor check` of a contact scene: what is there, what holds it, and how contact will be enforced, without a run.

use crate::analysis::Outcome;
use crate::analysis::contact::{Detector, steps, summary, unused_input};
use crate::error::Result;
use crate::model::scene::{Enforcement, Scene};
use crate::results::{BodyCheck, Diagnostic, PairCheck, SceneCheck};
use crate::scene::bodies::{Bodies, assemblies};

/// Size, mass and settings of a scene, and the gaps between its bodies as they are placed.
///
/// # Errors
/// An element without nonlinear form.
pub fn check(scene: &Scene) -> Result<Outcome<SceneCheck>> {
    let shafts = assemblies(scene);
    let bodies = Bodies::new(scene, &shafts)?;
    let settings = &scene.contact;
    let motion = settings.until.map(|until| (until, steps(settings, until)));
    let results = SceneCheck {
        bodies: (0..scene.bodies.len()).map(|i| body(&bodies, i)).collect(),
        unconstrained_degrees_of_freedom: bodies.len(),
        pairs: gaps(&bodies),
        method: settings.method.name(),
        penalty_n_m3: scene.largest_penalty(),
        integrator: motion.map(|_| settings.stepping.name()),
        until_s: settings.until,
        step_s: motion.map(|(_, (_, step))| step),
        steps: motion.map_or(settings.load_steps, |(_, (count, _))| count),
    };
    let mut diagnostics = unused_input(scene);
    let loose: Vec<String> = scene
        .bodies
        .iter()
        .filter(|b| b.supports.is_empty() && motion.is_none())
        .map(|b| format!("`{}`", b.name))
        .collect();
    if !loose.is_empty() {
        let words = format!("nothing but contact holds {}: an equilibrium may not exist", loose.join(", "));
        diagnostics.push(Diagnostic::warning("unsupported", words));
    }
    Ok(Outcome { results, model: summary(&bodies), diagnostics })
}

fn body(bodies: &Bodies<'_>, index: usize) -> BodyCheck {
    let body = &bodies.scene.bodies[index];
    let first = bodies.node(index, 0);
    let after = if index + 1 < bodies.scene.bodies.len() { bodies.node(index + 1, 0) } else { bodies.len() };
    let end = body.start + body.frame.column(0) * body.length;
    BodyCheck {
        name: body.name.clone(),
        element: body.element.clone(),
        elements: body.elements,
        degrees_of_freedom: bodies.unknown()[first..after].iter().flatten().count(),
        mass_kg: bodies.mass_of(index),
        length_m: body.length,
        height_m: body.height,
        start_m: body.start.into(),
        end_m: end.into(),
        velocity_m_s: body.velocity.into(),
        point_penalty_n_m: bodies.scene.point_penalty(index, bodies.scene.largest_penalty()),
        supports: body.supports.len(),
        loads: body.loads.len(),
    }
}

/// Gaps of all pairs of a small scene.
pub fn gaps(bodies: &Bodies<'_>) -> Vec<PairCheck> {
    let scene = bodies.scene;
    if scene.contact.method == Enforcement::None {
        return Vec::new();
    }
    let detector = Detector::new(bodies);
    let one = |(a, b): (usize, usize)| PairCheck {
        pair: [a, b].map(|i| scene.bodies[i].name.clone()),
        gap_m: detector.distance(bodies, (a, b), bodies.reference()),
        penalty_n_m3: crate::analysis::contact::own_penalty(scene, (a, b)),
    };
    crate::analysis::contact::pairs(scene).into_iter().filter(|(a, b)| a != b).map(one).collect()
}
