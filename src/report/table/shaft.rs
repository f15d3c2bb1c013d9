//! Tables of a shaft under load: static equilibrium and run-up.

use crate::report::table::{beside, columns, largest, short};
use crate::results::{
    ProbeState, RubSummary, SectionForces, SpinState, Spinup, Static, StatorSummary, SupportForces,
};

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

/// Table of a static equilibrium: reactions, probes and sections.
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
