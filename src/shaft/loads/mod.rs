//! Loads as forces on all coordinates: those fixed in space once and for all, and those that depend on where the shaft is.
//!
//! A force acts on the mean displacement of a section (or of a boundary of it), a moment on its mean rotation, a pressure on
//! the surface as it is. Axes are fixed in space unless a load follows. "Dead" moments and pressures are the tractions of
//! the undeformed shaft, whatever the motion. Source: docs/theory/loads.md#loads.

mod section;
mod surface;

use crate::element::basis::{evaluate, lagrange};
use crate::element::boundary_curve::{LinePoint, line};
use crate::element::quadrature::gauss;
use crate::model::{Element, Load, LoadKind, Model, Reading, SurfaceLoad, Traction};
use crate::section::Surface;
use crate::shaft::attachments::{
    Contribution, Numbering, Region, bearing_rows, displacement_weights, functions,
};
use crate::shaft::internal_forces::ScalarMass;
use section::SectionLoad;
use surface::ElementSurface;

/// Axes of the frame in which coordinates are given, turned about x from those fixed in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// Sine of the angle.
    pub sin: f64,
    /// Cosine of the angle.
    pub cos: f64,
}

impl Turned {
    /// Coordinates in axes fixed in space.
    pub const NOT: Self = Self { sin: 0.0, cos: 1.0 };

    /// A vector in the turned axes as seen from the space.
    pub fn in_space(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [x, self.cos * y - self.sin * z, self.sin * y + self.cos * z]
    }

    /// A vector of the space in the turned axes.
    pub fn seen(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [x, self.cos * y + self.sin * z, self.cos * z - self.sin * y]
    }
}

/// A load: forces on all coordinates (N) that are fixed in space, or a law.
enum LoadLaw {
    /// Forces on all coordinates (N) that keep their size and their direction in space.
    Fixed(Vec<f64>),
    /// A law whose forces depend on the displacement and rotation of one section.
    Section(SectionLoad),
    /// Laws whose forces depend on the places of points of the surface, one for each loaded element.
    Surface(Vec<ElementSurface>),
}

/// Which of the loads of a case act in an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// All loads of the case, and gravity.
    All,
    /// Those that do not change in the frame that turns with the shaft: what follows, pressure, and whatever acts along or
    /// about x.
    ConstantInTurningFrame,
    /// No load, and no gravity.
    None,
}

/// The loads of a model.
pub struct Loads {
    /// Sum of gravity, of all loads that are fixed in space and of the pull of bearings that stand beside the axis, on all
    /// coordinates, N.
    fixed: Vec<f64>,
    /// Every load: its path in the case (`loads.0`) and its law.
    list: Vec<(String, LoadLaw)>,
}

impl Loads {
    /// Prepares the loads of a model.
    pub fn new(model: &Model, numbering: &Numbering, mass: &ScalarMass, which: Which) -> Self {
        let mut list = Vec::new();
        let mut fixed = vec![0.0; numbering.len()];
        if which != Which::None {
            let turning = which == Which::ConstantInTurningFrame;
            let acts = |constant: bool| !turning || constant;
            for load in model.loads.iter().filter(|load| acts(load.is_constant_in_turning_frame())) {
                list.push((load.path.clone(), nodal(model, numbering, load, &mut fixed)));
            }
            for traction in model.tractions.iter().filter(|t| acts(t.is_constant_in_turning_frame())) {
                list.push((traction.path.clone(), spread(model, numbering, traction, &mut fixed)));
            }
            let [x, y, z] = model.gravity;
            let gravity = if turning { [x, 0.0, 0.0] } else { [x, y, z] };
            if gravity != [0.0; 3] {
                let weight = weight(model, numbering, mass, gravity);
                fixed.iter_mut().zip(&weight).for_each(|(sum, w)| *sum += w);
            }
            if !turning {
                add_pull_of_offsets(model, numbering, &mut fixed);
            }
        }
        Self { fixed, list }
    }

    /// Forces fixed in space on all coordinates, N.
    pub fn fixed(&self) -> &[f64] {
        &self.fixed
    }

    /// True when some force depends on where the shaft is.
    pub fn depend_on_place(&self) -> bool {
        self.list.iter().any(|(_, law)| !matches!(law, LoadLaw::Fixed(_)))
    }

    /// Adds a factor times all forces in a place q, whose axes are turned.
    pub fn add(&self, q: &[f64], axes: Turned, factor: f64, force: &mut [f64]) {
        for (f, load) in force.chunks_exact_mut(3).zip(self.fixed.chunks_exact(3)) {
            f[0] += factor * load[0];
            f[1] += factor * (axes.cos * load[1] + axes.sin * load[2]);
            f[2] += factor * (axes.cos * load[2] - axes.sin * load[1]);
        }
        for (_, law) in &self.list {
            law.add(q, axes, factor, force);
        }
    }

