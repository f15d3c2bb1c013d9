//! The rotation of the drive: prescribed by speeds over time, or driven by a torque over speed.

use crate::model::{Phase, RampShape, SpinupSettings};
use std::f64::consts::PI;

/// Angle, speed and acceleration of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turn {
    /// Angle Theta by which the drive has turned since t = 0, rad.
    pub angle: f64,
    /// Omega = dTheta/dt, rad/s.
    pub speed: f64,
    /// Angular acceleration dOmega/dt, rad/s^2.
    pub acceleration: f64,
}

/// A drive: phases of speed, or a torque whose motion is recorded as it comes about.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Speed at t = 0, rad/s.
    start: f64,
    phases: Vec<Phase>,
    /// Points (speed in rad/s, torque in N m), speeds ascending; none for a drive that prescribes the speed.
    torque: Vec<[f64; 2]>,
    /// Rotation at the ends of the steps of a run under torque, times ascending.
    passed: Vec<(f64, Turn)>,
    /// Time until which the end of a phase counts as the start of the next one: on a straight ramp the
    /// acceleration jumps there.
    begun: f64,
}

impl Drive {
    /// The drive of a spin-up.
    pub fn of(settings: &SpinupSettings) -> Self {
        if settings.torque.is_empty() {
            Self::new(settings.start_speed, &settings.drive)
        } else {
            Self::of_torque(settings.start_speed, &settings.torque)
        }
    }

    /// The drive of those phases from a speed at t = 0 (rad/s), `Omega = a + (b - a) (1 - cos(pi (t - t0)/T)) / 2` in each or
    /// `a + (b - a) (t - t0)/T`; their ends ascend.
    pub fn new(start: f64, phases: &[Phase]) -> Self {
        Self { start, phases: phases.to_vec(), torque: Vec::new(), passed: Vec::new(), begun: -1.0 }
    }

    /// A speed that never changes, rad/s.
    pub fn constant(speed: f64) -> Self {
        Self::new(speed, &[])
    }

    /// A drive that exerts a torque over speed: points (rad/s, N m), speeds ascending, straight between them and constant
    /// beyond.
    pub fn of_torque(start: f64, points: &[[f64; 2]]) -> Self {
        Self { torque: points.to_vec(), ..Self::constant(start) }
    }

    /// True for a drive that exerts a torque and follows where it leads.
    pub fn is_torque(&self) -> bool {
        !self.torque.is_empty()
    }

    /// Torque at a speed (rad/s), N m, and its derivative, N m s.
    pub fn torque_at(&self, speed: f64) -> (f64, f64) {
        let after = self.torque.iter().position(|point| point[0] > speed);
        match (after, self.torque.last()) {
            (Some(0), _) => (self.torque[0][1], 0.0),
            (Some(k), _) => {
                let ([w0, m0], [w1, m1]) = (self.torque[k - 1], self.torque[k]);
                let slope = (m1 - m0) / (w1 - w0);
                (m0 + slope * (speed - w0), slope)
            }
            (None, last) => (last.map_or(0.0, |point| point[1]), 0.0),
        }
    }

    /// Records where a torque has led at the end of a step.
    pub fn record(&mut self, t: f64, turn: Turn) {
        if self.is_torque() {
            self.passed.push((t, turn));
        }
    }

    /// Angle, speed and acceleration at a time `t >= 0`; after the last phase its speed is kept. Under a torque at times that
    /// a run has passed.
    pub fn at(&self, t: f64) -> Turn {
        if self.is_torque() {
            return self.recorded(t);
        }
        let (mut start, mut angle, mut from) = (0.0, 0.0, self.start);
        for &Phase { until, speed, shape } in &self.phases {
            let (length, change) = (until - start, speed - from);
            let elapsed = t.min(until) - start;
            let within = t < until || (t == until && t > self.begun);
            match shape {
                RampShape::Cosine => {
                    let (sin, cos) = (PI * elapsed / length).sin_cos();
                    let turned = angle + from * elapsed + change / 2.0 * (elapsed - length / PI * sin);
                    if within {
                        let speed = from + change / 2.0 * (1.0 - cos);
                        return Turn { angle: turned, speed, acceleration: change / 2.0 * PI / length * sin };
                    }
                    angle = turned;
                }
                RampShape::Linear => {
                    let acceleration = change / length;
                    let turned = angle + from * elapsed + acceleration * elapsed * elapsed / 2.0;
                    if within {
                        return Turn { angle: turned, speed: from + acceleration * elapsed, acceleration };
                    }
                    angle = turned;
                }
            }
            (start, from) = (until, speed);
        }
        Turn { angle: angle + from * (t - start), speed: from, acceleration: 0.0 }
    }

    fn recorded(&self, t: f64) -> Turn {
        let after = self.passed.partition_point(|(end, _)| *end < t).max(1);
        let (Some(&(t0, a)), Some(&(t1, b))) = (self.passed.get(after - 1), self.passed.get(after)) else {
            let last = self.passed.last();
            return last.map_or(Turn { speed: self.start, ..Turn::default() }, |(_, turn)| *turn);
        };
        let h = t1 - t0;
        let ends = [a.angle, a.speed, a.acceleration, b.angle, b.speed, b.acceleration];
        let [value, slope, curvature] = quintic(((t - t0) / h).clamp(0.0, 1.0));
        let scale = [1.0, h, h * h, 1.0, h, h * h];
        let blend = |p: &[f64; 6]| (0..6).map(|k| p[k] * scale[k] * ends[k]).sum::<f64>();
        Turn { angle: blend(&value), speed: blend(&slope) / h, acceleration: blend(&curvature) / (h * h) }
    }

