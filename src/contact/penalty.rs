//! Penalty contact: every penetrating probe is a spring, `V = w g^2/2`, with analytic force and tangent; and its discrete
//! gradient between two states. Source: docs/theory.md section 13.

use super::gap::{Gap, along, product, values};
use crate::linalg::lu::Entries;

/// What meets what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// Corners, or round beams that cross.
    PointToPoint,
    /// A corner, or a node of a side, and a side or an end face.
    PointToSegment,
    /// Sides, or round beams along each other.
    LineToLine,
}

impl Model {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::PointToPoint, Self::PointToSegment, Self::LineToLine];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::PointToPoint => "point-to-point",
            Self::PointToSegment => "point-to-segment",
            Self::LineToLine => "line-to-line",
        }
    }
}

/// A gap that a spring closes.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Energy is `weight g^2/2`, N/m.
    pub weight: f64,
    /// Slave body and master body.
    pub bodies: (usize, usize),
    /// Positions along the axes of both, m.
    pub positions: [f64; 2],
    /// What meets what.
    pub model: Model,
    /// The gap.
    pub gap: Gap,
}

impl Spring {
    /// Its bodies, the smaller index first.
    pub fn pair(&self) -> (usize, usize) {
        (self.bodies.0.min(self.bodies.1), self.bodies.0.max(self.bodies.1))
    }

    /// Penetration, m, zero when apart.
    pub fn penetration(&self) -> f64 {
        (-self.gap.value).max(0.0)
    }

    /// Stored energy, J.
    pub fn energy(&self) -> f64 {
        0.5 * self.weight * self.penetration().powi(2)
    }
}

/// Adds `dV/dq` to `force` and `d^2 V/dq^2` to the entries of the unknowns; returns V, J. A spring at a gap of zero has its
/// stiffness already.
pub fn add(
    springs: &[Spring],
    q: &[f64],
    components: usize,
    unknown: &[Option<usize>],
    force: &mut [f64],
    mut entries: Option<&mut Entries>,
) -> f64 {
    let mut energy = 0.0;
    for spring in springs {
        let (g, w) = (spring.gap.value, spring.weight);
        energy += spring.energy();
        let gradient = spring.gap.gradient(components);
        gradient.iter().for_each(|(k, value)| force[*k] += w * g * value);
        let Some(entries) = entries.as_deref_mut() else { continue };
        let block = spring.gap.curvature(q, components);
        let d = values(&gradient);
        let matrix = (&d * d.transpose() + block.matrix * g) * w;
        for (i, &row) in block.coordinates.iter().enumerate() {
            let Some(row) = unknown[row] else { continue };
            for (j, &column) in block.coordinates.iter().enumerate() {
                if let Some(column) = unknown[column] {
                    entries.add(row, column, matrix[(i, j)]);
                }
            }
        }
    }
    energy
}

/// A spring between two states: its gap at either end, and halfway.
#[derive(Debug, Clone)]
pub struct Stroke {
    /// Halfway.
    pub middle: Spring,
    /// Gap at the first state, m.
    pub before: f64,
    /// At the second, with its derivative.
    pub after: f64,
    /// `dg/dq` at the second state.
    pub gradient: Vec<(usize, f64)>,
}

/// Adds the force whose work between the states is the change of the energy, and with `entries` its derivative by the second
/// state (up to the change of the weights in a correction of third order). Returns the energy at the second state, J.
///
/// The force is `phi D`, `phi = w (g0^- + g1^-)/2 (..)`, the secant of the energy over the gap, and `D = (S - M)(x)(n + s d/|d|^2)`
/// with d the change of `x_s - x_m` and s what the gradient halfway misses of the change of the gap.
pub fn add_average(
    strokes: &[Stroke],
    q: [&[f64]; 3],
    components: usize,
    unknown: &[Option<usize>],
    force: &mut [f64],
    mut entries: Option<&mut Entries>,
) -> f64 {
    let [q0, q1, middle] = q;
    let mut energy = 0.0;
    for stroke in strokes {
        let (w, gap) = (stroke.middle.weight, &stroke.middle.gap);
        let [low, high] = [stroke.before, stroke.after].map(|g| g.min(0.0));
        energy += 0.5 * w * high * high;
        let change = stroke.after - stroke.before;
        let apart = change.abs() > 1e-9 * (stroke.after.abs() + stroke.before.abs());
        let phi = if apart { 0.5 * w * (high - low) * (high + low) / change } else { 0.5 * w * (high + low) };
        let weights = gap.difference();
        let mut d = nalgebra::Vector3::zeros();
        for (first, weight) in &weights {
            for c in 0..components {
                d[c] += weight * (q1[first + c] - q0[first + c]);
            }
        }
        let squared = d.norm_squared();
        let miss = change - gap.pull().dot(&d);
        let share = if squared > 1e-30 { miss / squared } else { 0.0 };
        let direction = gap.pull() + d * share;
        let gradient = along(&weights, &direction, components);
        gradient.iter().for_each(|(k, value)| force[*k] += phi * value);
        let Some(entries) = entries.as_deref_mut() else { continue };
        // d phi/dq1
        let slope = if apart { (w * high - phi) / change } else { 0.5 * w * f64::from(stroke.after < 0.0) };
        let mut add = |row: usize, column: usize, value: f64| {
            if let (Some(row), Some(column)) = (unknown[row], unknown[column]) {
                entries.add(row, column, value);
            }
        };
        for (row, value) in &gradient {
            for (column, by) in &stroke.gradient {
                add(*row, *column, slope * value * by);
            }
        }
        if phi == 0.0 {
            continue;
        }
        let block = gap.curvature(middle, components);
        for (i, &row) in block.coordinates.iter().enumerate() {
            for (j, &column) in block.coordinates.iter().enumerate() {
                add(row, column, 0.5 * phi * block.matrix[(i, j)]);
            }
        }
        if squared > 1e-30 {
            // share d: its direction turns with d, its size with both gaps
            let turned = along(&weights, &d, components);
            let plain = along(&weights, &gap.pull(), components);
            for (row, value) in &turned {
                for (column, by) in &stroke.gradient {
                    add(*row, *column, phi * value * by / squared);
                }
                for (column, by) in &plain {
                    add(*row, *column, -phi * value * by / squared);
                }
                for (column, by) in &turned {
                    add(*row, *column, -2.0 * phi * share * value * by / squared);
                }
            }
            for (first, a) in &weights {
                for (second, b) in &weights {
                    for c in 0..components {
                        add(first + c, second + c, phi * share * a * b);
                    }
                }
            }
        }
    }
    energy
}

/// `dg/dt` at a velocity.
pub fn rate(gradient: &[(usize, f64)], velocity: &[f64]) -> f64 {
    product(gradient, velocity)
}
