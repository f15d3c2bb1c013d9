//! Bad contact scenes, as users run them: bad input ends with exit code 2, path, value and remedy, and nothing is written; a run
//! that does not succeed with exit code 1, what was tried and what to change, and a report of what was done.

use crate::cli::{files, read, rotor, text};
use serde_json::{Value, json};

/// Two soft bars, one 0.1 m above the other, which comes down at 1 m/s.
fn bars() -> Value {
    json!({
        "title": "bars",
        "materials": { "soft": { "E": 2.07e7, "nu": 0.3, "rho": 7850 } },
        "sections": {
            "bar": { "shape": "rectangle", "height": 0.1, "width": 0.1 },
            "round": { "shape": "circle", "radius": 0.05 }
        },
        "bodies": [
            { "name": "lower", "length": 1, "elements": 4, "section": "bar", "material": "soft", "start": [0, 0] },
            { "name": "upper", "length": 1, "elements": 4, "section": "bar", "material": "soft", "start": [0.1, 0.2],
              "velocity": [0, -1] }
        ],
        "contact": { "method": "penalty", "until": 0.01, "step": 1e-3 }
    })
}

/// Two cantilevers in space, 0.1 m apart.
fn rods() -> Value {
    let rod = |name: &str, start: Value| {
        json!({ "name": name, "element": "34X3", "length": 1, "elements": 2, "section": "round", "material": "soft",
            "start": start, "supports": [{ "at": 0, "kind": "clamped" }] })
    };
    let mut scene = bars();
    scene["bodies"] = json!([rod("lower", json!([0, 0, 0])), rod("upper", json!([0.1, 0.2, 0]))]);
    scene["contact"] = json!({ "method": "penalty" });
    scene
}

/// The scene with values at dotted paths; null removes a key.
fn with(mut scene: Value, set: &Value) -> Value {
    for (path, value) in set.as_object().expect("overrides") {
        let (parent, key) = path.rsplit_once('.').unwrap_or(("", path));
        let pointer =
            if parent.is_empty() { String::new() } else { format!("/{}", parent.replace('.', "/")) };
        let parent = scene.pointer_mut(&pointer).unwrap_or_else(|| panic!("{path}"));
        match (value, parent) {
            (Value::Null, Value::Object(map)) => drop(map.shift_remove(key)),
            (value, Value::Array(list)) => list[key.parse::<usize>().expect("a place")] = value.clone(),
            (value, parent) => parent[key] = value.clone(),
        }
    }
    scene
}

/// Exit code, messages and report of a command on a scene.
fn run(command: &str, scene: &str) -> (i32, String, Option<Value>) {
    let folder = tempfile::tempdir().expect("folder");
    std::fs::write(folder.path().join("scene.json"), scene).expect("written");
    let got = rotor(folder.path(), &[command, "scene.json", "--out", "o", "--no-plots", "--quiet"]);
    let code = got.status.code().unwrap_or_else(|| panic!("ended by a signal: {scene}"));
    if code == 2 {
        assert_eq!(files(folder.path()), ["scene.json"], "written on bad input");
        return (code, text(&got.stderr), None);
    }
    let path = folder.path().join("o").join(format!("{command}.json"));
    (code, text(&got.stderr), Some(serde_json::from_str(&read(path)).expect("JSON")))
}

/// Exit code 2 with a path, and words of the problem, the value or what is allowed.
fn refused(scene: &Value, path: &str, words: &[&str]) -> String {
    let (code, message, _) = run("contact", &scene.to_string());
    assert_eq!(code, 2, "{path}: {message}");
    assert!(message.starts_with(&format!("error: scene.json: at `{path}`: ")), "{path}: {message}");
    for word in words.iter().chain(&["found:   ", "allowed: "]) {
        assert!(message.contains(word), "{path}: no {word:?} in {message}");
    }
    message
}

/// Exit code 0 and the results.
fn done(scene: &Value) -> Value {
    let (code, message, report) = run("contact", &scene.to_string());
    assert_eq!(code, 0, "{message}");
    report.expect("a report")["results"].clone()
}

