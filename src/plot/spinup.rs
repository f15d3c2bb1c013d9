//! Plots of `rotor static` and `rotor spinup`: the section, the deformed axis, forces, and a run over time.

use crate::error::Result;
use crate::plot::forces;
use crate::plot::panels::{Curve, Mark, Panel, STROKES, Surroundings, figure};
use crate::plot::style::{self, Line, Marker, Point, Stroke};
use crate::results::RubContact;
use crate::results::{
    History, PointState, Profile, Report, RubSummary, Spinup, Static, StatorHistory, StatorSummary,
};
use std::f64::consts::{PI, TAU};

/// Part of the section's size that its largest displacement takes when drawn.
const VISIBLE: f64 = 0.15;
/// Chords of a circle.
const CIRCLE: usize = 180;
/// Largest radius of a ring that is drawn, over that of the orbit.
const FAR: f64 = 5.0;
/// Share of the growth within which it is the same along y and z.
const ROUND: f64 = 1e-6;
/// Share of a position within which two are the same.
const SAME: f64 = 1e-9;

/// Figures as `(file name, SVG text)`.
type Figures = Vec<(String, String)>;

/// static.svg, section.svg and, where any force passes through the shaft, forces.svg.
///
/// # Errors
/// A failure of the drawing library.
pub fn statics(report: &Report<Static>) -> Result<Figures> {
    let results = &report.results;
    let n = results.axis.len();
    let x: Vec<f64> = (0..n).map(|k| k as f64 / (n.max(2) - 1) as f64).collect();
    let component = |c: usize| results.axis.iter().map(|u| u[c]).collect();
    let panel = Panel::over(
        ("Position over the shaft's length", "-"),
        ("Displacement of the axis", "m"),
        &x,
        vec![("along x", component(0)), ("along y", component(1)), ("along z", component(2))],
    );
    let remarks = format!("Load factor {:.4}.", results.load_factor);
    let axis = figure(&Surroundings::new(report, "Static equilibrium", remarks.clone()), &[panel], 1)?;
    let section = section(report, &results.profile, &remarks)?;
    let mut figures = vec![("static.svg".to_owned(), axis), ("section.svg".to_owned(), section)];
    figures.extend(forces::along(report, &results.sections, &remarks)?);
    Ok(figures)
}

/// section.svg, growth.svg and, where there are forces, forces.svg, and for a transient spinup.svg, orbit.svg and energy.svg, with stators spinup-rub.svg.
///
/// # Errors
/// A failure of the drawing library.
pub fn spinup(report: &Report<Spinup>) -> Result<Figures> {
    let last = &report.results.last;
    let remarks = format!("At {:.2} rpm, seen from the turning frame.", last.speed_rpm);
    let mut figures = vec![
        ("section.svg".to_owned(), section(report, &last.profile, &remarks)?),
        ("growth.svg".to_owned(), growth(report, &remarks)?),
    ];
    let Some(history) = &report.results.history else {
        figures.extend(forces::along(report, &report.results.sections, &remarks)?);
        return Ok(figures);
    };
    figures.extend(forces::over_time(report, history)?);
    figures.push(("spinup.svg".to_owned(), run(report, history)?));
    figures.push(("orbit.svg".to_owned(), orbit(report, history)?));
    figures.push(("energy.svg".to_owned(), energy(report, history)?));
    if let Some(summary) = &report.results.rub {
        figures.push(("spinup-rub.svg".to_owned(), rub(report, history, summary)?));
    }
    Ok(figures)
}

