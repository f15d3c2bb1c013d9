//! Plots of `rotor contact`: the scene, gaps and forces, the energy balance, and where the time went.

use crate::draw::clip::Point;
use crate::draw::palette::{self, LineStyle, Stroke};
use crate::draw::panels::{self, Curve, Panel, STROKES, Surroundings, figure};
use crate::draw::text;
use crate::error::Result;
use crate::results::{Contact, ContactEnergy, ContactHistory, Figures, Report, Snapshot};

const TIME: (&str, &str) = ("Time", "s");
/// Height over width of a scene from which it is drawn in two and in three columns.
const COLUMNS: [f64; 2] = [0.25, 0.6];
/// Share of the scene's size that its frame is larger by.
const FRAME_AIR_SHARE: f64 = 0.04;
/// Share of the largest energy below which one is not drawn.
const DRAWN_ENERGY_SHARE: f64 = 1e-6;
/// Least height of the frame of a scene, in logical pixels.
const LEAST_FRAME_HEIGHT: f64 = 110.0;

/// contact-scene.svg and contact-cost.svg, of a motion also contact-gap.svg and contact-energy.svg, as `(file name, SVG text)`.
///
/// # Errors
/// A failure of the drawing library.
pub fn svg(report: &Report<Contact>) -> Result<Figures> {
    let mut figures = vec![("contact-scene.svg".to_owned(), scene(report)?)];
    if let Some(history) = &report.results.history {
        figures.push(("contact-gap.svg".to_owned(), gap(report, history)?));
    }
    if let (Some(history), Some(list)) = (&report.results.history, &report.results.energy_j) {
        figures.push(("contact-energy.svg".to_owned(), energy(report, &history.time_s, list)?));
    }
    figures.push(("contact-cost.svg".to_owned(), cost(report)?));
    Ok(figures)
}

/// The bodies at some instants; in equilibrium over their undeformed shape.
fn scene(report: &Report<Contact>) -> Result<String> {
    let results = &report.results;
    let resting = results.history.is_none();
    let (low, high) = extent(&results.snapshots);
    let size = (high.0 - low.0, high.1 - low.1);
    let columns = 1 + COLUMNS.iter().filter(|&&least| size.1 >= least * size.0).count();
    let half = results.snapshots.len() / 2;
    // of an equilibrium the first half shows the undeformed shape
    let (before, shown) = results.snapshots.split_at(if resting { half } else { 0 });
    let columns = columns.min(shown.len().max(1));
    let names: Vec<&str> = results.bodies.iter().map(|b| b.name.as_str()).collect();
    let spatial = shown.iter().any(|s| s.axes != ["x", "y"]);
    let panel = |(k, snapshot): (usize, &Snapshot)| {
        let mut curves: Vec<Curve> = before.get(k).map(undeformed).unwrap_or_default();
        curves.extend(bodies(snapshot, &names));
        let seen = if spatial {
            format!(", seen in {}-{}", snapshot.axes[0], snapshot.axes[1])
        } else {
            String::new()
        };
        Panel {
            across: (snapshot.axes[0], "m"),
            up: (snapshot.axes[1], "m"),
            curves,
            equal: true,
            title: snapshot.label.clone() + &seen,
            inside: vec![low, high],
            ..Panel::default()
        }
    };
    let mut panels: Vec<Panel> = shown.iter().enumerate().map(panel).collect();
    panels::fit(&mut panels, columns, size, LEAST_FRAME_HEIGHT);
    let remarks = match resting {
        true => format!(
            "Displacements to scale. Largest penetration {} m.",
            text::significant(results.largest_penetration_m, 3)
        ),
        false => format!("Displacements to scale, all frames alike. {}", contacts(results)),
    };
    figure(&Surroundings::new(report, "Scene", remarks), &panels, columns)
}

