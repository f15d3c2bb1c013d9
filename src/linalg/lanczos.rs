//! Lowest eigenpairs of `K x = lambda B x` by block Lanczos on `K^-1 B`, K symmetric positive definite.
//!
//! The basis is orthonormal in the energy product of K (two passes against every earlier block), so B
//! may be indefinite: the largest positive `theta = 1/lambda` are wanted. Blocks find copies of multiple
//! eigenvalues; the caller proves completeness by a Sturm count and may ask for more.

use crate::error::{Error, Result};
use crate::linalg::dense::{graded_eigenvectors, self_adjoint};
use faer::{Mat, MatRef};

/// Vectors by which the basis grows in each step.
const BLOCK_VECTORS: usize = 6;
/// Relative residual (energy norm) at which a Ritz pair is good enough to be polished.
const RITZ_RTOL: f64 = 1e-8;
/// Relative residual at which a polished pair is final; the eigenvalue's error is its square.
const FINAL: f64 = 1e-11;
/// Steps of subspace iteration at most.
const POLISHING: usize = 30;
/// Groups of eigenvalues that stand decades apart, at most.
const GROUPS: usize = 6;
/// Ratio of the smallest to the largest theta that are taken as one group.
const GROUP: f64 = 1e-6;

/// The operators of `K x = lambda B x`, applied to blocks of columns.
pub struct Pencil<'a> {
    /// Number of rows of K and B.
    pub size: usize,
    /// Largest possible number of independent eigenvectors (size less the directions left out by `solve`).
    pub rank: usize,
    /// Applies K to a block of columns, `K X`.
    pub apply_k: &'a dyn Fn(MatRef<'_, f64>) -> Mat<f64>,
    /// Applies B to a block of columns, `B X`.
    pub apply_b: &'a dyn Fn(MatRef<'_, f64>) -> Mat<f64>,
    /// `K^-1 F`, on the complement of the null space of K.
    pub solve: &'a dyn Fn(Mat<f64>) -> Mat<f64>,
    /// Removes what lies in the null space of K: it has no energy, so nothing else here would see it grow.
    pub clean: &'a dyn Fn(&mut Mat<f64>),
    /// Directions near the eigenvectors of largest `|theta|`, if these stand decades apart from the others, in columns: what
    /// rounding leaves of them would hide the others, so they are found first and kept out of the iteration.
    pub apart: Option<Mat<f64>>,
}

/// Eigenpairs with the smallest positive lambda, ascending; vectors in columns with `x^T K x = lambda`
/// (for a positive B this is `x^T B x = 1`).
pub struct Eigenpairs {
    /// Eigenvalues lambda of `K x = lambda B x`, ascending.
    pub values: Vec<f64>,
    /// Eigenvectors in columns, in the order of the eigenvalues.
    pub vectors: Mat<f64>,
}

/// The `wanted` smallest positive eigenvalues (fewer if there are fewer).
///
/// # Errors
/// When they do not converge within the largest basis.
pub fn lowest(pencil: &Pencil<'_>, wanted: usize) -> Result<Eigenpairs> {
    let wanted = wanted.min(pencil.rank);
    let mut apart = pencil.apart.as_ref().and_then(|start| invariant(pencil, start));
    for _ in 0..GROUPS {
        let remove = |x: &mut Mat<f64>| {
            for found in apart.iter().chain(&apart) {
                *x -= &found.vectors * (found.images.transpose() * &*x);
            }
        };
        let rest = Pencil {
            rank: pencil.rank - apart.as_ref().map_or(0, |a| a.vectors.ncols()),
            solve: &|f| {
                let mut x = (pencil.solve)(f);
                remove(&mut x);
                x
            },
            clean: &|x| {
                (pencil.clean)(x);
                remove(x);
            },
            apart: None,
            ..*pencil
        };
        let positive = apart.as_ref().map_or(&[][..], |a| &a.positive);
        let kept = positive.len().min(wanted);
        match iterated(&rest, wanted - kept)? {
            Found::All(ritz, found) => {
                let first = positive.len();
                let ritz = Mat::from_fn(pencil.size, first + ritz.ncols(), |i, j| match &apart {
                    Some(apart) if j < first => apart.vectors[(i, positive[j])],
                    _ => ritz[(i, j - first)],
                });
                return Ok(polished(pencil, ritz, kept + found));
            }
            Found::Apart(ritz) => {
                let Some(more) = invariant(&rest, &ritz) else { break };
                apart = Some(match apart {
                    Some(apart) => apart.with(more),
                    None => more,
                });
            }
        }
    }
    Err(Error::analysis(
        "the eigenvalue solver found no new directions",
        format!("block Lanczos for {wanted} eigenvalues, in groups that stand decades apart"),
        "ask for fewer modes, or check the case for values that differ by many decades",
    ))
}

