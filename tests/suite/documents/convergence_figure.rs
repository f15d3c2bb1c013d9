//! Errors of members as curves, both axes logarithmic: the figures of docs/convergence.md.

use rotor::draw::clip::{Point, Rect};
use rotor::draw::palette::{self, Font, Stroke};
use rotor::draw::pen::Pen;
use rotor::draw::sheet::{self, Sample, legend_entry};
use rotor::draw::text::Anchor;
use rotor::plot::tradeoff::MARKERS;

/// A member and its errors.
pub type Curve = (String, Vec<f64>);

/// One frame of a figure.
pub struct Panel {
    pub title: &'static str,
    pub across: &'static str,
    /// Places of the errors, and whether they are drawn by their logarithm.
    pub places: Vec<f64>,
    pub curves: Vec<Curve>,
    /// Logarithms of the least and the largest error that are drawn.
    pub range: [f64; 2],
    /// A slope to compare with, and its name.
    pub slope: Option<(f64, &'static str)>,
}

const FRAME: (f64, f64) = (430.0, 380.0);
const LEFT: f64 = 84.0;

/// Panels side by side.
pub fn svg(title: &str, panels: &[Panel]) -> String {
    let width = panels.len() as f64 * (FRAME.0 + LEFT + 16.0) + 16.0;
    let rows = panels.iter().map(|p| p.curves.len().div_ceil(4)).max().unwrap_or(0) as f64;
    let top = sheet::below_title(width, title) + 34.0;
    let height = top + FRAME.1 + 64.0 + rows * sheet::LEGEND_ROW + 12.0;
    sheet::figure(width, height, |pen| {
        sheet::title(pen, width, title);
        for (i, panel) in panels.iter().enumerate() {
            let left = 16.0 + LEFT + i as f64 * (FRAME.0 + LEFT + 16.0);
            let frame = Rect::around((left + FRAME.0 / 2.0, top + FRAME.1 / 2.0), FRAME.0, FRAME.1);
            draw(pen, panel, frame);
        }
    })
    .expect("a figure")
}

fn draw(pen: &mut Pen, panel: &Panel, frame: Rect) {
    let (left, bottom) = (frame.center().0 - frame.width() / 2.0, frame.center().1 + frame.height() / 2.0);
    let logs: Vec<f64> = panel.places.iter().map(|x| x.log10()).collect();
    let (first, last) = (logs[0], logs[logs.len() - 1]);
    let margin = 0.06 * frame.width();
    let x = |log: f64| left + margin + (log - first) / (last - first) * (frame.width() - 2.0 * margin);
    let [low, high] = panel.range;
    let y = |log: f64| bottom - (log - low) / (high - low) * frame.height();
    let (font, grid) = (Font::new(12.0), Stroke::solid(palette::GREY, 0.4));
    for decade in (low as i32..=high as i32).step_by(if high - low > 8.0 { 2 } else { 1 }) {
        let at = y(f64::from(decade));
        pen.path(&[(left, at), (left + frame.width(), at)], grid);
        pen.text((left - 8.0, at), &format!("1e{decade}"), font, Anchor::Right);
    }
    for (place, log) in panel.places.iter().zip(&logs) {
        pen.path(&[(x(*log), bottom), (x(*log), bottom - 5.0)], Stroke::solid(palette::BLACK, 1.0));
        pen.text((x(*log), bottom + 14.0), &format!("{place}"), font, Anchor::Center);
    }
    pen.frame(frame, Stroke::solid(palette::BLACK, 1.0));
    pen.text((frame.center().0, bottom + 36.0), panel.across, Font::new(13.0), Anchor::Center);
    pen.vertical_text((left - 60.0, frame.center().1), "relative error", Font::new(13.0));
    pen.text(
        (frame.center().0, bottom - frame.height() - 14.0),
        panel.title,
        Font::new(14.0).bold(),
        Anchor::Center,
    );
    if let Some((slope, name)) = panel.slope {
        let (a, b) = (logs[1], logs[3.min(logs.len() - 1)]);
        let start = -1.2;
        let line: [Point; 2] = [(x(a), y(start)), (x(b), y(start - slope * (b - a)))];
        pen.path(&line, Stroke::solid(palette::GREY, 1.6));
        pen.text((line[1].0 + 8.0, line[1].1 - 8.0), name, font, Anchor::Left);
    }
    for (k, (name, errors)) in panel.curves.iter().enumerate() {
        let inside = |e: &f64| e.is_finite();
        let points: Vec<Point> = logs
            .iter()
            .zip(errors)
            .filter(|(_, e)| inside(e))
            .map(|(log, e)| (x(*log), y(e.abs().max(1e-300).log10().clamp(low, high))))
            .collect();
        // the symbols begin anew, in black
        let color = if k < MARKERS.len() { palette::BLUE } else { palette::BLACK };
        let marker = MARKERS[k % MARKERS.len()];
        let stroke = Stroke::solid(palette::BLACK, if k < MARKERS.len() { 1.0 } else { 2.2 });
        pen.group("curve", name, |pen| {
            pen.path(&points, stroke);
            points.iter().for_each(|point| pen.marker(*point, marker, 4.5, color));
        });
        let at =
            (left + (k % 4) as f64 * frame.width() / 4.0, bottom + 62.0 + (k / 4) as f64 * sheet::LEGEND_ROW);
        legend_entry(pen, at, frame.width() / 4.0, Sample::Marker(marker, color), name);
    }
}
