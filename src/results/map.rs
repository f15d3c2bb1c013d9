//! Results of the map of critical speeds.

use crate::results::{OperatingRange, Whirl};
use serde::Serialize;

/// Results of `rotor map`.
#[derive(Debug, Clone, Serialize)]
pub struct CriticalMap {
    /// Stiffness of the supports.
    #[serde(rename = "stiffness_N_m")]
    pub stiffness_n_m: Vec<f64>,
    /// Paths of the bearings that take it.
    pub bearings: Vec<String>,
    /// Undamped critical speeds, those of forward whirl before those of backward whirl.
    pub curves: Vec<MapCurve>,
    /// Stiffness of the bearings of the case over speed.
    pub bearing_curves: Vec<BearingCurve>,
    /// Where curves of critical speeds and of bearings meet.
    pub intersections: Vec<Intersection>,
    /// Decay over a cross-coupled stiffness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cross_coupling: Option<CrossCouplingCurve>,
    /// Speeds at which the machine runs, where the case says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operating_speed: Option<OperatingRange>,
    /// Largest relative difference of a critical speed to the unreduced one at the ends and in the middle of the stiffnesses.
    pub measured_error: f64,
}

/// A critical speed over the stiffness of the supports.
#[derive(Debug, Clone, Serialize)]
pub struct MapCurve {
    /// Sense of whirl.
    pub whirl: Whirl,
    /// Number among those of its sense, from 1.
    pub n: usize,
    /// Critical speeds; null where there are not so many.
    pub critical_rad_s: Vec<Option<f64>>,
    /// The same on supports that do not give way.
    pub rigid_rad_s: Option<f64>,
}

/// A direct stiffness of a bearing over speed.
#[derive(Debug, Clone, Serialize)]
pub struct BearingCurve {
    /// JSON path.
    pub bearing: String,
    /// "yy" or "zz".
    pub direction: &'static str,
    /// Speeds: those of the table, or the ends of the map.
    pub speed_rad_s: Vec<f64>,
    /// Stiffness there.
    #[serde(rename = "stiffness_N_m")]
    pub stiffness_n_m: Vec<f64>,
}

/// A speed at which a bearing has the stiffness at which that speed is critical.
#[derive(Debug, Clone, Serialize)]
pub struct Intersection {
    /// Sense of whirl of the curve.
    pub whirl: Whirl,
    /// Its number.
    pub n: usize,
    /// JSON path of the bearing.
    pub bearing: String,
    /// "yy" or "zz".
    pub direction: &'static str,
    /// The speed.
    pub speed_rad_s: f64,
    /// The stiffness.
    #[serde(rename = "stiffness_N_m")]
    pub stiffness_n_m: f64,
}

/// Log decrement of the first forward motion over a cross-coupled stiffness.
#[derive(Debug, Clone, Serialize)]
pub struct CrossCouplingCurve {
    /// Where it acts, m.
    pub at: f64,
    /// Speed of the rotor.
    pub speed_rad_s: f64,
    /// Values Q of `[[0, Q], [-Q, 0]]`.
    #[serde(rename = "stiffness_N_m")]
    pub stiffness_n_m: Vec<f64>,
    /// Log decrement of the first forward motion; null where none oscillates.
    pub log_decrement: Vec<Option<f64>>,
    /// The Q at which a motion begins to grow; null beyond the values.
    #[serde(rename = "threshold_N_m")]
    pub threshold_n_m: Option<f64>,
}
