//! From a model to sparse matrices in the free coordinates.
//!
//! Constraints hold within single nodes and are eliminated: `q = T z` with z a subset of the
//! coordinates, `A_free = T^T A T`; so are the vectors that follow a neighbour's at a joint of unlike elements. Matrices are accumulated in column profiles (the shaft is a chain, so
//! the profile is narrow) and stored without exact zeros, which uncouples the planes of symmetry.
//! Each matrix is built only when an analysis asks for it.

mod elimination;
mod hysteresis;
mod rigid_motions;

pub use rigid_motions::RigidMotion;

use crate::element::ElementMatrices;
use crate::element::basis::{SectionProducts, rotation_with_kinks};
use crate::element::inertia::convection;
use crate::linalg::chain::{Layout, Link};
use crate::linalg::sparse::{Sparse, from_columns};
use crate::model::{Bearing, Element, Field, Gyroscopic, Material, Model};
use crate::section::basis::SectionBasis;
use crate::section::kinks::Kinks;
use crate::shaft::attachments::{self, Contribution, Numbering};
use elimination::eliminate;
use faer::Mat;

/// Relative size below which a constraint or a motion counts as zero.
const ZERO_ROW_RTOL: f64 = 1e-9;

/// The matrix of one element that a system matrix sums.
type ElementMatrix<'a> = &'a dyn Fn(&Material, &ElementMatrices) -> Mat<f64>;

/// A model with its numbering, constraints and the matrices of its distinct elements.
pub struct Assembly<'a> {
    /// The model whose matrices are assembled.
    pub model: &'a Model,
    /// Where each node, vector and component stands among the coordinates before constraints.
    pub numbering: Numbering,
    /// `T`: every coordinate as a sum over free coordinates.
    expansion: Vec<Vec<(usize, f64)>>,
    /// For every free coordinate its index among the coordinates before constraints.
    free: Vec<usize>,
    /// Matrices of the distinct elements.
    distinct: Vec<ElementMatrices>,
    /// For every element the index of its matrices in the list above.
    element_type: Vec<usize>,
    /// Node and coefficients (over its coordinates) of every constraint.
    constraints: Vec<(usize, Vec<f64>)>,
}

/// What a system matrix sums: the matrix of every distinct element (none: no element has a share), and
/// contributions of nodes.
pub struct Parts {
    /// One matrix for each distinct element, in the coordinates of the element; empty where no element has a
    /// share.
    pub elements: Vec<Mat<f64>>,
    /// What nodes (disks, hubs, bearings) add, on coordinates before constraints.
    pub nodal: Vec<Contribution>,
}

/// One direction of a bearing's stiffness.
pub struct BearingSpring {
    /// The displacement it feels, as a row over coordinates before constraints.
    pub row: Vec<(usize, f64)>,
    /// Stiffness along that direction (N/m, N m/rad), never zero.
    pub stiffness: f64,
}

impl Parts {
    /// `A J`, `J u = e_x x u` on every vector.
    pub fn times_cross(mut self) -> Self {
        self.elements.iter_mut().for_each(|a| *a = times_cross(a));
        self.nodal.iter_mut().for_each(|part| part.matrix = times_cross(&part.matrix));
        self
    }
}

impl<'a> Assembly<'a> {
    /// Numbers the coordinates, eliminates the constraints and computes each distinct element once.
    pub fn new(model: &'a Model) -> Self {
        let numbering = Numbering::new(model);
        let (expansion, free, constraints) = eliminate(model, &numbering, true);
        Self::with(model, numbering, expansion, free, constraints)
    }

    /// The same without any support, rigid hubs not constrained; joints hold.
    pub fn unsupported(model: &'a Model) -> Self {
        let numbering = Numbering::new(model);
        let (expansion, free, constraints) = eliminate(model, &numbering, false);
        Self::with(model, numbering, expansion, free, constraints)
    }

