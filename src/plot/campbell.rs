//! Campbell diagram: whirl frequencies over spin speed, with excitation orders, numbered critical speeds and a
//! table of them. Legend and table stand beside the axes, names of branches in a gutter at their right ends,
//! numbers of critical speeds wherever they cover least.

use std::f64::consts::TAU;

use plotters::style::text_anchor::HPos;

use crate::error::Result;
use crate::plot::style::{self, Canvas, Font, Marker, Point, Rect, Sample, Scale, Side, Stroke};
use crate::results::{Branch, Campbell, CriticalSpeed, ModeKind, Report, Whirl};

const WIDTH: f64 = 1120.0;
const HEIGHT: f64 = 780.0;
const PANEL_WIDTH: f64 = 264.0;
const FRAME_LEFT: f64 = 96.0;
/// Height that the axis above and the axis below the frame take.
const AXIS_HEIGHT: f64 = 56.0;
/// From the right axis to the panel: ticks, label, air.
const RIGHT_AXIS_WIDTH: f64 = 92.0;
/// Critical speeds that get a number and a row of the table.
const LISTED: usize = 20;
const ROW: f64 = 17.5;
const NOTE_ROW: f64 = 16.0;
const NAME_SIZE: f64 = 14.0;
/// Names smaller than this could not be read.
const LEAST_NAME_SIZE: f64 = 8.0;
const LONGEST_NAME: f64 = 80.0;
/// Rounding alone must not mark a neutral branch as unstable.
const UNSTABLE_BELOW: f64 = -1e-9;
const RPM: f64 = 60.0 / TAU;
const ORDER_STROKE: Stroke = Stroke { color: style::GREY, width: 1.2, line: style::Line::DashDot };
const LEADER: Stroke = Stroke::solid(style::GREY, 0.9);
const RANGE: style::Color = style::PALE_RED;
const RANGE_SAMPLE: Stroke = Stroke::solid(RANGE, 11.0);
const BAND: Stroke = Stroke::solid(style::LIGHT_RED, 9.0);

/// The diagram as SVG text; the same report always gives the same text.
pub fn svg(report: &Report<Campbell>) -> Result<String> {
    style::figure(WIDTH, HEIGHT, |canvas| paint(canvas, report))
}

fn paint(canvas: &mut Canvas, report: &Report<Campbell>) {
    let title = format!(
        "Campbell diagram, {} frame, {} form: {}",
        report.results.frame, report.results.form, report.case.title
    );
    style::title(canvas, WIDTH, &title);
    let below_title = style::below_title(WIDTH, &title);
    let diagram = Diagram::new(&report.results, below_title);
    let mut obstacles = Obstacles::new(&diagram);
    diagram.paint_ranges(canvas);
    diagram.paint_axes(canvas);
    diagram.paint_orders(canvas, &mut obstacles);
    diagram.paint_curves(canvas);
    let unnamed = diagram.paint_names(canvas, &mut obstacles);
    diagram.paint_criticals(canvas, &mut obstacles);
    let notes = diagram.notes(unnamed);
    diagram.paint_panel(canvas, below_title, &notes);
    let results = &report.results;
    let remarks = format!(
        "Frequencies as seen in the {} frame; {} form; gyroscopic terms: {}. {}",
        results.frame,
        results.form,
        results.gyroscopic,
        style::failed_checks(&report.diagnostics)
    );
    let words = style::FooterWords { remarks, content: style::model_words(&report.model) };
    style::footer(canvas, (WIDTH, HEIGHT), &report.case, report.rotor, &words);
}

/// A point of a branch.
#[derive(Debug, Clone, Copy)]
struct Sampled {
    rpm: f64,
    hz: f64,
    unstable: bool,
    whirl: Whirl,
}

/// A branch as unbroken stretches.
struct Curve<'a> {
    branch: &'a Branch,
    stretches: Vec<Vec<Sampled>>,
}

