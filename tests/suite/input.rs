//! Bad input: exit code 2, file, JSON path, value and remedy in the message, nothing written, no panic.

use rotor::case::{Case, LoadedCase};
use rotor::error::{Error, Result};
use rotor::model::{
    Frame, Integrator, LoadKind, Model, Phase, Quadrature, RampShape, Reading, SpinupSettings,
    StaticSettings, SurfaceLoad, Traction,
};
use rotor::section::Surface;
use serde_json::{Map, Value, json};
use std::path::Path;
use std::process::Command;

fn valid() -> Value {
    json!({
        "title": "valid",
        "materials": { "steel": { "E": "210 GPa", "nu": 0.3, "rho": 7850 } },
        "sections": {
            "solid": { "shape": "circle", "radius": 0.05 },
            "hollow": { "shape": "tube", "outer_radius": 0.05, "inner_radius": 0.03 },
            "oval": { "shape": "ellipse", "semi_axis_y": 0.05, "semi_axis_z": 0.04 },
            "bar": { "shape": "rectangle", "height": 0.1, "width": 0.05 }
        },
        "shaft": { "element": "34X3", "segments": [{ "length": 1, "elements": 4, "section": "solid", "material": "steel" }] },
        "disks": [{ "at": 0.5, "mass": 10, "polar_inertia": 0.1, "diametral_inertia": 0.06 }],
        "supports": [
            { "at": 0, "kind": "revolute" },
            { "at": 1, "kind": "bearing", "stiffness": [[1e8, 0], [0, 1e8]] }
        ],
        "probes": [{ "name": "surface", "at": 0.3, "y": 0.05 }],
        "loads": [{ "at": 0.25, "force": [0, 1, 0] }],
        "modes": { "count": 4 },
        "campbell": { "speeds": { "from": 0, "to": "1000 rpm", "count": 3 }, "modes": 2 },
        "spinup": { "drive": [{ "until": 1, "speed": "1000 rpm" }, { "until": 2, "speed": 0 }] }
    })
}

fn build(value: Value) -> Result<Model> {
    Model::new(&LoadedCase::from_value("bad.json", value)?)
}

fn changed(set: &[(&str, Value)]) -> Result<Model> {
    let overrides: Map<String, Value> = set.iter().map(|(path, v)| (path.to_string(), v.clone())).collect();
    Model::new(&LoadedCase::from_value("bad.json", valid())?.with(&overrides)?)
}

#[test]
fn the_valid_case_is_valid() {
    build(valid()).unwrap_or_else(|e| panic!("{e}"));
}