    /// Derivatives of the forces that depend on the place, `d force / d q`, without symmetry.
    pub fn tangents(&self, q: &[f64], axes: Turned) -> Vec<Contribution> {
        let mut list = Vec::new();
        for (_, law) in &self.list {
            match law {
                LoadLaw::Fixed(_) => {}
                LoadLaw::Section(load) => list.push(load.tangent(q, axes)),
                LoadLaw::Surface(elements) => list.extend(elements.iter().map(|e| e.tangent(q))),
            }
        }
        list
    }

    /// Power of the forces that depend on the place, W.
    pub fn power_without_potential(&self, q: &[f64], velocity: &[f64], axes: Turned) -> f64 {
        let moving = self.list.iter().filter(|(_, law)| !matches!(law, LoadLaw::Fixed(_)));
        moving.map(|(_, law)| law.power(q, velocity, axes)).sum()
    }

    /// Power of every load, W, with its path in the case; `velocity` as seen from space, in the axes of q.
    pub fn powers(&self, q: &[f64], velocity: &[f64], axes: Turned) -> Vec<(&str, f64)> {
        self.list.iter().map(|(path, law)| (path.as_str(), law.power(q, velocity, axes))).collect()
    }
}

impl LoadLaw {
    fn add(&self, q: &[f64], axes: Turned, factor: f64, force: &mut [f64]) {
        match self {
            Self::Fixed(_) => {}
            Self::Section(load) => load.add(q, axes, factor, force),
            Self::Surface(elements) => elements.iter().for_each(|e| e.add(q, factor, force)),
        }
    }

    fn power(&self, q: &[f64], velocity: &[f64], axes: Turned) -> f64 {
        if let Self::Fixed(force) = self {
            let pairs = force.chunks_exact(3).zip(velocity.chunks_exact(3));
            let one = |(f, v): (&[f64], &[f64])| {
                let f = axes.seen([f[0], f[1], f[2]]);
                (0..3).map(|c| f[c] * v[c]).sum::<f64>()
            };
            return pairs.map(one).sum();
        }
        let mut force = vec![0.0; q.len()];
        self.add(q, axes, 1.0, &mut force);
        force.iter().zip(velocity).map(|(f, v)| f * v).sum()
    }
}

/// Tractions and pressures, element by element: the same forces as those of [`Loads`].
pub struct Spread {
    /// First coordinate and force `[x, y, z]` in the space, N.
    fixed: Vec<Vec<(usize, [f64; 3])>>,
    following: Vec<Vec<ElementSurface>>,
}

impl Spread {
    /// Prepares the loads on the surface of every element.
    pub fn new(model: &Model, numbering: &Numbering) -> Self {
        let follows = |t: &&Traction| t.reading == Reading::Following;
        let fixed = |e: &Element| {
            let mut force = vec![0.0; numbering.len()];
            for traction in model.tractions.iter().filter(|t| !follows(t)) {
                add_dead_traction(model, numbering, e, traction, &mut force);
            }
            let triples = force.chunks_exact(3).enumerate().filter(|(_, f)| *f != [0.0; 3]);
            triples.map(|(k, f)| (3 * k, [f[0], f[1], f[2]])).collect()
        };
        let following = |e: &Element| {
            let loads = model.tractions.iter().filter(follows);
            loads.map(|t| ElementSurface::new(model, numbering, e, t)).collect()
        };
        if model.tractions.is_empty() {
            return Self { fixed: Vec::new(), following: Vec::new() };
        }
        Self {
            fixed: model.elements.iter().map(fixed).collect(),
            following: model.elements.iter().map(following).collect(),
        }
    }

    /// Adds a factor times the forces on one element in a place q, whose axes are turned.
    pub fn add(&self, element: usize, q: &[f64], axes: Turned, factor: f64, force: &mut [f64]) {
        for &(at, f) in self.fixed.get(element).into_iter().flatten() {
            let f = axes.seen(f);
            (0..3).for_each(|c| force[at + c] += factor * f[c]);
        }
        self.following.get(element).into_iter().flatten().for_each(|load| load.add(q, factor, force));
    }
}

/// A law fixed in space, whose forces `add` adds: to those of all others and to its own.
fn fixed_in_space(add: impl Fn(&mut [f64]), all: &mut [f64]) -> LoadLaw {
    let mut own = vec![0.0; all.len()];
    add(all);
    add(&mut own);
    LoadLaw::Fixed(own)
}

fn nodal(model: &Model, numbering: &Numbering, load: &Load, all: &mut [f64]) -> LoadLaw {
    match (load.kind, load.reading) {
        (LoadKind::Force(f), Reading::FixedInSpace | Reading::Dead) => {
            let weights = displacement_weights(model, load.node, load.acts_on);
            let add = |force: &mut [f64]| {
                for (k, w) in weights.iter().enumerate() {
                    (0..3).for_each(|c| force[numbering.index(load.node, k, c)] += w * f[c]);
                }
            };
            fixed_in_space(add, all)
        }
        (LoadKind::Moment(m), Reading::Dead) => {
            fixed_in_space(|force| add_dead_moment(model, numbering, load, m, force), all)
        }
        _ => LoadLaw::Section(SectionLoad::new(model, numbering, load)),
    }
}

