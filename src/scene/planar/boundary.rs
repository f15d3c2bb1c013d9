//! The boundary of planar bodies: quadratic curves, counter-clockwise, and the nearest point on them.
//!
//! A body's boundary runs along its bottom side, its end face, its top side (backwards) and its start face. Along each curve the
//! outward normal is `n = (t_2, -t_1)/|t|`, t the tangent. Between two elements of a side the boundary has a kink, which the
//! nearest point may rest on; between a side and an end face it has a corner.

use crate::element::planar_2322s::{CURVATURES, slopes, values};
use crate::model::scene::Face as Place;
use crate::scene::bodies::{Bodies, Curve};
use crate::scene::gap::{Free, Gap, Hit, Point};
use nalgebra::Vector3;

/// Newton steps and bisections of a root.
const ROOT_STEPS: usize = 80;
/// Distance of a point from the normal at an end of a curve, relative to its gap, within which that end is its foot.
const FOOT: f64 = 1e-9;
/// Relative rounding of a distance, generously.
const ROUNDED: f64 = 1e-9;
/// Cosine between the normals of two curves that face each other, at most.
pub const FACING: f64 = -0.2;
/// The same, relative to the curve.
const ON_KINK: f64 = 1e-12;

/// A curve of a boundary.
#[derive(Debug, Clone)]
pub struct Face {
    /// Index of its body.
    pub body: usize,
    /// Where it lies.
    pub place: Place,
    /// Its points at -1, 0, 1.
    pub curve: Curve,
    /// Positions along the axis at -1 and 1, m.
    pub along: [f64; 2],
    /// Undeformed length, m.
    pub length: f64,
    /// Index of the curve after and before it.
    pub next: usize,
    /// Index of the curve before it.
    pub previous: usize,
}

impl Face {
    /// True at a corner between a side and an end face; else two elements meet.
    pub fn corner(&self, other: &Self) -> bool {
        self.place != other.place
    }

    /// The three points.
    pub fn points(&self, q: &[f64]) -> [Vector3<f64>; 3] {
        self.curve.map(|point| point.place(q))
    }

    /// The point at zeta with what it takes of the vectors behind it.
    pub fn point(&self, zeta: f64) -> Point {
        let (l, d) = (values(zeta), slopes(zeta));
        let vectors = self.curve.iter().enumerate().flat_map(|(i, point)| {
            let weights = [l[i], d[i], 0.0, CURVATURES[i], 0.0, 0.0];
            [(point.node, weights), (point.node + 2, weights.map(|w| w * point.height))]
        });
        Point { vectors: vectors.collect() }
    }

    /// Position along the axis, m.
    pub fn position(&self, zeta: f64) -> f64 {
        self.along[0] + (self.along[1] - self.along[0]) * (zeta + 1.0) / 2.0
    }
}

/// The boundaries of all bodies, one after the other.
pub fn faces(bodies: &Bodies<'_>) -> Vec<Face> {
    let mut list: Vec<Face> = Vec::new();
    for (index, body) in bodies.scene.bodies.iter().enumerate() {
        let first = list.len();
        let element = body.length / body.elements as f64;
        for place in [Place::Bottom, Place::End, Place::Top, Place::Start] {
            for (k, curve) in bodies.face(index, place).into_iter().enumerate() {
                let (along, length) = match place {
                    Place::Bottom => ([k as f64 * element, (k + 1) as f64 * element], element),
                    Place::Top => {
                        let left = (body.elements - 1 - k) as f64 * element;
                        ([left + element, left], element)
                    }
                    Place::End => ([body.length; 2], body.height),
                    Place::Start => ([0.0; 2], body.height),
                };
                let at = list.len();
                let previous = at.wrapping_sub(1);
                list.push(Face { body: index, place, curve, along, length, next: at + 1, previous });
            }
        }
        let last = list.len() - 1;
        list[last].next = first;
        list[first].previous = last;
    }
    list
}

/// Position on a curve through three points.
pub fn on_curve(points: &[Vector3<f64>; 3], zeta: f64) -> Vector3<f64> {
    let l = values(zeta);
    points[0] * l[0] + points[1] * l[1] + points[2] * l[2]
}

/// Outward normal of a curve, unit.
pub fn normal(points: &[Vector3<f64>; 3], zeta: f64) -> Vector3<f64> {
    let d = slopes(zeta);
    let t = points[0] * d[0] + points[1] * d[1] + points[2] * d[2];
    Vector3::new(t.y, -t.x, 0.0) / t.norm()
}