/// `(what is changed, path in the message, words in the message)`.
#[test]
fn every_fault_names_path_value_and_remedy() {
    let many = json!(1_000_000_000);
    let table: Vec<(&str, Value, &str, &[&str])> = vec![
        // types, keys, words
        (
            "materials.steel.nu",
            json!("0.3"),
            "materials.steel.nu",
            &["\"0.3\"", "a text in quotes does not belong here", "allowed: a number"],
        ),
        ("title", json!(5), "title", &["5", "allowed: a text in quotes"]),
        ("title", json!(null), "title", &["null is no value"]),
        ("gravity", json!([0, 1]), "gravity", &["the list has 2 entries", "a list of 3 entries"]),
        ("disks.0.thickness_inertia", json!("no"), "disks.0.thickness_inertia", &["true or false"]),
        (
            "shaft.segments",
            json!({}),
            "shaft.segments",
            &["{}", "an object { .. } does not belong here", "a list"],
        ),
        ("shaft.segments.0.elements", json!(2.5), "shaft.segments.0.elements", &["2.5"]),
        ("shaft.segments.0.elements", json!(-3), "shaft.segments.0.elements", &["-3", "a whole number"]),
        ("shaft.segmets", json!([]), "shaft.segmets", &["did you mean \"segments\"", "element, segments"]),
        ("campbel", json!({}), "campbel", &["did you mean \"campbell\""]),
        ("sections.solid.raduis", json!(1), "sections.solid.raduis", &["did you mean \"radius\""]),
        ("sections.solid.shape", json!("circel"), "sections.solid.shape", &["did you mean \"circle\""]),
        ("supports.0.kind", json!("hinge"), "supports.0.kind", &["hinge", "clamped", "bearing"]),
        ("campbell.reduction", json!("all"), "campbell.reduction", &["\"all\"", "none"]),
        (
            "sections.solid.shape",
            json!({ "circle": null }),
            "sections.solid.shape",
            &["wrong type", "a string"],
        ),
        ("shaft", json!(["34X3", []]), "shaft", &["wrong type", "an object"]),
        ("materials.steel.E", json!(1e300), "materials.steel.E", &["extreme", "1e30"]),
        ("sections.solid.radius", json!(1e-20), "sections.solid.radius", &["extreme", "1e-15"]),
        ("disks.0.mass", json!(1e300), "disks.0.mass", &["extreme"]),
        ("supports.1.stiffness.0.0", json!(1e200), "supports.1.stiffness.0.0", &["extreme"]),
        (
            "expected",
            json!([{ "path": "x", "value": 1, "rtol": 1, "source": "s", "set": { "shaft.segmets.0": 1 } }]),
            "expected.0.set",
            &["did you mean \"segments\""],
        ),
        // units
        ("sections.solid.radius", json!("5 mmm"), "sections.solid.radius", &["did you mean \"mm\""]),
        (
            "sections.solid.radius",
            json!("5 GPa"),
            "sections.solid.radius",
            &["stress", "length", "m, mm, um, km, in"],
        ),
        ("sections.solid.radius", json!("0,05 m"), "sections.solid.radius", &["decimal comma", "0.05 m"]),
        ("sections.solid.diameter", json!(0.1), "sections.solid.diameter", &["say the same", "one of both"]),
        ("sections.hollow.inner_diameter", json!(0.1), "sections.hollow.inner_diameter", &["say the same"]),
        ("sections.bar.diameter", json!(0.1), "sections.bar.diameter", &["height, width"]),
        (
            "sections.hollow",
            json!({ "shape": "tube", "outer_diameter": 0.1, "inner_diameter": "10 cm" }),
            "sections.hollow.inner_diameter",
            &["not smaller"],
        ),
        (
            "sections.solid",
            json!({ "shape": "circle", "diameter": -1 }),
            "sections.solid.diameter",
            &["negative"],
        ),
        (
            "sections.solid",
            json!({ "shape": "circle", "diameter": 0 }),
            "sections.solid.diameter",
            &["positive"],
        ),
        (
            "disks",
            json!([{ "at": 0.5, "radius": 0.1, "diameter": 0.2, "thickness": 0.1, "rho": 1 }]),
            "disks.0.diameter",
            &["say the same"],
        ),
        ("disks", json!([{ "at": 0.5, "diameter": 0.1, "rho": 1 }]), "disks.0.thickness", &["missing"]),
        ("supports.1.stiffness", json!("1e200 N/m"), "supports.1.stiffness", &["extreme"]),
        ("supports.1.damping", json!([1, 2]), "supports.1.damping.0", &["the number 1 does not fit"]),
        ("sections.solid.radius", json!("NaN m"), "sections.solid.radius", &["NaN m"]),
        ("sections.solid.radius", json!("1e999 m"), "sections.solid.radius", &["not a finite number"]),
        ("shaft.quadrature", json!("coarse"), "shaft.quadrature", &["coarse", "exact, reduced"]),
        ("shaft.quadrature", json!(5), "shaft.quadrature", &["the number 5 does not fit", "\"exact\""]),
        ("shaft.quadrature", json!({ "axial": -1 }), "shaft.quadrature.axial", &["a whole number"]),
        ("sections.solid.radius", json!(null), "sections.solid.radius", &["needs \"radius\""]),
        ("campbell.speeds.to", json!("1000 m"), "campbell.speeds.to", &["length", "speed", "rpm"]),
        // ranges
        ("shaft.segments.0.length", json!(0), "shaft.segments.0.length", &["positive"]),
        ("shaft.segments.0.length", json!(-1), "shaft.segments.0.length", &["-1", "positive"]),
        ("shaft.segments.0.elements", json!(0), "shaft.segments.0.elements", &["at least 1"]),
        ("shaft.segments.0.elements", many, "shaft.segments.0.elements", &["GB of memory", "fewer elements"]),
        ("shaft.segments.0.elements", json!(u64::MAX), "shaft.segments.0.elements", &["GB of memory"]),
        ("shaft.segments", json!([]), "shaft.segments", &["at least one segment"]),
        ("sections.solid.radius", json!(-0.1), "sections.solid.radius", &["positive"]),
        (
            "sections.hollow.inner_radius",
            json!(0.05),
            "sections.hollow.inner_radius",
            &["0.05", "below 0.05"],
        ),
        ("sections.hollow.inner_radius", json!(0.06), "sections.hollow.inner_radius", &["not smaller"]),
        ("sections.oval.inner_semi_axis_y", json!(0.01), "sections.oval", &["both semi-axes"]),
        ("sections.bar.radius", json!(0.01), "sections.bar.radius", &["height, width"]),
        ("materials.steel.E", json!(0), "materials.steel.E", &["positive"]),
        ("materials.steel.rho", json!(-1), "materials.steel.rho", &["positive"]),
        ("materials.steel.nu", json!(0.5), "materials.steel.nu", &["below 0.5"]),
        ("materials.steel.nu", json!(-1.0), "materials.steel.nu", &["above -1"]),
        (
            "materials.steel.damping",
            json!({ "mass": -1 }),
            "materials.steel.damping.mass",
            &["not be negative"],
        ),
        // names
        (
            "shaft.segments.0.material",
            json!("steal"),
            "shaft.segments.0.material",
            &["did you mean \"steel\"", "allowed: steel"],
        ),
        ("shaft.segments.0.section", json!("box"), "shaft.segments.0.section", &["solid"]),
        ("shaft.element", json!("34X6"), "shaft.element", &["34X1"]),
        ("shaft.segments.0.element", json!("34Rdh"), "shaft.segments.0.element", &["34X1"]),
        // places
        ("disks.0.at", json!(1.5), "disks.0.at", &["off the shaft", "0 to 1 m"]),
        ("probes.0.at", json!(-0.1), "probes.0.at", &["off the shaft"]),
        ("probes.0.y", json!(0.06), "probes.0.y", &["outside the section"]),
        ("loads.0.at", json!(7), "loads.0.at", &["off the shaft"]),
        // disks
        ("disks.0.radius", json!(0.1), "disks.0.radius", &["not both"]),
        ("disks.0.mass", json!(0), "disks.0.mass", &["positive"]),
        ("disks.0.diametral_inertia", json!(0.01), "disks.0.diametral_inertia", &["half the polar"]),
        (
            "disks",
            json!([{ "at": 0.5, "mass": 1, "diametral_inertia": 1 }]),
            "disks.0.polar_inertia",
            &["missing"],
        ),
        (
            "disks",
            json!([{ "at": 0.5, "radius": 0.1, "inner_radius": 0.2, "thickness": 0.1, "rho": 1 }]),
            "disks.0.inner_radius",
            &["below 0.1"],
        ),
        // supports
        ("supports.1.at", json!(2), "supports.1.at", &["off the shaft"]),
        ("supports.1.kind", json!("roller"), "supports.1.stiffness", &["has no \"stiffness\"", "acts_on"]),
        ("supports.0.fix", json!(["r"]), "supports.0.fix", &["not both"]),
        ("supports", json!([{ "at": 0 }]), "supports.0", &["holds nothing"]),
        (
            "supports",
            json!([{ "at": 0, "kind": "clamped" }, { "at": 0, "kind": "roller" }]),
            "supports.1",
            &["contradicts `supports.0`"],
        ),
        (
            "supports",
            json!([{ "at": 0, "kind": "pinned" }, { "at": 0, "fix": ["r"] }]),
            "supports.1",
            &["contradicts"],
        ),
        ("supports", json!([{ "at": 0, "fix": ["r", "r.x"] }]), "supports.0.fix.1", &["twice"]),
        ("supports", json!([{ "at": 0, "fix": ["yyyy"] }]), "supports.0.fix.0", &["yyyy", "all, r, y, z"]),
        ("supports.1.stiffness", json!([[1, 0], [0]]), "supports.1.stiffness.1", &["[0]"]),
        // loads
        ("loads.0.force.1", json!(1e31), "loads.0.force.1", &["extreme", "1e30"]),
        ("loads.0.moment", json!([0, 0, -1e31]), "loads.0.moment.2", &["extreme"]),
        ("gravity", json!([1e31, 0, 0]), "gravity.0", &["extreme"]),
        (
            "loads",
            json!([{ "surface": "top", "traction": [0, 1e31, 0] }]),
            "loads.0.traction.1",
            &["extreme"],
        ),
        (
            "loads",
            json!([{ "surface": "top", "pressure": 1, "follower": false }]),
            "loads.0.follower",
            &["surface as it is now", "dead"],
        ),
        ("loads", json!([{ "surface": "top" }]), "loads.0", &["incomplete or mixed"]),
        ("loads", json!([{ "force": [0, 1, 0] }]), "loads.0.at", &["acts at a place"]),
        // integration of nonlinear forces
        ("shaft.quadrature", json!({ "axial": 1 }), "shaft.quadrature.axial", &["2 to 20"]),
        ("shaft.quadrature", json!({ "axial": 21 }), "shaft.quadrature.axial", &["2 to 20"]),
        ("shaft.quadrature", json!({ "section": 1 }), "shaft.quadrature.section", &["2 to 20"]),
        ("shaft.quadrature", json!({ "section": 21 }), "shaft.quadrature.section", &["2 to 20"]),
        // static
        ("static", json!({ "load_steps": 0 }), "static.load_steps", &["1 to 10000"]),
        ("static", json!({ "load_steps": 10_001 }), "static.load_steps", &["1 to 10000"]),
        ("static", json!({ "max_iterations": 0 }), "static.max_iterations", &["1 to 1000"]),
        ("static", json!({ "max_iterations": 1001 }), "static.max_iterations", &["1 to 1000"]),
        ("static", json!({ "tolerance": 1e-32 }), "static.tolerance", &["between 1e-32 and 1e-2"]),
        ("static", json!({ "tolerance": 0.01 }), "static.tolerance", &["between 1e-32 and 1e-2"]),
        ("static", json!({ "tolerence": 1e-9 }), "static.tolerence", &["did you mean \"tolerance\""]),
        // spin-up
        ("spinup.drive", json!([]), "spinup.drive", &["no phase", "until"]),
        ("spinup.drive.0.until", json!(0), "spinup.drive.0.until", &["no duration", "above 0 s"]),
        ("spinup.drive.0.until", json!(-1), "spinup.drive.0.until", &["no duration"]),
        ("spinup.drive.1.until", json!(1), "spinup.drive.1.until", &["do not ascend", "above 1 s"]),
        ("spinup.drive.1.until", json!(2e9), "spinup.drive.1.until", &["extreme", "1e9"]),
        ("spinup.drive.0.speed", json!(-1e13), "spinup.drive.0.speed", &["extreme"]),
        ("spinup.until", json!(0), "spinup.until", &["positive"]),
        ("spinup.until", json!(2e9), "spinup.until", &["extreme", "1e9"]),
        ("spinup.rtol", json!(0), "spinup.rtol", &["above 0, at most 0.1"]),
        ("spinup.rtol", json!(0.2), "spinup.rtol", &["above 0, at most 0.1"]),
        ("spinup.atol", json!(-1e-9), "spinup.atol", &["above 0, at most 0.1"]),
        ("spinup.atol", json!(0.2), "spinup.atol", &["above 0, at most 0.1"]),
        ("spinup.step", json!(0), "spinup.step", &["above 0, at most 2 s"]),
        ("spinup.step", json!(3), "spinup.step", &["above 0, at most 2 s"]),
        ("spinup.rho_infinity", json!(0.5), "spinup.rho_infinity", &["generalized-alpha"]),
        ("spinup.output", json!(1), "spinup.output", &["2 to 1000000"]),
        ("spinup.output", json!(1_000_001), "spinup.output", &["2 to 1000000"]),
        ("spinup.max_steps", json!(0), "spinup.max_steps", &["at least 1"]),
        ("supports.0.driven", json!(false), "spinup.drive", &["no driven end", "revolute or cylindrical"]),
        ("supports.0.kind", json!("clamped"), "supports.0.kind", &["does not turn", "revolute"]),
        // holding the axis alone does not turn the section
        ("supports", json!([{ "at": 0, "fix": ["r"] }]), "spinup.drive", &["no driven end"]),
        // sweep
        ("campbell.speeds.to", json!(0), "campbell.speeds.to", &["above 0"]),
        ("campbell.speeds.to", json!(-5), "campbell.speeds.to", &["above 0"]),
        ("campbell.speeds.from", json!(200), "campbell.speeds.from", &["does not rise"]),
        ("campbell.speeds.count", json!(0), "campbell.speeds.count", &["1 to 100000"]),
        ("campbell.modes", json!(0), "campbell.modes", &["1 to 1000"]),
        ("modes.count", json!(0), "modes.count", &["1 to 2000"]),
        ("campbell.reduction", json!(5), "campbell.reduction", &["modes + 8"]),
        ("campbell.gyroscopic", json!("disks"), "campbell.gyroscopic", &["classical"]),
        ("campbell.orders", json!([-1]), "campbell.orders.0", &["positive"]),
        (
            "expected",
            json!([{ "path": "x", "value": "y", "rtol": 1, "source": "s" }]),
            "expected.0.value",
            &["number"],
        ),
        ("expected", json!([{ "path": "x", "value": 1, "source": "s" }]), "expected.0", &["rtol or atol"]),
        (
            "expected",
            json!([{ "analysis": "statics", "path": "x", "value": 1, "rtol": 1, "source": "s" }]),
            "expected.0.analysis",
            &["unknown word", "did you mean \"static\"?"],
        ),
    ];
    for (place, value, path, words) in table {
        let error = changed(&[(place, value.clone())])
            .err()
            .unwrap_or_else(|| panic!("{place} = {value} was accepted"));
        let message = error.to_string();
        assert_eq!(error.exit_code(), 2, "{message}");
        assert!(message.starts_with(&format!("bad.json: at `{path}`:")), "{place} = {value}: {message}");
        assert!(message.contains("found:") && message.contains("allowed:"), "{message}");
        for word in words {
            assert!(message.contains(word), "{place} = {value}: no {word:?} in: {message}");
        }
    }
}

