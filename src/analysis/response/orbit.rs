//! Orbits of steady vibration, `y = Re(Y exp(i w t))`, `z = Re(Z exp(i w t))`.
//!
//! With `f = (Y + i Z)/2` and `b = conj(Y - i Z)/2` the motion is `y + i z = f exp(i w t) + b exp(-i w t)`: a forward and a
//! backward circle, hence an ellipse with the semi-axes `|f| + |b|` and `|f| - |b|` (negative for backward whirl), the major
//! one at the angle `(arg f + arg b)/2` from y towards z.

use faer::c64;

/// Complex amplitudes along y and z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Along y.
    pub y: c64,
    /// Along z.
    pub z: c64,
}

/// Share of the major semi-axis below which the backward (or forward) circle is rounding.
const ROUNDING: f64 = 1e-12;

impl Orbit {
    /// `f`, the forward circle.
    pub fn forward(&self) -> c64 {
        (self.y + c64::new(0.0, 1.0) * self.z) / 2.0
    }

    /// `b`, the backward circle.
    pub fn backward(&self) -> c64 {
        ((self.y - c64::new(0.0, 1.0) * self.z) / 2.0).conj()
    }

    /// Major semi-axis.
    pub fn major(&self) -> f64 {
        self.forward().norm() + self.backward().norm()
    }

    /// Minor semi-axis, negative for backward whirl.
    pub fn minor(&self) -> f64 {
        self.forward().norm() - self.backward().norm()
    }

    /// Angle of the major axis from y towards z, rad, between -pi/2 and pi/2; `None` for a circle, and for no motion.
    pub fn inclination(&self) -> Option<f64> {
        let (f, b) = (self.forward(), self.backward());
        let least = ROUNDING * self.major();
        if f.norm() <= least || b.norm() <= least {
            return None;
        }
        let half = (f.arg() + b.arg()) / 2.0;
        let turned = half.rem_euclid(std::f64::consts::PI);
        Some(if turned > std::f64::consts::FRAC_PI_2 { turned - std::f64::consts::PI } else { turned })
    }

    /// Complex amplitude along a direction at an angle from y towards z.
    pub fn along(&self, angle: f64) -> c64 {
        self.y * angle.cos() + self.z * angle.sin()
    }
}
