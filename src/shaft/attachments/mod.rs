//! Supports, bearings and disks: linear constraints and constant matrices at the nodes.
//!
//! A node of order n carries (n+1)(n+2)/2 vectors, so "clamped" or "on the section" needs a meaning;
//! docs/theory/supports.md#kinds states it. Coordinates are scaled: `q = R^(a+b) r_,(y^a z^b)`.

mod bearings;
mod hub;

use crate::element::boundary_curve::{LinePoint, line};
use crate::element::fields::SectionFunctions;
use crate::model::{ActsOn, Disk, Element, Field, Hub, Model, Node, SectionHold, SupportKind, Unbalance};
use crate::section::Section;
use faer::Mat;

pub use bearings::*;
pub use hub::Hubs;

/// A matrix on some coordinates of the shaft (indices before constraints).
pub struct Contribution {
    /// Coordinates, one for each row and column.
    pub coordinates: Vec<usize>,
    /// The matrix on these coordinates, square, in their order.
    pub matrix: Mat<f64>,
}

/// Coordinates before constraints: `offset(node) + 3 vector + component`. The vectors of a neighbour that follows
/// come after the node's own, and after both the normals of disks that are thicker than thin and the displacements of housings.
pub struct Numbering {
    offsets: Vec<usize>,
    /// First coordinate of the vectors that follow; that of the normals where none do.
    followers: Vec<usize>,
    /// First coordinate of the normals, or the end of the node.
    normals: Vec<usize>,
    /// First coordinate of the displacements of housings, or the end of the node.
    housings: Vec<usize>,
    /// First coordinate of the normal of each disk that has one.
    of_disk: Vec<Option<usize>>,
    /// First coordinate of the displacement of each housing.
    of_housing: Vec<usize>,
}

impl Numbering {
    /// Numbers the nodes from left to right.
    pub fn new(model: &Model) -> Self {
        let (mut offsets, mut followers, mut normals) = (vec![0], Vec::new(), Vec::new());
        let mut of_disk = vec![None; model.disks.len()];
        let mut housings = Vec::new();
        let mut of_housing = vec![0; model.housings.len()];
        for (i, node) in model.nodes.iter().enumerate() {
            followers.push(offsets[i] + 3 * node.n_vectors());
            normals.push(followers[i] + 3 * node.follower.map_or(0, |f| f.count()));
            let mut end = normals[i];
            for (disk, place) in model.disks.iter().zip(&mut of_disk) {
                if disk.node == i && disk.thickness_inertia() > 0.0 {
                    *place = Some(end);
                    end += 3;
                }
            }
            housings.push(end);
            for (_, place) in model.housings.iter().zip(&mut of_housing).filter(|(h, _)| h.node == i) {
                *place = end;
                end += 3;
            }
            offsets.push(end);
        }
        Self { offsets, followers, normals, housings, of_disk, of_housing }
    }

    /// First coordinate of every set of section vectors at a node: its own, and those that follow.
    pub fn fields(&self, node: usize) -> impl Iterator<Item = usize> {
        let (own, follower, end) = (self.offsets[node], self.followers[node], self.normals[node]);
        std::iter::once(own).chain((follower < end).then_some(follower))
    }

    /// First coordinate of the normal of a disk, `R n`; `None` for a disk without inertia of thickness.
    pub fn normal(&self, disk: usize) -> Option<usize> {
        self.of_disk[disk]
    }

    /// The coordinates of all normals at a node.
    pub fn normals(&self, node: usize) -> std::ops::Range<usize> {
        self.normals[node]..self.housings[node]
    }

    /// The coordinates of all housings that stand at a node.
    pub fn housings(&self, node: usize) -> std::ops::Range<usize> {
        self.housings[node]..self.offsets[node + 1]
    }

    /// First coordinate of the displacement of each housing, with its node.
    pub fn all_housings<'m>(&'m self, model: &'m Model) -> impl Iterator<Item = (usize, usize)> + 'm {
        model.housings.iter().zip(&self.of_housing).map(|(h, &at)| (h.node, at))
    }

