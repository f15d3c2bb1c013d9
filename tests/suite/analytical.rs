//! Closed forms, and convergence rates towards them or towards fine meshes.

use crate::common::{frequencies, of_kind, shaft, with};
use rotor::results::ModeKind;
use serde_json::{Value, json};
use std::f64::consts::PI;

const E: f64 = 2.1e11;
const RHO: f64 = 7800.0;
const G: f64 = E / 2.6;

fn circle(radius: f64) -> Value {
    json!({ "shape": "circle", "radius": radius })
}

fn close(a: f64, b: f64, rtol: f64) {
    assert!((a / b - 1.0).abs() <= rtol, "{a} {b} {:.2e}", a / b - 1.0);
}

/// Fixed-free bar without Poisson effect: w = (2k-1) pi/(2L) sqrt(E/rho), exact in one dimension.
#[test]
fn axial_vibration() {
    let fix = ["r.x", "y.x", "z.x", "yz.x", "yy.x", "zz.x", "yyz.x", "yzz.x", "yyy.x", "zzz.x"];
    let case = shaft(
        circle(0.05),
        2.0,
        16,
        json!({ "materials": { "m": { "nu": 0 } }, "modes": { "count": 60 }, "supports": [{ "at": 0, "fix": fix }] }),
    );
    for (k, w) in of_kind(&case, ModeKind::Axial)[..3].iter().enumerate() {
        close(*w, (2 * k + 1) as f64 * PI / 4.0 * (E / RHO).sqrt(), 1e-6);
    }
}

/// Free-free torsion of solid and hollow circles: w = k pi/L sqrt(G/rho), exact in three dimensions, for
/// every order of the family.
#[test]
fn torsion_of_circles() {
    for section in [circle(0.2), json!({ "shape": "tube", "outer_radius": 0.2, "inner_radius": 0.15 })] {
        for element in ["34X1", "34X2", "34X3", "34X4", "34X5"] {
            let more = json!({ "shaft": { "element": element }, "modes": { "count": 24 } });
            let found = of_kind(&shaft(section.clone(), 2.0, 8, more), ModeKind::Torsion);
            for k in 1..=2 {
                close(found[k - 1], k as f64 * PI / 2.0 * (G / RHO).sqrt(), 1e-7 * 10f64.powi(2 * k as i32));
            }
        }
    }
}

/// A slender simply supported beam: Euler's w = (k pi/L)^2 sqrt(E I/(rho A)) with the first correction for
/// shear and rotary inertia, -(k pi r/L)^2/8 (1 + E/(ks G)) of it.
#[test]
fn bending_of_a_slender_beam() {
    let r = 0.005;
    let supports = json!([{ "at": 0, "kind": "pinned" }, { "at": 2, "kind": "roller" }]);
    let found = of_kind(&shaft(circle(r), 2.0, 48, json!({ "supports": supports })), ModeKind::Bending);
    let ks = 6.0 * 1.69 / (7.0 + 3.6 + 0.36);
    for k in 1..=3 {
        let wave = k as f64 * PI / 2.0;
        let euler = wave * wave * (E / RHO).sqrt() * r / 2.0;
        let timoshenko = euler * (1.0 - (wave * r).powi(2) / 8.0 * (1.0 + E / (ks * G)));
        close(found[2 * k - 2], timoshenko, 5e-6);
        close(found[2 * k - 1], timoshenko, 5e-6);
    }
}

/// Torsion of a shaft (L 6, r .05) with a disk Jp 2.03249 at mid-span, both ends held: w tan(w L/(2 c)) =
/// 2 G J/(c Jp), 78.233 Hz. Plane ends hold the mean rotation and a rigid hub turns as one: the same on every mesh.
#[test]
fn torsion_with_a_disk_is_the_same_on_every_mesh() {
    let (l, r, polar) = (6.0_f64, 0.05_f64, 2.03249);
    let (c, j) = ((G / RHO).sqrt(), PI * r.powi(4) / 2.0);
    let excess = |w: f64| w * (w * l / (2.0 * c)).tan() - 2.0 * G * j / (c * polar);
    let (mut low, mut high) = (100.0, 700.0);
    for _ in 0..100 {
        let middle = (low + high) / 2.0;
        if excess(middle) > 0.0 { high = middle } else { low = middle }
    }
    close(low / (2.0 * PI), 78.233, 1e-5);
    for elements in [4, 16, 64] {
        let case = shaft(
            circle(r),
            l,
            elements,
            json!({
                "disks": [{ "at": 3, "mass": 70.5727, "polar_inertia": polar, "diametral_inertia": 1.03095 }],
                "supports": [{ "at": 0, "kind": "clamped" }, { "at": 6, "kind": "clamped" }],
                "modes": { "count": 12 }
            }),
        );
        close(of_kind(&case, ModeKind::Torsion)[0], low, 2e-5);
    }
}

