//! The internal force: angle by angle strains and moments of stress as polynomials across the wall, forces on the
//! coefficients of F, then on waves, vectors and nodes. Stations lie side by side in the registers throughout.

use crate::element::kernel::pair_stiffness::PAIRS;
use crate::element::kernel::simd::{Scratch, take};
use crate::element::ring::{RingElement, product};
use pulp::Simd;

/// Rows of a law that are multiplied together.
const ROWS: usize = 3;

/// `S : E` of both sides.
#[inline(always)]
fn work<S: Simd>(simd: S, strains: &[[S::f64s; 2]], t: &[[S::f64s; 2]]) -> S::f64s {
    let mut sums = [simd.splat_f64s(0.0); 2];
    for (strain, t) in strains.iter().zip(t) {
        for side in 0..2 {
            sums[side] = simd.mul_add_e_f64s(strain[side], t[side], sums[side]);
        }
    }
    simd.add_f64s(sums[0], sums[1])
}

/// Adds the product `a . b` of both sides.
#[inline(always)]
fn add_dot<S: Simd>(simd: S, a: &[[S::f64s; 2]; 3], b: &[[S::f64s; 2]; 3], sum: &mut [S::f64s; 2]) {
    for i in 0..3 {
        for side in 0..2 {
            sum[side] = simd.mul_add_e_f64s(a[i][side], b[i][side], sum[side]);
        }
    }
}

impl RingElement {
    /// The force of all stations; returns the energy.
    #[inline(always)]
    pub(super) fn add_up<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64 {
        let (n, sets, products) = (self.coefficients(), self.sets(), self.products[6]);
        let mut pool = scratch.take(S::F64_LANES * (3 * 3 * n + 3 * 6 * sets + 2 * 2 * products));
        let [f, rate, sums] = [(); 3].map(|()| take::<[S::f64s; 3]>(&mut pool, n));
        let [at, rate_at, p] = [(); 3].map(|()| take::<[[S::f64s; 2]; 3]>(&mut pool, sets));
        let [strains, t] = [(); 2].map(|()| take::<[S::f64s; 2]>(&mut pool, products));
        let weights = S::as_simd_f64s(&self.stations.weights).0;
        let mut energy = 0.0;
        force.fill(0.0);
        for batch in 0..self.stations.count.div_ceil(S::F64_LANES) {
            self.gradient(simd, q, batch, f);
            if let Some(velocity) = velocity {
                self.gradient(simd, velocity, batch, rate);
            }
            sums.fill([simd.splat_f64s(0.0); 3]);
            let mut density = simd.splat_f64s(0.0);
            for j in 0..self.angles.count {
                self.at_angle(simd, j, f, at);
                self.strains(simd, at, strains);
                if velocity.is_some() {
                    self.at_angle(simd, j, rate, rate_at);
                    self.add_strain_rates(simd, at, rate_at, strains);
                }
                self.stress_moments(simd, strains, t);
                let weight = simd.splat_f64s(self.angles.weight(j));
                density = simd.mul_add_e_f64s(weight, work(simd, strains, t), density);
                self.contract(simd, t, at, p);
                self.add_waves(simd, j, p, sums);
            }
            if velocity.is_none() {
                energy += 0.5 * simd.reduce_sum_f64s(simd.mul_f64s(weights[batch], density));
            }
            self.add_force(simd, sums, batch, force);
        }
        energy
    }

    /// Strains from F: tensor components of equal directions, twice those of different ones.
    #[inline(always)]
    fn strains<S: Simd>(&self, simd: S, f: &[[[S::f64s; 2]; 3]], strains: &mut [[S::f64s; 2]]) {
        let half = simd.splat_f64s(0.5);
        strains.fill([simd.splat_f64s(0.0); 2]);
        for alpha in 0..3 {
            let (f, strains) = (self.column(alpha, f), &mut strains[self.products[alpha]..]);
            for (strain, unit) in strains.iter_mut().zip(&self.directions[alpha].half_square) {
                *strain = [simd.splat_f64s(-unit); 2];
            }
            for (e, a) in f.iter().enumerate() {
                for (other, b) in f[..e].iter().enumerate() {
                    add_dot(simd, a, b, &mut strains[e + other]);
                }
                let mut scaled = *a;
                for side in scaled.iter_mut().flatten() {
                    *side = simd.mul_f64s(half, *side);
                }
                add_dot(simd, &scaled, a, &mut strains[2 * e]);
            }
        }
        for (alpha, beta) in &PAIRS[3..] {
            self.add_products(simd, (*alpha, *beta), f, f, strains);
        }
    }

    /// Adds the products of the columns `a_alpha . b_beta` to those of strains.
    #[inline(always)]
    fn add_products<S: Simd>(
        &self,
        simd: S,
        (alpha, beta): (usize, usize),
        a: &[[[S::f64s; 2]; 3]],
        b: &[[[S::f64s; 2]; 3]],
        strains: &mut [[S::f64s; 2]],
    ) {
        let strains = &mut strains[product(&self.products, alpha, beta)..];
        for (e, a) in self.column(alpha, a).iter().enumerate() {
            for (b, strain) in self.column(beta, b).iter().zip(&mut strains[e..]) {
                add_dot(simd, a, b, strain);
            }
        }
    }

