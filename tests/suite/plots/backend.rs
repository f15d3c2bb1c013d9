//! SVG as a backend of plotters: what it writes for each word, of plotters' own figures too, and how long its files are.

use plotters::drawing::IntoDrawingArea;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::style::{BLACK, BLUE, Color, IntoFont, RED, TextStyle, WHITE};
use plotters_backend::DrawingBackend;
use rotor::draw::clip::{distance, simplified};
use rotor::draw::palette::{self, LineStyle, Stroke};
use rotor::draw::sheet::figure;
use rotor::draw::svg::Svg;
use rotor::draw::text::Anchor;

/// What a backend writes.
fn written(paint: impl FnOnce(&mut Svg)) -> String {
    let mut text = String::new();
    let mut svg = Svg::with_string(&mut text, (400, 300));
    paint(&mut svg);
    svg.present().expect("written");
    text
}

/// The tags inside the figure, a line each.
fn inside(paint: impl FnOnce(&mut Svg)) -> Vec<String> {
    let text = written(paint);
    roxmltree::Document::parse(&text).expect("well-formed XML");
    let lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[1..lines.len() - 1].to_vec()
}

#[test]
fn a_line_is_one_path_of_steps() {
    let line = |svg: &mut Svg| svg.draw_path([(10, 20), (15, 20), (15, 8), (12, 9), (13, 9)], &BLUE).unwrap();
    assert_eq!(inside(line), [r##"<path d="M10 20h5v-12l-3 1h1" fill="none" stroke="#00F"/>"##]);
    let square = |svg: &mut Svg| svg.draw_rect((0, 0), (7, 9), &RED, true).unwrap();
    assert_eq!(inside(square), [r##"<path d="M0 0h7v9h-7z" fill="#F00"/>"##]);
    let closed = |svg: &mut Svg| svg.draw_outline([(0, 0), (7, 0), (0, 9), (0, 0)], &BLACK);
    assert_eq!(inside(closed), [r##"<path d="M0 0h7l-7 9z" fill="none" stroke="#000"/>"##]);
    let nothing = |svg: &mut Svg| svg.draw_path([(0, 0), (9, 9)], &BLACK.mix(0.0)).unwrap();
    assert!(inside(nothing).is_empty());
    let faint = |svg: &mut Svg| svg.draw_pixel((2, 3), BLACK.mix(0.5).to_backend_color()).unwrap();
    assert_eq!(inside(faint), [r##"<path d="M2 3h1v1h-1z" fill-opacity="0.5"/>"##]);
}

#[test]
fn dashes_are_an_attribute() {
    let dashed = |svg: &mut Svg| {
        svg.set_dashes([90, 50]);
        svg.draw_path([(0, 0), (300, 0)], &BLACK.stroke_width(2)).unwrap();
        svg.draw_path([(0, 9), (300, 9)], &BLACK.stroke_width(2)).unwrap();
        svg.set_dashes([]);
        svg.draw_path([(0, 20), (300, 20)], &BLACK.stroke_width(2)).unwrap();
    };
    let svg = written(dashed);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let paths: Vec<_> = document.descendants().filter(|node| node.has_tag_name("path")).collect();
    let of = |name: &str| paths.iter().map(|node| super::inherited(*node, name)).collect::<Vec<_>>();
    // lines in the same look are one path, and each has its dashes
    assert_eq!(of("d"), [Some("M0 0h300M0 9h300"), Some("M0 20h300")]);
    assert_eq!(of("stroke-dasharray"), [Some("90 50"), None]);
    assert_eq!(of("stroke-width"), [Some("2"), Some("2")]);
}

#[test]
fn groups_have_a_class_and_a_title() {
    let lines = inside(|svg| {
        svg.open_group("branch", "1F: <3 & \"more\" \u{1}");
        svg.draw_circle((5, 5), 3, &RED, true).unwrap();
        svg.open_group("empty", "nothing");
        svg.close_group();
        svg.close_group();
        svg.close_group();
    });
    let title = r##"<g class="branch"><title>1F: &lt;3 &amp; &quot;more&quot;</title>"##;
    assert_eq!(lines, [title, r##"<circle cx="5" cy="5" r="3" fill="#F00"/>"##, "</g>"]);
    let open = written(|svg| {
        svg.open_group("never", "closed");
        svg.draw_circle((5, 5), 3, &RED, true).unwrap();
    });
    roxmltree::Document::parse(&open).expect("a group that stays open is closed at the end");
}

/// What shapes share stands at their group, and none of them looks different for that.
#[test]
fn shapes_look_the_same_wherever_their_attributes_stand() {
    let svg = written(|svg| {
        for k in 0..4 {
            svg.open_group("row", "");
            svg.draw_circle((10 * k, 5), 3, &RED, true).unwrap();
            svg.draw_circle((10 * k, 9), 3, if k == 2 { &BLACK } else { &RED }, true).unwrap();
            svg.draw_path([(0, k), (9, k)], &BLUE).unwrap();
            let style = TextStyle::from(("sans-serif", 12 + k).into_font()).color(&RED);
            svg.draw_text("word", &style, (3, k)).unwrap();
            svg.close_group();
        }
    });
    let document = roxmltree::Document::parse(&svg).unwrap();
    let look = |tag: &str, name: &str| -> Vec<String> {
        let nodes = document.descendants().filter(|node| node.has_tag_name(tag));
        nodes.map(|node| super::inherited(node, name).unwrap_or("unset").to_owned()).collect()
    };
    let fills = look("circle", "fill");
    assert!(fills.iter().enumerate().all(|(k, fill)| fill == if k == 5 { "#000" } else { "#F00" }), "{svg}");
    assert!(
        look("circle", "stroke").iter().all(|stroke| ["none", "unset"].contains(&stroke.as_str())),
        "{svg}"
    );
    assert_eq!(look("path", "stroke"), ["#00F"; 4]);
    assert_eq!(look("path", "fill"), ["none"; 4]);
    assert_eq!(look("text", "font-size"), ["12", "13", "14", "15"]);
    assert_eq!(look("text", "fill"), ["#F00"; 4]);
    assert_eq!(svg.matches("sans-serif").count(), 1);
}

#[test]
fn text_stays_text() {
    let lines = inside(|svg| {
        let style = TextStyle::from(("sans-serif", 100).into_font());
        svg.draw_text("a < b & 'c' \u{0}\u{ffff}ü…", &style, (30, 40)).unwrap();
        svg.draw_text(" \u{2} ", &style, (30, 40)).unwrap();
    });
    let text =
        r##"<text x="30" y="116" font-family="sans-serif" font-size="100">a &lt; b &amp; 'c'   ü…</text>"##;
    assert_eq!(lines, [text]);
    assert_eq!(
        written(|svg| assert_eq!(svg.get_size(), (400, 300))).matches("viewBox=\"0 0 400 300\"").count(),
        1
    );
}

/// Plotters' own words reach the backend.
#[test]
fn plotters_draws_on_it() {
    let mut text = String::new();
    {
        let area = Svg::with_string(&mut text, (400, 300)).into_drawing_area();
        area.fill(&WHITE).unwrap();
        area.draw(&PathElement::new(vec![(0, 0), (10, 30), (20, 0)], BLUE.stroke_width(3))).unwrap();
        area.draw(&Circle::new((50, 50), 8, RED.filled())).unwrap();
        area.draw(&Rectangle::new([(60, 60), (90, 80)], BLACK)).unwrap();
        area.draw(&Text::new("a < b", (10, 90), ("sans-serif", 12).into_font())).unwrap();
        area.titled("Title", ("sans-serif", 20)).unwrap();
        area.present().unwrap();
    }
    let document = roxmltree::Document::parse(&text).expect("well-formed XML");
    let words: Vec<_> =
        document.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).collect();
    assert_eq!(words, ["a < b", "Title"]);
    assert!(
        text.contains("M0 0l10 30 10-30") && text.contains("<circle") && text.contains("M60 60h30v20h-30z")
    );
}

#[test]
fn the_same_calls_give_the_same_bytes() {
    let draw = || {
        figure(300.0, 200.0, |pen| {
            pen.group("curve", "one", |pen| {
                for (k, line) in
                    [LineStyle::Solid, LineStyle::Dashed, LineStyle::Dotted].into_iter().enumerate()
                {
                    let y = 20.0 * k as f64 + 0.123_456_789;
                    pen.path(
                        &[(0.1, y), (99.9, y), (150.0, 0.0)],
                        Stroke { color: palette::BLUE, width: 1.1, line },
                    );
                }
            });
            pen.text((1.0, 2.0), "words", palette::Font::new(12.5), Anchor::Right);
        })
    };
    let first = draw().expect("a figure");
    assert_eq!(first, draw().expect("the same figure"));
    roxmltree::Document::parse(&first).expect("well-formed XML");
    assert!(!first.contains("99999") && !first.contains("00001"), "{first}");
}

/// Points that are left out lie where the curve is drawn without them.
#[test]
fn a_simplified_curve_passes_by_all_points() {
    let wave: Vec<(f64, f64)> =
        (0..2000).map(|k| (0.1 * f64::from(k), 40.0 * (0.02 * f64::from(k)).sin())).collect();
    let short = simplified(&wave, 0.1);
    assert!(short.len() < 200 && short.first() == wave.first() && short.last() == wave.last());
    for point in &wave {
        let far = short.windows(2).map(|ends| {
            let length = distance(ends[0], ends[1]);
            // height of the triangle over the segment, or an edge of it beyond the segment
            let (a, b) = (distance(ends[0], *point), distance(ends[1], *point));
            let along = (length * length + a * a - b * b) / (2.0 * length);
            if (0.0..=length).contains(&along) { (a * a - along * along).max(0.0).sqrt() } else { a.min(b) }
        });
        assert!(far.fold(f64::INFINITY, f64::min) <= 0.1 + 1e-6, "{point:?}");
    }
    assert_eq!(simplified(&[(0.0, 0.0), (5.0, 0.0), (0.0, 0.0)], 0.1).len(), 3);
    assert_eq!((simplified(&[], 0.1).len(), simplified(&[(1.0, 1.0)], 0.1).len()), (0, 1));
}

/// Branches and critical speeds say on hover what they are, and groups have names.
#[test]
fn a_campbell_diagram_tells_its_parts() {
    let report = super::data::report("A rotor", super::data::rotor());
    let svg = rotor::plot::campbell::svg(&report).expect("a diagram").remove(0).1;
    let document = roxmltree::Document::parse(&svg).unwrap();
    let titles = |class: &str| -> Vec<String> {
        let groups = document.descendants().filter(|n| n.attribute("class") == Some(class));
        let titles = |n: roxmltree::Node<'_, '_>| -> String {
            n.children().filter(|t| t.has_tag_name("title")).filter_map(|t| t.text()).collect()
        };
        groups.map(titles).collect()
    };
    for class in
        ["title", "grid", "axes", "axis", "order", "branch", "critical", "names", "legend", "table", "footer"]
    {
        assert!(!titles(class).is_empty(), "{class}");
    }
    let branches = titles("branch");
    for branch in &report.results.branches {
        let start = format!("{}: ", branch.name);
        assert!(branches.iter().any(|t| t.starts_with(&start) && t.ends_with(" Hz at rest")), "{branches:?}");
    }
    let criticals = titles("critical");
    assert_eq!(criticals.len(), report.results.critical_speeds.len());
    assert!(criticals.iter().any(|t| t.contains("620.13 rpm (")), "{criticals:?}");
}

/// Bytes of the figures of real runs, at most a third of what they took when dashes were lines of their own.
#[test]
fn files_are_short() {
    use rotor::run::Analysis;
    let before = [
        ("two-disk-stepped", Analysis::Campbell, "campbell.svg", 69_198),
        ("table3-tube", Analysis::Modes, "modes.svg", 120_204),
        ("table5-cantilever", Analysis::Static, "section.svg", 77_163),
    ];
    for (stem, analysis, name, bytes) in before {
        let kept = crate::common::report(&crate::common::case(stem), analysis);
        let finished = kept.get().expect("a report");
        let svg = &finished.plots.iter().find(|(file, _)| file == name).expect("a figure").1;
        assert!(3 * svg.len() <= bytes, "{stem} {name}: {} of {bytes} bytes", svg.len());
    }
}
