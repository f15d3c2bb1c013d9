//! Tapered elements: sections at stations along them, and how many stations integrate them exactly.
//!
//! The functions of 34Xn and kinked ones do not depend on the section, so a taper changes the area of integration alone.
//! Where all lengths of a section go linearly along the element, its moments are polynomials in x. Source:
//! docs/theory/elements.md#tapers.

use crate::element::cells::degrees;
use crate::model::ElementKind;
use crate::section::Section;
use crate::section::kinks::Kinks;

/// Stations more for kinked functions: what they have over the radius makes logarithms of it.
const OF_KINKS: usize = 4;

/// The section at xi (-1 to 1) between the faces of an element.
pub fn at([left, right]: [&Section; 2], xi: f64) -> Section {
    left.between(right, (1.0 + xi) / 2.0)
}

/// Gauss stations that mass and stiffness take: two factors of the axial degree p, and a moment of degree `2 n + 2`.
pub fn linear_stations(kind: ElementKind, kinks: &Kinks) -> usize {
    let (degree, _) = degrees(kind.basis, kinks);
    kind.axial_degree + degree + 2 + of_kinks(kinks)
}

/// Gauss stations that the nonlinear force takes: four factors F, along x of degree p in all but their own direction, which
/// has the degree n of the section less one: `4 p + 4 n - 2` with the area.
pub fn nonlinear_stations(kind: ElementKind, kinks: &Kinks) -> usize {
    let (degree, _) = degrees(kind.basis, kinks);
    2 * (kind.axial_degree + degree) + of_kinks(kinks)
}

fn of_kinks(kinks: &Kinks) -> usize {
    if kinks.is_empty() { 0 } else { OF_KINKS }
}
