//! Penalty contact: every penetrating probe is a spring, `V = w g^2/2`, with analytic force and tangent; and its discrete
//! gradient between two states. Source: docs/theory/contact.md#penalty.

use crate::linalg::lu::Entries;
use crate::scene::gap::Hit;
use crate::scene::gap::{Gap, along, product};
use nalgebra::{DMatrix, Vector3};
use std::collections::BTreeMap;

/// What meets what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactModel {
    /// Corners, or round beams that cross.
    PointToPoint,
    /// A corner, or a node of a side, and a side or an end face.
    PointToSegment,
    /// Sides, or round beams along each other.
    LineToLine,
}

impl ContactModel {
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
pub struct ContactSpring {
    /// Energy is `weight g^2/2`, N/m.
    pub weight: f64,
    /// Slave body and master body.
    pub bodies: (usize, usize),
    /// Positions along the axes of both, m.
    pub positions: [f64; 2],
    /// What meets what.
    pub model: ContactModel,
    /// The gap that the spring closes, with its derivatives.
    pub gap: Gap,
}

impl ContactSpring {
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

/// Derivatives of contact forces, summed by the coordinates that they stand between. Many points of a line of contact lie between the
/// same two curves: summed one by one, they would be hundreds of times the entries of the elements.
///
/// Blocks stay when they are cleared, as zeros, so that a system keeps its pattern while points close and open.
#[derive(Default)]
pub struct Sums {
    /// By the coordinates of rows and columns.
    blocks: BTreeMap<[Vec<usize>; 2], DMatrix<f64>>,
}

impl Sums {
    /// The block between some coordinates.
    fn block(&mut self, rows: &[usize], columns: &[usize]) -> &mut DMatrix<f64> {
        self.blocks
            .entry([rows.to_vec(), columns.to_vec()])
            .or_insert_with(|| DMatrix::zeros(rows.len(), columns.len()))
    }

    /// Makes all blocks zero.
    pub fn clear(&mut self) {
        self.blocks.values_mut().for_each(|block| block.fill(0.0));
    }

    /// Adds all blocks to the entries of the unknowns.
    pub fn add_to(&self, unknown: &[Option<usize>], entries: &mut Entries) {
        for ([rows, columns], matrix) in &self.blocks {
            for (j, &column) in columns.iter().enumerate() {
                let Some(column) = unknown[column] else { continue };
                for (i, &row) in rows.iter().enumerate() {
                    if let Some(row) = unknown[row] {
                        entries.add(row, column, matrix[(i, j)]);
                    }
                }
            }
        }
    }
}

/// The columns of a block.
fn columns(block: &mut DMatrix<f64>) -> std::slice::ChunksExactMut<'_, f64> {
    let rows = block.nrows().max(1);
    block.as_mut_slice().chunks_exact_mut(rows)
}

/// `block += a b^T`.
fn add_product(block: &mut DMatrix<f64>, a: &[f64], b: &[(usize, f64)]) {
    for (column, (_, b)) in columns(block).zip(b) {
        column.iter_mut().zip(a).for_each(|(sum, a)| *sum += a * b);
    }
}

/// Adds `dV/dq` to `force` and `d^2 V/dq^2` to the entries of the unknowns; returns V, J. A spring at a gap of zero has its
/// stiffness already.
pub fn add(
    springs: &[ContactSpring],
    q: &[f64],
    components: usize,
    unknown: &[Option<usize>],
    force: &mut [f64],
    entries: Option<&mut Entries>,
) -> f64 {
    let mut energy = 0.0;
    let mut sums = Sums::default();
    for spring in springs {
        let (g, w) = (spring.gap.value, spring.weight);
        energy += spring.energy();
        let gradient = spring.gap.gradient(components);
        gradient.iter().for_each(|(k, value)| force[*k] += w * g * value);
        if entries.is_none() {
            continue;
        }
        let places = spring.gap.coordinates(components);
        let sum = sums.block(&places, &places);
        let scaled: Vec<f64> = gradient.iter().map(|(_, value)| w * value).collect();
        add_product(sum, &scaled, &gradient);
        spring.gap.add_curvature(q, components, w * g, sum);
    }
    if let Some(entries) = entries {
        sums.add_to(unknown, entries);
    }
    energy
}

/// A spring between two states: its gap at either end, and halfway.
#[derive(Debug, Clone)]
pub struct SpringStroke {
    /// Number of its probe.
    pub probe: usize,
    /// The spring halfway between the two states.
    pub middle: ContactSpring,
    /// Gap at the first state, m.
    pub before: f64,
    /// At the second.
    pub after: f64,
    /// What is met at the second state, for the derivative of the gap.
    pub hit_after: Option<Hit>,
}

/// The force of a stroke, the one whose work between the states is the change of the energy.
#[derive(Debug, Clone, Copy)]
pub struct Average {
    /// phi, N: the secant of the energy over the gap, not positive.
    phi: f64,
    /// `d phi/d g_1`, N/m.
    slope: f64,
    /// `n + s d/|d|^2`.
    direction: Vector3<f64>,
    /// d, m: the change of `x_s - x_m`.
    moved: Vector3<f64>,
    /// `s/|d|^2`, m^-1; s is what the gradient halfway misses of the change of the gap.
    share: f64,
}

impl Average {
    /// On the slave, N; on the master it acts the other way.
    pub fn force(&self) -> Vector3<f64> {
        -self.direction * self.phi
    }
}

/// Least `|d|^2` of a stroke that turns its force, m^2.
const MOVED: f64 = 1e-30;

impl SpringStroke {
    /// Compression energy at the second state, J.
    pub fn energy(&self) -> f64 {
        0.5 * self.middle.weight * self.after.min(0.0).powi(2)
    }

