//! Loss factor of a turning material: damping whose size does not depend on the frequency.
//!
//! A pattern of k waves around the axis that travels forward at the whirl frequency w alternates in the material at `w - k Omega`,
//! one that travels backward at `w + k Omega`. The stress `K (1 + i eta sgn)` has the sign of that frequency. With E_k the
//! projector on patterns of k waves and A the turn of a pattern (`A^2 = -k^2` on it) the force is
//!
//! ```text
//!     i eta K E_k u          for w >= k Omega: as a damper of eta K E_k / w
//!     eta K A E_k u / k      for w <  k Omega: it feeds what travels forward and damps what travels backward
//! ```
//!
//! Source: docs/theory/linear-rotordynamics.md#hysteresis.

use crate::linalg::sparse::{Sparse, multiply};
use crate::shaft::assembly::Assembly;
use faer::{Mat, MatRef, Scale, c64};

/// `eta K E_k` and `eta K A E_k / k` for k waves, from 0.
#[derive(Debug, Clone, Default)]
pub struct Hysteresis<M>(pub Vec<[M; 2]>);

/// What acts at a speed on a motion: factors of the two matrices of each number of waves.
fn factors(waves: usize, speed: f64, lambda: c64) -> Vec<[f64; 2]> {
    let frequency = lambda.im.abs();
    let one = |k: usize| {
        if frequency == 0.0 {
            // what does not oscillate does not alternate
            [0.0, 0.0]
        } else if frequency >= k as f64 * speed.abs() {
            [1.0 / frequency, 0.0]
        } else {
            [0.0, speed.signum()]
        }
    };
    (0..waves).map(one).collect()
}

impl Hysteresis<Sparse> {
    /// Of a shaft, in its free coordinates.
    pub fn new(assembly: &Assembly<'_>) -> Self {
        Self(assembly.hysteresis())
    }

    /// On a basis.
    pub fn onto(&self, basis: &Mat<f64>) -> Hysteresis<Mat<f64>> {
        let reduce = |a: &Sparse| basis.transpose() * multiply(a, basis.as_ref());
        Hysteresis(self.0.iter().map(|[damping, turning]| [reduce(damping), reduce(turning)]).collect())
    }

    /// Matrices on velocities and on displacements with their factors, at a speed on a motion `exp(lambda t)`.
    pub fn terms(&self, speed: f64, lambda: c64) -> [Vec<(f64, &Sparse)>; 2] {
        let factors = factors(self.0.len(), speed, lambda);
        [0, 1].map(|part| {
            let all = self.0.iter().zip(&factors).map(|(m, f)| (f[part], &m[part]));
            all.filter(|(f, _)| *f != 0.0).collect()
        })
    }

    /// Forces `(lambda D + T) x` at a speed on motions `exp(lambda t)`, for the real and the imaginary part of x.
    pub fn products(&self, speed: f64, lambda: c64, x: MatRef<'_, f64>) -> [Mat<f64>; 2] {
        self.terms(speed, lambda).map(|terms| {
            let mut sum = Mat::zeros(x.nrows(), x.ncols());
            terms.into_iter().for_each(|(factor, a)| sum += multiply(a, x) * Scale(factor));
            sum
        })
    }
}

impl Hysteresis<Mat<f64>> {
    /// The matrix on velocities (part 0) or on displacements (part 1) at a speed on a motion `exp(lambda t)`; `None` for none.
    pub fn matrix(&self, part: usize, speed: f64, lambda: c64) -> Option<Mat<f64>> {
        let factors = factors(self.0.len(), speed, lambda);
        let mut sum: Option<Mat<f64>> = None;
        for (m, f) in self.0.iter().zip(&factors).filter(|(_, f)| f[part] != 0.0) {
            let scaled = &m[part] * Scale(f[part]);
            sum = Some(sum.map_or_else(|| scaled.clone(), |s| s + &scaled));
        }
        sum
    }
}

impl<M> Hysteresis<M> {
    /// True where no material has a loss factor.
    pub fn is_none(&self) -> bool {
        self.0.is_empty()
    }
}
