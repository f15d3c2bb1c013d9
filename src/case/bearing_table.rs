//! Tables of bearings over speed, as written: rows in the case, or a file beside it.

use crate::units::{Damping, Mass, Matrix, Speed, Stiffness};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Coefficients of a bearing over speed: rows. Where a case names a file, its rows have taken the place of the name when the case
/// is read: the case as analysed holds all that was computed with.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TableInput(pub Vec<TableRowInput>);

/// Coefficients of a bearing at a speed.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "TableRow")]
pub struct TableRowInput {
    /// Spin speed; the rows ascend.
    pub speed: Speed,
    /// Whirl frequency, where coefficients depend on it; every speed has the same ones, ascending.
    pub whirl: Option<Speed>,
    /// [[kyy, kyz], [kzy, kzz]], or one number for the same in y and z.
    pub stiffness: Matrix<Stiffness>,
    /// [[cyy, cyz], [czy, czz]], or one number for the same in y and z; default zero.
    pub damping: Option<Matrix<Damping>>,
    /// Added mass [[myy, myz], [mzy, mzz]], or one number for the same in y and z; default zero.
    pub mass: Option<Matrix<Mass>>,
}

/// A file that holds the rows.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "TableFile")]
pub struct TableFileInput {
    /// Text (comma, semicolon or tab between the cells) or workbook (.xlsx), as seen from the folder of the case file. Columns are
    /// speed, whirl, Kxx Kxy Kyx Kyy (x, y for the y, z of the case) or kyy kyz kzy kzz, C.. and M.. alike, each with its unit.
    pub file: String,
    /// Sheet of a workbook; needed where several hold anything.
    pub sheet: Option<String>,
}

impl JsonSchema for TableInput {
    fn schema_name() -> Cow<'static, str> {
        "Table".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let row = generator.subschema_for::<TableRowInput>();
        let file = generator.subschema_for::<TableFileInput>();
        json_schema!({ "anyOf": [{ "type": "array", "items": row, "minItems": 1 }, file] })
    }
}

/// Speeds and whirl frequencies of a table, ascending, rad/s; no frequencies where its rows name none.
pub(crate) type Grid = (Vec<f64>, Vec<f64>);

/// A row that does not fit the grid of those before it.
#[derive(Debug)]
pub(crate) struct Misplaced {
    /// Index of the row.
    pub row: usize,
    /// "speed" or "whirl".
    pub key: &'static str,
    /// What is wrong.
    pub problem: String,
    /// What is allowed.
    pub allowed: String,
}

/// The grid of rows `(speed, whirl frequency)`, rad/s: speeds ascend, and at each speed the same whirl frequencies.
pub(crate) fn grid(rows: &[(f64, Option<f64>)]) -> Result<Grid, Misplaced> {
    /// Relative distance below which two places are one.
    const SAME: f64 = 1e-9;
    let wrong = |row, key, problem: &str, allowed: String| {
        Err(Misplaced { row, key, problem: problem.to_owned(), allowed })
    };
    let with_whirl = rows.first().is_some_and(|row| row.1.is_some());
    if let Some(row) = rows.iter().position(|row| row.1.is_some() != with_whirl) {
        let allowed = "a whirl frequency in every row, or in none";
        return wrong(row, "whirl", "only some rows have a whirl frequency", allowed.to_owned());
    }
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
    let (mut speeds, mut whirls): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    // rows read at the last speed
    let mut read = 0;
    for (k, &(speed, whirl)) in rows.iter().enumerate() {
        let repeated = speeds.last().is_some_and(|last| same(*last, speed));
        if let Some(last) = speeds.last().filter(|last| speed < **last && !repeated) {
            let allowed = format!("{last} rad/s or more: sort the rows by speed");
            return wrong(k, "speed", "the speeds do not ascend", allowed);
        }
        if repeated && !with_whirl {
            return wrong(k, "speed", "this speed stands twice", "one row for each speed".to_owned());
        }
        if !repeated {
            if speeds.len() > 1 && read < whirls.len() {
                return incomplete(k, read, &whirls);
            }
            speeds.push(speed);
            read = 0;
        }
        let Some(whirl) = whirl else { continue };
        if whirl < 0.0 {
            let allowed = "0 or more: the sense of the whirl does not matter".to_owned();
            return wrong(k, "whirl", "the whirl frequency is negative", allowed);
        }
        if speeds.len() == 1 {
            if whirls.last().is_some_and(|last| whirl < *last || same(*last, whirl)) {
                let allowed = "each once, ascending: sort the rows by speed, then by whirl frequency";
                return wrong(k, "whirl", "the whirl frequencies do not ascend", allowed.to_owned());
            }
            whirls.push(whirl);
        } else if !whirls.get(read).is_some_and(|right| same(*right, whirl)) {
            let right = whirls.get(read).map_or("no further row".to_owned(), |w| format!("{w} rad/s"));
            let allowed = format!("at this place {right}: the whirl frequencies of the first speed");
            return wrong(k, "whirl", "each speed needs the same whirl frequencies", allowed);
        }
        read += 1;
    }
    match rows.len().checked_sub(1) {
        Some(last) if read < whirls.len() => incomplete(last, read, &whirls),
        Some(_) => Ok((speeds, whirls)),
        None => wrong(0, "speed", "the table has no rows", "at least one row".to_owned()),
    }
}

fn incomplete(row: usize, read: usize, whirls: &[f64]) -> Result<Grid, Misplaced> {
    Err(Misplaced {
        row,
        key: "whirl",
        problem: format!("a speed has {read} whirl frequencies, the first one {}", whirls.len()),
        allowed: "the same whirl frequencies at every speed".to_owned(),
    })
}
