//! Extremes of linear analyses: frequencies against closed forms.

use super::cell::{Cell, Measured, cell};
use crate::common::shaft;
use rotor::analysis::modes::modes;
use rotor::case::LoadedCase;
use rotor::model::Model;
use rotor::results::ModeKind;
use serde_json::{Value, json};
use std::f64::consts::PI;

const E: f64 = 2.1e11;
const RHO: f64 = 7800.0;
/// Shear modulus at nu = 0.3.
const G: f64 = E / 2.6;

pub fn circle(radius: f64) -> Value {
    json!({ "shape": "circle", "radius": radius })
}

pub fn tube(outer: f64, inner: f64) -> Value {
    json!({ "shape": "tube", "outer_radius": outer, "inner_radius": inner })
}

pub fn ends(length: f64) -> Value {
    json!([{ "at": 0, "kind": "pinned" }, { "at": length, "kind": "roller" }])
}

/// The lowest frequency (rad/s) of a kind.
pub fn lowest(kind: ModeKind) -> impl Fn(&LoadedCase) -> Measured {
    move |case| {
        let outcome = modes(&Model::new(case)?)?;
        let found = outcome.results.modes.iter().find(|m| m.kind == kind);
        Ok((found.map_or(f64::NAN, |m| m.frequency_rad_s), outcome.diagnostics))
    }
}

/// First bending (rad/s) of a beam on simple supports: the lower root of Timoshenko's equation.
/// `i2` is the radius of gyration squared, `ks` the shear correction.
pub fn timoshenko(length: f64, i2: f64, ks: f64, nu: f64, e: f64, rho: f64) -> f64 {
    let (k, g) = (PI / length, e / (2.0 * (1.0 + nu)));
    let (a, b, c) =
        (rho * i2 / (ks * g) * rho, -(rho + rho * i2 * k * k * (1.0 + e / (ks * g))), e * i2 * k.powi(4));
    (2.0 * c / (-b + (b * b - 4.0 * a * c).sqrt())).sqrt()
}

/// Shear correction of a circle.
pub fn ks(nu: f64) -> f64 {
    6.0 * (1.0 + nu).powi(2) / (7.0 + 12.0 * nu + 4.0 * nu * nu)
}

pub fn slenderness() -> Vec<Cell> {
    let family = "slenderness L/r";
    let mut list = Vec::new();
    for ratio in [2.0, 10.0, 100.0, 1e3, 1e4, 1e5] {
        let r = 1.0 / ratio;
        let more = json!({ "supports": ends(1.0), "modes": { "count": 8 } });
        for n in [1, 16] {
            if n == 1 && ratio < 50.0 {
                continue;
            }
            let case = shaft(circle(r), 1.0, n, more.clone());
            let exact = if ratio < 50.0 {
                let fine =
                    json!({ "supports": ends(1.0), "modes": { "count": 8 }, "shaft": { "element": "34X5" } });
                lowest(ModeKind::Bending)(&shaft(circle(r), 1.0, 24, fine)).expect("fine").0
            } else {
                timoshenko(1.0, r * r / 4.0, ks(0.3), 0.3, E, RHO)
            };
            let against =
                if ratio < 50.0 { "1st bending, 34X5 on 24 elements" } else { "1st bending, Timoshenko" };
            let bound = if n == 1 {
                5e-3
            } else if ratio < 50.0 {
                1e-2
            } else {
                1e-4
            };
            let name = format!("{ratio:.0}, {n} elements");
            list.push(cell(family, name, against, &case, lowest(ModeKind::Bending), -1, (exact, bound)));
        }
    }
    list
}