    /// Ends of the phases, where the third derivative of the angle jumps, or the second.
    pub fn ends(&self) -> impl Iterator<Item = f64> {
        self.phases.iter().map(|p| p.until)
    }

    /// Goes over to the next phase at the end of one; true when the acceleration jumps there.
    pub fn begin_phase(&mut self, t: f64) -> bool {
        if !self.phases.iter().any(|p| p.until == t) {
            return false;
        }
        let before = self.at(t).acceleration;
        let kept = std::mem::replace(&mut self.begun, t);
        let jumps =
            self.phases.iter().any(|p| p.shape == RampShape::Linear) && self.at(t).acceleration != before;
        if !jumps {
            self.begun = kept;
        }
        jumps
    }

    /// Speed after the last phase, rad/s.
    pub fn last_speed(&self) -> f64 {
        self.phases.last().map_or(self.start, |p| p.speed)
    }
}

/// Hermite's polynomials of value, slope and curvature at both ends of the unit interval, at s; their first and second
/// derivatives.
pub fn quintic(s: f64) -> [[f64; 6]; 3] {
    let (s2, s3) = (s * s, s * s * s);
    let value = [
        1.0 - s3 * (10.0 - 15.0 * s + 6.0 * s2),
        s - s3 * (6.0 - 8.0 * s + 3.0 * s2),
        s2 / 2.0 - s3 * (1.5 - 1.5 * s + 0.5 * s2),
        s3 * (10.0 - 15.0 * s + 6.0 * s2),
        s3 * (-4.0 + 7.0 * s - 3.0 * s2),
        s3 * (0.5 - s + 0.5 * s2),
    ];
    let slope = [
        -30.0 * s2 * (1.0 - 2.0 * s + s2),
        1.0 - s2 * (18.0 - 32.0 * s + 15.0 * s2),
        s - s2 * (4.5 - 6.0 * s + 2.5 * s2),
        30.0 * s2 * (1.0 - 2.0 * s + s2),
        s2 * (-12.0 + 28.0 * s - 15.0 * s2),
        s2 * (1.5 - 4.0 * s + 2.5 * s2),
    ];
    let curvature = [
        -60.0 * s * (1.0 - 3.0 * s + 2.0 * s2),
        -s * (36.0 - 96.0 * s + 60.0 * s2),
        1.0 - s * (9.0 - 18.0 * s + 10.0 * s2),
        60.0 * s * (1.0 - 3.0 * s + 2.0 * s2),
        s * (-24.0 + 84.0 * s - 60.0 * s2),
        s * (3.0 - 12.0 * s + 10.0 * s2),
    ];
    [value, slope, curvature]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_is_the_derivative_of_the_angle() {
        use RampShape::{Cosine, Linear};
        let phases = [(0.5, 48.0, Cosine), (1.0, 48.0, Linear), (1.25, -72.0, Linear), (2.0, 10.0, Cosine)];
        let phases = phases.map(|(until, speed, shape)| Phase { until, speed, shape });
        let mut drive = Drive::new(5.0, &phases);
        for k in 1..240 {
            let (t, h) = (f64::from(k) * 0.01 + 0.003, 1e-6);
            let (before, at, after) = (drive.at(t - h), drive.at(t), drive.at(t + h));
            assert!(((after.angle - before.angle) / (2.0 * h) - at.speed).abs() < 1e-6, "{t}");
            assert!(((after.speed - before.speed) / (2.0 * h) - at.acceleration).abs() < 1e-6, "{t}");
        }
        assert_eq!((drive.at(0.75).speed, drive.at(0.75).acceleration), (48.0, 0.0));
        assert_eq!((drive.at(3.0).speed, drive.last_speed()), (10.0, 10.0));
        // at its end a phase has its own acceleration, until the next one begins
        assert_eq!(drive.at(1.0).acceleration, 0.0);
        assert!(drive.begin_phase(1.0) && !drive.begin_phase(1.0));
        assert!((drive.at(1.0).acceleration + 480.0).abs() < 1e-9 && drive.at(1.0).speed == 48.0);
        assert!(!drive.begin_phase(0.7));
    }

    #[test]
    fn a_torque_is_straight_between_its_points() {
        let drive = Drive::of_torque(3.0, &[[0.0, 10.0], [50.0, 20.0], [100.0, 0.0]]);
        assert_eq!(drive.torque_at(-1.0), (10.0, 0.0));
        assert_eq!(drive.torque_at(25.0), (15.0, 0.2));
        assert_eq!(drive.torque_at(75.0), (10.0, -0.4));
        assert_eq!(drive.torque_at(200.0), (0.0, 0.0));
        assert_eq!(drive.at(0.0).speed, 3.0);
    }

    #[test]
    fn what_a_torque_did_is_read_between_the_steps() {
        let mut drive = Drive::of_torque(0.0, &[[0.0, 1.0]]);
        let turn = |t: f64| Turn { angle: t.powi(3), speed: 3.0 * t * t, acceleration: 6.0 * t };
        for t in [0.0, 0.5, 1.2] {
            drive.record(t, turn(t));
        }
        for t in [0.0, 0.2, 0.5, 0.9, 1.2] {
            let (found, right) = (drive.at(t), turn(t));
            assert!((found.angle - right.angle).abs() < 1e-12 && (found.speed - right.speed).abs() < 1e-12);
        }
    }
}