/// A rigid rotor on two springs: w^2 = 2k/m across, and for the tilt w^2 = k L^2/2 / Id.
#[test]
fn rigid_body_on_soft_bearings() {
    let (l, r, k) = (0.4_f64, 0.05_f64, 1000.0);
    let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[k, 0], [0, k]] });
    let case =
        shaft(circle(r), l, 2, json!({ "supports": [bearing(0.0), bearing(l)], "modes": { "count": 8 } }));
    let found = frequencies(&case);
    let m = RHO * PI * r * r * l;
    let diametral = m * (r * r / 4.0 + l * l / 12.0);
    assert_eq!(found.iter().filter(|w| **w == 0.0).count(), 2, "free along and about the axis");
    close(found[2], (2.0 * k / m).sqrt(), 1e-6);
    close(found[4], (k * l * l / 2.0 / diametral).sqrt(), 1e-6);
}

/// The same rigid rotor spinning: conical whirl w^2 Id -+ w Omega Jp - k L^2/2 = 0, forward and backward.
#[test]
fn conical_whirl_of_a_rigid_body() {
    let (l, r, k) = (0.4_f64, 0.05_f64, 1000.0);
    let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[k, 0], [0, k]] });
    let case = shaft(
        circle(r),
        l,
        2,
        json!({
            "supports": [bearing(0.0), bearing(l)],
            "campbell": { "speeds": { "to": 100, "count": 11 }, "modes": 4 }
        }),
    );
    let m = RHO * PI * r * r * l;
    let (polar, diametral) = (m * r * r / 2.0, m * (r * r / 4.0 + l * l / 12.0));
    let found = crate::common::campbell(&case);
    for (index, speed) in found.speeds_rad_s.iter().enumerate() {
        let half = speed * polar / (2.0 * diametral);
        let root = (half * half + k * l * l / 2.0 / diametral).sqrt();
        let at = |name: &str| {
            let branch = found.branches.iter().find(|b| b.name == name).expect("branch");
            branch.frequency_rad_s[index].expect("a frequency")
        };
        close(at("2F"), root + half, 1e-5);
        close(at("2B"), root - half, 1e-5);
    }
}

/// A heavy disk on the same body: its gyroscopic terms have the sense of the shaft's, and with Jp = 1.8 Id the
/// forward conical whirl follows the sum of both.
#[test]
fn conical_whirl_with_a_disk() {
    let (l, r, k) = (0.4_f64, 0.05_f64, 1000.0);
    let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[k, 0], [0, k]] });
    let case = shaft(
        circle(r),
        l,
        2,
        json!({
            "disks": [{ "at": l / 2.0, "mass": 20, "polar_inertia": 1.8, "diametral_inertia": 1.0 }],
            "supports": [bearing(0.0), bearing(l)],
            "campbell": { "speeds": { "to": 100, "count": 2 }, "modes": 4 }
        }),
    );
    let m = RHO * PI * r * r * l;
    let (polar, diametral) = (m * r * r / 2.0 + 1.8, m * (r * r / 4.0 + l * l / 12.0) + 1.0);
    let found = crate::common::campbell(&case);
    let half = 100.0 * polar / (2.0 * diametral);
    let root = (half * half + k * l * l / 2.0 / diametral).sqrt();
    let conical = |whirl: rotor::results::Whirl, w: f64| {
        let near = found.branches.iter().filter(|b| b.whirl == whirl);
        let best =
            near.map(|b| (b.frequency_rad_s[1].expect("a frequency") / w - 1.0).abs()).fold(1.0, f64::min);
        assert!(best < 1e-4, "{whirl:?} {w}: {best:.1e}");
    };
    conical(rotor::results::Whirl::Forward, root + half);
    conical(rotor::results::Whirl::Backward, root - half);
}

/// Free tilts of an unsupported spinning body: one whirls forward at Omega Jp/Id, nothing else does.
#[test]
fn free_precession_of_an_unsupported_body() {
    let (l, r) = (0.4_f64, 0.05_f64);
    let case = shaft(
        circle(r),
        l,
        2,
        json!({ "campbell": { "speeds": { "from": 100, "to": 300, "count": 3 }, "modes": 2 } }),
    );
    let found = crate::common::campbell(&case);
    let ratio = (r * r / 2.0) / (r * r / 4.0 + l * l / 12.0);
    for (f, speed) in found.branches[0].frequency_rad_s.iter().zip(&found.speeds_rad_s) {
        close(f.expect("a frequency"), speed * ratio, 1e-5);
    }
    assert!(found.critical_speeds.is_empty(), "a slender body has no conical critical speed");
}

