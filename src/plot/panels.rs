//! Figures of several small plots of curves: each panel has its axes, a frame, a grid and a legend above it.

use super::style::{
    self, Canvas, Color, Font, FooterWords, Line, Marker, Point, Rect, Sample, Scale, Stroke,
};
use crate::error::Result;
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
        let points = self.curves.iter().flat_map(|c| &c.points).chain(self.marks.iter().map(|m| &m.at));
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

    fn paint(&self, canvas: &mut Canvas, room: Rect) {
        let samples = self.curves.iter().map(|c| (Sample::Stroke(c.stroke), &c.name));
        let samples = samples.chain(self.marks.iter().map(|m| (Sample::Marker(m.marker, m.color), &m.name)));
        let samples: Vec<_> = samples.filter(|(_, name)| !name.is_empty()).collect();
        let per_row = 3;
        let legend = style::LEGEND_ROW * samples.len().div_ceil(per_row) as f64 + 6.0;
        let frame = Rect {
            left: room.left + LEFT,
            top: room.top + legend,
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
        style::grid(canvas, frame, across, up);
        for curve in &self.curves {
            let pixels: Vec<Point> = curve
                .points
                .iter()
                .filter(|p| p.0.is_finite() && p.1.is_finite())
                .map(|p| (across.pixel(p.0), up.pixel(p.1)))
                .collect();
            for piece in style::clip(&thinned(pixels), frame.grown(0.5)) {
                canvas.path(&piece, curve.stroke);
            }
        }
        for mark in &self.marks {
            canvas.marker((across.pixel(mark.at.0), up.pixel(mark.at.1)), mark.marker, 5.0, mark.color);
        }
        canvas.frame(frame, Stroke::solid(style::BLACK, 1.0));
        style::axis(canvas, style::Side::Bottom, frame.bottom, across, self.across.0, self.across.1);
        style::axis(canvas, style::Side::Left, frame.left, up, self.up.0, self.up.1);
        let width = frame.width() / per_row as f64;
        for (k, (sample, name)) in samples.into_iter().enumerate() {
            let (row, column) = (k / per_row, k % per_row);
            let at = (frame.left + column as f64 * width, room.top + style::LEGEND_ROW * (row as f64 + 0.5));
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
}

/// The panels in so many columns, as SVG text; panels with equal scales are higher.
///
/// # Errors
/// A failure of the drawing library.
pub fn figure(around: &Surroundings<'_>, panels: &[Panel], columns: usize) -> Result<String> {
    let below_title = style::below_title(WIDTH, &around.title) + 10.0;
    let row_height =
        if panels.iter().any(|p| p.equal) && columns == 1 { 3.0 * PANEL_HEIGHT } else { 1.3 * PANEL_HEIGHT };
    let rows = panels.len().div_ceil(columns).max(1) as f64;
    let height = below_title + rows * (row_height + GAP) + style::FOOTER_HEIGHT;
    style::figure(WIDTH, height, |canvas| {
        style::title(canvas, WIDTH, &around.title);
        let width = (WIDTH - 2.0 * style::MARGIN) / columns as f64;
        for (k, panel) in panels.iter().enumerate() {
            let left = style::MARGIN + (k % columns) as f64 * width;
            let top = below_title + (k / columns) as f64 * (row_height + GAP);
            panel.paint(canvas, Rect { left, top, right: left + width - 6.0, bottom: top + row_height });
        }
        if panels.is_empty() {
            let font = Font::new(style::LABEL_SIZE);
            canvas.text((style::MARGIN, below_title + 20.0), "Nothing to draw.", font, HPos::Left);
        }
        let remarks = [style::failed_checks(around.diagnostics), around.remarks.clone()].join(" ");
        let words =
            FooterWords { remarks: remarks.trim().to_owned(), content: style::model_words(around.model) };
        style::footer(canvas, (WIDTH, height), around.case, around.version, &words);
    })
}
