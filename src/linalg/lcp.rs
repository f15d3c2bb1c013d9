//! Linear complementarity problems: `w = N z + p >= 0`, `z >= 0`, `z . w = 0`.
//!
//! Lemke's complementary pivoting with a covering vector of ones and the lexicographic ratio test, which cannot cycle
//! on the rank-deficient matrices `N = D^T M^-1 D` of redundant contacts. A problem without an answer is an error,
//! never an answer of zeros.
//!
//! Source: R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem* (1992), sections 4.4 and 4.9.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef};

/// Relative residual of an answer, see [`lemke`].
const TOLERANCE: f64 = 1e-9;
/// Entries of a column below this share of its largest one (or of one) are rounding errors, not pivots.
const SMALLEST_PIVOT: f64 = 1e-11;
/// Ratios this near each other (relative, and absolute in the scaled problem) are tied.
const TIE: f64 = 1e-13;

/// Weight of the proximal term, in the scaled problem: far above rounding errors, far below a usual stiffness.
const PROXIMAL: f64 = 1e-6;
/// Proximal steps before a problem is given up.
const PROXIMAL_STEPS: usize = 30;

/// Why a linear complementarity problem was left unsolved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LcpFailure {
    /// The pivoting ended on a secondary ray; for a positive semidefinite N this says that, to rounding, no `z >= 0` has
    /// `N z + p >= 0`.
    #[error("the complementarity problem has no solution within reach: pivoting ended on a ray")]
    Ray,
    /// The pivots allowed did not suffice.
    #[error("the complementarity problem took more pivots than allowed")]
    Limit,
    /// N, p or the answer holds a value that is no finite number.
    #[error("the complementarity problem or its solution holds values that are not finite")]
    NotFinite,
    /// The pivoting ended, but rounding left a residual above 1e-9.
    #[error("the complementarity problem is too badly conditioned to be solved to a residual of 1e-9")]
    Inaccurate,
}

/// Solves `w = N z + p >= 0`, `z >= 0`, `z . w = 0` for z with at most `pivots` exchanges (some multiple of the size,
/// such as ten, is ample).
///
/// Row i may have a unit of its own: the problem is solved as `S N S`, `S p` with the diagonal S that brings the largest
/// entry of each row to about one, and with the largest violation `max(-S p)` as the unit of p. In these units the
/// answer has, for each i, `w_i >= -1e-9 (1 + |p_i|)` and either `w_i` below that bound or `z_i` below 1e-9 of the
/// largest.
///
/// Where the pivoting fails, as rounding can make it on nearly redundant contacts, the proximal point method (Rockafellar
/// 1976) follows: the well-conditioned problems of `N + e`, `p - e z` in turn, whose answers z tend to one of the problem
/// itself if N is positive semidefinite and it has one.
///
/// # Errors
/// [`LcpFailure`]. Of a positive semidefinite N, only a problem without a solution, or one so badly conditioned (1e10 and
/// more) that rounding makes it one, ends on a ray.
///
/// # Panics
/// N is not square with as many rows as p has entries.
pub fn lemke(n: MatRef<'_, f64>, p: &[f64], pivots: usize) -> Result<Vec<f64>, LcpFailure> {
    assert!(n.nrows() == p.len() && n.ncols() == p.len(), "N must be square and of the size of p");
    if !(p.iter().all(|v| v.is_finite()) && n.is_all_finite()) {
        return Err(LcpFailure::NotFinite);
    }
    if p.iter().all(|v| *v >= 0.0) {
        return Ok(vec![0.0; p.len()]);
    }
    let scale = equilibrate(n);
    let unit = power_of_two(p.iter().zip(&scale).map(|(p, s)| -p * s).fold(0.0, f64::max));
    let problem = Problem {
        n: Mat::from_fn(p.len(), p.len(), |i, j| n[(i, j)] * scale[i] * scale[j]),
        p: p.iter().zip(&scale).map(|(p, s)| p * s / unit).collect(),
    };
    let z = problem.solve(pivots)?;
    let z: Vec<f64> = z.iter().zip(&scale).map(|(z, s)| z * s * unit).collect();
    if z.iter().all(|v| v.is_finite()) { Ok(z) } else { Err(LcpFailure::NotFinite) }
}

