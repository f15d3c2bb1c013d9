//! The tangent: moments `A_ab,ij[g]` at the stations, their integrals along the axis for every pair of nodes, and
//! from them the stiffness of every pair of vectors.
//!
//! It goes class by class of monomials, so that the moments at the stations stay in the nearest cache. Stations lie
//! side by side in the vector registers until the axis is integrated, pairs of nodes from then on.

use super::polynomials::{Class, IN_ORDER, count, take};
use super::{DEGREE, NODES, NonlinearElement, PAIRS, Roles, Scratch, place};
use crate::vectors::exponents;
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Simd, WithSimd};

/// Ordered pairs of nodes, `NODES a + b`.
const NODE_PAIRS: usize = NODES * NODES;
/// Numbers that hold the stiffness of a pair of vectors: nine components for each pair of nodes.
const STIFFNESS: usize = 9 * NODE_PAIRS;
/// Vectors of working memory for each monomial of a class: squares, strains and an integrand.
const WORK: usize = 18 + 3 + 9;
/// Moments that are integrated along the axis together: with two vectors of node pairs each they fit 16 registers.
const BLOCK: usize = 6;
/// Components ji of nine by rows.
const TRANSPOSED: [usize; 9] = [0, 3, 6, 1, 4, 7, 2, 5, 8];

/// Components of `A_ab`, by place in [`PAIRS`].
fn components(pair: usize) -> usize {
    if pair < 3 { 6 } else { 9 }
}

/// Pairs of coefficients of two fields by the monomial of their product.
#[derive(Debug, Clone)]
struct Products {
    starts: Vec<usize>,
    pairs: Vec<(u16, u16)>,
}

impl Products {
    /// Products of fields with the first `left` and `right` monomials of a list; pairs `e < f` alone where `once`.
    fn new(
        targets: &[(usize, usize)],
        list: &[(usize, usize)],
        (left, right): (usize, usize),
        once: bool,
    ) -> Self {
        let (mut starts, mut pairs) = (vec![0], Vec::new());
        for g in targets {
            for (e, a) in list[..left].iter().enumerate() {
                let found = list[..right].iter().position(|b| (a.0 + b.0, a.1 + b.1) == *g);
                pairs.extend(found.filter(|&f| e < f || !once).map(|f| (e as u16, f as u16)));
            }
            starts.push(pairs.len());
        }
        Self { starts, pairs }
    }

    #[inline(always)]
    fn of(&self, target: usize) -> &[(u16, u16)] {
        &self.pairs[self.starts[target]..self.starts[target + 1]]
    }
}

/// What belongs to a class of monomials.
#[derive(Debug, Clone)]
struct ClassTables {
    /// Products of F_x with F_y or F_z; of F_y with F_z.
    products: [Products; 2],
    /// Products of F_x with itself; of F_y or F_z with itself: pairs of different coefficients once.
    squares: [Products; 2],
    /// The coefficient whose square is the monomial.
    roots: Vec<Option<usize>>,
    /// First moment of each pair of directions among those of the class.
    first: [usize; 6],
    /// Ends of three groups of pairs: xx meets `L_i' L_j'`; yy, zz and yz meet `L_i L_j`; xy and xz `L_i' L_j`.
    ends: [usize; 3],
    /// First moment of the class among all at the nodes.
    start: usize,
}

impl ClassTables {
    fn new(
        class: &Class,
        g: &[(usize, usize)],
        list: &[(usize, usize)],
        (x, y): (usize, usize),
        start: usize,
    ) -> Self {
        let [low, mid, all] = class.counts;
        let (mut first, mut ends, mut at) = ([0; 6], [0; 3], 0);
        for (group, pairs) in [&[0][..], &[1, 2, 5], &[3, 4]].into_iter().enumerate() {
            for &pair in pairs {
                first[pair] = at;
                at += components(pair) * class.counts[DEGREE[pair]];
            }
            at = at.next_multiple_of(BLOCK);
            ends[group] = at;
        }
        Self {
            products: [
                Products::new(&g[..mid], list, (x, y), false),
                Products::new(&g[..low], list, (y, y), false),
            ],
            squares: [
                Products::new(&g[..all], list, (x, x), true),
                Products::new(&g[..low], list, (y, y), true),
            ],
            roots: g.iter().map(|g| list[..x].iter().position(|e| (2 * e.0, 2 * e.1) == *g)).collect(),
            first,
            ends,
            start,
        }
    }

    /// Moments of xy and xz, which the nodes keep a second time, with their pairs exchanged.
    fn exchanged(&self) -> usize {
        self.ends[2] - self.ends[1]
    }
}

