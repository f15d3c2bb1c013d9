//! The look every figure shares: colours, strokes, fonts, axes, legend, title and footer, on a canvas in
//! logical pixels (x to the right, y downwards).
//!
//! The SVG backend has integer coordinates only, so everything is drawn [`SCALE`] times too large and shrunk by
//! the viewBox; curves would show stair-steps otherwise. It knows no dash patterns either: dashes are composed
//! of short paths. Text cannot be measured without fonts, so widths are estimated on the generous side.

use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, FontTransform, IntoFont, RGBAColor, RGBColor, ShapeStyle, TextStyle};

use crate::error::{Error, Result};
use crate::results::{CaseInfo, Diagnostic, Level, ModelSummary, Whirl, listed};

/// Backend units per logical pixel.
pub const SCALE: f64 = 8.0;

/// A point in logical pixels.
pub type Point = (f64, f64);

/// A colour; those below differ in lightness too, so that figures survive greyscale printing.
pub type Color = RGBColor;

/// Dark blue (after Okabe and Ito, darkened).
pub const BLUE: Color = RGBColor(0, 84, 148);
/// Vermillion (Okabe and Ito).
pub const VERMILLION: Color = RGBColor(213, 94, 0);
/// Bluish green (Okabe and Ito).
pub const GREEN: Color = RGBColor(0, 158, 115);
/// Text and marks.
pub const BLACK: Color = RGBColor(0, 0, 0);
/// Secondary text.
pub const DARK_GREY: Color = RGBColor(80, 80, 80);
/// Helper lines that carry meaning.
pub const GREY: Color = RGBColor(130, 130, 130);
/// Grid lines.
pub const LIGHT_GREY: Color = RGBColor(226, 226, 226);
/// Backgrounds of what is told apart.
pub const PALE_GREY: Color = RGBColor(238, 238, 238);
/// Band under unstable stretches.
pub const LIGHT_RED: Color = RGBColor(244, 160, 160);
/// Backgrounds of what is unstable.
pub const PALE_RED: Color = RGBColor(252, 228, 226);
/// Background.
pub const WHITE: Color = RGBColor(255, 255, 255);

/// Font sizes in logical pixels.
pub const TITLE_SIZE: f64 = 20.0;
/// Axis labels and legend.
pub const LABEL_SIZE: f64 = 15.0;
/// Tick labels and tables.
pub const TICK_SIZE: f64 = 14.0;
/// Footer and remarks.
pub const SMALL_SIZE: f64 = 12.5;

/// How a curve is broken up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Unbroken.
    Solid,
    /// Long strokes.
    Dashed,
    /// Short strokes.
    Dotted,
    /// Long and short strokes in turn.
    DashDot,
    /// A long stroke and two short ones in turn.
    DashDotDot,
}

impl Line {
    /// Lengths of strokes and gaps in turn, in multiples of logical pixels; empty for an unbroken line.
    fn pattern(self) -> &'static [f64] {
        match self {
            Line::Solid => &[],
            Line::Dashed => &[9.0, 5.0],
            Line::Dotted => &[2.5, 3.5],
            Line::DashDot => &[11.0, 4.0, 2.5, 4.0],
            Line::DashDotDot => &[9.0, 3.5, 2.0, 3.0, 2.0, 3.5],
        }
    }
}

/// Colour, width and kind of a curve.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width in logical pixels.
    pub width: f64,
    /// Kind.
    pub line: Line,
}

impl Stroke {
    /// An unbroken stroke.
    pub const fn solid(color: Color, width: f64) -> Self {
        Self { color, width, line: Line::Solid }
    }

    /// Whirl by colour and line kind alike: forward blue solid, backward vermillion dashed, mixed green with two dots a stroke,
    /// none black dotted.
    pub fn whirl(whirl: Whirl) -> Self {
        let (color, line) = match whirl {
            Whirl::Forward => (BLUE, Line::Solid),
            Whirl::Backward => (VERMILLION, Line::Dashed),
            Whirl::Mixed => (GREEN, Line::DashDotDot),
            Whirl::None => (BLACK, Line::Dotted),
        };
        Self { color, width: 2.2, line }
    }
}

/// Symbol of a single point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle.
    Disc,
    /// White circle with a black rim.
    Ring,
    /// Filled triangle.
    Triangle,
    /// Filled square.
    Square,
    /// Filled square on its corner.
    Diamond,
    /// Filled triangle, point down.
    Downward,
    /// Two strokes, crossed.
    Cross,
    /// Two strokes, upright.
    Plus,
}

