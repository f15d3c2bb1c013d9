//! The system matrices of a shaft.

/// One row (and column) of the matrices: an unknown of the unconstrained shaft.
#[derive(Debug, Clone, serde::Serialize)]
pub struct MatrixRow {
    /// Node, from 1.
    pub node: usize,
    /// Position of the node, m.
    pub x_m: f64,
    /// Vector, e.g. "r", "y", "yz": the derivative of the position, in 1/m^order; of a ring "P1cos2": what multiplies
    /// that function, in m; "normal2" is the unit normal that carries what the thickness of the second disk adds to its
    /// diametral inertia.
    pub vector: String,
    /// Component: "x", "y" or "z".
    pub component: &'static str,
}

/// A named matrix in physical units, entries `(row, column, value)` from 0, column by column.
pub struct PhysicalMatrix {
    /// "M", "G", "N" or "K0".
    pub name: &'static str,
    /// What it is, with the form it belongs to.
    pub description: &'static str,
    /// Number of rows.
    pub size: usize,
    /// Entries that are not zero.
    pub entries: Vec<(usize, usize, f64)>,
}
