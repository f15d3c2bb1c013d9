//! What a mode mainly moves: shares of kinetic energy by section motion and by harmonic around the axis.
//!
//! A section's field is split into translation along x (axial), translation and tilt across (bending),
//! rotation about x (torsion) and the rest (section), orthogonal in the section's mass. Harmonics are
//! the eigenspaces of `D_theta - J` (n = 0 axial and torsion, 1 bending, 2 ovalling, ..).

use crate::element::basis::{AxialProducts, SectionProducts, rotation_with_kinks};
use crate::error::Result;
use crate::linalg::dense::self_adjoint;
use crate::model::{Element, Field};
use crate::results::{EnergyShare, ModeKind};
use crate::section::Section;
use crate::section::basis::SectionBasis;
use crate::shaft::assembly::Assembly;
use faer::{Mat, c64};

/// Projections of one section's field.
struct Split {
    /// `p (x)` coordinates: rows give the coordinates along orthonormal axial, bending and torsion motions.
    motions: Mat<f64>,
    /// Section mass, `int m_k m_l dA`.
    mass: Mat<f64>,
    /// Rows whose squares sum to the energy of harmonics; `order[row]` is the number of waves.
    harmonics: Mat<f64>,
    order: Vec<usize>,
}

/// Energy shares of modes of one assembly.
pub struct Character<'a> {
    assembly: &'a Assembly<'a>,
    splits: Vec<Split>,
    /// Split and axial factor (Cholesky of `int L_i L_j dx`, times density) of each element.
    of_element: Vec<(usize, Mat<f64>)>,
}

/// Kind of the rows of [`Split::motions`].
const MOTION_KINDS: [ModeKind; 6] = [
    ModeKind::Axial,
    ModeKind::Bending,
    ModeKind::Bending,
    ModeKind::Bending,
    ModeKind::Bending,
    ModeKind::Torsion,
];

impl<'a> Character<'a> {
    /// Prepares the projections of every distinct section.
    ///
    /// # Errors
    /// When a small eigenproblem fails.
    pub fn new(assembly: &'a Assembly<'a>) -> Result<Self> {
        let model = assembly.model;
        let (mut keys, mut splits, mut of_element) = (Vec::<Field>::new(), Vec::new(), Vec::new());
        for element in &model.elements {
            let key = element.field();
            let at = match keys.iter().position(|k| *k == key) {
                Some(at) => at,
                None => {
                    keys.push(key);
                    splits.push(Split::new(
                        element,
                        &model.sections[element.section],
                        model.reference_length,
                    )?);
                    keys.len() - 1
                }
            };
            let lengths = AxialProducts::new(element.kind.axial_degree, element.length);
            let density = model.materials[element.material].density;
            of_element.push((at, cholesky(lengths.get(false, false), density)));
        }
        Ok(Self { assembly, splits, of_element })
    }

    /// Shares, kind and dominant number of waves of a (complex) mode in free coordinates.
    pub fn of(&self, mode: &[c64]) -> (EnergyShare, ModeKind, usize) {
        let parts = [mode.iter().map(|z| z.re).collect::<Vec<_>>(), mode.iter().map(|z| z.im).collect()];
        let (mut total, mut motions, mut waves) = (0.0, [0.0; 6], Vec::<f64>::new());
        for part in parts.iter().filter(|p| p.iter().any(|v| *v != 0.0)) {
            let q = self.assembly.expand(part);
            for (element, (split, factor)) in self.assembly.model.elements.iter().zip(&self.of_element) {
                let split = &self.splits[*split];
                let field = 3 * element.n_vectors();
                let index = self.assembly.element_coordinates(element);
                let nodal = Mat::from_fn(field, factor.nrows(), |k, node| q[index[node * field + k]]);
                let nodal = nodal * factor;
                for j in 0..nodal.ncols() {
                    let y = nodal.subcols(j, 1);
                    for (motion, value) in motions.iter_mut().zip((&split.motions * y).col(0).iter()) {
                        *motion += value * value;
                    }
                    total += split.energy(&nodal, j);
                    for (value, &n) in (&split.harmonics * y).col(0).iter().zip(&split.order) {
                        waves.resize(waves.len().max(n + 1), 0.0);
                        waves[n] += value * value;
                    }
                }
            }
        }
        let share = |kind: ModeKind| -> f64 {
            let sum: f64 =
                MOTION_KINDS.iter().zip(&motions).filter(|(k, _)| **k == kind).map(|(_, v)| v).sum();
            if total > 0.0 { sum / total } else { 0.0 }
        };
        let (axial, bending, torsion) =
            (share(ModeKind::Axial), share(ModeKind::Bending), share(ModeKind::Torsion));
        let section = (1.0 - axial - bending - torsion).max(0.0);
        let kinds = [
            (bending, ModeKind::Bending),
            (torsion, ModeKind::Torsion),
            (axial, ModeKind::Axial),
            (section, ModeKind::Section),
        ];
        let kind = kinds.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or(ModeKind::Section, |k| k.1);
        let order = (0..waves.len()).max_by(|&a, &b| waves[a].total_cmp(&waves[b])).unwrap_or(0);
        (EnergyShare { axial, bending, torsion, section }, kind, order)
    }
}