#[test]
fn form_and_frame_contradict() {
    let set = [("campbell.form", json!("classical")), ("campbell.frame", json!("rotating"))];
    let message = changed(&set).unwrap_err().to_string();
    assert!(message.contains("classical form exists in the stationary frame only"), "{message}");
}

/// Consistent, stationary for round sections, rotating for others; the classical form has one frame.
#[test]
fn form_and_frame_have_defaults() {
    use rotor::model::{Form, WhirlFrame};
    let settings = |set: &[(&str, Value)]| {
        let campbell = changed(set).unwrap_or_else(|e| panic!("{e}")).campbell.unwrap();
        (campbell.frame, campbell.form)
    };
    let oval = ("shaft.segments.0.section", json!("oval"));
    let offset = ("disks.0.offset", json!([0.01, 0]));
    let classical = ("campbell.form", json!("classical"));
    assert_eq!(settings(&[]), (WhirlFrame::Stationary, Form::Consistent));
    assert_eq!(settings(&[offset]), (WhirlFrame::Stationary, Form::Consistent));
    assert_eq!(settings(std::slice::from_ref(&oval)), (WhirlFrame::Rotating, Form::Consistent));
    assert_eq!(settings(&[oval, classical]), (WhirlFrame::Stationary, Form::Classical));
}

