//! `"element": "auto"`: the member that suits a segment, with a cheap estimate of what its section functions miss.
//!
//! Slender solids that do not spin up take the order that bends and twists them, radial growth and thick shafts take a
//! higher one, walls take rings. The estimates are fitted to errors of section and shaft that are measured elsewhere;
//! a mesh that is too coarse adds its own. Source: docs/theory/rings.md#automatic-choice.

use crate::section::basis::SectionBasis;
use crate::section::{Section, Shape};

/// Relative error that an automatic choice aims at.
const AIM: f64 = 1e-3;
/// Highest radial degree that is chosen: within [`AIM`] from bore over rim .1.
const HIGHEST: usize = 9;
/// Most that 34X5 misses of the growth of a tube: bore over rim .25 in docs/convergence.md.
const HOLLOW: f64 = 0.13;

/// A chosen member, why, and the estimate of its relative error.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Functions over the section.
    pub basis: SectionBasis,
    /// Why this member was chosen, in words for the report.
    pub reason: &'static str,
    /// Relative error of bending, torsion and growth that the functions leave.
    pub estimate: f64,
}

/// What of the case bears upon a choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demands {
    /// Length of the shaft, m.
    pub length: f64,
    /// Bending half waves along the shaft that count.
    pub half_waves: f64,
    /// Whether the shaft spins up, so that growth counts.
    pub spins_up: bool,
    /// Poisson's ratio of the material.
    pub poisson_ratio: f64,
}

/// Error of 34X2 and of 34X3 or 34X4 in bending with `n` half waves over a solid of radius r and length L, by
/// `(n r / L)`: the warping by shear that quadratic, and by its own change that cubic functions lack.
const BENDING: [(f64, i32); 2] = [(0.32, 2), (0.9, 4)];

/// The member that suits a taper between two sections: that of the larger one if both are solid.
pub fn choose_taper(faces: [&Section; 2], demands: Demands) -> Choice {
    if faces.iter().any(|face| face.is_hollow()) {
        return Choice {
            basis: SectionBasis::Monomials(5),
            reason: "hollow and tapered: the functions of a ring belong to one section",
            estimate: HOLLOW,
        };
    }
    let [a, b] = faces;
    choose(if a.outer_size() >= b.outer_size() { a } else { b }, demands)
}

/// The member that suits a section.
pub fn choose(section: &Section, demands: Demands) -> Choice {
    if section.is_ring() {
        return ring(section, demands.poisson_ratio);
    }
    if section.is_hollow() {
        return Choice {
            basis: SectionBasis::Monomials(5),
            reason: "hollow, but its bore is not similar to its outline: no ring",
            estimate: HOLLOW,
        };
    }
    let waves = demands.half_waves * section.outer_size() / demands.length;
    let [quadratic, cubic] = BENDING.map(|(factor, power)| factor * waves.powi(power));
    let solid = |order, reason, estimate: f64| Choice {
        basis: SectionBasis::Monomials(order),
        reason,
        estimate: estimate.max(1e-6),
    };
    if section.shape == Shape::Rectangle {
        // half of what the torsion constant is too high with quartic warping
        let [a, b] = section.outer;
        let flat = 1.0 - a.min(b) / a.max(b);
        let torsion = 6e-4 + 0.017 * flat * flat;
        return solid(4, "a rectangle, whose warping in torsion is quartic and more", cubic.max(torsion));
    }
    if cubic > AIM {
        return solid(5, "solid and thick for the waves along it", cubic * waves * waves);
    }
    if demands.spins_up {
        return solid(3, "solid; its radial growth is cubic", cubic);
    }
    if quadratic <= AIM {
        return solid(2, "solid and slender", quadratic);
    }
    solid(3, "solid, with waves along it short enough for shear", cubic)
}

/// Rings by the growth `~ 1/r` that Legendre polynomials across the wall leave.
fn ring(section: &Section, poisson_ratio: f64) -> Choice {
    // degree 1 would not ovalise
    let degree = (2..HIGHEST).find(|d| missed(section, poisson_ratio, *d) <= AIM).unwrap_or(HIGHEST);
    let reason = match degree {
        2 => "hollow; the ring family bends and ovalises a wall within about 1 % (34X3: 64 % off)",
        HIGHEST => "hollow with a bore so narrow that no radial degree resolves the growth at its edge",
        _ => "hollow with a thick wall, whose growth needs a higher radial degree (34X3: 26 % off)",
    };
    of_degree(section, poisson_ratio, degree, reason)
}

/// `4 d q^-2d` with the sum q of the half axes of the largest ellipse about the wall that does not hold r = 0, more for
/// materials that are stiffer in volume than those with a Poisson's ratio of .3.
fn missed(section: &Section, poisson_ratio: f64, degree: usize) -> f64 {
    /// `(1 - nu)/(1 - 2 nu)` to which the estimate is fitted.
    const VOLUME: f64 = 1.6;
    let root = (section.inner[0] / section.outer[0]).sqrt();
    let q = (1.0 + root) / (1.0 - root);
    let volume = (1.0 - poisson_ratio) / (1.0 - 2.0 * poisson_ratio) / VOLUME;
    4.0 * degree as f64 * q.powi(-2 * degree as i32) * volume.max(1.0)
}

fn of_degree(section: &Section, poisson_ratio: f64, degree: usize, reason: &'static str) -> Choice {
    let estimate = missed(section, poisson_ratio, degree).max(1e-6);
    Choice { basis: SectionBasis::Ring { degree, harmonics: 3 }, reason, estimate }
}

/// A choice with the section and Poisson's ratio it was made for.
pub type Chosen = (Choice, Section, f64);

/// Gives chosen rings that meet one degree, the highest among them: both sides of a joint then share all functions.
pub fn level(chosen: &mut [Option<Chosen>]) {
    let degree = |c: &Option<Chosen>| match c {
        Some((Choice { basis: SectionBasis::Ring { degree, .. }, .. }, ..)) => Some(*degree),
        _ => None,
    };
    let mut start = 0;
    while start < chosen.len() {
        let end = start + chosen[start..].iter().take_while(|c| degree(c).is_some()).count();
        if let Some(highest) = chosen[start..end].iter().filter_map(degree).max() {
            for (choice, section, poisson_ratio) in chosen[start..end].iter_mut().flatten() {
                if choice.basis != (SectionBasis::Ring { degree: highest, harmonics: 3 }) {
                    let reason = "hollow, of the radial degree of the walls it meets: their joints share all functions";
                    *choice = of_degree(section, *poisson_ratio, highest, reason);
                }
            }
        }
        start = end.max(start + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(bore: f64) -> Option<Chosen> {
        let section = Section::tube(1.0, bore);
        let demands = Demands { length: 10.0, half_waves: 3.0, spins_up: false, poisson_ratio: 0.3 };
        Some((choose(&section, demands), section, 0.3))
    }

    #[test]
    fn rings_that_meet_take_the_highest_degree() {
        let mut list = [chosen(0.2), chosen(0.8), None, chosen(0.8)];
        level(&mut list);
        let degrees: Vec<Option<usize>> = list
            .iter()
            .map(|c| {
                c.as_ref().map(|(c, ..)| match c.basis {
                    SectionBasis::Ring { degree, .. } => degree,
                    SectionBasis::Monomials(_) => 0,
                })
            })
            .collect();
        assert_eq!(degrees, [Some(6), Some(6), None, Some(2)]);
    }
}
