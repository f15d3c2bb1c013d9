//! The consistent form against axisymmetric solids of a St. Venant-Kirchhoff material at the spinning equilibrium (an
//! independent program: quadratic elements, converged to 3e-5, of ovalling to 1.4e-4), at 500 m/s on the surface.

use crate::common::{campbell, shaft};
use rotor::results::Campbell;
use serde_json::{Value, json};

fn check(section: Value, element: &str, more: Value, expected: &[(&str, f64, f64)]) -> Campbell {
    let mut base = json!({ "materials": { "m": { "rho": 7850 } }, "shaft": { "element": element } });
    for (key, value) in more.as_object().expect("an object") {
        base[key] = value.clone();
    }
    let found = campbell(&shaft(section, 2.0, 16, base));
    assert_eq!(found.form, "consistent");
    for (name, exact, rtol) in expected {
        let branch = found.branches.iter().find(|b| b.name == *name).unwrap_or_else(|| panic!("{name}"));
        let ours = branch.frequency_rad_s.last().copied().flatten().expect("a frequency");
        assert!((ours / exact - 1.0).abs() < *rtol, "{name}: {ours} {exact} {:.1e}", ours / exact - 1.0);
    }
    found
}

#[test]
fn bending_of_a_solid_shaft() {
    let more = json!({
        "supports": [{ "at": 0, "kind": "roller" }, { "at": 2, "kind": "roller" }],
        "campbell": { "speeds": { "from": 0, "to": 5000, "count": 3 }, "modes": 8 }
    });
    let circle = json!({ "shape": "circle", "radius": 0.1 });
    let expected =
        [("1B", 602.4983, 3e-5), ("1F", 662.128, 3e-5), ("2B", 2340.1998, 1e-4), ("2F", 2553.1425, 1e-4)];
    check(circle, "34X3", more, &expected);
}

#[test]
#[ignore = "long"]
fn bending_torsion_and_ovalling_of_a_tube() {
    let more = json!({ "campbell": { "speeds": { "from": 0, "to": 2500, "count": 2 }, "modes": 10 } });
    let tube = json!({ "shape": "tube", "outer_radius": 0.2, "inner_radius": 0.15 });
    let expected = [("1B", 2795.0283, 1e-5), ("1F", 3398.6985, 1e-5), ("T1", 5002.563, 1e-5)];
    let found = check(tube, "34R34", more, &expected);
    // ovalling: the lowest pair with two waves
    let last = |b: &rotor::results::Branch| b.frequency_rad_s.last().copied().flatten().unwrap_or(0.0);
    for exact in [4188.6743, 10259.399] {
        assert!(found.branches.iter().any(|b| (last(b) / exact - 1.0).abs() < 5e-4), "{exact}");
    }
}
