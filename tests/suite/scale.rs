//! The unit of length does not matter: a rotor a million times smaller has the same dimensionless results.

use crate::common::{campbell, case, case_files, frequencies};
use rotor::analysis::spinup::spinup;
use rotor::analysis::statics::statics;
use rotor::case::{Case, LoadedCase};
use rotor::model::{Model, SpinupSettings};
use rotor::units::{Damping, Inertia, Length, Mass, Matrix, Rate, Speed, Stiffness, Time};

const SCALE: f64 = 1e-6;

fn small(case: &Case) -> LoadedCase {
    scaled(case, SCALE)
}

/// The same rotor with every length times `scale`; moduli and densities stay, so times go with `scale`.
pub fn scaled(case: &Case, scale: f64) -> LoadedCase {
    let mut case = case.clone();
    let length = |l: &mut Length| l.0 *= scale;
    let each = |l: &mut Option<Length>| l.iter_mut().for_each(|l| l.0 *= scale);
    for m in case.materials.values_mut() {
        m.damping.stiffness = Time(m.damping.stiffness.0 * scale);
        m.damping.mass = Rate(m.damping.mass.0 / scale);
    }
    for s in case.sections.values_mut() {
        for l in [
            &mut s.radius,
            &mut s.outer_radius,
            &mut s.inner_radius,
            &mut s.semi_axis_y,
            &mut s.semi_axis_z,
            &mut s.inner_semi_axis_y,
            &mut s.inner_semi_axis_z,
            &mut s.height,
            &mut s.width,
        ] {
            each(l);
        }
    }
    for s in case.shaft.iter_mut().flat_map(|s| &mut s.segments) {
        length(&mut s.length);
        s.added_mass_per_length.iter_mut().for_each(|m| m.0 *= scale.powi(2));
        s.axial_force.iter_mut().for_each(|f| f.0 *= scale.powi(2));
        s.torque.iter_mut().for_each(|t| t.0 *= scale.powi(3));
    }
    // responses are not compared
    (case.unbalance, case.harmonic, case.map, case.operating_speed) = (None, None, None, None);
    case.clearances.clear();
    case.expected.clear();
    for d in &mut case.disks {
        length(&mut d.at);
        each(&mut d.radius);
        each(&mut d.inner_radius);
        each(&mut d.thickness);
        d.mass = d.mass.map(|m| Mass(m.0 * scale.powi(3)));
        d.polar_inertia = d.polar_inertia.map(|i| Inertia(i.0 * scale.powi(5)));
        d.diametral_inertia = d.diametral_inertia.map(|i| Inertia(i.0 * scale.powi(5)));
        d.offset.iter_mut().flatten().for_each(length);
    }
    for s in &mut case.supports {
        length(&mut s.at);
        s.stiffness = s.stiffness.map(|k| Matrix(k.0.map(|row| row.map(|k| Stiffness(k.0 * scale)))));
        s.damping = s.damping.map(|c| Matrix(c.0.map(|row| row.map(|c| Damping(c.0 * scale * scale)))));
        s.offset.iter_mut().flatten().for_each(length);
        s.mass.iter_mut().flat_map(|m| m.0.as_flattened_mut()).for_each(|m| m.0 *= scale.powi(3));
        s.axial_stiffness.iter_mut().for_each(|k| k.0 *= scale);
        for row in s.table.iter_mut().flat_map(|t| &mut t.0) {
            row.speed.0 /= scale;
            row.whirl.iter_mut().for_each(|w| w.0 /= scale);
            row.stiffness.0.as_flattened_mut().iter_mut().for_each(|k| k.0 *= scale);
            row.damping.iter_mut().flat_map(|c| c.0.as_flattened_mut()).for_each(|c| c.0 *= scale.powi(2));
            row.mass.iter_mut().flat_map(|m| m.0.as_flattened_mut()).for_each(|m| m.0 *= scale.powi(3));
        }
        if let Some(h) = &mut s.housing {
            h.mass.iter_mut().flat_map(|m| m.0.as_flattened_mut()).for_each(|m| m.0 *= scale.powi(3));
            h.stiffness.iter_mut().flat_map(|k| k.0.as_flattened_mut()).for_each(|k| k.0 *= scale);
            h.damping.iter_mut().flat_map(|c| c.0.as_flattened_mut()).for_each(|c| c.0 *= scale.powi(2));
        }
    }
    for p in &mut case.probes {
        length(&mut p.at);
        each(&mut p.y);
        each(&mut p.z);
    }
    for l in &mut case.loads {
        each(&mut l.at);
        l.force.iter_mut().flatten().for_each(|f| f.0 *= scale.powi(2));
        l.moment.iter_mut().flatten().for_each(|m| m.0 *= scale.powi(3));
    }
    case.gravity.iter_mut().flatten().for_each(|g| g.0 /= scale);
    if let Some(s) = &mut case.spinup {
        for phase in &mut s.drive {
            phase.until.0 *= scale;
            phase.speed.0 /= scale;
        }
        for t in [&mut s.until, &mut s.step] {
            t.iter_mut().for_each(|t| t.0 *= scale);
        }
        for stator in &mut s.stators {
            length(&mut stator.at);
            length(&mut stator.clearance);
            stator.stiffness.0 *= scale;
        }
    }
    if let Some(c) = &mut case.campbell {
        c.speeds.from = Speed(c.speeds.from.0 / scale);
        c.speeds.to = Speed(c.speeds.to.0 / scale);
    }
    LoadedCase::from_value("small.json", serde_json::to_value(&case).expect("JSON"))
        .unwrap_or_else(|e| panic!("{e}"))
}

