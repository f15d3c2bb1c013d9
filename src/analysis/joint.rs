//! What a joint of two sections misses in flexibility because both sides share the functions of the section.
//!
//! A long rod with a step is more flexible than its two parts: the wide side carries nothing in the corner behind the
//! step. Shared functions of a low order cannot leave that corner alone. What they miss is written as a piece of the
//! common section, `missing` times its outer radius R long, that stands in for the wide side:
//!
//! ```text
//!     dc = missing R sum over both sides (1/S_common - 1/S_side)       S = E I, G J or E A
//! ```
//!
//! The table holds `missing` for steps of the outer radius and of the bore. It was taken from solids of revolution
//! (nine-node quadratic elements graded into the corner, nu 0.3) less the program's own elements, a rod under a uniform
//! moment, torque or force; tests/suite/steps.rs repeats it. Bores common to both sides change polynomials by less
//! than a tenth up to 0.8 of the radius, rings by the factor of `ring_factor`.

use crate::section::Section;
use crate::section::basis::SectionBasis;

/// What a joint carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pull {
    /// A bending moment.
    Bending,
    /// A torque about the axis of the shaft.
    Torsion,
    /// An axial force.
    Axial,
}

/// Ratios of outer radii of the columns of [`OUTER`]; nothing is missing at 1.
const RATIOS: [f64; 7] = [1.0, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0];
/// Wider bores over the outer radius of the columns of [`BORE`]; nothing is missing at 0.
const BORES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 0.9];

/// Rows: 34X2 (34X1 and the comparison elements alike), 34X3, 34X4, 34X5, then rings of degree 1, 2, 3, 4 and more.
type Rows<const N: usize> = [[f64; N]; 8];

/// Steps of the outer radius: bending, torsion, axial force.
const OUTER: [Rows<6>; 3] = [
    [
        [0.146, 0.227, 0.364, 0.460, 0.518, 0.541],
        [0.084, 0.114, 0.182, 0.312, 0.453, 0.522],
        [0.069, 0.081, 0.132, 0.282, 0.441, 0.517],
        [0.046, 0.058, 0.087, 0.138, 0.324, 0.478],
        [0.154, 0.157, 0.165, 0.181, 0.248, 0.355],
        [0.048, 0.057, 0.100, 0.137, 0.154, 0.216],
        [0.031, 0.047, 0.059, 0.092, 0.139, 0.159],
        [0.027, 0.031, 0.054, 0.063, 0.106, 0.146],
    ],
    [
        [0.087, 0.135, 0.213, 0.267, 0.302, 0.315],
        [0.033, 0.040, 0.088, 0.181, 0.267, 0.307],
        [0.033, 0.040, 0.088, 0.181, 0.267, 0.307],
        [0.019, 0.030, 0.039, 0.066, 0.188, 0.282],
        [0.045, 0.058, 0.068, 0.082, 0.116, 0.167],
        [0.020, 0.029, 0.061, 0.078, 0.082, 0.107],
        [0.017, 0.023, 0.022, 0.044, 0.073, 0.084],
        [0.015, 0.013, 0.021, 0.023, 0.051, 0.077],
    ],
    [
        [0.105, 0.148, 0.217, 0.335, 0.573, 0.859],
        [0.089, 0.113, 0.135, 0.247, 0.513, 0.824],
        [0.058, 0.070, 0.106, 0.135, 0.264, 0.583],
        [0.048, 0.057, 0.102, 0.115, 0.236, 0.564],
        [0.088, 0.118, 0.149, 0.199, 0.328, 0.519],
        [0.047, 0.057, 0.106, 0.148, 0.180, 0.287],
        [0.031, 0.046, 0.057, 0.096, 0.150, 0.188],
        [0.026, 0.031, 0.053, 0.060, 0.107, 0.158],
    ],
];

