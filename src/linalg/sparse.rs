//! Sparse matrices by columns, both triangles stored.

use crate::instructions::Instructions;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::traits::ComplexField;
use faer::traits::ext::ComplexFieldExt;
use faer::{Mat, MatRef, c64};
use pulp::{Arch, NullaryFnOnce};

/// Real sparse matrix, compressed by columns, rows ascending.
pub type Sparse = SparseColMat<usize, f64>;
/// The same with complex values.
pub type ComplexSparse = SparseColMat<usize, c64>;

/// Columns that are multiplied together, one row of them a cache line.
const LANES: usize = 8;

/// Product `A X` of a sparse matrix and columns, by blocks of columns.
pub fn multiply(a: &Sparse, x: MatRef<'_, f64>) -> Mat<f64> {
    let mut y = Mat::zeros(a.nrows(), x.ncols());
    Instructions::Widest.arch().unwrap_or(Arch::Scalar).dispatch(Product { a, x, y: &mut y });
    y
}

/// A product that is compiled for each set of vector instructions.
struct Product<'a> {
    a: &'a Sparse,
    x: MatRef<'a, f64>,
    y: &'a mut Mat<f64>,
}

impl NullaryFnOnce for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { a, x, y } = self;
        let columns = x.ncols();
        let mut first = 0;
        while first < columns {
            first += match columns - first {
                1 => lanes::<1>(a, x, y, first),
                2 => lanes::<2>(a, x, y, first),
                3 | 4 => lanes::<4>(a, x, y, first),
                _ => lanes::<LANES>(a, x, y, first),
            };
        }
    }
}

/// `N` columns of a product, or as many as there are; returns how many.
#[inline(always)]
fn lanes<const N: usize>(a: &Sparse, x: MatRef<'_, f64>, y: &mut Mat<f64>, first: usize) -> usize {
    let width = N.min(x.ncols() - first);
    let (starts, rows, values) = (a.symbolic().col_ptr(), a.symbolic().row_idx(), a.val());
    let mut sum = vec![[0.0; N]; a.nrows()];
    for j in 0..a.ncols() {
        let mut factor = [0.0; N];
        for k in 0..width {
            factor[k] = x[(j, first + k)];
        }
        for at in starts[j]..starts[j + 1] {
            let (target, value) = (&mut sum[rows[at]], values[at]);
            for k in 0..N {
                target[k] += value * factor[k];
            }
        }
    }
    for k in 0..width {
        for i in 0..sum.len() {
            y[(i, first + k)] = sum[i][k];
        }
    }
    width
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
    let Some(((factor, first), rest)) = terms.split_first() else {
        return from_columns(0, vec![0], Vec::new(), Vec::new());
    };
    let (mut starts, mut rows) = (first.symbolic().col_ptr().to_vec(), first.symbolic().row_idx().to_vec());
    let mut values: Vec<T> = first.val().iter().map(|v| factor.mul_real(*v)).collect();
    for (factor, a) in rest {
        if starts == a.symbolic().col_ptr() && rows == a.symbolic().row_idx() {
            values.iter_mut().zip(a.val()).for_each(|(sum, v)| *sum += factor.mul_real(*v));
        } else {
            (starts, rows, values) = merged((&starts, &rows, &values), factor, a);
        }
    }
    from_columns(first.ncols(), starts, rows, values)
}

/// A matrix by its columns (starts, rows, values) plus `factor A`, by its columns.
fn merged<T: ComplexField<Real = f64> + std::ops::AddAssign>(
    (starts, rows, values): (&[usize], &[usize], &[T]),
    factor: &T,
    a: &Sparse,
) -> (Vec<usize>, Vec<usize>, Vec<T>) {
    let (other_starts, other_rows, other_values) = (a.symbolic().col_ptr(), a.symbolic().row_idx(), a.val());
    let room = rows.len().max(other_rows.len());
    let mut sum = (Vec::with_capacity(starts.len()), Vec::with_capacity(room), Vec::with_capacity(room));
    sum.0.push(0);
    for j in 0..a.ncols() {
        let (mut k, mut l) = (starts[j], other_starts[j]);
        let (end, other_end) = (starts[j + 1], other_starts[j + 1]);
        while k < end || l < other_end {
            let row = if k < end { rows[k] } else { usize::MAX };
            let other = if l < other_end { other_rows[l] } else { usize::MAX };
            sum.1.push(row.min(other));
            let mut value = T::zero_impl();
            if row <= other {
                value = values[k].clone();
                k += 1;
            }
            if other <= row {
                value += factor.mul_real(other_values[l]);
                l += 1;
            }
            sum.2.push(value);
        }
        sum.0.push(sum.1.len());
    }
    sum
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
