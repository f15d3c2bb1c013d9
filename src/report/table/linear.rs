//! Tables of the linear analyses: check, modes, Campbell diagram.

use crate::report::table::{columns, short};
use crate::results::{Branch, Campbell, Check, Modes, Whirl};
use std::f64::consts::TAU;

/// Table of the natural modes.
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
                m.kind.name().to_owned(),
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
                senses(b),
                b.kind.name().to_owned(),
            ]
        })
        .collect();
    let mut text = format!("  {} frame, {} form\n\n", results.frame, results.form);
    text += &columns(
        &["branch", "Hz at first speed", "Hz at last speed", "least log decrement", "whirl", "kind"],
        &rows,
    );
    text += &overdamped(results);
    for range in &results.unstable_ranges {
        text += &format!(
            "  unstable: {} from {:.3} to {:.3} rpm, growth rate up to {:.4} 1/s\n",
            range.branch, range.from_rpm, range.to_rpm, range.largest_growth_rate_1_s
        );
    }
    match (results.stability_threshold_rad_s, results.speeds_rad_s.first()) {
        (Some(speed), Some(first)) if speed <= *first => text += "  unstable from the first speed\n",
        (Some(speed), _) => {
            text += &format!("  stable below {:.3} rpm ({speed:.4} rad/s)\n", speed * 60.0 / TAU);
        }
        _ => {}
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
                format!("{} {}", c.whirl.name(), c.kind.name()),
            ]
        })
        .collect();
    text + &columns(&["no.", "rpm", "Hz", "branch", "solved as", "whirl, kind"], &rows)
}

/// The senses of a branch from speed to speed, each once in turn.
fn senses(branch: &Branch) -> String {
    let mut list: Vec<Whirl> = Vec::new();
    let oscillating = branch.whirl_at_speed.iter().zip(&branch.frequency_rad_s).filter(|(_, f)| f.is_some());
    for (whirl, _) in oscillating {
        if list.last() != Some(whirl) {
            list.push(*whirl);
        }
    }
    match list[..] {
        [] => Whirl::None.name().to_owned(),
        [.., last] if list.len() > 3 => format!("{}, .., {}", list[0].name(), last.name()),
        _ => list.into_iter().map(Whirl::name).collect::<Vec<_>>().join(", "),
    }
}

/// How many branches are overdamped, and where they begin to whirl.
fn overdamped(results: &Campbell) -> String {
    let list: Vec<&Branch> = results.branches.iter().filter(|b| !b.overdamped.is_empty()).collect();
    if list.is_empty() {
        return String::new();
    }
    let of = |b: &Branch| {
        let last = b.overdamped.iter().copied().fold(0.0, f64::max);
        let whirls =
            results.speeds_rad_s.iter().zip(&b.frequency_rad_s).find(|(s, f)| **s > last && f.is_some());
        let until = match whirls {
            Some((speed, _)) => format!("begins to whirl before {:.1} rpm", speed * 60.0 / TAU),
            None if b.frequency_rad_s.iter().all(Option::is_none) => "at all speeds".to_owned(),
            None => format!("from {:.1} rpm", b.overdamped[0] * 60.0 / TAU),
        };
        format!("{} {until}", b.name)
    };
    let words: Vec<String> = list.iter().map(|b| of(b)).collect();
    format!("  overdamped: {} of {} branches ({})\n", list.len(), results.branches.len(), words.join("; "))
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
        short(results.length_m),
        results.shaft_mass_kg,
        results.disk_mass_kg,
        results.polar_inertia_kg_m2,
        results.inertia_y_kg_m2,
        results.inertia_z_kg_m2,
        results.estimated_memory_mb,
        results.estimated_time_s,
    )
}
