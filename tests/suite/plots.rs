//! Figures of synthetic results: well-formed, complete, inside their page, the same every time.

mod backend;
mod data;

use rotor::draw::{svg::SCALE, text::text_width};
use rotor::results::Figures;
use rotor::results::*;

/// The only figure of an analysis.
fn only(figures: rotor::Result<Figures>) -> rotor::Result<String> {
    figures.map(|figures| figures.into_iter().next().expect("a figure").1)
}

fn campbell_svg(report: &Report<rotor::results::Campbell>) -> rotor::Result<String> {
    only(rotor::plot::campbell::svg(report))
}

fn modes_svg(report: &Report<rotor::results::Modes>) -> rotor::Result<String> {
    only(rotor::plot::modes::svg(report))
}

fn tradeoff_svg(report: &Report<rotor::results::Tradeoff>) -> rotor::Result<String> {
    only(rotor::plot::tradeoff::svg(report))
}

/// A text and the box it takes: left, top, right, bottom.
type Label = (String, [f64; 4]);

/// Checks what holds for every figure and returns its texts.
fn checked(svg: &str) -> Vec<String> {
    labels(svg).into_iter().map(|(text, _)| text).collect()
}

/// Checks what holds for every figure and returns its texts with their boxes.
fn labels(svg: &str) -> Vec<Label> {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    let root = document.root_element();
    let page: Vec<f64> =
        root.attribute("viewBox").expect("a viewBox").split(' ').map(|n| n.parse().unwrap()).collect();
    for attribute in document.descendants().flat_map(|node| node.attributes()) {
        assert!(!attribute.value().contains("NaN"), "{attribute:?}");
        assert!(!attribute.value().contains("inf"), "{attribute:?}");
    }
    let mut texts = Vec::new();
    for node in document.descendants().filter(|node| node.has_tag_name("text")) {
        let text = node.text().unwrap_or_default().trim().to_owned();
        let number = |name: &str| inherited(node, name).unwrap().parse::<f64>().unwrap();
        let (x, y, size) = (number("x"), number("y"), number("font-size"));
        let width = text_width(&text, size);
        let before = match inherited(node, "text-anchor") {
            Some("middle") => width / 2.0,
            Some("end") => width,
            _ => 0.0,
        };
        // the baseline divides the height of a line
        let (above, below) = (0.76 * size, 0.24 * size);
        let place = match node.attribute("transform") {
            Some(_) => [x - above, y - width / 2.0, x + below, y + width / 2.0],
            None => [x - before, y - above, x - before + width, y + below],
        };
        let inside = place[0] >= 0.0 && place[1] >= 0.0 && place[2] <= page[2] && place[3] <= page[3];
        assert!(inside, "{text:?} takes {place:?} of {page:?}");
        texts.push((text, place));
    }
    texts
}

/// The value of an attribute where it stands or, if it does not, at the nearest group around.
fn inherited<'a>(node: roxmltree::Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.ancestors().find_map(|around| around.attribute(name))
}

/// Number of lines and areas in a colour, told by the unbroken parts of their paths.
fn painted(svg: &str, color: &str) -> usize {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    let paths = document.descendants().filter(|node| node.has_tag_name("path"));
    let shown =
        paths.filter(|node| ["stroke", "fill"].iter().any(|name| inherited(*node, name) == Some(color)));
    shown.map(|node| node.attribute("d").expect("a path").matches('M').count()).sum()
}

fn drawn(results: Campbell) -> Vec<String> {
    let names: Vec<String> = results.branches.iter().map(|branch| branch.name.clone()).collect();
    let report = data::report("A rotor", results);
    let svg = campbell_svg(&report).expect("a diagram");
    assert_eq!(svg, campbell_svg(&report).expect("the same diagram"));
    let texts = checked(&svg);
    for name in names {
        assert!(texts.iter().any(|text| text.contains(&name)), "{name} is missing");
    }
    texts
}

#[test]
fn texts_do_not_overlap() {
    let single = [523.6];
    let lone = [10.0, 42.0, 43.0, 80.0].into_iter().enumerate();
    let lone = lone.flat_map(|(index, hz)| data::pair(index + 1, hz, 0.05, 0.01, &single)).collect();
    let lone = data::campbell(single.to_vec(), lone, Vec::new());
    let diagrams = [data::rotor(), data::damped(), data::crowded(), lone];
    let figures = diagrams.map(|results| campbell_svg(&data::report("A rotor", results)).unwrap());
    let shapes = modes_svg(&data::report("A free tube", data::tube_modes())).unwrap();
    figures.iter().chain([&shapes]).for_each(|svg| do_not_overlap(&labels(svg)));
}

