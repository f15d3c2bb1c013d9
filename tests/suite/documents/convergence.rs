//! Which members lock and where, and how fast meshes converge: docs/convergence.md.

use crate::common::{draw, keep, of_kind, shaft};
use crate::documents::convergence_figure::{Curve, Panel, svg};
use rotor::accuracy::locking_and_rounding::bending_excess;
use rotor::accuracy::radial_growth::basis_error;
use rotor::accuracy::thin_wall::ovalling_error;
use rotor::model::Material;
use rotor::results::ModeKind;
use rotor::section::Section;
use rotor::section::basis::SectionBasis;
use serde_json::{Value, json};
use std::f64::consts::PI;

const MEMBERS: [&str; 5] = ["34X1", "34X2", "34X3", "34X4", "34X5"];
const MESHES: [usize; 6] = [1, 2, 4, 8, 16, 32];
const STEEL: Material = Material {
    youngs_modulus: 2.1e11,
    poisson_ratio: 0.3,
    density: 7800.0,
    stiffness_damping: 0.0,
    mass_damping: 0.0,
    loss_factor: 0.0,
};

/// Relative errors of the lowest frequency of a kind over [`MESHES`], and the steepest rate between two of them.
fn errors(element: &str, kind: ModeKind, radius: f64, more: Value, exact: f64) -> (Vec<f64>, f64) {
    let error = |n: usize| {
        let mut more = more.clone();
        more["shaft"] = json!({ "element": element });
        of_kind(&shaft(json!({ "shape": "circle", "radius": radius }), 1.0, n, more), kind)[0] / exact - 1.0
    };
    let list: Vec<f64> = MESHES.iter().map(|&n| error(n)).collect();
    let rates = list.windows(2).filter(|e| e[1].abs() > 1e-10).map(|e| (e[0] / e[1]).abs().log2());
    let rate = rates.fold(0.0, f64::max);
    (list, rate)
}

fn row(name: &str, list: &[f64], last: String) -> String {
    let numbers: Vec<String> = list.iter().map(|e| format!("{:.1e}", e.abs())).collect();
    format!("| {name} | {} | {last} |\n", numbers.join(" | "))
}

