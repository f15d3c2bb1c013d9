//! Peaks of a response over speed, and the rules that they, unbalance and vibration are judged by.
//!
//! Everything here is a function of plain numbers; formulas and editions stand in the verdicts. Source:
//! docs/theory/margins.md.

use crate::results::{ResponsePeak, Verdict};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Amplification factor below which a peak counts as critically damped.
pub const CRITICALLY_DAMPED: f64 = 2.5;
/// Largest factor by which a measured amplitude is scaled to that of the vibration limit.
pub const LARGEST_SCALE: f64 = 6.0;
/// Share of a clearance that a scaled amplitude may take.
pub const SHARE_OF_CLEARANCE: f64 = 0.75;
/// Least logarithmic decrement of the first forward mode in a level I analysis.
pub const LEAST_DECREMENT: f64 = 0.1;

const EDITION_MARGIN: &str = "API 617, 8th edition, with API RP 684, SP6.8.2.1 and SP6.8.2.10";
const EDITION_UNBALANCE: &str = "API 617, 9th edition, 6.8.2.7";
const EDITION_CLEARANCE: &str = "API 617, 9th edition, 6.8.2.11";
const EDITION_STABILITY: &str = "API 617, 8th edition, with API RP 684, level I";

/// Relative width at which the search for a maximum or a crossing ends.
const WIDTH: f64 = 1e-9;

fn rpm(speed_rad_s: f64) -> f64 {
    speed_rad_s * 30.0 / PI
}

/// Maxima of a response over speed (rad/s), found between ascending samples and refined, with the speeds at 1/sqrt 2 of each.
///
/// A maximum is seen where one sample is higher than its neighbours; so the samples need the damped critical speeds among them, and
/// points between. Maxima at the first or last sample are none. From a maximum the curve is followed down to 1/sqrt 2 of it; where
/// it rises above the maximum first, or the samples end, there is no such speed.
pub fn peaks(amplitude: &dyn Fn(f64) -> f64, samples: &[f64]) -> Vec<ResponsePeak> {
    let values: Vec<f64> = samples.iter().map(|speed| amplitude(*speed)).collect();
    let inside = 1..samples.len().saturating_sub(1);
    let high = |k: &usize| values[*k] > values[k - 1] && values[*k] >= values[k + 1];
    inside.filter(high).map(|k| peak(amplitude, samples, &values, k)).collect()
}

/// The maximum around the k-th sample.
fn peak(amplitude: &dyn Fn(f64) -> f64, samples: &[f64], values: &[f64], k: usize) -> ResponsePeak {
    let (speed, top) = maximum(amplitude, [samples[k - 1], samples[k], samples[k + 1]], values[k]);
    let level = top * FRAC_1_SQRT_2;
    let crossing = |side: &mut dyn Iterator<Item = usize>| {
        let mut near = speed;
        for i in side {
            if values[i] <= level {
                return Some(root(&|x| amplitude(x) - level, samples[i], near));
            }
            if values[i] > top {
                return None;
            }
            near = samples[i];
        }
        None
    };
    let lower = crossing(&mut (0..k).rev());
    let upper = crossing(&mut (k + 1..samples.len()));
    let width = match (lower, upper) {
        (Some(a), Some(b)) => Some(b - a),
        (Some(a), None) => Some(2.0 * (speed - a)),
        (None, Some(b)) => Some(2.0 * (b - speed)),
        (None, None) => None,
    };
    ResponsePeak {
        speed_rad_s: speed,
        amplitude: top,
        lower_speed_rad_s: lower,
        upper_speed_rad_s: upper,
        amplification_factor: width.filter(|width| *width > 0.0).map(|width| speed / width),
    }
}

/// Place and height of the maximum between the outer of three places, by golden sections.
fn maximum(f: &dyn Fn(f64) -> f64, [mut low, mid, mut high]: [f64; 3], at_mid: f64) -> (f64, f64) {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (f(a), f(b));
    while high - low > WIDTH * high.abs() && low < a && a < b && b < high {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = f(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = f(b);
        }
    }
    let found = if at_a > at_b { (a, at_a) } else { (b, at_b) };
    if found.1 > at_mid { found } else { (mid, at_mid) }
}

