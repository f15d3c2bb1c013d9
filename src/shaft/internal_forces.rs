//! Nonlinear forces of the whole shaft: internal force and tangent of elements and rigid hubs, dead loads,
//! and products with the constant mass matrix.
//!
//! All coordinates before constraints, `q = q0 + T z` with q0 the undeformed state. Elements are evaluated
//! in parallel when there are many; sums are taken in one order, so results do not depend on threads.

use crate::element::Kernel;
use crate::element::kernel::simd::Scratch;
use crate::element::kinked::KinkedElement;
use crate::element::polynomial::NonlinearElement;
use crate::element::ring::RingElement;
use crate::element::structural_3333s::{AXIAL_POINTS, StructuralElement};
use crate::error::{Refusal, Result};
use crate::linalg::sparse::Sparse;
use crate::model::{Element, Law, Model};
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::{Contribution, Hubs};
use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Elements from which it pays to evaluate forces in parallel.
const PARALLEL_FORCES: usize = 64;
/// Elements from which it pays to evaluate tangents in parallel.
const PARALLEL_TANGENTS: usize = 4;

/// The nonlinear forces of an element of a model.
///
/// # Errors
/// What 3333s does not offer.
fn kernel(model: &Model, e: &Element) -> Result<Box<dyn Kernel>> {
    let (section, material) = (&model.sections[e.section], &model.materials[e.material]);
    let (r, quadrature) = (model.reference_length, model.quadrature);
    if !e.kinks.is_empty() {
        let with = (quadrature, model.instructions);
        let faces = model.faces(e);
        return Ok(Box::new(KinkedElement::new((e.kind, &e.kinks), faces, material, e.length, r, with)));
    }
    if e.is_tapered() {
        let element = NonlinearElement::tapered(e.kind, model.faces(e), material, e.length, r, quadrature);
        return Ok(Box::new(element.with_instructions(model.instructions)));
    }
    if let Some(element) = RingElement::new(e.kind, section, material, e.length, r, quadrature) {
        return Ok(Box::new(element.with_instructions(model.instructions)));
    }
    if e.kind.law != Law::Structural {
        let element = NonlinearElement::new(e.kind, section, material, e.length, r, quadrature);
        return Ok(Box::new(element.with_instructions(model.instructions)));
    }
    if material.stiffness_damping != 0.0 {
        return Err(Refusal::at(
            format!("materials.{}.damping.stiffness", model.names.materials[e.material]),
            "3333s has no stiffness damping in nonlinear analyses: its Kelvin-Voigt stress belongs to strains of \
             points, which its law does not use",
            "0; or an element 34X1 .. 34X5 or 3333c",
        )
        .into());
    }
    let points = quadrature.axial.unwrap_or(AXIAL_POINTS);
    if points < 3 {
        return Err(Refusal::at(
            "shaft.quadrature.axial",
            "3333s needs more Gauss points along an element: fewer than 3 leave zero-energy modes",
            "3 to 20, or \"exact\"",
        )
        .into());
    }
    Ok(Box::new(StructuralElement::new(section, material, e.length, r, points)))
}

/// Writes a matrix of an element, by columns, for its coordinates.
type Evaluate<'a> = &'a (dyn Fn(&dyn Kernel, &[f64], &mut [f64], &mut Scratch) + Sync);

/// Elements and hubs of a shaft, ready to be evaluated.
pub struct Forces<'a> {
    assembly: &'a Assembly<'a>,
    /// One kernel for each distinct element.
    elements: Vec<Box<dyn Kernel>>,
    hubs: Hubs,
    /// First coordinate of every node of every element, and coordinates of one node.
    places: Vec<(Vec<usize>, usize)>,
}

/// Working memory of [`Forces`].
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    scratch: Scratch,
    q: Vec<f64>,
    velocity: Vec<f64>,
    force: Vec<f64>,
}

