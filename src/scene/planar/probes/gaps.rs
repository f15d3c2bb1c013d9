//! Gaps of probes: which curve each may touch, and how far it is from it.

use crate::model::scene::{Face, Scene};
use crate::scene::bodies::Bodies;
use crate::scene::gap::Hit;
use crate::scene::near_pairs::{Aabb, bezier};
use crate::scene::penalty::{ContactModel, ContactSpring};
use crate::scene::planar::boundary::{Contours, FACING, Reach, differentiable, gap, normal, on_curve};
use crate::scene::planar::probes::{
    ContactProbe, Key, Kind, NEIGHBOUR_HEIGHTS, Onto, PlanarSearch, apart, at_nodes, slave_of,
};
use nalgebra::Vector3;

/// What the distance to a boundary is multiplied by on the way out past an end of the side that a point faces.
const EXIT_FACTOR: f64 = 10.0;
/// Distance in heights from a corner within which another corner is said to meet it, not the face beside it.
const AT_CORNER_HEIGHTS: f64 = 0.05;
/// Penetration in heights beyond which a curve is not the one that a point of a line has passed through.
const LAYER_HEIGHTS: f64 = 0.45;

/// Distance of a point from a box, zero inside.
pub(super) fn distance_to(b: &Aabb, x: &Vector3<f64>) -> f64 {
    (b.low - x).sup(&(x - b.high)).sup(&Vector3::zeros()).norm()
}

impl PlanarSearch {
    /// All curves in the state `q`.
    pub fn contours(&self, q: &[f64]) -> Contours {
        Contours::new(&self.faces, q)
    }

    /// Gap of a probe; `None` when it touches nothing or nothing is near.
    pub fn gap(&self, bodies: &Bodies<'_>, probe: &ContactProbe, contours: &Contours) -> Option<Hit> {
        let near = self.near(probe);
        match probe.onto {
            _ if near.is_empty() => None,
            Onto::Nothing => None,
            Onto::Side(place) => self.gap_to_side(probe.slave, near, place, contours),
            Onto::Nearest | Onto::Unknown => self.gap_at(bodies, probe.slave, probe.target, near, contours),
        }
    }

    /// Gap to the side that a point faces, or to where it leaves the body past an end of that side: the lesser of the depth below
    /// the side and [`EXIT_FACTOR`] times the distance to the whole boundary, which goes to zero on every way out.
    pub(super) fn gap_to_side(
        &self,
        slave: (usize, f64),
        near: &[usize],
        place: Face,
        contours: &Contours,
    ) -> Option<Hit> {
        let nearest = self.gap_to_any(slave, near, contours)?;
        if nearest.gap >= 0.0 || self.faces[nearest.face].place == place {
            return Some(nearest);
        }
        let side: Vec<usize> = near.iter().copied().filter(|&f| self.faces[f].place == place).collect();
        let exit = Hit { gap: EXIT_FACTOR * nearest.gap, scale: EXIT_FACTOR, ..nearest };
        let below =
            self.gap_to_any(slave, &side, contours).filter(|hit| exit.gap <= hit.gap && hit.gap <= 0.0);
        Some(below.unwrap_or(exit))
    }

    /// A probe's hit as a spring.
    pub fn spring(&self, probe: &ContactProbe, hit: &Hit) -> ContactSpring {
        let (slave, master) = (&self.faces[probe.slave.0], &self.faces[hit.face]);
        let neighbour = &self.faces[if hit.zeta > 0.0 { master.next } else { master.previous }];
        let to_end = (1.0 - hit.zeta.abs()) / 2.0 * master.length;
        let model = match probe.kind {
            Kind::Line => ContactModel::LineToLine,
            Kind::Corner if master.corner(neighbour) && to_end < AT_CORNER_HEIGHTS * self.height => {
                ContactModel::PointToPoint
            }
            Kind::Corner | Kind::Node => ContactModel::PointToSegment,
        };
        ContactSpring {
            weight: probe.weight,
            bodies: (slave.body, master.body),
            positions: [slave.position(probe.slave.1), master.position(hit.zeta)],
            model,
            gap: differentiable(&self.faces, probe.slave, hit),
        }
    }

    /// All springs with a gap below `limit` (m) in the state `q`, each with the key of its probe. Nodes touch only what one of their own
    /// faces faces: a constraint of a corner on the face beside another corner would hold it back without any obstacle.
    pub fn springs(&self, bodies: &Bodies<'_>, q: &[f64], limit: f64) -> Vec<(Key, ContactSpring)> {
        if !self.any {
            return Vec::new();
        }
        let contours = self.contours(q);
        let found = self.probes.iter().filter_map(|probe| {
            let hit = self.gap(bodies, probe, &contours)?;
            let counts = !at_nodes(bodies.scene) || self.faces_it(probe, &hit, &contours);
            (hit.gap <= limit && !hit.at_corner && counts).then(|| (probe.key(), self.spring(probe, &hit)))
        });
        found.collect()
    }

    /// Whether a face that a probe lies on faces what it has met.
    pub(super) fn faces_it(&self, probe: &ContactProbe, hit: &Hit, contours: &Contours) -> bool {
        let face = &self.faces[probe.slave.0];
        let own = normal(contours.points(probe.slave.0), probe.slave.1);
        let next = normal(contours.points(face.next), -1.0);
        let against = own.dot(&hit.normal);
        let least = if probe.kind == Kind::Corner { against.min(next.dot(&hit.normal)) } else { against };
        least <= FACING
    }

