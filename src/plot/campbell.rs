//! Campbell diagram: whirl frequencies over spin speed, with excitation orders, numbered critical speeds and a
//! table of them. Legend and table stand beside the axes, names of branches in a gutter at their right ends,
//! numbers of critical speeds wherever they cover least.

mod curves;

use crate::draw::axes::{self, Scale, Side};
use crate::draw::clip::{self, Point, Rect};
use crate::draw::labels::{self, Obstacles};
use crate::draw::palette::{self, Color, Font, LineStyle, Marker, Stroke};
use crate::draw::panels::{Curve, Mark, Panel, STROKES, Surroundings, figure};
use crate::draw::pen::Pen;
use crate::draw::sheet::{self, FooterWords, Sample};
use crate::draw::text::{self, Anchor};
use crate::error::Result;
use crate::plot::campbell::curves::{
    BranchCurve, CurveMark, Order, RPM, Sampled, marks, orders, speed_range, top_frequency,
};
use crate::plot::response::{operation, operation_words, rpm};
use crate::results::{Branch, Campbell, Figures, ModeKind, Report, Whirl};

const WIDTH: f64 = 1120.0;
const HEIGHT: f64 = 780.0;
const PANEL_WIDTH: f64 = 264.0;
const FRAME_LEFT: f64 = 96.0;
/// Height that the axis above and the axis below the frame take.
const AXIS_HEIGHT: f64 = 56.0;
/// From the right axis to the panel: ticks, label, air.
const RIGHT_AXIS_WIDTH: f64 = 92.0;
/// Critical speeds that get a number and a row of the table.
const LISTED_CRITICALS: usize = 20;
const ROW: f64 = 17.5;
const NOTE_ROW: f64 = 16.0;
const NAME_SIZE: f64 = 14.0;
/// Names smaller than this could not be read.
const LEAST_NAME_SIZE: f64 = 8.0;
const LONGEST_NAME: f64 = 80.0;
const ORDER_STROKE: Stroke = Stroke { color: palette::GREY, width: 1.2, line: LineStyle::DashDot };
const LEADER: Stroke = Stroke::solid(palette::GREY, 0.9);
const RANGE: Color = palette::PALE_RED;
const OPERATION_SAMPLE: Stroke = Stroke::solid(palette::PALE_GREY, 11.0);
const RANGE_SAMPLE: Stroke = Stroke::solid(RANGE, 11.0);
const BAND: Stroke = Stroke::solid(palette::LIGHT_RED, 9.0);

/// The diagram as SVG text; the same report always gives the same text.
pub fn svg(report: &Report<Campbell>) -> Result<Figures> {
    let diagram = sheet::figure(WIDTH, HEIGHT, |pen| paint(pen, report))?;
    let mut figures = vec![("campbell.svg".to_owned(), diagram)];
    let decays = |b: &Branch| b.log_decrement.iter().flatten().any(|d| *d != 0.0);
    if report.results.branches.iter().any(decays) {
        figures.push(("campbell-decrement.svg".to_owned(), decrement(report)?));
    }
    Ok(figures)
}