impl<'a> Curve<'a> {
    fn new(branch: &'a Branch, speeds: &[f64]) -> Self {
        let mut stretches: Vec<Vec<Sampled>> = vec![Vec::new()];
        for (index, (speed, frequency)) in speeds.iter().zip(&branch.frequency_rad_s).enumerate() {
            let unstable =
                branch.log_decrement.get(index).copied().flatten().is_some_and(|d| d < UNSTABLE_BELOW);
            match frequency {
                Some(frequency) if frequency.is_finite() && speed.is_finite() => {
                    let whirl = branch.whirl_at_speed.get(index).copied().unwrap_or(branch.whirl);
                    let sampled = Sampled { rpm: speed * RPM, hz: frequency / TAU, unstable, whirl };
                    if let Some(stretch) = stretches.last_mut() {
                        stretch.push(sampled);
                    }
                }
                _ => stretches.push(Vec::new()),
            }
        }
        stretches.retain(|stretch| !stretch.is_empty());
        Self { branch, stretches }
    }

    fn samples(&self) -> impl Iterator<Item = &Sampled> {
        self.stretches.iter().flatten()
    }

    /// Sense at the highest speed at which it is drawn.
    fn last_whirl(&self) -> Whirl {
        self.samples().last().map_or(self.branch.whirl, |sampled| sampled.whirl)
    }

    /// Stretches of one sense; neighbours meet halfway between the speeds at which they differ.
    fn by_whirl(&self) -> Vec<(Whirl, Vec<Sampled>)> {
        let mut runs: Vec<(Whirl, Vec<Sampled>)> = Vec::new();
        for stretch in &self.stretches {
            let mut before: Option<Sampled> = None;
            for &sampled in stretch {
                match (before, runs.last_mut()) {
                    (Some(_), Some((whirl, run))) if *whirl == sampled.whirl => run.push(sampled),
                    (Some(last), Some((_, run))) => {
                        let halfway = |whirl| Sampled {
                            rpm: (last.rpm + sampled.rpm) / 2.0,
                            hz: (last.hz + sampled.hz) / 2.0,
                            unstable: sampled.unstable,
                            whirl,
                        };
                        run.push(halfway(last.whirl));
                        runs.push((sampled.whirl, vec![halfway(sampled.whirl), sampled]));
                    }
                    _ => runs.push((sampled.whirl, vec![sampled])),
                }
                before = Some(sampled);
            }
        }
        runs
    }

    fn highest(&self) -> Option<f64> {
        self.samples().map(|sampled| sampled.hz).reduce(f64::max)
    }

    fn is_unstable(&self) -> bool {
        self.samples().any(|sampled| sampled.unstable)
    }

    /// Frequency at a speed inside one of the stretches.
    fn at(&self, rpm: f64) -> Option<f64> {
        let pairs = self.stretches.iter().flat_map(|stretch| stretch.windows(2));
        let around = pairs.map(|pair| (pair[0], pair[1])).find(|(a, b)| a.rpm <= rpm && rpm <= b.rpm);
        around.map(|(a, b)| {
            let fraction = if b.rpm > a.rpm { (rpm - a.rpm) / (b.rpm - a.rpm) } else { 0.0 };
            a.hz + fraction * (b.hz - a.hz)
        })
    }
}

/// A critical speed as drawn.
struct Mark<'a> {
    critical: &'a CriticalSpeed,
    rpm: f64,
    hz: f64,
}

/// An excitation line `frequency = slope * speed`.
struct Order {
    slope: f64,
    label: String,
}

/// Everything needed to paint the axes' inside.
struct Diagram<'a> {
    curves: Vec<Curve<'a>>,
    marks: Vec<Mark<'a>>,
    /// Unstable ranges, rpm.
    ranges: Vec<(f64, f64)>,
    orders: Vec<Order>,
    frame: Rect,
    /// Right end of the gutter with the names, where the right axis stands.
    spine: f64,
    x: Scale,
    y: Scale,
}

