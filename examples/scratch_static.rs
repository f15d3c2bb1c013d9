use rotor::analysis::equilibrium::*;
use rotor::assembly::Assembly;
use rotor::case::LoadedCase;
use rotor::model::*;
use serde_json::json;
fn model(
    section: serde_json::Value,
    ne: u32,
    e: f64,
    nu: f64,
    rho: f64,
    supports: serde_json::Value,
) -> Model {
    let v = json!({"title":"t","materials":{"m":{"E":e,"nu":nu,"rho":rho}},"sections":{"s":section},
      "shaft":{"segments":[{"length":2,"elements":ne,"section":"s","material":"m"}]},"supports":supports});
    Model::new(&LoadedCase::from_value("t", v).unwrap()).unwrap()
}
fn at(b: &Balance, z: &[f64], x: f64, y: f64, zz: f64) -> [f64; 3] {
    let q = b.coordinates(z);
    let m = b.assembly.model;
    let e = m.elements.iter().find(|e| x <= e.x + e.length + 1e-12).unwrap();
    let xi = 2.0 * (x - e.x) / e.length - 1.0;
    let ls = rotor::element::basis::lagrange(3);
    let mut r = [0.0; 3];
    for i in 0..4 {
        let l = rotor::element::basis::evaluate(&ls[i], xi);
        for (k, (a, bb)) in rotor::vectors::exponents(3).into_iter().enumerate() {
            let f: f64 = (1..=a).chain(1..=bb).map(|i| i as f64).product();
            let w =
                l * (y / m.reference_length).powi(a as i32) * (zz / m.reference_length).powi(bb as i32) / f;
            for c in 0..3 {
                r[c] += w * q[b.assembly.numbering.index(e.first_node + i, k, c)];
            }
        }
    }
    [r[0] - x, r[1] - y, r[2] - zz]
}
const S: NewtonSettings = NewtonSettings { load_steps: 1, max_iterations: 40, tolerance: 1e-20 };
fn main() {
    let clamp = json!([{"at":0,"fix":["all"]}]);
    for (quad, what) in
        [(Quadrature::EXACT, "exact"), (Quadrature { axial: Some(4), section: Some(4) }, "4x4x4")]
    {
        for f in [62.5e6, 125e6] {
            for ne in [1, 2, 4, 8] {
                let mut m = model(
                    json!({"shape":"rectangle","height":0.5,"width":0.5}),
                    ne,
                    2.07e11,
                    0.3,
                    7850.0,
                    clamp.clone(),
                );
                m.quadrature = quad;
                m.loads.push(Load {
                    node: m.nodes.len() - 1,
                    kind: LoadKind::Force([0.0, -f, 0.0]),
                    acts_on: ActsOn::Axis,
                });
                let a = Assembly::new(&m);
                let b = Balance::new(&a, true, 0.0).unwrap();
                let s = b.solve(S, None).unwrap();
                let u = at(&b, &s.z, 2.0, 0.0, 0.0);
                println!(
                    "{what} {f:e} {ne}: {:.8} {:.8}  lf {} it {} res {:e}",
                    u[0], u[1], s.load_factor, s.iterations, s.residual
                );
            }
        }
    }
    for ne in [1, 2, 4, 8] {
        let mut m = model(json!({"shape":"circle","radius":0.25}), ne, 2.07e11, 0.3, 7850.0, clamp.clone());
        m.loads.push(Load {
            node: m.nodes.len() - 1,
            kind: LoadKind::Force([0.0, -1.875e8, 0.0]),
            acts_on: ActsOn::Axis,
        });
        let a = Assembly::new(&m);
        let b = Balance::new(&a, true, 0.0).unwrap();
        let s = b.solve(S, None).unwrap();
        let u = at(&b, &s.z, 2.0, 0.0, 0.0);
        println!(
            "table5 {ne}: {:.8} {:.8}  lf {} it {} res {:e}",
            u[0], u[1], s.load_factor, s.iterations, s.residual
        );
    }
    for ne in [2, 8] {
        let mut m = model(
            json!({"shape":"rectangle","height":0.5,"width":0.5}),
            ne,
            2.07e11,
            0.3,
            7850.0,
            json!([{"at":0,"fix":["r", "y.z"]},{"at":2,"fix":["r.y","r.z"]}]),
        );
        m.tractions.push(Traction { top: true, traction: [0.0, -1.08e10, 0.0] });
        m.tractions.push(Traction { top: false, traction: [0.0, 1.08e10, 0.0] });
        let a = Assembly::new(&m);
        let b = Balance::new(&a, true, 0.0).unwrap();
        let s = b.solve(S, None).unwrap();
        let u = at(&b, &s.z, 1.0, 0.25, 0.0);
        let v = at(&b, &s.z, 2.0, 0.0, 0.0);
        println!(
            "table4 {ne}: {:?} end {:?} lf {} it {} cuts {} res {:e}",
            u, v, s.load_factor, s.iterations, s.cuts, s.residual
        );
    }
    for ne in [2, 4, 8] {
        let p = 1.08e9 / (0.25 * std::f64::consts::PI * 2.0);
        for (name, sup) in [
            ("axis", json!([{"at":0,"fix":["r", "y.z"]},{"at":2,"fix":["r.y","r.z"]}])),
            (
                "face",
                json!([{"at":0,"fix":["r","y.y","y.z","z.y","z.z","yz.y","yz.z","yy.y","yy.z","zz.y","zz.z","yyz.y","yyz.z","yzz.y","yzz.z","yyy.y","yyy.z","zzz.y","zzz.z"]},
             {"at":2,"fix":["r.y","r.z","y.y","y.z","z.y","z.z","yz.y","yz.z","yy.y","yy.z","zz.y","zz.z","yyz.y","yyz.z","yzz.y","yzz.z","yyy.y","yyy.z","zzz.y","zzz.z"]}]),
            ),
        ] {
            let mut m = model(json!({"shape":"circle","radius":0.25}), ne, 2.07e11, 0.3, 7850.0, sup);
            m.tractions.push(Traction { top: true, traction: [0.0, -p, 0.0] });
            let a = Assembly::new(&m);
            let b = Balance::new(&a, true, 0.0).unwrap();
            let s = b.solve(S, None).unwrap();
            println!(
                "table6 {name} {ne}: {:?} lf {} it {} cuts {} res {:e}",
                at(&b, &s.z, 1.0, 0.25, 0.0),
                s.load_factor,
                s.iterations,
                s.cuts,
                s.residual
            );
        }
        let p = 2.16e10 / (0.25 * std::f64::consts::PI * 2.0);
        let mut m = model(
            json!({"shape":"circle","radius":0.25}),
            ne,
            2.07e11,
            0.3,
            7850.0,
            json!([{"at":0,"fix":["all"]},{"at":2,"fix":["all"]}]),
        );
        m.tractions.push(Traction { top: true, traction: [0.0, -p, 0.0] });
        m.tractions.push(Traction { top: false, traction: [0.0, p, 0.0] });
        let a = Assembly::new(&m);
        let b = Balance::new(&a, true, 0.0).unwrap();
        let s = b.solve(S, None).unwrap();
        println!(
            "table7 {ne}: {:?} lf {} it {} cuts {} res {:e}",
            at(&b, &s.z, 1.0, 0.25, 0.0),
            s.load_factor,
            s.iterations,
            s.cuts,
            s.residual
        );
    }
    for ne in [4, 8] {
        let mut list = vec!["r.y", "r.z"];
        for v in ["y", "z", "yz", "yy", "zz", "yyz", "yzz", "yyy", "zzz"] {
            list.push(v);
        }
        let m = model(
            json!({"shape":"circle","radius":0.1}),
            ne,
            2.1e11,
            0.3,
            7850.0,
            json!([{"at":0,"fix":["all"]},{"at":2,"fix":list}]),
        );
        let a = Assembly::new(&m);
        let b = Balance::new(&a, true, 1570.796).unwrap();
        let s = b.solve(S, None).unwrap();
        println!(
            "table8 {ne}: {:?} lf {} it {} cuts {} res {:e} unst {}",
            at(&b, &s.z, 1.0, 0.1, 0.0),
            s.load_factor,
            s.iterations,
            s.cuts,
            s.residual,
            s.unstable
        );
        let m = model(
            json!({"shape":"ellipse","semi_axis_y":0.15,"semi_axis_z":0.2}),
            ne,
            1.5e11,
            0.33,
            7000.0,
            json!([{"at":0,"fix":["all"]},{"at":2,"fix":list}]),
        );
        let a = Assembly::new(&m);
        let b = Balance::new(&a, true, 161.905).unwrap();
        let s = b.solve(S, None).unwrap();
        println!(
            "table9 {ne}: {:?} {:?} lf {} it {} cuts {} res {:e} unst {}",
            at(&b, &s.z, 1.0, 0.15, 0.0),
            at(&b, &s.z, 1.0, 0.0, 0.2),
            s.load_factor,
            s.iterations,
            s.cuts,
            s.residual,
            s.unstable
        );
    }
}
