//! Rotordynamics on the higher-order ANCF beam element 34X3.

pub mod analysis;
pub mod assembly;
pub mod element;
pub mod error;
pub mod linalg;
pub mod model;
pub mod plot;
pub mod results;
pub mod section;
pub mod support;