impl<'a> Diagram<'a> {
    fn new(results: &'a Campbell, below_title: f64) -> Self {
        let curves: Vec<Curve> =
            results.branches.iter().map(|b| Curve::new(b, &results.speeds_rad_s)).collect();
        let marks = marks(results, &curves);
        let orders = orders(results);
        let (low, high) = speed_range(&results.speeds_rad_s);
        let inside = marks.iter().filter(|mark| low <= mark.rpm && mark.rpm <= high).map(|mark| mark.hz);
        let top =
            top_frequency(&curves, inside.reduce(f64::max).unwrap_or(0.0), high.abs().max(low.abs()) / 60.0);
        let spine = WIDTH - style::MARGIN - PANEL_WIDTH - RIGHT_AXIS_WIDTH;
        let frame = Rect {
            left: FRAME_LEFT,
            top: below_title + AXIS_HEIGHT,
            right: spine - gutter(results, &orders),
            bottom: HEIGHT - style::FOOTER_HEIGHT - AXIS_HEIGHT - 8.0,
        };
        let x = Scale { low, high, start: frame.left, end: frame.right };
        let y = Scale { low: 0.0, high: top, start: frame.bottom, end: frame.top };
        let ranges = results.unstable_ranges.iter().map(|r| (r.from_rpm, r.to_rpm)).collect();
        Self { curves, marks, ranges, orders, frame, spine, x, y }
    }

    fn point(&self, rpm: f64, hz: f64) -> Point {
        (self.x.pixel(rpm), self.y.pixel(hz))
    }

    fn pixels(&self, stretch: &[Sampled]) -> Vec<Point> {
        stretch.iter().map(|sampled| self.point(sampled.rpm, sampled.hz)).collect()
    }

    /// Visible parts of a curve as lines; single points come as lines of one point.
    fn visible(&self, curve: &Curve) -> Vec<Vec<Point>> {
        curve.stretches.iter().flat_map(|stretch| self.parts(stretch)).collect()
    }

    /// Visible parts of a line.
    fn parts(&self, stretch: &[Sampled]) -> Vec<Vec<Point>> {
        let pixels = self.pixels(stretch);
        match pixels[..] {
            [point] if self.frame.contains(point) => vec![vec![point]],
            _ => style::clip(&pixels, self.frame),
        }
    }

    /// Shades the unstable ranges over the whole height, the narrowest still visible.
    fn paint_ranges(&self, canvas: &mut Canvas) {
        for &(from, to) in &self.ranges {
            let (left, right) = (self.x.pixel(from), self.x.pixel(to));
            let (middle, half) = ((left + right) / 2.0, ((right - left) / 2.0).max(0.75));
            let frame = self.frame;
            let left = (middle - half).clamp(frame.left, frame.right);
            let right = (middle + half).clamp(frame.left, frame.right);
            if left < right {
                canvas.fill_rect(Rect { left, right, top: frame.top, bottom: frame.bottom }, RANGE);
            }
        }
    }

    fn paint_axes(&self, canvas: &mut Canvas) {
        let frame = self.frame;
        style::grid(canvas, frame, self.x, self.y);
        let black = Stroke::solid(style::BLACK, 1.2);
        canvas.frame(frame, black);
        canvas.path(&[(self.spine, frame.top), (self.spine, frame.bottom)], black);
        style::axis(canvas, Side::Bottom, frame.bottom, self.x, "Spin speed", "rpm");
        style::axis(canvas, Side::Top, frame.top, self.x.times(1.0 / RPM), "Spin speed", "rad/s");
        style::axis(canvas, Side::Left, frame.left, self.y, "Whirl frequency", "Hz");
        style::axis(canvas, Side::Right, self.spine, self.y.times(60.0), "Whirl frequency", "cpm");
    }

    fn order_line(&self, slope: f64) -> Vec<Vec<Point>> {
        let (low, high) = (self.x.low, self.x.high);
        let mut speeds = vec![low, high];
        if low < 0.0 && high > 0.0 {
            speeds.insert(1, 0.0);
        }
        let pixels: Vec<Point> =
            speeds.into_iter().map(|rpm| self.point(rpm, slope * rpm.abs() / 60.0)).collect();
        style::clip(&pixels, self.frame)
    }

    fn paint_orders(&self, canvas: &mut Canvas, obstacles: &mut Obstacles) {
        for order in &self.orders {
            for part in self.order_line(order.slope) {
                canvas.path(&part, ORDER_STROKE);
                obstacles.add_line(&part);
            }
        }
    }

