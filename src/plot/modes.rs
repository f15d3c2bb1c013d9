//! Mode shapes as small multiples: the deformed axis beside the deformed section of each mode. Displacements are
//! scaled for the eye, one scale for all axes, another for each section.

use crate::draw::axes::Scale;
use crate::draw::clip::{Point, Rect};
use crate::draw::palette::{self, Font, LineStyle, Marker, Stroke};
use crate::draw::pen::Pen;
use crate::draw::sheet::{self, FooterWords, Sample};
use crate::draw::text::{self, Anchor};
use crate::error::Result;
use crate::results::{Figures, Mode, ModeKind, ModeShape, Modes, Report};

const WIDTH: f64 = 1120.0;
const COLUMNS: usize = 3;
const SHOWN: usize = 12;
const PANEL_HEIGHT: f64 = 186.0;
const PANEL_GAP: f64 = 18.0;
/// One row of entries and the air around it.
const LEGEND_HEIGHT: f64 = 44.0;
/// Part of a section's size that its largest displacement takes.
const SECTION_DISPLACEMENT: f64 = 0.2;
/// The same in torsion: turning by straight displacements widens the outline, visibly so if they are large.
const TORSION_DISPLACEMENT: f64 = 0.12;
/// Points of the outer outline whose way is drawn; without them a turned circle looks like one at rest.
const FOLLOWED: usize = 8;

const ALONG_Y: Stroke = Stroke { color: palette::BLUE, width: 2.2, line: LineStyle::Solid };
const ALONG_Z: Stroke = Stroke { color: palette::VERMILLION, width: 2.2, line: LineStyle::Dashed };
const ALONG_X: Stroke = Stroke { color: palette::GREEN, width: 2.2, line: LineStyle::DashDot };
const TWIST: Stroke = Stroke { color: palette::BLACK, width: 2.2, line: LineStyle::Dotted };
const AT_REST: Stroke = Stroke::solid(palette::GREY, 1.0);
const WAY: Stroke = Stroke::solid(palette::DARK_GREY, 1.0);
const DEFORMED: Stroke = Stroke::solid(palette::BLACK, 2.2);

/// The figure as SVG text; the same report always gives the same text.
pub fn svg(report: &Report<Modes>) -> Result<Figures> {
    let elastic: Vec<&Mode> =
        report.results.modes.iter().filter(|mode| mode.kind != ModeKind::Rigid).collect();
    let shown = &elastic[..elastic.len().min(SHOWN)];
    let rows = shown.len().div_ceil(COLUMNS).max(1) as f64;
    let title = format!("Mode shapes: {}", report.case.title);
    let below_title = sheet::below_title(WIDTH, &title);
    let top = below_title + LEGEND_HEIGHT;
    let height = top + rows * (PANEL_HEIGHT + PANEL_GAP) + sheet::FOOTER_HEIGHT;
    sheet::figure(WIDTH, height, |pen| {
        sheet::title(pen, WIDTH, &title);
        paint_legend(pen, below_title + 18.0, shown);
        let width = (WIDTH - 2.0 * sheet::MARGIN + PANEL_GAP) / COLUMNS as f64 - PANEL_GAP;
        for (index, mode) in shown.iter().enumerate() {
            let left = sheet::MARGIN + (index % COLUMNS) as f64 * (width + PANEL_GAP);
            let upper = top + (index / COLUMNS) as f64 * (PANEL_HEIGHT + PANEL_GAP);
            let panel = Rect { left, top: upper, right: left + width, bottom: upper + PANEL_HEIGHT };
            pen.group("mode", &panel_title(mode), |pen| paint_panel(pen, panel, mode));
        }
        if shown.is_empty() {
            pen.text(
                (sheet::MARGIN, top),
                "No elastic modes to draw.",
                Font::new(palette::LABEL_SIZE),
                Anchor::Left,
            );
        }
        let remarks = remarks(report, elastic.len(), shown.len());
        let words = FooterWords { remarks, content: sheet::model_words(&report.model) };
        sheet::footer(pen, (WIDTH, height), &report.case, report.rotor, &words);
    })
    .map(|svg| vec![("modes.svg".to_owned(), svg)])
}

/// What the figure leaves out, and what to distrust.
fn remarks(report: &Report<Modes>, elastic: usize, shown: usize) -> String {
    let rigid = report.results.modes.len() - elastic;
    let mut words = vec![format!("Rigid modes left out: {rigid}.")];
    if elastic > shown {
        words.push(format!("Further modes not shown: {}.", elastic - shown));
    }
    if !report.results.sturm_count_agrees {
        words.push("The Sturm count disagrees: modes may be missing.".to_owned());
    }
    words.push(
        "Displacements not to scale; order: waves around the axis; sections seen along +x, y up, z right."
            .to_owned(),
    );
    words.push(sheet::failed_checks(&report.diagnostics));
    words.join(" ")
}

