//! Synthetic results that look like those of real rotors.

use std::f64::consts::{PI, TAU};

use rotor::results::*;

pub fn report<R>(title: &str, results: R) -> Report<R> {
    Report {
        rotor: "0.1.0",
        case: CaseInfo {
            title: title.to_owned(),
            file: "jeffcott_6m.json".to_owned(),
            sha256: "3f2a77aa10b7c5d2e9f8".to_owned(),
            overrides: serde_json::Map::new(),
            effective: serde_json::Value::Null,
        },
        model: ModelSummary {
            degrees_of_freedom: 1458,
            elements: 16,
            mass_kg: 440.431,
            modelled: ["gyroscopic moments", "shear deformation", "disk inertia", "rigid hub"]
                .map(|text| Modelled::Told(text.to_owned()))
                .to_vec(),
            left_out: ["gravity: ignored by this analysis", "material damping: none given"]
                .map(|text| LeftOut::Told(text.to_owned()))
                .to_vec(),
            estimated_error: None,
        },
        results,
        diagnostics: Vec::new(),
    }
}

pub fn speeds(to_rad_s: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| to_rad_s * i as f64 / (count - 1).max(1) as f64).collect()
}

pub fn branch(
    name: &str,
    whirl: Whirl,
    kind: ModeKind,
    speeds: &[f64],
    hz: impl Fn(f64) -> Option<f64>,
) -> Branch {
    Branch {
        name: name.to_owned(),
        whirl,
        whirl_at_speed: vec![whirl; speeds.len()],
        kind,
        overdamped: Vec::new(),
        frequency_rad_s: speeds.iter().map(|&speed| hz(speed).map(|hz| hz * TAU)).collect(),
        log_decrement: vec![Some(0.0); speeds.len()],
    }
}

/// A bending pair that starts at `hz` and splits by `rate` Hz per Hz of speed.
pub fn pair(number: usize, hz: f64, rate: f64, split: f64, speeds: &[f64]) -> [Branch; 2] {
    let at = move |speed: f64, sign: f64| {
        let spin = speed / TAU;
        let start = hz * (1.0 + sign * split);
        (start * start + (rate * spin).powi(2)).sqrt() + sign * rate * spin
    };
    [
        branch(&format!("{number}B"), Whirl::Backward, ModeKind::Bending, speeds, move |s| Some(at(s, -1.0))),
        branch(&format!("{number}F"), Whirl::Forward, ModeKind::Bending, speeds, move |s| Some(at(s, 1.0))),
    ]
}

/// All crossings of the branches with the speed itself.
pub fn criticals(branches: &[Branch], speeds: &[f64]) -> Vec<CriticalSpeed> {
    let mut found = Vec::new();
    for branch in branches {
        for i in 1..speeds.len() {
            let (Some(a), Some(b)) = (branch.frequency_rad_s[i - 1], branch.frequency_rad_s[i]) else {
                continue;
            };
            let (ga, gb) = (a - speeds[i - 1], b - speeds[i]);
            if ga > 0.0 && gb <= 0.0 {
                let speed = speeds[i - 1] + (speeds[i] - speeds[i - 1]) * ga / (ga - gb);
                found.push(critical(speed, &branch.name, branch.whirl, branch.kind, false));
            }
        }
    }
    found.sort_by(|a, b| a.speed_rad_s.total_cmp(&b.speed_rad_s));
    found
}

pub fn critical(speed: f64, name: &str, whirl: Whirl, kind: ModeKind, damped: bool) -> CriticalSpeed {
    CriticalSpeed {
        speed_rad_s: speed,
        speed_rpm: speed * 60.0 / TAU,
        branch: Some(name.to_owned()),
        whirl,
        kind,
        damped,
        crossing_difference: Some(1e-9),
    }
}

pub fn campbell(speeds: Vec<f64>, branches: Vec<Branch>, critical_speeds: Vec<CriticalSpeed>) -> Campbell {
    Campbell {
        frame: "stationary",
        form: "consistent",
        gyroscopic: "all",
        speeds_rad_s: speeds,
        branches,
        critical_speeds,
        orders: vec![2.0],
        operating_speed: None,
        unstable_ranges: Vec::new(),
        stability_threshold_rad_s: None,
        reduction: Reduction { basis: Some(60), measured_error: Some(1e-8), stiffening_error: None },
    }
}

