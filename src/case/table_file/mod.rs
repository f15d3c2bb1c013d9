//! Tables of bearings in files: their rows take the place of the file's name in the case, in SI.
//!
//! The case as analysed then holds all that was computed with: reports, their hash and studies need no file.

mod cells;
mod columns;

use crate::case::bearing_table::{TableFileInput, grid};
use crate::case::paths::shown;
use crate::case::words::input_error;
use crate::error::{Refusal, Result};
use crate::units::within_range;
use cells::{Cells, Row, cells};
use columns::{Column, Holds, columns};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Largest file that is read, bytes.
const LARGEST_FILE: u64 = 16 << 20;
/// Keys of the matrices of a row.
const KEYS: [&str; 3] = ["stiffness", "damping", "mass"];

/// What is wrong in a file, and where.
pub(crate) struct Trouble {
    at: String,
    found: Option<String>,
    problem: String,
    allowed: String,
}

impl Trouble {
    fn of_file(problem: impl Into<String>, allowed: impl Into<String>) -> Self {
        let (problem, allowed) = (problem.into(), allowed.into());
        Self { at: "(the whole file)".to_owned(), found: None, problem, allowed }
    }
}

/// A place in a file.
#[derive(Debug, Clone)]
struct Place {
    line: usize,
    column: usize,
    header: Option<String>,
}

impl Place {
    fn row(line: usize) -> Self {
        Self { line, column: 0, header: None }
    }

    fn cell(line: usize, column: usize, header: &str) -> Self {
        Self { line, column, header: Some(header.to_owned()) }
    }

    fn trouble(&self, found: &str, problem: impl Into<String>, allowed: impl Into<String>) -> Trouble {
        let at = match &self.header {
            Some(header) => format!("row {}, column {} (\"{header}\")", self.line, self.column + 1),
            None => format!("row {}", self.line),
        };
        Trouble { at, found: Some(format!("\"{found}\"")), problem: problem.into(), allowed: allowed.into() }
    }
}

/// Puts the rows of files in the place of their names: `supports.*.table` of a case that was read from `file`.
///
/// # Errors
/// A file that can't be read, or a cell that is no number with a unit, with the row and column it stands in.
pub(super) fn read_tables(file: &str, value: &mut Value) -> Result<()> {
    let count = value["supports"].as_array().map_or(0, Vec::len);
    for i in 0..count {
        let place = format!("supports.{i}.table");
        let table = value["supports"][i].get("table").filter(|table| table.is_object()).cloned();
        let Some(table) = table else { continue };
        let wanted: TableFileInput = serde_path_to_error::deserialize(table).map_err(|e| {
            let path = format!("{place}.{}", e.path()).trim_end_matches('.').to_owned();
            input_error(file, value, &path, &e.into_inner().to_string())
        })?;
        let path = Path::new(file).parent().unwrap_or(Path::new("")).join(&wanted.file);
        let bytes = bytes(&path).map_err(|problem| Refusal {
            file: Some(file.to_owned()),
            path: format!("{place}.file"),
            found: Some(shown(&wanted.file)),
            problem: format!("the table {} {problem}", shown(&path.display().to_string())),
            allowed: "a text (CSV) or a workbook (.xlsx), as seen from the folder of the case file"
                .to_owned(),
        })?;
        let rows = cells(&bytes, wanted.sheet.as_deref()).and_then(|cells| rows(&cells));
        value["supports"][i]["table"] = rows.map_err(|trouble| Refusal {
            file: Some(path.display().to_string()),
            path: shown(&trouble.at),
            found: trouble.found.map(|found| shown(&found)),
            problem: trouble.problem,
            allowed: trouble.allowed,
        })?;
    }
    Ok(())
}

fn bytes(path: &PathBuf) -> std::result::Result<Vec<u8>, String> {
    let failed = |e: std::io::Error| format!("can't be read: {e}");
    let about = std::fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        return Err("is no file".to_owned());
    }
    if about.len() > LARGEST_FILE {
        return Err(format!("has {} MB: at most {} MB are read", about.len() >> 20, LARGEST_FILE >> 20));
    }
    std::fs::read(path).map_err(failed)
}

/// Whether a cell is meant to be a number.
fn like_number(cell: &str) -> bool {
    cell.trim_start_matches(['+', '-', '.', ',']).starts_with(|c: char| c.is_ascii_digit())
}

