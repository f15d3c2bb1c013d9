//! What the force kernels of all elements share.

pub mod pair_stiffness;
pub mod simd;
pub mod stations;
pub mod vectorised;
