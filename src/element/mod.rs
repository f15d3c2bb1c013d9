//! The element family: axial Lagrange polynomials times section monomials.
//!
//! Element coordinates are ordered node by node, vector by vector, component by component:
//! `index = (node * n_vectors + vector) * 3 + component`. The vector of the section monomial
//! `y^a z^b / (a! b!)` is the derivative `r_,(y^a z^b)` of the position, scaled by `R^(a+b)` (R the
//! reference length of the shaft), so that every unknown is a length.

pub mod basis;
pub mod boundary_curve;
pub mod carried;
pub mod cells;
pub mod continuum;
pub mod fields;
pub mod inertia;
pub mod kernel;
pub mod kinked;
pub mod planar_2322s;
pub mod polynomial;
pub mod quadrature;
pub mod ring;
pub mod ring_functions;
pub mod structural_3333s;
pub mod taper;

use crate::model::{Carried, ElementKind, Law, Material};
use crate::section::Section;
use crate::section::kinks::Kinks;
use faer::Mat;
use kernel::simd::Scratch;

/// Nonlinear forces of one element, in its own coordinates.
pub trait Kernel: Send + Sync {
    /// Number of coordinates.
    fn size(&self) -> usize;

    /// Internal force `dW/dq` (N for a coordinate that is a length, N m for one that is not), of every coordinate of the state `q`,
    /// into `force`; returns the strain energy W (J).
    ///
    /// With velocities the Kelvin-Voigt stress `beta C : dE/dt` is added to the force (and no energy is returned), if the material
    /// has one.
    fn internal_force(
        &self,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64;

    /// Tangent `d force/dq`, symmetric, by columns into `tangent` (both triangles).
    fn tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut Scratch);

    /// Derivative of the Kelvin-Voigt force by the velocities, symmetric, by columns into `tangent`.
    fn viscous_tangent(&self, _: &[f64], tangent: &mut [f64], _: &mut Scratch) {
        tangent.fill(0.0);
    }
}

/// Constant matrices of one element in scaled coordinates, each `3 n_nodes n_vectors` square.
#[derive(Debug, Clone)]
pub struct ElementMatrices {
    /// `M`, symmetric positive definite; kg.
    pub mass: Mat<f64>,
    /// `G` per unit spin speed, skew for axisymmetric sections; kg.
    pub gyroscopic: Mat<f64>,
    /// `N` per unit spin speed squared, symmetric; kg.
    pub spin_softening: Mat<f64>,
    /// `K0`, the stiffness about the undeformed state, symmetric; N/m.
    pub stiffness: Mat<f64>,
    /// Geometric stiffness of the initial stress, symmetric, N/m; `None` without one.
    pub initial_stress: Option<Mat<f64>>,
}

impl ElementMatrices {
    /// Matrices of an element of the given length (m); `reference_length` is R (m).
    pub fn new(
        kind: ElementKind,
        section: &Section,
        material: &Material,
        length: f64,
        reference_length: f64,
    ) -> Self {
        Self::with_kinks((kind, &Kinks::NONE), section, material, length, reference_length)
    }

    /// [`Self::new`] of an element that has kinked functions beside those of its member.
    pub fn with_kinks(
        (kind, kinks): (ElementKind, &Kinks),
        section: &Section,
        material: &Material,
        length: f64,
        reference_length: f64,
    ) -> Self {
        let plane = basis::SectionProducts::with_kinks(kind.basis, kinks, section, reference_length);
        Self::on(&plane, kind, (section, material), &Carried::default(), length)
    }

    /// Matrices of an element on a section whose products are there.
    pub fn on(
        plane: &basis::SectionProducts,
        kind: ElementKind,
        of: (&Section, &Material),
        carried: &Carried,
        length: f64,
    ) -> Self {
        let axial = basis::AxialProducts::new(kind.axial_degree, length);
        Self::along(&axial, plane, kind, of, carried)
    }

    /// Matrices of an element whose section changes linearly from its left to its right face: at as many stations as make the
    /// integrals along it exact, each with the products of its own section. Source: docs/theory/elements.md#tapers.
    pub fn tapered(
        (kind, kinks): (ElementKind, &Kinks),
        (faces, material): ([&Section; 2], &Material),
        carried: &Carried,
        length: f64,
        reference_length: f64,
    ) -> Self {
        let mut sum: Option<Self> = None;
        for station in quadrature::gauss(taper::linear_stations(kind, kinks)) {
            let section = taper::at(faces, station.0);
            let plane = basis::SectionProducts::with_kinks(kind.basis, kinks, &section, reference_length);
            let axial = basis::AxialProducts::at_station(kind.axial_degree, length, station);
            let part = Self::along(&axial, &plane, kind, (&section, material), carried);
            match &mut sum {
                None => sum = Some(part),
                Some(sum) => sum.add(&part),
            }
        }
        sum.unwrap_or_else(|| Self::with_kinks((kind, kinks), faces[0], material, length, reference_length))
    }

    fn add(&mut self, part: &Self) {
        self.mass += &part.mass;
        self.gyroscopic += &part.gyroscopic;
        self.spin_softening += &part.spin_softening;
        self.stiffness += &part.stiffness;
        if let (Some(sum), Some(part)) = (&mut self.initial_stress, &part.initial_stress) {
            *sum += part;
        }
    }

    /// Stiffness at rest with that of the initial stress, N/m.
    pub fn stiffness_at_rest(&self) -> Mat<f64> {
        match &self.initial_stress {
            Some(initial) => &self.stiffness + initial,
            None => self.stiffness.clone(),
        }
    }

    fn along(
        axial: &basis::AxialProducts,
        plane: &basis::SectionProducts,
        kind: ElementKind,
        (section, material): (&Section, &Material),
        carried: &Carried,
    ) -> Self {
        let reference_length = plane.reference_length;
        let stiffness = match kind.law {
            Law::Continuum => continuum::stiffness(&continuum::isotropic(material), axial, plane),
            Law::Split => continuum::split_stiffness(section, material, axial, plane),
            Law::Structural => structural_3333s::stiffness(section, material, axial, reference_length),
        };
        let mut matrices = Self {
            mass: inertia::mass(material.density, axial, plane),
            gyroscopic: inertia::gyroscopic(material.density, axial, plane),
            spin_softening: inertia::spin_softening(material.density, axial, plane),
            stiffness,
            initial_stress: carried::initial_stress(carried, section, axial, plane),
        };
        if carried.added_mass != 0.0 {
            carried::add_mass(carried.added_mass, axial, plane, &mut matrices);
        }
        matrices
    }
}
