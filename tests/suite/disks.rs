//! Disks of any thickness: the tilt of the section carries what exceeds a thin disk's inertia, on every mesh.

use crate::common::{campbell, criticals_rpm, fieldtest, frequencies, of_kind, shaft, with};
use rotor::results::ModeKind;
use serde_json::{Value, json};

fn near(ours: f64, right: f64, rtol: f64, what: &str) {
    assert!((ours / right - 1.0).abs() <= rtol, "{what}: {ours} instead of {right}");
}

/// Every second value: the motions of an axisymmetric shaft come in pairs.
fn pairs(values: &[f64], what: &str) -> Vec<f64> {
    let pair = |p: &[f64]| {
        near(p[1], p[0], 1e-6, what);
        p[0]
    };
    values.chunks_exact(2).map(pair).collect()
}

/// Axisymmetric solid elements, harmonic 1, converged: 324.1, 1609.4 and 2916.2 rad/s for Id = Jp; nothing axial below
/// 10000 rad/s.
#[test]
fn a_thick_disk_bends_the_shaft_alike_on_every_mesh() {
    let base = fieldtest("thick_disk_on_bearings");
    for (elements, rtol) in [(10, 5e-3), (40, 1e-3), (320, 1e-3)] {
        let case = with(&base, json!({ "shaft.segments.0.elements": elements, "modes.count": 20 }));
        let bending = pairs(&of_kind(&case, ModeKind::Bending), "bending");
        for (ours, right) in bending.iter().zip([324.1, 1609.4, 2916.2]) {
            near(*ours, right, rtol, &format!("{elements} elements"));
        }
        let axial = of_kind(&case, ModeKind::Axial);
        assert!(axial.iter().all(|w| *w == 0.0 || *w > 1e4), "{axial:?}");
    }
}

/// Timoshenko beams (Cowper's shear factor), converged: 3064, 3110, 13625 and 16784 rpm and no other below 20000 rpm.
#[test]
fn criticals_of_a_thick_disk() {
    let case = with(&fieldtest("thick_disk_on_bearings"), json!({ "shaft.segments.0.elements": 80 }));
    let ours = criticals_rpm(&case);
    let below: Vec<f64> = ours.into_iter().filter(|rpm| *rpm < 2e4).collect();
    assert_eq!(below.len(), 4, "{below:?}");
    for (ours, right) in below.into_iter().zip([3064.0, 3110.0, 13625.0, 16784.0]) {
        near(ours, right, 5e-3, "critical");
    }
}

/// Timoshenko beams, converged: 1890.3 and 5800 Hz of a cantilever with a thick disk, and for a coupling at the free end
/// (6 kg, Jp .012, Id .018 kg m^2) the forward criticals 1446 and 5190 rad/s.
#[test]
fn disks_at_free_ends() {
    let base = fieldtest("thick_disk_on_cantilever");
    for elements in [20, 80] {
        let case = with(&base, json!({ "shaft.segments.0.elements": elements }));
        let bending = pairs(&of_kind(&case, ModeKind::Bending), "bending");
        for (ours, right) in bending[1..].iter().zip([1890.3, 5800.0]) {
            near(ours / std::f64::consts::TAU, right, 6e-3, &format!("{elements} elements"));
        }
    }
    let base = fieldtest("coupling_at_end");
    for elements in [10, 40, 160] {
        let case = with(&base, json!({ "shaft.segments.0.elements": elements }));
        let found = campbell(&case);
        let forward: Vec<f64> = found
            .critical_speeds
            .iter()
            .filter(|c| c.whirl == rotor::results::Whirl::Forward && c.kind == ModeKind::Bending)
            .map(|c| c.speed_rad_s)
            .collect();
        for (ours, right) in forward.iter().zip([1446.0, 5190.0]) {
            near(*ours, right, 3e-3, &format!("{elements} elements"));
        }
    }
}

/// What thickness takes from the frequencies of a stepped rotor, over thin disks of the same Jp: Timoshenko beams give
/// 1056/1256, 1695/2097 and 5998/6208.
#[test]
fn thickness_acts_alike_on_a_stepped_rotor() {
    // the oracle is a beam, whose joints are as stiff as shared functions make them
    let thick = with(&fieldtest("turbocharger"), json!({ "shaft.element": "autok0" }));
    let thin =
        with(&thick, json!({ "disks.0.diametral_inertia": 1.6e-5, "disks.1.diametral_inertia": 2.95e-5 }));
    let bending = |case| -> Vec<f64> {
        let list = of_kind(case, ModeKind::Bending);
        list.into_iter().filter(|w| *w > 0.0).step_by(2).collect()
    };
    let (thick, thin) = (bending(&thick), bending(&thin));
    for (mode, ratio) in [(2, 1056.0 / 1256.0), (3, 1695.0 / 2097.0), (4, 5998.0 / 6208.0)] {
        near(thick[mode] / thin[mode], ratio, 3e-3, &format!("mode {mode}"));
    }
}