/// The rows of a table as in a case, in SI.
fn rows(cells: &Cells) -> std::result::Result<Value, Trouble> {
    let (header, below) =
        cells.rows.split_first().ok_or_else(|| Trouble::of_file("the file is empty", "a table"))?;
    // nothing in the row below is like a number: it holds units
    let units = below.first().filter(|row| row.1.iter().all(|cell| !like_number(cell)));
    let list = columns(header, units)?;
    let numbers = &below[usize::from(units.is_some())..];
    if numbers.is_empty() {
        let allowed = "at least one row of numbers below the header";
        return Err(Place::row(header.0).trouble(
            &header.1.join(", "),
            "the table has a header and no rows",
            allowed,
        ));
    }
    let points = points_or_commas(cells, numbers)?;
    let mut table = Vec::new();
    let mut places = Vec::new();
    for (line, row) in numbers {
        let named = |at: usize| list.iter().any(|column| column.at == at);
        if let Some((at, extra)) = row.iter().enumerate().find(|(at, cell)| !named(*at) && !cell.is_empty()) {
            let problem =
                format!("the row has a cell that no column of the header names ({} between)", cells.between);
            let allowed =
                "as many cells as the header; with decimal commas write semicolons between the cells";
            return Err(Place::cell(*line, at, "").trouble(extra, problem, allowed));
        }
        let (mut speed, mut whirl) = (0.0, None);
        let mut matrices: [Option<[[f64; 2]; 2]>; 3] = [None; 3];
        for column in &list {
            let value = number(row.get(column.at).map_or("", String::as_str), *line, column, points)?;
            match column.holds {
                Holds::Speed => speed = value,
                Holds::Whirl => whirl = Some(value),
                Holds::Entry(matrix, k) => {
                    matrices[matrix].get_or_insert([[0.0; 2]; 2])[k / 2][k % 2] = value
                }
            }
        }
        places.push((speed, whirl));
        let mut one = Map::from_iter([("speed".to_owned(), json!(speed))]);
        one.extend(whirl.map(|whirl| ("whirl".to_owned(), json!(whirl))));
        one.extend(
            KEYS.iter().zip(matrices).filter_map(|(key, matrix)| Some(((*key).to_owned(), json!(matrix?)))),
        );
        table.push(Value::Object(one));
    }
    grid(&places).map_err(|wrong| {
        let (line, row) = &numbers[wrong.row.min(numbers.len() - 1)];
        let holds = if wrong.key == "speed" { Holds::Speed } else { Holds::Whirl };
        match list.iter().find(|column| column.holds == holds) {
            Some(column) => {
                let found = row.get(column.at).map_or("", String::as_str);
                Place::cell(*line, column.at, &column.header).trouble(found, wrong.problem, wrong.allowed)
            }
            None => Place::row(*line).trouble(&row.join(", "), wrong.problem, wrong.allowed),
        }
    })?;
    Ok(Value::Array(table))
}

/// Whether commas are decimal points; they are where semicolons stand between the cells, and then no point is one.
fn points_or_commas(cells: &Cells, numbers: &[Row]) -> std::result::Result<bool, Trouble> {
    let with = |c: char| {
        let all = numbers.iter().flat_map(|(line, row)| row.iter().map(move |cell| (*line, cell)));
        all.filter(move |(_, cell)| like_number(cell) && cell.contains(c))
    };
    let Some((line, cell)) = with(',').next() else { return Ok(false) };
    if !cells.decimal_comma {
        let problem = "the number has a comma";
        let allowed =
            "a decimal point, or semicolons between the cells of the file; no separators of thousands";
        return Err(Place::row(line).trouble(cell, problem, allowed));
    }
    match with('.').next() {
        Some((line, cell)) => {
            let problem = "numbers of the file have commas and points";
            let allowed = "one of both for the decimals, and no separators of thousands";
            Err(Place::row(line).trouble(cell, problem, allowed))
        }
        None => Ok(true),
    }
}

/// A number of a cell in SI.
fn number(cell: &str, line: usize, column: &Column, commas: bool) -> std::result::Result<f64, Trouble> {
    let wrong = |problem: String| {
        let allowed = "a finite number such as 2.5e8, in the unit of the column";
        Err(Place::cell(line, column.at, &column.header).trouble(cell, problem, allowed))
    };
    if cell.is_empty() {
        return wrong("the cell is empty".to_owned());
    }
    let text = if commas { cell.replace(',', ".") } else { cell.to_owned() };
    match text.parse::<f64>() {
        Ok(value) => match within_range(value * column.factor) {
            Ok(value) => Ok(value),
            Err(reason) => wrong(format!("the value {reason}")),
        },
        Err(_) => wrong("the cell holds no number".to_owned()),
    }
}
