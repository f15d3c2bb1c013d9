//! The integrators against an independent one (Dormand and Prince's order 5 of the crate `ode_solvers`) on the equations
//! of a small soft rotor, and against each other.

use crate::common::{model, shaft, with};
use ode_solvers::{DVector, Dopri5, OutputType, System};
use rotor::analysis::spinup::spinup;
use rotor::case::LoadedCase;
use rotor::integrate::implicit::Scheme;
use rotor::integrate::{IntegratorSettings, Method, Moment, Progress, integrate};
use rotor::model::{Frame, Model};
use rotor::results::Spinup;
use rotor::shaft::assembly::Assembly;
use rotor::shaft::drive::Drive;
use rotor::shaft::motion::Dynamics;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::ops::ControlFlow;

const UNTIL: f64 = 0.05;

/// A rubber shaft of one element with an unbalanced disk, so soft that explicit methods take steps of 1e-4 s, driven
/// rigid ends, material, external and bearing damping.
fn soft(more: Value) -> LoadedCase {
    let base = shaft(
        json!({ "shape": "circle", "radius": 0.05 }),
        0.6,
        1,
        json!({
            "materials": { "m": { "E": 2e7, "nu": 0.3, "rho": 1200, "damping": { "stiffness": 1e-5, "mass": 3 } } },
            "shaft": { "element": "34X2" },
            "disks": [{ "at": 0.3, "mass": 2, "polar_inertia": 0.004, "diametral_inertia": 0.002,
                        "offset": [0.004, 0.002], "hub": "soft" }],
            "supports": [{ "at": 0, "kind": "revolute", "section": "rigid" },
                         { "at": 0.6, "kind": "cylindrical", "section": "rigid" },
                         { "at": 0.3, "kind": "bearing", "stiffness": [[3e4, 2e3], [1e3, 2e4]], "damping": [[20, 0], [5, 30]] }],
            "gravity": [0, -9.81, 0],
            "spinup": { "drive": [{ "until": UNTIL, "speed": 150 }], "output": 11 }
        }),
    );
    with(&base, more)
}

/// Displacements and velocities at the end of the run-up from the undeformed state, and the steps.
fn end(model: &Model, frame: Frame, method: Method, tolerance: f64) -> (Vec<f64>, Progress) {
    let (assembly, settings) = (Assembly::new(model), model.spinup.as_ref().expect("spinup"));
    let drive = Drive::of(settings);
    let mut dynamics = Dynamics::new(&assembly, drive, frame).unwrap_or_else(|e| panic!("{e}"));
    let n = assembly.size();
    let mut start = Moment { t: 0.0, z: vec![0.0; n], v: vec![0.0; n], a: vec![0.0; n] };
    let rest = start.clone();
    dynamics.acceleration(0.0, &rest.z, &rest.v, &mut start.a);
    let settings = IntegratorSettings {
        method,
        rtol: tolerance,
        atol: tolerance * 1e-3,
        step: None,
        first_step: 1e-4,
        max_steps: 1_000_000,
        stops: vec![0.4 * UNTIL, UNTIL],
    };
    let mut last = Vec::new();
    let progress = integrate(&mut dynamics, start, &settings, &mut |_, step, _| {
        last = [&step.end.z[..], &step.end.v[..]].concat();
        Ok(ControlFlow::Continue(()))
    });
    (last, progress.unwrap_or_else(|e| panic!("{e}")))
}

/// `y' = (v, a(t, z, v))`.
struct FirstOrder<'a, 'b>(&'b RefCell<Dynamics<'a>>);

impl System<f64, DVector<f64>> for FirstOrder<'_, '_> {
    fn system(&self, t: f64, y: &DVector<f64>, dy: &mut DVector<f64>) {
        let n = y.len() / 2;
        let (z, v) = y.as_slice().split_at(n);
        let (dz, dv) = dy.as_mut_slice().split_at_mut(n);
        dz.copy_from_slice(v);
        self.0.borrow_mut().acceleration(t, z, v, dv);
    }
}