    /// The same without any constraint: all coordinates free, also those that follow at joints.
    pub fn unconstrained(model: &'a Model) -> Self {
        let numbering = Numbering::new(model);
        let expansion = (0..numbering.len()).map(|i| vec![(i, 1.0)]).collect();
        let free = (0..numbering.len()).collect();
        Self::with(model, numbering, expansion, free, Vec::new())
    }

    fn with(
        model: &'a Model,
        numbering: Numbering,
        expansion: Vec<Vec<(usize, f64)>>,
        free: Vec<usize>,
        constraints: Vec<(usize, Vec<f64>)>,
    ) -> Self {
        let mut keys: Vec<&Element> = Vec::new();
        let same = |a: &Element, b: &Element| {
            (a.kind, a.faces, a.material, a.kinks, a.carried)
                == (b.kind, b.faces, b.material, b.kinks, b.carried)
                && (a.length - b.length).abs() <= 1e-13 * b.length
        };
        let element_type = model
            .elements
            .iter()
            .map(|e| {
                keys.iter().position(|k| same(k, e)).unwrap_or_else(|| {
                    keys.push(e);
                    keys.len() - 1
                })
            })
            .collect();
        // elements of different lengths share the products of their section
        let mut products: Vec<(Field, SectionProducts)> = Vec::new();
        let mut matrices = |e: &&Element| {
            let (section, material) = (&model.sections[e.section], &model.materials[e.material]);
            if e.is_tapered() {
                let (of, r) = ((model.faces(e), material), model.reference_length);
                return ElementMatrices::tapered((e.kind, &e.kinks), of, &e.carried, e.length, r);
            }
            let at = products.iter().position(|(field, _)| *field == e.field()).unwrap_or_else(|| {
                let (basis, r) = (e.kind.basis, model.reference_length);
                products.push((e.field(), SectionProducts::with_kinks(basis, &e.kinks, section, r)));
                products.len() - 1
            });
            ElementMatrices::on(&products[at].1, e.kind, (section, material), &e.carried, e.length)
        };
        let distinct = keys.iter().map(&mut matrices).collect();
        Self { model, numbering, expansion, free, distinct, element_type, constraints }
    }

    /// Free coordinates of kinked functions.
    pub fn kinked_unknowns(&self) -> usize {
        let of_node = |(node, at): (usize, &crate::model::Node)| {
            let start = self.numbering.index(node, 0, 0);
            let own = start + 3 * at.field.basis.count()..start + 3 * at.field.count();
            // beyond a coupling all vectors are free
            let others = at.follower.filter(|_| at.coupled).map_or(0, |f| f.basis.count());
            let following = start + 3 * (at.field.count() + others)..self.numbering.normals(node).start;
            self.free_among(own).len() + self.free_among(following).len()
        };
        self.model.nodes.iter().enumerate().map(of_node).sum()
    }

    /// Number of free coordinates.
    pub fn size(&self) -> usize {
        self.free.len()
    }

    /// Index of the distinct element that an element is a copy of.
    pub fn element_type(&self, element: usize) -> usize {
        self.element_type[element]
    }

    /// Nodes that carry constraints.
    pub fn constrained_nodes(&self) -> impl Iterator<Item = usize> {
        self.constraints.iter().map(|(node, _)| *node)
    }

    /// `T^T f`: forces on all coordinates as forces on the free ones.
    pub fn project(&self, f: &[f64], on_free: &mut [f64]) {
        on_free.fill(0.0);
        for (row, f) in self.expansion.iter().zip(f) {
            for &(j, c) in row {
                on_free[j] += c * f;
            }
        }
    }

