//! Natural modes of the shaft at rest, proved complete: the basis of every linear analysis.
//!
//! `K x = w^2 M x` by block Lanczos on the flexibility; motions without strain are found from the
//! constraints, not from small numbers, and kept apart.

use crate::assembly::Assembly;
use crate::error::Result;
use crate::linalg::factor::Ldlt;
use crate::linalg::lanczos::{self, Pencil};
use crate::linalg::sparse::{Sparse, absolute_product_norm, combine, multiply};
use faer::Mat;

/// Generalised inverse of the stiffness: exact on forces in balance, its result free of rigid motion.
pub struct Flexibility {
    factor: Ldlt<f64>,
    /// Rigid motions R, `R^T M R = I`.
    pub rigid: Mat<f64>,
    /// `M R`.
    pub mass_rigid: Mat<f64>,
}

impl Flexibility {
    /// Factorises `K`, pinned at as many coordinates as there are rigid motions (statically determinate
    /// pins carry no force when the load is in balance, so nothing is approximated).
    ///
    /// # Errors
    /// When the factorisation fails.
    pub fn new(stiffness: &Sparse, mass: &Sparse, motions: Mat<f64>) -> Result<Self> {
        let rigid = mass_orthonormal(mass, motions);
        let mass_rigid = multiply(mass, rigid.as_ref());
        let mut pinned = stiffness.clone();
        pin(&mut pinned, &rigid);
        Ok(Self { factor: Ldlt::new(&pinned)?, rigid, mass_rigid })
    }

    /// `K^+ F` for every column: the part of F out of balance (`M R R^T F`) is left out, and the answer has
    /// no rigid motion (`R^T M x = 0`).
    pub fn solve(&self, mut f: Mat<f64>) -> Mat<f64> {
        if self.rigid.ncols() > 0 {
            f -= &self.mass_rigid * (self.rigid.transpose() * &f);
        }
        self.factor.solve_in_place(f.as_mut());
        self.without_rigid(&mut f);
        f
    }

    /// Directions of negative stiffness (negative pivots); all of them if a pivot is no number.
    pub fn unstable_directions(&self) -> usize {
        self.factor.negative_pivots().unwrap_or(usize::MAX)
    }

    /// Removes the rigid motion from every column.
    pub fn without_rigid(&self, x: &mut Mat<f64>) {
        if self.rigid.ncols() > 0 {
            *x -= &self.rigid * (self.mass_rigid.transpose() * &*x);
        }
    }
}

/// Doubles the diagonal of a matrix where pins stop every one of the rigid motions (in columns).
pub fn pin(matrix: &mut Sparse, rigid: &Mat<f64>) {
    for at in pins(rigid) {
        let (starts, rows) = (matrix.symbolic().col_ptr()[at], matrix.symbolic().row_idx_of_col_raw(at));
        if let Some(offset) = rows.iter().position(|&row| row == at) {
            matrix.val_mut()[starts + offset] *= 2.0;
        }
    }
}

/// Coordinates where pins stop every rigid motion: complete pivoting on the motions.
fn pins(rigid: &Mat<f64>) -> Vec<usize> {
    let mut rest = rigid.clone();
    let mut pins = Vec::new();
    for _ in 0..rigid.ncols() {
        let mut best = (0, 0, 0.0);
        for j in 0..rest.ncols() {
            for i in 0..rest.nrows() {
                if rest[(i, j)].abs() > best.2 {
                    best = (i, j, rest[(i, j)].abs());
                }
            }
        }
        let (row, column, size) = best;
        if size == 0.0 {
            break;
        }
        pins.push(row);
        let pivot = rest[(row, column)];
        let pivot_column: Vec<f64> = (0..rest.nrows()).map(|i| rest[(i, column)]).collect();
        for j in 0..rest.ncols() {
            let factor = rest[(row, j)] / pivot;
            for (i, p) in pivot_column.iter().enumerate() {
                rest[(i, j)] -= factor * p;
            }
        }
    }
    pins
}

/// `x^T M x = I` for the columns (Gram-Schmidt twice; the motions are independent).
fn mass_orthonormal(mass: &Sparse, mut x: Mat<f64>) -> Mat<f64> {
    for j in 0..x.ncols() {
        for _ in 0..2 {
            let m = multiply(mass, x.subcols(j, 1));
            for k in 0..j {
                let share: f64 = x.col(k).transpose() * m.col(0);
                for i in 0..x.nrows() {
                    x[(i, j)] -= share * x[(i, k)];
                }
            }
        }
        let m = multiply(mass, x.subcols(j, 1));
        let norm = (x.col(j).transpose() * m.col(0)).sqrt();
        for i in 0..x.nrows() {
            x[(i, j)] /= norm;
        }
    }
    x
}