/// Parameter of the point of a curve that is nearest to `x`: the squared distance is a polynomial of degree four, so every
/// stationary point is found, between the roots of its second derivative.
pub fn nearest(points: &[Vector3<f64>; 3], x: &Vector3<f64>) -> f64 {
    let d = (points[2] - points[0]) / 2.0;
    let e = (points[0] + points[2]) / 2.0 - points[1];
    let p = points[1] - x;
    // half the derivative of the squared distance, by ascending powers
    let c = [p.dot(&d), d.dot(&d) + 2.0 * p.dot(&e), 3.0 * d.dot(&e), 2.0 * e.dot(&e)];
    let slope = |z: f64| c[0] + z * (c[1] + z * (c[2] + z * c[3]));
    let second = |z: f64| c[1] + z * (2.0 * c[2] + z * 3.0 * c[3]);
    // -1, roots of the second derivative, 1
    let (mut bounds, mut count) = ([-1.0; 4], 1);
    let discriminant = c[2] * c[2] - 3.0 * c[3] * c[1];
    if discriminant > 0.0 {
        // both roots without cancellation
        let root = -(c[2] + c[2].signum() * discriminant.sqrt());
        let mut pair = [root / (3.0 * c[3]), c[1] / root];
        pair.sort_by(f64::total_cmp);
        for z in pair.into_iter().filter(|z| z.abs() < 1.0) {
            bounds[count] = z;
            count += 1;
        }
    }
    bounds[count] = 1.0;
    let mut best = [-1.0, 1.0];
    let distance = |z: f64| (on_curve(points, z) - x).norm_squared();
    if distance(best[1]) < distance(best[0]) {
        best.swap(0, 1);
    }
    let mut best = best[0];
    for pair in bounds[..=count].windows(2) {
        let (mut low, mut high) = (pair[0], pair[1]);
        if !(slope(low) < 0.0 && slope(high) > 0.0) {
            continue;
        }
        let mut z = (low + high) / 2.0;
        for _ in 0..ROOT_STEPS {
            let value = slope(z);
            if value < 0.0 {
                low = z;
            } else {
                high = z;
            }
            let mut next = z - value / second(z);
            if !(next > low && next < high) {
                next = (low + high) / 2.0;
            }
            let step = (next - z).abs();
            z = next;
            if step < 1e-15 {
                break;
            }
        }
        if distance(z) <= distance(best) {
            best = z;
        }
    }
    best
}

/// Which of the nearby curves a point may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Outward normal of the point, whose curve must be faced; `None` for any.
    pub normal: Option<Vector3<f64>>,
    /// Penetration up to which a curve is the one that the point has passed through, m.
    pub depth: f64,
}

impl Reach {
    /// Any curve.
    pub const ANY: Self = Self { normal: None, depth: f64::INFINITY };
}

/// Whether all of a curve is farther than `distance` from a point, by the circle about its middle that holds its Bezier points.
fn farther(points: &[Vector3<f64>; 3], x: &Vector3<f64>, distance: f64) -> bool {
    let sag = (points[1] * 2.0 - points[0] - points[2]) / 2.0;
    let [a, b] = [0, 2].map(|k| (points[k] - points[1]).norm_squared());
    let radius = a.max(b).max(sag.norm_squared()).sqrt();
    (x - points[1]).norm() > (radius + distance) * (1.0 + ROUNDED)
}

/// Gap of the point `x` to the nearest of some curves of one body; `None` when there is none that counts.
pub fn gap(faces: &[Face], near: &[usize], q: &[f64], x: &Vector3<f64>, reach: Reach) -> Option<Hit> {
    let mut best: Option<(f64, Hit)> = None;
    for &index in near {
        let face = &faces[index];
        let points = face.points(q);
        if best.is_some_and(|(d, _)| farther(&points, x, d)) {
            continue;
        }
        let zeta = nearest(&points, x);
        let from = x - on_curve(&points, zeta);
        let distance = from.norm();
        if best.is_some_and(|(d, _)| d <= distance) {
            continue;
        }
        let own = normal(&points, zeta);
        let mut hit = Hit {
            face: index,
            zeta,
            slides: true,
            gap: own.dot(&from),
            normal: own,
            scale: 1.0,
            at_corner: false,
        };
        let aside = (from - own * hit.gap).norm();
        if zeta.abs() == 1.0 && aside > ON_KINK * face.length + FOOT * distance {
            let neighbour = if zeta > 0.0 { face.next } else { face.previous };
            // a seam between curves that count and curves that do not is no place of the boundary
            if reach.depth.is_finite() && !near.contains(&neighbour) {
                continue;
            }
            let other = normal(&faces[neighbour].points(q), -zeta);
            let outside = (own + other).dot(&from) >= 0.0;
            hit.slides = false;
            hit.at_corner = face.corner(&faces[neighbour]) && outside;
            let sign = if outside { 1.0 } else { -1.0 };
            hit.gap = sign * distance;
            hit.normal = from * (sign / distance);
        }
        if reach.normal.is_some_and(|n| own.dot(&n) > FACING) || hit.gap < -reach.depth {
            continue;
        }
        best = Some((distance, hit));
    }
    best.map(|(_, hit)| hit)
}

/// The gap of a point of a curve with its derivatives.
pub fn differentiable(faces: &[Face], slave: (usize, f64), hit: &Hit) -> Gap {
    Gap {
        value: hit.gap,
        normal: hit.normal,
        scale: hit.scale,
        slave: faces[slave.0].point(slave.1),
        master: faces[hit.face].point(hit.zeta),
        free: Free { master: [hit.slides, false], slave: [false; 2] },
    }
}
