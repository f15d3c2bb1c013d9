//! Figures of the results as SVG text. Plots see only [`crate::results`], never the model or an analysis, and
//! the same results always give the same bytes. All figures share the look defined in [`style`].

pub mod campbell;
pub mod contact;
mod forces;
pub mod modes;
pub mod panels;
pub mod spinup;
pub mod style;
pub mod tradeoff;
