//! Lines on the lateral surface of a section: the whole outline, the bore, or a half of the outline.
//!
//! Points with weights of length and of the outward normal. On a circle equal angles are exact for whatever a
//! section carries; on an ellipse n of them converge like `((a - b) / (a + b))^(n/2)`
//! and are taken until rounding. Source:
//! docs/theory/supports.md#acts-on.

use crate::element::quadrature::gauss;
use crate::section::{Section, Shape, Surface};
use std::f64::consts::PI;

/// Gauss points over a half circumference or a face.
const HALF_CIRCUMFERENCE_POINTS: usize = 32;
/// Equal angles on a circle.
const ANGLES: usize = 64;
/// Most equal angles on an ellipse.
const MOST_ANGLES: usize = 20_000;

/// A point of a line with its weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePoint {
    /// Position y in the section, m.
    pub y: f64,
    /// Position z in the section, m.
    pub z: f64,
    /// Length that it stands for, m.
    pub length: f64,
    /// The same times the unit normal `[n_y, n_z]` that points out of the material, m.
    pub normal: [f64; 2],
}

/// Points of a line; the lengths sum to that of the line. None in a bore that does not exist.
pub fn line(section: &Section, surface: Surface) -> Vec<LinePoint> {
    match (surface, section.shape) {
        (Surface::Bore, _) if !section.is_hollow() => Vec::new(),
        (Surface::Bore, shape) => {
            let out = whole(shape, section.inner).into_iter();
            out.map(|p| LinePoint { normal: p.normal.map(|n| -n), ..p }).collect()
        }
        (Surface::Rim, shape) => whole(shape, section.outer),
        (Surface::Top, shape) => half(shape, section.outer, 1.0),
        (Surface::Bottom, shape) => half(shape, section.outer, -1.0),
    }
}

fn on_ellipse([cy, cz]: [f64; 2], sin: f64, cos: f64, weight: f64) -> LinePoint {
    let length = weight * (cy * sin).hypot(cz * cos);
    LinePoint { y: cy * cos, z: cz * sin, length, normal: [weight * cz * cos, weight * cy * sin] }
}

fn half(shape: Shape, [cy, cz]: [f64; 2], side: f64) -> Vec<LinePoint> {
    gauss(HALF_CIRCUMFERENCE_POINTS)
        .into_iter()
        .map(|(s, w)| match shape {
            Shape::Rectangle => {
                LinePoint { y: side * cy, z: cz * s, length: cz * w, normal: [side * cz * w, 0.0] }
            }
            Shape::Ellipse => {
                let (sin, cos) = (PI / 2.0 * s).sin_cos();
                on_ellipse([cy, cz], sin, side * cos, w * PI / 2.0)
            }
        })
        .collect()
}

fn whole(shape: Shape, [cy, cz]: [f64; 2]) -> Vec<LinePoint> {
    match shape {
        Shape::Rectangle => {
            let faces = [1.0, -1.0].into_iter().flat_map(|side| {
                let across = half(shape, [cz, cy], side).into_iter();
                let turned = across.map(|p| LinePoint { y: p.z, z: p.y, normal: [0.0, p.normal[0]], ..p });
                half(shape, [cy, cz], side).into_iter().chain(turned)
            });
            faces.collect()
        }
        Shape::Ellipse => {
            let flatness = (cy.min(cz) / cy.max(cz)).atanh();
            let more = (40.0 / flatness).min(MOST_ANGLES as f64) as usize;
            let count = ANGLES + more.div_ceil(4) * 4;
            let angle = 2.0 * PI / count as f64;
            (0..count)
                .map(|j| {
                    let (sin, cos) = (angle * j as f64).sin_cos();
                    on_ellipse([cy, cz], sin, cos, angle)
                })
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(section: &Section, surface: Surface) -> f64 {
        line(section, surface).iter().map(|p| p.length).sum()
    }

    #[test]
    fn lines_have_their_length() {
        for (surface, part) in [(Surface::Top, 0.5), (Surface::Bottom, 0.5), (Surface::Rim, 1.0)] {
            assert!((length(&Section::circle(0.3), surface) - 0.6 * PI * part).abs() < 1e-14);
            let ellipse = length(&Section::ellipse(1.0, 2.0), surface);
            // circumference of an ellipse with semi-axes 1 and 2
            assert!((ellipse - 9.688448220547675 * part).abs() < 1e-10, "{surface:?} {ellipse}");
        }
        // flat: 4 (1 + k^2 / 2 (ln(4 / k) - 1 / 2)), k = 1e-3
        assert!((length(&Section::ellipse(1e-3, 1.0), Surface::Rim) - 4.000_015_588).abs() < 1e-9);
        assert!((length(&Section::rectangle(0.4, 0.7), Surface::Top) - 0.7).abs() < 1e-14);
        assert!((length(&Section::rectangle(0.4, 0.7), Surface::Rim) - 2.2).abs() < 1e-14);
        assert!((length(&Section::tube(0.3, 0.2), Surface::Bore) - 0.4 * PI).abs() < 1e-14);
        assert!(line(&Section::circle(0.3), Surface::Bore).is_empty());
    }

    /// Gauss's theorem: `sum n_y y = sum n_z z` is the area inside; a bore's normals point into it.
    #[test]
    fn normals_enclose_the_area() {
        let hollow = Section { inner: [0.05, 0.12], ..Section::ellipse(0.15, 0.2) };
        for section in [Section::circle(0.3), Section::rectangle(0.4, 0.7), hollow] {
            for axis in 0..2 {
                let of = |p: &LinePoint| p.normal[axis] * [p.y, p.z][axis];
                let inside = |s: Surface| line(&section, s).iter().map(of).sum::<f64>();
                let area = inside(Surface::Rim) + inside(Surface::Bore);
                assert!((area / section.area() - 1.0).abs() < 1e-13, "{section:?}");
            }
        }
    }
}
