//! The equations of steady vibration on few vectors: dense matrices that are summed and factorised at each speed.

use crate::analysis::campbell::changing_bearings::{ChangingBearing, add};
use crate::analysis::campbell::hysteresis::Hysteresis;
use crate::analysis::campbell::reduced_basis::Reduced;
use faer::linalg::solvers::Solve;
use faer::{Mat, Scale, c64};

/// `Z(Omega, w)` on some vectors that are orthonormal in the mass.
#[derive(Clone)]
pub struct Compact {
    stiffness: Mat<f64>,
    varying: Vec<Mat<f64>>,
    gyroscopic: Option<Mat<f64>>,
    damping: Option<Mat<f64>>,
    cross_coupling: Option<Mat<f64>>,
    circulatory: Option<Mat<f64>>,
    changing: Vec<ChangingBearing>,
    hysteresis: Hysteresis<Mat<f64>>,
    /// Unit forces in columns.
    forces: Mat<f64>,
    /// Size of the diagonal at rest, for scaling.
    scale: Vec<f64>,
}

impl Compact {
    /// The whole of a reduced basis, with unit forces in columns.
    pub fn whole(reduced: &Reduced, forces: Mat<f64>) -> Self {
        let n = reduced.size();
        let w = &reduced.frequencies;
        Self {
            stiffness: Mat::from_fn(n, n, |i, j| if i == j { w[i] * w[i] } else { 0.0 }),
            varying: reduced.varying.clone(),
            gyroscopic: reduced.gyroscopic.clone(),
            damping: reduced.damping.clone(),
            cross_coupling: reduced.cross_coupling.clone(),
            circulatory: reduced.circulatory.clone(),
            changing: reduced.changing.clone(),
            hysteresis: reduced.hysteresis.clone(),
            forces,
            scale: w.clone(),
        }
    }

    /// The same on the columns of `v`, which are orthonormal.
    pub fn onto(&self, v: &Mat<f64>) -> Self {
        let project = |a: &Mat<f64>| v.transpose() * (a * v);
        let maybe = |a: &Option<Mat<f64>>| a.as_ref().map(project);
        let stiffness = project(&self.stiffness);
        Self {
            scale: (0..v.ncols()).map(|i| stiffness[(i, i)].max(0.0).sqrt()).collect(),
            stiffness,
            varying: self.varying.iter().map(project).collect(),
            gyroscopic: maybe(&self.gyroscopic),
            damping: maybe(&self.damping),
            cross_coupling: maybe(&self.cross_coupling),
            circulatory: maybe(&self.circulatory),
            changing: self.changing.iter().map(|b| b.onto(v)).collect(),
            hysteresis: Hysteresis(self.hysteresis.0.iter().map(|[a, b]| [project(a), project(b)]).collect()),
            forces: v.transpose() * &self.forces,
        }
    }

    /// Displacements at a speed and a frequency (rad/s) for complex shares of the unit forces; `weights` are those of the varying
    /// parts at the speed. `None` where the matrix is singular.
    pub fn solve(&self, (speed, frequency): (f64, f64), weights: &[f64], shares: &[c64]) -> Option<Vec<c64>> {
        let n = self.stiffness.nrows();
        let lambda = c64::new(0.0, frequency);
        let mut real = self.stiffness.clone();
        let mut imaginary = Mat::zeros(n, n);
        for (weight, part) in weights.iter().zip(&self.varying) {
            real += part * Scale(*weight);
        }
        let into = |factor: f64, a: &Option<Mat<f64>>, sum: &mut Mat<f64>| {
            if let Some(a) = a {
                *sum += a * Scale(factor);
            }
        };
        into(1.0, &self.cross_coupling, &mut real);
        into(speed, &self.circulatory, &mut real);
        into(1.0, &self.hysteresis.matrix(1, speed, lambda), &mut real);
        into(frequency, &self.damping, &mut imaginary);
        into(frequency * speed, &self.gyroscopic, &mut imaginary);
        into(frequency, &self.hysteresis.matrix(0, speed, lambda), &mut imaginary);
        for bearing in &self.changing {
            let change = bearing.change(speed, lambda);
            add(&bearing.rows, &change.stiffness, &mut real);
            add(&bearing.rows, &change.turning, &mut real);
            add(&bearing.rows, &change.damping.map(|row| row.map(|c| frequency * c)), &mut imaginary);
        }
        let scale: Vec<f64> = self.scale.iter().map(|w| 1.0 / w.max(frequency)).collect();
        let square = frequency * frequency;
        let z = Mat::from_fn(n, n, |i, j| {
            let inertia = if i == j { square } else { 0.0 };
            c64::new(real[(i, j)] - inertia, imaginary[(i, j)]) * (scale[i] * scale[j])
        });
        let force = |i: usize| shares.iter().enumerate().map(|(j, s)| s * self.forces[(i, j)]).sum::<c64>();
        let x = z.partial_piv_lu().solve(Mat::from_fn(n, 1, |i, _| force(i) * scale[i]));
        let q: Vec<c64> = (0..n).map(|i| x[(i, 0)] * scale[i]).collect();
        q.iter().all(|v| v.is_finite()).then_some(q)
    }
}
