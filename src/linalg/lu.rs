//! Sparse systems without symmetry: matrices summed from entries, and their LU factorisation.

use crate::error::{Error, Result};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::prelude::Solve;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::lu::simplicial::{
    self, SimplicialLu, factorize_simplicial_numeric_lu, factorize_simplicial_numeric_lu_scratch,
};
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use faer::traits::ComplexField;
use faer::traits::ext::ComplexFieldExt;
use faer::{Conj, Mat, Par};

/// Entries `(row, column, value)` of a square matrix, in any order; equal places are summed.
#[derive(Debug, Clone, Default)]
pub struct Entries {
    places: Vec<Pair<usize, usize>>,
    values: Vec<f64>,
}

impl Entries {
    /// Removes all entries and keeps the memory for the next matrix.
    pub fn clear(&mut self) {
        self.places.clear();
        self.values.clear();
    }

    /// Number of values that were added, those at equal places counted each.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// True when no value was added.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Adds a value at a place; several values at one place are summed.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.places.push(Pair::new(row, column));
        self.values.push(value);
    }

    /// Multiplies the matrix by a vector, `y = A x`; y is overwritten.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (place, value) in self.places.iter().zip(&self.values) {
            y[place.row] += value * x[place.col];
        }
    }
}

/// What depends on the places of the entries alone.
struct Pattern {
    places: Vec<Pair<usize, usize>>,
    symbolic: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    /// In which order columns are eliminated: by minimum degree of `A + A^T`. The matrices are almost symmetric, with pivots that
    /// stay near the diagonal; an order for any pivots leaves several times the fill.
    columns: Perm<usize>,
}

/// Factorises matrices one after the other; as long as their places are the same, the ordering is found once.
#[derive(Default)]
pub struct LuSolver {
    pattern: Option<Pattern>,
    factor: SimplicialLu<usize, f64>,
    /// Pivot rows of the factor; `None` without one.
    rows: Option<Perm<usize>>,
    /// Patterns of places that were ordered.
    pub orderings: usize,
}

fn failed(tried: String) -> Error {
    Error::analysis(
        "a system of equations could not be solved",
        tried,
        "check that supports or contact hold every body; in a motion take a smaller contact.step",
    )
}

impl LuSolver {
    /// Solves `A x = b` in place; `n` unknowns.
    ///
    /// # Errors
    /// A singular matrix or values that are not finite.
    pub fn solve(&mut self, n: usize, a: &Entries, b: &mut [f64]) -> Result<()> {
        self.factorise(n, a)?;
        self.solve_again(b)
    }

    /// Factorises a matrix of `n` unknowns for [`Self::solve_again`].
    ///
    /// # Errors
    /// A matrix that can't be factorised.
    pub fn factorise(&mut self, n: usize, a: &Entries) -> Result<()> {
        self.rows = None;
        if n == 0 {
            return Ok(());
        }
        let pattern = match self.pattern.take() {
            Some(pattern) if pattern.places == a.places && pattern.symbolic.nrows() == n => pattern,
            _ => {
                self.orderings += 1;
                Pattern::new(n, a)?
            }
        };
        let pattern = self.pattern.insert(pattern);
        let matrix = SparseColMat::new_from_argsort(pattern.symbolic.clone(), &pattern.order, &a.values)
            .map_err(|e| failed(format!("sum of {} entries: {e:?}", a.values.len())))?;
        if self.factor.ncols() != n {
            self.factor = SimplicialLu::new();
        }
        let tried = || format!("factorisation of {n} unknowns");
        let mut memory = MemBuffer::try_new(factorize_simplicial_numeric_lu_scratch::<usize, f64>(n, n))
            .map_err(|e| failed(format!("{}: {e:?}", tried())))?;
        let (mut forward, mut inverse) = (vec![0; n], vec![0; n]);
        factorize_simplicial_numeric_lu(
            &mut forward,
            &mut inverse,
            &mut self.factor,
            matrix.as_ref(),
            pattern.columns.as_ref(),
            MemStack::new(&mut memory),
        )
        .map_err(|e| failed(format!("{}: {e:?}", tried())))?;
        self.rows = Some(Perm::new_checked(forward.into(), inverse.into(), n));
        Ok(())
    }