fn assert_same(name: &str, large: &[f64], small: &[f64]) {
    assert_eq!(large.len(), small.len(), "{name}");
    for (a, b) in large.iter().zip(small) {
        assert!(
            (a - b * SCALE).abs() <= 1e-9 * a.abs(),
            "{name}: {a} {} {:.1e}",
            b * SCALE,
            b * SCALE / a - 1.0
        );
    }
}

#[test]
#[ignore = "long"]
fn natural_frequencies_of_every_case() {
    for path in case_files() {
        let large = Case::load(&path, &[]).expect("case");
        assert_same(&path.display().to_string(), &frequencies(&large), &frequencies(&small(&large.case)));
    }
}

#[test]
#[ignore = "long"]
fn campbell_diagrams_and_critical_speeds_of_every_case() {
    for path in case_files() {
        let large = Case::load(&path, &[]).expect("case");
        if large.case.campbell.is_none() {
            continue;
        }
        let (a, b) = (campbell(&large), campbell(&small(&large.case)));
        let name = path.display().to_string();
        let last = |c: &rotor::results::Campbell| -> Vec<f64> {
            c.branches
                .iter()
                // a motion that creeps has none
                .map(|b| b.frequency_rad_s.last().copied().flatten().unwrap_or(0.0))
                .collect()
        };
        let criticals = |c: &rotor::results::Campbell| -> Vec<f64> {
            c.critical_speeds.iter().map(|c| c.speed_rad_s).collect()
        };
        assert_same(&name, &last(&a), &last(&b));
        assert_same(&name, &criticals(&a), &criticals(&b));
    }
}

#[test]
fn damped_and_hollow_members_of_all_orders() {
    let base = case("bauchau-hollow");
    for element in ["34X1", "34X2", "34X4", "34X5", "34R13", "34R23"] {
        let large =
            crate::common::with(&base, serde_json::json!({ "shaft.element": element, "modes.count": 12 }));
        assert_same(element, &frequencies(&large), &frequencies(&small(&large.case)));
    }
}

/// Displacements of all probes over the reference, for equilibria under loads and at speed.
#[test]
#[ignore = "long"]
fn equilibria_of_every_case() {
    let mut compared = 0;
    for path in case_files() {
        let large = Case::load(&path, &[]).expect("case");
        let displacements = |case: &LoadedCase| -> Vec<f64> {
            let model = crate::common::model(case);
            let mut list = Vec::new();
            if model.has_loads() {
                let results = statics(&model).unwrap_or_else(|e| panic!("{e}")).results;
                list.extend(results.axis.iter().flatten());
            }
            if let Some(settings) = &model.spinup {
                let steady = SpinupSettings { steady: true, ..settings.clone() };
                // gravity makes a periodic motion of it, which has tests of its own
                let model = Model { gravity: [0.0; 3], ..model.clone() };
                let results = spinup(&model, &steady, &|_, _| true).unwrap_or_else(|e| panic!("{e}")).results;
                list.extend(results.last.growth_m);
            }
            list
        };
        let (a, b) = (displacements(&large), displacements(&small(&large.case)));
        // positions, of which displacements are a small part, are rounded
        let rounding = 1e-15 * crate::common::model(&large).length;
        let tolerance = 1e-9 * a.iter().fold(0.0, |m: f64, u| m.max(u.abs())) + rounding;
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            assert!(
                (a - b / SCALE).abs() <= tolerance,
                "{}: {a} {} {tolerance:e}",
                path.display(),
                b / SCALE
            );
            compared += 1;
        }
    }
    assert!(compared > 800, "{compared}");
}
