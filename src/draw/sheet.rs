//! A sheet around a figure: background, title, legend entries and footer.

use crate::draw::clip::{Point, Rect};
use crate::draw::palette::{
    Color, DARK_GREY, Font, Marker, SMALL_SIZE, Stroke, TICK_SIZE, TITLE_SIZE, WHITE,
};
use crate::draw::pen::Pen;
use crate::draw::text::{Anchor, BOLD_WIDER, shorten, significant, wrap};
use crate::error::{Error, Result};
use crate::results::{CaseInfo, Diagnostic, Level, ModelSummary, listed};

/// Paints a figure of this size (logical pixels) on white and returns it as SVG text.
///
/// # Errors
/// A failure of the backend.
pub fn figure(width: f64, height: f64, paint: impl FnOnce(&mut Pen)) -> Result<String> {
    let mut text = String::new();
    let mut pen = Pen::new(&mut text, (width, height));
    pen.fill_rect(Rect { left: 0.0, top: 0.0, right: width, bottom: height }, WHITE);
    paint(&mut pen);
    let outcome = pen.finish();
    outcome.map(|()| text).map_err(|message| {
        Error::analysis(
            format!("the figure could not be drawn: {message}"),
            "writing it as SVG",
            "run with --no-plots and report the case",
        )
    })
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
pub fn legend_entry(pen: &mut Pen, at: Point, width: f64, sample: Sample, words: &str) {
    let (x, y) = at;
    let ends = [(x, y), (x + 36.0, y)];
    match sample {
        Sample::Stroke(stroke) => pen.path(&ends, stroke),
        Sample::Band(below, above) => {
            pen.path(&ends, below);
            pen.path(&ends, above);
        }
        Sample::Marker(marker, color) => pen.marker((x + 18.0, y), marker, 4.5, color),
    }
    let words = shorten(words, TICK_SIZE, width - LEGEND_SAMPLE);
    pen.text((x + LEGEND_SAMPLE, y), &words, Font::new(TICK_SIZE), Anchor::Left);
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
pub fn title(pen: &mut Pen, width: f64, text: &str) {
    pen.group("title", "", |pen| {
        for (row, line) in title_lines(width, text).iter().enumerate() {
            let y = MARGIN + TITLE_LINE * (row as f64 + 0.5);
            pen.text((MARGIN, y), line, Font::new(TITLE_SIZE).bold(), Anchor::Left);
        }
    });
}

/// Height of a line of the footer.
const FOOTER_LINE: f64 = 17.0;
/// Height that a footer needs, margin included.
pub const FOOTER_HEIGHT: f64 = 4.0 * FOOTER_LINE + MARGIN;

/// Draws the footer: the case, the program, remarks on this figure, and what was modelled.
pub fn footer(pen: &mut Pen, size: (f64, f64), case: &CaseInfo, version: &str, words: &FooterWords) {
    let width = size.0 - 2.0 * MARGIN;
    let title = shorten(&case.title, SMALL_SIZE, 0.45 * width);
    let file = shorten(&case.file, SMALL_SIZE, 0.25 * width);
    let digest: String = case.sha256.chars().take(12).collect();
    let origin = format!("{title}  |  {file} (sha256 {digest})  |  rotor {version}");
    let mut lines = wrap(&origin, SMALL_SIZE, width, 1);
    lines.extend(wrap(&words.remarks, SMALL_SIZE, width, 2));
    lines.extend(wrap(&words.content, SMALL_SIZE, width, 4 - lines.len()));
    let top = size.1 - FOOTER_HEIGHT;
    pen.group("footer", "", |pen| {
        for (row, line) in lines.iter().enumerate() {
            let y = top + FOOTER_LINE * (row as f64 + 0.5);
            pen.text((MARGIN, y), line, Font::new(SMALL_SIZE).color(DARK_GREY), Anchor::Left);
        }
    });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_of_the_backend_is_an_error() {
        let svg = figure(100.0, 50.0, |pen| pen.keep(Err("disk full")));
        assert!(matches!(svg, Err(Error::Analysis { what, .. }) if what.contains("disk full")));
    }
}
