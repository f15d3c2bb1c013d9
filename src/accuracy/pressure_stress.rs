//! Stresses of long bodies under pressure on bore and rim: Lame's closed form, and how much of it the functions of a section
//! reach.
//!
//! A long circle or tube, bore a and rim b, under the pressures p_a and p_b, linear elasticity:
//!
//! ```text
//!     sigma_r = A - B / r^2,   sigma_t = A + B / r^2,   A = (p_a a^2 - p_b b^2) / (b^2 - a^2),   B = (p_a - p_b) a^2 b^2 / (b^2 - a^2)
//! ```
//!
//! whatever the uniform axial strain. Source: G. Lame, as in Timoshenko and Goodier, Theory of Elasticity, section 28.

use crate::accuracy::radial_growth::long_body;
use crate::element::boundary_curve::line;
use crate::element::continuum::lame;
use crate::element::fields::SectionFunctions;
use crate::model::{Law, Material, Model, SurfaceLoad};
use crate::results::Diagnostic;
use crate::section::basis::SectionBasis;
use crate::section::{Section, Surface};

/// Share of the largest stress, of either kind, that may be missing without a word.
const POOR_STRESS: f64 = 1e-2;
/// Radial degrees among which a remedy is looked for.
const DEGREES: std::ops::RangeInclusive<usize> = 2..=6;

/// Radial and hoop stress, Pa.
pub type Stresses = [f64; 2];

/// Lame's stresses at radius r (m) under the pressures (Pa) on bore and rim; none for other shapes.
pub fn closed_form(section: &Section, [on_bore, on_rim]: [f64; 2], r: f64) -> Option<Stresses> {
    if !section.is_axisymmetric() {
        return None;
    }
    let [a2, b2] = [section.inner[0], section.outer[0]].map(|c| c * c);
    let uniform = (on_bore * a2 - on_rim * b2) / (b2 - a2);
    let turned = if a2 > 0.0 { (on_bore - on_rim) * a2 * b2 / (b2 - a2) / (r * r) } else { 0.0 };
    Some([uniform - turned, uniform + turned])
}

/// The same of a long body with the functions of a basis over its section, at bore and rim (a circle: the rim twice).
pub fn in_functions(
    section: &Section,
    material: &Material,
    basis: SectionBasis,
    pressures: [f64; 2],
) -> Option<[Stresses; 2]> {
    let push = |functions: &SectionFunctions| {
        let mut forces = [0, 1].map(|_| vec![0.0; basis.count()]);
        for (surface, p) in [Surface::Bore, Surface::Rim].into_iter().zip(pressures) {
            let line = line(section, surface);
            for (c, forces) in forces.iter_mut().enumerate() {
                let sums = functions.along_any(&line, |point| -p * point.normal[c]);
                forces.iter_mut().zip(sums).for_each(|(f, s)| *f += s);
            }
        }
        forces
    };
    let (functions, u) = long_body(section, material, basis, push)?;
    let (lambda, mu) = lame(material);
    let axial = u[u.len() - 1];
    let stresses = |r: f64| {
        let slopes = functions.at(r, 0.0);
        let strain = |c: usize| slopes.iter().enumerate().map(|(i, f)| f[1 + c] * u[2 * i + c]).sum::<f64>();
        let (radial, hoop) = (strain(0), strain(1));
        let mean = lambda * (radial + hoop + axial);
        [mean + 2.0 * mu * radial, mean + 2.0 * mu * hoop]
    };
    Some(radii(section).map(stresses))
}

fn radii(section: &Section) -> [f64; 2] {
    let rim = section.outer[0];
    [if section.is_hollow() { section.inner[0] } else { rim }, rim]
}

/// Stresses at bore and rim: those in the functions of a basis, Lame's, and the largest error over the largest stress.
#[derive(Debug, Clone, Copy)]
pub struct Missed {
    /// Stresses that the functions of the section give at bore and rim, Pa.
    pub ours: [Stresses; 2],
    /// Stresses of Lame's solution at bore and rim, Pa.
    pub exact: [Stresses; 2],
    /// Largest error over the largest stress.
    pub share: f64,
}

/// What the functions of a basis miss of the stresses under the pressures (Pa) on bore and rim; none for other shapes.
pub fn missed(
    section: &Section,
    material: &Material,
    basis: SectionBasis,
    pressures: [f64; 2],
) -> Option<Missed> {
    let [at_bore, at_rim] = radii(section).map(|r| closed_form(section, pressures, r));
    let exact = [at_bore?, at_rim?];
    let ours = in_functions(section, material, basis, pressures)?;
    let (mut error, mut largest) = (0.0f64, f64::MIN_POSITIVE);
    for (a, b) in ours.iter().flatten().zip(exact.iter().flatten()) {
        (error, largest) = (error.max((a - b).abs()), largest.max(b.abs()));
    }
    Some(Missed { ours, exact, share: error / largest })
}