impl Marker {
    /// Symbol for points of a branch that cannot be joined to a curve.
    pub fn whirl(whirl: Whirl) -> Self {
        match whirl {
            Whirl::Forward => Marker::Disc,
            Whirl::Backward => Marker::Triangle,
            Whirl::Mixed => Marker::Diamond,
            Whirl::None => Marker::Square,
        }
    }
}

/// Size, colour and weight of a text.
#[derive(Debug, Clone, Copy)]
pub struct Font {
    /// Height of an em in logical pixels.
    pub size: f64,
    /// Colour.
    pub color: Color,
    /// Bold instead of regular.
    pub bold: bool,
}

impl Font {
    /// Regular black text.
    pub const fn new(size: f64) -> Self {
        Self { size, color: BLACK, bold: false }
    }
    /// The same in bold.
    pub const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }
    /// The same in another colour.
    pub const fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }
}

/// An upright rectangle in logical pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

impl Rect {
    /// The rectangle of this width and height around a centre.
    pub fn around(center: Point, width: f64, height: f64) -> Self {
        let (x, y) = center;
        Self {
            left: x - width / 2.0,
            top: y - height / 2.0,
            right: x + width / 2.0,
            bottom: y + height / 2.0,
        }
    }
    /// Width.
    pub fn width(&self) -> f64 {
        self.right - self.left
    }
    /// Height.
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }
    /// Centre.
    pub fn center(&self) -> Point {
        ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0)
    }
    /// The rectangle with all edges moved outwards.
    pub fn grown(&self, by: f64) -> Self {
        Self { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }
    /// Whether a point lies in it, edges included.
    pub fn contains(&self, (x, y): Point) -> bool {
        self.left <= x && x <= self.right && self.top <= y && y <= self.bottom
    }
    /// Whether another rectangle lies in it.
    pub fn encloses(&self, other: &Rect) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right, other.bottom))
    }
    /// Whether both share more than an edge.
    pub fn overlaps(&self, other: &Rect) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}

/// What a figure is painted on. A failure of the backend is kept and reported once, by [`figure`].
pub struct Canvas<'a> {
    backend: SVGBackend<'a>,
    failure: Option<String>,
}

/// Paints a figure of this size (logical pixels) on white and returns it as SVG text.
pub fn figure(width: f64, height: f64, paint: impl FnOnce(&mut Canvas)) -> Result<String> {
    let (large_width, large_height) = ((width * SCALE).round() as u32, (height * SCALE).round() as u32);
    let mut text = String::new();
    let failure = {
        let backend = SVGBackend::with_string(&mut text, (large_width, large_height));
        let mut canvas = Canvas { backend, failure: None };
        canvas.fill(&[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)], WHITE);
        paint(&mut canvas);
        let presented = canvas.backend.present().map_err(|error| error.to_string());
        canvas.note(presented);
        canvas.failure
    };
    if let Some(message) = failure {
        return Err(Error::analysis(
            format!("the figure could not be drawn: {message}"),
            "writing it as SVG",
            "run with --no-plots and report the case",
        ));
    }
    let large = format!("width=\"{large_width}\" height=\"{large_height}\"");
    let small = format!("width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\"");
    Ok(text.replacen(&large, &small, 1))
}

