//! Forces of supports and bearings, and the force and moment that pass through the sections of a shaft.
//!
//! Both follow from equilibrium. A support exerts what its node lacks. Through the end of an element passes the sum of all
//! that acts beyond it (loads, weight, inertia with a minus sign, damping by space, bearings, rings, supports):
//!
//! ```text
//!     S(x) = sum over nodes beyond x of (outer + held) + what acts on the element itself and is felt at the node at x
//! ```
//!
//! The last part is the element's own: its mass, damping and surface loads. No stress enters, so that short elements cost no
//! digits. Forces of supports carry what rounding makes of stresses: a section with supports at larger x alone takes the negative
//! sum of what acts before it. Source: docs/theory/loads.md#section-forces.

use crate::analysis::probes::element_at;
use crate::model::{Element, Model, Probe, Resists, SupportKind};
use crate::results::{SectionForces, SupportForces};
use crate::shaft::acting::{Acting, Resultant};
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::{axis_rows, bearing_rows};
use crate::shaft::loads::Spread;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A sum over vectors: first coordinate and weight of each.
type Row = Vec<(usize, f64)>;

/// What a shaft needs to tell its forces.
pub struct ForceReader<'a> {
    assembly: &'a Assembly<'a>,
    spread: Spread,
    /// y and z of the displacement that each bearing feels.
    bearings: Vec<[Row; 2]>,
    /// The axis' point at every node.
    axis: Vec<Row>,
}

impl<'a> ForceReader<'a> {
    /// Prepares the shaft of an assembly.
    pub fn new(assembly: &'a Assembly<'a>) -> Self {
        let (model, numbering) = (assembly.model, &assembly.numbering);
        let axis = |node| {
            let [row, ..] = axis_rows(model, numbering, node);
            row
        };
        Self {
            assembly,
            spread: Spread::new(model, numbering),
            bearings: model.bearings.iter().map(|b| bearing_rows(model, numbering, b)).collect(),
            axis: (0..model.nodes.len()).map(axis).collect(),
        }
    }

    /// Forces and moments of kinematic supports and bearings on the shaft, `[x, y, z]` in fixed directions.
    pub fn supports(&self, acting: &Acting) -> SupportForces<[f64; 3]> {
        let model = self.assembly.model;
        let mut found = SupportForces::default();
        let nodes = self.held(acting);
        for support in &model.supports {
            let all =
                nodes.iter().find(|(node, _)| *node == support.node).map_or_else(Resultant::default, |n| n.1);
            let all = all.in_space(acting.axes);
            let ([x, y, z], force) = (all.moment.into(), all.force.into());
            // a drive beside a support takes the torque and nothing else
            let shared = model.supports.iter().filter(|s| s.node == support.node).count() > 1;
            let (force, moment) = match (shared, support.kind == SupportKind::Turned) {
                (false, _) => (force, [x, y, z]),
                (true, true) => ([0.0; 3], [x, 0.0, 0.0]),
                (true, false) => (force, [0.0, y, z]),
            };
            found.forces_n.insert(support.path.clone(), force);
            found.moments_n_m.insert(support.path.clone(), moment);
            found.at_m.insert(support.path.clone(), model.nodes[support.node].x);
        }
        for (bearing, rows) in model.bearings.iter().zip(&self.bearings) {
            let across = bearing.is_across();
            let felt = |list: &[f64]| -> [f64; 2] {
                let values = [0, 1].map(|i| rows[i].iter().map(|&(at, w)| w * list[at]).sum::<f64>());
                if !across {
                    return values;
                }
                let [_, y, z] = acting.axes.in_space([0.0, values[0], values[1]]);
                [y, z]
            };
            let (mut u, v) = (felt(&acting.position), felt(&acting.velocity));
            (0..2).for_each(|c| u[c] -= acting.load * bearing.offset[c]);
            let (k, c) = (&bearing.stiffness, &bearing.damping);
            let [first, second] =
                [0, 1].map(|i| (0..2).map(|j| k[i][j] * u[j] + c[i][j] * v[j]).fold(0.0, |sum, f| sum - f));
            let (list, vector) = match bearing.resists {
                Resists::Lateral => (&mut found.forces_n, [0.0, first, second]),
                Resists::Axial => (&mut found.forces_n, [first, 0.0, 0.0]),
                Resists::Tilt => (&mut found.moments_n_m, [0.0, first, second]),
                Resists::Torsion => (&mut found.moments_n_m, [first, 0.0, 0.0]),
            };
            match list.get_mut(&bearing.path) {
                Some(sum) => (0..3).for_each(|c| sum[c] += vector[c]),
                None => drop(list.insert(bearing.path.clone(), vector)),
            }
            found.at_m.insert(bearing.path.clone(), model.nodes[bearing.node].x);
        }
        found
    }

