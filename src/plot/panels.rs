//! Figures of several small plots of curves: each panel has its axes, a frame, a grid and a legend above it.

use crate::error::Result;
use crate::plot::style::{
    self, Canvas, Color, Font, FooterWords, Line, Marker, Point, Rect, Sample, Scale, Stroke,
};
use crate::results::{CaseInfo, Diagnostic, ModelSummary, Report};
use plotters::style::text_anchor::HPos;

const WIDTH: f64 = 1120.0;
const PANEL_HEIGHT: f64 = 250.0;
/// Room for the axis' labels to the left of and below a panel, and between panels.
const LEFT: f64 = 92.0;
const BELOW: f64 = 66.0;
const GAP: f64 = 14.0;
/// Share of the range left free above and below the curves.
const AIR: f64 = 0.06;

/// Strokes of the curves of a panel, in order; each differs in colour and kind.
pub const STROKES: [Stroke; 5] = [
    Stroke { color: style::BLUE, width: 2.0, line: Line::Solid },
    Stroke { color: style::VERMILLION, width: 2.0, line: Line::Dashed },
    Stroke { color: style::GREEN, width: 2.0, line: Line::DashDot },
    Stroke { color: style::BLACK, width: 1.6, line: Line::Dotted },
    Stroke { color: style::GREY, width: 1.4, line: Line::Solid },
];

/// A named curve.
pub struct Curve {
    /// Words of its legend entry; none for a curve that looks like the one before and needs none.
    pub name: String,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Its points.
    pub points: Vec<Point>,
}

/// A named mark.
pub struct Mark {
    /// Words of its legend entry.
    pub name: String,
    /// Symbol.
    pub marker: Marker,
    /// Colour.
    pub color: Color,
    /// Where.
    pub at: Point,
}

/// One plot.
#[derive(Default)]
pub struct Panel {
    /// Quantity and unit across.
    pub across: (&'static str, &'static str),
    /// Quantity and unit upwards.
    pub up: (&'static str, &'static str),
    /// Curves.
    pub curves: Vec<Curve>,
    /// Marks.
    pub marks: Vec<Mark>,
    /// The same scale in both directions.
    pub equal: bool,
    /// Words above the frame.
    pub title: String,
    /// Stretches of the abscissa with a tinted background.
    pub bands: Vec<(f64, f64)>,
    /// Places that lie inside the frame, beside all that is drawn: panels that share them share their scales.
    pub inside: Vec<Point>,
    /// Height with legend and labels, in logical pixels; 0 for the usual one.
    pub height: f64,
}

impl Panel {
    /// A panel of curves over one list of abscissas, named and drawn in the order of [`STROKES`].
    pub fn over(
        across: (&'static str, &'static str),
        up: (&'static str, &'static str),
        x: &[f64],
        curves: Vec<(&str, Vec<f64>)>,
    ) -> Self {
        let curve = |(k, (name, y)): (usize, (&str, Vec<f64>))| Curve {
            name: name.to_owned(),
            stroke: STROKES[k % STROKES.len()],
            points: x.iter().copied().zip(y).collect(),
        };
        Self { across, up, curves: curves.into_iter().enumerate().map(curve).collect(), ..Self::default() }
    }

    /// Range of the points in one direction, with air around them; a flat one is opened.
    fn range(&self, of: impl Fn(&Point) -> f64, air: f64) -> (f64, f64) {
        let points = self.curves.iter().flat_map(|c| &c.points);
        let points = points.chain(self.marks.iter().map(|m| &m.at)).chain(&self.inside);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in points.map(of).filter(|v| v.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            return (0.0, 1.0);
        }
        let size = low.abs().max(high.abs());
        if high - low <= 1e-9 * size || size == 0.0 {
            let half = if size > 0.0 { size / 2.0 } else { 0.5 };
            return (low - half, high + half);
        }
        let margin = air * (high - low);
        (low - margin, high + margin)
    }

    /// Legend entries side by side: as many as are whole, at most three.
    fn legend_columns(&self, width: f64) -> usize {
        let names = self.curves.iter().map(|c| &c.name).chain(self.marks.iter().map(|m| &m.name));
        let widest = names.map(|name| style::text_width(name, style::TICK_SIZE)).fold(0.0, f64::max);
        (width / (widest + style::LEGEND_SAMPLE + 8.0)).clamp(1.0, 3.0) as usize
    }

