//! Forces and moments on one section, as it stands.
//!
//! With d_y and d_z the mean affine images of the section's axes (`R r_,y` and `R r_,z`), n the unit normal of their plane and
//! e_y, e_z the axes of the rotation nearest to them (`I_y |d_y - e_y|^2 + I_z |d_z - e_z|^2` least, `I_y = int y^2 dA`),
//! a virtual motion turns the section by
//!
//! ```text
//!     dtheta = n x dn + n (I_y e_z . dd_y - I_z e_y . dd_z) / (I_y e_y . d_y + I_z e_z . d_z),   dn . d_y = - n . dd_y (z alike)
//! ```
//!
//! and a moment m does the work `m . dtheta`. Source: docs/theory/loads.md#loads.

use crate::model::{Load, LoadKind, Model, Reading};
use crate::shaft::attachments::{Contribution, Numbering, Region, affine_rows, displacement_weights};
use crate::shaft::loads::Turned;
use faer::Mat;
use nalgebra::{SMatrix, SVector};
use num_dual::{DualNum, jacobian};

/// y and z images of a section: d_y, then d_z.
type Images<D> = SVector<D, 6>;
/// Forces conjugate to the mean displacement, d_y and d_z.
type SectionLoads<D> = SVector<D, 9>;

/// A force or moment on a section.
pub struct SectionLoad {
    force: [f64; 3],
    moment: [f64; 3],
    /// The components are those along the axes of the section.
    follows: bool,
    /// `I_y = int y^2` and `I_z = int z^2` of what the load acts on; only their ratio counts.
    inertia: [f64; 2],
    /// Mean displacement, d_y and d_z as sums over vectors, `(first coordinate, weight)`.
    rows: [Vec<(usize, f64)>; 3],
}

impl SectionLoad {
    /// The law of a load.
    pub fn new(model: &Model, numbering: &Numbering, load: &Load) -> Self {
        let (force, moment) = match load.kind {
            LoadKind::Force(f) => (f, [0.0; 3]),
            LoadKind::Moment(m) => ([0.0; 3], m),
        };
        let [_, y, z] = affine_rows(model, numbering, load.node, load.acts_on);
        let means = displacement_weights(model, load.node, load.acts_on).into_iter().enumerate();
        let mean = means.filter(|(_, w)| *w != 0.0).map(|(k, w)| (numbering.index(load.node, k, 0), w));
        let inertia = Region::new(model, load.node, load.acts_on)
            .map_or([1.0, 1.0], |region| [1.0, region.moment(0, 2) / region.moment(2, 0)]);
        let follows = load.reading == Reading::Following;
        Self { force, moment, follows, inertia, rows: [mean.collect(), y, z] }
    }

    fn images(&self, q: &[f64]) -> Images<f64> {
        let sum = |k: usize, c: usize| self.rows[k].iter().map(|(at, w)| w * q[at + c]).sum::<f64>();
        Images::from_fn(|i, _| sum(1 + i / 3, i % 3))
    }

    /// The forces conjugate to mean displacement and images.
    fn forces<D: DualNum<f64> + Copy>(&self, images: Images<D>, axes: Turned) -> SectionLoads<D> {
        let [y, z] = [0, 3].map(|at| [images[at], images[at + 1], images[at + 2]]);
        let frame = frame(y, z, self.inertia);
        let given = |v: [f64; 3]| {
            if self.follows { turn(&frame, v) } else { axes.seen(v).map(D::from) }
        };
        let (force, moment) = (given(self.force), given(self.moment));
        let [n, e_y, e_z] = frame;
        // dual base of the images within their plane
        let area = dot(cross(y, z), n);
        let (dual_y, dual_z) = (scale(cross(z, n), area.recip()), scale(cross(n, y), area.recip()));
        let tilting = cross(moment, n);
        let (tilt_y, tilt_z) = (-dot(tilting, dual_y), -dot(tilting, dual_z));
        let [i_y, i_z] = self.inertia.map(D::from);
        let turning = dot(moment, n) / (dot(y, e_y) * i_y + dot(z, e_z) * i_z);
        let mut all = SectionLoads::<D>::from_element(D::zero());
        for c in 0..3 {
            all[c] = force[c];
            all[3 + c] = n[c] * tilt_y + e_z[c] * (turning * i_y);
            all[6 + c] = n[c] * tilt_z - e_y[c] * (turning * i_z);
        }
        all
    }

