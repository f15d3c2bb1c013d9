//! Cross-sections: shape and moments `I(a,b) = int y^a z^b dA`, exact and in closed form.
//!
//! A section is an ellipse or a rectangle, centred on the shaft axis, minus a smaller one of the
//! same shape; circle and tube are ellipses with equal semi-axes. Moments with an odd exponent
//! vanish. Source: docs/theory/elements.md#matrices.

pub mod basis;
pub mod kinks;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Outline family of a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Ellipse, circle when both semi-axes are equal.
    Ellipse,
    /// Rectangle with sides along y and z.
    Rectangle,
}

/// A part of the lateral surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Surface {
    /// Upper half of the outline (y > 0), of a rectangle its upper face.
    Top,
    /// Lower half, or lower face.
    Bottom,
    /// The inner boundary.
    Bore,
    /// The whole outer boundary.
    Rim,
}

/// A checked cross-section. Half extents in metres, `[along y, along z]`; inner ones are zero for a
/// solid section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Outline family, the same for outer and inner boundary.
    pub shape: Shape,
    /// Outer half extents (semi-axes, or half height and half width).
    pub outer: [f64; 2],
    /// Inner half extents, zero when solid.
    pub inner: [f64; 2],
}

impl Section {
    /// Solid circle of the given radius.
    pub fn circle(radius: f64) -> Self {
        Self::tube(radius, 0.0)
    }

    /// A circular tube with those radii, m.
    pub fn tube(outer_radius: f64, inner_radius: f64) -> Self {
        Self { shape: Shape::Ellipse, outer: [outer_radius; 2], inner: [inner_radius; 2] }
    }

    /// Solid ellipse with its semi-axes along y and z.
    pub fn ellipse(semi_axis_y: f64, semi_axis_z: f64) -> Self {
        Self { shape: Shape::Ellipse, outer: [semi_axis_y, semi_axis_z], inner: [0.0; 2] }
    }

    /// Solid rectangle, full height along y and full width along z.
    pub fn rectangle(height: f64, width: f64) -> Self {
        Self { shape: Shape::Rectangle, outer: [height / 2.0, width / 2.0], inner: [0.0; 2] }
    }

    /// `I(a,b) = int y^a z^b dA` in m^(a+b+2).
    ///
    /// Outer minus inner is summed as `(Y^p - y^p) Z^q + y^p (Z^q - z^q)` with factored differences
    /// of powers, so thin walls lose no digits.
    pub fn moment(&self, a: usize, b: usize) -> f64 {
        if a % 2 == 1 || b % 2 == 1 {
            return 0.0;
        }
        let unit = match self.shape {
            Shape::Ellipse => {
                2.0 * PI * odd_factorial(a) * odd_factorial(b) / (even_factorial(a + b) * (a + b + 2) as f64)
            }
            Shape::Rectangle => 4.0 / ((a + 1) * (b + 1)) as f64,
        };
        let ([cy, cz], [dy, dz]) = (self.outer, self.inner);
        let (p, q) = (a + 1, b + 1);
        unit * (power_difference(cy, dy, p) * cz.powi(q as i32)
            + dy.powi(p as i32) * power_difference(cz, dz, q))
    }

