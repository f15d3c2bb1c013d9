//! Polynomials in the section: where their monomials lie, their products and their moments.
//!
//! The monomial `eta^a zeta^b` lies at `(2 n + 1) a + b` of a grid, n the order of the section: the place of a
//! product is the sum of the places of its factors, no table is needed. Moments `H[g,h] = int g h dA` vanish unless
//! g and h agree in the parities of a and of b: H is four dense blocks, one for each class of parities.
//!
//! Sums are taken for three rows and up to three columns at once: nine independent chains hide the latency of the
//! multiply-add units, every operand serves three times, and all fits 16 registers.

use crate::section::basis::exponents;
use pulp::Simd;
use std::ops::Range;

/// Number of monomials up to a total degree.
pub(super) fn count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Place of a monomial on the grid.
pub(super) fn place_on_grid(order: usize, (a, b): (usize, usize)) -> usize {
    (2 * order + 1) * a + b
}

/// Places of monomials that lie one after the other. The largest class, of order 5, has 21.
pub(super) const IN_ORDER: [usize; 21] = {
    let mut list = [0; 21];
    let mut g = 0;
    while g < list.len() {
        list[g] = g;
        g += 1;
    }
    list
};

/// Section moments `H[g,h]` of a class, m^2.
#[derive(Debug, Clone)]
enum Moments {
    /// The same at all stations, by rows.
    Same(Vec<f64>),
    /// Those of a taper, `[(g * columns + h) * padded + station]`.
    Tapered { values: Vec<f64>, padded: usize },
}

/// The monomials up to degree 2 n of one class of parities, ascending in degree.
#[derive(Debug, Clone)]
pub(super) struct Class {
    /// Exponents of eta and zeta.
    pub monomials: Vec<(usize, usize)>,
    /// Places on the grid.
    pub places: Vec<usize>,
    /// Number of monomials up to the degrees 2 n - 2, 2 n - 1 and 2 n.
    pub counts: [usize; 3],
    moments: Moments,
}

impl Class {
    /// The four classes; the one of the constant monomial comes first. `moment(a, b)` is `int eta^a zeta^b dA`.
    pub fn all(order: usize, moment: impl Fn(usize, usize) -> f64) -> [Self; 4] {
        Self::with(order, |products| Moments::Same(products.iter().map(|&(a, b)| moment(a, b)).collect()))
    }

    /// The classes of a taper; `moment(station, a, b)` is `int eta^a zeta^b dA` at a station.
    pub fn along(
        order: usize,
        (count, padded): (usize, usize),
        moment: impl Fn(usize, usize, usize) -> f64,
    ) -> [Self; 4] {
        Self::with(order, |products| {
            let at = |&(a, b): &(usize, usize)| {
                let moment = &moment;
                (0..padded).map(move |s| if s < count { moment(s, a, b) } else { 0.0 })
            };
            Moments::Tapered { values: products.iter().flat_map(at).collect(), padded }
        })
    }

    /// The classes with moments of the exponents of all products `g h`, by rows.
    fn with(order: usize, moments: impl Fn(&[(usize, usize)]) -> Moments) -> [Self; 4] {
        [(0, 0), (1, 1), (1, 0), (0, 1)].map(|parities| {
            let mut list = exponents(2 * order);
            list.retain(|&(a, b)| (a % 2, b % 2) == parities);
            let row = |g: &(usize, usize)| list.iter().map(|h| (g.0 + h.0, g.1 + h.1)).collect::<Vec<_>>();
            Self {
                places: list.iter().map(|&g| place_on_grid(order, g)).collect(),
                counts: [2, 1, 0].map(|less| list.iter().filter(|(a, b)| a + b + less <= 2 * order).count()),
                moments: moments(&list.iter().flat_map(row).collect::<Vec<_>>()),
                monomials: list,
            }
        })
    }

    /// `m[at[g]][k] = sum_h H[g,h] p[h][k]` at a batch of stations, for g in `rows`, h below `columns`, k in `FROM .. FROM + K`.
    #[inline(always)]
    pub fn integrate<S: Simd, const FROM: usize, const K: usize, const N: usize>(
        &self,
        simd: S,
        batch: usize,
        (rows, columns): (Range<usize>, usize),
        p: &[[S::f64s; N]],
        m: &mut [[S::f64s; N]],
        at: &[usize],
    ) {
        let mut g = rows.start;
        while g + 3 <= rows.end {
            let sums = self.rows::<S, FROM, K, N, 3>(simd, batch, g, &p[..columns]);
            for r in 0..3 {
                m[at[g + r]][FROM..FROM + K].copy_from_slice(&sums[r]);
            }
            g += 3;
        }
        while g < rows.end {
            let [sum] = self.rows::<S, FROM, K, N, 1>(simd, batch, g, &p[..columns]);
            m[at[g]][FROM..FROM + K].copy_from_slice(&sum);
            g += 1;
        }
    }

