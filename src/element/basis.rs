//! Axial Lagrange polynomials, section functions, and the exact integrals of their products.
//!
//! Position field: `r(x,y,z) = sum_i L_i(xi) sum_(a+b<=n) eta^a zeta^b / (a! b!) q_i,(ab)` with
//! `eta = y/R`, `zeta = z/R` and `q = R^(a+b) r_,(y^a z^b)`; xi in [-1, 1] along the element.
//! Integrals of monomials are closed forms; functions of rings are in [`crate::element::ring_functions`]. Source: docs/theory/elements.md#kinematics and
//! docs/theory/elements.md#matrices.

use crate::element::cells::{cells, degrees, on_ring};
use crate::element::ring_functions::{self, RingFunctions, Sums};
use crate::section::Section;
use crate::section::basis::SectionBasis;
pub use crate::section::basis::{exponents, vector_name};
use crate::section::kinks::Kinks;
use faer::Mat;

/// Monomial coefficients (ascending powers of xi) of the Lagrange polynomials of the given degree on
/// equally spaced nodes from xi = -1 to 1.
pub fn lagrange(degree: usize) -> Vec<Vec<f64>> {
    let node = |i: usize| 2.0 * i as f64 / degree as f64 - 1.0;
    (0..=degree)
        .map(|i| {
            let mut polynomial = vec![1.0];
            for j in (0..=degree).filter(|&j| j != i) {
                let scale = 1.0 / (node(i) - node(j));
                let mut next = vec![0.0; polynomial.len() + 1];
                for (power, c) in polynomial.iter().enumerate() {
                    next[power] -= c * node(j) * scale;
                    next[power + 1] += c * scale;
                }
                polynomial = next;
            }
            polynomial
        })
        .collect()
}

/// Derivative of a polynomial in ascending powers.
pub fn derivative(polynomial: &[f64]) -> Vec<f64> {
    polynomial.iter().enumerate().skip(1).map(|(power, c)| power as f64 * c).collect()
}

/// Value of a polynomial in ascending powers.
pub fn evaluate(polynomial: &[f64], xi: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, c| sum * xi + c)
}

/// Integrals along an element: `int L_i^(a) L_j^(b) dx`, each `(p+1)` square.
#[derive(Debug, Clone)]
pub struct AxialProducts {
    /// `products[a][b]` with a, b = 1 for the derivative by x.
    products: [[Mat<f64>; 2]; 2],
}

impl AxialProducts {
    /// Integrals of the Lagrange polynomials of `degree` over an element of `length` (m).
    pub fn new(degree: usize, length: f64) -> Self {
        let plain = lagrange(degree);
        let slopes: Vec<_> = plain.iter().map(|l| derivative(l)).collect();
        let integrals = |f: &[Vec<f64>], g: &[Vec<f64>], scale: f64| {
            Mat::from_fn(f.len(), g.len(), |i, j| scale * integral_of_product(&f[i], &g[j]))
        };
        Self {
            products: [
                [integrals(&plain, &plain, length / 2.0), integrals(&plain, &slopes, 1.0)],
                [integrals(&slopes, &plain, 1.0), integrals(&slopes, &slopes, 2.0 / length)],
            ],
        }
    }

    /// The share of one station at xi with a weight of a rule on [-1, 1].
    pub fn at_station(degree: usize, length: f64, (xi, weight): (f64, f64)) -> Self {
        let plain = lagrange(degree);
        let values: Vec<f64> = plain.iter().map(|l| evaluate(l, xi)).collect();
        let slopes: Vec<f64> = plain.iter().map(|l| evaluate(&derivative(l), xi) * 2.0 / length).collect();
        let products =
            |f: &[f64], g: &[f64]| Mat::from_fn(f.len(), g.len(), |i, j| weight * length / 2.0 * f[i] * g[j]);
        Self {
            products: [
                [products(&values, &values), products(&values, &slopes)],
                [products(&slopes, &values), products(&slopes, &slopes)],
            ],
        }
    }

    /// `int L_i^(a) L_j^(b) dx`; `true` stands for the derivative by x.
    pub fn get(&self, a: bool, b: bool) -> &Mat<f64> {
        &self.products[a as usize][b as usize]
    }
}

/// `int_-1^1 f g dxi`.
fn integral_of_product(f: &[f64], g: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in f.iter().enumerate() {
        for (j, b) in g.iter().enumerate().filter(|(j, _)| (i + j) % 2 == 0) {
            sum += a * b * 2.0 / (i + j + 1) as f64;
        }
    }
    sum
}

/// A polynomial in the section: `(coefficient, a, b)` for `coefficient eta^a zeta^b / (a! b!)`.
type Polynomial = Vec<(f64, usize, usize)>;

/// Integrals over a section of products of its functions `m_k` and of their derivatives, each
/// `n_vectors` square, in scaled coordinates (m^2, derivatives by y and z in 1/m).
#[derive(Debug, Clone)]
pub struct SectionProducts {
    /// `int m_k,a m_l,b dA` with a, b in {none, y, z}.
    gradients: [[Mat<f64>; 3]; 3],
    /// `int m_k (d_theta m_l) dA`, `d_theta = y d/dz - z d/dy`.
    pub rotation: Mat<f64>,
    /// `int (d_theta m_k)(d_theta m_l) dA`.
    pub rotation_rotation: Mat<f64>,
    /// Area of the section, m^2.
    pub area: f64,
    /// Reference length R, m.
    pub reference_length: f64,
}

