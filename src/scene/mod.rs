//! Contact between beams: boundaries, detection, gaps, and their enforcement by penalty or complementarity.
//!
//! What touches is a probe (a Gauss point of a line, a corner, a node) against the boundary of a body; a probe knows positions,
//! derivatives and the coordinates behind them and nothing of elements. Source: docs/theory/contact.md.

pub mod bodies;
pub mod gap;
pub mod near_pairs;
pub mod penalty;
pub mod planar;
pub mod spatial;
