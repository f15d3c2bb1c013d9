//! Overlap of bodies as a scene places them: straight and undeformed, so that it is a matter of rectangles and rods.

use crate::model::scene::{Body, Scene};
use crate::scene::near_pairs::{Aabb, OrientedBox, near_pairs};
use nalgebra::Vector3;

/// Sine of an angle below which axes count as parallel.
const PARALLEL: f64 = 1e-9;

/// Planar bodies that overlap most: their indices and the length of the shortest shift that parts them, m.
pub fn rectangles(scene: &Scene) -> Option<(usize, usize, f64)> {
    let boxes: Vec<OrientedBox> = scene.bodies.iter().map(rectangle).collect();
    let corners = |b: &OrientedBox| {
        let [along, across] = [0, 1].map(|k| b.axes[k] * b.half[k]);
        Aabb::of_points(&[
            b.centre - along - across,
            b.centre + along - across,
            b.centre + along + across,
            b.centre - along + across,
        ])
    };
    let around: Vec<Aabb> = boxes.iter().map(corners).collect();
    let depths = near_pairs(&around, 0.0, |_, _| false).into_iter().filter_map(|(a, b)| {
        let depth = depth(&boxes[a], &boxes[b]);
        (depth > 0.0).then_some((a, b, depth))
    });
    depths.max_by(|a, b| a.2.total_cmp(&b.2))
}

fn rectangle(body: &Body) -> OrientedBox {
    let axes = [0, 1, 2].map(|k| Vector3::from(body.frame.column(k)));
    let half = [body.length / 2.0, body.height / 2.0, 0.0];
    OrientedBox { centre: body.start + axes[0] * half[0], axes, half }
}

/// Shortest shift along an edge that parts two rectangles of the plane, negative when they are apart.
fn depth(a: &OrientedBox, b: &OrientedBox) -> f64 {
    let between = b.centre - a.centre;
    let reach =
        |c: &OrientedBox, l: &Vector3<f64>| (0..2).map(|k| c.half[k] * c.axes[k].dot(l).abs()).sum::<f64>();
    let along = |l: &Vector3<f64>| reach(a, l) + reach(b, l) - between.dot(l).abs();
    a.axes[..2].iter().chain(&b.axes[..2]).map(along).fold(f64::INFINITY, f64::min)
}

/// Gap between the lateral surfaces of two spatial bodies, m; `None` where an end of one is what is nearest.
pub fn rods(a: &Body, b: &Body) -> Option<f64> {
    let [u, v] = [a, b].map(|body| Vector3::from(body.frame.column(0)));
    let (between, normal) = (b.start - a.start, u.cross(&v));
    let sine = normal.norm();
    let distance = if sine > PARALLEL {
        // feet of the common perpendicular along either axis
        let foot = |other: &Vector3<f64>| between.cross(other).dot(&normal) / (sine * sine);
        let inside = |x: f64, body: &Body| (0.0..=body.length).contains(&x);
        if !inside(foot(&v), a) || !inside(foot(&u), b) {
            return None;
        }
        between.dot(&normal).abs() / sine
    } else {
        let ends = [0.0, b.length].map(|x| (between + v * x).dot(&u));
        if ends[0].max(ends[1]) <= 0.0 || ends[0].min(ends[1]) >= a.length {
            return None;
        }
        (between - u * between.dot(&u)).norm()
    };
    Some(distance - (a.height + b.height) / 2.0)
}