    /// First coordinates of all normals.
    pub fn all_normals(&self) -> impl Iterator<Item = usize> {
        self.of_disk.iter().flatten().copied()
    }

    /// First coordinate of the vectors of an element at its i-th node.
    pub fn of_element(&self, element: &Element, i: usize) -> usize {
        let node = element.first_node + i;
        let end = if i == 0 { 0 } else { 1 };
        let at_end = i == 0 || i == element.kind.axial_degree;
        if at_end && element.follows[end] { self.followers[node] } else { self.offsets[node] }
    }

    /// Index of a component (0, 1, 2) of a vector of a node.
    pub fn index(&self, node: usize, vector: usize, component: usize) -> usize {
        self.offsets[node] + 3 * vector + component
    }

    /// First coordinate of the node that a coordinate belongs to.
    fn start_of(&self, coordinate: usize) -> usize {
        self.offsets[self.offsets.partition_point(|&o| o <= coordinate) - 1]
    }

    /// Number of coordinates of the whole shaft before constraints.
    pub fn len(&self) -> usize {
        self.offsets[self.offsets.len() - 1]
    }

    /// True for a shaft without nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Coordinates of one node.
    pub fn of_node(&self, node: usize) -> std::ops::Range<usize> {
        self.offsets[node]..self.offsets[node + 1]
    }
}

/// The section a support or bearing takes hold of: common to both sides of a step.
pub fn section_at(model: &Model, node: usize) -> Option<Section> {
    let mut sections = model.elements.iter().filter_map(|e| e.face_at(node)).map(|face| model.sections[face]);
    let first = sections.next()?;
    Some(sections.fold(first, |a, b| a.common(&b).unwrap_or(a)))
}

/// The functions of a field of the model.
pub fn functions(model: &Model, field: Field) -> SectionFunctions {
    SectionFunctions::new(field.basis, &model.sections[field.section], model.reference_length)
        .with_kinks(field.kinks)
}

/// The functions that a node's own vectors multiply.
pub fn functions_at(model: &Model, node: usize) -> SectionFunctions {
    functions(model, model.nodes[node].field)
}

/// Rows that hold what a node's own kinked functions would do on the area of a neighbour that lacks them.
pub fn unmatched_kinks(model: &Model, node: usize) -> Vec<Vec<f64>> {
    let Node { field, follower: Some(follower), coupled: false, .. } = model.nodes[node] else {
        return Vec::new();
    };
    let Some(shared) = section_at(model, node).filter(|_| !field.kinks.is_empty()) else { return Vec::new() };
    let own = functions(model, field);
    let (free, followed) = (own.free_on(&shared), own.followed_by(&functions(model, follower), &shared));
    let unmatched = (0..field.count()).filter(|&k| !free[k] && !followed[k]);
    let unit = |at: usize| (0..3 * field.count()).map(|i| f64::from(i == at)).collect();
    unmatched.flat_map(|k| (0..3).map(move |c| 3 * k + c)).map(unit).collect()
}

/// Rows that keep a section plane and undistorted where a thin face joins two segments: all vectors but r, r_,y and r_,z are
/// zero. Source: docs/theory/steps.md#face.
pub fn face_rows(model: &Model, node: usize) -> Vec<Vec<f64>> {
    let Node { field, face: true, .. } = model.nodes[node] else { return Vec::new() };
    let n = 3 * field.count();
    (9..n).map(|at| (0..n).map(|i| f64::from(i == at)).collect()).collect()
}

/// Coordinates, counted from the first of a node, of followers that are free: all of them beyond a coupling, kinked functions at a step.
pub fn free_followers(model: &Model, node: usize) -> Vec<usize> {
    let Node { field, follower: Some(follower), coupled: true, .. } = model.nodes[node] else {
        return free_kinks(model, node);
    };
    (3 * field.count()..3 * (field.count() + follower.count())).collect()
}