/// Steps of the bore: bending, torsion, axial force.
const BORE: [Rows<5>; 3] = [
    [
        [0.102, 0.198, 0.266, 0.277, 0.237],
        [0.100, 0.177, 0.181, 0.094, 0.062],
        [0.100, 0.175, 0.171, 0.075, 0.046],
        [0.096, 0.132, 0.070, 0.036, 0.028],
        [0.160, 0.160, 0.160, 0.114, 0.050],
        [0.059, 0.058, 0.056, 0.036, 0.020],
        [0.038, 0.040, 0.042, 0.024, 0.015],
        [0.032, 0.030, 0.027, 0.019, 0.012],
    ],
    [
        [0.056, 0.108, 0.139, 0.131, 0.098],
        [0.055, 0.096, 0.098, 0.052, 0.028],
        [0.055, 0.096, 0.098, 0.052, 0.028],
        [0.053, 0.072, 0.038, 0.023, 0.022],
        [0.046, 0.047, 0.048, 0.029, 0.018],
        [0.029, 0.035, 0.042, 0.027, 0.016],
        [0.024, 0.025, 0.026, 0.013, 0.010],
        [0.022, 0.018, 0.015, 0.010, 0.009],
    ],
    [
        [0.167, 0.229, 0.192, 0.098, 0.086],
        [0.164, 0.219, 0.168, 0.069, 0.065],
        [0.137, 0.128, 0.059, 0.046, 0.032],
        [0.135, 0.123, 0.054, 0.043, 0.026],
        [0.144, 0.136, 0.129, 0.076, 0.043],
        [0.083, 0.070, 0.059, 0.037, 0.020],
        [0.047, 0.046, 0.045, 0.026, 0.016],
        [0.034, 0.030, 0.026, 0.020, 0.013],
    ],
];

/// Most that a side can miss of its own length: a short collar carries too little to be much too stiff. From a collar
/// of radius 60 and length 10 mm on a shaft of 20 mm, modes of solids of revolution.
const OF_LENGTH: f64 = 0.42;

/// Where a piece of length l joins two sections that have no area in common, it is a plate that carries one to the other:
/// its two joints miss more, by `1 + a exp(-b l/R)`, R the smaller outer radius; a and b for bending, torsion, axial force.
/// From solids of revolution: a shaft of radius 1, a plate of radius 1.78 and lengths .3 to 3, a tube 1.78/1.33.
const PLATE: [[f64; 2]; 3] = [[25.0, 4.2], [3.0, 4.2], [60.0, 3.4]];

/// Rings feel an outer step less, the wider the common bore b (over the smaller outer radius).
fn ring_factor(bore: f64) -> f64 {
    1.6 - bore
}

/// Row of the table for what both sides share: the functions of the poorer side.
fn row(sides: [SectionBasis; 2]) -> usize {
    let of = |basis| match basis {
        SectionBasis::Monomials(order) => order.clamp(2, 5) - 2,
        SectionBasis::Ring { degree, .. } => 3 + degree.clamp(1, 4),
    };
    match sides {
        [SectionBasis::Ring { .. }, SectionBasis::Monomials(_)] => of(sides[1]),
        [SectionBasis::Monomials(_), SectionBasis::Ring { .. }] => of(sides[0]),
        _ => of(sides[0]).min(of(sides[1])),
    }
}

/// Value between the columns; what lies beyond takes the last.
fn between<const N: usize>(places: &[f64], values: &[f64; N], at: f64) -> f64 {
    let at = at.clamp(places[0], places[places.len() - 1]);
    let k = places[1..].iter().position(|p| at <= *p).unwrap_or(N - 1);
    let left = if k == 0 { 0.0 } else { values[k - 1] };
    left + (values[k] - left) * (at - places[k]) / (places[k + 1] - places[k])
}

/// `missing` of the joint of two sections: the length over the common outer radius along one direction (0 for y, 1
/// for z, in which the moment stretches the section) that the common section would have to be longer.
pub fn missing(pull: Pull, sections: [&Section; 2], sides: [SectionBasis; 2], along: usize) -> f64 {
    let (at, row) = (pull as usize, row(sides));
    let outer = sections.map(|s| s.outer[along]);
    let bore = sections.map(|s| s.inner[along]);
    let (least, most) = (outer[0].min(outer[1]), outer[0].max(outer[1]));
    let factor = if row > 3 { ring_factor(bore[0].max(bore[1]) / least) } else { 1.0 };
    let of_outer = factor * between(&RATIOS, &OUTER[at][row], most / least);
    let of_bore = match bore[0] == bore[1] {
        true => 0.0,
        false => between(&BORES, &BORE[at][row], bore[0].max(bore[1]) / least),
    };
    of_outer.max(of_bore)
}