impl<'a> Forces<'a> {
    /// Prepares the distinct elements of an assembly.
    ///
    /// # Errors
    /// What 3333s does not offer: stiffness damping of its material, fewer than three Gauss points along an element.
    pub fn new(assembly: &'a Assembly<'a>) -> Result<Self> {
        let model = assembly.model;
        let (mut elements, mut places) = (Vec::new(), Vec::new());
        for (i, e) in model.elements.iter().enumerate() {
            if assembly.element_type(i) == elements.len() {
                elements.push(kernel(model, e)?);
            }
            let first = (0..=e.kind.axial_degree).map(|i| assembly.numbering.of_element(e, i)).collect();
            places.push((first, 3 * e.n_vectors()));
        }
        Ok(Self { assembly, elements, hubs: Hubs::new(model, &assembly.numbering), places })
    }

    /// The undeformed state: `r = (x, 0, 0)`, `r_,y = (0, 1, 0)`, `r_,z = (0, 0, 1)`, scaled.
    pub fn reference(&self) -> Vec<f64> {
        let (model, numbering) = (self.assembly.model, &self.assembly.numbering);
        let mut q = vec![0.0; numbering.len()];
        for (node, at) in model.nodes.iter().enumerate() {
            for first in numbering.fields(node) {
                q[first] = at.x;
                q[first + 4] = model.reference_length;
                q[first + 8] = model.reference_length;
            }
        }
        numbering.all_normals().for_each(|normal| q[normal] = model.reference_length);
        q
    }

    /// Internal forces on all coordinates (N) into `force`; returns the strain energy (J), hubs included.
    /// With velocities, Kelvin-Voigt forces are added (and the energy is not computed: zero).
    pub fn internal_force(
        &self,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        work: &mut Workspace,
    ) -> f64 {
        force.fill(0.0);
        let mut energy = 0.0;
        if self.places.len() < PARALLEL_FORCES {
            for e in 0..self.places.len() {
                energy += self.element_force(e, q, velocity, work);
                self.scatter(e, &work.force, force);
            }
        } else {
            let parts: Vec<(f64, Vec<f64>)> = (0..self.places.len())
                .into_par_iter()
                .map_init(Workspace::default, |work, e| {
                    (self.element_force(e, q, velocity, work), work.force.clone())
                })
                .collect();
            for (e, (part, f)) in parts.iter().enumerate() {
                energy += part;
                self.scatter(e, f, force);
            }
        }
        energy += self.hubs.add_force(q, force);
        energy
    }

    fn element_force(&self, e: usize, q: &[f64], velocity: Option<&[f64]>, work: &mut Workspace) -> f64 {
        let element = &self.elements[self.assembly.element_type(e)];
        self.gather(e, q, &mut work.q);
        work.force.resize(element.size(), 0.0);
        if let Some(velocity) = velocity {
            self.gather(e, velocity, &mut work.velocity);
        }
        let velocity = velocity.map(|_| &work.velocity[..]);
        element.internal_force(&work.q, velocity, &mut work.force, &mut work.scratch)
    }

    fn gather(&self, e: usize, q: &[f64], local: &mut Vec<f64>) {
        let (starts, count) = &self.places[e];
        local.clear();
        starts.iter().for_each(|&at| local.extend_from_slice(&q[at..at + count]));
    }

    fn scatter(&self, e: usize, local: &[f64], force: &mut [f64]) {
        let (starts, count) = &self.places[e];
        for (&at, part) in starts.iter().zip(local.chunks_exact(*count)) {
            force[at..at + count].iter_mut().zip(part).for_each(|(t, f)| *t += f);
        }
    }

    /// The vectors `R r_,y` and `R r_,z` at a node, m: scaled images of the axes of its section.
    fn slopes(&self, q: &[f64], node: usize) -> [Vector3<f64>; 2] {
        [1, 2].map(|vector| {
            let at = self.assembly.numbering.index(node, vector, 0);
            Vector3::new(q[at], q[at + 1], q[at + 2])
        })
    }

