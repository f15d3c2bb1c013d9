//! What a run-up models and leaves out, and remarks on its growth.

use crate::accuracy::radial_growth::basis_error;
use crate::analysis::nonlinear_summary;
use crate::model::{Law, Model};
use crate::results::{Diagnostic, LeftOut, ModelSummary, Modelled, SpinState};
use crate::section::basis::SectionBasis;
use crate::shaft::assembly::Assembly;
use crate::shaft::motion::Dynamics;

/// Error of the growth of a hollow section that calls for a warning.
const POOR_GROWTH: f64 = 1e-3;

/// Warns where no section is clear enough of hubs and joints to speak for the shaft's growth.
pub(super) fn clear_remark(state: &SpinState, diagnostics: &mut Vec<Diagnostic>) {
    if !state.growth_is_clear {
        diagnostics.push(Diagnostic::warning(
            "growth-disturbed",
            format!(
                "no section stands two radii and two elements clear of ends, disks, supports and joints: the growth at {} m is \
                 changed by them; results.growth has it along the whole shaft; shorter elements leave more of the shaft clear",
                state.growth_at_m
            ),
        ));
    }
}

/// Warns of hollow sections whose growth a polynomial misses, with the error of the same linear problem.
pub(super) fn growth_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    // a taper has one name for all its sections
    let mut seen: Vec<(&str, SectionBasis)> = Vec::new();
    for e in &model.elements {
        let key = (&model.names.sections[e.section][..], e.kind.basis);
        if seen.contains(&key) || e.kind.law != Law::Continuum {
            continue;
        }
        seen.push(key);
        let (section, material) = (&model.sections[e.section], &model.materials[e.material]);
        let error = |basis| basis_error(section, material, basis, section.outer[0]);
        let Some(now) = error(e.kind.basis).filter(|e| e.abs() > POOR_GROWTH) else { continue };
        let ring = SectionBasis::Ring { degree: 3, harmonics: 3 };
        let better = error(ring).filter(|_| section.is_ring() && !e.is_tapered());
        let better =
            better.map_or(String::new(), |b| format!("; 34R33 would miss it by {:+.1e} %", 100.0 * b));
        diagnostics.push(Diagnostic::warning(
            "hollow-growth",
            format!(
                "{} misses the radial growth of the {} {}/{} by {:+.1} % (a polynomial has no 1/r term){better}",
                e.kind.name(),
                if section.is_hollow() { "tube" } else { "circle" },
                section.outer[0],
                section.inner[0],
                100.0 * now
            ),
        ));
    }
}

pub(super) fn summary(model: &Model, assembly: &Assembly<'_>, dynamics: &Dynamics<'_>) -> ModelSummary {
    let mut summary = nonlinear_summary(model, assembly.size());
    summary.modelled.push(Modelled::TurningInertia);
    let offset = model.disks.iter().any(|d| d.offset != [0.0; 2]) || !model.spinning_masses.is_empty();
    let external = model.materials.iter().any(|m| m.mass_damping != 0.0);
    for (present, modelled, left_out) in [
        (model.has_gravity(), Modelled::Gravity, LeftOut::Gravity),
        (model.has_loads(), Modelled::Loads, LeftOut::LoadsOfRunUp),
        (offset, Modelled::Unbalance, LeftOut::Unbalance),
        (dynamics.is_viscous(), Modelled::MaterialDamping, LeftOut::MaterialDamping),
        (external, Modelled::ExternalDamping, LeftOut::ExternalDamping),
        (dynamics.counts.tangents > 0, Modelled::DeformedTangents, LeftOut::DeformedTangents),
    ] {
        if present {
            summary.modelled.push(modelled);
        } else {
            summary.left_out.push(left_out);
        }
    }
    summary
}