/// External damping alpha M decays every mode at alpha/2; Kelvin-Voigt damping beta gives zeta = beta w/2 at
/// rest. Spinning above w (1 + c_ext/c_int) the shaft becomes unstable.
#[test]
fn material_damping_and_its_instability_threshold() {
    let supports = json!([{ "at": 0, "kind": "pinned" }, { "at": 2, "kind": "roller" }]);
    let base = |damping: Value, to: f64, count: u32| {
        shaft(
            circle(0.02),
            2.0,
            6,
            json!({
                "materials": { "m": { "damping": damping } },
                "supports": supports,
                "campbell": { "speeds": { "to": to, "count": count }, "modes": 4 }
            }),
        )
    };
    let decrement = |c: &rotor::results::Campbell, branch: usize, at: usize| {
        c.branches[branch].log_decrement[at].expect("a decrement")
    };
    let (alpha, beta) = (4.0, 2e-5);
    let external = crate::common::campbell(&base(json!({ "mass": alpha }), 10.0, 3));
    let w = external.branches[0].frequency_rad_s[0].expect("a frequency");
    let internal = crate::common::campbell(&base(json!({ "stiffness": beta }), 10.0, 3));
    close(decrement(&external, 0, 0), PI * alpha / w, 1e-6);
    let w = w.hypot(alpha / 2.0); // undamped
    close(decrement(&internal, 0, 0), PI * beta * w, 1e-6);

    // threshold: forward decay alpha/2 + beta w (w - Omega)/2 vanishes at Omega = w + alpha/(beta w)
    let threshold = w + alpha / (beta * w);
    let both =
        crate::common::campbell(&base(json!({ "mass": alpha, "stiffness": beta }), 2.0 * threshold, 21));
    let forward = both.branches.iter().find(|b| b.name == "1F").expect("1F");
    let unstable =
        forward.log_decrement.iter().position(|d| d.expect("a decrement") < 0.0).expect("unstable");
    let step = both.speeds_rad_s[1];
    assert!(
        (both.speeds_rad_s[unstable] - threshold).abs() <= 1.02 * step,
        "{} {threshold}",
        both.speeds_rad_s[unstable]
    );
    let backward = both.branches.iter().find(|b| b.name == "1B").expect("1B");
    assert!(backward.log_decrement.iter().all(|d| d.expect("a decrement") > 0.0));
}

/// Bending frequencies converge from above with h^6 (cubic axial interpolation); with a cubic section the
/// three-dimensional stress state near the free ends brings that down to about h^4.5. Elements much longer
/// than the section is high converge with h^4 until they resolve it.
#[test]
fn rate_of_convergence_with_elements() {
    let errors = |element: &str, nu: f64, radius: f64| -> Vec<f64> {
        let more = json!({
            "materials": { "m": { "nu": nu } },
            "shaft": { "element": element },
            "modes": { "count": 10 }
        });
        let frequency =
            |n: usize| of_kind(&shaft(circle(radius), 2.0, n, more.clone()), ModeKind::Bending)[0];
        let exact = frequency(64);
        [4, 8, 16].iter().map(|&n| frequency(n) / exact - 1.0).collect()
    };
    for (element, nu, radius, band, bound) in [
        ("34X1", 0.0, 0.2, 5.4..6.6, 4e-8),
        ("34X3", 0.0, 0.2, 4.0..6.0, 3e-7),
        ("34X3", 0.3, 0.2, 3.5..6.0, 4e-7),
        ("34X3", 0.3, 0.01, 3.5..5.0, 4e-6),
    ] {
        let errors = errors(element, nu, radius);
        assert!(errors.windows(2).all(|e| e[0] > e[1] && e[1] > 0.0), "{errors:?}");
        for slope in errors.windows(2).map(|e| (e[0] / e[1]).log2()) {
            assert!(band.contains(&slope), "{element} nu {nu} r {radius}: slope {slope} of {errors:?}");
        }
        assert!(errors[2] < bound, "{errors:?}");
    }
}

/// Higher section orders approach the solid: the tube .2/.15 (three-dimensional reference 742.49 rad/s for the
/// third bending) falls to it monotonically, 34X5 within 0.2 %.
#[test]
fn convergence_with_section_order() {
    let tube = json!({ "shape": "tube", "outer_radius": 0.2, "inner_radius": 0.15 });
    let third = |element: &str| {
        let more = json!({
            "materials": { "m": { "E": 1e9, "rho": 7850 } },
            "shaft": { "element": element },
            "modes": { "count": 24 }
        });
        of_kind(&shaft(tube.clone(), 2.0, 8, more), ModeKind::Bending)[4]
    };
    let values: Vec<f64> = ["34X2", "34X3", "34X4", "34X5"].iter().map(|e| third(e)).collect();
    assert!(values.windows(2).all(|v| v[0] >= v[1] * (1.0 - 1e-9)), "{values:?}");
    close(values[3], 742.49, 2e-3);
}