    fn paint_curves(&self, canvas: &mut Canvas) {
        for stretch in self.curves.iter().flat_map(|curve| &curve.stretches) {
            for run in stretch.split(|sampled| !sampled.unstable) {
                match self.pixels(run)[..] {
                    [] => {}
                    [point] if self.frame.contains(point) => canvas.disc(point, 7.0, BAND.color),
                    ref pixels => {
                        style::clip(pixels, self.frame).iter().for_each(|part| canvas.path(part, BAND));
                    }
                }
            }
        }
        // Broken lines come last: where branches coincide, both stay visible.
        let runs: Vec<(Whirl, Vec<Sampled>)> = self.curves.iter().flat_map(Curve::by_whirl).collect();
        for layer in [Whirl::Forward, Whirl::Backward, Whirl::Mixed, Whirl::None] {
            let stroke = Stroke::whirl(layer);
            for part in runs.iter().filter(|(w, _)| *w == layer).flat_map(|(_, run)| self.parts(run)) {
                match part[..] {
                    [point] => canvas.marker(point, Marker::whirl(layer), 4.5, stroke.color),
                    _ => canvas.path(&part, stroke),
                }
            }
        }
    }

    /// Speed pixel at which the curves end.
    fn column(&self) -> f64 {
        let speeds = self.curves.iter().flat_map(Curve::samples).map(|sampled| sampled.rpm);
        speeds.reduce(f64::max).map_or(self.frame.right, |last| self.x.pixel(last))
    }