    /// Adds a factor times the forces in a place q.
    pub fn add(&self, q: &[f64], axes: Turned, factor: f64, force: &mut [f64]) {
        let all = self.forces(self.images(q), axes);
        for (k, row) in self.rows.iter().enumerate() {
            for &(at, w) in row {
                (0..3).for_each(|c| force[at + c] += factor * w * all[3 * k + c]);
            }
        }
    }

    /// Derivative of the forces by the coordinates, `d force / d q`; without symmetry.
    pub fn tangent(&self, q: &[f64], axes: Turned) -> Contribution {
        let (_, by_images): (SectionLoads<f64>, SMatrix<f64, 9, 6>) =
            jacobian(|images| self.forces(images, axes), &self.images(q));
        let mut starts: Vec<usize> = self.rows.iter().flatten().map(|entry| entry.0).collect();
        starts.sort_unstable();
        starts.dedup();
        let weight = |k: usize, start: usize| {
            self.rows[k].iter().find(|entry| entry.0 == start).map_or(0.0, |entry| entry.1)
        };
        let entry = |i: usize, j: usize| {
            let pairs = (0..3).flat_map(|k| (1..3).map(move |l| (k, l)));
            let part = |(k, l): (usize, usize)| {
                weight(k, starts[i / 3])
                    * weight(l, starts[j / 3])
                    * by_images[(3 * k + i % 3, 3 * (l - 1) + j % 3)]
            };
            pairs.map(part).sum::<f64>()
        };
        let n = 3 * starts.len();
        Contribution {
            coordinates: starts.iter().flat_map(|s| (0..3).map(move |c| s + c)).collect(),
            matrix: Mat::from_fn(n, n, entry),
        }
    }
}

/// The rotation nearest to the images of a section: n, e_y, e_z.
pub fn frame<D: DualNum<f64> + Copy>(y: [D; 3], z: [D; 3], inertia: [f64; 2]) -> [[D; 3]; 3] {
    let normal = cross(y, z);
    let n = scale(normal, dot(normal, normal).sqrt().recip());
    // axes of the plane, one along d_y, turned by the angle of the nearest rotation
    let first = scale(y, dot(y, y).sqrt().recip());
    let second = cross(n, first);
    let [i_y, i_z] = inertia.map(D::from);
    let (sin, cos) = (-dot(z, first) * i_z, dot(y, first) * i_y + dot(z, second) * i_z);
    let size = (sin * sin + cos * cos).sqrt().recip();
    let (sin, cos) = (sin * size, cos * size);
    let e_y = [0, 1, 2].map(|c| first[c] * cos + second[c] * sin);
    [n, e_y, cross(n, e_y)]
}

/// The vector with the components v along a frame, in the axes in which the frame is given: `sum_i v_i frame_i`.
pub fn turn<D: DualNum<f64> + Copy>(frame: &[[D; 3]; 3], v: [f64; 3]) -> [D; 3] {
    [0, 1, 2].map(|c| frame[0][c] * v[0] + frame[1][c] * v[1] + frame[2][c] * v[2])
}

fn dot<D: DualNum<f64> + Copy>(a: [D; 3], b: [D; 3]) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<D: DualNum<f64> + Copy>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn scale<D: DualNum<f64> + Copy>(a: [D; 3], s: D) -> [D; 3] {
    a.map(|a| a * s)
}
