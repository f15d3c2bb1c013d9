//! How far off results may be: what members lock or miss, and what rounding takes.

pub mod coarse_bending;
pub mod locking_and_rounding;
pub mod pressure_stress;
pub mod radial_growth;
pub mod thin_wall;
