//! Direct solver for matrices of a chain of elements: `x = T (T^T A T)^-1 T^T f`.
//!
//! Nodes within an element belong to it alone and are eliminated first, once for all elements that share a matrix:
//!
//! ```text
//!     S = A_ee - A_ei A_ii^-1 A_ie        (e the ends of an element, i its interior)
//! ```
//!
//! What is left couples each end node with the next one: a block tridiagonal system, factorised from left to right.
//! Matrices need not be symmetric; pivoting is partial, within a block. Every further contribution acts on one end node.

use crate::error::{Error, Result};
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::DenseSolveCore;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use std::ops::Range;

/// Where the coordinates of a chain are, and its constraints, which hold within end nodes.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Coordinates of every end node, from left to right.
    pub ends: Vec<Range<usize>>,
    /// `T` of every end node, its coordinates as sums over free ones; `None` where all are free.
    pub constraints: Vec<Option<Mat<f64>>>,
    /// Elements from left to right; element k joins end nodes k and k + 1.
    pub links: Vec<Link>,
}

/// An element: coordinates in the order of its matrix are those of the left end, the interior, the right end.
#[derive(Debug, Clone)]
pub struct Link {
    /// Its coordinates at both ends, counted from the first one of the end node.
    pub ends: [Vec<usize>; 2],
    /// Coordinates of the element that no other element shares.
    pub interior: Range<usize>,
}

/// The terms that a matrix of a chain is the sum of.
pub struct Terms<'a> {
    /// The distinct matrices of elements; elements that are copies of each other share one.
    pub elements: Vec<Mat<f64>>,
    /// For every element the index of its matrix in the list above.
    pub element_type: Vec<usize>,
    /// Factor, coordinates and matrix of further contributions, each on the coordinates of one end node.
    pub nodal: Vec<(f64, &'a [usize], MatRef<'a, f64>)>,
}

/// A factorised matrix of a chain, ready to solve for right-hand sides.
pub struct Chain {
    layout: Layout,
    condensed: Vec<Condensed>,
    /// Inverses of the blocks on the diagonal as elimination leaves them.
    inverse: Vec<Mat<f64>>,
    /// `A_(k+1,k) inverse_k` and `inverse_k A_(k,k+1)`.
    lower: Vec<Mat<f64>>,
    upper: Vec<Mat<f64>>,
}

/// What elimination of the interior leaves of a distinct matrix of elements.
struct Condensed {
    /// Inverse of the block of interior coordinates, `A_ii^-1`.
    inverse: Mat<f64>,
    /// Block that couples end nodes to interior coordinates, `A_ei`.
    outward: Mat<f64>,
    /// How interior coordinates follow the end nodes, but for the sign: `A_ii^-1 A_ie`.
    inward: Mat<f64>,
    elements: Vec<usize>,
}

impl Chain {
    /// Factorises a matrix.
    ///
    /// # Errors
    /// A singular matrix, or a contribution that reaches beyond one end node.
    pub fn new(layout: &Layout, terms: &Terms<'_>) -> Result<Self> {
        let mut schur = Vec::with_capacity(terms.elements.len());
        let mut condensed = Vec::with_capacity(terms.elements.len());
        for (kind, a) in terms.elements.iter().enumerate() {
            let elements: Vec<usize> =
                (0..layout.links.len()).filter(|&e| terms.element_type[e] == kind).collect();
            let Some(link) = elements.first().map(|&e| &layout.links[e]) else { continue };
            let (n, inner) = (link.ends[0].len(), link.interior.len());
            let outer = |i: usize| if i < n { i } else { i + inner };
            let part = |rows: usize, columns: usize, at: &dyn Fn(usize, usize) -> (usize, usize)| {
                Mat::from_fn(rows, columns, |i, j| a[at(i, j)])
            };
            let inverse = invert(&part(inner, inner, &|i, j| (n + i, n + j)))?;
            let outward = part(2 * n, inner, &|i, j| (outer(i), n + j));
            let inward = &inverse * part(inner, 2 * n, &|i, j| (n + i, outer(j)));
            let mut s = part(2 * n, 2 * n, &|i, j| (outer(i), outer(j)));
            subtract_product(s.as_mut(), &outward, &inward);
            schur.push(s);
            condensed.push(Condensed { inverse, outward, inward, elements });
        }
        let (diagonal, beside) = assemble(layout, &condensed, &schur, terms)?;
        let mut chain = Self {
            layout: layout.clone(),
            condensed,
            inverse: Vec::with_capacity(diagonal.len()),
            lower: Vec::with_capacity(beside.len()),
            upper: Vec::with_capacity(beside.len()),
        };
        for (k, mut block) in diagonal.into_iter().enumerate() {
            if k > 0 {
                let [above, below] = &beside[k - 1];
                let before = &chain.inverse[k - 1];
                let lower = below * before;
                subtract_product(block.as_mut(), &lower, above);
                chain.upper.push(before * above);
                chain.lower.push(lower);
            }
            chain.inverse.push(invert(&block)?);
        }
        Ok(chain)
    }