    /// `sum_h H[g,h] p[h]` for R rows from g on.
    #[inline(always)]
    fn rows<S: Simd, const FROM: usize, const K: usize, const N: usize, const R: usize>(
        &self,
        simd: S,
        batch: usize,
        g: usize,
        p: &[[S::f64s; N]],
    ) -> [[S::f64s; K]; R] {
        let mut sums = [[simd.splat_f64s(0.0); K]; R];
        let moments = match &self.moments {
            Moments::Same(moments) => moments,
            Moments::Tapered { values, padded } => {
                let (width, values) = (padded / S::F64_LANES, S::as_simd_f64s(values).0);
                for (h, p) in p.iter().enumerate() {
                    for (r, sums) in sums.iter_mut().enumerate() {
                        let moment = values[((g + r) * self.places.len() + h) * width + batch];
                        for k in 0..K {
                            sums[k] = simd.mul_add_e_f64s(moment, p[FROM + k], sums[k]);
                        }
                    }
                }
                return sums;
            }
        };
        let mut rows = [&moments[..0]; R];
        for (r, row) in rows.iter_mut().enumerate() {
            *row = &moments[(g + r) * self.places.len()..][..p.len()];
        }
        for (h, p) in p.iter().enumerate() {
            for r in 0..R {
                let moment = simd.splat_f64s(rows[r][h]);
                for k in 0..K {
                    sums[r][k] = simd.mul_add_e_f64s(moment, p[FROM + k], sums[r][k]);
                }
            }
        }
        sums
    }
}

/// Adds the products `a[e] . b[f]` to component k of the polynomial c on the grid.
#[inline(always)]
pub(super) fn add_products<S: Simd>(
    simd: S,
    places: &[usize],
    a: &[[S::f64s; 3]],
    b: &[[S::f64s; 3]],
    c: &mut [[S::f64s; 6]],
    k: usize,
) {
    for (a, &e) in a.iter().zip(places) {
        add_multiples(simd, places, a, b, &mut c[e..], k);
    }
}

/// Adds half the square `a . a` to component k of the polynomial c on the grid.
#[inline(always)]
pub(super) fn add_half_square<S: Simd>(
    simd: S,
    places: &[usize],
    a: &[[S::f64s; 3]],
    c: &mut [[S::f64s; 6]],
    k: usize,
) {
    let half = simd.splat_f64s(0.5);
    for (n, (v, &e)) in a.iter().zip(places).enumerate() {
        let c = &mut c[e..];
        for i in 0..3 {
            c[e][k] = simd.mul_add_e_f64s(simd.mul_f64s(half, v[i]), v[i], c[e][k]);
        }
        add_multiples(simd, &places[n + 1..], v, &a[n + 1..], c, k);
    }
}

/// Adds `a . b[f]` to component k of c at the places f.
#[inline(always)]
fn add_multiples<S: Simd>(
    simd: S,
    places: &[usize],
    a: &[S::f64s; 3],
    b: &[[S::f64s; 3]],
    c: &mut [[S::f64s; 6]],
    k: usize,
) {
    for (b, &f) in b.iter().zip(places) {
        let mut sum = c[f][k];
        for i in 0..3 {
            sum = simd.mul_add_e_f64s(a[i], b[i], sum);
        }
        c[f][k] = sum;
    }
}

/// `p[e] = sum_b sum_f t[e + f][pairs[b]] F_b[f]` for the places e of all p.
#[inline(always)]
pub(super) fn contract<S: Simd>(
    simd: S,
    places: &[usize],
    (t, pairs): (&[[S::f64s; 6]], [usize; 3]),
    fields: [&[[S::f64s; 3]]; 3],
    p: &mut [[S::f64s; 3]],
) {
    let places_of_p = &places[..p.len()];
    let mut blocks = p.chunks_exact_mut(3);
    for (p, e) in blocks.by_ref().zip(places_of_p.chunks_exact(3)) {
        p.copy_from_slice(&contract_rows::<S, 3>(simd, places, e, (t, pairs), fields));
    }
    let rest = places_of_p.len() / 3 * 3;
    for (p, e) in blocks.into_remainder().iter_mut().zip(&places_of_p[rest..]) {
        [*p] = contract_rows::<S, 1>(simd, places, &[*e], (t, pairs), fields);
    }
}

#[inline(always)]
fn contract_rows<S: Simd, const R: usize>(
    simd: S,
    places: &[usize],
    e: &[usize],
    (t, pairs): (&[[S::f64s; 6]], [usize; 3]),
    fields: [&[[S::f64s; 3]]; 3],
) -> [[S::f64s; 3]; R] {
    // the last place of a field, eta^n, is in the middle of the grid
    let span = t.len() / 2 + 1;
    let mut windows = [&t[..0]; R];
    for (window, &e) in windows.iter_mut().zip(e) {
        *window = &t[e..e + span];
    }
    let mut sums = [[simd.splat_f64s(0.0); 3]; R];
    for (field, pair) in fields.into_iter().zip(pairs) {
        for (f, &at) in field.iter().zip(places) {
            for r in 0..R {
                let t = windows[r][at][pair];
                for i in 0..3 {
                    sums[r][i] = simd.mul_add_e_f64s(t, f[i], sums[r][i]);
                }
            }
        }
    }
    sums
}