    /// `T^T A T` for matrices of elements (in the elements' coordinates) and contributions of nodes.
    pub fn sum(&self, elements: &[Mat<f64>], nodal: Vec<Contribution>) -> Sparse {
        let coordinates: Vec<_> = self.model.elements.iter().map(|e| self.element_coordinates(e)).collect();
        let parts: Vec<_> = coordinates.iter().zip(elements).collect();
        let nodal = nodal.iter().map(|n| (&n.coordinates, &n.matrix));
        self.accumulate(&parts.into_iter().chain(nodal).collect::<Vec<_>>())
    }

    /// Coordinates before constraints, `q = T z`.
    pub fn expand(&self, z: &[f64]) -> Vec<f64> {
        let mut q = vec![0.0; self.numbering.len()];
        self.expand_into(z, &mut q);
        q
    }

    /// [`Self::expand`] into memory that is there.
    pub fn expand_into(&self, z: &[f64], q: &mut [f64]) {
        for (q, row) in q.iter_mut().zip(&self.expansion) {
            *q = row.iter().map(|&(j, c)| c * z[j]).sum();
        }
    }

    /// A coordinate as a sum over the free ones, `(free coordinate, factor)`.
    pub fn expansion(&self, coordinate: usize) -> &[(usize, f64)] {
        &self.expansion[coordinate]
    }

    /// The free coordinates among all coordinates `q` (the inverse of [`Self::expand`] where q satisfies
    /// the constraints).
    pub fn restrict(&self, q: &[f64]) -> Vec<f64> {
        self.free.iter().map(|&i| q[i]).collect()
    }

    /// [`Self::restrict`] into memory that is there.
    pub fn restrict_into(&self, q: &[f64], z: &mut [f64]) {
        z.iter_mut().zip(&self.free).for_each(|(z, &i)| *z = q[i]);
    }

    /// The coordinates of a range that are free.
    pub fn free_among(&self, range: std::ops::Range<usize>) -> Vec<usize> {
        self.free.iter().copied().filter(|i| range.contains(i)).collect()
    }

    /// Matrices of one element.
    pub fn element_matrices(&self, element: usize) -> &ElementMatrices {
        &self.distinct[self.element_type[element]]
    }

    /// Coordinates of an element before constraints, in its own order.
    pub fn element_coordinates(&self, element: &Element) -> Vec<usize> {
        let n_vectors = element.n_vectors();
        (0..=element.kind.axial_degree)
            .flat_map(|i| {
                let start = self.numbering.of_element(element, i);
                start..start + 3 * n_vectors
            })
            .collect()
    }

    /// Mass of shaft, disks, bearings and housings, symmetric positive definite.
    pub fn mass(&self) -> Sparse {
        self.add_up(&self.mass_parts())
    }

    /// The mass matrix before it is summed: one matrix for each distinct element, and those of disks, bearings and housings.
    pub fn mass_parts(&self) -> Parts {
        let mut nodal = attachments::disk_mass(self.model, &self.numbering);
        nodal.extend(attachments::bearing_mass(self.model, &self.numbering));
        nodal.extend(attachments::unbalance_mass(self.model, &self.numbering));
        self.parts(Some(&|_, m| m.mass.clone()), nodal)
    }

    /// Stiffness about the undeformed state: shaft, hubs and the symmetric part of the bearings.
    pub fn stiffness(&self) -> Sparse {
        let mut nodal = attachments::Hubs::new(self.model, &self.numbering).stiffness();
        nodal.extend(self.bearings(|b| symmetric_part(b.stiffness)));
        self.build(Some(&|_, m| m.stiffness_at_rest()), nodal)
    }

    /// The part of [`Self::stiffness`] that the initial stress makes; `None` without one.
    pub fn initial_stress(&self) -> Option<Sparse> {
        let of = |_: &Material, m: &ElementMatrices| {
            m.initial_stress.clone().unwrap_or_else(|| Mat::zeros(m.mass.nrows(), m.mass.ncols()))
        };
        self.model.initial_stress.is_some().then(|| self.build(Some(&of), Vec::new()))
    }

