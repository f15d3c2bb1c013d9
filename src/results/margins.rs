//! Peaks of a response over speed and how they are judged.

use serde::Serialize;

/// A maximum of a response over speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ResponsePeak {
    /// Speed of the maximum, Nc.
    pub speed_rad_s: f64,
    /// Largest response, in the unit of the curve.
    pub amplitude: f64,
    /// Speed below the maximum at which the response has fallen to 1/sqrt 2 of it, N1; null where it does not.
    pub lower_speed_rad_s: Option<f64>,
    /// The same above the maximum, N2.
    pub upper_speed_rad_s: Option<f64>,
    /// Nc/(N2 - N1); with one of both speeds missing, twice the distance to the other one stands for their difference. Null with
    /// both missing.
    pub amplification_factor: Option<f64>,
}

/// A number held against a rule.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Name of the rule.
    pub rule: &'static str,
    /// Standard and edition that the rule is taken from.
    pub edition: &'static str,
    /// The rule as a formula.
    pub formula: &'static str,
    /// What was found; null where it is not defined.
    pub value: Option<f64>,
    /// What is required or allowed; null where the rule asks for nothing.
    pub limit: Option<f64>,
    /// Unit of both.
    pub unit: &'static str,
    /// Whether the rule is met.
    pub pass: bool,
    /// Why, in a sentence.
    pub reason: String,
}
