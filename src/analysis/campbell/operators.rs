//! Sparse operators of a spinning shaft in either frame and form (docs/theory/linear-rotordynamics.md#equations):
//!
//! ```text
//!     M u'' + (C + Omega G) u' + (K(Omega) + X + Omega H) u = 0
//! ```
//!
//! with C the damping, X the cross-coupling of the bearings, H what spin adds to the damping forces, and
//! - classical form, stationary frame: `K = K_0`;
//! - consistent form, stationary frame: `K = K_T(Omega) - Omega^2 N`;
//! - consistent form, rotating frame: `K = K_T(Omega) + Omega^2 M J^2`, `G = 2 M J`.

use crate::analysis::campbell::changing_bearings::{ChangingBearing, units};
use crate::analysis::campbell::hysteresis::Hysteresis;
use crate::analysis::campbell::spin_stiffening::Stiffening;
use crate::linalg::sparse::{ComplexSparse, Sparse, combine};
use crate::model::{Gyroscopic, WhirlFrame};
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::bearing_rows;
use crate::shaft::spectrum::{Spectrum, mass_orthonormal};
use faer::{Mat, Scale, c64};

/// The operators; absent ones act nowhere.
pub struct Operators {
    /// Frame that the coordinates belong to.
    pub frame: WhirlFrame,
    /// Mass matrix M, in free coordinates, kg.
    pub mass: Sparse,
    /// `K` at rest.
    pub stiffness: Sparse,
    /// `G` per unit spin speed; `None` without gyroscopic terms.
    pub gyroscopic: Option<Sparse>,
    /// Damping matrix C of bearings and material, N s/m; `None` without damping.
    pub damping: Option<Sparse>,
    /// Skew part X of the bearings' stiffness, N/m; `None` without cross-coupling.
    pub cross_coupling: Option<Sparse>,
    /// `H` per unit spin speed.
    pub circulatory: Option<Sparse>,
    /// `S = M (J - D_theta)`: motions with n waves around the axis that travel with the spin have `Im(u^H S u) = n u^H M u`,
    /// those against it the negative.
    pub travel: Sparse,
    /// The parts of C and of H that are proportional to the shaft's stiffness, without those of its mass and of bearings: they
    /// feel nothing of a rigid motion.
    pub strain_damping: [Option<Sparse>; 2],
    /// Motions of the shaft without its bearings that strain nothing, orthonormal in the mass.
    pub unstrained: Mat<f64>,
    /// `-N` or `M J^2` in the consistent form, per unit spin speed squared.
    pub centrifugal: Option<Sparse>,
    /// `K_T - K_0` over speed in the consistent form.
    pub stiffening: Option<Stiffening>,
    /// Bearings whose law changes with speed or frequency; the matrices above hold their law at standstill.
    pub changing: Vec<ChangingBearing>,
    /// Matrices of their unit laws.
    units: Vec<[[Sparse; 2]; 2]>,
    /// Damping of materials with a loss factor.
    pub hysteresis: Hysteresis<Sparse>,
    /// Static forces of bearings that damp, couple or change, in columns.
    pub bearing_forces: Mat<f64>,
    /// What the rigid motions become as the shaft deforms: for every node of the stiffening the rotation of its
    /// displacement, in columns (zero for translations).
    pub turned_states: Vec<Mat<f64>>,
    /// The same of the motions that only soft bearings resist.
    pub turned_soft_states: Vec<Mat<f64>>,
}

impl Operators {
    /// Builds the operators that the model requires; `stiffening` makes the form consistent.
    pub fn new(
        assembly: &Assembly<'_>,
        spectrum: &Spectrum,
        frame: WhirlFrame,
        gyroscopic: Gyroscopic,
        stiffening: Option<Stiffening>,
    ) -> Self {
        let present = |a: Sparse| (a.compute_nnz() > 0).then_some(a);
        let active = assembly.model.bearings.iter().filter(|b| b.damps() || b.couples() || b.table.is_some());
        let forces: Vec<Vec<f64>> = active
            .flat_map(|b| bearing_rows(assembly.model, &assembly.numbering, b))
            .map(|row| assembly.force(&row))
            .collect();
        let angular_momentum = assembly.angular_momentum();
        let travel = combine(&[(1.0, &angular_momentum), (-0.5, &assembly.gyroscopic(Gyroscopic::All))]);
        let rotating = frame == WhirlFrame::Rotating;
        let turning = if rotating { Scale(2.0) * &angular_momentum } else { assembly.gyroscopic(gyroscopic) };
        let circulatory = if rotating { assembly.rotating_damping() } else { assembly.circulatory() };
        let centrifugal = stiffening
            .is_some()
            .then(|| if rotating { assembly.centrifugal() } else { Scale(-1.0) * assembly.spin_softening() });
        let states = stiffening.as_ref().map_or(&[][..], |s| &s.states);
        let soft = spectrum.flexibility.soft_motions().map(|m| m.to_owned());
        Self {
            frame,
            mass: spectrum.mass.clone(),
            stiffness: spectrum.stiffness.clone(),
            gyroscopic: present(turning),
            damping: present(assembly.damping()),
            cross_coupling: present(assembly.cross_coupling()),
            circulatory: present(circulatory),
            travel,
            strain_damping: [
                present(assembly.strain_damping()),
                (!rotating).then(|| assembly.strain_circulatory()).and_then(present),
            ],
            unstrained: mass_orthonormal(&spectrum.mass, assembly.rigid_motions_on(&[]).1),
            centrifugal,
            changing: ChangingBearing::all(assembly, rotating),
            units: units(assembly),
            hysteresis: Hysteresis::new(assembly),
            bearing_forces: Mat::from_fn(assembly.size(), forces.len(), |i, j| forces[j][i]),
            turned_states: states
                .iter()
                .map(|z| assembly.turned_by(&spectrum.flexibility.rigid, z))
                .collect(),
            turned_soft_states: soft
                .iter()
                .flat_map(|m| states.iter().map(|z| assembly.turned_by(m, z)))
                .collect(),
            stiffening,
        }
    }

