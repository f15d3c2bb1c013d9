//! Abrupt steps of the section: how much too stiff a model with them is, by its modes at rest.
//!
//! The flexibility dc that a joint misses (see [`crate::analysis::joint`]) takes `dc Q^2` of the energy of a motion with the
//! resultant Q (moment, torque or axial force) at the joint: with `x^T M x = 1` the flexibility 1/w^2 of a natural motion
//! grows by `sum dc Q^2 / w^4`, so that its frequency is `sqrt(1 + sum dc Q^2 / w^2) - 1` too high. Q comes from the
//! forces `(K - w^2 M) q` at the end of the element beside the joint.

use crate::analysis::character::Character;
use crate::analysis::joint::{JointSide, Pull, missing_flexibility};
use crate::check::steps::SHARE_LEFT;
use crate::model::{Element, Hub, Model};
use crate::results::{Diagnostic, ModeKind};
use crate::section::Section;
use crate::section::basis::SectionBasis;
use crate::section::kinks::Kink;
use crate::shaft::assembly::Assembly;
use crate::shaft::spectrum::Spectrum;
use faer::{Mat, c64};

/// Relative error of a frequency from which a warning is due.
const TOLD: f64 = 5e-3;
/// Motions at rest that are looked at.
const MOTIONS: usize = 16;
/// Bending, torsional and axial motions that count, of each kind.
const COUNTED: usize = 4;
/// Ratio of radii up to which a joint with kinks of [`SETTLED_EFFORT`] misses less than [`TOLD`] and is not looked at.
const SETTLED_RATIO: f64 = 3.0;
/// Effort at a joint that leaves so little.
const SETTLED_EFFORT: usize = 3;
/// Share that kinks of degree 4 leave at larger ratios: 10-100-10 and 10-50-10 of docs/theory/steps.md#effort.
const DEEP_SHARE: f64 = 0.07;
/// Length of a disk over its reach beyond the shaft below which its own bending is looked at.
const PLATE: f64 = 0.5;
/// `lambda^2` of a free disk with two nodal diameters, Poisson's ratio 0.3 (Leissa, Vibration of Plates, NASA SP-160, 1969); a shaft
/// in its middle hardly changes it.
const TWO_DIAMETERS: f64 = 5.358;
/// Distance from a step over the smaller radius within which a stress depends on the functions of the section.
const SINGULAR: f64 = 0.5;
/// Steps whose places are named.
const NAMED: usize = 8;
/// The member that shares most functions, for comparison.
const BEST: SectionBasis = SectionBasis::Monomials(5);

/// A place where the section changes.
struct Joint {
    /// Element on its left.
    left: usize,
    x: f64,
    /// Flexibilities that are missed: moment about z, moment about y, torque, axial force.
    missing: [f64; 4],
    /// The same where polynomial sides are 34X5.
    best: [f64; 4],
}

/// What one motion at rest is off by.
#[derive(Debug, Clone, Copy)]
pub struct Excess {
    /// Kind of motion.
    pub kind: ModeKind,
    /// Its number among those of its kind, pairs of bending counted once.
    pub number: usize,
    /// Relative error of its frequency.
    pub error: f64,
    /// The same with 34X5 instead of lower polynomials.
    pub best: f64,
}

/// Share of what the joint of two elements misses that their kinks leave.
fn share_left(elements: [&Element; 2], sections: [&Section; 2]) -> f64 {
    let Some(common) = sections[0].common(sections[1]) else { return 1.0 };
    let kinks: Vec<Kink> = elements.iter().flat_map(|e| e.kinks.iter()).collect();
    let share = |edge: f64| {
        let degree = |apart: std::ops::Range<f64>| {
            let near = |k: &&Kink| apart.contains(&((k.radius - edge).abs() / common.outer[0]));
            kinks.iter().filter(near).map(|k| k.degree).max().unwrap_or(0)
        };
        match (degree(0.0..1e-6), degree(1e-6..0.3)) {
            (0, _) => SHARE_LEFT[0],
            (1, _) => SHARE_LEFT[1],
            (4.., 2..) => DEEP_SHARE,
            (_, beside) => SHARE_LEFT[2 + beside.min(2)],
        }
    };
    let [a, b] = sections;
    let of_outer = if a.outer == b.outer { 0.0 } else { share(common.outer[0]) };
    let of_bore = if a.inner == b.inner { 0.0 } else { share(common.inner[0]) };
    of_outer.max(of_bore)
}

