//! The tangent: moments `A_ab,ij[g]` at the stations, their integrals along the axis for every pair of nodes, and
//! from them the stiffness of every pair of vectors.
//!
//! It goes class by class of monomials, so that the moments at the stations stay in the nearest cache. Stations lie
//! side by side in the vector registers until the axis is integrated, pairs of nodes from then on.
//!
//! # The layout in a picture
//!
//! Example: 34X2, which has six vectors a node. F_x has six coefficients, F_y and F_z have three each. They stand one after
//! the other for each batch of stations, three components i to each, a register of stations to each component:
//!
//! ```text
//! f     0   1   2   3   4   5 | 6   7   8 | 9   10  11 | 12 ...
//!       F_x                   | F_y       | F_z        | F_x of the next batch of stations
//!       1   y   z   yz  yy  zz  1   y   z   1   y   z
//! ```
//!
//! A class holds the monomials up to degree 4 of equal parities, ascending in degree. Class 0 of 34X2 is
//!
//! ```text
//! g         0     1     2     3     4     5
//!           1     yy    zz    yyzz  yyyy  zzzz         in the order of `exponents`
//!           |-----------|                              counts[0] = 3: up to degree 2, for 11, 22 and 12
//!           |-----------|                              counts[1] = 3: up to degree 3, for x1 and x2
//!           |----------------------------------|       counts[2] = 6: up to degree 4, for xx
//! ```
//!
//! `Products` lists which coefficients multiply to a monomial. For g = 1, which is yy:
//!
//! ```text
//! squares[0] of F_x    (0, 4)             once for both orders, 1 times yy;  roots[1] = 1, y times y
//! products[0] x1       (1, 1), (4, 0)     y of F_x times y of F_y, yy of F_x times 1 of F_y
//! starts               where the pairs of each g begin: those of g are pairs[starts[g] .. starts[g + 1]]
//! ```
//!
//! The integrands of a class are `[g][component]`, six components (00 11 22 01 02 12) of equal directions and nine by rows of
//! different ones. Integrated over the section they become list c of `Expansion`, whose picture goes on from there: the
//! moment of g = 1 in xx starts at place `first[0] + 6`, in x1 at `first[3] + 9`.

use crate::element::kernel::pair_stiffness::{Expansion, PAIRS, TRANSPOSED, Term, place};
use crate::element::kernel::simd::{Scratch, take};
use crate::element::kernel::stations::Stations;
use crate::element::polynomial::section_polynomials::{Class, IN_ORDER, count};
use crate::element::polynomial::{DEGREE, NonlinearElement, Roles};
use crate::section::basis::exponents;
use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

/// Vectors of working memory for each monomial of a class: squares, strains and an integrand.
const WORK: usize = 18 + 3 + 9;
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
}

impl ClassTables {
    fn new(class: &Class, g: &[(usize, usize)], list: &[(usize, usize)], (x, y): (usize, usize)) -> Self {
        let [low, mid, all] = class.counts;
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
        }
    }
}

/// Tables of the tangent.
#[derive(Debug, Clone)]
pub(super) struct PolynomialTables {
    classes: [ClassTables; 4],
    pub expansion: Expansion,
}

