//! The two frames and forms of the spinning shaft: reference values, equivalence, instability.

use crate::common::{model, shaft};
use rotor::case::LoadedCase;
use rotor::results::{Campbell, Level, ModeKind, Whirl};
use serde_json::{Value, json};

/// 22500 rpm.
const SPEED: f64 = 22500.0 * std::f64::consts::PI / 30.0;

fn circle(radius: f64) -> Value {
    json!({ "shape": "circle", "radius": radius })
}

/// Sweep with few speeds in a frame and form.
fn sweep(speeds: Value, modes: usize, frame: &str, form: &str, reduction: Value) -> Value {
    json!({ "speeds": speeds, "modes": modes, "frame": frame, "form": form, "reduction": reduction })
}

fn close(a: f64, b: f64, rtol: f64) {
    assert!((a / b - 1.0).abs() <= rtol, "{a} instead of {b}: {:.2e}", a / b - 1.0);
}

/// Frequencies at the last speed, ascending, rad/s.
fn at_last(found: &Campbell) -> Vec<f64> {
    let mut list: Vec<f64> =
        found.branches.iter().filter_map(|b| *b.frequency_rad_s.last().expect("speeds")).collect();
    list.sort_by(f64::total_cmp);
    list
}

/// The diagram of a case, none of whose checks failed and all of whose branches were followed.
fn campbell(case: &LoadedCase) -> Campbell {
    let model = model(case);
    let settings = model.campbell.as_ref().expect("a campbell block");
    let found =
        rotor::analysis::campbell::campbell(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}"));
    // static corrections converge slowly to motions that are near critical damping
    let damped = found.results.branches.iter().any(|b| b.log_decrement.iter().flatten().any(|d| *d != 0.0));
    for d in &found.diagnostics {
        let harmless = d.level == Level::Info
            || ["offset-disk", "unstable", "point-support"].contains(&d.code)
            || (damped && d.code == "unreduced-check");
        assert!(harmless, "{d:?}");
    }
    assert!(found.results.reduction.stiffening_error.is_none_or(|e| e < 1e-9));
    found.results
}

/// One speed.
fn only(speed: f64) -> Value {
    json!({ "from": speed, "to": speed, "count": 1 })
}

/// Shafts of the reference: length 2 m, all vectors fixed at the ends, one end axially free.
fn fixed(radius: f64, disks: Value, campbell: Value) -> LoadedCase {
    let all_but_axial: Vec<String> = ["r", "y", "z", "yz", "yy", "zz", "yyz", "yzz", "yyy", "zzz"]
        .iter()
        .flat_map(|v| ["x", "y", "z"].map(|c| format!("{v}.{c}")))
        .filter(|name| name != "r.x")
        .collect();
    shaft(
        circle(radius),
        2.0,
        4,
        json!({
            "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7850 } },
            "disks": disks,
            "supports": [{ "at": 0, "fix": ["all"] }, { "at": 2, "fix": all_but_axial }],
            "campbell": campbell
        }),
    )
}

fn plain(campbell: Value) -> LoadedCase {
    fixed(0.1, json!([]), campbell)
}

fn with_disk(campbell: Value) -> LoadedCase {
    let disk = json!([{ "at": 0.5, "mass": 60, "polar_inertia": 2, "diametral_inertia": 1 }]);
    fixed(0.05, disk, campbell)
}

/// Independent numpy model, 4 elements, unreduced; printed to four decimals.
fn matches(found: &Campbell, reference: [f64; 8]) {
    for (ours, reference) in at_last(found).into_iter().zip(reference) {
        assert!((ours - reference).abs() <= 1e-6 * reference + 1e-4, "{ours} instead of {reference}");
    }
}

#[test]
fn a_fast_shaft_agrees_with_an_independent_model() {
    let find = |speed, frame, form| campbell(&plain(sweep(only(speed), 10, frame, form, json!("none"))));
    matches(
        &find(SPEED, "rotating", "consistent"),
        [932.2255, 1372.2898, 3749.3867, 4080.6127, 4519.9946, 5037.5267, 5986.1831, 8532.6865],
    );
    matches(
        &find(SPEED, "stationary", "consistent"),
        [1393.1922, 1423.969, 3629.9886, 3728.4843, 4080.6127, 5037.5267, 6703.0853, 6876.1891],
    );
    matches(
        &find(SPEED, "stationary", "classical"),
        [1392.7998, 1423.5313, 3628.8727, 3727.2231, 4081.8562, 5036.2249, 6700.957, 6873.8082],
    );
    let found = campbell(&plain(sweep(
        json!({ "to": 100, "count": 2 }),
        10,
        "rotating",
        "consistent",
        json!("none"),
    )));
    let at_rest: Vec<f64> = found.branches.iter().filter_map(|b| b.frequency_rad_s[0]).collect();
    let reference = [1408.1234, 1408.1234, 3677.9745, 3677.9745, 4082.9441, 5038.5842, 6787.4556, 6787.4556];
    at_rest.into_iter().zip(reference).for_each(|(ours, reference)| close(ours, reference, 1e-6));
}

