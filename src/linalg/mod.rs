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
