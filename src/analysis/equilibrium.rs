//! States of equilibrium: Newton's method with line search on
//!
//! ```text
//!     g(z) = T^T [ F(q) + B u + Omega D q + Omega^2 M J^2 q - lambda f(q) ] = 0,    q = q0 + T z
//! ```
//!
//! (B bearings, D what damping by space and by bearings feels of the rotation, f loads) in the frame that turns with the
//! shaft. Convergence is measured by energies, so it does not depend on units. Motions that nothing resists are pinned.
//! Source: docs/theory/motion.md#equilibrium and
//! docs/theory/linear-rotordynamics.md#stiffness-at-speed.

use crate::error::Result;
use crate::linalg::dot;
use crate::linalg::sparse::{Sparse, combine, multiply, symmetric_part};
use crate::model::{Bearing, Element};
use crate::shaft::acting::Acting;
use crate::shaft::assembly::{Assembly, RigidMotion, dragged};
use crate::shaft::attachments::bearing_rows;
use crate::shaft::internal_forces::{Forces, ScalarMass, Workspace};
use crate::shaft::loads::{Loads, Turned, Which};
use crate::shaft::spectrum::Flexibility;
use faer::{Mat, Scale};

/// Smallest share of the load by which a step may advance.
const SMALLEST_LOAD_STEP: f64 = 1.0 / 1024.0;
/// Share of the energy below which a correction that no longer shrinks is rounding.
const ROUNDING_ENERGY_SHARE: f64 = 1e-13;
/// Strain whose energy is rounding.
const ROUNDING_STRAIN: f64 = 1e-14;
/// Length of an element over its radius below which rounding of its ends' places makes more strain than that.
const SHORT: f64 = 0.1;

/// The forces on a shaft at constant speed under its loads.
pub struct Balance<'a> {
    /// Numbering, constraints and matrices of the shaft.
    pub assembly: &'a Assembly<'a>,
    /// Internal forces of elements and hubs.
    pub forces: Forces<'a>,
    /// Mass of all coordinates.
    pub mass: ScalarMass,
    /// Undeformed state q0.
    pub reference: Vec<f64>,
    /// Loads that act in the equilibrium.
    pub loads: Loads,
    /// Spin speed, rad/s.
    pub speed: f64,
    /// Energy of rounding, J.
    rounding: f64,
    bearings: Sparse,
    /// What damping by space and by bearings feels of the rotation, per unit speed; none where it does not act.
    drag: Option<Sparse>,
    external: Option<ScalarMass>,
    /// The tangent is not symmetric: bearings with cross-coupling, damping, or loads that depend on the place.
    skew: bool,
    free_mass: Sparse,
    centrifugal: Sparse,
    motions: Mat<f64>,
    /// Names of the motions that nothing resists.
    pub unresisted: Vec<RigidMotion>,
}

/// States that an extrapolation goes through.
const PATH: usize = 4;

/// How Newton's method is run.
#[derive(Debug, Clone, Copy)]
pub struct NewtonSettings {
    /// Number of equal steps in which the load is applied.
    pub load_steps: usize,
    /// Most iterations of a step.
    pub max_iterations: usize,
    /// Relative energy of the last correction.
    pub tolerance: f64,
}

/// A state of equilibrium, or the last one found.
#[derive(Debug, Clone)]
pub struct Equilibrium {
    /// Displacements in the free coordinates.
    pub z: Vec<f64>,
    /// Share of the load it carries; 1 when the analysis succeeded.
    pub load_factor: f64,
    /// Load steps taken.
    pub steps: usize,
    /// Steps that were cut.
    pub cuts: usize,
    /// Newton iterations in all.
    pub iterations: usize,
    /// Relative energy of the last correction.
    pub residual: f64,
    /// Directions in which the state is unstable (negative pivots of the tangent).
    pub unstable: usize,
}

