//! forces.svg: what passes through a shaft in one state, or what its supports, bearings and rings do over time.

use super::panels::{Curve, Panel, STROKES, Surroundings, figure};
use super::style::{Stroke, significant};
use crate::error::Result;
use crate::results::{History, Report, SectionForces, Spinup, SupportForces};

/// Share of the largest force, or of the moment it makes over the shaft's length, below which there is nothing to show.
const SEEN: f64 = 1e-6;

/// A figure as `(file name, SVG text)`, where there is anything to show.
type Figure = Option<(String, String)>;

/// Largest of some values, by size.
fn largest<'a>(lists: impl IntoIterator<Item = &'a Vec<f64>>) -> f64 {
    lists.into_iter().flatten().fold(0.0, |most, v| most.max(v.abs()))
}

/// Axial force, shear, bending moment and torque along the shaft.
///
/// # Errors
/// A failure of the drawing library.
pub fn along<R>(report: &Report<R>, s: &SectionForces, remarks: &str) -> Result<Figure> {
    let list = [
        (("Axial force", "N"), vec![("along x", &s.axial_force_n)]),
        (("Shear", "N"), vec![("along y", &s.shear_y_n), ("along z", &s.shear_z_n)]),
        (("Bending moment", "N m"), vec![("about y", &s.moment_y_n_m), ("about z", &s.moment_z_n_m)]),
        (("Torque", "N m"), vec![("about x", &s.torque_n_m)]),
    ];
    let length = s.x_m.last().copied().unwrap_or(1.0);
    // moments are seen beside the moments of forces
    let lever = |up: (&str, &str)| if up.1 == "N" { 1.0 } else { length };
    let sizes = list.each_ref().map(|(up, curves)| largest(curves.iter().map(|c| c.1)) / lever(*up));
    let most = sizes.iter().copied().fold(0.0, f64::max);
    let shown = list.into_iter().zip(sizes).filter(|(_, size)| *size > SEEN * most);
    let panel = |((up, curves), _): ((_, Vec<(&str, &Vec<f64>)>), f64)| {
        let curves = curves.into_iter().map(|(name, list)| (name, list.clone())).collect();
        Panel::over(("Position along the shaft", "m"), up, &s.x_m, curves)
    };
    let panels: Vec<Panel> = shown.map(panel).collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let remarks = format!(
        "{remarks} What the part at larger x exerts on the part before it, at the ends of elements; moments about the axis."
    );
    let svg = figure(&Surroundings::new(report, "Forces along the shaft", remarks), &panels, 1)?;
    Ok(Some(("forces.svg".to_owned(), svg)))
}

/// Forces of supports, bearings and rings, and moments of supports, over time.
///
/// # Errors
/// A failure of the drawing library.
pub fn over_time(report: &Report<Spinup>, h: &History) -> Result<Figure> {
    let SupportForces { forces_n, moments_n_m, at_m } = &h.support_forces;
    let across = |v: &[f64; 3]| v[1].hypot(v[2]);
    let list: [(_, _, &dyn Fn(&[f64; 3]) -> f64); 5] = [
        (("Force across the shaft", "N"), forces_n, &across),
        (("Force along y", "N"), forces_n, &|v| v[1]),
        (("Force along z", "N"), forces_n, &|v| v[2]),
        (("Force along x", "N"), forces_n, &|v| v[0]),
        (("Moment about x", "N m"), moments_n_m, &|v| v[0]),
    ];
    let length = report.results.sections.x_m.last().copied().unwrap_or(1.0);
    let panel = |(up, map, of): (_, &std::collections::BTreeMap<String, Vec<[f64; 3]>>, _)| {
        let of: &dyn Fn(&[f64; 3]) -> f64 = of;
        let curve = |(k, (path, values)): (usize, (&String, &Vec<[f64; 3]>))| Curve {
            name: at_m
                .get(path)
                .map_or_else(|| path.clone(), |x| format!("{path} at {} m", significant(*x, 4))),
            stroke: Stroke { width: 1.2, ..STROKES[k % STROKES.len()] },
            points: h.time_s.iter().copied().zip(values.iter().map(of)).collect(),
        };
        Panel {
            across: ("Time", "s"),
            up,
            curves: map.iter().enumerate().map(curve).collect(),
            ..Panel::default()
        }
    };
    let mut panels = list.map(panel);
    let size = |curve: &Curve, unit: &str| {
        let most = curve.points.iter().fold(0.0, |most: f64, p| most.max(p.1.abs()));
        if unit == "N" { most } else { most / length }
    };
    let all = panels.iter().flat_map(|panel| panel.curves.iter().map(|curve| size(curve, panel.up.1)));
    let least = SEEN * all.fold(0.0, f64::max);
    for panel in &mut panels {
        panel.curves.retain(|curve| size(curve, panel.up.1) > least);
    }
    let panels: Vec<Panel> = panels.into_iter().filter(|panel| !panel.curves.is_empty()).collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let remarks = "Forces and moments on the shaft, fixed directions.".to_owned();
    let svg = figure(&Surroundings::new(report, "Support forces", remarks), &panels, 1)?;
    Ok(Some(("forces.svg".to_owned(), svg)))
}