/// Corners of what all snapshots take, with air around it.
fn extent(snapshots: &[Snapshot]) -> (Point, Point) {
    let (mut low, mut high) = ((f64::INFINITY, f64::INFINITY), (f64::NEG_INFINITY, f64::NEG_INFINITY));
    for [x, y] in snapshots.iter().flat_map(|s| &s.outlines).flatten() {
        (low, high) = ((low.0.min(*x), low.1.min(*y)), (high.0.max(*x), high.1.max(*y)));
    }
    if low.0 > high.0 {
        return ((0.0, 0.0), (1.0, 1.0));
    }
    let air = FRAME_AIR_SHARE * (high.0 - low.0).max(high.1 - low.1);
    ((low.0 - air, low.1 - air), (high.0 + air, high.1 + air))
}

fn closed(outline: &[[f64; 2]]) -> Vec<Point> {
    outline.iter().chain(outline.first()).map(|p| (p[0], p[1])).collect()
}

/// Outlines of the bodies, one stroke for each; those of many are drawn alike.
fn bodies(snapshot: &Snapshot, names: &[&str]) -> Vec<Curve> {
    let many = names.len() > STROKES.len();
    let curve = |(k, outline): (usize, &Vec<[f64; 2]>)| Curve {
        name: match (many, k) {
            (false, _) => names.get(k).copied().unwrap_or_default().to_owned(),
            (true, 0) => format!("{} bodies", names.len()),
            (true, _) => String::new(),
        },
        stroke: Stroke { width: 1.4, ..STROKES[if many { 0 } else { k }] },
        points: closed(outline),
    };
    snapshot.outlines.iter().enumerate().map(curve).collect()
}

fn undeformed(snapshot: &Snapshot) -> Vec<Curve> {
    let curve = |(k, outline): (usize, &Vec<[f64; 2]>)| Curve {
        name: if k == 0 { snapshot.label.clone() } else { String::new() },
        stroke: Stroke { color: palette::GREY, width: 1.0, line: LineStyle::Dotted },
        points: closed(outline),
    };
    snapshot.outlines.iter().enumerate().map(curve).collect()
}

/// Gaps, penetrations and forces of the pairs; contacts are tinted.
fn gap(report: &Report<Contact>, h: &ContactHistory) -> Result<String> {
    let results = &report.results;
    let end = h.time_s.last().copied().unwrap_or_default();
    let bands: Vec<(f64, f64)> =
        results.events.iter().map(|e| (e.time_s, e.until_s.unwrap_or(end))).collect();
    // pairs that nothing was measured of are left out
    let shown: Vec<usize> = (0..h.pairs.len())
        .filter(|&i| h.gap_m[i].iter().any(Option::is_some) || !h.touches[i].is_empty())
        .collect();
    let shown = &shown[..shown.len().min(STROKES.len())];
    let panel = |up: (&'static str, &'static str), of: &dyn Fn(usize) -> Vec<Point>| {
        let curve = |(k, &i): (usize, &usize)| Curve {
            name: match &h.pairs[i] {
                [a, b] if a == b => format!("{a} with itself"),
                [a, b] => format!("{a} and {b}"),
            },
            stroke: Stroke { width: 1.4, ..STROKES[k] },
            points: of(i),
        };
        let curves = shown.iter().enumerate().map(curve).collect();
        Panel { across: TIME, up, curves, bands: bands.clone(), ..Panel::default() }
    };
    let gaps =
        |i: usize| h.time_s.iter().zip(&h.gap_m[i]).map(|(t, gap)| (*t, gap.unwrap_or(f64::NAN))).collect();
    let touches = |i: usize| {
        let steps = h.touches[i].iter().map(|step| (step[0], step[1]));
        [(0.0, 0.0)]
            .into_iter()
            .chain(steps)
            .chain(h.touches[i].last().is_none_or(|step| step[0] < end).then_some((end, 0.0)))
            .collect()
    };
    // a mean over each interval
    let forces = |i: usize| {
        let intervals = h.time_s.windows(2).zip(h.force_n[i].iter().skip(1));
        intervals.flat_map(|(ends, force)| [(ends[0], *force), (ends[1], *force)]).collect()
    };
    let mut list = Vec::new();
    if !shown.is_empty() {
        list.push(panel(("Smallest gap", "m"), &gaps));
    }
    if !results.events.is_empty() {
        list.push(panel(("Penetration", "m"), &touches));
        list.push(panel(("Contact force", "N"), &forces));
    }
    let left = h.pairs.len().saturating_sub(shown.len());
    let more = if left > 0 { format!(" {left} more pairs are not drawn.") } else { String::new() };
    let remarks = match list.len() {
        0 => "Nothing came near: no gap was measured.".to_owned(),
        1 => format!("No contact. A gap is measured only where something is near.{more}"),
        _ => format!(
            "Tinted: contact. Gaps at {} instants (contact.output), forces as means between them, penetration at every step. {}{more}",
            h.time_s.len(),
            contacts(results)
        ),
    };
    figure(&Surroundings::new(report, "Gap and contact force", remarks), &list, 1)
}