    /// `f := T (T^T A T)^-1 T^T f` for forces on all coordinates.
    pub fn solve_in_place(&self, f: &mut [f64]) {
        let layout = &self.layout;
        // interiors, with the ends at rest
        let interiors: Vec<Mat<f64>> = self
            .condensed
            .iter()
            .map(|c| {
                let mut forces = Mat::zeros(c.inverse.nrows(), c.elements.len());
                for (j, &e) in c.elements.iter().enumerate() {
                    column_mut(&mut forces, j).copy_from_slice(&f[layout.links[e].interior.clone()]);
                }
                let rest = &c.inverse * forces;
                let felt = &c.outward * &rest;
                for (j, &e) in c.elements.iter().enumerate() {
                    let mut felt = column(&felt, j).iter();
                    for (side, coordinates) in layout.links[e].ends.iter().enumerate() {
                        let start = layout.ends[e + side].start;
                        coordinates.iter().zip(&mut felt).for_each(|(i, felt)| f[start + i] -= felt);
                    }
                }
                rest
            })
            .collect();
        self.solve_ends(f);
        for (c, mut rest) in self.condensed.iter().zip(interiors) {
            let mut moved = Mat::zeros(c.inward.ncols(), c.elements.len());
            for (j, &e) in c.elements.iter().enumerate() {
                let mut moved = column_mut(&mut moved, j).iter_mut();
                for (side, coordinates) in layout.links[e].ends.iter().enumerate() {
                    let start = layout.ends[e + side].start;
                    coordinates.iter().zip(&mut moved).for_each(|(i, moved)| *moved = f[start + i]);
                }
            }
            subtract_product(rest.as_mut(), &c.inward, &moved);
            for (j, &e) in c.elements.iter().enumerate() {
                f[layout.links[e].interior.clone()].copy_from_slice(column(&rest, j));
            }
        }
    }

    /// The block tridiagonal system of the end nodes.
    fn solve_ends(&self, f: &mut [f64]) {
        let free = |k: usize, f: &[f64]| {
            let f = MatRef::from_column_major_slice(f, f.len(), 1);
            match &self.layout.constraints[k] {
                Some(t) => t.transpose() * f,
                None => f.to_owned(),
            }
        };
        let mut x: Vec<Mat<f64>> = Vec::with_capacity(self.layout.ends.len());
        for (k, range) in self.layout.ends.iter().enumerate() {
            let mut b = free(k, &f[range.clone()]);
            if k > 0 {
                subtract_product(b.as_mut(), &self.lower[k - 1], &x[k - 1]);
            }
            x.push(b);
        }
        for k in (0..x.len()).rev() {
            let mut answer = &self.inverse[k] * &x[k];
            if k + 1 < x.len() {
                subtract_product(answer.as_mut(), &self.upper[k], &x[k + 1]);
            }
            let all = &mut f[self.layout.ends[k].clone()];
            match &self.layout.constraints[k] {
                Some(t) => all.copy_from_slice(column(&(t * &answer), 0)),
                None => all.copy_from_slice(column(&answer, 0)),
            }
            x[k] = answer;
        }
    }
}

