//! Steady states of turning shafts: equilibria in the turning frame and periodic motions, against closed forms.

use crate::common::{fieldtest, model, shaft, with};
use faer::c64 as Complex;
use rotor::analysis::Outcome;
use rotor::analysis::spinup::spinup;
use rotor::case::LoadedCase;
use rotor::error::Error;
use rotor::results::Spinup;
use serde_json::{Value, json};

fn attempt(case: &LoadedCase) -> Result<Outcome<Spinup>, Error> {
    let model = model(case);
    spinup(&model, model.spinup.as_ref().expect("spinup"), &|_, _| true)
}

fn run(case: &LoadedCase) -> Outcome<Spinup> {
    attempt(case).unwrap_or_else(|e| panic!("{e}"))
}

pub const MASS: f64 = 1.0;
pub const ECCENTRICITY: f64 = 5e-4;
/// Stiffness of both bearings together: critical at 100 rad/s.
pub const STIFFNESS: f64 = 1e4;

/// A disk of 1 kg in the middle of a stiff shaft of no mass on two bearings, each with half of the laws.
pub fn jeffcott(stiffness: [[f64; 2]; 2], damping: [[f64; 2]; 2], speed: f64, more: Value) -> LoadedCase {
    let half = |law: [[f64; 2]; 2]| law.map(|row| row.map(|v| v / 2.0));
    let set = json!({
        "materials.light.rho": 1e-3,
        "supports.0.stiffness": half(stiffness), "supports.1.stiffness": half(stiffness),
        "supports.0.damping": half(damping), "supports.1.damping": half(damping),
        "spinup.drive.0.speed": speed,
        "probes": [{ "name": "disk", "at": 0.2, "y": 0 }]
    });
    with(&with(&fieldtest("steady_orbit_on_damped_bearings"), set), more)
}

/// Radius of the axis at the disk in an equilibrium of the turning frame.
fn radius(found: &Spinup) -> f64 {
    let [_, y, z] = found.last.probes[0].point.as_ref().expect("point").displacement_m;
    y.hypot(z)
}

#[test]
fn orbits_on_damped_bearings_are_the_closed_form() {
    // 200 N s/m are critical damping
    for damping in [0.0, 10.0, 60.0, 200.0, 1000.0] {
        for speed in [50.0, 90.0, 100.0, 110.0, 200.0] {
            if damping == 0.0 && speed == 100.0 {
                continue;
            }
            let law = [[damping, 0.0], [0.0, damping]];
            let case = jeffcott([[STIFFNESS, 0.0], [0.0, STIFFNESS]], law, speed, json!({}));
            let outcome = run(&case);
            let dynamic = Complex::new(STIFFNESS - MASS * speed * speed, damping * speed);
            let right = MASS * ECCENTRICITY * speed * speed / dynamic.norm();
            let ours = radius(&outcome.results);
            assert!((ours / right - 1.0).abs() < 1e-4, "c {damping} at {speed}: {ours} {right}");
            assert!(!outcome.diagnostics.iter().any(|d| d.code == "unstable-motion"));
            assert!(outcome.results.orbit.is_none());
        }
    }
}

/// Cross-coupling shifts the damping; beyond the threshold the state is told to be unstable, with its root.
#[test]
fn cross_coupled_bearings_hold_an_orbit_and_tell_their_root() {
    for (damping, crossed, speeds) in [
        (60.0, 2000.0, &[50.0, 90.0, 100.0, 200.0][..]),
        (60.0, -2000.0, &[90.0, 200.0]),
        (10.0, 2000.0, &[50.0, 100.0]),
        (10.0, 300.0, &[100.0]),
    ] {
        for &speed in speeds {
            let law = [[STIFFNESS, crossed], [-crossed, STIFFNESS]];
            let case = jeffcott(law, [[damping, 0.0], [0.0, damping]], speed, json!({}));
            let outcome = run(&case);
            let dynamic = Complex::new(STIFFNESS - MASS * speed * speed, damping * speed - crossed);
            let right = MASS * ECCENTRICITY * speed * speed / dynamic.norm();
            let ours = radius(&outcome.results);
            assert!((ours / right - 1.0).abs() < 1e-4, "{damping} {crossed} at {speed}: {ours} {right}");
            // m s^2 + c s + k -+ i kc = 0
            let inside = Complex::new(damping * damping - 4.0 * MASS * STIFFNESS, 4.0 * MASS * crossed.abs());
            let growth = (-damping + inside.sqrt().re) / (2.0 * MASS);
            let told = outcome.diagnostics.iter().find(|d| d.code == "unstable-motion");
            assert_eq!(told.is_some(), growth > 0.0, "{damping} {crossed}: {growth} {told:?}");
            if let Some(told) = told {
                let number = told.message.split("grows with ").nth(1).and_then(|t| t.split(' ').next());
                let number: f64 = number.expect("a root").parse().expect("a number");
                // the tilt of the disk has no part in it
                assert!((number / growth - 1.0).abs() < 1e-2, "{number} {growth}");
            }
        }
    }
}