impl Canvas<'_> {
    fn note(&mut self, outcome: std::result::Result<(), String>) {
        if let (Err(message), None) = (outcome, &self.failure) {
            self.failure = Some(message);
        }
    }

    fn unbroken(&mut self, points: &[Point], color: Color, width: f64) {
        let style = shape(color, width);
        let path: Vec<_> = points.iter().map(|&p| backend_point(p)).collect();
        let outcome = self.backend.draw_path(path, &style).map_err(|error| error.to_string());
        self.note(outcome);
    }

    /// Draws a curve through the points.
    pub fn path(&mut self, points: &[Point], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        match stroke.line.pattern() {
            [] => self.unbroken(points, stroke.color, stroke.width),
            pattern => {
                for piece in dashes(points, pattern) {
                    self.unbroken(&piece, stroke.color, stroke.width);
                }
            }
        }
    }

    /// Draws a closed curve through the points.
    pub fn outline(&mut self, points: &[Point], stroke: Stroke) {
        let closed: Vec<Point> = points.iter().chain(points.first()).copied().collect();
        self.path(&closed, stroke);
    }

    /// Draws the edges of a rectangle.
    pub fn frame(&mut self, rect: Rect, stroke: Stroke) {
        self.outline(&corners(rect), stroke);
    }

    /// Fills a polygon.
    pub fn fill(&mut self, points: &[Point], color: Color) {
        let path: Vec<_> = points.iter().map(|&p| backend_point(p)).collect();
        let outcome = self.backend.fill_polygon(path, &shape(color, 1.0)).map_err(|error| error.to_string());
        self.note(outcome);
    }

    /// Fills a rectangle.
    pub fn fill_rect(&mut self, rect: Rect, color: Color) {
        self.fill(&corners(rect), color);
    }

    /// Draws a filled circle.
    pub fn disc(&mut self, center: Point, radius: f64, color: Color) {
        let radius = (radius * SCALE).round() as u32;
        let outcome = self.backend.draw_circle(backend_point(center), radius, &shape(color, 1.0), true);
        self.note(outcome.map_err(|error| error.to_string()));
    }

    /// Draws a white circle with a coloured rim.
    pub fn ring(&mut self, center: Point, radius: f64, color: Color, width: f64) {
        self.disc(center, radius + width / 2.0, color);
        self.disc(center, radius - width / 2.0, WHITE);
    }

    /// Draws a symbol of about this radius.
    pub fn marker(&mut self, center: Point, marker: Marker, radius: f64, color: Color) {
        let (x, y) = center;
        match marker {
            Marker::Disc => self.disc(center, radius, color),
            Marker::Ring => self.ring(center, radius, color, 1.6),
            Marker::Triangle => {
                let (wide, tall) = (radius * 1.1, radius * 0.9);
                self.fill(&[(x - wide, y + tall), (x + wide, y + tall), (x, y - radius * 1.2)], color);
            }
            Marker::Square => self.fill_rect(Rect::around(center, 1.8 * radius, 1.8 * radius), color),
            Marker::Diamond => {
                let r = 1.25 * radius;
                self.fill(&[(x - r, y), (x, y - r), (x + r, y), (x, y + r)], color);
            }
            Marker::Downward => {
                let (wide, tall) = (radius * 1.1, radius * 0.9);
                self.fill(&[(x - wide, y - tall), (x + wide, y - tall), (x, y + radius * 1.2)], color);
            }
            Marker::Cross => {
                let (r, stroke) = (0.85 * radius, Stroke::solid(color, 0.5 * radius));
                self.path(&[(x - r, y - r), (x + r, y + r)], stroke);
                self.path(&[(x - r, y + r), (x + r, y - r)], stroke);
            }
            Marker::Plus => {
                let (r, stroke) = (1.1 * radius, Stroke::solid(color, 0.5 * radius));
                self.path(&[(x - r, y), (x + r, y)], stroke);
                self.path(&[(x, y - r), (x, y + r)], stroke);
            }
        }
    }

    /// Writes one line of text; `at` is its left end, centre or right end, at half the height of capitals.
    pub fn text(&mut self, at: Point, text: &str, font: Font, anchor: HPos) {
        let above = (at.0, at.1 - CENTER_BELOW_TOP * font.size);
        self.write(above, text, font, anchor, FontTransform::None);
    }

    /// Writes one line of text upwards, centred at `at`.
    pub fn vertical_text(&mut self, at: Point, text: &str, font: Font) {
        let beside = (at.0 - CENTER_BELOW_TOP * font.size, at.1);
        self.write(beside, text, font, HPos::Center, FontTransform::Rotate270);
    }

    fn write(&mut self, at: Point, text: &str, font: Font, anchor: HPos, transform: FontTransform) {
        let text = printable(text);
        if text.is_empty() {
            return;
        }
        let weight = if font.bold { FontStyle::Bold } else { FontStyle::Normal };
        // The backend divides sizes by 1.24 to turn the height of a line into an em.
        let described =
            ("sans-serif", font.size * SCALE * 1.24).into_font().style(weight).transform(transform);
        let style = TextStyle::from(described).color(&font.color).pos(Pos::new(anchor, VPos::Top));
        let outcome =
            self.backend.draw_text(&text, &style, backend_point(at)).map_err(|error| error.to_string());
        self.note(outcome);
    }
}

/// Distance from the upper anchor (0.76 em above the baseline) to half the height of capitals, in em.
const CENTER_BELOW_TOP: f64 = 0.76 - 0.36;

fn shape(color: Color, width: f64) -> ShapeStyle {
    let stroke_width = (width * SCALE).round().max(1.0) as u32;
    ShapeStyle { color: RGBAColor(color.0, color.1, color.2, 1.0), filled: true, stroke_width }
}

