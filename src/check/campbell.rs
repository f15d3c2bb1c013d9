//! Settings of modes and Campbell diagram.

use crate::case::{self};
use crate::check::Input;
use crate::error::Result;
use crate::model::{CampbellSettings, Form, Gyroscopic, SPARE_BASIS, WhirlFrame};

impl Input<'_> {
    pub(super) fn modes(&self) -> Result<usize> {
        match self.case.modes.count {
            count @ 1..=2000 => Ok(count as usize),
            _ => self.fault("modes.count", "no such number of modes", "1 to 2000"),
        }
    }

    /// The sweep, of a rotor whose sections are all `round` or not.
    pub(super) fn campbell(&self, round: bool) -> Result<Option<CampbellSettings>> {
        let Some(c) = &self.case.campbell else { return Ok(None) };
        let (from, to) = (self.not_negative("campbell.speeds.from", c.speeds.from.0)?, c.speeds.to.0);
        if !(to > 0.0 && to.is_finite()) {
            return self.fault("campbell.speeds.to", "the sweep has no positive speed", "a speed above 0");
        }
        let count = c.speeds.count;
        if !(1..=100_000).contains(&count) {
            return self.fault("campbell.speeds.count", "no such number of speeds", "1 to 100000");
        }
        if (count > 1 && from >= to) || (count == 1 && from != to) {
            return self.fault(
                "campbell.speeds.from",
                "the sweep does not rise",
                format!("below {to} rad/s (equal to it for a count of 1)"),
            );
        }
        let modes = c.modes as usize;
        if !(1..=1000).contains(&modes) {
            return self.fault("campbell.modes", "no such number of branches", "1 to 1000");
        }
        if c.form == Some(Form::Classical) && c.frame == Some(WhirlFrame::Rotating) {
            return self.fault(
                "campbell.frame",
                "the classical form exists in the stationary frame only: without centrifugal stiffening a spinning disk would not stay upright in the rotating frame",
                "\"frame\": \"stationary\"",
            );
        }
        let form = c.form.unwrap_or(Form::Consistent);
        let usual =
            if round || form == Form::Classical { WhirlFrame::Stationary } else { WhirlFrame::Rotating };
        let frame = c.frame.unwrap_or(usual);
        if form == Form::Consistent && c.gyroscopic != Gyroscopic::All {
            return self.fault(
                "campbell.gyroscopic",
                "gyroscopic terms can be left out in the classical form only: in the consistent form they belong together with the centrifugal terms",
                "\"all\", or \"form\": \"classical\"",
            );
        }
        let reduction = match c.reduction {
            case::ReductionSize::None => None,
            case::ReductionSize::Basis(n) if n as usize >= modes + SPARE_BASIS && n <= 5000 => {
                Some(n as usize)
            }
            case::ReductionSize::Basis(_) => {
                return self.fault(
                    "campbell.reduction",
                    "the basis does not fit the number of branches",
                    format!("{} (modes + {SPARE_BASIS}) to 5000, or \"none\"", modes + SPARE_BASIS),
                );
            }
        };
        for (i, order) in c.orders.iter().enumerate() {
            self.positive(&format!("campbell.orders.{i}"), *order)?;
        }
        let step = |k: u32| if count > 1 { f64::from(k) / f64::from(count - 1) } else { 1.0 };
        Ok(Some(CampbellSettings {
            speeds: (0..count).map(|k| from + (to - from) * step(k)).collect(),
            modes,
            frame,
            form,
            reduction,
            gyroscopic: c.gyroscopic,
            orders: c.orders.clone(),
        }))
    }
}