/// Root of a function that changes its sign between two places, by false position with halved ordinates (Illinois).
fn root(f: &dyn Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const MOST_STEPS: usize = 100;
    let (mut a, mut b) = ((from, f(from)), (to, f(to)));
    for _ in 0..MOST_STEPS {
        if b.1 == a.1 {
            break;
        }
        let x = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
        let (y, step) = (f(x), x - b.0);
        if y * b.1 < 0.0 {
            a = b;
        } else {
            a.1 /= 2.0;
        }
        b = (x, y);
        if y == 0.0 || step.abs() <= WIDTH * x.abs() {
            break;
        }
    }
    b.0
}

/// Required separation margin of a peak with an amplification factor, percent: below the least speed
/// `min(16, 17 (1 - 1/(AF - 1.5)))`, above the largest one `min(26, 10 + 17 (1 - 1/(AF - 1.5)))`; none for AF below 2.5.
pub fn required_margin(amplification_factor: f64, below: bool) -> Option<f64> {
    let damped = !(amplification_factor >= CRITICALLY_DAMPED);
    let common = 17.0 * (1.0 - 1.0 / (amplification_factor - 1.5));
    let margin = if below { common.min(16.0) } else { (10.0 + common).min(26.0) };
    (!damped).then_some(margin)
}

/// Distance of a speed from a range of speeds, percent of the least speed for one below and of the largest for one above; none
/// inside.
pub fn actual_margin(speed: f64, [minimum, maximum]: [f64; 2]) -> Option<f64> {
    if speed < minimum {
        Some(100.0 * (minimum - speed) / minimum)
    } else if speed > maximum {
        Some(100.0 * (speed - maximum) / maximum)
    } else {
        None
    }
}

/// Whether a peak stands far enough from the operating speeds, rad/s.
pub fn separation(peak: &ResponsePeak, [minimum, maximum]: [f64; 2]) -> Verdict {
    let speed = peak.speed_rad_s;
    let below = speed < minimum;
    let value = actual_margin(speed, [minimum, maximum]);
    let formula = match value {
        Some(_) if below => "(Nmin - Nc)/Nmin >= min(16 %, 17 % (1 - 1/(AF - 1.5))); AF < 2.5: none required",
        Some(_) => "(Nc - Nmax)/Nmax >= min(26 %, 10 % + 17 % (1 - 1/(AF - 1.5))); AF < 2.5: none required",
        None => "no peak with AF >= 2.5 from Nmin to Nmax",
    };
    let limit = peak.amplification_factor.and_then(|factor| required_margin(factor, below));
    let at = format!("the peak at {:.1} rpm", rpm(speed));
    let (pass, reason) = match (peak.amplification_factor, limit, value) {
        (None, ..) => {
            let why = "does not fall to 0.707 of its height on either side: its amplification factor is not defined";
            (false, format!("{at} {why}"))
        }
        (Some(factor), None, _) => {
            (true, format!("{at} is critically damped: AF {factor:.2} is below {CRITICALLY_DAMPED}"))
        }
        (Some(factor), Some(_), None) => {
            (false, format!("{at} lies within the operating speeds with AF {factor:.2}"))
        }
        (Some(factor), Some(limit), Some(value)) => {
            let (pass, side) = (value >= limit, if below { "below" } else { "above" });
            let is = if pass { "meets" } else { "misses" };
            (
                pass,
                format!(
                    "{at} with AF {factor:.2} is {value:.1} % {side} the operating speeds and {is} {limit:.1} %"
                ),
            )
        }
    };
    let limit = if value.is_some() { limit } else { None };
    Verdict {
        rule: "separation margin",
        edition: EDITION_MARGIN,
        formula,
        value,
        limit,
        unit: "%",
        pass,
        reason,
    }
}

/// A verdict on a value that must not be larger than a limit.
fn at_most(value: f64, limit: f64, what: &str, unit: &str) -> (bool, String) {
    let pass = value <= limit;
    let is = if pass { "within" } else { "above" };
    (pass, format!("{what} of {value:.4} {unit} is {is} {limit:.4} {unit}"))
}

/// Largest residual unbalance at a journal, g mm: `Ur = 6350 W/N` up to 25000 rpm, `W/3.937` above, with the journal's static load
/// W (kg) and the maximum continuous speed (rad/s).
pub fn residual_unbalance_limit(load_kg: f64, speed_rad_s: f64) -> f64 {
    load_kg * (6350.0 / rpm(speed_rad_s)).max(1.0 / 3.937)
}

