//! forces.svg: what passes through a shaft in one state, or what its supports, bearings and rings do over time.

use crate::draw::palette::Stroke;
use crate::draw::panels::{Curve, Panel, STROKES, Surroundings, figure};
use crate::draw::text::significant;
use crate::error::Result;
use crate::results::{History, Report, SectionForces, Spinup, SupportForces};
use std::collections::BTreeMap;

/// Share of the largest force, or of the moment it makes over the shaft's length, below which there is nothing to show.
const SHOWN_FORCE_SHARE: f64 = 1e-6;

/// Vectors over time by JSON path.
type Series = BTreeMap<String, Vec<[f64; 3]>>;

/// A figure as `(file name, SVG text)`, where there is anything to show.
type Figure = Option<(String, String)>;

/// A position without the zeros that digits end in.
fn place(x: f64) -> String {
    let text = significant(x, 5);
    if text.contains('e') || !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Leaves out what is nothing beside the rest: curves, or whole panels when curves come in pairs.
fn seen(panels: Vec<Panel>, length: f64, pairs: bool) -> Vec<Panel> {
    // moments are seen beside those of forces
    let lever = |panel: &Panel| if panel.up.1 == "N" { 1.0 } else { length };
    let size = |curve: &Curve| curve.points.iter().fold(0.0, |most: f64, p| most.max(p.1.abs()));
    let sizes = panels.iter().flat_map(|panel| panel.curves.iter().map(|c| size(c) / lever(panel)));
    let least = SHOWN_FORCE_SHARE * sizes.fold(0.0, f64::max);
    let mut shown = Vec::new();
    for mut panel in panels {
        let least = least * lever(&panel);
        let any = panel.curves.iter().any(|curve| size(curve) > least);
        if !pairs {
            panel.curves.retain(|curve| size(curve) > least);
        }
        shown.extend(any.then_some(panel));
    }
    shown
}

/// Axial force, shear, bending moment and torque along the shaft.
///
/// # Errors
/// A failure of the drawing library.
pub fn along<R>(report: &Report<R>, s: &SectionForces, remarks: &str) -> Result<Figure> {
    let panel = |up: (&'static str, &'static str), curves: &[(&str, &Vec<f64>)]| {
        let curves = curves.iter().map(|(name, list)| (*name, (*list).clone())).collect();
        Panel::over(("Position along the shaft", "m"), up, &s.x_m, curves)
    };
    let panels = vec![
        panel(("Axial force", "N"), &[("along x", &s.axial_force_n)]),
        panel(("Shear", "N"), &[("along y", &s.shear_y_n), ("along z", &s.shear_z_n)]),
        panel(("Bending moment", "N m"), &[("about y", &s.moment_y_n_m), ("about z", &s.moment_z_n_m)]),
        panel(("Torque", "N m"), &[("about x", &s.torque_n_m)]),
    ];
    let remarks = format!(
        "{remarks} What the part at larger x exerts on the part before it, at the ends of elements; moments about the axis."
    );
    let around = Surroundings::new(report, "Forces along the shaft", remarks);
    draw(&around, &seen(panels, length(s), true))
}

/// Forces of supports, bearings and rings, and moments of supports, over time.
///
/// # Errors
/// A failure of the drawing library.
pub fn over_time(report: &Report<Spinup>, h: &History) -> Result<Figure> {
    let SupportForces { forces_n, moments_n_m, at_m } = &h.support_forces;
    let panel = |up: (&'static str, &'static str), map: &Series, of: &dyn Fn(&[f64; 3]) -> f64| {
        let curve = |(k, (path, values)): (usize, (&String, &Vec<[f64; 3]>))| Curve {
            name: at_m.get(path).map_or_else(|| path.clone(), |x| format!("{path} at {} m", place(*x))),
            stroke: Stroke { width: 1.2, ..STROKES[k % STROKES.len()] },
            points: h.time_s.iter().copied().zip(values.iter().map(of)).collect(),
        };
        let curves = map.iter().enumerate().map(curve).collect();
        Panel { across: ("Time", "s"), up, curves, ..Panel::default() }
    };
    let panels = vec![
        panel(("Force across the shaft", "N"), forces_n, &|v| v[1].hypot(v[2])),
        panel(("Force along y", "N"), forces_n, &|v| v[1]),
        panel(("Force along z", "N"), forces_n, &|v| v[2]),
        panel(("Force along x", "N"), forces_n, &|v| v[0]),
        panel(("Moment about x", "N m"), moments_n_m, &|v| v[0]),
    ];
    let remarks = "Forces and moments on the shaft, fixed directions.".to_owned();
    let around = Surroundings::new(report, "Support forces", remarks);
    draw(&around, &seen(panels, length(&report.results.sections), false))
}

fn length(s: &SectionForces) -> f64 {
    s.x_m.last().copied().unwrap_or(1.0)
}

fn draw(around: &Surroundings<'_>, panels: &[Panel]) -> Result<Figure> {
    if panels.is_empty() {
        return Ok(None);
    }
    Ok(Some(("forces.svg".to_owned(), figure(around, panels, 1)?)))
}