/// An integrated moment and its factor in a stiffness.
#[derive(Debug, Clone)]
struct Term {
    moment: usize,
    factor: f64,
}

/// Tables of the tangent.
#[derive(Debug, Clone)]
pub(super) struct Tables {
    classes: [ClassTables; 4],
    /// `w L_i^(a) L_j^(b)` of the three groups at `[station * NODE_PAIRS + pair]`.
    axial: [Vec<f64>; 3],
    /// Moments of the largest class; of all at the nodes.
    sizes: [usize; 2],
    /// Terms of the stiffness of all pairs of vectors `k >= l`, by l, then k.
    terms: Vec<Term>,
    /// For each such pair, where five kinds of terms end: equal directions; yz; zy; xy and xz; yx and zx.
    ends: Vec<[usize; 5]>,
}

impl Tables {
    /// Tables for axial polynomials (and slopes) at the stations, plain and weighted.
    pub fn new(
        order: usize,
        classes: &[Class; 4],
        vectors: &[Roles],
        [axial, weighted]: [&[Vec<f64>; 2]; 2],
        padded: usize,
    ) -> Self {
        let list = exponents(2 * order);
        let monomials = classes.each_ref().map(|class| class.monomials.clone());
        let (mut largest, mut start) = (0, 0);
        let class_tables = [0, 1, 2, 3].map(|c| {
            let fields = (count(order), count(order - 1));
            let tables = ClassTables::new(&classes[c], &monomials[c], &list, fields, start);
            largest = largest.max(tables.ends[2]);
            start += tables.ends[2] + tables.exchanged();
            tables
        });
        let kinds: [&[(usize, usize)]; 5] =
            [&[(0, 0), (1, 1), (2, 2)], &[(1, 2)], &[(2, 1)], &[(0, 1), (0, 2)], &[(1, 0), (2, 0)]];
        let (mut terms, mut ends) = (Vec::new(), Vec::new());
        for l in 0..vectors.len() {
            for k in l..vectors.len() {
                ends.push([0, 1, 2, 3, 4].map(|kind| {
                    for &(alpha, beta) in kinds[kind] {
                        let roles = (vectors[k][alpha], vectors[l][beta]);
                        let (Some((e, left)), Some((f, right))) = roles else { continue };
                        let g = (list[e].0 + list[f].0, list[e].1 + list[f].1);
                        let of_class = |c: usize| Some((c, monomials[c].iter().position(|m| *m == g)?));
                        let Some((c, at)) = (0..4).find_map(of_class) else { continue };
                        let (class, pair): (&ClassTables, _) = (&class_tables[c], place(alpha, beta));
                        let second = if kind == 4 { class.exchanged() } else { 0 };
                        let moment = class.start + class.first[pair] + components(pair) * at + second;
                        terms.push(Term { moment, factor: left * right });
                    }
                    terms.len()
                }));
            }
        }
        Self {
            classes: class_tables,
            axial: [(1, 1), (0, 0), (1, 0)].map(|(a, b)| node_pairs(&weighted[a], &axial[b], padded)),
            sizes: [largest, start],
            terms,
            ends,
        }
    }
}

/// Products of two sets of axial functions for all pairs of nodes, from `[node * padded + station]`.
fn node_pairs(left: &[f64], right: &[f64], padded: usize) -> Vec<f64> {
    let mut table = vec![0.0; padded * NODE_PAIRS];
    for (a, left) in left.chunks_exact(padded).enumerate() {
        for (b, right) in right.chunks_exact(padded).enumerate() {
            for s in 0..padded {
                table[s * NODE_PAIRS + NODES * a + b] = left[s] * right[s];
            }
        }
    }
    table
}

/// The stiffness of all pairs of vectors into the working memory.
pub(super) struct Tangent<'a> {
    pub element: &'a NonlinearElement,
    pub q: &'a [f64],
    pub geometric: bool,
    pub scratch: &'a mut Scratch,
}

