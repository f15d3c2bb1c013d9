//! `rotor check`: what will be modelled, how big it is, and what it weighs.

use super::estimates::slow_remark;
use super::remarks::refusal;
use super::{Outcome, ignored_input, model_remarks, summary};
use crate::assembly::Assembly;
use crate::error::Result;
use crate::model::Model;
use crate::model::memory::memory;
use crate::results::{Check, Diagnostic};

/// Time of modes, critical speeds and checks per unknown, measured on one server core from 16 to 512
/// elements 34X3, s.
const TIME_PER_UNKNOWN: f64 = 2e-4;
/// Time of one spin speed on a basis of 60, measured likewise, s; grows with the cube of the basis.
const TIME_PER_SPEED: f64 = 2e-3;

/// Mass properties of the undeformed rotor.
#[derive(Debug, Clone, Copy, Default)]
pub struct Properties {
    /// Mass of the shaft, kg.
    pub shaft: f64,
    /// Mass of the disks, kg.
    pub disks: f64,
    /// Centre of mass, m.
    pub center: [f64; 3],
    /// Polar inertia about the shaft axis, kg m^2.
    pub polar: f64,
    /// Inertia about y and z axes through the centre of mass, kg m^2.
    pub diametral: [f64; 2],
}

impl Properties {
    /// Total mass, kg.
    pub fn mass(&self) -> f64 {
        self.shaft + self.disks
    }
}

/// Mass, centre of mass and inertia from the closed forms of sections and disks.
pub fn properties(model: &Model) -> Properties {
    let mut p = Properties::default();
    // first moments, and second moments about the left end of the axis
    let (mut first, mut xx, mut yy, mut zz) = ([0.0; 3], 0.0, 0.0, 0.0);
    for element in &model.elements {
        let (section, density) =
            (&model.sections[element.section], model.materials[element.material].density);
        let (a, b) = (element.x, element.x + element.length);
        let mass = density * section.area() * element.length;
        p.shaft += mass;
        first[0] += mass * (a + b) / 2.0;
        xx += mass * (a * a + a * b + b * b) / 3.0;
        yy += density * section.moment(2, 0) * element.length;
        zz += density * section.moment(0, 2) * element.length;
    }
    for disk in &model.disks {
        let x = model.nodes[disk.node].x;
        let [dy, dz] = disk.offset;
        p.disks += disk.mass;
        for (sum, at) in first.iter_mut().zip([x, dy, dz]) {
            *sum += disk.mass * at;
        }
        xx += disk.mass * x * x + disk.diametral_inertia - disk.polar_inertia / 2.0;
        yy += disk.mass * dy * dy + disk.polar_inertia / 2.0;
        zz += disk.mass * dz * dz + disk.polar_inertia / 2.0;
    }
    let mass = p.mass();
    p.center = first.map(|s| s / mass);
    let [cx, cy, cz] = p.center;
    p.polar = yy + zz;
    p.diametral = [xx + zz - mass * (cx * cx + cz * cz), xx + yy - mass * (cx * cx + cy * cy)];
    p
}

/// Size, mass properties and what each analysis will model.
///
/// # Errors
/// None at present; the signature is that of every analysis.
pub fn check(model: &Model) -> Result<Outcome<Check>> {
    let assembly = Assembly::new(model);
    let p = properties(model);
    let (rigid_motions, _) = assembly.rigid_motions();
    let unknowns = assembly.size();
    let speeds = model.campbell.as_ref().map_or(0, |c| c.speeds.len());
    let basis = model.campbell.as_ref().and_then(|c| c.reduction).unwrap_or(60);
    let time =
        TIME_PER_UNKNOWN * unknowns as f64 + speeds as f64 * TIME_PER_SPEED * (basis as f64 / 60.0).powi(3);
    let results = Check {
        nodes: model.nodes.len(),
        unconstrained_degrees_of_freedom: assembly.numbering.len(),
        rigid_motions,
        length_m: model.length,
        shaft_mass_kg: p.shaft,
        disk_mass_kg: p.disks,
        center_of_mass_m: p.center,
        polar_inertia_kg_m2: p.polar,
        inertia_y_kg_m2: p.diametral[0],
        inertia_z_kg_m2: p.diametral[1],
        estimated_memory_mb: memory(model).iter().map(|share| share.bytes).sum::<f64>() / 1e6,
        estimated_time_s: time,
    };
    let mut model_summary = summary(model, unknowns, p.mass());
    let mut diagnostics = ignored_input(model);
    match model.campbell.as_ref().map(|settings| (settings, refusal(model, settings))) {
        Some((_, Some(refused))) => diagnostics.push(Diagnostic::warning(
            "campbell-refused",
            format!("campbell will be refused: {}; remedy: {}", refused.reason, refused.remedy),
        )),
        Some((settings, None)) => {
            model_summary.modelled.push(format!("campbell: {} speeds", settings.speeds.len()));
        }
        None => model_summary.left_out.push("spin: no `campbell` block".to_owned()),
    }
    diagnostics.extend(model_remarks(model, &assembly));
    if let Some(spin) = &model.spinup {
        let fastest = spin.drive.iter().map(|p| p.speed).fold(0.0, f64::max);
        slow_remark(model, fastest, &mut diagnostics);
        if !spin.stators.is_empty() {
            model_summary.modelled.push(format!("spinup: rub (rings: {})", spin.stators.len()));
        }
    }
    Ok(Outcome { results, model: model_summary, diagnostics })
}