/// What no frame or form fits names its key, the reason and what would fit.
#[test]
#[ignore = "long"]
fn rotors_that_do_not_fit_a_frame_are_refused() {
    let oval = || ("shaft.segments.0.section", json!("oval"));
    let uneven = |k: Value| ("supports.1.stiffness", k);
    let fixed = ("supports.1", json!({ "at": 1, "fix": ["r.y"] }));
    // supports that turn nothing are no fault here
    let changed = |set: &[(&str, Value)]| changed(&[set, &[("spinup", Value::Null)]].concat());
    let refused = |set: &[(&str, Value)]| {
        let model = changed(set).unwrap_or_else(|e| panic!("{e}"));
        let settings = model.campbell.as_ref().unwrap();
        let refusal = rotor::analysis::campbell::remarks::fits(&model, settings).err();
        let failed = rotor::analysis::campbell::campbell(&model, settings, &|_| ()).is_err();
        assert_eq!(failed, refusal.is_some(), "{set:?}");
        refusal.map(|r| (r.path, format!("{} {}", r.problem, r.allowed)))
    };
    let frame = |f: &str| ("campbell.frame", json!(f));
    type Row<'a> = (&'a [(&'a str, Value)], &'a str, &'a str);
    let table: [Row<'_>; 7] = [
        (&[oval(), frame("stationary")], "shaft.segments", "rotating"),
        (&[oval(), uneven(json!([[1e8, 0], [0, 2e8]]))], "supports", "periodically"),
        (&[oval(), uneven(json!([[1e8, 1e6], [1e6, 1e8]]))], "supports", "periodically"),
        (&[oval(), fixed.clone()], "supports", "isotropic"),
        (&[frame("rotating"), uneven(json!([[1e8, 0], [0, 2e8]]))], "campbell.frame", "stationary"),
        (&[frame("rotating"), fixed], "campbell.frame", "stationary"),
        (&[("shaft.element", json!("3333s"))], "campbell.form", "classical"),
    ];
    for (set, path, word) in table {
        let (at, message) = refused(set).unwrap_or_else(|| panic!("{set:?} is not refused"));
        assert!(at == path && message.contains(word), "{set:?}: {at}: {message}");
    }
    let run = |set: &[(&str, Value)]| {
        let model = changed(set).unwrap_or_else(|e| panic!("{e}"));
        let settings = model.campbell.as_ref().unwrap();
        rotor::analysis::campbell::campbell(&model, settings, &|_| ()).map(|_| ()).map_err(|e| e.to_string())
    };
    let loose = ("supports", json!([]));
    assert!(run(&[frame("rotating"), loose.clone()]).unwrap_err().contains("held across its axis"));
    assert!(run(&[loose]).is_ok());
    let one_way = ["r", "y.x", "z.x", "y.y", "z.z"];
    let one_way = ("supports", json!([{ "at": 0, "fix": one_way }, { "at": 1, "fix": one_way }]));
    assert!(run(std::slice::from_ref(&one_way)).unwrap_err().contains("classical"));
    assert!(run(&[one_way, ("campbell.form", json!("classical"))]).is_ok());
    assert!(refused(&[oval(), uneven(json!([[1e8, 1e6], [-1e6, 1e8]]))]).is_none());
    assert!(refused(&[frame("rotating")]).is_none());
}

#[test]
fn settings_of_one_integrator_are_refused_by_others() {
    let with = |integrator: &str, key: &str, value: Value| {
        changed(&[("spinup.integrator", json!(integrator)), (key, value)])
    };
    let refused = |integrator, key: &str, value| {
        let message = with(integrator, key, value).unwrap_err().to_string();
        assert!(message.starts_with(&format!("bad.json: at `{key}`:")), "{message}");
    };
    refused("generalized-alpha", "spinup.rho_infinity", json!(1.1));
    refused("generalized-alpha", "spinup.rho_infinity", json!(-0.1));
    for rho in [0.0, 1.0] {
        let model = with("generalized-alpha", "spinup.rho_infinity", json!(rho)).unwrap();
        assert_eq!(model.spinup.unwrap().rho_infinity, rho);
    }
}

/// What the documentation of the keys promises for those that are left out.
#[test]
fn defaults_of_the_nonlinear_analyses() {
    let model = build(valid()).unwrap();
    assert_eq!(model.quadrature, Quadrature::EXACT);
    assert_eq!(model.statics, StaticSettings { load_steps: 1, max_iterations: 40, tolerance: 1e-20 });
    let (speed, shape) = (1000.0 * std::f64::consts::PI / 30.0, RampShape::Cosine);
    let expected = SpinupSettings {
        start_speed: 0.0,
        drive: [(1.0, speed), (2.0, 0.0)].map(|(until, speed)| Phase { until, speed, shape }).to_vec(),
        torque: Vec::new(),
        until: 2.0,
        frame: Frame::Rotating,
        integrator: Integrator::Esdirk,
        rtol: 1e-4,
        atol: 1e-7,
        rho_infinity: 0.9,
        step: None,
        max_steps: 1_000_000,
        output: 201,
        steady: false,
        driven_node: None,
        stators: Vec::new(),
    };
    assert_eq!(model.spinup, Some(expected));
    let mut bare = valid();
    bare.as_object_mut().unwrap().remove("spinup");
    assert_eq!(build(bare).unwrap().spinup, None);
}

#[test]
fn quadrature_by_name_and_by_points() {
    let rule = |value: Value| changed(&[("shaft.quadrature", value)]).unwrap().quadrature;
    assert_eq!(rule(json!("exact")), Quadrature::EXACT);
    assert_eq!(rule(json!("reduced")), Quadrature { axial: Some(5), section: None });
    assert_eq!(rule(json!({})), Quadrature::EXACT);
    assert_eq!(rule(json!({ "axial": 2, "section": 20 })), Quadrature { axial: Some(2), section: Some(20) });
}

/// A force and a moment of one entry are two loads on the node at its place, an element end.
#[test]
fn loads_stand_at_element_ends() {
    let loads = json!([
        { "at": 0.3, "force": [0, 1, 0], "moment": [2, 0, 0] },
        { "surface": "bottom", "traction": [0, 3, 0], "follower": false }
    ]);
    let model = changed(&[("loads", loads)]).unwrap();
    let kinds: Vec<LoadKind> = model.loads.iter().map(|l| l.kind).collect();
    assert_eq!(kinds, [LoadKind::Force([0.0, 1.0, 0.0]), LoadKind::Moment([2.0, 0.0, 0.0])]);
    for load in &model.loads {
        assert!((model.nodes[load.node].x - 0.3).abs() < 1e-12);
        assert!(model.elements.iter().any(|e| e.first_node == load.node));
    }
    let load = SurfaceLoad::Traction([0.0, 3.0, 0.0]);
    let (reading, path) = (Reading::FixedInSpace, "loads.1".to_owned());
    assert_eq!(model.tractions, [Traction { surface: Surface::Bottom, load, reading, path }]);
}

/// Supports that turn with the drive, and drives that turn nothing.
#[test]
fn drives_that_can_turn_the_shaft() {
    for fix in [json!(["all"]), json!(["r", "y.z"]), json!(["r", "z.y"])] {
        changed(&[("supports", json!([{ "at": 0, "fix": fix }]))]).unwrap_or_else(|e| panic!("{fix}: {e}"));
    }
    let still = json!([{ "until": 1, "speed": 0 }]);
    for kind in ["clamped", "pinned"] {
        changed(&[("spinup.drive", still.clone()), ("supports.0.kind", json!(kind))]).unwrap();
    }
}

#[test]
fn comparison_elements_refuse_other_sections() {
    for (element, section) in [("3333s", "bar"), ("3333s", "hollow"), ("3333c", "hollow"), ("3333c", "oval")]
    {
        let set = [("shaft.element", json!(element)), ("shaft.segments.0.section", json!(section))];
        assert!(changed(&set).unwrap_err().to_string().contains("shear correction"));
    }
}

#[test]
fn overrides_that_lead_nowhere() {
    let case = LoadedCase::from_value("bad.json", valid()).unwrap();
    for (path, said) in
        [("disks.7.at", "1 entries"), ("title.x", "only the value"), ("disks.first.at", "1 entries")]
    {
        let set: Map<String, Value> = [(path.to_owned(), json!(1))].into_iter().collect();
        let error = case.with(&set).unwrap_err();
        assert!(matches!(error, Error::Usage(_)) && error.to_string().contains(said), "{error}");
    }
}

/// The program itself: exit code 2, a message, an empty folder.
#[test]
fn bad_files_on_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let text = serde_json::to_string_pretty(&valid()).unwrap();
    let file = write("file", "x");
    let cases = [
        (write("text.json", "hello"), "not valid JSON"),
        (write("empty.json", ""), "not valid JSON"),
        (write("cut.json", &text[..text.len() / 2]), "not valid JSON"),
        (write("nan.json", &text.replace("0.3,", "NaN,")), "not valid JSON"),
        (write("huge.json", &text.replace("7850", "1e999")), "not valid JSON"),
        (
            write("twice.json", &text.replace("\"nu\": 0.3,", "\"nu\": 0.3, \"nu\": 0.4,")),
            "twice in one object",
        ),
        (write("bytes.json", "\u{0}\u{1}"), "not valid JSON"),
        (folder.path().join("absent.json"), "cannot read"),
        (folder.path().to_owned(), "cannot read"),
        (write("list.json", "[]"), "at `(top level)`"),
        (write("bare.json", "{}"), "missing"),
    ];
    let run = |case: &Path, more: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_rotor")).arg("campbell").arg(case).args(more).output().unwrap()
    };
    for (case, said) in &cases {
        let got = run(case, &["--out", out.to_str().unwrap()]);
        let message = String::from_utf8_lossy(&got.stderr);
        assert_eq!(got.status.code(), Some(2), "{message}");
        assert!(
            message.contains(said) && message.contains(case.file_name().unwrap().to_str().unwrap()),
            "{message}"
        );
        assert!(got.stdout.is_empty() && !out.exists());
    }
    let good = write("good.json", &text);
    let got = run(&good, &["--out", file.join("deeper").to_str().unwrap()]);
    assert_eq!(got.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&got.stderr).contains("is not a folder"));
    let stationary = ["--set", "campbell.frame=stationary", "--out", out.to_str().unwrap()];
    let oval = [&["--set", "shaft.segments.0.section=oval"], &stationary[..]].concat();
    let got = run(&good, &oval);
    assert_eq!(got.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&got.stderr).contains("not axisymmetric") && !out.exists());
    let got = run(&good, &["--out", out.to_str().unwrap()]);
    assert_eq!(got.status.code(), Some(0), "{}", String::from_utf8_lossy(&got.stderr));
}

