//! What a Campbell diagram shows: branches as curves, critical speeds, excitation lines, and the ranges of the axes.

use std::f64::consts::TAU;

use crate::draw::text::significant;
use crate::results::{Branch, Campbell, CriticalSpeed, Whirl};

/// Rounding alone must not mark a neutral branch as unstable.
const UNSTABLE_BELOW: f64 = -1e-9;
/// Revolutions per minute to a radian per second.
pub const RPM: f64 = 60.0 / TAU;

/// A point of a branch.
#[derive(Debug, Clone, Copy)]
pub struct Sampled {
    /// Spin speed, rpm.
    pub rpm: f64,
    /// Whirl frequency, Hz.
    pub hz: f64,
    /// Whether it grows.
    pub unstable: bool,
    /// Sense of the orbit at this speed.
    pub whirl: Whirl,
}

/// A branch as unbroken stretches.
pub struct BranchCurve<'a> {
    /// The branch of the report that the curve shows.
    pub branch: &'a Branch,
    /// Points between which it has no gap, by ascending speed.
    pub stretches: Vec<Vec<Sampled>>,
}

impl<'a> BranchCurve<'a> {
    /// The branch over these speeds, rad/s.
    pub fn new(branch: &'a Branch, speeds: &[f64]) -> Self {
        let mut stretches: Vec<Vec<Sampled>> = vec![Vec::new()];
        for (index, (speed, frequency)) in speeds.iter().zip(&branch.frequency_rad_s).enumerate() {
            let unstable =
                branch.log_decrement.get(index).copied().flatten().is_some_and(|d| d < UNSTABLE_BELOW);
            match frequency {
                Some(frequency) if frequency.is_finite() && speed.is_finite() => {
                    let whirl = branch.whirl_at_speed.get(index).copied().unwrap_or(branch.whirl);
                    let sampled = Sampled { rpm: speed * RPM, hz: frequency / TAU, unstable, whirl };
                    if let Some(stretch) = stretches.last_mut() {
                        stretch.push(sampled);
                    }
                }
                _ => stretches.push(Vec::new()),
            }
        }
        stretches.retain(|stretch| !stretch.is_empty());
        Self { branch, stretches }
    }

    /// All its points.
    pub fn samples(&self) -> impl Iterator<Item = &Sampled> {
        self.stretches.iter().flatten()
    }

    /// Sense at the highest speed at which it is drawn.
    pub fn last_whirl(&self) -> Whirl {
        self.samples().last().map_or(self.branch.whirl, |sampled| sampled.whirl)
    }

    /// Stretches of one sense; neighbours meet halfway between the speeds at which they differ.
    pub fn by_whirl(&self) -> Vec<(Whirl, Vec<Sampled>)> {
        let mut runs: Vec<(Whirl, Vec<Sampled>)> = Vec::new();
        for stretch in &self.stretches {
            let mut before: Option<Sampled> = None;
            for &sampled in stretch {
                match (before, runs.last_mut()) {
                    (Some(_), Some((whirl, run))) if *whirl == sampled.whirl => run.push(sampled),
                    (Some(last), Some((_, run))) => {
                        let halfway = |whirl| Sampled {
                            rpm: (last.rpm + sampled.rpm) / 2.0,
                            hz: (last.hz + sampled.hz) / 2.0,
                            unstable: sampled.unstable,
                            whirl,
                        };
                        run.push(halfway(last.whirl));
                        runs.push((sampled.whirl, vec![halfway(sampled.whirl), sampled]));
                    }
                    _ => runs.push((sampled.whirl, vec![sampled])),
                }
                before = Some(sampled);
            }
        }
        runs
    }

    /// Highest frequency, Hz.
    pub fn highest(&self) -> Option<f64> {
        self.samples().map(|sampled| sampled.hz).reduce(f64::max)
    }

    /// Whether it grows anywhere.
    pub fn is_unstable(&self) -> bool {
        self.samples().any(|sampled| sampled.unstable)
    }

    /// Its name and its frequency at rest, or at the speed nearest to rest.
    pub fn words(&self) -> String {
        let name = &self.branch.name;
        let Some(first) = self.samples().min_by(|a, b| a.rpm.abs().total_cmp(&b.rpm.abs())) else {
            return name.clone();
        };
        let hz = significant(first.hz, 5);
        match first.rpm {
            0.0 => format!("{name}: {hz} Hz at rest"),
            rpm => format!("{name}: {hz} Hz at {} rpm", significant(rpm, 5)),
        }
    }

    /// Frequency (Hz) at a speed (rpm) inside one of the stretches.
    pub fn at(&self, rpm: f64) -> Option<f64> {
        let pairs = self.stretches.iter().flat_map(|stretch| stretch.windows(2));
        let around = pairs.map(|pair| (pair[0], pair[1])).find(|(a, b)| a.rpm <= rpm && rpm <= b.rpm);
        around.map(|(a, b)| {
            let fraction = if b.rpm > a.rpm { (rpm - a.rpm) / (b.rpm - a.rpm) } else { 0.0 };
            a.hz + fraction * (b.hz - a.hz)
        })
    }
}

