//! A shaft: its elements with what is attached to it, the forces on it and its equations of motion.

pub mod acting;
pub mod assembly;
pub mod attachments;
pub mod drive;
pub mod internal_forces;
pub mod loads;
pub mod motion;
pub mod spectrum;
pub mod stator_ring;
