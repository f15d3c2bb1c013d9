//! Sparse matrices by columns, both triangles stored.

use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::traits::ComplexField;
use faer::traits::ext::ComplexFieldExt;
use faer::{Mat, MatRef};

/// Real sparse matrix, compressed by columns, rows ascending.
pub type Sparse = SparseColMat<usize, f64>;

/// Columns that are multiplied together, one row of them a cache line.
const LANES: usize = 8;

/// `A X`.
pub fn multiply(a: &Sparse, x: MatRef<'_, f64>) -> Mat<f64> {
    let mut y = Mat::zeros(a.nrows(), x.ncols());
    let (starts, rows, values) = (a.symbolic().col_ptr(), a.symbolic().row_idx(), a.val());
    let mut sum = vec![[0.0; LANES]; a.nrows()];
    for first in (0..x.ncols()).step_by(LANES) {
        let width = LANES.min(x.ncols() - first);
        sum.fill([0.0; LANES]);
        for j in 0..a.ncols() {
            let mut factor = [0.0; LANES];
            for (k, f) in factor[..width].iter_mut().enumerate() {
                *f = x[(j, first + k)];
            }
            let column = starts[j]..starts[j + 1];
            for (&row, &value) in rows[column.clone()].iter().zip(&values[column]) {
                for (s, f) in sum[row].iter_mut().zip(&factor) {
                    *s += value * f;
                }
            }
        }
        for k in 0..width {
            for (target, s) in y.col_mut(first + k).iter_mut().zip(&sum) {
                *target = s[k];
            }
        }
    }
    y
}

/// Norm of `|A| |x|` (absolute values entry by entry): the scale of the rounding error of `A x`.
pub fn absolute_product_norm(a: &Sparse, x: &[f64]) -> f64 {
    absolute_product(a, x).iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// `|A| |x|`, absolute values entry by entry.
pub fn absolute_product(a: &Sparse, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.nrows()];
    for (j, &factor) in x.iter().enumerate() {
        for (&row, value) in a.row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)) {
            y[row] += (value * factor).abs();
        }
    }
    y
}

/// `sum_k factor_k A_k` on the union of the patterns. All matrices have one shape.
pub fn combine<T: ComplexField<Real = f64> + std::ops::AddAssign>(
    terms: &[(T, &Sparse)],
) -> SparseColMat<usize, T> {
    let n = terms.first().map_or(0, |(_, a)| a.ncols());
    let mut starts = vec![0];
    let (mut rows, mut values): (Vec<usize>, Vec<T>) = (Vec::new(), Vec::new());
    let mut at: Vec<usize> = Vec::new();
    for j in 0..n {
        at.clear();
        at.extend(terms.iter().map(|(_, a)| a.symbolic().col_ptr()[j]));
        loop {
            let next = terms
                .iter()
                .zip(&at)
                .filter(|((_, a), at)| **at < a.symbolic().col_ptr()[j + 1])
                .map(|((_, a), at)| a.symbolic().row_idx()[*at])
                .min();
            let Some(row) = next else { break };
            let mut sum = T::zero_impl();
            for ((factor, a), at) in terms.iter().zip(at.iter_mut()) {
                if *at < a.symbolic().col_ptr()[j + 1] && a.symbolic().row_idx()[*at] == row {
                    sum += factor.mul_real(a.val()[*at]);
                    *at += 1;
                }
            }
            rows.push(row);
            values.push(sum);
        }
        starts.push(rows.len());
    }
    from_columns(n, starts, rows, values)
}

/// `(A + A^T) / 2`.
pub fn symmetric_part(a: &Sparse) -> Sparse {
    let transposed = a.transpose().to_col_major();
    transposed.map_or_else(|_| a.clone(), |t| combine(&[(0.5, a), (0.5, &t)]))
}

/// A square matrix from its compressed columns (rows ascending within each).
pub fn from_columns<T>(
    n: usize,
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<T>,
) -> SparseColMat<usize, T> {
    SparseColMat::new(SymbolicSparseColMat::new_checked(n, n, starts, None, rows), values)
}
