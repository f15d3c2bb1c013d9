//! A cantilever that is pressed on another one below it: how the penetration depends on the penalty.

use rotor::Rotor;
use serde_json::{Value, json};

/// The scene with a penalty, N/m^3.
fn scene(penalty: f64) -> Value {
    let beam = |name: &str, height: f64, load: Value| {
        json!({
            "name": name, "length": 1, "elements": 8, "section": "bar", "material": "soft", "start": [0, height],
            "supports": [{ "at": 0, "kind": "clamped" }], "loads": load
        })
    };
    json!({
        "title": "two cantilevers",
        "materials": { "soft": { "E": "20 MPa", "nu": 0, "rho": 1000 } },
        "sections": { "bar": { "shape": "rectangle", "height": "10 cm", "width": "10 cm" } },
        "bodies": [beam("lower", 0.0, json!([])), beam("upper", 0.1, json!([{ "at": 1, "force": [0, -20] }]))],
        "contact": { "method": "penalty", "penalty": penalty }
    })
}

/// Largest penetration (m), and how far the tip of the upper beam goes down (m).
pub fn pressed(penalty: f64) -> rotor::Result<(f64, f64)> {
    let found = Rotor::from_json("two cantilevers", scene(penalty))?.contact()?.results;
    let tip = found.bodies.last().map_or(f64::NAN, |upper| -upper.end_displacement_m[1]);
    Ok((found.largest_penetration_m, tip))
}

fn main() -> rotor::Result<()> {
    for penalty in [1e8, 1e9, 1e10] {
        let (penetration, tip) = pressed(penalty)?;
        println!("{penalty:.0e} N/m^3: penetration {penetration:.2e} m, tip down by {tip:.6} m");
    }
    Ok(())
}
