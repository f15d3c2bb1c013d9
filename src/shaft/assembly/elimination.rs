//! Elimination of what supports and rigid hubs hold: coordinates as combinations of free ones.

use crate::model::{Model, Node};
use crate::shaft::assembly::ZERO_ROW_RTOL;
use crate::shaft::attachments::{self, Numbering};
use faer::Mat;

pub(super) type Elimination = (Vec<Vec<(usize, f64)>>, Vec<usize>, Vec<(usize, Vec<f64>)>);

/// Eliminates the constraints of each node by Gauss-Jordan with full pivoting; dependent rows drop out.
/// Returns T by rows, the free coordinates, and the constraint rows for later use.
pub(super) fn eliminate(model: &Model, numbering: &Numbering, supports: bool) -> Elimination {
    let mut expansion = vec![Vec::new(); numbering.len()];
    let (mut free, mut constraints) = (Vec::new(), Vec::new());
    for node in 0..model.nodes.len() {
        let rows = if supports { attachments::constraint_rows(model, node) } else { Vec::new() };
        let start = numbering.index(node, 0, 0);
        let size = 3 * model.nodes[node].n_vectors();
        let mut all = rows.clone();
        all.extend(attachments::unmatched_kinks(model, node));
        all.extend(attachments::face_rows(model, node));
        let reduced = reduce(all);
        constraints.extend(rows.into_iter().map(|row| (node, row)));
        let is_pivot = |i: usize| reduced.iter().any(|(pivot, _)| *pivot == i);
        let first_free = free.len();
        free.extend((0..size).filter(|&i| !is_pivot(i)).map(|i| start + i));
        for (offset, &i) in free[first_free..].iter().enumerate() {
            expansion[i] = vec![(first_free + offset, 1.0)];
        }
        for (pivot, row) in &reduced {
            expansion[start + pivot] = free[first_free..]
                .iter()
                .enumerate()
                .filter(|(_, i)| row[**i - start] != 0.0)
                .map(|(offset, i)| (first_free + offset, -row[i - start]))
                .collect();
        }
        follow(model, node, start, &mut expansion);
        for coordinate in attachments::free_followers(model, node) {
            expansion[start + coordinate] = vec![(free.len(), 1.0)];
            free.push(start + coordinate);
        }
        for normal in numbering.normals(node) {
            expansion[normal] = vec![(free.len(), 1.0)];
            free.push(normal);
        }
        // a housing does not move along the axis
        for coordinate in
            numbering.housings(node).filter(|i| !(i - numbering.housings(node).start).is_multiple_of(3))
        {
            expansion[coordinate] = vec![(free.len(), 1.0)];
            free.push(coordinate);
        }
    }
    (expansion, free, constraints)
}

/// Expands the vectors that follow a node's own at a joint, `q_k = sum_l P_kl own_l`.
pub(super) fn follow(model: &Model, node: usize, start: usize, expansion: &mut [Vec<(usize, f64)>]) {
    let Node { field, follower: Some(follower), .. } = model.nodes[node] else { return };
    let Some(shared) = attachments::section_at(model, node).filter(|_| !model.nodes[node].coupled) else {
        return;
    };
    let p = if model.nodes[node].face {
        // plane and undistorted: r, r_,y and r_,z of both sides are one
        Mat::from_fn(follower.count(), field.count(), |k, l| f64::from(k == l && k < 3))
    } else {
        attachments::functions(model, follower).following(&attachments::functions(model, field), &shared)
    };
    for k in 0..p.nrows() {
        for c in 0..3 {
            let mut row: Vec<(usize, f64)> = Vec::new();
            for l in (0..p.ncols()).filter(|&l| p[(k, l)] != 0.0) {
                for &(j, value) in &expansion[start + 3 * l + c] {
                    match row.iter_mut().find(|(i, _)| *i == j) {
                        Some(entry) => entry.1 += p[(k, l)] * value,
                        None => row.push((j, p[(k, l)] * value)),
                    }
                }
            }
            expansion[start + 3 * (p.ncols() + k) + c] = row;
        }
    }
}

/// Reduced row echelon form: `(pivot column, row with 1 at the pivot and 0 at the other pivots)`.
pub(super) fn reduce(mut rows: Vec<Vec<f64>>) -> Vec<(usize, Vec<f64>)> {
    for row in &mut rows {
        let largest = row.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        row.iter_mut().for_each(|v| *v /= if largest > 0.0 { largest } else { 1.0 });
    }
    let mut done: Vec<(usize, Vec<f64>)> = Vec::new();
    while !rows.is_empty() {
        let mut best = (0, 0, 0.0);
        for (r, row) in rows.iter().enumerate() {
            for (c, v) in row.iter().enumerate() {
                // among equals the first, whatever rounding says
                if v.abs() > best.2 * (1.0 + ZERO_ROW_RTOL) {
                    best = (r, c, v.abs());
                }
            }
        }
        let (r, pivot, size) = best;
        if size < ZERO_ROW_RTOL {
            break;
        }
        let mut row = rows.swap_remove(r);
        let scale = row[pivot];
        row.iter_mut().for_each(|v| *v /= scale);
        for other in rows.iter_mut().chain(done.iter_mut().map(|d| &mut d.1)) {
            let factor = other[pivot];
            if factor != 0.0 {
                other.iter_mut().zip(&row).for_each(|(a, b)| *a -= factor * b);
                other[pivot] = 0.0;
            }
        }
        done.push((pivot, row));
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three conditions on four coordinates, one of them a sum of the others: two pivots, each 1 in its own row and 0 in the other.
    #[test]
    fn dependent_rows_leave_as_many_pivots_as_their_rank() {
        let rows = vec![vec![2.0, 1.0, 0.0, -1.0], vec![0.0, 3.0, 6.0, 0.0], vec![2.0, 4.0, 6.0, -1.0]];
        let reduced = reduce(rows.clone());
        assert_eq!(reduced.len(), 2);
        for (k, (pivot, row)) in reduced.iter().enumerate() {
            assert!((row[*pivot] - 1.0).abs() < 1e-14);
            assert!(reduced.iter().enumerate().all(|(l, (other, _))| l == k || row[*other] == 0.0));
        }
        // what the reduced rows leave free satisfies the rows as they were
        let pivots: Vec<usize> = reduced.iter().map(|(pivot, _)| *pivot).collect();
        for free in (0..4).filter(|c| !pivots.contains(c)) {
            let mut x = [0.0; 4];
            x[free] = 1.0;
            reduced.iter().for_each(|(pivot, row)| x[*pivot] = -row[free]);
            for row in &rows {
                let left: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
                assert!(left.abs() < 1e-13, "{left}");
            }
        }
    }
}
