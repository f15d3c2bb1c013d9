//! Critical speeds as eigenvalues, without a sweep.
//!
//! With `u exp(i Omega t)` the classical stationary form is `K u = Omega^2 (M - i G) u`: Hermitian, K
//! positive on motions with strain, `M - i G` indefinite when a disk is flat enough to have no forward
//! critical speed. In the consistent form K depends on Omega^2 almost linearly, `K = K_0 + Omega^2 S`: solved
//! with S the secant to the highest speed, then each speed for itself with its own K. In the rotating frame a
//! whirl in step with the shaft stands still: `(K_T + Omega^2 M J^2) u = 0`, real. Solved with the flexibility at
//! rest; a count of negative pivots of the matrix at a speed says how many lie below it.
//! Source: docs/theory/linear-rotordynamics.md#critical-speeds.

use crate::analysis::campbell::operators::Operators;
use crate::error::{Error, Result};
use crate::linalg::dense::self_adjoint;
use crate::linalg::factor::Ldlt;
use crate::linalg::lanczos::{self, Pencil};
use crate::linalg::sparse::{Sparse, combine, multiply};
use crate::shaft::spectrum::{Flexibility, Spectrum};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, c64};

/// Relative difference of two values up to which their vectors may be mixtures, or copies of each other.
const MIXED_RTOL: f64 = 1e-2;
/// Relative difference of two speeds that is none.
const SAME_SPEED_RTOL: f64 = 1e-8;
/// Most critical speeds that are solved for.
pub const MOST_CRITICAL_SPEEDS: usize = 200;

/// A critical speed and its shape in free coordinates.
pub struct Critical {
    /// Spin speed at which the motion turns in step with the shaft, rad/s.
    pub speed: f64,
    /// Complex shape of the motion, in free coordinates.
    pub shape: Vec<c64>,
}

/// Critical speeds with what vouches for them.
pub struct Criticals {
    /// Ascending, at most [`MOST_CRITICAL_SPEEDS`].
    pub list: Vec<Critical>,
    /// Their number agrees with the inertia count.
    pub complete: bool,
    /// Largest energy norm of what a motion leaves out of balance; the speed's relative error is about its square.
    pub imbalance: f64,
}

/// Number of critical speeds below `speed`, rigid motions not counted.
///
/// # Errors
/// When the factorisation fails.
pub fn count_below(operators: &Operators, spectrum: &Spectrum, speed: f64) -> Result<Option<usize>> {
    if operators.is_rotating() {
        let rigid = spectrum.flexibility.rigid.clone();
        let pinned =
            Flexibility::new(&operators.stiffness_at(speed, c64::new(0.0, 0.0)), &operators.mass, rigid)?;
        return Ok(Some(pinned.unstable_directions()).filter(|n| *n != usize::MAX));
    }
    let square = speed * speed;
    let real = |v: f64| c64::new(v, 0.0);
    let stiffness = operators.stiffness_at(speed, c64::new(0.0, speed));
    let mut terms = vec![(real(1.0), &stiffness), (real(-square), &operators.mass)];
    if let Some(g) = &operators.gyroscopic {
        terms.push((c64::new(0.0, square), g));
    }
    let negative = Ldlt::new(&combine(&terms))?.negative_pivots();
    let rigid = rigid_inertia(operators, spectrum)?;
    Ok(negative.and_then(|n| n.checked_sub(rigid)))
}

/// Number of negative eigenvalues that the rigid motions R add to the count: those of `-R^T (M - i G) R`.
fn rigid_inertia(operators: &Operators, spectrum: &Spectrum) -> Result<usize> {
    let rigid = spectrum.flexibility.rigid.as_ref();
    let n = rigid.ncols();
    let mass = rigid.transpose() * multiply(&operators.mass, rigid);
    let turning = match &operators.gyroscopic {
        Some(g) => rigid.transpose() * multiply(g, rigid),
        None => Mat::zeros(n, n),
    };
    let block = Mat::from_fn(n, n, |i, j| c64::new(-mass[(i, j)], turning[(i, j)]));
    Ok(self_adjoint(block.as_ref())?.0.iter().filter(|v| **v < 0.0).count())
}

