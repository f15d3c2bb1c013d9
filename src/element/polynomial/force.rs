//! The internal force: strains and stresses as polynomials, section moments of stress, forces on the coefficients
//! of F, forces on the coordinates. Stations lie side by side in the vector registers throughout.

use crate::element::kernel::pair_stiffness::{PAIRS, place};
use crate::element::kernel::simd::{Scratch, take};
use crate::element::polynomial::section_polynomials::{add_half_square, add_products, contract};
use crate::element::polynomial::{DEGREE, NonlinearElement};
use pulp::Simd;

impl NonlinearElement {
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
        let monomials: usize = self.fields.iter().sum();
        let (grid, largest) = (self.grid, self.classes[0].places.len());
        let mut pool = scratch.take(S::F64_LANES * (3 * 3 * monomials + 2 * 6 * grid + 6 * largest));
        let [f, rate, p] = [(); 3].map(|()| take::<[S::f64s; 3]>(&mut pool, monomials));
        let [strains, t] = [(); 2].map(|()| take::<[S::f64s; 6]>(&mut pool, grid));
        let stresses = take::<[S::f64s; 6]>(&mut pool, largest);
        let weights = S::as_simd_f64s(&self.stations.weights).0;
        let mut energy = 0.0;
        force.fill(0.0);
        for batch in 0..self.stations.count.div_ceil(S::F64_LANES) {
            self.gradient(simd, q, batch, f);
            self.strains(simd, f, strains);
            if let Some(velocity) = velocity {
                self.gradient(simd, velocity, batch, rate);
                self.add_strain_rates(simd, f, rate, strains);
            }
            self.stress_moments(simd, batch, strains, stresses, t);
            if velocity.is_none() {
                let density = self.energy_density(simd, strains, t);
                energy += simd.reduce_sum_f64s(simd.mul_f64s(weights[batch], density));
            }
            let fields = self.columns(f);
            let mut rest = &mut *p;
            for alpha in 0..3 {
                let (p, others) = rest.split_at_mut(self.fields[alpha]);
                let pairs = [place(alpha, 0), place(alpha, 1), place(alpha, 2)];
                contract(simd, &self.places, (t, pairs), fields, p);
                rest = others;
            }
            self.add_force(simd, p, batch, force);
        }
        energy
    }

    /// Strains on the grid from F: tensor components xx, yy, zz, twice those for xy, xz, yz.
    #[inline(always)]
    fn strains<S: Simd>(&self, simd: S, f: &[[S::f64s; 3]], strains: &mut [[S::f64s; 6]]) {
        for g in self.classes.iter().flat_map(|class| &class.places) {
            strains[*g] = [simd.splat_f64s(0.0); 6];
        }
        let f = self.columns(f);
        for (k, (alpha, beta)) in PAIRS.into_iter().enumerate() {
            if alpha == beta {
                strains[0][k] = simd.splat_f64s(-0.5);
                add_half_square(simd, &self.places, f[alpha], strains, k);
            } else {
                add_products(simd, &self.places, f[alpha], f[beta], strains, k);
            }
        }
    }

    /// Adds `beta dE/dt` to the strains; multiplies the rates of F by beta.
    #[inline(always)]
    fn add_strain_rates<S: Simd>(
        &self,
        simd: S,
        f: &[[S::f64s; 3]],
        rate: &mut [[S::f64s; 3]],
        strains: &mut [[S::f64s; 6]],
    ) {
        let viscosity = simd.splat_f64s(self.viscosity);
        for rate in rate.iter_mut().flatten() {
            *rate = simd.mul_f64s(viscosity, *rate);
        }
        let (f, rate) = (self.columns(f), self.columns(rate));
        for (k, (alpha, beta)) in PAIRS.into_iter().enumerate() {
            add_products(simd, &self.places, f[alpha], rate[beta], strains, k);
            if alpha != beta {
                add_products(simd, &self.places, rate[alpha], f[beta], strains, k);
            }
        }
    }

    /// Section moments of stress `T_ab[g]` on the grid.
    #[inline(always)]
    fn stress_moments<S: Simd>(
        &self,
        simd: S,
        batch: usize,
        strains: &[[S::f64s; 6]],
        stresses: &mut [[S::f64s; 6]],
        t: &mut [[S::f64s; 6]],
    ) {
        for class in &self.classes {
            for (stress, &g) in stresses.iter_mut().zip(&class.places) {
                for alpha in 0..3 {
                    let mut sum = simd.splat_f64s(0.0);
                    for beta in 0..3 {
                        let modulus = simd.splat_f64s(self.law.normal[alpha][beta]);
                        sum = simd.mul_add_e_f64s(modulus, strains[g][beta], sum);
                    }
                    stress[alpha] = sum;
                    let modulus = simd.splat_f64s(self.law.shear[alpha]);
                    stress[3 + alpha] = simd.mul_f64s(modulus, strains[g][3 + alpha]);
                }
            }
            let [low, mid, all] = class.counts;
            class.integrate::<S, 0, 3, 6>(simd, batch, (0..low, all), stresses, t, &class.places);
            class.integrate::<S, 0, 1, 6>(simd, batch, (low..all, all), stresses, t, &class.places);
            class.integrate::<S, 3, 2, 6>(simd, batch, (0..mid, mid), stresses, t, &class.places);
            class.integrate::<S, 5, 1, 6>(simd, batch, (0..low, low), stresses, t, &class.places);
        }
        if let Some(law) = self.law.on_axis {
            let [xx, yy, zz, ..] = strains[0];
            for alpha in 0..3 {
                t[0][alpha] = simd.add_f64s(t[0][alpha], self.axis_stress(simd, law[alpha], [xx, yy, zz]));
            }
        }
    }

    /// `int S : E dA / 2` at the stations, J/m.
    #[inline(always)]
    fn energy_density<S: Simd>(&self, simd: S, strains: &[[S::f64s; 6]], t: &[[S::f64s; 6]]) -> S::f64s {
        let mut sums = [simd.splat_f64s(0.0); 6];
        for class in &self.classes {
            for k in 0..6 {
                for &g in &class.places[..class.counts[DEGREE[k]]] {
                    sums[k] = simd.mul_add_e_f64s(t[g][k], strains[g][k], sums[k]);
                }
            }
        }
        let mut sum = sums[0];
        for k in 1..6 {
            sum = simd.add_f64s(sum, sums[k]);
        }
        simd.mul_f64s(simd.splat_f64s(0.5), sum)
    }

    /// Adds what forces P on the coefficients of F do on the coordinates.
    #[inline(always)]
    fn add_force<S: Simd>(&self, simd: S, p: &[[S::f64s; 3]], batch: usize, force: &mut [f64]) {
        let p = self.columns(p);
        for (k, roles) in self.vectors.iter().enumerate() {
            let (mut on_slope, mut on_value) = ([simd.splat_f64s(0.0); 3], [simd.splat_f64s(0.0); 3]);
            for alpha in 0..3 {
                let Some((e, factor)) = roles[alpha] else { continue };
                let (factor, on) =
                    (simd.splat_f64s(factor), if alpha == 0 { &mut on_slope } else { &mut on_value });
                for i in 0..3 {
                    on[i] = simd.mul_add_e_f64s(factor, p[alpha][e][i], on[i]);
                }
            }
            self.stations.add_force(simd, [on_value, on_slope], (k, self.n_vectors), batch, force);
        }
    }
}