    pub(super) fn gap_at(
        &self,
        bodies: &Bodies<'_>,
        slave: (usize, f64),
        target: usize,
        near: &[usize],
        contours: &Contours,
    ) -> Option<Hit> {
        // the distance to the whole boundary of another body has no steps
        if self.faces[slave.0].body != target {
            return self.gap_to_any(slave, near, contours);
        }
        let face = &self.faces[slave.0];
        let points = contours.points(slave.0);
        let mut n = normal(points, slave.1);
        let next = &self.faces[face.next];
        if slave.1 == 1.0 && face.corner(next) {
            // a corner stands between two normals
            n += normal(contours.points(face.next), -1.0);
        }
        let reach = Reach { normal: Some(n), depth: LAYER_HEIGHTS * bodies.scene.bodies[target].height };
        gap(&self.faces, near, contours, &on_curve(points, slave.1), reach)
    }

    /// Gap of any point of a curve to any near curve of a body.
    pub(super) fn gap_to_any(&self, slave: (usize, f64), near: &[usize], contours: &Contours) -> Option<Hit> {
        gap(&self.faces, near, contours, &on_curve(contours.points(slave.0), slave.1), Reach::ANY)
    }

    /// Gap of every probe in the state `q`, `None` where it touches nothing or nothing is near. Of those that are apart it is
    /// decided before what they may touch: the side that they are near, if they face it; nothing, if a corner stands with one of
    /// its faces at less than the angle of the settings to what it is near, for the line beside it carries that contact.
    pub fn choose(&mut self, bodies: &Bodies<'_>, q: &[f64]) -> Vec<Option<Hit>> {
        if !self.any {
            return Vec::new();
        }
        let contours = self.contours(q);
        let mut hits = Vec::with_capacity(self.probes.len());
        for k in 0..self.probes.len() {
            let probe = self.probes[k];
            let near = self.near(&probe);
            let hit = if near.is_empty() {
                None
            } else {
                self.gap_at(bodies, probe.slave, probe.target, near, &contours)
            };
            let Some(hit) = hit else {
                hits.push(None);
                continue;
            };
            let apart = hit.gap >= 0.0;
            if apart || probe.onto == Onto::Unknown {
                self.probes[k].onto = self.onto(bodies.scene, &probe, &hit, &contours);
            }
            hits.push(match self.probes[k].onto {
                Onto::Nothing => None,
                Onto::Side(_) if !apart => self.gap(bodies, &self.probes[k], &contours),
                _ => Some(hit),
            });
        }
        hits
    }

    /// What a probe may touch that is near a place of another boundary.
    pub(super) fn onto(&self, scene: &Scene, probe: &ContactProbe, hit: &Hit, contours: &Contours) -> Onto {
        let face = &self.faces[probe.slave.0];
        let n = normal(contours.points(probe.slave.0), probe.slave.1);
        match probe.kind {
            // what counts of its own body faces it
            _ if face.body == probe.target && probe.kind != Kind::Corner => Onto::Nearest,
            Kind::Line | Kind::Node => {
                let other = &self.faces[hit.face];
                let neighbour = if hit.zeta > 0.0 { other.next } else { other.previous };
                let ends = [(hit.face, hit.zeta), (neighbour, -hit.zeta)];
                let against = ends.map(|(f, zeta)| n.dot(&normal(contours.points(f), zeta)));
                let best = usize::from(hit.at_corner && against[1] < against[0]);
                if against[best] <= FACING {
                    Onto::Side(self.faces[ends[best].0].place)
                } else {
                    Onto::Nothing
                }
            }
            // where nodes carry the line, the corners of the side that integrates are nodes of it
            Kind::Corner if at_nodes(scene) && slave_of(scene, face.body, probe.target) == face.body => {
                Onto::Nearest
            }
            Kind::Corner => {
                let next = normal(contours.points(face.next), -1.0);
                let along = |n: &Vector3<f64>| (n.x * hit.normal.y - n.y * hit.normal.x).abs();
                let limit = scene.contact.corner_angle.sin();
                if along(&n).min(along(&next)) <= limit { Onto::Nothing } else { Onto::Nearest }
            }
        }
    }

    /// Smallest gap between two bodies in the state `q`, whatever it is, m: nodes of either against the curves of the other.
    pub fn distance(&self, bodies: &Bodies<'_>, pair: (usize, usize), q: &[f64]) -> Option<f64> {
        let of = |body: usize| (0..self.faces.len()).filter(move |&f| self.faces[f].body == body);
        let boxes: Vec<Option<Aabb>> = (0..self.faces.len())
            .map(|f| {
                (pair.0 == self.faces[f].body || pair.1 == self.faces[f].body)
                    .then(|| Aabb::of_points(&bezier(self.faces[f].points(q))))
            })
            .collect();
        let contours = self.contours(q);
        let mut smallest: Option<f64> = None;
        for (slave, master) in [pair, (pair.1, pair.0)] {
            for f in of(slave) {
                let face = &self.faces[f];
                for zeta in [-1.0, 0.0] {
                    let x = on_curve(contours.points(f), zeta);
                    let limit = smallest.unwrap_or(f64::INFINITY);
                    let skip = NEIGHBOUR_HEIGHTS * bodies.scene.bodies[slave].height;
                    let list: Vec<usize> = of(master)
                        .filter(|&m| boxes[m].as_ref().is_some_and(|b| distance_to(b, &x) <= limit.abs()))
                        .filter(|&m| slave != master || apart(face, &self.faces[m]) >= skip)
                        .collect();
                    let hit = if slave == master {
                        self.gap_at(bodies, (f, zeta), master, &list, &contours)
                    } else {
                        self.gap_to_any((f, zeta), &list, &contours)
                    };
                    let Some(hit) = hit else { continue };
                    if smallest.is_none_or(|s| hit.gap < s) {
                        smallest = Some(hit.gap);
                    }
                }
            }
            if slave == master {
                break;
            }
        }
        smallest
    }
}
