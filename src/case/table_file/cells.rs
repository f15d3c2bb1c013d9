//! The cells of a file, be it a text or a workbook.

use crate::case::table_file::Trouble;
use calamine::{DataRef, Reader, Xlsx};
use std::io::Cursor;

/// Most rows and columns that are read.
const MOST: (usize, usize) = (200_000, 256);

/// A row that holds anything: its number in the file, from 1, and its cells.
pub(super) type Row = (usize, Vec<String>);

/// Cells of a file.
pub(super) struct Cells {
    /// Its rows.
    pub rows: Vec<Row>,
    /// Whether a comma may be the decimal point.
    pub decimal_comma: bool,
    /// What stands between the cells, for messages.
    pub between: &'static str,
}

/// The cells of a file's bytes.
pub(super) fn cells(bytes: &[u8], sheet: Option<&str>) -> Result<Cells, Trouble> {
    let found = match bytes {
        [b'P', b'K', 3, 4, ..] => workbook(bytes, sheet)?,
        [0xd0, 0xcf, 0x11, 0xe0, ..] => {
            let problem = "the file is a workbook of the old kind (.xls), or locked by a password";
            return Err(Trouble::of_file(problem, "saved as .xlsx or as CSV in UTF-8"));
        }
        _ => text(bytes, sheet)?,
    };
    let holds = |row: &Row| row.1.iter().any(|cell| !cell.is_empty());
    let rows: Vec<_> = found.rows.into_iter().filter(holds).collect();
    if rows.is_empty() {
        return Err(Trouble::of_file(
            "the file is empty",
            "a header with units and at least one row of numbers",
        ));
    }
    Ok(Cells { rows, ..found })
}

fn text(bytes: &[u8], sheet: Option<&str>) -> Result<Cells, Trouble> {
    if sheet.is_some() {
        return Err(Trouble::of_file(
            "the file is a text and has no sheets",
            "\"file\" alone, or a workbook (.xlsx)",
        ));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let Ok(all) = std::str::from_utf8(bytes) else {
        return Err(Trouble::of_file("the file is no text in UTF-8", "saved as CSV in UTF-8, or as .xlsx"));
    };
    // a line of the kind "sep=;" tells spreadsheets what stands between
    let skipped = usize::from(all.starts_with("sep="));
    let lines = all.lines().skip(skipped);
    let header =
        lines.clone().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    let mut inside = 0_i32;
    let mut counts = [(';', 0, "semicolon"), ('\t', 0, "tab"), (',', 0, "comma")];
    for c in header.chars() {
        match c {
            '(' | '[' => inside += 1,
            ')' | ']' => inside -= 1,
            _ => {
                let counted = counts.iter_mut().filter(|count| count.0 == c && inside <= 0);
                counted.for_each(|count| count.1 += 1);
            }
        }
    }
    // the first of those that occur most often
    counts.sort_by_key(|count| std::cmp::Reverse(count.1));
    let (between, _, name) = counts[0];
    let mut reader = csv::ReaderBuilder::new();
    let reader = reader.has_headers(false).flexible(true).comment(Some(b'#')).trim(csv::Trim::All);
    let mut list = Vec::new();
    let (mut at, mut line) = (0, 1);
    for record in reader.delimiter(between as u8).from_reader(all.as_bytes()).records() {
        let record = record
            .map_err(|e| Trouble::of_file(format!("the file can't be read: {e}"), "a table of cells"))?;
        let begin = start(all, record.position().map_or(0, |place| place.byte() as usize));
        line += all.as_bytes()[at..begin.max(at)].iter().filter(|byte| **byte == b'\n').count();
        at = begin.max(at);
        if line > skipped {
            list.push((line, record.iter().map(str::to_owned).collect()));
        }
        within(list.len(), record.len())?;
    }
    Ok(Cells { rows: list, decimal_comma: between == ';', between: name })
}

/// Where a record begins that the reader looked for from a byte on: behind empty lines and comments.
fn start(text: &str, from: usize) -> usize {
    let mut at = from;
    while let Some(rest) = text.get(at..) {
        match rest.as_bytes().first() {
            Some(b'\r' | b'\n') => at += 1,
            Some(b'#') => at += rest.find('\n').unwrap_or(rest.len()),
            _ => break,
        }
    }
    at.min(text.len())
}

fn within(rows: usize, columns: usize) -> Result<(), Trouble> {
    if rows <= MOST.0 && columns <= MOST.1 {
        return Ok(());
    }
    let allowed = format!("at most {} rows and {} columns", MOST.0, MOST.1);
    Err(Trouble::of_file("the table is too large", allowed))
}

fn workbook(bytes: &[u8], sheet: Option<&str>) -> Result<Cells, Trouble> {
    let mut book: Xlsx<_> = calamine::open_workbook_from_rs(Cursor::new(bytes)).map_err(broken)?;
    let names = book.sheet_names();
    if let Some(name) = sheet.filter(|name| !names.iter().any(|n| n == name)) {
        return Err(Trouble::of_file(format!("the workbook has no sheet \"{name}\""), names.join(", ")));
    }
    let mut found: Vec<(String, Vec<Row>)> = Vec::new();
    for name in names.iter().filter(|name| sheet.is_none_or(|wanted| wanted == *name)) {
        let rows = sheet_rows(&mut book, name)?;
        if rows.iter().any(|row| row.1.iter().any(|cell| !cell.is_empty())) {
            found.push((name.clone(), rows));
        }
    }
    if found.len() > 1 {
        let names: Vec<String> = found.iter().map(|(name, _)| format!("\"sheet\": \"{name}\"")).collect();
        return Err(Trouble::of_file("several sheets of the workbook hold something", names.join(" or ")));
    }
    let rows = found.pop().map(|(_, rows)| rows).unwrap_or_default();
    Ok(Cells { rows, decimal_comma: false, between: "cell" })
}

fn broken(error: calamine::XlsxError) -> Trouble {
    let allowed = "a workbook (.xlsx) that opens in a spreadsheet";
    Trouble::of_file(format!("the workbook can't be read: {error}"), allowed)
}

/// The rows of a sheet.
fn sheet_rows(book: &mut Xlsx<Cursor<&[u8]>>, name: &str) -> Result<Vec<Row>, Trouble> {
    let mut rows: Vec<Row> = Vec::new();
    let mut reader = book.worksheet_cells_reader(name).map_err(broken)?;
    while let Some(cell) = reader.next_cell().map_err(broken)? {
        let text = match cell.get_value() {
            DataRef::Int(n) => n.to_string(),
            DataRef::Float(x) => x.to_string(),
            DataRef::String(text) => text.trim().to_owned(),
            DataRef::SharedString(text) => text.trim().to_owned(),
            DataRef::Bool(known) => known.to_string().to_uppercase(),
            DataRef::DateTime(_) | DataRef::DateTimeIso(_) | DataRef::DurationIso(_) => "a date".to_owned(),
            DataRef::Error(error) => error.to_string(),
            DataRef::Empty => continue,
        };
        let (row, column) = cell.get_position();
        let (line, column) = (row as usize + 1, column as usize);
        within(rows.len(), column)?;
        if rows.last().is_none_or(|(last, _)| *last != line) {
            rows.push((line, Vec::new()));
        }
        if let Some((_, cells)) = rows.last_mut() {
            cells.resize(cells.len().max(column + 1), String::new());
            cells[column] = text;
        }
    }
    Ok(rows)
}
