//! Whether the steady vibration is ever reached: the lowest speed at which a motion grows.

use crate::analysis::campbell::reduced_basis::Whirling;
use crate::analysis::response::vibration::Vibration;
use crate::error::Result;
use crate::model::Bearing;
use crate::results::Diagnostic;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Speeds at which all motions are looked at.
const LOOKS: usize = 13;
/// Relative width of the bracket of a threshold.
const BRACKET: f64 = 1e-4;

impl Vibration<'_> {
    /// True when all that acts beside elastic and gyroscopic forces is damping fixed in space: then no motion grows.
    fn only_damps(&self) -> bool {
        let operators = &self.operators;
        let damps = |b: &Bearing| {
            let [[yy, yz], [zy, zz]] = b.damping;
            yy >= 0.0 && zz >= 0.0 && (yz + zy) * (yz + zy) <= 4.0 * yy * zz
        };
        operators.cross_coupling.is_none()
            && operators.circulatory.is_none()
            && operators.hysteresis.is_none()
            && operators.changing.is_empty()
            && self.assembly.model.bearings.iter().all(damps)
    }

    /// The lowest speed up to `highest` (rad/s) at which a motion grows, and a remark on it. Where nothing feeds or takes energy, no
    /// motion grows or decays, which is told as well.
    ///
    /// # Errors
    /// A speed that can't be solved.
    pub fn threshold(&self, highest: f64, diagnostics: &mut Vec<Diagnostic>) -> Result<Option<f64>> {
        if self.operators.is_conservative() {
            diagnostics.push(Diagnostic::warning(
                "undamped-response",
                "nothing damps this rotor: a start never dies away, and at a critical speed the response has no bound",
            ));
            return Ok(None);
        }
        if self.only_damps() {
            return Ok(None);
        }
        let grows = |speed: f64| -> Result<bool> {
            Ok(self.reduced.solve(speed)?.motions.iter().any(Whirling::grows))
        };
        let speeds: Vec<f64> = (0..LOOKS).map(|k| highest * k as f64 / (LOOKS - 1) as f64).collect();
        let found: Vec<bool> = speeds.par_iter().map(|s| grows(*s)).collect::<Result<_>>()?;
        let Some(first) = found.iter().position(|grows| *grows) else { return Ok(None) };
        let mut threshold = speeds[first];
        if first > 0 {
            let mut low = speeds[first - 1];
            while threshold - low > BRACKET * threshold {
                let middle = (low + threshold) / 2.0;
                if grows(middle)? { threshold = middle } else { low = middle }
            }
        }
        diagnostics.push(Diagnostic::error(
            "unstable-response",
            format!(
                "from {:.1} rpm on a motion grows by itself: there the steady vibration is never reached, and what is told of it \
                 does not happen",
                threshold * 30.0 / PI
            ),
        ));
        Ok(Some(threshold))
    }
}