impl<'a> Balance<'a> {
    /// Prepares the forces of a model. In the steady state of a turning shaft
    /// ([`Which::ConstantInTurningFrame`]) damping by bearings and by space acts.
    ///
    /// # Errors
    /// An element without nonlinear form.
    pub fn new(assembly: &'a Assembly<'a>, which: Which, speed: f64) -> Result<Self> {
        let (model, numbering) = (assembly.model, &assembly.numbering);
        let forces = Forces::new(assembly)?;
        let mass = ScalarMass::new(model);
        let loads = Loads::new(model, numbering, &mass, which);
        let turns = which == Which::ConstantInTurningFrame && speed != 0.0;
        let external = turns && model.materials.iter().any(|m| m.mass_damping != 0.0);
        let damped = turns && model.bearings.iter().any(|b| b.damps());
        let drag = (damped || external).then(|| assembly.rotating_damping());
        let crossed = Bearing::couples;
        let skew = drag.is_some() || loads.depend_on_place() || model.bearings.iter().any(crossed);
        let (unresisted, motions) = assembly.rigid_motions();
        let modulus = |e: &Element| {
            let short = (SHORT * model.sections[e.section].outer_size() / e.length).max(1.0);
            model.materials[e.material].youngs_modulus
                * model.sections[e.section].area()
                * e.length
                * short
                * short
        };
        Ok(Self {
            rounding: ROUNDING_STRAIN.powi(2) * model.elements.iter().map(modulus).sum::<f64>(),
            reference: forces.reference(),
            bearings: assembly.bearing_stiffness(),
            free_mass: assembly.mass(),
            centrifugal: assembly.centrifugal(),
            assembly,
            forces,
            mass,
            loads,
            drag,
            external: external.then(|| ScalarMass::external_damping(model)),
            skew,
            speed,
            motions,
            unresisted,
        })
    }

    /// `q0 + T z`.
    pub fn coordinates(&self, z: &[f64]) -> Vec<f64> {
        let mut q = self.assembly.expand(z);
        q.iter_mut().zip(&self.reference).for_each(|(q, q0)| *q += q0);
        q
    }

    /// Forces out of balance on all coordinates without the bearings' (which act on free coordinates), and the
    /// strain energy.
    fn imbalance(&self, q: &[f64], load: f64, speed: f64, work: &mut Workspace) -> (Vec<f64>, f64) {
        let mut g = vec![0.0; q.len()];
        let energy = self.forces.internal_force(q, None, &mut g, work);
        self.subtract_outer(q, load, speed, &mut g);
        (g, energy)
    }

    /// Subtracts centrifugal pull and a share of the loads, and adds what damping by space takes.
    fn subtract_outer(&self, q: &[f64], load: f64, speed: f64, g: &mut [f64]) {
        if speed != 0.0 {
            let mut turning = q.to_vec();
            turning.iter_mut().step_by(3).for_each(|x| *x = 0.0);
            let mut pull = vec![0.0; q.len()];
            self.mass.multiply(&turning, &mut pull);
            g.iter_mut().zip(&pull).for_each(|(g, p)| *g -= speed * speed * p);
        }
        if let Some(external) = &self.external {
            let mut felt = vec![0.0; q.len()];
            external.multiply(&cross(q), &mut felt);
            g.iter_mut().zip(&felt).for_each(|(g, f)| *g += speed * f);
        }
        self.loads.add(q, Turned::NOT, -load, g);
    }

    /// `g(z)` and the strain energy (J).
    fn residual(&self, z: &[f64], load: f64, speed: f64, work: &mut Workspace) -> (Vec<f64>, f64) {
        let q = self.coordinates(z);
        let (mut all, energy) = self.imbalance(&q, load, speed, work);
        if self.drag.is_some() {
            self.add_bearing_drag(&q, speed, &mut all);
        }
        let mut g = vec![0.0; z.len()];
        self.assembly.project(&all, &mut g);
        let z = Mat::from_fn(z.len(), 1, |i, _| z[i]);
        let springs = multiply(&self.bearings, z.as_ref());
        g.iter_mut().enumerate().for_each(|(i, g)| *g += springs[(i, 0)]);
        (g, energy)
    }

    /// Adds `Omega C J u` of every bearing: a section at rest in the turning frame moves with `Omega J u`.
    fn add_bearing_drag(&self, q: &[f64], speed: f64, force: &mut [f64]) {
        let drag = |b: &Bearing, [y, z]: [f64; 2]| {
            dragged(b, b.damping).map(|[on_y, on_z]| speed * (on_y * y + on_z * z))
        };
        self.add_of_bearings(q, drag, force);
    }