    /// Height of title and legend above a frame of this width.
    fn above(&self, width: f64) -> f64 {
        let names = self.curves.iter().map(|c| &c.name).chain(self.marks.iter().map(|m| &m.name));
        let rows = names.filter(|name| !name.is_empty()).count().div_ceil(self.legend_columns(width));
        let title = usize::from(!self.title.is_empty());
        (title + rows) as f64 * style::LEGEND_ROW + 6.0
    }

    fn paint(&self, canvas: &mut Canvas, room: Rect) {
        let samples = self.curves.iter().map(|c| (Sample::Stroke(c.stroke), &c.name));
        let samples = samples.chain(self.marks.iter().map(|m| (Sample::Marker(m.marker, m.color), &m.name)));
        let samples: Vec<_> = samples.filter(|(_, name)| !name.is_empty()).collect();
        let per_row = self.legend_columns(room.width() - LEFT - 10.0);
        let title = if self.title.is_empty() { 0.0 } else { style::LEGEND_ROW };
        let frame = Rect {
            left: room.left + LEFT,
            top: room.top + self.above(room.width() - LEFT - 10.0),
            right: room.right - 10.0,
            bottom: room.bottom - BELOW,
        };
        let (mut x, mut y) =
            (self.range(|p| p.0, if self.equal { AIR } else { 0.0 }), self.range(|p| p.1, AIR));
        if self.equal {
            let unit = ((x.1 - x.0) / frame.width()).max((y.1 - y.0) / frame.height());
            let around = |(low, high): (f64, f64), size: f64| {
                let (middle, half) = ((low + high) / 2.0, unit * size / 2.0);
                (middle - half, middle + half)
            };
            (x, y) = (around(x, frame.width()), around(y, frame.height()));
        }
        let across = Scale { low: x.0, high: x.1, start: frame.left, end: frame.right };
        let up = Scale { low: y.0, high: y.1, start: frame.bottom, end: frame.top };
        for (from, to) in &self.bands {
            let ends = [from, to].map(|x| across.pixel(*x).clamp(frame.left, frame.right));
            // a short one is still seen
            let right = ends[1].max(ends[0] + 1.0).min(frame.right);
            canvas.fill_rect(Rect { left: ends[0], right, ..frame }, style::PALE_GREY);
        }
        style::grid(canvas, frame, across, up);
        for curve in &self.curves {
            // what has no value breaks a curve
            for stretch in curve.points.split(|p| !(p.0.is_finite() && p.1.is_finite())) {
                let pixels = stretch.iter().map(|p| (across.pixel(p.0), up.pixel(p.1))).collect();
                for piece in style::clip(&thinned(pixels), frame.grown(0.5)) {
                    canvas.path(&piece, curve.stroke);
                }
            }
        }
        for mark in &self.marks {
            canvas.marker((across.pixel(mark.at.0), up.pixel(mark.at.1)), mark.marker, 5.0, mark.color);
        }
        canvas.frame(frame, Stroke::solid(style::BLACK, 1.0));
        style::axis(canvas, style::Side::Bottom, frame.bottom, across, self.across.0, self.across.1);
        style::axis(canvas, style::Side::Left, frame.left, up, self.up.0, self.up.1);
        if title > 0.0 {
            let font = Font::new(style::LABEL_SIZE).bold();
            let words = style::shorten(&self.title, font.size * 1.12, frame.width());
            canvas.text((frame.left, room.top + title / 2.0), &words, font, HPos::Left);
        }
        let width = frame.width() / per_row as f64;
        for (k, (sample, name)) in samples.into_iter().enumerate() {
            let (row, column) = (k / per_row, k % per_row);
            let y = room.top + title + style::LEGEND_ROW * (row as f64 + 0.5);
            let at = (frame.left + column as f64 * width, y);
            style::legend_entry(canvas, at, width - 8.0, sample, name);
        }
    }
}

/// Drops points closer than half a pixel to the one before: long histories stay small files.
fn thinned(points: Vec<Point>) -> Vec<Point> {
    let last = points.last().copied();
    let mut kept: Vec<Point> = Vec::new();
    for point in points {
        if kept.last().is_none_or(|&before| style::distance(before, point) >= 0.5) {
            kept.push(point);
        }
    }
    kept.extend(last.filter(|l| kept.last() != Some(l)));
    kept
}

/// What stands around the panels of a figure.
pub struct Surroundings<'a> {
    title: String,
    case: &'a CaseInfo,
    model: &'a ModelSummary,
    diagnostics: &'a [Diagnostic],
    version: &'a str,
    remarks: String,
}

