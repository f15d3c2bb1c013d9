//! Which curves may touch, found in three phases, and the probes whose gaps are watched.
//!
//! 1. Broad: a tree of boxes around all curves, grown by a margin. The pairs found stay valid until a surface has moved so far
//!    that the margin may be used up; with nothing near, that is the only work.
//! 2. Oriented boxes with the separating axis test.
//! 3. Narrow: the chord of one curve, clipped by the other's oriented box; what is left is measured by projection.
//!
//! Source: docs/theory/contact.md#gap.

mod gaps;

use crate::element::quadrature::gauss;
use crate::model::scene::{ContactSettings, Enforcement, Face, Scene};
use crate::scene::bodies::Bodies;
use crate::scene::near_pairs::{Aabb, OrientedBox, bezier, clip, near_pairs};
use crate::scene::planar::boundary::{BoundaryCurve, faces, normal, on_curve};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Number of Gauss points of an integration segment.
const LINE_POINTS: usize = 4;
/// Share of a margin that nodes may move before the pairs are looked for again: both curves of a pair may move by 5/4 of it.
const SPENT_MARGIN_SHARE: f64 = 0.4;
/// Margin in heights with which something near is watched.
const NEAR_MARGIN_HEIGHTS: f64 = 1.0;
/// Margin in heights, or in motions of a step, with which it is seen that nothing is near.
const FAR_MARGIN_HEIGHTS: f64 = 4.0;
/// Height that surfaces may move in a step while something is near.
const STEP_HEIGHTS: f64 = 0.2;
/// Height that surfaces may have moved after a step while something is near: twice that is below [`LAYER`].
const SEEN_HEIGHTS: f64 = 0.22;
/// Self-contact: distance along the body, in heights, that neighbours have.
const NEIGHBOUR_HEIGHTS: f64 = 3.0;
/// What a probe stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A Gauss point of a line contact.
    Line,
    /// A corner between a side and an end face.
    Corner,
    /// A node of a side.
    Node,
}

/// A point of one boundary that is watched against one body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactProbe {
    /// Curve and parameter.
    pub slave: (usize, f64),
    /// Body that it may penetrate.
    pub target: usize,
    /// Energy is `weight g^2/2`, N/m.
    pub weight: f64,
    /// What it stands for.
    pub kind: Kind,
    /// What it may touch.
    onto: Onto,
}

/// What a probe may touch of the body that it is watched against. Decided while it is apart, so that its energy has no steps
/// while it is in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Onto {
    /// Not decided yet.
    Unknown,
    /// Nothing: another probe carries the contact.
    Nothing,
    /// Whatever is nearest.
    Nearest,
    /// The side that it faces.
    Side(Face),
}

/// What tells one probe from another: curve, parameter (its bits), body that it may penetrate.
pub type Key = (usize, u64, usize);

impl ContactProbe {
    /// What tells it from another.
    pub fn key(&self) -> Key {
        (self.slave.0, self.slave.1.to_bits(), self.target)
    }
}

/// What detection did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SearchCounts {
    /// How often near pairs were looked for.
    pub searches: usize,
    /// Pairs of curves whose grown boxes overlap, last time.
    pub broad: usize,
    /// Pairs left by oriented boxes.
    pub oriented: usize,
    /// Pairs left by clipping.
    pub narrow: usize,
    /// Time in broad phase, boxes and clipping, s.
    pub seconds: f64,
}

/// Detection between the boundaries of a scene.
pub struct PlanarSearch {
    /// Boundary curves of all bodies.
    pub faces: Vec<BoundaryCurve>,
    /// Probes of curves that are near something, in the order of the curves.
    pub probes: Vec<ContactProbe>,
    /// Per curve: near curves by body, those of one body together.
    near: Vec<Vec<(usize, Vec<usize>)>>,
    any: bool,
    margin: f64,
    built: Vec<f64>,
    /// The smallest height and half the largest, m.
    height: f64,
    half_height: f64,
    /// What it did.
    pub counts: SearchCounts,
}

/// Which of two bodies integrates: the one with the shorter elements, of equals the later one.
pub fn slave_of(scene: &Scene, a: usize, b: usize) -> usize {
    let size = |i: usize| scene.bodies[i].length / scene.bodies[i].elements as f64;
    if size(a.min(b)) < size(a.max(b)) * (1.0 - 1e-9) { a.min(b) } else { a.max(b) }
}

