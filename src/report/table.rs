//! Short tables for the terminal.

use crate::results::{Campbell, Check, Diagnostic, Level, ModelSummary, Modes};
use std::f64::consts::TAU;

/// Columns of text, right-aligned under their heads; the last column is left-aligned.
pub fn columns(head: &[&str], rows: &[Vec<String>]) -> String {
    let width = |c: usize| {
        rows.iter().map(|r| r[c].chars().count()).chain([head[c].chars().count()]).max().unwrap_or(0)
    };
    let line = |cells: Vec<&str>| {
        let mut text = String::from(" ");
        for (c, cell) in cells.iter().enumerate() {
            let space = width(c).saturating_sub(cell.chars().count());
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
    text += &format!("  modelled: {}\n", summary.modelled.join("; "));
    if !summary.left_out.is_empty() {
        text += &format!("  left out: {}\n", summary.left_out.join("; "));
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

/// Natural modes.
pub fn modes(results: &Modes) -> String {
    let rows: Vec<Vec<String>> = results
        .modes
        .iter()
        .map(|m| {
            vec![
                m.number.to_string(),
                format!("{:.4}", m.frequency_rad_s),
                format!("{:.5}", m.frequency_hz),
                m.circumferential_order.to_string(),
                format!("{:?}", m.kind).to_lowercase(),
            ]
        })
        .collect();
    columns(&["mode", "rad/s", "Hz", "waves", "kind"], &rows)
}

/// Critical speeds and the branches at the ends of the sweep.
pub fn campbell(results: &Campbell) -> String {
    let hz =
        |f: Option<&Option<f64>>| f.copied().flatten().map_or("-".to_owned(), |f| format!("{:.4}", f / TAU));
    let rows: Vec<Vec<String>> = results
        .branches
        .iter()
        .map(|b| {
            let least = b.log_decrement.iter().flatten().copied().fold(f64::INFINITY, f64::min);
            vec![
                b.name.clone(),
                hz(b.frequency_rad_s.first()),
                hz(b.frequency_rad_s.last()),
                if least.is_finite() { format!("{least:.4}") } else { "-".to_owned() },
                format!("{:?}", b.whirl).to_lowercase(),
                format!("{:?}", b.kind).to_lowercase(),
            ]
        })
        .collect();
    let mut text = format!("  {} frame, {} form\n\n", results.frame, results.form);
    text += &columns(
        &["branch", "Hz at first speed", "Hz at last speed", "least log decrement", "whirl", "kind"],
        &rows,
    );
    for range in results.unstable_ranges.iter().flatten() {
        text += &format!(
            "  unstable: {} from {:.3} to {:.3} rpm, growth rate up to {:.4} 1/s\n",
            range.branch, range.from_rpm, range.to_rpm, range.largest_growth_rate_1_s
        );
    }
    text += "\n  critical speeds\n";
    if results.critical_speeds.is_empty() {
        return text + "  none within the sweep\n";
    }
    let rows: Vec<Vec<String>> = results
        .critical_speeds
        .iter()
        .enumerate()
        .map(|(i, c)| {
            vec![
                (i + 1).to_string(),
                format!("{:.3}", c.speed_rpm),
                format!("{:.4}", c.speed_rad_s / TAU),
                c.branch.clone().unwrap_or_else(|| "-".to_owned()),
                if c.damped { "damped crossing" } else { "eigenvalue" }.to_owned(),
                format!("{:?} {:?}", c.whirl, c.kind).to_lowercase(),
            ]
        })
        .collect();
    text + &columns(&["no.", "rpm", "Hz", "branch", "solved as", "whirl, kind"], &rows)
}

/// Size and mass properties.
pub fn check(results: &Check) -> String {
    let [x, y, z] = results.center_of_mass_m;
    let rigid =
        if results.rigid_motions.is_empty() { "none".to_owned() } else { results.rigid_motions.join(", ") };
    format!(
        "  nodes                    {}\n  unknowns before supports {}\n  rigid motions left       {rigid}\n  \
         length                   {} m\n  mass of shaft, disks     {:.6} kg, {:.6} kg\n  \
         centre of mass           ({x:.6}, {y:.6}, {z:.6}) m\n  polar inertia            {:.6e} kg m^2\n  \
         inertia about y, z       {:.6e}, {:.6e} kg m^2 (through the centre of mass)\n  \
         estimated                {:.0} MB, {:.1} s (campbell on one core)\n",
        results.nodes,
        results.unconstrained_degrees_of_freedom,
        results.length_m,
        results.shaft_mass_kg,
        results.disk_mass_kg,
        results.polar_inertia_kg_m2,
        results.inertia_y_kg_m2,
        results.inertia_z_kg_m2,
        results.estimated_memory_mb,
        results.estimated_time_s,
    )
}