impl SectionProducts {
    /// Integrals of the functions of `basis` over `section`, scaled by `reference_length`.
    pub fn new(basis: SectionBasis, section: &Section, reference_length: f64) -> Self {
        match basis {
            SectionBasis::Monomials(order) => Self::of_monomials(order, section, reference_length),
            SectionBasis::Ring { degree, harmonics } => {
                let (gradients, rotation, rotation_rotation) =
                    ring_functions::products(degree, harmonics, section, reference_length);
                Self { gradients, rotation, rotation_rotation, area: section.area(), reference_length }
            }
        }
    }

    /// Integrals of the functions of `basis` and of kinked ones.
    pub fn with_kinks(basis: SectionBasis, kinks: &Kinks, section: &Section, reference_length: f64) -> Self {
        if kinks.is_empty() {
            return Self::new(basis, section, reference_length);
        }
        let (core, rings) = cells(section, kinks);
        let n = basis.count() + kinks.count();
        let mut sums: Sums = [(); 16].map(|()| Mat::zeros(n, n));
        if let Some(core) = core {
            let of_core = Self::new(basis, &core, reference_length);
            let mut add = |place: usize, matrix: &Mat<f64>| {
                for l in 0..matrix.ncols() {
                    for k in 0..matrix.nrows() {
                        sums[place][(k, l)] += matrix[(k, l)];
                    }
                }
            };
            (0..3).for_each(|a| (0..3).for_each(|b| add(4 * a + b, of_core.gradient(a, b))));
            add(3, &of_core.rotation);
            add(15, &of_core.rotation_rotation);
        }
        let (degree, harmonics) = degrees(basis, kinks);
        for cell in rings {
            let terms = on_ring(basis, kinks, section, &cell, reference_length);
            let ring = RingFunctions::new(&cell);
            let at = |rho, theta| ring.of_terms(&terms, rho, theta);
            let of_ring = ring.sums(n, 2 * degree + 2, harmonics, &at);
            sums.iter_mut().zip(of_ring).for_each(|(sum, part)| *sum += part);
        }
        let odd: Vec<[bool; 2]> = basis.odd().into_iter().chain(kinks.odd()).collect();
        let (gradients, rotation, rotation_rotation) = ring_functions::clean(&sums, &odd, true);
        Self { gradients, rotation, rotation_rotation, area: section.area(), reference_length }
    }

    fn of_monomials(order: usize, section: &Section, reference_length: f64) -> Self {
        let r = reference_length;
        let scaled = Section {
            shape: section.shape,
            outer: section.outer.map(|c| c / r),
            inner: section.inner.map(|c| c / r),
        };
        let list = exponents(order);
        // Every moment that occurs, looked up by (a, b).
        let top = 2 * order + 1;
        let moments: Vec<f64> = (0..top * top).map(|i| scaled.moment(i / top, i % top) * r * r).collect();
        let integral = |f: &Polynomial, g: &Polynomial| -> f64 {
            let mut sum = 0.0;
            for &(cf, af, bf) in f {
                for &(cg, ag, bg) in g {
                    let scale = factorial(af) * factorial(bf) * factorial(ag) * factorial(bg);
                    sum += cf * cg * moments[(af + ag) * top + bf + bg] / scale;
                }
            }
            sum
        };
        let matrix = |f: &[Polynomial], g: &[Polynomial]| {
            Mat::from_fn(f.len(), g.len(), |k, l| integral(&f[k], &g[l]))
        };
        let plain: Vec<Polynomial> = list.iter().map(|&(a, b)| vec![(1.0, a, b)]).collect();
        let by_y: Vec<Polynomial> =
            list.iter().map(|&(a, b)| if a > 0 { vec![(1.0 / r, a - 1, b)] } else { vec![] }).collect();
        let by_z: Vec<Polynomial> =
            list.iter().map(|&(a, b)| if b > 0 { vec![(1.0 / r, a, b - 1)] } else { vec![] }).collect();
        let turned: Vec<Polynomial> = list.iter().map(|&e| turn(e)).collect();
        let fields = [&plain, &by_y, &by_z];
        Self {
            gradients: fields.map(|f| fields.map(|g| matrix(f, g))),
            rotation: matrix(&plain, &turned),
            rotation_rotation: matrix(&turned, &turned),
            area: moments[0],
            reference_length,
        }
    }

    /// `int m_k m_l dA`.
    pub fn plain(&self) -> &Mat<f64> {
        &self.gradients[0][0]
    }

    /// `int m_k,a m_l,b dA`; directions 0 = none (along x the axial factor is derived), 1 = y, 2 = z.
    pub fn gradient(&self, a: usize, b: usize) -> &Mat<f64> {
        &self.gradients[a][b]
    }

