//! Sparse and dense solvers on top of faer: the only place that knows its defects.
//!
//! Sparse symmetric factorisation with an inertia count, block shift-invert Lanczos, and dense
//! eigenproblems that are scaled before and checked after.

pub mod dense;
pub mod factor;
pub mod lanczos;
pub mod lu;
pub mod sparse;
