//! Dense eigenproblems of small (reduced) matrices.
//!
//! faer's eigenvectors lose accuracy on badly scaled matrices, so every matrix is scaled by a power of
//! two to unit norm first, and nonsymmetric results are checked against their residual.

use crate::error::{Error, Result};
use faer::linalg::solvers::Solve;
use faer::traits::ComplexField;
use faer::traits::ext::ComplexFieldExt;
use faer::{Mat, MatRef, Side, c64};

/// Eigenvalues (ascending) and orthonormal eigenvectors (columns) of a symmetric or Hermitian matrix;
/// only the lower triangle is read.
///
/// # Errors
/// No convergence, or entries that are not finite.
pub fn self_adjoint<T: ComplexField<Real = f64>>(a: MatRef<'_, T>) -> Result<(Vec<f64>, Mat<T>)> {
    let n = a.nrows();
    if n == 0 {
        return Ok((Vec::new(), Mat::zeros(0, 0)));
    }
    let scale = unit_scale(a.norm_max())?;
    let scaled = Mat::from_fn(n, n, |i, j| a[(i, j)].mul_real(scale));
    let eigen = scaled.self_adjoint_eigen(Side::Lower).map_err(|e| no_convergence(format!("{e:?}")))?;
    let values: Vec<f64> = eigen.S().column_vector().iter().map(|v| v.real() / scale).collect();
    if values.iter().any(|v| !v.is_finite()) {
        return Err(no_convergence("eigenvalues that are not finite".to_owned()));
    }
    Ok((values, eigen.U().to_owned()))
}

/// Eigenvalues and right eigenvectors (columns, unit norm) of a real nonsymmetric matrix.
///
/// # Errors
/// No convergence, or a residual `|A x - lambda x|` above 1e-9 of the norm of A.
pub fn general(a: MatRef<'_, f64>) -> Result<(Vec<c64>, Mat<c64>)> {
    let n = a.nrows();
    if n == 0 {
        return Ok((Vec::new(), Mat::zeros(0, 0)));
    }
    let scale = unit_scale(a.norm_max())?;
    let scaled = Mat::from_fn(n, n, |i, j| a[(i, j)] * scale);
    let eigen = scaled.eigen().map_err(|e| no_convergence(format!("{e:?}")))?;
    let values: Vec<c64> = eigen.S().column_vector().iter().copied().collect();
    let mut vectors = eigen.U().to_owned();
    for j in 0..n {
        let norm = vectors.col(j).norm_l2();
        for i in 0..n {
            // a vector that came out as no number starts anew, different for each column
            let usable = norm.is_finite() && norm > 0.0;
            vectors[(i, j)] =
                if usable { vectors[(i, j)] / norm } else { c64::new((1 + i * (j + 7) % 11) as f64, 0.0) };
        }
    }
    let complex = Mat::from_fn(n, n, |i, j| c64::new(scaled[(i, j)], 0.0));
    let norm = scaled.norm_l2();
    for j in 0..n {
        let mut error = residual(&complex, values[j], vectors.as_ref(), j);
        for _ in 0..3 {
            // written so that a residual that is not a number is worked on too
            if !(error <= 1e-13 * norm) {
                sharpen(&complex, values[j], &mut vectors, j, norm);
                error = residual(&complex, values[j], vectors.as_ref(), j);
            }
        }
        // written so that a residual that is not a number fails too
        if !(error <= 1e-9 * norm) {
            return Err(no_convergence(format!("eigenvector residual {:.1e}", error / norm)));
        }
    }
    Ok((values.into_iter().map(|v| v / scale).collect(), vectors))
}

