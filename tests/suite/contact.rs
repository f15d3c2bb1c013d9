//! Beams in contact against identities, closed forms, an independent implementation, and each other.
//!
//! Where a test names a prototype's figure, it is that of an independent implementation of the same formulas (element 2322s, gaps
//! on quadratic boundaries, penalty springs), written before this one; printed figures are of Publication II on beam contact with
//! 2322s (line-to-line contact, Lemke's method).

use crate::common::{case, with};
use rotor::analysis::contact::contact;
use rotor::case::LoadedCase;
use rotor::linalg::lu::Entries;
use rotor::model::scene::Scene;
use rotor::results::{Contact, LeftOut};
use rotor::scene::bodies::{Bodies, assemblies};
use rotor::scene::penalty::{ContactModel, ContactSpring, add};
use rotor::scene::planar::probes::PlanarSearch;
use rotor::scene::spatial;
use serde_json::{Value, json};

fn scene(loaded: &LoadedCase) -> Scene {
    Scene::new(loaded).unwrap_or_else(|e| panic!("{e}"))
}

fn of(value: Value) -> LoadedCase {
    LoadedCase::from_value("scene.json", value).unwrap_or_else(|e| panic!("{e}"))
}

/// Runs a scene to its end.
fn run(loaded: &LoadedCase) -> Contact {
    let outcome = contact(&scene(loaded), &|_, _| true).unwrap_or_else(|e| panic!("{e}"));
    assert!(outcome.results.converged, "{:?}", outcome.diagnostics);
    outcome.results
}

const SOFT: f64 = 2.07e7;

/// Two beams of the soft material of the cases, one on the other with some overlap, turned by an angle (degrees).
fn overlapping(angle: f64, depth: f64) -> Value {
    let turn = |x: f64, y: f64| {
        let (sin, cos) = angle.to_radians().sin_cos();
        json!([cos * x - sin * y, sin * x + cos * y])
    };
    json!({
        "title": "overlap",
        "materials": { "soft": { "E": SOFT, "nu": 0, "rho": 7850 } },
        "sections": { "square": { "shape": "rectangle", "height": 0.1, "width": 0.1 } },
        "bodies": [
            { "name": "lower", "length": 1, "elements": 3, "section": "square", "material": "soft",
              "start": turn(0.0, 0.0), "angle": format!("{angle} deg") },
            { "name": "upper", "length": 0.7, "elements": 3, "section": "square", "material": "soft",
              "start": turn(0.2, 0.1 - depth), "angle": format!("{} deg", angle + 2.0) }
        ],
        "contact": { "method": "penalty", "penalty": 1e9, "corner_angle": "1 deg" }
    })
}

/// A smooth deformation of the undeformed state, in a frame turned by an angle.
fn deformed(bodies: &Bodies<'_>, angle: f64, size: f64) -> Vec<f64> {
    let mut q = bodies.reference().to_vec();
    let (sin, cos) = angle.to_radians().sin_cos();
    for (k, node) in q.chunks_exact_mut(4).enumerate() {
        let s = k as f64;
        let d = [(1.3 * s).sin(), (0.7 * s).cos(), 0.4 * (0.9 * s).sin(), 0.3 * (1.1 * s).cos()];
        for pair in [0, 2] {
            let (x, y) = (size * d[pair], size * d[pair + 1]);
            node[pair] += cos * x - sin * y;
            node[pair + 1] += sin * x + cos * y;
        }
    }
    q
}

/// Springs of a planar scene in a state.
fn springs(bodies: &Bodies<'_>, q: &[f64]) -> Vec<ContactSpring> {
    let mut search = PlanarSearch::new(bodies);
    search.prepare(bodies, q, &vec![0.0; q.len()], 1.0);
    search.springs(bodies, q, 0.0).into_iter().map(|(_, s)| s).collect()
}