/// A curve over the axis: its stroke, its name and its values.
type Component = (Stroke, &'static str, fn(&ModeShape) -> Vec<f64>);

/// What moves in modes of this kind.
fn components(kind: ModeKind) -> &'static [Component] {
    const BENDING: [Component; 2] = [
        (ALONG_Y, "axis along y", |shape| shape.axis.iter().map(|u| u[1]).collect()),
        (ALONG_Z, "axis along z", |shape| shape.axis.iter().map(|u| u[2]).collect()),
    ];
    const AXIAL: [Component; 1] =
        [(ALONG_X, "axis along x", |shape| shape.axis.iter().map(|u| u[0]).collect())];
    const TORSION: [Component; 1] = [(TWIST, "twist × outer radius", |shape| shape.twist.clone())];
    match kind {
        ModeKind::Torsion => &TORSION,
        ModeKind::Axial => &AXIAL,
        ModeKind::Rigid | ModeKind::Bending | ModeKind::Section => &BENDING,
    }
}

fn paint_legend(pen: &mut Pen, y: f64, shown: &[&Mode]) {
    let mut entries: Vec<(Sample, &str)> = Vec::new();
    for kind in [ModeKind::Bending, ModeKind::Torsion, ModeKind::Axial, ModeKind::Section] {
        if shown.iter().any(|mode| mode.kind == kind) {
            for &(stroke, name, _) in components(kind) {
                if !entries.iter().any(|(_, known)| *known == name) {
                    entries.push((Sample::Stroke(stroke), name));
                }
            }
        }
    }
    entries.push((Sample::Stroke(DEFORMED), "section, deformed"));
    entries.push((Sample::Marker(Marker::Triangle, palette::BLACK), "its position"));
    entries.push((Sample::Stroke(AT_REST), "at rest"));
    pen.group("legend", "", |pen| {
        let mut x = sheet::MARGIN;
        for (sample, name) in entries {
            let width = sheet::LEGEND_SAMPLE + text::text_width(name, palette::TICK_SIZE) + 4.0;
            sheet::legend_entry(pen, (x, y), width, sample, name);
            x += width + 6.0;
        }
    });
}

fn paint_panel(pen: &mut Pen, panel: Rect, mode: &Mode) {
    let name = text::shorten(&panel_title(mode), palette::LABEL_SIZE * text::BOLD_WIDER, panel.width());
    pen.text((panel.left, panel.top + 8.0), &name, Font::new(palette::LABEL_SIZE).bold(), Anchor::Left);
    let (top, bottom) = (panel.top + 24.0, panel.bottom - 20.0);
    let side = bottom - top;
    let middle = panel.right - side - 12.0;
    let axis_box = Rect { left: panel.left, top, right: middle, bottom };
    let section_box = Rect { left: panel.right - side, top, right: panel.right, bottom };
    for part in [axis_box, section_box] {
        pen.frame(part, Stroke::solid(palette::LIGHT_GREY, 1.0));
    }
    paint_axis(pen, axis_box, mode);
    paint_section(pen, section_box, mode);
}

fn panel_title(mode: &Mode) -> String {
    let kind = match mode.kind {
        ModeKind::Rigid => "rigid",
        ModeKind::Bending => "bending",
        ModeKind::Torsion => "torsion",
        ModeKind::Axial => "axial",
        ModeKind::Section => "section",
    };
    let frequency = text::significant(mode.frequency_hz, 5);
    format!("{}: {frequency} Hz, {kind}, order {}", mode.number, mode.circumferential_order)
}