pub fn walls() -> Vec<Cell> {
    let family = "wall t/r";
    let mut list = Vec::new();
    for wall in [0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let (t, r) = (0.2 * wall, 0.2 * (1.0 - wall / 2.0));
        let a = 0.2 - t;
        for element in ["34R23", "34X3", "34X5"] {
            // slender enough for a beam theory
            let more =
                json!({ "supports": ends(8.0), "modes": { "count": 24 }, "shaft": { "element": element } });
            let case = shaft(tube(0.2, a), 8.0, 8, more);
            let m2 = (a / 0.2f64).powi(2);
            let nu = 0.3f64;
            // Cowper's correction of a tube
            let shear = 6.0 * (1.0 + nu) * (1.0 + m2).powi(2)
                / ((7.0 + 6.0 * nu) * (1.0 + m2).powi(2) + (20.0 + 12.0 * nu) * m2);
            let exact = timoshenko(8.0, (0.04 + a * a) / 4.0, shear, nu, E, RHO);
            let bending = lowest(ModeKind::Bending);
            list.push(cell(
                family,
                format!("{wall:e}, {element}"),
                "1st bending, Timoshenko (Cowper)",
                &case,
                bending,
                -1,
                (exact, 2e-3),
            ));
        }
        let exact = (E / (RHO * 0.91)).sqrt() * t / (r * r) * 0.6f64.sqrt();
        let ring = |element: &str| json!({ "shaft": { "element": element }, "modes": { "count": 10 } });
        if wall < 0.05 {
            for element in ["34R13", "34R23", "34R34", "34X5"] {
                let case = shaft(tube(0.2, a), 2.0, 8, ring(element));
                let section = lowest(ModeKind::Section);
                list.push(cell(
                    family,
                    format!("{wall:e}, {element}"),
                    "ovalling, thin ring in plane strain",
                    &case,
                    section,
                    -1,
                    (exact, 2e-3),
                ));
            }
        }
    }
    list
}

pub fn poisson() -> Vec<Cell> {
    let family = "Poisson's ratio";
    let mut list = Vec::new();
    for nu in [-0.99, -0.5, 0.0, 0.3, 0.45, 0.49, 0.499, 0.4999] {
        for element in ["34X1", "34X2", "34X3", "34X5"] {
            let more = json!({
                "materials": { "m": { "nu": nu } }, "shaft": { "element": element },
                "supports": ends(1.0), "modes": { "count": 8 }
            });
            let case = shaft(circle(0.01), 1.0, if nu < -0.6 { 36 } else { 16 }, more);
            // the shear correction has a pole near -0.8
            let exact = if nu < -0.6 {
                let fine = json!({
                    "materials": { "m": { "nu": nu } }, "shaft": { "element": "34X5" },
                    "supports": ends(1.0), "modes": { "count": 8 }
                });
                lowest(ModeKind::Bending)(&shaft(circle(0.01), 1.0, 72, fine)).expect("fine").0
            } else {
                timoshenko(1.0, 2.5e-5, ks(nu), nu, E, RHO)
            };
            list.push(cell(
                family,
                format!("{nu}, {element}"),
                "1st bending, Timoshenko",
                &case,
                lowest(ModeKind::Bending),
                -1,
                (exact, 2e-3),
            ));
        }
        let more = json!({
            "materials": { "m": { "nu": nu } }, "modes": { "count": 40 }, "shaft": { "element": "34R23" }
        });
        let g = E / (2.0 * (1.0 + nu));
        let case = shaft(tube(0.2, 0.15), 2.0, 4, more);
        list.push(cell(
            family,
            format!("{nu}, 34R23"),
            "1st torsion, exact",
            &case,
            lowest(ModeKind::Torsion),
            -1,
            (PI / 2.0 * (g / RHO).sqrt(), 1e-4),
        ));
    }
    list
}

pub fn units() -> Vec<Cell> {
    let mut list = Vec::new();
    for size in [1e-6, 1e-3, 1.0, 1e3] {
        let more = json!({ "supports": ends(size), "modes": { "count": 8 } });
        let case = shaft(circle(0.02 * size), size, 16, more);
        let exact = timoshenko(size, 1e-4 * size * size, ks(0.3), 0.3, E, RHO);
        list.push(cell(
            "length of the shaft (m)",
            format!("{size:e}"),
            "1st bending, Timoshenko",
            &case,
            lowest(ModeKind::Bending),
            -1,
            (exact, 1e-4),
        ));
    }
    for (e, rho) in [(1e3, 1e-3), (1e3, 1e9), (1e9, 1e3), (1e15, 1e-3), (1e15, 1e9)] {
        let more = json!({ "supports": ends(1.0), "modes": { "count": 8 }, "materials": { "m": { "E": e, "rho": rho } } });
        let case = shaft(circle(0.02), 1.0, 16, more);
        let exact = timoshenko(1.0, 1e-4, ks(0.3), 0.3, e, rho);
        list.push(cell(
            "E (Pa), rho (kg/m^3)",
            format!("{e:e}, {rho:e}"),
            "1st bending, Timoshenko",
            &case,
            lowest(ModeKind::Bending),
            -1,
            (exact, 1e-4),
        ));
    }
    list
}