impl PlanarSearch {
    /// Watches the bodies; pairs are looked for at the first call of [`Self::prepare`].
    pub fn new(bodies: &Bodies<'_>) -> Self {
        let scene = bodies.scene;
        let faces = faces(bodies);
        Self {
            near: vec![Vec::new(); faces.len()],
            faces,
            probes: Vec::new(),
            any: false,
            margin: -1.0,
            built: Vec::new(),
            height: scene.bodies.iter().map(|b| b.height).fold(f64::INFINITY, f64::min),
            half_height: scene.bodies.iter().map(|b| b.height / 2.0).fold(0.0, f64::max),
            counts: SearchCounts::default(),
        }
    }

    /// Probes of all curves that are near something; their segments are cut at the places that `cuts` gives.
    fn make_probes(&self, scene: &Scene, cuts: impl Fn(usize, usize) -> Vec<f64>) -> Vec<ContactProbe> {
        let at_nodes = at_nodes(scene);
        let mut list = Vec::new();
        for (index, face) in self.faces.iter().enumerate() {
            for &(target, _) in &self.near[index] {
                let line = face.body == target || slave_of(scene, face.body, target) == face.body;
                if line && !at_nodes {
                    self.segments(scene, index, target, &cuts(index, target), &mut list);
                }
                if face.corner(&self.faces[face.next]) {
                    let share = if face.body == target { 0.5 } else { 1.0 };
                    list.push(ContactProbe {
                        slave: (index, 1.0),
                        target,
                        weight: scene.point_penalty(face.body, scene.penalty(face.body, target)) * share,
                        kind: Kind::Corner,
                        onto: Onto::Unknown,
                    });
                } else if line && at_nodes {
                    list.push(node_probe(index, 1.0, target));
                }
                if line && at_nodes {
                    list.push(node_probe(index, 0.0, target));
                }
            }
        }
        list
    }

    /// Gauss points of the segments of a curve, cut at more places.
    fn segments(
        &self,
        scene: &Scene,
        index: usize,
        target: usize,
        cuts: &[f64],
        list: &mut Vec<ContactProbe>,
    ) {
        let face = &self.faces[index];
        let settings: &ContactSettings = &scene.contact;
        let count = settings.segments;
        let mut bounds: Vec<f64> = (0..=count).map(|k| 2.0 * k as f64 / count as f64 - 1.0).collect();
        bounds.extend_from_slice(cuts);
        bounds.sort_by(f64::total_cmp);
        // in self-contact every place is seen from both sides
        let share = if face.body == target { 0.5 } else { 1.0 };
        let penalty = scene.penalty(face.body, target);
        let per_length = penalty * scene.bodies[face.body].width * share * face.length / 2.0;
        let points = gauss(LINE_POINTS);
        for pair in bounds.windows(2).filter(|pair| pair[1] > pair[0]) {
            let (middle, half) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
            for &(x, w) in &points {
                list.push(ContactProbe {
                    slave: (index, middle + half * x),
                    target,
                    weight: per_length * half * w,
                    kind: Kind::Line,
                    onto: Onto::Unknown,
                });
            }
        }
    }

    /// Cuts the segments where the elements of the other body end, in the state `q`; returns the largest change of a probe's
    /// parameter (infinity when their number changes).
    pub fn cut(&mut self, scene: &Scene, q: &[f64]) -> f64 {
        if !scene.contact.cut || scene.contact.method != Enforcement::Penalty {
            return 0.0;
        }
        let list = self.make_probes(scene, |index, target| self.cuts(index, target, q));
        let before = self.replace_probes(list);
        if before.len() != self.probes.len() {
            return f64::INFINITY;
        }
        before.iter().zip(&self.probes).map(|(a, b)| (a.slave.1 - b.slave.1).abs()).fold(0.0, f64::max)
    }

    /// Takes new probes; those that were there go on with what they may touch. Returns the old ones.
    fn replace_probes(&mut self, mut list: Vec<ContactProbe>) -> Vec<ContactProbe> {
        let alike = |(a, b): (&ContactProbe, &ContactProbe)| {
            (a.slave.0, a.target, a.kind) == (b.slave.0, b.target, b.kind)
        };
        if list.len() == self.probes.len() && list.iter().zip(&self.probes).all(alike) {
            list.iter_mut().zip(&self.probes).for_each(|(new, old)| new.onto = old.onto);
        } else {
            let known: BTreeMap<Key, Onto> = self.probes.iter().map(|p| (p.key(), p.onto)).collect();
            for probe in &mut list {
                probe.onto = known.get(&probe.key()).copied().unwrap_or(Onto::Unknown);
            }
        }
        std::mem::replace(&mut self.probes, list)
    }

