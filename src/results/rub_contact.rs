//! What happens where a shaft meets a ring.

/// State of a shaft at a ring.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RubContact {
    /// Gap, positive when open, m.
    pub gap: f64,
    /// Force N of the ring towards its centre, N.
    pub normal_force: f64,
    /// Friction on the shaft's surface along e_x x n, N: negative when the surface slips in the positive sense.
    pub friction_force: f64,
    /// Slip w of the surface, m/s.
    pub slip: f64,
}