    /// Its force between the states `q0` and `q1`: `-phi (n + s d/|d|^2)`, `phi = w (g1^-^2 - g0^-^2)/(2 (g1 - g0))`.
    pub fn average(&self, q0: &[f64], q1: &[f64], components: usize) -> Average {
        let (w, gap) = (self.middle.weight, &self.middle.gap);
        let [low, high] = [self.before, self.after].map(|g| g.min(0.0));
        let change = self.after - self.before;
        let apart = change.abs() > 1e-9 * (self.after.abs() + self.before.abs());
        let phi = if apart { 0.5 * w * (high - low) * (high + low) / change } else { 0.5 * w * (high + low) };
        let slope = if apart { (w * high - phi) / change } else { 0.5 * w * f64::from(self.after < 0.0) };
        let mut moved = Vector3::zeros();
        for (first, weight) in &gap.difference() {
            for c in 0..components {
                moved[c] += weight * (q1[first + c] - q0[first + c]);
            }
        }
        let squared = moved.norm_squared();
        let miss = change - gap.pull().dot(&moved);
        let share = if squared > MOVED { miss / squared } else { 0.0 };
        Average { phi, slope, direction: gap.pull() + moved * share, moved, share }
    }
}

/// `dg/dq` of a stroke at its second state.
pub type GapGradient<'a> = &'a dyn Fn(&SpringStroke) -> Vec<(usize, f64)>;

/// Adds the force whose work between the states is the change of the energy and, where it is wanted, its derivative by the second
/// state (up to the change of the weights in a correction of third order) to `tangent`.
///
/// The force is `phi D`, `D = (S - M)(x)(n + s d/|d|^2)`, as in [`SpringStroke::average`].
pub fn add_average(
    strokes: &[SpringStroke],
    q: [&[f64]; 3],
    components: usize,
    force: &mut [f64],
    mut tangent: Option<(&mut Sums, GapGradient<'_>)>,
) {
    let [q0, q1, middle] = q;
    for stroke in strokes {
        let gap = &stroke.middle.gap;
        let Average { phi, slope, direction, moved, share } = stroke.average(q0, q1, components);
        let weights = gap.difference();
        let gradient = along(&weights, &direction, components);
        gradient.iter().for_each(|(k, value)| force[*k] += phi * value);
        let Some((tangent, gradient_after)) = &mut tangent else { continue };
        let after = gradient_after(stroke);
        // share d: its direction turns with d, its size with both gaps
        let squared = moved.norm_squared();
        let turning = if squared > MOVED { phi / squared } else { 0.0 };
        let turned = along(&weights, &moved, components);
        let by_gap: Vec<f64> = gradient
            .iter()
            .zip(&turned)
            .map(|((_, value), (_, turn))| slope * value + turning * turn)
            .collect();
        let places = gap.coordinates(components);
        let places_after: Vec<usize> = after.iter().map(|(k, _)| *k).collect();
        add_product(tangent.block(&places, &places_after), &by_gap, &after);
        let sum = tangent.block(&places, &places);
        gap.add_curvature(middle, components, 0.5 * phi, sum);
        let by_place: Vec<f64> = turned.iter().map(|(_, turn)| -turning * turn).collect();
        add_product(sum, &by_place, &along(&weights, &(gap.pull() + moved * (2.0 * share)), components));
        for (j, column) in columns(sum).enumerate() {
            let scaled = phi * share * weights[j / components].1;
            let rows = column.chunks_exact_mut(components).zip(&weights);
            rows.for_each(|(rows, (_, a))| rows[j % components] += scaled * a);
        }
    }
}

/// `dg/dt` at a velocity.
pub fn rate(gradient: &[(usize, f64)], velocity: &[f64]) -> f64 {
    product(gradient, velocity)
}