/// A complementarity problem after its rows and its right-hand side were scaled to about one.
struct Problem {
    n: Mat<f64>,
    p: Vec<f64>,
}

/// The dictionary of a basis: variables 0..n are w, n..2n are z, 2n is the covering variable.
struct Basis {
    /// The variable of each row.
    variables: Vec<usize>,
    /// Each row's value, then its row of the inverse of the basis. Every row is lexicographically positive.
    rows: Vec<Vec<f64>>,
}

impl Problem {
    fn solve(&self, pivots: usize) -> Result<Vec<f64>, LcpFailure> {
        self.pivoted(pivots).or_else(|failure| self.proximal(pivots).ok_or(failure))
    }

    fn proximal(&self, pivots: usize) -> Option<Vec<f64>> {
        let size = self.p.len();
        let n = &self.n + Mat::<f64>::identity(size, size) * faer::Scale(PROXIMAL);
        let mut step = Problem { n, p: self.p.clone() };
        for _ in 0..PROXIMAL_STEPS {
            let z = step.pivoted(pivots).ok()?;
            if self.residual(&z) <= TOLERANCE {
                return Some(z);
            }
            step.p = self.p.iter().zip(&z).map(|(p, z)| p - PROXIMAL * z).collect();
        }
        None
    }

    fn pivoted(&self, pivots: usize) -> Result<Vec<f64>, LcpFailure> {
        let size = self.p.len();
        let cover = 2 * size;
        let mut basis = Basis {
            variables: (0..size).collect(),
            rows: (0..size)
                .map(|i| {
                    let mut row = vec![0.0; size + 1];
                    (row[0], row[i + 1]) = (self.p[i], 1.0);
                    row
                })
                .collect(),
        };
        // the lexicographically smallest row: the last one of those with the smallest p
        let first = (0..size).fold(0, |best, i| if self.p[i] <= self.p[best] { i } else { best });
        let mut leaving = basis.exchange(first, cover, &vec![-1.0; size]);
        for _ in 0..pivots {
            let entering = (leaving + size) % cover;
            let column = self.column(&basis, entering);
            let Some(row) = basis.leaving_row(&column, cover) else {
                // on the edge of what has a solution rounding may leave a trace of the covering variable
                return self.answer(&basis).map_err(|_| LcpFailure::Ray);
            };
            leaving = basis.exchange(row, entering, &column);
            if leaving == cover {
                return self.answer(&basis);
            }
        }
        Err(LcpFailure::Limit)
    }

    /// Column of a w or z in the present basis: the inverse times its column of `[I, -N]`.
    fn column(&self, basis: &Basis, variable: usize) -> Vec<f64> {
        let size = self.p.len();
        let entry = |row: &Vec<f64>| {
            if variable < size {
                row[variable + 1]
            } else {
                -(0..size).map(|k| row[k + 1] * self.n[(k, variable - size)]).sum::<f64>()
            }
        };
        basis.rows.iter().map(entry).collect()
    }

    /// The z of a basis, solved anew from `N_BB z_B = -p_B` unless the dictionary's own values are better.
    fn answer(&self, basis: &Basis) -> Result<Vec<f64>, LcpFailure> {
        let size = self.p.len();
        let (mut active, mut z) = (Vec::new(), vec![0.0; size]);
        for (&variable, row) in basis.variables.iter().zip(&basis.rows) {
            if (size..2 * size).contains(&variable) {
                active.push(variable - size);
                z[variable - size] = row[0].max(0.0);
            }
        }
        let factors =
            Mat::from_fn(active.len(), active.len(), |i, j| self.n[(active[i], active[j])]).full_piv_lu();
        let mut best = self.residual(&z);
        let mut refined = z.clone();
        for _ in 0..4 {
            let w = self.w(&refined);
            let step = factors.solve(Mat::from_fn(active.len(), 1, |i, _| -w[active[i]]));
            for (i, &k) in active.iter().enumerate() {
                refined[k] = (refined[k] + step[(i, 0)]).max(0.0);
            }
            let residual = self.residual(&refined);
            if residual < best {
                best = residual;
                z.clone_from(&refined);
            }
        }
        // written so that a residual that is no number fails too
        if !(best <= TOLERANCE) {
            return Err(LcpFailure::Inaccurate);
        }
        Ok(z)
    }

