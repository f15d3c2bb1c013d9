//! Element matrices: identities, and products computed by an independent numpy model
//! (tests/reference/element.json, see its note; full integration, physical units).

use faer::Mat;
use rotor::element::ElementMatrices;
use rotor::element::Kernel;
use rotor::element::basis::{exponents, vector_name};
use rotor::element::kernel::simd::Scratch;
use rotor::element::polynomial::NonlinearElement;
use rotor::model::{ElementKind, Law, Material, Quadrature};
use rotor::section::Section;
use rotor::section::basis::SectionBasis;
use serde_json::Value;

const KIND_34X3: ElementKind =
    ElementKind { axial_degree: 3, basis: SectionBasis::Monomials(3), law: Law::Continuum };

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Rows of the reference file in the order of the element's coordinates.
fn coordinates(rows: &Value) -> Vec<f64> {
    let names: Vec<_> = exponents(3).into_iter().map(vector_name).collect();
    let mut result = vec![f64::NAN; 120];
    for row in rows.as_array().expect("rows") {
        let node = row["node"].as_u64().expect("node") as usize - 1;
        let vector =
            names.iter().position(|n| n == row["derivative"].as_str().expect("name")).expect("known");
        for c in 0..3 {
            result[(node * 10 + vector) * 3 + c] = number(&row["value"][c]);
        }
    }
    assert!(result.iter().all(|x| x.is_finite()));
    result
}

/// `D A D x` with D = diag(R^k): the physical product of a matrix in scaled coordinates.
fn physical_product(matrix: &Mat<f64>, x: &[f64], r: f64) -> Vec<f64> {
    let degree: Vec<i32> = exponents(3).iter().map(|&(a, b)| (a + b) as i32).collect();
    let scale = |i: usize| r.powi(degree[i / 3 % 10]);
    (0..x.len())
        .map(|i| scale(i) * (0..x.len()).map(|j| matrix[(i, j)] * scale(j) * x[j]).sum::<f64>())
        .collect()
}

/// Section, material, length and coordinates of the cases of the reference file.
struct Reference {
    case: Value,
    section: Section,
    material: Material,
    length: f64,
}

fn references() -> Vec<Reference> {
    let text = include_str!("../reference/element.json");
    let reference: Value = serde_json::from_str(text).expect("JSON");
    let cases = reference["cases"].as_array().expect("cases").clone();
    assert_eq!(cases.len(), 4);
    cases.into_iter().map(reference_case).collect()
}

fn reference_case(case: Value) -> Reference {
    let d: Vec<f64> = case["dimensions"].as_array().expect("list").iter().map(number).collect();
    let section = match case["section"].as_str().expect("name") {
        "circle" => Section::circle(d[0]),
        "tube" => Section::tube(d[0], d[1]),
        "ellipse" => Section::ellipse(d[0], d[1]),
        _ => Section::rectangle(d[0], d[1]),
    };
    let material = Material {
        youngs_modulus: number(&case["E"]),
        poisson_ratio: number(&case["nu"]),
        density: number(&case["rho"]),
        stiffness_damping: 0.0,
        mass_damping: 0.0,
        loss_factor: 0.0,
    };
    let length = number(&case["length_m"]);
    Reference { case, section, material, length }
}

#[test]
fn products_agree_with_the_independent_model() {
    for Reference { case, section, material, length } in references() {
        let r = section.outer_size();
        let matrices = ElementMatrices::new(KIND_34X3, &section, &material, length, r);
        let direction = coordinates(&case["direction"]);
        for (matrix, name) in [
            (&matrices.mass, "mass_times_direction"),
            (&matrices.gyroscopic, "gyroscopic_times_direction"),
            (&matrices.stiffness, "linear_stiffness_times_direction"),
        ] {
            let ours = physical_product(matrix, &direction, r);
            let theirs = coordinates(&case[name]);
            agree(&ours, &theirs, 1e-10, &format!("{} {name}", case["section"]));
        }
    }
}

/// Vectors of one kind share a unit: compares each kind by its own largest value.
fn agree(ours: &[f64], theirs: &[f64], tolerance: f64, what: &str) {
    for vector in 0..10 {
        let entries = || (0..120).filter(|i| i / 3 % 10 == vector);
        let scale = entries().map(|i| theirs[i].abs()).fold(0.0, f64::max);
        for i in entries() {
            let difference = (ours[i] - theirs[i]).abs();
            assert!(difference <= tolerance * scale, "{what} entry {i}: {} {}", ours[i], theirs[i]);
        }
    }
}

#[test]
fn nonlinear_forces_agree_with_the_independent_model() {
    for Reference { case, section, material, length } in references() {
        let r = section.outer_size();
        let element = NonlinearElement::new(KIND_34X3, &section, &material, length, r, Quadrature::EXACT);
        let degree: Vec<i32> = exponents(3).iter().map(|&(a, b)| (a + b) as i32).collect();
        let scale = |i: usize| r.powi(degree[i / 3 % 10]);
        let scaled = |x: &[f64]| -> Vec<f64> { x.iter().enumerate().map(|(i, v)| v * scale(i)).collect() };
        let q = scaled(&coordinates(&case["coordinates"]));
        let mut scratch = Scratch::default();
        let mut force = vec![0.0; 120];
        let energy = element.internal_force(&q, None, &mut force, &mut scratch);
        let theirs = number(&case["energy_J"]);
        assert!((energy / theirs - 1.0).abs() < 1e-10, "{}: {energy} {theirs}", case["section"]);
        let what = format!("{} force", case["section"]);
        agree(&scaled(&force), &coordinates(&case["internal_force"]), 1e-10, &what);

        let direction = coordinates(&case["direction"]);
        let mut tangent = vec![0.0; 120 * 120];
        element.tangent(&q, &mut tangent, &mut scratch);
        let matrix = Mat::from_fn(120, 120, |i, j| tangent[j * 120 + i]);
        let ours = physical_product(&matrix, &direction, r);
        let what = format!("{} tangent", case["section"]);
        agree(&ours, &coordinates(&case["tangent_times_direction"]), 1e-10, &what);
    }
}
