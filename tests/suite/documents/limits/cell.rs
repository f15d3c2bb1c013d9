//! One row of the table of limits: a case, its error, what rounding left of it, and what the program said.

use rotor::analysis::check::check;
use rotor::case::LoadedCase;
use rotor::error::Error;
use rotor::model::Model;
use rotor::results::{Diagnostic, Level};

/// Factor on all lengths of a copy; what it changes in a dimensionless result is rounding.
const SCALE: f64 = 1.7;

/// A value with the remarks of its run.
pub type Measured = Result<(f64, Vec<Diagnostic>), Error>;

/// What became of a cell.
#[derive(Debug, Clone)]
pub struct Cell {
    /// The extreme that is approached.
    pub family: &'static str,
    /// Which case.
    pub name: String,
    /// What was measured, against what.
    pub quantity: &'static str,
    /// Relative error; none when the program refused.
    pub error: Option<f64>,
    /// Bound on the error.
    pub bound: f64,
    /// Relative change of the result of the copy: rounding.
    pub noise: Option<f64>,
    /// Codes of the warnings before (`check`) and of the run.
    pub said: Vec<String>,
    /// Exit code and first line of a refusal.
    pub refused: Option<(u8, String)>,
    /// What the copy said, where that is something else.
    pub wavered: Option<String>,
}

impl Cell {
    /// The verdict: "within", "warned", "refused" or "SILENT".
    pub fn verdict(&self) -> &'static str {
        match (&self.refused, self.error) {
            (Some(_), _) => "refused",
            (None, Some(error)) if error <= self.bound && !self.is_rounded() => "within",
            (None, Some(error)) if error.is_finite() && !self.said.is_empty() => "warned",
            _ => "SILENT",
        }
    }

    /// True when rounding is so large a part of the bound that it decides whether the error is within.
    fn is_rounded(&self) -> bool {
        self.noise.is_some_and(|noise| noise > self.bound / 10.0)
    }

    /// Decimal digits that rounding took from a result.
    pub fn digits_lost(&self) -> Option<f64> {
        self.noise.map(|n| (n / f64::EPSILON).log10().max(0.0))
    }
}

/// Warnings of a list, each code once.
fn codes(list: &[Diagnostic]) -> Vec<String> {
    let mut said: Vec<String> = Vec::new();
    for d in list.iter().filter(|d| d.level != Level::Info) {
        if !said.iter().any(|s| s == d.code) {
            said.push(d.code.to_owned());
        }
    }
    said
}

/// Measures a cell: the value of `case` against `exact`, and against one copy of other size, whose value is that of the
/// case times `scale^power`. Every quantity of the copy is moved by a few units in the last place, so that it tells both
/// what rounding does to the number and whether the words survive it.
pub fn cell(
    family: &'static str,
    name: impl Into<String>,
    quantity: &'static str,
    case: &LoadedCase,
    measure: impl Fn(&LoadedCase) -> Measured,
    power: i32,
    (exact, bound): (f64, f64),
) -> Cell {
    let mut made = Cell {
        family,
        name: name.into(),
        quantity,
        error: None,
        bound,
        noise: None,
        said: Vec::new(),
        refused: None,
        wavered: None,
    };
    let refused =
        |e: Error| Some((e.exit_code(), e.to_string().lines().next().unwrap_or_default().to_owned()));
    let checked = Model::new(case).and_then(|model| check(&model));
    let mut first = f64::NAN;
    match (checked, measure(case)) {
        (Ok(checked), Ok((value, remarks))) => {
            first = value;
            made.error = Some((value / exact - 1.0).abs());
            made.said = codes(&[checked.diagnostics, remarks].concat());
        }
        (Err(e), _) | (_, Err(e)) => made.refused = refused(e),
    }
    // a run of so many steps is not repeated
    if family == "transient steps" {
        return made;
    }
    let scale = if power == 0 { 1.0 } else { SCALE };
    let moved = crate::common::shaken(&crate::scale::scaled(&case.case, scale), 11);
    let checked = Model::new(&moved).and_then(|model| check(&model));
    made.wavered = match (checked, measure(&moved), &made.refused) {
        (Ok(checked), Ok((value, remarks)), None) => {
            let value = value / scale.powi(power);
            let (said, error) =
                (codes(&[checked.diagnostics, remarks].concat()), (value / exact - 1.0).abs());
            made.noise = (power != 0).then(|| (value / first - 1.0).abs());
            let crossed = (error <= bound) != made.error.is_some_and(|e| e <= bound);
            (said != made.said || (crossed && !made.is_rounded()))
                .then(|| format!("{} at an error of {error:e}", said.join(", ")))
        }
        (Err(e), _, Some(_)) | (_, Err(e), Some(_))
            if refused(e.clone()).map(|r| r.0) == made.refused.as_ref().map(|r| r.0) =>
        {
            None
        }
        (Err(e), ..) | (_, Err(e), _) => Some(e.to_string()),
        (Ok(_), Ok((value, _)), Some(_)) => Some(format!("a value, {value}")),
    };
    made
}
