//! Elements and nodes along the shaft: segments laid end to end, cut where something stands.

use crate::check::steps::{Neighbour, Steps, most};
use crate::model::{Carried, Element, ElementKind, Field, Node};
use crate::section::Section;
use crate::section::kinks::Kinks;

/// Share of the shaft's length within which two positions are one: a place so near to the end of a segment or to another
/// place was written with fewer digits.
const SAME_PLACE_PER_LENGTH: f64 = 1e-7;

/// Share of the shaft's length that a segment needs for ends of its own.
pub const SHORTEST_SEGMENT_PER_LENGTH: f64 = 1e-8;

/// A checked segment.
#[derive(Debug, Clone, Copy)]
pub struct SegmentPlan {
    /// Length of the segment, m.
    pub length: f64,
    /// Elements asked for.
    pub elements: u64,
    /// Member of the element family.
    pub kind: ElementKind,
    /// Effort at steps, 0 for none.
    pub effort: usize,
    /// Index of its section.
    pub section: usize,
    /// Index of the section at its right end; that of a taper is another one.
    pub to_section: usize,
    /// Index of its material.
    pub material: usize,
    /// Added mass and initial stress.
    pub carried: Carried,
    /// Joined to the segment before by a thin face.
    pub face: bool,
}

impl SegmentPlan {
    /// Sections of the left and the right end.
    fn faces<'a>(&self, sections: &'a [Section]) -> [&'a Section; 2] {
        [&sections[self.section], &sections[self.to_section]]
    }

    fn is_tapered(&self) -> bool {
        self.section != self.to_section
    }
}

/// Elements and nodes from left to right.
#[derive(Debug)]
pub struct Mesh {
    /// Elements from x = 0 on.
    pub elements: Vec<Element>,
    /// Nodes from x = 0 on.
    pub nodes: Vec<Node>,
    /// The sections of the segments, and those between them along tapers.
    pub sections: Vec<Section>,
    /// For every section along a taper those of the ends of its segment.
    pub between: Vec<[usize; 2]>,
}

impl Mesh {
    /// Meshes the segments so that every one of `positions` is an element end.
    ///
    /// Steps at the places `plain` take no kinks. At the places `coupled` nothing but a coupling joins both sides. Within a segment the elements are dealt out to the pieces between
    /// positions, each time to the piece whose elements are longest, at least one to each: lengths as even as possible,
    /// never fewer elements.
    pub fn new(
        plans: &[SegmentPlan],
        sections: &[Section],
        (positions, plain, coupled): (&[f64], &[f64], &[f64]),
        length: f64,
    ) -> Self {
        let mut mesh = Self {
            elements: Vec::new(),
            nodes: Vec::new(),
            sections: sections.to_vec(),
            between: Vec::new(),
        };
        let mut start = 0.0;
        for (segment, plan) in plans.iter().enumerate() {
            if let Some(node) = mesh.nodes.last_mut() {
                node.face = plan.face;
            }
            let (steps, before) = steps(plans, sections, segment, plain, start);
            let graded = steps.cuts.iter().map(|x| start + x - before);
            let end = start + plan.length;
            let same = (SAME_PLACE_PER_LENGTH * length).min(plan.length / 4.0);
            let mut cuts: Vec<f64> =
                positions.iter().copied().filter(|x| *x > start + same && *x < end - same).collect();
            cuts.extend([start, end]);
            let graded: Vec<f64> = graded.filter(|x| *x > start + same && *x < end - same).collect();
            cuts.extend(&graded);
            cuts.sort_by(f64::total_cmp);
            cuts.dedup_by(|a, b| *a - *b <= same);
            let pieces: Vec<(f64, f64)> = cuts.windows(2).map(|c| (c[0], c[1])).collect();
            let mut left = plan.section;
            for (&(a, b), count) in pieces.iter().zip(share(&pieces, plan.elements + graded.len() as u64)) {
                let kinks = steps.kinks(a - start + before, b - start + before);
                for k in 0..count {
                    let at = |k: u64| a + (b - a) * k as f64 / count as f64;
                    let length = (b - a) / count as f64;
                    let last = b == end && k + 1 == count;
                    let part = |x: f64| (x - start) / plan.length;
                    let right = if last { plan.to_section } else { mesh.along(plan, part(at(k) + length)) };
                    let section = mesh.along(plan, part(at(k) + length / 2.0));
                    let kinks = if plan.is_tapered() {
                        kinks.within([left, right].map(|face| &mesh.sections[face]))
                    } else {
                        kinks
                    };
                    if let Some(node) = mesh.nodes.last_mut() {
                        node.coupled = coupled.iter().any(|x| (x - at(k)).abs() <= same);
                    }
                    mesh.push((plan, kinks), ([left, right], section), at(k), length);
                    left = right;
                }
            }
            start = end;
        }
        mesh
    }

