//! The analyses: each takes a checked model and returns plain results with diagnostics.
//! They know nothing of files, arguments or plots.

pub mod campbell;
pub mod character;
pub mod check;
pub mod contact;
pub mod critical_map;
pub mod equilibrium;
pub mod joint;
pub mod margins;
pub mod mass_properties;
pub mod matrices;
pub mod modes;
pub mod plausibility;
mod points;
pub mod probes;
pub mod response;
mod section_forces;
pub mod spinup;
pub mod statics;
pub mod stations;
pub mod steps;

use crate::element::structural_3333s::AXIAL_POINTS;
use crate::error::{Refusal, Result};
use crate::model::{Hub, Law, Model, Quadrature};
use crate::results::{Diagnostic, LeftOut, ModelSummary, Modelled, OperatingRange};
use crate::shaft::assembly::Assembly;

/// Called with the number of speeds that were done.
pub type Counter<'a> = &'a (dyn Fn(usize) + Sync);
/// Called with the share of the run that is done and a line on where it is; false stops the run.
pub type Watch<'a> = &'a (dyn Fn(f64, &str) -> bool + Sync);

/// Results with what was modelled and the remarks of the run.
#[derive(Debug, Clone)]
pub struct Outcome<R> {
    /// The analysis' own results.
    pub results: R,
    /// Size and content of the model.
    pub model: ModelSummary,
    /// Remarks on accuracy and on input that the analysis does not use.
    pub diagnostics: Vec<Diagnostic>,
}

/// What every linear analysis about the undeformed state models and leaves out.
fn summary(model: &Model, degrees_of_freedom: usize, mass_kg: f64) -> ModelSummary {
    let mut summary = contents(model, Modelled::LinearElasticity, degrees_of_freedom, mass_kg);
    if model.has_gravity() {
        summary.left_out.push(LeftOut::GravityInLinear);
    }
    if model.has_loads() {
        summary.left_out.push(LeftOut::LoadsInLinear);
    }
    if model.has_bearing_offsets() {
        summary.left_out.push(LeftOut::OffsetsInLinear);
    }
    summary
}

/// What every nonlinear analysis models and leaves out.
fn nonlinear_summary(model: &Model, degrees_of_freedom: usize) -> ModelSummary {
    let mass_kg = mass_properties::properties(model).mass();
    let mut summary = contents(model, Modelled::FiniteDisplacements, degrees_of_freedom, mass_kg);
    summary.modelled.push(Modelled::InternalForces(quadrature_name(model)));
    summary.left_out.push(LeftOut::ContactOfShaft);
    if model.has_bearing_offsets() {
        summary.modelled.push(Modelled::BearingOffsets);
    }
    summary
}

/// The parts of a shaft, with the law of its deformation.
fn contents(model: &Model, law: Modelled, degrees_of_freedom: usize, mass_kg: f64) -> ModelSummary {
    let mut members: Vec<String> = Vec::new();
    for element in &model.elements {
        let with = if element.kinks.is_empty() { "" } else { " with kinks" };
        let name = element.kind.name() + with;
        if !members.contains(&name) {
            members.push(name);
        }
    }
    let mut modelled = vec![law, Modelled::Elements(members)];
    let mut left_out = Vec::new();
    if model.disks.is_empty() {
        left_out.push(LeftOut::Disks);
    } else {
        let with = |hub: Hub| (model.disks.iter().filter(|d| d.hub == hub).count(), hub.name());
        let hubs = [Hub::Rigid, Hub::Soft, Hub::Bore, Hub::Rim].map(with);
        modelled.push(Modelled::Disks(hubs.into_iter().filter(|(n, _)| *n > 0).collect()));
    }
    let mut bearings: Vec<&str> =
        model.bearings.iter().filter(|b| b.holds_shaft()).map(|b| b.path.as_str()).collect();
    bearings.dedup();
    if bearings.is_empty() {
        left_out.push(LeftOut::Bearings);
    } else {
        modelled.push(Modelled::Bearings(bearings.len()));
    }
    if !model.housings.is_empty() {
        modelled.push(Modelled::Housings(model.housings.len()));
    }
    if model.elements.iter().any(|e| e.carried.added_mass != 0.0) {
        modelled.push(Modelled::AddedMass);
    }
    if model.initial_stress.is_some() {
        modelled.push(Modelled::InitialStress);
    }
    ModelSummary {
        degrees_of_freedom,
        elements: model.elements.len(),
        mass_kg,
        modelled,
        left_out,
        estimated_error: model.estimated_error(),
    }
}

