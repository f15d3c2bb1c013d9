//! Motions that do not oscillate, motions that grow, and the speed at which they begin to.

use crate::common::{fieldtest, model, shaft, with};
use rotor::case::LoadedCase;
use rotor::results::{Branch, Campbell, Diagnostic, Whirl};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn run(case: &LoadedCase) -> (Campbell, Vec<Diagnostic>) {
    let model = model(case);
    let settings = model.campbell.as_ref().expect("a campbell block");
    let outcome =
        rotor::analysis::campbell::campbell(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}"));
    (outcome.results, outcome.diagnostics)
}

fn bearing(at: f64, k: f64, c: f64) -> Value {
    json!({ "at": at, "kind": "bearing", "stiffness": [[k, 0], [0, k]], "damping": [[c, 0], [0, c]] })
}

fn named<'a>(found: &'a Campbell, name: &str) -> &'a Branch {
    found.branches.iter().find(|b| b.name == name).unwrap_or_else(|| panic!("no branch {name}"))
}

/// A damper of 1e6 N s/m at mid-span holds the middle: the first bending pair creeps at all speeds, and the motion at 1658 rad/s
/// is the second pair (Timoshenko beams).
#[test]
fn an_overdamped_first_bending_is_told_and_counted() {
    let (found, _) = run(&fieldtest("overdamped_middle"));
    let names: Vec<&str> = found.branches.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["1B", "1F", "2B", "2F"]);
    for name in ["1B", "1F"] {
        let branch = named(&found, name);
        assert_eq!(branch.overdamped, found.speeds_rad_s);
        assert!(branch.frequency_rad_s.iter().all(Option::is_none));
        assert!(branch.whirl_at_speed.iter().all(|w| *w == Whirl::None));
    }
    for name in ["2B", "2F"] {
        let branch = named(&found, name);
        assert!(branch.overdamped.is_empty());
        let first = branch.frequency_rad_s[0].expect("a frequency");
        assert!((first / 1658.0 - 1.0).abs() < 1e-3, "{first}");
    }
    let table = rotor::report::table::campbell(&found);
    assert!(table.contains("overdamped: 2 of 4 branches (1B at all speeds; 1F at all speeds)"), "{table}");
}

/// The conical motion of a stiff rotor on damped bearings obeys `Id s^2 + (ct - i Omega Jp) s + kt = 0` (closed form): overdamped
/// at standstill, it whirls when it spins, slowly backward and fast forward. Its translation is overdamped at all speeds.
#[test]
fn what_creeps_at_rest_may_whirl_at_speed() {
    let (l, r, k, c) = (0.4_f64, 0.05_f64, 1000.0, 500.0);
    let case = shaft(
        json!({ "shape": "circle", "radius": r }),
        l,
        2,
        json!({
            "disks": [{ "at": l / 2.0, "mass": 20, "polar_inertia": 1.8, "diametral_inertia": 1.0 }],
            "supports": [bearing(0.0, k, c), bearing(l, k, c)],
            "campbell": { "speeds": { "to": 100, "count": 6 }, "modes": 4, "form": "classical" }
        }),
    );
    let (found, _) = run(&case);
    let m = 7800.0 * PI * r * r * l;
    let (polar, diametral) = (m * r * r / 2.0 + 1.8, m * (r * r / 4.0 + l * l / 12.0) + 1.0);
    let (ct, kt) = (c * l * l / 2.0, k * l * l / 2.0);
    for name in ["1B", "1F"] {
        assert_eq!(named(&found, name).overdamped, found.speeds_rad_s, "{name}");
    }
    for (name, whirl, sign) in [("2B", Whirl::Backward, -1.0), ("2F", Whirl::Forward, 1.0)] {
        let branch = named(&found, name);
        assert_eq!(branch.overdamped, [0.0], "{name}");
        for index in 1..found.speeds_rad_s.len() {
            // sqrt of a complex number with a positive imaginary part
            let gyro = found.speeds_rad_s[index] * polar;
            let (re, im) = (ct * ct - gyro * gyro - 4.0 * diametral * kt, -2.0 * ct * gyro);
            let size = re.hypot(im);
            let (root_re, root_im) = (((size + re) / 2.0).sqrt(), -((size - re) / 2.0).sqrt());
            let (s_re, s_im) =
                ((-ct - sign * root_re) / (2.0 * diametral), (gyro - sign * root_im) / (2.0 * diametral));
            let frequency = branch.frequency_rad_s[index].expect("a frequency");
            assert!((frequency / s_im.abs() - 1.0).abs() < 2e-3, "{name} {index}: {frequency} {s_im}");
            let decrement = branch.log_decrement[index].expect("a decrement");
            assert!(
                (decrement / (-2.0 * PI * s_re / s_im.abs()) - 1.0).abs() < 4e-3,
                "{name} {index}: {decrement}"
            );
            assert_eq!(branch.whirl_at_speed[index], whirl, "{name}");
        }
    }
    let table = rotor::report::table::campbell(&found);
    assert!(table.contains("2F begins to whirl before 191.0 rpm"), "{table}");
}

