//! `rotor matrices`.

use crate::analysis::matrices::matrices;
use crate::cli::analyse::{RunArguments, load};
use crate::cli::terminal::print;
use crate::cli::{cost, written_paths};
use crate::error::Result;
use crate::model::Model;
use crate::report::{files, json, matrix_market};
use std::process::ExitCode;
use std::time::Instant;

/// Writes the matrices of a shaft.
///
/// # Errors
/// Bad input, or files that can't be written.
pub(super) fn write_matrices(arguments: &RunArguments) -> Result<ExitCode> {
    let start = Instant::now();
    let (loaded, folder) = load(arguments, "matrices")?;
    let model = Model::new(&loaded)?;
    let (rows, list) = matrices(&model);
    let mut pending: Vec<(String, String)> = list
        .iter()
        .map(|m| (format!("{}.mtx", m.name), matrix_market::text(m, &loaded.case.title)))
        .collect();
    pending.push((
        "matrices.json".to_owned(),
        json::text(&matrix_market::sidecar(&rows, &list, &loaded.sha256)),
    ));
    let set =
        files::Set { analysis: "matrices", case: &arguments.case, files: pending, cost: cost(start, None) };
    let paths = files::write_set(&folder, set)?;
    if !arguments.quiet {
        print(&format!("{} unknowns, unconstrained, physical units\n{}", rows.len(), written_paths(&paths)))?;
    }
    Ok(ExitCode::SUCCESS)
}