/// The lateral frequencies of a shaft whose disk has Id/Jp = ratio.
fn of_ratio(section: &Value, member: &str, hub: &str, ratio: f64, mesh: Value) -> Vec<f64> {
    let mut case = json!({
        "shaft": { "element": member },
        "disks": [{ "at": 0.4, "mass": 15, "polar_inertia": 0.1, "diametral_inertia": 0.1 * ratio, "hub": hub }],
        "supports": [{ "at": 0, "kind": "pinned" }, { "at": 1.2, "kind": "roller" }],
        "modes": { "count": 12 }
    });
    if mesh.is_array() {
        case["shaft"]["segments"] = mesh;
        return of_kind(&shaft(section.clone(), 1.2, 1, case), ModeKind::Bending);
    }
    let elements = mesh.as_u64().expect("elements") as usize;
    of_kind(&shaft(section.clone(), 1.2, elements, case), ModeKind::Bending)
}

/// The same to 320 elements, every hub.
#[test]
#[ignore = "long"]
fn every_hub_settles_on_the_finest_meshes() {
    let solid = json!({ "shape": "circle", "radius": 0.03 });
    let tube = json!({ "shape": "tube", "outer_radius": 0.04, "inner_radius": 0.025 });
    for (section, member, hub) in [
        (&solid, "34X3", "rigid"),
        (&solid, "34X3", "soft"),
        (&tube, "34R23", "rigid"),
        (&tube, "34R23", "bore"),
        (&tube, "34R23", "rim"),
    ] {
        let on = |elements: u32| of_ratio(section, member, hub, 2.0, json!(elements));
        let (fine, finest) = (on(80), on(320));
        for k in [0, 2, 4] {
            near(finest[k], fine[k], 2e-3, &format!("{hub} of {member}, mode {k}"));
        }
    }
}

/// For every hub: frequencies settle from 12 to 80 elements (a rigid hub: to 160, above to 320), a neighbour of the disk that is 1000 times
/// shorter changes nothing, and neither does the order of the section beyond what it changes for a thin disk. The meshes and
/// the short neighbours are shared out between two thicknesses.
#[test]
#[ignore = "long"]
fn every_hub_settles_under_refinement() {
    let solid = json!({ "shape": "circle", "radius": 0.03 });
    let tube = json!({ "shape": "tube", "outer_radius": 0.04, "inner_radius": 0.025 });
    for (section, member, other, hub) in [
        (&solid, "34X3", "34X5", "rigid"),
        (&solid, "34X3", "34X5", "soft"),
        (&tube, "34R23", "34R33", "rigid"),
        (&tube, "34R23", "34R33", "bore"),
        (&tube, "34R23", "34R33", "rim"),
    ] {
        let first = |list: Vec<f64>| [list[0], list[2], list[4]];
        let ratios = [(2.0, 1e-6), (0.6, 3e-5)];
        for (ratio, short) in ratios.into_iter().take(if hub == "rigid" { 2 } else { 1 }) {
            let what = |name: &str| format!("{hub}, Id/Jp {ratio}, {name}");
            let on = |mesh| first(of_ratio(section, member, hub, ratio, mesh));
            let fine = on(json!(40));
            for (ours, right) in on(json!(12)).into_iter().zip(fine) {
                near(ours, right, 6e-2, &what("12 elements"));
            }
            let finest = match (hub, member, ratio == 2.0) {
                ("rigid", "34X3", true) => Some(160),
                ("rim", _, true) => Some(80),
                _ => None,
            };
            if let Some(finest) = finest {
                for (ours, right) in on(json!(finest)).into_iter().zip(fine) {
                    near(ours, right, 2e-3, &what("the finest mesh"));
                }
            }
            let piece = |length: f64, elements: u32| json!({ "length": length, "elements": elements, "section": "s", "material": "m" });
            let mesh = json!([piece(0.4 - short, 13), piece(short, 1), piece(0.8, 27)]);
            for (ours, right) in on(mesh).into_iter().zip(fine) {
                near(ours, right, 3e-3, &what("a short neighbour"));
            }
        }
        if hub == "soft" {
            // its inertia acts on r_,y and r_,z themselves, which every order moves in its own way
            continue;
        }
        let of = |member: &str, ratio: f64| first(of_ratio(section, member, hub, ratio, json!(18)));
        let [thick, thick_other, thin, thin_other] =
            [(member, 2.0), (other, 2.0), (member, 0.5), (other, 0.5)]
                .map(|(member, ratio)| of(member, ratio));
        for k in 0..3 {
            // what is taken hold of at a boundary yields in its neighbourhood, which every order resolves in its own way
            let rtol = if hub == "rigid" { 4e-3 } else { 1.5e-2 };
            near(thick_other[k] / thick[k], thin_other[k] / thin[k], rtol, &format!("{hub}, {other}"));
        }
    }
}