#[test]
fn a_shaft_with_a_disk_agrees_with_an_independent_model() {
    let find = |frame, form| campbell(&with_disk(sweep(only(600.0), 10, frame, form, json!("none"))));
    matches(
        &find("rotating", "consistent"),
        [23.5674, 900.2486, 1015.1255, 1182.5058, 2094.3758, 2556.1771, 3351.3721, 3823.6543],
    );
    matches(
        &find("stationary", "consistent"),
        [582.5058, 623.5674, 1015.1255, 1494.3758, 1500.2486, 2751.3721, 3156.1771, 3823.6543],
    );
    matches(
        &find("stationary", "classical"),
        [582.5036, 623.5642, 1015.1179, 1494.3648, 1500.2378, 2751.3547, 3156.1515, 3823.6723],
    );
}

/// `w_rotating = |w_stationary - Omega|` for forward and `w + Omega` for backward whirl, `w` for torsion and axial.
fn equivalent(case: impl Fn(Value) -> LoadedCase, speed: f64, reduction: Value, rtol: f64) {
    let find = |frame| campbell(&case(sweep(only(speed), 12, frame, "consistent", reduction.clone())));
    let (stationary, rotating) = (find("stationary"), at_last(&find("rotating")));
    let mut compared = 0;
    for branch in &stationary.branches {
        let w = branch.frequency_rad_s[0].expect("oscillating");
        let seen = match (branch.whirl, branch.kind) {
            (Whirl::Forward, ModeKind::Bending) => (w - speed).abs(),
            (Whirl::Backward, ModeKind::Bending) => w + speed,
            (_, ModeKind::Torsion | ModeKind::Axial) => w,
            _ => continue,
        };
        if seen <= rotating[11] {
            let nearest = rotating.iter().map(|r| (r - seen).abs()).fold(f64::INFINITY, f64::min);
            assert!(nearest <= rtol * w, "{} {w}: {seen} misses {rotating:?} by {nearest:.1e}", branch.name);
            compared += 1;
        }
    }
    assert!(compared >= 8, "{compared}");
}

#[test]
fn both_frames_are_one_theory() {
    for (reduction, rtol) in [(json!("none"), 1e-9), (json!(60), 1e-5)] {
        equivalent(plain, SPEED, reduction.clone(), rtol);
        equivalent(with_disk, 600.0, reduction, rtol);
    }
}

/// Damping too: what the material, the surroundings and the bearings take is the same seen from either frame.
#[test]
#[ignore = "long"]
fn both_frames_are_one_theory_with_damping() {
    let case = |frame: &str| {
        shaft(
            circle(0.05),
            2.0,
            6,
            json!({
                "materials": { "m": { "damping": { "stiffness": 2e-5, "mass": 3.0 } } },
                "disks": [{ "at": 0.8, "mass": 60, "polar_inertia": 2, "diametral_inertia": 1.2 }],
                "supports": [
                    { "at": 0, "kind": "bearing", "stiffness": [[2e7, 1e6], [-1e6, 2e7]], "damping": [[2e3, 0], [0, 2e3]] },
                    { "at": 2, "kind": "bearing", "stiffness": [[3e7, 0], [0, 3e7]], "damping": [[1e3, 200], [-200, 1e3]] }
                ],
                "campbell": sweep(json!({ "to": 500, "count": 4 }), 8, frame, "consistent", json!(80))
            }),
        )
    };
    let (stationary, rotating) = (campbell(&case("stationary")), campbell(&case("rotating")));
    let value = |found: &Campbell, b: usize, k: usize| {
        let w = found.branches[b].frequency_rad_s[k]?;
        Some((w, -w * found.branches[b].log_decrement[k]? / std::f64::consts::TAU))
    };
    let mut compared = 0;
    for k in 0..4 {
        let speed = stationary.speeds_rad_s[k];
        for (b, branch) in stationary.branches.iter().enumerate() {
            let (w, growth) = value(&stationary, b, k).expect("oscillating");
            let seen = match (branch.whirl, branch.kind) {
                (Whirl::Forward, ModeKind::Bending) => (w - speed).abs(),
                (Whirl::Backward, ModeKind::Bending) => w + speed,
                (_, ModeKind::Torsion | ModeKind::Axial) => w,
                _ => continue,
            };
            let miss = |other: usize| {
                value(&rotating, other, k)
                    .map_or(f64::INFINITY, |(v, g)| (v - seen).abs() + (g - growth).abs())
            };
            let nearest = (0..8).map(miss).fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= 1e-6 * w || seen > 2500.0,
                "{} at {speed}: {w} {growth} misses by {nearest:.1e}",
                branch.name
            );
            compared += usize::from(nearest <= 1e-6 * w);
        }
    }
    assert!(compared >= 20, "{compared}");
    // cross-coupling and rotating damping drive the shaft: both frames name the same ranges
    let ranges = |found: &Campbell| found.unstable_ranges.clone();
    assert_eq!(ranges(&stationary).len(), ranges(&rotating).len());
    for (a, b) in ranges(&stationary).iter().zip(&ranges(&rotating)) {
        close(a.from_rad_s, b.from_rad_s, 1e-6);
        close(a.largest_growth_rate_1_s, b.largest_growth_rate_1_s, 1e-5);
    }
}