    /// Force and moment about the axis' point at every node that supports hold, from left to right, in the axes of the frame: what
    /// they can exert; the rest is what a solution leaves out of balance. The only node that holds rotation takes the torque that
    /// the whole shaft lacks: between the steps of an integrator stresses at one node are far less exact than inertia.
    fn held(&self, acting: &Acting) -> Vec<(usize, Resultant)> {
        let mut nodes: BTreeMap<usize, Holds> = BTreeMap::new();
        for support in &self.assembly.model.supports {
            let (all, one) = (nodes.entry(support.node).or_default(), holds(&support.kind));
            all.along |= one.along;
            all.across |= one.across;
            all.torque |= one.torque;
            all.tilt |= one.tilt;
        }
        let one = |(&node, holds): (&usize, &Holds)| {
            let all = self.at_node(node, acting, &acting.held).about(self.centre(node, acting));
            let told = |v: Vector3<f64>, along: bool, across: bool| {
                let [x, y, z] = v.into();
                let (x, [y, z]) = (if along { x } else { 0.0 }, if across { [y, z] } else { [0.0; 2] });
                Vector3::new(x, y, z)
            };
            let force = told(all.force, holds.along, holds.across);
            (node, Resultant { force, moment: told(all.moment, holds.torque, holds.tilt) })
        };
        let mut list: Vec<(usize, Resultant)> = nodes.iter().map(one).collect();
        let holders: Vec<usize> = (0..list.len()).filter(|i| nodes[&list[*i].0].torque).collect();
        if let [only] = holders[..] {
            let all = 0..self.assembly.model.nodes.len();
            let whole: f64 = all.map(|node| self.at_node(node, acting, &acting.held).moment.x).sum();
            let levers = list.iter().map(|(node, held)| self.centre(*node, acting).cross(&held.force).x);
            list[only].1.moment.x = whole - levers.sum::<f64>();
        }
        list
    }

    /// What passes through the left and the right end of every element, just inside, in fixed directions; moments are about
    /// the axis' point.
    fn cuts(&self, acting: &Acting) -> Vec<[Resultant; 2]> {
        let model = self.assembly.model;
        let held = self.held(acting);
        // what acts from each node on
        let mut beyond = vec![Resultant::default(); model.nodes.len() + 1];
        for node in (0..model.nodes.len()).rev() {
            beyond[node] = beyond[node + 1] + self.at_node(node, acting, &acting.outer);
            if let Some((_, held)) = held.iter().find(|(other, _)| *other == node) {
                beyond[node] += held.about(-self.centre(node, acting));
            }
        }
        let first = held.first().map_or(0, |(node, _)| *node);
        let mut work = vec![0.0; acting.position.len()];
        let one = |(index, e): (usize, &Element)| {
            let (left, right) = (e.first_node, e.first_node + e.kind.axial_degree);
            let [at_left, at_right] = self.of_element(index, acting, &mut work);
            // all that acts is zero but for rounding
            let all = if right <= first { beyond[0] } else { Resultant::default() };
            [(left, beyond[left + 1] + at_left - all), (right, beyond[right] - at_right - all)]
                .map(|(node, cut)| cut.about(self.centre(node, acting)).in_space(acting.axes))
        };
        model.elements.iter().enumerate().map(one).collect()
    }

    /// What passes through the sections of the shaft.
    pub fn sections(&self, acting: &Acting) -> SectionForces {
        let mut found = SectionForces::default();
        for (e, ends) in self.assembly.model.elements.iter().zip(self.cuts(acting)) {
            for (x, Resultant { force, moment }) in [e.x, e.x + e.length].into_iter().zip(ends) {
                found.x_m.push(x);
                found.axial_force_n.push(force.x);
                found.shear_y_n.push(force.y);
                found.shear_z_n.push(force.z);
                found.torque_n_m.push(moment.x);
                found.moment_y_n_m.push(moment.y);
                found.moment_z_n_m.push(moment.z);
            }
        }
        found
    }

    /// Torque (N m) and shear `[y, z]` (N) at [`probe_section`] of every probe.
    pub fn at_probes(&self, acting: &Acting) -> Vec<(f64, [f64; 2])> {
        let model = self.assembly.model;
        if model.probes.is_empty() {
            return Vec::new();
        }
        let cuts = self.cuts(acting);
        let one = |probe: &Probe| {
            let (element, end, _) = probe_section(model, probe);
            let Resultant { force, moment } = cuts[element][end];
            (moment.x, [force.y, force.z])
        };
        model.probes.iter().map(one).collect()
    }

