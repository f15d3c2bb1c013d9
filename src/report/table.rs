//! Short tables for the terminal.

use crate::results::{
    Branch, Campbell, Check, Contact, Diagnostic, Level, ModelSummary, Modes, ProbeState, RubSummary,
    SceneCheck, SectionForces, SpinState, Spinup, Static, StatorSummary, SupportForces, Tradeoff,
    TradeoffPoint, Trust, Whirl,
};
use std::f64::consts::TAU;

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
                senses(b),
                format!("{:?}", b.kind).to_lowercase(),
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
                format!("{:?} {:?}", c.whirl, c.kind).to_lowercase(),
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
    let word = |whirl: Whirl| format!("{whirl:?}").to_lowercase();
    match list[..] {
        [] => word(Whirl::None),
        [.., last] if list.len() > 3 => format!("{}, .., {}", word(list[0]), word(last)),
        _ => list.into_iter().map(word).collect::<Vec<_>>().join(", "),
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

/// Displacements and stress at the probes.
fn probes(list: &[ProbeState]) -> String {
    let mut rows = Vec::new();
    let points = || list.iter().flat_map(|probe| probe.point.iter().chain(&probe.points));
    let moved = largest(points().flat_map(|p| p.displacement_m));
    let stressed = largest(points().map(|p| p.stress_pa.von_mises));
    for probe in list {
        for point in probe.point.iter().chain(&probe.points) {
            let [x, y, z] = point.displacement_m;
            let mut row = vec![probe.name.clone(), format!("{:.4}", probe.at_m)];
            row.extend([point.y_m, point.z_m].map(|v| format!("{v:.4}")));
            row.extend([x, y, z].map(|v| beside(v, moved, 6)));
            row.push(beside(point.stress_pa.von_mises, stressed, 4));
            rows.push(row);
        }
    }
    if rows.is_empty() {
        return String::new();
    }
    columns(&["probe", "x (m)", "y (m)", "z (m)", "u_x (m)", "u_y (m)", "u_z (m)", "von Mises (Pa)"], &rows)
}

/// Static equilibrium.
pub fn statics(results: &Static) -> String {
    let newton = &results.newton;
    let mut text = format!(
        "  load factor {:.6}, {} load steps ({} cut), {} Newton iterations, relative energy of the last correction {:.1e}\n\
        \x20 strain energy {:.6e} J, largest principal strain {:.3e}\n",
        results.load_factor,
        newton.load_steps,
        newton.cuts,
        newton.iterations,
        newton.residual,
        results.strain_energy_j,
        results.largest_strain
    );
    text += &probes(&results.probes);
    text + &supports(&results.support_forces) + &sections(&results.sections)
}

/// Forces and moments of supports and bearings in one state.
fn supports(found: &SupportForces<[f64; 3]>) -> String {
    let carried = largest(found.forces_n.values().flatten().copied());
    let turned = largest(found.moments_n_m.values().flatten().copied());
    let row = |(path, force): (&String, &[f64; 3])| {
        let mut row = vec![found.at_m.get(path).map_or_else(String::new, |x| format!("{x:.4}"))];
        row.extend(force.map(|f| beside(f, carried, 6)));
        match found.moments_n_m.get(path) {
            Some(moment) => row.extend(moment.map(|m| beside(m, turned, 4))),
            None => row.extend([(); 3].map(|()| "-".to_owned())),
        }
        row.push(path.clone());
        row
    };
    let rows: Vec<Vec<String>> = found.forces_n.iter().map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = ["x (m)", "F_x (N)", "F_y (N)", "F_z (N)", "M_x (N m)", "M_y (N m)", "M_z (N m)", "support"];
    columns(&head, &rows)
}

/// The largest forces and moments of supports, bearings and rings over time.
fn supports_over_time(time: &[f64], found: &SupportForces<Vec<[f64; 3]>>) -> String {
    let most = |list: &[[f64; 3]]| {
        let sizes = list.iter().map(|v| v.iter().map(|v| v * v).sum::<f64>().sqrt());
        sizes.zip(time).fold((0.0, 0.0), |most, (v, t)| if v > most.0 { (v, *t) } else { most })
    };
    let row = |(path, forces): (&String, &Vec<[f64; 3]>)| {
        let mut row = vec![found.at_m.get(path).map_or_else(String::new, |x| format!("{x:.4}"))];
        for list in [Some(forces), found.moments_n_m.get(path)] {
            match list.map(|list| most(list)) {
                Some((v, t)) => row.extend([format!("{v:.4e}"), format!("{t:.5}")]),
                None => row.extend(["-".to_owned(), "-".to_owned()]),
            }
        }
        row.push(path.clone());
        row
    };
    let rows: Vec<Vec<String>> = found.forces_n.iter().map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    columns(&["x (m)", "largest force (N)", "at (s)", "largest moment (N m)", "at (s)", "support"], &rows)
}

/// The largest of what passes through the shaft.
fn sections(s: &SectionForces) -> String {
    let pairs = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a.hypot(*b)).collect::<Vec<_>>();
    let words = |(name, unit, list): (&str, &str, Vec<f64>)| {
        let sizes = list.into_iter().map(f64::abs).zip(&s.x_m);
        let most = sizes.fold((0.0, 0.0), |most, (v, x)| if v > most.0 { (v, *x) } else { most });
        format!("{name} {:.4e} {unit} at {} m", most.0, short(most.1))
    };
    let list = [
        ("axial force", "N", s.axial_force_n.clone()),
        ("shear", "N", pairs(&s.shear_y_n, &s.shear_z_n)),
        ("bending moment", "N m", pairs(&s.moment_y_n_m, &s.moment_z_n_m)),
        ("torque", "N m", s.torque_n_m.clone()),
    ];
    format!("  largest along the shaft: {}\n", list.map(words).join(", "))
}