/// Energy, force and its products with a direction, of springs.
fn enforce(
    bodies: &Bodies<'_>,
    springs: &[ContactSpring],
    q: &[f64],
    direction: &[f64],
) -> (f64, Vec<f64>, Vec<f64>) {
    let (mut force, mut entries, mut product) = (vec![0.0; q.len()], Entries::default(), vec![0.0; q.len()]);
    let energy = add(springs, q, bodies.components(), bodies.unknown(), &mut force, Some(&mut entries));
    entries.multiply(direction, &mut product);
    (energy, force, product)
}

fn direction(n: usize) -> Vec<f64> {
    (0..n).map(|k| (2.3 * k as f64 + 0.4).sin()).collect()
}

fn largest(list: &[f64]) -> f64 {
    list.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Central differences along a direction against force and tangent.
fn check_derivatives(
    bodies: &Bodies<'_>,
    q: &[f64],
    step: f64,
    found: &mut dyn FnMut(&[f64]) -> Vec<ContactSpring>,
) {
    let d = direction(q.len());
    let here = found(q);
    assert!(here.len() > 3, "{} springs", here.len());
    let (_, force, product) = enforce(bodies, &here, q, &d);
    let shifted = |sign: f64| -> Vec<f64> { q.iter().zip(&d).map(|(q, d)| q + sign * step * d).collect() };
    let (plus, minus) = (shifted(1.0), shifted(-1.0));
    let (up, down) = (found(&plus), found(&minus));
    assert_eq!((up.len(), down.len()), (here.len(), here.len()), "the same probes act");
    let (energy_up, force_up, _) = enforce(bodies, &up, &plus, &d);
    let (energy_down, force_down, _) = enforce(bodies, &down, &minus, &d);
    let slope = (energy_up - energy_down) / (2.0 * step);
    let along: f64 = force.iter().zip(&d).map(|(f, d)| f * d).sum();
    let scale: f64 = force.iter().zip(&d).map(|(f, d)| (f * d).abs()).sum();
    assert!((slope - along).abs() < 1e-7 * scale, "force: {slope:e} and {along:e}");
    let error = (0..q.len())
        .map(|k| ((force_up[k] - force_down[k]) / (2.0 * step) - product[k]).abs())
        .fold(0.0, f64::max);
    assert!(error < 1e-7 * largest(&product), "tangent: {error:e} of {:e}", largest(&product));
}

/// Gap, penalty force and tangent against differences; the prototype left 7e-11.
#[test]
fn planar_force_and_tangent_are_derivatives() {
    let scene = scene(&of(overlapping(0.0, 0.01)));
    let shafts = assemblies(&scene);
    let bodies = Bodies::new(&scene, &shafts).expect("bodies");
    let q = deformed(&bodies, 0.0, 1e-3);
    check_derivatives(&bodies, &q, 1e-7, &mut |q| springs(&bodies, q));
}

fn crossing(element: &str, contact: Value) -> Value {
    json!({
        "title": "crossing",
        "materials": { "rubber": { "E": 1e7, "nu": 0.3, "rho": 1000 } },
        "sections": { "round": { "shape": "circle", "radius": 0.05 } },
        "bodies": [
            { "name": "lower", "element": element, "length": 1, "elements": 3, "section": "round", "material": "rubber",
              "start": [0, 0, 0], "direction": [1, 0, 0], "supports": [{ "at": 0, "kind": "clamped" }] },
            { "name": "upper", "element": element, "length": 0.8, "elements": 3, "section": "round", "material": "rubber",
              "start": [0.4, 0.0955, -0.15], "direction": [0.6, 0.02, 0.8] }
        ],
        "contact": contact
    })
}

/// The same in space: the nearest pair of two axes, and Gauss points of a line, of 3333s and 34X3.
#[test]
fn spatial_force_and_tangent_are_derivatives() {
    for element in ["3333s", "34X3"] {
        for (angle, at_point) in [("10 deg", true), ("90 deg", false)] {
            let settings = json!({ "penalty": 1e8, "segments": 40, "corner_angle": angle });
            let scene = scene(&of(crossing(element, settings)));
            let shafts = assemblies(&scene);
            let bodies = Bodies::new(&scene, &shafts).expect("bodies");
            let mut q = bodies.reference().to_vec();
            q.iter_mut().enumerate().for_each(|(k, q)| *q += 2e-5 * (1.7 * k as f64).sin());
            let mut search = spatial::SpatialSearch::new(&bodies);
            search.update(&bodies, &q);
            let mut found = |q: &[f64]| -> Vec<ContactSpring> {
                let list: Vec<ContactSpring> =
                    search.springs(&bodies, q, 0.0).into_iter().map(|(_, s)| s).collect();
                assert!(list.iter().all(|s| (s.model == ContactModel::LineToLine) != at_point));
                // one spring four times, so that there is something to sum
                if at_point { [&list[..], &list, &list, &list].concat() } else { list }
            };
            let d = direction(q.len());
            let (step, unknown) = (1e-7, bodies.unknown().to_vec());
            // held coordinates have no column in the tangent
            let d: Vec<f64> =
                d.iter().zip(&unknown).map(|(d, u)| if u.is_some() { *d } else { 0.0 }).collect();
            let free: Vec<f64> = bodies.free().iter().map(|&k| d[k]).collect();
            let here = found(&q);
            let (mut force, mut entries) = (vec![0.0; q.len()], Entries::default());
            add(&here, &q, 3, &unknown, &mut force, Some(&mut entries));
            let mut product = vec![0.0; free.len()];
            entries.multiply(&free, &mut product);
            let mut at = |sign: f64| {
                let q: Vec<f64> = q.iter().zip(&d).map(|(q, d)| q + sign * step * d).collect();
                let springs = found(&q);
                let mut force = vec![0.0; q.len()];
                let energy = add(&springs, &q, 3, &unknown, &mut force, None);
                (energy, force, springs.len())
            };
            let ((up, force_up, n_up), (down, force_down, n_down)) = (at(1.0), at(-1.0));
            assert!(n_up == here.len() && n_down == n_up && n_up >= 4, "{n_up} springs");
            let along: f64 = force.iter().zip(&d).map(|(f, d)| f * d).sum();
            let scale: f64 = force.iter().zip(&d).map(|(f, d)| (f * d).abs()).sum();
            assert!(((up - down) / (2.0 * step) - along).abs() < 1e-7 * scale, "{element} {angle}");
            let error = bodies
                .free()
                .iter()
                .enumerate()
                .map(|(u, &k)| ((force_up[k] - force_down[k]) / (2.0 * step) - product[u]).abs())
                .fold(0.0, f64::max);
            assert!(
                error < 1e-7 * largest(&product),
                "{element} {angle}: {error:e} of {:e}",
                largest(&product)
            );
        }
    }
}

/// Forces of contact sum to nothing, and so do their moments.
#[test]
fn contact_forces_are_in_balance() {
    let scene = scene(&of(overlapping(0.0, 0.01)));
    let shafts = assemblies(&scene);
    let bodies = Bodies::new(&scene, &shafts).expect("bodies");
    let q = deformed(&bodies, 0.0, 1e-3);
    let (_, force, _) = enforce(&bodies, &springs(&bodies, &q), &q, &direction(q.len()));
    let (mut sum, mut moment, mut scale) = ([0.0; 2], 0.0, 0.0);
    for (f, q) in force.chunks_exact(4).zip(q.chunks_exact(4)) {
        sum[0] += f[0];
        sum[1] += f[1];
        moment += q[0] * f[1] - q[1] * f[0] + q[2] * f[3] - q[3] * f[2];
        scale += f[0].abs() + f[1].abs();
    }
    assert!(
        scale > 1.0 && largest(&sum) < 1e-12 * scale && moment.abs() < 1e-12 * scale,
        "{sum:?} {moment:e} of {scale:e}"
    );
}

/// A turned scene gives turned forces.
#[test]
fn contact_forces_turn_with_the_scene() {
    let forces = [0.0, 33.0].map(|angle| {
        let scene = scene(&of(overlapping(angle, 0.01)));
        let shafts = assemblies(&scene);
        let bodies = Bodies::new(&scene, &shafts).expect("bodies");
        let q = deformed(&bodies, angle, 1e-3);
        enforce(&bodies, &springs(&bodies, &q), &q, &direction(q.len())).1
    });
    let (sin, cos) = 33.0_f64.to_radians().sin_cos();
    let scale = largest(&forces[0]);
    assert!(scale > 1.0);
    for (plain, turned) in forces[0].chunks_exact(2).zip(forces[1].chunks_exact(2)) {
        let expected = [cos * plain[0] - sin * plain[1], sin * plain[0] + cos * plain[1]];
        let error = (0..2).map(|c| (turned[c] - expected[c]).abs()).fold(0.0, f64::max);
        assert!(error < 1e-11 * scale, "{error:e} of {scale:e}");
    }
}

/// Two stacked beams of 5 and 7 elements under pressure from both sides.
fn patch(more: Value) -> Value {
    let mut value = json!({
        "title": "patch",
        "materials": { "soft": { "E": SOFT, "nu": 0, "rho": 7850 } },
        "sections": { "square": { "shape": "rectangle", "height": 0.1, "width": 0.1 } },
        "bodies": [
            { "name": "lower", "length": 1, "elements": 5, "section": "square", "material": "soft", "start": [0, 0],
              "supports": [{ "at": 0, "kind": "pinned" }, { "at": 1, "kind": "pinned-y" }],
              "loads": [{ "face": "bottom", "pressure": 1e4 }] },
            { "name": "upper", "length": 1, "elements": 7, "section": "square", "material": "soft", "start": [0, 0.1],
              "supports": [{ "at": 0, "kind": "pinned-x" }],
              "loads": [{ "face": "top", "pressure": 1e4 }] }
        ],
        "contact": { "method": "penalty", "penalty": 1e9, "load_steps": 2 }
    });
    for (key, v) in more.as_object().expect("keys") {
        value["contact"][key] = v.clone();
    }
    value
}

/// The patch test: with segments cut where the other body's elements end, a uniform pressure crosses the contact exactly (the
/// prototype left 3e-13); without the cuts it does not (7.5 % there).
#[test]
fn patch_test_between_unequal_meshes() {
    let gaps = |cut: bool| -> Vec<f64> {
        let loaded = of(patch(json!({ "cut": cut, "segments": 1 })));
        let scene = scene(&loaded);
        let outcome = contact(&scene, &|_, _| true).expect("runs");
        assert!(outcome.results.converged, "{:?}", outcome.diagnostics);
        // gaps at the nodes of the lower body's top, from the deformed state in the report
        outcome
            .results
            .bodies
            .iter()
            .flat_map(|b| [b.start_displacement_m[1], b.end_displacement_m[1]])
            .collect()
    };
    let exact = gaps(true);
    // the lower beam stays straight; the upper one comes down by half of both compressions and the penetration
    assert!((exact[2] - exact[3]).abs() < 1e-10 * exact[2].abs(), "{exact:?}");
    let result = run(&of(patch(json!({ "segments": 1 }))));
    let pair = &result.pairs[0];
    let force = 1e4 * 0.1;
    assert!((pair.force_n[1].abs() - force).abs() < 1e-9 * force, "{:?}", pair.force_n);
    // gap times penalty over pressure is one, everywhere
    for gap in [pair.gap_m.expect("a gap"), -pair.penetration_m] {
        assert!((-gap * 1e9 / 1e4 - 1.0).abs() < 1e-6, "{gap:e}");
    }
    let spread = |result: &Contact| (-result.pairs[0].gap_m.expect("a gap") * 1e9 / 1e4 - 1.0).abs();
    assert!(spread(&result) < 1e-10, "{:e}", spread(&result));
    let uncut = run(&of(patch(json!({ "segments": 1, "cut": false }))));
    assert!(spread(&uncut) > 1e-3, "{:e}", spread(&uncut));
}

/// Contact time of two equal bars over 2L/c, and restitution. Each bar runs against a spring of 2 k (the mirror image of the
/// other): while the first wave is under way the force grows like 1 - exp(-a t), a = 2 k/Z, Z = A sqrt(E rho); after 2L/c it
/// falls like (2 + 2 a s) exp(-a s) - 1, which is zero at a s = 1.67835.
#[test]
fn two_bars_meet_for_twice_the_time_of_a_wave() {
    let bars = case("bar-impact");
    let wave = 2.0 / (SOFT / 7850.0_f64).sqrt();
    for (factor, step, tolerance) in [(2.0, 2e-4, 0.01), (200.0, 2e-5, 0.01)] {
        let result = run(&with(&bars, json!({ "contact.penalty": factor * SOFT, "contact.step": step })));
        let (first, last) = (&result.events[0], result.events.last().expect("an event"));
        let time = (last.until_s.expect("an end") - first.time_s) / wave;
        let a = 2.0 * factor * SOFT * 0.01 / (0.01 * (SOFT * 7850.0).sqrt());
        let exact = 1.0 + 1.67835 / (a * wave);
        assert!((time - exact).abs() < tolerance, "{factor}: {time} instead of {exact}");
        let history = result.history.as_ref().expect("a history");
        let speed = history.velocity_m_s[1].last().expect("a row")[0];
        assert!(speed > 0.985 && speed < 1.0, "{factor}: restitution {speed}");
        assert!(result.energy_error.expect("energies") < 1e-9, "{:?}", result.energy_error);
        assert!(result.momentum_residual.expect("free bodies") < 1e-9);
    }
}

/// The same as the prototype measured it, between the first and the last instant of penetration: 1.20, 1.017 and 1.00. Of stiff
/// contact the mass centres keep 0.99 of their speed.
#[test]
fn two_bars_meet_as_in_the_prototype() {
    let bars = case("bar-impact");
    let wave = 2.0 / (SOFT / 7850.0_f64).sqrt();
    for (factor, step, figure) in [(2.0, 2e-4, 1.20), (20.0, 2e-4, 1.017), (200.0, 1e-4, 1.00)] {
        let output = (0.05_f64 / step).round() as u32 + 1;
        let set = json!({ "contact.penalty": factor * SOFT, "contact.step": step, "contact.output": output });
        let history = run(&with(&bars, set)).history.expect("a history");
        let closed = |gap: &Option<f64>| gap.is_some_and(|g| g < 0.0);
        let ends = [history.gap_m[0].iter().position(closed), history.gap_m[0].iter().rposition(closed)];
        let [first, last] = ends.map(|row| history.time_s[row.expect("contact")]);
        let time = (last - first) / wave;
        assert!((time - figure).abs() < 0.01, "{factor}: {time}");
        if factor >= 20.0 {
            assert!((time - 1.0).abs() < 0.02, "{factor}: {time}");
            let speed = history.velocity_m_s[1].last().expect("a row")[0];
            assert!(speed > 0.99 && speed < 1.0, "{factor}: restitution {speed}");
        }
    }
}

/// The energy-consistent step keeps the energy through a corner's contact; the prototype left 4e-6.
#[test]
fn corner_on_a_side_keeps_its_energy() {
    let result = run(&case("corner-to-side"));
    assert!(result.events[0].kind == "point-to-segment" && result.events[0].force_n > 1e3);
    // 0.06 m at 3 m/s, both bodies falling
    assert!((result.events[0].time_s - 0.02).abs() < 1e-4, "{}", result.events[0].time_s);
    assert!(result.energy_error.expect("energies") < 1e-9, "{:?}", result.energy_error);
}

/// The pendulums that lose 6 to 25 % of their energy with one gap a node: with the nearest curve of the whole boundary as the
/// other side, the potential is continuous and the loss is that of the solver.
#[test]
fn pendulums_keep_their_energy() {
    let result = run(&with(&case("pendulums"), json!({ "contact.until": 0.56, "contact.step": 2e-4 })));
    assert!(
        result.events.len() > 3 && result.events[0].kinds.contains(&"point-to-point"),
        "{:?}",
        result.events
    );
    assert!(result.energy_error.expect("energies") < 1e-8, "{:?}", result.energy_error);
}

/// So do they with a step that resolves how points slide past corners: what a point in contact may touch has no steps.
#[test]
fn pendulums_meet_in_small_steps() {
    let set = json!({ "contact.until": 0.4985, "contact.step": 1e-4, "contact.output": 2 });
    let result = run(&with(&case("pendulums"), set));
    assert!(result.converged && result.solver.cut == 0, "{:?}", result.solver);
    assert!(result.solver.most_iterations < 12, "{:?}", result.solver);
    assert!(result.energy_error.expect("energies") < 1e-8, "{:?}", result.energy_error);
}

/// Equal faces that meet flush part by complementarity too: symmetric, at rest between, after twice the time of a wave.
#[test]
fn two_bars_meet_by_complementarity() {
    let set = json!({ "contact.method": "lcp", "contact.step": 1e-4 });
    let result = run(&with(&case("bar-impact"), set));
    let (first, last) = (&result.events[0], result.events.last().expect("an event"));
    let time = (last.until_s.expect("an end") - first.time_s) / (2.0 / (SOFT / 7850.0_f64).sqrt());
    assert!((time - 1.0).abs() < 0.02, "{time}");
    assert!(result.largest_penetration_m < 1e-9, "{:e}", result.largest_penetration_m);
    let history = result.history.as_ref().expect("a history");
    for (left, right) in history.ends_m[0].iter().zip(&history.ends_m[1]) {
        assert!(left[2] < right[0] + 1e-9 && (left[2] + right[0] - 2.001).abs() < 1e-6, "{left:?} {right:?}");
        assert!(left[3].abs() < 1e-6 && right[1].abs() < 1e-6, "{left:?} {right:?}");
    }
    let change = result.energy_change.expect("energies");
    assert!((-0.02..0.0).contains(&change), "{change}");
}

/// Interval of contact; the prototype's figure is 0.2258 to 0.2301 s.
#[test]
fn side_to_side_interval() {
    let result = run(&with(&case("side-to-side"), json!({ "contact.until": 0.24 })));
    let (first, last) = (&result.events[0], result.events.last().expect("an event"));
    assert!((first.time_s - 0.2258).abs() < 1e-3, "{}", first.time_s);
    assert!((last.until_s.expect("an end") - 0.2301).abs() < 1e-3, "{:?}", last.until_s);
    // free fall through 0.25 m
    assert!((first.time_s - (0.5_f64 / 9.81).sqrt()).abs() < 1e-4);
    assert!(first.kind == "line-to-line" && result.energy_error.expect("energies") < 1e-9);
}

/// Tips of the double cantilever with either method. The prototype's figures, relative to the size of the displacement.
#[test]
fn double_cantilever_tips() {
    let plain = case("double-cantilever");
    let exact = run(&with(&plain, json!({ "contact.method": "active-set" })));
    for result in [&run(&with(&plain, json!({ "contact.penalty": 2.0 }))), &exact] {
        for (body, figure) in result.bodies.iter().zip([[-2.1741_f64, -5.2306], [-1.7588, -4.7873]]) {
            let size = figure[0].hypot(figure[1]);
            let error =
                (body.end_displacement_m[0] - figure[0]).hypot(body.end_displacement_m[1] - figure[1]);
            assert!(error < 1e-3 * size, "{}: {} {:?}", result.method, body.name, body.end_displacement_m);
        }
        assert!(result.pairs[0].force_n[1] < 0.0, "the lower one is pressed down");
    }
    assert!(exact.largest_penetration_m < 1e-9, "{:e}", exact.largest_penetration_m);
    // penalty tends to the constraint
    let tip = |r: &Contact| r.bodies[1].end_displacement_m[1];
    let errors = [10.0, 100.0]
        .map(|p| (tip(&run(&with(&plain, json!({ "contact.penalty": p })))) - tip(&exact)).abs());
    assert!(errors[1] < errors[0], "{errors:?}");
}

/// Roll-up of a cantilever by an end moment of 1.2 EI/L: the tip's distance from the exact circle, order 4 in the mesh. The
/// prototype left 4.5e-4, 2.8e-5, 1.75e-6 m with L = 10 m.
#[test]
fn roll_up_converges_with_order_four() {
    let errors = [4, 8, 16].map(|elements| {
        let (length, lambda) = (10.0, 1.2);
        let inertia = 0.1_f64.powi(4) / 12.0;
        let result = run(&of(json!({
            "title": "roll-up",
            "materials": { "m": { "E": 1e9, "nu": 0, "rho": 1 } },
            "sections": { "s": { "shape": "rectangle", "height": 0.1, "width": 0.1 } },
            "bodies": [{ "name": "beam", "length": length, "elements": elements, "section": "s", "material": "m",
                "start": [0, 0], "supports": [{ "at": 0, "kind": "clamped" }],
                "loads": [{ "at": length, "moment": lambda * 1e9 * inertia / length }] }],
            "contact": { "method": "none", "load_steps": 10 }
        })));
        let exact = [length * lambda.sin() / lambda, length * (1.0 - lambda.cos()) / lambda];
        (result.bodies[0].end_m[0] - exact[0]).hypot(result.bodies[0].end_m[1] - exact[1])
    });
    for (ours, figure) in errors.iter().zip([4.5e-4, 2.8e-5, 1.75e-6]) {
        assert!((ours / figure - 1.0).abs() < 0.1, "{errors:?}");
    }
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.7..4.3).contains(&order), "{errors:?}: order {order}");
    }
}