/// Blocks on the diagonal, and those above and below it, in the free coordinates of the end nodes.
#[allow(clippy::type_complexity)]
fn assemble(
    layout: &Layout,
    condensed: &[Condensed],
    schur: &[Mat<f64>],
    terms: &Terms<'_>,
) -> Result<(Vec<Mat<f64>>, Vec<[Mat<f64>; 2]>)> {
    let size = |k: usize| layout.ends[k].len();
    let mut diagonal: Vec<Mat<f64>> = (0..layout.ends.len()).map(|k| Mat::zeros(size(k), size(k))).collect();
    let mut beside: Vec<[Mat<f64>; 2]> = (0..layout.links.len())
        .map(|k| [Mat::zeros(size(k), size(k + 1)), Mat::zeros(size(k + 1), size(k))])
        .collect();
    for (c, s) in condensed.iter().zip(schur) {
        for &e in &c.elements {
            let [left, right] = &layout.links[e].ends;
            let add = |to: &mut Mat<f64>, rows: &[usize], columns: &[usize], at: [usize; 2]| {
                for (j, &column) in columns.iter().enumerate() {
                    for (i, &row) in rows.iter().enumerate() {
                        to[(row, column)] += s[(at[0] + i, at[1] + j)];
                    }
                }
            };
            let n = left.len();
            add(&mut diagonal[e], left, left, [0, 0]);
            add(&mut diagonal[e + 1], right, right, [n, n]);
            add(&mut beside[e][0], left, right, [0, n]);
            add(&mut beside[e][1], right, left, [n, 0]);
        }
    }
    for &(factor, coordinates, matrix) in &terms.nodal {
        let k = end_of(layout, coordinates).ok_or_else(|| {
            Error::analysis(
                "a system matrix couples nodes that no element joins",
                "the chain of elements with contributions of single nodes",
                "report this with the case: the program puts no such contribution together",
            )
        })?;
        let start = layout.ends[k].start;
        for (j, &column) in coordinates.iter().enumerate() {
            for (i, &row) in coordinates.iter().enumerate() {
                diagonal[k][(row - start, column - start)] += factor * matrix[(i, j)];
            }
        }
    }
    // into the free coordinates
    let from_left = |k: usize, a: Mat<f64>| match &layout.constraints[k] {
        Some(t) => t.transpose() * a,
        None => a,
    };
    let from_right = |k: usize, a: Mat<f64>| match &layout.constraints[k] {
        Some(t) => a * t,
        None => a,
    };
    let diagonal = diagonal.into_iter().enumerate().map(|(k, a)| from_right(k, from_left(k, a))).collect();
    let beside = beside
        .into_iter()
        .enumerate()
        .map(|(k, [above, below])| {
            [from_right(k + 1, from_left(k, above)), from_right(k, from_left(k + 1, below))]
        })
        .collect();
    Ok((diagonal, beside))
}

/// The end node that holds all the coordinates.
fn end_of(layout: &Layout, coordinates: &[usize]) -> Option<usize> {
    let within = |range: &Range<usize>| coordinates.iter().all(|i| range.contains(i));
    layout.ends.iter().position(within)
}

fn invert(a: &Mat<f64>) -> Result<Mat<f64>> {
    let inverse = a.partial_piv_lu().inverse();
    if inverse.is_all_finite() {
        return Ok(inverse);
    }
    Err(Error::analysis(
        "a system matrix could not be factorised",
        format!("elimination of a block of {} unknowns: it is singular", a.nrows()),
        "check supports and bearings for values that differ by more than ten decades",
    ))
}

/// Subtracts a product of matrices in place, `c -= a b`.
fn subtract_product(c: MatMut<'_, f64>, a: &Mat<f64>, b: &Mat<f64>) {
    matmul(c, Accum::Add, a, b, -1.0, Par::Seq);
}

fn column(a: &Mat<f64>, j: usize) -> &[f64] {
    a.col_as_slice(j)
}

