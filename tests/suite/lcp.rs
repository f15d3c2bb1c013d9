//! Linear complementarity problems: textbook answers, random problems with redundant contacts, and each way to fail.

use faer::Mat;
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};
use rotor::linalg::lcp::{LcpFailure, lemke};

fn random() -> TestRng {
    TestRng::deterministic_rng(RngAlgorithm::ChaCha)
}

fn matrix<const N: usize>(rows: [[f64; N]; N]) -> Mat<f64> {
    Mat::from_fn(N, N, |i, j| rows[i][j])
}

fn product(n: &Mat<f64>, z: &[f64]) -> Vec<f64> {
    (0..z.len()).map(|i| (0..z.len()).map(|j| n[(i, j)] * z[j]).sum()).collect()
}

/// Largest `|min(z_i, w_i)|`, z in units of its largest entry, w in units of the largest of p.
fn residual(n: &Mat<f64>, p: &[f64], z: &[f64]) -> f64 {
    let largest = |v: &[f64]| v.iter().fold(1e-300, |m: f64, x| m.max(x.abs()));
    let (unit_z, unit_w) = (largest(z), largest(p));
    let w = product(n, z);
    (0..z.len()).fold(0.0, |worst: f64, i| {
        assert!(z[i] >= 0.0, "{z:?}");
        worst.max((z[i] / unit_z).min((w[i] + p[i]) / unit_w).abs())
    })
}

fn near(found: &[f64], exact: &[f64]) {
    let worst = found.iter().zip(exact).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(found.len() == exact.len() && worst < 1e-12, "{found:?} instead of {exact:?}");
}

/// Checked by hand: w = (2, 0, 0).
#[test]
fn a_matrix_with_a_zero_diagonal() {
    let n = matrix([[0.0, -1.0, 2.0], [2.0, 0.0, -2.0], [-1.0, 1.0, 0.0]]);
    near(&lemke(n.as_ref(), &[-3.0, 6.0, -1.0], 20).unwrap(), &[0.0, 1.0, 3.0]);
}

/// Bazaraa and Shetty's quadratic programme: minimise `x1^2 - 2 x1 x2 + 2 x2^2 - 2 x1 - 6 x2` with `x1 + x2 <= 2`,
/// `-x1 + 2 x2 <= 2`, `x >= 0`. At (4/5, 6/5) the gradient is -(14/5) (1, 1), normal to the first constraint; unknowns
/// are the two multipliers, then x.
#[test]
fn a_quadratic_programme() {
    let n = matrix([
        [0.0, 0.0, -1.0, -1.0],
        [0.0, 0.0, 1.0, -2.0],
        [1.0, -1.0, 2.0, -2.0],
        [1.0, 2.0, -2.0, 4.0],
    ]);
    near(&lemke(n.as_ref(), &[2.0, 2.0, -2.0, -6.0], 20).unwrap(), &[2.8, 0.0, 0.8, 1.2]);
}

/// Murty's problems of exponential length: N lower triangular with ones on and twos below the diagonal,
/// `p_i = -(2^n + 2^(n-1) + ... + 2^(n+1-i))`; the answer is (2^n, 0, ..., 0).
#[test]
fn murtys_problems() {
    for size in [3, 8] {
        let n = Mat::from_fn(size, size, |i, j| [0.0, 1.0, 2.0][1 + usize::from(i > j) - usize::from(i < j)]);
        let powers: Vec<f64> = (0..size).map(|i| 2_f64.powi((size - i) as i32)).collect();
        let p: Vec<f64> = (0..size).map(|i| -powers[..=i].iter().sum::<f64>()).collect();
        let mut exact = vec![0.0; size];
        exact[0] = powers[0];
        near(&lemke(n.as_ref(), &p, 1000).unwrap(), &exact);
    }
}

/// Answers chosen beforehand; those of a positive definite matrix are the only ones.
#[test]
fn positive_definite_problems() {
    let mut random = random();
    for case in 0..300 {
        let size = 1 + case % 40;
        let b = Mat::from_fn(size, size, |_, _| random.random_range(-1.0..1.0));
        let n = b.transpose() * &b + Mat::<f64>::identity(size, size) * faer::Scale(1e-2);
        let (mut z, mut w) = (vec![0.0; size], vec![0.0; size]);
        for i in 0..size {
            let chosen = if random.random_range(0.0..1.0) < 0.5 { &mut z } else { &mut w };
            chosen[i] = random.random_range(0.0..1.0);
        }
        let p: Vec<f64> = product(&n, &z).iter().zip(&w).map(|(nz, w)| w - nz).collect();
        // powers of ten that differ from row to row, and the size of contact matrices
        let unit = [1.0, 1e-6, 1e6][case % 3];
        let scale: Vec<f64> = (0..size).map(|_| 10_f64.powf(random.random_range(-3.0..3.0))).collect();
        let scaled = Mat::from_fn(size, size, |i, j| unit * scale[i] * scale[j] * n[(i, j)]);
        let scaled_p: Vec<f64> = p.iter().zip(&scale).map(|(p, s)| p * s).collect();
        let found = lemke(scaled.as_ref(), &scaled_p, 50 * size).unwrap_or_else(|e| panic!("{case}: {e}"));
        let found: Vec<f64> = found.iter().zip(&scale).map(|(z, s)| z * s * unit).collect();
        assert!(residual(&n, &p, &found) < 1e-11, "{case}: {:e}", residual(&n, &p, &found));
        assert!(found.iter().zip(&z).all(|(a, b)| (a - b).abs() < 1e-9), "{case}: {found:?}, {z:?}");
    }
}

