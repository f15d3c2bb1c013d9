//! Bodies in the plane: their boundaries, the points that may touch, and overlap at the start.

pub mod boundary;
pub mod overlap;
pub mod probes;
