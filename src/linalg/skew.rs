//! Eigenpairs of a real skew matrix.
//!
//! Householder reflections take `A = -A^T` to a tridiagonal `T = Q^T A Q`, which couples even places with odd ones
//! only: `T y = i w y` are the singular values and vectors of its half-sized block B. All of it is real, where the Hermitian
//! problem `i A` is complex. Source: Ward, Gray, Eigensystem computation for skew-symmetric matrices,
//! ACM Trans. Math. Softw. 4 (1978).

use crate::error::Result;
use crate::instructions::Instructions;
use crate::linalg::dense::{no_convergence, unit_scale};
use faer::{Mat, MatRef, c64};
use pulp::{Arch, NullaryFnOnce};
use std::f64::consts::FRAC_1_SQRT_2;

/// Sums of a scalar product that run side by side.
const LANES: usize = 8;

/// Frequencies `w >= 0`, ascending, with `A x = i w x`, and the unit vectors x in columns: half of the eigenpairs of A
/// (the others are their conjugates and, where the size is odd, a zero).
///
/// # Errors
/// Entries that are no numbers, or no convergence.
pub fn skew_eigenpairs(a: MatRef<'_, f64>) -> Result<(Vec<f64>, Mat<c64>)> {
    let n = a.nrows();
    let (even, odd) = (n.div_ceil(2), n / 2);
    if odd == 0 {
        return Ok((Vec::new(), Mat::zeros(n, 0)));
    }
    let scale = unit_scale(a.norm_max())?;
    let mut matrix: Vec<f64> = (0..n * n).map(|at| a[(at % n, at / n)] * scale).collect();
    let mut turn = vec![0.0; n * n];
    let mut below = vec![0.0; n];
    let arch = Instructions::Widest.arch().unwrap_or(Arch::Scalar);
    arch.dispatch(Tridiagonal { n, matrix: &mut matrix, turn: &mut turn, below: &mut below });
    // T y = (-B^T r, B p) for y = (p at even places, r at odd ones)
    let block = Mat::from_fn(odd, even, |i, j| match j {
        _ if j == i => below[2 * i],
        _ if j == i + 1 => -below[2 * i + 1],
        _ => 0.0,
    });
    let svd = block.thin_svd().map_err(|error| no_convergence(format!("{error:?}")))?;
    let columns = |first: usize, count: usize| Mat::from_fn(n, count, |i, j| turn[(first + 2 * j) * n + i]);
    let (re, im) = (columns(0, even) * svd.V().get(.., ..odd), columns(1, odd) * svd.U());
    // singular values descend
    let vectors = Mat::from_fn(n, odd, |i, j| {
        let at = (i, odd - 1 - j);
        c64::new(FRAC_1_SQRT_2 * re[at], -FRAC_1_SQRT_2 * im[at])
    });
    let values = svd.S().column_vector();
    Ok(((0..odd).map(|j| values[odd - 1 - j] / scale).collect(), vectors))
}

/// The reduction to tridiagonal form, compiled for each set of vector instructions.
struct Tridiagonal<'a> {
    n: usize,
    /// A by columns, of which only the lower triangle is read; it becomes the reflections.
    matrix: &'a mut [f64],
    /// Q by columns, zero before.
    turn: &'a mut [f64],
    /// `T[k + 1, k]`.
    below: &'a mut [f64],
}

