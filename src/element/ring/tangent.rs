//! The tangent: moments `A_ab,ij[g]` of the moduli at every angle, their waves around the section, and from these
//! the stiffness of every pair of vectors.
//!
//! Mirrored, a modulus has at -theta the sign of its directions. Its cosines meet sums of both sides, its sines
//! differences; what a pair of vectors needs are the waves of the difference and of the sum of their own.
//!
//! # The layout in a picture
//!
//! Example: 34R12 on a circle (degree 1, harmonics 2). Along x, rho and theta the columns of F have 2, 1 and 2 powers of s and
//! two harmonics each. So a product of x and x has 2 + 2 - 1 = 3 powers and four harmonics. At an angle the moduli are
//!
//! ```text
//! entry   0        18       24       42       60       87       105
//!         | xx     | 11     | 22     | x1     | x2     | 12     |       = entries[0 ..= 6]
//!         | 3 x 6  | 1 x 6  | 3 x 6  | 2 x 9  | 3 x 9  | 2 x 9  |         powers of s x components
//!
//! xx      0                   6                   12                  18
//!         | s^0               | s^1               | s^2               |   00 11 22 01 02 12 each
//!
//! array   [angle][entry][side], five angles 0 .. pi: number ((j * 105) + entry) * 2 + side, each a register of stations
//!         side 0 meets cosines, side 1 sines
//! ```
//!
//! The angles are then turned into waves. In the list of `Expansion` the component runs fastest, then the power of s, then the
//! wave, cosines 0 .. 4 before sines 1 .. 4:
//!
//! ```text
//! place   0      162    216    378    540    702    945  948
//!         | xx   | 11   | 22   | 12   | x1   | x2   | -  |          = first of the pairs; three places fill a block
//!         | 9x18 | 9x6  | 9x18 | 9x18 | 9x18 | 9x27 | 3  |            waves x entries
//!
//! xx      0       18      36      54      72      90      108     126     144     162
//!         | cos 0 | cos 1 | cos 2 | cos 3 | cos 4 | sin 1 | sin 2 | sin 3 | sin 4 |
//! ```
//!
//! So s^1 of sin 2 in xx is moment `at = 6 * 3 + 1 = 19` of its pair and starts at place `6 * 19 = 114`. Example of a term: two
//! vectors that enter F_x with s^0 cos theta and s^1 sin theta need `sin 2 theta / 2` (the sine of the difference vanishes), which
//! is this moment with the factor 1/2.

use crate::element::kernel::pair_stiffness::{Expansion, PAIRS, TRANSPOSED, Term, components, place};
use crate::element::kernel::simd::{Scratch, take};
use crate::element::kernel::stations::Stations;
use crate::element::ring::{Direction, RingElement, Role};
use pulp::Simd;
use pulp::bytemuck::cast_slice;

/// Entries of the moduli that are turned to waves together.
const ENTRIES: usize = 3;

/// Tables of the tangent.
#[derive(Debug, Clone)]
pub(super) struct RingTables {
    /// First entry of the moduli of each pair of directions at an angle, and the end of the last.
    entries: [usize; 7],
    pub expansion: Expansion,
}

impl RingTables {
    /// Tables for what the vectors of a node do to the columns.
    pub fn new(vectors: &[[Vec<Role>; 3]], directions: &[Direction; 3], stations: &Stations) -> Self {
        let length = |p: usize| directions[PAIRS[p].0].count + directions[PAIRS[p].1].count - 1;
        let harmonics = |p: usize| directions[PAIRS[p].0].harmonics + directions[PAIRS[p].1].harmonics;
        let mut entries = [0; 7];
        for p in 0..6 {
            entries[p + 1] = entries[p] + components(p) * length(p);
        }
        // by the waves of the displacement
        let waves = |pair: [usize; 2]| {
            let [(m, a), (n, b)] = pair.map(|k| number(&directions[0], vectors[k][0][0].wave));
            let (lower, upper) = (m.min(n), m.max(n));
            2 * ((directions[0].harmonics + 1) * upper + lower) + usize::from(a != b)
        };
        let terms = |[k, l]: [usize; 2], (alpha, beta): (usize, usize)| {
            let p = place(alpha, beta);
            let mut terms: Vec<Term> = Vec::new();
            for left in &vectors[k][alpha] {
                for right in &vectors[l][beta] {
                    let waves =
                        [(left.wave, alpha), (right.wave, beta)].map(|(t, a)| number(&directions[a], t));
                    for (factor, number, sine) in products(waves) {
                        let wave = if sine { harmonics(p) + number } else { number };
                        let at = wave * length(p) + left.power + right.power;
                        let factor = left.factor * right.factor * factor;
                        match terms.iter_mut().find(|term| term.at == at) {
                            Some(term) => term.factor += factor,
                            None => terms.push(Term { batch: 0, at, factor }),
                        }
                    }
                }
            }
            terms.retain(|term| term.factor != 0.0);
            terms
        };
        let counts = [0, 1, 2, 3, 4, 5].map(|p| (2 * harmonics(p) + 1) * length(p));
        Self { entries, expansion: Expansion::new(stations, vectors.len(), &[counts], waves, terms) }
    }
}

