//! Tables of contact scenes.

use crate::report::table::columns;
use crate::results::{Contact, SceneCheck};

/// A contact scene as it is placed.
pub fn scene(results: &SceneCheck) -> String {
    let place = |p: &[f64; 3]| format!("{:.6}, {:.6}, {:.6}", p[0], p[1], p[2]);
    let rows: Vec<Vec<String>> = results
        .bodies
        .iter()
        .map(|b| {
            vec![
                b.name.clone(),
                format!("{} {}", b.elements, b.element),
                b.degrees_of_freedom.to_string(),
                format!("{:.6}", b.mass_kg),
                format!("{:.6}", b.length_m),
                place(&b.start_m),
                place(&b.end_m),
                format!("{}, {}", b.supports, b.loads),
            ]
        })
        .collect();
    let head = [
        "body",
        "elements",
        "unknowns",
        "mass (kg)",
        "length (m)",
        "start (m)",
        "end (m)",
        "supports, loads",
    ];
    let mut text = columns(&head, &rows);
    if !results.pairs.is_empty() {
        let gap = |gap: Option<f64>| gap.map_or("-".to_owned(), |g| format!("{g:.6e}"));
        let pairs: Vec<Vec<String>> =
            results.pairs.iter().map(|p| vec![p.pair.join(" - "), gap(p.gap_m)]).collect();
        text += "\n";
        text += &columns(&["pair", "gap at the start (m)"], &pairs);
    }
    text += &format!("\n  unknowns before supports {}\n", results.unconstrained_degrees_of_freedom);
    text += &match results.method {
        "penalty" => {
            format!("  contact by                penalty, {:.4e} N/m^3 along lines\n", results.penalty_n_m3)
        }
        method => format!("  contact by                {method}\n"),
    };
    text += &match (results.until_s, results.step_s, results.integrator) {
        (Some(until), Some(step), Some(name)) => {
            format!(
                "  motion                    {until} s in {} steps of {step:.4e} s, {name}\n",
                results.steps
            )
        }
        _ => format!("  equilibrium               in {} load steps\n", results.steps),
    };
    text
}

/// Beams in contact.
pub fn contact(results: &Contact) -> String {
    let ends: Vec<Vec<String>> = results
        .bodies
        .iter()
        .map(|b| {
            let place = |p: &[f64; 3]| format!("{:.6}, {:.6}, {:.6}", p[0], p[1], p[2]);
            vec![
                b.name.clone(),
                format!("{} {}", b.elements, b.element),
                place(&b.end_m),
                place(&b.end_displacement_m),
            ]
        })
        .collect();
    let mut text = columns(&["body", "elements", "end (m)", "displacement of its end (m)"], &ends);
    let pairs: Vec<Vec<String>> = results
        .pairs
        .iter()
        .map(|p| {
            vec![
                p.pair.join(" - "),
                p.gap_m.map_or("-".to_owned(), |g| format!("{g:.6e}")),
                format!("{:.3e}", p.penetration_m),
                format!("{:.4e}", p.force_n.iter().map(|f| f * f).sum::<f64>().sqrt()),
                p.kind.unwrap_or("none").to_owned(),
            ]
        })
        .collect();
    if !pairs.is_empty() {
        text += "\n";
        text += &columns(&["pair", "gap (m)", "penetration (m)", "force (N)", "contact"], &pairs);
    }
    if !results.events.is_empty() {
        const SHOWN: usize = 20;
        let rows: Vec<Vec<String>> = results
            .events
            .iter()
            .take(SHOWN)
            .map(|e| {
                vec![
                    e.pair.join(" - "),
                    format!("{:.6}", e.time_s),
                    e.until_s.map_or("-".to_owned(), |t| format!("{t:.6}")),
                    format!("{:.3e}", -e.gap_m),
                    format!("{:.4e}", e.force_n),
                    e.kinds.join(", "),
                ]
            })
            .collect();
        text += "\n";
        text +=
            &columns(&["contact of", "from (s)", "until (s)", "penetration (m)", "force (N)", "kind"], &rows);
        if results.events.len() > SHOWN {
            text += &format!("  and {} more in the report\n", results.events.len() - SHOWN);
        }
    }
    if let (Some(error), Some(last)) = (results.energy_error, results.energy_change) {
        text += &format!(
            "\n  energy: largest change {error:.2e}, at the end {last:+.2e} of the largest kinetic energy\n"
        );
    }
    if let (Some(momentum), Some(angular)) = (results.momentum_residual, results.angular_momentum_residual) {
        text += &format!("  momentum: missing at most {momentum:.2e}, of the angular one {angular:.2e}\n");
    }
    let solver = &results.solver;
    text += &format!(
        "  {} steps, {} cut, {} Newton iterations, {} complementarity problems, {} searches\n",
        solver.steps, solver.cut, solver.iterations, solver.complementarity_problems, solver.searches
    );
    text
}