    /// Entry `(2 k + c, 2 l + d)` of the stiffness in the plane of the section, `int (lambda div u div v + 2 mu e(u) : e(v)) dA`,
    /// of displacements c, d (0 for y, 1 for z) of the functions k and l; Pa for Lame's constants in Pa.
    pub fn plane_stiffness(&self, (lambda, mu): (f64, f64), i: usize, j: usize) -> f64 {
        let g = |a: usize, b: usize| self.gradient(a, b)[(i / 2, j / 2)];
        let (c, d) = (i % 2 + 1, j % 2 + 1);
        if c == d {
            (lambda + 2.0 * mu) * g(c, c) + mu * g(3 - c, 3 - c)
        } else {
            lambda * g(c, d) + mu * g(d, c)
        }
    }

    /// The same products with the integral replaced by area times the value on the axis.
    pub fn on_axis(&self, order: usize) -> Self {
        let r = self.reference_length;
        let list = exponents(order);
        let value = |derivative: usize, e: (usize, usize)| match (derivative, e) {
            (0, (0, 0)) => 1.0,
            (1, (1, 0)) | (2, (0, 1)) => 1.0 / r,
            _ => 0.0,
        };
        let zero = Mat::zeros(list.len(), list.len());
        Self {
            gradients: [0, 1, 2].map(|a| {
                [0, 1, 2].map(|b| {
                    Mat::from_fn(list.len(), list.len(), |k, l| {
                        self.area * value(a, list[k]) * value(b, list[l])
                    })
                })
            }),
            rotation: zero.clone(),
            rotation_rotation: zero,
            area: self.area,
            reference_length: r,
        }
    }
}

/// `d_theta` of the monomial `eta^a zeta^b / (a! b!)` in the same monomials.
fn turn((a, b): (usize, usize)) -> Polynomial {
    let mut result = Vec::new();
    if b > 0 {
        result.push(((a + 1) as f64, a + 1, b - 1));
    }
    if a > 0 {
        result.push((-((b + 1) as f64), a - 1, b + 1));
    }
    result
}

/// Matrix T of `d_theta` on the functions of a round section: `d_theta m_l = sum_k T_kl m_k` (monomials: of any
/// section).
pub fn rotation_matrix(basis: SectionBasis) -> Mat<f64> {
    let order = match basis {
        SectionBasis::Monomials(order) => order,
        SectionBasis::Ring { degree, harmonics } => {
            return ring_functions::rotation_matrix(degree, harmonics);
        }
    };
    let list = exponents(order);
    let mut matrix = Mat::zeros(list.len(), list.len());
    for (l, &e) in list.iter().enumerate() {
        for (c, a, b) in turn(e) {
            if let Some(k) = list.iter().position(|&m| m == (a, b)) {
                matrix[(k, l)] = c;
            }
        }
    }
    matrix
}

/// Matrix T of d_theta on the functions of a basis and on kinked ones behind them.
pub fn rotation_with_kinks(basis: SectionBasis, kinks: &Kinks) -> Mat<f64> {
    let (own, list) = (rotation_matrix(basis), kinks.functions());
    let first = own.nrows();
    Mat::from_fn(first + list.len(), first + list.len(), |k, l| {
        if k < first || l < first {
            return if k < first && l < first { own[(k, l)] } else { 0.0 };
        }
        let (f, g) = (list[k - first], list[l - first]);
        if (f.kink, f.power, f.waves) != (g.kink, g.power, g.waves) || f.sine == g.sine {
            return 0.0;
        }
        if f.sine { -(f.waves as f64) } else { f.waves as f64 }
    })
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lagrange_polynomials_are_one_at_their_node() {
        for degree in [2, 3] {
            for (i, l) in lagrange(degree).iter().enumerate() {
                for j in 0..=degree {
                    let xi = 2.0 * j as f64 / degree as f64 - 1.0;
                    assert!((evaluate(l, xi) - f64::from(i == j)).abs() < 1e-15);
                }
            }
        }
    }

    #[test]
    fn axial_products_partition_unity() {
        let products = AxialProducts::new(3, 0.7);
        let total: f64 = (0..4)
            .flat_map(|i| (0..4).map(move |j| (i, j)))
            .map(|(i, j)| products.get(false, false)[(i, j)])
            .sum();
        assert!((total - 0.7).abs() < 1e-15);
        for i in 0..4 {
            let row: f64 = (0..4).map(|j| products.get(true, true)[(i, j)]).sum();
            assert!(row.abs() < 1e-13);
        }
    }

    #[test]
    fn rotation_products_follow_from_the_rotation_matrix() {
        let section = Section::ellipse(0.15, 0.2);
        // order 2 monomials turn into order 2 monomials, so the products are exact matrix products
        let p = SectionProducts::new(SectionBasis::Monomials(3), &section, 0.2);
        let t = rotation_matrix(SectionBasis::Monomials(3));
        let rotation = p.plain() * &t;
        assert!((&rotation - &p.rotation).norm_max() < 1e-17);
        assert!((t.transpose() * &rotation - &p.rotation_rotation).norm_max() < 1e-17);
    }
}
