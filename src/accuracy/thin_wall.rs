//! What a hollow section's functions make of its wall: estimates of error that need no run.
//!
//! A long body's section in plane strain is a small eigenproblem of its own. The lowest elastic motion of a tube is
//! its ovalling; a basis is measured against the ring functions of degree 4 with 4 harmonics. Source:
//! docs/theory/rings.md#thin-walls.

use crate::element::basis::SectionProducts;
use crate::element::continuum::lame;
use crate::linalg::dense::{cholesky, self_adjoint};
use crate::model::{Law, Material, Model};
use crate::results::Diagnostic;
use crate::section::Section;
use crate::section::basis::SectionBasis;
use faer::Mat;
use faer::linalg::solvers::Solve;

/// Ring functions that count as exact when the error of others is estimated.
const FINE: SectionBasis = SectionBasis::Ring { degree: 4, harmonics: 4 };
/// Error of the ovalling frequency from which a warning is due.
const POOR: f64 = 0.02;
/// Wall over radius below which the estimate of a thinner wall is that of this one: the error no longer changes.
const THIN: f64 = 2e-3;
/// Decimal digits left of a bending frequency of the wall, below which a warning is due.
const FEW_DIGITS: f64 = 8.0;

/// Lowest elastic frequency (rad/s) of a section in plane strain with the functions of a basis.
pub fn section_frequency(section: &Section, material: &Material, basis: SectionBasis) -> Option<f64> {
    let products = SectionProducts::new(basis, section, section.outer_size());
    let n = basis.count();
    let mass = Mat::from_fn(2 * n, 2 * n, |i, j| {
        if i % 2 == j % 2 { material.density * products.plain()[(i / 2, j / 2)] } else { 0.0 }
    });
    let stiffness = Mat::from_fn(2 * n, 2 * n, |i, j| products.plane_stiffness(lame(material), i, j));
    // largest values of K^-1 M past the three rigid motions, which a small mass term keeps away from zero
    let shift = 1e-9 * material.youngs_modulus / (material.density * section.outer_size().powi(2))
        * (1.0 - section.inner[0] / section.outer[0]).powi(2);
    let shifted = &stiffness + &mass * faer::Scale(shift);
    let l = cholesky(shifted.as_ref())?;
    let half = l.partial_piv_lu().solve(&mass);
    let compliance = l.partial_piv_lu().solve(half.transpose().to_owned());
    let symmetric = Mat::from_fn(2 * n, 2 * n, |i, j| (compliance[(i, j)] + compliance[(j, i)]) / 2.0);
    let (values, _) = self_adjoint(symmetric.as_ref()).ok()?;
    let largest = values.get(2 * n - 4).filter(|v| **v > 0.0)?;
    Some((1.0 / largest - shift).max(0.0).sqrt())
}

/// Relative error of the ovalling frequency of a hollow section with the functions of a basis.
pub fn ovalling_error(section: &Section, material: &Material, basis: SectionBasis) -> Option<f64> {
    if !section.is_ring() {
        return None;
    }
    let share = (section.inner[0] / section.outer[0]).min(1.0 - THIN);
    let wall = Section { inner: section.outer.map(|c| c * share), ..*section };
    Some(section_frequency(&wall, material, basis)? / section_frequency(&wall, material, FINE)? - 1.0)
}

/// Decimal digits that are left of the frequency of a wall that bends without stretching: its stiffness is
/// (t/r)^2 of the numbers that cancel in it.
pub fn digits_left(section: &Section) -> f64 {
    let wall = (0..2).map(|i| 1.0 - section.inner[i] / section.outer[i]).fold(1.0, f64::min);
    15.0 + 2.0 * wall.log10()
}

/// Elements the program chose, polynomials on a wall, and walls so thin that they lose digits.
pub fn wall_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    // segments that are alike share a line
    let mut told: Vec<(&str, Vec<String>)> = Vec::new();
    for choice in &model.choices {
        let segment = choice.segment.to_string();
        match told.iter_mut().find(|(text, _)| *text == choice.text) {
            Some((_, segments)) => segments.push(segment),
            None => told.push((&choice.text, vec![segment])),
        }
    }
    diagnostics.extend(told.into_iter().map(|(text, segments)| {
        let of = if segments.len() == 1 { "segment" } else { "segments" };
        Diagnostic::info("element-choice", format!("{of} {}: {text}", segments.join(", ")))
    }));
    // a taper has one name for all its sections
    let mut seen: Vec<(&str, SectionBasis)> = Vec::new();
    for e in &model.elements {
        let (key, section) =
            ((&model.names.sections[e.section][..], e.kind.basis), &model.sections[e.section]);
        if seen.contains(&key) || !section.is_hollow() || e.kind.law != Law::Continuum {
            continue;
        }
        seen.push(key);
        let [a, b] = [section.outer[0], section.inner[0]];
        let digits = digits_left(section);
        if digits < FEW_DIGITS {
            diagnostics.push(Diagnostic::warning(
                "thin-wall",
                format!("the wall of the section {a}/{b} is so thin that about {digits:.0} digits of its bending are left"),
            ));
        }
        if e.kind.basis.is_ring() {
            continue;
        }
        let material = &model.materials[e.material];
        let error = |basis| ovalling_error(section, material, basis);
        let text = match error(e.kind.basis) {
            Some(now) if now < POOR => continue,
            Some(now) if e.is_tapered() => format!(
                "{} puts the ovalling of the hollow taper, {a}/{b} at one place, about {:.0} % too high and bends it too stiffly: a \
                 polynomial section cannot bend a wall, and no ring follows a taper; 34X5 is the best there is, or short straight \
                 tubes",
                e.kind.name(),
                100.0 * now
            ),
            Some(now) => {
                let ring = error(SectionBasis::Ring { degree: 2, harmonics: 3 }).unwrap_or(0.0);
                format!(
                    "{} puts the ovalling of the hollow section {a}/{b} about {:.0} % too high and bends it too stiffly: a \
                     polynomial section cannot bend a wall; 34R23 (\"auto\") would be {:.1} % off",
                    e.kind.name(),
                    100.0 * now,
                    100.0 * ring
                )
            }
            None => format!(
                "{} cannot bend the wall of the hollow section {a}/{b}, and no ring fits it: its bore is not similar to its \
                 outline; 34X5 is the best there is",
                e.kind.name()
            ),
        };
        diagnostics.push(Diagnostic::warning("hollow-section", text));
    }
}