/// The integration of nonlinear forces in words.
fn quadrature_name(model: &Model) -> String {
    let structural = model.elements.iter().any(|e| e.kind.law == Law::Structural);
    match (model.quadrature.axial, model.quadrature.section) {
        (None, None) if structural => format!("exact, of 3333s {AXIAL_POINTS} Gauss points along an element"),
        (None, None) => "exact".to_owned(),
        (axial, section) => {
            let points = |n: Option<usize>| n.map_or("exact".to_owned(), |n| format!("{n} Gauss points"));
            format!("axial {}, section {}", points(axial), points(section))
        }
    }
}

/// What every analysis says of its model, before it runs: places that were snapped, elements that were chosen, functions
/// that lock, miss a wall or lose digits.
fn model_remarks(model: &Model, assembly: &Assembly<'_>) -> Vec<Diagnostic> {
    let mut list: Vec<Diagnostic> =
        model.snapped.iter().map(|text| Diagnostic::info("snapped", text.clone())).collect();
    crate::accuracy::thin_wall::wall_remarks(model, &mut list);
    crate::accuracy::locking_and_rounding::bore_remarks(model, &mut list);
    crate::accuracy::locking_and_rounding::estimates(model, assembly, &mut list);
    points::point_remarks(model, &mut list);
    steps::kink_remarks(assembly, &mut list);
    steps::step_remarks(assembly, &mut list);
    list
}

/// The speeds at which the machine runs, for the report.
fn operating_range(model: &Model) -> Option<OperatingRange> {
    model.operating_speed.map(|o| OperatingRange {
        minimum_rad_s: o.minimum,
        maximum_rad_s: o.maximum,
        trip_rad_s: o.trip,
    })
}

/// Speeds at which bearings have no coefficients of their own.
fn table_remarks(model: &Model, speeds: &[f64], list: &mut Vec<Diagnostic>) {
    let rpm = |s: f64| s * 30.0 / std::f64::consts::PI;
    for bearing in &model.bearings {
        let Some(table) = &bearing.table else { continue };
        let outside = speeds.iter().filter(|s| table.outside(**s)).count();
        if outside > 0 {
            let [first, last] = table.speeds();
            list.push(Diagnostic::warning(
                "table-held",
                format!(
                    "{}: the table covers {:.1} to {:.1} rpm; at {outside} of {} speeds outside the values of its end are held",
                    bearing.path,
                    rpm(first),
                    rpm(last),
                    speeds.len()
                ),
            ));
        }
    }
}

/// Refuses axial forces and torques of segments where stress follows from the loads.
fn refuse_initial_stress(model: &Model) -> Result<()> {
    let Some(path) = &model.initial_stress else { return Ok(()) };
    Err(Refusal::at(
        path.clone(),
        "an initial stress acts in modes and campbell only: here the forces of the shaft follow from its loads",
        "no axial_force and torque in the segments; a force or moment in \"loads\" instead",
    )
    .into())
}

/// Remarks on input that a linear analysis does not use.
fn ignored_input(model: &Model) -> Vec<Diagnostic> {
    let mut list = Vec::new();
    if model.has_gravity() {
        list.push(Diagnostic::info("gravity-ignored", "gravity does not act in this linear analysis"));
    }
    if model.has_loads() {
        list.push(Diagnostic::info("loads-ignored", "loads do not act in this linear analysis"));
    }
    if model.has_bearing_offsets() {
        let text = "offsets of bearings do not act in this linear analysis about the undeformed shaft";
        list.push(Diagnostic::info("offsets-ignored", text));
    }
    if model.quadrature != Quadrature::EXACT {
        list.push(Diagnostic::info(
            "quadrature-ignored",
            "linear analyses integrate exactly: shaft.quadrature acts in static and spinup only",
        ));
    }
    if !model.probes.is_empty() {
        list.push(Diagnostic::info(
            "probes-ignored",
            "probes are read by static and transient analyses only",
        ));
    }
    list
}
