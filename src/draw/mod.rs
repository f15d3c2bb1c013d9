//! What every figure is drawn with. Figures say what they show; this module says how it looks, and writes it as SVG.
//!
//! Lengths are logical pixels, x to the right and y downwards. The same calls always give the same bytes.

pub mod axes;
pub mod clip;
pub mod labels;
pub mod palette;
pub mod panels;
pub mod pen;
pub mod sheet;
pub mod svg;
pub mod text;