/// Pressures on the whole bore and the whole rim, Pa.
fn pressures(model: &Model) -> [f64; 2] {
    [Surface::Bore, Surface::Rim].map(|surface| {
        let on = |t: &crate::model::Traction| match t.load {
            SurfaceLoad::Pressure(p) if t.surface == surface => p,
            _ => 0.0,
        };
        model.tractions.iter().map(on).sum()
    })
}

/// Warns of circles and tubes whose functions miss the stress that the pressures of the case make by more than 1 %, with the
/// ring that would not.
pub fn pressure_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    let pressures = pressures(model);
    if pressures == [0.0; 2] {
        return;
    }
    let mut seen: Vec<(usize, usize, SectionBasis)> = Vec::new();
    for e in &model.elements {
        let (section, material) = (&model.sections[e.section], &model.materials[e.material]);
        let key = (e.section, e.material, e.kind.basis);
        if seen.contains(&key) || e.kind.law != Law::Continuum {
            continue;
        }
        seen.push(key);
        let of = |basis| missed(section, material, basis, pressures);
        let Some(now) = of(e.kind.basis).filter(|m| m.share > POOR_STRESS) else { continue };
        let harmonics = match e.kind.basis {
            SectionBasis::Ring { harmonics, .. } => harmonics,
            SectionBasis::Monomials(_) => 3,
        };
        // stresses that are alike all around are those of any number of waves
        let does = |degree: &usize| {
            of(SectionBasis::Ring { degree: *degree, harmonics: 1 }).is_some_and(|m| m.share <= POOR_STRESS)
        };
        let degree = DEGREES.clone().find(does).filter(|_| section.is_ring());
        let remedy = degree.map_or_else(
            || "no member does: read stresses from Lame's closed form".to_owned(),
            |degree| format!("{} would keep within 1 %", SectionBasis::Ring { degree, harmonics }.member()),
        );
        let told = |kind: usize| {
            // a surface without pressure has none, whatever rounding leaves
            let pressure = pressures[0].abs().max(pressures[1].abs());
            let shown = |p: f64| if p.abs() < 1e-9 * pressure { "0".to_owned() } else { format!("{p:.3e}") };
            let [bore, rim] = [0, 1]
                .map(|at| format!("{} for {} Pa", shown(now.ours[at][kind]), shown(now.exact[at][kind])));
            format!("{bore} at the bore and {rim} at the rim")
        };
        diagnostics.push(Diagnostic::warning(
            "pressure-stress",
            format!(
                "{} misses {:.0} % of the largest stress that the pressure makes in the tube {}/{} (Lame): radial {}, hoop {}; {remedy}",
                e.kind.name(),
                100.0 * now.share,
                section.outer[0],
                section.inner[0],
                told(0),
                told(1)
            ),
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material {
        youngs_modulus: 2.1e11,
        poisson_ratio: 0.3,
        density: 7850.0,
        stiffness_damping: 0.0,
        loss_factor: 0.0,
        mass_damping: 0.0,
    };

    fn ring(degree: usize) -> SectionBasis {
        SectionBasis::Ring { degree, harmonics: 3 }
    }

    #[test]
    fn the_closed_form_meets_its_pressures() {
        let tube = Section::tube(0.2, 0.1);
        let [bore, rim] = [0.1, 0.2].map(|r| closed_form(&tube, [3.0, 1.0], r).unwrap());
        assert!((bore[0] + 3.0).abs() < 1e-14 && (rim[0] + 1.0).abs() < 1e-14);
        // hoop at the bore under pressure there alone: (a^2 + b^2) / (b^2 - a^2)
        assert!((closed_form(&tube, [1.0, 0.0], 0.1).unwrap()[1] - 5.0 / 3.0).abs() < 1e-14);
    }

    #[test]
    fn low_degrees_miss_the_stress_at_a_bore() {
        let tube = Section::tube(0.2, 0.1);
        let at_bore = |degree| in_functions(&tube, &STEEL, ring(degree), [1.0, 0.0]).unwrap()[0][0];
        assert!((at_bore(2) + 0.59).abs() < 5e-3, "{}", at_bore(2));
        let errors: Vec<f64> =
            (1..=6).map(|d| missed(&tube, &STEEL, ring(d), [1.0, 0.0]).unwrap().share).collect();
        assert!(errors.windows(2).all(|e| e[1] < 0.6 * e[0]) && errors[5] < 1e-2, "{errors:?}");
    }

    #[test]
    fn uniform_stress_is_nobodys_fault() {
        for basis in [ring(1), ring(2), SectionBasis::Monomials(1), SectionBasis::Monomials(3)] {
            let tube = missed(&Section::tube(0.2, 0.1), &STEEL, basis, [1.0, 1.0]).unwrap();
            assert!(tube.share < 1e-10, "{basis:?} {tube:?}");
        }
        let circle = missed(&Section::circle(0.2), &STEEL, SectionBasis::Monomials(2), [0.0, 1.0]).unwrap();
        assert!(circle.share < 1e-10, "{circle:?}");
    }
}
