//! A pen that draws in logical pixels: it turns strokes, symbols and words into what the backend knows.

use std::fmt::Display;

use plotters::style::text_anchor::{Pos, VPos};
use plotters::style::{Color as _, FontStyle, FontTransform, IntoFont, RGBAColor, ShapeStyle, TextStyle};
use plotters_backend::{BackendCoord, DrawingBackend};

use crate::draw::clip::{Point, Rect, simplified};
use crate::draw::palette::{Color, Font, LineStyle, Marker, Stroke, WHITE};
use crate::draw::svg::{SCALE, Svg};
use crate::draw::text::Anchor;

/// Distance in logical pixels below which a point of a curve is not missed.
const UNSEEN: f64 = 0.1;

/// Draws on a backend. The backend's first failure is kept until [`Pen::finish`].
pub struct Pen<'a> {
    svg: Svg<'a>,
    failure: Option<String>,
}

impl<'a> Pen<'a> {
    /// A pen on an empty figure of this size in logical pixels, which will be written to `out`.
    pub fn new(out: &'a mut String, (width, height): Point) -> Self {
        Self { svg: Svg::with_string(out, (units(width), units(height))), failure: None }
    }

    /// Writes the figure.
    ///
    /// # Errors
    /// The message of the backend's first failure.
    pub fn finish(mut self) -> Result<(), String> {
        let outcome = self.svg.present();
        self.keep(outcome);
        self.failure.map_or(Ok(()), Err)
    }

    pub(super) fn keep(&mut self, outcome: Result<(), impl Display>) {
        if let (Err(error), None) = (outcome, &self.failure) {
            self.failure = Some(error.to_string());
        }
    }

    /// Draws shapes that belong together, as a group with a class; a title is shown on hover over any of them, an empty one is left out.
    pub fn group<R>(&mut self, class: &'static str, title: &str, paint: impl FnOnce(&mut Self) -> R) -> R {
        self.svg.open_group(class, title);
        let result = paint(self);
        self.svg.close_group();
        result
    }

    /// Draws a curve through the points.
    pub fn path(&mut self, points: &[Point], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        let shown = simplified(points, UNSEEN);
        self.dash(stroke.line);
        let outcome = self.svg.draw_path(shown.into_iter().map(place), &style(stroke.color, stroke.width));
        self.keep(outcome);
    }

    /// Draws a closed curve through the points.
    pub fn outline(&mut self, points: &[Point], stroke: Stroke) {
        let closed: Vec<Point> = points.iter().chain(points.first()).copied().collect();
        if closed.len() < 3 {
            return;
        }
        let shown = simplified(&closed, UNSEEN);
        self.dash(stroke.line);
        self.svg.draw_outline(shown.into_iter().map(place), &style(stroke.color, stroke.width));
    }

    /// Draws the edges of a rectangle.
    pub fn frame(&mut self, rect: Rect, stroke: Stroke) {
        self.dash(stroke.line);
        let (upper_left, bottom_right) = ends(rect);
        let style = style(stroke.color, stroke.width);
        let outcome = self.svg.draw_rect(upper_left, bottom_right, &style, false);
        self.keep(outcome);
    }

    /// Fills a polygon.
    pub fn fill(&mut self, points: &[Point], color: Color) {
        let outcome = self.svg.fill_polygon(points.iter().copied().map(place), &color);
        self.keep(outcome);
    }

    /// Fills a rectangle.
    pub fn fill_rect(&mut self, rect: Rect, color: Color) {
        let (upper_left, bottom_right) = ends(rect);
        let outcome = self.svg.draw_rect(upper_left, bottom_right, &color, true);
        self.keep(outcome);
    }

    /// Draws a filled circle.
    pub fn disc(&mut self, center: Point, radius: f64, color: Color) {
        let outcome = self.svg.draw_circle(place(center), units(radius), &color, true);
        self.keep(outcome);
    }

    /// Draws a circle that covers nothing.
    pub fn circle(&mut self, center: Point, radius: f64, color: Color, width: f64) {
        let outcome = self.svg.draw_circle(place(center), units(radius), &style(color, width), false);
        self.keep(outcome);
    }

    /// Draws a white circle with a coloured rim.
    pub fn ring(&mut self, center: Point, radius: f64, color: Color, width: f64) {
        let fill = WHITE.to_backend_color();
        self.svg.draw_ring(place(center), units(radius), fill, &style(color, width));
    }

    /// Draws a symbol of about this radius.
    pub fn marker(&mut self, center: Point, marker: Marker, radius: f64, color: Color) {
        let (x, y) = center;
        let (wide, tall, tip) = (radius * 1.1, radius * 0.9, radius * 1.2);
        match marker {
            Marker::Disc => self.disc(center, radius, color),
            Marker::Ring => self.ring(center, radius, color, 1.6),
            Marker::Triangle => self.fill(&[(x - wide, y + tall), (x + wide, y + tall), (x, y - tip)], color),
            Marker::Downward => self.fill(&[(x - wide, y - tall), (x + wide, y - tall), (x, y + tip)], color),
            Marker::Square => self.fill_rect(Rect::around(center, 1.8 * radius, 1.8 * radius), color),
            Marker::Diamond => {
                let r = 1.25 * radius;
                self.fill(&[(x - r, y), (x, y - r), (x + r, y), (x, y + r)], color);
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
    pub fn text(&mut self, at: Point, text: &str, font: Font, anchor: Anchor) {
        self.write(at, text, font, anchor, FontTransform::None);
    }

    /// Writes one line of text upwards, centred at `at`.
    pub fn vertical_text(&mut self, at: Point, text: &str, font: Font) {
        self.write(at, text, font, Anchor::Center, FontTransform::Rotate270);
    }

    fn write(&mut self, at: Point, text: &str, font: Font, anchor: Anchor, transform: FontTransform) {
        let weight = if font.bold { FontStyle::Bold } else { FontStyle::Normal };
        let described = ("sans-serif", font.size * SCALE).into_font().style(weight).transform(transform);
        let style = TextStyle::from(described).color(&font.color).pos(Pos::new(anchor, VPos::Center));
        let outcome = self.svg.draw_text(text, &style, place(at));
        self.keep(outcome);
    }

    fn dash(&mut self, line: LineStyle) {
        self.svg.set_dashes(line.pattern().iter().map(|length| units(*length)));
    }
}

fn style(color: Color, width: f64) -> ShapeStyle {
    let color = RGBAColor(color.0, color.1, color.2, 1.0);
    ShapeStyle { color, filled: false, stroke_width: units(width).max(1) }
}

fn units(length: f64) -> u32 {
    (length * SCALE).round() as u32
}

fn place((x, y): Point) -> BackendCoord {
    ((x * SCALE).round() as i32, (y * SCALE).round() as i32)
}

fn ends(rect: Rect) -> (BackendCoord, BackendCoord) {
    (place((rect.left, rect.top)), place((rect.right, rect.bottom)))
}
