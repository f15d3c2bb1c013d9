//! Sparse and dense solvers on top of faer: the only place that knows its defects.
//!
//! Sparse symmetric factorisation with an inertia count, block shift-invert Lanczos, dense eigenproblems that are
//! scaled before and checked after, and a direct solver for general matrices of a chain of elements.

pub mod chain;
pub mod dense;
pub mod factor;
pub mod gmres;
pub mod lanczos;
pub mod lcp;
pub mod lu;
pub mod skew;
pub mod sparse;

/// Sums that are taken beside each other in [`dot_in_lanes`].
const LANES: usize = 8;

/// `a . b`, summed from first to last.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a . b`, summed in eight lanes, which vector instructions take at once; its rounding differs from that of [`dot`].
#[inline(always)]
pub fn dot_in_lanes(a: &[f64], b: &[f64]) -> f64 {
    let (a_lanes, b_lanes) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a_lanes.remainder().iter().zip(b_lanes.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; LANES];
    for (a, b) in a_lanes.zip(b_lanes) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}