/// Uneven bearings, gravity and forces in space: a periodic motion, `Y = m e W^2 / (k_y - m W^2 + i c_y W)` and alike along z,
/// about the sag.
#[test]
fn uneven_bearings_and_gravity_make_a_periodic_motion() {
    let (ky, kz) = (STIFFNESS, 2.25 * STIFFNESS);
    for (speed, gravity) in [(50.0, 0.0), (120.0, 0.0), (200.0, -9.81), (80.0, -9.81)] {
        let case = jeffcott(
            [[ky, 0.0], [0.0, kz]],
            [[20.0, 0.0], [0.0, 40.0]],
            speed,
            json!({ "gravity": [0, gravity, 0] }),
        );
        let found = run(&case).results;
        let orbit = found.orbit.as_ref().expect("a periodic motion");
        assert!(orbit.truncation < 1e-8, "{orbit:?}");
        let forced = |k: f64, c: f64| {
            MASS * ECCENTRICITY * speed * speed / Complex::new(k - MASS * speed * speed, c * speed)
        };
        let (y, z) = (forced(ky, 20.0), forced(kz, 40.0));
        let history = found.history.as_ref().expect("one turn");
        let size = y.norm().max(z.norm());
        for (t, u) in history.time_s.iter().zip(&history.mid_span_m) {
            let turned = Complex::new(0.0, speed * t).exp();
            let right = [(y * turned).re + MASS * gravity / ky, (z * turned).im];
            let off = (u[1] - right[0]).hypot(u[2] - right[1]);
            assert!(off < 1e-4 * size, "{speed} at {t}: {u:?} {right:?}");
        }
        let energy = found.energy.expect("over one turn");
        assert!((energy.drive_work_j / energy.bearings_j - 1.0).abs() < 1e-6, "{energy:?}");
    }
}

/// A force in space on a turning shaft bends it as at rest; the same from a fine mesh, a short neighbour and other members.
#[test]
fn a_force_in_space_bends_a_turning_shaft_as_at_rest() {
    let (load, length, r): (f64, f64, f64) = (500.0, 1.0, 0.02);
    let bent = |segments: Value, element: &str| {
        let case = crate::common::shaft(
            json!({ "shape": "circle", "radius": r }),
            length,
            2,
            json!({
                "supports": [{ "at": 0, "kind": "revolute" }, { "at": length, "kind": "cylindrical", "driven": false }],
                "loads": [{ "at": 0.5, "force": [0, load, 0] }],
                "spinup": { "drive": [{ "until": 1, "speed": 30 }], "steady": true }
            }),
        );
        let case = with(&case, json!({ "shaft.segments": segments, "shaft.element": element }));
        let found = run(&case).results;
        let history = found.history.as_ref().expect("one turn").mid_span_m.clone();
        let spread = history.iter().map(|u| (u[1] - history[0][1]).abs().max(u[2].abs())).fold(0.0, f64::max);
        assert!(spread < 2e-3 * history[0][1], "{element}: {spread} of {}", history[0][1]);
        history[0][1]
    };
    let part = |length: f64, elements: usize| json!({ "length": length, "elements": elements, "section": "s", "material": "m" });
    // both ends keep their planes: F L^3 / (192 E I), and shear
    let stiffness = 2.1e11 * std::f64::consts::PI * r.powi(4) / 4.0;
    let slender = load * length.powi(3) / (192.0 * stiffness);
    let coarse = bent(json!([part(0.5, 2), part(0.5, 2)]), "34X3");
    let fine = bent(json!([part(0.5, 10), part(0.5, 10)]), "34X3");
    let short = bent(json!([part(0.4995, 5), part(5e-4, 1), part(0.5, 5)]), "34X3");
    let other = bent(json!([part(0.5, 5), part(0.5, 5)]), "34X2");
    assert!(fine > slender && fine < 1.05 * slender, "{fine} {slender}");
    for (name, value) in [("coarse", coarse), ("short", short), ("34X2", other)] {
        assert!((value / fine - 1.0).abs() < 5e-3, "{name}: {value} {fine}");
    }
}

#[test]
fn the_orbit_of_another_code_at_a_critical_speed() {
    let found = run(&fieldtest("damped_steady_orbit")).results;
    let (m, e, w, c) = (10.0, 1e-4, 177.65365503769215, 40.0);
    // the shaft's stiffness, 48 E I / L^3 with driven plane ends: its critical speed is w
    assert!((radius(&found) / (m * e * w / c) - 1.0).abs() < 2e-3, "{}", radius(&found));
}

