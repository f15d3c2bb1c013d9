//! Gauss stations along an element, side by side in SIMD lanes.

use crate::element::basis::{derivative, evaluate, lagrange};
use crate::element::kernel::simd::LANES;
use crate::element::quadrature::gauss;
use pulp::Simd;

/// Most nodes of an element.
pub const NODES: usize = 4;

/// Axial polynomials at the stations of an element.
#[derive(Debug, Clone)]
pub struct Stations {
    /// Stations, without padding.
    pub count: usize,
    /// Stations, padded to a multiple of [`LANES`]; functions and weights of what is padded are zero.
    pub padded: usize,
    /// Weights of the stations, m.
    pub weights: Vec<f64>,
    n_nodes: usize,
    /// `L_i` and `dL_i/dx`, `[derivative][node * padded + station]`.
    axial: [Vec<f64>; 2],
    /// The same times the weights of the stations.
    weighted: [Vec<f64>; 2],
}

impl Stations {
    /// `count` Gauss stations along an element of the given length (m).
    pub fn new(axial_degree: usize, length: f64, count: usize) -> Self {
        Self::of(axial_degree, length, &gauss(count))
    }

    /// Stations at places xi with weights of a rule on [-1, 1].
    pub fn of(axial_degree: usize, length: f64, points: &[(f64, f64)]) -> Self {
        let (count, n_nodes) = (points.len(), axial_degree + 1);
        assert!(n_nodes <= NODES, "tables for four nodes");
        let padded = count.next_multiple_of(LANES);
        let mut axial = [vec![0.0; n_nodes * padded], vec![0.0; n_nodes * padded]];
        let mut weighted = axial.clone();
        let mut weights: Vec<f64> = points.iter().map(|(_, w)| w * length / 2.0).collect();
        weights.resize(padded, 0.0);
        for (i, l) in lagrange(axial_degree).iter().enumerate() {
            let slope = derivative(l);
            for (s, &(xi, _)) in points.iter().enumerate() {
                let values = [evaluate(l, xi), evaluate(&slope, xi) * 2.0 / length];
                for (a, value) in values.into_iter().enumerate() {
                    axial[a][i * padded + s] = value;
                    weighted[a][i * padded + s] = value * weights[s];
                }
            }
        }
        Self { count, padded, weights, n_nodes, axial, weighted }
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.n_nodes
    }

    /// `w L_i^(a) L_j^(b)` for all pairs of nodes, at `[station * 16 + 4 i + j]`; true stands for the slope.
    pub fn node_pairs(&self, a: bool, b: bool) -> Vec<f64> {
        let (left, right) = (&self.weighted[usize::from(a)], &self.axial[usize::from(b)]);
        let mut table = vec![0.0; self.padded * NODES * NODES];
        for (i, left) in left.chunks_exact(self.padded).enumerate() {
            for (j, right) in right.chunks_exact(self.padded).enumerate() {
                for s in 0..self.padded {
                    table[(s * NODES + i) * NODES + j] = left[s] * right[s];
                }
            }
        }
        table
    }

    /// Vector k of `n_vectors` and its slope along x at a batch of stations: as many as a register holds.
    #[inline(always)]
    pub(in crate::element) fn collapse<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        (k, n_vectors): (usize, usize),
        batch: usize,
    ) -> [[S::f64s; 3]; 2] {
        let width = self.padded / S::F64_LANES;
        let (values, slopes) = (S::as_simd_f64s(&self.axial[0]).0, S::as_simd_f64s(&self.axial[1]).0);
        let (mut value, mut slope) = ([simd.splat_f64s(0.0); 3], [simd.splat_f64s(0.0); 3]);
        for node in 0..self.n_nodes {
            let q = &q[3 * (node * n_vectors + k)..][..3];
            for i in 0..3 {
                let q = simd.splat_f64s(q[i]);
                value[i] = simd.mul_add_e_f64s(q, values[node * width + batch], value[i]);
                slope[i] = simd.mul_add_e_f64s(q, slopes[node * width + batch], slope[i]);
            }
        }
        [value, slope]
    }

    /// The transpose of [`Self::collapse`]: adds forces on a vector and on its slope to those on the nodes.
    #[inline(always)]
    pub(in crate::element) fn add_force<S: Simd>(
        &self,
        simd: S,
        [on_value, on_slope]: [[S::f64s; 3]; 2],
        (k, n_vectors): (usize, usize),
        batch: usize,
        force: &mut [f64],
    ) {
        let width = self.padded / S::F64_LANES;
        let (values, slopes) = (S::as_simd_f64s(&self.weighted[0]).0, S::as_simd_f64s(&self.weighted[1]).0);
        for node in 0..self.n_nodes {
            let (value, slope) = (values[node * width + batch], slopes[node * width + batch]);
            let target = &mut force[3 * (node * n_vectors + k)..][..3];
            for i in 0..3 {
                let sum = simd.mul_add_e_f64s(slope, on_slope[i], simd.mul_f64s(value, on_value[i]));
                target[i] += simd.reduce_sum_f64s(sum);
            }
        }
    }
}
