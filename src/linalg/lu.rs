//! Sparse `L U` factorisation of general matrices, and of those that a reflection makes symmetric.

use super::factor::Ldlt;
use super::sparse::Sparse;
use crate::error::{Error, Result};
use faer::Mat;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Lu;

/// Relative size of what a reflection may leave unsymmetric.
const SYMMETRIC: f64 = 1e-12;

/// A factorised matrix `A`, symmetric after a change of signs or general.
pub enum Factor {
    /// `Q A` is symmetric for the signs Q.
    Reflected(Ldlt<f64>, Vec<f64>),
    /// No such signs.
    General(Box<Lu<usize, f64>>),
}

impl Factor {
    /// Factorises A. The equations of a shaft that spins are symmetric but for terms in `M J`, which change sign
    /// when the shaft is reflected in a plane of symmetry: with Q that reflection `Q A Q = A^T`, hence `Q A` is
    /// symmetric and (quasi-definite) factorises without pivoting, at half the price of `L U`.
    /// `reflections` are the candidates for Q.
    ///
    /// # Errors
    /// A singular matrix or lack of memory.
    pub fn new(a: &Sparse, reflections: &[Vec<f64>]) -> Result<Self> {
        for signs in reflections {
            if is_symmetric_with(a, signs) {
                return Ok(Self::Reflected(Ldlt::new(&with_signs(a, signs))?, signs.clone()));
            }
        }
        let lu = a.sp_lu().map_err(|e| {
            Error::analysis(
                "a system matrix could not be factorised",
                format!("sparse LU: {e:?}"),
                "check supports and bearings for values that differ by more than ten decades",
            )
        })?;
        Ok(Self::General(Box::new(lu)))
    }

    /// `x := A^-1 x`.
    pub fn solve_in_place(&self, x: &mut Mat<f64>) {
        match self {
            Self::Reflected(ldlt, signs) => {
                for j in 0..x.ncols() {
                    x.col_mut(j).iter_mut().zip(signs).for_each(|(x, s)| *x *= s);
                }
                ldlt.solve_in_place(x.as_mut());
            }
            Self::General(lu) => lu.solve_in_place(x.as_mut()),
        }
    }
}

/// `Q A` for signs Q.
fn with_signs(a: &Sparse, signs: &[f64]) -> Sparse {
    let mut result = a.clone();
    let rows: Vec<usize> = a.symbolic().row_idx().to_vec();
    result.val_mut().iter_mut().zip(rows).for_each(|(v, row)| *v *= signs[row]);
    result
}

/// True when `Q A` is symmetric up to rounding (an entry that rounding left on one side only is rounding).
fn is_symmetric_with(a: &Sparse, signs: &[f64]) -> bool {
    let entry = |i: usize, j: usize| {
        let place = a.row_idx_of_col_raw(j).binary_search(&i);
        place.map_or(0.0, |at| a.val_of_col(j)[at])
    };
    let diagonal: Vec<f64> = (0..a.ncols()).map(|j| entry(j, j).abs()).collect();
    (0..a.ncols()).all(|j| {
        let mut entries = a.row_idx_of_col_raw(j).iter().zip(a.val_of_col(j));
        entries.all(|(&i, v)| {
            (signs[i] * v - signs[j] * entry(j, i)).abs() <= SYMMETRIC * (diagonal[i] * diagonal[j]).sqrt()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::sparse::from_columns;

    /// `M + c J` for two masses coupled in y and z: rows (y1, z1, y2, z2).
    fn spinning(c: f64, defect: f64) -> Sparse {
        let rows = [[4.0, -c, -1.0, 0.0], [c, 4.0, 0.0, -1.0], [-1.0, defect, 3.0, -c], [0.0, -1.0, c, 3.0]];
        let (mut starts, mut index, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..4 {
            for (i, row) in rows.iter().enumerate().filter(|(_, row)| row[j] != 0.0) {
                index.push(i);
                values.push(row[j]);
            }
            starts.push(index.len());
        }
        from_columns(4, starts, index, values)
    }

    #[test]
    fn both_factors_solve() {
        let mirror = vec![1.0, -1.0, 1.0, -1.0];
        for (a, reflected) in [(spinning(2.0, 0.0), true), (spinning(2.0, 0.5), false)] {
            let factor = Factor::new(&a, &[vec![1.0; 4], mirror.clone()]).unwrap();
            assert_eq!(matches!(factor, Factor::Reflected(..)), reflected);
            let x = Mat::from_fn(4, 1, |i, _| 1.0 + i as f64);
            let mut b = crate::linalg::sparse::multiply(&a, x.as_ref());
            factor.solve_in_place(&mut b);
            assert!((b - x).norm_max() < 1e-14);
        }
    }
}
