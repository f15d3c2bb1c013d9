//! Rotordynamics on the higher-order ANCF beam element 34X3.

pub mod error;
pub mod model;
pub mod plot;
pub mod results;
pub mod section;
