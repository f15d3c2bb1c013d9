//! Contact of many beams: cost over the number of elements, and what contact costs where nothing is near.
//!
//! `cargo bench --bench contact`

use divan::Bencher;
use rotor::analysis::contact::contact;
use rotor::case::LoadedCase;
use rotor::model::scene::Scene;
use serde_json::{Value, json};

fn main() {
    divan::main();
}

/// Rows of short beams of five elements; the first runs into the second, the others rest.
fn rows(elements: usize, method: &str, speed: f64) -> Scene {
    let body = |k: usize| {
        let x = match k {
            0 => 0.0,
            1 if speed > 0.0 => 1.002,
            _ => (k % 20) as f64 * 1.3,
        };
        json!({
            "name": format!("beam {k}"), "length": 1, "elements": 5, "section": "square", "material": "soft",
            "start": [x, -((k / 20) as f64) * 0.5], "velocity": [if k == 0 { speed } else { 0.0 }, 0]
        })
    };
    let bodies: Vec<Value> = (0..elements / 5).map(body).collect();
    let case = json!({
        "title": "rows",
        "materials": { "soft": { "E": 2.07e7, "nu": 0, "rho": 7850 } },
        "sections": { "square": { "shape": "rectangle", "height": 0.1, "width": 0.1 } },
        "bodies": bodies,
        "contact": { "method": method, "penalty": 4e9, "until": 0.005, "step": 2.5e-5, "output": 2, "snapshots": 1 }
    });
    LoadedCase::from_value("rows.json", case).and_then(|loaded| Scene::new(&loaded)).expect("a scene")
}

fn run(bencher: Bencher<'_, '_>, scene: &Scene) {
    bencher.bench_local(|| contact(scene, &|_, _| true).expect("runs").results.solver.steps);
}

/// One pair of beams in contact, all others near one another but apart.
#[divan::bench(args = [10, 100, 1000], sample_count = 5)]
fn few_contacts(bencher: Bencher<'_, '_>, elements: usize) {
    run(bencher, &rows(elements, "penalty", 1.0));
}

/// All 0.3 m apart, one moving away: with contact.
#[divan::bench(args = [10, 100, 1000], sample_count = 15)]
fn nothing_near_with_contact(bencher: Bencher<'_, '_>, elements: usize) {
    run(bencher, &rows(elements, "penalty", -1.0));
}

/// And with contact switched off.
#[divan::bench(args = [10, 100, 1000], sample_count = 15)]
fn nothing_near_without_contact(bencher: Bencher<'_, '_>, elements: usize) {
    run(bencher, &rows(elements, "none", -1.0));
}
