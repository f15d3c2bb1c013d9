//! The gap between two boundaries, with its first and second derivative, in the plane and in space.
//!
//! A boundary point is linear in the vectors behind it, `x = sum_k w_k(s) v_k`, s its parameters on the boundary. The gap is
//! the stationary value of
//!
//! ```text
//!     G = n . (x_s - x_m)   over the direction n, |n| = 1, and over those parameters P that are free,
//!     dg/dv = n (S - M),    d^2 g/dv^2 = - B^T A^-1 B,   A = d^2 G/dP^2,  B = d^2 G/dP dv
//! ```
//!
//! with n the outward normal of the master, so that penetration is negative. With m' the derivatives by free parameters of the
//! master, s' by those of the slave, and e the directions across n:
//!
//! ```text
//!     A:  -n.x_m,ab   n.x_s,ab   -e.x_m,a   e.x_s,a   -g delta (of n)
//!     B:  -n M,a      n S,a      e (S - M)
//! ```
//!
//! At a kink of the boundary the parameter of the master is not free. Source: docs/theory/contact.md#gap.

use nalgebra::{DMatrix, DVector, Vector3};

/// A boundary point: what it takes of the vectors behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePoint {
    /// First coordinate of each vector, and its weight: plain, by the first and second parameter a and b, by aa, ab, bb.
    pub vectors: Vec<(usize, [f64; 6])>,
}

/// Index of a weight: derivative by the parameters.
const FIRST: [usize; 2] = [1, 2];
const SECOND: [[usize; 2]; 2] = [[3, 4], [4, 5]];

impl SurfacePoint {
    /// `sum w v`, of the weight of that index; `components` per vector (2 in the plane).
    pub fn sum(&self, q: &[f64], index: usize, components: usize) -> Vector3<f64> {
        let mut x = Vector3::zeros();
        for (first, w) in &self.vectors {
            for c in 0..components {
                x[c] += w[index] * q[first + c];
            }
        }
        x
    }
}

/// Which parameters a gap is stationary in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Free {
    /// Of the master.
    pub master: [bool; 2],
    /// Of the slave.
    pub slave: [bool; 2],
}

/// A gap between a slave and a master point.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// g, m; negative in penetration.
    pub value: f64,
    /// Outward normal n of the master.
    pub normal: Vector3<f64>,
    /// What the distance is multiplied by: 1 but on the way out past an end of the master.
    pub scale: f64,
    /// The point that may penetrate.
    pub slave: SurfacePoint,
    /// The nearest point of the other boundary.
    pub master: SurfacePoint,
    /// What the gap is stationary in.
    pub free: Free,
}

/// A point against a boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Curve of the nearest point.
    pub face: usize,
    /// Parameter of the nearest point on its curve, -1 to 1.
    pub zeta: f64,
    /// Whether the nearest point slides along the curve; on a kink it does not.
    pub slides: bool,
    /// Gap, m; negative in penetration.
    pub gap: f64,
    /// Outward normal of the boundary at the nearest point.
    pub normal: Vector3<f64>,
    /// What the distance is multiplied by.
    pub scale: f64,
    /// True when the point lies outside and nearest to a corner: no contact can act.
    pub at_corner: bool,
}

impl Gap {
    /// `S - M` of the vectors behind: first coordinate and weight.
    pub fn difference(&self) -> Vec<(usize, f64)> {
        let mut list = Vec::with_capacity(self.slave.vectors.len() + self.master.vectors.len());
        list.extend(self.slave.vectors.iter().map(|(first, w)| (*first, w[0])));
        list.extend(self.master.vectors.iter().map(|(first, w)| (*first, -w[0])));
        list
    }

    /// `scale n`: the gap's change by that of `x_s - x_m`.
    pub fn pull(&self) -> Vector3<f64> {
        self.normal * self.scale
    }

    /// `dg/dq`: coordinate and value; coordinates may come twice.
    pub fn gradient(&self, components: usize) -> Vec<(usize, f64)> {
        along(&self.difference(), &self.pull(), components)
    }

    /// The free parameters of master and slave.
    fn parameters(&self) -> [Vec<usize>; 2] {
        [self.free.master, self.free.slave].map(|flags| (0..2).filter(|k| flags[*k]).collect())
    }