/// Eigenvectors that are kept out of the iteration.
struct Apart {
    /// Orthonormal in the energy product.
    vectors: Mat<f64>,
    /// K times these vectors.
    images: Mat<f64>,
    /// Indices of the vectors whose theta is positive.
    positive: Vec<usize>,
}

impl Apart {
    fn with(mut self, more: Self) -> Self {
        let first = self.vectors.ncols();
        append(&mut self.vectors, more.vectors.as_ref());
        append(&mut self.images, more.images.as_ref());
        self.positive.extend(more.positive.iter().map(|i| first + i));
        self
    }
}

/// What an iteration ends with.
enum Found {
    /// Ritz vectors of the wanted theta and a few more, and how many of the wanted ones there are.
    All(Mat<f64>, usize),
    /// Ritz vectors that stand decades apart from the others and hide them.
    Apart(Mat<f64>),
}

/// The eigenvectors of largest `|theta|` near `start`; `None` where they do not converge.
fn invariant(pencil: &Pencil<'_>, start: &Mat<f64>) -> Option<Apart> {
    let mut x = start.clone();
    (pencil.clean)(&mut x);
    let mut kx = (pencil.apply_k)(x.as_ref());
    ascending_orthonormal(&mut x, &mut kx);
    let mut earlier = f64::INFINITY;
    for _ in 0..POLISHING {
        let mut y = (pencil.solve)((pencil.apply_b)(x.as_ref()));
        let mut ky = (pencil.apply_k)(y.as_ref());
        let share = x.transpose() * &ky;
        let (rest, k_rest) = (&y - &x * &share, &ky - &kx * &share);
        let worst = energies(&rest, &k_rest).into_iter().zip(energies(&y, &ky));
        let worst = worst.fold(0.0, |worst: f64, (rest, all)| worst.max(rest / all));
        // below the tolerance, or down at rounding
        if worst <= FINAL * FINAL || (worst <= RITZ_RTOL * RITZ_RTOL && worst > 0.3 * earlier) {
            let (thetas, turn) = self_adjoint(share.as_ref()).ok()?;
            let positive = (0..thetas.len()).filter(|&i| thetas[i] > 0.0).collect();
            return Some(Apart { vectors: &x * &turn, images: &kx * turn, positive });
        }
        ascending_orthonormal(&mut y, &mut ky);
        (x, kx, earlier) = (y, ky, worst);
    }
    None
}