fn do_not_overlap(labels: &[Label]) {
    for (index, (text, a)) in labels.iter().enumerate() {
        for (other, b) in &labels[index + 1..] {
            let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
            assert!(apart, "{text:?} at {a:?} and {other:?} at {b:?}");
        }
    }
}

/// The figures of statics and spin-up, of real runs: names, units, what they must show.
#[test]
fn figures_of_statics_and_spin_up_are_complete() {
    use rotor::run::{Analysis, Host, run};
    type Figure<'a> = (&'a str, &'a [&'a str]);
    let wanted: [(&str, Analysis, &[Figure<'_>]); 4] = [
        (
            "rub-ring",
            Analysis::Spinup,
            &[
                ("spinup-rub.svg", &["Gap", "Normal force", "ring at 0.2 m", "N"]),
                ("orbit.svg", &["clearance of the ring", "largest radius"]),
                (
                    "forces.svg",
                    &[
                        "Force across the shaft",
                        "Force along y",
                        "supports.0 at 0 m",
                        "spinup.stators.0 at 0.2 m",
                    ],
                ),
            ],
        ),
        (
            "table5-cantilever",
            Analysis::Static,
            &[
                ("static.svg", &["Displacement"]),
                ("forces.svg", &["Shear", "Bending moment", "N m", "along y", "about z"]),
                ("section.svg", &["I1", "undeformed", "deformed", "displaced"]),
            ],
        ),
        (
            "table8-spin-circle",
            Analysis::Spinup,
            &[
                ("spinup.svg", &["Speed", "rpm", "Growth", "closed form", "Torque", "N m"]),
                ("orbit.svg", &["start", "end", "largest radius"]),
                ("section.svg", &["Cauchy stress", "Pa", "I2^(1/2)", "I3^(1/3)", "undeformed"]),
                ("energy.svg", &["kinetic", "strain", "work of the drive", "lost by the integrator", "J"]),
            ],
        ),
        (
            "iftomm-runup",
            Analysis::Spinup,
            &[
                ("orbit.svg", &["Displacement along y", "largest radius"]),
                ("section.svg", &["Displacement", "-0.1326"]),
            ],
        ),
    ];
    for (stem, analysis, figures) in wanted {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("cases/{stem}.json"));
        let case = rotor::case::Case::load(&path, &[]).unwrap();
        let finished = run(&case, analysis, &Host { plots: true, ..Host::silent() }).unwrap();
        for (name, words) in figures {
            let svg = &finished.plots.iter().find(|(file, _)| file == name).unwrap().1;
            let labels = labels(svg);
            do_not_overlap(&labels);
            let texts: Vec<String> = labels.into_iter().map(|(text, _)| text).collect();
            for word in *words {
                assert!(shows(&texts, word), "{stem} {name}: {word} in {texts:?}");
            }
        }
    }
}

fn of_scene(stem: &str, settings: serde_json::Value) -> Vec<(String, Vec<Label>)> {
    use rotor::run::{Analysis, Host, run};
    let case = crate::common::with(&crate::common::case(stem), serde_json::json!({ "contact": settings }));
    let finished = run(&case, Analysis::Contact, &Host { plots: true, ..Host::silent() }).unwrap();
    finished.plots.into_iter().map(|(name, svg)| (name, labels(&svg))).collect()
}

