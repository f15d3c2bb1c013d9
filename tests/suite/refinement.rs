//! Frequencies settle as elements shrink, where supports hold sections; on points of the axis they do not.

use crate::common::{case, frequencies, with};
use rotor::analysis::campbell::campbell;
use rotor::model::Model;
use serde_json::json;

/// The first two pairs of critical speeds, rpm, and the codes of the warnings.
fn criticals(stem: &str, elements: u64) -> (Vec<f64>, Vec<&'static str>) {
    let set = json!({ "shaft.segments.0.elements": elements, "campbell.speeds.to": "2500 rpm", "campbell.speeds.count": 3, "campbell.modes": 6 });
    let model = Model::new(&with(&case(stem), set)).unwrap_or_else(|e| panic!("{e}"));
    let settings = model.campbell.as_ref().expect("a sweep");
    let found = campbell(&model, settings, &|_| ()).unwrap_or_else(|e| panic!("{e}"));
    let codes = found.diagnostics.iter().map(|d| d.code).collect();
    (found.results.critical_speeds.iter().map(|c| c.speed_rpm).take(4).collect(), codes)
}

/// The headline case, 10 to 160 elements: within 1 % of its limit from the start, each fourfold mesh moves it less.
#[test]
fn the_headline_case_converges() {
    let list: Vec<Vec<f64>> = [10, 40, 160]
        .map(|n| criticals("bauchau", n))
        .map(|(list, codes)| {
            assert!(!codes.contains(&"point-support"), "{codes:?}");
            list
        })
        .to_vec();
    for k in 0..4 {
        let at = |i: usize| list[i][k];
        assert!((at(0) / at(2) - 1.0).abs() < 1e-2, "{list:?}");
        assert!((at(1) - at(2)).abs() < 0.6 * (at(0) - at(1)).abs(), "{list:?}");
        assert!((at(1) / at(2) - 1.0).abs() < 6e-4, "{list:?}");
    }
}

/// The ends of the source: 615 rpm falls to 593, and the run says why.
#[test]
fn ends_on_points_do_not_converge_and_say_so() {
    let list = [16, 80].map(|n| criticals("table11-points", n));
    assert!(list.iter().all(|(_, codes)| codes.contains(&"point-support")));
    let [a, b] = list.map(|(list, _)| list[0]);
    assert!((a - 615.18).abs() < 0.05 && b < a - 4.0, "{a} {b}");
}

/// Plane ends of every kind beside an element a thousand times shorter than its neighbour: nothing moves.
#[test]
fn one_short_element_moves_nothing() {
    let base = case("bauchau");
    let whole = with(&base, json!({ "disks": [], "expected": [], "modes.count": 14 }));
    let cut = with(
        &whole,
        json!({ "shaft.segments": [
        { "length": 0.0004, "elements": 1, "section": "shaft", "material": "steel" },
        { "length": 5.9996, "elements": 16, "section": "shaft", "material": "steel" }
    ] }),
    );
    for (a, b) in frequencies(&whole).iter().zip(frequencies(&cut)).filter(|(a, _)| **a > 1.0) {
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }
}