    fn w(&self, z: &[f64]) -> Vec<f64> {
        let row = |i: usize| self.p[i] + z.iter().enumerate().map(|(j, z)| self.n[(i, j)] * z).sum::<f64>();
        (0..z.len()).map(row).collect()
    }

    /// Largest relative violation of `w >= 0` and of `z_i = 0` or `w_i = 0`, for `z >= 0`.
    fn residual(&self, z: &[f64]) -> f64 {
        let largest = z.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(*v));
        let mut worst = 0.0;
        for (i, w) in self.w(z).iter().enumerate() {
            let w = w / (1.0 + self.p[i].abs());
            let violation = if w < 0.0 { -w } else { w.min(z[i] / largest) };
            // written so that a violation that is no number stays
            if !(violation <= worst) {
                worst = violation;
            }
        }
        worst
    }
}

impl Basis {
    /// Row whose variable reaches zero first as the variable of `column` grows; ties are told apart by the rows of
    /// the inverse. `None` when nothing stops it.
    fn leaving_row(&self, column: &[f64], cover: usize) -> Option<usize> {
        let smallest = SMALLEST_PIVOT * column.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
        let mut tied: Vec<usize> = (0..column.len()).filter(|&i| column[i] > smallest).collect();
        for k in 0..=column.len() {
            let ratio = |i: usize| self.rows[i][k] / column[i];
            let least = tied.iter().fold(f64::INFINITY, |m, &i| m.min(ratio(i)));
            tied.retain(|&i| ratio(i) <= least + TIE * least.abs().max(1.0));
            // an end is better than any other exchange
            if let Some(&end) = tied.iter().find(|&&i| k == 0 && self.variables[i] == cover) {
                return Some(end);
            }
            if tied.len() <= 1 {
                break;
            }
        }
        tied.first().copied()
    }

    /// Makes `variable`, with its `column` in the present basis, the variable of `row`; returns the one it replaces.
    fn exchange(&mut self, row: usize, variable: usize, column: &[f64]) -> usize {
        let mut pivot = std::mem::take(&mut self.rows[row]);
        pivot.iter_mut().for_each(|v| *v /= column[row]);
        for (other, factor) in self.rows.iter_mut().zip(column) {
            for (value, p) in other.iter_mut().zip(&pivot) {
                *value -= factor * p;
            }
        }
        self.rows[row] = pivot;
        std::mem::replace(&mut self.variables[row], variable)
    }
}

/// Powers of two s such that the largest entry of each row and column of `s_i N_ij s_j` is about one (Ruiz's
/// iteration); of a positive semidefinite matrix, the diagonal. Rows of zeros keep one.
fn equilibrate(n: MatRef<'_, f64>) -> Vec<f64> {
    let size = n.nrows();
    let mut scale = vec![1.0; size];
    for _ in 0..20 {
        let largest = |i: usize| {
            (0..size).fold(0.0, |m: f64, j| m.max(n[(i, j)].abs().max(n[(j, i)].abs()) * scale[i] * scale[j]))
        };
        scale = (0..size).map(|i| scale[i] / power_of_two(largest(i)).sqrt()).collect();
    }
    scale.into_iter().map(power_of_two).collect()
}

/// The power of two next to a positive number; one for zero.
fn power_of_two(value: f64) -> f64 {
    if value > 0.0 { value.log2().round().exp2() } else { 1.0 }
}
