//! The spinning shaft on a small basis: natural modes with static corrections.
//!
//! The basis holds the rigid motions, the lowest modes phi at rest and static corrections: `K^+ G phi`, those of
//! damping and bearings and, in the consistent form, of what spin adds to the stiffness. Without them torsion and
//! axial modes are off by up to 7e-4. Source: docs/theory/linear-rotordynamics.md#reduction.

use crate::analysis::campbell::changing_bearings::ChangingBearing;
use crate::analysis::campbell::hysteresis::Hysteresis;
use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::spin_stiffening::Nodes;
use crate::error::Result;
use crate::linalg::dense::self_adjoint;
use crate::linalg::sparse::{Sparse, absolute_product, combine, multiply};
use crate::shaft::spectrum::Spectrum;
use faer::{Mat, MatRef, c64};

/// Corrections of which less than this share (in energy) is new are not new directions.
const NEW_DIRECTION_ENERGY_SHARE: f64 = 1e-12;
/// Share of the energy of the largest of its kind below which a correction is rounding error.
const ROUNDING_ENERGY_SHARE: f64 = 1e-20;
/// Imbalance (in energy, relative to the motion) below which a motion needs no correction.
const BALANCED: f64 = 1e-16;

/// One whirl motion `u exp(lambda t)` on the reduced basis.
#[derive(Debug, Clone)]
pub struct Whirling {
    /// Eigenvalue, 1/s; the imaginary part is the damped frequency, zero for a motion that does not oscillate.
    pub lambda: c64,
    /// Right eigenvector of the state matrix.
    pub right: Vec<c64>,
    /// Left eigenvector with `left^H right = 1`; `None` when it equals `right`.
    pub left: Option<Vec<c64>>,
    /// What rounding may have made of the real part of lambda, 1/s; zero where there is none.
    pub noise: f64,
}

impl Whirling {
    /// True for a motion that grows by more than rounding.
    pub fn grows(&self) -> bool {
        self.lambda.re > self.noise.max(1e-13 * self.lambda.norm())
    }
}

/// The motions at one speed.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Spin speed, rad/s.
    pub speed: f64,
    /// Motions: those that oscillate by ascending frequency, then those that creep, from slow to fast (the imaginary part of
    /// their lambda is zero).
    pub motions: Vec<Whirling>,
    /// Number of motions that oscillate.
    pub oscillating: usize,
    /// Motions that creep instead of oscillating, because their damping is above the critical one.
    pub overdamped: Vec<Overdamped>,
    /// Motions for which no law of the bearings was found that is their own.
    pub unsettled: usize,
}

/// A motion that creeps: two real eigenvalues where an oscillation would have a conjugate pair.
#[derive(Debug, Clone, Copy)]
pub struct Overdamped {
    /// Frequency of its shape without damping, rad/s.
    pub frequency: f64,
    /// The slower of the two among the motions.
    pub slow: usize,
}

/// The operators on a reduced basis.
#[derive(Clone)]
pub struct Reduced {
    /// Basis in columns, mass-orthonormal: rigid motions first, then vectors with diagonal stiffness.
    pub basis: Mat<f64>,
    /// Number of rigid motions.
    pub n_rigid: usize,
    n_modes: usize,
    /// Number of motions that are solved with their own law where bearings depend on the motion.
    pub(super) followed: usize,
    /// Square roots of the diagonal stiffness at rest; zero for rigid motions.
    pub frequencies: Vec<f64>,
    /// `G` per unit spin speed.
    pub gyroscopic: Option<Mat<f64>>,
    /// Damping matrix C on the basis.
    pub damping: Option<Mat<f64>>,
    /// Skew part X of the bearings' stiffness on the basis.
    pub cross_coupling: Option<Mat<f64>>,
    /// `H` per unit spin speed.
    pub circulatory: Option<Mat<f64>>,
    pub(super) travel: Mat<f64>,
    /// Root of the rounding in `C` that each vector of the basis feels.
    pub(super) strain_noise: Vec<f64>,
    /// Parts of `K(Omega) - K_0`: the centrifugal matrix, then the change at each node.
    pub varying: Vec<Mat<f64>>,
    /// What the rigid motions gain at each node, in columns.
    pub turned: Vec<Mat<f64>>,
    nodes: Option<Nodes>,
    /// Bearings whose law changes, on the basis.
    pub changing: Vec<ChangingBearing>,
    /// Damping of materials with a loss factor, on the basis.
    pub hysteresis: Hysteresis<Mat<f64>>,
    /// True in the frame that turns with the shaft.
    pub rotating: bool,
}

