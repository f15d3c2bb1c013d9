//! Penalty against complementarity on the scenes of the repository, in one run: time, steps, energy and penetration, as the
//! tables of docs/contact.md. Each run three times, the shortest time counts.
//!
//! `cargo bench --bench contact_methods`

use rotor::analysis::contact::contact;
use rotor::case::{Case, LoadedCase};
use rotor::model::scene::Scene;
use rotor::results::Contact;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

const REPEATS: usize = 3;

fn load(stem: &str, set: Value) -> Result<LoadedCase, rotor::error::Error> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("cases/{stem}.json"));
    Case::load(&path, &[])?.with(set.as_object().expect("overrides"))
}

/// The results and the shortest time, s.
fn measure(stem: &str, set: Value) -> Result<(Contact, f64), rotor::error::Error> {
    let scene = Scene::new(&load(stem, set)?)?;
    let timed = || {
        let start = Instant::now();
        contact(&scene, &|_, _| true).map(|outcome| (outcome.results, start.elapsed().as_secs_f64()))
    };
    let (results, mut least) = timed()?;
    for _ in 1..REPEATS {
        least = least.min(timed()?.1);
    }
    Ok((results, least))
}

fn row(stem: &str, until: f64, step: f64, method: &str, integrator: &str) {
    let set = json!({
        "contact.until": until, "contact.step": step, "contact.method": method, "contact.integrator": integrator
    });
    let named = format!("| {stem} | {method} | {integrator} | {step:.1e} |");
    match measure(stem, set) {
        Err(error) => println!("{named} {} |", error.to_string().lines().next().unwrap_or_default()),
        Ok((r, _)) if !r.converged => println!("{named} ended at {:.4} s |", r.time_s.unwrap_or(0.0)),
        Ok((r, seconds)) => println!(
            "{named} {} | {} | {seconds:.2} | {:.1e} | {:+.1e} | {:.1e} | {} |",
            r.solver.steps,
            r.solver.cut,
            r.energy_error.unwrap_or(f64::NAN),
            r.energy_change.unwrap_or(f64::NAN),
            r.largest_penetration_m,
            r.events.first().map_or("-".to_owned(), |e| format!("{:.4}", e.time_s)),
        ),
    }
}

const HEAD: &str = "| scene | method | integrator | step (s) | steps | cut | time (s) | largest energy error | at the end | largest penetration (m) | first contact (s) |
|---|---|---|---|---|---|---|---|---|---|---|";

fn main() {
    // `cargo test --benches` runs benches too
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("{HEAD}");
    let scenes = [
        ("side-to-side", 0.3, [1e-4, 1e-4]),
        ("corner-to-side", 0.1, [1e-4, 1e-4]),
        ("pendulums", 0.8, [1e-4, 1e-4]),
        ("flying-spaghetti", 3.2, [1e-3, 2e-4]),
    ];
    for (stem, until, [consistent, explicit]) in scenes {
        row(stem, until, consistent, "penalty", "energy-consistent");
        row(stem, until, explicit, "penalty", "semi-implicit-euler");
        row(stem, until, explicit, "lcp", "semi-implicit-euler");
        row(stem, until, explicit, "lcp-single", "semi-implicit-euler");
    }
    println!("\n{HEAD}");
    for (stem, until) in [("side-to-side", 0.25), ("pendulums", 0.56)] {
        for step in [2e-4, 1e-4, 5e-5, 2.5e-5] {
            row(stem, until, step, "penalty", "energy-consistent");
            row(stem, until, step, "lcp", "semi-implicit-euler");
        }
    }
}
