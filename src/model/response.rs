//! Settings of steady vibration, checked.

use crate::case::{AmplitudeInput, Form};
use std::f64::consts::{PI, TAU};

/// Speeds at which the machine runs, rad/s: minimum, maximum and, where it has one, that of the trip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatingSpeed {
    /// Lowest speed of continuous operation.
    pub minimum: f64,
    /// Highest speed of continuous operation.
    pub maximum: f64,
    /// Speed at which the machine is stopped.
    pub trip: Option<f64>,
}

/// A gap between the rotor and its surroundings.
#[derive(Debug, Clone, PartialEq)]
pub struct Clearance {
    /// Name in reports.
    pub name: String,
    /// Position along the shaft, m.
    pub x: f64,
    /// Radial gap at standstill, m.
    pub gap: f64,
}

/// Where a response is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// Name in reports.
    pub name: String,
    /// Position along the shaft, m.
    pub x: f64,
    /// Direction in which a sensor looks, from y towards z, rad.
    pub angle: Option<f64>,
}

/// A mass beside the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Unbalance {
    /// Position along the shaft, m.
    pub x: f64,
    /// Mass times radius, kg m.
    pub moment: f64,
    /// Direction at angle zero of the rotation, from y towards z, rad.
    pub angle: f64,
    /// JSON path, or what it comes from.
    pub path: String,
    /// That of a disk with an offset, which the mass matrix of the disk holds.
    pub of_disk: bool,
}

/// How amplitudes are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Amplitude {
    /// From one extreme to the other.
    PeakToPeak,
    /// From the middle to an extreme.
    ZeroToPeak,
}

impl From<AmplitudeInput> for Amplitude {
    fn from(input: AmplitudeInput) -> Self {
        match input {
            AmplitudeInput::PeakToPeak => Self::PeakToPeak,
            AmplitudeInput::ZeroToPeak => Self::ZeroToPeak,
        }
    }
}

impl Amplitude {
    /// What an amplitude from the middle to an extreme is multiplied by.
    pub fn factor(self) -> f64 {
        match self {
            Self::PeakToPeak => 2.0,
            Self::ZeroToPeak => 1.0,
        }
    }

    /// Name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PeakToPeak => "peak-to-peak",
            Self::ZeroToPeak => "zero-to-peak",
        }
    }
}

/// Settings of unbalance.
#[derive(Debug, Clone, PartialEq)]
pub struct UnbalanceSettings {
    /// Speeds of the analysis, ascending, rad/s; none where the masses serve a run-up only.
    pub speeds: Vec<f64>,
    /// All masses beside the axis, those of offset disks and of a grade among them.
    pub masses: Vec<Unbalance>,
    /// Where the response is read.
    pub stations: Vec<Station>,
    /// How amplitudes are told.
    pub amplitude: Amplitude,
    /// Speeds at which the deflected shaft is told besides those of the peaks, rad/s.
    pub shapes: Vec<f64>,
    /// Form of the equations.
    pub form: Form,
}

/// What excites at a frequency of its own, as complex amplitudes (real part, imaginary part).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation {
    /// Force along x, y, z at a position, N.
    Force([f64; 3], f64),
    /// Moment about x, y, z at a position, N m.
    Moment([f64; 3], f64),
    /// Displacement of the ground along y and z, m.
    BaseDisplacement([f64; 2]),
    /// Acceleration of the ground along y and z, m/s^2.
    BaseAcceleration([f64; 2]),
}

/// Settings of harmonic excitation.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicSettings {
    /// Speed at which the rotor turns, rad/s.
    pub spin_speed: f64,
    /// Frequencies, ascending, rad/s.
    pub frequencies: Vec<f64>,
    /// What excites, each with its phase (rad) ahead.
    pub excitations: Vec<(Excitation, f64)>,
    /// Where the response is read.
    pub stations: Vec<Station>,
    /// How amplitudes are told.
    pub amplitude: Amplitude,
    /// Form of the equations.
    pub form: Form,
}

/// Settings of the map of critical speeds.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSettings {
    /// Stiffnesses, ascending, N/m.
    pub stiffness: Vec<f64>,
    /// Paths of the bearings that take them.
    pub bearings: Vec<String>,
    /// Curves of each sense of whirl.
    pub curves: usize,
    /// Decay over a cross-coupled stiffness.
    pub cross_coupling: Option<CrossCoupling>,
}

/// A cross-coupled stiffness that grows.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossCoupling {
    /// Where it acts, m.
    pub x: f64,
    /// Speed of the rotor, rad/s.
    pub speed: f64,
    /// Values Q of `[[0, Q], [-Q, 0]]`, from 0, N/m.
    pub stiffness: Vec<f64>,
}

/// Speed in rpm.
pub fn rpm(speed: f64) -> f64 {
    speed * 30.0 / PI
}

/// An angle between -pi and pi.
pub fn principal(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}