    /// Writes the names of orders and branches and returns how many found no room.
    fn paint_names(&self, canvas: &mut Canvas, obstacles: &mut Obstacles) -> usize {
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
                aligned.push(Name { words: &order.label, color: style::DARK_GREY, end, clear: 1.0 });
            } else {
                paint_order_name(canvas, obstacles, &order.label, (from, end));
            }
        }
        aligned.sort_by(|a, b| a.end.1.total_cmp(&b.end.1));
        let unnamed = self.paint_column(canvas, obstacles, &aligned);
        for name in elsewhere {
            let words = style::shorten(name.words, NAME_SIZE, LONGEST_NAME);
            let size = (style::text_width(&words, NAME_SIZE) + 2.0, NAME_SIZE);
            let place = obstacles.near(name.end, size);
            canvas.path(&[name.end, nearest(place, name.end)], LEADER);
            canvas.text(place.center(), &words, Font::new(NAME_SIZE).color(name.color), HPos::Center);
        }
        unnamed
    }

    /// Names of the lines that reach the highest speed, one below the other.
    fn paint_column(&self, canvas: &mut Canvas, obstacles: &mut Obstacles, names: &[Name]) -> usize {
        let height = self.frame.height();
        let room = (height / LEAST_NAME_SIZE) as usize;
        // Lowest frequencies stand last and are the ones to keep.
        let (unnamed, names) = names.split_at(names.len().saturating_sub(room));
        let size = (height / names.len().max(1) as f64 / 1.25).clamp(LEAST_NAME_SIZE / 1.1, NAME_SIZE);
        let wanted: Vec<f64> = names.iter().map(|name| name.end.1).collect();
        let half = size / 2.0;
        let rows = style::spread(&wanted, size * 1.1, self.frame.top + half, self.frame.bottom - half);
        for (name, y) in names.iter().zip(rows) {
            let words = style::shorten(name.words, size, LONGEST_NAME);
            let (end, start) = (name.end, name.end.0 + name.clear);
            let left = start + 14.0;
            canvas.path(&[(start, end.1), (start + 2.0, end.1), (left - 5.0, y), (left - 2.0, y)], LEADER);
            canvas.text((left, y), &words, Font::new(size).color(name.color), HPos::Left);
            let right = left + style::text_width(&words, size);
            obstacles.boxes.push(Rect { left: end.0, top: y - half, right, bottom: y + half });
        }
        unnamed.len()
    }

    fn paint_criticals(&self, canvas: &mut Canvas, obstacles: &mut Obstacles) {
        let drawn: Vec<(usize, Point, bool)> = self
            .marks
            .iter()
            .enumerate()
            .filter(|(_, mark)| self.is_inside(mark))
            .map(|(index, mark)| (index, self.point(mark.rpm, mark.hz), mark.critical.damped))
            .collect();
        let numbered: Vec<(usize, Point)> = drawn
            .iter()
            .filter(|(index, ..)| *index < LISTED)
            .map(|&(index, point, _)| (index, point))
            .collect();
        let places: Vec<Rect> =
            numbered.iter().map(|&(_, point)| obstacles.near(point, (21.0, 21.0))).collect();
        for (&(_, point), place) in numbered.iter().zip(&places) {
            canvas.path(&[point, place.center()], Stroke::solid(style::BLACK, 0.9));
        }
        for (_, point, damped) in drawn {
            canvas.marker(point, critical_marker(damped), 3.6, style::BLACK);
        }
        for ((index, _), place) in numbered.iter().zip(&places) {
            canvas.ring(place.center(), 9.6, style::BLACK, 1.1);
            let number = (index + 1).to_string();
            canvas.text(place.center(), &number, Font::new(12.0).bold(), HPos::Center);
        }
    }

    fn is_inside(&self, mark: &Mark) -> bool {
        let within = |scale: Scale, value: f64| scale.low <= value && value <= scale.high;
        within(self.x, mark.rpm) && within(self.y, mark.hz)
    }

    /// Remarks below the table on what the diagram does not show.
    fn notes(&self, unnamed: usize) -> Vec<String> {
        let mut notes = Vec::new();
        let names = |curves: Vec<&Curve>| -> String {
            curves.iter().map(|curve| curve.branch.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let hidden: Vec<&Curve> = self.curves.iter().filter(|curve| self.visible(curve).is_empty()).collect();
        let (silent, above): (Vec<&Curve>, Vec<&Curve>) =
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
        if self.marks.iter().take(LISTED).any(|mark| !self.is_inside(mark)) {
            notes.push("Grey rows lie outside the diagram".to_owned());
        }
        notes.iter().flat_map(|note| style::wrap(note, style::SMALL_SIZE, PANEL_WIDTH, 3)).collect()
    }

    fn legend(&self) -> Vec<(Sample, String)> {
        let mut entries = Vec::new();
        for (whirl, words) in [
            (Whirl::Forward, "forward whirl"),
            (Whirl::Backward, "backward whirl"),
            (Whirl::Mixed, "mixed whirl, or in a plane"),
            (Whirl::None, "no whirl"),
        ] {
            if self.curves.iter().flat_map(Curve::samples).any(|sampled| sampled.whirl == whirl) {
                let stroke = Stroke::whirl(whirl);
                let single =
                    self.curves.iter().flat_map(|curve| &curve.stretches).all(|stretch| stretch.len() == 1);
                let marker = Sample::Marker(Marker::whirl(whirl), stroke.color);
                entries.push((if single { marker } else { Sample::Stroke(stroke) }, words.to_owned()));
            }
        }
        if self.curves.iter().any(Curve::is_unstable) {
            let sample = Sample::Band(BAND, Stroke::solid(style::BLACK, 1.5));
            entries.push((sample, "unstable".to_owned()));
        }
        if !self.ranges.is_empty() {
            entries.push((Sample::Stroke(RANGE_SAMPLE), "unstable range of speed".to_owned()));
        }
        entries.push((Sample::Stroke(ORDER_STROKE), "excitation order".to_owned()));
        for (damped, words) in [(false, "critical speed"), (true, "critical speed, damped (d)")] {
            if self.marks.iter().any(|mark| mark.critical.damped == damped) {
                entries.push((Sample::Marker(critical_marker(damped), style::BLACK), words.to_owned()));
            }
        }
        entries
    }

    fn paint_panel(&self, canvas: &mut Canvas, below_title: f64, notes: &[String]) {
        let left = WIDTH - style::MARGIN - PANEL_WIDTH;
        let mut y = below_title + 20.0;
        for (sample, words) in self.legend() {
            style::legend_entry(canvas, (left, y), PANEL_WIDTH, sample, &words);
            y += style::LEGEND_ROW;
        }
        let notes_height = NOTE_ROW * notes.len() as f64;
        let bottom = HEIGHT - style::FOOTER_HEIGHT - 12.0;
        y = self.paint_table(canvas, (left, y + 16.0), bottom - notes_height) + 6.0;
        for note in notes {
            let font = Font::new(style::SMALL_SIZE).color(style::DARK_GREY);
            canvas.text((left, y), note, font, HPos::Left);
            y += NOTE_ROW;
        }
    }

    /// Draws the table of critical speeds and returns the y of the line below it.
    fn paint_table(&self, canvas: &mut Canvas, (left, top): Point, bottom: f64) -> f64 {
        let regular = Font::new(13.5);
        let heading = if self.marks.is_empty() { "No critical speeds found" } else { "Critical speeds" };
        canvas.text((left, top), heading, Font::new(style::LABEL_SIZE).bold(), HPos::Left);
        if self.marks.is_empty() {
            return top + ROW;
        }
        let mut y = top + ROW + 2.0;
        table_row(canvas, (left, y), ["no.", "rpm", "Hz", "whirl", "branch"], regular.bold());
        canvas.path(&[(left, y + 10.0), (left + PANEL_WIDTH, y + 10.0)], Stroke::solid(style::BLACK, 0.8));
        y += 3.0;
        let room = ((bottom - y) / ROW - 1.0).clamp(1.0, LISTED as f64) as usize;
        for (index, mark) in self.marks.iter().take(room).enumerate() {
            y += ROW;
            let critical = mark.critical;
            let number = (index + 1).to_string();
            let speed = style::significant(critical.speed_rpm, 5);
            let frequency = style::significant(critical.speed_rpm / 60.0, 5);
            let damped = if critical.damped { " (d)" } else { "" };
            let name = critical.branch.as_deref().unwrap_or(kind_word(critical.kind));
            let branch = style::shorten(
                name,
                regular.size,
                PANEL_WIDTH - 212.0 - style::text_width(damped, regular.size),
            ) + damped;
            let color = if self.is_inside(mark) { style::BLACK } else { style::GREY };
            let cells = [&number, &speed, &frequency, whirl_word(critical.whirl), &branch];
            table_row(canvas, (left, y), cells, regular.color(color));
        }
        if self.marks.len() > room {
            y += ROW;
            let words = format!("and {} more, see the report", self.marks.len() - room);
            canvas.text((left, y), &words, regular, HPos::Left);
        }
        y + ROW
    }
}

/// The name of a line, to be written near its end.
struct Name<'a> {
    words: &'a str,
    color: style::Color,
    end: Point,
    /// Distance that the leader keeps from the end, so that it does not run through a symbol.
    clear: f64,
}