impl Reduced {
    /// The `modes` lowest natural modes, and corrections for the lowest `corrected` of them.
    ///
    /// # Errors
    /// When a small eigenproblem fails.
    pub fn new(operators: &Operators, spectrum: &Spectrum, modes: usize, corrected: usize) -> Result<Self> {
        let modes = modes.min(spectrum.values.len());
        let kept = spectrum.vectors.get(.., ..modes);
        let carriers = hstack(&[spectrum.flexibility.rigid.as_ref(), kept.get(.., ..corrected.min(modes))]);
        let mut forces = vec![operators.bearing_forces.clone()];
        let velocity_terms = [&operators.gyroscopic, &operators.circulatory];
        forces.extend(velocity_terms.into_iter().flatten().map(|a| multiply(a, carriers.as_ref())));
        if let (Some(damping), Some(_)) = (&operators.damping, &operators.circulatory) {
            forces.push(multiply(damping, carriers.as_ref()));
        }
        if let Some(secant) = operators.stiffening.as_ref().and_then(|s| operators.secant(s.nodes.highest()))
        {
            forces.push(multiply(&secant, carriers.as_ref()));
        }
        for [damping, turning] in &operators.hysteresis.0 {
            forces.extend([damping, turning].map(|a| multiply(a, carriers.as_ref())));
        }
        let mut answers: Vec<Mat<f64>> = forces
            .into_iter()
            .map(|f| {
                let f = spectrum.without_low_modes(&f);
                let answer = spectrum.flexibility.solve(f.clone());
                let energy: Vec<f64> = (0..f.ncols()).map(|j| answer.col(j).transpose() * f.col(j)).collect();
                let floor = ROUNDING_ENERGY_SHARE * energy.iter().copied().fold(0.0, f64::max);
                columns(&answer, |j| energy[j] > floor)
            })
            .collect();
        // what rigid motions become must lie in the basis, or they would gain a frequency
        answers.extend(operators.turned_states.iter().chain(&operators.turned_soft_states).map(|turned| {
            let mut turned = turned.clone();
            spectrum.flexibility.without_rigid(&mut turned);
            columns(&turned, |j| turned.col(j).norm_max() > 0.0)
        }));
        let parts: Vec<MatRef<'_, f64>> = answers.iter().map(|f| f.as_ref()).collect();
        let corrections = hstack(&parts);
        let values = &spectrum.values[..modes];
        Self::project(operators, spectrum, (values, kept), corrections, corrected)
    }

    /// The same with that many motions solved with their own law where bearings or the material depend on the motion.
    pub fn following(mut self, motions: usize) -> Self {
        self.followed = motions;
        self
    }

    /// The same with more vectors in the basis.
    ///
    /// # Errors
    /// When a small eigenproblem fails.
    pub fn with(&self, operators: &Operators, spectrum: &Spectrum, more: MatRef<'_, f64>) -> Result<Self> {
        let end = self.n_rigid + self.n_modes;
        let (modes, earlier) = (self.basis.get(.., self.n_rigid..end), self.basis.get(.., end..));
        let mut corrections = hstack(&[earlier, more]);
        spectrum.flexibility.without_rigid(&mut corrections);
        let values = &spectrum.values[..self.n_modes];
        Self::project(operators, spectrum, (values, modes), corrections, self.followed)
    }