impl PolynomialTables {
    /// Tables for the classes of an order and what the vectors of a node do.
    pub fn new(order: usize, classes: &[Class; 4], vectors: &[Roles], stations: &Stations) -> Self {
        let list = exponents(2 * order);
        let fields = (count(order), count(order - 1));
        let parities = |[k, l]: [usize; 2]| {
            let [a, b] = [list[k].0 + list[l].0, list[k].1 + list[l].1];
            2 * (a % 2) + b % 2
        };
        let terms = |[k, l]: [usize; 2], (alpha, beta): (usize, usize)| {
            let (Some((e, left)), Some((f, right))) = (vectors[k][alpha], vectors[l][beta]) else {
                return Vec::new();
            };
            let g = (list[e].0 + list[f].0, list[e].1 + list[f].1);
            let found = classes
                .iter()
                .enumerate()
                .find_map(|(batch, class)| Some((batch, class.monomials.iter().position(|m| *m == g)?)));
            found.into_iter().map(|(batch, at)| Term { batch, at, factor: left * right }).collect()
        };
        Self {
            classes: classes.each_ref().map(|class| ClassTables::new(class, &class.monomials, &list, fields)),
            expansion: Expansion::new(
                stations,
                vectors.len(),
                &classes.each_ref().map(|class| DEGREE.map(|degree| class.counts[degree])),
                parities,
                terms,
            ),
        }
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

impl NonlinearElement {
    /// The stiffness of all pairs of vectors into the working memory.
    #[inline(always)]
    pub(super) fn pair_stiffness<S: Simd>(&self, simd: S, q: &[f64], geometric: bool, scratch: &mut Scratch) {
        let expansion = &self.tangent.expansion;
        let of_class = expansion.batches.iter().map(|batch| batch.length()).max().unwrap_or(0);
        let batches = self.stations.count.div_ceil(S::F64_LANES);
        let (monomials, largest) = (self.fields.iter().sum::<usize>(), self.classes[0].places.len());
        let vectors = batches * (3 * monomials + of_class) + WORK * largest;
        let stiffness = expansion.stiffness_size();
        let mut pool = scratch.take(stiffness + expansion.at_nodes() + S::F64_LANES * vectors);
        let stiffness = take::<S::f64s>(&mut pool, stiffness / S::F64_LANES);
        let at_nodes = take::<f64>(&mut pool, expansion.at_nodes());
        let f = take::<[S::f64s; 3]>(&mut pool, batches * monomials);
        let at_stations = take::<S::f64s>(&mut pool, batches * of_class);
        for (batch, f) in f.chunks_exact_mut(monomials).enumerate() {
            self.gradient(simd, q, batch, f);
        }
        for c in 0..4 {
            let length = expansion.batches[c].length();
            let stations = f.chunks_exact(monomials).zip(at_stations.chunks_exact_mut(length));
            for (batch, (f, moments)) in stations.enumerate() {
                self.tangent_moments(simd, (c, batch), self.columns(f), geometric, pool, moments);
            }
            expansion.along_axis(simd, c, cast_slice(at_stations), at_nodes);
        }
        expansion.stiffness(simd, cast_slice(at_nodes), stiffness);
    }

    /// Moments `A_ab,ij` of a class at a batch of stations.
    #[inline(always)]
    fn tangent_moments<S: Simd>(
        &self,
        simd: S,
        (c, batch): (usize, usize),
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
            self.normal_moments(simd, (c, batch, alpha), squares, stress, pool, moments);
        }
        for pair in 3..6 {
            self.shear_moments(simd, (c, batch, pair), f, geometric, pool, moments);
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
        (c, batch, alpha): (usize, usize, usize),
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
        let first = self.tangent.expansion.batches[c].first[alpha];
        let moments: &mut [[S::f64s; 6]] = cast_slice_mut(&mut moments[first..][..6 * rows]);
        class.integrate::<S, 0, 3, 6>(simd, batch, (0..rows, all), integrand, moments, &IN_ORDER);
        class.integrate::<S, 3, 3, 6>(simd, batch, (0..rows, all), integrand, moments, &IN_ORDER);
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
        (c, batch, pair): (usize, usize, usize),
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
        let first = self.tangent.expansion.batches[c].first[pair];
        let moments: &mut [[S::f64s; 9]] = cast_slice_mut(&mut moments[first..][..9 * count]);
        class.integrate::<S, 0, 3, 9>(simd, batch, (0..count, count), integrand, moments, &IN_ORDER);
        class.integrate::<S, 3, 3, 9>(simd, batch, (0..count, count), integrand, moments, &IN_ORDER);
        class.integrate::<S, 6, 3, 9>(simd, batch, (0..count, count), integrand, moments, &IN_ORDER);
        if c == 0
            && let Some(law) = self.law.on_axis
        {
            let factor = simd.splat_f64s(self.area * law[alpha][beta]);
            for (k, moment) in moments[0].iter_mut().enumerate() {
                *moment = simd.mul_add_e_f64s(factor, simd.mul_f64s(a[0][k / 3], b[0][k % 3]), *moment);
            }
        }
    }
}