fn backend_point((x, y): Point) -> (i32, i32) {
    ((x * SCALE).round() as i32, (y * SCALE).round() as i32)
}

fn corners(rect: Rect) -> [Point; 4] {
    [(rect.left, rect.top), (rect.right, rect.top), (rect.right, rect.bottom), (rect.left, rect.bottom)]
}

/// The strokes of a broken line along the points; `pattern` holds strokes and gaps in turn, all positive.
pub fn dashes(points: &[Point], pattern: &[f64]) -> Vec<Vec<Point>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<Point> = points.first().copied().into_iter().collect();
    let (mut phase, mut remaining) = (0, pattern.first().copied().unwrap_or(f64::INFINITY));
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut length = distance(from, to);
        while length > remaining {
            from = between(from, to, remaining / length);
            length -= remaining;
            if phase % 2 == 0 {
                piece.push(from);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![from];
            }
            phase = (phase + 1) % pattern.len();
            remaining = pattern[phase];
        }
        remaining -= length;
        if phase % 2 == 0 {
            piece.push(to);
        }
    }
    if piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

/// Distance of two points.
pub fn distance(a: Point, b: Point) -> f64 {
    ((a.0 - b.0).powi(2) + (a.1 - b.1).powi(2)).sqrt()
}

/// The point a fraction of the way from one point to another.
pub fn between(a: Point, b: Point, fraction: f64) -> Point {
    (a.0 + fraction * (b.0 - a.0), a.1 + fraction * (b.1 - a.1))
}

/// The stretches of a polygonal line that lie inside a rectangle.
pub fn clip(points: &[Point], rect: Rect) -> Vec<Vec<Point>> {
    let mut stretches: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        let Some((start, end)) = clip_segment(pair[0], pair[1], rect) else { continue };
        match stretches.last_mut() {
            Some(stretch) if stretch.last() == Some(&start) => stretch.push(end),
            _ => stretches.push(vec![start, end]),
        }
    }
    stretches
}

/// The part of a segment inside a rectangle (Liang and Barsky 1984).
pub fn clip_segment(from: Point, to: Point, rect: Rect) -> Option<(Point, Point)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let edges = [
        (-dx, from.0 - rect.left),
        (dx, rect.right - from.0),
        (-dy, from.1 - rect.top),
        (dy, rect.bottom - from.1),
    ];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (towards, room) in edges {
        if towards == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if towards < 0.0 {
            enter = enter.max(room / towards);
        } else {
            leave = leave.min(room / towards);
        }
    }
    if enter > leave {
        return None;
    }
    let start = if enter == 0.0 { from } else { between(from, to, enter) };
    let end = if leave == 1.0 { to } else { between(from, to, leave) };
    Some((start, end))
}

/// Positions as near as possible (least squares) to the wanted ones, in the same order, at least `gap` apart and
/// within `[low, high]`; the gap shrinks if there is too little room.
pub fn spread(wanted: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    if wanted.is_empty() {
        return Vec::new();
    }
    let steps = (wanted.len() - 1) as f64;
    let gap = if steps * gap > high - low { (high - low) / steps } else { gap };
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // With the gaps subtracted, positions need only ascend: isotonic regression by pooling, then clamping.
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (rank, &index) in order.iter().enumerate() {
        let mut pool = (wanted[index] - rank as f64 * gap, 1);
        while let Some(&(mean, count)) = pools.last() {
            if mean <= pool.0 {
                break;
            }
            pools.pop();
            let total = count + pool.1;
            pool = ((mean * count as f64 + pool.0 * pool.1 as f64) / total as f64, total);
        }
        pools.push(pool);
    }
    let highest = (high - steps * gap).max(low);
    let ascending =
        pools.iter().flat_map(|&(mean, count)| std::iter::repeat_n(mean.clamp(low, highest), count));
    let mut placed = vec![0.0; wanted.len()];
    for ((rank, &index), position) in order.iter().enumerate().zip(ascending) {
        placed[index] = position + rank as f64 * gap;
    }
    placed
}

/// Linear map from a quantity to logical pixels.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Quantity at `start`.
    pub low: f64,
    /// Quantity at `end`.
    pub high: f64,
    /// Pixel of `low`.
    pub start: f64,
    /// Pixel of `high`.
    pub end: f64,
}