    /// Adds forces of bearings by the displacements that they feel.
    fn add_of_bearings(&self, q: &[f64], law: impl Fn(&Bearing, [f64; 2]) -> [f64; 2], force: &mut [f64]) {
        let (model, numbering) = (self.assembly.model, &self.assembly.numbering);
        for bearing in &model.bearings {
            let rows = bearing_rows(model, numbering, bearing);
            let felt = [0, 1].map(|i| rows[i].iter().map(|&(at, w)| w * q[at]).sum::<f64>());
            for (row, f) in rows.iter().zip(law(bearing, felt)) {
                row.iter().for_each(|&(at, w)| force[at] += w * f);
            }
        }
    }

    /// What the tangent has beside that of elements, hubs, bearings and the centrifugal pull: not symmetric.
    fn skew_part(&self, z: &[f64], load: f64, speed: f64) -> Sparse {
        let mut parts = self.loads.tangents(&self.coordinates(z), Turned::NOT);
        parts.iter_mut().for_each(|part| part.matrix *= Scale(-load));
        let loads = self.assembly.sum(&[], parts);
        match &self.drag {
            Some(drag) => combine(&[(1.0, &loads), (speed, drag)]),
            None => loads,
        }
    }

    /// Forces that the supports exert on all coordinates in equilibrium under a share of the load, N.
    pub fn reactions_at(&self, z: &[f64], load: f64) -> Vec<f64> {
        let (q, speed) = (self.coordinates(z), self.speed * load.sqrt());
        let (mut held, _) = self.imbalance(&q, load, speed, &mut Workspace::default());
        // a bearing at the node of a support carries its own part
        self.add_of_bearings(&q, spring, &mut held);
        if self.drag.is_some() {
            self.add_bearing_drag(&q, speed, &mut held);
        }
        held
    }

    /// All that acts in equilibrium under a share of the load, in the axes of the turning frame.
    pub fn acting(&self, z: &[f64], load: f64) -> Acting {
        let position = self.coordinates(z);
        let speed = self.speed * load.sqrt();
        let mut outer = vec![0.0; position.len()];
        self.subtract_outer(&position, load, speed, &mut outer);
        self.add_of_bearings(&position, spring, &mut outer);
        if self.drag.is_some() {
            self.add_bearing_drag(&position, speed, &mut outer);
        }
        let mut held = vec![0.0; position.len()];
        self.forces.internal_force(&position, None, &mut held, &mut Workspace::default());
        held.iter_mut().zip(&outer).for_each(|(h, o)| *h += o);
        outer.iter_mut().for_each(|o| *o = -*o);
        let velocity: Vec<f64> = cross(&position).into_iter().map(|v| speed * v).collect();
        let acceleration = cross(&velocity).into_iter().map(|a| speed * a).collect();
        Acting { position, velocity, acceleration, outer, held, axes: Turned::NOT, load }
    }

    /// Tangent of elements, hubs and bearings at a state, without the centrifugal part.
    pub fn tangent(&self, z: &[f64]) -> Sparse {
        let k = self.forces.tangent(&self.coordinates(z));
        combine(&[(1.0, &k), (1.0, &self.bearings)])
    }

    /// Solves for equilibrium at the speed and the full load.
    ///
    /// Load and centrifugal pull are raised together in steps; a step that does not converge is halved. When
    /// no step succeeds any more the last state found is returned, with its load factor below 1.
    ///
    /// # Errors
    /// A tangent that can't be factorised, or loads along a motion that nothing resists.
    pub fn solve(&self, settings: NewtonSettings, start: Option<&[f64]>) -> Result<Equilibrium> {
        let size = self.assembly.size();
        let mut state = Equilibrium {
            z: start.map_or_else(|| vec![0.0; size], <[f64]>::to_vec),
            load_factor: 0.0,
            steps: 0,
            cuts: 0,
            iterations: 0,
            residual: 0.0,
            unstable: 0,
        };
        let mut step = 1.0 / settings.load_steps as f64;
        let mut work = Workspace::default();
        // states on the way, for a start that is nearer than the last one
        let mut path = vec![(0.0, state.z.clone())];
        while state.load_factor < 1.0 {
            let target = (state.load_factor + step).min(1.0);
            // the last stretch is not left to rounding
            let target = if target > 1.0 - 1e-9 { 1.0 } else { target };
            let ahead = extrapolated(&path, target);
            let mut next = None;
            for start in ahead.iter().chain([&state.z]) {
                next = self.step(start, target, settings, &mut work, &mut state.iterations)?;
                if next.is_some() {
                    break;
                }
            }
            if let Some(next) = next {
                (state.z, state.residual, state.unstable) = next;
                state.load_factor = target;
                state.steps += 1;
                path.push((target, state.z.clone()));
                if path.len() > PATH {
                    path.remove(0);
                }
                continue;
            }
            state.cuts += 1;
            step /= 2.0;
            if step < SMALLEST_LOAD_STEP / settings.load_steps as f64 {
                break;
            }
        }
        Ok(state)
    }

