//! States at material points: displacement, strain and stress from the coordinates of a shaft.

use crate::element::basis::{derivative, evaluate, lagrange};
use crate::element::polynomial::stress_at;
use crate::model::{Element, Hub, Model, SectionHold, SupportKind};
use crate::results::{PointState, ProbeState, Profile, Stress};
use crate::section::{Section, Shape};
use crate::shaft::assembly::Assembly;
use crate::shaft::attachments::functions;
use nalgebra::{Matrix3, RowVector3, Vector3};

/// Distance from a rigid hub, over the radius, within which a section is held by it.
const HELD: f64 = 0.5;

/// Points of a profile.
const PROFILE_POINTS: usize = 17;
/// Points of an outline.
const OUTLINE_POINTS: usize = 96;

/// The element at a position (the left one at a common end).
pub fn element_at(model: &Model, x: f64) -> &Element {
    let tolerance = 1e-9 * model.length;
    let inside = |e: &&Element| x <= e.x + e.length + tolerance;
    model.elements.iter().find(inside).unwrap_or(&model.elements[model.elements.len() - 1])
}

/// Shape functions of the point `(x, y, z)`: for every vector of its element the first coordinate, the function's
/// value and its gradient (1/m).
fn shape(assembly: &Assembly<'_>, e: &Element, [x, y, z]: [f64; 3]) -> Vec<(usize, f64, [f64; 3])> {
    let xi = (2.0 * (x - e.x) / e.length - 1.0).clamp(-1.0, 1.0);
    let field = e.field();
    let functions = functions(assembly.model, field).at(y, z);
    let mut list = Vec::with_capacity(e.kind.n_nodes() * e.n_vectors());
    for (i, l) in lagrange(e.kind.axial_degree).iter().enumerate() {
        let (value, slope) = (evaluate(l, xi), evaluate(&derivative(l), xi) * 2.0 / e.length);
        let first = assembly.numbering.of_element(e, i);
        for (k, [f, by_y, by_z]) in functions.iter().enumerate() {
            list.push((first + 3 * k, value * f, [slope * f, value * by_y, value * by_z]));
        }
    }
    list
}

/// Position (m) and deformation gradient of a point for coordinates q.
fn position(
    assembly: &Assembly<'_>,
    q: &[f64],
    e: &Element,
    point: [f64; 3],
) -> (Vector3<f64>, Matrix3<f64>) {
    let (mut place, mut gradient) = (Vector3::zeros(), Matrix3::zeros());
    for (at, value, slopes) in shape(assembly, e, point) {
        let vector = Vector3::new(q[at], q[at + 1], q[at + 2]);
        place += vector * value;
        gradient += vector * RowVector3::from(slopes);
    }
    (place, gradient)
}

/// xx, yy, zz, xy, xz, yz of a symmetric tensor.
fn components(t: &Matrix3<f64>) -> [f64; 6] {
    [t[(0, 0)], t[(1, 1)], t[(2, 2)], t[(0, 1)], t[(0, 2)], t[(1, 2)]]
}

/// State of the point `(x, y, z)` of the undeformed shaft.
pub fn point_state(assembly: &Assembly<'_>, q: &[f64], [x, y, z]: [f64; 3]) -> PointState {
    let model = assembly.model;
    let e = element_at(model, x);
    let (place, f) = position(assembly, q, e, [x, y, z]);
    let strain = (f.transpose() * f - Matrix3::identity()) / 2.0;
    let second_piola =
        stress_at(e.kind.law, &model.sections[e.section], &model.materials[e.material], &strain);
    let cauchy = f * second_piola * f.transpose() / f.determinant();
    let i1 = cauchy.trace();
    let deviator = cauchy - Matrix3::identity() * (i1 / 3.0);
    let displacement = place - Vector3::new(x, y, z);
    PointState {
        in_rigid_hub: in_rigid_hub(model, x),
        y_m: y,
        z_m: z,
        displacement_m: displacement.into(),
        strain: components(&strain),
        second_piola_pa: components(&second_piola),
        stress_pa: Stress {
            cauchy: components(&cauchy),
            von_mises: (1.5 * deviator.norm_squared()).sqrt(),
            i1,
            i2: (i1 * i1 - (cauchy * cauchy).trace()) / 2.0,
            i3: cauchy.determinant(),
        },
    }
}

