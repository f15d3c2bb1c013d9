//! Force and tangent of one element, and what share of the core's peak they reach.

use divan::Bencher;
use divan::counter::ItemsCount;
use rotor::element::Kernel;
use rotor::element::kernel::simd::Scratch;
use rotor::element::kinked::KinkedElement;
use rotor::element::polynomial::NonlinearElement;
use rotor::element::ring::RingElement;
use rotor::instructions::Instructions;
use rotor::model::{ElementKind, Law, Material, Quadrature};
use rotor::section::Section;
use rotor::section::basis::SectionBasis;
use rotor::section::kinks::{Kink, Kinks};

fn main() {
    divan::main();
}

const QUADRATURES: [(&str, Quadrature); 3] = [
    ("exact", Quadrature::EXACT),
    ("5 stations", Quadrature { axial: Some(5), section: None }),
    ("4 stations", Quadrature { axial: Some(4), section: None }),
];

const STEEL: Material = Material {
    youngs_modulus: 2.1e11,
    poisson_ratio: 0.3,
    density: 7850.0,
    stiffness_damping: 0.0,
    mass_damping: 0.0,
    loss_factor: 0.0,
};

/// Coordinates of an element of n vectors, 0.3 m long, strained by some per cent; R is the reference length, m.
fn strained(size: usize, n: usize, reference_length: f64) -> Vec<f64> {
    let at = |i: usize| {
        let straight = match (i / 3 % n, i % 3) {
            (0, 0) => 0.1 * (i / 3 / n) as f64,
            (1, 1) | (2, 2) => reference_length,
            _ => 0.0,
        };
        straight + 0.001 * (0.7 * i as f64).sin()
    };
    (0..size).map(at).collect()
}

fn element(order: usize, quadrature: usize) -> (NonlinearElement, Vec<f64>) {
    let kind = ElementKind { axial_degree: 3, basis: SectionBasis::Monomials(order), law: Law::Continuum };
    let rule = QUADRATURES[quadrature].1;
    let element = NonlinearElement::new(kind, &Section::circle(0.1), &STEEL, 0.3, 0.1, rule);
    let n = kind.n_vectors();
    let q = strained(element.size(), n, 0.1);
    (element, q)
}

/// Items are floating point operations (a multiply-add is two): divan prints them per second.
#[divan::bench(args = [(1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (4, 0), (5, 0)])]
fn force(bencher: Bencher<'_, '_>, (order, quadrature): (usize, usize)) {
    let (element, q) = element(order, quadrature);
    let mut scratch = Scratch::default();
    let mut force = vec![0.0; q.len()];
    bencher
        .counter(ItemsCount::new(element.force_operations()))
        .bench_local(|| element.internal_force(divan::black_box(&q), None, &mut force, &mut scratch));
}

#[divan::bench(args = [(1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (4, 0), (5, 0)])]
fn tangent(bencher: Bencher<'_, '_>, (order, quadrature): (usize, usize)) {
    let (element, q) = element(order, quadrature);
    let mut scratch = Scratch::default();
    let mut tangent = vec![0.0; q.len() * q.len()];
    bencher.bench_local(|| element.tangent(divan::black_box(&q), &mut tangent, &mut scratch));
}

/// 34X3, exact, with narrower instructions than the machine may have.
const NARROW: [&str; 2] = ["avx2", "none"];

fn narrow(name: &str) -> Option<(NonlinearElement, Vec<f64>)> {
    let instructions = Instructions::from_name(name).filter(|set| set.are_available())?;
    let (element, q) = element(3, 0);
    Some((element.with_instructions(instructions), q))
}

#[divan::bench(args = NARROW)]
fn force_with(bencher: Bencher<'_, '_>, name: &str) {
    let Some((element, q)) = narrow(name) else { return };
    let mut scratch = Scratch::default();
    let mut force = vec![0.0; q.len()];
    bencher
        .counter(ItemsCount::new(element.force_operations()))
        .bench_local(|| element.internal_force(divan::black_box(&q), None, &mut force, &mut scratch));
}

#[divan::bench(args = NARROW)]
fn tangent_with(bencher: Bencher<'_, '_>, name: &str) {
    let Some((element, q)) = narrow(name) else { return };
    let mut scratch = Scratch::default();
    let mut tangent = vec![0.0; q.len() * q.len()];
    bencher.bench_local(|| element.tangent(divan::black_box(&q), &mut tangent, &mut scratch));
}