/// Coordinates, counted from the first of a node, of kinked functions of the neighbour that follows and that vanish on the
/// area both sides share: they are free at the face of the step.
fn free_kinks(model: &Model, node: usize) -> Vec<usize> {
    let Node { field, follower: Some(follower), .. } = model.nodes[node] else { return Vec::new() };
    let Some(shared) = section_at(model, node).filter(|_| !follower.kinks.is_empty()) else {
        return Vec::new();
    };
    // a rigid hub or a face holds the section as a whole
    if model.nodes[node].face || model.disks.iter().any(|d| d.node == node && d.hub == Hub::Rigid) {
        return Vec::new();
    }
    let free = functions(model, follower).free_on(&shared);
    let vectors = (0..free.len()).filter(|&k| free[k]);
    vectors.flat_map(|k| (0..3).map(move |c| 3 * (field.count() + k) + c)).collect()
}

/// True when a support at the node turns its section with the drive: driven ends and sections, and fixed components.
pub fn drives(model: &Model, node: usize) -> bool {
    model.supports.iter().filter(|s| s.node == node).any(|s| {
        matches!(
            s.kind,
            SupportKind::Revolute { driven: true, .. }
                | SupportKind::Cylindrical { driven: true, .. }
                | SupportKind::Turned
                | SupportKind::Fix(_)
        )
    })
}

/// What a support or load takes hold of at a node: an area or a line of its section, whose means count.
pub struct Region {
    functions: SectionFunctions,
    section: Section,
    line: Option<Vec<LinePoint>>,
}

impl Region {
    /// The section common to both sides of the node, or a boundary of it; `None` for the axis.
    pub fn new(model: &Model, node: usize, acts_on: ActsOn) -> Option<Self> {
        Self::of(functions_at(model, node), section_at(model, node)?, acts_on)
    }

    /// The whole section of a field, or a boundary of it; `None` for the axis.
    pub fn of_field(model: &Model, field: Field, acts_on: ActsOn) -> Option<Self> {
        Self::of(functions(model, field), model.sections[field.section], acts_on)
    }

    fn of(functions: SectionFunctions, section: Section, acts_on: ActsOn) -> Option<Self> {
        let line = match (acts_on, acts_on.surface()) {
            (ActsOn::Axis, _) => return None,
            (_, None) => None,
            (_, Some(surface)) => Some(line(&section, surface)),
        };
        Some(Self { functions, section, line })
    }

    /// Mean value of every function.
    pub fn means(&self) -> Vec<f64> {
        if self.line.is_none() {
            return self.functions.means(&self.section);
        }
        let sums = self.integrals(0, 0);
        // the first function is 1
        sums.iter().map(|s| s / sums[0]).collect()
    }

    /// `int f_k y^a z^b`, by area (m^(2+a+b)) or length (m^(1+a+b)), a and b 0 or 1.
    pub fn integrals(&self, a: usize, b: usize) -> Vec<f64> {
        self.integrals_per(a, b, [1.0, 1.0])
    }

    /// [`Self::integrals`] divided by two numbers.
    fn integrals_per(&self, a: usize, b: usize, per: [f64; 2]) -> Vec<f64> {
        let Some(line) = &self.line else { return self.functions.integrals_per(&self.section, a, b, per) };
        let weight = |p: &LinePoint| p.length * p.y.powi(a as i32) * p.z.powi(b as i32);
        let sums = self.functions.along(line, [a % 2 == 1, b % 2 == 1], weight);
        sums.into_iter().map(|s| s / (per[0] * per[1])).collect()
    }

    /// `int y^a z^b`, by area or length.
    pub fn moment(&self, a: usize, b: usize) -> f64 {
        let of = |p: &LinePoint| p.length * p.y.powi(a as i32) * p.z.powi(b as i32);
        self.line.as_ref().map_or_else(|| self.section.moment(a, b), |line| line.iter().map(of).sum())
    }