impl Scale {
    /// Pixel of a value, bounded so that far-off values stay drawable (and clippable).
    pub fn pixel(&self, value: f64) -> f64 {
        let fraction = (value - self.low) / (self.high - self.low);
        (self.start + fraction * (self.end - self.start)).clamp(-1e6, 1e6)
    }
    /// The same pixels for the quantity in another unit.
    pub fn times(&self, factor: f64) -> Self {
        Self { low: self.low * factor, high: self.high * factor, ..*self }
    }
}

/// Tick values of an axis with the power of ten taken out of their labels.
#[derive(Debug, Clone, PartialEq)]
pub struct Ticks {
    /// Value and label of each tick, ascending.
    pub marks: Vec<(f64, String)>,
    /// Power of ten the labels are to be multiplied by; a multiple of three.
    pub exponent: i32,
}

/// At most about `count` ticks at multiples of 1, 2 or 5 times a power of ten within `[low, high]`.
pub fn ticks(low: f64, high: f64, count: f64) -> Ticks {
    let step = nice_step((high - low) / count.max(1.0));
    let largest = low.abs().max(high.abs());
    let exponent =
        if (0.01..1e5).contains(&largest) { 0 } else { 3 * (largest.log10() / 3.0).floor() as i32 };
    let unit = 10f64.powi(exponent);
    let decimals = (-(step / unit * 1.001).log10().floor()).clamp(0.0, 9.0) as usize;
    let first = (low / step - 1e-9).ceil();
    let number = ((high / step + 1e-9).floor() - first).clamp(0.0, 50.0) as usize;
    let mark = |index: usize| {
        // Adding zero turns a negative zero into a positive one.
        let value = (first + index as f64) * step + 0.0;
        (value, format!("{:.decimals$}", value / unit + 0.0))
    };
    Ticks { marks: (0..=number).map(mark).collect(), exponent }
}

fn nice_step(least: f64) -> f64 {
    if !(least.is_finite() && least > 0.0) {
        return 1.0;
    }
    let power = 10f64.powi(least.log10().floor() as i32);
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= least * 0.999).unwrap_or(10.0);
    factor * power
}

/// A quantity with its unit and, if needed, a power of ten: "Spin speed (10³ rpm)".
pub fn axis_label(quantity: &str, unit: &str, exponent: i32) -> String {
    match exponent {
        0 => format!("{quantity} ({unit})"),
        _ => format!("{quantity} (10{} {unit})", superscript(exponent)),
    }
}

/// A power in raised digits.
pub fn superscript(exponent: i32) -> String {
    let raised = |character| match character {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    exponent.to_string().chars().map(raised).collect()
}

/// Side of a plot an axis stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Below.
    Bottom,
    /// Above.
    Top,
    /// To the left.
    Left,
    /// To the right.
    Right,
}

/// Distance of an axis' label from the axis (its centre), horizontal and vertical axes.
const LABEL_DISTANCE: (f64, f64) = (43.0, 67.0);

/// Draws ticks, tick labels and the axis label; the axis runs along `at` (a y for horizontal, an x for vertical
/// axes).
pub fn axis(canvas: &mut Canvas, side: Side, at: f64, scale: Scale, quantity: &str, unit: &str) {
    let horizontal = matches!(side, Side::Bottom | Side::Top);
    let spacing = if horizontal { 85.0 } else { 48.0 };
    let ticks = ticks(scale.low, scale.high, (scale.end - scale.start).abs() / spacing);
    let outwards = if matches!(side, Side::Bottom | Side::Right) { 1.0 } else { -1.0 };
    for (value, label) in &ticks.marks {
        let along = scale.pixel(*value);
        let stroke = Stroke::solid(BLACK, 1.0);
        if horizontal {
            canvas.path(&[(along, at), (along, at + 6.0 * outwards)], stroke);
            canvas.text((along, at + 17.0 * outwards), label, Font::new(TICK_SIZE), HPos::Center);
        } else {
            canvas.path(&[(at, along), (at + 6.0 * outwards, along)], stroke);
            let anchor = if side == Side::Left { HPos::Right } else { HPos::Left };
            canvas.text((at + 9.0 * outwards, along), label, Font::new(TICK_SIZE), anchor);
        }
    }
    let label = axis_label(quantity, unit, ticks.exponent);
    let middle = (scale.start + scale.end) / 2.0;
    if horizontal {
        let centre = (middle, at + LABEL_DISTANCE.0 * outwards);
        canvas.text(centre, &label, Font::new(LABEL_SIZE), HPos::Center);
    } else {
        canvas.vertical_text((at + LABEL_DISTANCE.1 * outwards, middle), &label, Font::new(LABEL_SIZE));
    }
}

