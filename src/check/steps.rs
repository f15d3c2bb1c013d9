//! Near a step: which kinked functions each side takes, over which length, and where its elements end.
//!
//! The face of a step leaves a corner, at which stress has no bound. Sections that deform only by the functions of their
//! member cannot follow it on any mesh; kinked functions at and beside the smaller radius do. They reach as far as the
//! disturbance. Source: docs/theory/steps.md, where the numbers are measured.

use crate::section::Section;
use crate::section::basis::SectionBasis;
use crate::section::kinks::{Kink, Kinks};

/// Largest effort.
pub const FINEST: usize = 6;
/// Length of a zone with kinks over the outer radius of its side: the side that reaches beyond the other, and the other one.
const REACH: [f64; 2] = [0.8, 0.3];
/// Length of the element beside a step over the smaller outer radius.
const FIRST_ELEMENT: f64 = 0.5;
/// Ratio of the lengths of elements one behind the other.
const GROWTH: f64 = 3.0;
/// Share of an element within which an end is not placed beside another one.
const CLOSE_ENDS: f64 = 0.3;
/// Longest element of a graded mesh over the outer radius.
const LONGEST: f64 = 2.0;
/// Height over the smaller radius below which a step is none: it changes frequencies by less than 1e-4.
const SMALLEST_STEP: f64 = 2e-3;
/// Longest scale of a kink beside a step over its distance from the edge of the shared area.
const SCALE: f64 = 5.0;

/// Distance of two kinks over their radius within which they are one. This number and the two below are by trial on short disks
/// between unlike shafts, whose eigenvalue problems did not converge with less.
const NEAR_RADIUS: f64 = 0.03;
/// Distance of the radii of two steps over the smaller one that kinks of a high degree need in one zone.
const HIGH_APART: f64 = 0.35;
/// Largest degree of kinks that are closer.
const CLOSE_DEGREE: usize = 2;

/// Kinks of one effort.
struct Effort {
    /// Degree at the radius of the step.
    at: usize,
    /// Radii beside it on both sides: their distance over the radius, and the degree there.
    beside: &'static [(f64, usize)],
}

/// Efforts 0 (none) to [`FINEST`].
const EFFORTS: [Effort; FINEST + 1] = [
    Effort { at: 0, beside: &[] },
    Effort { at: 1, beside: &[] },
    Effort { at: 2, beside: &[] },
    Effort { at: 2, beside: &[(0.1, 1)] },
    Effort { at: 2, beside: &[(0.15, 2)] },
    Effort { at: 4, beside: &[(0.15, 2)] },
    Effort { at: 4, beside: &[(0.2, 2), (0.07, 2)] },
];

/// The part of a segment beside a step.
#[derive(Debug, Clone)]
struct Zone {
    /// Length along the segment, m.
    length: f64,
    /// Length of the element at the face, m.
    first: f64,
    /// Kinks where the area ends that both sides share.
    at: Vec<Kink>,
    /// Kinks beside them.
    beside: Vec<Kink>,
}

/// A neighbour at an end of a piece of the shaft.
#[derive(Debug, Clone, Copy)]
pub struct Neighbour<'a> {
    /// Its section.
    pub section: &'a Section,
    /// Effort at the step: that of both sides where both have one, else that of the piece.
    pub effort: usize,
}

/// What the steps at the ends of a piece of one section ask of it.
#[derive(Debug, Clone, Default)]
pub struct Steps {
    /// Places where elements end, measured from the left end of the piece, m.
    pub cuts: Vec<f64>,
    /// At the left and the right end.
    zones: [Option<Zone>; 2],
    /// Length of the piece, m.
    length: f64,
}