/// Axial stress of small strains at the surface of a section at x (m), on its axes y and z: rows over the coordinates.
pub fn axial_stress_rows(assembly: &Assembly<'_>, x: f64) -> [Vec<(usize, f64)>; 2] {
    let model = assembly.model;
    let e = element_at(model, x);
    let section = &model.sections[e.section];
    let by_gradient = |c: usize, j: usize| {
        let mut strain = Matrix3::zeros();
        strain[(c, j)] += 0.5;
        strain[(j, c)] += 0.5;
        stress_at(e.kind.law, section, &model.materials[e.material], &strain)[(0, 0)]
    };
    let factors: [[f64; 3]; 3] = [0, 1, 2].map(|c| [0, 1, 2].map(|j| by_gradient(c, j)));
    [[section.outer[0], 0.0], [0.0, section.outer[1]]].map(|[y, z]| {
        let mut row = Vec::new();
        for (at, _, slopes) in shape(assembly, e, [x, y, z]) {
            for (c, factors) in factors.iter().enumerate() {
                let factor: f64 = factors.iter().zip(slopes).map(|(a, b)| a * b).sum();
                if factor != 0.0 {
                    row.push((at + c, factor));
                }
            }
        }
        row
    })
}

/// Displacement of a point.
pub fn displacement(assembly: &Assembly<'_>, q: &[f64], point: [f64; 3]) -> [f64; 3] {
    let (place, _) = position(assembly, q, element_at(assembly.model, point[0]), point);
    (place - Vector3::from(point)).into()
}

/// Displacement of the axis, or of the centre of a ring section, whose axis is empty.
pub fn axis_displacement(assembly: &Assembly<'_>, q: &[f64], x: f64) -> [f64; 3] {
    let e = element_at(assembly.model, x);
    if e.kind.basis.is_ring() {
        return Centre::new(assembly, x, &assembly.model.section_in(e, x)).displacement(q);
    }
    displacement(assembly, q, [x, 0.0, 0.0])
}

/// The probes of the model.
pub fn probe_states(assembly: &Assembly<'_>, q: &[f64]) -> Vec<ProbeState> {
    let state = |x: f64, [y, z]: [f64; 2]| point_state(assembly, q, [x, y, z]);
    assembly
        .model
        .probes
        .iter()
        .map(|probe| {
            let mut points: Vec<PointState> = probe.points.iter().map(|&p| state(probe.x, p)).collect();
            let point = if points.len() == 1 { points.pop() } else { None };
            ProbeState { name: probe.name.clone(), at_m: probe.x, point, points, growth: None }
        })
        .collect()
}

/// States along y and z of a section at x (m), and its deformed outline.
pub fn profile(assembly: &Assembly<'_>, q: &[f64], x: f64, section: &Section) -> Profile {
    let along = |axis: usize| {
        let (from, to) = (section.inner[axis], section.outer[axis]);
        (0..PROFILE_POINTS)
            .map(|k| {
                let mut point = [x, 0.0, 0.0];
                point[1 + axis] = from + (to - from) * k as f64 / (PROFILE_POINTS - 1) as f64;
                point_state(assembly, q, point)
            })
            .collect()
    };
    let outlines: Vec<Vec<[f64; 2]>> = [false, true]
        .into_iter()
        .filter(|&inner| !inner || section.is_hollow())
        .map(|inner| section.outline(inner, OUTLINE_POINTS))
        .collect();
    let centre = Centre::new(assembly, x, section).displacement(q);
    let moved = |&[y, z]: &[f64; 2]| {
        let u = displacement(assembly, q, [x, y, z]);
        [u[1] - centre[1], u[2] - centre[2]]
    };
    let outline_displacements = outlines.iter().map(|line| line.iter().map(moved).collect()).collect();
    Profile { at_m: x, along_y: along(0), along_z: along(1), outlines, outline_displacements }
}