/// Number of a wave of a direction, and true for a sine.
fn number(d: &Direction, wave: usize) -> (usize, bool) {
    if wave > d.harmonics { (wave - d.harmonics, true) } else { (wave, false) }
}

/// Product of two waves as a sum of waves: `(factor, number, sine)`.
fn products([(m, first), (n, second)]: [(usize, bool); 2]) -> Vec<(f64, usize, bool)> {
    let (sum, difference) = (m + n, m.abs_diff(n));
    let sign = |positive: bool| if positive { 0.5 } else { -0.5 };
    let list = match (first, second) {
        (false, false) => [(0.5, difference, false), (0.5, sum, false)],
        (true, true) => [(0.5, difference, false), (-0.5, sum, false)],
        (true, false) => [(sign(m > n), difference, true), (0.5, sum, true)],
        (false, true) => [(sign(n > m), difference, true), (0.5, sum, true)],
    };
    list.into_iter().filter(|(_, number, sine)| *number > 0 || !sine).collect()
}

impl RingElement {
    /// The stiffness of all pairs of vectors into the working memory.
    #[inline(always)]
    pub(super) fn pair_stiffness<S: Simd>(&self, simd: S, q: &[f64], geometric: bool, scratch: &mut Scratch) {
        let RingTables { entries, expansion } = &self.tangent;
        let (length, angles, n) = (expansion.batches[0].length(), self.angles.count, self.coefficients());
        let batches = self.stations.count.div_ceil(S::F64_LANES);
        let normal = self.products[3];
        let vectors =
            batches * length + 3 * n + 6 * self.sets() + (2 * 12 + 18) * normal + 2 * angles * entries[6];
        let mut pool =
            scratch.take(expansion.stiffness_size() + expansion.at_nodes() + S::F64_LANES * vectors);
        let stiffness = take::<S::f64s>(&mut pool, expansion.stiffness_size() / S::F64_LANES);
        let at_nodes = take::<f64>(&mut pool, expansion.at_nodes());
        let at_stations = take::<S::f64s>(&mut pool, batches * length);
        let f = take::<[S::f64s; 3]>(&mut pool, n);
        let at = take::<[[S::f64s; 2]; 3]>(&mut pool, self.sets());
        let [squares, integrands] = [(); 2].map(|()| take::<[[S::f64s; 2]; 6]>(&mut pool, normal));
        let products = take::<[[S::f64s; 2]; 9]>(&mut pool, normal);
        let moduli = take::<[S::f64s; 2]>(&mut pool, angles * entries[6]);
        for (batch, moments) in at_stations.chunks_exact_mut(length).enumerate() {
            self.gradient(simd, q, batch, f);
            for (j, moduli) in moduli.chunks_exact_mut(entries[6]).enumerate() {
                self.at_angle(simd, j, f, at);
                self.squares(simd, at, squares);
                for p in 0..3 {
                    self.normal_moduli(simd, p, squares, integrands, geometric, moduli);
                }
                for p in 3..6 {
                    self.shear_moduli(simd, p, at, products, geometric, moduli);
                }
            }
            for p in 0..6 {
                self.waves_of_moduli(simd, p, moduli, moments);
            }
        }
        expansion.along_axis(simd, 0, cast_slice(at_stations), at_nodes);
        expansion.stiffness(simd, cast_slice(at_nodes), stiffness);
    }