/// More contacts than motions, `N = D^T D` with fewer rows than columns and some columns twice, and
/// `p = -D^T u + s` with `s >= 0`, often zero: `D^T v + s >= 0` has the point v = 0, so there is a nearest to -u.
#[test]
fn rank_deficient_problems() {
    let mut random = random();
    let mut worst = 0.0_f64;
    for case in 0..300 {
        let size = 2 + case % 60;
        let rank = 1 + random.random_range(0..size - 1);
        let mut d = Mat::from_fn(rank, size, |_, _| random.random_range(-1.0..1.0));
        for j in 1..size {
            if random.random_range(0.0..1.0) < 0.2 {
                for i in 0..rank {
                    d[(i, j)] = d[(i, j - 1)];
                }
            }
        }
        let scale = [1.0, 1e-6, 1e6][case % 3];
        let n = d.transpose() * &d * faer::Scale(scale);
        let u: Vec<f64> = (0..rank).map(|_| random.random_range(-1.0..1.0)).collect();
        let open = [0.0, 0.3, 1.0][case / 3 % 3];
        let p: Vec<f64> = (0..size)
            .map(|j| {
                let gap =
                    if random.random_range(0.0..1.0) < open { random.random_range(0.0..1.0) } else { 0.0 };
                gap - (0..rank).map(|i| d[(i, j)] * u[i]).sum::<f64>()
            })
            .collect();
        let z = lemke(n.as_ref(), &p, 50 * size).unwrap_or_else(|e| panic!("{case}: {e}"));
        worst = worst.max(residual(&n, &p, &z));
    }
    assert!(worst < 1e-9, "{worst:e}");
}

/// Contacts side by side, whose columns of D differ by 1 down to 1e-12: an answer is right, and seldom is there none.
#[test]
fn nearly_redundant_problems() {
    let mut random = random();
    let mut unsolved = 0;
    for case in 0..600 {
        let size = 2 + case % 60;
        let rank = 1 + random.random_range(0..size);
        let mut d = Mat::from_fn(rank, size, |_, _| random.random_range(-1.0..1.0));
        for j in 1..size {
            if random.random_range(0.0..1.0) < 0.3 {
                let apart = 10_f64.powf(random.random_range(-12.0..0.0));
                for i in 0..rank {
                    d[(i, j)] = d[(i, j - 1)] + apart * d[(i, j)];
                }
            }
        }
        let n = d.transpose() * &d;
        let u: Vec<f64> = (0..rank).map(|_| random.random_range(-1.0..1.0)).collect();
        let p: Vec<f64> = (0..size).map(|j| -(0..rank).map(|i| d[(i, j)] * u[i]).sum::<f64>()).collect();
        match lemke(n.as_ref(), &p, 50 * size) {
            Ok(z) => {
                let residual = residual(&n, &p, &z);
                assert!(residual < 1e-8, "{case}: {residual:e}");
            }
            Err(_) => unsolved += 1,
        }
    }
    assert!(unsolved <= 6, "{unsolved} unsolved");
}

#[test]
fn a_problem_without_a_solution_ends_on_a_ray() {
    assert_eq!(lemke(matrix([[0.0; 2]; 2]).as_ref(), &[-1.0, 1.0], 10), Err(LcpFailure::Ray));
    // two contacts that can't both open: w1 + w2 = -1
    let n = matrix([[1.0, -1.0], [-1.0, 1.0]]);
    assert_eq!(lemke(n.as_ref(), &[-2.0, 1.0], 10), Err(LcpFailure::Ray));
    // but w1 + w2 = 0 is just possible, with z1 - z2 = 2
    let z = lemke(n.as_ref(), &[-2.0, 2.0], 10).unwrap();
    assert!((z[0] - z[1] - 2.0).abs() < 1e-12, "{z:?}");
}

#[test]
fn too_few_pivots_and_useless_values_are_errors() {
    let n = matrix([[2.0, 1.0], [1.0, 2.0]]);
    assert_eq!(lemke(n.as_ref(), &[-5.0, -6.0], 1), Err(LcpFailure::Limit));
    near(&lemke(n.as_ref(), &[-5.0, -6.0], 2).unwrap(), &[4.0 / 3.0, 7.0 / 3.0]);
    assert_eq!(lemke(n.as_ref(), &[-5.0, f64::NAN], 10), Err(LcpFailure::NotFinite));
    assert_eq!(lemke(matrix([[f64::INFINITY]]).as_ref(), &[1.0], 10), Err(LcpFailure::NotFinite));
    // the answer itself, 1e500, is beyond all numbers
    assert_eq!(lemke(matrix([[1e-250]]).as_ref(), &[-1e250], 10), Err(LcpFailure::NotFinite));
}

#[test]
fn problems_without_contact_or_force() {
    assert_eq!(lemke(Mat::zeros(0, 0).as_ref(), &[], 10), Ok(vec![]));
    assert_eq!(lemke(matrix([[1.0]]).as_ref(), &[3.0], 0), Ok(vec![0.0]));
}