#[test]
#[ignore = "long"]
fn members_lock_where_the_document_says_and_converge_elsewhere() {
    let mut text = "# Convergence and locking\n
This page says which members lock and how fast meshes converge. It is made by
`ROTOR_WRITE_DOCS=1 cargo test --release --test suite convergence:: -- --include-ignored`. The long tests compare it with a fresh one.\n
**What locks.** 34X1 locks in bending wherever Poisson's ratio is not 0. It does so on every mesh, because its section can't contract.
It does not lock in torsion. No other member locks in bending of solids.\n
On thin walls polynomials of every order make ovalling too high, at every thinness and on every mesh. Rings with degree 1 are 10 % too
high. Rings with degree 2 or more do not lock. `rotor check` warns of each.\n
All numbers of the tables are relative errors.\n
![Errors of bending and torsion over the number of elements](figures/convergence-mesh.svg)\n
![Errors of growth and ovalling of walls](figures/convergence-walls.svg)\n
## Bending, slender round shaft on pins (L/r 100, nu .3), error by number of elements\n
| member | 1 | 2 | 4 | 8 | 16 | 32 | steepest rate |\n|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    let [mut bending, mut torsion, mut growth, mut ovalling] = [const { Vec::<Curve>::new() }; 4];
    let ends = json!([{ "at": 0, "kind": "pinned" }, { "at": 1, "kind": "roller" }]);
    let (wave, r, ks) = (PI, 0.01_f64, 6.0 * 1.69 / (7.0 + 3.6 + 0.36));
    // Timoshenko's equation, lower root
    let (b, c) = (1.0 + (wave * r / 2.0).powi(2) * (1.0 + 2.6 / ks), (wave * wave * r / 2.0).powi(2));
    let a = (r / 2.0).powi(2) * 2.6 / ks;
    let exact = (2.0 * c / (b + (b * b - 4.0 * a * c).sqrt()) * 2.1e11 / 7800.0).sqrt();
    for member in MEMBERS {
        let more = json!({ "supports": ends, "modes": { "count": 8 } });
        let (list, rate) = errors(member, ModeKind::Bending, r, more, exact);
        text += &row(member, &list, format!("{rate:.1}"));
        bending.push((member.to_owned(), list.clone()));
        if member == "34X1" {
            assert!(list.iter().all(|e| *e > 0.15), "{list:?}");
        } else {
            assert!(list[4].abs() < 1e-4 && rate > 3.5, "{member}: {list:?} {rate}");
        }
    }
    text += "\n## Torsion, free round shaft (L/r 10, nu .3)\n
| member | 1 | 2 | 4 | 8 | 16 | 32 | steepest rate |\n|---|---|---|---|---|---|---|---|\n";
    for member in MEMBERS {
        let exact = PI * (2.1e11 / 2.6 / 7800.0f64).sqrt();
        let (list, rate) = errors(member, ModeKind::Torsion, 0.1, json!({ "modes": { "count": 16 } }), exact);
        text += &row(member, &list, format!("{rate:.1}"));
        torsion.push((member.to_owned(), list.clone()));
        assert!(list[3].abs() < 1e-7 && (5.5..6.8).contains(&rate), "{member}: {list:?} {rate}");
    }
    text += "\n## Radial growth at the rim of a long spinning body, error by bore / rim (section alone; no mesh changes it)\n
| member | 0 | 0.25 | 0.5 | 0.75 | 0.9 | 0.99 | least |\n|---|---|---|---|---|---|---|---|\n";
    let ring = |degree, harmonics| SectionBasis::Ring { degree, harmonics };
    let bases = (1..=5).map(SectionBasis::Monomials).chain([ring(1, 3), ring(2, 3), ring(3, 3), ring(4, 3)]);
    let least = |list: &[f64]| format!("{:.1e}", list.iter().fold(f64::INFINITY, |m, e| m.min(e.abs())));
    for basis in bases.clone() {
        let share = |k: f64| match basis.is_ring() && k == 0.0 {
            true => f64::NAN,
            false => basis_error(&Section::tube(1.0, k), &STEEL, basis, 1.0).expect("a tube"),
        };
        let list = [0.0, 0.25, 0.5, 0.75, 0.9, 0.99].map(share);
        text += &row(&basis.member(), &list, least(&list)).replace("NaN", "-");
        growth.push((basis.member(), list[1..].to_vec()));
        if let SectionBasis::Ring { degree, .. } = basis {
            assert!(list[3].abs() < 0.2 * 0.06f64.powi(degree as i32), "{basis:?} {list:?}");
        } else if basis.count() >= 10 {
            assert!(list[0].abs() < 1e-9 && list[2].abs() > 0.1, "{basis:?} {list:?}");
        }
    }
    text += "\n## Thin walls: ovalling too high by, against wall / radius\n
| member | 0.5 | 0.1 | 0.05 | 0.02 | 0.01 | 0.005 | least |\n|---|---|---|---|---|---|---|---|\n";
    for basis in bases.filter(|b| b.count() > 3) {
        let list = [0.5, 0.1, 0.05, 0.02, 0.01, 0.005]
            .map(|t| ovalling_error(&Section::tube(1.0, 1.0 - t), &STEEL, basis).expect("a tube"));
        text += &row(&basis.member(), &list, least(&list));
        ovalling.push((basis.member(), list.to_vec()));
        match basis {
            SectionBasis::Ring { degree: 2.., .. } => assert!(list[4] < 2e-3, "{basis:?} {list:?}"),
            SectionBasis::Ring { .. } => assert!((0.05..0.15).contains(&list[4]), "{basis:?} {list:?}"),
            _ => assert!(list[4] > 0.2, "{basis:?} {list:?}"),
        }
        let excess = bending_excess(&Section::tube(1.0, 0.9), &STEEL, basis).expect("a tube");
        assert!(excess < 0.02, "{basis:?} {excess}");
    }
    keep("docs/convergence.md", &text);
    let meshes = || MESHES.map(|n| n as f64).to_vec();
    let panel = |title, across, places, curves, slope| Panel {
        title,
        across,
        places,
        curves,
        range: [-12.0, 3.0],
        slope,
    };
    let figure = svg(
        "Convergence with the mesh: orders 1 to 5",
        &[
            panel("bending, L/r 100", "elements", meshes(), bending, Some((4.0, "slope 4"))),
            panel("torsion, L/r 10", "elements", meshes(), torsion, Some((6.0, "slope 6"))),
        ],
    );
    draw("docs/figures/convergence-mesh.svg", &figure);
    let walls = |list: [f64; 5]| list.to_vec();
    let thin = ovalling.into_iter().map(|(name, list)| (name, list.into_iter().rev().collect())).collect();
    let figure = svg(
        "Walls: what the functions over a section miss, on any mesh",
        &[
            panel("growth of the rim", "bore / rim", walls([0.25, 0.5, 0.75, 0.9, 0.99]), growth, None),
            panel("ovalling", "wall / rim", vec![0.005, 0.01, 0.02, 0.05, 0.1, 0.5], thin, None),
        ],
    );
    draw("docs/figures/convergence-walls.svg", &figure);
}