/// A critical speed as drawn.
pub struct CurveMark<'a> {
    /// The critical speed.
    pub critical: &'a CriticalSpeed,
    /// Spin speed, rpm.
    pub rpm: f64,
    /// Whirl frequency, Hz.
    pub hz: f64,
}

impl CurveMark<'_> {
    /// Its number, its speed, its sense and its branch.
    pub fn words(&self, number: usize) -> String {
        let [rpm, hz] = [self.rpm, self.rpm / 60.0].map(|speed| significant(speed, 5));
        let critical = self.critical;
        let sense = match critical.whirl {
            Whirl::Forward => ", forward whirl",
            Whirl::Backward => ", backward whirl",
            Whirl::Mixed => ", mixed whirl",
            Whirl::None => "",
        };
        let branch = critical.branch.as_ref().map_or(String::new(), |name| format!(", {name}"));
        let damped = if critical.damped { ", damped" } else { "" };
        format!("critical speed {number}: {rpm} rpm ({hz} Hz){sense}{branch}{damped}")
    }
}

/// An excitation line `frequency = slope * speed`.
pub struct Order {
    /// Hz to an rpm, times 60.
    pub slope: f64,
    /// Name of the branch beside its curve.
    pub label: String,
}

/// Critical speeds with the frequency at which they are drawn. In the stationary frame this is the speed itself; in
/// the rotating frame it is the branch's own frequency there, or else what the frame's rotation makes of the speed.
pub fn marks<'a>(results: &'a Campbell, curves: &[BranchCurve]) -> Vec<CurveMark<'a>> {
    let usable = results.critical_speeds.iter().filter(|critical| critical.speed_rpm.is_finite());
    usable
        .map(|critical| {
            let rpm = critical.speed_rpm;
            let seen = match critical.whirl {
                _ if results.frame != "rotating" => 1.0,
                Whirl::Forward => 0.0,
                Whirl::Backward => 2.0,
                Whirl::Mixed | Whirl::None => 1.0,
            };
            let own = curves.iter().find(|curve| Some(&curve.branch.name) == critical.branch.as_ref());
            let on_branch = own.filter(|_| results.frame == "rotating").and_then(|curve| curve.at(rpm));
            CurveMark { critical, rpm, hz: on_branch.unwrap_or(seen * rpm.abs() / 60.0) }
        })
        .collect()
}

/// Excitation lines. Seen from the rotating frame, an excitation at n times the speed is (n - 1) times the speed for
/// forward and (n + 1) times for backward whirl; its forward 1x is the zero line. A force fixed in space, gravity,
/// turns backward at the speed itself.
pub fn orders(results: &Campbell) -> Vec<Order> {
    let further =
        results.orders.iter().copied().filter(|order| order.is_finite() && *order > 0.0 && *order != 1.0);
    let factors: Vec<f64> = std::iter::once(1.0).chain(further).collect();
    if results.frame != "rotating" {
        return factors.into_iter().map(|slope| Order { slope, label: format!("{slope}x") }).collect();
    }
    let mut orders: Vec<Order> = vec![Order { slope: 1.0, label: "gravity".to_owned() }];
    for factor in factors {
        for (slope, sense) in [((factor - 1.0).abs(), "fwd"), (factor + 1.0, "bwd")] {
            let label = format!("{factor}x {sense}");
            match orders.iter_mut().find(|order| order.slope == slope) {
                Some(order) => order.label += &format!(", {label}"),
                None if slope > 0.0 => orders.push(Order { slope, label }),
                None => {}
            }
        }
    }
    orders
}

/// Lowest and highest speed in rpm, widened if there is only one.
pub fn speed_range(speeds: &[f64]) -> (f64, f64) {
    let finite = || speeds.iter().copied().filter(|speed| speed.is_finite()).map(|speed| speed * RPM);
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    if low > high {
        return (0.0, 1.0);
    }
    let largest = low.abs().max(high.abs());
    if high - low > 1e-9 * largest {
        return (low, high);
    }
    let half = if largest > 0.0 { 0.5 * largest } else { 1.0 };
    (low - half, high + half)
}

/// Upper end of the frequency axis: all branches, unless some lie so high that they would squeeze the others; all
/// critical speeds in any case. The speed itself (`one_x`) only loosens the limit.
pub fn top_frequency(curves: &[BranchCurve], highest_critical: f64, one_x: f64) -> f64 {
    let mut highest: Vec<f64> = curves.iter().filter_map(BranchCurve::highest).collect();
    highest.sort_by(f64::total_cmp);
    let median = highest.get(highest.len() / 2).copied().unwrap_or(0.0);
    let limit = (5.0 * one_x).max(8.0 * median);
    let branches = highest.into_iter().filter(|&hz| hz <= limit).fold(0.0, f64::max);
    let top = branches.max(highest_critical);
    let shown = if top > 0.0 { top } else { one_x };
    if shown > 0.0 { (1.07 * shown).min(f64::MAX / 1e3) } else { 1.0 }
}
