//! Linear equations `A x = b` by GMRES, preconditioned from the right: for matrices near one that is factorised.
//!
//! Each iteration adds a direction and minimises the residual over all of them (Arnoldi with modified Gram-Schmidt, twice,
//! and Givens rotations). A difference of rank k to the preconditioner takes k + 1 iterations. Source: Saad, Iterative
//! methods for sparse linear systems, sections 6.5 and 9.3.

use crate::linalg::dot;

/// Solves until the residual is below `tolerance` times that of zero; `None` when `most` iterations do not reach it.
///
/// `multiply` is A, `precondition` an approximation of its inverse.
pub fn gmres(
    multiply: impl Fn(&[f64]) -> Vec<f64>,
    precondition: impl Fn(&[f64]) -> Vec<f64>,
    b: &[f64],
    tolerance: f64,
    most: usize,
) -> Option<Vec<f64>> {
    let size = norm(b);
    if size == 0.0 {
        return Some(vec![0.0; b.len()]);
    }
    let mut basis = vec![b.iter().map(|v| v / size).collect::<Vec<f64>>()];
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<(f64, f64)> = Vec::new();
    let mut right = vec![size];
    while directions.len() < most {
        let k = directions.len();
        let direction = precondition(&basis[k]);
        let mut image = multiply(&direction);
        directions.push(direction);
        let mut column = vec![0.0; k + 2];
        for _ in 0..2 {
            for (h, v) in column.iter_mut().zip(&basis) {
                let part = dot(v, &image);
                *h += part;
                image.iter_mut().zip(v).for_each(|(w, v)| *w -= part * v);
            }
        }
        let rest = norm(&image);
        column[k + 1] = rest;
        for (i, (cos, sin)) in rotations.iter().enumerate() {
            let (upper, lower) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (cos * upper + sin * lower, cos * lower - sin * upper);
        }
        let length = column[k].hypot(column[k + 1]);
        if !(length > 0.0) || !length.is_finite() {
            return None;
        }
        let (cos, sin) = (column[k] / length, column[k + 1] / length);
        rotations.push((cos, sin));
        column[k] = length;
        columns.push(column);
        let last = right[k];
        right[k] = cos * last;
        right.push(-sin * last);
        if right[k + 1].abs() <= tolerance * size {
            return combine(&columns, &right, &directions);
        }
        if rest == 0.0 {
            return None;
        }
        basis.push(image.into_iter().map(|v| v / rest).collect());
    }
    None
}

/// Back substitution in the triangle of the columns, and the sum of the directions.
fn combine(columns: &[Vec<f64>], right: &[f64], directions: &[Vec<f64>]) -> Option<Vec<f64>> {
    let n = columns.len();
    let mut y = right[..n].to_vec();
    for i in (0..n).rev() {
        for j in i + 1..n {
            y[i] -= columns[j][i] * y[j];
        }
        y[i] /= columns[i][i];
    }
    let mut x = vec![0.0; directions.first()?.len()];
    for (direction, factor) in directions.iter().zip(&y) {
        x.iter_mut().zip(direction).for_each(|(x, d)| *x += factor * d);
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A diagonal matrix with a skew part of rank two takes three iterations.
    #[test]
    fn a_difference_of_rank_two_takes_three_iterations() {
        let n = 40;
        let diagonal = |i: usize| 1.0 + 1e6 * (i as f64 / n as f64).powi(3);
        let multiply = |x: &[f64]| {
            let mut y: Vec<f64> = x.iter().enumerate().map(|(i, x)| diagonal(i) * x).collect();
            y[3] += 5.0 * x[17];
            y[17] -= 5.0 * x[3];
            y
        };
        let precondition = |x: &[f64]| x.iter().enumerate().map(|(i, x)| x / diagonal(i)).collect::<Vec<_>>();
        let right: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let b = multiply(&right);
        let x = gmres(multiply, precondition, &b, 1e-12, 3).expect("three iterations");
        assert!(x.iter().zip(&right).all(|(x, r)| (x - r).abs() < 1e-9), "{x:?}");
        assert!(gmres(multiply, precondition, &b, 1e-15, 1).is_none());
    }
}