/// Diagonalises a symmetric positive definite matrix in place by Jacobi rotations and returns the
/// eigenvectors in columns. For a graded, nearly diagonal matrix every eigenvalue keeps its own digits.
pub fn graded_eigenvectors(a: &mut Mat<f64>) -> Mat<f64> {
    let n = a.nrows();
    let mut vectors = Mat::<f64>::identity(n, n);
    for _sweep in 0..20 {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let off = (a[(p, q)] + a[(q, p)]) / 2.0;
                // written so that entries that are not numbers end the work
                if !(off.abs() > 1e-15 * (a[(p, p)] * a[(q, q)]).abs().sqrt()) {
                    continue;
                }
                rotated = true;
                let half = (a[(q, q)] - a[(p, p)]) / (2.0 * off);
                let t = half.signum() / (half.abs() + half.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for k in 0..n {
                    let (x, y) = (a[(k, p)], a[(k, q)]);
                    (a[(k, p)], a[(k, q)]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (vectors[(k, p)], vectors[(k, q)]);
                    (vectors[(k, p)], vectors[(k, q)]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[(p, k)], a[(q, k)]);
                    (a[(p, k)], a[(q, k)]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    vectors
}

/// Lower factor L of a symmetric positive definite matrix `A = L L^T` (lower triangle read); `None` when it
/// is not positive definite. A graded matrix keeps the digits of its small entries.
pub fn cholesky(a: MatRef<'_, f64>) -> Option<Mat<f64>> {
    let n = a.nrows();
    let mut l: Mat<f64> = Mat::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let rest = a[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
            if i == j {
                // written so that a pivot that is no number fails too
                if !(rest > 1e-14 * a[(j, j)]) {
                    return None;
                }
                l[(j, j)] = rest.sqrt();
            } else {
                l[(i, j)] = rest / l[(j, j)];
            }
        }
    }
    Some(l)
}

/// `A L^-T` for a lower triangle L.
pub fn over_lower(a: &Mat<f64>, l: MatRef<'_, f64>) -> Mat<f64> {
    let mut x = a.clone();
    for j in 0..l.ncols() {
        for k in 0..j {
            let factor = l[(j, k)];
            if factor != 0.0 {
                for i in 0..x.nrows() {
                    x[(i, j)] -= factor * x[(i, k)];
                }
            }
        }
        x.col_mut(j).iter_mut().for_each(|v| *v /= l[(j, j)]);
    }
    x
}

/// `|A x - lambda x|` of column j.
fn residual(a: &Mat<c64>, lambda: c64, x: MatRef<'_, c64>, j: usize) -> f64 {
    let x = x.subcols(j, 1);
    (a * x - x * faer::Scale(lambda)).norm_l2()
}

/// One step of inverse iteration on column j, keeping its length of one.
fn sharpen(a: &Mat<c64>, lambda: c64, x: &mut Mat<c64>, j: usize, norm: f64) {
    let shift = lambda + 1e-15 * norm;
    let shifted =
        Mat::from_fn(a.nrows(), a.ncols(), |i, k| if i == k { a[(i, k)] - shift } else { a[(i, k)] });
    let next = shifted.partial_piv_lu().solve(x.subcols(j, 1));
    let length = next.norm_l2();
    if length.is_finite() && length > 0.0 {
        for i in 0..a.nrows() {
            x[(i, j)] = next[(i, 0)] / length;
        }
    }
}

/// The power of two that brings `norm` to about one (exact, so no digit is lost).
pub(super) fn unit_scale(norm: f64) -> Result<f64> {
    if norm == 0.0 {
        Ok(1.0)
    } else if norm.is_finite() {
        Ok((-norm.log2().round()).exp2())
    } else {
        Err(no_convergence("matrix entries that are not finite".to_owned()))
    }
}

pub(super) fn no_convergence(what: String) -> Error {
    Error::analysis(
        "a reduced eigenproblem could not be solved",
        what,
        "change `campbell.reduction` or check the case for values that differ by many decades",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A badly scaled symmetric matrix above the size where plain faer calls went wrong.
    #[test]
    fn badly_scaled_symmetric_problem_keeps_its_residual() {
        let n = 160;
        let a = Mat::from_fn(n, n, |i, j| {
            let (p, q) = (i.min(j) as f64, i.max(j) as f64);
            1e12 * (-(q - p) / 3.0).exp() * (1.0 + (p * 1.3).sin()) * 0.5
        });
        let (values, vectors) = self_adjoint(a.as_ref()).unwrap();
        let residual = &a * &vectors - Mat::from_fn(n, n, |i, j| vectors[(i, j)] * values[j]);
        assert!(residual.norm_l2() < 1e-12 * a.norm_l2());
        let (left, right) = (vectors.transpose() * &vectors, Mat::<f64>::identity(n, n));
        assert!((left - right).norm_l2() < 1e-11);
    }

    /// diag(1, 1e-8, 1e-16) in a turned basis of graded rotations: the smallest eigenvalue to full accuracy.
    #[test]
    fn graded_matrices_keep_their_smallest_eigenvalues() {
        let d = [1.0, 1e-8, 1e-16];
        let exact = Mat::from_fn(3, 3, |i, j| {
            let t = [[1.0, 0.3, 0.2], [0.3, 1.0, 0.4], [0.2, 0.4, 1.0]][i][j];
            t * f64::sqrt(d[i] * d[j])
        });
        let mut a = exact.clone();
        let vectors = graded_eigenvectors(&mut a);
        // the determinant is exact: product of the scales times that of the correlation matrix
        let correlation = 1.0 - 0.09 - 0.04 - 0.16 + 2.0 * 0.3 * 0.4 * 0.2;
        let product = a[(0, 0)] * a[(1, 1)] * a[(2, 2)] / 1e-24;
        assert!((product / correlation - 1.0).abs() < 1e-14, "{product}");
        assert!((vectors.transpose() * &vectors - Mat::<f64>::identity(3, 3)).norm_max() < 1e-15);
    }

    #[test]
    fn rotation_has_imaginary_eigenvalues_at_any_scale() {
        for scale in [1e-200, 1.0, 1e200] {
            let a = Mat::from_fn(2, 2, |i, j| scale * (i as f64 - j as f64));
            let (values, _) = general(a.as_ref()).unwrap();
            assert!(
                values.iter().all(|v| v.re.abs() < 1e-14 * scale && (v.im.abs() / scale - 1.0).abs() < 1e-14)
            );
        }
    }
}
