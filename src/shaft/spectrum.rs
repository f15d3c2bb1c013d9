//! Natural modes of the shaft at rest, proved complete: the basis of every linear analysis.
//!
//! `K x = w^2 M x` by block Lanczos on the flexibility; motions without strain are found from the
//! constraints, not from small numbers, and kept apart.

use crate::error::{Error, Refusal, Result};
use crate::linalg::dense::{cholesky, over_lower, self_adjoint};
use crate::linalg::factor::Ldlt;
use crate::linalg::gmres::gmres;
use crate::linalg::lanczos::{self, Pencil};
use crate::linalg::lu::SparseLu;
use crate::linalg::sparse::{Sparse, absolute_product_norm, combine, multiply};
use crate::model::{Bearing, Model};
use crate::shaft::assembly::{Assembly, RigidMotion};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef};

/// Stiffness of a spring over that of the shaft where it acts below which the spring is soft.
const SOFT: f64 = 1e-6;
/// Stiffness of a spring times the give of the shaft at its place above which the spring is not soft.
const HARD: f64 = 100.0;

/// Relative residual of equations without symmetry, and the most iterations before they are factorised.
const SOLVED: f64 = 1e-11;
const MOST_ITERATIONS: usize = 30;

/// Digits to which the share of the initial stress is told at which a shaft buckles.
const BUCKLING_DIGITS: f64 = 1e-5;

/// Square of a frequency over that of the highest mode below which a mode stands apart.
const APART_SQUARE_SHARE: f64 = 1e-9;

/// Generalised inverse of the stiffness: exact on forces in balance, its result free of rigid motion.
///
/// Bearings many decades softer than the shaft do not show in `K = K_0 + B k B^T`: rounding of K_0 resists the motions R that
/// only they hold (`K_0 R = 0`) by more than they do. Such springs stay out of the matrix that is factorised, and their
/// forces p are solved for: with the balanced solution y of K_0, `x = y - K_0^+ B p + R a`, `p = k B^T x` and the balance
/// `R^T B p = R^T f` of the motions.
pub struct Flexibility {
    factor: Ldlt<f64>,
    /// Rigid motions R, `R^T M R = I`.
    pub rigid: Mat<f64>,
    /// Mass times the rigid motions, `M R`: forces that move the shaft without straining it.
    pub mass_rigid: Mat<f64>,
    soft: Option<Soft>,
}