/// The figures of contact, of real runs: what they must show, and what has no place in them.
#[test]
fn figures_of_contact_are_complete() {
    type Figure<'a> = (&'a str, &'a [&'a str], &'a [&'a str]);
    let resting = serde_json::json!({});
    let cost: Figure<'_> = ("contact-cost.svg", &["search", "elements", "equations", " s, "], &[]);
    let wanted: [(&str, serde_json::Value, &[Figure<'_>]); 4] = [
        (
            "corner-to-side",
            serde_json::json!({ "until": 0.024, "snapshots": 4 }),
            &[
                ("contact-scene.svg", &["0.0240 s", "upper", "lower", "x (m)", "y (m)"], &["undeformed"]),
                ("contact-gap.svg", &["Smallest gap (m)", "Penetration", "Contact force", "Tinted"], &[]),
                ("contact-energy.svg", &["kinetic", "strain", "gravity", "contact springs"], &["work of"]),
                cost,
            ],
        ),
        (
            "corner-to-side",
            serde_json::json!({ "until": 0.001, "method": "none" }),
            &[
                ("contact-gap.svg", &["Smallest gap", "No contact."], &["Contact force", "Penetration"]),
                ("contact-energy.svg", &["kinetic"], &["strain", "contact springs"]),
            ],
        ),
        (
            "double-cantilever",
            resting.clone(),
            &[("contact-scene.svg", &["undeformed", "equilibrium", "upper", "lower"], &["seen in"]), cost],
        ),
        (
            "crossing-cantilevers",
            resting,
            &[("contact-scene.svg", &["seen in x-y", "seen in x-z", "z (m)"], &[]), cost],
        ),
    ];
    for (stem, settings, figures) in wanted {
        let drawn = of_scene(stem, settings);
        for (name, words, absent) in figures {
            let labels = &drawn.iter().find(|(file, _)| file == name).unwrap().1;
            do_not_overlap(labels);
            let texts: Vec<String> = labels.iter().map(|(text, _)| text.clone()).collect();
            words.iter().for_each(|word| assert!(shows(&texts, word), "{stem} {name}: {word} in {texts:?}"));
            absent.iter().for_each(|word| {
                assert!(!texts.iter().any(|text| text.starts_with(word)), "{stem} {name}: {word}");
            });
        }
    }
}

fn shows(texts: &[String], words: &str) -> bool {
    texts.iter().any(|text| text.contains(words))
}

#[test]
fn a_campbell_diagram_names_branches_orders_and_critical_speeds() {
    let texts = drawn(data::rotor());
    for words in
        ["1x", "2x", "Spin speed (rpm)", "Whirl frequency (Hz)", "620.13", "621.87", "10", "forward whirl"]
    {
        assert!(texts.iter().any(|text| text == words), "{words} is missing");
    }
    assert!(!shows(&texts, "unstable"));
    assert!(shows(&texts, "Modelled: gyroscopic moments"));
}

#[test]
fn instability_and_damping_are_marked_only_where_present() {
    let texts = drawn(data::damped());
    assert!(shows(&texts, "unstable") && shows(&texts, "damped (d)") && shows(&texts, "1F (d)"));
}

#[test]
fn more_critical_speeds_than_rows_are_counted() {
    let results = data::crowded();
    let more = format!("and {} more, see the report", results.critical_speeds.len() - 20);
    assert!(shows(&drawn(results), &more));
}

#[test]
fn a_rotating_frame_shows_its_own_excitation_lines() {
    let mut results = data::rotor();
    results.frame = "rotating";
    let texts = drawn(results);
    assert!(shows(&texts, "1x bwd") && shows(&texts, "gravity") && shows(&texts, "rotating frame"));
    assert!(!shows(&texts, "unstable range"));
}

/// A branch is drawn in the style of its sense at each speed, and the legend shows every sense that occurs.
#[test]
fn curves_change_style_where_the_sense_changes() {
    let speeds = data::speeds(1000.0, 11);
    let mut branch =
        data::branch("4B", Whirl::Backward, ModeKind::Bending, &speeds, |s| Some(80.0 + s / 100.0));
    let plain = data::campbell(speeds.clone(), vec![branch.clone()], Vec::new());
    let texts = drawn(plain.clone());
    assert!(
        shows(&texts, "backward whirl") && !shows(&texts, "forward whirl") && !shows(&texts, "mixed whirl")
    );
    for (index, whirl) in branch.whirl_at_speed.iter_mut().enumerate() {
        *whirl = [Whirl::Mixed, Whirl::Backward, Whirl::Forward][index.div_ceil(5)];
    }
    let changing = data::campbell(speeds, vec![branch], Vec::new());
    let texts = drawn(changing.clone());
    for words in ["backward whirl", "forward whirl", "mixed whirl, or in a plane"] {
        assert!(shows(&texts, words), "{words}");
    }
    let paths = |results: Campbell, color: &str| {
        painted(&campbell_svg(&data::report("A rotor", results)).expect("a diagram"), color)
    };
    let (blue, vermillion, green) = ("#005494", "#D55E00", "#009E73");
    assert_eq!([blue, green].map(|c| paths(plain.clone(), c)), [0, 0]);
    assert!(paths(plain, vermillion) > 0);
    assert!([blue, vermillion, green].into_iter().all(|c| paths(changing.clone(), c) > 0));
}

#[test]
fn unstable_ranges_are_shaded() {
    let mut results = data::rotor();
    let range = |from_rpm: f64, to_rpm: f64| UnstableRange {
        from_rad_s: from_rpm * std::f64::consts::PI / 30.0,
        to_rad_s: to_rpm * std::f64::consts::PI / 30.0,
        from_rpm,
        to_rpm,
        branch: "1F".to_owned(),
        largest_growth_rate_1_s: 2.0,
    };
    results.unstable_ranges = vec![range(2000.0, 2500.0), range(4000.0, 4000.1), range(9000.0, 20000.0)];
    let report = data::report("A rotor", results.clone());
    let svg = campbell_svg(&report).expect("a diagram");
    assert_eq!(painted(&svg, "#FCE4E2"), 4, "three ranges and the legend");
    assert!(shows(&drawn(results), "unstable range of speed"));
}

#[test]
fn odd_results_are_drawn_all_the_same() {
    let lone = [523.6];
    let one = |hz| data::branch("T1", Whirl::None, ModeKind::Torsion, &lone, move |_| hz);
    let beyond = data::critical(9e3, "T1", Whirl::None, ModeKind::Torsion, false);
    drawn(data::campbell(Vec::new(), Vec::new(), Vec::new()));
    drawn(data::campbell(data::speeds(1000.0, 11), Vec::new(), Vec::new()));
    drawn(data::campbell(vec![0.0], vec![one(Some(3.0))], Vec::new()));
    drawn(data::campbell(lone.to_vec(), vec![one(Some(120.0))], vec![beyond]));
    assert!(shows(
        &drawn(data::campbell(lone.to_vec(), vec![one(None)], Vec::new())),
        "Nowhere oscillating: T1"
    ));
    drawn(data::campbell(lone.to_vec(), vec![one(Some(f64::NAN))], Vec::new()));
    for top in [1e-300, 1e-3, 1e6, 1e300] {
        let speeds = data::speeds(top, 5);
        for hz in [0.0, 1e-12, 1.0, 1e9, 1e300] {
            let branches = data::pair(1, hz, 0.0, 0.1, &speeds).to_vec();
            let found = data::criticals(&branches, &speeds);
            drawn(data::campbell(speeds.clone(), branches, found));
        }
    }
}

#[test]
fn missing_values_break_the_line() {
    let speeds = data::speeds(100.0, 5);
    let lines = |gap: bool| {
        let hz = |speed: f64| (!gap || speed != 50.0).then_some(7.0);
        let branch = data::branch("1F", Whirl::Forward, ModeKind::Bending, &speeds, hz);
        let svg =
            campbell_svg(&data::report("", data::campbell(speeds.clone(), vec![branch], vec![]))).unwrap();
        painted(&svg, "#005494")
    };
    // One line in the legend, one or two in the diagram.
    assert_eq!((lines(false), lines(true)), (2, 3));
}

#[test]
fn many_branches_far_apart_do_not_squeeze_the_others() {
    let mut results = data::rotor();
    let high = data::branch("S1", Whirl::None, ModeKind::Section, &results.speeds_rad_s, |_| Some(40e3));
    results.branches.push(high);
    assert!(shows(&drawn(results), "Outside the diagram: S1"));
}

#[test]
fn titles_are_escaped_and_shortened() {
    let title = format!("<b>\"A\" & 'B'</b> \u{1}{}", "much too long ".repeat(40));
    let svg = campbell_svg(&data::report(&title, data::rotor())).unwrap();
    let texts = checked(&svg);
    assert!(texts[0].contains("<b>\"A\" & 'B'</b>"), "{}", texts[0]);
    assert!(texts[1].ends_with('…'), "{}", texts[1]);
    checked(&campbell_svg(&data::report(&"x".repeat(500), data::rotor())).unwrap());
    checked(&campbell_svg(&data::report("", data::rotor())).unwrap());
}

#[test]
fn failed_checks_are_not_hidden() {
    let mut report = data::report("A rotor", data::rotor());
    report.diagnostics.push(Diagnostic::error("lost", "a branch was lost"));
    assert!(shows(&checked(&campbell_svg(&report).unwrap()), "One check failed"));
}

fn drawn_modes(results: Modes) -> Vec<String> {
    let report = data::report("A free tube", results);
    let svg = modes_svg(&report).expect("a figure");
    assert_eq!(svg, modes_svg(&report).expect("the same figure"));
    checked(&svg)
}

#[test]
fn mode_shapes_show_twelve_and_count_the_others() {
    let texts = drawn_modes(data::tube_modes());
    for words in ["7: 161.27 Hz, bending, order 1", "18: 1935.2 Hz, section, order 4", "twist × outer radius"]
    {
        assert!(shows(&texts, words), "{words} is missing");
    }
    assert!(!shows(&texts, "19: "));
    assert!(shows(&texts, "Rigid modes left out: 6. Further modes not shown: 2."));
}

#[test]
fn odd_mode_shapes_are_drawn_all_the_same() {
    let none = Modes { rigid_modes: 0, modes: Vec::new(), sturm_count_agrees: false };
    let texts = drawn_modes(none);
    assert!(shows(&texts, "No elastic modes") && shows(&texts, "Sturm count disagrees"));
    let huge = data::shape(|_| [f64::NAN, 1e300, 0.0], |_| 1e300, |_, _| [0.0, 1e200, f64::INFINITY]);
    let still = data::shape(|_| [0.0; 3], |_| 0.0, |_, _| [0.0; 3]);
    let ragged = ModeShape { outlines: vec![vec![[0.0, 0.0]], Vec::new()], x_m: vec![1.0], ..still.clone() };
    let shapes = [huge, still, ragged, ModeShape::default()];
    let modes = shapes.into_iter().enumerate().flat_map(|(index, shape)| {
        [ModeKind::Bending, ModeKind::Torsion, ModeKind::Axial]
            .map(|kind| data::mode(index + 1, f64::NAN, kind, 1, shape.clone()))
    });
    drawn_modes(Modes { rigid_modes: 0, modes: modes.collect(), sturm_count_agrees: true });
}

#[test]
fn curves_keep_fractions_of_a_pixel() {
    let svg = campbell_svg(&data::report("A rotor", data::rotor())).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let root = document.root_element();
    let shown: f64 = root.attribute("width").unwrap().parse().unwrap();
    assert!(root.attribute("viewBox").unwrap().starts_with(&format!("0 0 {} ", shown * SCALE)));
}

/// A study of `members` elements on `meshes` meshes, and whether the errors crowd together.
fn study(members: usize, meshes: usize, crowded: bool, target: Option<f64>) -> Report<Tradeoff> {
    use rotor::study::design::{ComparedWith, Measured, Measurement, Subject, tradeoff};
    let mut points = Vec::new();
    for member in 0..members {
        for mesh in 0..meshes {
            let (member, mesh) = (member as f64, mesh as f64);
            let (time, fall) = if crowded { (0.02 * mesh, 0.05) } else { (mesh, 1.5) };
            let error = (-2.0 - fall * mesh - 0.3 * member).exp();
            let settings = serde_json::json!({
                "shaft.element": format!("34X{member}"),
                "shaft.segments.0.elements": (mesh as u64 + 1),
                "spinup.integrator": "implicit",
                "spinup.frame": "rotating"
            });
            let measurement = Measurement {
                value: 2.0 * (1.0 + error),
                wall_s: vec![0.01 * (time + 0.4 * member).exp()],
                degrees_of_freedom: 100 * mesh as u64,
                ..Measurement::default()
            };
            let settings = settings.as_object().expect("settings").clone();
            points.push(Measured { settings, outcome: Ok(measurement) });
        }
    }
    let subject = Subject {
        analysis: rotor::run::Analysis::Spinup,
        quantity: "results.final.growth_m.0".to_owned(),
        machine: Machine { processor: "A processor".to_owned(), cores: 2 },
        repeats: 3,
        points_at_a_time: 1,
        reference: ComparedWith::Number(2.0),
        target,
    };
    let (results, diagnostics) = tradeoff(&subject, &points);
    let mut report = data::report("A study", results);
    report.diagnostics = diagnostics;
    report
}

#[test]
fn studies_name_their_front_without_overlaps() {
    for (members, meshes, crowded) in
        [(7, 6, false), (9, 5, true), (3, 40, true), (1, 40, false), (1, 1, false), (2, 1, true)]
    {
        for target in [None, Some(1e-3), Some(0.5), Some(1e-30)] {
            let report = study(members, meshes, crowded, target);
            let svg = tradeoff_svg(&report).expect("a figure");
            let labels = labels(&svg);
            do_not_overlap(&labels);
            let has = |words: &str| labels.iter().any(|(text, _)| text.contains(words));
            assert!(has("Wall time (s)") && has("Relative error") && has("34X0"), "{labels:?}");
            assert_eq!(has("error asked for"), target.is_some());
            assert_eq!(has("chosen"), report.results.choice.is_some());
        }
    }
    let empty = tradeoff_svg(&study(0, 0, false, None)).expect("a figure");
    assert!(checked(&empty).iter().any(|text| text == "No point has an error to draw."));
}
