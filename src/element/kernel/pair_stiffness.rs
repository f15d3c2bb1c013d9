//! From moments of the moduli at the stations to the tangent of an element.
//!
//! Moments `A_ab,ij[g] = int g A_ab,ij dA` come list by list, with the stations side by side in the registers. They are
//! integrated along the axis for every pair of nodes; from then on the pairs of nodes lie side by side. The stiffness of
//! a pair of vectors is a sum of such integrals times factors, its terms. Source: derived in
//! docs/theory/elements.md#nonlinear-forces.
//!
//! # The layout in a picture
//!
//! Example: 34X1, which has the vectors r, y, z at each of four nodes. Its list 0 has the moments of the monomials 1, yy
//! and zz. In a list the component ij runs fastest, then the monomial g, then the pair of directions, then the group of
//! pairs that share a product of axial functions:
//!
//! ```text
//! place   0           18        24        30        39   42        51        60        69        78
//!         | xx        | 11      | 22      | 12      | -  | x1      | x2      | x1      | x2      |
//!         | 3 g x 6   | 1 g x 6 | 1 g x 6 | 1 g x 9 | 3  | 1 g x 9 | 1 g x 9 | 1 g x 9 | 1 g x 9 |
//!         | L_a' L_b' | L_a L_b                     |    | L_a' L_b          | L_a L_b'          |
//!           ends[0] = 18                 ends[1] = 42       ends[2] = 60      at the nodes only
//!
//! xx      0                 6                   12                  18
//!         | g = 1           | g = yy            | g = zz            |        00 11 22 01 02 12 each
//! ```
//!
//! Every group is filled up to a multiple of `BLOCK`; here three places follow the 39th. The last two blocks are those
//! of x1 and x2 with the nodes a and b exchanged. So this list has 60 places at the stations and 78 at the nodes; the next
//! list starts at 78. What stands where:
//!
//! | array | index, slowest to fastest | for list 0 of 34X1 |
//! |---|---|---|
//! | at the stations | `[batch of stations][place][lane]` | station 5, place 24, four lanes: batch 1, lane 1, number `(1 * 60 + 24) * 4 + 1` |
//! | at the nodes | `[place][4 a + b]` | place 24, nodes a = 2, b = 3: number `24 * 16 + 11` |
//! | axial functions | `[station][4 a + b]`, one table a group | station 5: number `5 * 16 + 11` |
//! | stiffness | `[pair of vectors][3 i + j][4 a + b]` | pair (z, y), the fifth of (r,r) (y,r) (z,r) (y,y) (z,y) (z,z): from `4 * 9 * 16` on |
//! | tangent | `[3 (b n + l) + j][3 (a n + k) + i]`, by columns, n = 3 | node a = 2, vector k = z, i = 1: row `3 (2 * 3 + 2) + 1 = 25` of 36 |
//!
//! A term of the pair (k, l) is the place of its first component and a factor. Example: y enters F_y with the coefficient of
//! 1, r enters F_x with the coefficient of 1. So the pair (y, r) has a term of g = 1 in the directions 1x: the exchanged
//! copy of x1, place 60, whose nine components it takes transposed.

use crate::element::kernel::simd::Scratch;
use crate::element::kernel::stations::{NODES, Stations};
use pulp::Simd;
use pulp::bytemuck::cast_slice_mut;

