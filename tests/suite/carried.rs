//! What segments carry: added mass, axial force and torque, against beams in closed form and by Ritz's method.

use crate::common::{campbell, model, of_kind, shaft, with};
use nalgebra::{DMatrix, SymmetricEigen};
use rotor::analysis::mass_properties::properties;
use rotor::analysis::modes::modes;
use rotor::case::LoadedCase;
use rotor::results::ModeKind;
use rotor::run::{Analysis, Host, run};
use serde_json::{Value, json};
use std::f64::consts::PI;

const E: f64 = 2.1e11;
const RHO: f64 = 7800.0;
const RADIUS: f64 = 0.02;
const LENGTH: f64 = 1.6;
const AREA: f64 = PI * RADIUS * RADIUS;
const BENDING: f64 = E * PI / 4.0 * RADIUS * RADIUS * RADIUS * RADIUS;

/// Shear stiffness of the circle: `ks G A` with Cowper's factor in three dimensions.
fn shear() -> f64 {
    let nu: f64 = 0.3;
    let ks = 6.0 * (1.0 + nu).powi(2) / (7.0 + 12.0 * nu + 4.0 * nu * nu);
    ks * E / 2.0 / (1.0 + nu) * AREA
}

fn beam(ends: [&str; 2], more: Value) -> LoadedCase {
    let supports = json!([{ "at": 0, "kind": ends[0] }, { "at": LENGTH, "kind": ends[1] }]);
    let base = json!({ "supports": supports, "modes": { "count": 12 } });
    let case = shaft(json!({ "shape": "circle", "radius": RADIUS }), LENGTH, 10, base);
    with(&case, more)
}

fn bending(case: &LoadedCase) -> Vec<f64> {
    of_kind(case, ModeKind::Bending).into_iter().step_by(2).collect()
}

fn near(ours: f64, right: f64, rtol: f64, what: &str) {
    assert!((ours / right - 1.0).abs() <= rtol, "{what}: {ours} instead of {right}");
}

#[test]
fn added_mass_moves_with_the_section_and_does_not_turn() {
    let (light, added) = (1.0, 20.0);
    let case = beam(
        ["pinned", "roller"],
        json!({ "materials.m.rho": light, "shaft.segments.0.added_mass_per_length": added }),
    );
    let k = PI / LENGTH;
    for (n, ours) in bending(&case).iter().take(3).enumerate() {
        let k = k * (n + 1) as f64;
        let mass = added + light * AREA;
        // without rotary inertia
        let right = (BENDING * k.powi(4) / (1.0 + BENDING * k * k / shear()) / mass).sqrt();
        near(*ours, right, 3e-4, "pinned beam");
    }
    let p = properties(&model(&case));
    near(p.shaft, (added + light * AREA) * LENGTH, 1e-12, "mass");
    near(p.polar, light * AREA * LENGTH * RADIUS * RADIUS / 2.0, 1e-12, "polar inertia");
    // it has no gyroscopic moment: forward and backward stay together; both frames agree
    let sweep = |frame: &str| {
        let block = json!({ "speeds": { "from": 0, "to": 300, "count": 2 }, "modes": 4, "frame": frame });
        let case = with(&case, json!({ "campbell": block }));
        campbell(&case).branches.iter().filter_map(|b| b.frequency_rad_s[1]).collect::<Vec<f64>>()
    };
    let still = sweep("stationary");
    near(still[0], still[1], 1e-5, "whirl");
    let turning = sweep("rotating");
    for w in &turning[..2] {
        let meets = |x: &&f64| [w + 300.0, (w - 300.0).abs()].iter().any(|v| (v / **x - 1.0).abs() < 1e-6);
        assert!(still.iter().any(|x| meets(&x)), "{turning:?} {still:?}");
    }
}

#[test]
fn added_mass_and_initial_stress_settle_under_refinement() {
    let carried = json!({ "added_mass_per_length": 15, "axial_force": -2e4, "torque": 2e3 });
    for element in ["34X2", "34X4"] {
        let of = |elements: u64, disks: Value| {
            let mut case =
                beam(["pinned", "roller"], json!({ "shaft.element": element, "disks": disks })).value;
            for (key, value) in carried.as_object().expect("keys") {
                case["shaft"]["segments"][0][key] = value.clone();
            }
            case["shaft"]["segments"][0]["elements"] = json!(elements);
            bending(&LoadedCase::from_value("c.json", case).unwrap_or_else(|e| panic!("{e}")))
        };
        let list = [10, 40, 320].map(|n| of(n, json!([])));
        for n in 0..3 {
            near(list[0][n], list[2][n], 1e-3, element);
            near(list[1][n], list[2][n], 1e-4, element);
        }
        let point = |x: f64| json!({ "at": x, "mass": 1e-9, "hub": "soft" });
        let short = of(10, json!([point(0.8), point(0.8 + 1.6e-4)]));
        near(short[0], list[0][0], 1e-4, "a short element");
    }
}

