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
//! as velocities are those seen from space. Source: docs/theory.md section 12.

use crate::model::{Model, Stator};
use crate::support::{Numbering, axis_rows};
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

/// Slip at which friction is 76 % (tanh 1) of full, over the speed of the surface at the drive's largest speed.
const SLIP: f64 = 0.01;
/// Largest approach in a step over what velocity and acceleration at its start say.
const SAFETY: f64 = 2.0;
/// Steps ahead that velocity and acceleration speak for.
const AHEAD: f64 = 16.0;

/// y and z of the axis vector and of R r_,y and R r_,z, or anything conjugate to them.
pub type Vector = SVector<f64, 6>;
/// Derivative of a [`Vector`] by another.
pub type Matrix = SMatrix<f64, 6, 6>;

/// What a ring does at a gap and a slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
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

/// State of a shaft at a ring.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Contact {
    /// Gap, positive when open, m.
    pub gap: f64,
    /// Force N of the ring towards its centre, N.
    pub normal_force: f64,
    /// Friction on the shaft's surface along e_x x n, N: negative when the surface slips in the positive sense.
    pub friction_force: f64,
    /// Slip w of the surface, m/s.
    pub slip: f64,
}

/// Directions at a place of the shaft.
struct Directions {
    rho: f64,
    /// n, outwards, in the first two entries.
    normal: Vector,
    /// t in the first two entries; the slip is `tangent . q'`.
    tangent: Vector,
    /// Derivative of `tangent` by the place.
    turning: Matrix,
}

impl Law {
    /// Gap `d - rho`, m; `place` as in [`Self::contact`].
    pub fn gap(&self, place: &Vector) -> f64 {
        self.clearance - place[0].hypot(place[1])
    }

    /// Gap, forces and slip at a place (y, z of u, R r_,y, R r_,z) and the rates of these as seen from space.
    pub fn contact(&self, place: &Vector, rate: &Vector) -> Contact {
        let gap = self.gap(place);
        if gap >= 0.0 {
            return Contact { gap, ..Contact::default() };
        }
        let slip = self.directions(place).tangent.dot(rate);
        let normal_force = -self.stiffness * gap;
        let friction_force = -self.friction * normal_force * (slip / self.slip_speed).tanh();
        Contact { gap, normal_force, friction_force, slip }
    }

    /// Force of the ring on the shaft in the coordinates of the place, N.
    pub fn force(&self, place: &Vector, contact: &Contact) -> Vector {
        if contact.normal_force == 0.0 {
            return Vector::zeros();
        }
        let Directions { normal, tangent, .. } = self.directions(place);
        tangent * contact.friction_force - normal * contact.normal_force
    }