    /// `A = d^2 G/dP^2` with P in the order master, slave, n; and the directions e across n.
    pub fn system(&self, q: &[f64], components: usize) -> (DMatrix<f64>, Vec<Vector3<f64>>) {
        let n = self.normal;
        let across: Vec<Vector3<f64>> = if components == 2 {
            vec![Vector3::new(-n.y, n.x, 0.0)]
        } else {
            let helper = if n.x.abs() < 0.8 { Vector3::x() } else { Vector3::y() };
            let first = n.cross(&helper).normalize();
            vec![first, n.cross(&first)]
        };
        let [master, slave] = self.parameters();
        let of_n = master.len() + slave.len();
        let mut a = DMatrix::zeros(of_n + across.len(), of_n + across.len());
        for i in 0..across.len() {
            a[(of_n + i, of_n + i)] = -self.value / self.scale;
        }
        for (start, point, list, sign) in
            [(0, &self.master, &master, -1.0), (master.len(), &self.slave, &slave, 1.0)]
        {
            for (i, &p) in list.iter().enumerate() {
                let tangent = point.sum(q, FIRST[p], components);
                for (k, e) in across.iter().enumerate() {
                    let value = sign * e.dot(&tangent);
                    a[(start + i, of_n + k)] = value;
                    a[(of_n + k, start + i)] = value;
                }
                for (j, &other) in list.iter().enumerate() {
                    a[(start + i, start + j)] = sign * n.dot(&point.sum(q, SECOND[p][other], components));
                }
            }
        }
        (a, across)
    }

    /// `dG/dP`, zero where the gap is stationary; in the order of [`Self::system`].
    pub fn residual(&self, q: &[f64], components: usize, across: &[Vector3<f64>]) -> DVector<f64> {
        let [master, slave] = self.parameters();
        let apart = self.slave.sum(q, 0, components) - self.master.sum(q, 0, components);
        let of_master = master.iter().map(|&p| -self.normal.dot(&self.master.sum(q, FIRST[p], components)));
        let of_slave = slave.iter().map(|&p| self.normal.dot(&self.slave.sum(q, FIRST[p], components)));
        let all: Vec<f64> = of_master.chain(of_slave).chain(across.iter().map(|e| e.dot(&apart))).collect();
        DVector::from_vec(all)
    }

    /// The coordinates of the gradient and of the curvature, in their order; they may come twice.
    pub fn coordinates(&self, components: usize) -> Vec<usize> {
        let mut list =
            Vec::with_capacity(components * (self.slave.vectors.len() + self.master.vectors.len()));
        for (first, _) in self.slave.vectors.iter().chain(&self.master.vectors) {
            list.extend((0..components).map(|c| first + c));
        }
        list
    }

    /// Adds `factor d^2 g/dq^2` (m^-1) to a matrix between [`Self::coordinates`]. Nothing for a point that lies on a kink, where
    /// there is none.
    pub fn add_curvature(&self, q: &[f64], components: usize, factor: f64, sum: &mut DMatrix<f64>) {
        let (a, across) = self.system(q, components);
        let [master, slave] = self.parameters();
        let (of_slave, of_n) = (master.len(), master.len() + slave.len());
        let slaves = self.slave.vectors.len();
        let columns = (slaves + self.master.vectors.len()) * components;
        // transposed, so that what belongs to one parameter lies together
        let mut b = DMatrix::zeros(columns, a.nrows());
        let mut fill = |row: usize, of_slave: Option<usize>, of_master: Option<usize>, e: &Vector3<f64>| {
            for (vectors, start, index, sign) in
                [(&self.slave.vectors, 0, of_slave, 1.0), (&self.master.vectors, slaves, of_master, -1.0)]
            {
                let Some(index) = index else { continue };
                for (k, (_, w)) in vectors.iter().enumerate() {
                    (0..components)
                        .for_each(|c| b[((start + k) * components + c, row)] = sign * w[index] * e[c]);
                }
            }
        };
        for (i, e) in across.iter().enumerate() {
            fill(of_n + i, Some(0), Some(0), e);
        }
        master.iter().enumerate().for_each(|(i, &p)| fill(i, None, Some(FIRST[p]), &self.normal));
        slave.iter().enumerate().for_each(|(i, &p)| fill(of_slave + i, Some(FIRST[p]), None, &self.normal));
        let Some(inverse) = a.try_inverse().filter(|a| a.iter().all(|v| v.is_finite())) else { return };
        let left = &b * (inverse * (-self.scale * factor));
        sum.gemm(1.0, &left, &b.transpose(), 1.0);
    }
}

/// `w v` of vectors along a direction, component by component.
pub fn along(vectors: &[(usize, f64)], direction: &Vector3<f64>, components: usize) -> Vec<(usize, f64)> {
    let mut list = Vec::with_capacity(components * vectors.len());
    for (first, w) in vectors {
        list.extend((0..components).map(|c| (first + c, w * direction[c])));
    }
    list
}

/// The sum of a gradient with a vector of all coordinates.
pub fn product(gradient: &[(usize, f64)], x: &[f64]) -> f64 {
    gradient.iter().map(|(k, v)| v * x[*k]).sum()
}
