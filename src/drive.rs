//! The prescribed rotation: speeds joined by half cosines.

use crate::model::Phase;
use std::f64::consts::PI;

/// Angle, speed and acceleration of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turn {
    /// Theta, rad.
    pub angle: f64,
    /// Omega = dTheta/dt, rad/s.
    pub speed: f64,
    /// dOmega/dt, rad/s^2.
    pub acceleration: f64,
}

/// Phases of a drive that starts at rest, `Omega = a + (b - a) (1 - cos(pi (t - t0)/T)) / 2` in each.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Speed at t = 0, rad/s.
    start: f64,
    phases: Vec<Phase>,
}

impl Drive {
    /// The drive of those phases; their ends ascend.
    pub fn new(phases: &[Phase]) -> Self {
        Self { start: 0.0, phases: phases.to_vec() }
    }

    /// A speed that never changes, rad/s.
    pub fn constant(speed: f64) -> Self {
        Self { start: speed, phases: Vec::new() }
    }

    /// Angle, speed and acceleration at a time `t >= 0`; after the last phase its speed is kept.
    pub fn at(&self, t: f64) -> Turn {
        let (mut start, mut angle, mut from) = (0.0, 0.0, self.start);
        for &Phase { until, speed } in &self.phases {
            let (length, change) = (until - start, speed - from);
            let elapsed = t.min(until) - start;
            let (sin, cos) = (PI * elapsed / length).sin_cos();
            let turned = angle + from * elapsed + change / 2.0 * (elapsed - length / PI * sin);
            if t <= until {
                let speed = from + change / 2.0 * (1.0 - cos);
                return Turn { angle: turned, speed, acceleration: change / 2.0 * PI / length * sin };
            }
            (start, angle, from) = (until, turned, speed);
        }
        Turn { angle: angle + from * (t - start), speed: from, acceleration: 0.0 }
    }

    /// Ends of the phases, where the third derivative of the angle jumps.
    pub fn ends(&self) -> impl Iterator<Item = f64> {
        self.phases.iter().map(|p| p.until)
    }

    /// Largest speed, rad/s.
    pub fn largest_speed(&self) -> f64 {
        self.phases.iter().map(|p| p.speed).fold(self.start, f64::max)
    }

    /// Speed after the last phase, rad/s.
    pub fn last_speed(&self) -> f64 {
        self.phases.last().map_or(self.start, |p| p.speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_is_the_derivative_of_the_angle() {
        let phases = [(0.5, 48.0), (1.0, 48.0), (1.25, 72.0), (2.0, 10.0)];
        let drive = Drive::new(&phases.map(|(until, speed)| Phase { until, speed }));
        for k in 1..240 {
            let (t, h) = (f64::from(k) * 0.01 + 0.003, 1e-6);
            let (before, at, after) = (drive.at(t - h), drive.at(t), drive.at(t + h));
            assert!(((after.angle - before.angle) / (2.0 * h) - at.speed).abs() < 1e-6, "{t}");
            assert!(((after.speed - before.speed) / (2.0 * h) - at.acceleration).abs() < 1e-6, "{t}");
        }
        assert_eq!((drive.at(0.75).speed, drive.at(0.75).acceleration), (48.0, 0.0));
        assert_eq!((drive.at(3.0).speed, drive.largest_speed(), drive.last_speed()), (10.0, 72.0, 10.0));
    }
}
