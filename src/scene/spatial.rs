//! Contact of spatial beams of circular section: lines of Gauss points, or the one pair of nearest points where axes cross.
//!
//! A surface point is `x(xi, theta) = sum_i L_i(xi) sum_k f_k(R cos theta, R sin theta) q_ik`. A Gauss point fixes xi of the
//! slave; its theta, and xi and theta of the master, make the gap stationary. At a point contact xi of the slave does so too.
//! Sections deform with their elements, so that a softer section comes nearer. Source: docs/theory/contact.md#space.

use crate::element::basis::{derivative, evaluate, lagrange};
use crate::element::quadrature::gauss;
use crate::model::scene::Beam;
use crate::scene::bodies::Bodies;
use crate::scene::gap::{Free, Gap, SurfacePoint};
use crate::scene::near_pairs::{Aabb, OrientedBox, bezier, bezier_cubic, near_pairs};
use crate::scene::penalty::{ContactModel, ContactSpring};
use crate::scene::planar::overlap::rods;
use crate::scene::planar::probes::{Key, SearchCounts, slave_of};
use crate::section::basis::exponents;
use nalgebra::{DVector, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Gauss points of an integration segment.
const GAUSS_POINTS: usize = 4;
/// Newton steps of a projection.
const PROJECTION_STEPS: usize = 60;
/// Largest step of a parameter.
const LARGEST_PARAMETER_STEP: f64 = 0.4;
/// Residual of a projection, over the radius.
const PROJECTION_RESIDUAL_PER_RADIUS: f64 = 1e-12;
/// Margin of the boxes in diameters.
const BOX_MARGIN_DIAMETERS: f64 = 1.0;
/// Samples of an axis element for the nearest points of two axes.
const SAMPLES: usize = 9;

/// What places a body's surface.
struct RoundSurface {
    elements: usize,
    degree: usize,
    length: f64,
    radius: f64,
    reference: f64,
    exponents: Vec<(usize, usize)>,
    /// `L_i` and its derivatives.
    polynomials: [Vec<Vec<f64>>; 3],
}

/// Parameters on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    element: usize,
    xi: f64,
    theta: f64,
}

/// How a pair of bodies touches.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Meeting {
    point: bool,
    /// Between the axes where they are nearest, rad.
    angle: f64,
}

/// Detection between spatial bodies.
pub struct SpatialSearch {
    surfaces: Vec<RoundSurface>,
    /// Per pair (slave, master): elements of the slave with the near elements of the master.
    near: BTreeMap<(usize, usize), BTreeMap<usize, Vec<usize>>>,
    meetings: BTreeMap<(usize, usize), Meeting>,
    built: Vec<f64>,
    margin: f64,
    /// What it did.
    pub counts: SearchCounts,
}

impl SpatialSearch {
    /// Watches the bodies.
    pub fn new(bodies: &Bodies<'_>) -> Self {
        let surface = |body: &crate::model::scene::Body| {
            let (order, reference) = match &body.beam {
                Beam::Spatial(model) => {
                    (model.elements.first().map_or(3, |e| e.kind.polynomial_order()), model.reference_length)
                }
                Beam::Planar(_) => (1, 1.0),
            };
            let plain = lagrange(body.degree());
            let first: Vec<Vec<f64>> = plain.iter().map(|l| derivative(l)).collect();
            let second = first.iter().map(|l| derivative(l)).collect();
            RoundSurface {
                elements: body.elements,
                degree: body.degree(),
                length: body.length,
                radius: body.height / 2.0,
                reference,
                exponents: exponents(order),
                polynomials: [plain, first, second],
            }
        };
        Self {
            surfaces: bodies.scene.bodies.iter().map(surface).collect(),
            near: BTreeMap::new(),
            meetings: BTreeMap::new(),
            built: Vec::new(),
            margin: -1.0,
            counts: SearchCounts::default(),
        }
    }

    /// True when some pair is near.
    pub fn any(&self) -> bool {
        !self.near.is_empty()
    }

    /// Angle between the axes of two bodies where they are nearest, rad.
    pub fn angle(&self, pair: (usize, usize)) -> Option<f64> {
        self.meetings.get(&pair).or_else(|| self.meetings.get(&(pair.1, pair.0))).map(|m| m.angle)
    }