/// Growth of rim and bore along the shaft.
fn growth(report: &Report<Spinup>, remarks: &str) -> Result<String> {
    let (last, along) = (&report.results.last, &report.results.growth);
    let round = along.rim_m.iter().all(|[y, z]| (y - z).abs() <= ROUND * y.abs().max(z.abs()));
    let axes: &[(usize, &str)] = if round { &[(0, "")] } else { &[(0, " along y"), (1, " along z")] };
    let mut curves = Vec::new();
    for (k, &(axis, words)) in axes.iter().enumerate() {
        let rim = along.x_m.iter().zip(&along.rim_m).map(|(x, g)| (*x, g[axis])).collect();
        curves.push(Curve { name: format!("rim{words}"), stroke: STROKES[2 * k], points: rim });
        let mut name = format!("bore{words}");
        for points in hollow_stretches(&along.x_m, &along.bore_m, axis) {
            // the legend names the first stretch
            curves.push(Curve { name: std::mem::take(&mut name), stroke: STROKES[2 * k + 1], points });
        }
    }
    let at = (last.growth_at_m, last.growth_m[0]);
    let mark =
        Mark { name: "section of the headline".to_owned(), marker: Marker::Disc, color: style::BLACK, at };
    let panel = Panel {
        across: ("Position along the shaft", "m"),
        up: ("Growth of the radius", "m"),
        curves,
        marks: vec![mark],
        ..Panel::default()
    };
    let remarks = format!("{remarks} Rigid hubs and rigid ends do not grow.");
    figure(&Surroundings::new(report, "Growth along the shaft", remarks), &[panel], 1)
}

/// The growth of the bore in each stretch of the shaft that has one.
fn hollow_stretches(x: &[f64], bore: &[Option<[f64; 2]>], axis: usize) -> Vec<Vec<Point>> {
    let mut stretches: Vec<Vec<Point>> = Vec::new();
    let mut inside = false;
    for (x, bore) in x.iter().zip(bore) {
        let Some(grown) = bore else {
            inside = false;
            continue;
        };
        if !inside {
            stretches.push(Vec::new());
            inside = true;
        }
        stretches.iter_mut().last().into_iter().for_each(|s| s.push((*x, grown[axis])));
    }
    stretches
}

/// Gap and forces at the stators.
fn rub(report: &Report<Spinup>, h: &History, summary: &RubSummary) -> Result<String> {
    let panel = |up: (&'static str, &'static str), of: &dyn Fn(&RubContact) -> f64| {
        let curve = |(k, (s, h)): (usize, (&StatorSummary, &StatorHistory))| Curve {
            name: format!("ring at {} m", s.at_m),
            stroke: Stroke { width: 1.2, ..STROKES[k % STROKES.len()] },
            points: h.drawn.iter().map(|(t, contact)| (*t, of(contact))).collect(),
        };
        let curves = summary.stators.iter().zip(&h.stators).enumerate().map(curve).collect();
        Panel { across: ("Time", "s"), up, curves, ..Panel::default() }
    };
    let mut panels = vec![panel(("Gap", "m"), &|c| c.gap)];
    if summary.stators.iter().any(|s| s.touched) {
        panels.push(panel(("Normal force", "N"), &|c| c.normal_force));
    }
    if summary.stators.iter().any(|s| s.largest_friction_force_n > 0.0) {
        panels.push(panel(("Friction force", "N"), &|c| c.friction_force));
    }
    let first = summary.stators.iter().filter_map(|s| Some((s.first_contact_s?, s.at_m)));
    let first = first.min_by(|a, b| a.0.total_cmp(&b.0));
    let first = first.map_or(String::new(), |(t, x)| format!("First contact at {t:.5} s, at {x} m. "));
    let remarks = match panels.len() {
        1 => "No ring was touched: there are no forces.",
        2 => "A gap below zero is penetration.",
        _ => "A gap below zero is penetration; friction is positive in the sense of rotation.",
    };
    figure(&Surroundings::new(report, "Rub", first + remarks), &panels, 1)
}

