//! Rub: a shaft against rigid rings around it, in the coordinates of one node of the shaft.
//!
//! A ring of clearance d is centred on the undeformed axis. With u the displacement of the shaft's axis across it,
//! rho = |u|, n = u / rho, t = e_x x n, and phi the rotation of the section about x:
//!
//! ```text
//!     gap g = d - rho        N = k max(0, -g)        w = t . u' + R phi'        F = - N n - mu N tanh(w / w_0) t
//! ```
//!
//! and the torque `- mu N R tanh(w / w_0)` about x. All of it looks the same in any frame turned about x, as long
//! as velocities are those seen from space. Source: docs/theory/rub.md#force-law.

use crate::model::Stator;
use crate::results::RubContact;
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::axis_rows;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

/// Slip at which friction is 76 % (tanh 1) of full, over the speed of the surface at the drive's largest speed.
const SLIP_SPEED_SHARE: f64 = 0.01;
/// Share of a step's tolerance by which a ring may be passed before it acts. Newton's iteration leaves less.
const MARGIN_TOLERANCE_SHARE: f64 = 0.1;
/// Depth by which a ring may be passed before it acts, as a share of its clearance; the lesser of both counts.
const MARGIN_CLEARANCE_SHARE: f64 = 1e-4;
/// Depth over the radius of a ring that rounding alone gives to a path along the ring; it counts as no passage.
const ROUNDING_PER_RADIUS: f64 = 1e-12;
/// Halvings of a step by which a touch is located: 2^-44 of the step.
const TOUCH_HALVINGS: usize = 44;

/// y and z of the axis vector and of R r_,y and R r_,z, or anything conjugate to them.
pub type Vector = SVector<f64, 6>;
/// Derivative of a [`Vector`] by another.
pub type PlaneMatrix = SMatrix<f64, 6, 6>;

/// What a ring does at a gap and a slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RubLaw {
    /// Radial play d, m.
    pub clearance: f64,
    /// Force per penetration k, N/m.
    pub stiffness: f64,
    /// Coefficient of friction mu.
    pub friction: f64,
    /// Radius R of the shaft's surface, m.
    pub radius: f64,
    /// Slip w_0 of the regularised friction, m/s.
    pub slip_speed: f64,
}

/// Directions at a place of the shaft.
struct Directions {
    rho: f64,
    /// n, outwards, in the first two entries.
    normal: Vector,
    /// t in the first two entries; the slip is `tangent . q'`.
    tangent: Vector,
    /// Derivative of `tangent` by the place.
    turning: PlaneMatrix,
}

impl RubLaw {
    /// Gap `d - rho`, m; `place` as in [`Self::contact`].
    pub fn gap(&self, place: &Vector) -> f64 {
        self.clearance - place[0].hypot(place[1])
    }

    /// Gap, forces and slip at a place (y, z of u, R r_,y, R r_,z) and the rates of these as seen from space.
    pub fn contact(&self, place: &Vector, rate: &Vector) -> RubContact {
        let gap = self.gap(place);
        if gap >= 0.0 {
            return RubContact { gap, ..RubContact::default() };
        }
        let slip = self.directions(place).tangent.dot(rate);
        let normal_force = -self.stiffness * gap;
        let friction_force = -self.friction * normal_force * (slip / self.slip_speed).tanh();
        RubContact { gap, normal_force, friction_force, slip }
    }

    /// Force of the ring on the shaft in the coordinates of the place, N.
    pub fn force(&self, place: &Vector, contact: &RubContact) -> Vector {
        if contact.normal_force == 0.0 {
            return Vector::zeros();
        }
        let Directions { normal, tangent, .. } = self.directions(place);
        tangent * contact.friction_force - normal * contact.normal_force
    }

    /// Derivatives of [`Self::force`] by place and by rate; zero when the gap is open.
    pub fn tangents(&self, place: &Vector, rate: &Vector) -> [PlaneMatrix; 2] {
        let contact = self.contact(place, rate);
        if contact.normal_force == 0.0 {
            return [PlaneMatrix::zeros(); 2];
        }
        let Directions { rho, normal, tangent, turning } = self.directions(place);
        let RubContact { normal_force, friction_force, slip, .. } = contact;
        let share = (slip / self.slip_speed).tanh();
        let steepness = -self.friction * normal_force * (1.0 - share * share) / self.slip_speed;
        let mut across = Vector::zeros();
        (across[0], across[1]) = (-normal[1], normal[0]);
        let by_rate = tangent * tangent.transpose() * steepness;
        let by_place = normal * normal.transpose() * -self.stiffness
            - across * across.transpose() * (normal_force / rho)
            - tangent * normal.transpose() * (self.friction * self.stiffness * share)
            + turning * friction_force
            + tangent * (turning.transpose() * rate).transpose() * steepness;
        [by_place, by_rate]
    }

