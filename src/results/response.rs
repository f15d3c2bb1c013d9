//! Results of steady vibration: unbalance and harmonic excitation.

use crate::results::{Verdict, Whirl};
use serde::Serialize;
use std::collections::BTreeMap;

/// Results of `rotor unbalance`.
#[derive(Debug, Clone, Serialize)]
pub struct UnbalanceResponse {
    /// "classical" or "consistent".
    pub form: &'static str,
    /// How displacements are told: "peak-to-peak" (whole axes of orbits) or "zero-to-peak" (semi-axes). Forces and stresses are
    /// always from zero to peak.
    pub amplitude: &'static str,
    /// What excites.
    pub masses: Vec<UnbalanceMass>,
    /// Speeds at which the machine runs, where the case says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operating_speed: Option<OperatingRange>,
    /// Speeds asked for, rad/s.
    pub speeds_rad_s: Vec<f64>,
    /// Response at every station.
    pub stations: Vec<StationResponse>,
    /// Peaks of every station, by ascending speed.
    pub peaks: Vec<Peak>,
    /// What the standards say, where the case has operating speeds.
    pub margins: Vec<Margin>,
    /// What bearings and housings carry, by JSON path.
    #[serde(rename = "bearing_forces_N")]
    pub bearing_forces_n: BTreeMap<String, ForceResponse>,
    /// The deflected shaft at the speeds asked for and at the peaks.
    pub shapes: Vec<DeflectedShape>,
    /// Lowest speed at which a motion grows, where there is one: beyond it the response is never reached.
    pub stability_threshold_rad_s: Option<f64>,
    /// Largest difference of the reduced and the unreduced response where both were solved, over the largest displacement.
    pub measured_error: f64,
    /// Curves with speeds added around the peaks, for the figure: amplitude and phase over speed for each station.
    #[serde(skip)]
    pub fine: Vec<Vec<[f64; 3]>>,
}

/// Results of `rotor harmonic`.
#[derive(Debug, Clone, Serialize)]
pub struct HarmonicResponse {
    /// "classical" or "consistent".
    pub form: &'static str,
    /// How displacements are told: "peak-to-peak" (whole axes of orbits) or "zero-to-peak" (semi-axes). Forces and stresses are
    /// always from zero to peak.
    pub amplitude: &'static str,
    /// Speed at which the rotor turns.
    pub spin_speed_rad_s: f64,
    /// Frequencies asked for, rad/s.
    pub frequencies_rad_s: Vec<f64>,
    /// Response at every station, absolute also where the ground moves.
    pub stations: Vec<StationResponse>,
    /// What bearings and housings carry, by JSON path.
    #[serde(rename = "bearing_forces_N")]
    pub bearing_forces_n: BTreeMap<String, ForceResponse>,
    /// Lowest speed below that of the rotor at which a motion grows, where there is one.
    pub stability_threshold_rad_s: Option<f64>,
    /// Largest difference of the reduced and the unreduced response where both were solved, over the largest displacement.
    pub measured_error: f64,
}

/// Speeds at which the machine runs.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct OperatingRange {
    /// Lowest speed of continuous operation.
    pub minimum_rad_s: f64,
    /// Highest speed of continuous operation.
    pub maximum_rad_s: f64,
    /// Speed at which the machine is stopped.
    pub trip_rad_s: Option<f64>,
}

/// A mass beside the axis.
#[derive(Debug, Clone, Serialize)]
pub struct UnbalanceMass {
    /// Position along the shaft, m.
    pub at: f64,
    /// Mass times radius.
    pub moment_kg_m: f64,
    /// Direction at angle zero of the rotation, from y towards z.
    pub angle_rad: f64,
    /// JSON path.
    pub path: String,
}

/// Response at a station, one value for each speed or frequency.
#[derive(Debug, Clone, Default, Serialize)]
pub struct StationResponse {
    /// Name.
    pub name: String,
    /// Position along the shaft, m.
    pub at: f64,
    /// Direction in which the sensor looks, from y towards z; null without one.
    pub angle_rad: Option<f64>,
    /// Amplitude along the sensor's direction, else the major axis.
    pub amplitude_m: Vec<f64>,
    /// Phase of that direction, else of the forward circle of the orbit: positive ahead of the unbalance at angle zero (of the
    /// excitation at phase zero), so that a lag is negative.
    pub phase_rad: Vec<f64>,
    /// Major axis of the orbit.
    pub major_axis_m: Vec<f64>,
    /// Minor axis of the orbit, negative for backward whirl.
    pub minor_axis_m: Vec<f64>,
    /// Angle of the major axis from y towards z; null for a circle.
    pub inclination_rad: Vec<Option<f64>>,
    /// Sense of the orbit.
    pub whirl: Vec<Whirl>,
    /// Largest axial stress at the surface around the section; null under a rigid hub.
    pub bending_stress_pa: Vec<Option<f64>>,
    /// Amplitude of the part that alternates in the material, twice a turn: of the backward circle.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub alternating_stress_pa: Vec<Option<f64>>,
}

/// Force that a bearing carries, from zero to peak.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ForceResponse {
    /// Position along the shaft, m.
    pub at: f64,
    /// Amplitude along y.
    #[serde(rename = "y_N")]
    pub y_n: Vec<f64>,
    /// Phase of that.
    pub y_phase_rad: Vec<f64>,
    /// Amplitude along z.
    #[serde(rename = "z_N")]
    pub z_n: Vec<f64>,
    /// Phase of that.
    pub z_phase_rad: Vec<f64>,
    /// Largest force in any direction.
    #[serde(rename = "major_N")]
    pub major_n: Vec<f64>,
}

/// A maximum of the response of a station over speed.
#[derive(Debug, Clone, Serialize)]
pub struct Peak {
    /// Name of the station.
    pub station: String,
    /// Its position, m.
    pub at: f64,
    /// Speed of the maximum.
    pub speed_rad_s: f64,
    /// The same in rpm.
    pub speed_rpm: f64,
    /// Amplitude there, as told.
    pub amplitude_m: f64,
    /// Phase there.
    pub phase_rad: f64,
    /// Speeds below and above at which the amplitude is 0.707 of it; null where there is none.
    pub half_power_rad_s: [Option<f64>; 2],
    /// Speed over the distance of these.
    pub amplification_factor: Option<f64>,
    /// Distance from the operating speeds, percent of the minimum (below) or the maximum (above); null within, and without operating
    /// speeds.
    pub separation_margin_percent: Option<f64>,
    /// Distance that the standard asks for; null where it asks for none.
    pub required_percent: Option<f64>,
    /// Whether the standard is met; null without operating speeds.
    pub pass: Option<bool>,
}

/// A verdict and what it is about.
#[derive(Debug, Clone, Serialize)]
pub struct Margin {
    /// Station, clearance or motion.
    pub subject: String,
    /// What was found, what is asked for, and by which rule.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// The deflected shaft at a speed: complex amplitudes from zero to peak at element ends.
#[derive(Debug, Clone, Serialize)]
pub struct DeflectedShape {
    /// Speed.
    pub speed_rad_s: f64,
    /// Whether it is that of a peak.
    pub at_peak: bool,
    /// Positions along the shaft.
    pub x_m: Vec<f64>,
    /// Major semi-axis of the orbit.
    pub major_m: Vec<f64>,
    /// Minor semi-axis, negative for backward whirl.
    pub minor_m: Vec<f64>,
    /// Real and imaginary part along y.
    pub y_m: Vec<[f64; 2]>,
    /// Real and imaginary part along z.
    pub z_m: Vec<[f64; 2]>,
}