fn paint_axis(pen: &mut Pen, area: Rect, mode: &Mode) {
    let shape = &mode.shape;
    let finite = || shape.x_m.iter().copied().filter(|x| x.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let small = Font::new(palette::SMALL_SIZE);
    let below = area.bottom + 11.0;
    if low >= high || low.is_infinite() {
        pen.text(area.center(), "no shape", small, Anchor::Center);
        return;
    }
    pen.text((area.left, below), &format!("x = {}", position(low)), small, Anchor::Left);
    pen.text((area.right, below), &format!("{} m", position(high)), small, Anchor::Right);
    let along = Scale { low, high, start: area.left + 8.0, end: area.right - 8.0 };
    let (_, middle) = area.center();
    pen.path(&[(along.start, middle), (along.end, middle)], AT_REST);
    let curves: Vec<(Stroke, &str, Vec<f64>)> =
        components(mode.kind).iter().map(|&(stroke, name, values)| (stroke, name, values(shape))).collect();
    // Shapes are scaled to a largest displacement of 1; a shape beyond that must still stay in its box.
    let magnitudes = curves.iter().flat_map(|(_, _, values)| values).map(|value| value.abs());
    let largest = magnitudes.filter(|value| value.is_finite()).fold(1.0, f64::max);
    let up = Scale { low: 0.0, high: largest, start: middle, end: area.top + 14.0 };
    for (stroke, name, values) in curves {
        let points: Vec<Point> = shape
            .x_m
            .iter()
            .zip(values)
            .filter(|(x, value)| x.is_finite() && value.is_finite())
            .map(|(&x, value)| (along.pixel(x), up.pixel(value)))
            .collect();
        pen.group("curve", name, |pen| pen.path(&points, stroke));
    }
    if along.low <= shape.section_x_m && shape.section_x_m <= along.high {
        let x = along.pixel(shape.section_x_m);
        pen.fill(&[(x - 5.0, area.bottom), (x + 5.0, area.bottom), (x, area.bottom - 8.0)], palette::BLACK);
    }
}

fn position(x_m: f64) -> String {
    let text = text::significant(x_m, 4);
    let trimmed = text.trim_end_matches('0').trim_end_matches('.');
    if text.contains('.') && !text.contains('e') { trimmed.to_owned() } else { text }
}

/// Outlines at rest and deformed, seen along +x: y upwards, z to the right.
fn paint_section(pen: &mut Pen, area: Rect, mode: &Mode) {
    let shape = &mode.shape;
    let small = Font::new(palette::SMALL_SIZE);
    let Some(bounds) = bounds(&shape.outlines) else {
        pen.text(area.center(), "no section", small, Anchor::Center);
        return;
    };
    let size = bounds.width().max(bounds.height());
    let moved = || shape.outline_displacements.iter().flatten().filter(|u| u.iter().all(|c| c.is_finite()));
    let largest = moved().map(|u| (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt()).fold(0.0, f64::max);
    let share = if mode.kind == ModeKind::Torsion { TORSION_DISPLACEMENT } else { SECTION_DISPLACEMENT };
    let factor = if largest > 0.0 { share * size / largest } else { 0.0 };
    let (middle_z, middle_y) = bounds.center();
    let pixels = (area.width() - 12.0) / (size * (1.0 + 2.0 * SECTION_DISPLACEMENT));
    let (x, y) = area.center();
    let place = |[at_y, at_z]: [f64; 2]| (x + (at_z - middle_z) * pixels, y - (at_y - middle_y) * pixels);
    for outline in &shape.outlines {
        let rest: Vec<Point> = finite_points(outline).map(place).collect();
        pen.outline(&rest, AT_REST);
    }
    for (index, (outline, displacements)) in
        shape.outlines.iter().zip(&shape.outline_displacements).enumerate()
    {
        let pairs = outline.iter().zip(displacements);
        let ways = pairs.map(|(p, u)| (*p, [p[0] + factor * u[1], p[1] + factor * u[2]]));
        let ways = ways.filter(|(from, to)| from.iter().chain(to).all(|coordinate| coordinate.is_finite()));
        let ways: Vec<(Point, Point)> = ways.map(|(from, to)| (place(from), place(to))).collect();
        let deformed: Vec<Point> = ways.iter().map(|&(_, to)| to).collect();
        pen.outline(&deformed, DEFORMED);
        if index == 0 {
            let followed = || ways.iter().step_by(ways.len().div_ceil(FOLLOWED).max(1));
            followed().for_each(|&(from, to)| pen.path(&[from, to], WAY));
            followed().for_each(|&(_, to)| pen.disc(to, 2.8, palette::BLACK));
        }
    }
    let across = moved().map(|u| (u[1] * u[1] + u[2] * u[2]).sqrt()).fold(0.0, f64::max);
    let sense = if across < 0.5 * largest { ", along x" } else { "" };
    let caption = format!("at {} m{sense}", position(shape.section_x_m));
    let caption = text::shorten(&caption, palette::SMALL_SIZE, area.width() + 10.0);
    pen.text((area.right, area.bottom + 11.0), &caption, small, Anchor::Right);
}

fn finite_points(points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> + '_ {
    points.iter().copied().filter(|point| point.iter().all(|coordinate| coordinate.is_finite()))
}

/// Smallest box around all outlines, z as its horizontal and y as its vertical coordinate; none without any size.
fn bounds(outlines: &[Vec<[f64; 2]>]) -> Option<Rect> {
    let points = || outlines.iter().flat_map(|outline| finite_points(outline));
    let over = |component: usize, start: f64, pick: fn(f64, f64) -> f64| {
        points().map(|point| point[component]).fold(start, pick)
    };
    let bounds = Rect {
        left: over(1, f64::INFINITY, f64::min),
        right: over(1, f64::NEG_INFINITY, f64::max),
        top: over(0, f64::INFINITY, f64::min),
        bottom: over(0, f64::NEG_INFINITY, f64::max),
    };
    let size = bounds.width().max(bounds.height());
    (size.is_finite() && size > 0.0).then_some(bounds)
}