/// Length of the elements up to the next step from a face on, and the section beyond it; `right` counts to the right.
fn run(list: &mut dyn Iterator<Item = &Element>, mut face: usize, right: bool) -> (f64, Option<usize>) {
    let mut length = 0.0;
    for e in list {
        let [near, far] = if right { e.faces } else { [e.faces[1], e.faces[0]] };
        if near != face {
            return (length, Some(near));
        }
        (length, face) = (length + e.length, far);
    }
    (length, None)
}

/// Joints of unlike sections. At a rigid hub or a face the section is undeformed by intent, and nothing is missed.
fn joints(model: &Model) -> Vec<Joint> {
    let mut list = Vec::new();
    for (left, pair) in model.elements.windows(2).enumerate() {
        let [a, b] = [&pair[0], &pair[1]];
        let held = model.nodes[b.first_node].face
            || model.disks.iter().any(|d| d.node == b.first_node && d.hub == Hub::Rigid);
        let faces = [a.faces[1], b.faces[0]];
        if faces[0] == faces[1] || held {
            continue;
        }
        let sections = faces.map(|face| &model.sections[face]);
        let share = share_left([a, b], sections);
        let radii = sections.map(|s| s.outer_size());
        let settled = radii[0].max(radii[1]) <= SETTLED_RATIO * radii[0].min(radii[1]);
        if share <= SHARE_LEFT[SETTLED_EFFORT] && settled {
            continue;
        }
        let runs = [
            run(&mut model.elements[..=left].iter().rev(), faces[0], false),
            run(&mut model.elements[left + 1..].iter(), faces[1], true),
        ];
        let mean = |value: &dyn Fn(usize) -> f64| (value(a.material) + value(b.material)) / 2.0;
        let soft = mean(&|m| 1.0 / model.materials[m].youngs_modulus);
        let sheared =
            mean(&|m| 2.0 * (1.0 + model.materials[m].poisson_ratio) / model.materials[m].youngs_modulus);
        let all = |bases: [SectionBasis; 2]| {
            let side = |i: usize| JointSide {
                section: sections[i],
                basis: bases[i],
                length: runs[i].0,
                beyond: runs[i].1.map(|s| &model.sections[s]),
            };
            let of = |pull, along| missing_flexibility(pull, [side(0), side(1)], along);
            let torsion = (of(Pull::Torsion, 0) + of(Pull::Torsion, 1)) / 2.0;
            [
                soft * of(Pull::Bending, 0),
                soft * of(Pull::Bending, 1),
                sheared * torsion,
                soft * (of(Pull::Axial, 0) + of(Pull::Axial, 1)) / 2.0,
            ]
            .map(|missing| share * missing)
        };
        let bases = [a.kind.basis, b.kind.basis];
        let raised = bases.map(|basis| if basis.is_ring() { basis } else { BEST });
        list.push(Joint { left, x: b.x, missing: all(bases), best: all(raised) });
    }
    list
}

/// Moment about z, about y, torque and axial force at the right end of an element that moves as q with w^2 = value.
fn resultants(assembly: &Assembly<'_>, e: usize, q: &[f64], value: f64) -> [f64; 4] {
    let model = assembly.model;
    let (element, matrices) = (&model.elements[e], assembly.element_matrices(e));
    let index = assembly.element_coordinates(element);
    let local = Mat::from_fn(index.len(), 1, |i, _| q[index[i]]);
    let force = &matrices.stiffness * &local - &matrices.mass * &local * faer::Scale(value);
    let end = 3 * element.n_vectors() * element.kind.axial_degree;
    let (at, r) = (|vector: usize, c: usize| force[(end + 3 * vector + c, 0)], model.reference_length);
    // the first three functions are 1, y/R and z/R in every member
    [r * at(1, 0), r * at(2, 0), r * (at(1, 2) - at(2, 1)), at(0, 0)]
}

