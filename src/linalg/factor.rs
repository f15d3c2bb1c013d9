//! Sparse `L D L^H` factorisation of symmetric or Hermitian matrices, and their inertia.

use crate::error::{Error, Result};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::perm::Perm;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SparseColMat};
use faer::traits::ComplexField;
use faer::traits::ext::ComplexFieldExt;
use faer::{Conj, MatMut, Par, Side};

/// A factorised matrix `A = L D L^H` without pivoting.
pub struct Ldlt<T> {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<T>,
}

/// What the message names when there is too little memory.
const FACTORS: &str = "the factors of a system matrix";

fn failed(what: String) -> Error {
    Error::analysis(
        "a system matrix could not be factorised",
        what,
        "check supports and bearings for values that differ by more than ten decades",
    )
}

impl<T: ComplexField<Real = f64>> Ldlt<T> {
    /// Factorises a symmetric (Hermitian) matrix; only its lower triangle is read.
    ///
    /// Unknowns are ordered by connected component of the matrix, then as they come: a doubly symmetric shaft falls into
    /// four uncoupled banded systems (axial, torsional, two planes of bending).
    ///
    /// # Errors
    /// A zero pivot or lack of memory.
    pub fn new(a: &SparseColMat<usize, T>) -> Result<Self> {
        let order = by_component(a);
        let ordering = Perm::new_checked(order.0.into_boxed_slice(), order.1.into_boxed_slice(), a.ncols());
        let symbolic = factorize_symbolic_cholesky(
            a.symbolic(),
            Side::Lower,
            SymmetricOrdering::Custom(ordering.as_ref()),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        );
        let symbolic = symbolic.map_err(|e| match e {
            FaerError::OutOfMemory => Error::memory(FACTORS),
            other => failed(format!("symbolic factorisation: {other:?}")),
        })?;
        let mut values = Vec::new();
        values.try_reserve_exact(symbolic.len_val()).map_err(|_| Error::memory(FACTORS))?;
        values.resize(symbolic.len_val(), T::zero_impl());
        let mut memory =
            MemBuffer::try_new(symbolic.factorize_numeric_ldlt_scratch::<T>(Par::Seq, Default::default()))
                .map_err(|_| Error::memory(FACTORS))?;
        symbolic
            .factorize_numeric_ldlt(
                &mut values,
                a.as_ref(),
                Side::Lower,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|e| failed(format!("numeric factorisation: {e:?}")))?;
        Ok(Self { symbolic, values })
    }

    /// `x := A^-1 x` for every column.
    pub fn solve_in_place(&self, x: MatMut<'_, T>) {
        let scratch = self.symbolic.solve_in_place_scratch::<T>(x.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        LdltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }

    /// Number of negative pivots: by Sylvester's law the number of negative eigenvalues.
    /// `None` when a pivot is not finite.
    pub fn negative_pivots(&self) -> Option<usize> {
        let pivots = self.pivots();
        pivots.iter().all(|d| d.is_finite()).then(|| pivots.iter().filter(|d| **d < 0.0).count())
    }

    fn pivots(&self) -> Vec<f64> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(s) => {
                s.col_ptr()[..s.ncols()].iter().map(|&at| self.values[at].real()).collect()
            }
            SymbolicCholeskyRaw::Supernodal(s) => {
                let mut pivots = Vec::with_capacity(s.ncols());
                for k in 0..s.n_supernodes() {
                    let columns = s.supernode_end()[k] - s.supernode_begin()[k];
                    let first = s.col_ptr_for_val()[k];
                    let rows = (s.col_ptr_for_val()[k + 1] - first) / columns.max(1);
                    pivots.extend((0..columns).map(|j| self.values[first + j * (rows + 1)].real()));
                }
                pivots
            }
        }
    }
}

/// Forward and inverse permutation that sorts the unknowns by connected component, else keeps them.
fn by_component<T>(a: &SparseColMat<usize, T>) -> (Vec<usize>, Vec<usize>) {
    let n = a.ncols();
    let mut component = vec![usize::MAX; n];
    let mut stack = Vec::new();
    let mut count = 0;
    for start in 0..n {
        if component[start] != usize::MAX {
            continue;
        }
        component[start] = count;
        stack.push(start);
        while let Some(j) = stack.pop() {
            for &i in a.symbolic().row_idx_of_col_raw(j) {
                if component[i] == usize::MAX {
                    component[i] = count;
                    stack.push(i);
                }
            }
        }
        count += 1;
    }
    let mut forward: Vec<usize> = (0..n).collect();
    forward.sort_by_key(|&i| component[i]);
    let mut inverse = vec![0; n];
    for (at, &i) in forward.iter().enumerate() {
        inverse[i] = at;
    }
    (forward, inverse)
}