fn column_mut(a: &mut Mat<f64>, j: usize) -> &mut [f64] {
    a.col_as_slice_mut(j)
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::linalg::solvers::Solve;

    /// Three elements on end nodes of 3, 2, 3 and 2 coordinates, two kinds, a constraint and contributions of nodes.
    #[test]
    fn chains_solve_as_dense_matrices_do() {
        let noise = |i: usize, j: usize| ((3 * i + 7 * j * j + 1) as f64).sin();
        let square = |n: usize, seed: usize| {
            Mat::from_fn(n, n, |i, j| noise(i + seed, j) + if i == j { 6.0 } else { 0.0 })
        };
        // coordinates: end 0 has 0..3, interior 3..5, end 1 has 5..7, and so on
        let ends = vec![0..3, 5..7, 9..12, 14..16];
        let link = |left: &[usize], right: &[usize], interior: Range<usize>| Link {
            ends: [left.to_vec(), right.to_vec()],
            interior,
        };
        let links =
            vec![link(&[0, 2], &[0, 1], 3..5), link(&[0, 1], &[1, 2], 7..9), link(&[0, 1], &[0, 1], 12..14)];
        let tie = Mat::from_fn(3, 2, |i, j| [[1.0, 0.0], [0.0, 1.0], [0.5, -0.25]][i][j]);
        let layout =
            Layout { ends: ends.clone(), constraints: vec![None, None, Some(tie.clone()), None], links };
        let elements = vec![square(6, 1), square(6, 40)];
        let element_type = vec![0, 1, 0];
        let near = square(2, 9);
        // node 0 also needs a stiffness on the coordinate that no element has
        let alone = Mat::from_fn(1, 1, |_, _| 2.0);
        let nodal = vec![(0.5, &[5, 6][..], near.as_ref()), (1.0, &[1][..], alone.as_ref())];
        let mut dense: Mat<f64> = Mat::zeros(16, 16);
        let mut add = |coordinates: &[usize], factor: f64, a: MatRef<'_, f64>| {
            for (j, &column) in coordinates.iter().enumerate() {
                for (i, &row) in coordinates.iter().enumerate() {
                    dense[(row, column)] += factor * a[(i, j)];
                }
            }
        };
        for (e, link) in layout.links.iter().enumerate() {
            let of = |side: usize| -> Vec<usize> {
                link.ends[side].iter().map(|i| ends[e + side].start + i).collect()
            };
            let coordinates: Vec<usize> =
                of(0).into_iter().chain(link.interior.clone()).chain(of(1)).collect();
            add(&coordinates, 1.0, elements[element_type[e]].as_ref());
        }
        nodal.iter().for_each(|(factor, coordinates, a)| add(coordinates, *factor, *a));
        // coordinate 11 follows 9 and 10
        let expand = Mat::from_fn(16, 15, |i, j| match i {
            11 => [0.5, -0.25].get(j.wrapping_sub(9)).copied().unwrap_or(0.0),
            _ => f64::from(j == if i < 11 { i } else { i - 1 }),
        });
        let f = Mat::from_fn(16, 1, |i, _| noise(i, 3));
        let reduced = expand.transpose() * &dense * &expand;
        let exact = &expand * reduced.partial_piv_lu().solve(expand.transpose() * &f);
        let chain = Chain::new(&layout, &Terms { elements, element_type, nodal }).unwrap();
        let mut x = column(&f, 0).to_vec();
        chain.solve_in_place(&mut x);
        for (ours, exact) in x.iter().zip(column(&exact, 0)) {
            assert!((ours - exact).abs() < 1e-13, "{ours} {exact}");
        }
    }

    #[test]
    fn what_it_cannot_solve_is_told() {
        let layout = Layout {
            ends: vec![0..1, 2..3],
            constraints: vec![None, None],
            links: vec![Link { ends: [vec![0], vec![0]], interior: 1..2 }],
        };
        let terms = Terms { elements: vec![Mat::zeros(3, 3)], element_type: vec![0], nodal: Vec::new() };
        assert!(Chain::new(&layout, &terms).is_err());
        let one = Mat::from_fn(3, 3, |i, j| f64::from(i == j));
        let joined = Mat::from_fn(2, 2, |_, _| 1.0);
        let nodal = vec![(1.0, &[0, 2][..], joined.as_ref())];
        let terms = Terms { elements: vec![one], element_type: vec![0], nodal };
        assert!(Chain::new(&layout, &terms).is_err());
    }
}
