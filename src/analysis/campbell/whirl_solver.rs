//! The motions of the reduced model at one speed: those that oscillate, those that creep, and the sense in which their
//! patterns travel around the axis.

use crate::analysis::campbell::branch_tracking::most_like;
use crate::analysis::campbell::changing_bearings::ChangingBearing;
use crate::analysis::campbell::first_order::FirstOrderForm;
use crate::analysis::campbell::operators::Operators;
use crate::analysis::campbell::reduced_basis::{Overdamped, Reduced, Solution, Whirling};
use crate::error::Result;
use crate::linalg::dense::{general, self_adjoint};
use crate::linalg::skew::skew_eigenpairs;
use crate::linalg::sparse::multiply;
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, c64};

/// Share of the imaginary part below which an eigenvalue counts as real.
const REAL: f64 = 1e-5;
/// Decay over frequency from which a motion does not count as an oscillation.
const CREEP: f64 = 100.0;
/// Frequency over the lowest at rest below which an eigenvalue is that of a rigid motion.
const ZERO: f64 = 1e-6;
/// Rounding of the state matrix over a frequency above which the motion is sharpened.
const SHARP: f64 = 1e-8;
/// Relative distance within which an eigenvalue is looked for: from the solver's own, and from that under another law.
const NEAR: f64 = 1e-3;
const FAR: f64 = 0.7;
/// Most steps towards the law of a motion.
const SETTLING: usize = 30;
/// The same where all motions are solved at each law.
const SETTLING_ALL: usize = 6;
/// Relative change of an eigenvalue at which its law has settled.
const SETTLED: f64 = 1e-11;
/// Relative difference of the eigenvalues of copies of one motion, and the share of one in the other above which they are copies.
const SAME: f64 = 1e-7;
const COPY: f64 = 0.99;
/// Share of rigid motions in a creeping motion from which it is theirs.
const RIGID: f64 = 0.9;

impl Reduced {
    /// All motions at a spin speed that oscillate and those that creep; in the rotating frame the creeping ones that grow.
    ///
    /// # Errors
    /// When the small eigenproblem fails, or the shaft bursts.
    pub fn solve(&self, speed: f64) -> Result<Solution> {
        if self.is_implicit() {
            self.solve_implicit(speed)
        } else {
            self.solve_as(speed, c64::new(0.0, speed))
        }
    }

    /// [`Self::solve`] with the law that bearings have on a motion `exp(lambda t)`.
    fn solve_as(&self, speed: f64, lambda: c64) -> Result<Solution> {
        let at = FirstOrderForm::new(self, speed, lambda)?;
        let conservative = at.is_conservative();
        let (mut motions, mut creeping) = if conservative && at.is_skew() {
            (self.undamped(&at)?, Vec::new())
        } else {
            self.damped(&at, conservative)?
        };
        for motion in motions.iter_mut().chain(&mut creeping) {
            at.restored(&mut motion.right);
            motion.left.iter_mut().for_each(|left| at.restored(left));
        }
        motions.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
        self.circularise(&mut motions)?;
        let oscillating = motions.len();
        let overdamped = self.overdamped(&creeping, oscillating);
        motions.extend(creeping);
        Ok(Solution { speed, motions, oscillating, overdamped, unsettled: 0 })
    }

    fn is_implicit(&self) -> bool {
        !self.hysteresis.is_none() || self.changing.iter().any(ChangingBearing::is_implicit)
    }

    /// The motions where bearings depend on the motion: each of the lowest is solved with the law that holds for itself.
    fn solve_implicit(&self, speed: f64) -> Result<Solution> {
        // the law of a motion without frequency: that of what creeps, and a start for what oscillates
        let first = self.solve_as(speed, c64::new(0.0, 0.0))?;
        let mut motions: Vec<Whirling> = Vec::new();
        let mut unsettled = 0;
        for (i, start) in first.motions[..first.oscillating].iter().enumerate() {
            if i >= self.followed {
                motions.push(start.clone());
                continue;
            }
            let other = |m: &Whirling| !motions.iter().any(|known| self.is_same(known, m));
            let settled = match self.settled(speed, start)?.filter(other) {
                Some(motion) => Some(motion),
                None => self.settled_among_all(speed, start)?.filter(other),
            };
            unsettled += usize::from(settled.is_none());
            motions.push(settled.unwrap_or_else(|| start.clone()));
        }
        motions.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
        let oscillating = motions.len();
        let creeping = first.motions[first.oscillating..].to_vec();
        let overdamped = self.overdamped(&creeping, oscillating);
        motions.extend(creeping);
        Ok(Solution { speed, motions, oscillating, overdamped, unsettled })
    }

