//! Whole rotors that were made by others, against what other codes give for them.

use crate::common::{campbell, fieldtest, frequencies, with};
use serde_json::json;

/// A compressor on 14 bearings and seals with sleeves as soft disks. Timoshenko beams, converged, give 162.3 and 164.7 Hz for the
/// first pair at 8000 rpm.
#[test]
fn a_compressor_on_bearings_and_seals() {
    let found = campbell(&fieldtest("compressor_like"));
    for (branch, right) in found.branches.iter().zip([162.3, 164.7]) {
        let hertz = branch.frequency_rad_s[2].expect("a whirl") / std::f64::consts::TAU;
        assert!((hertz / right - 1.0).abs() < 1e-2, "{hertz} instead of {right}");
    }
}

/// A solid segment between hollow ones: axisymmetric solid elements have a bending motion at 2750 rad/s and none near 2999.
#[test]
fn a_solid_segment_between_hollow_ones() {
    let case = with(&fieldtest("hollow_solid_hollow"), json!({ "modes.count": 16 }));
    let found = frequencies(&case);
    assert!(found.iter().any(|w| (w / 2750.0 - 1.0).abs() < 1e-2), "{found:?}");
    assert!(found.iter().all(|w| (w / 2999.0 - 1.0).abs() > 3e-2), "{found:?}");
}
