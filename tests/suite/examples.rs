//! The examples of the library: they run, and say what closed forms and references say.

#[allow(dead_code)]
#[path = "../../examples/critical_speeds_of_a_case.rs"]
mod critical_speeds_of_a_case;
#[allow(dead_code)]
#[path = "../../examples/growth_of_a_tube.rs"]
mod growth_of_a_tube;
#[allow(dead_code)]
#[path = "../../examples/mesh_refinement.rs"]
mod mesh_refinement;
#[allow(dead_code)]
#[path = "../../examples/sweep_bearing_stiffness.rs"]
mod sweep_bearing_stiffness;
#[allow(dead_code)]
#[path = "../../examples/two_beams_in_contact.rs"]
mod two_beams_in_contact;

use rotor::Rotor;
use rotor::results::Whirl;

/// On soft bearings the shaft is rigid: with the displacement u of its middle and the tilt t, L = 1,
/// `w^2 [[m, s], [s, J -+ P]] (u, t) = 2 k [[1, 0], [0, 1/4]] (u, t)`, - for forward and + for backward whirl. Stiffer bearings raise
/// every critical speed.
#[test]
fn a_bearing_stiffness_is_swept() {
    let shaft = sweep_bearing_stiffness::shaft().expect("a rotor");
    let found = |stiffness: f64| sweep_bearing_stiffness::critical_speeds(&shaft, stiffness).expect("runs");
    let (rod, radius, disk, off) = (7850.0 * std::f64::consts::PI * 0.03_f64.powi(2), 0.03_f64, 20.0, -0.1);
    let (mass, static_moment, polar) = (rod + disk, disk * off, rod * radius * radius / 2.0 + 0.25);
    let across = rod * (1.0 / 12.0 + radius * radius / 4.0) + 0.13 + disk * off * off;
    let soft = 1e3;
    let ours = found(soft);
    assert_eq!(ours.len(), 4, "{ours:?}");
    for (whirl, sign) in [(Whirl::Forward, -1.0), (Whirl::Backward, 1.0)] {
        let inertia = across + sign * polar;
        // determinant of K - x M, x = w^2
        let (a, b) = (mass * inertia - static_moment * static_moment, 2.0 * soft * (inertia + mass / 4.0));
        let root = (b * b - 4.0 * a * soft * soft).sqrt();
        let rigid = [b - root, b + root].map(|x| (x / (2.0 * a)).sqrt());
        let ours: Vec<f64> = ours.iter().filter(|c| c.whirl == whirl).map(|c| c.speed_rad_s).collect();
        for (ours, rigid) in ours.iter().zip(rigid) {
            assert!((ours / rigid - 1.0).abs() < 5e-4, "{whirl:?}: {ours} {rigid}");
        }
        assert_eq!(ours.len(), 2, "{whirl:?}");
    }
    let first = [1e3, 1e6, 3e6, 1e7, 3e7, 1e8].map(|k| [0, 1].map(|i| found(k)[i].speed_rad_s));
    assert!(first.windows(2).all(|k| k[0][0] < k[1][0] && k[0][1] < k[1][1]), "{first:?}");
}

/// The typed results carry the remarks of the report: here Young's modulus in GPa, taken for Pa.
#[test]
fn typed_results_doubt_the_values_as_the_report_does() {
    let slip = sweep_bearing_stiffness::shaft().and_then(|shaft| shaft.with("materials.steel.E", 210));
    let slip = slip.expect("a rotor");
    let typed = slip.check().expect("runs").diagnostics;
    let reported = slip.report(rotor::Analysis::Check, false).expect("runs").diagnostics;
    assert!(typed.iter().any(|d| d.code == "implausible" && d.message.contains("materials.steel.E")));
    assert_eq!(format!("{typed:?}"), format!("{reported:?}"));
}

#[test]
fn a_case_is_read() {
    let found = critical_speeds_of_a_case::critical_speeds("cases/jeffcott.json").expect("runs");
    let case = Rotor::from_file("cases/jeffcott.json").expect("a case");
    let whole = case.report(rotor::Analysis::Campbell, false).expect("runs").json;
    let reported = whole["results"]["critical_speeds"].as_array().expect("a list");
    assert_eq!(found.len(), reported.len());
    for (ours, reported) in found.iter().zip(reported) {
        assert_eq!(Some(ours.speed_rpm), reported["speed_rpm"].as_f64());
    }
}

/// A Timoshenko beam in two pins, shear factor of Cowper: `w^2` is the lower root of
/// `rho I / (k G A) w^4 - (1 + (p r)^2 (1 + E / (k G))) w^2 + p^4 E I / (rho A) = 0`, p = pi / L.
#[test]
fn a_mesh_is_refined() {
    let (e, nu, rho, radius, length) = (210e9, 0.3, 7850.0, 0.05_f64, 2.0);
    let p = std::f64::consts::PI / length;
    let turn = radius * radius / 4.0;
    let shear: f64 = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu) * e / (2.0 * (1.0 + nu));
    let (a, b, c) = (rho * turn / shear, 1.0 + p * p * turn * (1.0 + e / shear), p.powi(4) * e * turn / rho);
    let closed = ((b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)).sqrt() / std::f64::consts::TAU;
    let fine = mesh_refinement::first_bending(32).expect("runs");
    assert!((fine / closed - 1.0).abs() < 1e-3, "{fine} {closed}");
    let errors = [2, 4].map(|n| mesh_refinement::first_bending(n).expect("runs") - fine);
    assert!(errors[0] > 16.0 * errors[1] && errors[1] > 0.0, "{errors:?}");
}

#[test]
fn a_tube_grows() {
    for speed in [250.0, 1000.0] {
        let (ours, closed) =
            (growth_of_a_tube::growth(speed).expect("runs"), growth_of_a_tube::closed_form(speed));
        assert!((ours / closed - 1.0).abs() < 2e-3, "{speed}: {ours} {closed}");
    }
}

/// The penetration is the pressure over the penalty; both beams bend as one of twice their stiffness.
#[test]
fn beams_press_on_each_other() {
    let [(soft, _), (hard, tip)] =
        [1e9, 1e10].map(|penalty| two_beams_in_contact::pressed(penalty).expect("runs"));
    assert!(soft > 3.0 * hard && hard > 0.0, "{soft} {hard}");
    let bending = 20e6 * 0.1_f64.powi(4) / 12.0;
    let closed = 20.0 / (6.0 * bending);
    assert!((tip / closed - 1.0).abs() < 0.02, "{tip} {closed}");
}

/// What a case needs is told with its path, as the command line does.
#[test]
fn refusals_name_the_path() {
    let bare = Rotor::builder("bare").build().expect("a case");
    let text = bare.modes().expect_err("no shaft").to_string();
    assert!(text.contains("shaft.segments") && text.contains("bare"), "{text}");
    let shaft = Rotor::builder("no speeds")
        .material("steel", 210e9, 0.3, 7850.0)
        .circle("a.b", 0.02)
        .segment(1.0, 2, "a.b", "steel");
    let text = shaft.clone().build().expect("a case").campbell().expect_err("no block").to_string();
    assert!(text.contains("at `campbell`"), "{text}");
    assert!(shaft.build().expect("a case").with("shaft.segments.0.radius", 1).is_err());
}