    /// The bearings' symmetric stiffness as springs along its principal directions.
    pub fn springs(&self) -> Vec<BearingSpring> {
        let mut springs = Vec::new();
        for bearing in &self.model.bearings {
            let [y, z] = attachments::bearing_rows(self.model, &self.numbering, bearing);
            let [[kyy, off], [_, kzz]] = symmetric_part(bearing.stiffness);
            // a turn by half the angle of (kyy - kzz, 2 off); none where y and z are uncoupled
            let (sin, cos) =
                if off == 0.0 { (0.0, 1.0) } else { (off.atan2((kyy - kzz) / 2.0) / 2.0).sin_cos() };
            let along = |a: f64, b: f64| -> Vec<(usize, f64)> {
                let scaled = |row: &[(usize, f64)], by: f64| -> Vec<(usize, f64)> {
                    row.iter().filter(|_| by != 0.0).map(|&(i, w)| (i, by * w)).collect()
                };
                [scaled(&y, a), scaled(&z, b)].concat()
            };
            let law = |a: f64, b: f64| a * a * kyy + 2.0 * a * b * off + b * b * kzz;
            for (a, b) in [(cos, sin), (-sin, cos)] {
                let stiffness = law(a, b);
                let rounding = if off == 0.0 { 0.0 } else { 16.0 * f64::EPSILON * (kyy + kzz) };
                if stiffness.abs() > rounding {
                    springs.push(BearingSpring { row: along(a, b), stiffness });
                }
            }
        }
        springs
    }