/// One side of a joint.
#[derive(Debug, Clone, Copy)]
pub struct JointSide<'a> {
    /// The section on this side of the joint.
    pub section: &'a Section,
    /// Functions over it.
    pub basis: SectionBasis,
    /// Length up to the next change of the section, m.
    pub length: f64,
    /// The section beyond.
    pub beyond: Option<&'a Section>,
}

/// Flexibility that the joint misses, times the modulus (E, for torsion G): 1/m^3, of an axial force 1/m.
pub fn missing_flexibility(pull: Pull, sides: [JointSide<'_>; 2], along: usize) -> f64 {
    let sections = sides.map(|s| s.section);
    let Some(common) = sections[0].common(sections[1]) else { return 0.0 };
    let stiffness = |s: &Section| match (pull, along) {
        (Pull::Bending, 0) => s.moment(2, 0),
        (Pull::Bending, _) => s.moment(0, 2),
        (Pull::Torsion, _) => s.moment(2, 0) + s.moment(0, 2),
        (Pull::Axial, _) => s.area(),
    };
    let missing = missing(pull, sections, sides.map(|s| s.basis), along) * common.outer[along];
    let of = |side: &JointSide<'_>| {
        let lost = (1.0 / stiffness(&common) - 1.0 / stiffness(side.section)).max(0.0);
        lost * missing.min(OF_LENGTH * side.length)
    };
    let [a, b] = PLATE[pull as usize];
    let plate = |i: usize| match sides[i].beyond.map(|s| s.common(sections[1 - i])) {
        Some(None) => 1.0 + a * (-b * sides[i].length / common.outer[along]).exp(),
        _ => 1.0,
    };
    plate(0).max(plate(1)) * sides.iter().map(of).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn side(section: &Section, order: usize) -> JointSide<'_> {
        JointSide { section, basis: SectionBasis::Monomials(order), length: 10.0, beyond: None }
    }

    const CUBIC: [SectionBasis; 2] = [SectionBasis::Monomials(3); 2];

    #[test]
    fn no_step_misses_nothing_and_sides_may_be_changed() {
        let [thin, thick] = [1.0, 2.0].map(Section::circle);
        for pull in [Pull::Bending, Pull::Torsion, Pull::Axial] {
            let of = |a, b, order| missing_flexibility(pull, [side(a, order), side(b, order)], 0);
            assert_eq!(of(&thin, &thin, 3), 0.0);
            assert!(of(&thin, &thick, 3) > 0.0 && of(&thin, &thick, 3) == of(&thick, &thin, 3));
            assert!(of(&thin, &thick, 5) < of(&thin, &thick, 3));
            let collar =
                missing_flexibility(pull, [side(&thin, 3), JointSide { length: 0.1, ..side(&thick, 3) }], 0);
            assert!(collar < of(&thin, &thick, 3));
        }
    }

    #[test]
    fn the_table_is_met_at_its_places_and_kept_beyond() {
        let wide = Section::circle(1.0);
        for (ratio, value) in [(1.1, 0.084), (2.0, 0.312), (5.0, 0.522), (50.0, 0.522)] {
            let m = missing(Pull::Bending, [&wide, &Section::circle(ratio)], CUBIC, 0);
            assert!((m - value).abs() < 1e-12, "{ratio}: {m}");
        }
        let ring = SectionBasis::Ring { degree: 2, harmonics: 3 };
        let [solid, tube] = [Section::circle(1.0), Section::tube(1.0, 0.4)];
        let mixed = missing(Pull::Axial, [&solid, &tube], [SectionBasis::Monomials(5), ring], 0);
        assert!((mixed - 0.123).abs() < 1e-12, "{mixed}");
    }
}