/// Writes the name of an order inside the frame, beside its line.
fn paint_order_name(canvas: &mut Canvas, obstacles: &mut Obstacles, name: &str, (from, to): (Point, Point)) {
    let words = style::shorten(name, style::SMALL_SIZE, 160.0);
    let size = (style::text_width(&words, style::SMALL_SIZE) + 4.0, style::SMALL_SIZE + 3.0);
    if let Some(place) = obstacles.along(from, to, size) {
        let font = Font::new(style::SMALL_SIZE).color(style::DARK_GREY);
        canvas.text(place.center(), &words, font, HPos::Center);
    }
}

fn table_row(canvas: &mut Canvas, (left, y): Point, cells: [&str; 5], font: Font) {
    let columns = [
        (26.0, HPos::Right),
        (96.0, HPos::Right),
        (158.0, HPos::Right),
        (166.0, HPos::Left),
        (212.0, HPos::Left),
    ];
    for (cell, (offset, anchor)) in cells.into_iter().zip(columns) {
        canvas.text((left + offset, y), cell, font, anchor);
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
    let longest = names.map(|name| style::text_width(name, NAME_SIZE)).fold(14.0, f64::max);
    23.0 + longest.min(LONGEST_NAME)
}

/// Critical speeds with the frequency at which they are drawn. In the stationary frame this is the speed itself; in
/// the rotating frame it is the branch's own frequency there, or else what the frame's rotation makes of the speed.
fn marks<'a>(results: &'a Campbell, curves: &[Curve]) -> Vec<Mark<'a>> {
    let usable = results.critical_speeds.iter().filter(|critical| critical.speed_rpm.is_finite());
    usable
        .map(|critical| {
            let rpm = critical.speed_rpm;
            let seen = match critical.whirl {
                _ if results.frame != "rotating" => 1.0,
                Whirl::Forward => 0.0,
                Whirl::Backward => 2.0,
                Whirl::Mixed | Whirl::None => 1.0,
            };
            let own = curves.iter().find(|curve| Some(&curve.branch.name) == critical.branch.as_ref());
            let on_branch = own.filter(|_| results.frame == "rotating").and_then(|curve| curve.at(rpm));
            Mark { critical, rpm, hz: on_branch.unwrap_or(seen * rpm.abs() / 60.0) }
        })
        .collect()
}