/// Whether a residual unbalance (g mm) is small enough for a journal's static load (kg) and maximum continuous speed (rad/s).
pub fn residual_unbalance(unbalance_g_mm: f64, load_kg: f64, speed_rad_s: f64) -> Verdict {
    let limit = residual_unbalance_limit(load_kg, speed_rad_s);
    let (pass, reason) = at_most(unbalance_g_mm, limit, "the residual unbalance", "g mm");
    Verdict {
        rule: "residual unbalance",
        edition: EDITION_UNBALANCE,
        formula: "U <= 6350 W/N, from 25000 rpm W/3.937 (g mm, W kg, N rpm)",
        value: Some(unbalance_g_mm),
        limit: Some(limit),
        unit: "g mm",
        pass,
        reason,
    }
}

/// Vibration limit at a maximum continuous speed (rad/s), um peak-to-peak: `Avl = min(25.4, 25.4 sqrt(12000/N))`, N in rpm.
pub fn amplitude_limit_um(speed_rad_s: f64) -> f64 {
    25.4 * (12_000.0 / rpm(speed_rad_s)).sqrt().min(1.0)
}

/// Whether an amplitude (um peak-to-peak, major axis) is within the vibration limit at a maximum continuous speed (rad/s).
pub fn vibration(amplitude_um: f64, speed_rad_s: f64) -> Verdict {
    let limit = amplitude_limit_um(speed_rad_s);
    let (pass, reason) = at_most(amplitude_um, limit, "the amplitude", "um peak-to-peak");
    Verdict {
        rule: "vibration limit",
        edition: EDITION_CLEARANCE,
        formula: "A <= min(25.4 um, 25.4 um sqrt(12000/N)), peak-to-peak, N in rpm",
        value: Some(amplitude_um),
        limit: Some(limit),
        unit: "um peak-to-peak",
        pass,
        reason,
    }
}

/// Factor that scales a response to the vibration limit: `Scc = Avl/Amax`, at most 6; both in one unit.
pub fn scale_factor(limit: f64, largest_amplitude: f64) -> f64 {
    (limit / largest_amplitude).min(LARGEST_SCALE)
}

/// Whether the largest amplitude anywhere up to trip speed, scaled, leaves a clearance open: `Scc A <= 0.75` of the least
/// diametral clearance, both um, the amplitude peak-to-peak along the major axis; `scale` from [`scale_factor`].
pub fn clearance(amplitude_um: f64, scale: f64, diametral_clearance_um: f64) -> Verdict {
    let (value, limit) = (scale * amplitude_um, SHARE_OF_CLEARANCE * diametral_clearance_um);
    let (pass, reason) = at_most(value, limit, "the scaled amplitude", "um");
    Verdict {
        rule: "clearance",
        edition: EDITION_CLEARANCE,
        formula: "Scc A <= 0.75 of the diametral clearance, Scc = Avl/Amax, at most 6",
        value: Some(value),
        limit: Some(limit),
        unit: "um",
        pass,
        reason,
    }
}

/// Whether the logarithmic decrement of the first forward mode is above 0.1.
pub fn stability(log_decrement: f64) -> Verdict {
    let pass = log_decrement > LEAST_DECREMENT;
    let is = if pass { "is" } else { "is not" };
    Verdict {
        rule: "stability, level I",
        edition: EDITION_STABILITY,
        formula: "logarithmic decrement > 0.1",
        value: Some(log_decrement),
        limit: Some(LEAST_DECREMENT),
        unit: "1",
        pass,
        reason: format!("the logarithmic decrement of {log_decrement:.3} {is} above {LEAST_DECREMENT}"),
    }
}

/// Permissible residual unbalance of a rotor, kg m: `U = G m/Omega` with the balance quality grade as the speed of the centre of
/// mass (m/s; 2.5e-3 for G2.5), the mass (kg) and the largest speed (rad/s). ISO 21940-11:2016.
pub fn permissible_unbalance(grade_m_s: f64, mass_kg: f64, speed_rad_s: f64) -> f64 {
    grade_m_s * mass_kg / speed_rad_s
}

/// Shares of two planes in a permissible unbalance: inversely as their distances from the centre of mass (positions along the
/// shaft, m), `U_a/U_b = L_b/L_a`, as a static load between two bearings is shared. Halves where both stand at the centre.
pub fn shares_of_planes(centre: f64, planes: [f64; 2]) -> [f64; 2] {
    let [a, b] = planes.map(|x| (x - centre).abs());
    if a + b > 0.0 { [b / (a + b), a / (a + b)] } else { [0.5; 2] }
}
