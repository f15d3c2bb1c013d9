//! Anderson's acceleration of Newton iterations by secants of earlier steps.

use crate::linalg::dot_in_lanes;
use nalgebra::{DMatrix, DVector};

/// Anderson's acceleration (J. ACM 12, 1965; type II): differences of steps s and of corrections d between
/// iterations tell how the matrix differs from the tangent. They outlive a stage: the next one starts with them.
#[derive(Default)]
pub(super) struct Secants {
    /// `(s + delta d, delta d)`, the latter of unit length, in a ring.
    pairs: Vec<(Vec<f64>, Vec<f64>)>,
    /// Place of the next pair.
    next: usize,
    /// Scalar products of the `delta d` of the kept pairs.
    gram: [[f64; KEPT_PAIRS]; KEPT_PAIRS],
    step: Vec<f64>,
    correction: Vec<f64>,
}

/// Pairs that are kept.
const KEPT_PAIRS: usize = 6;

/// Regularisation of nearly dependent pairs.
const GRAM_REGULARISATION: f64 = 1e-10;

impl Secants {
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.next = 0;
    }

    /// Turns the correction d into `d - sum g_j (s_j + delta d_j)` with g the least squares solution of
    /// `d = sum g_j delta d_j`. `follows`: the last correction belongs to the same stage.
    pub(super) fn improve(&mut self, d: &mut [f64], follows: bool) {
        if follows {
            self.learn(d);
        }
        self.correction.clear();
        self.correction.extend_from_slice(d);
        let m = self.pairs.len();
        if m > 0 {
            let gram = DMatrix::from_fn(m, m, |i, j| {
                self.gram[i][j] + if i == j { GRAM_REGULARISATION } else { 0.0 }
            });
            let right = DVector::from_fn(m, |i, _| dot_in_lanes(&self.pairs[i].1, d));
            if let Some(cholesky) = gram.cholesky() {
                let weights = cholesky.solve(&right);
                for ((s, _), weight) in self.pairs.iter().zip(weights.iter()) {
                    d.iter_mut().zip(s).for_each(|(d, s)| *d -= weight * s);
                }
            }
        }
        self.step.clear();
        self.step.extend_from_slice(d);
    }

    pub(super) fn learn(&mut self, d: &[f64]) {
        if self.pairs.len() < KEPT_PAIRS {
            self.pairs.push((vec![0.0; d.len()], vec![0.0; d.len()]));
            self.next = self.pairs.len() - 1;
        }
        let at = self.next;
        let (s, y) = &mut self.pairs[at];
        y.iter_mut().zip(d.iter().zip(&self.correction)).for_each(|(y, (d, old))| *y = d - old);
        // unit length: pairs differ by many decades
        let scale = 1.0 / dot_in_lanes(y, y).sqrt().max(f64::MIN_POSITIVE);
        y.iter_mut().for_each(|y| *y *= scale);
        s.iter_mut().zip(self.step.iter().zip(&*y)).for_each(|(s, (step, y))| *s = scale * step + y);
        for j in 0..self.pairs.len() {
            let product = dot_in_lanes(&self.pairs[at].1, &self.pairs[j].1);
            (self.gram[at][j], self.gram[j][at]) = (product, product);
        }
        self.next = (at + 1) % KEPT_PAIRS;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear problem with a matrix that serves badly: secants make the iteration end after as many iterations as there are unknowns,
    /// which without them takes hundreds.
    #[test]
    fn secants_solve_a_linear_problem_in_as_many_iterations_as_unknowns() {
        let exact = [3.0, -1.0, 2.0, 0.5];
        // the tangent is diagonal and not the identity that stands for it
        let tangent = [0.2, 1.7, 0.6, 1.1];
        let run = |accelerated: bool| {
            let (mut secants, mut x) = (Secants::default(), [0.0; 4]);
            for iteration in 0..1000 {
                let mut d: Vec<f64> = (0..4).map(|k| tangent[k] * (exact[k] - x[k])).collect();
                if d.iter().all(|d| d.abs() < 1e-8) {
                    return iteration;
                }
                if accelerated {
                    secants.improve(&mut d, iteration > 0);
                }
                (0..4).for_each(|k| x[k] += d[k]);
            }
            1000
        };
        assert!(run(true) <= 7, "{}", run(true));
        assert!(run(false) > 50, "{}", run(false));
    }
}