fn oracle(model: &Model, frame: Frame) -> Vec<f64> {
    let (assembly, settings) = (Assembly::new(model), model.spinup.as_ref().expect("spinup"));
    let drive = Drive::of(settings);
    let dynamics = RefCell::new(Dynamics::new(&assembly, drive, frame).unwrap_or_else(|e| panic!("{e}")));
    let y = DVector::zeros(2 * assembly.size());
    let (rtol, atol, most) = (1e-10, 1e-12, 1_000_000);
    // the usual step control, every step kept: the last one ends at UNTIL
    let control = (0.9, 0.04, 0.2, 10.0);
    let mut solver = Dopri5::from_param(
        FirstOrder(&dynamics),
        0.0,
        UNTIL,
        UNTIL,
        y,
        rtol,
        atol,
        control.0,
        control.1,
        control.2,
        control.3,
        UNTIL,
        0.0,
        most,
        most,
        OutputType::Sparse,
    );
    solver.integrate().unwrap_or_else(|e| panic!("{e}"));
    assert!((solver.x_out().last().expect("end") / UNTIL - 1.0).abs() < 1e-12);
    solver.y_out().last().expect("end").as_slice().to_vec()
}

/// Largest differences of displacements and of velocities over the largest of each.
fn errors(ours: &[f64], exact: &[f64]) -> [f64; 2] {
    let n = exact.len() / 2;
    [0..n, n..2 * n].map(|range| {
        let size = exact[range.clone()].iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let pairs = ours[range.clone()].iter().zip(&exact[range]);
        pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / size
    })
}

#[test]
fn every_integrator_agrees_with_an_independent_one() {
    let model = model(&soft(json!({})));
    for frame in [Frame::Rotating, Frame::Inertial] {
        let exact = oracle(&model, frame);
        assert!(exact.iter().any(|x| x.abs() > 1e-3) && exact.iter().all(|x| x.is_finite()));
        let alpha = Method::Implicit(Scheme::GeneralizedAlpha { rho_infinity: 0.9 });
        for (method, tolerance, allowed) in [
            (Method::Adams, 1e-9, [1e-7, 2e-6]),
            (Method::Implicit(Scheme::Esdirk), 1e-8, [3e-6, 1e-4]),
            (alpha, 1e-7, [2e-4, 2e-3]),
        ] {
            let (ours, _) = end(&model, frame, method, tolerance);
            let found = errors(&ours, &exact);
            assert!(
                found[0] < allowed[0] && found[1] < allowed[1],
                "{method:?} {frame:?}: {found:?} of {allowed:?}"
            );
        }
    }
}

/// The error follows the tolerance, and a high order takes few steps for a small one.
#[test]
fn adams_errors_follow_the_tolerance() {
    let model = model(&soft(json!({})));
    let exact = oracle(&model, Frame::Rotating);
    let (mut before, mut fewest) = (f64::INFINITY, usize::MAX);
    for tolerance in [1e-5, 1e-7, 1e-9] {
        let (ours, progress) = end(&model, Frame::Rotating, Method::Adams, tolerance);
        let error = errors(&ours, &exact)[0];
        assert!(error < 300.0 * tolerance && error < before / 10.0, "{tolerance:e}: {error:e}");
        assert!(progress.rejected * 5 < progress.steps, "{progress:?}");
        before = error;
        fewest = fewest.min(progress.steps);
    }
    // four decades of accuracy for less than three times the steps: order above seven
    let (_, tight) = end(&model, Frame::Rotating, Method::Adams, 1e-9);
    assert!(tight.steps < 3 * fewest, "{} of {fewest}", tight.steps);
}

fn run(case: &LoadedCase) -> Spinup {
    let model = model(case);
    let outcome = spinup(&model, model.spinup.as_ref().expect("spinup"), &|_, _| true);
    outcome.unwrap_or_else(|e| panic!("{e}")).results
}

