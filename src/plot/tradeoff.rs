//! Error over wall time of a study, both logarithmic: the front as a stepped line with named points, the others as light
//! marks, shapes by element. Nothing lies below and to the left of a point of the front, so its name stands there.

use crate::draw::axes::{self, Scale, Side};
use crate::draw::clip::{Point, Rect};
use crate::draw::palette::{self, Color, Font, LineStyle, Marker, Stroke};
use crate::draw::pen::Pen;
use crate::draw::sheet::{self, FooterWords, Sample};
use crate::draw::text::{self, Anchor};
use crate::error::Result;
use crate::results::{Figures, Report, Tradeoff, TradeoffPoint, Trust};

const WIDTH: f64 = 1120.0;
/// Height of the frame of the axes.
const FRAME_HEIGHT: f64 = 520.0;
/// Room for the axes' labels.
const LEFT: f64 = 96.0;
const BELOW: f64 = 70.0;
const LEGEND_COLUMNS: usize = 3;
/// Most points of a front that are named.
const NAMED: usize = 16;
/// Height that a name takes, and its distance from its point.
const NAME_HEIGHT: f64 = 16.0;
const NAME_BELOW: f64 = 13.0;
const NAME_BESIDE: f64 = 7.0;
/// Errors below this are rounding.
const LEAST_ERROR: f64 = 1e-15;

/// Symbols that tell curves or elements apart, also without colours.
pub const MARKERS: [Marker; 8] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Downward,
    Marker::Cross,
    Marker::Plus,
    Marker::Ring,
];
const FRONT: Color = palette::BLUE;
const OTHER: Color = palette::MID_GREY;
const FRONT_LINE: Stroke = Stroke { color: palette::BLUE, width: 1.8, line: LineStyle::Solid };
const TARGET_LINE: Stroke = Stroke { color: palette::VERMILLION, width: 1.6, line: LineStyle::Dashed };
const LEADER: Stroke = Stroke::solid(palette::GREY, 0.8);

/// A point to draw.
struct Spot<'a> {
    point: &'a TradeoffPoint,
    index: usize,
    /// Decimal logarithms of time and error.
    at: Point,
    marker: Marker,
}

/// The figure as SVG text.
///
/// # Errors
/// A failure of the drawing library.
pub fn svg(report: &Report<Tradeoff>) -> Result<Figures> {
    let results = &report.results;
    let groups = groups(results);
    let spots: Vec<Spot<'_>> = spots(results, &groups);
    let title = format!("Error and cost: {}", report.case.title);
    let below_title = sheet::below_title(WIDTH, &title) + 8.0;
    let entries = legend(results, &groups);
    let legend_height = sheet::LEGEND_ROW * entries.len().div_ceil(LEGEND_COLUMNS) as f64 + 8.0;
    let frame = Rect {
        left: sheet::MARGIN + LEFT,
        top: below_title + legend_height,
        right: WIDTH - sheet::MARGIN - 6.0,
        bottom: below_title + legend_height + FRAME_HEIGHT,
    };
    let height = frame.bottom + BELOW + sheet::FOOTER_HEIGHT;
    sheet::figure(WIDTH, height, |pen| {
        sheet::title(pen, WIDTH, &title);
        let width = frame.width() / LEGEND_COLUMNS as f64;
        pen.group("legend", "", |pen| {
            for (k, (sample, name)) in entries.iter().enumerate() {
                let (row, column) = (k / LEGEND_COLUMNS, k % LEGEND_COLUMNS);
                let y = below_title + sheet::LEGEND_ROW * (row as f64 + 0.5);
                let at = (frame.left + column as f64 * width, y);
                sheet::legend_entry(pen, at, width - 8.0, *sample, name);
            }
        });
        if spots.is_empty() {
            let middle = frame.center();
            pen.text(
                middle,
                "No point has an error to draw.",
                Font::new(palette::LABEL_SIZE),
                Anchor::Center,
            );
        } else {
            paint(pen, frame, results, &spots);
        }
        pen.frame(frame, Stroke::solid(palette::BLACK, 1.0));
        let words = FooterWords { remarks: remarks(report), content: content(results) };
        sheet::footer(pen, (WIDTH, height), &report.case, report.rotor, &words);
    })
    .map(|svg| vec![("tradeoff.svg".to_owned(), svg)])
}