impl Split {
    fn new(element: &Element, section: &Section, reference_length: f64) -> Result<Self> {
        let (basis, kinks) = (element.kind.basis, &element.kinks);
        let products = |section| SectionProducts::with_kinks(basis, kinks, section, reference_length);
        let mass = products(section).plain().clone();
        let n = mass.nrows();
        // unit motions: x, y, z, tilt about z, tilt about y, rotation about x
        let shapes: [&[(usize, usize, f64)]; 6] = [
            &[(0, 0, 1.0)],
            &[(0, 1, 1.0)],
            &[(0, 2, 1.0)],
            &[(1, 0, 1.0)],
            &[(2, 0, 1.0)],
            &[(1, 2, 1.0), (2, 1, -1.0)],
        ];
        let mut motions = Mat::zeros(6, 3 * n);
        for (row, shape) in shapes.iter().enumerate() {
            let mut weighted = vec![0.0; 3 * n];
            for &(vector, component, value) in *shape {
                for k in 0..n {
                    weighted[3 * k + component] += mass[(k, vector)] * value;
                }
            }
            let norm: f64 = shape.iter().map(|&(v, c, value)| value * weighted[3 * v + c]).sum();
            for (k, w) in weighted.iter().enumerate() {
                motions[(row, k)] = w / norm.sqrt();
            }
        }
        let size = section.outer_size();
        let round = match basis {
            _ if section.is_axisymmetric() => *section,
            SectionBasis::Monomials(_) => Section::circle(size),
            SectionBasis::Ring { .. } => Section::tube(size, size * section.inner[0] / section.outer[0]),
        };
        let round_mass = if round == *section { mass.clone() } else { products(&round).plain().clone() };
        let most = kinks.functions().iter().map(|f| f.waves).fold(most_waves(basis), usize::max);
        let (harmonics, waves) = harmonics(&round_mass, &rotation_with_kinks(basis, kinks), most)?;
        Ok(Self { motions, mass, harmonics, order: waves })
    }

    fn energy(&self, nodal: &Mat<f64>, column: usize) -> f64 {
        let n = self.mass.nrows();
        let mut sum = 0.0;
        for l in 0..n {
            for k in 0..n {
                let m = self.mass[(k, l)];
                if m != 0.0 {
                    sum += m
                        * (0..3)
                            .map(|c| nodal[(3 * k + c, column)] * nodal[(3 * l + c, column)])
                            .sum::<f64>();
                }
            }
        }
        sum
    }
}

/// Largest number of waves of the functions of a basis.
fn most_waves(basis: SectionBasis) -> usize {
    match basis {
        SectionBasis::Monomials(order) => order,
        SectionBasis::Ring { harmonics, .. } => harmonics,
    }
}

/// Rows whose squares sum to the energy of each harmonic of a round section, and the number of waves of each row.
///
/// The generator T of rotations has the eigenvalues `+-i n`, whole numbers, so the part of a field with n waves is
/// `P_n y`, `P_n = prod_(m != n) (T^2 + m^2) / (m^2 - n^2)`: no eigenproblem of the mass A, whose smallest
/// eigenvalues are rounding on thin walls. The rows are a square root of `P_n^T A P_n`.
fn harmonics(mass: &Mat<f64>, turn: &Mat<f64>, most: usize) -> Result<(Mat<f64>, Vec<usize>)> {
    let n = 3 * mass.nrows();
    let full = Mat::from_fn(n, n, |i, j| if i % 3 == j % 3 { mass[(i / 3, j / 3)] } else { 0.0 });
    let generator = Mat::from_fn(n, n, |i, j| {
        let moved = if i % 3 == j % 3 { turn[(i / 3, j / 3)] } else { 0.0 };
        let turned = match (i / 3 == j / 3, i % 3, j % 3) {
            (true, 1, 2) => -1.0,
            (true, 2, 1) => 1.0,
            _ => 0.0,
        };
        moved - turned
    });
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut waves = Vec::new();
    for (number, part) in projectors(&generator, 1 + most).iter().enumerate() {
        let energy = part.transpose() * &full * part;
        let (values, vectors) = self_adjoint(energy.as_ref())?;
        // what is no larger than rounding carries no energy
        let floor = values.last().copied().unwrap_or(0.0) * f64::EPSILON;
        for k in (0..n).filter(|&k| values[k] > floor) {
            rows.push(vectors.col(k).iter().map(|v| values[k].sqrt() * v).collect());
            waves.push(number);
        }
    }
    Ok((Mat::from_fn(rows.len(), n, |i, j| rows[i][j]), waves))
}

