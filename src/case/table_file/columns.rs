//! What the columns of a file mean: names and units of its header.

use crate::case::table_file::cells::Row;
use crate::case::table_file::{Place, Trouble};
use crate::case::words::nearest;
use crate::units::unit_factor;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holds {
    /// Spin speed.
    Speed,
    /// Whirl frequency.
    Whirl,
    /// An entry of stiffness (0), damping (1) or mass (2), in the order yy yz zy zz.
    Entry(usize, usize),
}

/// A column of numbers.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// Where it stands.
    pub at: usize,
    /// Its header as written.
    pub header: String,
    /// What it holds.
    pub holds: Holds,
    /// SI unit over the unit of the column.
    pub factor: f64,
}

/// Names of matrices and their dimensions.
const MATRICES: [(char, &str); 3] = [('k', "stiffness"), ('c', "damping"), ('m', "mass")];
const SPEEDS: [&str; 10] = [
    "speed",
    "rpm",
    "omega",
    "\u{3c9}",
    "n",
    "spin",
    "spinspeed",
    "rotorspeed",
    "shaftspeed",
    "runningspeed",
];
const WHIRLS: [&str; 7] =
    ["whirl", "whirlfrequency", "whirlspeed", "frequency", "excitationfrequency", "precession", "nu"];
const KNOWN: &str = "speed, whirl, Kxx Kxy Kyx Kyy, Cxx .. Cyy, Mxx .. Myy (x and y for the y and z of the case), \
                     or kyy kyz kzy kzz, cyy .. czz, myy .. mzz";
const UNITS: &str = "a unit in the header, as \"speed (rpm)\", \"Kxx [N/m]\", or in a row below it; a number without unit is not \
                     accepted: rpm and rad/s can't be told apart";

/// Name and unit of a header, "Kxx (N/m)" or "Kxx [N/m]".
fn parts(header: &str) -> (&str, Option<&str>) {
    match header.find(['(', '[']) {
        Some(at) => {
            let unit = header[at + 1..].trim_end().trim_end_matches([')', ']']).trim();
            (header[..at].trim(), Some(unit).filter(|unit| !unit.is_empty()))
        }
        None => (header.trim(), None),
    }
}

/// The name without case, blanks and lines.
fn plain(name: &str) -> String {
    name.to_lowercase()
        .chars()
        .filter(|c| !c.is_whitespace() && !matches!(c, '_' | '-' | '.' | ','))
        .collect()
}

/// Letter and both axes of an entry, as "kxy".
fn entry(plain: &str) -> Option<(usize, [char; 2])> {
    let mut letters = plain.chars();
    let (first, a, b) = (letters.next()?, letters.next()?, letters.next()?);
    let matrix = MATRICES.iter().position(|(letter, _)| *letter == first)?;
    let axes = [a, b].iter().all(|c| matches!(c, 'x'..='z')) && letters.next().is_none();
    axes.then_some((matrix, [a, b]))
}