/// A rigid body on a light, stiff stub that a soft bearing pair holds: `w^2 = k a^2 / Id` for its tilt, closed form.
#[test]
fn a_thick_disk_tilts_with_its_own_inertia() {
    let (half, k, diametral) = (0.1_f64, 1e4_f64, 0.5_f64);
    let law = json!([[k, 0], [0, k]]);
    let case = shaft(
        json!({ "shape": "circle", "radius": 0.05 }),
        2.0 * half,
        2,
        json!({
            "materials": { "m": { "rho": 1e-3 } },
            "disks": [{ "at": half, "mass": 10, "polar_inertia": 0.4, "diametral_inertia": diametral }],
            "supports": [{ "at": 0, "kind": "bearing", "stiffness": law }, { "at": 2.0 * half, "kind": "bearing", "stiffness": law }],
            "modes": { "count": 6 }
        }),
    );
    let found = frequencies(&case);
    let bounce = (2.0 * k / 10.0).sqrt();
    let tilt = (2.0 * k * half * half / diametral).sqrt();
    for (ours, right) in found[2..6].iter().zip([tilt, tilt, bounce, bounce]) {
        near(*ours, right, 1e-4, "rigid body");
    }
}

/// Forward criticals of a rigid body with Id > Jp: `W^2 (Id - Jp) = k_tilt`, in both frames.
#[test]
fn a_thick_disk_has_its_gyroscopic_critical_in_both_frames() {
    let (half, k, polar, diametral) = (0.1_f64, 1e6_f64, 0.2_f64, 0.5_f64);
    let law = json!([[k, 0], [0, k]]);
    let right = [
        (2.0 * k * half * half / (diametral + polar)).sqrt(),
        (2.0 * k * half * half / (diametral - polar)).sqrt(),
        (2.0 * k / 10.0).sqrt(),
    ];
    for frame in ["stationary", "rotating"] {
        let case = shaft(
            json!({ "shape": "circle", "radius": 0.05 }),
            2.0 * half,
            2,
            json!({
                "materials": { "m": { "rho": 1e-3 } },
                "disks": [{ "at": half, "mass": 10, "polar_inertia": polar, "diametral_inertia": diametral }],
                "supports": [{ "at": 0, "kind": "bearing", "stiffness": law }, { "at": 2.0 * half, "kind": "bearing", "stiffness": law }],
                "campbell": { "speeds": { "to": 600, "count": 7 }, "modes": 6, "frame": frame }
            }),
        );
        let found: Vec<f64> = campbell(&case).critical_speeds.iter().map(|c| c.speed_rad_s).collect();
        let wanted = if frame == "stationary" { &right[..] } else { &right[1..] };
        for right in wanted {
            assert!(
                found.iter().any(|w| (w / right - 1.0).abs() < 1e-3),
                "{frame}: {right} not in {found:?}"
            );
        }
    }
}

/// A place that differs from a segment's end by rounding is that end, and a run says so.
#[test]
fn a_disk_beside_a_segments_end_snaps_to_it() {
    let piece = json!({ "length": 0.4, "elements": 4, "section": "s", "material": "m" });
    let case = |at: f64| {
        shaft(
            json!({ "shape": "circle", "radius": 0.03 }),
            0.8,
            8,
            json!({
                "shaft": { "segments": [piece, piece] },
                "disks": [{ "at": at, "mass": 15, "polar_inertia": 0.1, "diametral_inertia": 0.1 }],
                "supports": [{ "at": 0, "kind": "pinned" }, { "at": 0.8, "kind": "roller" }]
            }),
        )
    };
    let shortest = |at: f64| {
        let model = crate::common::model(&case(at));
        model.elements.iter().map(|e| e.length).fold(f64::INFINITY, f64::min)
    };
    assert!(shortest(0.4) > 0.09 && shortest(0.40000002) > 0.09);
    assert!((shortest(0.4 + 1e-6) / 1e-6 - 1.0).abs() < 1e-6);
    let said = |at: f64| {
        let outcome = rotor::analysis::modes::modes(&crate::common::model(&case(at))).expect("modes");
        outcome.diagnostics.into_iter().find(|d| d.code == "snapped").map(|d| d.message)
    };
    assert_eq!(said(0.4), None);
    assert!(said(0.40000002).is_some_and(|text| text.contains("disks.0.at") && text.contains("0.4 m")));
}

/// Disks of several hubs may share a place: a soft one on a rigid hub is rigid too.
#[test]
fn a_soft_disk_on_a_rigid_hub_is_a_rigid_disk() {
    let lowest = |second: &str| {
        let disk = |hub: &str| json!({ "at": 0.4, "mass": 8, "polar_inertia": 0.05, "diametral_inertia": 0.04, "hub": hub });
        let more = json!({
            "disks": [disk("rigid"), disk(second)],
            "supports": [{ "at": 0, "kind": "pinned" }, { "at": 1.2, "kind": "roller" }],
            "modes": { "count": 8 }
        });
        of_kind(&shaft(json!({ "shape": "circle", "radius": 0.03 }), 1.2, 12, more), ModeKind::Bending)
    };
    for (ours, right) in lowest("soft").into_iter().zip(lowest("rigid")) {
        near(ours, right, 1e-5, "soft on rigid");
    }
}