/// Ordered pairs of nodes, `NODES a + b`.
pub const NODE_PAIRS: usize = NODES * NODES;
/// Numbers that hold the stiffness of a pair of vectors: nine components for each pair of nodes.
const STIFFNESS: usize = 9 * NODE_PAIRS;
/// Moments that are integrated along the axis together: with two registers of node pairs each they fit 16 registers.
const BLOCK: usize = 6;
/// Components as they come.
const IN_ORDER: [usize; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
/// Components ji of nine by rows.
pub const TRANSPOSED: [usize; 9] = [0, 3, 6, 1, 4, 7, 2, 5, 8];
/// The pairs of directions with their place in lists of six: xx 11 22 x1 x2 12.
pub const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Kinds of terms by the directions of derivatives of the two vectors: equal ones have six components, in the order
/// of [`PAIRS`], the others nine by rows; 21, x-first and x-last take them transposed, in order and transposed.
const KINDS: [&[(usize, usize)]; 5] =
    [&[(0, 0), (1, 1), (2, 2)], &[(1, 2)], &[(2, 1)], &[(0, 1), (0, 2)], &[(1, 0), (2, 0)]];
/// The pairs whose moments meet `L_i' L_j'`, `L_i L_j` and `L_i' L_j`.
const GROUPS: [&[usize]; 3] = [&[0], &[1, 2, 5], &[3, 4]];

/// Place of a pair of directions in [`PAIRS`].
#[inline(always)]
pub fn place(alpha: usize, beta: usize) -> usize {
    [[0, 3, 4], [3, 1, 5], [4, 5, 2]][alpha][beta]
}

/// Components of `A_ab`, by place in [`PAIRS`].
pub fn components(pair: usize) -> usize {
    if pair < 3 { 6 } else { 9 }
}

/// Moments that are made together, in one list.
#[derive(Debug, Clone)]
pub struct Batch {
    /// First moment of each pair of directions.
    pub first: [usize; 6],
    /// Ends of the three groups of [`GROUPS`], multiples of [`BLOCK`].
    ends: [usize; 3],
    /// First moment of the list among all at the nodes.
    start: usize,
}

impl Batch {
    /// Length of the list.
    pub fn length(&self) -> usize {
        self.ends[2]
    }

    /// Moments of x1 and x2, which the nodes keep a second time, with their pairs exchanged.
    fn exchanged(&self) -> usize {
        self.ends[2] - self.ends[1]
    }
}

/// A moment of a list, and its factor in a stiffness.
#[derive(Debug, Clone, Copy)]
pub struct Term {
    /// Index of the list of moments that the term reads.
    pub batch: usize,
    /// Which of the moments of its pair of directions.
    pub at: usize,
    /// Factor of the moment in the stiffness.
    pub factor: f64,
}

/// Tables of the expansion.
#[derive(Debug, Clone)]
pub struct Expansion {
    n_nodes: usize,
    n_vectors: usize,
    n_stations: usize,
    /// Lists of moments.
    pub batches: Vec<Batch>,
    /// `w L_i^(a) L_j^(b)` of the three groups at `[station * NODE_PAIRS + pair]`.
    axial: [Vec<f64>; 3],
    /// Moments at the nodes.
    at_nodes: usize,
    /// First component at the nodes and factor, for all pairs of vectors.
    terms: Vec<(usize, f64)>,
    /// The pairs, those that share moments next to each other.
    pairs: Vec<Pair>,
    /// Ends of the groups of pairs that share moments.
    groups: Vec<usize>,
    /// Place of the first pair `k >= l` of each l among the stiffnesses.
    starts: Vec<usize>,
}

/// A pair of vectors.
#[derive(Debug, Clone)]
struct Pair {
    /// Place of its stiffness.
    place: usize,
    /// First of its terms.
    start: usize,
    /// Where its five kinds of terms end.
    ends: [usize; 5],
}

impl Expansion {
    /// Tables for lists with so many moments for each pair of directions; `terms` of vectors k and l with
    /// derivatives in two directions (the moments are those of their pair in [`PAIRS`]). Pairs of vectors of one
    /// `group` share moments: one after the other they find them in the nearest cache.
    pub fn new(
        stations: &Stations,
        n_vectors: usize,
        lists: &[[usize; 6]],
        group: impl Fn([usize; 2]) -> usize,
        terms: impl Fn([usize; 2], (usize, usize)) -> Vec<Term>,
    ) -> Self {
        let mut start = 0;
        let of_list = |counts: &[usize; 6]| {
            let (mut first, mut ends, mut at) = ([0; 6], [0; 3], 0);
            for (end, pairs) in ends.iter_mut().zip(GROUPS) {
                for &pair in pairs {
                    first[pair] = at;
                    at += components(pair) * counts[pair];
                }
                at = at.next_multiple_of(BLOCK);
                *end = at;
            }
            let batch = Batch { first, ends, start };
            start += batch.length() + batch.exchanged();
            batch
        };
        let batches: Vec<Batch> = lists.iter().map(of_list).collect();
        let (mut sorted, mut starts) = (Vec::new(), Vec::new());
        for l in 0..n_vectors {
            starts.push(sorted.len());
            for k in l..n_vectors {
                sorted.push((group([k, l]), sorted.len(), [k, l]));
            }
        }
        sorted.sort_by_key(|(group, ..)| *group);
        let groups = sorted.chunk_by(|a, b| a.0 == b.0).map(<[_]>::len);
        let groups = groups.scan(0, |end, length| {
            *end += length;
            Some(*end)
        });
        let groups: Vec<usize> = groups.collect();
        let mut list = Vec::new();
        let of_pair = |(_, place, [k, l]): (usize, usize, [usize; 2])| {
            let start = list.len();
            let ends = KINDS.map(|kind| {
                for &(alpha, beta) in kind {
                    let pair = self::place(alpha, beta);
                    list.extend(terms([k, l], (alpha, beta)).into_iter().map(|term| {
                        let batch = &batches[term.batch];
                        let second = if beta == 0 && alpha > 0 { batch.exchanged() } else { 0 };
                        let at = batch.start + batch.first[pair] + components(pair) * term.at;
                        (at + second, term.factor)
                    }));
                }
                list.len()
            });
            Pair { place, start, ends }
        };
        let pairs = sorted.into_iter().map(of_pair).collect();
        Self {
            n_nodes: stations.n_nodes(),
            n_vectors,
            n_stations: stations.count,
            batches,
            axial: [(true, true), (false, false), (true, false)].map(|(a, b)| stations.node_pairs(a, b)),
            at_nodes: start,
            terms: list,
            pairs,
            groups,
            starts,
        }
    }

    /// Number of coordinates.
    pub fn size(&self) -> usize {
        3 * self.n_nodes * self.n_vectors
    }

    /// Numbers that hold the moments at the nodes.
    pub fn at_nodes(&self) -> usize {
        NODE_PAIRS * self.at_nodes
    }

    /// Numbers that hold the stiffness of all pairs of vectors.
    pub fn stiffness_size(&self) -> usize {
        STIFFNESS * self.pairs.len()
    }

    /// Integrals of a list of moments along the axis for all pairs of nodes. Of every batch of stations there is one
    /// list of registers.
    #[inline(always)]
    pub(in crate::element) fn along_axis<S: Simd>(
        &self,
        simd: S,
        list: usize,
        at_stations: &[f64],
        at_nodes: &mut [f64],
    ) {
        let batch = &self.batches[list];
        let at_nodes =
            &mut at_nodes[NODE_PAIRS * batch.start..][..NODE_PAIRS * (batch.length() + batch.exchanged())];
        let mut start = 0;
        for (axial, end) in self.axial.iter().zip(batch.ends) {
            let axial = S::as_simd_f64s(axial).0;
            for at in (start..end).step_by(BLOCK) {
                let moments = &at_stations[at * S::F64_LANES..];
                let target = S::as_mut_simd_f64s(&mut at_nodes[NODE_PAIRS * at..][..NODE_PAIRS * BLOCK]).0;
                for v in (0..NODE_PAIRS / S::F64_LANES).step_by(2) {
                    self.axis_block(simd, moments, batch.length(), axial, target, v);
                }
            }
            start = end;
        }
        let (direct, exchanged) =
            at_nodes[NODE_PAIRS * batch.ends[1]..].split_at_mut(NODE_PAIRS * batch.exchanged());
        for (direct, exchanged) in direct.chunks_exact(NODE_PAIRS).zip(exchanged.chunks_exact_mut(NODE_PAIRS))
        {
            for a in 0..NODES {
                for b in 0..NODES {
                    exchanged[NODES * a + b] = direct[NODES * b + a];
                }
            }
        }
    }

    /// Two registers of node pairs of a block of moments.
    #[inline(always)]
    fn axis_block<S: Simd>(
        &self,
        simd: S,
        moments: &[f64],
        length: usize,
        axial: &[S::f64s],
        target: &mut [S::f64s],
        v: usize,
    ) {
        let stride = NODE_PAIRS / S::F64_LANES;
        let mut sums = [[simd.splat_f64s(0.0); 2]; BLOCK];
        for s in 0..self.n_stations {
            let at = s / S::F64_LANES * length * S::F64_LANES + s % S::F64_LANES;
            let moments = &moments[at..][..(BLOCK - 1) * S::F64_LANES + 1];
            let weights = &axial[s * stride + v..][..2];
            for b in 0..BLOCK {
                let moment = simd.splat_f64s(moments[b * S::F64_LANES]);
                for u in 0..2 {
                    sums[b][u] = simd.mul_add_e_f64s(moment, weights[u], sums[b][u]);
                }
            }
        }
        for b in 0..BLOCK {
            target[b * stride + v..][..2].copy_from_slice(&sums[b]);
        }
    }

    /// The stiffness of all pairs of vectors `k >= l`: `[3 i + j][pair of nodes]`.
    #[inline(always)]
    pub(in crate::element) fn stiffness<S: Simd>(
        &self,
        simd: S,
        at_nodes: &[S::f64s],
        stiffness: &mut [S::f64s],
    ) {
        let (stride, terms, mut from) = (NODE_PAIRS / S::F64_LANES, &self.terms, 0);
        for &to in &self.groups {
            for v in 0..stride {
                let at_nodes = &at_nodes[v..];
                for Pair { place, start, ends } in &self.pairs[from..to] {
                    let mut six = [simd.splat_f64s(0.0); 6];
                    add_terms(simd, &terms[*start..ends[0]], at_nodes, stride, &IN_ORDER, &mut six);
                    // the six 00 11 22 01 02 12 by rows
                    let mut nine = [six[0], six[3], six[4], six[3], six[1], six[5], six[4], six[5], six[2]];
                    add_terms(simd, &terms[ends[0]..ends[1]], at_nodes, stride, &IN_ORDER, &mut nine);
                    add_terms(simd, &terms[ends[1]..ends[2]], at_nodes, stride, &TRANSPOSED, &mut nine);
                    add_terms(simd, &terms[ends[2]..ends[3]], at_nodes, stride, &IN_ORDER, &mut nine);
                    add_terms(simd, &terms[ends[3]..ends[4]], at_nodes, stride, &TRANSPOSED, &mut nine);
                    let target = &mut stiffness[place * 9 * stride..][..9 * stride];
                    for k in 0..9 {
                        target[k * stride + v] = nine[k];
                    }
                }
            }
            from = to;
        }
    }

    /// Writes both triangles, bit by bit symmetric, from the stiffness of all pairs of vectors, which lies at the
    /// front of the working memory.
    ///
    /// Column by column: what belongs to a vector l stays in the nearest cache meanwhile. Not part of the vectorised
    /// code, it moves single numbers.
    pub(in crate::element) fn write(&self, scratch: &mut Scratch, tangent: &mut [f64]) {
        let (n, nodes, starts) = (self.n_vectors, self.n_nodes, &self.starts);
        let size = self.size();
        let all: &mut [[[f64; NODE_PAIRS]; 9]] = cast_slice_mut(scratch.take(self.stiffness_size()));
        for l in 0..n {
            symmetrise(&mut all[starts[l]]);
            let of_l = &all[starts[l]..][..n - l];
            for b in 0..nodes {
                for j in 0..3 {
                    let column = &mut tangent[(3 * (b * n + l) + j) * size..][..size];
                    for a in 0..nodes {
                        let rows = &mut column[3 * n * a..][..3 * n];
                        // the remainders change nothing but spare the checks of the innermost loops
                        let (pair, mirrored) = ((NODES * a + b) % NODE_PAIRS, (NODES * b + a) % NODE_PAIRS);
                        for k in 0..l {
                            let m = &all[starts[k] + l - k];
                            let row = [m[3 * j][mirrored], m[3 * j + 1][mirrored], m[3 * j + 2][mirrored]];
                            rows[3 * k..][..3].copy_from_slice(&row);
                        }
                        for k in l..n {
                            let m = &of_l[k - l];
                            let row = [m[j][pair], m[3 + j][pair], m[6 + j][pair]];
                            rows[3 * k..][..3].copy_from_slice(&row);
                        }
                    }
                }
            }
        }
    }
}

/// Makes the stiffness of a vector with itself symmetric where rounding has left a difference.
fn symmetrise(m: &mut [[f64; NODE_PAIRS]; 9]) {
    for a in 0..NODES {
        for b in 0..=a {
            for i in 0..3 {
                for j in 0..3 {
                    if (b, j) < (a, i) {
                        m[3 * j + i][NODES * b + a] = m[3 * i + j][NODES * a + b];
                    }
                }
            }
        }
    }
}

/// Adds the terms; component k of the sum takes component `order[k]` of the moments.
#[inline(always)]
fn add_terms<S: Simd, const K: usize>(
    simd: S,
    terms: &[(usize, f64)],
    moments: &[S::f64s],
    stride: usize,
    order: &[usize],
    sums: &mut [S::f64s; K],
) {
    for &(moment, factor) in terms {
        let factor = simd.splat_f64s(factor);
        let moments = &moments[moment * stride..][..(K - 1) * stride + 1];
        for k in 0..K {
            sums[k] = simd.mul_add_e_f64s(factor, moments[order[k] * stride], sums[k]);
        }
    }
}