/// A rigid hub carries the disk's pull, so torsion moves only as the shaft grows.
#[test]
fn torsion_stays_where_it_is() {
    let found = campbell(&with_disk(sweep(
        json!({ "to": 600, "count": 3 }),
        4,
        "stationary",
        "consistent",
        json!(60),
    )));
    let torsion = found.branches.iter().find(|b| b.kind == ModeKind::Torsion).expect("torsion");
    close(torsion.frequency_rad_s[2].expect("w"), torsion.frequency_rad_s[0].expect("w"), 1e-6);
}

/// Seen from the shaft forward whirl slows down with speed and backward whirl gains: the sense of `2 Omega M J`.
#[test]
fn forward_whirl_slows_down_in_the_rotating_frame() {
    let found =
        campbell(&with_disk(sweep(json!({ "to": 200, "count": 5 }), 5, "rotating", "consistent", json!(60))));
    let mut senses = Vec::new();
    for branch in found.branches.iter().filter(|b| b.kind == ModeKind::Bending) {
        let change = branch.frequency_rad_s[4].expect("w") - branch.frequency_rad_s[0].expect("w");
        let expected = if change < 0.0 { Whirl::Forward } else { Whirl::Backward };
        assert!(branch.whirl == expected && change.abs() > 150.0, "{} changes by {change}", branch.name);
        senses.push(branch.whirl);
    }
    assert!(senses.contains(&Whirl::Forward) && senses.contains(&Whirl::Backward));
}

/// A point mass on a massless elliptic shaft: unstable between the frequencies of its two planes, where
/// `s^4 + s^2 (a + b + 2 Omega^2) + (a - Omega^2)(b - Omega^2) = 0` has a positive root (a, b their squares).
#[test]
fn an_elliptic_jeffcott_rotor_is_unstable_between_its_two_frequencies() {
    let (c_y, c_z, m) = (0.005, 0.006, 10.0);
    let case = shaft(
        json!({ "shape": "ellipse", "semi_axis_y": c_y, "semi_axis_z": c_z }),
        1.0,
        8,
        json!({
            "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 0.001 } },
            "disks": [{ "at": 0.5, "mass": m, "polar_inertia": 0, "diametral_inertia": 0, "hub": "soft" }],
            "supports": [{ "at": 0, "kind": "pinned" }, { "at": 1, "kind": "roller" }],
            "campbell": sweep(json!({ "to": 60, "count": 13 }), 2, "rotating", "consistent", json!(60))
        }),
    );
    let stiffness = |c: f64, other: f64| 48.0 * 2.1e11 * std::f64::consts::PI / 4.0 * other * c.powi(3);
    let (soft, stiff) = ((stiffness(c_y, c_z) / m).sqrt(), (stiffness(c_z, c_y) / m).sqrt());
    let found = campbell(&case);
    let ranges = &found.unstable_ranges;
    assert_eq!(ranges.len(), 1, "{ranges:?}");
    close(ranges[0].from_rad_s, soft, 1e-3);
    close(ranges[0].to_rad_s, stiff, 1e-3);
    let criticals: Vec<f64> = found.critical_speeds.iter().map(|c| c.speed_rad_s).collect();
    assert_eq!(criticals.len(), 2, "{criticals:?}");
    close(ranges[0].from_rad_s, criticals[0], 1e-6);
    close(ranges[0].to_rad_s, criticals[1], 1e-6);
    let (a, b) = (criticals[0].powi(2), criticals[1].powi(2));
    let growth = |speed: f64| {
        let (half, rest) = ((a + b) / 2.0 + speed * speed, (a - speed * speed) * (b - speed * speed));
        (-half + (half * half - rest).sqrt()).max(0.0).sqrt()
    };
    let largest = (0..=10000)
        .map(|i| growth(criticals[0] + (criticals[1] - criticals[0]) * f64::from(i) / 1e4))
        .fold(0.0, f64::max);
    close(ranges[0].largest_growth_rate_1_s, largest, 1e-6);
    for (branch, sign) in found.branches.iter().zip([-1.0, 1.0]) {
        for (speed, w) in found.speeds_rad_s.iter().zip(&branch.frequency_rad_s) {
            let (half, rest) = ((a + b) / 2.0 + speed * speed, (a - speed * speed) * (b - speed * speed));
            let square = half + sign * (half * half - rest).sqrt();
            match w {
                Some(w) => assert!((w - square.sqrt()).abs() < 1e-4 * w + 1e-6, "{w} at {speed}"),
                None => assert!(square < 0.0, "{speed}"),
            }
        }
    }
}