fn run(report: &Report<Spinup>, h: &History) -> Result<String> {
    const TIME: (&str, &str) = ("Time", "s");
    let rpm = h.speed_rad_s.iter().map(|w| w * 30.0 / PI).collect();
    let along = |i: usize| h.growth_m.iter().map(|g| g[i]).collect();
    let mut growth = vec![("along y", along(0)), ("along z", along(1))];
    if h.closed_form_growth_m.len() == h.time_s.len() {
        growth.push(("long body, free ends (closed form)", h.closed_form_growth_m.clone()));
    }
    let panels = [
        Panel::over(TIME, ("Speed", "rpm"), &h.time_s, vec![("speed of the drive", rpm)]),
        Panel::over(TIME, ("Growth of the radius", "m"), &h.time_s, growth),
        Panel::over(
            TIME,
            ("Torque", "N m"),
            &h.time_s,
            vec![("torque of the drive", h.drive_torque_n_m.clone())],
        ),
    ];
    figure(
        &Surroundings::new(
            report,
            if report.results.orbit.is_some() { "Steady state over one turn" } else { "Run-up" },
            format!("Growth of the section at {:.4} m.", report.results.last.growth_at_m),
        ),
        &panels,
        1,
    )
}

fn orbit(report: &Report<Spinup>, h: &History) -> Result<String> {
    let points: Vec<Point> = h.orbit_m.iter().map(|u| (u[1], u[0])).collect();
    let radius = |p: &Point| p.0.hypot(p.1);
    let farthest = points.iter().copied().max_by(|a, b| radius(a).total_cmp(&radius(b)));
    let mark = |name: &str, marker, color, at: Option<Point>| {
        at.map(|at| Mark { name: name.to_owned(), marker, color, at })
    };
    let marks = [
        mark("start", Marker::Disc, style::GREEN, points.first().copied()),
        mark("end", Marker::Square, style::VERMILLION, points.last().copied()),
        mark("largest radius", Marker::Triangle, style::BLACK, farthest),
    ];
    let curve =
        Curve { name: "axis at mid-length".to_owned(), stroke: Stroke { width: 1.2, ..STROKES[0] }, points };
    let mut curves = vec![curve];
    let reached = farthest.as_ref().map_or(0.0, radius);
    let middle = report.results.growth.x_m.last().map_or(0.0, |length| length / 2.0);
    for stator in report.results.rub.iter().flat_map(|r| &r.stators) {
        // a ring far out would shrink the orbit to a point
        let here = (stator.at_m - middle).abs() <= SAME * middle.abs() && stator.clearance_m < FAR * reached;
        if here {
            let at = |k: usize| (TAU * k as f64 / CIRCLE as f64).sin_cos();
            let points = (0..=CIRCLE).map(at).map(|(s, c)| (stator.clearance_m * s, stator.clearance_m * c));
            curves.push(Curve {
                name: "clearance of the ring".to_owned(),
                stroke: Stroke { color: style::BLACK, width: 1.2, line: Line::Dashed },
                points: points.collect(),
            });
        }
    }
    let panel = Panel {
        across: ("Displacement along z", "m"),
        up: ("Displacement along y", "m"),
        curves,
        marks: marks.into_iter().flatten().collect(),
        equal: true,
        ..Panel::default()
    };
    let remarks = "Fixed directions, equal scales; the x axis points to the viewer's back.".to_owned();
    figure(&Surroundings::new(report, "Orbit", remarks), &[panel], 1)
}

fn energy(report: &Report<Spinup>, h: &History) -> Result<String> {
    let e = &h.energy_j;
    let potential = match e.stators.len() {
        0 => ("potential", e.potential.clone()),
        _ => ("potential, with rings", e.potential.iter().zip(&e.stators).map(|(p, s)| p + s).collect()),
    };
    let curves = vec![
        ("kinetic", e.kinetic.clone()),
        ("strain", e.strain.clone()),
        potential,
        ("work of the drive", e.drive_work.clone()),
        ("absorbed", e.absorbed.clone()),
    ];
    let panels = [
        Panel::over(("Time", "s"), ("Energy", "J"), &h.time_s, curves),
        Panel::over(
            ("Time", "s"),
            ("Energy", "J"),
            &h.time_s,
            vec![("lost by the integrator", e.lost.clone())],
        ),
    ];
    let remarks = "Lost: work of the drive less change of energy less absorbed energy.".to_owned();
    figure(&Surroundings::new(report, "Energy balance", remarks), &panels, 1)
}