    /// Derivatives of [`Self::force`] by place and by rate; zero when the gap is open.
    pub fn tangents(&self, place: &Vector, rate: &Vector) -> [Matrix; 2] {
        let contact = self.contact(place, rate);
        if contact.normal_force == 0.0 {
            return [Matrix::zeros(); 2];
        }
        let Directions { rho, normal, tangent, turning } = self.directions(place);
        let Contact { normal_force, friction_force, slip, .. } = contact;
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
pub struct Ring {
    /// Node of the shaft.
    pub node: usize,
    /// Its law.
    pub law: Law,
    /// u, R r_,y and R r_,z as sums over vectors of the node, `(first coordinate, weight)`.
    pub rows: [Vec<(usize, f64)>; 3],
}

impl Ring {
    /// The ring of a stator around a shaft that turns with at most `largest_speed`, rad/s. A shaft that never turns
    /// stays at rest, whatever its friction.
    pub fn new(model: &Model, numbering: &Numbering, stator: &Stator, largest_speed: f64) -> Self {
        let fastest = if largest_speed > 0.0 { largest_speed } else { 1.0 };
        let law = Law {
            clearance: stator.clearance,
            stiffness: stator.stiffness,
            friction: stator.friction,
            radius: stator.radius,
            slip_speed: SLIP * stator.radius * fastest,
        };
        Self { node: stator.node, law, rows: axis_rows(model, numbering, stator.node) }
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
pub struct Touch {
    /// Which ring.
    pub ring: usize,
    /// Place of the shaft in it.
    pub place: Vector,
    /// Its rate as seen from space.
    pub rate: Vector,
}

/// The rings around a shaft, and when they are worth a look.
#[derive(Debug, Clone, Default)]
pub struct Rub {
    /// The rings.
    pub rings: Vec<Ring>,
    /// Contact is possible in the present step.
    pub near: bool,
    /// Times that gaps were looked at.
    pub gap_checks: usize,
    /// Evaluations of the equations with contact.
    pub contact_evaluations: usize,
    /// Deepest penetration found where no contact had been possible, m.
    pub missed: f64,
    /// Contacts at the last evaluation.
    pub touching: Vec<Touch>,
    clear_until: f64,
}

impl Rub {
    /// True when a step from t of length h needs no look: the last one spoke for it.
    pub fn is_clear(&self, t: f64, h: f64) -> bool {
        t + h <= self.clear_until
    }

    /// Declares the present step free of contact.
    pub fn stay_clear(&mut self) {
        self.near = false;
        self.touching.clear();
    }

    /// Looks at the gaps at the start of a step: no ring is reached before the axis has moved by its gap, or rho grown by
    /// it. Within a time tau of up to 16 steps that is at most twice `|v| tau + |a| tau^2 / 2`, v and a being
    /// velocity and acceleration of the axis or, if this takes longer, `rho'` and `rho''`.
    pub fn look(&mut self, t: f64, h: f64, [position, velocity, acceleration]: [&[f64]; 3]) {
        self.gap_checks += 1;
        let mut ahead = AHEAD * h;
        for ring in &self.rings {
            let [u, v, a] = [position, velocity, acceleration].map(|list| {
                let vector = ring.gather(list);
                Vector2::new(vector[0], vector[1])
            });
            let rho = u.norm();
            let gap = ring.law.clearance - rho;
            if gap < 0.0 && !self.near {
                self.missed = self.missed.max(-gap);
            }
            let gap = gap.max(0.0);
            // v tau + a tau^2 / 2 = gap
            let time = |v: f64, a: f64| {
                let root = v + (v * v + 2.0 * a * gap).sqrt();
                if root > 0.0 { 2.0 * gap / root } else { f64::INFINITY }
            };
            let mut clear = time(SAFETY * v.norm(), SAFETY * a.norm());
            if rho > 0.0 {
                let n = u / rho;
                let growing = n.dot(&v);
                let around = (v - n * growing).norm_squared() / rho;
                clear = clear.max(time(SAFETY * growing.abs(), SAFETY * (n.dot(&a) + around).abs()));
            }
            ahead = ahead.min(clear);
        }
        self.clear_until = t + ahead;
        if self.is_clear(t, h) { self.stay_clear() } else { self.near = true }
    }

    /// Adds the forces of the rings with a minus sign (as forces out of balance) and returns the power that friction
    /// takes, W.
    pub fn add(&mut self, position: &[f64], velocity: &[f64], out_of_balance: &mut [f64]) -> f64 {
        self.gap_checks += 1;
        self.touching.clear();
        let mut power = 0.0;
        for (index, ring) in self.rings.iter().enumerate() {
            let (place, rate) = (ring.gather(position), ring.gather(velocity));
            let contact = ring.law.contact(&place, &rate);
            if contact.normal_force > 0.0 {
                ring.scatter(-1.0, &ring.law.force(&place, &contact), out_of_balance);
                power -= contact.friction_force * contact.slip;
                self.touching.push(Touch { ring: index, place, rate });
            }
        }
        self.contact_evaluations += usize::from(!self.touching.is_empty());
        power
    }

    /// Energy `k g^2 / 2` of the penetrated rings, J.
    pub fn energy(&self, position: &[f64]) -> f64 {
        let one =
            |ring: &Ring| ring.law.stiffness * ring.law.gap(&ring.gather(position)).min(0.0).powi(2) / 2.0;
        self.rings.iter().map(one).sum()
    }
}