/// Log decrement over speed, with the lines 0.1 and 0 and the speed at which a motion begins to grow.
fn decrement(report: &Report<Campbell>) -> Result<String> {
    let results = &report.results;
    let speeds: Vec<f64> = results.speeds_rad_s.iter().map(|s| rpm(*s)).collect();
    let mut bending: Vec<&Branch> = results.branches.iter().filter(|b| b.kind == ModeKind::Bending).collect();
    // what decays least is what matters
    let least = |b: &Branch| b.log_decrement.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    bending.sort_by(|a, b| least(a).total_cmp(&least(b)));
    let mut curves: Vec<Curve> = bending
        .iter()
        .take(STROKES.len())
        .enumerate()
        .map(|(k, b)| {
            let at = |d: &Option<f64>| d.unwrap_or(f64::NAN);
            let points = speeds.iter().copied().zip(b.log_decrement.iter().map(at)).collect();
            Curve { name: b.name.clone(), stroke: STROKES[k], points }
        })
        .collect();
    let (low, high) = speed_range(&results.speeds_rad_s);
    let line = Stroke { color: palette::GREY, width: 1.2, line: LineStyle::Dashed };
    for (name, value) in [("0.1 and 0", 0.1), ("", 0.0)] {
        curves.push(Curve { name: name.to_owned(), stroke: line, points: vec![(low, value), (high, value)] });
    }
    let threshold = results.stability_threshold_rad_s.map(|speed| Mark {
        name: "a motion begins to grow".to_owned(),
        marker: Marker::Ring,
        color: palette::VERMILLION,
        at: (rpm(speed), 0.0),
    });
    let panel = Panel {
        across: ("Spin speed", "rpm"),
        up: ("Log decrement", "-"),
        curves,
        marks: threshold.into_iter().collect(),
        bands: results.operating_speed.iter().map(operation).collect(),
        height: 420.0,
        ..Panel::default()
    };
    let left = bending.len().saturating_sub(STROKES.len());
    let more = if left > 0 { format!(" {left} more bending motions decay faster.") } else { String::new() };
    let remarks =
        format!("The bending motions that decay least.{more}{}", operation_words(results.operating_speed));
    figure(&Surroundings::new(report, "Decay over speed", remarks), &[panel], 1)
}

fn paint(pen: &mut Pen, report: &Report<Campbell>) {
    let title = format!(
        "Campbell diagram, {} frame, {} form: {}",
        report.results.frame, report.results.form, report.case.title
    );
    sheet::title(pen, WIDTH, &title);
    let below_title = sheet::below_title(WIDTH, &title);
    let diagram = Diagram::new(&report.results, below_title);
    let mut obstacles = diagram.obstacles();
    diagram.paint_operation(pen);
    diagram.paint_ranges(pen);
    diagram.paint_axes(pen);
    diagram.paint_orders(pen, &mut obstacles);
    diagram.paint_curves(pen);
    let unnamed = diagram.paint_names(pen, &mut obstacles);
    diagram.paint_criticals(pen, &mut obstacles);
    let notes = diagram.notes(unnamed);
    diagram.paint_panel(pen, below_title, &notes);
    let results = &report.results;
    let remarks = format!(
        "Frequencies as seen in the {} frame; {} form; gyroscopic terms: {}. {}",
        results.frame,
        results.form,
        results.gyroscopic,
        sheet::failed_checks(&report.diagnostics)
    );
    let words = FooterWords { remarks, content: sheet::model_words(&report.model) };
    sheet::footer(pen, (WIDTH, HEIGHT), &report.case, report.rotor, &words);
}

/// Everything needed to paint the axes' inside.
struct Diagram<'a> {
    curves: Vec<BranchCurve<'a>>,
    marks: Vec<CurveMark<'a>>,
    /// Unstable ranges, rpm.
    ranges: Vec<(f64, f64)>,
    /// Speeds of operation, rpm.
    operation: Option<(f64, f64)>,
    orders: Vec<Order>,
    frame: Rect,
    /// Right end of the gutter with the names, where the right axis stands.
    spine: f64,
    x: Scale,
    y: Scale,
}

impl<'a> Diagram<'a> {
    fn new(results: &'a Campbell, below_title: f64) -> Self {
        let curves: Vec<BranchCurve> =
            results.branches.iter().map(|b| BranchCurve::new(b, &results.speeds_rad_s)).collect();
        let marks = marks(results, &curves);
        let orders = orders(results);
        let (low, high) = speed_range(&results.speeds_rad_s);
        let inside = marks.iter().filter(|mark| low <= mark.rpm && mark.rpm <= high).map(|mark| mark.hz);
        let top =
            top_frequency(&curves, inside.reduce(f64::max).unwrap_or(0.0), high.abs().max(low.abs()) / 60.0);
        let spine = WIDTH - sheet::MARGIN - PANEL_WIDTH - RIGHT_AXIS_WIDTH;
        let frame = Rect {
            left: FRAME_LEFT,
            top: below_title + AXIS_HEIGHT,
            right: spine - gutter(results, &orders),
            bottom: HEIGHT - sheet::FOOTER_HEIGHT - AXIS_HEIGHT - 8.0,
        };
        let x = Scale { low, high, start: frame.left, end: frame.right };
        let y = Scale { low: 0.0, high: top, start: frame.bottom, end: frame.top };
        let ranges = results.unstable_ranges.iter().map(|r| (r.from_rpm, r.to_rpm)).collect();
        let operation = results.operating_speed.map(|o| operation(&o));
        Self { curves, marks, ranges, operation, orders, frame, spine, x, y }
    }