    /// `phi = atan2(s, c)`, `s = y_z - z_y`, `c = y_y + z_z` of the vectors y = R r_,y and z = R r_,z.
    fn directions(&self, place: &Vector) -> Directions {
        let rho = place[0].hypot(place[1]);
        let [ny, nz] = [place[0] / rho, place[1] / rho];
        let (s, c) = (place[3] - place[4], place[2] + place[5]);
        let d = s * s + c * c;
        let (by_s, by_c) =
            (Vector::from([0.0, 0.0, 0.0, 1.0, -1.0, 0.0]), Vector::from([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
        let spin = (by_s * c - by_c * s) * (self.radius / d);
        let mut turning = ((by_c * by_c.transpose() - by_s * by_s.transpose()) * (2.0 * s * c)
            + (by_s * by_c.transpose() + by_c * by_s.transpose()) * (s * s - c * c))
            * (self.radius / (d * d));
        turning
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&(Matrix2::new(ny * nz, -ny * ny, nz * nz, -ny * nz) / rho));
        let normal = Vector::from([ny, nz, 0.0, 0.0, 0.0, 0.0]);
        Directions { rho, normal, tangent: Vector::from([-nz, ny, 0.0, 0.0, 0.0, 0.0]) + spin, turning }
    }
}

/// A ring around a node.
#[derive(Debug, Clone)]
pub struct StatorRing {
    /// Node of the shaft.
    pub node: usize,
    /// Radial play, stiffness and friction, from which gap and forces follow.
    pub law: RubLaw,
    /// The displacement u and the vectors R r_,y and R r_,z as sums over vectors of the node: first coordinate
    /// and weight of each.
    pub rows: [Vec<(usize, f64)>; 3],
    /// True while the ring has its force in the equations of the present step.
    pub acts: bool,
    /// y and z of u as sums over the unknowns, in the node's own directions.
    across: [Vec<(usize, f64)>; 2],
}

impl StatorRing {
    /// The ring of a stator around a shaft that turns with at most `largest_speed`, rad/s. A shaft that never turns
    /// stays at rest, whatever its friction.
    pub fn new(assembly: &Assembly<'_>, stator: &Stator, largest_speed: f64) -> Self {
        let fastest = if largest_speed > 0.0 { largest_speed } else { 1.0 };
        let law = RubLaw {
            clearance: stator.clearance,
            stiffness: stator.stiffness,
            friction: stator.friction,
            radius: stator.radius,
            slip_speed: SLIP_SPEED_SHARE * stator.radius * fastest,
        };
        let rows = axis_rows(assembly.model, &assembly.numbering, stator.node);
        let across = [1, 2].map(|component| {
            let over = |&(first, w): &(usize, f64)| {
                assembly.expansion(first + component).iter().map(move |&(j, c)| (j, w * c))
            };
            rows[0].iter().flat_map(over).collect()
        });
        Self { node: stator.node, law, rows, acts: false, across }
    }

    /// y and z of u from displacements (or rates) of the unknowns, in the node's own directions, m.
    fn place(&self, unknowns: &[f64]) -> Vector2<f64> {
        let sum = |k: usize| self.across[k].iter().map(|&(j, c)| c * unknowns[j]).sum::<f64>();
        Vector2::new(sum(0), sum(1))
    }

    /// Depth by which the ring may be passed before it acts in steps of a tolerance, m.
    fn margin(&self, tolerance: f64) -> f64 {
        (MARGIN_TOLERANCE_SHARE * tolerance).min(MARGIN_CLEARANCE_SHARE * self.law.clearance)
    }

    /// Path of u within a step of length h, s, from displacements, velocities and accelerations at both ends.
    pub fn path(&self, h: f64, ends: [[&[f64]; 3]; 2]) -> AxisPath {
        AxisPath::new(h, ends.map(|end| end.map(|list| self.place(list))))
    }

    /// y and z of the axis vector and of R r_,y and R r_,z.
    pub fn gather(&self, list: &[f64]) -> Vector {
        let sum = |k: usize, c: usize| self.rows[k].iter().map(|(at, w)| w * list[at + c]).sum::<f64>();
        Vector::from_fn(|i, _| sum(i / 2, 1 + i % 2))
    }

    /// Adds a factor times forces conjugate to [`Self::gather`].
    pub fn scatter(&self, factor: f64, force: &Vector, list: &mut [f64]) {
        for (k, row) in self.rows.iter().enumerate() {
            for &(at, w) in row {
                list[at + 1] += factor * w * force[2 * k];
                list[at + 2] += factor * w * force[2 * k + 1];
            }
        }
    }
}

/// A ring in contact.
#[derive(Debug, Clone, Copy)]
pub struct RubTouch {
    /// Index of the ring among those of the shaft.
    pub ring: usize,
    /// Place of the shaft in the ring: y and z of u, R r_,y and R r_,z, m.
    pub place: Vector,
    /// Rate of that place as seen from space, m/s.
    pub rate: Vector,
}

/// Path of a point across the axis within a step: the quintic with place, velocity and acceleration of both ends, as the
/// points `b_k` of `u(s) = sum_k B_k(s) b_k` over Bernstein's polynomials of degree five, s from 0 to 1. As these are positive
/// and sum to one, the path stays within the largest `|b_k|`. Source: Farin, Curves and Surfaces for CAGD, chapters 4 and 5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPath([Vector2<f64>; 6]);

impl AxisPath {
    /// The path in a step of length h, s, with place (m), velocity and acceleration at start and end.
    pub fn new(h: f64, [[u0, v0, a0], [u1, v1, a1]]: [[Vector2<f64>; 3]; 2]) -> Self {
        let (slope, curve) = (h / 5.0, h * h / 20.0);
        Self([
            u0,
            u0 + v0 * slope,
            u0 + v0 * (2.0 * slope) + a0 * curve,
            u1 - v1 * (2.0 * slope) + a1 * curve,
            u1 - v1 * slope,
            u1,
        ])
    }

    /// Distance from the axis at a share s of the step, m.
    pub fn radius(&self, s: f64) -> f64 {
        self.split(s)[1].0[0].norm()
    }

    /// A radius (m) that the path nowhere exceeds: the largest distance of its Bernstein points from the axis.
    pub fn bound(&self) -> f64 {
        self.0.iter().fold(0.0, |m: f64, b| m.max(b.norm()))
    }

    /// The parts before and after a share (de Casteljau).
    fn split(&self, s: f64) -> [Self; 2] {
        let (mut left, mut right) = (self.0, self.0);
        for k in 1..6 {
            for i in 0..6 - k {
                right[i] = right[i] * (1.0 - s) + right[i + 1] * s;
            }
            left[k] = right[0];
        }
        [Self(left), Self(right)]
    }

    /// First share after `from` at which the path is further out than a radius, if it ever is, within the step: halves are
    /// searched until the points bound them. So a largest radius inside the step counts as well as the end.
    pub fn passes(&self, radius: f64, from: f64) -> Option<f64> {
        let [_, rest] = self.split(from);
        let share = rest.search(radius, TOUCH_HALVINGS)?;
        Some(from + share * (1.0 - from))
    }

    fn search(&self, radius: f64, halvings: usize) -> Option<f64> {
        let [start, end] = [self.0[0].norm(), self.0[5].norm()];
        if start > radius {
            return Some(0.0);
        }
        if end <= radius && self.bound() <= radius * (1.0 + ROUNDING_PER_RADIUS) {
            return None;
        }
        if halvings == 0 {
            return (end > radius).then_some(1.0);
        }
        let [left, right] = self.split(0.5);
        let first = left.search(radius, halvings - 1).map(|s| s / 2.0);
        first.or_else(|| right.search(radius, halvings - 1).map(|s| (1.0 + s) / 2.0))
    }

    /// Share at which the path comes back within a radius between one where it is outside and one where it is inside.
    pub fn returns(&self, radius: f64, outside: f64, inside: f64) -> f64 {
        let (mut outside, mut inside) = (outside, inside);
        for _ in 0..TOUCH_HALVINGS {
            let middle = (outside + inside) / 2.0;
            if self.radius(middle) > radius { outside = middle } else { inside = middle }
        }
        inside
    }
}

/// The rings around a shaft.
#[derive(Debug, Clone, Default)]
pub struct Rub {
    /// Every ring around the shaft, in the order of the case.
    pub rings: Vec<StatorRing>,
    /// Looks at gaps: searches of paths that may reach a ring, and evaluations with a ring that acts.
    pub gap_checks: usize,
    /// Evaluations of the equations with contact.
    pub contact_evaluations: usize,
    /// Contacts at the last evaluation.
    pub touching: Vec<RubTouch>,
}

impl Rub {
    /// True when a ring takes part in the equations of the present step.
    pub fn acts(&self) -> bool {
        self.rings.iter().any(|ring| ring.acts)
    }

    /// Before a step of a tolerance, m, from displacements of the unknowns: the rings that are reached to within a tenth of it
    /// and 1e-4 of the clearance act.
    pub fn prepare(&mut self, unknowns: &[f64], tolerance: f64) {
        for ring in &mut self.rings {
            ring.acts = ring.law.clearance - ring.place(unknowns).norm() <= ring.margin(tolerance);
        }
    }

    /// The first ring that does not act and yet is passed by more than [`Self::prepare`] allows in a step of length h, s, and
    /// the share of the step at which it is reached; displacements, velocities and accelerations of the unknowns at both ends.
    pub fn reached(&mut self, h: f64, ends: [[&[f64]; 3]; 2], tolerance: f64) -> Option<(usize, f64)> {
        let mut first: Option<(usize, f64)> = None;
        for (index, ring) in self.rings.iter().enumerate().filter(|(_, ring)| !ring.acts) {
            let (path, clearance) = (ring.path(h, ends), ring.law.clearance);
            let margin = ring.margin(tolerance);
            if path.bound() <= clearance + margin {
                continue;
            }
            self.gap_checks += 1;
            let Some(passed) = path.passes(clearance + margin, 0.0) else { continue };
            let share = path.passes(clearance, 0.0).unwrap_or(passed);
            if first.is_none_or(|(_, other)| share < other) {
                first = Some((index, share));
            }
        }
        first
    }

    /// Adds the forces of the rings that act with a minus sign (as forces out of balance) and returns the power that friction
    /// takes, W.
    pub fn add(&mut self, position: &[f64], velocity: &[f64], out_of_balance: &mut [f64]) -> f64 {
        self.touching.clear();
        self.gap_checks += usize::from(self.acts());
        let mut power = 0.0;
        for (index, ring) in self.rings.iter().enumerate().filter(|(_, ring)| ring.acts) {
            let (place, rate) = (ring.gather(position), ring.gather(velocity));
            let contact = ring.law.contact(&place, &rate);
            if contact.normal_force > 0.0 {
                ring.scatter(-1.0, &ring.law.force(&place, &contact), out_of_balance);
                power -= contact.friction_force * contact.slip;
                self.touching.push(RubTouch { ring: index, place, rate });
            }
        }
        self.contact_evaluations += usize::from(!self.touching.is_empty());
        power
    }

    /// Gap of every ring, and force and slip at those that act.
    pub fn contacts(&self, position: &[f64], velocity: &[f64]) -> Vec<RubContact> {
        let one = |ring: &StatorRing| {
            let place = ring.gather(position);
            match ring.acts {
                true => ring.law.contact(&place, &ring.gather(velocity)),
                false => RubContact { gap: ring.law.gap(&place), ..RubContact::default() },
            }
        };
        self.rings.iter().map(one).collect()
    }

    /// Energy `k g^2 / 2` of the penetrated rings that act, J.
    pub fn energy(&self, position: &[f64]) -> f64 {
        let one = |ring: &StatorRing| {
            ring.law.stiffness * ring.law.gap(&ring.gather(position)).min(0.0).powi(2) / 2.0
        };
        // a plain sum over no rings is -0
        self.rings.iter().filter(|ring| ring.acts).map(one).fold(0.0, |sum, e| sum + e)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both ends of a parabola are inside; it leaves and comes back where the quadratic equation says.
    #[test]
    fn a_path_that_leaves_between_its_ends_is_found() {
        let (h, rise) = (2e-3, 1.2e-3);
        // y = 4 rise s (1 - s), z = 0
        let (v, a) = (4.0 * rise / h, -8.0 * rise / (h * h));
        let at = |x: f64| Vector2::new(0.0, x);
        let path = AxisPath::new(h, [[at(0.0), at(v), at(a)], [at(0.0), at(-v), at(a)]]);
        assert!((path.radius(0.5) - rise).abs() < 1e-15 && path.bound() >= rise);
        for depth in [1e-3, 1e-6, 1e-9] {
            let d = rise * (1.0 - depth);
            let exact = (1.0 - depth.sqrt()) / 2.0;
            let found = path.passes(d, 0.0).expect("passes");
            assert!((found - exact).abs() < 1e-6, "{depth:e}: {found} {exact}");
            let back = path.returns(d, 0.5, 1.0);
            assert!((back - 1.0 + exact).abs() < 1e-6, "{depth:e}: {back}");
            assert_eq!(path.passes(d, back), None);
        }
        assert_eq!(path.passes(rise * (1.0 + 1e-9), 0.0), None);
    }
}