impl WithSimd for Tangent<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { element, q, geometric, scratch } = self;
        let tables = &element.tangent;
        let [of_class, of_all] = tables.sizes;
        let batches = element.n_stations.div_ceil(S::F64_LANES);
        let (monomials, largest) = (element.fields.iter().sum::<usize>(), element.classes[0].places.len());
        let vectors = batches * (3 * monomials + of_class) + WORK * largest;
        let stiffness = STIFFNESS * tables.ends.len();
        let mut pool = scratch.pool.take(stiffness + NODE_PAIRS * of_all + S::F64_LANES * vectors);
        let stiffness = take::<S::f64s>(&mut pool, stiffness / S::F64_LANES);
        let at_nodes = take::<f64>(&mut pool, NODE_PAIRS * of_all);
        let f = take::<[S::f64s; 3]>(&mut pool, batches * monomials);
        let at_stations = take::<S::f64s>(&mut pool, batches * of_class);
        for (batch, f) in f.chunks_exact_mut(monomials).enumerate() {
            element.gradient(simd, q, batch, f);
        }
        for c in 0..4 {
            let length = tables.classes[c].ends[2];
            for (f, moments) in f.chunks_exact(monomials).zip(at_stations.chunks_exact_mut(length)) {
                element.tangent_moments(simd, c, element.columns(f), geometric, pool, moments);
            }
            element.along_axis(simd, c, cast_slice(at_stations), at_nodes);
        }
        element.stiffness(simd, cast_slice(at_nodes), stiffness);
    }
}

/// Nine sums of products `a_i[e] b_j[f]`, by rows.
#[inline(always)]
fn outer<S: Simd>(simd: S, pairs: &[(u16, u16)], a: &[[S::f64s; 3]], b: &[[S::f64s; 3]]) -> [S::f64s; 9] {
    let mut sums = [simd.splat_f64s(0.0); 9];
    for &(e, f) in pairs {
        let (a, b) = (&a[e as usize], &b[f as usize]);
        for i in 0..3 {
            for j in 0..3 {
                sums[3 * i + j] = simd.mul_add_e_f64s(a[i], b[j], sums[3 * i + j]);
            }
        }
    }
    sums
}

/// Adds the terms; component k of the sum takes component `order[k]` of the moments.
#[inline(always)]
fn add_terms<S: Simd, const K: usize>(
    simd: S,
    terms: &[Term],
    moments: &[S::f64s],
    stride: usize,
    order: &[usize],
    sums: &mut [S::f64s; K],
) {
    for term in terms {
        let factor = simd.splat_f64s(term.factor);
        let moments = &moments[term.moment * stride..][..(K - 1) * stride + 1];
        for k in 0..K {
            sums[k] = simd.mul_add_e_f64s(factor, moments[order[k] * stride], sums[k]);
        }
    }
}

impl NonlinearElement {
    /// Moments `A_ab,ij` of a class at a batch of stations.
    #[inline(always)]
    fn tangent_moments<S: Simd>(
        &self,
        simd: S,
        c: usize,
        f: [&[[S::f64s; 3]]; 3],
        geometric: bool,
        mut pool: &mut [f64],
        moments: &mut [S::f64s],
    ) {
        let all = self.classes[c].counts[2];
        let squares = take::<[[S::f64s; 6]; 3]>(&mut pool, all);
        let strains = take::<[S::f64s; 3]>(&mut pool, all);
        self.squares(simd, c, f, squares, strains);
        for alpha in 0..3 {
            let stress = geometric.then_some(&*strains);
            self.normal_moments(simd, (c, alpha), squares, stress, pool, moments);
        }
        for pair in 3..6 {
            self.shear_moments(simd, (c, pair), f, geometric, pool, moments);
        }
    }

    /// Products `F_ai F_aj`, by the six components ij = 00 11 22 01 02 12, and the strains `E_aa` of a class.
    #[inline(always)]
    fn squares<S: Simd>(
        &self,
        simd: S,
        c: usize,
        f: [&[[S::f64s; 3]]; 3],
        squares: &mut [[[S::f64s; 6]; 3]],
        strains: &mut [[S::f64s; 3]],
    ) {
        let (tables, low) = (&self.tangent.classes[c], self.classes[c].counts[0]);
        let half = simd.splat_f64s(0.5);
        for (g, (squares, strains)) in squares.iter_mut().zip(strains).enumerate() {
            *squares = [[simd.splat_f64s(0.0); 6]; 3];
            // the squares of F_y and F_z have a lower degree
            for alpha in 0..if g < low { 3 } else { 1 } {
                let pairs = tables.squares[usize::from(alpha > 0)].of(g);
                let m = outer(simd, pairs, f[alpha], f[alpha]);
                // the pairs once, in both orders
                let mut square = [m[0], m[4], m[8], m[1], m[2], m[5]];
                for (square, m) in square.iter_mut().zip([m[0], m[4], m[8], m[3], m[6], m[7]]) {
                    *square = simd.add_f64s(*square, m);
                }
                if let Some(e) = tables.roots[g] {
                    let f = &f[alpha][e];
                    for (square, (i, j)) in square.iter_mut().zip(PAIRS) {
                        *square = simd.mul_add_e_f64s(f[i], f[j], *square);
                    }
                }
                squares[alpha] = square;
            }
            for (strain, s) in strains.iter_mut().zip(squares) {
                let mut trace = simd.add_f64s(simd.add_f64s(s[0], s[1]), s[2]);
                if (c, g) == (0, 0) {
                    trace = simd.sub_f64s(trace, simd.splat_f64s(1.0));
                }
                *strain = simd.mul_f64s(half, trace);
            }
        }
    }