/// The first motions of each kind.
fn excesses(assembly: &Assembly<'_>, spectrum: &Spectrum, joints: &[Joint]) -> Vec<Excess> {
    let Ok(character) = Character::new(assembly) else { return Vec::new() };
    let kinds = [(ModeKind::Bending, 2), (ModeKind::Torsion, 1), (ModeKind::Axial, 1)];
    let mut list: Vec<Excess> = Vec::new();
    let mut seen = [0usize; 3];
    for (j, &value) in spectrum.values.iter().enumerate() {
        let z: Vec<f64> = spectrum.vectors.col(j).iter().copied().collect();
        let complex: Vec<c64> = z.iter().map(|&v| c64::new(v, 0.0)).collect();
        let kind = character.of(&complex).1;
        let Some(k) = kinds.iter().position(|(of, _)| *of == kind) else { continue };
        seen[k] += 1;
        let number = seen[k].div_ceil(kinds[k].1);
        if number > COUNTED {
            continue;
        }
        let q = assembly.expand(&z);
        let (mut error, mut best) = (0.0, 0.0);
        for joint in joints {
            let carried = resultants(assembly, joint.left, &q, value);
            let energy = |c: &[f64; 4]| c.iter().zip(&carried).map(|(c, q)| c * q * q).sum::<f64>() / value;
            error += energy(&joint.missing);
            best += energy(&joint.best);
        }
        let [error, best] = [error, best].map(|e: f64| (1.0 + e).sqrt() - 1.0);
        match list.iter_mut().find(|x| (x.kind, x.number) == (kind, number)) {
            Some(twin) if twin.error >= error => {}
            Some(twin) => *twin = Excess { kind, number, error, best },
            None => list.push(Excess { kind, number, error, best }),
        }
    }
    list
}

/// What steps of the section make too stiff: the first four bending, torsional and axial motions at rest. Empty without
/// steps, and where there are no modes to look at.
pub fn step_excess(assembly: &Assembly<'_>) -> Vec<Excess> {
    let joints = joints(assembly.model);
    if joints.is_empty() {
        return Vec::new();
    }
    Spectrum::new(assembly, MOTIONS).map_or(Vec::new(), |spectrum| excesses(assembly, &spectrum, &joints))
}

/// True when the section does not change from one element to the next.
fn runs_on(model: &Model, left: &Element, right: &Element) -> bool {
    model.sections[left.faces[1]] == model.sections[right.faces[0]]
}

/// Pairs of elements between which the section changes.
fn steps_of(model: &Model) -> impl Iterator<Item = [&Element; 2]> {
    model.elements.windows(2).map(|pair| [&pair[0], &pair[1]]).filter(|[a, b]| !runs_on(model, a, b))
}

/// Says where kinked functions act and what they cost, and warns of disks whose own bending they do not reach.
pub fn kink_remarks(assembly: &Assembly<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let model = assembly.model;
    let elements = model.elements.iter().filter(|e| !e.kinks.is_empty()).count();
    if elements == 0 {
        return;
    }
    let round = |e: &&Element| model.sections[e.section].is_axisymmetric();
    let refined = |pair: &[&Element; 2]| pair.iter().all(round) && pair.iter().any(|e| !e.kinks.is_empty());
    let steps: Vec<f64> = steps_of(model).filter(refined).map(|[_, right]| right.x).collect();
    diagnostics.push(Diagnostic::info(
        "steps-refined",
        format!(
            "sections deform by kinked functions near the steps at x = {} m: on {elements} of {} elements, {} of {} unknowns",
            places(&steps),
            model.elements.len(),
            assembly.kinked_unknowns(),
            assembly.size()
        ),
    ));
    plate_remarks(model, diagnostics);
}

/// Warns of thin disks: their motions with two and more nodal diameters, and umbrella motions of higher order, need functions
/// of the section that no member has.
fn plate_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    let mut start = 0;
    for piece in model.elements.chunk_by(|a, b| runs_on(model, a, b)) {
        let (section, end) = (&model.sections[piece[0].section], start + piece.len());
        let beside = [start.checked_sub(1), Some(end)].map(|i| model.elements.get(i?));
        let shaft = beside.into_iter().flatten().map(|e| model.sections[e.section].outer_size());
        let (shaft, length) = (shaft.fold(0.0, f64::max), piece.iter().map(|e| e.length).sum::<f64>());
        let reach = section.outer_size() - shaft;
        let kinked = piece.iter().any(|e| !e.kinks.is_empty());
        start = end;
        if !kinked || shaft == 0.0 || length >= PLATE * reach {
            continue;
        }
        let material = &model.materials[piece[0].material];
        let wave_speed = (material.youngs_modulus
            / (material.density * (1.0 - material.poisson_ratio * material.poisson_ratio)))
            .sqrt();
        // w = lambda^2 sqrt(E h^2 / (12 rho (1 - nu^2))) / R^2
        let two_diameters = TWO_DIAMETERS * wave_speed * length / 12f64.sqrt() / section.outer_size().powi(2);
        diagnostics.push(Diagnostic::warning(
            "thin-disk",
            format!(
                "the disk from x = {} m is {:.2} times as long as it reaches beyond the shaft: its motions with two and more nodal \
                 diameters (from about {} rad/s at rest) and its umbrella motions of higher order are missing or too high; tilt and \
                 bending of the shaft with it are not",
                five_digits(piece[0].x),
                length / reach,
                format!("{two_diameters:.1e}").parse::<f64>().unwrap_or(two_diameters)
            ),
        ));
    }
}