    /// Rows of the mean affine motion in the measure of the first three vectors: `int f_k`, `R int y f_k / int y^2` and
    /// `R int z f_k / int z^2`, the first over the size. What they give of `r + y r_,y + z r_,z` is r, R r_,y and R r_,z.
    pub fn affine(&self, reference_length: f64) -> [Vec<f64>; 3] {
        let slope = |a: usize, b: usize| {
            let per = self.moment(2 * a, 2 * b) / reference_length;
            self.integrals_per(a, b, [per, 1.0])
        };
        [self.means(), slope(1, 0), slope(0, 1)]
    }
}

/// Weights `w_k` of the mean displacement `sum_k w_k q_k` of what is taken hold of.
pub fn displacement_weights(model: &Model, node: usize, acts_on: ActsOn) -> Vec<f64> {
    let axis = || (0..model.nodes[node].n_vectors()).map(|k| f64::from(k == 0)).collect();
    Region::new(model, node, acts_on).map_or_else(axis, |region| region.means())
}

/// For each vector of a node whether a support grips it: all but kinked functions that vanish on the area both sides of a step
/// share.
fn gripped(model: &Model, node: usize) -> Vec<bool> {
    let Node { field, follower, .. } = model.nodes[node];
    match section_at(model, node).filter(|_| follower.is_some()) {
        Some(shared) => functions(model, field).free_on(&shared).into_iter().map(|free| !free).collect(),
        None => vec![true; field.count()],
    }
}

/// Constraint rows `sum c_i q_i = 0` over the coordinates of one node.
pub fn constraint_rows(model: &Model, node: usize) -> Vec<Vec<f64>> {
    let n_vectors = model.nodes[node].n_vectors();
    let unit = |vector: usize, component: usize| {
        let mut row = vec![0.0; 3 * n_vectors];
        row[3 * vector + component] = 1.0;
        row
    };
    let mean = |component: usize, acts_on: ActsOn| {
        let mut row = vec![0.0; 3 * n_vectors];
        for (k, w) in displacement_weights(model, node, acts_on).into_iter().enumerate() {
            row[3 * k + component] = w;
        }
        row
    };
    // what is free at the face of a step is not part of what a support grips
    let gripped = gripped(model, node);
    let gripped = &gripped;
    let in_plane_shape =
        || (3..n_vectors).filter(|&k| gripped[k]).flat_map(move |k| [1, 2].map(|c| unit(k, c)));
    let plane = |acts_on: ActsOn, axially_free: bool, driven: bool| {
        let held = |c: usize| if c > 0 { mean(c, acts_on) } else { unit(0, c) };
        let mut rows: Vec<Vec<f64>> = (0..3).filter(|&c| !(axially_free && c == 0)).map(held).collect();
        rows.extend((1..n_vectors).filter(|&k| gripped[k]).map(|k| unit(k, 0)));
        if driven {
            rows.push(mean_rotation(model, node, acts_on));
        }
        rows
    };
    let held = |hold: SectionHold, axially_free: bool, driven: bool| match (hold, driven) {
        (SectionHold::Plane(acts_on), _) => plane(acts_on, axially_free, driven),
        (SectionHold::Rigid, true) => (0..n_vectors)
            .filter(|&k| gripped[k])
            .flat_map(|k| (0..3).map(move |c| (k, c)))
            .filter(|&(k, c)| !(axially_free && k == 0 && c == 0))
            .map(|(k, c)| unit(k, c))
            .collect(),
        // free to spin as a rigid disk: a hub holds r_,y and r_,z orthonormal
        (SectionHold::Rigid, false) => {
            plane(ActsOn::Axis, axially_free, false).into_iter().chain(in_plane_shape()).collect()
        }
    };
    let mut rows = Vec::new();
    for support in model.supports.iter().filter(|s| s.node == node) {
        rows.extend(match &support.kind {
            SupportKind::Clamped(hold) => held(*hold, false, true),
            SupportKind::Revolute { hold, driven } => held(*hold, false, *driven),
            SupportKind::Cylindrical { hold, driven } => held(*hold, true, *driven),
            SupportKind::Pinned(acts_on) => (0..3).map(|c| mean(c, *acts_on)).collect(),
            SupportKind::Roller(acts_on) => (1..3).map(|c| mean(c, *acts_on)).collect(),
            SupportKind::Turned => vec![mean_rotation(model, node, ActsOn::Section)],
            SupportKind::Fix(components) => {
                components.iter().filter(|(k, _)| gripped[*k]).map(|&(k, c)| unit(k, c)).collect()
            }
        });
    }
    if model.disks.iter().any(|d| d.node == node && d.hub == Hub::Rigid) {
        rows.extend((3..n_vectors).flat_map(|k| (0..3).map(move |c| (k, c))).map(|(k, c)| unit(k, c)));
    }
    rows
}

