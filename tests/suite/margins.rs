//! Peaks of responses and the rules of standards, on the curve of one degree of freedom with unbalance.

use rotor::analysis::margins::{
    actual_margin, amplitude_limit_um, clearance, peaks, permissible_unbalance, required_margin,
    residual_unbalance, residual_unbalance_limit, scale_factor, separation, shares_of_planes, stability,
    vibration,
};
use rotor::results::ResponsePeak;
use serde_json::Value;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

const RPM: f64 = PI / 30.0;

fn near(ours: f64, right: f64, rtol: f64, what: &str) {
    assert!((ours - right).abs() <= rtol * right.abs(), "{what}: {ours} instead of {right}");
}

/// The response to unbalance over the speed in units of the natural frequency.
fn response(zeta: f64) -> impl Fn(f64) -> f64 {
    move |x: f64| x * x / ((1.0 - x * x).powi(2) + (2.0 * zeta * x).powi(2)).sqrt()
}

fn samples(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
}

/// Maximum and its flanks in closed form: `x^2 = 1/(1 - 2 z^2)` and the roots of
/// `(1 - 2/p^2) y^2 - 2 (1 - 2 z^2) y + 1`, `y = x^2`, at the height `p`.
fn closed(zeta: f64) -> [f64; 4] {
    let b = 1.0 - 2.0 * zeta * zeta;
    let top = 1.0 / (2.0 * zeta * (1.0 - zeta * zeta).sqrt());
    let a = 1.0 - 2.0 / (top * top);
    let rest = (b * b - a).sqrt();
    [(1.0 / b).sqrt(), top, ((b - rest) / a).sqrt(), ((b + rest) / a).sqrt()]
}

/// The closed form to 1e-6, on coarse and fine samples alike.
#[test]
fn peaks_meet_their_closed_form() {
    for zeta in [0.005, 0.02, 0.05, 0.12, 0.18, 0.22] {
        let [speed, top, lower, upper] = closed(zeta);
        for count in [37, 400] {
            let found = peaks(&response(zeta), &samples(0.1, 3.0, count));
            assert_eq!(found.len(), 1);
            let what = format!("{zeta} on {count}");
            near(found[0].speed_rad_s, speed, 1e-6, &what);
            near(found[0].amplitude, top, 1e-9, &what);
            near(found[0].lower_speed_rad_s.expect("N1"), lower, 1e-7, &what);
            near(found[0].upper_speed_rad_s.expect("N2"), upper, 1e-7, &what);
            near(found[0].amplification_factor.expect("AF"), speed / (upper - lower), 1e-6, &what);
        }
    }
}

/// The reference values of amplification, required and actual margin.
#[test]
fn margins_meet_the_reference() {
    let kept: Value = serde_json::from_str(include_str!("../reference/response_peaks.json")).expect("values");
    for row in kept["values"].as_array().expect("rows") {
        let number = |key: &str| row[key].as_f64().expect("a number");
        let zeta = number("zeta");
        let found = peaks(&response(zeta), &samples(0.1, 3.0, 100));
        let peak = &found[0];
        let factor = peak.amplification_factor.expect("AF");
        // the reference took Nc from a grid of 400001 points, and AF with it
        near(peak.speed_rad_s, number("critical"), 1e-5, "Nc");
        near(factor, number("AF"), 1e-5, "AF");
        for (below, key, range, margin) in [
            (
                true,
                "SM_required_percent_below_min_speed",
                [1.3, 1.6],
                "operating 1.3..1.6 (critical below min)",
            ),
            (
                false,
                "SM_required_percent_above_max_speed",
                [0.5, 0.8],
                "operating 0.5..0.8 (critical above max)",
            ),
        ] {
            let required = required_margin(factor, below).unwrap_or(0.0);
            near(required, number(key), 1e-5, key);
            let actual = row["SM_actual_percent"][margin].as_f64().expect("a number");
            near(actual_margin(peak.speed_rad_s, range).expect("outside"), actual, 1e-4, margin);
            let verdict = separation(peak, range);
            assert_eq!(verdict.pass, actual >= required, "{verdict:?}");
            assert_eq!(verdict.limit.unwrap_or(0.0), required);
            near(verdict.value.expect("a margin"), actual, 1e-4, margin);
            assert!(verdict.edition.contains("API") && verdict.formula.contains("AF"));
        }
        let inside = separation(peak, [0.9, 1.2]);
        assert_eq!(inside.pass, factor < 2.5, "{inside:?}");
        assert!(inside.value.is_none());
    }
}