    /// Products `F_ai F_aj`, by the six components ij = 00 11 22 01 02 12, of the three columns.
    #[inline(always)]
    fn squares<S: Simd>(&self, simd: S, f: &[[[S::f64s; 2]; 3]], squares: &mut [[[S::f64s; 2]; 6]]) {
        squares.fill([[simd.splat_f64s(0.0); 2]; 6]);
        for alpha in 0..3 {
            let (f, squares) = (self.column(alpha, f), &mut squares[self.products[alpha]..]);
            for (e, a) in f.iter().enumerate() {
                for (b, square) in f.iter().zip(&mut squares[e..]) {
                    for (square, (i, j)) in square.iter_mut().zip(PAIRS) {
                        for side in 0..2 {
                            square[side] = simd.mul_add_e_f64s(a[i][side], b[j][side], square[side]);
                        }
                    }
                }
            }
        }
    }

    /// Moments of `A_aa,ij`, with stress if `geometric`.
    #[inline(always)]
    fn normal_moduli<S: Simd>(
        &self,
        simd: S,
        p: usize,
        squares: &[[[S::f64s; 2]; 6]],
        integrands: &mut [[[S::f64s; 2]; 6]],
        geometric: bool,
        moduli: &mut [[S::f64s; 2]],
    ) {
        let half = simd.splat_f64s(0.5);
        for q in 0..3 {
            let (start, end) = (self.products[q], self.products[q + 1]);
            let [of_stress, of_square] = match p == q {
                true => [self.lambda + 2.0 * self.mu; 2],
                false => [self.lambda, self.mu],
            };
            let [of_stress, of_square] = [simd.splat_f64s(of_stress), simd.splat_f64s(of_square)];
            let units = &self.directions[q].half_square;
            for (g, (square, integrand)) in
                squares[start..end].iter().zip(&mut integrands[start..end]).enumerate()
            {
                for side in 0..2 {
                    let mut stress = simd.splat_f64s(0.0);
                    if geometric {
                        let trace =
                            simd.add_f64s(simd.add_f64s(square[0][side], square[1][side]), square[2][side]);
                        let unit = simd.splat_f64s(if g < units.len() { -units[g] } else { 0.0 });
                        stress = simd.mul_f64s(of_stress, simd.mul_add_e_f64s(half, trace, unit));
                    }
                    for k in 0..3 {
                        integrand[k][side] = simd.mul_add_e_f64s(of_square, square[k][side], stress);
                        integrand[3 + k][side] = simd.mul_f64s(of_square, square[3 + k][side]);
                    }
                }
            }
        }
        let over = self.over(p);
        for g in 0..self.products[p + 1] - self.products[p] {
            let mut sums = [[simd.splat_f64s(0.0); 2]; 6];
            for q in 0..3 {
                let integrands = &integrands[self.products[q]..self.products[q + 1]];
                let moments = &self.moments[over + self.over(q)][g..];
                for (integrand, moment) in integrands.iter().zip(moments) {
                    let moment = simd.splat_f64s(*moment);
                    for k in 0..6 {
                        for side in 0..2 {
                            sums[k][side] = simd.mul_add_e_f64s(moment, integrand[k][side], sums[k][side]);
                        }
                    }
                }
            }
            let target = &mut moduli[self.tangent.entries[p] + 6 * g..][..6];
            for k in 0..6 {
                target[k] = folded(simd, sums[k], false);
            }
        }
    }

    /// Moments of `A_ab,ij` of different directions, ij by rows.
    #[inline(always)]
    fn shear_moduli<S: Simd>(
        &self,
        simd: S,
        p: usize,
        f: &[[[S::f64s; 2]; 3]],
        integrands: &mut [[[S::f64s; 2]; 9]],
        geometric: bool,
        moduli: &mut [[S::f64s; 2]],
    ) {
        let (alpha, beta) = PAIRS[p];
        let integrands = &mut integrands[..self.products[p + 1] - self.products[p]];
        integrands.fill([[simd.splat_f64s(0.0); 2]; 9]);
        for (e, a) in self.column(alpha, f).iter().enumerate() {
            for (b, product) in self.column(beta, f).iter().zip(&mut integrands[e..]) {
                for i in 0..3 {
                    for j in 0..3 {
                        for side in 0..2 {
                            let sum = product[3 * i + j][side];
                            product[3 * i + j][side] = simd.mul_add_e_f64s(a[i][side], b[j][side], sum);
                        }
                    }
                }
            }
        }
        let (lambda, mu) = (simd.splat_f64s(self.lambda), simd.splat_f64s(self.mu));
        for integrand in integrands.iter_mut() {
            let m = *integrand;
            for side in 0..2 {
                for k in 0..9 {
                    let exchanged = simd.mul_f64s(mu, m[TRANSPOSED[k]][side]);
                    integrand[k][side] = simd.mul_add_e_f64s(lambda, m[k][side], exchanged);
                }
                if geometric {
                    let trace = simd.add_f64s(simd.add_f64s(m[0][side], m[4][side]), m[8][side]);
                    for k in [0, 4, 8] {
                        integrand[k][side] = simd.mul_add_e_f64s(mu, trace, integrand[k][side]);
                    }
                }
            }
        }
        let moments = &self.moments[2 * self.over(p)];
        let mirrored = self.directions[alpha].mirrored * self.directions[beta].mirrored < 0.0;
        for g in 0..integrands.len() {
            let target = &mut moduli[self.tangent.entries[p] + 9 * g..][..9];
            for i in 0..3 {
                let mut sums = [[simd.splat_f64s(0.0); 2]; 3];
                for (integrand, moment) in integrands.iter().zip(&moments[g..]) {
                    let moment = simd.splat_f64s(*moment);
                    for j in 0..3 {
                        for side in 0..2 {
                            sums[j][side] =
                                simd.mul_add_e_f64s(moment, integrand[3 * i + j][side], sums[j][side]);
                        }
                    }
                }
                for j in 0..3 {
                    target[3 * i + j] = folded(simd, sums[j], mirrored);
                }
            }
        }
    }

