//! The beams of a scene as one system: coordinates, inertia, internal forces, loads, energies and momenta.
//!
//! All coordinates stand body by body, node by node, vector by vector; planar vectors have two components, spatial ones three.
//! Those of held nodes stay as they are, the others are the unknowns. Spatial vectors are scaled as in [`crate::element`].

use crate::element::Kernel;
use crate::element::kernel::simd::Scratch;
use crate::element::planar_2322s::{self, PlanarElement, SIZE, moment_on_vector};
use crate::element::quadrature::gauss;
use crate::error::Result;
use crate::linalg::lu::Entries;
use crate::linalg::sparse::Sparse;
use crate::model::scene::{Action, Beam, Body, Face, Hold, Scene};
use crate::shaft::assembly::Assembly;
use crate::shaft::internal_forces::{Forces, ScalarMass, Workspace};
use faer::sparse::Triplet;
use nalgebra::{DMatrix, Vector3};

/// Number of Gauss points of a pressure on a face: the integrand is of degree three.
const PRESSURE_POINTS: usize = 2;

/// Internal forces of a body.
enum BodyForces<'a> {
    Planar(Box<PlanarElement>),
    Spatial(Box<Forces<'a>>, ScalarMass),
}

/// One body among the coordinates.
struct BodyPart<'a> {
    body: &'a Body,
    first: usize,
    per_node: usize,
    forces: BodyForces<'a>,
}

/// All bodies of a scene.
pub struct Bodies<'a> {
    /// The scene that the bodies belong to.
    pub scene: &'a Scene,
    parts: Vec<BodyPart<'a>>,
    size: usize,
    /// Unknown of each coordinate.
    unknown: Vec<Option<usize>>,
    /// Coordinate of each unknown.
    free: Vec<usize>,
    reference: Vec<f64>,
    gravity: Vec<f64>,
}

/// The shafts behind spatial bodies, which [`Bodies`] borrows.
pub fn assemblies(scene: &Scene) -> Vec<Option<Assembly<'_>>> {
    scene
        .bodies
        .iter()
        .map(|body| match &body.beam {
            Beam::Planar(_) => None,
            Beam::Spatial(model) => Some(Assembly::unconstrained(model)),
        })
        .collect()
}

/// Kinetic energy and momenta of a motion.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RigidMotion {
    /// Kinetic energy, J.
    pub kinetic: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 2],
    /// About the origin, counter-clockwise, kg m^2/s.
    pub angular_momentum: f64,
}

impl<'a> Bodies<'a> {
    /// Lays out the coordinates of a scene.
    ///
    /// # Errors
    /// An element without nonlinear form.
    pub fn new(scene: &'a Scene, assemblies: &'a [Option<Assembly<'a>>]) -> Result<Self> {
        let (mut parts, mut size) = (Vec::new(), 0);
        for (body, assembly) in scene.bodies.iter().zip(assemblies) {
            let (per_node, forces) = match (&body.beam, assembly) {
                (Beam::Spatial(model), Some(assembly)) => (
                    3 * model.nodes.first().map_or(0, |n| n.n_vectors()),
                    BodyForces::Spatial(Box::new(Forces::new(assembly)?), ScalarMass::new(model)),
                ),
                (Beam::Planar(section), _) => {
                    let element = PlanarElement::new(*section, body.length / body.elements as f64);
                    (planar_2322s::PER_NODE, BodyForces::Planar(Box::new(element)))
                }
                (Beam::Spatial(_), None) => continue,
            };
            parts.push(BodyPart { body, first: size, per_node, forces });
            size += body.nodes() * per_node;
        }
        let mut held = vec![false; size];
        let components = if scene.is_planar() { 2 } else { 3 };
        for part in &parts {
            for &(node, hold) in &part.body.supports {
                let first = part.first + node * part.per_node;
                let list = match hold {
                    Hold::Clamped => 0..part.per_node,
                    Hold::Pinned => 0..components,
                    Hold::PinnedX => 0..1,
                    Hold::PinnedY => 1..2,
                };
                list.for_each(|k| held[first + k] = true);
            }
        }
        let free: Vec<usize> = (0..size).filter(|&k| !held[k]).collect();
        let mut unknown = vec![None; size];
        free.iter().enumerate().for_each(|(u, &k)| unknown[k] = Some(u));
        let mut bodies =
            Self { scene, parts, size, unknown, free, reference: Vec::new(), gravity: vec![0.0; size] };
        bodies.reference = bodies.undeformed();
        bodies.gravity = bodies.weight();
        Ok(bodies)
    }

    /// Components of a vector.
    pub fn components(&self) -> usize {
        if self.scene.is_planar() { 2 } else { 3 }
    }

    /// Number of coordinates of the whole shaft before constraints.
    pub fn len(&self) -> usize {
        self.size
    }

    /// True without any coordinate.
    pub fn is_empty(&self) -> bool {
        self.size == 0
    }

    /// Coordinate of each unknown.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// Unknown of each coordinate, `None` when it is held.
    pub fn unknown(&self) -> &[Option<usize>] {
        &self.unknown
    }

    /// First coordinate of a node of a body.
    pub fn node(&self, body: usize, node: usize) -> usize {
        self.parts[body].first + node * self.parts[body].per_node
    }

    /// The undeformed state, m (planar section vectors: 1).
    pub fn reference(&self) -> &[f64] {
        &self.reference
    }

    fn undeformed(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.size];
        for part in &self.parts {
            let body = part.body;
            let end = body.nodes() - 1;
            for node in 0..=end {
                let at = part.first + node * part.per_node;
                let along = body.length * node as f64 / end as f64;
                let place = body.start + body.frame.column(0) * along;
                match (&part.forces, &body.beam) {
                    (BodyForces::Spatial(..), Beam::Spatial(model)) => {
                        q[at..at + 3].copy_from_slice(place.as_slice());
                        for axis in [1, 2] {
                            let vector = body.frame.column(axis) * model.reference_length;
                            q[at + 3 * axis..at + 3 * axis + 3].copy_from_slice(vector.as_slice());
                        }
                    }
                    _ => {
                        let up = body.frame.column(1);
                        q[at..at + 4].copy_from_slice(&[place.x, place.y, up.x, up.y]);
                    }
                }
            }
        }
        q
    }