    /// True when energy is conserved: without growth the eigenvalues are imaginary.
    pub fn is_conservative(&self) -> bool {
        self.damping.is_none()
            && self.cross_coupling.is_none()
            && self.circulatory.is_none()
            && self.hysteresis.is_none()
            && self.changing.iter().all(ChangingBearing::is_conservative)
    }

    /// True when the eigenvalues change with the spin speed.
    pub fn depends_on_speed(&self) -> bool {
        self.gyroscopic.is_some()
            || self.circulatory.is_some()
            || self.centrifugal.is_some()
            || !self.changing.is_empty()
            || !self.hysteresis.is_none()
    }

    /// True when the law of a bearing or of the material depends on the motion itself.
    pub fn is_implicit(&self) -> bool {
        !self.hysteresis.is_none() || self.changing.iter().any(ChangingBearing::is_implicit)
    }

    /// True in the frame that turns with the shaft.
    pub fn is_rotating(&self) -> bool {
        self.frame == WhirlFrame::Rotating
    }

    /// The parts of `K(Omega) - K_0`.
    pub fn varying(&self) -> impl Iterator<Item = &Sparse> {
        self.centrifugal.iter().chain(self.stiffening.iter().flat_map(|s| &s.changes))
    }

    /// Their factors at a speed.
    pub fn weights(&self, speed: f64) -> Vec<f64> {
        let mut weights: Vec<f64> = self.centrifugal.iter().map(|_| speed * speed).collect();
        weights.extend(self.stiffening.iter().flat_map(|s| s.nodes.weights(speed)));
        weights
    }

    /// `(K(Omega) - K_0) / Omega^2`; `None` in the classical form.
    pub fn secant(&self, speed: f64) -> Option<Sparse> {
        let weights = self.weights(speed);
        let terms: Vec<(f64, &Sparse)> =
            weights.iter().map(|w| w / (speed * speed)).zip(self.varying()).collect();
        (!terms.is_empty()).then(|| combine(&terms))
    }

    /// Stiffness matrix at a spin speed (rad/s), `K(Omega)`, N/m; with the bearings' symmetric change on a motion
    /// `exp(lambda t)`.
    pub fn stiffness_at(&self, speed: f64, lambda: c64) -> Sparse {
        let weights = self.weights(speed);
        let mut terms = vec![(1.0, &self.stiffness)];
        terms.extend(weights.iter().copied().zip(self.varying()));
        terms.extend(self.bearing_terms(|bearing| bearing.change(speed, lambda).stiffness));
        combine(&terms)
    }

    /// Dynamic stiffness `K(Omega) + X + Omega H + i w (C + Omega G) - w^2 M` of steady vibration at a frequency w (rad/s).
    pub fn dynamic_stiffness(&self, speed: f64, frequency: f64) -> ComplexSparse {
        let stiffness = self.stiffness_at(speed, c64::new(0.0, frequency));
        let (real, imaginary) = (|v: f64| c64::new(v, 0.0), |v: f64| c64::new(0.0, v));
        let mut terms = vec![(real(1.0), &stiffness), (real(-frequency * frequency), &self.mass)];
        terms.extend(self.cross_coupling.iter().map(|a| (real(1.0), a)));
        terms.extend(self.circulatory.iter().map(|a| (real(speed), a)));
        terms.extend(self.damping.iter().map(|a| (imaginary(frequency), a)));
        terms.extend(self.gyroscopic.iter().map(|a| (imaginary(frequency * speed), a)));
        let [on_velocity, on_place] = self.hysteresis.terms(speed, c64::new(0.0, frequency));
        terms.extend(on_velocity.into_iter().map(|(v, a)| (imaginary(frequency * v), a)));
        terms.extend(on_place.into_iter().map(|(v, a)| (real(v), a)));
        let on = |bearing: &ChangingBearing| bearing.change(speed, c64::new(0.0, frequency));
        terms.extend(self.bearing_terms(|b| on(b).turning).into_iter().map(|(v, a)| (real(v), a)));
        terms.extend(
            self.bearing_terms(|b| on(b).damping).into_iter().map(|(v, a)| (imaginary(frequency * v), a)),
        );
        combine(&terms)
    }

    /// A law of every changing bearing as terms of a sparse sum.
    pub fn bearing_terms(&self, law: impl Fn(&ChangingBearing) -> [[f64; 2]; 2]) -> Vec<(f64, &Sparse)> {
        let mut terms = Vec::new();
        for (law, units) in self.changing.iter().map(law).zip(&self.units) {
            for (k, l) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                if law[k][l] != 0.0 {
                    terms.push((law[k][l], &units[k][l]));
                }
            }
        }
        terms
    }
}
