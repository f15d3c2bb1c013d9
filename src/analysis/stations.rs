//! Where growth and stresses of a section are read: along the whole shaft, and at one section clear of what holds or
//! stiffens the shaft nearby.
//!
//! A hub, a support, a joint of unlike sections, a taper or a free end changes the growth of a section within about two of its
//! radii (axisymmetric end effects of a solid decay as `exp(-2.7 x / R)`). On elements longer than that the section
//! functions can't follow so short a decay: they swing over an element or two instead.

use crate::analysis::probes::{element_at, growth_in};
use crate::model::{Element, Model, SupportKind};
use crate::results::{GrowthAlong, SectionGrowth};
use crate::section::Section;
use crate::shaft::assembly::Assembly;

/// Distance from a disturbance, over the radius and counted in elements, from which a section counts as clear of it.
const CLEAR_DISTANCE: f64 = 2.0;
/// Stations of the growth along an element, its right end left out.
const STATIONS_PER_ELEMENT: usize = 4;
/// Share of the shaft's length within which two places are one.
const SAME_PLACE_PER_LENGTH: f64 = 1e-9;

/// A section of the shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthStation {
    /// Position along the undeformed shaft, m.
    pub x: f64,
    /// The section there.
    pub section: Section,
    /// Index of its material.
    pub material: usize,
    /// Distance to the nearest disturbance: over the outer radius, or counted in elements if that is less.
    pub clearance: f64,
}

impl GrowthStation {
    /// True when nothing nearby changes the section's growth.
    pub fn is_clear(&self) -> bool {
        self.clearance >= CLEAR_DISTANCE * (1.0 - SAME_PLACE_PER_LENGTH)
    }
}

/// The section nearest to mid-length that is clear of disturbances; where none is, the one farthest from them.
pub fn headline(model: &Model) -> GrowthStation {
    let places = disturbances(model);
    let middle = model.length / 2.0;
    let station = |x: f64| {
        let e = element_at(model, x);
        let section = model.section_in(e, x);
        let radius = section.outer_size();
        let distance = |p: &f64| ((p - x).abs() / radius).min(elements_between(model, *p, x));
        let clearance = places.iter().map(distance).fold(f64::INFINITY, f64::min);
        GrowthStation { x, section, material: e.material, clearance }
    };
    let inner = model.elements.iter().flat_map(|e| [e.x, e.x + e.length / 2.0]);
    // within rounding, the left one of two that are alike
    let better = |a: &GrowthStation, b: &GrowthStation| {
        let (near_a, near_b) = ((a.x - middle).abs(), (b.x - middle).abs());
        match (a.is_clear(), b.is_clear()) {
            (true, true) => near_a < near_b - SAME_PLACE_PER_LENGTH * model.length,
            (false, false) => a.clearance > b.clearance * (1.0 + SAME_PLACE_PER_LENGTH),
            (clear, _) => clear,
        }
    };
    let start = station(middle);
    inner.map(station).fold(start, |best, next| if better(&next, &best) { next } else { best })
}

/// Elements between two positions, those that lie there in part counted in part.
fn elements_between(model: &Model, a: f64, b: f64) -> f64 {
    let (left, right) = (a.min(b), a.max(b));
    let share = |e: &Element| ((e.x + e.length).min(right) - e.x.max(left)).max(0.0) / e.length;
    model.elements.iter().map(share).sum()
}

/// Positions of ends, joints of unlike elements, tapers, disks and supports, m.
fn disturbances(model: &Model) -> Vec<f64> {
    let mut places = vec![0.0, model.length];
    let unlike =
        |a: &Element, b: &Element| (a.faces[1], a.material, a.kind) != (b.faces[0], b.material, b.kind);
    places.extend(model.elements.windows(2).filter(|w| unlike(&w[0], &w[1])).map(|w| w[1].x));
    let tapered = model.elements.iter().filter(|e| e.is_tapered());
    places.extend(tapered.flat_map(|e| [e.x, e.x + e.length]));
    places.extend(model.disks.iter().map(|d| model.nodes[d.node].x));
    let held = model.supports.iter().filter(|s| s.kind != SupportKind::Turned);
    places.extend(held.map(|s| model.nodes[s.node].x));
    places
}