/// The lowest natural modes with the matrices they belong to.
pub struct Spectrum {
    /// Mass.
    pub mass: Sparse,
    /// Stiffness.
    pub stiffness: Sparse,
    /// Generalised inverse of the stiffness, with the rigid motions.
    pub flexibility: Flexibility,
    /// Names of the rigid motions.
    pub rigid_names: Vec<String>,
    /// `w^2` of the modes with strain, ascending.
    pub values: Vec<f64>,
    /// Their shapes in columns, `x^T M x = 1`.
    pub vectors: Mat<f64>,
    /// True when a Sturm count confirms that no mode below the last one is missing.
    pub complete: bool,
}

impl Spectrum {
    /// The `wanted` lowest modes with strain (or all, when there are fewer).
    ///
    /// # Errors
    /// When the eigenvalue solver does not converge.
    pub fn new(assembly: &Assembly<'_>, wanted: usize) -> Result<Self> {
        let (mass, stiffness) = (assembly.mass(), assembly.stiffness());
        let (rigid_names, motions) = assembly.rigid_motions();
        let flexibility = Flexibility::new(&stiffness, &mass, motions)?;
        let (size, n_rigid) = (assembly.size(), rigid_names.len());
        let pencil = Pencil {
            size,
            rank: size - n_rigid,
            apply_k: &|x| multiply(&stiffness, x),
            apply_b: &|x| multiply(&mass, x),
            solve: &|f| flexibility.solve(f),
            clean: &|x| flexibility.without_rigid(x),
        };
        // A few more than wanted, so that the count falls into a gap; more again if one was missed.
        let mut extra = 3;
        let (values, vectors, complete) = loop {
            let pairs = lanczos::lowest(&pencil, wanted + extra)?;
            let (found, rank) = (pairs.values.len(), size - n_rigid);
            let kept = wanted.min(found);
            let (shift, below) = gap(&pairs.values, kept, rank);
            let shifted = combine(&[(1.0, &stiffness), (-shift, &mass)]);
            let count = Ldlt::new(&shifted)?.negative_pivots();
            let complete = count == Some(n_rigid + below);
            if complete || extra > 24 {
                break (pairs.values[..kept].to_vec(), pairs.vectors.get(.., ..kept).to_owned(), complete);
            }
            extra *= 3;
        };
        let mut vectors = vectors;
        normalise(&mass, &mut vectors);
        Ok(Self { mass, stiffness, flexibility, rigid_names, values, vectors, complete })
    }

    /// `|K x - w^2 M x|` over the norm of `|K| |x|` for the rigid motions and then the modes with strain.
    pub fn residuals(&self) -> Vec<f64> {
        let of = |x: &Mat<f64>, value: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let (kx, mx) = (multiply(&self.stiffness, x.as_ref()), multiply(&self.mass, x.as_ref()));
            (0..x.ncols())
                .map(|j| {
                    let norm = (kx.col(j) - mx.col(j) * faer::Scale(value(j))).norm_l2();
                    let column: Vec<f64> = x.col(j).iter().copied().collect();
                    norm / absolute_product_norm(&self.stiffness, &column)
                })
                .collect()
        };
        let mut list = of(&self.flexibility.rigid, &|_| 0.0);
        list.extend(of(&self.vectors, &|j| self.values[j]));
        list
    }
}

/// A shift in the widest gap at or above the `kept`-th value, and the number of values below it.
fn gap(values: &[f64], kept: usize, rank: usize) -> (f64, usize) {
    if values.len() == rank || kept == values.len() {
        return (values.last().map_or(1.0, |v| 1.5 * v), values.len());
    }
    let widest = (kept..values.len()).max_by(|&a, &b| {
        let ratio = |i: usize| values[i] / values[i.max(1) - 1];
        ratio(a).total_cmp(&ratio(b))
    });
    let at = widest.unwrap_or(kept);
    if at == 0 { (values[0] / 2.0, 0) } else { ((values[at - 1] * values[at]).sqrt(), at) }
}

/// Scales every column to `x^T M x = 1`, largest entry positive.
fn normalise(mass: &Sparse, x: &mut Mat<f64>) {
    let mx = multiply(mass, x.as_ref());
    for j in 0..x.ncols() {
        let norm = (x.col(j).transpose() * mx.col(j)).sqrt();
        let largest = x.col(j).iter().copied().fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m });
        let scale = largest.signum() / norm;
        for i in 0..x.nrows() {
            x[(i, j)] *= scale;
        }
    }
}