    /// Index of the section at a part (0 to 1) of a segment, which a taper adds to the list.
    fn along(&mut self, plan: &SegmentPlan, part: f64) -> usize {
        if !plan.is_tapered() {
            return plan.section;
        }
        let [left, right] = plan.faces(&self.sections);
        let section = left.between(right, part);
        self.sections.push(section);
        self.between.push([plan.section, plan.to_section]);
        self.sections.len() - 1
    }

    fn push(
        &mut self,
        (plan, kinks): (&SegmentPlan, Kinks),
        (faces, section): ([usize; 2], usize),
        x: f64,
        length: f64,
    ) {
        let (kind, material, sections) = (plan.kind, plan.material, &self.sections);
        let field = Field { basis: kind.basis, kinks, section };
        let mut follows = [false; 2];
        match (self.nodes.last_mut(), self.elements.last_mut()) {
            (Some(shared), Some(_)) if shared.coupled => {
                follows[0] = true;
                shared.follower = Some(field);
            }
            (Some(shared), Some(left)) if !same_functions(shared.field, field, sections) => {
                follows[0] = leads(shared.field, field, sections);
                left.follows[1] = !follows[0];
                shared.follower = Some(field);
                if left.follows[1] {
                    (shared.field, shared.follower) = (field, Some(shared.field));
                }
            }
            (Some(_), _) => {}
            (None, _) => self.nodes.push(Node { x, field, follower: None, face: false, coupled: false }),
        }
        let first_node = self.nodes.len() - 1;
        for i in 1..=kind.axial_degree {
            let x = x + length * i as f64 / kind.axial_degree as f64;
            self.nodes.push(Node { x, field, follower: None, face: false, coupled: false });
        }
        self.elements.push(Element {
            x,
            length,
            first_node,
            kind,
            kinks,
            section,
            faces,
            material,
            carried: plan.carried,
            follows,
        });
    }

    /// The element end nearest to a position (which was among those given to [`Mesh::new`]).
    pub fn node_at(&self, x: f64) -> usize {
        let ends = self.elements.iter().flat_map(|e| [e.first_node, e.first_node + e.kind.axial_degree]);
        ends.min_by(|&a, &b| (self.nodes[a].x - x).abs().total_cmp(&(self.nodes[b].x - x).abs())).unwrap_or(0)
    }

    /// Sections of the elements that meet at an element end, there.
    pub fn sections_at(&self, node: usize) -> impl Iterator<Item = usize> {
        self.elements.iter().filter_map(move |e| e.face_at(node))
    }

    /// The element that holds a position.
    pub fn element_at(&self, x: f64) -> Option<&Element> {
        self.elements.iter().find(|e| x <= e.x + e.length).or(self.elements.last())
    }
}

/// What steps ask of a segment: those at the ends of the piece of one section that it belongs to, and where it starts in that
/// piece, m.
fn steps(
    plans: &[SegmentPlan],
    sections: &[Section],
    segment: usize,
    plain: &[f64],
    from: f64,
) -> (Steps, f64) {
    let plan = &plans[segment];
    if plan.effort == 0 {
        return (Steps::default(), 0.0);
    }
    let same = |p: &&SegmentPlan| {
        !p.is_tapered() && !plan.is_tapered() && sections[p.section] == sections[plan.section]
    };
    let before: Vec<&SegmentPlan> = plans[..segment].iter().rev().take_while(same).collect();
    let after: Vec<&SegmentPlan> = plans[segment + 1..].iter().take_while(same).collect();
    let neighbour = |i: Option<usize>, face: usize| {
        let other = plans.get(i?)?;
        // both sides of a step take the same kinks
        let effort = if other.effort == 0 { plan.effort } else { plan.effort.max(other.effort) };
        let effort = effort.min(most(plan.kind.basis)).min(most(other.kind.basis));
        Some(Neighbour { section: other.faces(sections)[face], effort })
    };
    let start: f64 = before.iter().map(|p| p.length).sum();
    let length = start + plan.length + after.iter().map(|p| p.length).sum::<f64>();
    let faces = [from - start, from - start + length];
    let same_place = |a: f64, b: f64| (a - b).abs() <= SAME_PLACE_PER_LENGTH * plan.length;
    let kinked = |face: &f64| !plain.iter().any(|x| same_place(*x, *face));
    let beside = [segment.checked_sub(before.len() + 1), Some(segment + after.len() + 1)];
    let neighbours = [0, 1].map(|i| neighbour(beside[i].filter(|_| kinked(&faces[i])), 1 - i));
    let longest = plan.length / plan.elements as f64;
    (Steps::new(plan.faces(sections), neighbours, length, longest), start)
}