/// Displacement, stresses and invariants along y and z of a section, and its deformed outline.
fn section<R>(report: &Report<R>, profile: &Profile, remarks: &str) -> Result<String> {
    let mut panels = Vec::new();
    for (axis, states) in [(0, &profile.along_y), (1, &profile.along_z)] {
        let across = [("Position along y", "m"), ("Position along z", "m")][axis];
        let place: Vec<f64> = states.iter().map(|s| [s.y_m, s.z_m][axis]).collect();
        let list = |f: &dyn Fn(&PointState) -> f64| states.iter().map(f).collect::<Vec<f64>>();
        panels.push(Panel::over(
            across,
            ("Displacement", "m"),
            &place,
            vec![("along y", list(&|s| s.displacement_m[1])), ("along z", list(&|s| s.displacement_m[2]))],
        ));
        let stress = |k: usize| list(&|s| s.stress_pa.cauchy[k]);
        panels.push(Panel::over(
            across,
            ("Cauchy stress", "Pa"),
            &place,
            vec![("xx", stress(0)), ("yy", stress(1)), ("zz", stress(2))],
        ));
        panels.push(Panel::over(
            across,
            ("Invariants", "Pa"),
            &place,
            vec![
                ("I1", list(&|s| s.stress_pa.i1)),
                ("I2^(1/2)", list(&|s| s.stress_pa.i2.signum() * s.stress_pa.i2.abs().sqrt())),
                ("I3^(1/3)", list(&|s| s.stress_pa.i3.cbrt())),
            ],
        ));
    }
    // columns: along y, along z
    let (along_z, mut ordered) = (panels.split_off(3), Vec::new());
    for (y, z) in panels.into_iter().zip(along_z) {
        ordered.extend([y, z]);
    }
    let (outline, scale) = outline(profile);
    ordered.push(outline);
    let remarks = format!(
        "Section at x = {:.4} m. {remarks} Roots of the invariants keep their sign. Outline displaced {scale} times, its centre held.",
        profile.at_m
    );
    figure(&Surroundings::new(report, "Section", remarks), &ordered, 2)
}

/// The deformed outline over the undeformed one, and the factor of its displacements.
fn outline(profile: &Profile) -> (Panel, String) {
    let size = profile.outlines.iter().flatten().fold(0.0, |m: f64, p| m.max(p[0].abs()).max(p[1].abs()));
    let moved = profile.outline_displacements.iter().flatten().fold(0.0, |m: f64, u| m.max(u[0].hypot(u[1])));
    let wanted = if moved > 0.0 { VISIBLE * size / moved } else { 1.0 };
    let power = 10f64.powf(wanted.log10().floor());
    let scale = power * [5.0, 2.0].into_iter().find(|f| f * power <= wanted).unwrap_or(1.0);
    let mut curves = Vec::new();
    for (k, (line, displaced)) in profile.outlines.iter().zip(&profile.outline_displacements).enumerate() {
        // the bore is drawn as the outline is
        let name = |of: &str| if k == 0 { of.to_owned() } else { String::new() };
        curves.push(Curve {
            name: name("undeformed"),
            stroke: Stroke { color: style::GREY, width: 1.2, line: Line::Dashed },
            points: line.iter().map(|p| (p[1], p[0])).collect(),
        });
        curves.push(Curve {
            name: name("deformed"),
            stroke: STROKES[0],
            points: line
                .iter()
                .zip(displaced)
                .map(|(p, u)| (p[1] + scale * u[1], p[0] + scale * u[0]))
                .collect(),
        });
    }
    let panel = Panel { across: ("z", "m"), up: ("y", "m"), curves, equal: true, ..Panel::default() };
    (panel, if scale < 1e6 { format!("{scale}") } else { format!("{scale:.0e}") })
}