/// The free spaghetti (EI 500): loaded tip at 2.5 and 6 s. The prototype (4.4304, -0.7849) and (8.4263, 6.8412); a Reissner beam
/// (4.4305, -0.7850) and (8.4266, 6.8400).
#[test]
fn free_spaghetti_tip() {
    let set = json!({ "bodies.0.structural.EI": 500, "contact.method": "none", "contact.self": false, "contact.step": 2.5e-3,
        "contact.output": 13 });
    let result = run(&with(&case("flying-spaghetti"), set));
    let history = result.history.expect("a history");
    let at = |t: f64| history.time_s.iter().position(|x| (x - t).abs() < 1e-9).expect("a row");
    for (t, figure) in [(2.5, [4.4304, -0.7849]), (6.0, [8.4263, 6.8412])] {
        let [x, y, ..] = history.ends_m[0][at(t)];
        assert!((x - figure[0]).hypot(y - figure[1]) < 2e-3, "{t}: {x}, {y}");
    }
    assert!(result.energy_error.expect("energies") < 1e-9, "{:?}", result.energy_error);
    assert!(result.solver.searches == 0 && result.solver.gaps == 0);
}

/// First contact of the spaghetti with itself, printed and in the prototype 2.84 s, with both methods.
#[test]
fn spaghetti_touches_itself() {
    let plain = with(&case("flying-spaghetti"), json!({ "contact.until": 2.9, "contact.output": 3 }));
    let penalty = run(&with(&plain, json!({ "contact.step": 2e-3 })));
    let lcp = run(&with(&plain, json!({ "contact.method": "lcp", "contact.step": 2e-4 })));
    for result in [&penalty, &lcp] {
        let first = result.events.first().expect("a contact");
        assert!((first.time_s - 2.840).abs() < 0.01, "{} {}", result.method, first.time_s);
    }
    assert!(penalty.energy_error.expect("energies") < 1e-9);
}