/// Says of probes beside a step that stress has no limit at its corner.
pub fn stress_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    let radius = |e: &Element| model.sections[e.section].outer_size();
    let steps: Vec<(f64, f64)> = steps_of(model).map(|[a, b]| (b.x, radius(a).min(radius(b)))).collect();
    for probe in &model.probes {
        let near = |(x, radius): &&(f64, f64)| (probe.x - x).abs() < SINGULAR * radius;
        let Some((x, radius)) = steps.iter().find(near) else { continue };
        diagnostics.push(Diagnostic::info(
            "stress-at-step",
            format!(
                "probe \"{}\" stands {} m from the step at x = {} m, within half the smaller radius of {} m: at a sharp corner \
                 stress grows without bound as functions and mesh are refined; take stress farther away, times the factor of the \
                 fillet",
                probe.name,
                five_digits((probe.x - x).abs()),
                five_digits(*x),
                five_digits(*radius)
            ),
        ));
    }
}

/// A length to five digits.
fn five_digits(x: f64) -> f64 {
    format!("{x:.4e}").parse().unwrap_or(x)
}

/// Positions in words, to five digits.
fn places(steps: &[f64]) -> String {
    let mut list: Vec<String> = steps.iter().take(NAMED).map(|x| five_digits(*x).to_string()).collect();
    if steps.len() > NAMED {
        list.push(format!("and {} more", steps.len() - NAMED));
    }
    list.join(", ")
}

/// The motion of a kind that is off most.
fn worst(list: &[Excess], kind: ModeKind) -> Option<Excess> {
    list.iter().filter(|x| x.kind == kind).copied().reduce(|a, b| if b.error > a.error { b } else { a })
}

/// Motion and error in words.
fn words(x: &Excess) -> String {
    let name = match x.kind {
        ModeKind::Bending => "bending",
        ModeKind::Torsion => "torsion",
        _ => "axial motion",
    };
    let better = match x.best < 0.9 * x.error {
        true => format!(" (34X5: {:.1} %)", 100.0 * x.best),
        false => String::new(),
    };
    format!("{name} {} {:.1} %{better}", x.number, 100.0 * x.error)
}

/// Warns where steps of the section put a frequency too high by half a percent or more: the first bending motion, and
/// of each kind the worst of the first four.
pub fn step_remarks(assembly: &Assembly<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let list = step_excess(assembly);
    let kinds = [ModeKind::Bending, ModeKind::Torsion, ModeKind::Axial];
    let mut told: Vec<Excess> =
        kinds.iter().filter_map(|kind| worst(&list, *kind)).filter(|x| x.error >= TOLD).collect();
    let Some(largest) = told.iter().map(|x| x.error).reduce(f64::max) else { return };
    let first = list.iter().find(|x| x.kind == ModeKind::Bending && x.number == 1);
    if let Some(first) = first.filter(|_| told[0].kind == ModeKind::Bending && told[0].number > 1) {
        told.insert(0, *first);
    }
    let parts: Vec<String> = told.iter().map(words).collect();
    let model = assembly.model;
    let round = model.sections.iter().all(Section::is_axisymmetric)
        && model.elements.iter().all(|e| e.kinks.is_empty());
    diagnostics.push(Diagnostic::warning(
        "step",
        format!(
            "the section changes abruptly (at x = {} m); both sides share their functions, which makes the joint too stiff on \
             any mesh. Frequencies at rest are too high by about: {}; displacements under loads too small by up to {:.1} %{}",
            places(&joints(assembly.model).iter().map(|j| j.x).collect::<Vec<_>>()),
            parts.join(", "),
            100.0 * (1.0 - 1.0 / (1.0 + largest).powi(2)),
            if round { "; \"element\": \"auto\" lets sections deform near steps, within about 0.5 %" } else { "" }
        ),
    ));
}
