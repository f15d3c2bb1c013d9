//! Gauss-Legendre points, and the moments of a section as a section rule sees them.

use crate::section::{Section, Shape};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Points and weights on [-1, 1], exact for polynomials up to degree `2 count - 1`.
pub fn gauss(count: usize) -> Vec<(f64, f64)> {
    match RULES.get(count) {
        Some(rule) => rule.get_or_init(|| solved(count)).clone(),
        None => solved(count),
    }
}

/// Rules that were asked for before, by their number of points.
static RULES: [OnceLock<Vec<(f64, f64)>>; 64] = [const { OnceLock::new() }; 64];

fn solved(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|k| {
            // Newton's method on the Legendre polynomial from Tricomi's estimate of its root
            let mut x = -(PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (value, derivative) = legendre(count, x);
                slope = derivative;
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Legendre polynomial of degree n and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
    }
    (value, n as f64 * (x * value - previous) / (x * x - 1.0))
}

/// Points `(y, z, weight)` of the section rule with `count` Gauss points in each direction.
///
/// Rectangle: product rule, degree `2 count - 1` in each direction. Ellipse: Gauss in the squared radius
/// times `4 count` equal angles, degree `4 count - 2`.
pub fn section_rule(section: &Section, count: usize) -> Vec<(f64, f64, f64)> {
    let points = gauss(count);
    match section.shape {
        Shape::Rectangle => {
            let plate = |[cy, cz]: [f64; 2], sign: f64| -> Vec<(f64, f64, f64)> {
                let rows =
                    points.iter().flat_map(|&(y, wy)| points.iter().map(move |&(z, wz)| (y, z, wy * wz)));
                rows.map(|(y, z, w)| (cy * y, cz * z, sign * cy * cz * w)).collect()
            };
            let mut rule = plate(section.outer, 1.0);
            if section.is_hollow() {
                rule.extend(plate(section.inner, -1.0));
            }
            rule
        }
        Shape::Ellipse => {
            // between the boundaries: (y, z) = c(s) (cos, sin) with c from inner to outer, area element
            // exact for similar ellipses; others are outer minus inner
            let disk = |[cy, cz]: [f64; 2], from: f64, sign: f64| -> Vec<(f64, f64, f64)> {
                let angles = 4 * count;
                let mut rule = Vec::with_capacity(count * angles);
                for &(s, w) in &points {
                    let square = from + (1.0 - from) * (s + 1.0) / 2.0;
                    let weight = sign * w * (1.0 - from) / 4.0 * cy * cz * 2.0 * PI / angles as f64;
                    for k in 0..angles {
                        let (sin, cos) = (2.0 * PI * (k as f64 + 0.5) / angles as f64).sin_cos();
                        rule.push((cy * square.sqrt() * cos, cz * square.sqrt() * sin, weight));
                    }
                }
                rule
            };
            let [share_y, share_z] = [0, 1].map(|i| section.inner[i] / section.outer[i]);
            if share_y == share_z {
                disk(section.outer, share_y * share_y, 1.0)
            } else {
                let mut rule = disk(section.outer, 0.0, 1.0);
                rule.extend(disk(section.inner, 0.0, -1.0));
                rule
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_points_integrate_their_degree() {
        for count in 1..=20 {
            let rule = gauss(count);
            for degree in 0..2 * count {
                let exact = if degree % 2 == 0 { 2.0 / (degree + 1) as f64 } else { 0.0 };
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                assert!((sum - exact).abs() < 1e-14, "{count} {degree}: {sum}");
            }
        }
    }

    #[test]
    fn section_rules_reach_their_degree() {
        let hollow = Section { inner: [0.1, 0.3], ..Section::rectangle(1.0, 2.0) };
        let uneven = Section { inner: [0.05, 0.12], ..Section::ellipse(0.15, 0.2) };
        for section in [Section::circle(0.7), Section::tube(1.0, 0.9), uneven, hollow] {
            let rule = section_rule(&section, 4);
            for (a, b) in crate::section::basis::exponents(7) {
                let sum: f64 = rule.iter().map(|(y, z, w)| w * y.powi(a as i32) * z.powi(b as i32)).sum();
                let exact = section.moment(a, b);
                assert!((sum - exact).abs() < 1e-14, "{section:?} {a} {b}: {sum} {exact}");
            }
        }
    }
}
