//! Values that no machine has, with the unit that was probably meant.

use crate::analysis::mass_properties::properties;
use crate::model::Model;
use crate::results::Diagnostic;

/// Young's modulus, Pa: numbers in GPa and in MPa of solids, the softest shaft (rubber) and the stiffest material (diamond).
const MODULUS_GPA: std::ops::RangeInclusive<f64> = 0.5..=1500.0;
const SOFTEST: f64 = 5e5;
const STIFFEST: f64 = 2e12;
/// Density, kg/m^3: numbers in g/cm^3 of solids, and the densest metal (osmium, 22600) with some room. Lighter materials are
/// made light on purpose.
const DENSITY_G_CM3: std::ops::RangeInclusive<f64> = 0.5..=25.0;
const DENSEST: f64 = 25_000.0;
/// Half extent of a section over the length of the shaft, and in m.
const STOUTEST: f64 = 3.0;
const THICKEST: f64 = 6.0;
/// Speed of the surface, m/s: steel bursts near 500.
const FASTEST_SURFACE_M_S: f64 = 800.0;
/// Spin speed, rad/s: a million turns a minute.
const FASTEST_SPIN_RAD_S: f64 = 1.05e5;
/// Mass of the heaviest rotor with some room, kg: hydroelectric ones have 2e6.
const HEAVIEST: f64 = 5e6;
/// Strongest gravity that a machine feels, m/s^2.
const STRONGEST_GRAVITY: f64 = 300.0;

/// Warnings of values that look like a slip of units, each with its path.
pub fn plausibility(model: &Model) -> Vec<Diagnostic> {
    let mut list = Vec::new();
    let mut doubt = |path: String, text: String| {
        list.push(Diagnostic::warning("implausible", format!("`{path}`: {text}")));
    };
    for (m, name) in model.materials.iter().zip(&model.names.materials) {
        let (e, rho) = (m.youngs_modulus, m.density);
        let path = |key: &str| format!("materials.{name}.{key}");
        if MODULUS_GPA.contains(&e) {
            doubt(path("E"), format!("{e} Pa is softer than anything that turns; \"{e} GPa\"?"));
        } else if e < SOFTEST {
            doubt(path("E"), format!("{e} Pa is softer than rubber; \"{e} MPa\"?"));
        } else if e > STIFFEST {
            doubt(path("E"), format!("{e:e} Pa is stiffer than diamond; \"{} GPa\" is steel", 210));
        }
        if DENSITY_G_CM3.contains(&rho) {
            doubt(path("rho"), format!("{rho} kg/m^3 is lighter than any solid; \"{rho} g/cm^3\"?"));
        } else if rho > DENSEST {
            doubt(path("rho"), format!("{rho:e} kg/m^3 is denser than any metal; steel has 7850 kg/m^3"));
        }
    }
    let largest = (0..model.sections.len())
        .max_by(|&a, &b| model.sections[a].outer_size().total_cmp(&model.sections[b].outer_size()));
    if let Some((i, size)) = largest.map(|i| (i, model.sections[i].outer_size())) {
        let path = format!("sections.{}", model.names.sections[i]);
        if size > THICKEST {
            doubt(path, format!("no rotor is {} m across; \"{size} mm\" of radius?", 2.0 * size));
        } else if size > STOUTEST * model.length {
            doubt(
                path,
                format!("{} m across on a shaft of {} m; is one of them in mm?", 2.0 * size, model.length),
            );
        }
        let sweep = model.campbell.as_ref().and_then(|c| c.speeds.last().copied());
        let drive = model.spinup.as_ref().map(|s| s.largest_speed());
        for (path, speed) in [("campbell.speeds.to", sweep), ("spinup.drive", drive)] {
            let Some(speed) = speed else { continue };
            if speed * size > FASTEST_SURFACE_M_S {
                doubt(
                    path.to_owned(),
                    format!(
                        "at {speed} rad/s the surface of the shaft runs at {:.0} m/s (steel bursts near 500); \"{speed} rpm\"?",
                        speed * size
                    ),
                );
            } else if speed > FASTEST_SPIN_RAD_S {
                doubt(path.to_owned(), format!("{speed} rad/s is more than a million rpm; \"{speed} rpm\"?"));
            }
        }
    }
    let mass = properties(model).mass();
    if mass > HEAVIEST {
        doubt(
            "shaft".to_owned(),
            format!(
                "the rotor weighs {:.3e} t, more than any that was built: check lengths, densities and masses",
                mass / 1e3
            ),
        );
    }
    let gravity = model.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    if gravity > STRONGEST_GRAVITY {
        doubt(
            "gravity".to_owned(),
            format!("{gravity} m/s^2 is no gravity of a planet; \"{gravity} mm/s^2\"?"),
        );
    }
    list
}