    /// One load step: the state, the relative energy of the last correction and the unstable directions.
    #[allow(clippy::type_complexity)]
    fn step(
        &self,
        start: &[f64],
        load: f64,
        settings: NewtonSettings,
        work: &mut Workspace,
        iterations: &mut usize,
    ) -> Result<Option<(Vec<f64>, f64, usize)>> {
        let speed = self.speed * load.sqrt();
        let mut z = start.to_vec();
        let (mut g, mut energy) = self.residual(&z, load, speed, work);
        let (mut largest, mut previous) = (0.0_f64, f64::INFINITY);
        for _ in 0..settings.max_iterations {
            *iterations += 1;
            let mut k = combine(&[(1.0, &self.tangent(&z)), (speed * speed, &self.centrifugal)]);
            if self.skew {
                k = combine(&[(1.0, &k), (1.0, &self.skew_part(&z, load, speed))]);
            }
            let symmetric = if self.skew { symmetric_part(&k) } else { k.clone() };
            let Ok(flexibility) = Flexibility::new(&symmetric, &self.free_mass, self.motions.clone()) else {
                return Ok(None);
            };
            let right = Mat::from_fn(g.len(), 1, |i, _| -g[i]);
            let answer = if self.skew {
                let Ok(answer) = flexibility.solve_unsymmetric(right, k) else { return Ok(None) };
                answer
            } else {
                flexibility.solve(right)
            };
            let change: Vec<f64> = answer.col(0).iter().copied().collect();
            let slope = dot(&g, &change);
            if !slope.is_finite() {
                return Ok(None);
            }
            largest = largest.max(slope.abs()).max(energy.abs());
            let relative = if slope.abs() > self.rounding { slope.abs() / largest } else { 0.0 };
            let stalled = relative > previous / 4.0 && relative < ROUNDING_ENERGY_SHARE;
            previous = relative;
            let done = relative <= settings.tolerance || stalled;
            // backtracking on the work of the imbalance along the correction
            let mut share = 1.0;
            loop {
                let trial: Vec<f64> = z.iter().zip(&change).map(|(z, d)| z + share * d).collect();
                let (next, w) = self.residual(&trial, load, speed, work);
                let work_left = dot(&next, &change);
                if done || (work_left.is_finite() && work_left.abs() <= 0.9 * slope.abs()) {
                    (z, g, energy) = (trial, next, w);
                    break;
                }
                share /= 2.0;
                if share < 1e-3 {
                    return Ok(None);
                }
            }
            if done {
                if !z.iter().all(|v| v.is_finite()) {
                    return Ok(None);
                }
                let unstable = flexibility.unstable_directions();
                return Ok(Some((z, relative, unstable)));
            }
        }
        Ok(None)
    }
}

/// The polynomial through states on a path (load factor, state), at another load factor; `None` for a single state.
fn extrapolated(path: &[(f64, Vec<f64>)], load: f64) -> Option<Vec<f64>> {
    let (_, last) = path.last().filter(|_| path.len() > 1)?;
    let weight = |i: usize| -> f64 {
        let others = path.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, (other, _))| (load - other) / (path[i].0 - other)).product()
    };
    let weights: Vec<f64> = (0..path.len()).map(weight).collect();
    let at = |k: usize| path.iter().zip(&weights).map(|((_, z), w)| w * z[k]).sum();
    Some((0..last.len()).map(at).collect())
}

/// Force of a bearing's springs against the displacement that it feels, N.
fn spring(bearing: &Bearing, [y, z]: [f64; 2]) -> [f64; 2] {
    bearing.stiffness.map(|k| k[0] * y + k[1] * z)
}

/// `J q`, `e_x x` every vector.
fn cross(q: &[f64]) -> Vec<f64> {
    q.chunks_exact(3).flat_map(|v| [0.0, -v[2], v[1]]).collect()
}