impl<'a> Surroundings<'a> {
    /// Title and remarks for a figure of a report.
    pub fn new<R>(report: &'a Report<R>, title: &str, remarks: String) -> Self {
        Self {
            title: format!("{title}: {}", report.case.title),
            case: &report.case,
            model: &report.model,
            diagnostics: &report.diagnostics,
            version: report.rotor,
            remarks,
        }
    }

    fn footer(&self, canvas: &mut Canvas, height: f64) {
        let remarks = [style::failed_checks(self.diagnostics), self.remarks.clone()].join(" ");
        let words =
            FooterWords { remarks: remarks.trim().to_owned(), content: style::model_words(self.model) };
        style::footer(canvas, (WIDTH, height), self.case, self.version, &words);
    }
}

/// The panels in so many columns, as SVG text; panels with equal scales are higher.
///
/// # Errors
/// A failure of the drawing library.
pub fn figure(around: &Surroundings<'_>, panels: &[Panel], columns: usize) -> Result<String> {
    let below_title = style::below_title(WIDTH, &around.title) + 10.0;
    let equal = panels.iter().any(|p| p.equal) && columns == 1;
    let usual = if equal { 3.0 * PANEL_HEIGHT } else { 1.3 * PANEL_HEIGHT };
    let given = panels.iter().map(|p| p.height).fold(0.0, f64::max);
    let row_height = if given > 0.0 { given } else { usual };
    let rows = panels.len().div_ceil(columns).max(1) as f64;
    let height = below_title + rows * (row_height + GAP) + style::FOOTER_HEIGHT;
    style::figure(WIDTH, height, |canvas| {
        style::title(canvas, WIDTH, &around.title);
        let width = panel_width(columns);
        for (k, panel) in panels.iter().enumerate() {
            let left = style::MARGIN + (k % columns) as f64 * width;
            let top = below_title + (k / columns) as f64 * (row_height + GAP);
            panel.paint(canvas, Rect { left, top, right: left + width - 6.0, bottom: top + row_height });
        }
        if panels.is_empty() {
            let font = Font::new(style::LABEL_SIZE);
            canvas.text((style::MARGIN, below_title + 20.0), "Nothing to draw.", font, HPos::Left);
        }
        around.footer(canvas, height);
    })
}

fn panel_width(columns: usize) -> f64 {
    (WIDTH - 2.0 * style::MARGIN) / columns as f64
}

/// Gives panels in so many columns, in equal scales, the height at which their frames show `size` (across and upwards) and
/// no more, at least `least`.
pub fn fit(panels: &mut [Panel], columns: usize, size: Point, least: f64) {
    let width = panel_width(columns) - LEFT - 16.0;
    let frame = (width * size.1 / size.0.max(f64::MIN_POSITIVE)).clamp(least, 3.0 * PANEL_HEIGHT);
    for panel in panels {
        panel.height = panel.above(width) + frame + BELOW;
    }
}

/// Shares of a whole as horizontal bars with their values, as SVG text.
///
/// # Errors
/// A failure of the drawing library.
pub fn bars(around: &Surroundings<'_>, unit: &str, parts: &[(&str, f64)]) -> Result<String> {
    let below_title = style::below_title(WIDTH, &around.title) + 10.0;
    let (row, names, values) = (34.0, 240.0, 200.0);
    let height = below_title + row * parts.len() as f64 + GAP + style::FOOTER_HEIGHT;
    let total: f64 = parts.iter().map(|(_, value)| value).sum();
    let room = WIDTH - 2.0 * style::MARGIN - names - values;
    style::figure(WIDTH, height, |canvas| {
        style::title(canvas, WIDTH, &around.title);
        let left = style::MARGIN + names;
        for (k, (name, value)) in parts.iter().enumerate() {
            let share = if total > 0.0 { value / total } else { 0.0 };
            let middle = below_title + row * (k as f64 + 0.5);
            let bar = Rect {
                left,
                right: left + (room * share).max(1.0),
                top: middle - 0.3 * row,
                bottom: middle + 0.3 * row,
            };
            canvas.fill_rect(bar, style::BLUE);
            let font = Font::new(style::LABEL_SIZE);
            canvas.text((left - 10.0, middle), name, font, HPos::Right);
            let words = format!("{} {unit}, {:.1} %", style::significant(*value, 3), 100.0 * share);
            canvas.text((bar.right + 10.0, middle), &words, font, HPos::Left);
        }
        let ends = [(left, below_title), (left, below_title + row * parts.len() as f64)];
        canvas.path(&ends, Stroke::solid(style::BLACK, 1.0));
        around.footer(canvas, height);
    })
}
