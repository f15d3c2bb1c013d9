//! Error over wall time of a study, both logarithmic: the front as a stepped line with named points, the others as light
//! marks, shapes by element. Nothing lies below and to the left of a point of the front, so its name stands there.

use crate::error::Result;
use crate::plot::style::{
    self, Canvas, Color, Font, FooterWords, Line, Marker, Point, Rect, Sample, Scale, Stroke,
};
use crate::results::{Report, Tradeoff, TradeoffPoint, Trust};
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

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
/// The name of the choice is bold.
const BOLD_WIDER: f64 = 1.12;
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
const FRONT: Color = style::BLUE;
const OTHER: Color = RGBColor(165, 165, 165);
const FRONT_LINE: Stroke = Stroke { color: style::BLUE, width: 1.8, line: Line::Solid };
const TARGET_LINE: Stroke = Stroke { color: style::VERMILLION, width: 1.6, line: Line::Dashed };
const LEADER: Stroke = Stroke::solid(style::GREY, 0.8);

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
pub fn svg(report: &Report<Tradeoff>) -> Result<String> {
    let results = &report.results;
    let groups = groups(results);
    let spots: Vec<Spot<'_>> = spots(results, &groups);
    let title = format!("Error and cost: {}", report.case.title);
    let below_title = style::below_title(WIDTH, &title) + 8.0;
    let entries = legend(results, &groups);
    let legend_height = style::LEGEND_ROW * entries.len().div_ceil(LEGEND_COLUMNS) as f64 + 8.0;
    let frame = Rect {
        left: style::MARGIN + LEFT,
        top: below_title + legend_height,
        right: WIDTH - style::MARGIN - 6.0,
        bottom: below_title + legend_height + FRAME_HEIGHT,
    };
    let height = frame.bottom + BELOW + style::FOOTER_HEIGHT;
    style::figure(WIDTH, height, |canvas| {
        style::title(canvas, WIDTH, &title);
        let width = frame.width() / LEGEND_COLUMNS as f64;
        for (k, (sample, name)) in entries.iter().enumerate() {
            let (row, column) = (k / LEGEND_COLUMNS, k % LEGEND_COLUMNS);
            let at =
                (frame.left + column as f64 * width, below_title + style::LEGEND_ROW * (row as f64 + 0.5));
            style::legend_entry(canvas, at, width - 8.0, *sample, name);
        }
        if spots.is_empty() {
            let middle = frame.center();
            canvas.text(middle, "No point has an error to draw.", Font::new(style::LABEL_SIZE), HPos::Center);
        } else {
            paint(canvas, frame, results, &spots);
        }
        canvas.frame(frame, Stroke::solid(style::BLACK, 1.0));
        let words = FooterWords { remarks: remarks(report), content: content(results) };
        style::footer(canvas, (WIDTH, height), &report.case, report.rotor, &words);
    })
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
        .map(|(k, name)| (Sample::Marker(MARKERS[k % MARKERS.len()], style::BLACK), name.clone()))
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
        list.push((Sample::Marker(Marker::Ring, style::BLACK), "its run warned of its accuracy".to_owned()));
    }
    if results.choice.is_some() {
        list.push((Sample::Marker(Marker::Ring, style::VERMILLION), "chosen".to_owned()));
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
    let width = |label: &String| BOLD_WIDER * style::text_width(label, style::SMALL_SIZE);
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
    style::shorten(&words.join(", "), style::SMALL_SIZE, 330.0) + star
}

