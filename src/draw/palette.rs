//! Colours, strokes, symbols and fonts that every figure shares.

use plotters::style::RGBColor;

use crate::results::Whirl;

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
/// Marks in the background.
pub const MID_GREY: Color = RGBColor(165, 165, 165);
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
pub enum LineStyle {
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

impl LineStyle {
    /// Lengths of strokes and gaps in turn, in logical pixels; empty for an unbroken line.
    pub fn pattern(self) -> &'static [f64] {
        match self {
            LineStyle::Solid => &[],
            LineStyle::Dashed => &[9.0, 5.0],
            LineStyle::Dotted => &[2.5, 3.5],
            LineStyle::DashDot => &[11.0, 4.0, 2.5, 4.0],
            LineStyle::DashDotDot => &[9.0, 3.5, 2.0, 3.0, 2.0, 3.5],
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
    pub line: LineStyle,
}

impl Stroke {
    /// An unbroken stroke.
    pub const fn solid(color: Color, width: f64) -> Self {
        Self { color, width, line: LineStyle::Solid }
    }

    /// Whirl by colour and line kind alike: forward blue solid, backward vermillion dashed, mixed green with two dots a stroke,
    /// none black dotted.
    pub fn whirl(whirl: Whirl) -> Self {
        let (color, line) = match whirl {
            Whirl::Forward => (BLUE, LineStyle::Solid),
            Whirl::Backward => (VERMILLION, LineStyle::Dashed),
            Whirl::Mixed => (GREEN, LineStyle::DashDotDot),
            Whirl::None => (BLACK, LineStyle::Dotted),
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
