//! Short tables for the terminal.

mod linear;
mod response;
mod scene;
mod shaft;
mod tradeoff;

pub use linear::{campbell, check, modes};
pub use response::{harmonic, map, unbalance};
pub use scene::{contact, scene};
pub use shaft::{spinup, statics};
pub use tradeoff::tradeoff;

use crate::results::{Diagnostic, Level, ModelSummary, listed};

/// Columns of text, right-aligned under their heads; the last column is left-aligned.
pub fn columns(head: &[&str], rows: &[Vec<String>]) -> String {
    let width = |c: usize| {
        rows.iter().map(|r| r[c].chars().count()).chain([head[c].chars().count()]).max().unwrap_or(0)
    };
    // once for all rows: a line of probes has ten thousand
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let line = |cells: Vec<&str>| {
        let mut text = String::from(" ");
        for (c, cell) in cells.iter().enumerate() {
            let space = widths[c].saturating_sub(cell.chars().count());
            if c + 1 == cells.len() {
                text += &format!(" {cell}");
            } else {
                text += &format!(" {}{cell} ", " ".repeat(space));
            }
        }
        text.trim_end().to_owned() + "\n"
    };
    let mut text = line(head.to_vec());
    for row in rows {
        text += &line(row.iter().map(String::as_str).collect());
    }
    text
}

/// What was modelled and left out.
pub fn model(summary: &ModelSummary) -> String {
    let mut text = format!(
        "  {} elements, {} degrees of freedom, {:.6} kg\n",
        summary.elements, summary.degrees_of_freedom, summary.mass_kg
    );
    text += &format!("  modelled: {}\n", listed(&summary.modelled));
    if !summary.left_out.is_empty() {
        text += &format!("  left out: {}\n", listed(&summary.left_out));
    }
    text
}

/// Remarks, one a line.
pub fn diagnostics(list: &[Diagnostic]) -> String {
    let name = |level| match level {
        Level::Info => "note",
        Level::Warning => "warning",
        Level::Error => "error",
    };
    list.iter().map(|d| format!("  {}: {} [{}]\n", name(d.level), d.message, d.code)).collect()
}

/// Share of the largest value beside it below which a value is what rounding leaves of zero.
const NOISE: f64 = 1e-11;

/// A value with so many decimals, or "0" where it is noise beside the largest of its kind.
fn beside(value: f64, largest: f64, decimals: usize) -> String {
    if value.abs() <= NOISE * largest { "0".to_owned() } else { format!("{value:.decimals$e}") }
}

/// Largest of some values, by size.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, v| most.max(v.abs()))
}

/// A place in metres without the digits that sums leave.
fn short(place: f64) -> String {
    let text = format!("{place:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "0" && place != 0.0 { format!("{place:e}") } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_and_the_rounding_of_sums_are_not_printed() {
        assert_eq!([beside(3.99e-6, 1.9e8, 6), beside(-2.5, 1.9e8, 2)], ["0", "-2.50e0"]);
        assert_eq!([short(3.3999999999999995), short(2.0), short(0.0)], ["3.4", "2", "0"]);
    }
}