/// Bearings on the section converge with the mesh; a point on the axis does not: it keeps giving way.
#[test]
fn bearings_on_the_section_converge_and_on_the_axis_do_not() {
    let first = |acts_on: &str, elements: usize| {
        let bearing = |at: f64| json!({ "at": at, "kind": "bearing", "stiffness": [[1e9, 0], [0, 1e9]], "acts_on": acts_on });
        let more = json!({ "supports": [bearing(0.25), bearing(0.75)], "modes": { "count": 6 }, "shaft": { "element": "34X3" } });
        of_kind(&shaft(circle(0.05), 1.0, elements, more), ModeKind::Bending)[0]
    };
    let change = |acts_on: &str, n: usize| (first(acts_on, n) / first(acts_on, 2 * n) - 1.0).abs();
    let (section, axis) = (change("section", 32), change("axis", 32));
    assert!(section < 2e-4, "{section:.1e}");
    assert!(axis > 5.0 * section, "axis {axis:.1e}, section {section:.1e}");
}

/// A soft hub lets torsion under the disk soften as the mesh is refined; a rigid hub does not.
#[test]
fn hubs_under_refinement() {
    let torsion = |hub: &str, elements: usize| {
        let more = json!({
            "disks": [{ "at": 0.5, "mass": 60, "polar_inertia": 2, "diametral_inertia": 1, "hub": hub }],
            "supports": [{ "at": 0, "kind": "clamped" }, { "at": 1, "kind": "clamped" }],
            "modes": { "count": 8 }
        });
        of_kind(&shaft(circle(0.05), 1.0, elements, more), ModeKind::Torsion)[0]
    };
    let change = |hub: &str| (torsion(hub, 8) / torsion(hub, 64) - 1.0).abs();
    assert!(change("rigid") < 1e-4, "{:.1e}", change("rigid"));
    assert!(change("soft") > 1e-3, "{:.1e}", change("soft"));
}

/// Pinned and roller supports hold the mean displacement: Euler's frequencies at any order of the section.
#[test]
fn supports_mean_the_same_at_every_order() {
    let supports = json!([{ "at": 0, "kind": "pinned" }, { "at": 2, "kind": "roller" }]);
    let case = shaft(circle(0.02), 2.0, 8, json!({ "supports": supports }));
    let cubic = of_kind(&case, ModeKind::Bending)[0];
    for element in ["34X2", "34X4", "34X5", "3333c", "3333s"] {
        let set = json!({ "shaft.element": element, "shaft.segments.0.elements": 24 });
        close(of_kind(&with(&case, set), ModeKind::Bending)[0], cubic, 1e-3);
    }
}

/// Every support that holds sections converges with the mesh; a pin on the axis vector and the source's ends, which
/// hold single vectors, move several times more at the same refinement.
#[test]
fn supports_under_refinement() {
    let first = |supports: &Value, elements: usize| {
        let more = json!({ "supports": supports, "modes": { "count": 8 } });
        of_kind(&shaft(circle(0.1), 1.0, elements, more), ModeKind::Bending)[0]
    };
    let change = |supports: Value| (first(&supports, 32) / first(&supports, 64) - 1.0).abs();
    let both = |kind: Value| {
        let at = |x: f64| {
            let mut support = kind.clone();
            support["at"] = json!(x);
            support
        };
        json!([at(0.0), at(1.0)])
    };
    let sections: Vec<f64> = [
        json!({ "kind": "clamped" }),
        json!({ "kind": "clamped", "section": "rigid" }),
        json!({ "kind": "revolute", "driven": false }),
        json!({ "kind": "revolute", "section": "rigid", "driven": false }),
        json!({ "kind": "cylindrical" }),
        json!({ "kind": "pinned" }),
        json!({ "kind": "roller" }),
    ]
    .into_iter()
    .map(|kind| change(both(kind)))
    .collect();
    let points: Vec<f64> =
        [json!({ "kind": "pinned", "acts_on": "axis" }), json!({ "fix": ["r", "y.x", "z.x", "y.y", "z.z"] })]
            .into_iter()
            .map(|kind| change(both(kind)))
            .collect();
    let worst = sections.iter().copied().fold(0.0, f64::max);
    assert!(worst < 2e-5, "{sections:?}");
    assert!(points[0] > 3.0 * sections[5], "pinned on the axis and on the section: {points:?} {sections:?}");
    assert!(points[1] > 3.0 * worst, "single vectors: {points:?} {sections:?}");
}
