//! Speed of the pipeline's stages on the 6 m rotor: `cargo bench`. Quote ratios of one run.

use divan::{Bencher, black_box};
use rotor::analysis::campbell::campbell;
use rotor::analysis::campbell::operators::Operators;
use rotor::analysis::campbell::reduced_basis::Reduced;
use rotor::case::{Case, LoadedCase};
use rotor::element::ElementMatrices;
use rotor::model::{ElementKind, Gyroscopic, Law, Model, WhirlFrame};
use rotor::section::basis::SectionBasis;
use rotor::shaft::assembly::Assembly;
use rotor::shaft::spectrum::Spectrum;
use serde_json::{Map, json};
use std::path::Path;

fn main() {
    divan::main();
}

fn model(elements: usize) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/bauchau.json");
    let set: Map<String, serde_json::Value> =
        [("shaft.segments.0.elements".to_owned(), json!(elements))].into_iter().collect();
    let case: LoadedCase =
        Case::load(&path, &[]).and_then(|c| c.with(&set)).expect("the case of the repository");
    Model::new(&case).expect("a valid case")
}

/// M, G, N, K0 of one element.
#[divan::bench(args = [1, 2, 3, 4, 5])]
fn element_matrices(bencher: Bencher, order: usize) {
    let model = model(4);
    let kind = ElementKind { axial_degree: 3, basis: SectionBasis::Monomials(order), law: Law::Continuum };
    bencher.bench(|| {
        ElementMatrices::new(kind, &model.sections[0], &model.materials[0], black_box(0.375), 0.05)
    });
}

#[divan::bench(args = [16, 64, 256])]
fn assemble_stiffness(bencher: Bencher, elements: usize) {
    let model = model(elements);
    let assembly = Assembly::new(&model);
    bencher.bench(|| assembly.stiffness());
}

/// 36 modes with the Sturm count.
#[divan::bench(args = [16, 64, 256, 512], sample_count = 5)]
fn natural_modes(bencher: Bencher, elements: usize) {
    let model = model(elements);
    let assembly = Assembly::new(&model);
    bencher.bench(|| Spectrum::new(&assembly, 36).expect("converges"));
}

/// One spin speed on a basis of this size.
#[divan::bench(args = [30, 60, 120])]
fn one_speed(bencher: Bencher, basis: usize) {
    let model = model(16);
    let assembly = Assembly::new(&model);
    let spectrum = Spectrum::new(&assembly, basis * 6 / 10).expect("converges");
    let operators = Operators::new(&assembly, &spectrum, WhirlFrame::Stationary, Gyroscopic::All, None);
    let reduced = Reduced::new(&operators, &spectrum, basis * 6 / 10, basis * 4 / 10).expect("converges");
    bencher.bench(|| reduced.solve(black_box(500.0)).expect("converges"));
}

/// 101 speeds, 12 branches, critical speeds, checks.
#[divan::bench(args = [16, 64, 512], sample_count = 3)]
fn campbell_diagram(bencher: Bencher, elements: usize) {
    let model = model(elements);
    let settings = model.campbell.clone().expect("a campbell block");
    bencher.bench(|| campbell(&model, &settings, &|_| ()).expect("converges"));
}
