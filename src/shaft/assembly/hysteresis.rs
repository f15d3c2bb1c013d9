//! Matrices of unit laws of bearings, of materials with a loss factor by waves around the axis, and the inertia of a translation.

use crate::element::inertia::convection;
use crate::linalg::sparse::Sparse;
use crate::model::Bearing;
use crate::shaft::assembly::{Assembly, Parts};
use faer::Mat;

impl Assembly<'_> {
    /// True when a material of the shaft has damping.
    pub fn has_material_damping(&self) -> bool {
        self.model.materials.iter().any(|m| m.stiffness_damping != 0.0 || m.mass_damping != 0.0)
    }

    /// The law that couples the k-th displacement of one bearing to its l-th force by 1, as a matrix.
    pub fn bearing_unit(&self, bearing: &Bearing, k: usize, l: usize) -> Sparse {
        let law = |b: &Bearing| {
            let mut law = [[0.0; 2]; 2];
            law[k][l] = f64::from(std::ptr::eq(b, bearing));
            law
        };
        self.build(None, self.bearings(law))
    }

    /// Stiffness times loss factor of the materials, by waves around the axis: for every k from 0 the matrix `eta K E_k` and, from
    /// k = 1 on, `eta K A E_k / k`. `A = D_theta - J` turns a pattern with its vectors, and E_k projects on patterns of k waves,
    /// for which `A^2 = -k^2`. Empty without a loss factor. Source: docs/theory/linear-rotordynamics.md#hysteresis.
    pub fn hysteresis(&self) -> Vec<[Sparse; 2]> {
        if self.model.materials.iter().all(|m| m.loss_factor == 0.0) {
            return Vec::new();
        }
        let turns: Vec<Mat<f64>> =
            (0..self.distinct.len()).map(|kind| self.turn_of(&self.distinct[kind])).collect();
        let most = turns.iter().map(|turn| waves(turn) + 1).max().unwrap_or(0);
        let part = |k: usize, turned: bool| {
            let elements = self.distinct.iter().enumerate().map(|(kind, m)| {
                let loss = self.material_of(kind).loss_factor;
                let a = convection(3 * turns[kind].nrows(), &turns[kind]);
                let projector = wave_projector(&a, k, waves(&turns[kind]) + 1);
                let node = if turned { &a * projector * faer::Scale(1.0 / k as f64) } else { projector };
                let size = node.nrows();
                let whole = Mat::from_fn(m.stiffness.nrows(), m.stiffness.nrows(), |i, j| {
                    if i / size == j / size { node[(i % size, j % size)] } else { 0.0 }
                });
                &m.stiffness * whole * faer::Scale(loss)
            });
            self.add_up(&Parts { elements: elements.collect(), nodal: Vec::new() })
        };
        let none = || self.build(None, Vec::new());
        (0..=most).map(|k| [part(k, false), if k > 0 { part(k, true) } else { none() }]).collect()
    }

    /// `M R` for the translation R of shaft and housings by 1 m along a component (0 to 2): a row over coordinates before constraints.
    pub fn inertia_of_translation(&self, component: usize) -> Vec<(usize, f64)> {
        let motion = &self.all_rigid_motions()[component];
        let mut row = vec![0.0; self.numbering.len()];
        let parts = self.mass_parts();
        let mut add = |coordinates: &[usize], matrix: &Mat<f64>| {
            for (i, &at) in coordinates.iter().enumerate() {
                row[at] +=
                    coordinates.iter().enumerate().map(|(j, &c)| matrix[(i, j)] * motion[c]).sum::<f64>();
            }
        };
        for (element, &kind) in self.model.elements.iter().zip(&self.element_type) {
            add(&self.element_coordinates(element), &parts.elements[kind]);
        }
        parts.nodal.iter().for_each(|n| add(&n.coordinates, &n.matrix));
        row.into_iter().enumerate().filter(|(_, v)| *v != 0.0).collect()
    }
}

/// No fewer than the most waves around the axis among functions with that matrix T of `d_theta`: functions of k waves have the
/// eigenvalues `i k`, and none is above a norm.
fn waves(turn: &Mat<f64>) -> usize {
    let norm =
        (0..turn.nrows()).map(|i| turn.row(i).iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
    norm.ceil() as usize
}

/// Projector on the patterns of k waves, of 0 to `most`: `prod_j (A^2 + j^2) / (j^2 - k^2)` over the others.
fn wave_projector(a: &Mat<f64>, k: usize, most: usize) -> Mat<f64> {
    let n = a.nrows();
    let square = a * a;
    let mut projector = Mat::<f64>::identity(n, n);
    for j in (0..=most).filter(|j| *j != k) {
        let (j, k) = ((j * j) as f64, (k * k) as f64);
        let factor = &square + Mat::from_fn(n, n, |r, c| if r == c { j } else { 0.0 });
        projector = factor * projector * faer::Scale(1.0 / (j - k));
    }
    projector
}
