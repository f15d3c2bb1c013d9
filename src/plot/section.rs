//! section.svg: displacements and stresses across a section, and its deformed outline.

use crate::draw::palette::{self, LineStyle, Stroke};
use crate::draw::panels::{Curve, Panel, STROKES, Surroundings, figure};
use crate::error::Result;
use crate::results::{PointState, Profile, Report};

/// Part of the section's size that its largest displacement takes when drawn.
const VISIBLE: f64 = 0.15;

/// Displacement, stresses and invariants along y and z of a section, and its deformed outline.
///
/// # Errors
/// A failure of the drawing library.
pub fn section<R>(report: &Report<R>, profile: &Profile, remarks: &str) -> Result<String> {
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
            stroke: Stroke { color: palette::GREY, width: 1.2, line: LineStyle::Dashed },
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