    /// The basis extended by the static answer to what `targets` leave out of balance at `speed`, and the
    /// largest energy norm of that answer relative to the motion's.
    ///
    /// # Errors
    /// When a small eigenproblem fails.
    pub fn refined(
        &self,
        operators: &Operators,
        spectrum: &Spectrum,
        speed: f64,
        targets: &[Whirling],
    ) -> Result<(Self, f64)> {
        let shapes = self.shapes(targets);
        let part =
            |f: fn(&c64) -> f64| Mat::from_fn(shapes.nrows(), shapes.ncols(), |i, j| f(&shapes[(i, j)]));
        let (real, imaginary) = (part(|z| z.re), part(|z| z.im));
        let weights = operators.weights(speed);
        // residual of lambda^2 M u + lambda (C + Omega G) u + (K(Omega) + X + Omega H) u, by real and imaginary part
        let products = |x: &Mat<f64>| -> [Mat<f64>; 3] {
            let apply = |a: &Option<Sparse>, factor: f64, sum: &mut Mat<f64>| {
                if let Some(a) = a {
                    *sum += multiply(a, x.as_ref()) * faer::Scale(factor);
                }
            };
            let mut on_velocity = Mat::zeros(x.nrows(), x.ncols());
            apply(&operators.damping, 1.0, &mut on_velocity);
            apply(&operators.gyroscopic, speed, &mut on_velocity);
            let mut on_position = spectrum.stiffness_times(x.as_ref());
            for (weight, part) in weights.iter().zip(operators.varying()) {
                on_position += multiply(part, x.as_ref()) * faer::Scale(*weight);
            }
            apply(&operators.cross_coupling, 1.0, &mut on_position);
            apply(&operators.circulatory, speed, &mut on_position);
            [multiply(&operators.mass, x.as_ref()), on_velocity, on_position]
        };
        let (re, im) = (products(&real), products(&imaginary));
        let changes = changing_forces(operators, speed, targets, (&real, &imaginary));
        let residual = |i: usize, j: usize| {
            let lambda = targets[j].lambda;
            let z = |k: usize| c64::new(re[k][(i, j)], im[k][(i, j)]);
            lambda * lambda * z(0) + lambda * z(1) + z(2) + changes[(i, j)]
        };
        let (n, m) = (real.nrows(), real.ncols());
        let forces =
            Mat::from_fn(n, 2 * m, |i, j| if j < m { residual(i, j).re } else { residual(i, j - m).im });
        let answers = spectrum.flexibility.solve(forces.clone());
        let energy = |j: usize| -> f64 { answers.col(j).transpose() * forces.col(j) };
        let energies = |x: &Mat<f64>| -> Vec<f64> {
            let images = spectrum.stiffness_times(x.as_ref());
            (0..m).map(|j| x.col(j).transpose() * images.col(j)).collect()
        };
        let scale: Vec<f64> =
            energies(&real).iter().zip(energies(&imaginary)).map(|(re, im)| re + im).collect();
        let imbalance = |j: usize| ((energy(j) + energy(j + m)).max(0.0) / scale[j]).sqrt();
        let worst = (0..m).map(imbalance).fold(0.0, f64::max);
        let answers = columns(&answers, |j| energy(j) > BALANCED * scale[j % m]);
        // Only true modes are orthogonal in both M and K: earlier corrections are worked over again.
        let end = self.n_rigid + self.n_modes;
        let (modes, earlier) = (self.basis.get(.., self.n_rigid..end), self.basis.get(.., end..));
        let values = &spectrum.values[..self.n_modes];
        let corrections = hstack(&[earlier, answers.as_ref()]);
        Ok((Self::project(operators, spectrum, (values, modes), corrections, self.followed)?, worst))
    }

