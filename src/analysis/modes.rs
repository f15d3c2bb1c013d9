//! `rotor modes`: natural frequencies and shapes of the shaft at rest.

use crate::accuracy::locking_and_rounding::refuse_dependent;
use crate::analysis::character::Character;
use crate::analysis::{Outcome, ignored_input, model_remarks, summary};
use crate::element::basis::{evaluate, lagrange};
use crate::error::Result;
use crate::model::{Field, Model};
use crate::results::{Diagnostic, EnergyShare, LeftOut, Mode, ModeKind, ModeShape, Modes};
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::functions;
use crate::shaft::spectrum::Spectrum;
use faer::{Mat, c64};

/// Residual up to which a mode counts as solved.
const SOLVED_RESIDUAL: f64 = 1e-10;
/// Stations drawn within each element.
const DRAWN_STATIONS_PER_ELEMENT: usize = 4;
/// Points on the drawn outline of a section.
const OUTLINE_POINTS: usize = 72;

/// The lowest `model.modes` modes at rest, rigid ones first.
///
/// # Errors
/// When the eigenvalue solver does not converge.
pub fn modes(model: &Model) -> Result<Outcome<Modes>> {
    refuse_dependent(model)?;
    let assembly = Assembly::new(model);
    let spectrum = Spectrum::new(&assembly, model.modes)?;
    let character = Character::new(&assembly)?;
    let n_rigid = spectrum.rigid_motions.len();
    let residuals = spectrum.residuals();
    let mut list = Vec::new();
    for number in 1..=model.modes.min(n_rigid + spectrum.values.len()) {
        let (value, x) = if number <= n_rigid {
            (0.0, spectrum.flexibility.rigid.subcols(number - 1, 1))
        } else {
            let at = number - n_rigid - 1;
            (spectrum.values[at], spectrum.vectors.subcols(at, 1))
        };
        let column: Vec<f64> = x.col(0).iter().copied().collect();
        let complex: Vec<c64> = column.iter().map(|&v| c64::new(v, 0.0)).collect();
        let (energy_share, kind, circumferential_order) = character.of(&complex);
        let kind = if number <= n_rigid { ModeKind::Rigid } else { kind };
        list.push(Mode {
            number,
            frequency_rad_s: value.sqrt(),
            frequency_hz: value.sqrt() / std::f64::consts::TAU,
            kind,
            circumferential_order,
            relative_residual: residuals[number - 1],
            shape: shape(&assembly, &assembly.expand(&column), &energy_share),
            energy_share,
        });
    }
    let mut diagnostics = ignored_input(model);
    diagnostics.extend(model_remarks(model, &assembly));
    if !spectrum.complete {
        diagnostics.push(Diagnostic::error(
            "sturm-count",
            "a Sturm count disagrees with the number of modes found: a mode below the last one may be missing",
        ));
    }
    let worst = list.iter().map(|m| m.relative_residual).fold(0.0, f64::max);
    if worst > SOLVED_RESIDUAL {
        diagnostics.push(Diagnostic::error(
            "residual",
            format!(
                "a mode's residual is {worst:.1e} of |K||x|, above {SOLVED_RESIDUAL:.0e}: the digits beyond are lost"
            ),
        ));
    }
    if list.len() < model.modes {
        diagnostics.push(Diagnostic::warning(
            "few-modes",
            format!("{} modes were asked for; the model has only {}", model.modes, list.len()),
        ));
    }
    let mass = crate::analysis::mass_properties::properties(model).mass();
    let mut model_summary = summary(model, assembly.size(), mass);
    model_summary.left_out.push(LeftOut::SpinOfModes);
    let lossy = model.materials.iter().any(|m| m.loss_factor > 0.0);
    if assembly.has_material_damping() || lossy || model.bearings.iter().any(|b| b.damps()) {
        model_summary.left_out.push(LeftOut::DampingOfModes);
    }
    if model.bearings.iter().any(|b| b.couples()) {
        diagnostics.push(Diagnostic::warning(
            "cross-coupling-ignored",
            "the skew part of the bearings' stiffness (cross-coupling) is left out of the natural modes",
        ));
    }
    let results =
        Modes { rigid_modes: n_rigid.min(list.len()), modes: list, sturm_count_agrees: spectrum.complete };
    Ok(Outcome { results, model: model_summary, diagnostics })
}

