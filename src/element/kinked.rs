//! Elements with kinked functions: cell by cell across the section, where every function is a polynomial.
//!
//! The radii of the kinks part a round section into cells: a core, in which 34Xn has its monomials alone, and rings. On a
//! ring every function is a sum of terms `p(s) wave(m theta)`, so that the ring kernel integrates it exactly; matrices and
//! forces of the section are sums over its cells. Source: docs/theory/steps.md#cells.

use crate::element::Kernel;
use crate::element::basis::SectionProducts;
use crate::element::kernel::simd::Scratch;
use crate::element::polynomial::NonlinearElement;
use crate::element::ring::{Over, RingElement};
use crate::element::ring_functions::{self, RingFunctions, Sums, Term};
use crate::instructions::Instructions;
use crate::model::{ElementKind, Material, Quadrature};
use crate::section::Section;
use crate::section::basis::{SectionBasis, exponents};
use crate::section::kinks::{HARMONICS, Kinks};
use faer::Mat;

/// The functions of a round section on one ring between two radii (m).
fn on_ring(
    basis: SectionBasis,
    kinks: &Kinks,
    section: &Section,
    cell: &Section,
    reference_length: f64,
) -> Vec<Vec<Term>> {
    let ring = RingFunctions::new(cell);
    let mut list = match basis {
        SectionBasis::Monomials(order) => {
            exponents(order).into_iter().map(|e| monomial(&ring, e, reference_length)).collect()
        }
        SectionBasis::Ring { degree, harmonics } => {
            let whole = RingFunctions::new(section);
            let terms = whole.terms(degree, harmonics, reference_length);
            terms.into_iter().map(|term| vec![moved(&whole, &ring, term)]).collect::<Vec<_>>()
        }
    };
    let size = ring.outer[0];
    for f in kinks.functions() {
        let value = f.polynomial(ring.mean * size, ring.half * size);
        list.push(match value.is_empty() {
            true => Vec::new(),
            false => vec![ring.term(value, f.waves, f.sine)],
        });
    }
    list
}

/// A term over one ring as a polynomial in the wall coordinate of another one.
fn moved(from: &RingFunctions, to: &RingFunctions, term: Term) -> Term {
    // s of the one by that of the other
    let ratio = to.outer[0] / from.outer[0];
    let (constant, linear) = ((to.mean * ratio - from.mean) / from.half, to.half * ratio / from.half);
    let value = term.value.iter().rev().fold(Vec::new(), |p: Vec<f64>, c| {
        let at = |e: usize| p.get(e).copied().unwrap_or(0.0);
        let mut next: Vec<f64> =
            (0..=p.len()).map(|e| constant * at(e) + if e > 0 { linear * at(e - 1) } else { 0.0 }).collect();
        next[0] += c;
        next.truncate(term.value.len());
        next
    });
    to.term(value, term.waves, term.sine)
}

/// `eta^a zeta^b / (a! b!)` as terms: a power of rho times the waves of `cos^a sin^b`.
fn monomial(ring: &RingFunctions, (a, b): (usize, usize), reference_length: f64) -> Vec<Term> {
    let factorials = (1..=a).chain(1..=b).map(|k| k as f64).product::<f64>();
    let scale = ring.outer[0] / reference_length;
    let mut radial = vec![1.0 / factorials];
    for _ in 0..a + b {
        radial = ring.times_rho(&radial).iter().map(|c| c * scale).collect();
    }
    // coefficients of cosines and sines of 0, 1, .. waves
    let mut waves = vec![[0.0; 2]; a + b + 2];
    waves[0][0] = 1.0;
    for factor in std::iter::repeat_n(false, a).chain(std::iter::repeat_n(true, b)) {
        let mut next = vec![[0.0; 2]; waves.len()];
        let mut add = |m: isize, sine: bool, c: f64| {
            let sign = if sine { m.signum() as f64 } else { 1.0 };
            if let Some(entry) = next.get_mut(m.unsigned_abs()) {
                entry[usize::from(sine)] += sign * c / 2.0;
            }
        };
        for (m, &[cos, sin]) in waves.iter().enumerate() {
            let m = m as isize;
            if factor {
                // cos m sin 1 = (sin(m+1) - sin(m-1))/2, sin m sin 1 = (cos(m-1) - cos(m+1))/2
                add(m + 1, true, cos);
                add(m - 1, true, -cos);
                add(m - 1, false, sin);
                add(m + 1, false, -sin);
            } else {
                add(m + 1, false, cos);
                add(m - 1, false, cos);
                add(m + 1, true, sin);
                add(m - 1, true, sin);
            }
        }
        waves = next;
    }
    let mut terms = Vec::new();
    for (m, pair) in waves.iter().enumerate() {
        for (sine, c) in [(false, pair[0]), (true, pair[1])] {
            if c != 0.0 {
                terms.push(ring.term(radial.iter().map(|r| c * r).collect(), m, sine));
            }
        }
    }
    terms
}

