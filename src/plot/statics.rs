//! Plots of `rotor static`: the deformed axis, the section and the forces along the shaft.

use crate::draw::panels::{Panel, Surroundings, figure};
use crate::error::Result;
use crate::plot::forces;
use crate::plot::section::section;
use crate::results::{Figures, Report, Static};

/// static.svg, section.svg and, where any force passes through the shaft, forces.svg.
///
/// # Errors
/// A failure of the drawing library.
pub fn svg(report: &Report<Static>) -> Result<Figures> {
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
