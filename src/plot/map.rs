//! Plots of `rotor map`: critical speeds over the stiffness of supports, both logarithmic, and decay over a cross-coupling.

use crate::draw::clip::Point;
use crate::draw::palette::{self, LineStyle, Marker, Stroke};
use crate::draw::panels::{Curve, Mark, Panel, STROKES, Surroundings, figure};
use crate::error::Result;
use crate::plot::response::rpm;
use crate::results::{CriticalMap, Figures, Report, Whirl};

/// Most bearing curves that have a name in the legend.
const NAMED_BEARINGS: usize = 4;

/// map.svg and, with a cross-coupling, map-cross-coupling.svg.
///
/// # Errors
/// A failure of the drawing library.
pub fn svg(report: &Report<CriticalMap>) -> Result<Figures> {
    let mut figures = vec![("map.svg".to_owned(), map(report)?)];
    if let Some(q) = &report.results.cross_coupling {
        let points: Vec<Point> =
            q.stiffness_n_m.iter().zip(&q.log_decrement).filter_map(|(k, d)| Some((*k, (*d)?))).collect();
        let end = q.stiffness_n_m.last().copied().unwrap_or(1.0);
        let zero = Stroke { color: palette::GREY, width: 1.2, line: LineStyle::Dashed };
        let panel = Panel {
            across: ("Cross-coupled stiffness Q", "N/m"),
            up: ("Log decrement, first forward", "-"),
            curves: vec![
                Curve { name: "log decrement".to_owned(), stroke: STROKES[0], points },
                Curve { name: "0.1 and 0".to_owned(), stroke: zero, points: vec![(0.0, 0.1), (end, 0.1)] },
                Curve { name: String::new(), stroke: zero, points: vec![(0.0, 0.0), (end, 0.0)] },
            ],
            marks: q
                .threshold_n_m
                .map(|k| Mark {
                    name: "a motion begins to grow".to_owned(),
                    marker: Marker::Ring,
                    color: palette::VERMILLION,
                    at: (k, 0.0),
                })
                .into_iter()
                .collect(),
            height: 330.0,
            ..Panel::default()
        };
        let remarks = format!("Q at {:.4} m, rotor at {:.0} rpm.", q.at, rpm(q.speed_rad_s));
        let around = Surroundings::new(report, "Decay over cross-coupling", remarks);
        figures.push(("map-cross-coupling.svg".to_owned(), figure(&around, &[panel], 1)?));
    }
    Ok(figures)
}

fn map(report: &Report<CriticalMap>) -> Result<String> {
    let results = &report.results;
    let forward = Stroke { color: palette::BLUE, width: 2.0, line: LineStyle::Solid };
    let backward = Stroke { color: palette::VERMILLION, width: 1.6, line: LineStyle::Dashed };
    let mut curves = Vec::new();
    let mut named = [false; 2];
    for curve in &results.curves {
        let sense = usize::from(curve.whirl == Whirl::Backward);
        let points: Vec<Point> = results
            .stiffness_n_m
            .iter()
            .zip(&curve.critical_rad_s)
            .filter_map(|(k, c)| Some((k.log10(), rpm((*c)?).log10())))
            .collect();
        let name = if named[sense] { String::new() } else { format!("critical, {}", curve.whirl.name()) };
        named[sense] = true;
        curves.push(Curve { name, stroke: [forward, backward][sense], points });
    }
    let inside: Vec<Point> = curves.iter().flat_map(|c| c.points.clone()).collect();
    let bounds = |of: fn(&Point) -> f64| {
        let values = inside.iter().map(of);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let (left, right) = bounds(|p| p.0);
    let (low, high) = bounds(|p| p.1);
    let fits = |p: &Point| left <= p.0 && p.0 <= right && low <= p.1 && p.1 <= high;
    for (k, of) in results.bearing_curves.iter().enumerate() {
        let positive = of.speed_rad_s.iter().zip(&of.stiffness_n_m).filter(|(s, v)| **s > 0.0 && **v > 0.0);
        let mut points: Vec<Point> = positive.map(|(s, v)| (v.log10(), rpm(*s).log10())).collect();
        if let ([only], Some(stiffness)) = (&points[..], of.stiffness_n_m.first()) {
            // one stiffness at all speeds
            points = vec![(stiffness.log10(), low), *only];
        }
        points.retain(&fits);
        let stroke = Stroke {
            color: palette::GREEN,
            width: 1.6,
            line: [LineStyle::DashDot, LineStyle::Dotted][k % 2],
        };
        let name =
            if k < NAMED_BEARINGS { format!("{} {}", of.bearing, of.direction) } else { String::new() };
        curves.push(Curve { name, stroke, points });
    }
    if let Some(o) = results.operating_speed {
        for (name, speed) in [("operating speed", o.minimum_rad_s), ("", o.maximum_rad_s)] {
            let y = rpm(speed).log10();
            let stroke = Stroke { color: palette::BLACK, width: 1.2, line: LineStyle::Dashed };
            if low <= y && y <= high {
                curves.push(Curve { name: name.to_owned(), stroke, points: vec![(left, y), (right, y)] });
            }
        }
    }
    let mut marks: Vec<Mark> = results
        .intersections
        .iter()
        .map(|i| Mark {
            name: String::new(),
            marker: Marker::Ring,
            color: palette::BLACK,
            at: (i.stiffness_n_m.log10(), rpm(i.speed_rad_s).log10()),
        })
        .filter(|m| fits(&m.at))
        .collect();
    if let Some(first) = marks.first_mut() {
        first.name = "bearing meets critical".to_owned();
    }
    let panel = Panel {
        across: ("Stiffness of the supports", "N/m"),
        up: ("Critical speed", "rpm"),
        curves,
        marks,
        decades: true,
        height: 640.0,
        ..Panel::default()
    };
    let remarks =
        "Undamped, in step with the rotation; the stiffness is the same along y and z at each support.";
    figure(&Surroundings::new(report, "Critical speed map", remarks.to_owned()), &[panel], 1)
}
