//! Time integration of the equations of motion.

pub mod implicit;