    /// Velocity at the start, m/s.
    pub fn initial_velocity(&self) -> Vec<f64> {
        let mut v = self.uniform(|_, body| body.velocity);
        v.iter_mut().zip(&self.unknown).filter(|(_, u)| u.is_none()).for_each(|(v, _)| *v = 0.0);
        v
    }

    /// A translation of each body.
    fn uniform(&self, of: impl Fn(usize, &Body) -> Vector3<f64>) -> Vec<f64> {
        let mut x = vec![0.0; self.size];
        for (index, part) in self.parts.iter().enumerate() {
            let value = of(index, part.body);
            for node in 0..part.body.nodes() {
                let at = part.first + node * part.per_node;
                for c in 0..self.components() {
                    x[at + c] = value[c];
                }
            }
        }
        x
    }

    /// The weight of the bodies on which gravity acts.
    fn weight(&self) -> Vec<f64> {
        let acceleration =
            self.uniform(|_, body| if body.gravity { self.scene.gravity } else { Vector3::zeros() });
        let mut weight = vec![0.0; self.size];
        self.mass_times(&acceleration, &mut weight);
        weight
    }

    /// Mass of a body, kg.
    pub fn mass_of(&self, body: usize) -> f64 {
        let one = self.uniform(|index, _| if index == body { Vector3::x() } else { Vector3::zeros() });
        let mut y = vec![0.0; self.size];
        self.mass_times(&one, &mut y);
        one.iter().zip(&y).map(|(a, b)| a * b).sum()
    }

    /// Whether gravity acts at all.
    pub fn has_gravity(&self) -> bool {
        self.gravity.iter().any(|g| *g != 0.0)
    }

    /// `- sum m g . r`, J, zero in the undeformed state.
    pub fn gravity_potential(&self, q: &[f64]) -> f64 {
        self.gravity.iter().zip(q.iter().zip(&self.reference)).map(|(g, (q, r))| -g * (q - r)).sum()
    }

    /// `y = M x` on all coordinates.
    pub fn mass_times(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for part in &self.parts {
            match &part.forces {
                BodyForces::Planar(element) => {
                    let mass = element.mass();
                    for e in 0..part.body.elements {
                        let at = part.first + 2 * e * planar_2322s::PER_NODE;
                        for (i, row) in mass.iter().enumerate() {
                            for (j, pair) in row.iter().enumerate() {
                                for c in 0..planar_2322s::PER_NODE {
                                    y[at + planar_2322s::PER_NODE * i + c] +=
                                        pair[c / 2] * x[at + planar_2322s::PER_NODE * j + c];
                                }
                            }
                        }
                    }
                }
                BodyForces::Spatial(_, mass) => {
                    let range = part.first..part.first + part.body.nodes() * part.per_node;
                    mass.multiply(&x[range.clone()], &mut y[range]);
                }
            }
        }
    }