    fn centre(&self, node: usize, acting: &Acting) -> Vector3<f64> {
        self.axis[node].iter().map(|&(at, w)| vector(&acting.position, at) * w).sum()
    }

    /// Resultant of forces on a node.
    fn at_node(&self, node: usize, acting: &Acting, force: &[f64]) -> Resultant {
        let mut sum = Resultant::default();
        let numbering = &self.assembly.numbering;
        for at in numbering.of_node(node).step_by(3) {
            let moves = numbering.fields(node).any(|first| first == at);
            sum.take(vector(&acting.position, at), vector(force, at), moves);
        }
        sum
    }

    /// Resultants at both end nodes of an element of what acts on the element itself; `work` holds zeros, before and after.
    fn of_element(&self, index: usize, acting: &Acting, work: &mut [f64]) -> [Resultant; 2] {
        let (model, numbering) = (self.assembly.model, &self.assembly.numbering);
        let e = &model.elements[index];
        let mass = &self.assembly.element_matrices(index).mass;
        let damping = model.materials[e.material].mass_damping;
        let gravity = Vector3::from(acting.axes.seen(model.gravity)) * acting.load;
        let vectors = e.n_vectors();
        let starts: Vec<usize> = (0..e.kind.n_nodes()).map(|i| numbering.of_element(e, i)).collect();
        let places = || starts.iter().flat_map(|start| (0..vectors).map(move |k| (start + 3 * k, k == 0)));
        let felt: Vec<Vector3<f64>> = places()
            .map(|(at, moves)| {
                let weight = if moves { gravity } else { Vector3::zeros() };
                weight - vector(&acting.acceleration, at) - vector(&acting.velocity, at) * damping
            })
            .collect();
        self.spread.add(index, &acting.position, acting.axes, acting.load, work);
        let ends = [0, starts.len() - 1].map(|end| {
            let mut sum = Resultant::default();
            for k in 0..vectors {
                let (row, at) = (3 * (end * vectors + k), starts[end] + 3 * k);
                let mut force = vector(work, at);
                felt.iter().enumerate().for_each(|(j, a)| force += a * mass[(row, 3 * j)]);
                sum.take(vector(&acting.position, at), force, k == 0);
            }
            sum
        });
        places().for_each(|(at, _)| work[at..at + 3].fill(0.0));
        ends
    }
}

/// The end of the element in which a probe stands that is nearer to it: index of the element, 0 for its left and 1 for its
/// right end, and the place, m. It is just inside the element.
pub fn probe_section(model: &Model, probe: &Probe) -> (usize, usize, f64) {
    let e = element_at(model, probe.x);
    let index = model.elements.iter().position(|other| std::ptr::eq(other, e)).unwrap_or(0);
    let end = usize::from(probe.x - e.x > e.length / 2.0);
    (index, end, e.x + end as f64 * e.length)
}

/// What a support can exert on its section.
#[derive(Default)]
struct Holds {
    /// A force along x.
    along: bool,
    /// A force across it.
    across: bool,
    /// A moment about x.
    torque: bool,
    /// A moment across it.
    tilt: bool,
}

fn holds(kind: &SupportKind) -> Holds {
    let of = |along, across, torque, tilt| Holds { along, across, torque, tilt };
    match kind {
        SupportKind::Clamped(_) => of(true, true, true, true),
        SupportKind::Revolute { driven, .. } => of(true, true, *driven, true),
        SupportKind::Cylindrical { driven, .. } => of(false, true, *driven, true),
        SupportKind::Pinned(_) => of(true, true, false, false),
        SupportKind::Roller(_) => of(false, true, false, false),
        SupportKind::Turned => of(false, false, true, false),
        SupportKind::Fix(components) => {
            let any = |of: &dyn Fn(usize, usize) -> bool| components.iter().any(|&(vector, c)| of(vector, c));
            of(
                any(&|vector, c| vector == 0 && c == 0),
                any(&|vector, c| vector == 0 && c > 0),
                any(&|vector, c| vector > 0 && c > 0),
                any(&|vector, c| vector > 0 && c == 0),
            )
        }
    }
}

fn vector(list: &[f64], at: usize) -> Vector3<f64> {
    Vector3::new(list[at], list[at + 1], list[at + 2])
}