/// What space damps of a rigid shaft: `c = alpha M`.
#[test]
fn external_damping_holds_an_orbit() {
    let (alpha, speed) = (50.0, 90.0);
    let even = [[STIFFNESS, 0.0], [0.0, STIFFNESS]];
    let more = json!({ "materials.light.rho": 300, "materials.light.damping": { "mass": alpha } });
    let found = run(&jeffcott(even, [[0.0; 2]; 2], speed, more)).results;
    let shaft = 300.0 * std::f64::consts::PI * 0.05 * 0.05 * 0.4;
    let dynamic = Complex::new(STIFFNESS - (MASS + shaft) * speed * speed, alpha * shaft * speed);
    let right = MASS * ECCENTRICITY * speed * speed / dynamic.norm();
    assert!((radius(&found) / right - 1.0).abs() < 1e-3, "{} {right}", radius(&found));
}

/// Orbits over meshes of 10 and 40 elements and beside a short neighbour.
#[test]
fn orbits_do_not_change_with_the_mesh() {
    let even = [[STIFFNESS, 0.0], [0.0, STIFFNESS]];
    let part = |length: f64, elements: usize| json!({ "length": length, "elements": elements, "section": "shaft", "material": "light" });
    let right = MASS * ECCENTRICITY * 90.0 * 90.0 / Complex::new(STIFFNESS - 8100.0, 900.0).norm();
    for (segments, element) in [
        (json!([part(0.4, 10)]), "34X3"),
        (json!([part(0.4, 40)]), "34X3"),
        (json!([part(0.2, 4), part(4e-5, 1), part(0.19996, 4)]), "34X3"),
        (json!([part(0.4, 10)]), "34X2"),
    ] {
        let set = json!({ "shaft.segments": segments, "shaft.element": element });
        let found = run(&jeffcott(even, [[10.0, 0.0], [0.0, 10.0]], 90.0, set)).results;
        assert!((radius(&found) / right - 1.0).abs() < 2e-4, "{segments} {}: {right}", radius(&found));
    }
}

/// Disks out of their axis by 1e-3 and 1e-6 of the above, on uneven bearings: the same closed form, over meshes, beside a short
/// neighbour and with other members.
#[test]
fn small_motions_on_uneven_bearings_are_the_closed_form() {
    let (ky, kz, speed) = (STIFFNESS, 2.25 * STIFFNESS, 120.0);
    let part = |length: f64, elements: usize| json!({ "length": length, "elements": elements, "section": "shaft", "material": "light" });
    for (offset, segments, element) in [
        (5e-7, json!([part(0.4, 10)]), "34X3"),
        (5e-10, json!([part(0.4, 10)]), "34X3"),
        (5e-7, json!([part(0.4, 40)]), "34X3"),
        (5e-7, json!([part(0.2, 4), part(4e-5, 1), part(0.19996, 4)]), "34X3"),
        (5e-7, json!([part(0.4, 10)]), "34X2"),
    ] {
        let set =
            json!({ "disks.0.offset": [offset, 0], "shaft.segments": segments, "shaft.element": element });
        let found = run(&jeffcott([[ky, 0.0], [0.0, kz]], [[20.0, 0.0], [0.0, 40.0]], speed, set)).results;
        let forced = |k: f64, c: f64| {
            MASS * offset * speed * speed / Complex::new(k - MASS * speed * speed, c * speed)
        };
        let (y, z) = (forced(ky, 20.0), forced(kz, 40.0));
        let history = found.history.as_ref().expect("one turn");
        for (t, u) in history.time_s.iter().zip(&history.mid_span_m) {
            let turned = Complex::new(0.0, speed * t).exp();
            let off = (u[1] - (y * turned).re).hypot(u[2] - (z * turned).im);
            assert!(
                off < 2e-4 * y.norm().max(z.norm()),
                "{segments} {element} {offset} at {t}: {u:?} {y} {z}"
            );
        }
    }
}

/// A balanced shaft, and one whose disk is a hundredth of a millimetre out of its axis, on uneven bearings: motions that are small beside
/// what rounding moves are found, and are as linear as they are small.
#[test]
fn small_motions_on_uneven_bearings_are_found() {
    let fan = |offset: f64| {
        let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[5e7, 0], [0, 2e7]], "damping": [[5e3, 0], [0, 5e3]] });
        let more = json!({
            "disks": [{ "at": 0.85, "mass": 30.0, "polar_inertia": 0.6, "diametral_inertia": 0.31, "offset": [offset, 0] }],
            "supports": [bearing(0.1), bearing(0.7)],
            "spinup": {
                "drive": [{ "until": 1.0, "speed": "3000 rpm" }], "until": 1.0, "steady": true, "driven_at": 0
            }
        });
        let model = model(&shaft(json!({ "shape": "circle", "radius": 0.03 }), 0.9, 9, more));
        let settings = model.spinup.as_ref().expect("spinup");
        spinup(&model, settings, &|_, _| true).unwrap_or_else(|e| panic!("{offset}: {e}")).results
    };
    assert!(fan(0.0).extremes.expect("an orbit").radius_m < 1e-11);
    let [small, large] = [1e-5, 1e-4].map(|offset| fan(offset).extremes.expect("an orbit").radius_m / offset);
    assert!(small > 1e-3 && (small / large - 1.0).abs() < 1e-4, "{small} {large}");
}