    fn point(&self, rpm: f64, hz: f64) -> Point {
        (self.x.pixel(rpm), self.y.pixel(hz))
    }

    fn pixels(&self, stretch: &[Sampled]) -> Vec<Point> {
        stretch.iter().map(|sampled| self.point(sampled.rpm, sampled.hz)).collect()
    }

    /// Visible parts of a curve as lines; single points come as lines of one point.
    fn visible(&self, curve: &BranchCurve) -> Vec<Vec<Point>> {
        curve.stretches.iter().flat_map(|stretch| self.parts(stretch)).collect()
    }

    /// Visible parts of a line.
    fn parts(&self, stretch: &[Sampled]) -> Vec<Vec<Point>> {
        let pixels = self.pixels(stretch);
        match pixels[..] {
            [point] if self.frame.contains(point) => vec![vec![point]],
            _ => clip::clip(&pixels, self.frame),
        }
    }

    /// What labels inside the frame should not cover.
    fn obstacles(&self) -> Obstacles {
        let inside = self.marks.iter().filter(|mark| self.is_inside(mark));
        let mut obstacles =
            Obstacles::new(self.frame, inside.map(|mark| self.point(mark.rpm, mark.hz)).collect());
        for part in self.curves.iter().flat_map(|curve| self.visible(curve)) {
            obstacles.add_line(&part);
        }
        obstacles
    }

    /// Shades the speeds of operation over the whole height.
    fn paint_operation(&self, pen: &mut Pen) {
        let Some((from, to)) = self.operation else { return };
        let frame = self.frame;
        let [left, right] = [from, to].map(|rpm| self.x.pixel(rpm).clamp(frame.left, frame.right));
        if left < right {
            let words = format!("operation from {from:.0} to {to:.0} rpm");
            let place = Rect { left, right, top: frame.top, bottom: frame.bottom };
            pen.group("operation", &words, |pen| pen.fill_rect(place, palette::PALE_GREY));
        }
    }

    /// Shades the unstable ranges over the whole height, the narrowest still visible.
    fn paint_ranges(&self, pen: &mut Pen) {
        for &(from, to) in &self.ranges {
            let (left, right) = (self.x.pixel(from), self.x.pixel(to));
            let (middle, half) = ((left + right) / 2.0, ((right - left) / 2.0).max(0.75));
            let frame = self.frame;
            let left = (middle - half).clamp(frame.left, frame.right);
            let right = (middle + half).clamp(frame.left, frame.right);
            if left < right {
                let [from, to] = [from, to].map(|rpm| text::significant(rpm, 5));
                let words = format!("unstable from {from} to {to} rpm");
                let place = Rect { left, right, top: frame.top, bottom: frame.bottom };
                pen.group("unstable", &words, |pen| pen.fill_rect(place, RANGE));
            }
        }
    }

    fn paint_axes(&self, pen: &mut Pen) {
        let frame = self.frame;
        axes::grid(pen, frame, self.x, self.y);
        let black = Stroke::solid(palette::BLACK, 1.2);
        pen.group("axes", "", |pen| {
            pen.frame(frame, black);
            pen.path(&[(self.spine, frame.top), (self.spine, frame.bottom)], black);
            axes::axis(pen, Side::Bottom, frame.bottom, self.x, "Spin speed", "rpm");
            axes::axis(pen, Side::Top, frame.top, self.x.times(1.0 / RPM), "Spin speed", "rad/s");
            axes::axis(pen, Side::Left, frame.left, self.y, "Whirl frequency", "Hz");
            axes::axis(pen, Side::Right, self.spine, self.y.times(60.0), "Whirl frequency", "cpm");
        });
    }

