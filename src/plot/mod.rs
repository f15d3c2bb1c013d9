//! Figures of the results as SVG text, a file for each analysis. Plots see only [`crate::results`], never the model or an analysis, and
//! the same results always give the same bytes. All figures are drawn with [`crate::draw`].

pub mod campbell;
pub mod contact;
mod forces;
pub mod harmonic;
pub mod map;
pub mod modes;
mod response;
mod section;
pub mod spinup;
pub mod statics;
pub mod tradeoff;
pub mod unbalance;
