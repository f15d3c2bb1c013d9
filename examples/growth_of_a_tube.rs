//! How far a hollow shaft grows radially at speed, against the closed form of a long turning tube.

use rotor::Rotor;
use serde_json::json;

const E: f64 = 210e9;
const NU: f64 = 0.3;
const RHO: f64 = 7850.0;
const OUTER: f64 = 0.10;
const BORE: f64 = 0.06;

/// Growth of the rim at mid-length in the steady state at a speed (rad/s), m.
pub fn growth(speed: f64) -> rotor::Result<f64> {
    let tube = Rotor::builder("a long tube that turns")
        .material("steel", E, NU, RHO)
        .tube("wall", OUTER, BORE)
        .segment(1.0, 8, "wall", "steel")
        .support(0.0, "revolute")
        .support(1.0, "cylindrical")
        .set("spinup", json!({ "drive": [{ "until": 1.0, "speed": speed }], "until": 1.0, "steady": true }))
        .build()?;
    Ok(tube.spinup()?.results.last.growth_m[0])
}

/// Growth of the rim of a long tube with free ends, `rho w^2 b ((3 + nu) a^2 + (1 - nu) b^2) / (4 E)`, m.
pub fn closed_form(speed: f64) -> f64 {
    RHO * speed * speed * OUTER * ((3.0 + NU) * BORE * BORE + (1.0 - NU) * OUTER * OUTER) / (4.0 * E)
}

fn main() -> rotor::Result<()> {
    for speed in [250.0, 500.0, 1000.0, 2000.0] {
        println!("{speed:6.0} rad/s: {:.5e} m, closed form {:.5e} m", growth(speed)?, closed_form(speed));
    }
    Ok(())
}