#[test]
fn the_schema_knows_the_keys_of_the_nonlinear_analyses() {
    let schema = rotor::case::schema().to_string();
    let keys = "quadrature axial section static load_steps max_iterations tolerance spinup drive until frame \
                integrator rtol atol rho_infinity step max_steps output steady driven_at generalized-alpha stators clearance friction";
    for key in keys.split_whitespace() {
        assert!(schema.contains(&format!("\"{key}\"")), "{key}");
    }
}

#[test]
fn the_schema_knows_every_key_of_the_cases() {
    let schema = rotor::case::schema().to_string();
    for path in crate::common::case_files().into_iter().chain(crate::common::scene_files()) {
        let loaded = Case::load(&path, &[]).unwrap();
        for key in loaded.value.as_object().unwrap().keys() {
            assert!(schema.contains(&format!("\"{key}\"")), "{key}");
        }
    }
}

/// One rotor written with diameters, units run together, numbers as text, whole numbers with a point and one number for a
/// matrix, and with radii, SI and matrices.
#[test]
fn forms_of_input_mean_the_same() {
    let plain = valid();
    let mut free = valid();
    free["$schema"] = json!("https://example.org/case.schema.json");
    free["sections"]["solid"] = json!({ "shape": "circle", "diameter": "10cm" });
    free["sections"]["hollow"] =
        json!({ "shape": "tube", "outer_diameter": "100mm", "inner_radius": "3e-2" });
    free["shaft"]["segments"][0]["elements"] = json!(4.0);
    free["modes"]["count"] = json!(4.0);
    free["supports"][1]["stiffness"] = json!("100 kN/mm");
    free["disks"][0] =
        json!({ "at": "0.5", "mass": "10kg", "polar_inertia": "1e5 kg mm^2", "diametral_inertia": 0.06 });
    let [a, b] = [plain, free].map(|case| build(case).unwrap_or_else(|e| panic!("{e}")));
    assert_eq!(format!("{:?}", a.sections), format!("{:?}", b.sections));
    assert_eq!(a.elements.len(), b.elements.len());
    assert_eq!(format!("{:?}", a.bearings), format!("{:?}", b.bearings));
    assert_eq!((a.disks[0].mass, a.modes), (b.disks[0].mass, b.modes));
    assert!((a.disks[0].polar_inertia - b.disks[0].polar_inertia).abs() < 1e-15);
    // a disk by its geometry
    let disk = |keys: Value| {
        let mut case = valid();
        case["disks"] = json!([keys]);
        build(case).unwrap_or_else(|e| panic!("{e}")).disks[0]
    };
    let by_radius =
        disk(json!({ "at": 0.5, "radius": 0.2, "inner_radius": 0.05, "thickness": 0.03, "rho": 7800 }));
    let by_diameter = disk(
        json!({ "at": 0.5, "diameter": 0.4, "inner_diameter": "100 mm", "thickness": 0.03, "rho": 7800 }),
    );
    assert!((by_radius.mass - by_diameter.mass).abs() < 1e-12 && by_radius.mass > 27.0);
    assert!((by_radius.diametral_inertia - by_diameter.diametral_inertia).abs() < 1e-12);
}

