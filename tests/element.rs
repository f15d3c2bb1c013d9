//! Element matrices: identities, and products computed by an independent numpy model
//! (tests/reference/element.json, see its note; full integration, physical units).

use faer::Mat;
use rotor::element::ElementMatrices;
use rotor::element::basis::{exponents, vector_name};
use rotor::model::{ElementKind, Law, Material};
use rotor::section::Section;
use serde_json::Value;

const KIND_34X3: ElementKind = ElementKind { axial_degree: 3, section_order: 3, law: Law::Continuum };

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

#[test]
fn products_agree_with_the_independent_model() {
    let text = include_str!("reference/element.json");
    let reference: Value = serde_json::from_str(text).expect("JSON");
    let cases = reference["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 4);
    for case in cases {
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
        };
        let r = section.outer_size();
        let matrices = ElementMatrices::new(KIND_34X3, &section, &material, number(&case["length_m"]), r);
        let direction = coordinates(&case["direction"]);
        for (matrix, name) in [
            (&matrices.mass, "mass_times_direction"),
            (&matrices.gyroscopic, "gyroscopic_times_direction"),
            (&matrices.stiffness, "linear_stiffness_times_direction"),
        ] {
            let ours = physical_product(matrix, &direction, r);
            let theirs = coordinates(&case[name]);
            // vectors of one kind share a unit: compare each kind by its own largest value
            for vector in 0..10 {
                let entries = || (0..120).filter(|i| i / 3 % 10 == vector);
                let scale = entries().map(|i| theirs[i].abs()).fold(0.0, f64::max);
                for i in entries() {
                    assert!(
                        (ours[i] - theirs[i]).abs() <= 1e-10 * scale,
                        "{} {name} entry {i}: {} {}",
                        case["section"],
                        ours[i],
                        theirs[i]
                    );
                }
            }
        }
    }
}