    /// Mass matrix of the unknowns of planar bodies.
    ///
    /// # Errors
    /// Lack of memory.
    pub fn mass(&self) -> Result<Sparse> {
        let mut list = Vec::new();
        self.mass_entries(1.0, &mut |i, j, value| list.push(Triplet::new(i, j, value)));
        Sparse::try_new_from_triplets(self.free.len(), self.free.len(), &list).map_err(|e| {
            crate::error::Error::analysis(
                "the mass matrix could not be summed",
                format!("{} entries: {e:?}", list.len()),
                "take fewer elements",
            )
        })
    }

    /// Adds `factor M` of planar bodies.
    pub fn add_mass(&self, factor: f64, entries: &mut Entries) {
        self.mass_entries(factor, &mut |i, j, value| entries.add(i, j, value));
    }

    fn mass_entries(&self, factor: f64, add: &mut dyn FnMut(usize, usize, f64)) {
        for (element, at) in self.planar_elements() {
            for (i, row) in element.mass().iter().enumerate() {
                for (j, pair) in row.iter().enumerate() {
                    for c in 0..planar_2322s::PER_NODE {
                        let places = [i, j].map(|n| self.unknown[at + planar_2322s::PER_NODE * n + c]);
                        if let [Some(row), Some(column)] = places {
                            add(row, column, factor * pair[c / 2]);
                        }
                    }
                }
            }
        }
    }

    /// Internal force `dU/dq` into `force`; returns the strain energy U, J.
    pub fn internal_force(&self, q: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let mut energy = 0.0;
        for part in &self.parts {
            let range = part.first..part.first + part.body.nodes() * part.per_node;
            match &part.forces {
                BodyForces::Planar(element) => {
                    let (mut f, scratch) = ([0.0; SIZE], &mut Scratch::default());
                    for e in 0..part.body.elements {
                        let at = part.first + 2 * e * planar_2322s::PER_NODE;
                        energy += element.internal_force(&q[at..at + SIZE], None, &mut f, scratch);
                        force[at..at + SIZE].iter_mut().zip(f).for_each(|(t, f)| *t += f);
                    }
                }
                BodyForces::Spatial(forces, _) => {
                    energy += forces.internal_force(
                        &q[range.clone()],
                        None,
                        &mut force[range],
                        &mut Workspace::default(),
                    );
                }
            }
        }
        energy
    }

    /// Adds the tangent `d internal_force/dq`.
    pub fn add_tangent(&self, q: &[f64], entries: &mut Entries) {
        let mut k = [0.0; SIZE * SIZE];
        for part in &self.parts {
            match &part.forces {
                BodyForces::Planar(element) => {
                    for e in 0..part.body.elements {
                        let at = part.first + 2 * e * planar_2322s::PER_NODE;
                        element.tangent(&q[at..at + SIZE], &mut k, &mut Scratch::default());
                        self.add_square(at, SIZE, &|i, j| k[SIZE * j + i], entries);
                    }
                }
                BodyForces::Spatial(forces, _) => {
                    let range = part.first..part.first + part.body.nodes() * part.per_node;
                    for (e, k) in forces.element_tangents(&q[range]).iter().enumerate() {
                        let at = part.first + e * part.body.degree() * part.per_node;
                        self.add_square(at, k.nrows(), &|i, j| k[(i, j)], entries);
                    }
                }
            }
        }
    }

    /// Adds a square matrix on the coordinates from `at` on.
    fn add_square(&self, at: usize, size: usize, k: &dyn Fn(usize, usize) -> f64, entries: &mut Entries) {
        for i in 0..size {
            let Some(row) = self.unknown[at + i] else { continue };
            for j in 0..size {
                if let Some(column) = self.unknown[at + j] {
                    entries.add(row, column, k(i, j));
                }
            }
        }
    }

