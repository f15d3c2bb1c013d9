//! Shafts on springs many decades softer than themselves: every rigid motion once, with the digits of the closed form.

use crate::common::{campbell, fieldtest, model, shaft, with};
use rotor::results::{Campbell, Level};
use serde_json::json;
use std::f64::consts::PI;

/// Mass, polar and diametral inertia of a circular cylinder.
fn cylinder(rho: f64, r: f64, l: f64) -> (f64, f64, f64) {
    let m = rho * PI * r * r * l;
    (m, m * r * r / 2.0, m * (r * r / 4.0 + l * l / 12.0))
}

/// A rigid rotor on two end springs k (closed form): `w^2 = 2 k/m`, and the conical `w^2 (Id -+ Jp) = k L^2/2` at w = Omega.
fn rigid_criticals(k: f64) -> [f64; 4] {
    let (m, polar, diametral) = cylinder(7850.0, 0.025, 1.0);
    let across = (2.0 * k / m).sqrt();
    let conical = |sign: f64| (k / 2.0 / (diametral + sign * polar)).sqrt();
    [across, across, conical(1.0), conical(-1.0)]
}

fn failed(case: &rotor::case::LoadedCase) -> (Campbell, Vec<String>) {
    let model = model(case);
    let settings = model.campbell.as_ref().expect("a campbell block");
    let outcome =
        rotor::analysis::campbell::campbell(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}"));
    let bad = outcome.diagnostics.iter().filter(|d| d.level != Level::Info);
    (outcome.results, bad.map(|d| format!("{}: {}", d.code, d.message)).collect())
}

/// From 1 mN/m to 10 kN/m there are exactly four critical speeds below 6000 rpm, those of the rigid rotor (below 10 N/m the
/// shaft's own give, k L^3/(E I), is below the digits asked for), in both forms.
#[test]
#[ignore = "long"]
fn springs_of_any_softness_have_the_criticals_of_the_rigid_rotor() {
    let case = fieldtest("soft_springs_1");
    for form in ["classical", "consistent"] {
        for k in [1e-3, 1e-1, 1.0, 10.0, 1e4] {
            let law = json!([[k, 0], [0, k]]);
            let case = with(
                &case,
                json!({ "supports.0.stiffness": law, "supports.1.stiffness": law, "campbell.form": form }),
            );
            let (found, bad) = failed(&case);
            assert!(bad.is_empty(), "{form} {k}: {bad:?}");
            let exact = rigid_criticals(k);
            let ours: Vec<f64> = found.critical_speeds.iter().map(|c| c.speed_rad_s).collect();
            assert_eq!(ours.len(), 4, "{form} {k}: {ours:?}");
            // K_T - K_0 of the spinning state carries a rounding of K_0
            let rtol = if k > 100.0 {
                3e-3
            } else if form == "consistent" {
                1e-4
            } else {
                3e-6
            };
            for (ours, exact) in ours.iter().zip(exact) {
                assert!((ours / exact - 1.0).abs() < rtol, "{form} {k}: {ours} {exact}");
            }
            if form == "consistent" && k < 10.0 {
                // K_T - K_0 carries a rounding of K_0, about 1e-6 N m for the tilt
                continue;
            }
            // and the conical whirl at every speed
            let (_, polar, diametral) = cylinder(7850.0, 0.025, 1.0);
            for (name, sign) in [("2F", 1.0), ("2B", -1.0)] {
                let branch = found.branches.iter().find(|b| b.name == name).expect("a conical branch");
                for (speed, ours) in found.speeds_rad_s.iter().zip(&branch.frequency_rad_s) {
                    let half = speed * polar / (2.0 * diametral);
                    // w -+ of the same product
                    let root = (half * half + k / 2.0 / diametral).sqrt();
                    let exact = if sign > 0.0 { root + half } else { k / 2.0 / diametral / (root + half) };
                    let ours = ours.expect("a frequency");
                    assert!(
                        (ours / exact - 1.0).abs() < rtol.max(1e-5),
                        "{form} {k} {name} {speed}: {ours} {exact}"
                    );
                }
            }
        }
    }
}