    /// Stiffness of shaft, hubs and some of the [`Self::springs`].
    pub fn stiffness_on<'s>(&self, springs: impl Iterator<Item = &'s BearingSpring>) -> Sparse {
        let mut parts = self.elastic_parts();
        parts.nodal.extend(springs.map(|spring| Contribution {
            coordinates: spring.row.iter().map(|(i, _)| *i).collect(),
            matrix: Mat::from_fn(spring.row.len(), spring.row.len(), |i, j| {
                spring.stiffness * spring.row[i].1 * spring.row[j].1
            }),
        }));
        self.add_up(&parts)
    }

    /// Stiffness of the bearings, skew part included.
    pub fn bearing_stiffness(&self) -> Sparse {
        self.build(None, self.bearings(|b| b.stiffness))
    }

    /// A law of every bearing between the displacements (or velocities) it feels and its forces, as a matrix.
    pub fn bearing_matrix(&self, law: impl Fn(&Bearing) -> [[f64; 2]; 2]) -> Sparse {
        self.build(None, self.bearings(law))
    }

    /// Stiffness of shaft and hubs about the undeformed state, without bearings.
    pub fn elastic_parts(&self) -> Parts {
        self.parts(
            Some(&|_, m| m.stiffness_at_rest()),
            attachments::Hubs::new(self.model, &self.numbering).stiffness(),
        )
    }

    /// Stiffness and damping of the bearings averaged over the directions, as a turning section feels them in the mean.
    pub fn mean_bearings(&self) -> [Parts; 2] {
        let mean = |b: &Bearing, law: [[f64; 2]; 2]| if b.is_across() { mean(law) } else { law };
        [self.bearings(|b| mean(b, b.stiffness)), self.bearings(|b| mean(b, b.damping))]
            .map(|nodal| Parts { elements: Vec::new(), nodal })
    }

    /// External damping `alpha M` of the shaft (N s/m); disks have none.
    pub fn external_damping(&self) -> Sparse {
        self.add_up(&self.external_parts())
    }

    /// Parts of [`Self::external_damping`]; none when no material has such damping.
    pub fn external_parts(&self) -> Parts {
        let shaft = |material: &Material, m: &ElementMatrices| &m.mass * faer::Scale(material.mass_damping);
        let damped = self.model.materials.iter().any(|m| m.mass_damping != 0.0);
        self.parts(damped.then_some(&shaft), Vec::new())
    }

    /// Skew part of the bearings' stiffness (cross-coupling).
    pub fn cross_coupling(&self) -> Sparse {
        let nodal = self.bearings(|b| {
            let half = (b.stiffness[0][1] - b.stiffness[1][0]) / 2.0;
            [[0.0, half], [-half, 0.0]]
        });
        self.build(None, nodal)
    }

    /// Gyroscopic matrix G for a spin of 1 rad/s, seen from space: it adds `Omega G u'` to the inertia forces.
    pub fn gyroscopic(&self, whose: Gyroscopic) -> Sparse {
        let disks = match whose {
            Gyroscopic::None => Vec::new(),
            _ => attachments::disk_gyroscopic(self.model, &self.numbering),
        };
        let shaft: ElementMatrix<'_> = &|_, m| m.gyroscopic.clone();
        self.build((whose == Gyroscopic::All).then_some(shaft), disks)
    }

    /// `W = M J`, skew: a mode `u exp(i w t)` has the mean angular momentum `w/2 Im(u^H W u)` about x.
    pub fn angular_momentum(&self) -> Sparse {
        self.add_up(&self.mass_parts().times_cross())
    }

    /// `M J^2`, the centrifugal matrix per unit spin speed squared of the rotating frame: `-M` on y and z.
    pub fn centrifugal(&self) -> Sparse {
        self.add_up(&self.mass_parts().times_cross().times_cross())
    }

    /// Spin-softening matrix N for a spin of 1 rad/s: the stiffness changes by `-Omega^2 N`.
    pub fn spin_softening(&self) -> Sparse {
        let disks = attachments::disk_softening(self.model, &self.numbering);
        self.build(Some(&|_, m| m.spin_softening.clone()), disks)
    }

    /// Damping matrix at rest: bearings, `beta K` and `alpha M` of the materials.
    pub fn damping(&self) -> Sparse {
        self.build(self.has_material_damping().then_some(&material_damping), self.bearings(|b| b.damping))
    }

    /// What spin adds to the material damping forces, per unit spin speed, on displacements:
    /// `beta K (D_theta - J) + alpha G / 2` (stationary frame; docs/theory/linear-rotordynamics.md#equations).
    pub fn circulatory(&self) -> Sparse {
        let material = |material: &Material, m: &ElementMatrices| {
            let convected = &m.stiffness * convection(m.stiffness.nrows(), &self.turn_of(m));
            convected * faer::Scale(material.stiffness_damping)
                + &m.gyroscopic * faer::Scale(material.mass_damping / 2.0)
        };
        self.build(self.has_material_damping().then_some(&material), Vec::new())
    }

    /// `beta K` of the materials, the part of [`Self::damping`] that strain rates feel.
    pub fn strain_damping(&self) -> Sparse {
        let strain =
            |material: &Material, m: &ElementMatrices| &m.stiffness * faer::Scale(material.stiffness_damping);
        self.build(self.has_viscosity().then_some(&strain), Vec::new())
    }

    /// `beta K (D_theta - J)`, the same part of [`Self::circulatory`].
    pub fn strain_circulatory(&self) -> Sparse {
        let strain = |material: &Material, m: &ElementMatrices| {
            &m.stiffness
                * convection(m.stiffness.nrows(), &self.turn_of(m))
                * faer::Scale(material.stiffness_damping)
        };
        self.build(self.has_viscosity().then_some(&strain), Vec::new())
    }

    fn has_viscosity(&self) -> bool {
        self.model.materials.iter().any(|m| m.stiffness_damping != 0.0)
    }

    /// What spin adds to the damping forces in the rotating frame, per unit spin speed, on displacements:
    /// `alpha M J + C_b J`, external and bearing damping being felt by inertial velocities.
    pub fn rotating_damping(&self) -> Sparse {
        let material = |material: &Material, m: &ElementMatrices| {
            times_cross(&m.mass) * faer::Scale(material.mass_damping)
        };
        let external = self.model.materials.iter().any(|m| m.mass_damping != 0.0);
        let bearings = self.bearings(|b| dragged(b, b.damping));
        self.build(external.then_some(&material), bearings)
    }

    /// Matrix of d_theta on the functions of the elements that have the given matrices.
    fn turn_of(&self, matrices: &ElementMatrices) -> Mat<f64> {
        let of = |e: usize| std::ptr::eq(self.element_matrices(e), matrices);
        let element = (0..self.model.elements.len()).find(|&e| of(e)).map(|e| &self.model.elements[e]);
        element.map_or_else(
            || rotation_with_kinks(SectionBasis::Monomials(1), &Kinks::NONE),
            |e| rotation_with_kinks(e.kind.basis, &e.kinks),
        )
    }

    fn bearings(&self, law: impl Fn(&Bearing) -> [[f64; 2]; 2]) -> Vec<Contribution> {
        attachments::bearing_contributions(self.model, &self.numbering, law)
    }

    /// A row over all coordinates as a column vector in the free ones, `T^T row`.
    pub fn force(&self, row: &[(usize, f64)]) -> Vec<f64> {
        let mut force = vec![0.0; self.size()];
        for &(i, value) in row {
            for &(j, c) in &self.expansion[i] {
                force[j] += c * value;
            }
        }
        force
    }

    /// Sums element and nodal contributions, `T^T A T`.
    fn build(&self, shaft: Option<ElementMatrix<'_>>, nodal: Vec<Contribution>) -> Sparse {
        self.add_up(&self.parts(shaft, nodal))
    }

    /// The matrix of every distinct element, and contributions of nodes.
    fn parts(&self, shaft: Option<ElementMatrix<'_>>, nodal: Vec<Contribution>) -> Parts {
        let Some(shaft) = shaft else { return Parts { elements: Vec::new(), nodal } };
        let matrix = |(kind, m)| shaft(self.material_of(kind), m);
        Parts { elements: self.distinct.iter().enumerate().map(matrix).collect(), nodal }
    }

    fn add_up(&self, parts: &Parts) -> Sparse {
        let coordinates: Vec<_> = self.model.elements.iter().map(|e| self.element_coordinates(e)).collect();
        let kinds = coordinates.iter().zip(&self.element_type);
        let elements = kinds.filter_map(|(c, &kind)| parts.elements.get(kind).map(|m| (c, m)));
        let nodal = parts.nodal.iter().map(|n| (&n.coordinates, &n.matrix));
        self.accumulate(&elements.chain(nodal).collect::<Vec<_>>())
    }

    /// Material of a distinct element.
    fn material_of(&self, kind: usize) -> &Material {
        let first = self.element_type.iter().position(|&k| k == kind).unwrap_or(0);
        &self.model.materials[self.model.elements[first].material]
    }

    /// Kelvin-Voigt factor beta of every distinct element, s.
    pub fn viscosities(&self) -> Vec<f64> {
        (0..self.distinct.len()).map(|kind| self.material_of(kind).stiffness_damping).collect()
    }

    /// Where a direct solver for sums of [`Parts`] finds coordinates and constraints.
    pub fn chain(&self) -> Layout {
        let elements = &self.model.elements;
        let nodes = elements.iter().map(|e| e.first_node);
        let nodes: Vec<usize> =
            nodes.chain(elements.last().map(|e| e.first_node + e.kind.axial_degree)).collect();
        let links = elements.iter().map(|e| {
            let coordinates = self.element_coordinates(e);
            let n = 3 * e.n_vectors();
            let (left, right) = (&coordinates[..n], &coordinates[coordinates.len() - n..]);
            let local = |list: &[usize], node: usize| {
                let start = self.numbering.index(node, 0, 0);
                list.iter().map(|i| i - start).collect::<Vec<_>>()
            };
            let last = e.first_node + e.kind.axial_degree;
            Link {
                ends: [local(left, e.first_node), local(right, last)],
                interior: self.numbering.of_node(e.first_node + 1).start..self.numbering.of_node(last).start,
            }
        });
        let constraint = |&node: &usize| {
            let range = self.numbering.of_node(node);
            let rows = &self.expansion[range.clone()];
            let columns = rows.iter().flatten().map(|(j, _)| *j);
            let first = columns.clone().min().unwrap_or(0);
            let count = columns.max().map_or(0, |last| last + 1 - first);
            let mut t = Mat::zeros(range.len(), count);
            for (i, row) in rows.iter().enumerate() {
                row.iter().for_each(|&(j, c)| t[(i, j - first)] = c);
            }
            (count < range.len()).then_some(t)
        };
        Layout {
            ends: nodes.iter().map(|&node| self.numbering.of_node(node)).collect(),
            constraints: nodes.iter().map(constraint).collect(),
            links: links.collect(),
        }
    }

    fn accumulate(&self, parts: &[(&Vec<usize>, &Mat<f64>)]) -> Sparse {
        let n = self.size();
        let free_of =
            |c: &[usize]| c.iter().flat_map(|&i| self.expansion[i].iter().map(|&(j, _)| j)).collect();
        let mut profile = vec![(usize::MAX, 0); n];
        for (coordinates, _) in parts {
            let columns: Vec<usize> = free_of(coordinates);
            let Some((&low, &high)) = columns.iter().min().zip(columns.iter().max()) else { continue };
            for j in columns {
                profile[j] = (profile[j].0.min(low), profile[j].1.max(high + 1));
            }
        }
        let mut starts = vec![0];
        for &(low, high) in &profile {
            starts.push(starts[starts.len() - 1] + high.saturating_sub(low));
        }
        let mut values = vec![0.0; starts[n]];
        for (coordinates, matrix) in parts {
            for (b, &column) in coordinates.iter().enumerate() {
                for &(j, cj) in &self.expansion[column] {
                    let start = starts[j] - profile[j].0;
                    for (a, &row) in coordinates.iter().enumerate() {
                        let value = matrix[(a, b)];
                        if value != 0.0 {
                            for &(i, ci) in &self.expansion[row] {
                                values[start + i] += ci * value * cj;
                            }
                        }
                    }
                }
            }
        }
        let (mut column_starts, mut rows, mut kept) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n {
            for (offset, &value) in values[starts[j]..starts[j + 1]].iter().enumerate() {
                if value != 0.0 {
                    rows.push(profile[j].0 + offset);
                    kept.push(value);
                }
            }
            column_starts.push(rows.len());
        }
        from_columns(n, column_starts, rows, kept)
    }
}

/// `A J` for coordinates in triples, `J u = e_x x u`.
fn times_cross(a: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| match j % 3 {
        1 => a[(i, j + 1)],
        2 => -a[(i, j - 1)],
        _ => 0.0,
    })
}

/// Damping matrix of an element by its material, `beta K + alpha M`, N s/m.
fn material_damping(material: &Material, m: &ElementMatrices) -> Mat<f64> {
    &m.stiffness * faer::Scale(material.stiffness_damping) + &m.mass * faer::Scale(material.mass_damping)
}

/// `C J` of a damping law: what it makes of a displacement that turns with the frame, per unit speed. Along and about the axis
/// nothing turns.
pub fn dragged(bearing: &Bearing, damping: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    if bearing.is_across() { damping.map(|[y, z]| [z, -y]) } else { [[0.0; 2]; 2] }
}

/// The same law in both directions, with the mean of the diagonal.
fn mean(law: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let mean = (law[0][0] + law[1][1]) / 2.0;
    [[mean, 0.0], [0.0, mean]]
}

fn symmetric_part(k: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let off = (k[0][1] + k[1][0]) / 2.0;
    [[k[0][0], off], [off, k[1][1]]]
}