    /// Moments `A_aa,ij`, with stress if strains are given.
    #[inline(always)]
    fn normal_moments<S: Simd>(
        &self,
        simd: S,
        (c, alpha): (usize, usize),
        squares: &[[[S::f64s; 6]; 3]],
        strains: Option<&[[S::f64s; 3]]>,
        mut pool: &mut [f64],
        moments: &mut [S::f64s],
    ) {
        let (class, zero) = (&self.classes[c], simd.splat_f64s(0.0));
        let (rows, all) = (class.counts[DEGREE[alpha]], class.counts[2]);
        let integrand = take::<[S::f64s; 6]>(&mut pool, all);
        let normal = self.law.normal[alpha];
        let mut moduli = [normal[alpha]; 3];
        for gamma in 0..3 {
            if gamma != alpha {
                moduli[gamma] = self.law.shear[place(alpha, gamma) - 3];
            }
        }
        for g in 0..all {
            let mut stress = zero;
            if let Some(strains) = strains {
                for beta in 0..3 {
                    stress = simd.mul_add_e_f64s(simd.splat_f64s(normal[beta]), strains[g][beta], stress);
                }
            }
            for k in 0..6 {
                let mut sum = if k < 3 { stress } else { zero };
                for gamma in 0..3 {
                    sum = simd.mul_add_e_f64s(simd.splat_f64s(moduli[gamma]), squares[g][gamma][k], sum);
                }
                integrand[g][k] = sum;
            }
        }
        let first = self.tangent.classes[c].first[alpha];
        let moments: &mut [[S::f64s; 6]] = cast_slice_mut(&mut moments[first..][..6 * rows]);
        class.integrate::<S, 0, 3, 6>(simd, (0..rows, all), integrand, moments, &IN_ORDER);
        class.integrate::<S, 3, 3, 6>(simd, (0..rows, all), integrand, moments, &IN_ORDER);
        if c == 0
            && let Some(law) = self.law.on_axis
        {
            let factor = simd.splat_f64s(self.area * law[alpha][alpha]);
            let stress = strains.map_or(zero, |strains| self.axis_stress(simd, law[alpha], strains[0]));
            for k in 0..6 {
                let sum = simd.mul_add_e_f64s(factor, squares[0][alpha][k], moments[0][k]);
                moments[0][k] = if k < 3 { simd.add_f64s(sum, stress) } else { sum };
            }
        }
    }

    /// Moments `A_ab,ij` of a pair of different directions, ij by rows.
    #[inline(always)]
    fn shear_moments<S: Simd>(
        &self,
        simd: S,
        (c, pair): (usize, usize),
        f: [&[[S::f64s; 3]]; 3],
        geometric: bool,
        mut pool: &mut [f64],
        moments: &mut [S::f64s],
    ) {
        let (class, tables) = (&self.classes[c], &self.tangent.classes[c]);
        let (alpha, beta) = PAIRS[pair];
        let (a, b, count) = (f[alpha], f[beta], class.counts[DEGREE[pair]]);
        let products = &tables.products[usize::from(alpha > 0)];
        let integrand = take::<[S::f64s; 9]>(&mut pool, count);
        let coupling = simd.splat_f64s(self.law.normal[alpha][beta]);
        let shear = simd.splat_f64s(self.law.shear[pair - 3]);
        for g in 0..count {
            let m = outer(simd, products.of(g), a, b);
            for k in 0..9 {
                let sum = simd.mul_f64s(shear, m[TRANSPOSED[k]]);
                integrand[g][k] = simd.mul_add_e_f64s(coupling, m[k], sum);
            }
            if geometric {
                let stress = simd.mul_f64s(shear, simd.add_f64s(simd.add_f64s(m[0], m[4]), m[8]));
                for k in [0, 4, 8] {
                    integrand[g][k] = simd.add_f64s(integrand[g][k], stress);
                }
            }
        }
        let moments: &mut [[S::f64s; 9]] = cast_slice_mut(&mut moments[tables.first[pair]..][..9 * count]);
        class.integrate::<S, 0, 3, 9>(simd, (0..count, count), integrand, moments, &IN_ORDER);
        class.integrate::<S, 3, 3, 9>(simd, (0..count, count), integrand, moments, &IN_ORDER);
        class.integrate::<S, 6, 3, 9>(simd, (0..count, count), integrand, moments, &IN_ORDER);
        if c == 0
            && let Some(law) = self.law.on_axis
        {
            let factor = simd.splat_f64s(self.area * law[alpha][beta]);
            for (k, moment) in moments[0].iter_mut().enumerate() {
                *moment = simd.mul_add_e_f64s(factor, simd.mul_f64s(a[0][k / 3], b[0][k % 3]), *moment);
            }
        }
    }