    /// Projects the operators on rigid motions, `modes` (mass-orthonormal, with diagonal stiffness `values`)
    /// and `corrections`.
    fn project(
        operators: &Operators,
        spectrum: &Spectrum,
        (values, modes): (&[f64], MatRef<'_, f64>),
        corrections: Mat<f64>,
        followed: usize,
    ) -> Result<Self> {
        let (extra, extra_values) = independent(spectrum, modes, corrections)?;
        let rigid = spectrum.flexibility.rigid.as_ref();
        let basis = hstack(&[rigid, modes, extra.as_ref()]);
        let n_rigid = rigid.ncols();
        let mut frequencies = vec![0.0; n_rigid];
        frequencies.extend(values.iter().chain(&extra_values).map(|v| v.sqrt()));
        let reduce = |a: &Sparse| basis.transpose() * multiply(a, basis.as_ref());
        // strain rates see only what strains: what cancels in a motion that is nearly rigid is taken out before
        let straining = &basis
            - &operators.unstrained
                * (operators.unstrained.transpose() * multiply(&operators.mass, basis.as_ref()));
        let with_strain = |total: &Option<Sparse>, strain: &Option<Sparse>| match (total, strain) {
            (Some(total), Some(strain)) => {
                let rest = combine(&[(1.0, total), (-1.0, strain)]);
                let reduced = straining.transpose() * multiply(strain, straining.as_ref());
                Some(reduce(&rest) + reduced)
            }
            (Some(total), None) => Some(reduce(total)),
            _ => None,
        };
        let [strain_damping, strain_circulatory] = &operators.strain_damping;
        Ok(Self {
            gyroscopic: operators.gyroscopic.as_ref().map(|a| skew(reduce(a))),
            damping: with_strain(&operators.damping, strain_damping),
            cross_coupling: operators.cross_coupling.as_ref().map(reduce),
            circulatory: with_strain(&operators.circulatory, strain_circulatory),
            travel: skew(reduce(&operators.travel)),
            strain_noise: strain_noise(strain_damping, &straining),
            varying: operators.varying().map(reduce).collect(),
            turned: operators
                .turned_states
                .iter()
                .map(|x| basis.transpose() * multiply(&operators.mass, x.as_ref()))
                .collect(),
            nodes: operators.stiffening.as_ref().map(|s| s.nodes.clone()),
            changing: operators.changing.iter().map(|b| b.onto(&basis)).collect(),
            hysteresis: operators.hysteresis.onto(&basis),
            rotating: operators.is_rotating(),
            basis,
            n_rigid,
            n_modes: values.len(),
            followed,
            frequencies,
        })
    }

    /// Factors of [`Self::varying`] at a speed.
    pub fn weights(&self, speed: f64) -> Vec<f64> {
        let nodes = self.nodes.iter().flat_map(|n| n.weights(speed));
        if self.varying.is_empty() {
            Vec::new()
        } else {
            std::iter::once(speed * speed).chain(nodes).collect()
        }
    }

    /// Number of rigid motions that stay at zero frequency at a spin speed (a rigid tilt that whirls
    /// takes one of a pair with it).
    ///
    /// # Errors
    /// When a small eigenproblem fails.
    pub fn zero_frequencies(&self, speed: f64) -> Result<usize> {
        let r = self.n_rigid;
        let turning = |i: usize, j: usize| self.gyroscopic.as_ref().map_or(0.0, |g| speed * g[(i, j)]);
        let block = Mat::from_fn(r, r, |i, j| c64::new(0.0, turning(i, j)));
        Ok(self_adjoint(block.as_ref())?.0.iter().filter(|v| **v <= 1e-9 * speed).count())
    }

    /// `S`, see [`Operators::travel`].
    pub fn travel(&self) -> &Mat<f64> {
        &self.travel
    }

    /// Size of the basis.
    pub fn size(&self) -> usize {
        self.frequencies.len()
    }

    /// Shapes `u` of motions in free coordinates, in columns.
    pub fn shapes(&self, motions: &[Whirling]) -> Mat<c64> {
        let weights = |f: fn(&c64) -> f64| {
            Mat::from_fn(self.size(), motions.len(), |i, j| f(&(motions[j].right[i] / motions[j].lambda)))
        };
        let (re, im) = (&self.basis * weights(|z| z.re), &self.basis * weights(|z| z.im));
        Mat::from_fn(re.nrows(), re.ncols(), |i, j| c64::new(re[(i, j)], im[(i, j)]))
    }

    /// True when the energy of an undamped motion at frequency w is positive: `2 w v^H v + Omega Im(v^H G v)`.
    pub fn energy_sign(&self, motion: &Whirling, speed: f64) -> bool {
        let v = &motion.right[..self.size()];
        let turning = self.gyroscopic.as_ref().map_or(0.0, |g| {
            let row = |i: usize| (0..v.len()).map(|j| v[j] * g[(i, j)]).sum::<c64>();
            (0..v.len()).map(|i| (v[i].conj() * row(i)).im).sum::<f64>()
        });
        2.0 * motion.lambda.im * v.iter().map(|v| v.norm_sqr()).sum::<f64>() + speed * turning > 0.0
    }
}

/// Removes rounding from a matrix that is skew by construction.
fn skew(a: Mat<f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| (a[(i, j)] - a[(j, i)]) / 2.0)
}

