//! Matrix Market files of the system matrices, and the sidecar that names their rows.

use crate::results::{MatrixRow, PhysicalMatrix};
use serde_json::{Value, json};
use std::fmt::Write;

/// Coordinate format, general symmetry, all digits.
pub fn text(matrix: &PhysicalMatrix, title: &str) -> String {
    let mut out = String::from("%%MatrixMarket matrix coordinate real general\n");
    // writing to a string can't fail
    let _ = writeln!(
        out,
        "% {}: {}\n% {}",
        matrix.name,
        matrix.description,
        crate::report::printable::line(title)
    );
    let _ = writeln!(out, "{0} {0} {1}", matrix.size, matrix.entries.len());
    for (i, j, value) in &matrix.entries {
        let _ = writeln!(out, "{} {} {value:e}", i + 1, j + 1);
    }
    out
}

/// What each row (and column) stands for, and what each file holds.
pub fn sidecar(rows: &[MatrixRow], matrices: &[PhysicalMatrix], sha256: &str) -> Value {
    json!({
        "rotor": env!("CARGO_PKG_VERSION"),
        "case_sha256": sha256,
        "files": matrices.iter().map(|m| json!({ "file": format!("{}.mtx", m.name), "holds": m.description })).collect::<Vec<_>>(),
        "units": "SI; an unknown is a component of r (m) or of a derivative of r by y and z (1/m^(order-1))",
        "constraints": "none: supports other than bearings are not applied",
        "left_out": ["K_T: at the undeformed state at rest it equals K0"],
        "rows": rows,
    })
}