#[test]
fn an_axial_force_changes_frequencies_by_the_root_of_its_share() {
    let k = PI / LENGTH;
    let euler = BENDING * k * k;
    let critical = euler / (1.0 + euler / shear());
    // compression takes P I / A of the bending stiffness
    let critical = critical * (1.0 - critical / (E * AREA));
    let base = bending(&beam(["pinned", "roller"], json!({})))[0];
    for share in [-0.9, -0.5, 0.5, 3.0] {
        let case = beam(["pinned", "roller"], json!({ "shaft.segments.0.axial_force": share * critical }));
        near(bending(&case)[0], base * f64::sqrt(1.0 + share), 2e-4, &format!("P = {share} Pcr"));
    }
    let buckled = beam(["pinned", "roller"], json!({ "shaft.segments.0.axial_force": -1.02 * critical }));
    let error = modes(&model(&buckled)).expect_err("buckled").to_string();
    assert!(error.contains("buckles at 0.98"), "{error}");
    assert!(
        modes(&model(&beam(
            ["pinned", "roller"],
            json!({ "shaft.segments.0.axial_force": -0.99 * critical })
        )))
        .is_ok()
    );
}

/// Squares of the frequencies of a clamped beam under a torque, over those without, by Ritz's method: Euler's beam
/// `1/2 int EI |z''|^2 + T/2 Im(z''* z') + rho A/2 |z|^2` with z = v + i w in `x^2 (1-x)^2 x^k`.
fn clamped_under_torque(torque: f64) -> Vec<f64> {
    const N: usize = 9;
    let shape = |k: usize, x: f64| -> [f64; 3] {
        let p = k as i32 + 2;
        // x^p (1 - 2 x + x^2)
        let term = |c: f64, p: i32| {
            let f = f64::from(p);
            [c * x.powi(p), c * f * x.powi(p - 1), c * f * (f - 1.0) * x.powi(p - 2)]
        };
        let [a, b, d] = [term(1.0, p), term(-2.0, p + 1), term(1.0, p + 2)];
        [0, 1, 2].map(|i| a[i] + b[i] + d[i])
    };
    let (mut k, mut m) = (DMatrix::<f64>::zeros(2 * N, 2 * N), DMatrix::<f64>::zeros(2 * N, 2 * N));
    for (xi, w) in rotor::element::quadrature::gauss(20) {
        let x = (1.0 + xi) / 2.0;
        let of: Vec<[f64; 3]> = (0..N).map(|k| shape(k, x)).collect();
        for i in 0..N {
            for j in 0..N {
                let bend = w / 2.0 * BENDING / LENGTH.powi(3) * of[i][2] * of[j][2];
                let mass = w / 2.0 * RHO * AREA * LENGTH * of[i][0] * of[j][0];
                // T/2 int (v'' w' - w'' v')
                let twist =
                    w / 2.0 * torque / 2.0 / LENGTH.powi(2) * (of[i][2] * of[j][1] - of[i][1] * of[j][2]);
                k[(i, j)] += bend;
                k[(N + i, N + j)] += bend;
                k[(i, N + j)] += twist;
                k[(N + j, i)] += twist;
                m[(i, j)] += mass;
                m[(N + i, N + j)] += mass;
            }
        }
    }
    let l = m.cholesky().expect("mass").l();
    let inverse = l.try_inverse().expect("triangular");
    let mut list: Vec<f64> =
        SymmetricEigen::new(&inverse * k * inverse.transpose()).eigenvalues.iter().copied().collect();
    list.sort_by(f64::total_cmp);
    list
}

#[test]
fn a_torque_changes_frequencies_as_that_of_a_clamped_beam() {
    let under = |torque: f64| {
        of_kind(
            &beam(["clamped", "clamped"], json!({ "shaft.segments.0.torque": torque, "modes.count": 8 })),
            ModeKind::Bending,
        )
    };
    let (base, ritz) = (under(0.0), clamped_under_torque(0.0));
    for share in [4.0, 7.0] {
        let torque = share * BENDING / LENGTH;
        let (ours, right) = (under(torque), clamped_under_torque(torque));
        for n in 0..4 {
            let right = (right[n] / ritz[n]).sqrt();
            near(ours[n] / base[n], right, 2e-3, &format!("T = {share} EI/L, {n}"));
        }
        // the sense does not matter
        near(under(-torque)[0], ours[0], 1e-9, "sense");
    }
}