    fn order_line(&self, slope: f64) -> Vec<Vec<Point>> {
        let (low, high) = (self.x.low, self.x.high);
        let mut speeds = vec![low, high];
        if low < 0.0 && high > 0.0 {
            speeds.insert(1, 0.0);
        }
        let pixels: Vec<Point> =
            speeds.into_iter().map(|rpm| self.point(rpm, slope * rpm.abs() / 60.0)).collect();
        clip::clip(&pixels, self.frame)
    }

    fn paint_orders(&self, pen: &mut Pen, obstacles: &mut Obstacles) {
        for order in &self.orders {
            let parts = self.order_line(order.slope);
            pen.group("order", &order.label, |pen| {
                parts.iter().for_each(|part| pen.path(part, ORDER_STROKE))
            });
            parts.iter().for_each(|part| obstacles.add_line(part));
        }
    }

    fn paint_curves(&self, pen: &mut Pen) {
        for curve in self.curves.iter().filter(|curve| curve.is_unstable()) {
            pen.group("growing", &format!("{}, unstable here", curve.words()), |pen| {
                self.paint_band(pen, curve)
            });
        }
        // Broken lines come last: where branches coincide, both stay visible.
        let runs: Vec<_> = self.curves.iter().map(|curve| (curve.words(), curve.by_whirl())).collect();
        for layer in [Whirl::Forward, Whirl::Backward, Whirl::Mixed, Whirl::None] {
            let stroke = Stroke::whirl(layer);
            for (words, runs) in &runs {
                let runs = runs.iter().filter(|(whirl, _)| *whirl == layer);
                pen.group("branch", words, |pen| {
                    for part in runs.flat_map(|(_, run)| self.parts(run)) {
                        match part[..] {
                            [point] => pen.marker(point, Marker::whirl(layer), 4.5, stroke.color),
                            _ => pen.path(&part, stroke),
                        }
                    }
                });
            }
        }
    }

    /// A wide band under the unstable stretches of a curve.
    fn paint_band(&self, pen: &mut Pen, curve: &BranchCurve) {
        let runs = curve.stretches.iter().flat_map(|stretch| stretch.split(|sampled| !sampled.unstable));
        for run in runs {
            match self.pixels(run)[..] {
                [] => {}
                [point] if self.frame.contains(point) => pen.disc(point, 7.0, BAND.color),
                ref pixels => {
                    clip::clip(pixels, self.frame).iter().for_each(|part| pen.path(part, BAND));
                }
            }
        }
    }

    /// Speed pixel at which the curves end.
    fn column(&self) -> f64 {
        let speeds = self.curves.iter().flat_map(BranchCurve::samples).map(|sampled| sampled.rpm);
        speeds.reduce(f64::max).map_or(self.frame.right, |last| self.x.pixel(last))
    }

    /// Writes the names of orders and branches and returns how many found no room.
    fn paint_names(&self, pen: &mut Pen, obstacles: &mut Obstacles) -> usize {
        let column = self.column();
        let (mut aligned, mut elsewhere) = (Vec::new(), Vec::new());
        for curve in &self.curves {
            let Some(part) = self.visible(curve).pop() else { continue };
            let Some(&end) = part.last() else { continue };
            let color = Stroke::whirl(curve.last_whirl()).color;
            let name = Name {
                words: &curve.branch.name,
                color,
                end,
                clear: if part.len() == 1 { 6.0 } else { 1.0 },
            };
            if end.0 >= column - 1.0 { aligned.push(name) } else { elsewhere.push(name) }
        }
        for order in &self.orders {
            let Some(part) = self.order_line(order.slope).pop() else { continue };
            let (Some(&from), Some(&end)) = (part.first(), part.last()) else { continue };
            if end.0 >= self.frame.right - 0.5 && column >= self.frame.right - 1.0 {
                aligned.push(Name { words: &order.label, color: palette::DARK_GREY, end, clear: 1.0 });
            } else {
                paint_order_name(pen, obstacles, &order.label, (from, end));
            }
        }
        aligned.sort_by(|a, b| a.end.1.total_cmp(&b.end.1));
        pen.group("names", "", |pen| {
            let unnamed = self.paint_column(pen, obstacles, &aligned);
            for name in elsewhere {
                let words = text::shorten(name.words, NAME_SIZE, LONGEST_NAME);
                let size = (text::text_width(&words, NAME_SIZE) + 2.0, NAME_SIZE);
                let place = obstacles.near(name.end, size);
                pen.path(&[name.end, labels::nearest(place, name.end)], LEADER);
                pen.text(place.center(), &words, Font::new(NAME_SIZE).color(name.color), Anchor::Center);
            }
            unnamed
        })
    }

