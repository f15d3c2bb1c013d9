//! Figures of several small plots of curves: each panel has its axes, a frame, a grid and a legend above it.

use crate::draw::axes::{self, Scale, Side};
use crate::draw::clip::{self, Point, Rect};
use crate::draw::palette::{self, Color, Font, LineStyle, Marker, Stroke};
use crate::draw::pen::Pen;
use crate::draw::sheet::{self, FooterWords, Sample};
use crate::draw::text::{self, Anchor};
use crate::error::Result;
use crate::results::{CaseInfo, Diagnostic, ModelSummary, Report};

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
    Stroke { color: palette::BLUE, width: 2.0, line: LineStyle::Solid },
    Stroke { color: palette::VERMILLION, width: 2.0, line: LineStyle::Dashed },
    Stroke { color: palette::GREEN, width: 2.0, line: LineStyle::DashDot },
    Stroke { color: palette::BLACK, width: 1.6, line: LineStyle::Dotted },
    Stroke { color: palette::GREY, width: 1.4, line: LineStyle::Solid },
];

/// A named curve.
pub struct Curve {
    /// Words of its legend entry; none for a curve that looks like the one before and needs none.
    pub name: String,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Points of the curve, in the units of the axes.
    pub points: Vec<Point>,
}

/// A named mark.
pub struct Mark {
    /// Words of its legend entry.
    pub name: String,
    /// Symbol that marks the point.
    pub marker: Marker,
    /// Colour of the symbol.
    pub color: Color,
    /// Place of the mark, in the units of the axes.
    pub at: Point,
}

/// One plot of a figure: its axes, curves and marks.
#[derive(Default)]
pub struct Panel {
    /// Quantity and unit across.
    pub across: (&'static str, &'static str),
    /// Quantity and unit upwards.
    pub up: (&'static str, &'static str),
    /// Curves that the panel shows.
    pub curves: Vec<Curve>,
    /// Marks that the panel shows.
    pub marks: Vec<Mark>,
    /// The same scale in both directions.
    pub equal: bool,
    /// Both axes logarithmic: places are decimal logarithms of values in the units of the axes.
    pub decades: bool,
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
        let widest = names.map(|name| text::text_width(name, palette::TICK_SIZE)).fold(0.0, f64::max);
        (width / (widest + sheet::LEGEND_SAMPLE + 8.0)).clamp(1.0, 3.0) as usize
    }

    /// Height of title and legend above a frame of this width.
    fn above(&self, width: f64) -> f64 {
        let names = self.curves.iter().map(|c| &c.name).chain(self.marks.iter().map(|m| &m.name));
        let rows = names.filter(|name| !name.is_empty()).count().div_ceil(self.legend_columns(width));
        let title = usize::from(!self.title.is_empty());
        (title + rows) as f64 * sheet::LEGEND_ROW + 6.0
    }

    fn paint(&self, pen: &mut Pen, room: Rect) {
        let width = room.width() - LEFT - 10.0;
        let frame = Rect {
            left: room.left + LEFT,
            top: room.top + self.above(width),
            right: room.right - 10.0,
            bottom: room.bottom - BELOW,
        };
        let (across, up) = self.scales(frame);
        pen.group("panel", &self.title, |pen| {
            self.paint_bands(pen, frame, across);
            if self.decades {
                axes::decades(pen, frame, Side::Bottom, across, self.across.0, self.across.1);
                axes::decades(pen, frame, Side::Left, up, self.up.0, self.up.1);
            } else {
                axes::grid(pen, frame, across, up);
            }
            for curve in &self.curves {
                pen.group("curve", &curve.name, |pen| paint_curve(pen, curve, frame, across, up));
            }
            for mark in &self.marks {
                let at = (across.pixel(mark.at.0), up.pixel(mark.at.1));
                pen.group("mark", &self.mark_words(mark), |pen| pen.marker(at, mark.marker, 5.0, mark.color));
            }
            pen.group("axes", "", |pen| {
                pen.frame(frame, Stroke::solid(palette::BLACK, 1.0));
                if !self.decades {
                    axes::axis(pen, Side::Bottom, frame.bottom, across, self.across.0, self.across.1);
                    axes::axis(pen, Side::Left, frame.left, up, self.up.0, self.up.1);
                }
            });
            self.paint_legend(pen, room.top, frame);
        });
    }

    /// Scales that show all points.
    fn scales(&self, frame: Rect) -> (Scale, Scale) {
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
        (across, up)
    }

    fn paint_bands(&self, pen: &mut Pen, frame: Rect, across: Scale) {
        pen.group("bands", "", |pen| {
            for (from, to) in &self.bands {
                let ends = [from, to].map(|x| across.pixel(*x).clamp(frame.left, frame.right));
                // a short one is still seen
                let right = ends[1].max(ends[0] + 1.0).min(frame.right);
                pen.fill_rect(Rect { left: ends[0], right, ..frame }, palette::PALE_GREY);
            }
        });
    }

    /// Name and place of a mark.
    fn mark_words(&self, mark: &Mark) -> String {
        let part = |(quantity, unit): (&str, &str), value: f64| {
            let value = if self.decades { 10f64.powf(value) } else { value };
            format!("{quantity} {} {unit}", text::significant(value, 5))
        };
        format!("{}: {}, {}", mark.name, part(self.across, mark.at.0), part(self.up, mark.at.1))
    }

    fn paint_legend(&self, pen: &mut Pen, top: f64, frame: Rect) {
        let samples = self.curves.iter().map(|c| (Sample::Stroke(c.stroke), &c.name));
        let samples = samples.chain(self.marks.iter().map(|m| (Sample::Marker(m.marker, m.color), &m.name)));
        let samples: Vec<_> = samples.filter(|(_, name)| !name.is_empty()).collect();
        let title = if self.title.is_empty() { 0.0 } else { sheet::LEGEND_ROW };
        if title > 0.0 {
            let font = Font::new(palette::LABEL_SIZE).bold();
            let words = text::shorten(&self.title, font.size * text::BOLD_WIDER, frame.width());
            pen.text((frame.left, top + title / 2.0), &words, font, Anchor::Left);
        }
        let per_row = self.legend_columns(frame.width());
        let width = frame.width() / per_row as f64;
        pen.group("legend", "", |pen| {
            for (k, (sample, name)) in samples.into_iter().enumerate() {
                let (row, column) = (k / per_row, k % per_row);
                let y = top + title + sheet::LEGEND_ROW * (row as f64 + 0.5);
                let at = (frame.left + column as f64 * width, y);
                sheet::legend_entry(pen, at, width - 8.0, sample, name);
            }
        });
    }
}

