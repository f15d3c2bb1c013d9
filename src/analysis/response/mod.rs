//! Steady vibration: by unbalance, in step with the rotation, and by excitations at a frequency of their own.

mod compact;
pub mod harmonic;
pub mod orbit;
mod readings;
mod stability;
pub mod unbalance;
pub mod vibration;

use crate::error::{Refusal, Result};
use crate::model::{Model, WhirlFrame};

/// The frame in which the equations have constant coefficients.
///
/// # Errors
/// A rotor that has none: sections that are not round on bearings that are not alike in all directions.
fn frame(model: &Model, path: &str) -> Result<WhirlFrame> {
    if model.sections.iter().all(crate::section::Section::is_axisymmetric) {
        return Ok(WhirlFrame::Stationary);
    }
    Err(Refusal::at(
        path,
        "a section is not round: seen from space its stiffness changes with the angle, and no single frequency answers",
        "circle and tube sections; or `rotor spinup`, which takes any section",
    )
    .into())
}