    /// Names of the lines that reach the highest speed, one below the other.
    fn paint_column(&self, pen: &mut Pen, obstacles: &mut Obstacles, names: &[Name]) -> usize {
        let height = self.frame.height();
        let room = (height / LEAST_NAME_SIZE) as usize;
        // Lowest frequencies stand last and are the ones to keep.
        let (unnamed, names) = names.split_at(names.len().saturating_sub(room));
        let size = (height / names.len().max(1) as f64 / 1.25).clamp(LEAST_NAME_SIZE / 1.1, NAME_SIZE);
        let wanted: Vec<f64> = names.iter().map(|name| name.end.1).collect();
        let half = size / 2.0;
        let rows = labels::spread(&wanted, size * 1.1, self.frame.top + half, self.frame.bottom - half);
        for (name, y) in names.iter().zip(&rows) {
            let (end, start) = (name.end, name.end.0 + name.clear);
            let left = start + 14.0;
            pen.path(&[(start, end.1), (start + 2.0, end.1), (left - 5.0, *y), (left - 2.0, *y)], LEADER);
        }
        for (name, y) in names.iter().zip(rows) {
            let words = text::shorten(name.words, size, LONGEST_NAME);
            let left = name.end.0 + name.clear + 14.0;
            pen.text((left, y), &words, Font::new(size).color(name.color), Anchor::Left);
            let right = left + text::text_width(&words, size);
            obstacles.add_label(Rect { left: name.end.0, top: y - half, right, bottom: y + half });
        }
        unnamed.len()
    }

    fn paint_criticals(&self, pen: &mut Pen, obstacles: &mut Obstacles) {
        let inside = self.marks.iter().enumerate().filter(|(_, mark)| self.is_inside(mark));
        let drawn: Vec<(usize, &CurveMark, Point)> =
            inside.map(|(index, mark)| (index + 1, mark, self.point(mark.rpm, mark.hz))).collect();
        let place = |&(number, _, point): &(usize, &CurveMark, Point)| {
            (number <= LISTED_CRITICALS).then(|| obstacles.near(point, (21.0, 21.0)))
        };
        let places: Vec<Option<Rect>> = drawn.iter().map(place).collect();
        pen.group("leaders", "", |pen| {
            for ((_, _, point), place) in drawn.iter().zip(&places) {
                let ends = place.map(|place| [*point, place.center()]);
                ends.iter().for_each(|ends| pen.path(ends, Stroke::solid(palette::BLACK, 0.9)));
            }
        });
        for ((number, mark, point), place) in drawn.iter().zip(&places) {
            pen.group("critical", &mark.words(*number), |pen| {
                pen.marker(*point, critical_marker(mark.critical.damped), 3.6, palette::BLACK);
                if let Some(place) = place {
                    pen.ring(place.center(), 9.6, palette::BLACK, 1.1);
                    pen.text(place.center(), &number.to_string(), Font::new(12.0).bold(), Anchor::Center);
                }
            });
        }
    }

    fn is_inside(&self, mark: &CurveMark) -> bool {
        let within = |scale: Scale, value: f64| scale.low <= value && value <= scale.high;
        within(self.x, mark.rpm) && within(self.y, mark.hz)
    }

