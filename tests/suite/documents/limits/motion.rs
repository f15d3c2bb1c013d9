//! Extremes of speed, tolerance and time: growth of a spinning shaft against its closed form, energy that is lost.

use super::cell::{Cell, Measured, cell};
use super::linear::{circle, tube};
use crate::common::shaft;
use rotor::accuracy::radial_growth::closed_form;
use rotor::analysis::spinup::spinup;
use rotor::case::LoadedCase;
use rotor::model::Model;
use rotor::results::Spinup;
use rotor::section::Section;
use serde_json::{Value, json};

fn run(case: &LoadedCase) -> Result<(Spinup, Vec<rotor::results::Diagnostic>), rotor::error::Error> {
    let model = Model::new(case)?;
    let outcome = spinup(&model, model.spinup.as_ref().expect("a spinup block"), &|_, _| true)?;
    Ok((outcome.results, outcome.diagnostics))
}

fn growth(case: &LoadedCase) -> Measured {
    run(case).map(|(found, said)| (found.last.growth_m[0], said))
}

/// 1 plus what the integrator lost of the energy.
fn energy(case: &LoadedCase) -> Measured {
    run(case).map(|(found, said)| (1.0 + found.energy.map_or(f64::NAN, |e| e.relative_error), said))
}

fn turning(section: Value, length: f64, elements: usize, element: &str, spin: Value) -> LoadedCase {
    let more = json!({
        "shaft": { "element": element },
        "supports": [{ "at": 0, "kind": "revolute" }, { "at": length, "kind": "cylindrical" }],
        "spinup": spin
    });
    shaft(section, length, elements, more)
}

fn material() -> rotor::model::Material {
    rotor::model::Material {
        youngs_modulus: 2.1e11,
        poisson_ratio: 0.3,
        density: 7800.0,
        stiffness_damping: 0.0,
        mass_damping: 0.0,
        loss_factor: 0.0,
    }
}

/// A steel shaft of radius 0.1 m and length 2 m: first critical speed near 1400 rad/s.
pub fn speeds() -> Vec<Cell> {
    let mut list = Vec::new();
    for speed in [1.4e-3, 1.4, 140.0, 1400.0, 5e3, 2e4, 1e5, 1e8] {
        let spin = json!({ "drive": [{ "until": 1, "speed": speed }], "steady": true });
        let case = turning(circle(0.1), 2.0, 4, "34X3", spin);
        let exact = closed_form(&Section::circle(0.1), &material(), speed, 0.1).expect("a circle");
        // the closed form is of small strains, which are about rho W^2 R^2 / E
        let bound = (7800.0 * speed * speed * 0.01 / 2.1e11).max(2e-3);
        list.push(cell(
            "speed (rad/s)",
            format!("{speed:e}"),
            "growth, closed form (small strain)",
            &case,
            growth,
            0,
            (exact, bound),
        ));
    }
    list
}

pub fn bores() -> Vec<Cell> {
    let mut list = Vec::new();
    for share in [0.5, 0.05, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        let spin = json!({ "drive": [{ "until": 1, "speed": 50 }], "steady": true });
        let case = turning(tube(0.2, 0.2 * share), 8.0, 4, "34R33", spin);
        let exact = closed_form(&Section::tube(0.2, 0.2 * share), &material(), 50.0, 0.2).expect("a tube");
        list.push(cell(
            "bore / rim",
            format!("{share:e}, 34R33"),
            "growth of the rim, closed form",
            &case,
            growth,
            0,
            (exact, 5e-4),
        ));
    }
    list
}

pub fn tolerances() -> Vec<Cell> {
    let mut list = Vec::new();
    let exact = closed_form(&Section::circle(0.1), &material(), 140.0, 0.1).expect("a circle");
    for rtol in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let spin = json!({ "drive": [{ "until": 0.05, "speed": 140 }], "rtol": rtol, "atol": rtol * 1e-3, "max_steps": 4000 });
        let case = turning(circle(0.1), 2.0, 2, "34X3", spin);
        list.push(cell(
            "rtol",
            format!("{rtol:e}"),
            "growth after a ramp, closed form",
            &case,
            growth,
            0,
            (exact, 5e-3),
        ));
    }
    for ramp in [1e-4, 1.0, 3600.0] {
        let spin = json!({ "drive": [{ "until": ramp, "speed": 140 }] });
        let case = turning(circle(0.1), 2.0, 3, "34X3", spin);
        // a ramp shorter than the section's own vibrations leaves them behind: only the energy is held to account
        if ramp < 1e-3 {
            list.push(cell(
                "ramp (s)",
                format!("{ramp:e}"),
                "energy that is lost",
                &case,
                energy,
                0,
                (1.0, 1e-3),
            ));
        } else {
            list.push(cell(
                "ramp (s)",
                format!("{ramp:e}"),
                "growth, closed form",
                &case,
                growth,
                0,
                (exact, 5e-3),
            ));
        }
    }
    list
}

/// Energy lost over many steps of generalized-alpha without dissipation on a ringing shaft.
pub fn drift(steps: usize) -> Cell {
    let step = 1e-5;
    let until = step * steps as f64;
    let spin = json!({
        "drive": [{ "until": 100.0 * step, "speed": 140 }, { "until": until, "speed": 140 }],
        "integrator": "generalized-alpha", "rho_infinity": 1.0, "step": step, "max_steps": 2 * steps, "output": 11
    });
    let case = turning(circle(0.1), 2.0, 1, "34X1", spin);
    cell(
        "transient steps",
        "generalized-alpha, 200 000 of 10 us",
        "energy that is lost",
        &case,
        energy,
        0,
        (1.0, 1e-3),
    )
}