/// Negative damping beyond the critical: a real root grows, `m s^2 - c s + k = 0` (closed form), and is told as an instability.
#[test]
fn a_real_root_that_grows_is_an_instability() {
    let (l, r, k, c) = (0.4_f64, 0.05_f64, 1000.0, 2000.0);
    let case = shaft(
        json!({ "shape": "circle", "radius": r }),
        l,
        2,
        json!({
            "supports": [bearing(0.0, k, -c), bearing(l, k, -c)],
            "campbell": { "speeds": { "to": 1, "count": 3 }, "modes": 2, "form": "classical" }
        }),
    );
    let (found, diagnostics) = run(&case);
    let m = 7800.0 * PI * r * r * l;
    let diametral = m * (r * r / 4.0 + l * l / 12.0);
    let root = |m: f64, c: f64, k: f64| (c + (c * c - 4.0 * m * k).sqrt()) / (2.0 * m);
    let exact = root(m, 2.0 * c, 2.0 * k).max(root(diametral, c * l * l / 2.0, k * l * l / 2.0));
    let real = found.unstable_ranges.iter().find(|r| r.branch == "not oscillating").expect("told");
    assert_eq!((real.from_rad_s, real.to_rad_s), (0.0, 1.0));
    assert!(
        (real.largest_growth_rate_1_s / exact - 1.0).abs() < 1e-3,
        "{} {exact}",
        real.largest_growth_rate_1_s
    );
    assert_eq!(found.stability_threshold_rad_s, Some(0.0));
    assert!(diagnostics.iter().any(|d| d.code == "unstable" && d.message.contains("does not oscillate")));
}