/// True when the vectors of two sides multiply the same functions.
fn same_functions(a: Field, b: Field, sections: &[Section]) -> bool {
    same_member(a, b, sections) && a.kinks == b.kinks
}

/// True when the members of two sides have the same functions.
fn same_member(a: Field, b: Field, sections: &[Section]) -> bool {
    a.basis == b.basis && (!a.basis.is_ring() || sections[a.section] == sections[b.section])
}

/// True when b, not a, has to follow at a joint: the side whose member has more vectors follows, and among equals the one
/// with less area, all or most of which is shared; of equal members the one with more kinked functions.
fn leads(a: Field, b: Field, sections: &[Section]) -> bool {
    if same_member(a, b, sections) {
        return a.kinks.count() <= b.kinks.count();
    }
    let area = |f: Field| sections[f.section].area();
    (a.basis.count(), -area(a)) <= (b.basis.count(), -area(b))
}

/// Elements for each piece.
fn share(pieces: &[(f64, f64)], elements: u64) -> Vec<u64> {
    let total: f64 = pieces.iter().map(|p| p.1 - p.0).sum();
    // Whole shares first (never more than deserved), then one by one to the longest elements.
    let mut counts: Vec<u64> = pieces
        .iter()
        .map(|p| (((p.1 - p.0) / total * elements as f64 * (1.0 - 1e-12)).floor() as u64).max(1))
        .collect();
    while counts.iter().sum::<u64>() < elements {
        let size = |i: usize| (pieces[i].1 - pieces[i].0) / counts[i] as f64;
        let longest =
            (0..pieces.len()).fold(0, |best, i| if size(i) > size(best) * (1.0 + 1e-9) { i } else { best });
        counts[longest] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Law;
    use crate::section::basis::SectionBasis;

    fn plan(length: f64, elements: u64, order: usize) -> SegmentPlan {
        let kind =
            ElementKind { axial_degree: 3, basis: SectionBasis::Monomials(order), law: Law::Continuum };
        SegmentPlan {
            length,
            elements,
            kind,
            effort: 0,
            section: 0,
            to_section: 0,
            material: 0,
            carried: Carried::default(),
            face: false,
        }
    }

    fn ends(mesh: &Mesh) -> Vec<f64> {
        mesh.elements.iter().map(|e| e.x).collect()
    }

    #[test]
    fn a_matching_mesh_stays_as_it_is() {
        let mesh = Mesh::new(&[plan(6.0, 16, 3)], &[], (&[3.0, 0.0, 6.0], &[], &[]), 6.0);
        assert_eq!(ends(&mesh), ends(&Mesh::new(&[plan(6.0, 16, 3)], &[], (&[], &[], &[]), 6.0)));
        assert_eq!((mesh.nodes.len(), mesh.node_at(3.0)), (49, 24));
    }

    #[test]
    fn positions_force_ends_and_keep_lengths_even() {
        let mesh = Mesh::new(&[plan(1.0, 4, 3)], &[], (&[0.9], &[], &[]), 1.0);
        assert_eq!(mesh.elements.len(), 4);
        assert!(mesh.elements.iter().any(|e| (e.x - 0.9).abs() < 1e-15));
        let few = Mesh::new(&[plan(1.0, 1, 3)], &[], (&[0.2, 0.4, 0.4 + 1e-8], &[], &[]), 1.0);
        assert_eq!(few.elements.len(), 3);
    }

    #[test]
    fn the_richer_side_follows_at_a_joint() {
        let mesh =
            Mesh::new(&[plan(1.0, 1, 1), plan(1.0, 2, 4)], &[Section::circle(0.1)], (&[], &[], &[]), 2.0);
        let vectors: Vec<usize> = mesh.nodes.iter().map(Node::n_vectors).collect();
        assert_eq!(vectors, [3, 3, 3, 3, 15, 15, 15, 15, 15, 15]);
        let follows: Vec<[bool; 2]> = mesh.elements.iter().map(|e| e.follows).collect();
        assert_eq!(follows, [[false, false], [true, false], [false, false]]);
    }
}