/// Excitation lines. Seen from the rotating frame, an excitation at n times the speed is (n - 1) times the speed for
/// forward and (n + 1) times for backward whirl; its forward 1x is the zero line. A force fixed in space, gravity,
/// turns backward at the speed itself.
fn orders(results: &Campbell) -> Vec<Order> {
    let further =
        results.orders.iter().copied().filter(|order| order.is_finite() && *order > 0.0 && *order != 1.0);
    let factors: Vec<f64> = std::iter::once(1.0).chain(further).collect();
    if results.frame != "rotating" {
        return factors.into_iter().map(|slope| Order { slope, label: format!("{slope}x") }).collect();
    }
    let mut orders: Vec<Order> = vec![Order { slope: 1.0, label: "gravity".to_owned() }];
    for factor in factors {
        for (slope, sense) in [((factor - 1.0).abs(), "fwd"), (factor + 1.0, "bwd")] {
            let label = format!("{factor}x {sense}");
            match orders.iter_mut().find(|order| order.slope == slope) {
                Some(order) => order.label += &format!(", {label}"),
                None if slope > 0.0 => orders.push(Order { slope, label }),
                None => {}
            }
        }
    }
    orders
}

/// Lowest and highest speed in rpm, widened if there is only one.
fn speed_range(speeds: &[f64]) -> (f64, f64) {
    let finite = || speeds.iter().copied().filter(|speed| speed.is_finite()).map(|speed| speed * RPM);
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    if low > high {
        return (0.0, 1.0);
    }
    let largest = low.abs().max(high.abs());
    if high - low > 1e-9 * largest {
        return (low, high);
    }
    let half = if largest > 0.0 { 0.5 * largest } else { 1.0 };
    (low - half, high + half)
}

/// Upper end of the frequency axis: all branches, unless some lie so high that they would squeeze the others; all
/// critical speeds in any case. The speed itself (`one_x`) only loosens the limit.
fn top_frequency(curves: &[Curve], highest_critical: f64, one_x: f64) -> f64 {
    let mut highest: Vec<f64> = curves.iter().filter_map(Curve::highest).collect();
    highest.sort_by(f64::total_cmp);
    let median = highest.get(highest.len() / 2).copied().unwrap_or(0.0);
    let limit = (5.0 * one_x).max(8.0 * median);
    let branches = highest.into_iter().filter(|&hz| hz <= limit).fold(0.0, f64::max);
    let top = branches.max(highest_critical);
    let shown = if top > 0.0 { top } else { one_x };
    if shown > 0.0 { (1.07 * shown).min(f64::MAX / 1e3) } else { 1.0 }
}

/// What labels inside the frame should not cover.
struct Obstacles {
    frame: Rect,
    boxes: Vec<Rect>,
    dots: Vec<Point>,
    samples: Vec<Point>,
    leaders: Vec<(Point, Point)>,
}

impl Obstacles {
    fn new(diagram: &Diagram) -> Self {
        let inside = diagram.marks.iter().filter(|mark| diagram.is_inside(mark));
        let mut obstacles = Self {
            frame: diagram.frame,
            boxes: Vec::new(),
            dots: inside.map(|mark| diagram.point(mark.rpm, mark.hz)).collect(),
            samples: Vec::new(),
            leaders: Vec::new(),
        };
        for part in diagram.curves.iter().flat_map(|curve| diagram.visible(curve)) {
            obstacles.add_line(&part);
        }
        obstacles
    }