impl NullaryFnOnce for Tridiagonal<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { n, matrix, turn, below } = self;
        let mut sizes = vec![0.0; n];
        let (mut vector, mut image) = (vec![0.0; n], vec![0.0; n]);
        for k in 0..n.saturating_sub(1) {
            let m = n - k - 1;
            let (v, w) = (&mut vector[..m], &mut image[..m]);
            v.copy_from_slice(&matrix[k * n + k + 1..(k + 1) * n]);
            let rest = dot(&v[1..], &v[1..]);
            below[k] = v[0];
            if rest == 0.0 {
                continue;
            }
            // I - s v v^T, v[0] = 1, turns the column into (below, 0, ..)
            let norm = (v[0] * v[0] + rest).sqrt();
            below[k] = if v[0] > 0.0 { -norm } else { norm };
            let head = v[0] - below[k];
            sizes[k] = -head / below[k];
            for entry in v.iter_mut() {
                *entry /= head;
            }
            v[0] = 1.0;
            // w = s A v; A += v w^T - w v^T (the term in v v^T is v^T A v = 0), of the lower triangles
            w.fill(0.0);
            for j in 0..m {
                let column = &matrix[(k + 1 + j) * n + k + 2 + j..(k + 2 + j) * n];
                w[j] -= dot(column, &v[j + 1..]);
                add(&mut w[j + 1..], v[j], column);
            }
            for entry in w.iter_mut() {
                *entry *= sizes[k];
            }
            for j in 0..m {
                let column = &mut matrix[(k + 1 + j) * n + k + 2 + j..(k + 2 + j) * n];
                for ((entry, v_i), w_i) in column.iter_mut().zip(&v[j + 1..]).zip(&w[j + 1..]) {
                    *entry += v_i * w[j] - w_i * v[j];
                }
            }
            matrix[k * n + k + 1..(k + 1) * n].copy_from_slice(v);
        }
        for i in 0..n {
            turn[i * n + i] = 1.0;
        }
        for k in (0..n.saturating_sub(1)).rev().filter(|&k| sizes[k] != 0.0) {
            let v = &matrix[k * n + k + 1..(k + 1) * n];
            for j in k + 1..n {
                let column = &mut turn[j * n + k + 1..(j + 1) * n];
                let share = -sizes[k] * dot(v, column);
                add(column, share, v);
            }
        }
    }
}

/// `y += factor x`.
#[inline(always)]
fn add(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// Scalar product `x^T y`, in [`LANES`] sums side by side.
#[inline(always)]
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let whole = x.len() / LANES * LANES;
    let mut sums = [0.0; LANES];
    for (x, y) in x[..whole].chunks_exact(LANES).zip(y[..whole].chunks_exact(LANES)) {
        for k in 0..LANES {
            sums[k] += x[k] * y[k];
        }
    }
    let rest: f64 = x[whole..].iter().zip(&y[whole..]).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random and graded matrices, matrices of planes that turn alike and of odd size: `A x = i w x`, unit vectors, half of
    /// the trace of `A^T A` in the squares of the frequencies.
    #[test]
    fn pairs_solve_the_eigenproblem() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for (n, kind) in [(1, 0), (2, 0), (3, 0), (24, 0), (41, 0), (40, 1), (31, 2), (16, 3)] {
            let mut a = Mat::<f64>::zeros(n, n);
            for j in 0..n {
                for i in j + 1..n {
                    let value = match kind {
                        1 => random() * 1e12 * 10f64.powi(-((i + j) as i32) / 10),
                        2 if j % 2 == 0 && i == j + 1 => 3.0,
                        3 | 2 => 0.0,
                        _ => random(),
                    };
                    (a[(i, j)], a[(j, i)]) = (value, -value);
                }
            }
            let (values, vectors) = skew_eigenpairs(a.as_ref()).unwrap();
            assert_eq!((values.len(), vectors.ncols()), (n / 2, n / 2));
            let size = a.norm_max().max(1e-300);
            let mut squares = 0.0;
            for (j, w) in values.iter().enumerate() {
                squares += w * w;
                assert!((vectors.col(j).norm_l2() - 1.0).abs() < 1e-13, "{n} {kind}");
                for i in 0..n {
                    let image: c64 = (0..n).map(|k| vectors[(k, j)] * a[(i, k)]).sum();
                    let left = image - c64::new(0.0, *w) * vectors[(i, j)];
                    assert!(left.norm() < 1e-13 * size * n as f64, "{n} {kind}: {:e}", left.norm());
                }
            }
            let trace = a.squared_norm_l2();
            assert!((2.0 * squares - trace).abs() <= 1e-12 * trace, "{n} {kind}");
            assert!(values.windows(2).all(|w| w[0] <= w[1]));
        }
    }
}