    /// Powers of rho below a product of two columns.
    #[inline(always)]
    fn over(&self, p: usize) -> usize {
        let (alpha, beta) = PAIRS[p];
        self.directions[alpha].over + self.directions[beta].over
    }

    /// Waves of the moduli of a pair of directions: integrals around the section of their products with cosines,
    /// then sines.
    #[inline(always)]
    fn waves_of_moduli<S: Simd>(&self, simd: S, p: usize, moduli: &[[S::f64s; 2]], moments: &mut [S::f64s]) {
        let (alpha, beta) = PAIRS[p];
        let harmonics = self.directions[alpha].harmonics + self.directions[beta].harmonics;
        let RingTables { entries, expansion } = &self.tangent;
        let (first, stride) = (entries[p], entries[6]);
        let length = entries[p + 1] - first;
        let moments = &mut moments[expansion.batches[0].first[p]..][..(2 * harmonics + 1) * length];
        for entry in (0..length).step_by(ENTRIES) {
            let moduli = &moduli[first + entry..];
            for (parity, range) in [0..harmonics + 1, 1..harmonics + 1].into_iter().enumerate() {
                let count = self.angles.count;
                let table = &self.angles.weighted[parity][range.start * count..range.end * count];
                let target = &mut moments[parity * (harmonics + 1) * length + entry..];
                let (mut w, waves) = (0, range.len());
                while w < waves {
                    let table = &table[w * count..];
                    let target = &mut target[w * length..];
                    w += match waves - w {
                        1 => transform::<S, 1>(simd, table, moduli, (stride, length, count, parity), target),
                        2 => transform::<S, 2>(simd, table, moduli, (stride, length, count, parity), target),
                        3 => transform::<S, 3>(simd, table, moduli, (stride, length, count, parity), target),
                        _ => transform::<S, 4>(simd, table, moduli, (stride, length, count, parity), target),
                    };
                }
            }
        }
    }
}

/// W waves of some entries: `target[w * length + e] = sum_j table[w][j] moduli[j * stride + e][parity]`; returns W.
#[inline(always)]
fn transform<S: Simd, const W: usize>(
    simd: S,
    table: &[f64],
    moduli: &[[S::f64s; 2]],
    (stride, length, count, parity): (usize, usize, usize, usize),
    target: &mut [S::f64s],
) -> usize {
    let mut sums = [[simd.splat_f64s(0.0); ENTRIES]; W];
    for j in 0..count {
        let moduli = &moduli[j * stride..][..ENTRIES];
        for w in 0..W {
            let factor = simd.splat_f64s(table[w * count + j]);
            for e in 0..ENTRIES {
                sums[w][e] = simd.mul_add_e_f64s(factor, moduli[e][parity], sums[w][e]);
            }
        }
    }
    for w in 0..W {
        target[w * length..][..ENTRIES].copy_from_slice(&sums[w]);
    }
    W
}

/// What meets cosines and what meets sines of the values at theta and, mirrored, at -theta.
#[inline(always)]
fn folded<S: Simd>(simd: S, value: [S::f64s; 2], mirrored: bool) -> [S::f64s; 2] {
    let (sum, difference) = (simd.add_f64s(value[0], value[1]), simd.sub_f64s(value[0], value[1]));
    if mirrored { [difference, sum] } else { [sum, difference] }
}