/// Torques at which shafts buckle: tan x = x with x = T L / (2 EI) where both ends are clamped, tan x = -x/3 where they are
/// pinned and the torque is semi-tangential.
#[test]
fn shafts_buckle_under_a_torque_at_the_closed_forms() {
    for (ends, critical) in
        [(["clamped", "clamped"], 2.0 * 4.493_409), (["pinned", "roller"], 2.0 * 2.455_644)]
    {
        let torque = 1.05 * critical * BENDING / LENGTH;
        let buckled = beam(ends, json!({ "shaft.segments.0.torque": torque }));
        let error = modes(&model(&buckled)).expect_err("buckled").to_string();
        let share: f64 = error
            .split("buckles at ")
            .nth(1)
            .and_then(|text| text.split(' ').next())
            .and_then(|number| number.parse().ok())
            .unwrap_or_else(|| panic!("{error}"));
        near(share * 1.05, 1.0, 3e-3, &format!("{ends:?}"));
        let held = beam(ends, json!({ "shaft.segments.0.torque": 0.98 * critical * BENDING / LENGTH }));
        assert!(modes(&model(&held)).is_ok());
    }
}

#[test]
fn both_frames_agree_under_initial_stress() {
    let euler = BENDING * (PI / LENGTH).powi(2);
    let set = json!({
        "shaft.segments.0.axial_force": -0.3 * euler, "shaft.segments.0.torque": 2.0 * BENDING / LENGTH,
        "shaft.segments.0.elements": 5
    });
    let case = with(&beam(["pinned", "roller"], json!({})), set);
    let sweep = |frame: &str| {
        let block = json!({ "speeds": { "from": 0, "to": 900, "count": 2 }, "modes": 4, "frame": frame });
        let case = with(&case, json!({ "campbell": block }));
        campbell(&case).branches.iter().filter_map(|b| b.frequency_rad_s[1]).collect::<Vec<f64>>()
    };
    let (still, turning) = (sweep("stationary"), sweep("rotating"));
    for w in &turning[..2] {
        let meets = |x: &&f64| [w + 900.0, (w - 900.0).abs()].iter().any(|v| (v / **x - 1.0).abs() < 1e-5);
        assert!(still.iter().any(|x| meets(&x)), "{turning:?} {still:?}");
    }
}

#[test]
fn initial_stress_that_cannot_act_is_refused() {
    let stressed = |ends: Value| {
        let case = beam(["pinned", "roller"], json!({ "shaft.segments.0.axial_force": 1e4 }));
        with(&case, json!({ "supports": ends }))
    };
    let pinned = stressed(json!([{ "at": 0, "kind": "pinned" }, { "at": LENGTH, "kind": "roller" }]));
    for analysis in [Analysis::Static, Analysis::Spinup] {
        let case = with(
            &pinned,
            json!({ "spinup": { "drive": [{ "until": 0.1, "speed": 100 }], "until": 0.1, "driven_at": 0 } }),
        );
        let error = match run(&case, analysis, &Host::silent()) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("{} ran", analysis.name()),
        };
        assert!(error.contains("shaft.segments.0.axial_force") && error.contains("loads"), "{error}");
    }
    let free = modes(&model(&stressed(json!([])))).expect_err("free to tilt").to_string();
    assert!(free.contains("tilt"), "{free}");
    let flat = with(&beam(["pinned", "roller"], json!({ "shaft.segments.0.torque": 10 })), json!({}));
    let mut flat = flat.value;
    flat["sections"]["s"] = json!({ "shape": "rectangle", "height": 0.02, "width": 0.03 });
    let flat = LoadedCase::from_value("flat.json", flat).unwrap_or_else(|e| panic!("{e}"));
    assert!(rotor::model::Model::new(&flat).expect_err("flat").to_string().contains("round"));
    for key in ["added_mass_per_length", "mass"] {
        let set = if key == "mass" {
            json!({ "disks": [{ "at": 0.5, "mass": -1 }] })
        } else {
            json!({ "shaft.segments.0.added_mass_per_length": -1 })
        };
        let error = rotor::model::Model::new(&with(&pinned, set)).expect_err("negative").to_string();
        assert!(error.contains(key), "{error}");
    }
}

#[test]
fn a_disk_may_be_a_point_mass() {
    let of = |disk: Value| bending(&beam(["pinned", "roller"], json!({ "disks": [disk] })));
    let point = of(json!({ "at": 0.8, "mass": 5 }));
    let written = of(json!({ "at": 0.8, "mass": 5, "polar_inertia": 0, "diametral_inertia": 0 }));
    assert_eq!(point, written);
}