/// Forces on motions (real and imaginary parts in columns) of what depends on speed or on the motion itself: bearings that change
/// and materials with a loss factor.
fn changing_forces(
    operators: &Operators,
    speed: f64,
    targets: &[Whirling],
    (real, imaginary): (&Mat<f64>, &Mat<f64>),
) -> Mat<c64> {
    let shapes = Mat::from_fn(real.nrows(), real.ncols(), |i, j| c64::new(real[(i, j)], imaginary[(i, j)]));
    let mut changes = Mat::<c64>::zeros(real.nrows(), real.ncols());
    if !operators.hysteresis.is_none() {
        for (j, target) in targets.iter().enumerate() {
            let [re, im] = [real, imaginary]
                .map(|x| operators.hysteresis.products(speed, target.lambda, x.subcols(j, 1)));
            for i in 0..shapes.nrows() {
                let z = |part: usize| c64::new(re[part][(i, 0)], im[part][(i, 0)]);
                changes[(i, j)] += target.lambda * z(0) + z(1);
            }
        }
    }
    for bearing in &operators.changing {
        for (j, target) in targets.iter().enumerate() {
            let change = bearing.change(speed, target.lambda);
            let felt = [0, 1]
                .map(|k| (0..shapes.nrows()).map(|i| shapes[(i, j)] * bearing.rows[(i, k)]).sum::<c64>());
            for k in 0..2 {
                let on = |l: usize| {
                    change.stiffness[k][l] + change.turning[k][l] + target.lambda * change.damping[k][l]
                };
                let force = on(0) * felt[0] + on(1) * felt[1];
                (0..shapes.nrows()).for_each(|i| changes[(i, j)] += force * bearing.rows[(i, k)]);
            }
        }
    }
    changes
}

/// The columns for which `keep` holds.
fn columns(a: &Mat<f64>, keep: impl Fn(usize) -> bool) -> Mat<f64> {
    let kept: Vec<usize> = (0..a.ncols()).filter(|&j| keep(j)).collect();
    Mat::from_fn(a.nrows(), kept.len(), |i, j| a[(i, kept[j])])
}

/// Columns side by side.
fn hstack(parts: &[MatRef<'_, f64>]) -> Mat<f64> {
    let rows = parts.first().map_or(0, |p| p.nrows());
    let mut result = Mat::zeros(rows, parts.iter().map(|p| p.ncols()).sum());
    let mut at = 0;
    for part in parts {
        result.get_mut(.., at..at + part.ncols()).copy_from(part);
        at += part.ncols();
    }
    result
}

/// Root of `eps |y|^T |C| |y|` for every column y.
fn strain_noise(damping: &Option<Sparse>, straining: &Mat<f64>) -> Vec<f64> {
    let of = |j: usize| {
        let y: Vec<f64> = straining.col(j).iter().map(|v| v.abs()).collect();
        let image = damping.as_ref().map(|c| absolute_product(c, &y));
        let energy: f64 = image.iter().flatten().zip(&y).map(|(a, b)| a * b).sum();
        (f64::EPSILON * energy).sqrt()
    };
    (0..straining.ncols()).map(of).collect()
}

/// The part of `corrections` that is new beside `modes`, mass-orthonormal and with diagonal stiffness.
fn independent(
    spectrum: &Spectrum,
    modes: MatRef<'_, f64>,
    corrections: Mat<f64>,
) -> Result<(Mat<f64>, Vec<f64>)> {
    let mut x = corrections;
    // Modes are orthogonal in M and K alike; M sees those on soft bearings as sharply as the others.
    let mass_modes = multiply(&spectrum.mass, modes);
    // The answers to forces of very different size count alike: each to unit energy first.
    let images = spectrum.stiffness_times(x.as_ref());
    for j in 0..x.ncols() {
        let energy: f64 = x.col(j).transpose() * images.col(j);
        let scale = if energy > 0.0 { 1.0 / energy.sqrt() } else { 0.0 };
        x.col_mut(j).iter_mut().for_each(|v| *v *= scale);
    }
    for _ in 0..2 {
        x -= modes * (mass_modes.transpose() * &x);
    }
    let gram = x.transpose() * spectrum.stiffness_times(x.as_ref());
    let (energies, directions) = self_adjoint(gram.as_ref())?;
    let kept: Vec<usize> =
        (0..energies.len()).filter(|&i| energies[i] > NEW_DIRECTION_ENERGY_SHARE).collect();
    let turn =
        Mat::from_fn(x.ncols(), kept.len(), |i, j| directions[(i, kept[j])] / energies[kept[j]].sqrt());
    let x = &x * turn;
    // Now x^T K x = I: the eigenvalues of x^T M x are the inverse squares of the frequencies.
    let mass = x.transpose() * multiply(&spectrum.mass, x.as_ref());
    let (flexibilities, directions) = self_adjoint(mass.as_ref())?;
    let kept: Vec<usize> = (0..flexibilities.len()).rev().filter(|&i| flexibilities[i] > 0.0).collect();
    let turn =
        Mat::from_fn(x.ncols(), kept.len(), |i, j| directions[(i, kept[j])] / flexibilities[kept[j]].sqrt());
    Ok((&x * turn, kept.iter().map(|&i| 1.0 / flexibilities[i]).collect()))
}