/// A continuous elliptic shaft, also between two speeds of a coarse sweep; mirrored about the diagonal it is the same.
#[test]
fn an_elliptic_shaft_has_an_unstable_range_between_its_critical_speeds() {
    let find = |y: f64, z: f64| {
        campbell(&shaft(
            json!({ "shape": "ellipse", "semi_axis_y": y, "semi_axis_z": z }),
            2.0,
            6,
            json!({
                "supports": [{ "at": 0, "kind": "revolute", "driven": false }, { "at": 2, "kind": "cylindrical" }],
                "campbell": sweep(json!({ "to": 1200, "count": 7 }), 6, "rotating", "consistent", json!(60))
            }),
        ))
    };
    let (found, mirrored) = (find(0.05, 0.051), find(0.051, 0.05));
    let ranges = &found.unstable_ranges;
    let criticals: Vec<f64> = found.critical_speeds.iter().map(|c| c.speed_rad_s).collect();
    assert!(!ranges.is_empty());
    for range in ranges {
        for end in [range.from_rad_s, range.to_rad_s] {
            let nearest = criticals.iter().map(|c| (c / end - 1.0).abs()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-6, "{end} {criticals:?}");
        }
    }
    for critical in &found.critical_speeds {
        assert!(critical.crossing_difference.expect("crossing").abs() < 1e-6);
        assert!(critical.branch.is_some());
    }
    for (a, b) in ranges.iter().zip(&mirrored.unstable_ranges) {
        close(a.from_rad_s, b.from_rad_s, 1e-7);
        close(a.largest_growth_rate_1_s, b.largest_growth_rate_1_s, 1e-5);
    }
}

/// Forward critical speeds of an axisymmetric rotor are the same in both frames, by different eigenproblems.
#[test]
fn forward_critical_speeds_agree_between_the_frames() {
    let find = |frame| {
        campbell(&with_disk(sweep(json!({ "to": 3000, "count": 31 }), 8, frame, "consistent", json!(60))))
            .critical_speeds
    };
    let (stationary, rotating) = (find("stationary"), find("rotating"));
    let forward: Vec<f64> =
        stationary.iter().filter(|c| c.whirl == Whirl::Forward).map(|c| c.speed_rad_s).collect();
    assert_eq!(forward.len(), rotating.len());
    assert!(!forward.is_empty());
    forward.iter().zip(&rotating).for_each(|(a, b)| close(*a, b.speed_rad_s, 1e-9));
}

#[test]
fn an_offset_disk_parts_the_critical_speeds_in_the_rotating_frame() {
    let disk = json!([{ "at": 0.5, "mass": 60, "polar_inertia": 2, "diametral_inertia": 1.2, "offset": [0.03, 0.0] }]);
    let case =
        fixed(0.05, disk, sweep(json!({ "to": 1000, "count": 21 }), 6, "rotating", "consistent", json!(60)));
    let found = campbell(&case);
    let ranges = &found.unstable_ranges;
    assert_eq!((ranges.len(), found.critical_speeds.len()), (1, 2));
    close(ranges[0].from_rad_s, found.critical_speeds[0].speed_rad_s, 1e-7);
    close(ranges[0].to_rad_s, found.critical_speeds[1].speed_rad_s, 1e-7);
}

#[test]
fn a_shaft_that_bursts_says_at_which_speed() {
    for frame in ["stationary", "rotating"] {
        let case = plain(sweep(json!({ "to": 1e5, "count": 11 }), 4, frame, "consistent", json!(60)));
        let model = model(&case);
        let settings = model.campbell.as_ref().expect("settings");
        let error =
            rotor::analysis::campbell::campbell(&model, settings, &|_| ()).map(|_| ()).expect_err("bursts");
        assert_eq!(error.exit_code(), 1);
        assert!(error.to_string().contains("no stable equilibrium"), "{error}");
    }
}