/// Modes at rest of the same: two along and about the axis that nothing holds, four of the rigid rotor, then those of the
/// free shaft, each to a residual of rounding.
#[test]
fn modes_on_soft_springs_are_those_of_the_rigid_rotor() {
    let case = fieldtest("soft_springs_1");
    for k in [1e-3, 1.0, 1e4] {
        let law = json!([[k, 0], [0, k]]);
        let model = model(&with(&case, json!({ "supports.0.stiffness": law, "supports.1.stiffness": law })));
        let outcome = rotor::analysis::modes::modes(&model).unwrap_or_else(|e| panic!("{e}"));
        assert!(outcome.diagnostics.iter().all(|d| d.level == Level::Info), "{k}: {:?}", outcome.diagnostics);
        let (m, _, diametral) = cylinder(7850.0, 0.025, 1.0);
        let exact = [0.0, 0.0, (2.0 * k / m).sqrt(), (2.0 * k / m).sqrt(), (k / 2.0 / diametral).sqrt()];
        for (mode, exact) in outcome.results.modes.iter().zip(exact) {
            let rtol = if k > 100.0 { 3e-3 } else { 3e-6 };
            assert!(
                (mode.frequency_rad_s - exact).abs() <= rtol * exact,
                "{k}: {} {exact}",
                mode.frequency_rad_s
            );
        }
    }
}

/// A rotor with three disks on three springs of 1 N/m: modes and Campbell diagram without an error.
#[test]
fn a_rotor_in_magnetic_bearings_is_solved() {
    let case = fieldtest("soft_magnetic_bearings");
    let outcome = rotor::analysis::modes::modes(&model(&case)).unwrap_or_else(|e| panic!("{e}"));
    assert!(outcome.diagnostics.iter().all(|d| d.level == Level::Info), "{:?}", outcome.diagnostics);
    let (found, bad) = failed(&case);
    assert!(bad.is_empty(), "{bad:?}");
    assert_eq!(found.critical_speeds.iter().filter(|c| c.speed_rad_s < 10.0).count(), 4);
}

/// One direction of one bearing is soft, the other is not; a skew law too.
#[test]
fn soft_in_one_direction_only() {
    let bearing = |at: f64, law: serde_json::Value| json!({ "at": at, "kind": "bearing", "stiffness": law });
    for turn in [0.0f64, 0.6] {
        let (hard, soft) = (1e9, 1e-2);
        let (s, c) = turn.sin_cos();
        let law = json!([
            [c * c * hard + s * s * soft, s * c * (hard - soft)],
            [s * c * (hard - soft), s * s * hard + c * c * soft]
        ]);
        let more =
            json!({ "supports": [bearing(0.0, law.clone()), bearing(1.0, law)], "modes": { "count": 8 } });
        let found =
            crate::common::frequencies(&shaft(json!({ "shape": "circle", "radius": 0.025 }), 1.0, 8, more));
        let (m, _, diametral) = cylinder(7800.0, 0.025, 1.0);
        for (ours, exact) in
            found[2..4].iter().zip([(2.0 * soft / m).sqrt(), (soft / 2.0 / diametral).sqrt()])
        {
            let rtol = if turn == 0.0 { 3e-6 } else { 1e-4 };
            assert!((ours / exact - 1.0).abs() < rtol, "{turn}: {ours} {exact}");
        }
    }
}

/// Springs that are soft beside the section but not beside a slender shaft on many of them: as before, against the same on
/// a softer and a stiffer scale of the split.
#[test]
fn a_slender_shaft_on_many_springs_keeps_its_frequencies() {
    let supports: Vec<serde_json::Value> = (0..9)
        .map(|i| json!({ "at": f64::from(i) / 8.0, "kind": "bearing", "stiffness": [[1e3, 0], [0, 1e3]] }))
        .collect();
    let case = shaft(
        json!({ "shape": "circle", "radius": 5e-4 }),
        1.0,
        16,
        json!({ "supports": supports, "modes": { "count": 6 } }),
    );
    let found = campbell_free(&case);
    // Euler-Bernoulli on springs, spans of 1/8 m: first mode between those of one span pinned and clamped
    let span = |c: f64| c / 0.125f64.powi(2) * (2.1e11 / 7800.0f64).sqrt() * 5e-4 / 2.0;
    assert!(found > 0.8 * span(PI * PI) && found < span(22.37), "{found} {}", span(PI * PI));
}

fn campbell_free(case: &rotor::case::LoadedCase) -> f64 {
    let found = crate::common::frequencies(case);
    found.into_iter().find(|w| *w > 0.0).expect("a frequency")
}

/// The sweep's lowest branches on soft springs have one forward and one backward whirl each.
#[test]
fn branches_on_soft_springs_come_in_pairs() {
    let found = campbell(&fieldtest("soft_springs_1"));
    let names: Vec<&str> = found.branches.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["1B", "1F", "2B", "2F", "3B", "3F", "4B", "4F"]);
}