/// Draws light lines across the frame at the ticks of both scales.
pub fn grid(canvas: &mut Canvas, frame: Rect, across: Scale, up: Scale) {
    let stroke = Stroke::solid(LIGHT_GREY, 1.0);
    for (value, _) in ticks(across.low, across.high, frame.width() / 85.0).marks {
        let x = across.pixel(value);
        canvas.path(&[(x, frame.top), (x, frame.bottom)], stroke);
    }
    for (value, _) in ticks(up.low, up.high, frame.height() / 48.0).marks {
        let y = up.pixel(value);
        canvas.path(&[(frame.left, y), (frame.right, y)], stroke);
    }
}

/// What a legend entry shows beside its words.
#[derive(Debug, Clone, Copy)]
pub enum Sample {
    /// A curve.
    Stroke(Stroke),
    /// A curve on top of a wider one.
    Band(Stroke, Stroke),
    /// A symbol.
    Marker(Marker, Color),
}

/// Height of a legend entry.
pub const LEGEND_ROW: f64 = 20.0;
/// Room for the sample of a legend entry.
pub const LEGEND_SAMPLE: f64 = 44.0;

/// Draws one legend entry whose sample starts at `at`; words beyond `width` are shortened.
pub fn legend_entry(canvas: &mut Canvas, at: Point, width: f64, sample: Sample, words: &str) {
    let (x, y) = at;
    let ends = [(x, y), (x + 36.0, y)];
    match sample {
        Sample::Stroke(stroke) => canvas.path(&ends, stroke),
        Sample::Band(below, above) => {
            canvas.path(&ends, below);
            canvas.path(&ends, above);
        }
        Sample::Marker(marker, color) => canvas.marker((x + 18.0, y), marker, 4.5, color),
    }
    let words = shorten(words, TICK_SIZE, width - LEGEND_SAMPLE);
    canvas.text((x + LEGEND_SAMPLE, y), &words, Font::new(TICK_SIZE), HPos::Left);
}

/// Height of a line of the title.
const TITLE_LINE: f64 = 26.0;
/// Margin around every figure.
pub const MARGIN: f64 = 16.0;

fn title_lines(width: f64, text: &str) -> Vec<String> {
    wrap(text, TITLE_SIZE * BOLD_WIDER, width - 2.0 * MARGIN, 2)
}

/// The y below a title, at most two lines of it.
pub fn below_title(width: f64, text: &str) -> f64 {
    MARGIN + TITLE_LINE * title_lines(width, text).len() as f64
}

/// Draws the title.
pub fn title(canvas: &mut Canvas, width: f64, text: &str) {
    for (row, line) in title_lines(width, text).iter().enumerate() {
        let y = MARGIN + TITLE_LINE * (row as f64 + 0.5);
        canvas.text((MARGIN, y), line, Font::new(TITLE_SIZE).bold(), HPos::Left);
    }
}

/// Bold letters are about this much wider than regular ones.
const BOLD_WIDER: f64 = 1.12;
/// Height of a line of the footer.
const FOOTER_LINE: f64 = 17.0;
/// Height that a footer needs, margin included.
pub const FOOTER_HEIGHT: f64 = 4.0 * FOOTER_LINE + MARGIN;

/// Draws the footer: the case, the program, remarks on this figure, and what was modelled.
pub fn footer(canvas: &mut Canvas, size: (f64, f64), case: &CaseInfo, version: &str, words: &FooterWords) {
    let width = size.0 - 2.0 * MARGIN;
    let title = shorten(&case.title, SMALL_SIZE, 0.45 * width);
    let file = shorten(&case.file, SMALL_SIZE, 0.25 * width);
    let digest: String = case.sha256.chars().take(12).collect();
    let origin = format!("{title}  |  {file} (sha256 {digest})  |  rotor {version}");
    let mut lines = wrap(&origin, SMALL_SIZE, width, 1);
    lines.extend(wrap(&words.remarks, SMALL_SIZE, width, 2));
    lines.extend(wrap(&words.content, SMALL_SIZE, width, 4 - lines.len()));
    let top = size.1 - FOOTER_HEIGHT;
    for (row, line) in lines.iter().enumerate() {
        let y = top + FOOTER_LINE * (row as f64 + 0.5);
        canvas.text((MARGIN, y), line, Font::new(SMALL_SIZE).color(DARK_GREY), HPos::Left);
    }
}