/// Mean rotation about the axis, `int (y u_z - z u_y)`, of a section (also where the axis is held) or a boundary, as a row.
fn mean_rotation(model: &Model, node: usize, acts_on: ActsOn) -> Vec<f64> {
    let region = if acts_on == ActsOn::Axis { ActsOn::Section } else { acts_on };
    let Some(region) = Region::new(model, node, region) else { return Vec::new() };
    let per = [region.moment(0, 0), model.reference_length];
    let with_y = region.integrals_per(1, 0, per).into_iter();
    let with_z = region.integrals_per(0, 1, per).into_iter();
    with_y.zip(with_z).flat_map(|(y, z)| [0.0, -z, y]).collect()
}

/// r, R r_,y and R r_,z of the axis as rows over the coordinates (first component); of a ring section those of the mean
/// affine motion of its outer boundary.
pub fn axis_rows(model: &Model, numbering: &Numbering, node: usize) -> [Vec<(usize, f64)>; 3] {
    let acts_on = if model.nodes[node].field.basis.is_ring() { ActsOn::Rim } else { ActsOn::Axis };
    affine_rows(model, numbering, node, acts_on)
}

/// R r_,y and R r_,z after r as rows over the coordinates (first component): vectors of the node, or the mean affine
/// motion of the boundary that carries the disk.
fn disk_vectors(model: &Model, numbering: &Numbering, disk: &Disk) -> [Vec<(usize, f64)>; 3] {
    affine_rows(model, numbering, disk.node, disk.hub.acts_on())
}

/// r, R r_,y and R r_,z of the mean affine motion of what is taken hold of at a node, as rows over the coordinates (first
/// component).
pub fn affine_rows(
    model: &Model,
    numbering: &Numbering,
    node: usize,
    acts_on: ActsOn,
) -> [Vec<(usize, f64)>; 3] {
    let rows = match Region::new(model, node, acts_on) {
        Some(region) => region.affine(model.reference_length),
        None => [vec![1.0], vec![0.0, 1.0], vec![0.0, 0.0, 1.0]],
    };
    rows.map(|row| {
        let used = row.into_iter().enumerate().filter(|(_, w)| *w != 0.0);
        used.map(|(k, w)| (numbering.index(node, k, 0), w)).collect()
    })
}

/// `sum_kl block_kl rows_k^T rows_l (x) I3`.
fn on_rows(block: &Mat<f64>, rows: &[Vec<(usize, f64)>]) -> Contribution {
    let mut starts: Vec<usize> = rows.iter().flatten().map(|entry| entry.0).collect();
    starts.sort_unstable();
    starts.dedup();
    let dense = Mat::from_fn(rows.len(), starts.len(), |k, i| {
        rows[k].iter().find(|entry| entry.0 == starts[i]).map_or(0.0, |entry| entry.1)
    });
    on_vectors(&(dense.transpose() * block * &dense), &starts)
}