    /// A motion near `start` that satisfies the equations with the law that holds for itself: inverse iteration, the law each
    /// time that of the motion before. `None` where it does not settle, or stops to oscillate.
    fn settled(&self, speed: f64, start: &Whirling) -> Result<Option<Whirling>> {
        let mut motion = start.clone();
        let (mut law, mut last) = (motion.lambda, c64::new(0.0, 0.0));
        for _ in 0..SETTLING {
            let at = FirstOrderForm::new(self, speed, law)?;
            let (a, forms) = (at.state_matrix(), at.forms());
            let mut right = motion.right.clone();
            let mut left = motion.left.take().unwrap_or_else(|| right.clone());
            at.turn(&mut right);
            at.turn(&mut left);
            let before = motion.lambda;
            (motion.lambda, motion.noise) = at.sharpened(&a, &forms, (&mut right, &mut left), before, FAR);
            at.restored(&mut right);
            at.restored(&mut left);
            (motion.right, motion.left) = (right, Some(left));
            if !(motion.lambda.im > 0.0) {
                return Ok(None);
            }
            let step = motion.lambda - law;
            if step.norm() <= SETTLED * motion.lambda.norm() {
                return Ok((motion.noise < motion.lambda.norm()).then_some(motion));
            }
            // steps to and fro are halved
            let returns = (step * last.conj()).re < 0.0;
            law += step * if returns { 0.5 } else { 1.0 };
            last = step;
        }
        Ok(None)
    }

    /// The same by all motions at each law, among which the one most like `start` is taken.
    fn settled_among_all(&self, speed: f64, start: &Whirling) -> Result<Option<Whirling>> {
        let mut lambda = start.lambda;
        for _ in 0..SETTLING_ALL {
            let all = self.solve_as(speed, lambda)?;
            let Some(motion) = most_like(&all, start).filter(|m| m.lambda.im > 0.0) else { return Ok(None) };
            let before = std::mem::replace(&mut lambda, motion.lambda);
            if (lambda - before).norm() <= SETTLED * lambda.norm() {
                return Ok(Some(motion.clone()));
            }
        }
        Ok(None)
    }

    /// True for two copies of one motion.
    fn is_same(&self, a: &Whirling, b: &Whirling) -> bool {
        let n = self.size();
        let size = |v: &[c64]| v.iter().map(|v| v.norm_sqr()).sum::<f64>();
        let share: c64 = a.right[..n].iter().zip(&b.right[..n]).map(|(a, b)| a.conj() * b).sum();
        (a.lambda - b.lambda).norm() <= SAME * b.lambda.norm()
            && share.norm_sqr() > COPY * size(&a.right[..n]) * size(&b.right[..n])
    }

    /// Frequency below which an eigenvalue is zero, and the highest of the basis.
    fn range(&self) -> (f64, f64) {
        let first = self.frequencies.get(self.n_rigid).copied().unwrap_or(0.0);
        (ZERO * first, self.frequencies.iter().copied().fold(0.0, f64::max))
    }

    /// The motions of a skew state matrix.
    fn undamped(&self, at: &FirstOrderForm<'_>) -> Result<Vec<Whirling>> {
        let (zero, largest) = self.range();
        let (values, vectors) = skew_eigenpairs(at.state_matrix().as_ref())?;
        let oscillating = (0..values.len()).filter(|&k| values[k] > zero);
        let motion = |k: usize| {
            let right = column(vectors.as_ref(), k);
            // the solver's error is a rounding of the highest frequency: far below it, sharpen
            let sharp = values[k] >= ZERO * largest;
            let frequency = if sharp { values[k] } else { at.rayleigh(&right, values[k]) };
            Whirling { lambda: c64::new(0.0, frequency), right, left: None, noise: 0.0 }
        };
        Ok(oscillating.map(motion).collect())
    }