/// With the sweep ending on a flank, the other flank counts twice; with neither, nothing is defined and nothing passes.
#[test]
fn one_flank_stands_for_both() {
    let [speed, _, lower, upper] = closed(0.05);
    for (from, to, width) in [(0.5, 1.03, 2.0 * (speed - lower)), (0.98, 2.0, 2.0 * (upper - speed))] {
        let found = peaks(&response(0.05), &samples(from, to, 30));
        near(found[0].amplification_factor.expect("AF"), speed / width, 1e-5, "one-sided");
        assert!(found[0].lower_speed_rad_s.is_none() || found[0].upper_speed_rad_s.is_none());
    }
    let found = peaks(&response(0.05), &samples(0.98, 1.03, 30));
    assert!(found[0].amplification_factor.is_none());
    let verdict = separation(&found[0], [2.0, 3.0]);
    assert!(!verdict.pass && verdict.reason.contains("not defined"), "{verdict:?}");
    // an overdamped curve rises without a maximum
    assert!(peaks(&response(0.8), &samples(0.1, 5.0, 50)).is_empty());
    assert!(peaks(&response(0.1), &[]).is_empty() && peaks(&response(0.1), &[1.0, 2.0]).is_empty());
}

/// Two modes: each peak has its own flanks; a shoulder beside a higher peak ends where the curve rises above it.
#[test]
fn neighbours_do_not_share_flanks() {
    let pair = |gap: f64, zeta: f64| move |x: f64| response(zeta)(x) + 3.0 * response(zeta)(x / (1.0 + gap));
    let apart = peaks(&pair(1.0, 0.02), &samples(0.2, 4.0, 200));
    assert_eq!(apart.len(), 2);
    for peak in &apart {
        let [a, b] = [peak.lower_speed_rad_s, peak.upper_speed_rad_s].map(|x| x.expect("a flank"));
        assert!(a < peak.speed_rad_s && peak.speed_rad_s < b);
        for side in [a, b] {
            near(pair(1.0, 0.02)(side), FRAC_1_SQRT_2 * peak.amplitude, 1e-7, "a flank");
        }
    }
    assert!(apart[0].upper_speed_rad_s < apart[1].lower_speed_rad_s);
    let close = peaks(&pair(0.12, 0.03), &samples(0.2, 2.0, 400));
    assert_eq!(close.len(), 2);
    assert!(close[0].upper_speed_rad_s.is_none() && close[0].lower_speed_rad_s.is_some(), "{close:?}");
    assert!(close[1].upper_speed_rad_s.is_some());
}

/// Limits by hand: 6350 W/N, W/3.937, 25.4 sqrt(12000/N), three quarters of a clearance, a decrement of 0.1.
#[test]
fn limits_meet_their_formulas() {
    near(residual_unbalance_limit(200.0, 10_000.0 * RPM), 127.0, 1e-12, "Ur");
    near(residual_unbalance_limit(200.0, 40_000.0 * RPM), 200.0 / 3.937, 1e-12, "Ur at high speed");
    let [below, above] = [24_999.9, 25_000.1].map(|n| residual_unbalance_limit(1.0, n * RPM));
    near(below, above, 1e-5, "Ur is continuous");
    assert!(residual_unbalance(126.0, 200.0, 10_000.0 * RPM).pass);
    assert!(!residual_unbalance(128.0, 200.0, 10_000.0 * RPM).pass);
    near(amplitude_limit_um(6000.0 * RPM), 25.4, 1e-12, "Avl at low speed");
    near(amplitude_limit_um(48_000.0 * RPM), 12.7, 1e-12, "Avl");
    assert!(vibration(12.6, 48_000.0 * RPM).pass && !vibration(12.8, 48_000.0 * RPM).pass);
    near(scale_factor(12.7, 5.0), 2.54, 1e-12, "Scc");
    assert_eq!(scale_factor(12.7, 0.5), 6.0);
    let scaled = clearance(40.0, 2.54, 135.0);
    near(scaled.value.expect("scaled"), 101.6, 1e-12, "scaled amplitude");
    assert!(!scaled.pass && clearance(40.0, 2.54, 136.0).pass, "{scaled:?}");
    assert!(stability(0.11).pass && !stability(0.1).pass && !stability(-0.02).pass);
    // JSON holds no other numbers
    let peak = ResponsePeak {
        speed_rad_s: 1.0,
        amplitude: 1.0,
        lower_speed_rad_s: None,
        upper_speed_rad_s: None,
        amplification_factor: None,
    };
    assert!(serde_json::to_value(separation(&peak, [0.5, 2.0])).expect("JSON")["value"].is_null());
}

/// A rotor of 100 kg at 3000 rpm in G2.5: 795.8 g mm; planes share it as bearings share its weight.
#[test]
fn grades_are_permissible_unbalances() {
    near(
        permissible_unbalance(2.5e-3, 100.0, 3000.0 * RPM) * 1e6,
        2.5e3 * 100.0 / (100.0 * PI),
        1e-12,
        "G2.5",
    );
    let [a, b] = shares_of_planes(0.4, [0.1, 1.1]);
    near(a, 0.7, 1e-12, "the near plane");
    near(b, 0.3, 1e-12, "the far plane");
    // the couple about the centre vanishes for equal angles
    assert!((a * 0.3 - b * 0.7).abs() < 1e-12);
    assert_eq!(shares_of_planes(0.4, [0.4, 1.0]), [1.0, 0.0]);
    assert_eq!(shares_of_planes(0.4, [0.4, 0.4]), [0.5, 0.5]);
}
