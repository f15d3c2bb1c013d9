//! The sense of whirl belongs to a speed: what travels which way, what branches are called, how they are drawn.

use crate::common::{campbell, fieldtest, model, shaft, with};
use rotor::results::{Branch, Campbell, ModeKind, Whirl};
use serde_json::json;

/// Names in order of frequency at the first speed.
fn names(found: &Campbell) -> Vec<String> {
    found.branches.iter().map(|b| b.name.clone()).collect()
}

/// Names in the order of the alphabet.
fn sorted(found: &Campbell) -> Vec<String> {
    let mut list = names(found);
    list.sort();
    list
}

/// After a veering a motion that started backward whirls forward: at 19600 rpm the one at 488 rad/s has the circularity
/// +0.45 (Timoshenko beams).
#[test]
fn a_branch_changes_its_sense_after_a_veering() {
    let model = model(&fieldtest("whirl_after_veering"));
    let settings = model.campbell.as_ref().expect("a campbell block");
    let outcome = rotor::analysis::campbell::campbell(&model, settings, &|_| ()).expect("a diagram");
    let found = &outcome.results;
    let last = found.speeds_rad_s.len() - 1;
    let at = |b: &&Branch| (b.frequency_rad_s[last].expect("a frequency") - 488.0).abs() < 2.0;
    let branch = found.branches.iter().find(at).expect("the motion at 488 rad/s");
    assert_eq!(branch.whirl_at_speed[last], Whirl::Forward);
    assert!(branch.whirl_at_speed.contains(&Whirl::Backward), "it started backward");
    for branch in &found.branches {
        assert_eq!(branch.whirl_at_speed.len(), found.speeds_rad_s.len());
        let expected = if branch.kind == ModeKind::Bending { Whirl::Mixed } else { Whirl::None };
        assert_eq!(branch.whirl_at_speed[0], expected, "{} at standstill moves in a plane", branch.name);
    }
    // critical speeds take the sense at that speed, and agree with the crossings of their branches
    assert!(outcome.diagnostics.iter().all(|d| d.code != "critical-mismatch"), "{:?}", outcome.diagnostics);
}

/// Where the sweep begins and ends has no say in the names.
#[test]
#[ignore = "long"]
fn names_do_not_depend_on_the_sweep() {
    let case = fieldtest("whirl_after_veering");
    let found = campbell(&case);
    assert_eq!(names(&found)[..6], ["1B", "1F", "2B", "2F", "3B", "3F"]);
    let whole = sorted(&found);
    for speeds in [
        json!({ "from": 0, "to": "8000 rpm", "count": 9 }),
        json!({ "from": "5000 rpm", "to": "19600 rpm", "count": 16 }),
        json!({ "from": "12000 rpm", "to": "12000 rpm", "count": 1 }),
    ] {
        assert_eq!(sorted(&campbell(&with(&case, json!({ "campbell.speeds": speeds })))), whole, "{speeds}");
    }
}

/// A solid drum .2/.2 spinning free (axisymmetric solid elements, consistent form): which way patterns of n waves travel, at
/// 0, 1000 and 2500 rad/s. Breathing (n = 0) travels nowhere.
#[test]
fn patterns_of_a_short_drum_travel_as_in_solid_elements() {
    let more = json!({
        "materials": { "m": { "E": 2.1e11, "nu": 0.3, "rho": 7850 } },
        "shaft": { "element": "34X5" },
        "campbell": { "speeds": { "to": 2500, "count": 6 }, "modes": 14 }
    });
    let found = campbell(&shaft(json!({ "shape": "circle", "radius": 0.2 }), 0.2, 8, more));
    let (backward, forward, none) = (Whirl::Backward, Whirl::Forward, Whirl::None);
    for (frequencies, whirl) in [
        ([25521.638, 23860.714, 21477.576], backward),
        ([25521.638, 27241.122, 29930.327], forward),
        ([37610.244, 36498.469, 34917.781], backward),
        ([37610.244, 38769.412, 40597.698], forward),
        ([38525.734, 38531.683, 38562.944], none),
        ([43378.599, 41984.663, 40001.637], backward),
        ([43378.599, 44829.584, 47110.995], forward),
        ([49525.903, 49048.015, 48361.997], backward),
        ([49525.903, 50023.198, 50809.756], forward),
    ] {
        let fits = |b: &&Branch| {
            [0, 2, 5]
                .iter()
                .zip(frequencies)
                .all(|(&k, exact)| b.frequency_rad_s[k].is_some_and(|f| (f / exact - 1.0).abs() < 2e-3))
        };
        let branch =
            found.branches.iter().find(fits).unwrap_or_else(|| panic!("no branch at {frequencies:?}"));
        assert!(
            branch.whirl_at_speed.iter().all(|w| *w == whirl),
            "{}: {whirl:?} {:?}",
            branch.name,
            branch.whirl_at_speed
        );
    }
}

/// An isotropic rotor whirls in circles at all speeds, translation included, which spin does not split.
#[test]
fn orbits_of_an_isotropic_rotor_are_circles() {
    let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[1e6, 0], [0, 1e6]] });
    let more = json!({
        "supports": [bearing(0.0), bearing(1.0)],
        "campbell": { "speeds": { "to": 600, "count": 4 }, "modes": 6 }
    });
    let found = campbell(&shaft(json!({ "shape": "circle", "radius": 0.03 }), 1.0, 8, more));
    assert_eq!(names(&found), ["1B", "1F", "2B", "2F", "3B", "3F"]);
    for branch in &found.branches {
        let expected = if branch.name.ends_with('F') { Whirl::Forward } else { Whirl::Backward };
        assert!(
            branch.whirl_at_speed.iter().all(|w| *w == expected),
            "{}: {:?}",
            branch.name,
            branch.whirl_at_speed
        );
        assert_eq!(branch.whirl, expected);
    }
}

/// The conical whirl of a free tube, w = Omega Jp/Id (closed form; 5.38 rad/s at 60), has a branch though it does not
/// oscillate at standstill.
#[test]
fn a_free_conical_whirl_has_a_branch() {
    let (outer, inner, l) = (0.2f64, 0.15f64, 2.0f64);
    let more = json!({
        "materials": { "m": { "E": 1e9, "nu": 0.3, "rho": 7850 } },
        "shaft": { "element": "34R23" },
        "campbell": { "speeds": { "to": 60, "count": 4 }, "modes": 4 }
    });
    let section = json!({ "shape": "tube", "outer_radius": outer, "inner_radius": inner });
    let found = campbell(&shaft(section, l, 8, more));
    let branch = &found.branches[0];
    assert_eq!((branch.name.as_str(), branch.kind), ("R1", ModeKind::Rigid));
    assert_eq!(branch.frequency_rad_s[0], None);
    assert!(branch.overdamped.is_empty());
    let squares = outer * outer + inner * inner;
    let ratio = squares / 2.0 / (squares / 4.0 + l * l / 12.0);
    for k in 1..4 {
        let (w, speed) = (branch.frequency_rad_s[k].expect("a frequency"), found.speeds_rad_s[k]);
        // that of the rigid tube; its own give adds 2e-3 at 60 rad/s
        assert!((w / (speed * ratio) - 1.0).abs() < 2e-3, "{w} {}", speed * ratio);
        assert_eq!(branch.whirl_at_speed[k], Whirl::Forward);
    }
    assert!((branch.frequency_rad_s[3].expect("a frequency") - 5.38).abs() < 0.01);
}
