//! Cells of a section with kinks: between the radii of the kinks every function is a polynomial.
//!
//! The radii part a round section into a core, in which 34Xn has its monomials alone, and rings, on which every function is a
//! sum of terms `p(s) wave(m theta)` with the wall coordinate s of the ring. Source: docs/theory/steps.md#cells.

use crate::element::ring_functions::{RingFunctions, Term};
use crate::section::Section;
use crate::section::basis::{SectionBasis, exponents};
use crate::section::kinks::{HARMONICS, Kinks};

/// The functions of a round section on one ring between two radii (m).
pub fn on_ring(
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
pub fn degrees(basis: SectionBasis, kinks: &Kinks) -> (usize, usize) {
    let (degree, harmonics) = match basis {
        SectionBasis::Monomials(order) => (order, order),
        SectionBasis::Ring { degree, harmonics } => (degree, harmonics),
    };
    (kinks.iter().map(|k| k.degree).fold(degree, usize::max), harmonics.max(HARMONICS))
}

/// Core (radius in m; none for rings) and rings of a round section.
pub fn cells(section: &Section, kinks: &Kinks) -> (Option<Section>, Vec<Section>) {
    let of = |[inner, outer]: [f64; 2]| Section::tube(outer, inner);
    let mut all: Vec<Section> = kinks.cells(section.inner[0], section.outer[0]).into_iter().map(of).collect();
    let core = (!section.is_hollow()).then(|| all.remove(0));
    (core, all)
}