/// The parts of a footer that differ from figure to figure.
#[derive(Debug, Clone)]
pub struct FooterWords {
    /// At most two lines on this figure.
    pub remarks: String,
    /// What was modelled and what was left out.
    pub content: String,
}

/// Size of the model, what it contains and what it leaves out, in one sentence.
pub fn model_words(model: &ModelSummary) -> String {
    let mut words = format!(
        "{} elements, {} degrees of freedom, {} kg.",
        model.elements,
        model.degrees_of_freedom,
        significant(model.mass_kg, 4)
    );
    for (name, items) in [("Modelled", listed(&model.modelled)), ("Left out", listed(&model.left_out))] {
        if !items.is_empty() {
            words += &format!(" {name}: {}.", items);
        }
    }
    words
}

/// A remark on failed checks, empty if there are none: a figure must not look better than its numbers.
pub fn failed_checks(diagnostics: &[Diagnostic]) -> String {
    match diagnostics.iter().filter(|diagnostic| diagnostic.level == Level::Error).count() {
        0 => String::new(),
        1 => "One check failed, see the report.".to_owned(),
        count => format!("{count} checks failed, see the report."),
    }
}

/// Estimated width of a text, on the generous side for common sans-serif fonts.
pub fn text_width(text: &str, size: f64) -> f64 {
    text.chars().map(character_width).sum::<f64>() * size
}

/// Widths in em after DejaVu Sans, one of the widest fonts that stand in for "sans-serif".
fn character_width(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | '\'' => 0.28,
        ' ' | ',' | '.' | ';' | ':' | '|' | '/' | '!' | 'I' | '-' => 0.35,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '"' => 0.42,
        'm' | '…' | '%' | '@' => 1.0,
        'w' | '+' | '=' | '<' | '>' | '~' | '×' | '–' | '#' => 0.84,
        'W' => 1.0,
        'A'..='Z' | '&' => 0.78,
        '\u{0}'..='\u{7f}' => 0.64,
        '⁰'..='⁹' | '⁻' | '¹' | '²' | '³' | '·' => 0.45,
        '\u{80}'..='\u{2e7f}' => 0.8,
        _ => 1.05,
    }
}

/// The text itself if it fits, else its beginning with an ellipsis.
pub fn shorten(text: &str, size: f64, width: f64) -> String {
    let text = printable(text);
    if text_width(&text, size) <= width {
        return text;
    }
    let mut kept = String::new();
    let mut used = text_width("…", size);
    for character in text.chars() {
        used += character_width(character) * size;
        if used > width {
            break;
        }
        kept.push(character);
    }
    format!("{}…", kept.trim_end())
}

/// Breaks a text at spaces into at most `rows` lines; what does not fit ends in an ellipsis.
pub fn wrap(text: &str, size: f64, width: f64, rows: usize) -> Vec<String> {
    let text = printable(text);
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    let mut words = text.split_whitespace().peekable();
    while let Some(&word) = words.peek() {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if text_width(&longer, size) <= width {
            line = longer;
            words.next();
        } else if lines.len() + 1 >= rows {
            break;
        } else if line.is_empty() {
            lines.push(shorten(word, size, width));
            words.next();
        } else {
            lines.push(std::mem::take(&mut line));
        }
    }
    let rest: Vec<&str> = words.collect();
    if !rest.is_empty() {
        line = shorten(&format!("{line} {}", rest.join(" ")), size, width);
    }
    if !line.trim().is_empty() && rows > 0 {
        lines.push(line.trim_start().to_owned());
    }
    lines
}

/// The text without characters that XML forbids or that would break a line.
fn printable(text: &str) -> String {
    let allowed = |c: char| !c.is_control() && c != '\u{fffe}' && c != '\u{ffff}';
    text.chars().map(|c| if allowed(c) { c } else { ' ' }).collect()
}