/// The projections on fields of 0, 1, .. `most` waves, T being the generator of rotations.
fn projectors(generator: &Mat<f64>, most: usize) -> Vec<Mat<f64>> {
    let n = generator.nrows();
    let square = generator * generator;
    let of = |waves: usize| {
        let mut part = Mat::<f64>::identity(n, n);
        for other in (0..=most).filter(|&m| m != waves) {
            let (m, k) = ((other * other) as f64, (waves * waves) as f64);
            let moved = &square * &part;
            part = Mat::from_fn(n, n, |i, j| (moved[(i, j)] + m * part[(i, j)]) / (m - k));
        }
        part
    };
    (0..=most).map(of).collect()
}

/// Lower factor L of `density * a = L L^T`.
fn cholesky(a: &Mat<f64>, density: f64) -> Mat<f64> {
    let n = a.nrows();
    let mut l: Mat<f64> = Mat::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let sum: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
            let rest = density * a[(i, j)] - sum;
            l[(i, j)] = if i == j { rest.sqrt() } else { rest / l[(j, j)] };
        }
    }
    l
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::basis::rotation_matrix;

    const BASES: [SectionBasis; 6] = [
        SectionBasis::Monomials(1),
        SectionBasis::Monomials(3),
        SectionBasis::Monomials(5),
        SectionBasis::Ring { degree: 1, harmonics: 2 },
        SectionBasis::Ring { degree: 2, harmonics: 3 },
        SectionBasis::Ring { degree: 6, harmonics: 9 },
    ];

    /// The parts of n waves sum to the field, each is a projection, and T^2 multiplies it by -n^2.
    #[test]
    fn fields_are_the_sum_of_their_waves() {
        for basis in BASES {
            let turn = rotation_matrix(basis);
            let n = turn.nrows();
            let most = match basis {
                SectionBasis::Monomials(order) => order,
                SectionBasis::Ring { harmonics, .. } => harmonics,
            };
            let square = &turn * &turn;
            let mut sum = Mat::<f64>::zeros(n, n);
            for (waves, part) in projectors(&turn, most).iter().enumerate() {
                let size = part.norm_max().max(1.0);
                assert!((part * part - part).norm_max() < 1e-9 * size * size, "{basis:?} {waves}");
                let moved = &square * part + part * faer::Scale((waves * waves) as f64);
                assert!(moved.norm_max() < 1e-8 * size, "{basis:?} {waves}: {:.1e}", moved.norm_max());
                sum += part;
            }
            assert!((sum - Mat::<f64>::identity(n, n)).norm_max() < 1e-9, "{basis:?}");
        }
    }

    /// The harmonics hold all of the energy on walls of any thickness, also where the mass of the functions is singular to
    /// rounding.
    #[test]
    fn thin_walls_have_harmonics() {
        for basis in [SectionBasis::Monomials(3), SectionBasis::Monomials(5)] {
            for step in 0..60 {
                let inner = 0.2 * (1.0 - 10f64.powf(-1.0 - 4.0 * f64::from(step) / 60.0));
                let mass = SectionProducts::new(basis, &Section::tube(0.2, inner), 0.2).plain().clone();
                let (rows, waves) = harmonics(&mass, &rotation_matrix(basis), most_waves(basis)).unwrap();
                assert!((0..rows.nrows()).all(|i| (0..rows.ncols()).all(|j| rows[(i, j)].is_finite())));
                // a tilt of the section has one wave
                let n = rows.ncols();
                let tilt = Mat::from_fn(n, 1, |i, _| f64::from(i == 3));
                let energy = |k: usize| -> f64 {
                    let y = &rows * &tilt;
                    (0..y.nrows()).filter(|&i| waves[i] == k).map(|i| y[(i, 0)].powi(2)).sum()
                };
                let total: f64 = (0..=6).map(energy).sum();
                assert!((total / mass[(1, 1)] - 1.0).abs() < 1e-9, "{inner}: {total} {}", mass[(1, 1)]);
                assert!(energy(1) > (1.0 - 1e-9) * total, "{inner}");
            }
        }
    }
}