    /// Adds `beta dE/dt` to the strains; multiplies the rates of F by beta.
    #[inline(always)]
    fn add_strain_rates<S: Simd>(
        &self,
        simd: S,
        f: &[[[S::f64s; 2]; 3]],
        rate: &mut [[[S::f64s; 2]; 3]],
        strains: &mut [[S::f64s; 2]],
    ) {
        let viscosity = simd.splat_f64s(self.viscosity);
        for rate in rate.iter_mut().flatten().flatten() {
            *rate = simd.mul_f64s(viscosity, *rate);
        }
        for (alpha, beta) in PAIRS {
            self.add_products(simd, (alpha, beta), f, rate, strains);
            if alpha != beta {
                self.add_products(simd, (alpha, beta), rate, f, strains);
            }
        }
    }

    /// Moments of stress `T_ab[g]`.
    #[inline(always)]
    fn stress_moments<S: Simd>(&self, simd: S, strains: &[[S::f64s; 2]], t: &mut [[S::f64s; 2]]) {
        for (law, [start, end]) in self.law.iter().zip([[0, 3], [3, 4], [4, 5], [5, 6]]) {
            let range = self.products[start]..self.products[end];
            let (strains, t) = (&strains[range.clone()], &mut t[range]);
            let n = strains.len();
            let mut blocks = t.chunks_exact_mut(ROWS);
            let mut rows = law.chunks_exact(ROWS * n);
            for (t, rows) in blocks.by_ref().zip(rows.by_ref()) {
                t.copy_from_slice(&multiply::<S, ROWS>(simd, rows, strains));
            }
            for (t, row) in blocks.into_remainder().iter_mut().zip(rows.remainder().chunks_exact(n)) {
                [*t] = multiply::<S, 1>(simd, row, strains);
            }
        }
    }

    /// Forces `P_a[e] = sum_b sum_f T_ab[e + f] F_b[f]` on the coefficients of F.
    #[inline(always)]
    fn contract<S: Simd>(
        &self,
        simd: S,
        t: &[[S::f64s; 2]],
        f: &[[[S::f64s; 2]; 3]],
        p: &mut [[[S::f64s; 2]; 3]],
    ) {
        for (alpha, d) in self.directions.iter().enumerate() {
            for e in 0..d.count {
                let mut sums = [[simd.splat_f64s(0.0); 2]; 3];
                for beta in 0..3 {
                    let t = &t[product(&self.products, alpha, beta) + e..];
                    for (f, t) in self.column(beta, f).iter().zip(t) {
                        for i in 0..3 {
                            for side in 0..2 {
                                sums[i][side] = simd.mul_add_e_f64s(t[side], f[i][side], sums[i][side]);
                            }
                        }
                    }
                }
                p[d.set + e] = sums;
            }
        }
    }

    /// The transpose of [`Self::at_angle`]: adds forces at theta and -theta to those on waves.
    #[inline(always)]
    fn add_waves<S: Simd>(&self, simd: S, j: usize, p: &[[[S::f64s; 2]; 3]], sums: &mut [[S::f64s; 3]]) {
        let count = self.angles.count;
        let [cos, sin] = [&self.angles.weighted[0][j..], &self.angles.weighted[1][j..]];
        for d in &self.directions {
            let of_d = &mut sums[d.first..d.first + d.count * d.waves()];
            for (sums, p) in of_d.chunks_exact_mut(d.waves()).zip(&p[d.set..d.set + d.count]) {
                let (mut even, mut odd) = ([p[0][0]; 3], [p[0][0]; 3]);
                for i in 0..3 {
                    (even[i], odd[i]) = (simd.add_f64s(p[i][0], p[i][1]), simd.sub_f64s(p[i][0], p[i][1]));
                }
                if d.mirrored < 0.0 {
                    (even, odd) = (odd, even);
                }
                for m in 0..=d.harmonics {
                    let cos = simd.splat_f64s(cos[m * count]);
                    for i in 0..3 {
                        sums[m][i] = simd.mul_add_e_f64s(cos, even[i], sums[m][i]);
                    }
                }
                for m in 1..=d.harmonics {
                    let sin = simd.splat_f64s(sin[m * count]);
                    let sum = &mut sums[d.harmonics + m];
                    for i in 0..3 {
                        sum[i] = simd.mul_add_e_f64s(sin, odd[i], sum[i]);
                    }
                }
            }
        }
    }

    /// Adds what forces on the coefficients of F do on the coordinates.
    #[inline(always)]
    fn add_force<S: Simd>(&self, simd: S, p: &[[S::f64s; 3]], batch: usize, force: &mut [f64]) {
        for (k, roles) in self.vectors.iter().enumerate() {
            let (mut on_slope, mut on_value) = ([simd.splat_f64s(0.0); 3], [simd.splat_f64s(0.0); 3]);
            for alpha in 0..3 {
                let d = &self.directions[alpha];
                let on = if alpha == 0 { &mut on_slope } else { &mut on_value };
                for role in &roles[alpha] {
                    let p = &p[d.first + d.waves() * role.power + role.wave];
                    let factor = simd.splat_f64s(role.factor);
                    for i in 0..3 {
                        on[i] = simd.mul_add_e_f64s(factor, p[i], on[i]);
                    }
                }
            }
            self.stations.add_force(simd, [on_value, on_slope], (k, self.n_vectors), batch, force);
        }
    }
}

/// R rows of a law times the strains.
#[inline(always)]
fn multiply<S: Simd, const R: usize>(simd: S, rows: &[f64], strains: &[[S::f64s; 2]]) -> [[S::f64s; 2]; R] {
    let mut sums = [[simd.splat_f64s(0.0); 2]; R];
    for (h, strain) in strains.iter().enumerate() {
        for r in 0..R {
            let modulus = simd.splat_f64s(rows[r * strains.len() + h]);
            for side in 0..2 {
                sums[r][side] = simd.mul_add_e_f64s(modulus, strain[side], sums[r][side]);
            }
        }
    }
    sums
}
