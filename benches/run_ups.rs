//! Run-ups from model to results, without plots and files: `cargo bench --bench run_ups`. Quote ratios of one run.

use divan::Bencher;
use rotor::analysis::spinup::spinup;
use rotor::case::Case;
use rotor::model::Model;
use serde_json::{Map, Value, json};
use std::path::Path;

fn main() {
    divan::main();
}

fn model(stem: &str, set: Value) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("cases/{stem}.json"));
    let set: Map<String, Value> = set.as_object().cloned().unwrap_or_default();
    let case = Case::load(&path, &[]).and_then(|c| c.with(&set)).expect("a case of the repository");
    Model::new(&case).expect("a valid case")
}

fn run(bencher: Bencher<'_, '_>, model: &Model) {
    let settings = model.spinup.as_ref().expect("a spinup block");
    bencher.bench_local(|| spinup(divan::black_box(model), settings, &|_, _| true).expect("succeeds"));
}

/// The ramp of Table 8, 8 elements, 1 s, as the case sets it.
#[divan::bench(sample_count = 20)]
fn table8_esdirk_rotating(bencher: Bencher<'_, '_>) {
    run(bencher, &model("table8-spin-circle", json!({})));
}

/// The first 2 ms of the same ramp (a 500th of it) by the explicit method in the inertial frame, at a tolerance that
/// keeps the growth to the accuracy of the implicit run.
#[divan::bench(sample_count = 5)]
fn table8_adams_inertial_500th(bencher: Bencher<'_, '_>) {
    let set = json!({ "spinup.integrator": "adams", "spinup.frame": "inertial", "spinup.rtol": 1e-10, "spinup.atol": 1e-10,
                      "spinup.until": 0.002, "spinup.output": 2 });
    run(bencher, &model("table8-spin-circle", set));
}

/// The run-up through a critical speed, 16 elements, 2.5 s, as the case sets it.
#[divan::bench(sample_count = 5)]
fn iftomm_esdirk(bencher: Bencher<'_, '_>) {
    run(bencher, &model("iftomm-runup", json!({})));
}

/// The same with steps of 1 ms.
#[divan::bench(sample_count = 5)]
fn iftomm_generalized_alpha(bencher: Bencher<'_, '_>) {
    run(
        bencher,
        &model("iftomm-runup", json!({ "spinup.integrator": "generalized-alpha", "spinup.step": 1e-3 })),
    );
}

/// The same with 5 Gauss points along an element instead of 7.
#[divan::bench(sample_count = 5)]
fn iftomm_reduced_quadrature(bencher: Bencher<'_, '_>) {
    run(bencher, &model("iftomm-runup", json!({ "shaft.quadrature": "reduced" })));
}