/// What is wrong with a text that is no JSON, in plain words.
#[test]
fn faults_of_json_are_told_in_plain_words() {
    for (text, words) in [
        ("{ \"title\": \"a\", }", "a comma stands before the closing bracket"),
        ("{ title: \"a\" }", "the key has no quotes"),
        ("{ \"gravity\": [0, 1,] }", "a comma stands before the closing bracket"),
        ("{ \"title\": \"a\" \"source\": \"b\" }", "a comma or `}` is missing"),
        ("{ \"gravity\": [0 1] }", "a comma or `]` is missing"),
        ("{ \"title\" \"a\" }", "a colon is missing"),
        ("{ \"title\": steel }", "a value is missing or is none"),
        ("{ \"title\": .5 }", "numbers begin with a digit"),
        ("{ \"title\": \"a\nb\" }", "control character"),
        ("{ \"title\": \"C:\\shaft\" }", "backslash"),
        ("{ \"title\": \"a\"", "the file ends before"),
        ("{} {}", "something follows the end"),
        (&"[".repeat(200), "nested too deeply"),
        ("{ \"title\": 1e999 }", "too large"),
        ("{ \"title\": nul }", "only true, false and null"),
    ] {
        let message = Case::parse("bad.json", text, &[]).unwrap_err().to_string();
        assert!(message.starts_with("bad.json:1:") || message.starts_with("bad.json:2:"), "{message}");
        assert!(message.contains("not valid JSON") && message.contains(words), "{text}: {message}");
    }
}