/// Mass of the disks: `m/2 |r + d_y r_,y + d_z r_,z|^2 + Jp/4 (|r_,y|^2 + |r_,z|^2) + (Id - Jp/2)/2 |n|^2` in rates;
/// n is the normal that [`Hubs`] keep upright on the section. On a boundary its mean affine motion stands for r, r_,y
/// and r_,z.
pub fn disk_mass(model: &Model, numbering: &Numbering) -> Vec<Contribution> {
    let r = model.reference_length;
    let mut result = Vec::new();
    for (i, disk) in model.disks.iter().enumerate() {
        let centre = [1.0, disk.offset[0] / r, disk.offset[1] / r];
        let half_polar = disk.polar_inertia / 2.0 / (r * r);
        let vectors = Mat::from_fn(3, 3, |k, l| {
            disk.mass * centre[k] * centre[l] + if k == l && k > 0 { half_polar } else { 0.0 }
        });
        result.push(on_rows(&vectors, &disk_vectors(model, numbering, disk)));
        if let Some(normal) = numbering.normal(i) {
            let thickness = Mat::from_fn(1, 1, |_, _| disk.thickness_inertia() / (r * r));
            result.push(on_vectors(&thickness, &[normal]));
        }
    }
    result
}

/// What masses beside the axis add to the mass: `r' . (U_y r_,y' + U_z r_,z')` of the mean affine motion of the section, with the
/// moments `U = m e (cos a, sin a)`. Their own inertia is part of the rotor's.
pub fn unbalance_mass(model: &Model, numbering: &Numbering) -> Vec<Contribution> {
    let r = model.reference_length;
    let one = |mass: &Unbalance| {
        let [y, z] = [mass.angle.cos(), mass.angle.sin()].map(|share| mass.moment * share / r);
        let block = Mat::from_fn(3, 3, |k, l| match (k, l) {
            (0, 1) | (1, 0) => y,
            (0, 2) | (2, 0) => z,
            _ => 0.0,
        });
        affine_rows_at(model, numbering, mass.x).map(|rows| on_rows(&block, &rows))
    };
    model.spinning_masses.iter().filter_map(one).collect()
}

/// r, R r_,y and R r_,z of the mean affine motion of the section at any position (m), as rows over the coordinates (first component).
fn affine_rows_at(model: &Model, numbering: &Numbering, x: f64) -> Option<[Vec<(usize, f64)>; 3]> {
    let (element, region) = bearings::region_at(model, x)?;
    let starts = bearings::shapes_at(numbering, element, x);
    Some(region.affine(model.reference_length).map(|weights| {
        let of = |(start, factor): &(usize, f64)| {
            let used = weights.iter().enumerate().filter(|(_, w)| **w != 0.0);
            used.map(|(k, w)| (start + 3 * k, factor * w)).collect::<Vec<_>>()
        };
        starts.iter().flat_map(of).collect()
    }))
}

/// Gyroscopic terms of the disks per unit spin speed: `G[y,z] += Jp I3, G[z,y] -= Jp I3`.
pub fn disk_gyroscopic(model: &Model, numbering: &Numbering) -> Vec<Contribution> {
    disk_pairs(model, numbering, |polar| [[0.0, polar], [-polar, 0.0]])
}

/// Spin softening of the disks per unit spin speed squared: `Jp/2` on r_,y and on r_,z.
pub fn disk_softening(model: &Model, numbering: &Numbering) -> Vec<Contribution> {
    disk_pairs(model, numbering, |polar| [[polar / 2.0, 0.0], [0.0, polar / 2.0]])
}

fn disk_pairs(
    model: &Model,
    numbering: &Numbering,
    block: impl Fn(f64) -> [[f64; 2]; 2],
) -> Vec<Contribution> {
    let r2 = model.reference_length.powi(2);
    model
        .disks
        .iter()
        .map(|disk| {
            let block = block(disk.polar_inertia / r2);
            let vectors = Mat::from_fn(2, 2, |k, l| block[k][l]);
            on_rows(&vectors, &disk_vectors(model, numbering, disk)[1..])
        })
        .collect()
}

/// `matrix (x) I3` on vectors that start at the given coordinates.
fn on_vectors(matrix: &Mat<f64>, starts: &[usize]) -> Contribution {
    let n = 3 * starts.len();
    Contribution {
        coordinates: starts.iter().flat_map(|s| (0..3).map(move |c| s + c)).collect(),
        matrix: Mat::from_fn(n, n, |i, j| if i % 3 == j % 3 { matrix[(i / 3, j / 3)] } else { 0.0 }),
    }
}
