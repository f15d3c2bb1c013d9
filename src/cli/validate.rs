//! `rotor validate`: arguments, and the table of what is compared.

use crate::case::Case;
use crate::cli::terminal::print;
use crate::error::{Error, Result};
use crate::report::table;
use crate::validate::{Comparison, validate};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Arguments of a comparison.
#[derive(Args)]
pub(super) struct ValidateArguments {
    /// Case files [default: every .json in cases/]
    cases: Vec<PathBuf>,
    /// Print only what is out of tolerance
    #[arg(long)]
    quiet: bool,
}

/// Runs what cases expect and prints ours, reference and error.
///
/// # Errors
/// Bad input, or an analysis that does not succeed.
pub(super) fn validate_cases(arguments: &ValidateArguments) -> Result<ExitCode> {
    let cases = if arguments.cases.is_empty() { all_cases()? } else { arguments.cases.clone() };
    let (mut total, mut out) = (0, 0);
    for path in &cases {
        let loaded = Case::load(path, &[])?;
        let comparisons = validate(&loaded)?;
        total += comparisons.len();
        let failed = comparisons.iter().filter(|c| !c.holds()).count();
        out += failed;
        if !arguments.quiet || failed > 0 {
            let shown: Vec<&Comparison> =
                comparisons.iter().filter(|c| !arguments.quiet || !c.holds()).collect();
            print(&format!("{}\n{}\n", path.display(), comparison_table(&shown)))?;
        }
    }
    print(&format!("{} of {total} values within tolerance, {} cases\n", total - out, cases.len()))?;
    Ok(ExitCode::from(u8::from(out > 0)))
}

fn all_cases() -> Result<Vec<PathBuf>> {
    let folder = Path::new("cases");
    let entries =
        std::fs::read_dir(folder).map_err(|e| Error::io(folder, "read this folder of cases", &e))?;
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    Ok(paths)
}

fn comparison_table(comparisons: &[&Comparison]) -> String {
    if comparisons.is_empty() {
        return "  nothing expected\n".to_owned();
    }
    // small values in powers of ten: a growth of micrometres has digits too
    let number = |value: Option<f64>| match value {
        None => "-".to_owned(),
        Some(v) if v != 0.0 && v.abs() < 0.1 => format!("{v:.6e}"),
        Some(v) => format!("{v:.6}"),
    };
    let rows: Vec<Vec<String>> = comparisons
        .iter()
        .map(|c| {
            vec![
                if c.holds() { "ok" } else { "OUT" }.to_owned(),
                number(c.ours),
                number(Some(c.reference)),
                c.error().map_or("-".to_owned(), |e| format!("{e:.1e}")),
                format!("{:.1e}", c.tolerance),
                number(c.published),
                match c.ours {
                    Some(_) => format!("{} {} ({})", c.analysis, c.path, c.source),
                    None => {
                        format!("{} {}: the report has no number there ({})", c.analysis, c.path, c.source)
                    }
                },
            ]
        })
        .collect();
    table::columns(&["", "ours", "reference", "error", "tolerance", "published", "value (source)"], &rows)
}