/// A path of very many steps, wherever paths are written: refused, where it once overflowed the stack.
#[test]
fn paths_have_a_bounded_number_of_steps() {
    let folder = tempfile::tempdir().unwrap();
    let long = vec!["a"; 20_000].join(".");
    let run = |name: &str, case: &Value, command: &str, more: &[&str]| {
        let path = folder.path().join(name);
        std::fs::write(&path, case.to_string()).unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_rotor"));
        program.arg(command).arg(&path).args(more).arg("--out").arg(folder.path().join("out"));
        let got = program.output().unwrap();
        let message = String::from_utf8_lossy(&got.stderr).into_owned();
        assert_eq!(got.status.code(), Some(2), "{name}: {message}");
        assert!(message.contains("20000 steps") && message.contains("at most 32"), "{name}: {message}");
        assert!(message.len() < 2000, "{name}: {} characters", message.len());
    };
    run("set.json", &valid(), "check", &["--set", &format!("{long}=1")]);
    let mut case = valid();
    case["expected"] = json!([{ "path": "x", "value": 1, "rtol": 1, "source": "s", "set": { &long: 1 } }]);
    run("expected.json", &case, "check", &[]);
    let mut case = valid();
    case["tradeoff"] = json!({
        "analysis": "modes", "quantity": "results.modes.0.frequency_hz", "reference": "finest", "grid": { &long: [1, 2] }
    });
    run("grid.json", &case, "tradeoff", &[]);
    // within the bound a path that leads nowhere is refused as before
    let message = changed(&[(&vec!["a"; 32].join("."), json!(1))]).unwrap_err().to_string();
    assert!(message.contains("unknown key"), "{message}");
}