/// A number with this many significant digits; a dash if it is not finite.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    // The rounded number decides on the decimals: 9.99996 has one digit less behind the point than 9.99994.
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent = rounded.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok()).unwrap_or(0);
    if (-4..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        rounded
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(low: f64, high: f64, count: f64) -> Vec<String> {
        ticks(low, high, count).marks.into_iter().map(|(_, label)| label).collect()
    }

    proptest! {
        #[test]
        fn spread_labels_keep_their_distance_order_and_bounds(
            wanted in proptest::collection::vec(-50.0..150.0f64, 0..60),
            gap in 0.0..5.0f64,
        ) {
            let placed = spread(&wanted, gap, 0.0, 100.0);
            prop_assert_eq!(placed.len(), wanted.len());
            let gap = gap.min(100.0 / (wanted.len() as f64 - 1.0).max(1.0));
            for (i, &a) in placed.iter().enumerate() {
                prop_assert!((-1e-9..=100.0 + 1e-9).contains(&a));
                for (j, &b) in placed.iter().enumerate().skip(i + 1) {
                    prop_assert!((a - b).abs() >= gap - 1e-9);
                    prop_assert!(wanted[i] == wanted[j] || gap == 0.0 || (a < b) == (wanted[i] < wanted[j]));
                }
            }
        }

        #[test]
        fn ticks_are_few_and_inside(low in -1e3..1e3f64, power in -12..12i32, count in 2.0..12.0f64) {
            let high = low + 10f64.powi(power);
            let marks = ticks(low, high, count).marks;
            let slack = 1e-6 * (high - low) + 1e-9 * low.abs();
            prop_assert!(marks.len() <= 52);
            prop_assert!(marks.iter().all(|(value, _)| low - slack <= *value && *value <= high + slack));
        }

        #[test]
        fn dashes_and_gaps_add_up(points in proptest::collection::vec((0.0..100.0f64, 0.0..100.0f64), 2..20)) {
            let whole: f64 = points.windows(2).map(|p| distance(p[0], p[1])).sum();
            let drawn: f64 =
                dashes(&points, &[3.0, 2.0]).iter().flat_map(|d| d.windows(2)).map(|p| distance(p[0], p[1])).sum();
            prop_assert!((drawn - 0.6 * whole).abs() <= 2.0 + 1e-9, "{drawn} of {whole}");
        }

        #[test]
        fn wrapped_lines_fit(text in ".{0,200}", width in 40.0..400.0f64, rows in 1..4usize) {
            let lines = wrap(&text, 10.0, width, rows);
            prop_assert!(lines.len() <= rows);
            prop_assert!(lines.iter().all(|line| text_width(line, 10.0) <= width + 1e-9), "{lines:?}");
        }
    }

    #[test]
    fn labels_with_room_stay_where_they_belong() {
        assert_eq!(spread(&[90.0, 10.0, 50.0], 12.0, 0.0, 100.0), [90.0, 10.0, 50.0]);
        assert_eq!(spread(&[50.0, 50.0], 10.0, 0.0, 100.0), [45.0, 55.0]);
        assert_eq!(spread(&[0.0, 0.0], 10.0, 0.0, 100.0), [0.0, 10.0]);
    }

    #[test]
    fn ticks_have_round_labels() {
        assert_eq!(labels(0.0, 1.0, 5.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(0.0, 10000.0, 5.0), ["0", "2000", "4000", "6000", "8000", "10000"]);
        assert_eq!(labels(-1.0, 1.0, 2.0), ["-1", "0", "1"]);
        assert_eq!(ticks(0.0, 9.5e6, 5.0).exponent, 6);
        assert_eq!(axis_label("Speed", "rpm", ticks(0.0, 1e-3, 5.0).exponent), "Speed (10⁻³ rpm)");
    }

    #[test]
    fn lines_are_clipped_at_the_frame() {
        let frame = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        assert_eq!(
            clip(&[(-5.0, 5.0), (5.0, 5.0), (15.0, 5.0)], frame),
            [[(0.0, 5.0), (5.0, 5.0), (10.0, 5.0)]]
        );
        assert_eq!(clip(&[(5.0, 5.0), (5.0, 20.0), (8.0, 20.0), (8.0, 5.0)], frame).len(), 2);
        assert!(clip(&[(-5.0, -1.0), (15.0, -1.0)], frame).is_empty());
    }

    #[test]
    fn numbers_have_the_digits_asked_for() {
        let written =
            [0.0, 620.1, 9.99996, 123456.7, 1.5e9, 2e-7, -3.25, f64::NAN].map(|v| significant(v, 5));
        assert_eq!(written, ["0", "620.10", "10.000", "123457", "1.5000e9", "2.0000e-7", "-3.2500", "–"]);
    }

    #[test]
    fn a_failure_of_the_backend_is_an_error() {
        let svg = figure(100.0, 50.0, |canvas| canvas.note(Err("disk full".to_owned())));
        assert!(matches!(svg, Err(Error::Analysis { what, .. }) if what.contains("disk full")));
    }
}