fn spread(model: &Model, numbering: &Numbering, traction: &Traction, all: &mut [f64]) -> LoadLaw {
    if traction.reading == Reading::Following {
        let elements = model.elements.iter().map(|e| ElementSurface::new(model, numbering, e, traction));
        return LoadLaw::Surface(elements.collect());
    }
    let add = |force: &mut [f64]| {
        model.elements.iter().for_each(|e| add_dead_traction(model, numbering, e, traction, force));
    };
    fixed_in_space(add, all)
}

/// `K d` of every bearing that stands at d beside the undeformed axis: with it the springs' force `-K u` becomes `K (d - u)`.
fn add_pull_of_offsets(model: &Model, numbering: &Numbering, force: &mut [f64]) {
    for bearing in model.bearings.iter().filter(|b| b.offset != [0.0; 2]) {
        let pull = bearing.stiffness.map(|[y, z]| y * bearing.offset[0] + z * bearing.offset[1]);
        for (row, pull) in bearing_rows(model, numbering, bearing).iter().zip(pull) {
            row.iter().for_each(|&(at, w)| force[at] += w * pull);
        }
    }
}

/// Weight of shaft and disks on all coordinates, N.
fn weight(model: &Model, numbering: &Numbering, mass: &ScalarMass, gravity: [f64; 3]) -> Vec<f64> {
    let mut acceleration = vec![0.0; numbering.len()];
    for node in 0..model.nodes.len() {
        for first in numbering.fields(node) {
            acceleration[first..first + 3].copy_from_slice(&gravity);
        }
    }
    let mut force = vec![0.0; numbering.len()];
    mass.multiply(&acceleration, &mut force);
    force
}

/// Tractions `t = m_x / (I_yy + I_zz) (0, -z, y) + (m_y z / I_zz - m_z y / I_yy, 0, 0)` over the section or a boundary, with
/// `I_yy = int y^2`; on the axis the same moments by couples on r_,y and r_,z.
fn add_dead_moment(model: &Model, numbering: &Numbering, load: &Load, m: [f64; 3], force: &mut [f64]) {
    let r = model.reference_length;
    let mut add = |k: usize, c: usize, value: f64| force[numbering.index(load.node, k, c)] += value;
    let Some(region) = Region::new(model, load.node, load.acts_on) else {
        add(1, 2, m[0] / (2.0 * r));
        add(2, 1, -m[0] / (2.0 * r));
        add(2, 0, m[1] / r);
        add(1, 0, -m[2] / r);
        return;
    };
    let (yy, zz) = (region.moment(2, 0), region.moment(0, 2));
    let (with_y, with_z) = (region.integrals(1, 0), region.integrals(0, 1));
    for (k, (with_y, with_z)) in with_y.into_iter().zip(with_z).enumerate() {
        add(k, 0, m[1] * with_z / zz - m[2] * with_y / yy);
        add(k, 1, -m[0] * with_z / (yy + zz));
        add(k, 2, m[0] * with_y / (yy + zz));
    }
}

fn add_dead_traction(model: &Model, numbering: &Numbering, e: &Element, t: &Traction, force: &mut [f64]) {
    let line = line(&model.sections[e.section], t.surface);
    let along: Vec<f64> = lagrange(e.kind.axial_degree)
        .iter()
        .map(|l| gauss(e.kind.axial_degree).iter().map(|&(xi, w)| w * evaluate(l, xi) * e.length / 2.0).sum())
        .collect();
    let functions = functions(model, e.field());
    // halves are not symmetric about z
    let whole = matches!(t.surface, Surface::Bore | Surface::Rim);
    let around = |odd: [bool; 2], weight: &dyn Fn(&LinePoint) -> f64| {
        if whole { functions.along(&line, odd, weight) } else { functions.along_any(&line, weight) }
    };
    let length = |p: &LinePoint| p.length;
    let components: [Vec<f64>; 3] = match t.load {
        SurfaceLoad::Traction(t) => {
            let around = around([false, false], &length);
            t.map(|t| around.iter().map(|a| t * a).collect())
        }
        SurfaceLoad::Pressure(p) => [
            vec![0.0; e.n_vectors()],
            around([true, false], &|point| -p * point.normal[0]),
            around([false, true], &|point| -p * point.normal[1]),
        ],
    };
    for (c, around) in components.into_iter().enumerate() {
        for (k, around) in around.into_iter().enumerate() {
            for (i, length) in along.iter().enumerate() {
                force[numbering.of_element(e, i) + 3 * k + c] += around * length;
            }
        }
    }
}
