//! Sparse systems without symmetry: matrices summed from entries, and their LU factorisation.

use crate::error::{Error, Result};
use crate::linalg::sparse::Sparse;
use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};

/// Entries `(row, column, value)` of a square matrix, in any order; equal places are summed.
#[derive(Debug, Clone, Default)]
pub struct Entries {
    places: Vec<Pair<usize, usize>>,
    values: Vec<f64>,
}

impl Entries {
    /// Forgets all entries.
    pub fn clear(&mut self) {
        self.places.clear();
        self.values.clear();
    }

    /// Number of values added.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// True without any.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Adds a value.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.places.push(Pair::new(row, column));
        self.values.push(value);
    }

    /// `y = A x`.
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
    lu: SymbolicLu<usize>,
}

/// Factorises matrices one after the other; as long as their places are the same, ordering and fill are found once.
#[derive(Default)]
pub struct Solver {
    pattern: Option<Pattern>,
    factor: Option<Lu<usize, f64>>,
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

impl Solver {
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
        self.factor = None;
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
        let lu = Lu::try_new_with_symbolic(pattern.lu.clone(), matrix.as_ref())
            .map_err(|e| failed(format!("factorisation of {n} unknowns: {e:?}")))?;
        self.factor = Some(lu);
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
        let Some(factor) = &self.factor else { return Err(failed(format!("{n} unknowns: no matrix"))) };
        let mut x = Mat::from_fn(n, 1, |i, _| b[i]);
        factor.solve_in_place(&mut x);
        if x.col(0).iter().any(|v| !v.is_finite()) {
            return Err(failed(format!("{n} unknowns: the matrix is singular")));
        }
        b.iter_mut().zip(x.col(0).iter()).for_each(|(b, x)| *b = *x);
        Ok(())
    }
}

/// The LU factorisation of one sparse matrix.
pub struct SparseLu {
    factor: Lu<usize, f64>,
    size: usize,
}

impl SparseLu {
    /// Factorises a matrix.
    ///
    /// # Errors
    /// A singular matrix, or lack of memory.
    pub fn new(a: &Sparse) -> Result<Self> {
        let size = a.ncols();
        let factor = a.sp_lu().map_err(|e| failed(format!("factorisation of {size} unknowns: {e:?}")))?;
        Ok(Self { factor, size })
    }

    /// `A^-1 b`.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>> {
        let x = self.solve_columns(Mat::from_fn(b.len(), 1, |i, _| b[i]))?;
        Ok(x.col(0).iter().copied().collect())
    }

    /// `A^-1 B`.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn solve_columns(&self, mut b: Mat<f64>) -> Result<Mat<f64>> {
        self.factor.solve_in_place(&mut b);
        if b.col_iter().any(|column| column.iter().any(|v| !v.is_finite())) {
            return Err(failed(format!("{} unknowns: the matrix is singular", self.size)));
        }
        Ok(b)
    }
}

impl Pattern {
    fn new(n: usize, a: &Entries) -> Result<Self> {
        let (symbolic, order) = SymbolicSparseColMat::try_new_from_indices(n, n, &a.places)
            .map_err(|e| failed(format!("pattern of {n} unknowns: {e:?}")))?;
        let lu = SymbolicLu::try_new(symbolic.as_ref())
            .map_err(|e| failed(format!("ordering of {n} unknowns: {e:?}")))?;
        Ok(Self { places: a.places.clone(), symbolic, order, lu })
    }
}