impl Steps {
    /// The steps of a piece between neighbours; `own` are the sections of its ends, `longest` is the length of an element (m)
    /// that was asked for.
    pub fn new(
        own: [&Section; 2],
        neighbours: [Option<Neighbour<'_>>; 2],
        length: f64,
        longest: f64,
    ) -> Self {
        let zones = [0, 1].map(|i| zone(own[i], neighbours[i]?.section, neighbours[i]?.effort));
        let size = own[0].outer_size().min(own[1].outer_size());
        Self { cuts: cuts(length, longest.min(LONGEST * size), &zones), zones, length }
    }

    /// The kinks between two places, measured from the left end of the piece.
    pub fn kinks(&self, from: f64, to: f64) -> Kinks {
        let middle = (from + to) / 2.0;
        let [left, right] = &self.zones;
        let one = meet(&self.zones, self.length);
        let in_left = left.as_ref().filter(|z| one || middle < z.length);
        let in_right = right.as_ref().filter(|z| one || middle > self.length - z.length);
        let zones: Vec<&Zone> = in_left.into_iter().chain(in_right).collect();
        // by radius, so that a shaft and its mirror image take the same
        let sorted = |of: fn(&Zone) -> &[Kink]| {
            let mut list: Vec<Kink> = zones.iter().flat_map(|z| of(z)).copied().collect();
            list.sort_by(|a, b| a.radius.total_cmp(&b.radius));
            list
        };
        let apart = |a: &Kink, b: &Kink| (a.radius - b.radius).abs() / a.radius.min(b.radius);
        let mut kept: Vec<Kink> = Vec::new();
        for kink in sorted(|z| &z.at) {
            match kept.iter().position(|k| k.inward == kink.inward && apart(k, &kink) < NEAR_RADIUS) {
                // the one of two that vanishes on both shared areas
                Some(i) => {
                    let degree = kept[i].degree.max(kink.degree);
                    kept[i] = Kink { degree, ..if kink.inward { kept[i] } else { kink } };
                }
                None => kept.push(kink),
            }
        }
        let steps = kept.clone();
        for (i, kink) in kept.iter_mut().enumerate() {
            let others = steps.iter().enumerate().filter(|(j, k)| *j != i && k.inward == kink.inward);
            if others.map(|(_, k)| apart(k, kink)).any(|d| d < HIGH_APART) {
                kink.degree = kink.degree.min(CLOSE_DEGREE);
            }
        }
        for kink in sorted(|z| &z.beside) {
            // functions of radii that are close to each other can hardly be told apart
            match kept.iter().position(|k| apart(k, &kink) < NEAR_RADIUS) {
                Some(i) if kept[i].is_at(&kink) => kept[i].degree = kept[i].degree.max(kink.degree),
                Some(_) => {}
                None => kept.push(kink),
            }
        }
        Kinks::new(&kept)
    }
}

/// True for zones that meet, or nearly so: they are one.
fn meet(zones: &[Option<Zone>; 2], length: f64) -> bool {
    match zones {
        [Some(a), Some(b)] => a.length + b.length >= length - CLOSE_ENDS * a.first.min(b.first),
        [one, other] => one.iter().chain(other).any(|z| z.length >= length),
    }
}

/// Most effort that suits the functions of a member: polynomials of a high degree across a wall can hardly be told from kinks of
/// a high degree.
pub fn most(basis: SectionBasis) -> usize {
    match basis {
        SectionBasis::Ring { degree: 6.., .. } => 4,
        _ => FINEST,
    }
}

/// A segment as steps see it: the effort that is asked for, the sections of its ends, and its length, m.
pub type Stretch = (Option<usize>, [Section; 2], f64);

/// The effort of every segment; where none is asked for, one that suits the steps at the ends of the piece of one section
/// that it belongs to.
pub fn efforts(segments: &[Stretch]) -> Vec<usize> {
    let mut list = Vec::with_capacity(segments.len());
    for piece in segments.chunk_by(|a, b| a.1[0] == a.1[1] && a.1 == b.1) {
        let (first, own) = (list.len(), &piece[0].1);
        let length = piece.iter().map(|s| s.2).sum();
        let neighbours = [first.checked_sub(1), Some(first + piece.len())];
        let suits =
            |(end, i): (usize, usize)| segments.get(i).map_or(0, |s| suits(&own[end], &s.1[1 - end], length));
        let beside = neighbours.into_iter().enumerate().filter_map(|(end, i)| Some((end, i?)));
        let automatic = beside.map(suits).max().unwrap_or(0);
        list.extend(piece.iter().map(|s| s.0.unwrap_or(automatic)));
    }
    list
}

/// Largest relative error of bending motions seen without kinks at steps of a height (difference of radii over the smaller
/// outer radius): up to 0.6 the random shafts of docs/theory/steps.md#effort, beyond them the shafts of docs/limits.md.
const WITHOUT_KINKS: [(f64, f64); 8] = [
    (0.0, 0.0),
    (0.15, 0.007),
    (0.3, 0.011),
    (0.4, 0.02),
    (0.6, 0.027),
    (1.0, 0.036),
    (3.0, 0.067),
    (9.0, 0.074),
];
/// The share of the error without kinks that each effort leaves on most of the same shafts, between median and upper quartile.
pub const SHARE_LEFT: [f64; FINEST + 1] = [1.0, 0.75, 0.36, 0.2, 0.14, 0.12, 0.1];
/// Relative error that an automatic effort aims at.
const AIM: f64 = 0.005;
/// Height above which a short piece is a disk that bends by itself.
const DISK_HEIGHT: f64 = 0.5;
/// Length of such a piece over its radius.
const DISK_LENGTH: f64 = 0.5;
/// Effort for it.
const DISK_EFFORT: usize = 5;

/// Error that a step of a height leaves at an effort.
fn error_left(height: f64, effort: usize) -> f64 {
    let k = WITHOUT_KINKS[1..].iter().position(|(at, _)| height <= *at).unwrap_or(WITHOUT_KINKS.len() - 2);
    let [(a, low), (b, high)] = [WITHOUT_KINKS[k], WITHOUT_KINKS[k + 1]];
    let share = ((height - a) / (b - a)).clamp(0.0, 1.0);
    SHARE_LEFT[effort.min(FINEST)] * (low + (high - low) * share)
}

/// The area that both sides of a step share; `None` where there is no step that kinks can follow.
fn shared(own: &Section, other: &Section) -> Option<Section> {
    let common = own.common(other).filter(|_| own.is_axisymmetric() && other.is_axisymmetric())?;
    (height(own, &common).max(height(other, &common)) > SMALLEST_STEP).then_some(common)
}

/// Height of a step: how far a section reaches beyond what it has in common with its neighbour, over the smaller outer
/// radius.
fn height(own: &Section, common: &Section) -> f64 {
    (own.outer[0] - common.outer[0]).max(common.inner[0] - own.inner[0]) / common.outer[0]
}

/// The effort that suits a step seen from one of its sides.
fn suits(own: &Section, other: &Section, length: f64) -> usize {
    let Some(common) = shared(own, other) else { return 0 };
    if height(own, &common) > DISK_HEIGHT && length < DISK_LENGTH * own.outer[0] {
        return DISK_EFFORT;
    }
    let height = height(own, &common).max(height(other, &common));
    (0..FINEST).find(|&effort| error_left(height, effort) <= AIM).unwrap_or(FINEST)
}

/// Largest error that the steps at the ends of a segment leave at the efforts of both sides; 0 without steps.
pub fn estimate(segments: &[Stretch], efforts: &[usize], i: usize) -> f64 {
    let of = |(end, j): (usize, Option<usize>)| {
        let (own, other) = (&segments[i].1[end], &segments.get(j?)?.1[1 - end]);
        let common = shared(own, other)?;
        Some(error_left(height(own, &common).max(height(other, &common)), efforts[i].min(efforts[j?])))
    };
    [i.checked_sub(1), Some(i + 1)].into_iter().enumerate().filter_map(of).fold(0.0, f64::max)
}

/// What a step asks of one of its sides; `None` where there is none, or none that kinks can follow.
fn zone(own: &Section, other: &Section, effort: usize) -> Option<Zone> {
    let common = shared(own, other)?;
    let (inner, outer) = (common.inner[0], common.outer[0]);
    let apart = |a: f64, b: f64| (a - b).abs() > SMALLEST_STEP * outer;
    let steps = [apart(own.outer[0], other.outer[0]), apart(own.inner[0], other.inner[0])];
    if effort == 0 {
        return None;
    }
    let effort = &EFFORTS[effort.min(FINEST)];
    let (mut at, mut beside) = (Vec::new(), Vec::new());
    let wall = (outer - inner) / 2.0;
    // what a side has alone counts by what is beyond; shared functions by what both sides know
    let outward = |radius: f64, degree| {
        let scale = if radius < outer { radius.min(SCALE * (outer - radius)) } else { own.outer[0] - radius };
        Kink { radius, scale, degree, inward: false }
    };
    let inward = |radius: f64, degree| Kink { radius, scale: radius - own.inner[0], degree, inward: true };
    if steps[0] {
        let beyond = (own.outer[0] - outer) / 2.0;
        if beyond > 0.0 {
            at.push(outward(outer, effort.at));
            beside.extend(effort.beside.iter().map(|&(s, d)| outward(outer + (s * outer).min(beyond), d)));
        }
        beside.extend(effort.beside.iter().map(|&(s, d)| outward(outer - (s * outer).min(wall), d)));
    }
    if steps[1] && own.is_hollow() {
        let beyond = (inner - own.inner[0]) / 2.0;
        if beyond > 0.0 {
            at.push(inward(inner, effort.at));
            beside.extend(effort.beside.iter().map(|&(s, d)| inward(inner - (s * inner).min(beyond), d)));
        }
        if other.is_hollow() {
            // beside the functions of a wall an outward kink does what an inward one does
            beside.extend(effort.beside.iter().map(|&(s, d)| outward(inner + (s * inner).min(wall), d)));
        }
    }
    if steps[1] && !own.is_hollow() {
        // a core cannot be cut out: it takes functions that the wall of the neighbour has, too
        at.push(outward(inner, effort.at.max(2)));
    }
    let beyond = own.outer[0] > outer || own.inner[0] < inner;
    let reach = REACH[usize::from(!beyond)] * own.outer[0];
    Some(Zone { length: reach, first: FIRST_ELEMENT * outer, at, beside })
}

/// Ends of the elements of a graded mesh within a segment, none at its own ends.
fn cuts(length: f64, longest: f64, zones: &[Option<Zone>; 2]) -> Vec<f64> {
    // up to where each side may put ends
    let share = |i: usize| match (&zones[i], &zones[1 - i]) {
        (None, _) => 0.0,
        (Some(_), None) => length,
        (Some(a), Some(b)) => length * a.first / (a.first + b.first),
    };
    let from_end = |i: usize| -> Vec<f64> {
        let Some(zone) = &zones[i] else { return Vec::new() };
        let (mut list, mut at, mut size) = (Vec::new(), 0.0, zone.first);
        let whole = meet(zones, length);
        while at < zone.length || size < longest {
            let next = at + size.min(longest.max(zone.first));
            // an end of the zone is one of an element, unless the next or the last one is close to it
            let ends = !whole && at < zone.length && next > zone.length - CLOSE_ENDS * size;
            at = if ends { zone.length } else { next };
            // both sides place the ends of their zones, and share what is left
            if (whole || at > zone.length) && at > share(i) - CLOSE_ENDS * size.min(longest) {
                break;
            }
            list.push(at);
            size *= GROWTH;
        }
        list
    };
    let mut list = from_end(0);
    list.extend(from_end(1).into_iter().rev().map(|x| length - x));
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graded(length: f64, own: f64, others: [Option<f64>; 2]) -> Vec<f64> {
        let zone = |other: Option<f64>| zone(&Section::circle(own), &Section::circle(other?), 3);
        let zones = others.map(zone);
        cuts(length, 2.0 * own, &zones)
    }

    fn close(a: &[f64], b: &[f64]) {
        let same = a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(same, "{a:?} {b:?}");
    }

    #[test]
    fn elements_grow_away_from_a_step_up_to_the_end_of_its_zone() {
        close(&graded(20.0, 1.0, [Some(2.0), None]), &[0.3, 1.8]);
        close(&graded(20.0, 5.0, [None, Some(1.0)]), &[16.0, 18.0, 19.5]);
        // both zones meet
        close(&graded(6.0, 5.0, [Some(1.0), Some(1.0)]), &[0.5, 2.0, 4.0, 5.5]);
        assert!(graded(6.0, 5.0, [None, None]).is_empty());
    }

    #[test]
    fn kinks_stand_at_the_common_radius_and_beside_it() {
        let [thin, thick, tube] = [Section::circle(1.0), Section::circle(2.0), Section::tube(1.0, 0.5)];
        let radii = |a, b, effort| -> Vec<(f64, usize, bool)> {
            let neighbour = Neighbour { section: b, effort };
            let steps = Steps::new([a, a], [Some(neighbour), None], 10.0, 1.0);
            steps.kinks(0.0, 0.1).iter().map(|k| (k.radius, k.degree, k.inward)).collect()
        };
        assert_eq!(radii(&thick, &thin, 2), [(1.0, 2, false)]);
        assert_eq!(radii(&thick, &thin, 3), [(0.9, 1, false), (1.0, 2, false), (1.1, 1, false)]);
        assert_eq!(radii(&thin, &thick, 3), [(0.9, 1, false)]);
        assert_eq!(radii(&thin, &tube, 1), [(0.5, 2, false)]);
        assert_eq!(radii(&Section::tube(1.0, 0.2), &tube, 1), [(0.5, 1, true)]);
        assert!(zone(&thick, &thin, 0).is_none() && zone(&thin, &thin, 3).is_none());
        assert!(zone(&thick, &Section::rectangle(1.0, 1.0), 3).is_none());
    }
}