    /// Looks for near pairs when surfaces have moved too far since the last time.
    pub fn update(&mut self, bodies: &Bodies<'_>, q: &[f64]) {
        let moved =
            |(now, then): (&[f64], &[f64])| (0..3).map(|c| (now[c] - then[c]).powi(2)).sum::<f64>().sqrt();
        let spent = q.chunks_exact(3).zip(self.built.chunks_exact(3)).map(moved).fold(0.0, f64::max);
        // a vector of a section and the axis may move the surface by several times their own motion
        if self.margin >= 0.0 && spent < self.margin / 16.0 {
            return;
        }
        let start = std::time::Instant::now();
        let scene = bodies.scene;
        self.margin =
            BOX_MARGIN_DIAMETERS * scene.bodies.iter().map(|b| b.height).fold(f64::INFINITY, f64::min);
        let mut items = Vec::new();
        let mut hulls = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            for element in 0..surface.elements {
                items.push((index, element));
                hulls.push(surface.hull(bodies, index, element, q));
            }
        }
        let boxes: Vec<Aabb> = hulls.iter().map(|points| Aabb::of_points(points)).collect();
        let pairs = near_pairs(&boxes, self.margin, |i, j| items[i].0 == items[j].0);
        self.counts.searches += 1;
        self.counts.broad = pairs.len();
        (self.counts.oriented, self.counts.narrow) = (0, 0);
        self.near.clear();
        for (i, j) in pairs {
            let along = |k: usize| {
                let points = &hulls[k];
                OrientedBox::around(points, points[points.len() - 1] - points[0])
            };
            if along(i).grown(self.margin).separated(&along(j)) {
                continue;
            }
            self.counts.oriented += 1;
            let slave = slave_of(scene, items[i].0, items[j].0);
            let (s, m) = if items[i].0 == slave { (i, j) } else { (j, i) };
            let pair = self.near.entry((items[s].0, items[m].0)).or_default();
            pair.entry(items[s].1).or_default().push(items[m].1);
        }
        self.counts.narrow = self.counts.oriented;
        self.built = q.to_vec();
        self.counts.seconds += start.elapsed().as_secs_f64();
    }

    /// All springs with a gap below `limit` (m) in the state `q`, with a number of their own.
    pub fn springs(&mut self, bodies: &Bodies<'_>, q: &[f64], limit: f64) -> Vec<(Key, ContactSpring)> {
        let scene = bodies.scene;
        let mut list = Vec::new();
        let mut number = 0;
        for (&pair, elements) in &self.near {
            let (slave, master) = pair;
            let Some((start, found)) = self.nearest_axes(bodies, pair, elements, q) else { continue };
            let known = self.meetings.get(&pair).copied();
            let (s, m) = (&self.surfaces[slave], &self.surfaces[master]);
            let axes = (s.axis(bodies, slave, start.0, 0, q) - m.axis(bodies, master, start.1, 0, q)).norm();
            let apart = axes > s.radius + m.radius;
            let meeting = match known {
                Some(meeting) if !apart => Meeting { angle: found.angle, ..meeting },
                _ => found,
            };
            self.meetings.insert(pair, meeting);
            if meeting.point {
                number += 1;
                let free = Free { master: [true; 2], slave: [true; 2] };
                let Some((gap, s_at, m_at)) = self.project(bodies, pair, start, free, q) else { continue };
                if gap.value <= limit {
                    let positions = [s.position(s_at), m.position(m_at)];
                    let weight = scene.point_penalty(slave, scene.penalty(slave, master));
                    list.push((
                        (number, 0, master),
                        ContactSpring {
                            weight,
                            bodies: pair,
                            positions,
                            model: ContactModel::PointToPoint,
                            gap,
                        },
                    ));
                }
                continue;
            }
            let per_length = scene.penalty(slave, master) * scene.bodies[slave].width;
            let count = scene.contact.segments;
            for (&element, near) in elements {
                for segment in 0..count {
                    for (x, w) in gauss(GAUSS_POINTS) {
                        number += 1;
                        let xi = (2.0 * segment as f64 + 1.0 + x) / count as f64 - 1.0;
                        let weight = per_length * w / count as f64 * s.length / s.elements as f64 / 2.0;
                        let at = Place { element, xi, theta: 0.0 };
                        let Some(beside) = self.beside(bodies, pair, at, near, q) else { continue };
                        let free = Free { master: [true; 2], slave: [false, true] };
                        let Some((gap, s_at, m_at)) = self.project(bodies, pair, (at, beside), free, q)
                        else {
                            continue;
                        };
                        if gap.value <= limit {
                            let positions = [s.position(s_at), m.position(m_at)];
                            list.push((
                                (number, 0, master),
                                ContactSpring {
                                    weight,
                                    bodies: pair,
                                    positions,
                                    model: ContactModel::LineToLine,
                                    gap,
                                },
                            ));
                        }
                    }
                }
            }
        }
        list
    }

    /// The places on two axes that are nearest, and how the bodies meet there.
    fn nearest_axes(
        &self,
        bodies: &Bodies<'_>,
        (slave, master): (usize, usize),
        elements: &BTreeMap<usize, Vec<usize>>,
        q: &[f64],
    ) -> Option<((Place, Place), Meeting)> {
        let (s, m) = (&self.surfaces[slave], &self.surfaces[master]);
        let sample = |k: usize| 2.0 * k as f64 / (SAMPLES - 1) as f64 - 1.0;
        let mut best: Option<(f64, Place, Place)> = None;
        for (&element, near) in elements {
            for k in 0..SAMPLES {
                let at = Place { element, xi: sample(k), theta: 0.0 };
                let x = s.axis(bodies, slave, at, 0, q);
                for &other in near {
                    for l in 0..SAMPLES {
                        let there = Place { element: other, xi: sample(l), theta: 0.0 };
                        let distance = (m.axis(bodies, master, there, 0, q) - x).norm();
                        if best.is_none_or(|(d, ..)| distance < d) {
                            best = Some((distance, at, there));
                        }
                    }
                }
            }
        }
        let (_, at, there) = best?;
        let tangents = [s.axis(bodies, slave, at, 1, q), m.axis(bodies, master, there, 1, q)];
        let cosine = (tangents[0].dot(&tangents[1]) / (tangents[0].norm() * tangents[1].norm())).abs();
        let angle = cosine.min(1.0).acos();
        // of two bent axes the nearest points are unique above arccos(1 - 2 lambda), lambda = radius times curvature
        let lambda = s.bending(bodies, slave, at, q).max(m.bending(bodies, master, there, q));
        let unique = (1.0 - 2.0 * lambda).clamp(-1.0, 1.0).acos();
        let point = angle > unique.max(bodies.scene.contact.corner_angle);
        Some(((at, there), Meeting { point, angle }))
    }

    /// The place on the master's axis that is nearest to a place on the slave's.
    fn beside(
        &self,
        bodies: &Bodies<'_>,
        (slave, master): (usize, usize),
        at: Place,
        near: &[usize],
        q: &[f64],
    ) -> Option<Place> {
        let (s, m) = (&self.surfaces[slave], &self.surfaces[master]);
        let x = s.axis(bodies, slave, at, 0, q);
        let sample = |k: usize| 2.0 * k as f64 / (SAMPLES - 1) as f64 - 1.0;
        let places = near
            .iter()
            .flat_map(|&element| (0..SAMPLES).map(move |k| Place { element, xi: sample(k), theta: 0.0 }));
        let distance = |p: &Place| (m.axis(bodies, master, *p, 0, q) - x).norm();
        places.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Makes the gap stationary from places on both axes; `None` beyond an end of the master, or without convergence.
    fn project(
        &self,
        bodies: &Bodies<'_>,
        (slave, master): (usize, usize),
        (mut at, mut there): (Place, Place),
        free: Free,
        q: &[f64],
    ) -> Option<(Gap, Place, Place)> {
        let (s, m) = (&self.surfaces[slave], &self.surfaces[master]);
        let between = s.axis(bodies, slave, at, 0, q) - m.axis(bodies, master, there, 0, q);
        at.theta = s.facing(bodies, slave, at, &-between, q);
        there.theta = m.facing(bodies, master, there, &between, q);
        let mut normal = between.normalize();
        let mut free = free;
        let mut crossings = 0;
        for _ in 0..PROJECTION_STEPS {
            let mut gap = Gap {
                scale: 1.0,
                value: 0.0,
                normal,
                slave: s.point(bodies, slave, at),
                master: m.point(bodies, master, there),
                free,
            };
            let apart = gap.slave.sum(q, 0, 3) - gap.master.sum(q, 0, 3);
            gap.value = normal.dot(&apart);
            let (a, across) = gap.system(q, 3);
            let residual = gap.residual(q, 3, &across);
            let size = residual.amax();
            if size <= PROJECTION_RESIDUAL_PER_RADIUS * m.radius.max(s.radius) {
                // outward of the master, or the section is turned inside out
                return Some((gap, at, there));
            }
            let step = a.lu().solve(&DVector::from_column_slice((-residual).as_slice()))?;
            let mut k = 0;
            let mut take = |flag: bool| {
                if !flag {
                    return 0.0;
                }
                k += 1;
                step[k - 1].clamp(-LARGEST_PARAMETER_STEP, LARGEST_PARAMETER_STEP)
            };
            there.xi += take(free.master[0]);
            there.theta += take(free.master[1]);
            at.xi += take(free.slave[0]);
            at.theta += take(free.slave[1]);
            let turned = normal + across[0] * step[k] + across[1] * step[k + 1];
            normal = turned.normalize();
            for (place, surface, of_master) in [(&mut there, m, true), (&mut at, s, false)] {
                if place.xi.abs() <= 1.0 {
                    continue;
                }
                let forward = place.xi > 0.0;
                let end = if forward { place.element + 1 == surface.elements } else { place.element == 0 };
                if end && place.xi.abs() > 1.0 + LARGEST_PARAMETER_STEP {
                    return None;
                }
                if end {
                    continue;
                }
                crossings += 1;
                if crossings > 6 && of_master {
                    // the nearest point rests on the seam of two elements
                    place.xi = if forward { 1.0 } else { -1.0 };
                    free.master[0] = false;
                } else if forward {
                    (place.element, place.xi) = (place.element + 1, place.xi - 2.0);
                } else {
                    (place.element, place.xi) = (place.element - 1, place.xi + 2.0);
                }
            }
        }
        None
    }

    /// The deepest overlap of near bodies in the undeformed state `q`: the two bodies and the gap, m.
    pub fn overlap(&self, bodies: &Bodies<'_>, q: &[f64]) -> Option<(usize, usize, f64)> {
        let gaps = self.near.keys().filter_map(|&(a, b)| {
            let gap = rods(&bodies.scene.bodies[a], &bodies.scene.bodies[b]);
            Some((a.min(b), a.max(b), gap.or_else(|| self.distance(bodies, (a, b), q))?))
        });
        gaps.min_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Smallest gap between two bodies: of the nearest places on their axes.
    pub fn distance(&self, bodies: &Bodies<'_>, pair: (usize, usize), q: &[f64]) -> Option<f64> {
        let slave = slave_of(bodies.scene, pair.0, pair.1);
        let pair = if pair.0 == slave { pair } else { (pair.1, pair.0) };
        let every: BTreeMap<usize, Vec<usize>> = (0..self.surfaces[pair.0].elements)
            .map(|e| (e, (0..self.surfaces[pair.1].elements).collect()))
            .collect();
        let (start, meeting) = self.nearest_axes(bodies, pair, &every, q)?;
        let free = Free { master: [true; 2], slave: [meeting.point, true] };
        self.project(bodies, pair, start, free, q).map(|(gap, ..)| gap.value)
    }
}

impl RoundSurface {
    /// Position along the axis, m.
    fn position(&self, at: Place) -> f64 {
        (at.element as f64 + (at.xi + 1.0) / 2.0) * self.length / self.elements as f64
    }

    /// First coordinate of a node of an element.
    fn node(&self, bodies: &Bodies<'_>, body: usize, element: usize, i: usize) -> usize {
        bodies.node(body, self.degree * element + i)
    }

    /// Point of the axis, or its derivative by xi.
    fn axis(&self, bodies: &Bodies<'_>, body: usize, at: Place, order: usize, q: &[f64]) -> Vector3<f64> {
        let mut x = Vector3::zeros();
        for (i, l) in self.polynomials[order].iter().enumerate() {
            let first = self.node(bodies, body, at.element, i);
            x += Vector3::new(q[first], q[first + 1], q[first + 2]) * evaluate(l, at.xi);
        }
        x
    }

    /// Radius times the curvature of the axis.
    fn bending(&self, bodies: &Bodies<'_>, body: usize, at: Place, q: &[f64]) -> f64 {
        let (t, c) = (self.axis(bodies, body, at, 1, q), self.axis(bodies, body, at, 2, q));
        self.radius * t.cross(&c).norm() / t.norm().powi(3)
    }

    /// Angle in the section at which the surface faces a direction.
    fn facing(
        &self,
        bodies: &Bodies<'_>,
        body: usize,
        at: Place,
        direction: &Vector3<f64>,
        q: &[f64],
    ) -> f64 {
        let [mut y, mut z] = [Vector3::zeros(), Vector3::zeros()];
        for (i, l) in self.polynomials[0].iter().enumerate() {
            let first = self.node(bodies, body, at.element, i);
            let value = evaluate(l, at.xi);
            y += Vector3::new(q[first + 3], q[first + 4], q[first + 5]) * value;
            z += Vector3::new(q[first + 6], q[first + 7], q[first + 8]) * value;
        }
        z.dot(direction).atan2(y.dot(direction))
    }

    /// A surface point with its derivatives by xi and theta.
    fn point(&self, bodies: &Bodies<'_>, body: usize, at: Place) -> SurfacePoint {
        let (sin, cos) = at.theta.sin_cos();
        let rho = self.radius / self.reference;
        let (eta, zeta) = (rho * cos, rho * sin);
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let falling = |x: f64, n: usize, by: usize| {
            if n < by { 0.0 } else { x.powi((n - by) as i32) / factorial(n - by) }
        };
        let values: Vec<[f64; 3]> = self
            .exponents
            .iter()
            .map(|&(a, b)| {
                let f = |i: usize, j: usize| falling(eta, a, i) * falling(zeta, b, j);
                // d eta/d theta = -zeta, d zeta/d theta = eta
                let first = -zeta * f(1, 0) + eta * f(0, 1);
                let second = zeta * zeta * f(2, 0) - 2.0 * eta * zeta * f(1, 1) + eta * eta * f(0, 2)
                    - eta * f(1, 0)
                    - zeta * f(0, 1);
                [f(0, 0), first, second]
            })
            .collect();
        let mut vectors = Vec::with_capacity((self.degree + 1) * values.len());
        for i in 0..=self.degree {
            let [l, d, c] = [0, 1, 2].map(|order: usize| evaluate(&self.polynomials[order][i], at.xi));
            let first = self.node(bodies, body, at.element, i);
            for (k, [f, f1, f2]) in values.iter().enumerate() {
                vectors.push((first + 3 * k, [l * f, d * f, l * f1, c * f, d * f1, l * f2]));
            }
        }
        SurfacePoint { vectors }
    }

    /// Points whose hull holds an element: the Bezier points of lines along its surface, moved outwards so that their polygon is
    /// circumscribed to the circle; the first and the last on the axis.
    fn hull(&self, bodies: &Bodies<'_>, body: usize, element: usize, q: &[f64]) -> Vec<Vector3<f64>> {
        const AROUND: usize = 12;
        let axis = |xi: f64| self.axis(bodies, body, Place { element, xi, theta: 0.0 }, 0, q);
        let mut points = vec![axis(-1.0)];
        for l in 0..AROUND {
            let theta = 2.0 * PI * l as f64 / AROUND as f64;
            let node = |i: usize| {
                let xi = 2.0 * i as f64 / self.degree as f64 - 1.0;
                let on_circle = self.point(bodies, body, Place { element, xi, theta }).sum(q, 0, 3);
                axis(xi) + (on_circle - axis(xi)) / (PI / AROUND as f64).cos()
            };
            if self.degree == 2 {
                points.extend(bezier([0, 1, 2].map(node)));
            } else {
                points.extend(bezier_cubic([0, 1, 2, 3].map(node)));
            }
        }
        points.push(axis(1.0));
        points
    }
}