/// Complementarity takes energy at impacts only, never gives; one contact at a time gives.
#[test]
fn complementarity_takes_energy_and_its_scalar_form_gives() {
    let plain = with(&case("side-to-side"), json!({ "contact.until": 0.25 }));
    let lcp = run(&with(&plain, json!({ "contact.method": "lcp" })));
    let change = lcp.energy_change.expect("energies");
    assert!((-0.1..0.001).contains(&change), "{change}");
    assert!(lcp.largest_penetration_m < 1e-6 && lcp.solver.largest_problem > 5);
    assert!(lcp.momentum_residual.is_some_and(|r| r < 1e-9));
    let outcome = contact(&scene(&with(&plain, json!({ "contact.method": "lcp-single" }))), &|_, _| true);
    let outcome = outcome.expect("runs");
    assert!(outcome.diagnostics.iter().any(|d| d.code == "energy-gain"), "{:?}", outcome.diagnostics);
    let single = outcome.results;
    assert!(single.energy_error.expect("energies") > 0.2, "{:?}", single.energy_error);
    assert!(single.largest_penetration_m > 10.0 * lcp.largest_penetration_m);
}

/// With nothing near, contact changes nothing at all.
#[test]
fn a_scene_with_nothing_near_does_not_know_of_contact() {
    let loaded = with(&case("side-to-side"), json!({ "contact.until": 0.1 }));
    let outcome = contact(&scene(&loaded), &|_, _| true).expect("runs");
    let off = run(&with(&loaded, json!({ "contact.method": "none" })));
    let [on, off] = [&outcome.results, &off]
        .map(|r| (r.history.as_ref().map(|h| &h.ends_m), r.energy_j.as_ref().map(|e| &e.total)));
    assert!(on.0.is_some() && on == off);
    assert!(outcome.results.solver.gaps == 0 && outcome.results.solver.searches < 10);
    assert!(outcome.model.left_out.contains(&LeftOut::ContactForces));
}