/// Draws what of a curve lies in the frame.
fn paint_curve(pen: &mut Pen, curve: &Curve, frame: Rect, across: Scale, up: Scale) {
    // what has no value breaks a curve
    for stretch in curve.points.split(|p| !(p.0.is_finite() && p.1.is_finite())) {
        let pixels = stretch.iter().map(|p| (across.pixel(p.0), up.pixel(p.1))).collect();
        for piece in clip::clip(&thinned(pixels), frame.grown(0.5)) {
            pen.path(&piece, curve.stroke);
        }
    }
}

/// Drops points closer than half a pixel to the one before: long histories stay small files.
fn thinned(points: Vec<Point>) -> Vec<Point> {
    let last = points.last().copied();
    let mut kept: Vec<Point> = Vec::new();
    for point in points {
        if kept.last().is_none_or(|&before| clip::distance(before, point) >= 0.5) {
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

    fn footer(&self, pen: &mut Pen, height: f64) {
        let remarks = [sheet::failed_checks(self.diagnostics), self.remarks.clone()].join(" ");
        let words =
            FooterWords { remarks: remarks.trim().to_owned(), content: sheet::model_words(self.model) };
        sheet::footer(pen, (WIDTH, height), self.case, self.version, &words);
    }
}

/// The panels in so many columns, as SVG text; panels with equal scales are higher.
///
/// # Errors
/// A failure of the drawing library.
pub fn figure(around: &Surroundings<'_>, panels: &[Panel], columns: usize) -> Result<String> {
    let below_title = sheet::below_title(WIDTH, &around.title) + 10.0;
    let equal = panels.iter().any(|p| p.equal) && columns == 1;
    let usual = if equal { 3.0 * PANEL_HEIGHT } else { 1.3 * PANEL_HEIGHT };
    let given = panels.iter().map(|p| p.height).fold(0.0, f64::max);
    let row_height = if given > 0.0 { given } else { usual };
    let rows = panels.len().div_ceil(columns).max(1) as f64;
    let height = below_title + rows * (row_height + GAP) + sheet::FOOTER_HEIGHT;
    sheet::figure(WIDTH, height, |pen| {
        sheet::title(pen, WIDTH, &around.title);
        let width = panel_width(columns);
        for (k, panel) in panels.iter().enumerate() {
            let left = sheet::MARGIN + (k % columns) as f64 * width;
            let top = below_title + (k / columns) as f64 * (row_height + GAP);
            panel.paint(pen, Rect { left, top, right: left + width - 6.0, bottom: top + row_height });
        }
        if panels.is_empty() {
            let font = Font::new(palette::LABEL_SIZE);
            pen.text((sheet::MARGIN, below_title + 20.0), "Nothing to draw.", font, Anchor::Left);
        }
        around.footer(pen, height);
    })
}

fn panel_width(columns: usize) -> f64 {
    (WIDTH - 2.0 * sheet::MARGIN) / columns as f64
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
    let below_title = sheet::below_title(WIDTH, &around.title) + 10.0;
    let (row, names, values) = (34.0, 240.0, 200.0);
    let height = below_title + row * parts.len() as f64 + GAP + sheet::FOOTER_HEIGHT;
    let total: f64 = parts.iter().map(|(_, value)| value).sum();
    let room = WIDTH - 2.0 * sheet::MARGIN - names - values;
    sheet::figure(WIDTH, height, |pen| {
        sheet::title(pen, WIDTH, &around.title);
        let left = sheet::MARGIN + names;
        for (k, (name, value)) in parts.iter().enumerate() {
            let share = if total > 0.0 { value / total } else { 0.0 };
            let middle = below_title + row * (k as f64 + 0.5);
            let bar = Rect {
                left,
                right: left + (room * share).max(1.0),
                top: middle - 0.3 * row,
                bottom: middle + 0.3 * row,
            };
            let font = Font::new(palette::LABEL_SIZE);
            let words = format!("{} {unit}, {:.1} %", text::significant(*value, 3), 100.0 * share);
            pen.group("bar", &format!("{name}: {words}"), |pen| {
                pen.fill_rect(bar, palette::BLUE);
                pen.text((left - 10.0, middle), name, font, Anchor::Right);
                pen.text((bar.right + 10.0, middle), &words, font, Anchor::Left);
            });
        }
        let ends = [(left, below_title), (left, below_title + row * parts.len() as f64)];
        pen.path(&ends, Stroke::solid(palette::BLACK, 1.0));
        around.footer(pen, height);
    })
}