/// Twelve branches, ten crossings, the first pair nearly coinciding.
pub fn rotor() -> Campbell {
    let speeds = speeds(10000.0 * TAU / 60.0, 101);
    let mut branches: Vec<Branch> = Vec::new();
    for (number, (hz, rate, split)) in [
        (10.35, 0.0004, 0.001),
        (37.0, 0.02, 0.0),
        (62.0, 0.004, 0.0),
        (101.0, 0.06, 0.0),
        (131.0, 0.012, 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        branches.extend(pair(number + 1, hz, rate, split, &speeds));
    }
    branches.push(branch("T1", Whirl::None, ModeKind::Torsion, &speeds, |_| Some(266.0)));
    branches.push(branch("A1", Whirl::None, ModeKind::Axial, &speeds, |_| Some(431.0)));
    let found = criticals(&branches, &speeds);
    campbell(speeds, branches, found)
}

/// Damped bearings: lost and over-damped stretches, instability above a threshold.
pub fn damped() -> Campbell {
    let speeds = speeds(1200.0, 61);
    let mut branches = Vec::new();
    branches.extend(pair(1, 30.0, 0.1, 0.01, &speeds));
    branches.extend(pair(2, 92.0, 0.3, 0.0, &speeds));
    branches.push(branch("3F", Whirl::Forward, ModeKind::Bending, &speeds, |s| {
        (!(400.0..600.0).contains(&s) && s < 900.0).then_some(150.0 + 0.05 * s)
    }));
    for (decrement, speed) in branches[1].log_decrement.iter_mut().zip(&speeds) {
        *decrement = Some(0.3 - speed / 1500.0);
    }
    let mut found = criticals(&branches, &speeds);
    found.iter_mut().for_each(|critical| critical.damped = true);
    campbell(speeds, branches, found)
}

/// Forty branches and about as many critical speeds.
pub fn crowded() -> Campbell {
    let speeds = speeds(6000.0, 101);
    let branches: Vec<Branch> =
        (1..=20).flat_map(|n| pair(n, 12.0 * (n * n) as f64 / 4.0 + 5.0, 0.05, 0.002, &speeds)).collect();
    let found = criticals(&branches, &speeds);
    campbell(speeds, branches, found)
}

pub fn mode(number: usize, hz: f64, kind: ModeKind, order: usize, shape: ModeShape) -> Mode {
    Mode {
        number,
        frequency_rad_s: hz * TAU,
        frequency_hz: hz,
        kind,
        circumferential_order: order,
        energy_share: EnergyShare { axial: 0.0, bending: 1.0, torsion: 0.0, section: 0.0 },
        relative_residual: 1e-12,
        shape,
    }
}

/// A tube of 2 m whose axis, twist and outline move by the given functions.
pub fn shape(
    axis: impl Fn(f64) -> [f64; 3],
    twist: impl Fn(f64) -> f64,
    outline: impl Fn(f64, f64) -> [f64; 3],
) -> ModeShape {
    let x_m: Vec<f64> = (0..=64).map(|i| 2.0 * i as f64 / 64.0).collect();
    let angles: Vec<f64> = (0..72).map(|i| TAU * i as f64 / 72.0).collect();
    let radii = [0.2, 0.15];
    let circle = |radius: f64| angles.iter().map(|a| [radius * a.cos(), radius * a.sin()]).collect();
    ModeShape {
        axis: x_m.iter().map(|x| axis(x / 2.0)).collect(),
        twist: x_m.iter().map(|x| twist(x / 2.0)).collect(),
        x_m,
        section_x_m: 1.0,
        outlines: radii.map(circle).to_vec(),
        outline_displacements: radii
            .map(|radius| angles.iter().map(|&angle| outline(angle, radius / 0.2)).collect())
            .to_vec(),
    }
}

/// Six rigid motions and fourteen modes of every kind.
pub fn tube_modes() -> Modes {
    let rigid = (1..=6).map(|number| mode(number, 0.0, ModeKind::Rigid, 1, ModeShape::default()));
    let elastic = (0..14).map(|index| {
        let waves = (index / 4 + 1) as f64;
        let hz = 161.27 * (index + 1) as f64;
        let (kind, order, shape) = match index % 4 {
            0 => (
                ModeKind::Bending,
                1,
                shape(
                    |s| [0.0, 0.9 * (PI * waves * s).sin(), 0.3 * (PI * waves * s).sin()],
                    |_| 0.0,
                    |angle, r| [0.1 * r * angle.cos(), 0.9, 0.3],
                ),
            ),
            1 => (
                ModeKind::Torsion,
                0,
                shape(
                    |_| [0.0; 3],
                    |s| (PI * waves * s).cos(),
                    |angle, r| [0.0, -r * angle.sin(), r * angle.cos()],
                ),
            ),
            2 => (
                ModeKind::Axial,
                0,
                shape(
                    |s| [(PI * waves * s).cos(), 0.0, 0.0],
                    |_| 0.0,
                    |angle, r| [1.0, 0.05 * r * angle.cos(), 0.05 * r * angle.sin()],
                ),
            ),
            _ => {
                let n = waves + 1.0;
                (
                    ModeKind::Section,
                    n as usize,
                    shape(
                        |_| [0.0; 3],
                        |_| 0.0,
                        move |a, r| {
                            let out = r * (n * a).cos();
                            [0.0, out * a.cos(), out * a.sin()]
                        },
                    ),
                )
            }
        };
        mode(index + 7, hz, kind, order, shape)
    });
    Modes { rigid_modes: 6, modes: rigid.chain(elastic).collect(), sturm_count_agrees: true }
}
