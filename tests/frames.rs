//! The two frames and forms of the spinning shaft: reference values, equivalence, instability.

mod common;

use common::{campbell, model, shaft, with};
use rotor::case::LoadedCase;
use rotor::results::{Campbell, ModeKind, Whirl};
use serde_json::{Value, json};

const SPEED: f64 = 2356.194;

fn circle(radius: f64) -> Value {
    json!({ "shape": "circle", "radius": radius })
}

/// Sweep with few speeds in a frame and form.
fn sweep(speeds: Value, modes: usize, frame: &str, form: &str, reduction: Value) -> Value {
    json!({ "speeds": speeds, "modes": modes, "frame": frame, "form": form, "reduction": reduction })
}

fn close(a: f64, b: f64, rtol: f64) {
    assert!((a / b - 1.0).abs() <= rtol, "{a} instead of {b}: {:.2e}", a / b - 1.0);
}

/// Frequencies at the last speed, ascending, rad/s.
fn at_last(found: &Campbell) -> Vec<f64> {
    let mut list: Vec<f64> =
        found.branches.iter().filter_map(|b| *b.frequency_rad_s.last().expect("speeds")).collect();
    list.sort_by(f64::total_cmp);
    list
}

/// Shaft of the reference: circle 0.1 m, length 2 m, all vectors fixed, one end axially free.
fn plain(campbell: Value) -> LoadedCase {
    let all_but_axial: Vec<String> = ["r", "y", "z", "yz", "yy", "zz", "yyz", "yzz", "yyy", "zzz"]
        .iter()
        .flat_map(|v| ["x", "y", "z"].map(|c| format!("{v}.{c}")))
        .filter(|name| name != "r.x")
        .collect();
    shaft(
        circle(0.1),
        2.0,
        4,
        json!({
            "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7850 } },
            "supports": [{ "at": 0, "fix": ["all"] }, { "at": 2, "fix": all_but_axial }],
            "campbell": campbell
        }),
    )
}

#[test]
fn probe() {
    for (frame, form) in [("stationary", "classical"), ("stationary", "consistent"), ("rotating", "consistent")] {
        for reduction in [json!("none"), json!(60)] {
            let t = std::time::Instant::now();
            let found = campbell(&plain(sweep(
                json!({ "from": SPEED, "to": SPEED, "count": 1 }), 10, frame, form, reduction)));
            println!("{frame} {form} {:?}", t.elapsed());
            println!("{:?}", at_last(&found));
            println!("{:?}", found.critical_speeds.iter().map(|c| (c.speed_rad_s, &c.branch, c.whirl, c.crossing_difference)).collect::<Vec<_>>());
            println!("{:?} {:?}", found.reduction, found.unstable_ranges);
        }
    }
}