/// Ritz vectors of the `wanted` largest positive theta and a few more, and how many of the wanted ones there are.
fn iterated(pencil: &Pencil<'_>, wanted: usize) -> Result<Found> {
    let wanted = wanted.min(pencil.rank);
    if wanted == 0 {
        return Ok(Found::All(Mat::zeros(pencil.size, 0), 0));
    }
    let limit = pencil.rank.min(8 * wanted + 40 * BLOCK_VECTORS);
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut start = || {
        let w = (pencil.solve)((pencil.apply_b)(random.block(pencil.size, BLOCK_VECTORS).as_ref()));
        let kw = (pencil.apply_k)(w.as_ref());
        (w, kw)
    };
    let mut basis: Mat<f64> = Mat::zeros(pencil.size, 0);
    let mut projected: Mat<f64> = Mat::zeros(0, 0);
    let mut block = orthonormal(pencil, basis.as_ref(), start())?.0;
    for step in 1.. {
        let room = limit - basis.ncols();
        append(&mut basis, block.get(.., ..block.ncols().min(room)));
        let added = block.ncols().min(room);
        let image = (pencil.apply_b)(basis.get(.., basis.ncols() - added..));
        border(&mut projected, basis.transpose() * &image);
        // w = K^-1 B v, so that K w is the image itself (which is free of forces on rigid motions)
        let w = (pencil.solve)(image.clone());
        let (next, coupling) = orthonormal(pencil, basis.as_ref(), (w, image))?;

        let full = basis.ncols() == limit;
        let exhausted = full && limit == pencil.rank;
        if basis.ncols() >= wanted && (full || step % 3 == 0 || next.ncols() == 0) {
            let (thetas, weights) = self_adjoint(projected.as_ref())?;
            let remainder = &coupling * weights.get(basis.ncols() - added.., ..);
            let best: Vec<usize> =
                (0..thetas.len()).rev().take(wanted).take_while(|&i| thetas[i] > 0.0).collect();
            let settled = |i: &usize| remainder.col(*i).norm_l2() <= RITZ_RTOL * thetas[*i];
            if exhausted || (best.len() == wanted && best.iter().all(settled)) {
                let near: Vec<usize> = (0..thetas.len())
                    .rev()
                    .take(wanted + BLOCK_VECTORS)
                    .take_while(|&i| thetas[i] > 0.0)
                    .collect();
                return Ok(Found::All(ritz_vectors(basis.as_ref(), weights.as_ref(), &near), best.len()));
            }
            if full && let Some(apart) = far_ones(&thetas, |i| settled(&i)) {
                return Ok(Found::Apart(ritz_vectors(basis.as_ref(), weights.as_ref(), &apart)));
            }
            if full {
                return Err(Error::analysis(
                    "the eigenvalue solver did not converge",
                    format!("block Lanczos with {limit} vectors for {wanted} eigenvalues"),
                    "ask for more or fewer modes, or check the case for values that differ by many decades",
                ));
            }
        }
        block = if next.ncols() > 0 { next } else { orthonormal(pencil, basis.as_ref(), start())?.0 };
        if block.ncols() == 0 {
            // beside what is there already nothing is seen
            let (thetas, weights) = self_adjoint(projected.as_ref())?;
            let apart = far_ones(&thetas, |_| true).unwrap_or_default();
            return Ok(Found::Apart(ritz_vectors(basis.as_ref(), weights.as_ref(), &apart)));
        }
    }
    unreachable!("the loop ends at the limit of the basis")
}

/// The settled theta within [`GROUP`] of the largest one; `None` where there are none.
fn far_ones(thetas: &[f64], settled: impl Fn(usize) -> bool) -> Option<Vec<usize>> {
    let largest = thetas.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
    let far: Vec<usize> =
        (0..thetas.len()).filter(|&i| thetas[i].abs() > GROUP * largest && settled(i)).collect();
    (!far.is_empty()).then_some(far)
}

/// Appends the columns of `block`.
fn append(basis: &mut Mat<f64>, block: MatRef<'_, f64>) {
    let old = basis.ncols();
    basis.resize_with(basis.nrows(), old + block.ncols(), |i, j| block[(i, j - old)]);
}

/// Adds rows and columns to a symmetric matrix; `columns` holds the new columns.
fn border(matrix: &mut Mat<f64>, columns: Mat<f64>) {
    let (old, new) = (matrix.nrows(), columns.nrows());
    matrix.resize_with(new, new, |i, j| if j >= old { columns[(i, j - old)] } else { columns[(j, i - old)] });
}

/// Splits `w` into its part in the basis (dropped) and `v c` with `v^T K v = I`, `v^T K basis = 0`;
/// directions that are rounding errors are dropped. Takes `(w, K w)`, returns `(v, c)`.
fn orthonormal(
    pencil: &Pencil<'_>,
    basis: MatRef<'_, f64>,
    (mut v, mut kv): (Mat<f64>, Mat<f64>),
) -> Result<(Mat<f64>, Mat<f64>)> {
    // A direction counts when it is above the rounding error of what is subtracted.
    let noise = energies(&v, &kv).into_iter().fold(0.0, f64::max) * 1e-20;
    let mut c = Mat::<f64>::identity(v.ncols(), v.ncols());
    for floor in [noise, 0.25] {
        v -= basis * (basis.transpose() * &kv);
        (pencil.clean)(&mut v);
        kv = (pencil.apply_k)(v.as_ref());
        let gram = v.transpose() * &kv;
        let (squares, directions) = self_adjoint(gram.as_ref())?;
        let kept: Vec<usize> = (0..squares.len()).filter(|&i| squares[i] > floor).collect();
        let turn =
            Mat::from_fn(v.ncols(), kept.len(), |i, j| directions[(i, kept[j])] / squares[kept[j]].sqrt());
        let back =
            Mat::from_fn(kept.len(), v.ncols(), |i, j| directions[(j, kept[i])] * squares[kept[i]].sqrt());
        v = &v * &turn;
        kv = &kv * turn;
        c = back * c;
    }
    Ok((v, c))
}