/// What an analysis refuses about the model names its own place, value and what is allowed.
#[test]
fn refusals_of_analyses_name_their_place() {
    use rotor::run::{Analysis, Host, run};
    let refused = |set: &[(&str, Value)], analysis| {
        let overrides: Map<String, Value> =
            set.iter().map(|(path, v)| (path.to_string(), v.clone())).collect();
        let loaded = LoadedCase::from_value("bad.json", valid()).unwrap().with(&overrides).unwrap();
        let error = run(&loaded, analysis, &Host::silent()).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string()
    };
    let structural = ("shaft.element", json!("3333s"));
    let damped = ("materials.steel.damping", json!({ "stiffness": 1e-5 }));
    for analysis in [Analysis::Static, Analysis::Spinup] {
        let message = refused(&[structural.clone(), damped.clone()], analysis);
        assert!(message.starts_with("bad.json: at `materials.steel.damping.stiffness`:"), "{message}");
        assert!(
            message.contains("found:   0.00001") && message.contains("allowed: 0; or an element"),
            "{message}"
        );
        let message = refused(&[structural.clone(), ("shaft.quadrature", json!({ "axial": 2 }))], analysis);
        assert!(message.starts_with("bad.json: at `shaft.quadrature.axial`:"), "{message}");
        assert!(message.contains("found:   2") && message.contains("allowed: 3 to 20"), "{message}");
    }
    // a rotor that floats in the rotating frame
    let free = [("supports", json!([])), ("campbell.frame", json!("rotating")), ("spinup", json!(null))];
    let message = refused(&free, Analysis::Campbell);
    assert!(message.starts_with("bad.json: at `campbell.frame`:"), "{message}");
    assert!(
        message.contains("found:   \"rotating\"") && message.contains("allowed: \"stationary\""),
        "{message}"
    );
}
