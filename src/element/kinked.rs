//! Elements with kinked functions: forces and tangents cell by cell across the section.
//!
//! On a ring between two kinks every function is a sum of terms that the ring kernel integrates exactly; the core of a solid
//! section has the polynomial kernel. Forces and tangents of the section are sums over its cells. Source:
//! docs/theory/steps.md#cells.

use crate::element::Kernel;
use crate::element::cells::{cells, degrees, on_ring};
use crate::element::kernel::simd::Scratch;
use crate::element::kernel::stations::Stations;
use crate::element::polynomial::NonlinearElement;
use crate::element::quadrature::gauss;
use crate::element::ring::{Over, RingElement};
use crate::element::taper;
use crate::instructions::Instructions;
use crate::model::{ElementKind, Material, Quadrature};
use crate::section::Section;
use crate::section::kinks::Kinks;

/// A part of the section between two radii, with the vectors whose functions do not vanish there.
struct Cell {
    kernel: Box<dyn Kernel>,
    /// For each of its coordinates that of the element.
    coordinates: Vec<usize>,
}

/// Nonlinear forces of an element with kinks: sums over its cells.
pub struct KinkedElement {
    size: usize,
    cells: Vec<Cell>,
}

impl KinkedElement {
    /// Tables for an element of the given length (m) on a round section, that of both faces or changing linearly between them;
    /// `reference_length` is R (m).
    ///
    /// A ring of a taper that changes along it is integrated station by station, each with the ring that is there.
    pub fn new(
        (kind, kinks): (ElementKind, &Kinks),
        faces: [&Section; 2],
        material: &Material,
        length: f64,
        reference_length: f64,
        (quadrature, instructions): (Quadrature, Instructions),
    ) -> Self {
        let section = faces[0];
        let (core, rings) = cells(section, kinks);
        let ends = cells(faces[1], kinks).1;
        let (degree, harmonics) = degrees(kind.basis, kinks);
        let n_vectors = kind.n_vectors() + kinks.count();
        let cell = |kernel: Box<dyn Kernel>, vectors: Vec<usize>| {
            let of_node = |node| vectors.iter().map(move |k| node * n_vectors + k);
            let vectors = (0..kind.n_nodes()).flat_map(of_node);
            Cell { kernel, coordinates: vectors.flat_map(|k| (0..3).map(move |c| 3 * k + c)).collect() }
        };
        let of_core = |core: Section| {
            let element = NonlinearElement::new(kind, &core, material, length, reference_length, quadrature);
            cell(Box::new(element.with_instructions(instructions)), (0..kind.n_vectors()).collect())
        };
        let at_stations = |ring: &Section, points: &[(f64, f64)]| {
            let all = on_ring(kind.basis, kinks, section, ring, reference_length);
            let vectors: Vec<usize> = (0..n_vectors).filter(|&k| !all[k].is_empty()).collect();
            let functions = all.into_iter().filter(|terms| !terms.is_empty()).collect();
            let over = Over { section: ring, degree, harmonics, functions };
            let stations = Stations::of(kind.axial_degree, length, points);
            let element = RingElement::of_functions(stations, over, material, quadrature);
            cell(Box::new(element.with_instructions(instructions)), vectors)
        };
        let of_ring = |(left, right): (Section, Section)| {
            if left == right {
                // the integrand holds four factors of the axial degree
                let count = quadrature.axial.unwrap_or(2 * kind.axial_degree + 1);
                return vec![at_stations(&left, &gauss(count))];
            }
            let count = quadrature.axial.unwrap_or(taper::nonlinear_stations(kind, kinks));
            let station = |point: (f64, f64)| at_stations(&taper::at([&left, &right], point.0), &[point]);
            gauss(count).into_iter().map(station).collect()
        };
        let rings = rings.into_iter().zip(ends).flat_map(of_ring);
        let cells = core.into_iter().map(of_core).chain(rings).collect();
        Self { size: 3 * kind.n_nodes() * n_vectors, cells }
    }

    /// Sums the matrices that the cells write.
    fn add_up(&self, q: &[f64], sum: &mut [f64], mut write: impl FnMut(&dyn Kernel, &[f64], &mut [f64])) {
        sum.fill(0.0);
        let mut part = vec![0.0; sum.len()];
        for Cell { kernel, coordinates } in &self.cells {
            let (local, n) = (gather(q, coordinates), coordinates.len());
            write(kernel.as_ref(), &local, &mut part[..n * n]);
            for (column, &j) in part.chunks_exact(n).zip(coordinates) {
                let sum = &mut sum[j * self.size..][..self.size];
                column.iter().zip(coordinates).for_each(|(value, &i)| sum[i] += value);
            }
        }
    }
}

/// Some of the coordinates.
fn gather(q: &[f64], coordinates: &[usize]) -> Vec<f64> {
    coordinates.iter().map(|&i| q[i]).collect()
}

impl Kernel for KinkedElement {
    fn size(&self) -> usize {
        self.size
    }

    fn internal_force(
        &self,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64 {
        force.fill(0.0);
        let mut energy = 0.0;
        let mut part = vec![0.0; self.size];
        for Cell { kernel, coordinates } in &self.cells {
            let local = gather(q, coordinates);
            let velocity = velocity.map(|v| gather(v, coordinates));
            let part = &mut part[..coordinates.len()];
            energy += kernel.internal_force(&local, velocity.as_deref(), part, scratch);
            part.iter().zip(coordinates).for_each(|(f, &i)| force[i] += f);
        }
        energy
    }

    fn tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut Scratch) {
        self.add_up(q, tangent, |cell, q, part| cell.tangent(q, part, scratch));
    }

    fn viscous_tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut Scratch) {
        self.add_up(q, tangent, |cell, q, part| cell.viscous_tangent(q, part, scratch));
    }
}