fn contacts(results: &Contact) -> String {
    let count = match results.events.len() {
        0 => return "No contact.".to_owned(),
        1 => "1 contact".to_owned(),
        n => format!("{n} contacts"),
    };
    format!(
        "{count}, the first at {} s, largest penetration {} m.",
        text::significant(results.events[0].time_s, 4),
        text::significant(results.largest_penetration_m, 3)
    )
}

/// Energies, and the change of their sum.
fn energy(report: &Report<Contact>, time: &[f64], e: &ContactEnergy) -> Result<String> {
    let named = [
        ("kinetic", &e.kinetic),
        ("strain", &e.strain),
        ("potential of gravity", &e.gravity),
        ("work of the loads", &e.work),
        ("contact springs", &e.contact),
    ];
    let size = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let largest = named.iter().map(|(_, values)| size(values)).fold(0.0, f64::max);
    let curves = named
        .into_iter()
        .filter(|(_, values)| size(values) > DRAWN_ENERGY_SHARE * largest)
        .map(|(name, values)| (name, values.clone()))
        .collect();
    let start = e.total.first().copied().unwrap_or_default();
    let change = e.total.iter().map(|total| total - start).collect();
    let list = [
        Panel::over(TIME, ("Energy", "J"), time, curves),
        Panel::over(
            TIME,
            ("Change of the sum", "J"),
            time,
            vec![("sum of the energies less the work", change)],
        ),
    ];
    let remarks = match (report.results.energy_error, report.results.energy_change) {
        (Some(error), Some(change)) => format!(
            "Over the largest kinetic energy the sum changes by at most {} during the run and by {} at its end.",
            text::significant(error, 3),
            text::significant(change, 3)
        ),
        _ => "Nothing moved.".to_owned(),
    };
    figure(&Surroundings::new(report, "Energy balance", remarks), &list, 1)
}

/// Seconds by phase.
fn cost(report: &Report<Contact>) -> Result<String> {
    let c = &report.results.cost;
    let phases = [
        ("search", c.search_s),
        ("gaps", c.gaps_s),
        ("elements", c.elements_s),
        ("equations", c.solve_s),
        ("complementarity", c.complementarity_s),
    ];
    let rest = (c.total_s - phases.iter().map(|(_, seconds)| seconds).sum::<f64>()).max(0.0);
    let parts: Vec<(&str, f64)> = phases.into_iter().chain([("rest", rest)]).collect();
    let solver = &report.results.solver;
    let remarks = format!(
        "{} steps, {} cut; {} iterations; {} searches, {} gaps measured, {} complementarity problems.",
        solver.steps,
        solver.cut,
        solver.iterations,
        solver.searches,
        solver.gaps,
        solver.complementarity_problems
    );
    panels::bars(&Surroundings::new(report, "Time by phase", remarks), "s", &parts)
}