    /// Bound of the angular frequencies of planar bodies as they are placed, rad/s: the largest of an element alone,
    /// `K_e x = w^2 M_e x`, which no assembly of such elements exceeds (Irons and Treharne 1971).
    pub fn fastest_vibration(&self) -> f64 {
        let of_part = |part: &BodyPart<'_>| {
            let BodyForces::Planar(element) = &part.forces else { return 0.0 };
            let mut k = vec![0.0; SIZE * SIZE];
            let q = &self.reference[part.first..part.first + SIZE];
            element.tangent(q, &mut k, &mut Scratch::default());
            let mass = element.mass();
            let n = planar_2322s::PER_NODE;
            let m = DMatrix::from_fn(SIZE, SIZE, |i, j| {
                if i % n == j % n { mass[i / n][j / n][i % n / 2] } else { 0.0 }
            });
            let Some(factor) = m.cholesky() else { return 0.0 };
            let k = DMatrix::from_vec(SIZE, SIZE, k);
            let Some(half) = factor.l().solve_lower_triangular(&k) else { return 0.0 };
            let Some(whole) = factor.l().solve_lower_triangular(&half.transpose()) else { return 0.0 };
            whole.symmetric_eigenvalues().max().max(0.0).sqrt()
        };
        self.parts.iter().map(of_part).fold(0.0, f64::max)
    }

    /// Strain energy of planar bodies, J.
    pub fn strain_energy(&self, q: &[f64]) -> f64 {
        self.planar_elements().map(|(element, at)| element.energy(&q[at..at + SIZE])).sum()
    }

    /// Elements of planar bodies with their first coordinates.
    fn planar_elements(&self) -> impl Iterator<Item = (&PlanarElement, usize)> {
        self.parts.iter().flat_map(|part| {
            let element = match &part.forces {
                BodyForces::Planar(element) => Some(&**element),
                BodyForces::Spatial(..) => None,
            };
            let places = (0..part.body.elements).map(|e| part.first + 2 * e * planar_2322s::PER_NODE);
            element.into_iter().flat_map(move |element| places.clone().map(move |at| (element, at)))
        })
    }

    /// Force of planar bodies whose work from `q0` to `q1` is the change of the strain energy; with `entries` its derivative by
    /// `q1` is added there.
    pub fn average_force(
        &self,
        q0: &[f64],
        q1: &[f64],
        force: &mut [f64],
        mut entries: Option<&mut Entries>,
    ) {
        force.fill(0.0);
        let (mut f, mut k) = ([0.0; SIZE], [0.0; SIZE * SIZE]);
        for (element, at) in self.planar_elements() {
            let range = at..at + SIZE;
            let tangent = entries.is_some().then_some(&mut k[..]);
            element.average_force(&q0[range.clone()], &q1[range.clone()], &mut f, tangent);
            force[range].iter_mut().zip(f).for_each(|(t, f)| *t += f);
            if let Some(entries) = entries.as_deref_mut() {
                self.add_square(at, SIZE, &|i, j| k[SIZE * j + i], entries);
            }
        }
    }

    /// Loads and gravity at the state `q` and time `t` (s), times `factor`, into `force`; with `entries`, `scale` times the
    /// negative derivative by q is added there.
    pub fn loads(
        &self,
        q: &[f64],
        t: f64,
        factor: f64,
        force: &mut [f64],
        mut entries: Option<(&mut Entries, f64)>,
    ) {
        force.iter_mut().zip(&self.gravity).for_each(|(f, g)| *f = factor * g);
        let components = self.components();
        for (index, part) in self.parts.iter().enumerate() {
            for load in part.body.loads.iter().filter(|load| t <= load.until) {
                match load.action {
                    Action::Force(node, value) => {
                        let at = self.node(index, node);
                        for c in 0..components {
                            force[at + c] += factor * value[c];
                        }
                    }
                    Action::Moment(node, moment) => {
                        let at = self.node(index, node) + 2;
                        let b = [q[at], q[at + 1]];
                        let moment = factor * moment;
                        let f = moment_on_vector(moment, b);
                        force[at] += f[0];
                        force[at + 1] += f[1];
                        if let Some((entries, scale)) = entries.as_mut() {
                            // d (-b2, b1)/|b|^2 / db
                            let n2 = b[0] * b[0] + b[1] * b[1];
                            let turned = [-b[1], b[0]];
                            let plain = [[0.0, -1.0], [1.0, 0.0]];
                            for i in 0..2 {
                                for j in 0..2 {
                                    let value =
                                        moment * (plain[i][j] / n2 - 2.0 * turned[i] * b[j] / (n2 * n2));
                                    self.add(at + i, at + j, -*scale * value, entries);
                                }
                            }
                        }
                    }
                    Action::Pressure(face, pressure) => {
                        let scaled = factor * pressure * part.body.width;
                        for curve in self.face(index, face) {
                            self.pressure(&curve, scaled, q, force, entries.as_mut());
                        }
                    }
                }
            }
        }
    }

    /// Adds an entry for two coordinates.
    fn add(&self, row: usize, column: usize, value: f64, entries: &mut Entries) {
        if let (Some(row), Some(column)) = (self.unknown[row], self.unknown[column]) {
            entries.add(row, column, value);
        }
    }

    /// `- p int L n dA` on the curve of a face: with the tangent t = (t1, t2) of a counter-clockwise boundary `n ds = (t2, -t1)`.
    fn pressure(
        &self,
        curve: &CurvePoints,
        pressure: f64,
        q: &[f64],
        force: &mut [f64],
        mut entries: Option<&mut (&mut Entries, f64)>,
    ) {
        for (zeta, weight) in gauss(PRESSURE_POINTS) {
            let (l, d) = (planar_2322s::values(zeta), planar_2322s::slopes(zeta));
            let mut t = Vector3::zeros();
            for (i, point) in curve.iter().enumerate() {
                t += point.place(q) * d[i];
            }
            let f = [-t.y, t.x].map(|v| v * pressure * weight);
            for (i, point) in curve.iter().enumerate() {
                for (vector, factor) in [(0, 1.0), (2, point.height)] {
                    for c in 0..2 {
                        force[point.node + vector + c] += l[i] * factor * f[c];
                    }
                    let Some((entries, scale)) = entries.as_deref_mut() else { continue };
                    for (j, other) in curve.iter().enumerate() {
                        for (other_vector, other_factor) in [(0, 1.0), (2, other.height)] {
                            let value = pressure * weight * l[i] * factor * d[j] * other_factor;
                            let (row, column) = (point.node + vector, other.node + other_vector);
                            self.add(row, column + 1, *scale * value, entries);
                            self.add(row + 1, column, -*scale * value, entries);
                        }
                    }
                }
            }
        }
    }

    /// The curves of a face of a planar body, counter-clockwise about it.
    pub fn face(&self, body: usize, face: Face) -> Vec<CurvePoints> {
        let part = &self.parts[body];
        let half = part.body.height / 2.0;
        let at = |node: usize, height: f64| CurvePoint { node: self.node(body, node), height };
        let (elements, end) = (part.body.elements, part.body.nodes() - 1);
        match face {
            Face::Bottom => (0..elements).map(|e| [0, 1, 2].map(|i| at(2 * e + i, -half))).collect(),
            Face::Top => (0..elements).rev().map(|e| [2, 1, 0].map(|i| at(2 * e + i, half))).collect(),
            Face::End => vec![[-half, 0.0, half].map(|y| at(end, y))],
            Face::Start => vec![[half, 0.0, -half].map(|y| at(0, y))],
        }
    }

    /// Kinetic energy and momenta of planar bodies.
    pub fn motion(&self, q: &[f64], v: &[f64]) -> RigidMotion {
        let mut momentum = vec![0.0; self.size];
        self.mass_times(v, &mut momentum);
        let mut motion = RigidMotion {
            kinetic: 0.5 * v.iter().zip(&momentum).map(|(v, p)| v * p).sum::<f64>(),
            ..RigidMotion::default()
        };
        for node in (0..self.size).step_by(planar_2322s::PER_NODE) {
            let (q, p) = (&q[node..node + 4], &momentum[node..node + 4]);
            motion.momentum[0] += p[0];
            motion.momentum[1] += p[1];
            motion.angular_momentum += q[0] * p[1] - q[1] * p[0] + q[2] * p[3] - q[3] * p[2];
        }
        motion
    }
}

/// A node of a curve: the section's point at that height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// First coordinate of the node.
    pub node: usize,
    /// y in the section, m.
    pub height: f64,
}

/// Three points of a quadratic curve at -1, 0, 1.
pub type CurvePoints = [CurvePoint; 3];

impl CurvePoint {
    /// `r + y r_,y`.
    pub fn place(&self, q: &[f64]) -> Vector3<f64> {
        let v = &q[self.node..self.node + 4];
        Vector3::new(v[0] + self.height * v[2], v[1] + self.height * v[3], 0.0)
    }
}