/// A disk of 10 kg on a shaft of (nearly) no mass, viscous material, external damper at the disk: unstable beyond
/// `w (1 + c_ext/c_int)` (closed form), whatever the shaft weighs.
#[test]
#[ignore = "long"]
fn thresholds_of_rotating_damping() {
    let (r, l, beta) = (0.01f64, 1.0, 1e-5);
    let stiffness = 48.0 * 2.1e11 * PI * r.powi(4) / 4.0 / (l * l * l);
    let case = |ratio: f64, density: f64, count: usize| {
        let w = (stiffness / 10.0).sqrt();
        let damper = bearing(0.5, 0.0, ratio * beta * stiffness);
        let mut supports = vec![json!({ "at": 0, "kind": "pinned" }), json!({ "at": l, "kind": "roller" })];
        supports.extend((ratio > 0.0).then_some(damper));
        shaft(
            json!({ "shape": "circle", "radius": r }),
            l,
            8,
            json!({
                "materials": { "m": { "nu": 0, "rho": density, "damping": { "stiffness": beta } } },
                "disks": [{ "at": 0.5, "mass": 10, "polar_inertia": 0.02, "diametral_inertia": 0.01 }],
                "supports": supports,
                "campbell": { "speeds": { "to": 1.6 * w * (1.0 + ratio), "count": count }, "modes": 2, "form": "classical" }
            }),
        )
    };
    for density in [1.0, 1e-3] {
        let ratios = if density < 0.1 { &[0.0, 1.0, 4.0][..] } else { &[0.0, 0.25, 0.5, 1.0, 2.0, 4.0] };
        for &ratio in ratios {
            let (found, _) = run(&case(ratio, density, 5));
            let w = named(&found, "1F").frequency_rad_s[0].expect("a frequency");
            let threshold = found.stability_threshold_rad_s.expect("a threshold");
            assert!(
                (threshold / (w * (1.0 + ratio)) - 1.0).abs() < 1e-3,
                "{density} {ratio}: {threshold} {w}"
            );
        }
    }
    // so light that nothing is left: right, or said
    let (found, diagnostics) = run(&case(1.0, 1e-7, 3));
    match found.stability_threshold_rad_s {
        Some(threshold) => {
            assert!((threshold / (2.0 * (stiffness / 10.0).sqrt()) - 1.0).abs() < 2e-3, "{threshold}")
        }
        None => assert!(diagnostics.iter().any(|d| d.code == "decay-rounded"), "{diagnostics:?}"),
    }
}

/// A stiff shaft of viscous material on soft bearings strains little, but the threshold of its rigid motion is its frequency
/// (closed form: no external damping).
#[test]
fn threshold_of_a_stiff_shaft_on_soft_bearings() {
    for k in [1e2, 1e4, 1e6] {
        let case = shaft(
            json!({ "shape": "circle", "radius": 0.02 }),
            1.0,
            8,
            json!({
                "materials": { "m": { "damping": { "stiffness": 1e-5 } } },
                "supports": [bearing(0.0, k, 0.0), bearing(1.0, k, 0.0)],
                "campbell": { "speeds": { "to": 1.7 * (2.0 * k / 9.8_f64).sqrt(), "count": 6 }, "modes": 2, "form": "classical" }
            }),
        );
        let (found, diagnostics) = run(&case);
        let w = named(&found, "1F").frequency_rad_s[0].expect("a frequency");
        match found.stability_threshold_rad_s {
            Some(threshold) => assert!((threshold / w - 1.0).abs() < 1e-3, "{k}: {threshold} {w}"),
            None => assert!(diagnostics.iter().any(|d| d.code == "decay-rounded"), "{k}: {diagnostics:?}"),
        }
        assert!(found.stability_threshold_rad_s.is_some() || k < 1e4, "{k}: no threshold");
    }
}

/// Without growth there is no threshold; a single speed of a damped rotor says why it has no critical speeds.
#[test]
fn a_single_damped_speed_says_why_it_has_no_critical_speeds() {
    let case = shaft(
        json!({ "shape": "circle", "radius": 0.02 }),
        1.0,
        4,
        json!({
            "supports": [bearing(0.0, 1e6, 100.0), bearing(1.0, 1e6, 100.0)],
            "campbell": { "speeds": { "from": 300, "to": 300, "count": 1 }, "modes": 2 }
        }),
    );
    let (found, diagnostics) = run(&case);
    assert!(found.critical_speeds.is_empty() && found.stability_threshold_rad_s.is_none());
    assert!(
        diagnostics.iter().any(|d| d.code == "damped-criticals" && d.message.contains("single speed")),
        "{diagnostics:?}"
    );
    let (found, diagnostics) = run(&with(&case, json!({ "campbell.speeds": { "to": 600, "count": 3 } })));
    assert!(!found.critical_speeds.is_empty());
    assert!(diagnostics.iter().all(|d| !d.message.contains("single speed")));
}