    /// The motions of a general state matrix: those that oscillate, and those that creep.
    fn damped(&self, at: &FirstOrderForm<'_>, conservative: bool) -> Result<(Vec<Whirling>, Vec<Whirling>)> {
        let (zero, largest) = self.range();
        let a = at.state_matrix();
        let (values, vectors) = general(a.as_ref())?;
        // rows of the inverse are the left vectors' conjugate transposes
        let inverse = vectors.partial_piv_lu().solve(Mat::<c64>::identity(a.nrows(), a.nrows()));
        let forms = at.forms();
        let moves = |k: &usize| values[*k].norm() > zero;
        let is_real = |k: &usize| values[*k].im.abs() <= REAL * values[*k].norm();
        // what creeps in space turns with the speed when seen from the shaft, and two planes that creep alike are a double
        // real value, which rounding parts
        let creeps = |k: &usize| is_real(k) || values[*k].re.abs() > CREEP * values[*k].im.abs();
        let rounding = f64::EPSILON * a.norm_max() * a.nrows() as f64;
        let motion = |k: usize| {
            let mut right = column(vectors.as_ref(), k);
            let mut left: Vec<c64> = (0..a.nrows()).map(|i| inverse[(k, i)].conj()).collect();
            let (mut lambda, mut noise) = (values[k], 0.0);
            if self.rotating && is_real(&k) {
                lambda.im = 0.0;
            } else if !conservative && rounding > SHARP * lambda.norm() && !creeps(&k) {
                (lambda, noise) = at.sharpened(&a, &forms, (&mut right, &mut left), lambda, NEAR);
            } else if !conservative {
                (lambda, noise) = at.quotient(&forms, (&right, &left), lambda, NEAR);
            } else if lambda.re.abs() <= 1e-7 * lambda.im + 1e-13 * largest {
                let sharp = lambda.im >= ZERO * largest;
                lambda = c64::new(0.0, if sharp { lambda.im } else { at.rayleigh(&right, lambda.im) });
            }
            Whirling { lambda, right, left: Some(left), noise }
        };
        let all = || (0..values.len()).filter(moves);
        if self.rotating {
            let mut kept: Vec<usize> = all()
                .filter(|k| values[*k].im > 0.0 && !is_real(k) && -values[*k].re <= CREEP * values[*k].im)
                .collect();
            // a pair of frequencies that met at zero goes on as a pair on the real axis: its growing half
            let mut real: Vec<usize> = all().filter(is_real).collect();
            real.sort_by(|&i, &j| values[j].re.total_cmp(&values[i].re));
            kept.extend(&real[..real.len() / 2]);
            return Ok((kept.into_iter().map(motion).collect(), Vec::new()));
        }
        let oscillating = all().filter(|k| values[*k].im > zero && !creeps(k)).map(motion).collect();
        let mut creeping: Vec<Whirling> =
            all().filter(|k| creeps(k)).map(motion).filter(|m| !self.is_rigid(m)).collect();
        creeping.iter_mut().for_each(|m| m.lambda.im = 0.0);
        creeping.sort_by(|a, b| a.lambda.re.abs().total_cmp(&b.lambda.re.abs()));
        Ok((oscillating, creeping))
    }

    /// True for a motion that is mainly rigid.
    pub fn is_rigid(&self, motion: &Whirling) -> bool {
        let size = |v: &[c64]| v.iter().map(|v| v.norm_sqr()).sum::<f64>();
        size(&motion.right[..self.n_rigid]) > RIGID * size(&motion.right[..self.size()])
    }

    /// The overdamped motions: two creeping ones each, a slow one and a fast one. The slow one is the deflection that the
    /// damper lets go of, and the frequency of that shape without damping that of its energies, `x^H K x / x^H M x`; a fast
    /// one is little more than the damper's place.
    fn overdamped(&self, creeping: &[Whirling], first: usize) -> Vec<Overdamped> {
        let frequency = |motion: &Whirling| {
            let (mut strain, mut mass) = (0.0, 0.0);
            for (v, w) in motion.right.iter().zip(&self.frequencies) {
                strain += v.norm_sqr() * w * w;
                mass += v.norm_sqr();
            }
            (strain / mass).sqrt()
        };
        let pair = |i: usize| Overdamped { frequency: frequency(&creeping[i]), slow: first + i };
        (0..creeping.len() / 2).map(pair).collect()
    }