    /// Solves `A x = b` in place with the matrix that was factorised last.
    ///
    /// # Errors
    /// A singular matrix or values that are not finite.
    pub fn solve_again(&self, b: &mut [f64]) -> Result<()> {
        let n = b.len();
        if n == 0 {
            return Ok(());
        }
        let (Some(rows), Some(pattern)) = (&self.rows, &self.pattern) else {
            return Err(failed(format!("{n} unknowns: no matrix")));
        };
        let mut x = Mat::from_fn(n, 1, |i, _| b[i]);
        let mut memory = MemBuffer::new(simplicial::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq));
        self.factor.solve_in_place_with_conj(
            rows.as_ref(),
            pattern.columns.as_ref(),
            Conj::No,
            x.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        if x.col(0).iter().any(|v| !v.is_finite()) {
            return Err(failed(format!("{n} unknowns: the matrix is singular")));
        }
        b.iter_mut().zip(x.col(0).iter()).for_each(|(b, x)| *b = *x);
        Ok(())
    }
}

/// The LU factorisation of one sparse matrix, real or complex.
pub struct SparseLu<T> {
    factor: Lu<usize, T>,
    size: usize,
}

impl<T: ComplexField<Real = f64>> SparseLu<T> {
    /// Factorises a matrix.
    ///
    /// # Errors
    /// A singular matrix, or lack of memory.
    pub fn new(a: &SparseColMat<usize, T>) -> Result<Self> {
        let size = a.ncols();
        let factor = a.sp_lu().map_err(|e| failed(format!("factorisation of {size} unknowns: {e:?}")))?;
        Ok(Self { factor, size })
    }

    /// Solves for one right side: `A^-1 b`.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn solve(&self, b: &[T]) -> Result<Vec<T>> {
        let x = self.solve_columns(Mat::from_fn(b.len(), 1, |i, _| b[i].clone()))?;
        Ok(x.col(0).iter().cloned().collect())
    }

    /// Solves for several right sides: `A^-1 B`.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn solve_columns(&self, mut b: Mat<T>) -> Result<Mat<T>> {
        self.factor.solve_in_place(&mut b);
        let finite = |v: &T| v.real().is_finite() && v.imag().is_finite();
        if b.col_iter().any(|column| column.iter().any(|v| !finite(v))) {
            return Err(failed(format!("{} unknowns: the matrix is singular", self.size)));
        }
        Ok(b)
    }
}

impl Pattern {
    fn new(n: usize, a: &Entries) -> Result<Self> {
        let (symbolic, order) = SymbolicSparseColMat::try_new_from_indices(n, n, &a.places)
            .map_err(|e| failed(format!("pattern of {n} unknowns: {e:?}")))?;
        let (mut forward, mut inverse) = (vec![0; n], vec![0; n]);
        let scratch = amd::order_maybe_unsorted_scratch::<usize>(n, symbolic.compute_nnz());
        let mut memory =
            MemBuffer::try_new(scratch).map_err(|e| failed(format!("ordering of {n} unknowns: {e:?}")))?;
        let stack = MemStack::new(&mut memory);
        amd::order_maybe_unsorted(&mut forward, &mut inverse, symbolic.as_ref(), Default::default(), stack)
            .map_err(|e| failed(format!("ordering of {n} unknowns: {e:?}")))?;
        let columns = Perm::new_checked(forward.into(), inverse.into(), n);
        Ok(Self { places: a.places.clone(), symbolic, order, columns })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An almost symmetric band against its product with a known vector; the second matrix of the pattern is ordered no more; a smaller
    /// one afterwards is another pattern.
    #[test]
    fn systems_are_solved_with_one_ordering() {
        let mut solver = LuSolver::default();
        for (n, factor, orderings) in [(40, 1.0, 1), (40, 3.0, 1), (17, 1.0, 2)] {
            let mut entries = Entries::default();
            for i in 0..n {
                entries.add(i, i, 4.0 * factor + i as f64);
                if i + 3 < n {
                    entries.add(i, i + 3, -1.0 + 0.1 * factor);
                    entries.add(i + 3, i, -1.0);
                }
            }
            let x: Vec<f64> = (0..n).map(|i| (0.7 * i as f64).sin()).collect();
            let mut b = vec![0.0; n];
            entries.multiply(&x, &mut b);
            solver.solve(n, &entries, &mut b).unwrap();
            let error = b.iter().zip(&x).map(|(b, x)| (b - x).abs()).fold(0.0, f64::max);
            assert!(error < 1e-13, "{n}: {error:e}");
            assert_eq!(solver.orderings, orderings);
        }
        // a row of zeros
        let mut singular = Entries::default();
        singular.add(0, 0, 1.0);
        singular.add(1, 1, 0.0);
        assert!(solver.solve(2, &singular, &mut [1.0, 1.0]).is_err());
    }
}
