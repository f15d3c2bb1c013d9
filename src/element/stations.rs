//! Gauss stations along an element, side by side in SIMD lanes.

use super::basis::{derivative, evaluate, lagrange};
use super::quadrature::gauss;

/// Stations are padded to a multiple of the widest SIMD register.
pub const LANES: usize = 8;
/// Pairs of nodes of an element, padded: 4 x 4.
pub const NODE_PAIRS: usize = 16;

/// Axial polynomials at the stations of an element.
#[derive(Debug, Clone)]
pub struct Stations {
    /// Stations, without padding.
    pub count: usize,
    /// Stations, padded to a multiple of [`LANES`]; what is padded has weight zero.
    pub padded: usize,
    /// `L_i` and `dL_i/dx`, `[derivative][node * padded + station]`.
    pub axial: [Vec<f64>; 2],
    /// The same times the weights of the stations.
    pub weighted: [Vec<f64>; 2],
    /// Weights of the stations, m.
    pub weights: Vec<f64>,
    /// `w L_i^(a) L_j^(b)` at `[2 a + b][station * 16 + 4 i + j]`.
    pub pairs: [Vec<f64>; 4],
}

impl Stations {
    /// `count` Gauss stations along an element of the given length (m).
    pub fn new(axial_degree: usize, length: f64, count: usize) -> Self {
        let (points, n_nodes) = (gauss(count), axial_degree + 1);
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
        let pairs = [0, 1, 2, 3].map(|pair| {
            let mut table = vec![0.0; padded * NODE_PAIRS];
            for s in 0..count {
                for i in 0..n_nodes {
                    for j in 0..n_nodes {
                        let (left, right) = (&weighted[pair / 2], &axial[pair % 2]);
                        table[s * NODE_PAIRS + 4 * i + j] = left[i * padded + s] * right[j * padded + s];
                    }
                }
            }
            table
        });
        Self { count, padded, axial, weighted, weights, pairs }
    }
}