    /// Where frequencies coincide up to rounding, their motions are arbitrary mixtures: chooses those whose patterns travel
    /// most clearly, the circular forward and backward orbits of an isotropic rotor. They are what the motions become once
    /// spin parts them, and what they remain where nothing does.
    fn circularise(&self, motions: &mut [Whirling]) -> Result<()> {
        let (_, largest) = self.range();
        let same = |a: &Whirling, b: &Whirling| {
            (a.lambda - b.lambda).norm() <= 1e-9 * a.lambda.norm() + 1e-13 * largest
        };
        for cluster in motions.chunk_by_mut(|a, b| same(a, b)).filter(|c| c.len() > 1) {
            let k = cluster.len();
            let product = |x: &[c64], y: &[c64]| -> c64 { x.iter().zip(y).map(|(x, y)| x.conj() * y).sum() };
            let gram = Mat::from_fn(k, k, |i, j| product(&cluster[i].right, &cluster[j].right));
            let (sizes, axes) = self_adjoint(gram.as_ref())?;
            if sizes[0] < 1e-6 {
                continue;
            }
            let root = |power: f64| {
                let scaled = Mat::from_fn(k, k, |i, j| axes[(i, j)] * sizes[j].powf(power));
                scaled * axes.adjoint()
            };
            let travelling: Vec<Vec<c64>> = cluster.iter().map(|m| self.travelling(&m.right)).collect();
            let travel =
                Mat::from_fn(k, k, |i, j| c64::new(0.0, -1.0) * product(&cluster[i].right, &travelling[j]));
            let (_, senses) = self_adjoint((root(-0.5) * travel * root(-0.5)).as_ref())?;
            let mix = |vectors: Vec<Vec<c64>>, weights: &Mat<c64>| -> Vec<Vec<c64>> {
                let entry = |j: usize, at: usize| (0..k).map(|i| vectors[i][at] * weights[(i, j)]).sum();
                (0..k).map(|j| (0..vectors[0].len()).map(|at| entry(j, at)).collect()).collect()
            };
            let rights = mix(cluster.iter().map(|m| m.right.clone()).collect(), &(root(-0.5) * &senses));
            let lefts: Option<Vec<Vec<c64>>> = cluster.iter().map(|m| m.left.clone()).collect();
            let lefts = lefts.map(|lefts| mix(lefts, &(root(0.5) * &senses)));
            for (j, right) in rights.into_iter().enumerate() {
                cluster[j].right = right;
                cluster[j].left = lefts.as_ref().map(|lefts| lefts[j].clone());
            }
        }
        Ok(())
    }

    /// `S v` for the velocities of a state, padded to its length.
    fn travelling(&self, state: &[c64]) -> Vec<c64> {
        let n = self.size();
        let row = |i: usize| (0..n).map(|j| state[j] * self.travel[(i, j)]).sum();
        (0..state.len()).map(|i| if i < n { row(i) } else { c64::new(0.0, 0.0) }).collect()
    }

    /// `Im(v^H S v) / v^H M v`: n for a motion whose pattern of n waves travels around the axis with the spin, -n for one
    /// that travels against it, between for what is partly the one and partly the other.
    pub fn travel_of(&self, motion: &Whirling) -> f64 {
        let travelling = self.travelling(&motion.right);
        let turning: f64 = motion.right.iter().zip(&travelling).map(|(v, w)| (v.conj() * w).im).sum();
        let moving: f64 = motion.right[..self.size()].iter().map(|v| v.norm_sqr()).sum();
        if moving > 0.0 { turning / moving } else { 0.0 }
    }
}

fn column(a: MatRef<'_, c64>, j: usize) -> Vec<c64> {
    a.col(j).iter().copied().collect()
}

impl Reduced {
    /// The motions of this (finer) basis expressed on `target`, up to what `target` does not hold.
    ///
    /// # Errors
    /// A stiffness that is not positive.
    pub fn onto(&self, target: &Self, operators: &Operators, mut solution: Solution) -> Result<Solution> {
        let map = target.basis.transpose() * multiply(&operators.mass, self.basis.as_ref());
        let speed = solution.speed;
        let both = |lambda: c64| -> Result<_> {
            Ok((FirstOrderForm::new(self, speed, lambda)?, FirstOrderForm::new(target, speed, lambda)?))
        };
        let common = both(c64::new(0.0, speed))?;
        let apply = |x: &[c64]| -> Vec<c64> {
            (0..map.nrows()).map(|i| (0..map.ncols()).map(|j| x[j] * map[(i, j)]).sum()).collect()
        };
        for motion in &mut solution.motions {
            let own = if self.is_implicit() { Some(both(motion.lambda)?) } else { None };
            let (fine, coarse) = own.as_ref().unwrap_or(&common);
            motion.right = coarse.right_of(apply(&motion.right), motion.lambda);
            motion.left =
                motion.left.take().map(|left| coarse.left_of(apply(&left), &apply(&fine.covector(&left))));
        }
        Ok(solution)
    }

    /// Number of critical speeds of the rotating frame below a speed, on this basis: negative directions of K.
    ///
    /// # Errors
    /// When a small eigenproblem fails.
    pub fn criticals_below(&self, speed: f64) -> Result<usize> {
        let at = FirstOrderForm::new(self, speed, c64::new(0.0, 0.0))?;
        let w = &self.frequencies[self.n_rigid..];
        let n = w.len();
        // over the frequencies at rest, so that no digit of the small ones is lost
        let scaled = Mat::from_fn(n, n, |i, j| at.stiffness[(i, j)] / (w[i] * w[j]));
        Ok(self_adjoint(scaled.as_ref())?.0.iter().filter(|v| **v < 0.0).count())
    }
}