/// A place in metres without the digits that sums leave.
fn short(place: f64) -> String {
    let text = format!("{place:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "0" && place != 0.0 { format!("{place:e}") } else { text.to_owned() }
}

/// State of the spinning shaft.
fn spin_state(state: &SpinState) -> String {
    let [y, z] = state.growth_m;
    let mut text = format!(
        "  {:.3} rpm{}: growth of the section at {} m {y:.6e} m along y, {z:.6e} m along z",
        state.speed_rpm,
        state.time_s.map_or(String::new(), |t| format!(" at t = {t:.6} s")),
        short(state.growth_at_m)
    );
    if let Some(exact) = state.closed_form_growth_m {
        text += &format!(" (long body with free ends: {exact:.6e} m)");
    }
    text + &format!("\n  largest principal strain {:.3e}\n", state.largest_strain) + &probes(&state.probes)
}

/// Stators, one a line.
fn rub(rub: &RubSummary) -> String {
    let row = |s: &StatorSummary| {
        vec![
            format!("{:.4}", s.at_m),
            format!("{:.4e}", s.clearance_m),
            format!("{:.4e}", s.smallest_gap_m),
            s.first_contact_s.map_or("-".to_owned(), |t| format!("{t:.5}")),
            s.contacts.to_string(),
            format!("{:.4e}", s.longest_contact_s),
            format!("{:.4e}", s.largest_normal_force_n),
            format!("{:.4e}", s.largest_friction_force_n),
            s.stator.clone(),
        ]
    };
    let head = [
        "x (m)",
        "clearance (m)",
        "least gap (m)",
        "first (s)",
        "contacts",
        "longest (s)",
        "normal (N)",
        "friction (N)",
        "ring",
    ];
    let rows: Vec<Vec<String>> = rub.stators.iter().map(row).collect();
    let said = if rub.stators.iter().any(|s| s.touched) {
        "; contact begins where the path within a step meets the ring"
    } else {
        ": never touched, no contact forces"
    };
    columns(&head, &rows)
        + &format!(
            "  {} gap checks, {} evaluations with contact{said}\n",
            rub.gap_checks, rub.contact_evaluations
        )
}

/// Run up to speed.
pub fn spinup(results: &Spinup) -> String {
    let mut text = spin_state(&results.last);
    text += &format!(
        "  largest growth of the rim along the shaft {:.6e} m at {} m\n",
        results.growth.largest_rim_m,
        short(results.growth.largest_rim_at_m)
    );
    if let Some(e) = &results.extremes {
        text += &format!(
            "  largest radius of the axis at mid-length {:.6e} m at {:.4} s, largest torque {:.4e} N m at {:.4} s\n",
            e.radius_m, e.radius_time_s, e.torque_n_m, e.torque_time_s
        );
    }
    if let Some(e) = &results.energy {
        text += &format!(
            "  work of the drive {:.6e} J, numerical dissipation {:.3e} J ({:.1e} of the energy)\n",
            e.drive_work_j, e.numerical_dissipation_j, e.relative_error
        );
    }
    text += &results.support_forces.as_ref().map_or_else(String::new, supports);
    if let Some(h) = &results.history {
        text += &supports_over_time(&h.time_s, &h.support_forces);
    }
    text += &sections(&results.sections);
    if let Some(r) = &results.rub {
        text += &rub(r);
    }
    if let Some(i) = &results.integrator {
        text += &format!(
            "  {}, {} frame: {} steps, {} rejected, {} force evaluations, {} factorizations ({} with tangents)\n",
            i.name, i.frame, i.steps, i.rejected, i.force_evaluations, i.factorizations, i.tangents
        );
    }
    text
}

/// A study: the front, the other points by time, what failed, and the choice.
pub fn tradeoff(results: &Tradeoff) -> String {
    let reference = &results.reference;
    let mut text = format!(
        "  {} of {}, reference {} ({}{})\n  times on {}, {}\n\n",
        results.quantity,
        results.analysis,
        reference.value.map_or("-".to_owned(), |v| format!("{v:.9e}")),
        match reference.kind {
            "number" => "given",
            "expected" => "expected by the case",
            _ => "the finest point without a warning, no part of the comparison",
        },
        match (&reference.source, reference.error) {
            (Some(source), _) => format!(": {source}"),
            (None, Some(error)) =>
                format!("; itself off by about {error:.1e}, which bounds the errors below"),
            (None, None) => String::new(),
        },
        results.machine.processor,
        match results.repeats {
            1 => "one run each".to_owned(),
            n => format!("median of {n} runs (one where it takes more than 10 s)"),
        },
    );
    let chosen = results.choice.as_ref().map(|c| c.point);
    let row = |i: usize| tradeoff_row(&results.points[i], chosen == Some(i), reference.point == Some(i));
    let mut others: Vec<usize> = (0..results.points.len())
        .filter(|&i| results.points[i].wall_s.is_some() && !results.points[i].pareto)
        .collect();
    let time = |i: usize| results.points[i].wall_s.unwrap_or(f64::INFINITY);
    others.sort_by(|&a, &b| time(a).total_cmp(&time(b)));
    let rows: Vec<Vec<String>> = results.front.iter().chain(&others).map(|&i| row(i)).collect();
    if !rows.is_empty() {
        let steps = results.points.iter().any(|p| p.steps.is_some());
        let keep = |mut row: Vec<String>| {
            if !steps {
                row.remove(STEPS);
            }
            row
        };
        let head = keep(
            ["", "error", "wall (s)", "MB", "unknowns", "steps", "value", "setting"]
                .map(str::to_owned)
                .to_vec(),
        );
        let head: Vec<&str> = head.iter().map(String::as_str).collect();
        text += &columns(&head, &rows.into_iter().map(keep).collect::<Vec<_>>());
    }
    for point in &results.points {
        if let Some(reason) = &point.failed {
            text += &format!("  no value: {}: {reason}\n", point.name);
        }
    }
    if let (Some(choice), Some(target)) = (&results.choice, results.target_error) {
        let trust = match choice.trust {
            Trust::Confirmed => "confirmed by",
            Trust::Unconfirmed => "not confirmed, for want of finer points",
            Trust::Refuted => "by luck: missed by one of",
            Trust::Warned => "its run warned of its accuracy;",
        };
        let finer = match choice.finer.len() {
            0 => String::new(),
            1 => " 1 finer point".to_owned(),
            n => format!(" {n} finer points"),
        };
        let refined = match choice.refined.is_empty() {
            true => String::new(),
            false => format!("; refined: {}", choice.refined.join(", ")),
        };
        let open = match choice.not_refined.is_empty() {
            true => String::new(),
            false => format!("; not refined: {}", choice.not_refined.join(", ")),
        };
        text += &format!(
            "\n  chosen for {target:e}: {}, error {:.2e}, {:.4} s ({trust}{finer}{refined}{open})\n",
            results.points[choice.point].name, choice.error, choice.wall_s
        );
    }
    text
}

/// Column of the steps in [`tradeoff_row`].
const STEPS: usize = 5;

fn tradeoff_row(point: &TradeoffPoint, chosen: bool, reference: bool) -> Vec<String> {
    let number = |n: Option<u64>| n.map_or("-".to_owned(), |n| n.to_string());
    let mut name = point.name.clone();
    if let Some(estimate) = point.estimated_error {
        name += &format!(" (estimated {estimate:.0e})");
    }
    if point.finer_is_worse {
        name += " (a finer point is worse)";
    }
    let codes: Vec<&str> = point.warnings.iter().filter_map(|w| w.split(':').next()).collect();
    if !codes.is_empty() {
        name += &format!(" (warned: {})", codes.join(", "));
    }
    let mark = match (chosen, point.pareto, reference) {
        (true, ..) => "chosen",
        (_, true, _) => "front",
        (_, _, true) => "reference",
        _ => "",
    };
    vec![
        mark.to_owned(),
        point.error.map_or("-".to_owned(), |e| format!("{e:.2e}")),
        point.wall_s.map_or("-".to_owned(), |w| format!("{w:.4}")),
        point.peak_memory_mb.map_or("-".to_owned(), |m| format!("{m:.0}")),
        number(point.degrees_of_freedom),
        number(point.steps),
        point.value.map_or("-".to_owned(), |v| format!("{v:.9e}")),
        name,
    ]
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_and_the_rounding_of_sums_are_not_printed() {
        assert_eq!([beside(3.99e-6, 1.9e8, 6), beside(-2.5, 1.9e8, 2)], ["0", "-2.50e0"]);
        assert_eq!([short(3.3999999999999995), short(2.0), short(0.0)], ["3.4", "2", "0"]);
    }
}