/// `w_j^T (K w)_j` for each column.
fn energies(w: &Mat<f64>, kw: &Mat<f64>) -> Vec<f64> {
    (0..w.ncols()).map(|j| w.col(j).transpose() * kw.col(j)).collect()
}

fn ritz_vectors(basis: MatRef<'_, f64>, weights: MatRef<'_, f64>, best: &[usize]) -> Mat<f64> {
    basis * Mat::from_fn(weights.nrows(), best.len(), |i, j| weights[(i, best[j])])
}

/// Subspace iteration with a Rayleigh-Ritz step that keeps relative accuracy; the `wanted` lowest pairs.
///
/// The dense eigenproblem of the Lanczos basis errs by a rounding of the largest theta. Where lambda spans many
/// decades (a stiff shaft in soft bearings) that is too much for modes far above the lowest; here the
/// projected matrix is nearly diagonal and graded, which Jacobi rotations solve to the last digit of each.
fn polished(pencil: &Pencil<'_>, ritz: Mat<f64>, wanted: usize) -> Eigenpairs {
    let mut x = ritz;
    let mut thetas: Vec<f64> = Vec::new();
    let mut earlier = f64::INFINITY;
    for _ in 0..POLISHING {
        let mut y = (pencil.solve)((pencil.apply_b)(x.as_ref()));
        let mut ky = (pencil.apply_k)(y.as_ref());
        if !thetas.is_empty() {
            // remainder of K^-1 B x = theta x in the energy norm; x^T K x = 1
            let rest = Mat::from_fn(y.nrows(), wanted, |i, j| y[(i, j)] - thetas[j] * x[(i, j)]);
            let energy = energies(&rest, &(pencil.apply_k)(rest.as_ref()));
            let worst = (0..wanted).map(|i| energy[i].max(0.0).sqrt() / thetas[i]).fold(0.0, f64::max);
            // below the tolerance, or down at the rounding error of the solution with K
            if worst <= FINAL || worst > 0.7 * earlier {
                break;
            }
            earlier = worst;
        }
        ascending_orthonormal(&mut y, &mut ky);
        let mut projected = y.transpose() * (pencil.apply_b)(y.as_ref());
        let rotation = graded_eigenvectors(&mut projected);
        let mut order: Vec<usize> = (0..y.ncols()).collect();
        order.sort_by(|&a, &b| projected[(b, b)].total_cmp(&projected[(a, a)]));
        thetas = order.iter().map(|&i| projected[(i, i)]).collect();
        x = &y * Mat::from_fn(y.ncols(), y.ncols(), |i, j| rotation[(i, order[j])]);
    }
    let values: Vec<f64> = thetas[..wanted].iter().map(|theta| 1.0 / theta).collect();
    let vectors = Mat::from_fn(x.nrows(), wanted, |i, j| x[(i, j)] * values[j].sqrt());
    Eigenpairs { values, vectors }
}

/// Gram-Schmidt in the energy product, twice, the softest directions first: they are the ones that grow as noise
/// in the others. `kx` follows as `K x`.
fn ascending_orthonormal(x: &mut Mat<f64>, kx: &mut Mat<f64>) {
    for i in 0..x.ncols() {
        for _ in 0..2 {
            let share = x.get(.., ..i).transpose() * kx.subcols(i, 1);
            let (part, k_part) = (x.get(.., ..i) * &share, kx.get(.., ..i) * &share);
            let mut column = x.subcols_mut(i, 1);
            column -= part;
            let mut column = kx.subcols_mut(i, 1);
            column -= k_part;
        }
        let energy: f64 = x.col(i).transpose() * kx.col(i);
        let scale = 1.0 / energy.sqrt();
        x.col_mut(i).iter_mut().for_each(|v| *v *= scale);
        kx.col_mut(i).iter_mut().for_each(|v| *v *= scale);
    }
}