/// The mean displacement of four opposite surface points: the section's centre, also where a bore is.
pub struct Centre {
    place: [f64; 3],
    /// First coordinate and weight of every vector that moves it.
    weights: Vec<(usize, f64)>,
}

impl Centre {
    /// The centre of the section at x (m).
    pub fn new(assembly: &Assembly<'_>, x: f64, section: &Section) -> Self {
        let e = element_at(assembly.model, x);
        let [cy, cz] = section.outer;
        let points = [[cy, 0.0], [-cy, 0.0], [0.0, cz], [0.0, -cz]];
        let shapes = points.map(|[y, z]| shape(assembly, e, [x, y, z]));
        let weight = |k: usize| shapes.iter().map(|s| s[k].1 / 4.0).sum::<f64>();
        let weights = shapes[0].iter().enumerate().map(|(k, s)| (s.0, weight(k)));
        Self { place: [x, 0.0, 0.0], weights: weights.filter(|(_, w)| *w != 0.0).collect() }
    }

    /// Its displacement for coordinates q, m.
    pub fn displacement(&self, q: &[f64]) -> [f64; 3] {
        let of = |c: usize| self.weights.iter().map(|(at, w)| w * q[at + c]).sum::<f64>() - self.place[c];
        [of(0), of(1), of(2)]
    }
}

/// Growth of half extents along y and z of an element's section at x, m: half the change of the distance between
/// opposite points.
pub fn growth_in(
    assembly: &Assembly<'_>,
    q: &[f64],
    e: &Element,
    x: f64,
    half_extents: [f64; 2],
) -> [f64; 2] {
    [0, 1].map(|axis| {
        let c = half_extents[axis];
        let place = |side: f64| {
            let mut point = [x, 0.0, 0.0];
            point[1 + axis] = side * c;
            position(assembly, q, e, point).0
        };
        (place(1.0) - place(-1.0)).norm() / 2.0 - c
    })
}

/// True where a rigid hub, end or face keeps the section from deforming: stresses there are those of its constraint.
pub fn in_rigid_hub(model: &Model, x: f64) -> bool {
    let disks = model.disks.iter().filter(|d| d.hub == Hub::Rigid).map(|d| d.node);
    let rigid = |kind: &SupportKind| {
        matches!(
            kind,
            SupportKind::Clamped(SectionHold::Rigid)
                | SupportKind::Revolute { hold: SectionHold::Rigid, .. }
                | SupportKind::Cylindrical { hold: SectionHold::Rigid, .. }
        )
    };
    let supports = model.supports.iter().filter(|s| rigid(&s.kind)).map(|s| s.node);
    let radius = model.section_in(element_at(model, x), x).outer_size();
    let faces = (0..model.nodes.len()).filter(|&node| model.nodes[node].face);
    disks.chain(supports).chain(faces).any(|node| (model.nodes[node].x - x).abs() <= HELD * radius)
}

/// Largest principal Green-Lagrange strain, by size, at three stations of every element, on its outline and axis.
pub fn largest_strain(assembly: &Assembly<'_>, q: &[f64]) -> f64 {
    let model = assembly.model;
    let mut largest: f64 = 0.0;
    for e in &model.elements {
        for share in [0.0, 0.5, 1.0] {
            let section = model.section_in(e, e.x + share * e.length);
            let mut points = section.outline(false, if section.shape == Shape::Rectangle { 8 } else { 12 });
            points.extend(if section.is_hollow() { section.outline(true, 12) } else { vec![[0.0; 2]] });
            for &[y, z] in &points {
                let (_, f) = position(assembly, q, e, [e.x + share * e.length, y, z]);
                let strain = (f.transpose() * f - Matrix3::identity()) / 2.0;
                largest = largest.max(strain.symmetric_eigenvalues().amax());
            }
        }
    }
    largest
}