fn paint(canvas: &mut Canvas, frame: Rect, results: &Tradeoff, spots: &[Spot<'_>]) {
    let front: Vec<&Spot<'_>> =
        results.front.iter().filter_map(|&i| spots.iter().find(|s| s.index == i)).collect();
    let every = front.len().div_ceil(NAMED).max(1);
    let named: Vec<&Spot<'_>> = front.iter().copied().step_by(every).collect();
    let shared = shared_words(results);
    let labels: Vec<String> = named.iter().map(|s| label_of(s.point, &shared)).collect();
    let (across, up, boxes) = layout(frame, spots, &named, &labels, results.target_error);
    let pixel = |spot: &Spot<'_>| (across.pixel(spot.at.0), up.pixel(spot.at.1));
    decades(canvas, frame, across, false, "Wall time", "s");
    decades(canvas, frame, up, true, "Relative error", "–");
    if let Some(target) = results.target_error {
        let y = up.pixel(target.log10());
        canvas.path(&[(frame.left, y), (frame.right, y)], TARGET_LINE);
    }
    for spot in spots.iter().filter(|s| !s.point.pareto) {
        canvas.marker(pixel(spot), spot.marker, 4.2, OTHER);
    }
    let mut steps: Vec<Point> = Vec::new();
    for spot in &front {
        let (x, y) = pixel(spot);
        steps.push((x, steps.last().map_or(frame.top, |before: &Point| before.1)));
        steps.push((x, y));
    }
    steps.extend(steps.last().copied().map(|(_, y)| (frame.right, y)));
    canvas.path(&steps, FRONT_LINE);
    for (spot, place) in named.iter().zip(&boxes) {
        let (x, y) = pixel(spot);
        if place.center().1 > y + NAME_BELOW + 6.0 {
            canvas.path(&[(x, y), (place.right + 2.0, place.center().1)], LEADER);
        }
    }
    let chosen = results.choice.as_ref().map(|c| c.point);
    for spot in &front {
        let at = pixel(spot);
        canvas.marker(at, spot.marker, 5.4, FRONT);
    }
    for spot in spots.iter().filter(|s| !s.point.warnings.is_empty()) {
        canvas.ring(pixel(spot), 7.0, style::BLACK, 1.0);
    }
    if let Some(spot) = spots.iter().find(|s| Some(s.index) == chosen) {
        canvas.ring(pixel(spot), 9.0, style::VERMILLION, 2.2);
        canvas.marker(pixel(spot), spot.marker, 5.0, if spot.point.pareto { FRONT } else { style::BLACK });
    }
    for ((spot, place), label) in named.iter().zip(&boxes).zip(&labels) {
        canvas.fill_rect(*place, style::WHITE);
        let font = Font::new(style::SMALL_SIZE);
        let font = if Some(spot.index) == chosen { font.bold() } else { font };
        canvas.text((place.right, place.center().1), label, font, HPos::Right);
    }
}

/// Grid, ticks and labels of a logarithmic axis; `scale` maps decimal logarithms.
fn decades(canvas: &mut Canvas, frame: Rect, scale: Scale, upwards: bool, quantity: &str, unit: &str) {
    let (low, high) = (scale.low.min(scale.high), scale.low.max(scale.high));
    let room = (scale.end - scale.start).abs() / (high - low).max(1e-9);
    // labels between the powers where a decade has room for them, fewer powers where it has none
    let digits: &[i32] = if room > 260.0 { &[1, 2, 5] } else { &[1] };
    let stride = (40.0 / room).ceil().max(1.0) as i32;
    for power in low.floor() as i32..=high.ceil() as i32 {
        for digit in 1..10 {
            let value = f64::from(power) + f64::from(digit).log10();
            if !(low..=high).contains(&value) {
                continue;
            }
            let at = scale.pixel(value);
            let labelled = digits.contains(&digit) && (digit > 1 || power % stride == 0);
            let grid = Stroke::solid(style::LIGHT_GREY, if digit == 1 { 1.2 } else { 0.6 });
            let tick = Stroke::solid(style::BLACK, 1.0);
            let length = if labelled { 6.0 } else { 3.0 };
            let label = label(digit, power, upwards);
            if upwards {
                canvas.path(&[(frame.left, at), (frame.right, at)], grid);
                canvas.path(&[(frame.left, at), (frame.left - length, at)], tick);
                if labelled {
                    let place = (frame.left - 9.0, at);
                    canvas.text(place, &label, Font::new(style::TICK_SIZE), HPos::Right);
                }
            } else {
                canvas.path(&[(at, frame.top), (at, frame.bottom)], grid);
                canvas.path(&[(at, frame.bottom), (at, frame.bottom + length)], tick);
                if labelled {
                    let place = (at, frame.bottom + 17.0);
                    canvas.text(place, &label, Font::new(style::TICK_SIZE), HPos::Center);
                }
            }
        }
    }
    let words = if unit == "–" { quantity.to_owned() } else { style::axis_label(quantity, unit, 0) };
    let font = Font::new(style::LABEL_SIZE);
    let middle = frame.center();
    if upwards {
        canvas.vertical_text((frame.left - 80.0, middle.1), &words, font);
    } else {
        canvas.text((middle.0, frame.bottom + 44.0), &words, font, HPos::Center);
    }
}

/// Times as they are, errors as powers of ten.
fn label(digit: i32, power: i32, as_power: bool) -> String {
    if as_power || !(-4..5).contains(&power) {
        let raised = format!("10{}", style::superscript(power));
        return if digit == 1 { raised } else { format!("{digit}·{raised}") };
    }
    let decimals = usize::try_from(-power).unwrap_or(0);
    format!("{:.decimals$}", f64::from(digit) * 10f64.powi(power))
}

/// What the figure leaves out, and what to distrust.
fn remarks(report: &Report<Tradeoff>) -> String {
    let results = &report.results;
    let mut words = vec![style::failed_checks(&report.diagnostics)];
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
    let reference = results.reference.value.map_or("none".to_owned(), |v| style::significant(v, 8));
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