/// Growth of rim and bore of the section at x.
pub fn section_growth(assembly: &Assembly<'_>, q: &[f64], x: f64) -> SectionGrowth {
    let e = element_at(assembly.model, x);
    let section = assembly.model.section_in(e, x);
    let bore = section.is_hollow().then(|| growth_in(assembly, q, e, x, section.inner));
    SectionGrowth { rim_m: growth_in(assembly, q, e, x, section.outer), bore_m: bore }
}

/// Growth along the whole shaft; at a joint of two sections both of them, from left to right.
pub fn growth_along(assembly: &Assembly<'_>, q: &[f64]) -> GrowthAlong {
    let model = assembly.model;
    let mut along = GrowthAlong::default();
    for (i, e) in model.elements.iter().enumerate() {
        let joint = model.elements.get(i + 1).is_none_or(|next| next.faces[0] != e.faces[1]);
        for k in 0..STATIONS_PER_ELEMENT + usize::from(joint) {
            let x = e.x + e.length * k as f64 / STATIONS_PER_ELEMENT as f64;
            let section = model.section_in(e, x);
            along.x_m.push(x);
            along.rim_m.push(growth_in(assembly, q, e, x, section.outer));
            let bore = section.is_hollow().then(|| growth_in(assembly, q, e, x, section.inner));
            along.bore_m.push(bore);
        }
    }
    let size = |k: &usize| along.rim_m[*k].iter().fold(f64::MIN, |m: f64, g| m.max(*g));
    // the first of those alike
    let largest = (0..along.x_m.len())
        .reduce(|a, b| if size(&b) > size(&a) + SAME_PLACE_PER_LENGTH * size(&a).abs() { b } else { a });
    if let Some(k) = largest {
        (along.largest_rim_m, along.largest_rim_at_m) = (size(&k), along.x_m[k]);
    }
    along
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::probes::in_rigid_hub;
    use crate::case::LoadedCase;
    use serde_json::json;

    fn model(disks: serde_json::Value) -> Model {
        let case = json!({
            "title": "shaft",
            "materials": { "m": { "E": 2e11, "nu": 0.3, "rho": 7800 } },
            "sections": { "s": { "shape": "circle", "radius": 0.1 } },
            "shaft": { "segments": [{ "length": 2.0, "elements": 8, "section": "s", "material": "m" }] },
            "supports": [{ "at": 0, "kind": "revolute" }, { "at": 2, "kind": "cylindrical" }],
            "disks": disks
        });
        Model::new(&LoadedCase::from_value("shaft.json", case).unwrap()).unwrap()
    }

    #[test]
    fn the_headline_is_mid_length_unless_a_disk_is_there() {
        let disk = |at: f64| json!({ "at": at, "mass": 1, "polar_inertia": 0.02, "diametral_inertia": 0.01 });
        let free = headline(&model(json!([])));
        assert!(free.x == 1.0 && free.is_clear());
        let beside = headline(&model(json!([disk(1.0)])));
        // two elements of 0.25 m, which are more than two radii
        assert!((beside.x - 0.5).abs() < 1e-12 && beside.is_clear(), "{beside:?}");
        let crowded = headline(&model(json!((1..8).map(|k| disk(0.25 * f64::from(k))).collect::<Vec<_>>())));
        assert!(!crowded.is_clear() && (crowded.clearance - 0.5).abs() < 1e-9, "{crowded:?}");
    }

    #[test]
    fn a_rigid_hub_holds_the_section_beside_it() {
        let model =
            model(json!([{ "at": 1.0, "mass": 1, "polar_inertia": 0.02, "diametral_inertia": 0.01 }]));
        assert!(in_rigid_hub(&model, 1.0) && in_rigid_hub(&model, 1.04) && !in_rigid_hub(&model, 1.2));
    }
}