/// A small deterministic generator (xorshift), so that runs repeat bit by bit.
struct Random(u64);

impl Random {
    fn block(&mut self, rows: usize, columns: usize) -> Mat<f64> {
        Mat::from_fn(rows, columns, |_, _| {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagonal_pencil(stiffness: &[f64], wanted: usize) -> Eigenpairs {
        let scale = |x: MatRef<'_, f64>, f: &dyn Fn(f64) -> f64| {
            Mat::from_fn(x.nrows(), x.ncols(), |i, j| f(stiffness[i]) * x[(i, j)])
        };
        let pencil = Pencil {
            size: stiffness.len(),
            rank: stiffness.len(),
            apply_k: &|x| scale(x, &|k| k),
            apply_b: &|x| x.to_owned(),
            solve: &|x| scale(x.as_ref(), &|k| 1.0 / k),
            clean: &|_| (),
            apart: None,
        };
        lowest(&pencil, wanted).unwrap()
    }

    #[test]
    fn finds_every_copy_of_a_multiple_eigenvalue() {
        let mut stiffness: Vec<f64> = (0..300).map(|i| 10.0 + (i * i) as f64).collect();
        stiffness[..9].fill(1.0);
        let found = diagonal_pencil(&stiffness, 12);
        assert!(found.values[..9].iter().all(|v| (v - 1.0).abs() < 1e-12));
        for (i, v) in found.values[9..].iter().enumerate() {
            let expected = 10.0 + ((i + 9) * (i + 9)) as f64;
            assert!((v / expected - 1.0).abs() < 1e-10, "{v} {expected}");
        }
    }

    /// Four eigenvalues sixteen decades below the others: told apart they leave the others their digits.
    #[test]
    fn what_stands_decades_apart_does_not_hide_the_others() {
        let mut stiffness: Vec<f64> = (0..300).map(|i| 1e4 + 1e4 * f64::from(i * i)).collect();
        stiffness[..4].copy_from_slice(&[1e-12, 1e-12, 3e-12, 3e-12]);
        let scale = |x: MatRef<'_, f64>, f: &dyn Fn(f64) -> f64| {
            Mat::from_fn(x.nrows(), x.ncols(), |i, j| f(stiffness[i]) * x[(i, j)])
        };
        let pencil = Pencil {
            size: 300,
            rank: 300,
            apply_k: &|x| scale(x, &|k| k),
            apply_b: &|x| x.to_owned(),
            solve: &|x| scale(x.as_ref(), &|k| 1.0 / k),
            clean: &|_| (),
            apart: Some(Mat::from_fn(
                300,
                4,
                |i, j| if i < 4 { f64::from((i + j) % 3 == 0) + 0.1 } else { 0.0 } + f64::from(i == j),
            )),
        };
        let found = lowest(&pencil, 30).unwrap();
        let mut exact = stiffness.clone();
        exact.sort_by(f64::total_cmp);
        for (ours, exact) in found.values.iter().zip(&exact) {
            assert!((ours / exact - 1.0).abs() < 1e-10, "{ours} {exact}");
        }
    }

    /// The same without being told, in three groups.
    #[test]
    fn groups_that_stand_decades_apart_are_found_one_after_the_other() {
        let mut stiffness: Vec<f64> = (0..200).map(|i| 1e4 + 1e4 * f64::from(i * i)).collect();
        stiffness[..2].copy_from_slice(&[1e-12, 3e-12]);
        stiffness[2..5].copy_from_slice(&[1e-4, 2e-4, 2e-4]);
        let found = diagonal_pencil(&stiffness, 25);
        let mut exact = stiffness.clone();
        exact.sort_by(f64::total_cmp);
        for (ours, exact) in found.values.iter().zip(&exact) {
            assert!((ours / exact - 1.0).abs() < 1e-10, "{ours} {exact}");
        }
    }

    #[test]
    fn a_tiny_problem_is_exhausted_exactly() {
        let found = diagonal_pencil(&[4.0, 1.0, 9.0], 10);
        assert_eq!(found.values.len(), 3);
        assert!((found.values[2] - 9.0).abs() < 1e-12);
    }
}
