//! The boundary of planar bodies: quadratic curves, counter-clockwise, and the nearest point on them.
//!
//! A body's boundary runs along its bottom side, its end face, its top side (backwards) and its start face. Along each curve the
//! outward normal is `n = (t_2, -t_1)/|t|`, t the tangent. Between two elements of a side the boundary has a kink, which the
//! nearest point may rest on; between a side and an end face it has a corner.

use crate::element::planar_2322s::{CURVATURES, slopes, values};
use crate::model::scene::Face;
use crate::scene::bodies::{Bodies, CurvePoints};
use crate::scene::gap::{Free, Gap, Hit, SurfacePoint};
use nalgebra::Vector3;

/// Newton steps and bisections of a root.
const ROOT_STEPS: usize = 80;
/// Distance of a point from the normal at an end of a curve, relative to its gap, within which that end is its foot.
const FOOT_RTOL: f64 = 1e-9;
/// Relative rounding of a distance, generously.
const DISTANCE_ROUNDING: f64 = 1e-9;
/// Cosine between the normals of two curves that face each other, at most.
pub const FACING: f64 = -0.2;
/// The same, relative to the curve.
const ON_KINK: f64 = 1e-12;

/// A curve of a boundary.
#[derive(Debug, Clone)]
pub struct BoundaryCurve {
    /// Index of its body.
    pub body: usize,
    /// Where it lies.
    pub place: Face,
    /// Its points at -1, 0, 1.
    pub curve: CurvePoints,
    /// Positions along the axis at -1 and 1, m.
    pub along: [f64; 2],
    /// Undeformed length, m.
    pub length: f64,
    /// Index of the curve after and before it.
    pub next: usize,
    /// Index of the curve before it.
    pub previous: usize,
}

impl BoundaryCurve {
    /// True at a corner between a side and an end face; else two elements meet.
    pub fn corner(&self, other: &Self) -> bool {
        self.place != other.place
    }

    /// The three points.
    pub fn points(&self, q: &[f64]) -> [Vector3<f64>; 3] {
        self.curve.map(|point| point.place(q))
    }

    /// The point at zeta with what it takes of the vectors behind it.
    pub fn point(&self, zeta: f64) -> SurfacePoint {
        let (l, d) = (values(zeta), slopes(zeta));
        let mut vectors = Vec::with_capacity(2 * self.curve.len());
        for (i, point) in self.curve.iter().enumerate() {
            let weights = [l[i], d[i], 0.0, CURVATURES[i], 0.0, 0.0];
            vectors.extend([(point.node, weights), (point.node + 2, weights.map(|w| w * point.height))]);
        }
        SurfacePoint { vectors }
    }

    /// Position along the axis, m.
    pub fn position(&self, zeta: f64) -> f64 {
        self.along[0] + (self.along[1] - self.along[0]) * (zeta + 1.0) / 2.0
    }
}