    /// The section between this one and another of the same shape, `share` (0 to 1) of the way: all lengths change linearly.
    /// Source: docs/theory/elements.md#tapers.
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| a[i] + (b[i] - a[i]) * share);
        Self { shape: self.shape, outer: mix(self.outer, other.outer), inner: mix(self.inner, other.inner) }
    }

    /// Area in m^2.
    pub fn area(&self) -> f64 {
        self.moment(0, 0)
    }

    /// Timoshenko shear correction factor of a solid circle or rectangle (Cowper's formulas as the source uses them) for
    /// Poisson's ratio nu.
    pub fn shear_correction(&self, nu: f64) -> f64 {
        match self.shape {
            Shape::Rectangle => 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu),
            Shape::Ellipse => 6.0 * (1.0 + nu).powi(2) / (7.0 + 12.0 * nu + 4.0 * nu * nu),
        }
    }

    /// True for circles and tubes: the mass and stiffness do not change when the section turns.
    pub fn is_axisymmetric(&self) -> bool {
        self.shape == Shape::Ellipse && self.outer[0] == self.outer[1] && self.inner[0] == self.inner[1]
    }

    /// True when there is a bore.
    pub fn is_hollow(&self) -> bool {
        self.inner[0] > 0.0
    }

    /// True for a tube, and for a hollow ellipse whose bore is similar to its outline: the image of a ring.
    pub fn is_ring(&self) -> bool {
        let [a, b] = [0, 1].map(|i| self.inner[i] / self.outer[i]);
        self.shape == Shape::Ellipse && self.is_hollow() && (a - b).abs() <= 1e-12
    }

    /// Largest half extent, in metres.
    pub fn outer_size(&self) -> f64 {
        self.outer[0].max(self.outer[1])
    }

    /// The section common to two neighbours of a step: the overlap of equal shapes, else the
    /// smaller one. `None` when nothing is common (a bore larger than the neighbour).
    pub fn common(&self, other: &Self) -> Option<Self> {
        if self.shape != other.shape {
            let (round, plate) = if self.shape == Shape::Ellipse { (self, other) } else { (other, self) };
            if round.is_hollow()
                && (0..2).map(|i| (plate.outer[i] / round.inner[i]).powi(2)).sum::<f64>() <= 1.0
            {
                return None;
            }
            return Some(if self.area() <= other.area() { *self } else { *other });
        }
        let common = Self {
            shape: self.shape,
            outer: [self.outer[0].min(other.outer[0]), self.outer[1].min(other.outer[1])],
            inner: [self.inner[0].max(other.inner[0]), self.inner[1].max(other.inner[1])],
        };
        (common.inner[0] < common.outer[0] && common.inner[1] < common.outer[1]).then_some(common)
    }

    /// Points `[y, z]` of the outer (`inner = false`) or inner boundary, closed, for drawing.
    pub fn outline(&self, inner: bool, points: usize) -> Vec<[f64; 2]> {
        let [cy, cz] = if inner { self.inner } else { self.outer };
        (0..=points)
            .map(|i| {
                let angle = 2.0 * PI * i as f64 / points as f64;
                let (s, c) = angle.sin_cos();
                match self.shape {
                    Shape::Ellipse => [cy * c, cz * s],
                    Shape::Rectangle => {
                        let scale = 1.0 / s.abs().max(c.abs());
                        [cy * c * scale, cz * s * scale]
                    }
                }
            })
            .collect()
    }
}

/// `(a-1)!! = 1 3 5 .. (a-1)` for even a.
fn odd_factorial(a: usize) -> f64 {
    (1..a).step_by(2).map(|k| k as f64).product()
}

/// `a!! = 2 4 6 .. a` for even a.
fn even_factorial(a: usize) -> f64 {
    (2..=a).step_by(2).map(|k| k as f64).product()
}

/// `x^p - y^p = (x - y) sum_k x^(p-1-k) y^k`, without cancellation beyond that of `x - y`.
fn power_difference(x: f64, y: f64, p: usize) -> f64 {
    (x - y) * (0..p).map(|k| x.powi((p - 1 - k) as i32) * y.powi(k as i32)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-14 * b.abs().max(1e-300), "{a} {b}");
    }

    #[test]
    fn textbook_moments() {
        let r = 0.2;
        close(Section::circle(r).area(), PI * r * r);
        close(Section::circle(r).moment(2, 0), PI * r.powi(4) / 4.0);
        close(Section::circle(r).moment(4, 2), PI * r.powi(8) / 64.0);
        close(Section::tube(r, 0.15).moment(0, 2), PI * (r.powi(4) - 0.15f64.powi(4)) / 4.0);
        close(Section::ellipse(0.1, 0.3).moment(2, 0), PI * 0.1f64.powi(3) * 0.3 / 4.0);
        close(Section::rectangle(0.4, 0.3).moment(2, 0), 0.3 * 0.4f64.powi(3) / 12.0);
        assert_eq!(Section::circle(r).moment(1, 2), 0.0);
    }

    #[test]
    fn thin_walls_keep_their_digits() {
        // I = pi/4 (R^4 - r^4) with r = R - t, expanded exactly for t = 2^-30, R = 1.
        let t = 2f64.powi(-30);
        let exact = PI / 4.0 * t * (4.0 - 6.0 * t + 4.0 * t * t - t * t * t);
        close(Section::tube(1.0, 1.0 - t).moment(2, 0), exact);
    }

    #[test]
    fn moments_agree_with_a_fine_sum() {
        let hollow = Section { inner: [0.05, 0.12], ..Section::ellipse(0.15, 0.2) };
        let n = 2000;
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                let y = 0.15 * (2.0 * (i as f64 + 0.5) / n as f64 - 1.0);
                let z = 0.2 * (2.0 * (j as f64 + 0.5) / n as f64 - 1.0);
                let (o, h) = ((y / 0.15).hypot(z / 0.2), (y / 0.05).hypot(z / 0.12));
                if o < 1.0 && h > 1.0 {
                    sum += y * y * z * z * 0.3 * 0.4 / (n * n) as f64;
                }
            }
        }
        assert!((sum / hollow.moment(2, 2) - 1.0).abs() < 1e-3);
    }
}