/// The setting that shapes stand for: the element, else the first one with words for values.
fn group_path(results: &Tradeoff) -> Option<&str> {
    let settings = || results.points.iter().flat_map(|p| &p.settings);
    let element = settings().find(|(path, _)| path.rsplit('.').next() == Some("element"));
    element.or_else(|| settings().find(|(_, value)| value.is_string())).map(|(path, _)| path.as_str())
}

fn group_of(point: &TradeoffPoint, path: Option<&str>) -> String {
    let value = path.and_then(|path| point.settings.get(path));
    value
        .map_or("setting of the case".to_owned(), |v| v.as_str().map_or_else(|| v.to_string(), str::to_owned))
}

/// The groups that have something to draw, in the order of the grid.
fn groups(results: &Tradeoff) -> Vec<String> {
    let path = group_path(results);
    let mut list: Vec<String> = Vec::new();
    for point in results.points.iter().filter(|p| p.error.is_some()) {
        let group = group_of(point, path);
        if !list.contains(&group) {
            list.push(group);
        }
    }
    list
}

fn spots<'a>(results: &'a Tradeoff, groups: &[String]) -> Vec<Spot<'a>> {
    let path = group_path(results);
    let spot = |(index, point): (usize, &'a TradeoffPoint)| {
        let at = (point.wall_s?.max(1e-6).log10(), point.error?.max(LEAST_ERROR).log10());
        let group = groups.iter().position(|g| *g == group_of(point, path))?;
        Some(Spot { point, index, at, marker: MARKERS[group % MARKERS.len()] })
    };
    results.points.iter().enumerate().filter_map(spot).collect()
}

fn legend(results: &Tradeoff, groups: &[String]) -> Vec<(Sample, String)> {
    let mut list: Vec<(Sample, String)> = groups
        .iter()
        .enumerate()
        .map(|(k, name)| (Sample::Marker(MARKERS[k % MARKERS.len()], palette::BLACK), name.clone()))
        .collect();
    if !results.front.is_empty() {
        let shared = shared_words(results);
        let all =
            if shared.is_empty() { "dark marks".to_owned() } else { format!("all {}", shared.join(", ")) };
        list.push((Sample::Stroke(FRONT_LINE), format!("Pareto front ({all})")));
    }
    if let Some(target) = results.target_error {
        list.push((Sample::Stroke(TARGET_LINE), format!("error asked for: {target:e}")));
    }
    if results.points.iter().any(|p| p.error.is_some() && !p.warnings.is_empty()) {
        list.push((
            Sample::Marker(Marker::Ring, palette::BLACK),
            "its run warned of its accuracy".to_owned(),
        ));
    }
    if results.choice.is_some() {
        list.push((Sample::Marker(Marker::Ring, palette::VERMILLION), "chosen".to_owned()));
    }
    list
}