/// The boundaries of all bodies, one after the other.
pub fn faces(bodies: &Bodies<'_>) -> Vec<BoundaryCurve> {
    let mut list: Vec<BoundaryCurve> = Vec::new();
    for (index, body) in bodies.scene.bodies.iter().enumerate() {
        let first = list.len();
        let element = body.length / body.elements as f64;
        for place in [Face::Bottom, Face::End, Face::Top, Face::Start] {
            for (k, curve) in bodies.face(index, place).into_iter().enumerate() {
                let (along, length) = match place {
                    Face::Bottom => ([k as f64 * element, (k + 1) as f64 * element], element),
                    Face::Top => {
                        let left = (body.elements - 1 - k) as f64 * element;
                        ([left + element, left], element)
                    }
                    Face::End => ([body.length; 2], body.height),
                    Face::Start => ([0.0; 2], body.height),
                };
                let at = list.len();
                let previous = at.wrapping_sub(1);
                list.push(BoundaryCurve { body: index, place, curve, along, length, next: at + 1, previous });
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
    let distance = |z: f64| (p + (d + e * z) * z).norm_squared();
    let mut best = if distance(1.0) < distance(-1.0) { 1.0 } else { -1.0 };
    let (bounds, count) = turning_points(&c);
    for pair in bounds[..count].windows(2) {
        if !(slope(pair[0]) < 0.0 && slope(pair[1]) > 0.0) {
            continue;
        }
        let z = rising_root(&c, pair[0], pair[1]);
        if distance(z) <= distance(best) {
            best = z;
        }
    }
    best
}

/// -1, the roots of the derivative of a polynomial of degree three between them, and 1; and how many they are.
fn turning_points(c: &[f64; 4]) -> ([f64; 4], usize) {
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
    (bounds, count + 1)
}

/// The root of a polynomial that rises from below zero at `low` to above zero at `high`, by Newton's method from where a straight
/// curve has it, within bounds.
fn rising_root(c: &[f64; 4], mut low: f64, mut high: f64) -> f64 {
    let straight = -c[0] / c[1];
    let mut z = if straight > low && straight < high { straight } else { (low + high) / 2.0 };
    for _ in 0..ROOT_STEPS {
        let value = c[0] + z * (c[1] + z * (c[2] + z * c[3]));
        if value < 0.0 {
            low = z;
        } else {
            high = z;
        }
        let mut next = z - value / (c[1] + z * (2.0 * c[2] + z * 3.0 * c[3]));
        if !(next > low && next < high) {
            next = (low + high) / 2.0;
        }
        let step = (next - z).abs();
        z = next;
        if step < 1e-15 {
            break;
        }
    }
    z
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
    /// A point may touch any curve, however deep.
    pub const ANY: Self = Self { normal: None, depth: f64::INFINITY };
}

/// All curves in one state.
pub struct Contours {
    curves: Vec<Contour>,
}

/// A curve in one state.
struct Contour {
    points: [Vector3<f64>; 3],
    /// Of the circle about its middle point that holds its Bezier points, and so all of it, m.
    radius: f64,
}

impl Contours {
    /// The curves in the state `q`.
    pub fn new(faces: &[BoundaryCurve], q: &[f64]) -> Self {
        let curve = |face: &BoundaryCurve| {
            let points = face.points(q);
            let sag = (points[1] * 2.0 - points[0] - points[2]) / 2.0;
            let [a, b] = [0, 2].map(|k| (points[k] - points[1]).norm_squared());
            Contour { points, radius: a.max(b).max(sag.norm_squared()).sqrt() }
        };
        Self { curves: faces.iter().map(curve).collect() }
    }

    /// The three points of a curve.
    pub fn points(&self, face: usize) -> &[Vector3<f64>; 3] {
        &self.curves[face].points
    }

    /// Of some curves, the one whose middle is nearest to a point: where a search for the nearest point had best begin.
    fn first(&self, near: &[usize], x: &Vector3<f64>) -> usize {
        let from = |face: usize| (x - self.curves[face].points[1]).norm_squared();
        (1..near.len()).fold(0, |best, k| if from(near[k]) < from(near[best]) { k } else { best })
    }

    /// Whether all of a curve is farther than `distance` from a point.
    fn farther(&self, face: usize, x: &Vector3<f64>, distance: f64) -> bool {
        let Contour { points, radius } = &self.curves[face];
        let far = (radius + distance) * (1.0 + DISTANCE_ROUNDING);
        (x - points[1]).norm_squared() > far * far
    }
}

/// Gap of the point `x` to the nearest of some curves of one body; `None` when there is none that counts. Of curves that are equally
/// near it takes the first.
pub fn gap(
    faces: &[BoundaryCurve],
    near: &[usize],
    contours: &Contours,
    x: &Vector3<f64>,
    reach: Reach,
) -> Option<Hit> {
    let mut best: Option<(f64, usize, Hit)> = None;
    let first = contours.first(near, x);
    let order = std::iter::once(first).chain((0..near.len()).filter(|k| *k != first));
    for k in order.filter(|_| !near.is_empty()) {
        let index = near[k];
        if best.is_some_and(|(d, ..)| contours.farther(index, x, d)) {
            continue;
        }
        let (face, points) = (&faces[index], contours.points(index));
        let zeta = nearest(points, x);
        let from = x - on_curve(points, zeta);
        let distance = from.norm();
        if best.is_some_and(|(d, earlier, _)| d < distance || d == distance && earlier < k) {
            continue;
        }
        let own = normal(points, zeta);
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
        if zeta.abs() == 1.0 && aside > ON_KINK * face.length + FOOT_RTOL * distance {
            let neighbour = if zeta > 0.0 { face.next } else { face.previous };
            // a seam between curves that count and curves that do not is no place of the boundary
            if reach.depth.is_finite() && !near.contains(&neighbour) {
                continue;
            }
            let other = normal(contours.points(neighbour), -zeta);
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
        best = Some((distance, k, hit));
    }
    best.map(|(.., hit)| hit)
}

/// The gap of a point of a curve with its derivatives.
pub fn differentiable(faces: &[BoundaryCurve], slave: (usize, f64), hit: &Hit) -> Gap {
    Gap {
        value: hit.gap,
        normal: hit.normal,
        scale: hit.scale,
        slave: faces[slave.0].point(slave.1),
        master: faces[hit.face].point(hit.zeta),
        free: Free { master: [hit.slides, false], slave: [false; 2] },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The nearest point against the best of ten thousand, on curves that are flat, bent and turned back.
    #[test]
    fn the_nearest_point_is_nearer_than_any_sample() {
        let curves = [
            [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]],
            [[0.0, 0.0], [0.5, 0.4], [1.0, 0.0]],
            [[0.0, 0.0], [0.9, 0.3], [0.2, 0.1]],
        ];
        let places = [[0.3, 0.2], [0.5, -1.0], [0.5, 3.0], [-2.0, 0.1], [0.7, 0.05], [0.5, 0.4]];
        for curve in curves {
            let points = curve.map(|[x, y]| Vector3::new(x, y, 0.0));
            for [x, y] in places {
                let x = Vector3::new(x, y, 0.0);
                let distance = |z: f64| (on_curve(&points, z) - x).norm();
                let zeta = nearest(&points, &x);
                let sampled =
                    (0..=10_000).map(|k| distance(f64::from(k) / 5e3 - 1.0)).fold(f64::INFINITY, f64::min);
                assert!((-1.0..=1.0).contains(&zeta));
                assert!(distance(zeta) <= sampled + 1e-15, "{curve:?} {x:?}: {} {sampled}", distance(zeta));
                // samples a ten-thousandth apart can't be better than the root by more than their spacing
                assert!(distance(zeta) >= sampled - 2e-4);
            }
        }
    }
}
