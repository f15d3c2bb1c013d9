//! Plots of `rotor spinup`: the section, growth, forces, and a run over time.

use crate::draw::clip::Point;
use crate::draw::palette::{self, LineStyle, Marker, Stroke};
use crate::draw::panels::{Curve, Mark, Panel, STROKES, Surroundings, figure};
use crate::error::Result;
use crate::plot::forces;
use crate::plot::section::section;
use crate::results::RubContact;
use crate::results::{Figures, History, Report, RubSummary, Spinup, StatorHistory, StatorSummary};
use std::f64::consts::{PI, TAU};

/// Chords of a circle.
const CIRCLE_CHORDS: usize = 180;
/// Largest radius of a ring that is drawn, over that of the orbit.
const DRAWN_RING_ORBITS: f64 = 5.0;
/// Share of the growth within which it is the same along y and z.
const ROUND_RTOL: f64 = 1e-6;
/// Share of a position within which two are the same.
const SAME_PLACE_RTOL: f64 = 1e-9;

/// section.svg, growth.svg and, where there are forces, forces.svg, and for a transient spinup.svg, orbit.svg and energy.svg, with stators spinup-rub.svg.
///
/// # Errors
/// A failure of the drawing library.
pub fn svg(report: &Report<Spinup>) -> Result<Figures> {
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
    let round = along.rim_m.iter().all(|[y, z]| (y - z).abs() <= ROUND_RTOL * y.abs().max(z.abs()));
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
        Mark { name: "section of the headline".to_owned(), marker: Marker::Disc, color: palette::BLACK, at };
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
        mark("start", Marker::Disc, palette::GREEN, points.first().copied()),
        mark("end", Marker::Square, palette::VERMILLION, points.last().copied()),
        mark("largest radius", Marker::Triangle, palette::BLACK, farthest),
    ];
    let curve =
        Curve { name: "axis at mid-length".to_owned(), stroke: Stroke { width: 1.2, ..STROKES[0] }, points };
    let mut curves = vec![curve];
    let reached = farthest.as_ref().map_or(0.0, radius);
    let middle = report.results.growth.x_m.last().map_or(0.0, |length| length / 2.0);
    for stator in report.results.rub.iter().flat_map(|r| &r.stators) {
        // a ring far out would shrink the orbit to a point
        let here = (stator.at_m - middle).abs() <= SAME_PLACE_RTOL * middle.abs()
            && stator.clearance_m < DRAWN_RING_ORBITS * reached;
        if here {
            let at = |k: usize| (TAU * k as f64 / CIRCLE_CHORDS as f64).sin_cos();
            let points =
                (0..=CIRCLE_CHORDS).map(at).map(|(s, c)| (stator.clearance_m * s, stator.clearance_m * c));
            curves.push(Curve {
                name: "clearance of the ring".to_owned(),
                stroke: Stroke { color: palette::BLACK, width: 1.2, line: LineStyle::Dashed },
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