/// Scales with room for the names of the front, and where these stand.
fn layout(
    frame: Rect,
    spots: &[Spot<'_>],
    named: &[&Spot<'_>],
    labels: &[String],
    target: Option<f64>,
) -> (Scale, Scale, Vec<Rect>) {
    let bounds = |values: &mut dyn Iterator<Item = f64>| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        values.for_each(|v| (low, high) = (low.min(v), high.max(v)));
        // at least half a decade, so that one point has axes too
        let lacking = (0.5 - (high - low)).max(0.0) / 2.0;
        (low - lacking, high + lacking)
    };
    let x = bounds(&mut spots.iter().map(|s| s.at.0));
    let y = bounds(&mut spots.iter().map(|s| s.at.1).chain(target.map(f64::log10)));
    let width = |label: &String| text::BOLD_WIDER * text::text_width(label, palette::SMALL_SIZE);
    let widths: Vec<f64> = labels.iter().map(width).collect();
    let (mut left, mut below) = (20.0_f64, 24.0_f64);
    let scales = |left: f64, below: f64| {
        let across = Scale { low: x.0, high: x.1, start: frame.left + left, end: frame.right - 20.0 };
        let up = Scale { low: y.0, high: y.1, start: frame.bottom - below, end: frame.top + 20.0 };
        (across, up)
    };
    // a wider margin draws the points together, which asks for a little more of it
    for _ in 0..40 {
        let (across, up) = scales(left, below);
        let boxes = names(&across, &up, named, &widths);
        let out_left = boxes.iter().map(|b| frame.left + 5.0 - b.left).fold(0.0, f64::max);
        let out_below = boxes.iter().map(|b| b.bottom + 3.0 - frame.bottom).fold(0.0, f64::max);
        if out_left < 0.5 && out_below < 0.5 {
            break;
        }
        left = (left + out_left).min(0.6 * frame.width());
        below = (below + out_below).min(0.6 * frame.height());
    }
    let (across, up) = scales(left, below);
    let boxes = names(&across, &up, named, &widths);
    (whole(across, frame.left, frame.right), whole(up, frame.bottom, frame.top), boxes)
}

/// The scale with its ends moved to the edges of the frame.
fn whole(scale: Scale, start: f64, end: f64) -> Scale {
    let unit = (scale.high - scale.low) / (scale.end - scale.start);
    let value = |pixel: f64| scale.low + unit * (pixel - scale.start);
    Scale { low: value(start), high: value(end), start, end }
}

/// Boxes of the names: left below their points, each moved down until it is clear of those before.
fn names(across: &Scale, up: &Scale, named: &[&Spot<'_>], widths: &[f64]) -> Vec<Rect> {
    let mut placed: Vec<Rect> = Vec::new();
    for (spot, width) in named.iter().zip(widths) {
        let right = across.pixel(spot.at.0) - NAME_BESIDE;
        let center = (right - width / 2.0, up.pixel(spot.at.1) + NAME_BELOW);
        let mut place = Rect::around(center, *width, NAME_HEIGHT);
        while let Some(other) = placed.iter().find(|other| other.grown(1.0).overlaps(&place)) {
            let down = other.bottom + 1.5 - place.top;
            place.top += down;
            place.bottom += down;
        }
        placed.push(place);
    }
    placed
}

/// The words that all points of the front share, if they have others too.
fn shared_words(results: &Tradeoff) -> Vec<&str> {
    let words = |i: &usize| results.points[*i].name.split(", ").collect::<Vec<_>>();
    let Some((first, rest)) = results.front.split_first() else { return Vec::new() };
    let mut shared = words(first);
    shared.retain(|word| rest.iter().all(|i| words(i).contains(word)));
    let all = results.front.iter().any(|i| words(i).len() == shared.len());
    if rest.is_empty() || all { Vec::new() } else { shared }
}

/// The name of a point without the words that stand in the legend.
fn label_of(point: &TradeoffPoint, shared: &[&str]) -> String {
    let words: Vec<&str> = point.name.split(", ").filter(|word| !shared.contains(word)).collect();
    let star = if point.finer_is_worse { "*" } else { "" };
    text::shorten(&words.join(", "), palette::SMALL_SIZE, 330.0) + star
}

fn paint(pen: &mut Pen, frame: Rect, results: &Tradeoff, spots: &[Spot<'_>]) {
    let front: Vec<&Spot<'_>> =
        results.front.iter().filter_map(|&i| spots.iter().find(|s| s.index == i)).collect();
    let every = front.len().div_ceil(NAMED).max(1);
    let named: Vec<&Spot<'_>> = front.iter().copied().step_by(every).collect();
    let shared = shared_words(results);
    let labels: Vec<String> = named.iter().map(|s| label_of(s.point, &shared)).collect();
    let (across, up, boxes) = layout(frame, spots, &named, &labels, results.target_error);
    let pixel = |spot: &Spot<'_>| (across.pixel(spot.at.0), up.pixel(spot.at.1));
    pen.group("axes", "", |pen| {
        axes::decades(pen, frame, Side::Bottom, across, "Wall time", "s");
        axes::decades(pen, frame, Side::Left, up, "Relative error", "");
    });
    if let Some(target) = results.target_error {
        let y = up.pixel(target.log10());
        let ends = [(frame.left, y), (frame.right, y)];
        pen.group("target", &format!("error asked for: {target:e}"), |pen| pen.path(&ends, TARGET_LINE));
    }
    for spot in spots.iter().filter(|s| !s.point.pareto) {
        paint_point(pen, spot, pixel(spot), (4.2, OTHER));
    }
    let mut steps: Vec<Point> = Vec::new();
    for spot in &front {
        let (x, y) = pixel(spot);
        steps.push((x, steps.last().map_or(frame.top, |before: &Point| before.1)));
        steps.push((x, y));
    }
    steps.extend(steps.last().copied().map(|(_, y)| (frame.right, y)));
    pen.group("front", "Pareto front", |pen| pen.path(&steps, FRONT_LINE));
    pen.group("leaders", "", |pen| {
        for (spot, place) in named.iter().zip(&boxes) {
            let (x, y) = pixel(spot);
            if place.center().1 > y + NAME_BELOW + 6.0 {
                pen.path(&[(x, y), (place.right + 2.0, place.center().1)], LEADER);
            }
        }
    });
    for spot in &front {
        paint_point(pen, spot, pixel(spot), (5.4, FRONT));
    }
    let chosen = results.choice.as_ref().map(|c| c.point);
    if let Some(spot) = spots.iter().find(|s| Some(s.index) == chosen) {
        pen.group("chosen", &words_of(spot), |pen| {
            pen.ring(pixel(spot), 9.0, palette::VERMILLION, 2.2);
            let color = if spot.point.pareto { FRONT } else { palette::BLACK };
            pen.marker(pixel(spot), spot.marker, 5.0, color);
        });
    }
    pen.group("names", "", |pen| {
        for ((spot, place), label) in named.iter().zip(&boxes).zip(&labels) {
            pen.fill_rect(*place, palette::WHITE);
            let font = Font::new(palette::SMALL_SIZE);
            let font = if Some(spot.index) == chosen { font.bold() } else { font };
            pen.text((place.right, place.center().1), label, font, Anchor::Right);
        }
    });
}

/// Draws a point, with a ring if its run warned.
fn paint_point(pen: &mut Pen, spot: &Spot<'_>, at: Point, (radius, color): (f64, Color)) {
    pen.group("point", &words_of(spot), |pen| {
        pen.marker(at, spot.marker, radius, color);
        if !spot.point.warnings.is_empty() {
            pen.circle(at, 7.0, palette::BLACK, 1.0);
        }
    });
}

/// Name, error and time of a point.
fn words_of(spot: &Spot<'_>) -> String {
    let number = |value: Option<f64>| text::significant(value.unwrap_or(f64::NAN), 3);
    let (error, wall) = (number(spot.point.error), number(spot.point.wall_s));
    format!("{}: error {error}, {wall} s", spot.point.name)
}

/// What the figure leaves out, and what to distrust.
fn remarks(report: &Report<Tradeoff>) -> String {
    let results = &report.results;
    let mut words = vec![sheet::failed_checks(&report.diagnostics)];
    if let Some(index) = results.reference.point {
        words.push(format!(
            "Not drawn: the finest point ({}), which is the reference.",
            results.points[index].name
        ));
    }
    let failed = results.points.iter().filter(|p| p.failed.is_some()).count();
    if failed > 0 {
        words.push(format!("Points without a value: {failed}."));
    }
    if results.front.iter().any(|&i| results.points[i].finer_is_worse) {
        words.push("* A finer point has a larger error.".to_owned());
    }
    if let Some(error) = results.reference.error {
        words.push(format!("The reference is itself off by about {error:.0e}: no point is drawn below."));
    }
    if results.points.iter().any(|p| p.error.is_some_and(|e| e < LEAST_ERROR)) {
        words.push(format!("Errors below {LEAST_ERROR:e} are drawn there."));
    }
    match results.choice.as_ref().map(|c| c.trust) {
        Some(Trust::Unconfirmed) => words.push("No finer point confirms the choice.".to_owned()),
        Some(Trust::Refuted) => words.push("A finer point refutes the choice.".to_owned()),
        Some(Trust::Warned) => words.push("The run of the choice warned of its accuracy.".to_owned()),
        _ => {}
    }
    words.retain(|w| !w.is_empty());
    words.join(" ")
}

fn content(results: &Tradeoff) -> String {
    let reference = results.reference.value.map_or("none".to_owned(), |v| text::significant(v, 8));
    let at_a_time = match results.points_at_a_time {
        1 => String::new(),
        n => format!(" ({n} points at a time)"),
    };
    format!(
        "{} of {}; reference {reference} ({}). Wall time {} on one thread{at_a_time}, {}.",
        results.quantity,
        results.analysis,
        results.reference.kind,
        match results.repeats {
            1 => "of one run".to_owned(),
            n => format!("(median of {n} runs)"),
        },
        results.machine.processor
    )
}