    /// Where the ends of near curves of a body project on a curve.
    fn cuts(&self, index: usize, target: usize, q: &[f64]) -> Vec<f64> {
        let face = &self.faces[index];
        let Some(near) = self.near_of(index, target) else { return Vec::new() };
        let points = face.points(q);
        let mut cuts = Vec::new();
        for &other in near {
            let other = &self.faces[other];
            let ends = other.points(q);
            for (end, zeta) in [(ends[0], -1.0), (ends[2], 1.0)] {
                let z = crate::scene::planar::boundary::nearest(&points, &end);
                // the master's own normal decides which point of the slave belongs to its end
                let foot = self.along_normal(&points, z, &end, &normal(&ends, zeta));
                if foot.abs() < 1.0 {
                    cuts.push(foot);
                }
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        cuts
    }

    /// Parameter where a curve meets the line from a point along a direction, from a start near it.
    fn along_normal(
        &self,
        points: &[Vector3<f64>; 3],
        start: f64,
        from: &Vector3<f64>,
        n: &Vector3<f64>,
    ) -> f64 {
        let mut z = start;
        for _ in 0..8 {
            let miss = on_curve(points, z) - from;
            let d = crate::element::planar_2322s::slopes(z);
            let t = points[0] * d[0] + points[1] * d[1] + points[2] * d[2];
            let slope = t.x * n.y - t.y * n.x;
            let value = miss.x * n.y - miss.y * n.x;
            if slope.abs() < 1e-3 * t.norm() {
                return f64::INFINITY;
            }
            let step = value / slope;
            z -= step;
            if step.abs() < 1e-14 {
                break;
            }
        }
        z
    }

    fn near_of(&self, face: usize, target: usize) -> Option<&[usize]> {
        self.near[face].iter().find(|(body, _)| *body == target).map(|(_, list)| &list[..])
    }

    /// Near curves of a body that a probe may touch, empty when it is far from all.
    pub fn near(&self, probe: &ContactProbe) -> &[usize] {
        self.near_of(probe.slave.0, probe.target).unwrap_or(&[])
    }

    /// True when some pair is near.
    pub fn any(&self) -> bool {
        self.any
    }

    /// Looks for near pairs if the last ones may be out of date within the next step of `dt` (s) from `q` at velocity `v`.
    /// Returns into how many parts the step must be cut so that nothing passes through anything.
    pub fn prepare(&mut self, bodies: &Bodies<'_>, q: &[f64], v: &[f64], dt: f64) -> usize {
        let stride = self.fastest(bodies, v) * dt;
        if self.margin >= 0.0 && self.moved(q) + stride <= SPENT_MARGIN_SHARE * self.margin {
            return 1;
        }
        let start = std::time::Instant::now();
        self.build(bodies, q, (FAR_MARGIN_HEIGHTS * self.height).max(FAR_MARGIN_HEIGHTS * stride));
        let mut parts = 1;
        if self.any {
            self.build(bodies, q, NEAR_MARGIN_HEIGHTS * self.height);
            parts = (stride / (STEP_HEIGHTS * self.height)).ceil().clamp(1.0, 1e9) as usize;
        }
        self.counts.seconds += start.elapsed().as_secs_f64();
        parts
    }

    /// Speed of the fastest surface point, against the mean of all bodies, m/s.
    fn fastest(&self, bodies: &Bodies<'_>, v: &[f64]) -> f64 {
        let step = 2 * bodies.components();
        let nodes = (v.len() / step).max(1) as f64;
        let mean = |c: usize| v.iter().skip(c).step_by(step).sum::<f64>() / nodes;
        let mean = [mean(0), mean(1)];
        self.largest(bodies, |at, c| v[at + c] - if c < 2 { mean[c] } else { 0.0 })
    }

    /// How far a surface moves between two states, against the mean of all bodies, m.
    pub fn travel(&self, bodies: &Bodies<'_>, from: &[f64], to: &[f64]) -> f64 {
        let moved: Vec<f64> = from.iter().zip(to).map(|(from, to)| to - from).collect();
        self.fastest(bodies, &moved)
    }

    /// Largest distance (m) any surface may travel in the next step without a missed contact: what is left of half the search
    /// margin and, if a pair is near, at most 0.22 heights. Rigid motion common to all bodies does not count.
    pub fn reach(&self, q: &[f64]) -> f64 {
        let rest = (self.margin / 2.0 - self.moved(q)).max(0.0);
        if self.any { rest.min(SEEN_HEIGHTS * self.height) } else { rest }
    }

    fn largest(&self, bodies: &Bodies<'_>, of: impl Fn(usize, usize) -> f64) -> f64 {
        let mut largest = 0.0_f64;
        for (index, body) in bodies.scene.bodies.iter().enumerate() {
            for node in 0..body.nodes() {
                let at = bodies.node(index, node);
                let length = |k: usize| (of(at, k).powi(2) + of(at, k + 1).powi(2)).sqrt();
                let (axis, turn) = (length(0), length(2) * body.height / 2.0);
                largest = largest.max(axis + turn);
            }
        }
        largest
    }

    /// How far a surface has moved since the pairs were found, m.
    fn moved(&self, q: &[f64]) -> f64 {
        let mut largest = 0.0_f64;
        let half = self.half_height;
        for (now, then) in q.chunks_exact(4).zip(self.built.chunks_exact(4)) {
            let length = |k: usize| ((now[k] - then[k]).powi(2) + (now[k + 1] - then[k + 1]).powi(2)).sqrt();
            let (axis, turn) = (length(0), length(2));
            largest = largest.max(axis + turn * half);
        }
        largest
    }

    fn build(&mut self, bodies: &Bodies<'_>, q: &[f64], margin: f64) {
        let scene = bodies.scene;
        let hulls: Vec<[Vector3<f64>; 3]> = self.faces.iter().map(|f| bezier(f.points(q))).collect();
        let boxes: Vec<Aabb> = hulls.iter().map(|points| Aabb::of_points(points)).collect();
        let skip = |i: usize, j: usize| {
            let (a, b) = (&self.faces[i], &self.faces[j]);
            a.body == b.body
                && !(scene.contact.with_itself
                    && apart(a, b) >= NEIGHBOUR_HEIGHTS * scene.bodies[a.body].height)
        };
        let pairs = near_pairs(&boxes, margin, skip);
        self.counts.searches += 1;
        self.counts.broad = pairs.len();
        self.near = vec![Vec::new(); self.faces.len()];
        (self.counts.oriented, self.counts.narrow) = (0, 0);
        let oriented: Vec<OrientedBox> =
            hulls.iter().map(|points| OrientedBox::along_chord(points)).collect();
        for (i, j) in pairs {
            if oriented[i].grown(margin).separated(&oriented[j]) {
                continue;
            }
            self.counts.oriented += 1;
            // the chord of the flatter curve against the box of the other, swollen by what the curve is away from its chord
            let sag = (hulls[i][1] - (hulls[i][0] + hulls[i][2]) / 2.0).norm();
            let polygon = outline(&oriented[j].grown(margin + sag));
            if clip(hulls[i][0], hulls[i][2], &polygon).is_none() {
                continue;
            }
            self.counts.narrow += 1;
            for (from, to) in [(i, j), (j, i)] {
                let target = self.faces[to].body;
                match self.near[from].iter_mut().find(|(body, _)| *body == target) {
                    Some((_, list)) => list.push(to),
                    None => self.near[from].push((target, vec![to])),
                }
            }
        }
        self.any = self.counts.narrow > 0;
        let probes = self.make_probes(scene, |_, _| Vec::new());
        self.replace_probes(probes);
        self.margin = margin;
        self.built = q.to_vec();
    }
}

/// Corners of an oriented box in the plane, counter-clockwise.
fn outline(b: &OrientedBox) -> [Vector3<f64>; 4] {
    // the box of points in the plane has one axis across it
    let across = (0..3).find(|&k| b.axes[k].z.abs() > 0.5).unwrap_or(2);
    let [i, j] = [(across + 1) % 3, (across + 2) % 3];
    let (mut u, v) = (b.axes[i] * b.half[i], b.axes[j] * b.half[j]);
    if u.x * v.y - u.y * v.x < 0.0 {
        u = -u;
    }
    [b.centre - u - v, b.centre + u - v, b.centre + u + v, b.centre - u + v]
}

/// Whether contact is enforced at nodes instead of along lines.
fn at_nodes(scene: &Scene) -> bool {
    !matches!(scene.contact.method, Enforcement::Penalty | Enforcement::None)
}

fn node_probe(face: usize, zeta: f64, target: usize) -> ContactProbe {
    ContactProbe { slave: (face, zeta), target, weight: 0.0, kind: Kind::Node, onto: Onto::Unknown }
}

/// Distance of two curves along the axis of their body, m.
fn apart(a: &BoundaryCurve, b: &BoundaryCurve) -> f64 {
    let [low_a, high_a] = [a.along[0].min(a.along[1]), a.along[0].max(a.along[1])];
    let [low_b, high_b] = [b.along[0].min(b.along[1]), b.along[0].max(b.along[1])];
    (low_a - high_b).max(low_b - high_a).max(0.0)
}