/// Largest power of s and largest number of waves of the functions on a ring.
fn degrees(basis: SectionBasis, kinks: &Kinks) -> (usize, usize) {
    let (degree, harmonics) = match basis {
        SectionBasis::Monomials(order) => (order, order),
        SectionBasis::Ring { degree, harmonics } => (degree, harmonics),
    };
    (kinks.iter().map(|k| k.degree).fold(degree, usize::max), harmonics.max(HARMONICS))
}

/// Core (radius in m; none for rings) and rings of a round section.
fn cells(section: &Section, kinks: &Kinks) -> (Option<Section>, Vec<Section>) {
    let of = |[inner, outer]: [f64; 2]| Section::tube(outer, inner);
    let mut all: Vec<Section> = kinks.cells(section.inner[0], section.outer[0]).into_iter().map(of).collect();
    let core = (!section.is_hollow()).then(|| all.remove(0));
    (core, all)
}

/// Products of the functions of a round section with kinks.
pub fn products(
    basis: SectionBasis,
    kinks: &Kinks,
    section: &Section,
    reference_length: f64,
) -> ring_functions::Products {
    let (core, rings) = cells(section, kinks);
    let n = basis.count() + kinks.count();
    let mut sums: Sums = [(); 16].map(|()| Mat::zeros(n, n));
    if let Some(core) = core {
        let of_core = SectionProducts::new(basis, &core, reference_length);
        let mut add = |place: usize, matrix: &Mat<f64>| {
            for l in 0..matrix.ncols() {
                for k in 0..matrix.nrows() {
                    sums[place][(k, l)] += matrix[(k, l)];
                }
            }
        };
        (0..3).for_each(|a| (0..3).for_each(|b| add(4 * a + b, of_core.gradient(a, b))));
        add(3, &of_core.rotation);
        add(15, &of_core.rotation_rotation);
    }
    let (degree, harmonics) = degrees(basis, kinks);
    for cell in rings {
        let terms = on_ring(basis, kinks, section, &cell, reference_length);
        let ring = RingFunctions::new(&cell);
        let at = |rho, theta| ring.of_terms(&terms, rho, theta);
        let of_ring = ring.sums(n, 2 * degree + 2, harmonics, &at);
        sums.iter_mut().zip(of_ring).for_each(|(sum, part)| *sum += part);
    }
    let odd: Vec<[bool; 2]> = basis.odd().into_iter().chain(kinks.odd()).collect();
    ring_functions::clean(&sums, &odd, true)
}

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
    /// Tables for an element of the given length (m) on a round section; `reference_length` is R (m).
    pub fn new(
        (kind, kinks): (ElementKind, &Kinks),
        section: &Section,
        material: &Material,
        length: f64,
        reference_length: f64,
        (quadrature, instructions): (Quadrature, Instructions),
    ) -> Self {
        let (core, rings) = cells(section, kinks);
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
        let of_ring = |ring: Section| {
            let all = on_ring(kind.basis, kinks, section, &ring, reference_length);
            let vectors: Vec<usize> = (0..n_vectors).filter(|&k| !all[k].is_empty()).collect();
            let functions = all.into_iter().filter(|terms| !terms.is_empty()).collect();
            let over = Over { section: &ring, degree, harmonics, functions };
            let element = RingElement::of_functions(kind.axial_degree, over, material, length, quadrature);
            cell(Box::new(element.with_instructions(instructions)), vectors)
        };
        let cells = core.into_iter().map(of_core).chain(rings.into_iter().map(of_ring)).collect();
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