    /// A line weighs by its length, so it counts as points at equal distances.
    fn add_line(&mut self, line: &[Point]) {
        self.samples.extend(line.first());
        for pair in line.windows(2) {
            let pieces = (style::distance(pair[0], pair[1]) / 4.0).ceil().max(1.0);
            let inner = (1..=pieces as usize).map(|piece| piece as f64 / pieces);
            self.samples.extend(inner.map(|fraction| style::between(pair[0], pair[1], fraction)));
        }
    }

    /// Badness of a label; labels above all must not lie on one another.
    fn cost(&self, label: &Rect, leader: Option<(Point, Point)>) -> f64 {
        let covers = |points: &[Point], margin: f64| {
            let grown = label.grown(margin);
            points.iter().filter(|&&point| grown.contains(point)).count() as f64
        };
        let count = |hits: usize| hits as f64;
        let mut cost = covers(&self.samples, 1.0) + 40.0 * covers(&self.dots, 3.0);
        cost += 1000.0 * count(self.boxes.iter().filter(|other| other.overlaps(&label.grown(1.0))).count());
        cost += 100.0
            * count(self.leaders.iter().filter(|l| style::clip_segment(l.0, l.1, *label).is_some()).count());
        if let Some((from, to)) = leader {
            cost += 100.0
                * count(self.boxes.iter().filter(|b| style::clip_segment(from, to, **b).is_some()).count());
            cost += 30.0 * count(self.leaders.iter().filter(|l| cross(**l, (from, to))).count());
        }
        cost
    }

    /// Takes the best place for a label around a point; its leader starts there.
    fn near(&mut self, anchor: Point, (width, height): (f64, f64)) -> Rect {
        let mut best = (f64::INFINITY, Rect::around(anchor, width, height));
        for ring in 0..10 {
            let gap = 7.0 + 9.0 * f64::from(ring);
            for step in 0..24 {
                let (sine, cosine) = (f64::from(step) * TAU / 24.0).sin_cos();
                let away = (cosine * (gap + width / 2.0), -sine * (gap + height / 2.0));
                let place = Rect::around((anchor.0 + away.0, anchor.1 + away.1), width, height);
                if !self.frame.grown(-1.0).encloses(&place) {
                    continue;
                }
                let leader = (anchor, nearest(place, anchor));
                let cost = self.cost(&place, Some(leader)) + 0.15 * gap;
                if cost < best.0 {
                    best = (cost, place);
                }
            }
        }
        self.boxes.push(best.1);
        self.leaders.push((anchor, nearest(best.1, anchor)));
        best.1
    }

    /// Takes the best place for a label beside a straight line, near its far end.
    fn along(&mut self, from: Point, to: Point, (width, height): (f64, f64)) -> Option<Rect> {
        let length = style::distance(from, to);
        let mut best: Option<(f64, Rect)> = None;
        for step in 0..30 {
            let back = 12.0 + 8.0 * f64::from(step);
            if back > length {
                break;
            }
            let (x, y) = style::between(to, from, back / length);
            let (right, down) = (width / 2.0 + 4.0, height / 2.0 + 2.0);
            for (dx, dy) in
                [(-right, -down), (right, down), (-right, 0.0), (right, 0.0), (0.0, -down), (0.0, down)]
            {
                let place = Rect::around((x + dx, y + dy), width, height);
                if !self.frame.grown(-1.0).encloses(&place) {
                    continue;
                }
                let cost = self.cost(&place, None) + 0.02 * back;
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, place));
                }
            }
        }
        let place = best.map(|(_, place)| place)?;
        self.boxes.push(place);
        Some(place)
    }
}

/// The point of a rectangle nearest to another point.
fn nearest(rect: Rect, (x, y): Point) -> Point {
    (x.clamp(rect.left, rect.right), y.clamp(rect.top, rect.bottom))
}

/// Whether two segments cross in their insides.
fn cross((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
    let side = |from: Point, to: Point, p: Point| {
        (to.0 - from.0) * (p.1 - from.1) - (to.1 - from.1) * (p.0 - from.0)
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