/// Work of the drive, damping and energies balance; frames and integrators tell the same torque and reactions.
#[test]
fn adams_balances_energy_and_tells_the_same_torque() {
    let adams = |frame: &str| {
        run(&soft(
            json!({ "spinup.integrator": "adams", "spinup.frame": frame, "spinup.rtol": 1e-9, "spinup.atol": 1e-11 }),
        ))
    };
    let implicit = run(&soft(json!({ "spinup.rtol": 1e-8, "spinup.atol": 1e-10 })));
    let reference = implicit.history.as_ref().expect("history");
    for frame in ["rotating", "inertial"] {
        let result = adams(frame);
        let energy = result.energy.as_ref().expect("energy");
        assert!(energy.relative_error.abs() < 1e-7, "{frame}: {energy:?}");
        for absorbed in [energy.material_damping_j, energy.external_damping_j, energy.bearings_j] {
            assert!(absorbed > 0.0, "{frame}: {energy:?}");
        }
        let history = result.history.as_ref().expect("history");
        let size = reference.drive_torque_n_m.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
        for (a, b) in history.drive_torque_n_m.iter().zip(&reference.drive_torque_n_m) {
            assert!((a - b).abs() < 1e-4 * size, "{frame}: {a} {b} of {size}");
        }
        for (path, forces) in &reference.reactions_n {
            let size = forces.iter().flatten().fold(0.0, |m: f64, f| m.max(f.abs()));
            let pairs = forces.iter().flatten().zip(history.reactions_n[path].iter().flatten());
            for (a, b) in pairs {
                assert!((a - b).abs() < 1e-3 * size, "{frame} {path}: {a} {b} of {size}");
            }
        }
        let summary = result.integrator.expect("integrator");
        assert!(summary.name == "adams" && summary.factorizations == 0, "{summary:?}");
    }
}

/// A stiff run is given up early, with an estimate of the steps it would take.
#[test]
fn adams_says_early_that_steps_would_be_too_many() {
    let set = json!({ "spinup.integrator": "adams", "materials.m.E": 2e11, "spinup.max_steps": 2000 });
    let model = model(&soft(set));
    let error = spinup(&model, model.spinup.as_ref().expect("spinup"), &|_, _| true).expect_err("too many");
    let text = error.to_string();
    assert_eq!(error.exit_code(), 1);
    assert!(text.contains("steps, more than spinup.max_steps = 2000") && text.contains("implicit"), "{text}");
}

/// What the explicit method can't take is a fault of the case, with its remedy.
#[test]
fn adams_refuses_fixed_steps_and_turning_masses() {
    let fixed = soft(json!({ "spinup.integrator": "adams", "spinup.step": 1e-6 }));
    let error = Model::new(&fixed).expect_err("fixed step");
    let text = error.to_string();
    assert!(error.exit_code() == 2 && text.contains("spinup.step") && text.contains("rtol"), "{text}");
    let refusal = |set: Value| {
        let model = model(&with(&soft(json!({ "spinup.integrator": "adams" })), set));
        rotor::analysis::spinup::fits(&model, model.spinup.as_ref().expect("spinup")).err()
    };
    let plane = json!({ "spinup.frame": "inertial", "supports.1.section": "plane" });
    let refused = refusal(plane).expect("a plane section turns the mass matrix");
    assert!(refused.path == "spinup.integrator" && refused.allowed.contains("rotating"), "{refused:?}");
    assert_eq!(refusal(json!({ "spinup.frame": "inertial" })), None);
    assert_eq!(refusal(json!({ "spinup.frame": "rotating", "supports.1.section": "plane" })), None);
    // undriven, a plane section keeps to fixed directions
    let undriven =
        json!({ "spinup.frame": "inertial", "supports.1.section": "plane", "supports.1.driven": false });
    assert_eq!(refusal(undriven), None);
}