    /// Remarks below the table on what the diagram does not show.
    fn notes(&self, unnamed: usize) -> Vec<String> {
        let mut notes = Vec::new();
        let names = |curves: Vec<&BranchCurve>| -> String {
            curves.iter().map(|curve| curve.branch.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let hidden: Vec<&BranchCurve> =
            self.curves.iter().filter(|curve| self.visible(curve).is_empty()).collect();
        let (silent, above): (Vec<&BranchCurve>, Vec<&BranchCurve>) =
            hidden.into_iter().partition(|curve| curve.stretches.is_empty());
        if !above.is_empty() {
            notes.push(format!("Outside the diagram: {}", names(above)));
        }
        if !silent.is_empty() {
            notes.push(format!("Nowhere oscillating: {}", names(silent)));
        }
        if unnamed > 0 {
            notes.push(format!("{unnamed} lines have no room for their names"));
        }
        if self.marks.iter().take(LISTED_CRITICALS).any(|mark| !self.is_inside(mark)) {
            notes.push("Grey rows lie outside the diagram".to_owned());
        }
        notes.iter().flat_map(|note| text::wrap(note, palette::SMALL_SIZE, PANEL_WIDTH, 3)).collect()
    }

    fn legend(&self) -> Vec<(Sample, String)> {
        let mut entries = Vec::new();
        if self.operation.is_some() {
            entries.push((Sample::Stroke(OPERATION_SAMPLE), "operating speed".to_owned()));
        }
        for (whirl, words) in [
            (Whirl::Forward, "forward whirl"),
            (Whirl::Backward, "backward whirl"),
            (Whirl::Mixed, "mixed whirl, or in a plane"),
            (Whirl::None, "no whirl"),
        ] {
            if self.curves.iter().flat_map(BranchCurve::samples).any(|sampled| sampled.whirl == whirl) {
                let stroke = Stroke::whirl(whirl);
                let single =
                    self.curves.iter().flat_map(|curve| &curve.stretches).all(|stretch| stretch.len() == 1);
                let marker = Sample::Marker(Marker::whirl(whirl), stroke.color);
                entries.push((if single { marker } else { Sample::Stroke(stroke) }, words.to_owned()));
            }
        }
        if self.curves.iter().any(BranchCurve::is_unstable) {
            let sample = Sample::Band(BAND, Stroke::solid(palette::BLACK, 1.5));
            entries.push((sample, "unstable".to_owned()));
        }
        if !self.ranges.is_empty() {
            entries.push((Sample::Stroke(RANGE_SAMPLE), "unstable range of speed".to_owned()));
        }
        entries.push((Sample::Stroke(ORDER_STROKE), "excitation order".to_owned()));
        for (damped, words) in [(false, "critical speed"), (true, "critical speed, damped (d)")] {
            if self.marks.iter().any(|mark| mark.critical.damped == damped) {
                entries.push((Sample::Marker(critical_marker(damped), palette::BLACK), words.to_owned()));
            }
        }
        entries
    }

    fn paint_panel(&self, pen: &mut Pen, below_title: f64, notes: &[String]) {
        let left = WIDTH - sheet::MARGIN - PANEL_WIDTH;
        let mut y = below_title + 20.0;
        pen.group("legend", "", |pen| {
            for (sample, words) in self.legend() {
                sheet::legend_entry(pen, (left, y), PANEL_WIDTH, sample, &words);
                y += sheet::LEGEND_ROW;
            }
        });
        let notes_height = NOTE_ROW * notes.len() as f64;
        let bottom = HEIGHT - sheet::FOOTER_HEIGHT - 12.0;
        let below = bottom - notes_height;
        y = pen.group("table", "", |pen| self.paint_table(pen, (left, y + 16.0), below)) + 6.0;
        pen.group("notes", "", |pen| {
            for note in notes {
                let font = Font::new(palette::SMALL_SIZE).color(palette::DARK_GREY);
                pen.text((left, y), note, font, Anchor::Left);
                y += NOTE_ROW;
            }
        });
    }

    /// Draws the table of critical speeds and returns the y of the line below it.
    fn paint_table(&self, pen: &mut Pen, (left, top): Point, bottom: f64) -> f64 {
        let regular = Font::new(13.5);
        let heading = if self.marks.is_empty() { "No critical speeds found" } else { "Critical speeds" };
        pen.text((left, top), heading, Font::new(palette::LABEL_SIZE).bold(), Anchor::Left);
        if self.marks.is_empty() {
            return top + ROW;
        }
        let mut y = top + ROW + 2.0;
        table_row(pen, (left, y), ["no.", "rpm", "Hz", "whirl", "branch"], regular.bold());
        pen.path(&[(left, y + 10.0), (left + PANEL_WIDTH, y + 10.0)], Stroke::solid(palette::BLACK, 0.8));
        y += 3.0;
        let room = ((bottom - y) / ROW - 1.0).clamp(1.0, LISTED_CRITICALS as f64) as usize;
        for (index, mark) in self.marks.iter().take(room).enumerate() {
            y += ROW;
            let critical = mark.critical;
            let number = (index + 1).to_string();
            let speed = text::significant(critical.speed_rpm, 5);
            let frequency = text::significant(critical.speed_rpm / 60.0, 5);
            let damped = if critical.damped { " (d)" } else { "" };
            let name = critical.branch.as_deref().unwrap_or(kind_word(critical.kind));
            let branch = text::shorten(
                name,
                regular.size,
                PANEL_WIDTH - 212.0 - text::text_width(damped, regular.size),
            ) + damped;
            let color = if self.is_inside(mark) { palette::BLACK } else { palette::GREY };
            let cells = [&number, &speed, &frequency, whirl_word(critical.whirl), &branch];
            table_row(pen, (left, y), cells, regular.color(color));
        }
        if self.marks.len() > room {
            y += ROW;
            let words = format!("and {} more, see the report", self.marks.len() - room);
            pen.text((left, y), &words, regular, Anchor::Left);
        }
        y + ROW
    }
}

/// The name of a line, to be written near its end.
struct Name<'a> {
    words: &'a str,
    color: Color,
    end: Point,
    /// Distance that the leader keeps from the end, so that it does not run through a symbol.
    clear: f64,
}

/// Writes the name of an order inside the frame, beside its line.
fn paint_order_name(pen: &mut Pen, obstacles: &mut Obstacles, name: &str, (from, to): (Point, Point)) {
    let words = text::shorten(name, palette::SMALL_SIZE, 160.0);
    let size = (text::text_width(&words, palette::SMALL_SIZE) + 4.0, palette::SMALL_SIZE + 3.0);
    if let Some(place) = obstacles.along(from, to, size) {
        let font = Font::new(palette::SMALL_SIZE).color(palette::DARK_GREY);
        pen.text(place.center(), &words, font, Anchor::Center);
    }
}

fn table_row(pen: &mut Pen, (left, y): Point, cells: [&str; 5], font: Font) {
    let columns = [
        (26.0, Anchor::Right),
        (96.0, Anchor::Right),
        (158.0, Anchor::Right),
        (166.0, Anchor::Left),
        (212.0, Anchor::Left),
    ];
    for (cell, (offset, anchor)) in cells.into_iter().zip(columns) {
        pen.text((left + offset, y), cell, font, anchor);
    }
}

fn critical_marker(damped: bool) -> Marker {
    if damped { Marker::Ring } else { Marker::Disc }
}

fn whirl_word(whirl: Whirl) -> &'static str {
    match whirl {
        Whirl::Forward => "fwd",
        Whirl::Backward => "bwd",
        Whirl::Mixed => "mix",
        Whirl::None => "–",
    }
}

fn kind_word(kind: ModeKind) -> &'static str {
    match kind {
        ModeKind::Rigid => "rigid",
        ModeKind::Bending => "bending",
        ModeKind::Torsion => "torsion",
        ModeKind::Axial => "axial",
        ModeKind::Section => "section",
    }
}

/// Width of the gutter between frame and right axis: leader and longest name.
fn gutter(results: &Campbell, orders: &[Order]) -> f64 {
    let branches = results.branches.iter().map(|branch| branch.name.as_str());
    let names = branches.chain(orders.iter().map(|order| order.label.as_str()));
    let longest = names.map(|name| text::text_width(name, NAME_SIZE)).fold(14.0, f64::max);
    23.0 + longest.min(LONGEST_NAME)
}