/// A ring member on a tube .2/.15, strained by some per cent.
fn ring(degree: usize, harmonics: usize) -> Option<(RingElement, Vec<f64>)> {
    let basis = SectionBasis::Ring { degree, harmonics };
    let kind = ElementKind { axial_degree: 3, basis, law: Law::Continuum };
    let element = RingElement::new(kind, &Section::tube(0.2, 0.15), &STEEL, 0.3, 0.2, Quadrature::EXACT)?;
    let n = kind.n_vectors();
    let q = strained(element.size(), n, 0.2);
    Some((element, q))
}

/// 34X3 with the kinks of effort 4 at half the radius of a solid of radius .2.
fn kinked() -> (KinkedElement, Vec<f64>) {
    let kind = ElementKind { axial_degree: 3, basis: SectionBasis::Monomials(3), law: Law::Continuum };
    let at = |radius| Kink { radius, scale: 0.1, degree: 2, inward: false };
    let kinks = Kinks::new(&[at(0.085), at(0.1), at(0.115)]);
    let with = (Quadrature::EXACT, Instructions::Widest);
    let element = KinkedElement::new((kind, &kinks), [&Section::circle(0.2); 2], &STEEL, 0.3, 0.2, with);
    let n = kind.n_vectors() + kinks.count();
    let q = strained(element.size(), n, 0.2);
    (element, q)
}

#[divan::bench]
fn kinked_force(bencher: Bencher<'_, '_>) {
    let (element, q) = kinked();
    let mut scratch = Scratch::default();
    let mut force = vec![0.0; q.len()];
    bencher.bench_local(|| element.internal_force(divan::black_box(&q), None, &mut force, &mut scratch));
}

#[divan::bench]
fn kinked_tangent(bencher: Bencher<'_, '_>) {
    let (element, q) = kinked();
    let mut scratch = Scratch::default();
    let mut tangent = vec![0.0; q.len() * q.len()];
    bencher.bench_local(|| element.tangent(divan::black_box(&q), &mut tangent, &mut scratch));
}

const RINGS: [(usize, usize); 5] = [(1, 2), (1, 3), (2, 3), (3, 3), (3, 4)];

#[divan::bench(args = RINGS)]
fn ring_force(bencher: Bencher<'_, '_>, (degree, harmonics): (usize, usize)) {
    let Some((element, q)) = ring(degree, harmonics) else { return };
    let mut scratch = Scratch::default();
    let mut force = vec![0.0; q.len()];
    bencher.bench_local(|| element.internal_force(divan::black_box(&q), None, &mut force, &mut scratch));
}

#[divan::bench(args = RINGS)]
fn ring_tangent(bencher: Bencher<'_, '_>, (degree, harmonics): (usize, usize)) {
    let Some((element, q)) = ring(degree, harmonics) else { return };
    let mut scratch = Scratch::default();
    let mut tangent = vec![0.0; q.len() * q.len()];
    bencher.bench_local(|| element.tangent(divan::black_box(&q), &mut tangent, &mut scratch));
}

/// Independent multiply-adds in registers: the core's peak, in the same units.
#[divan::bench]
fn peak(bencher: Bencher<'_, '_>) {
    const ROUNDS: usize = 1000;
    struct Run;
    impl pulp::WithSimd for Run {
        type Output = f64;
        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, simd: S) -> f64 {
            let factor = simd.splat_f64s(divan::black_box(0.999));
            let mut sums = [simd.splat_f64s(1.0); 12];
            for _ in 0..ROUNDS {
                for sum in &mut sums {
                    *sum = simd.mul_add_e_f64s(*sum, factor, factor);
                }
            }
            sums.iter().map(|s| simd.reduce_sum_f64s(*s)).sum()
        }
    }
    let lanes = pulp::Arch::new().dispatch(Lanes);
    bencher.counter(ItemsCount::new(2 * 12 * ROUNDS * lanes)).bench_local(|| pulp::Arch::new().dispatch(Run));
}

struct Lanes;

impl pulp::WithSimd for Lanes {
    type Output = usize;
    fn with_simd<S: pulp::Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}