/// Exit code 1 with words of what was tried and what to change; the results say that they are not whole.
fn failed(scene: &Value, words: &[&str]) -> Value {
    let (code, message, report) = run("contact", &scene.to_string());
    assert_eq!(code, 1, "{message}");
    let report = report.expect("a report");
    let errors: Vec<&str> = report["diagnostics"]
        .as_array()
        .expect("list")
        .iter()
        .filter_map(|d| d["message"].as_str())
        .collect();
    for word in words.iter().chain(&["tried:", "remedy:"]) {
        assert!(
            message.contains(word) && errors.iter().any(|e| e.contains(word)),
            "no {word:?} in {message}"
        );
    }
    assert_eq!(report["results"]["converged"], false);
    report["results"].clone()
}

#[test]
fn the_scenes_of_these_tests_are_valid() {
    assert_eq!(done(&bars())["converged"], true);
    assert_eq!(done(&rods())["converged"], true);
}

/// `(what is changed, path in the message, words in the message)`.
type Fault = (Value, &'static str, &'static [&'static str]);

fn refuse_all(scene: fn() -> Value, faults: Vec<Fault>) {
    for (set, path, words) in faults {
        refused(&with(scene(), &set), path, words);
    }
}

#[test]
fn settings_of_contact_are_checked() {
    let table: Vec<Fault> = vec![
        (json!({ "contact.penalty": -1 }), "contact.penalty", &["must be positive", "found:   -1"]),
        (json!({ "contact.penalty": 0 }), "contact.penalty", &["must be positive", "found:   0"]),
        (json!({ "contact.penalty": "5 GPa" }), "contact.penalty", &["5 GPa", "stress"]),
        (
            json!({ "contact.point_penalty": -2.5 }),
            "contact.point_penalty",
            &["must be positive", "found:   -2.5"],
        ),
        (json!({ "contact.point_penalty": 0 }), "contact.point_penalty", &["must be positive"]),
        (json!({ "contact.penality": 1 }), "contact.penality", &["did you mean \"penalty\"?"]),
        (json!({ "contact.method": "friction" }), "contact.method", &["\"friction\"", "active-set"]),
        (
            json!({ "contact.self": true, "bodies.1.elements": 2 }),
            "contact.self",
            &["`upper` can't touch itself", "2 elements", "at least 4 elements", "found:   true"],
        ),
        (
            json!({ "contact.self": true, "bodies.0.length": 0.5 }),
            "contact.self",
            &["`lower` can't touch itself", "5.000 heights"],
        ),
        // a method that does not go with the analysis
        (
            json!({ "contact.method": "active-set" }),
            "contact.method",
            &["finds equilibria", "no contact.until"],
        ),
        (
            json!({ "contact.method": "lcp", "contact.until": null }),
            "contact.method",
            &["a motion", "contact.until for a motion"],
        ),
        (json!({ "contact.method": "lcp-single", "contact.until": null }), "contact.method", &["a motion"]),
        (
            json!({ "contact.method": "lcp", "contact.integrator": "energy-consistent" }),
            "contact.integrator",
            &["semi-implicit-euler; or the method penalty"],
        ),
        // time
        (json!({ "contact.until": -1 }), "contact.until", &["must be positive", "found:   -1"]),
        (json!({ "contact.until": 0 }), "contact.until", &["must be positive"]),
        (json!({ "contact.step": 0 }), "contact.step", &["must be positive"]),
        (
            json!({ "contact.step": "20 ms" }),
            "contact.step",
            &["does not fit the motion", "\"20 ms\"", "1e-10 s to 1e-2 s"],
        ),
        (json!({ "contact.step": 1e-12 }), "contact.step", &["does not fit the motion"]),
        // counts
        (json!({ "contact.segments": 0 }), "contact.segments", &["1 to 1000"]),
        (json!({ "contact.segments": 4_000_000_000_u64 }), "contact.segments", &["4000000000", "1 to 1000"]),
        (
            json!({ "contact.segments": 1000, "bodies.0.elements": 19_000 }),
            "contact.segments",
            &["19004 elements", "1 to 52"],
        ),
        (json!({ "contact.output": 0 }), "contact.output", &["2 to 1000000"]),
        (json!({ "contact.output": 2_000_000 }), "contact.output", &["2 to 1000000"]),
        (json!({ "contact.snapshots": 0 }), "contact.snapshots", &["1 to 12"]),
        (json!({ "contact.load_steps": 0 }), "contact.load_steps", &["1 to 100000"]),
        (json!({ "contact.corner_angle": "91 deg" }), "contact.corner_angle", &["0 to 90 deg"]),
        (json!({ "contact": null }), "contact", &["no `contact` block", "for example"]),
    ];
    refuse_all(bars, table);
}

#[test]
fn bodies_are_checked() {
    let structural = json!({ "EA": 1, "GA": 1, "EI": 1, "EA_t": 1, "rho_A": 1, "rho_I": 1, "height": 0.1 });
    let table: Vec<Fault> = vec![
        (json!({ "bodies": [] }), "bodies", &["needs bodies", "for example"]),
        (json!({ "bodies.0.elements": 0 }), "bodies.0.elements", &["needs elements", "1 to 20000"]),
        (
            json!({ "bodies.0.elements": 1_000_000_000 }),
            "bodies.0.elements",
            &["too many", "1000000000", "1 to 20000"],
        ),
        (json!({ "bodies.0.elements": 20_000 }), "bodies", &["too large: 20004 elements", "at most 20000"]),
        (
            json!({ "bodies.0.length": 0.09 }),
            "bodies.0.length",
            &["shorter than high", "at least its height, 0.1 m"],
        ),
        (json!({ "bodies.0.length": -1 }), "bodies.0.length", &["must be positive"]),
        (json!({ "bodies.0.element": "34X4" }), "bodies.0.element", &["\"34X4\"", "2322s, 3333s or 34X3"]),
        (json!({ "bodies.0.name": "upper" }), "bodies.1.name", &["two bodies have this name"]),
        (json!({ "bodies.0.section": "beam" }), "bodies.0.section", &["no section \"beam\"", "bar, round"]),
        (json!({ "bodies.0.section": "round" }), "bodies.0.section", &["rectangular", "shape rectangle"]),
        (
            json!({ "bodies.0.material": "steel" }),
            "bodies.0.material",
            &["no material \"steel\"", "allowed: soft"],
        ),
        (
            json!({ "bodies.0.material": null }),
            "bodies.0",
            &["no stiffness", "section and material, or structural"],
        ),
        (json!({ "bodies.0.structural": structural }), "bodies.0.structural", &["one of both"]),
        (json!({ "materials.soft.damping": { "mass": 1 } }), "bodies.0.material", &["no damping"]),
        (json!({ "bodies.0.start": [0, 0, 0] }), "bodies.0.start", &["[0,0,0]", "two numbers [x, y]"]),
        (json!({ "bodies.0.start": [0] }), "bodies.0.start", &["two numbers [x, y]"]),
        (json!({ "bodies.0.start": [0, 1e16] }), "bodies.0.start.1", &["extreme", "1e15"]),
        (json!({ "bodies.0.start": ["NaN m", 0] }), "bodies.0.start.0", &["NaN m"]),
        (json!({ "bodies.1.velocity": [0, "inf m/s"] }), "bodies.1.velocity.1", &["inf m/s"]),
        (json!({ "bodies.1.velocity": [0, 0, 1] }), "bodies.1.velocity", &["two numbers [x, y]"]),
        (json!({ "bodies.0.direction": [1, 0, 0] }), "bodies.0.direction", &["a planar body has an angle"]),
        (json!({ "gravity": [0, 0, -9.81] }), "gravity.2", &["plane of x and y", "-9.81"]),
        // supports and loads
        (
            json!({ "bodies.0.supports": [{ "at": 0.3, "kind": "clamped" }] }),
            "bodies.0.supports.0.at",
            &["there is no node", "0.3", "a multiple of 0.125 m"],
        ),
        (
            json!({ "bodies.0.supports": [{ "at": 1.5, "kind": "clamped" }] }),
            "bodies.0.supports.0.at",
            &["off the body", "0 to 1 m"],
        ),
        (
            json!({ "bodies.0.supports": [{ "at": 0, "kind": "pinned" }, { "at": 0, "kind": "pinned-x" }] }),
            "bodies.0.supports.1",
            &["`bodies.0.supports.0` holds this place"],
        ),
        (
            json!({ "bodies.0.supports": [{ "at": 0, "kind": "revolute" }] }),
            "bodies.0.supports.0.kind",
            &["\"revolute\"", "clamped"],
        ),
        (
            json!({ "bodies.0.loads": [{ "pressure": 5 }] }),
            "bodies.0.loads.0",
            &["incomplete or mixed", "face with pressure"],
        ),
        (json!({ "bodies.0.loads": [{ "face": "top" }] }), "bodies.0.loads.0", &["incomplete or mixed"]),
        (
            json!({ "bodies.0.loads": [{ "at": 0, "face": "top", "pressure": 5 }] }),
            "bodies.0.loads.0",
            &["incomplete or mixed"],
        ),
        (
            json!({ "bodies.0.loads": [{ "at": 0, "force": [0, 1], "moment": 1 }] }),
            "bodies.0.loads.0",
            &["incomplete or mixed"],
        ),
        (
            json!({ "bodies.0.loads": [{ "at": 0.3, "force": [0, 1] }] }),
            "bodies.0.loads.0.at",
            &["there is no node"],
        ),
        (
            json!({ "bodies.0.loads": [{ "at": 0, "force": [0, 1, 0] }] }),
            "bodies.0.loads.0.force",
            &["two numbers"],
        ),
        (
            json!({ "bodies.0.loads": [{ "at": 0, "moment": 1, "until": -1 }] }),
            "bodies.0.loads.0.until",
            &["must be positive"],
        ),
    ];
    refuse_all(bars, table);
}

#[test]
fn spatial_bodies_are_checked() {
    let table: Vec<Fault> = vec![
        (json!({ "bodies.0.section": "bar" }), "bodies.0.section", &["solid circle", "shape circle"]),
        (json!({ "bodies.0.element": "2322s" }), "bodies.0.section", &["rectangular"]),
        (
            json!({ "bodies.0.loads": [{ "at": 0, "moment": 1 }] }),
            "bodies.0.loads.0",
            &["forces only", "force [x, y, z]"],
        ),
        (
            json!({ "bodies.0.loads": [{ "face": "top", "pressure": 1 }] }),
            "bodies.0.loads.0",
            &["forces only"],
        ),
        (json!({ "bodies.0.start": [0, 0] }), "bodies.0.start", &["three numbers [x, y, z]"]),
        (json!({ "bodies.0.direction": [0, 0, 0] }), "bodies.0.direction", &["no direction", "not all zero"]),
        (
            json!({ "bodies.0.direction": [0, 1, 0], "bodies.0.angle": 0.3 }),
            "bodies.0.angle",
            &["one of both"],
        ),
        (
            json!({ "bodies.0.supports": [{ "at": 0, "kind": "pinned" }] }),
            "bodies.0.supports.0.kind",
            &["clamped"],
        ),
        (
            json!({ "bodies.0.supports": [{ "at": 0.25, "kind": "clamped" }] }),
            "bodies.0.supports.0.at",
            &["no node"],
        ),
        // the path is that of the scene, not of the shaft that the body is made of
        (json!({ "bodies.0.elements": 20_000 }), "bodies.0.elements", &["GB of memory", "found:   20000"]),
        (json!({ "bodies.0.elements": 4000 }), "bodies", &["too large: 4002 elements", "at most 4000"]),
        (json!({ "bodies.1": bars()["bodies"][1] }), "bodies", &["planar and spatial", "all 2322s"]),
        (json!({ "contact.until": 1 }), "contact.until", &["equilibrium only"]),
        (json!({ "contact.method": "active-set" }), "contact.method", &["meet by penalty"]),
        (json!({ "contact.self": true }), "contact.self", &["each other only", "false"]),
    ];
    refuse_all(rods, table);
}

/// Texts that are no numbers for JSON.
#[test]
fn numbers_that_are_none_are_refused() {
    for word in ["NaN", "1e999", "-Infinity"] {
        let scene = bars().to_string().replace("[0.1,0.2]", &format!("[0.1,{word}]"));
        assert!(scene.contains(word));
        let (code, message, _) = run("contact", &scene);
        assert!(code == 2 && message.contains("scene.json:1:"), "{code}: {message}");
    }
}

/// What belongs to a shaft is not dropped silently, and the other way round.
#[test]
fn blocks_of_the_other_kind_of_case_are_refused() {
    for (key, value) in [
        ("disks", json!([{ "at": 0, "mass": 1, "polar_inertia": 1, "diametral_inertia": 1 }])),
        ("supports", json!([{ "at": 0, "kind": "clamped" }])),
        ("loads", json!([{ "at": 0, "force": [0, 1, 0] }])),
        ("probes", json!([{ "name": "tip", "at": 1 }])),
        ("modes", json!({ "count": 4 })),
        ("campbell", json!({ "speeds": { "from": 0, "to": 10, "count": 3 } })),
        ("static", json!({ "load_steps": 2 })),
        ("spinup", json!({ "drive": [{ "until": 1, "speed": 0 }] })),
    ] {
        refused(&with(bars(), &json!({ key: value })), key, &["belongs to a shaft", "bodies", "contact"]);
    }
    let segment = json!({ "length": 1, "elements": 2, "section": "round", "material": "soft" });
    let both = with(bars(), &json!({ "shaft": { "segments": [segment] } }));
    refused(&both, "bodies", &["either a shaft or bodies"]);
    let shaft = with(both, &json!({ "bodies": null }));
    let (code, message, _) = run("modes", &shaft.to_string());
    assert!(code == 2 && message.contains("at `contact`") && message.contains("spinup.stators"), "{message}");
}

/// What is written without being of use is named in the report.
#[test]
fn settings_without_use_are_named() {
    for (scene, words) in [
        (
            with(bars(), &json!({ "contact.load_steps": 3 })),
            vec!["contact.load_steps; a motion has no load steps"],
        ),
        (
            with(bars(), &json!({ "contact.method": "lcp", "contact.penalty": 1e9, "contact.segments": 3 })),
            vec!["contact.penalty, contact.segments; impulses act at nodes"],
        ),
        (
            with(
                rods(),
                &json!({ "contact.step": 1e-3, "contact.cut": true, "bodies.1.velocity": [0, -1, 0] }),
            ),
            vec![
                "contact.step, bodies.1.velocity; an equilibrium has no time",
                "contact.cut; segments of spatial",
            ],
        ),
    ] {
        let (code, message, report) = run("contact", &scene.to_string());
        assert_eq!(code, 0, "{message}");
        let remarks = report.expect("a report")["diagnostics"].to_string();
        for word in words {
            assert!(remarks.contains(&format!("not used: {word}")), "{remarks}");
        }
    }
}

/// The number of metres in a message on an overlap.
fn depth(message: &str) -> f64 {
    let rest = message.split("overlap by ").nth(1).expect("an overlap");
    rest.split(' ').next().expect("a word").parse().expect("a number")
}

/// Overlap at the start, with the depth that the geometry says: the shortest shift that parts the bodies.
#[test]
fn an_overlap_is_refused_with_its_depth() {
    let turned = 30.0_f64.to_radians();
    let thin = json!({ "shape": "rectangle", "height": 0.004, "width": 0.1 });
    for (what, set, exact) in [
        ("side on side", json!({ "bodies.1.start": [0.1, 0.09] }), 0.01),
        ("end on end", json!({ "bodies.1.start": [0.999, 0] }), 1e-3),
        // the lower corner of its start face lies half a height below the start, turned
        (
            "corner in side",
            json!({ "bodies.1.start": [0.4, 0.05 - 3e-3 + 0.05 * turned.cos()], "bodies.1.angle": "30 deg" }),
            3e-3,
        ),
        ("corner in corner", json!({ "bodies.1.start": [0.98, 0.095] }), 5e-3),
        ("one within the other", json!({ "bodies.1.start": [0.3, 0], "bodies.1.length": 0.2 }), 0.1),
        ("one in place of the other", json!({ "bodies.1.start": [0, 0] }), 0.1),
        // no node of either is in the other
        (
            "a thin one across a coarse one",
            json!({ "sections.thin": thin, "bodies.1.section": "thin", "bodies.0.elements": 1, "bodies.1.elements": 1,
                "bodies.1.start": [0.53, -0.3], "bodies.1.angle": "90 deg" }),
            0.35,
        ),
    ] {
        let message = refused(
            &with(bars(), &set),
            "bodies.1.start",
            &["`lower` and `upper` overlap by", "apart or touching"],
        );
        assert!((depth(&message) - exact).abs() < 1e-6 * exact, "{what}: {message}");
    }
    for (what, set, exact) in [
        ("side by side", json!({ "bodies.1.start": [0.1, 0.03, 0.04] }), 0.05),
        ("across", json!({ "bodies.1.start": [0.5, 0.05, -0.5], "bodies.1.direction": [0, 0, 1] }), 0.05),
        ("axes that meet", json!({ "bodies.1.start": [0.5, 0, -0.5], "bodies.1.direction": [0, 0, 1] }), 0.1),
        ("one in place of the other", json!({ "bodies.1.start": [0, 0, 0] }), 0.1),
    ] {
        let message = refused(
            &with(rods(), &set),
            "bodies.1.start",
            &["`lower` and `upper` overlap by", "apart or touching"],
        );
        assert!((depth(&message) - exact).abs() < 1e-6 * exact, "{what}: {message}");
    }
    // a third body is named by its own place
    let mut scene = bars();
    let mut third = scene["bodies"][1].clone();
    (third["name"], third["start"]) = (json!("third"), json!([0.1, 0.28]));
    scene["bodies"].as_array_mut().expect("bodies").push(third);
    let message = refused(&scene, "bodies.2.start", &["`upper` and `third` overlap by"]);
    assert!((depth(&message) - 0.02).abs() < 1e-8, "{message}");
}

/// Bodies that touch at the start are allowed: at rest they stay so, and under weight they are held.
#[test]
fn bodies_may_touch_at_the_start() {
    let touching = with(bars(), &json!({ "bodies.1.start": [0.1, 0.1], "bodies.1.velocity": [0, 0] }));
    let held: Vec<Value> = (0..9).map(|k| json!({ "at": f64::from(k) / 8.0, "kind": "clamped" })).collect();
    let weight = 0.1 * 0.1 * 7850.0 * 9.81;
    for (method, step) in [("penalty", 1e-3), ("lcp", 2e-4)] {
        let method = json!({ "contact.method": method, "contact.step": step, "contact.until": 0.1 });
        let rest = done(&with(touching.clone(), &method));
        // rounding of the places is all that is left
        let small = |value: &Value, limit: f64| value.as_f64().expect("a number").abs() < limit;
        assert!(small(&rest["largest_penetration_m"], 1e-15), "{method}: {}", rest["events"]);
        let moved = rest["bodies"][1]["end_displacement_m"].as_array().expect("three").clone();
        assert!(moved.iter().all(|x| small(x, 1e-14)), "{method}: {moved:?}");
        let set = json!({ "bodies.0.supports": held, "gravity": [0, -9.81, 0] });
        let lying = done(&with(with(touching.clone(), &method), &set));
        let event = &lying["events"][0];
        assert!(event["time_s"] == 0.0 && event["until_s"].is_null(), "{method}: {event}");
        // what holds it against its weight, but for the momentum of its bouncing
        let impulse = event["impulse_N_s"][1].as_f64().expect("a number");
        assert!((impulse / (-weight * 0.1) - 1.0).abs() < 0.05, "{method}: {impulse}");
        let moved = lying["bodies"][1]["start_displacement_m"][1].as_f64().expect("a number");
        assert!(moved.abs() < 1e-3, "{method}: {moved}");
    }
    assert_eq!(done(&with(rods(), &json!({ "bodies.1.start": [0.1, 0.1, 0] })))["converged"], true);
}

/// Whether the axis of the upper bar is above the top of the lower one, which is held, but for what springs let through; its section may be flat.
fn above(results: &Value) -> bool {
    let y = |end: &str| results["bodies"][1][end][1].as_f64().expect("a number");
    y("start_m") > 0.04 && y("end_m") > 0.04
}

/// A bar that would pass wholly through the other within one step, by its speed or by the force on it, from near or far: the step is
/// cut, and what the springs can't hold is refused. Nothing passes silently.
#[test]
fn nothing_tunnels_through_a_body_in_a_step() {
    let held = json!([0.0, 0.25, 0.5, 0.75, 1.0].map(|at| json!({ "at": at, "kind": "clamped" })));
    let forces = |f: f64| json!([0.0, 0.4, 0.8].map(|at| json!({ "at": at, "force": [0, -f] })));
    let fast = json!({ "bodies.1.velocity": [0, -20] });
    let far = json!({ "bodies.1.velocity": [0, -40], "bodies.1.start": [0.1, 0.3] });
    let pushed = json!({ "bodies.1.velocity": null, "bodies.1.loads": forces(4e4) });
    let pushed_far =
        json!({ "bodies.1.velocity": null, "bodies.1.start": [0.1, 0.7], "bodies.1.loads": forces(4e5) });
    let coarse = json!({ "bodies.0.supports": held, "bodies.1.length": 0.8, "bodies.0.elements": 2, "bodies.1.elements": 2, "contact.until": 0.02,
        "contact.step": 0.02 });
    for (what, set) in [("fast", fast), ("far", far), ("pushed", pushed), ("pushed from afar", pushed_far)] {
        for settings in [
            json!({ "contact.method": "penalty" }),
            json!({ "contact.method": "penalty", "contact.integrator": "semi-implicit-euler" }),
            json!({ "contact.method": "lcp" }),
            json!({ "contact.method": "lcp-single" }),
        ] {
            let scene = with(with(with(bars(), &coarse), &set), &settings);
            let (code, message, report) = run("contact", &scene.to_string());
            let results =
                report.unwrap_or_else(|| panic!("{what}, {settings}: {message}"))["results"].clone();
            let cut = results["solver"]["cut"].as_u64().expect("a number");
            assert!(above(&results), "{what}, {settings}: {}", results["bodies"]);
            assert!(cut > 0, "{what}, {settings}: no step was cut");
            if code == 0 {
                assert!(
                    !results["events"].as_array().expect("list").is_empty(),
                    "{what}, {settings}: never met"
                );
            } else {
                let remedies = ["contact.step", "contact.penalty"];
                assert!(
                    code == 1 && remedies.iter().any(|r| message.contains(r)),
                    "{what}, {settings}: {message}"
                );
            }
        }
    }
}

/// A step of a hundred thousand times what can be followed.
#[test]
fn a_step_far_too_large_is_refused() {
    let scene = with(bars(), &json!({ "bodies.1.velocity": [0, -1e7] }));
    let results = failed(&scene, &["the step is too large for the speed", "parts", "take a contact.step of"]);
    assert_eq!(results["time_s"], 0.0);
}

/// Springs too soft for an impact: the remedy is not a softer one.
#[test]
fn springs_that_give_way_are_named() {
    let scene =
        with(bars(), &json!({ "contact.penalty": 1e4, "contact.until": 0.2, "bodies.1.velocity": [0, -5] }));
    let results = failed(&scene, &["a penetration of", "take a larger contact.penalty"]);
    assert!(results["time_s"].as_f64().expect("a time") > 0.02 && above(&results), "{}", results["bodies"]);
}

/// Two bodies that nothing can part, with a penetration that counts as touching: Lemke's method ends on a ray, and the report holds the
/// state so far.
#[test]
fn a_ray_is_reported_with_the_state() {
    let held = json!([0.0, 0.5, 1.0].map(|at| json!({ "at": at, "kind": "clamped" })));
    let set = json!({ "bodies.0.supports": held, "bodies.1.supports": held, "bodies.0.elements": 1, "bodies.1.elements": 1,
        "bodies.1.velocity": null, "bodies.1.start": [0.2, 0.1 - 5e-8], "contact.method": "lcp" });
    let results = failed(
        &with(bars(), &set),
        &[
            "complementarity problem of the contacts has no solution at 0.000000000 s",
            "Lemke's method on 2 contacts",
            "ray",
            "free the bodies where they meet",
            "smaller contact.step",
            "method penalty",
        ],
    );
    assert_eq!(results["time_s"], 0.0);
    assert_eq!(results["history"]["time_s"], json!([0.0]));
    assert_eq!(results["bodies"][1]["start_m"], json!([0.2, 0.09999995, 0.0]));
    assert_eq!(results["solver"]["complementarity_problems"], 2);
}

/// A load that nothing carries: no equilibrium, and the report holds the last state found.
#[test]
fn a_body_that_nothing_holds_has_no_equilibrium() {
    let set = json!({ "contact": { "method": "penalty" }, "bodies.1.velocity": null,
        "bodies.1.loads": [{ "at": 0.5, "force": [0, 10] }] });
    let (code, message, report) = run("contact", &with(bars(), &set).to_string());
    assert_eq!(code, 1, "{message}");
    assert!(
        message.contains("no equilibrium was found beyond 0.0000") && message.contains("Support every body"),
        "{message}"
    );
    let results = &report.expect("a report")["results"];
    assert!(results["converged"] == false && results["load_factor"] == 0.0, "{results}");
}