/// The columns of a header; `units` is the row below it where that holds units.
pub(super) fn columns((line, header): &Row, units: Option<&Row>) -> Result<Vec<Column>, Trouble> {
    let names: Vec<String> = header.iter().map(|cell| plain(parts(cell).0)).collect();
    let axes: Vec<char> = names.iter().filter_map(|name| entry(name)).flat_map(|(_, axes)| axes).collect();
    let of_field = !axes.contains(&'z');
    let mut list: Vec<Column> = Vec::new();
    for (at, (written, name)) in header.iter().zip(&names).enumerate() {
        let place = Place::cell(*line, at, written);
        if name.is_empty() && units.and_then(|(_, row)| row.get(at)).is_none_or(String::is_empty) {
            continue;
        }
        let (holds, dimension) = match entry(name) {
            Some((_, axes)) if axes.contains(if of_field { &'z' } else { &'x' }) => {
                let problem = "names of two kinds stand side by side: x, y and y, z";
                let allowed = "Kxx Kxy Kyx Kyy (x and y for the y and z of the case), or kyy kyz kzy kzz, in all columns";
                return Err(place.trouble(written, problem, allowed));
            }
            Some((matrix, axes)) => {
                let second = if of_field { 'y' } else { 'z' };
                let [i, j] = axes.map(|axis| usize::from(axis == second));
                (Holds::Entry(matrix, 2 * i + j), MATRICES[matrix].1)
            }
            None if SPEEDS.contains(&name.as_str()) => (Holds::Speed, "speed"),
            None if WHIRLS.contains(&name.as_str()) => (Holds::Whirl, "speed"),
            None => {
                let known = [&SPEEDS[..1], &WHIRLS[..1], &["kxx", "kxy", "cxx", "kzz", "mxx"]].concat();
                let near =
                    nearest(name, &known).map(|n| format!(", did you mean \"{n}\"?")).unwrap_or_default();
                let problem = format!("no such column{near}");
                return Err(place.trouble(
                    written,
                    problem,
                    format!("{KNOWN}; other columns have to be removed"),
                ));
            }
        };
        if list.iter().any(|other| other.holds == holds) {
            return Err(place.trouble(written, "this column stands twice", "each column once"));
        }
        let factor = factor(&place, written, name, units, dimension)?;
        list.push(Column { at, header: written.clone(), holds, factor });
    }
    complete(&list, *line, of_field)?;
    Ok(list)
}

/// What numbers of a column are multiplied by.
fn factor(
    place: &Place,
    written: &str,
    name: &str,
    units: Option<&Row>,
    dimension: &'static str,
) -> Result<f64, Trouble> {
    let below =
        units.and_then(|(line, row)| Some((*line, row.get(place.column)?))).filter(|u| !u.1.is_empty());
    let (place, unit) = match (parts(written).1, below) {
        (Some(_), Some((line, unit))) => {
            let place = Place::cell(line, place.column, written);
            return Err(place.trouble(unit, "the header has a unit already", "one unit for each column"));
        }
        (Some(unit), None) => (place.clone(), unit),
        (None, Some((line, unit))) => {
            let bare = unit.trim_start_matches(['(', '[']).trim_end_matches([')', ']']);
            (Place::cell(line, place.column, written), bare)
        }
        (None, None) if name == "rpm" => (place.clone(), "rpm"),
        (None, None) => return Err(place.trouble(written, "the column has no unit", UNITS)),
    };
    // N-s/m and N.s/m are N s/m
    let unit = unit.replace(['-', '.'], " ");
    unit_factor(&unit, dimension).map_err(|reason| {
        let (problem, allowed) = reason.split_once("; ").unwrap_or((&reason, UNITS));
        let allowed = allowed.rsplit_once("one of: ").map_or(allowed, |(_, list)| list);
        place.trouble(&unit, problem, allowed)
    })
}

/// Refuses a header without speed or stiffness, or with a part of a matrix.
fn complete(list: &[Column], line: usize, of_field: bool) -> Result<(), Trouble> {
    let has = |holds| list.iter().any(|column| column.holds == holds);
    let place = Place::row(line);
    let headers = list.iter().map(|c| c.header.as_str()).collect::<Vec<_>>().join(", ");
    if !has(Holds::Speed) {
        return Err(place.trouble(
            &headers,
            "the column of the speed is missing",
            "\"speed (rpm)\" or \"speed (rad/s)\"",
        ));
    }
    let axes = if of_field { ["xx", "xy", "yx", "yy"] } else { ["yy", "yz", "zy", "zz"] };
    for (matrix, (letter, dimension)) in MATRICES.iter().enumerate() {
        let there = [0, 1, 2, 3].map(|k| has(Holds::Entry(matrix, k)));
        let any = there.contains(&true) || matrix == 0;
        let missing = [(0, any), (3, any), (1, there[2]), (2, there[1])];
        if let Some((k, _)) = missing.into_iter().find(|&(k, needed)| needed && !there[k]) {
            let problem =
                format!("the column {}{} of the {dimension} is missing", letter.to_uppercase(), axes[k]);
            return Err(place.trouble(&headers, problem, KNOWN));
        }
    }
    Ok(())
}
