//! Critical speeds as eigenvalues, without a sweep.
//!
//! With `u exp(i Omega t)` the classical stationary form is `K u = Omega^2 (M - i G) u`: Hermitian, K
//! positive on motions with strain, `M - i G` indefinite when a disk is flat enough to have no forward
//! critical speed. Solved as a real problem of twice the size with the flexibility at rest; a count of
//! negative pivots of `K - Omega^2 (M - i G)` says how many lie below a speed.
//! Source: docs/theory.md section 6.

use super::reduced::Operators;
use super::spectrum::Spectrum;
use crate::error::{Error, Result};
use crate::linalg::dense::self_adjoint;
use crate::linalg::factor::Ldlt;
use crate::linalg::lanczos::{self, Pencil};
use crate::linalg::sparse::{combine, multiply};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, c64};

/// Most critical speeds that are solved for.
pub const MOST: usize = 200;

/// A critical speed and its shape in free coordinates.
pub struct Critical {
    /// rad/s.
    pub speed: f64,
    /// Complex shape.
    pub shape: Vec<c64>,
}

/// Number of critical speeds below `speed`, rigid motions not counted.
///
/// # Errors
/// When the factorisation fails.
pub fn count_below(operators: &Operators, spectrum: &Spectrum, speed: f64) -> Result<Option<usize>> {
    let square = speed * speed;
    let real = |v: f64| c64::new(v, 0.0);
    let mut terms = vec![(real(1.0), &operators.stiffness), (real(-square), &operators.mass)];
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

/// The critical speeds from above zero up to `highest`, ascending, at most [`MOST`]; and whether their
/// number agrees with the count.
///
/// # Errors
/// When the eigenvalue solver does not converge.
pub fn critical_speeds(
    operators: &Operators,
    spectrum: &Spectrum,
    highest: f64,
) -> Result<(Vec<Critical>, bool)> {
    let Some(expected) = count_below(operators, spectrum, highest)? else {
        return Ok((Vec::new(), false));
    };
    if expected == 0 {
        return Ok((Vec::new(), true));
    }
    let n = operators.mass.nrows();
    let flexibility = &spectrum.flexibility;
    let n_rigid = flexibility.rigid.ncols();
    // x = a + i b as (a, b): K on both, B (a, b) = (M a + G b, M b - G a)
    let halves = |f: &dyn Fn(MatRef<'_, f64>) -> Mat<f64>, x: MatRef<'_, f64>| {
        stack(f(x.get(..n, ..)).as_ref(), f(x.get(n.., ..)).as_ref())
    };
    let apply_b = |x: MatRef<'_, f64>| {
        let mut y = halves(&|a| multiply(&operators.mass, a), x);
        if let Some(g) = &operators.gyroscopic {
            let (ga, gb) = (multiply(g, x.get(..n, ..)), multiply(g, x.get(n.., ..)));
            let mut top = y.get_mut(..n, ..);
            top += gb;
            let mut bottom = y.get_mut(n.., ..);
            bottom -= ga;
        }
        y
    };
    let zero = Mat::<f64>::zeros(n, n_rigid);
    let rigid = hstack(
        stack(flexibility.rigid.as_ref(), zero.as_ref()),
        stack(zero.as_ref(), flexibility.rigid.as_ref()),
    );
    let b_rigid = apply_b(rigid.as_ref());
    let rigid_block = rigid.transpose() * &b_rigid;
    let rigid_factor = rigid_block.full_piv_lu();
    // motions with strain at Omega > 0 satisfy R^T B x = 0
    let clean = |x: &mut Mat<f64>| {
        if n_rigid > 0 {
            let share = rigid_factor.solve(b_rigid.transpose() * &*x);
            *x -= &rigid * share;
        }
    };
    let solve = |f: Mat<f64>| {
        let top = flexibility.solve(f.get(..n, ..).to_owned());
        let bottom = flexibility.solve(f.get(n.., ..).to_owned());
        let mut x = stack(top.as_ref(), bottom.as_ref());
        clean(&mut x);
        x
    };
    let pencil = Pencil {
        size: 2 * n,
        rank: 2 * (n - n_rigid),
        apply_k: &|x| halves(&|a| multiply(&operators.stiffness, a), x),
        apply_b: &apply_b,
        solve: &solve,
        clean: &clean,
    };
    let wanted = expected.min(MOST);
    let pairs = lanczos::lowest(&pencil, 2 * wanted)?;
    if pairs.vectors.col_iter().any(|c| c.iter().any(|v| !v.is_finite())) {
        return Err(Error::analysis(
            "the synchronous eigenproblem has no finite solution",
            "block Lanczos on K x = Omega^2 (M - i G) x",
            "check the disks' inertias: a free rotor with equal polar and diametral inertia has no steady whirl",
        ));
    }
    let criticals = complex_shapes(operators, pairs.values, pairs.vectors);
    let agrees = criticals.len() == wanted && criticals.last().is_none_or(|c| c.speed <= highest);
    Ok((criticals, agrees))
}

/// Every complex eigenvector x stands in the real problem as x and i x: keeps one of each.
fn complex_shapes(operators: &Operators, values: Vec<f64>, vectors: Mat<f64>) -> Vec<Critical> {
    let n = vectors.nrows() / 2;
    let mut kept: Vec<(f64, Vec<c64>, Vec<c64>)> = Vec::new();
    for (j, value) in values.into_iter().enumerate() {
        let mut shape: Vec<c64> = (0..n).map(|i| c64::new(vectors[(i, j)], vectors[(i + n, j)])).collect();
        let before = energy_image(operators, &shape);
        let length = product(&shape, &before).re;
        for (other, x, kx) in &kept {
            if (value / other - 1.0).abs() < 1e-7 {
                let share = product(kx, &shape) / product(kx, x);
                shape.iter_mut().zip(x).for_each(|(s, x)| *s -= share * x);
            }
        }
        let image = energy_image(operators, &shape);
        if product(&shape, &image).re > 1e-6 * length {
            kept.push((value, shape, image));
        }
    }
    kept.into_iter().map(|(value, shape, _)| Critical { speed: value.sqrt(), shape }).collect()
}

fn product(a: &[c64], b: &[c64]) -> c64 {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

fn energy_image(operators: &Operators, x: &[c64]) -> Vec<c64> {
    let parts = Mat::from_fn(x.len(), 2, |i, j| if j == 0 { x[i].re } else { x[i].im });
    let image = multiply(&operators.stiffness, parts.as_ref());
    (0..x.len()).map(|i| c64::new(image[(i, 0)], image[(i, 1)])).collect()
}

fn stack(top: MatRef<'_, f64>, bottom: MatRef<'_, f64>) -> Mat<f64> {
    let n = top.nrows();
    Mat::from_fn(n + bottom.nrows(), top.ncols(), |i, j| if i < n { top[(i, j)] } else { bottom[(i - n, j)] })
}

fn hstack(left: Mat<f64>, right: Mat<f64>) -> Mat<f64> {
    let n = left.ncols();
    Mat::from_fn(left.nrows(), n + right.ncols(), |i, j| if j < n { left[(i, j)] } else { right[(i, j - n)] })
}

/// Mean angular momentum of a shape about x relative to a circular orbit's, in [-1, 1].
pub fn momentum(operators: &Operators, shape: &[c64]) -> f64 {
    let parts = Mat::from_fn(shape.len(), 2, |i, j| if j == 0 { shape[i].re } else { shape[i].im });
    let complex =
        |y: Mat<f64>| -> Vec<c64> { (0..shape.len()).map(|i| c64::new(y[(i, 0)], y[(i, 1)])).collect() };
    let turning = product(shape, &complex(multiply(&operators.angular_momentum, parts.as_ref()))).im;
    turning / product(shape, &complex(multiply(&operators.mass, parts.as_ref()))).re
}