/// Samples a mode for drawing: axis and twist along the shaft, the outline of one section.
fn shape(assembly: &Assembly<'_>, q: &[f64], share: &EnergyShare) -> ModeShape {
    let model = assembly.model;
    let r = model.reference_length;
    let mut shape = ModeShape::default();
    let mut activity = (-1.0, 0, 0.0);
    let mut means: Option<(Field, Vec<f64>)> = None;
    for (e, element) in model.elements.iter().enumerate() {
        let section = &model.sections[element.section];
        let field = element.field();
        if means.as_ref().is_none_or(|(of, _)| *of != field) {
            means = Some((field, functions(model, field).means(section)));
        }
        let weights = means.as_ref().map_or(&[][..], |(_, weights)| weights);
        let last = e + 1 == model.elements.len();
        for station in 0..DRAWN_STATIONS_PER_ELEMENT + usize::from(last) {
            let xi = 2.0 * station as f64 / DRAWN_STATIONS_PER_ELEMENT as f64 - 1.0;
            let field = field_at(assembly, q, e, xi);
            let mean = |c: usize| weights.iter().enumerate().map(|(k, w)| w * field[(k, c)]).sum::<f64>();
            let size = model.section_in(element, element.x + element.length * (xi + 1.0) / 2.0).outer_size();
            let twist = (field[(1, 2)] - field[(2, 1)]) / 2.0 * size / r;
            shape.x_m.push(element.x + element.length * station as f64 / DRAWN_STATIONS_PER_ELEMENT as f64);
            shape.axis.push([mean(0), mean(1), mean(2)]);
            shape.twist.push(twist);
            // where to cut: the section that deforms (or moves) most
            let moved: f64 = if share.section > 0.5 {
                (1..field.nrows()).map(|k| (0..3).map(|c| field[(k, c)].powi(2)).sum::<f64>()).sum()
            } else {
                twist.powi(2) + (0..3).map(|c| mean(c).powi(2)).sum::<f64>()
            };
            if moved > activity.0 * (1.0 + 1e-9) {
                activity = (moved, e, xi);
            }
        }
    }
    let (_, e, xi) = activity;
    let element = &model.elements[e];
    let field = field_at(assembly, q, e, xi);
    let functions = functions(model, element.field());
    shape.section_x_m = element.x + element.length * (xi + 1.0) / 2.0;
    let section = model.section_in(element, shape.section_x_m);
    for inner in [false, true].into_iter().take(1 + usize::from(section.is_hollow())) {
        let outline = section.outline(inner, OUTLINE_POINTS);
        let displacement = |&[y, z]: &[f64; 2]| {
            let values = functions.at(y, z);
            std::array::from_fn(|c| values.iter().enumerate().map(|(k, f)| f[0] * field[(k, c)]).sum())
        };
        shape.outline_displacements.push(outline.iter().map(displacement).collect());
        shape.outlines.push(outline);
    }
    scale(&mut shape);
    shape
}

/// Section vectors (rows) at `xi` of an element.
fn field_at(assembly: &Assembly<'_>, q: &[f64], e: usize, xi: f64) -> Mat<f64> {
    let element = &assembly.model.elements[e];
    let n_vectors = element.n_vectors();
    let index = assembly.element_coordinates(element);
    let values: Vec<f64> = lagrange(element.kind.axial_degree).iter().map(|l| evaluate(l, xi)).collect();
    Mat::from_fn(n_vectors, 3, |k, c| {
        values.iter().enumerate().map(|(i, l)| l * q[index[(i * n_vectors + k) * 3 + c]]).sum()
    })
}

/// Scales to a largest displacement of one.
fn scale(shape: &mut ModeShape) {
    let length = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let outline = shape.outline_displacements.iter().flatten().map(length);
    let axis = shape.axis.iter().map(length);
    let largest = outline.chain(axis).chain(shape.twist.iter().map(|t| t.abs())).fold(0.0, f64::max);
    if largest > 0.0 {
        shape.axis.iter_mut().flatten().for_each(|v| *v /= largest);
        shape.twist.iter_mut().for_each(|v| *v /= largest);
        shape.outline_displacements.iter_mut().flatten().flatten().for_each(|v| *v /= largest);
    }
}