    /// Integrals of the moments of a class along the axis for all pairs of nodes.
    #[inline(always)]
    fn along_axis<S: Simd>(&self, simd: S, c: usize, at_stations: &[f64], at_nodes: &mut [f64]) {
        let tables = &self.tangent.classes[c];
        let at_nodes =
            &mut at_nodes[NODE_PAIRS * tables.start..][..NODE_PAIRS * (tables.ends[2] + tables.exchanged())];
        let mut start = 0;
        for (axial, end) in self.tangent.axial.iter().zip(tables.ends) {
            let axial = S::as_simd_f64s(axial).0;
            for at in (start..end).step_by(BLOCK) {
                let moments = &at_stations[at * S::F64_LANES..];
                let target = S::as_mut_simd_f64s(&mut at_nodes[NODE_PAIRS * at..][..NODE_PAIRS * BLOCK]).0;
                for v in (0..NODE_PAIRS / S::F64_LANES).step_by(2) {
                    self.axis_block(simd, moments, tables.ends[2], axial, target, v);
                }
            }
            start = end;
        }
        let (direct, exchanged) =
            at_nodes[NODE_PAIRS * tables.ends[1]..].split_at_mut(NODE_PAIRS * tables.exchanged());
        for (direct, exchanged) in direct.chunks_exact(NODE_PAIRS).zip(exchanged.chunks_exact_mut(NODE_PAIRS))
        {
            for a in 0..NODES {
                for b in 0..NODES {
                    exchanged[NODES * a + b] = direct[NODES * b + a];
                }
            }
        }
    }

    /// Two vectors of node pairs of a block of moments.
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
    fn stiffness<S: Simd>(&self, simd: S, at_nodes: &[S::f64s], stiffness: &mut [S::f64s]) {
        let (tables, stride) = (&self.tangent, NODE_PAIRS / S::F64_LANES);
        let mut start = 0;
        for (ends, target) in tables.ends.iter().zip(stiffness.chunks_exact_mut(STIFFNESS / S::F64_LANES)) {
            let terms = |from: usize, to: usize| &tables.terms[from..to];
            for v in 0..stride {
                let mut six = [simd.splat_f64s(0.0); 6];
                add_terms(simd, terms(start, ends[0]), &at_nodes[v..], stride, &IN_ORDER, &mut six);
                // the six 00 11 22 01 02 12 by rows
                let mut nine = [six[0], six[3], six[4], six[3], six[1], six[5], six[4], six[5], six[2]];
                add_terms(simd, terms(ends[0], ends[1]), &at_nodes[v..], stride, &IN_ORDER, &mut nine);
                add_terms(simd, terms(ends[1], ends[2]), &at_nodes[v..], stride, &TRANSPOSED, &mut nine);
                add_terms(simd, terms(ends[2], ends[3]), &at_nodes[v..], stride, &IN_ORDER, &mut nine);
                add_terms(simd, terms(ends[3], ends[4]), &at_nodes[v..], stride, &TRANSPOSED, &mut nine);
                for k in 0..9 {
                    target[k * stride + v] = nine[k];
                }
            }
            start = ends[4];
        }
    }

    /// Writes both triangles, bit by bit symmetric, from the stiffness of all pairs of vectors in the working memory.
    ///
    /// Column by column: what belongs to a vector l stays in the nearest cache meanwhile. Not part of the vectorised
    /// code, it moves single numbers.
    pub(super) fn write_tangent(&self, scratch: &mut Scratch, tangent: &mut [f64]) {
        let (n, nodes, size) = (self.n_vectors, self.n_nodes, self.size());
        // pairs k >= l of a vector l follow each other; the largest order has 21 vectors
        let mut starts = [0; 21];
        for l in 1..n {
            starts[l] = starts[l - 1] + n + 1 - l;
        }
        let all: &mut [[[f64; NODE_PAIRS]; 9]] =
            cast_slice_mut(scratch.pool.take(STIFFNESS * self.tangent.ends.len()));
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