    /// Tangent `dF/dq` of elements and hubs in the free coordinates.
    pub fn tangent(&self, q: &[f64]) -> Sparse {
        self.assembly.sum(&self.element_tangents(q), self.hub_tangents(q))
    }

    /// Tangent of every element in its own coordinates.
    pub fn element_tangents(&self, q: &[f64]) -> Vec<Mat<f64>> {
        self.element_matrices(q, &|element, q, k, scratch| element.tangent(q, k, scratch))
    }

    /// `d (Kelvin-Voigt force) / d velocity` of every element in its own coordinates.
    pub fn viscous_tangents(&self, q: &[f64]) -> Vec<Mat<f64>> {
        self.element_matrices(q, &|element, q, c, scratch| element.viscous_tangent(q, c, scratch))
    }

    fn element_matrices(&self, q: &[f64], evaluate: Evaluate<'_>) -> Vec<Mat<f64>> {
        let one = |work: &mut Workspace, e: usize| {
            let element = &self.elements[self.assembly.element_type(e)];
            self.gather(e, q, &mut work.q);
            let n = element.size();
            work.force.resize(n * n, 0.0);
            evaluate(element.as_ref(), &work.q, &mut work.force[..n * n], &mut work.scratch);
            Mat::from_fn(n, n, |i, j| work.force[j * n + i])
        };
        if self.places.len() < PARALLEL_TANGENTS {
            let mut work = Workspace::default();
            (0..self.places.len()).map(|e| one(&mut work, e)).collect()
        } else {
            (0..self.places.len()).into_par_iter().map_init(Workspace::default, one).collect()
        }
    }

    /// Tangent stiffness of every hub at a state q, on coordinates before constraints.
    pub fn hub_tangents(&self, q: &[f64]) -> Vec<Contribution> {
        self.hubs.tangents(q)
    }

    /// Rotation of the section at a node: orthonormal frame nearest to its r_,y and r_,z (columns are the
    /// turned axes x, y, z).
    pub fn section_frame(&self, q: &[f64], node: usize) -> Matrix3<f64> {
        let [y, z] = self.slopes(q, node);
        let x = y.cross(&z).normalize();
        // the bisectors of y and z with respect to each other share what shear there is
        let (y, z) = (y.normalize(), z.normalize());
        let (sum, difference) = ((y + z).normalize(), (y - z).normalize());
        let (y, z) = ((sum + difference).normalize(), (sum - difference).normalize());
        Matrix3::from_columns(&[x, y, z])
    }
}

/// The mass matrix of all coordinates: the same scalar matrix for each of the three components.
#[derive(Debug, Clone)]
pub struct ScalarMass {
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl ScalarMass {
    /// Mass of shaft and disks, no constraint.
    pub fn new(model: &Model) -> Self {
        Self::of(&Assembly::unconstrained(model).mass())
    }

    /// `alpha M` of the shaft, the external damping.
    pub fn external_damping(model: &Model) -> Self {
        Self::of(&Assembly::unconstrained(model).external_damping())
    }

    fn of(mass: &Sparse) -> Self {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in (0..mass.ncols()).step_by(3) {
            for (&row, &value) in mass.row_idx_of_col_raw(column).iter().zip(mass.val_of_col(column)) {
                rows.push((row / 3) as u32);
                values.push(value);
            }
            starts.push(rows.len());
        }
        Self { starts, rows, values }
    }

    /// Multiplies the mass matrix by a list of all coordinates, `y = M x`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        // symmetric: each row is a column
        for (k, y) in y.chunks_exact_mut(3).enumerate() {
            let mut sum = [0.0; 3];
            let range = self.starts[k]..self.starts[k + 1];
            for (&row, &value) in self.rows[range.clone()].iter().zip(&self.values[range]) {
                let x = &x[3 * row as usize..3 * row as usize + 3];
                for c in 0..3 {
                    sum[c] += value * x[c];
                }
            }
            y.copy_from_slice(&sum);
        }
    }
}