/// A function of each of the parts of a vector: of the whole of a real one, of the real and the imaginary part of a complex one.
fn on_parts(parts: usize, f: &dyn Fn(MatRef<'_, f64>) -> Mat<f64>, x: MatRef<'_, f64>) -> Mat<f64> {
    let n = x.nrows() / parts;
    match parts {
        1 => f(x),
        _ => stack(f(x.get(..n, ..)).as_ref(), f(x.get(n.., ..)).as_ref()),
    }
}

/// `B x` with `B (a, b) = (M a + G b, M b - G a)` of parts a and b, less the secant of the stiffness by the square of the speed;
/// without M in the rotating frame.
fn inertia_image(
    operators: &Operators,
    secant: Option<&Sparse>,
    parts: usize,
    x: MatRef<'_, f64>,
) -> Mat<f64> {
    let n = x.nrows() / parts;
    let mut y = on_parts(
        parts,
        &|a| {
            let inertia = (parts == 2).then(|| multiply(&operators.mass, a));
            let stiffening = secant.map(|s| multiply(s, a));
            match (inertia, stiffening) {
                (Some(m), Some(s)) => m - s,
                (Some(m), None) => m,
                (None, Some(s)) => -s,
                (None, None) => Mat::zeros(a.nrows(), a.ncols()),
            }
        },
        x,
    );
    if let (Some(g), 2) = (&operators.gyroscopic, parts) {
        let (ga, gb) = (multiply(g, x.get(..n, ..)), multiply(g, x.get(n.., ..)));
        let mut top = y.get_mut(..n, ..);
        top += gb;
        let mut bottom = y.get_mut(n.., ..);
        bottom -= ga;
    }
    y
}

/// The critical speeds from above zero up to `highest`.
///
/// # Errors
/// When the eigenvalue solver does not converge.
pub fn critical_speeds(operators: &Operators, spectrum: &Spectrum, highest: f64) -> Result<Criticals> {
    let none = |complete| Ok(Criticals { list: Vec::new(), complete, imbalance: 0.0 });
    let Some(expected) = count_below(operators, spectrum, highest)? else { return none(false) };
    if expected == 0 {
        return none(true);
    }
    let n = operators.mass.nrows();
    let flexibility = &spectrum.flexibility;
    let n_rigid = flexibility.rigid.ncols();
    let secant = operators.secant(highest);
    // x = a + i b as (a, b); real in the rotating frame
    let parts = if operators.is_rotating() { 1 } else { 2 };
    let apart = |f: &dyn Fn(MatRef<'_, f64>) -> Mat<f64>, x: MatRef<'_, f64>| on_parts(parts, f, x);
    let apply_b = |x: MatRef<'_, f64>| inertia_image(operators, secant.as_ref(), parts, x);
    let rigid = if parts == 1 {
        flexibility.rigid.clone()
    } else {
        let zero = Mat::<f64>::zeros(n, n_rigid);
        hstack(
            stack(flexibility.rigid.as_ref(), zero.as_ref()),
            stack(zero.as_ref(), flexibility.rigid.as_ref()),
        )
    };
    let b_rigid = apply_b(rigid.as_ref());
    let rigid_block = rigid.transpose() * &b_rigid;
    let rigid_factor = rigid_block.full_piv_lu();
    // motions with strain at Omega > 0 satisfy R^T B x = 0; in the rotating frame those that remain (along and
    // about the axis) have no B, and any share of them will do
    let clean = |x: &mut Mat<f64>| {
        if parts == 1 {
            flexibility.without_rigid(x);
        } else if n_rigid > 0 {
            let share = rigid_factor.solve(b_rigid.transpose() * &*x);
            *x -= &rigid * share;
        }
    };
    let solve = |f: Mat<f64>| {
        let mut x = apart(&|f| flexibility.solve(f.to_owned()), f.as_ref());
        clean(&mut x);
        x
    };
    let pencil = Pencil {
        size: parts * n,
        rank: parts * (n - n_rigid),
        apply_k: &|x| apart(&|a| spectrum.stiffness_times(a), x),
        apply_b: &apply_b,
        solve: &solve,
        clean: &clean,
        apart: flexibility.soft_motions().map(|soft| apart_in(parts, soft)),
    };
    let wanted = expected.min(MOST_CRITICAL_SPEEDS);
    let pairs = lanczos::lowest(&pencil, parts * wanted)?;
    if pairs.vectors.col_iter().any(|c| c.iter().any(|v| !v.is_finite())) {
        return Err(Error::analysis(
            "the synchronous eigenproblem has no finite solution",
            "block Lanczos on K x = Omega^2 (M - i G) x",
            "check the disks' inertias: a free rotor with equal polar and diametral inertia has no steady whirl",
        ));
    }
    let mut list = if parts == 1 {
        let shape = |j: usize| pairs.vectors.col(j).iter().map(|&v| c64::new(v, 0.0)).collect();
        let speeds = pairs.values.iter().enumerate();
        speeds.map(|(j, value)| Critical { speed: value.sqrt(), shape: shape(j) }).collect()
    } else {
        complex_shapes(spectrum, pairs.values, pairs.vectors)
    };
    let imbalance = polish(operators, spectrum, secant.is_some(), &mut list)?;
    let complete = list.len() == wanted && list.last().is_none_or(|c| c.speed <= highest * (1.0 + 1e-9));
    Ok(Criticals { list, complete, imbalance })
}

/// Brings each speed into balance with the stiffness of its own, and chooses among shapes of equal speeds; returns the largest
/// imbalance that remains.
fn polish(operators: &Operators, spectrum: &Spectrum, stiffens: bool, list: &mut [Critical]) -> Result<f64> {
    let mut imbalance = 0.0_f64;
    if stiffens {
        list.iter_mut().for_each(|critical| settle(operators, spectrum, critical));
        list.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        for critical in &*list {
            imbalance = imbalance.max(left_over(operators, spectrum, critical));
        }
    }
    if !operators.is_rotating() {
        for equal in
            list.chunk_by_mut(|a, b| b.speed / a.speed - 1.0 <= SAME_SPEED_RTOL).filter(|c| c.len() > 1)
        {
            circularise(operators, equal)?;
        }
    }
    Ok(imbalance)
}

/// Shapes at one speed are arbitrary mixtures: chooses those that travel most clearly, the backward ones first.
fn circularise(operators: &Operators, equal: &mut [Critical]) -> Result<()> {
    let k = equal.len();
    let images = |a: &Sparse| -> Vec<Vec<c64>> { equal.iter().map(|c| image(a, &c.shape)).collect() };
    let form = |images: &[Vec<c64>]| Mat::from_fn(k, k, |i, j| product(&equal[i].shape, &images[j]));
    let (mass, travel) = (form(&images(&operators.mass)), form(&images(&operators.travel)));
    let (sizes, axes) = self_adjoint(mass.as_ref())?;
    // written so that sizes that are no numbers leave the shapes as they are
    if !(sizes[0] > 1e-6 * sizes[k - 1]) {
        return Ok(());
    }
    let half = Mat::from_fn(k, k, |i, j| axes[(i, j)] / sizes[j].sqrt());
    let turning = half.adjoint() * Mat::from_fn(k, k, |i, j| travel[(i, j)] * c64::new(0.0, -1.0)) * &half;
    let weights = &half * self_adjoint(turning.as_ref())?.1;
    let entry = |j: usize, at: usize| (0..k).map(|i| equal[i].shape[at] * weights[(i, j)]).sum();
    let shapes: Vec<Vec<c64>> =
        (0..k).map(|j| (0..equal[0].shape.len()).map(|at| entry(j, at)).collect()).collect();
    equal.iter_mut().zip(shapes).for_each(|(critical, shape)| critical.shape = shape);
    Ok(())
}

/// The speed at which a shape is in balance in the mean, K being that of the speed itself. The error is the
/// square of the shape's.
fn settle(operators: &Operators, spectrum: &Spectrum, critical: &mut Critical) {
    let x = &critical.shape;
    let form = |a: &Sparse| product(x, &image(a, x));
    let stiffness = product(x, &energy_image(spectrum, x)).re;
    let varying: Vec<f64> = operators.varying().map(|a| form(a).re).collect();
    let inertia = if operators.is_rotating() {
        0.0
    } else {
        form(&operators.mass).re + operators.gyroscopic.as_ref().map_or(0.0, |g| form(g).im)
    };
    let Some((centrifugal, changes)) = varying.split_first() else { return };
    let mut speed = critical.speed;
    for _ in 0..50 {
        let weights = operators.weights(speed);
        let stiffening: f64 = weights.iter().skip(1).zip(changes).map(|(w, change)| w * change).sum();
        let next = ((stiffness + stiffening) / (inertia - centrifugal)).sqrt();
        if !next.is_finite() {
            return;
        }
        let change = (next / speed - 1.0).abs();
        speed = next;
        if change < 1e-15 {
            break;
        }
    }
    critical.speed = speed;
}

/// Energy norm of what a critical motion leaves out of balance, relative to the motion's.
fn left_over(operators: &Operators, spectrum: &Spectrum, critical: &Critical) -> f64 {
    let (x, square) = (&critical.shape, critical.speed * critical.speed);
    let mut force = energy_image(spectrum, x);
    let mut add = |factor: c64, a: &Sparse| {
        force.iter_mut().zip(image(a, x)).for_each(|(f, image)| *f += factor * image);
    };
    for (weight, part) in operators.weights(critical.speed).into_iter().zip(operators.varying()) {
        add(c64::new(weight, 0.0), part);
    }
    if !operators.is_rotating() {
        add(c64::new(-square, 0.0), &operators.mass);
        if let Some(g) = &operators.gyroscopic {
            add(c64::new(0.0, square), g);
        }
    }
    let forces = Mat::from_fn(x.len(), 2, |i, j| if j == 0 { force[i].re } else { force[i].im });
    let answer = spectrum.flexibility.solve(forces.clone());
    let energy: f64 = (0..2).map(|j| -> f64 { answer.col(j).transpose() * forces.col(j) }).sum();
    (energy.max(0.0) / product(x, &energy_image(spectrum, x)).re).sqrt()
}

/// Every complex eigenvector x stands in the real problem as x and i x: keeps one of each.
fn complex_shapes(spectrum: &Spectrum, values: Vec<f64>, vectors: Mat<f64>) -> Vec<Critical> {
    let n = vectors.nrows() / 2;
    let mut kept: Vec<(f64, Vec<c64>, Vec<c64>)> = Vec::new();
    let images = [vectors.get(..n, ..), vectors.get(n.., ..)].map(|part| spectrum.stiffness_times(part));
    for (j, value) in values.into_iter().enumerate() {
        let mut shape: Vec<c64> = (0..n).map(|i| c64::new(vectors[(i, j)], vectors[(i + n, j)])).collect();
        let mut image: Vec<c64> = (0..n).map(|i| c64::new(images[0][(i, j)], images[1][(i, j)])).collect();
        let length = product(&shape, &image).re;
        for (other, x, kx) in &kept {
            // eigenvectors of other values have no share in it
            if (value / other - 1.0).abs() < MIXED_RTOL {
                let share = product(kx, &shape) / product(kx, x);
                shape.iter_mut().zip(x).for_each(|(s, x)| *s -= share * x);
                image.iter_mut().zip(kx).for_each(|(s, kx)| *s -= share * kx);
            }
        }
        if product(&shape, &image).re > 1e-6 * length {
            kept.push((value, shape, image));
        }
    }
    kept.into_iter().map(|(value, shape, _)| Critical { speed: value.sqrt(), shape }).collect()
}

fn product(a: &[c64], b: &[c64]) -> c64 {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

/// `K x` at rest.
fn energy_image(spectrum: &Spectrum, x: &[c64]) -> Vec<c64> {
    complex(x, |parts| spectrum.stiffness_times(parts))
}

fn image(a: &Sparse, x: &[c64]) -> Vec<c64> {
    complex(x, |parts| multiply(a, parts))
}

/// A real operator on a complex vector.
fn complex(x: &[c64], apply: impl Fn(MatRef<'_, f64>) -> Mat<f64>) -> Vec<c64> {
    let parts = Mat::from_fn(x.len(), 2, |i, j| if j == 0 { x[i].re } else { x[i].im });
    let image = apply(parts.as_ref());
    (0..x.len()).map(|i| c64::new(image[(i, 0)], image[(i, 1)])).collect()
}

fn stack(top: MatRef<'_, f64>, bottom: MatRef<'_, f64>) -> Mat<f64> {
    let n = top.nrows();
    Mat::from_fn(n + bottom.nrows(), top.ncols(), |i, j| if i < n { top[(i, j)] } else { bottom[(i - n, j)] })
}

/// Motions in every part of the real problem.
fn apart_in(parts: usize, motions: MatRef<'_, f64>) -> Mat<f64> {
    let (n, m) = (motions.nrows(), motions.ncols());
    let entry = |i: usize, j: usize| if i / n == j / m { motions[(i % n, j % m)] } else { 0.0 };
    Mat::from_fn(parts * n, parts * m, entry)
}

fn hstack(left: Mat<f64>, right: Mat<f64>) -> Mat<f64> {
    let n = left.ncols();
    Mat::from_fn(left.nrows(), n + right.ncols(), |i, j| if j < n { left[(i, j)] } else { right[(i, j - n)] })
}

/// `Im(u^H S u) / u^H M u` of a shape, see [`Operators::travel`].
pub fn travel_of(operators: &Operators, shape: &[c64]) -> f64 {
    let turning = product(shape, &image(&operators.travel, shape)).im;
    turning / product(shape, &image(&operators.mass, shape)).re
}