/// A step in which bodies would pass through each other is cut.
#[test]
fn too_large_a_step_is_cut() {
    let set = json!({ "bodies.0.velocity": [20, 0], "bodies.1.velocity": [-20, 0], "bodies.1.start": [1.12, 0],
        "contact.step": 2e-3, "contact.until": 4e-3 });
    let result = run(&with(&case("bar-impact"), set));
    assert!(result.solver.cut > 0 && !result.events.is_empty(), "{:?}", result.solver);
    assert!(result.largest_penetration_m < 0.025, "{:e}", result.largest_penetration_m);
    assert!(result.bodies[0].end_m[0] < result.bodies[1].start_m[0] + 0.025, "they met instead of passing");
}

/// Two crossing cantilevers carry the same load through one point as their bending says: the upper one's force share balances.
#[test]
fn crossing_cantilevers_share_the_load() {
    for element in ["3333s", "34X3"] {
        let result = run(&with(
            &case("crossing-cantilevers"),
            json!({ "bodies.0.element": element, "bodies.1.element": element }),
        ));
        let pair = &result.pairs[0];
        assert!(pair.kind == Some("point-to-point") && pair.points == 1, "{pair:?}");
        assert!((pair.angle_deg.expect("an angle") - 90.0).abs() < 2.0, "{pair:?}");
        // Euler-Bernoulli: equal deflection at the crossing less the gap of 1 mm
        let (e, i) = (1e7, std::f64::consts::PI * 0.05_f64.powi(4) / 4.0);
        let (a, l, p, gap) = (0.4, 1.0, 20.0, 1e-3);
        let under_load = p * a * a * (3.0 * l - a) / (6.0 * e * i);
        let (soft, lower) = (a * a * a / (3.0 * e * i), 0.6_f64.powi(3) / (3.0 * e * i));
        let force = (under_load - gap) / (soft + lower);
        assert!((pair.force_n[1] / -force - 1.0).abs() < 0.03, "{element}: {:?} for {force}", pair.force_n);
    }
}