/// Springs that are soft beside the shaft, and the motions that nothing else resists.
struct Soft {
    /// `K_0`, without these springs.
    stiffness: Sparse,
    /// Motions R that only these springs resist, `R^T M R = I`, orthogonal to the rigid ones.
    motions: Mat<f64>,
    /// Mass times the motions that only soft springs resist, `M R`.
    mass_motions: Mat<f64>,
    /// `B`, the displacement each spring feels.
    rows: Mat<f64>,
    /// Stiffness k of each soft spring, N/m.
    law: Vec<f64>,
    /// Displacements under a unit force of each soft spring that the rigid and the loose motions balance,
    /// `K_0^+ B`.
    answers: Mat<f64>,
    /// Stiffness of the soft springs in series with the shaft, `(1 + k B^T K_0^+ B)^-1 k`.
    law_in_series: Mat<f64>,
    /// What each soft spring feels of the motions that only they resist, `B^T R`.
    felt: Mat<f64>,
    /// Inverse of what the springs in series oppose to the loose motions, `A = R^T B (law in series) B^T R`.
    inverse: Mat<f64>,
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
        Ok(Self { factor: Ldlt::new(&pinned)?, rigid, mass_rigid, soft: None })
    }

    /// As [`Self::new`] for a shaft at rest, with springs that are soft beside the shaft kept out of the factorised matrix.
    ///
    /// # Errors
    /// When the factorisation fails, or nothing but cross-coupling holds a motion.
    pub fn at_rest(assembly: &Assembly<'_>, stiffness: &Sparse, mass: &Sparse) -> Result<Self> {
        let motions = assembly.rigid_motions().1;
        let springs = assembly.springs();
        let forces: Vec<Vec<f64>> = springs.iter().map(|s| assembly.force(&s.row)).collect();
        // the motions that only springs hold are no longer free of stiffness
        let stressed = assembly.model.initial_stress.is_some();
        let mut soft: Vec<usize> = (0..springs.len())
            .filter(|_| !stressed)
            .filter(|&i| springs[i].stiffness.abs() < SOFT * local_stiffness(stiffness, &forces[i]))
            .collect();
        loop {
            let others = || (0..springs.len()).filter(|i| !soft.contains(i)).map(|i| &springs[i]);
            let (_, loose) = assembly.rigid_motions_on(&others().map(|s| &s.row).collect::<Vec<_>>());
            if soft.is_empty() || loose.ncols() == motions.ncols() {
                return Self::new(stiffness, mass, motions);
            }
            let rigid = mass_orthonormal(mass, motions.clone());
            let held = without(mass, &rigid, loose);
            let mut pinned = assembly.stiffness_on(others());
            let stiffness_of_others = pinned.clone();
            let all = hstack(&rigid, &held);
            pin(&mut pinned, &all);
            let bare = Self {
                factor: Ldlt::new(&pinned)?,
                mass_rigid: multiply(mass, all.as_ref()),
                rigid: all,
                soft: None,
            };
            let rows = Mat::from_fn(mass.nrows(), soft.len(), |i, j| forces[soft[j]][i]);
            let answers = bare.solve(rows.clone());
            let law: Vec<f64> = soft.iter().map(|&i| springs[i].stiffness).collect();
            let give = rows.transpose() * &answers;
            let hard: Vec<usize> = (0..soft.len()).filter(|&i| law[i] * give[(i, i)] > HARD).collect();
            if hard.is_empty() {
                let negative = most_negative(assembly.model);
                let soft = Soft::new(stiffness_of_others, mass, held, (rows, law), (answers, give));
                let soft = soft.map_err(|error| negative.map_or(error, |bearing| unheld(bearing).into()))?;
                let mass_rigid = multiply(mass, rigid.as_ref());
                return Ok(Self { factor: bare.factor, rigid, mass_rigid, soft: Some(soft) });
            }
            soft = (0..soft.len()).filter(|i| !hard.contains(i)).map(|i| soft[i]).collect();
        }
    }

    /// `K^+ F` for every column: the part of F out of balance (`M R R^T F`) is left out, and the answer has
    /// no rigid motion (`R^T M x = 0`).
    pub fn solve(&self, mut f: Mat<f64>) -> Mat<f64> {
        if self.rigid.ncols() > 0 {
            f -= &self.mass_rigid * (self.rigid.transpose() * &f);
        }
        let Some(soft) = &self.soft else {
            self.factor.solve_in_place(f.as_mut());
            self.without_rigid(&mut f);
            return f;
        };
        let resultant = soft.motions.transpose() * &f;
        f -= &soft.mass_motions * &resultant;
        self.factor.solve_in_place(f.as_mut());
        self.without_rigid(&mut f);
        f -= &soft.motions * (soft.mass_motions.transpose() * &f);
        let felt = soft.rows.transpose() * &f;
        let share = &soft.inverse * (resultant - soft.felt.transpose() * (&soft.law_in_series * &felt));
        let forces = &soft.law_in_series * (felt + &soft.felt * &share);
        f - &soft.answers * forces + &soft.motions * share
    }

    /// [`Self::solve`] for one column and a matrix without symmetry, of which this is the symmetric part: by iteration, or
    /// where that does not converge by a factorisation of its own.
    ///
    /// # Errors
    /// A singular matrix.
    pub fn solve_unsymmetric(&self, mut f: Mat<f64>, mut matrix: Sparse) -> Result<Mat<f64>> {
        let column = |x: &[f64]| Mat::from_fn(x.len(), 1, |i, _| x[i]);
        let list = |x: Mat<f64>| x.col(0).iter().copied().collect::<Vec<f64>>();
        let balanced = |mut f: Mat<f64>| {
            if self.rigid.ncols() > 0 {
                f -= &self.mass_rigid * (self.rigid.transpose() * &f);
            }
            f
        };
        f = balanced(f);
        let found = gmres(
            |x| list(balanced(multiply(&matrix, column(x).as_ref()))),
            |b| list(self.solve(column(b))),
            &list(f.clone()),
            SOLVED,
            MOST_ITERATIONS,
        );
        if let Some(x) = found {
            return Ok(column(&x));
        }
        if self.rigid.ncols() > 0 {
            pin(&mut matrix, &self.rigid);
        }
        let mut x = SparseLu::new(&matrix)?.solve_columns(f)?;
        self.without_rigid(&mut x);
        Ok(x)
    }

    /// `K X`, K being the stiffness that was factorised: what soft springs do to the motions that only they hold is not
    /// lost in the rounding of the others.
    pub fn stiffness_times(&self, stiffness: &Sparse, x: MatRef<'_, f64>) -> Mat<f64> {
        let Some(soft) = &self.soft else { return multiply(stiffness, x) };
        let y = x - &soft.motions * (soft.mass_motions.transpose() * x);
        let mut f = multiply(&soft.stiffness, y.as_ref());
        f -= &soft.mass_motions * (soft.motions.transpose() * &f);
        let mut forces = soft.rows.transpose() * x;
        for (i, k) in soft.law.iter().enumerate() {
            forces.row_mut(i).iter_mut().for_each(|v| *v *= *k);
        }
        f + &soft.rows * forces
    }

    /// Motions that only soft springs resist, orthonormal in the mass; none where no spring is soft.
    pub fn soft_motions(&self) -> Option<MatRef<'_, f64>> {
        self.soft.as_ref().map(|soft| soft.motions.as_ref())
    }

    /// Rigid motions and those that only soft springs resist.
    pub fn loose_motions(&self) -> Mat<f64> {
        self.soft.as_ref().map_or_else(|| self.rigid.clone(), |soft| hstack(&self.rigid, &soft.motions))
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

impl Soft {
    fn new(
        stiffness: Sparse,
        mass: &Sparse,
        motions: Mat<f64>,
        (rows, law): (Mat<f64>, Vec<f64>),
        (answers, give): (Mat<f64>, Mat<f64>),
    ) -> Result<Self> {
        let m = law.len();
        let series = Mat::from_fn(m, m, |i, j| f64::from(i == j) + law[i] * give[(i, j)]);
        let own = Mat::from_fn(m, m, |i, j| if i == j { law[i] } else { 0.0 });
        let law_in_series = series.partial_piv_lu().solve(own);
        let felt = rows.transpose() * &motions;
        let a = felt.transpose() * &law_in_series * &felt;
        let factor =
            cholesky(Mat::from_fn(a.nrows(), a.nrows(), |i, j| (a[(i, j)] + a[(j, i)]) / 2.0).as_ref());
        let Some(l) = factor else {
            return Err(Error::analysis(
                "nothing but cross-coupling holds a motion of the shaft",
                "the balance of the motions that only soft bearings resist",
                "give the bearings a direct stiffness",
            ));
        };
        let half = over_lower(&Mat::identity(l.nrows(), l.nrows()), l.as_ref());
        Ok(Self {
            mass_motions: multiply(mass, motions.as_ref()),
            inverse: &half * half.transpose(),
            stiffness,
            motions,
            rows,
            law,
            answers,
            law_in_series,
            felt,
        })
    }
}

/// Stiffness of the shaft at the coordinate that a row mainly feels, N/m for the displacement of the row.
fn local_stiffness(stiffness: &Sparse, row: &[f64]) -> f64 {
    let at = (0..row.len()).max_by(|&i, &j| row[i].abs().total_cmp(&row[j].abs()));
    let Some(at) = at.filter(|&i| row[i] != 0.0) else { return 0.0 };
    let rows = stiffness.row_idx_of_col_raw(at);
    let diagonal = rows.iter().position(|&i| i == at).map_or(0.0, |k| stiffness.val_of_col(at)[k]);
    diagonal / (row[at] * row[at])
}

/// What is new in `x` beside `rigid`, orthonormal in the mass.
fn without(mass: &Sparse, rigid: &Mat<f64>, x: Mat<f64>) -> Mat<f64> {
    let norm = |x: &Mat<f64>| -> f64 { (x.col(0).transpose() * multiply(mass, x.as_ref()).col(0)).sqrt() };
    let mut kept = rigid.clone();
    for j in 0..x.ncols() {
        let mut column = x.subcols(j, 1).to_owned();
        let before = norm(&column);
        for _ in 0..2 {
            let share = multiply(mass, kept.as_ref()).transpose() * &column;
            column -= &kept * share;
        }
        let after = norm(&column);
        if after > 1e-6 * before {
            kept = hstack(&kept, &(column * faer::Scale(1.0 / after)));
        }
    }
    kept.get(.., rigid.ncols()..).to_owned()
}

fn hstack(left: &Mat<f64>, right: &Mat<f64>) -> Mat<f64> {
    let n = left.ncols();
    Mat::from_fn(left.nrows(), n + right.ncols(), |i, j| if j < n { left[(i, j)] } else { right[(i, j - n)] })
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
pub fn mass_orthonormal(mass: &Sparse, mut x: Mat<f64>) -> Mat<f64> {
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
    /// Mass matrix M of shaft and disks in the free coordinates.
    pub mass: Sparse,
    /// Stiffness K at rest in the free coordinates, bearings included.
    pub stiffness: Sparse,
    /// Generalised inverse of the stiffness, with the rigid motions.
    pub flexibility: Flexibility,
    /// Names of the rigid motions.
    pub rigid_motions: Vec<RigidMotion>,
    /// `w^2` of the modes with strain, ascending.
    pub values: Vec<f64>,
    /// Shapes of the modes in columns, in the order of the values, scaled to `x^T M x = 1`.
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
        let rigid_motions = assembly.rigid_motions().0;
        let flexibility = Flexibility::at_rest(assembly, &stiffness, &mass)?;
        refuse_unstable(assembly, &flexibility)?;
        refuse_buckled(assembly, &rigid_motions, &stiffness, &mass)?;
        let (size, n_rigid) = (assembly.size(), rigid_motions.len());
        let pencil = Pencil {
            size,
            rank: size - n_rigid,
            apply_k: &|x| flexibility.stiffness_times(&stiffness, x),
            apply_b: &|x| multiply(&mass, x),
            solve: &|f| flexibility.solve(f),
            clean: &|x| flexibility.without_rigid(x),
            apart: flexibility.soft_motions().map(|m| m.to_owned()),
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
        align(&mass, &assembly.mirror_signs(), &values, &mut vectors)?;
        normalise(&mass, &mut vectors);
        Ok(Self { mass, stiffness, flexibility, rigid_motions, values, vectors, complete })
    }

    /// `K X`, see [`Flexibility::stiffness_times`].
    pub fn stiffness_times(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        self.flexibility.stiffness_times(&self.stiffness, x)
    }

    /// The part of forces that modes decades below the others do not answer to (those on soft springs, those of disks on a
    /// massless shaft): what these answer would drown what the others do, and they are in the basis anyway.
    pub fn without_low_modes(&self, f: &Mat<f64>) -> Mat<f64> {
        let highest = self.values.last().copied().unwrap_or(0.0);
        let n = self.values.iter().take_while(|value| **value < APART_SQUARE_SHARE * highest).count();
        if n == 0 {
            return f.clone();
        }
        let modes = self.vectors.get(.., ..n);
        f - multiply(&self.mass, modes) * (modes.transpose() * f)
    }

    /// `|K x - w^2 M x|` over the norm of `|K| |x|` for the rigid motions and then the modes with strain.
    pub fn residuals(&self) -> Vec<f64> {
        let of = |x: &Mat<f64>, value: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let (kx, mx) = (self.stiffness_times(x.as_ref()), multiply(&self.mass, x.as_ref()));
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

/// Refuses a shaft whose initial stress finds no hold, or more than the shaft bears.
fn refuse_buckled(
    assembly: &Assembly<'_>,
    rigid_motions: &[RigidMotion],
    stiffness: &Sparse,
    mass: &Sparse,
) -> Result<()> {
    let Some(initial) = assembly.initial_stress() else { return Ok(()) };
    if rigid_motions.iter().any(|motion| motion.has(&[4, 5])) {
        return Err(Error::analysis(
            "nothing holds the line of the axial force or torque: the shaft is free to tilt",
            "the initial stress on the rigid motions of the shaft",
            "supports that keep the shaft from tilting; or no axial_force and torque in its segments",
        ));
    }
    let motions = assembly.rigid_motions().1;
    let unstable = |share: f64| -> Result<bool> {
        let k = combine(&[(1.0, stiffness), (share - 1.0, &initial)]);
        Ok(Flexibility::new(&k, mass, motions.clone())?.unstable_directions() > 0)
    };
    if !unstable(1.0)? {
        return Ok(());
    }
    let (mut stable, mut buckled) = (0.0, 1.0);
    while buckled - stable > BUCKLING_DIGITS * buckled && buckled > BUCKLING_DIGITS {
        let share = (stable + buckled) / 2.0;
        if unstable(share)? { buckled = share } else { stable = share }
    }
    Err(Error::analysis(
        format!(
            "the shaft is unstable at rest under the axial_force and torque of its segments: it buckles at {:.4} times them",
            (stable + buckled) / 2.0
        ),
        "the stiffness with that of the initial stress",
        "less compression (axial_force is positive in tension) or torque, or a stiffer shaft or supports",
    ))
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

/// Relative difference below which two values count as equal.
const SAME_VALUE_RTOL: f64 = 1e-10;

/// Shapes of equal value are arbitrary mixtures: turns them into the planes of symmetry, motions along y before those along z,
/// so that rounding does not choose the plane that is drawn.
fn align(mass: &Sparse, mirror: &[[bool; 2]], values: &[f64], vectors: &mut Mat<f64>) -> Result<()> {
    let mut first = 0;
    for equal in values.chunk_by(|a, b| b - a <= SAME_VALUE_RTOL * b) {
        let (from, count) = (first, equal.len());
        first += count;
        if count < 2 {
            continue;
        }
        let x = vectors.get(.., from..from + count).to_owned();
        // the part that changes its sign with y
        let odd = Mat::from_fn(x.nrows(), count, |i, j| if mirror[i][0] { x[(i, j)] } else { 0.0 });
        let share = odd.transpose() * multiply(mass, odd.as_ref());
        let (shares, turn) = self_adjoint(share.as_ref())?;
        // only where the planes part them
        if shares[count - 1] - shares[0] < 0.5 {
            continue;
        }
        let turned = &x * turn;
        for j in 0..count {
            let column = count - 1 - j;
            (0..x.nrows()).for_each(|i| vectors[(i, from + j)] = turned[(i, column)]);
        }
    }
    Ok(())
}

/// Refuses springs of negative stiffness that the rest of the rotor does not hold.
fn refuse_unstable(assembly: &Assembly<'_>, flexibility: &Flexibility) -> Result<()> {
    match most_negative(assembly.model).filter(|_| flexibility.unstable_directions() > 0) {
        Some(bearing) => Err(unheld(bearing).into()),
        None => Ok(()),
    }
}

/// The bearing whose stiffness is the most negative in a direction.
fn most_negative(model: &Model) -> Option<&Bearing> {
    let least = |b: &Bearing| {
        let [[yy, yz], [zy, zz]] = b.stiffness;
        let off = (yz + zy) / 2.0;
        if b.is_across() { (yy + zz) / 2.0 - ((yy - zz) / 2.0).hypot(off) } else { yy }
    };
    let negative = model.bearings.iter().filter(|b| least(b) < 0.0);
    negative.min_by(|a, b| least(a).total_cmp(&least(b)))
}

fn unheld(bearing: &Bearing) -> Refusal {
    Refusal::at(
        format!("{}.stiffness", bearing.path),
        "the negative stiffness outweighs what holds the shaft: the rotor is statically unstable",
        "a rotor whose stiffness as a whole is positive: stiffer bearings, or less negative stiffness",
    )
}

/// Scales every column to `x^T M x = 1`, the first of its largest entries positive.
fn normalise(mass: &Sparse, x: &mut Mat<f64>) {
    let mx = multiply(mass, x.as_ref());
    for j in 0..x.ncols() {
        let norm = (x.col(j).transpose() * mx.col(j)).sqrt();
        let largest = x.col(j).iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        // an odd shape is as large at the other end, up to rounding
        let first = x.col(j).iter().copied().find(|v| v.abs() >= (1.0 - 1e-6) * largest).unwrap_or(1.0);
        let scale = first.signum() / norm;
        for i in 0..x.nrows() {
            x[(i, j)] *= scale;
        }
    }
}