pub fn meshes() -> Vec<Cell> {
    let mut list = Vec::new();
    for ratio in [1.0, 1e-2, 1e-4] {
        // two long elements with a short one between them
        let short = 0.5 * ratio;
        let segment =
            |length: f64| json!({ "length": length, "elements": 4, "section": "s", "material": "m" });
        let more = json!({
            "shaft": { "segments": [segment(2.0), segment(4.0 * short), segment(2.0)] },
            "modes": { "count": 24 }
        });
        let case = shaft(circle(0.2), 1.0, 1, more);
        let length = 4.0 + 4.0 * short;
        list.push(cell(
            "ratio of element lengths",
            format!("{ratio:e}"),
            "1st torsion, exact",
            &case,
            lowest(ModeKind::Torsion),
            -1,
            (PI / length * (G / RHO).sqrt(), 1e-6),
        ));
        let bending = lowest(ModeKind::Bending);
        let fine = shaft(circle(0.2), length, 24, json!({ "modes": { "count": 8 } }));
        list.push(cell(
            "ratio of element lengths",
            format!("{ratio:e}"),
            "1st bending, 24 even elements",
            &case,
            bending,
            -1,
            (lowest(ModeKind::Bending)(&fine).expect("fine").0, 1e-4),
        ));
    }
    for n in [1, 2, 8, 64, 512] {
        let more = json!({ "shaft": { "element": "34X1" }, "modes": { "count": 16 } });
        let case = shaft(circle(0.2), 2.0, n, more);
        let bound =
            [1e-3, 1e-4, 1e-6, 1e-6, 1e-6][[1, 2, 8, 64, 512].iter().position(|k| *k == n).unwrap_or(0)];
        list.push(cell(
            "number of elements",
            format!("{n}, 34X1"),
            "1st torsion, exact",
            &case,
            lowest(ModeKind::Torsion),
            -1,
            (PI / 2.0 * (G / RHO).sqrt(), bound),
        ));
    }
    for element in [
        "34X1", "34X2", "34X3", "34X4", "34X5", "34R12", "34R13", "34R23", "34R33", "34R34", "34R44",
        "34R66", "34R69",
    ] {
        let more = json!({ "shaft": { "element": element }, "modes": { "count": 30 } });
        let case = shaft(tube(0.2, 0.15), 2.0, 2, more);
        list.push(cell(
            "member",
            element,
            "1st torsion of a tube, exact",
            &case,
            lowest(ModeKind::Torsion),
            -1,
            (PI / 2.0 * (G / RHO).sqrt(), 1e-4),
        ));
    }
    list
}

/// Symmetric mode of a slender beam on end springs: E I b^3 (tan b a + tanh b a) = 2 k, a half its length.
pub fn on_springs(k: f64, length: f64, r: f64) -> f64 {
    let (a, i, area) = (length / 2.0, PI * r.powi(4) / 4.0, PI * r * r);
    let (mut low, mut high) = (0.0, PI / 2.0);
    for _ in 0..200 {
        let b = (low + high) / 2.0;
        if E * i * (b / a).powi(3) * (b.tan() + b.tanh()) > 2.0 * k { high = b } else { low = b }
    }
    (low / a).powi(2) * (E * i / (RHO * area)).sqrt()
}

pub fn bearings() -> Vec<Cell> {
    let r = 0.005;
    (0..=8)
        .map(|p| {
            let k = 10f64.powi(2 * p);
            let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[k, 0], [0, k]] });
            let more = json!({ "supports": [bearing(0.0), bearing(1.0)], "modes": { "count": 10 } });
            let case = shaft(circle(r), 1.0, 16, more);
            let exact = on_springs(k, 1.0, r);
            cell(
                "bearings (N/m)",
                format!("{k:e}"),
                "1st bending, Euler-Bernoulli on springs",
                &case,
                lowest(ModeKind::Bending),
                -1,
                (exact, 2e-4),
            )
        })
        .collect()
}
