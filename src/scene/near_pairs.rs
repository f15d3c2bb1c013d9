//! Which parts of beams may touch, in three phases from coarse to fine.
//!
//! 1. [`near_pairs`]: pairs of items whose axis-aligned boxes come near each other, from a tree.
//! 2. [`OrientedBox::separated`]: the separating axis test of the boxes along the parts.
//! 3. [`clip`]: Cyrus and Beck's clipping of a segment, the starting guess of a projection.
//!
//! All lengths are in metres. Points have three coordinates; a plane scene keeps z = 0. Boxes enclose a curve for certain
//! if they are made of its Bezier points ([`bezier`], [`bezier_cubic`]), not of its nodes. Touching boxes overlap.

use nalgebra::Vector3;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};

/// Bezier points of the quadratic curve through nodes at -1, 0 and 1: the curve lies in their convex hull. The middle
/// one is `2 r2 - (r1 + r3) / 2`.
pub fn bezier([r1, r2, r3]: [Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    [r1, 2.0 * r2 - (r1 + r3) / 2.0, r3]
}

/// Bezier points of the cubic curve through nodes at -1, -1/3, 1/3 and 1: the curve lies in their convex hull.
pub fn bezier_cubic([r1, r2, r3, r4]: [Vector3<f64>; 4]) -> [Vector3<f64>; 4] {
    let inner = |near, next, beyond, far| (-5.0 * near + 18.0 * next - 9.0 * beyond + 2.0 * far) / 6.0;
    [r1, inner(r1, r2, r3, r4), inner(r4, r3, r2, r1), r4]
}

/// A box along the axes of coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Corner of the smallest coordinates, m.
    pub low: Vector3<f64>,
    /// Corner of the largest coordinates, m.
    pub high: Vector3<f64>,
}

impl Aabb {
    /// The smallest box around points; that of none overlaps nothing, nor does one with a coordinate that is no number.
    pub fn of_points(points: &[Vector3<f64>]) -> Self {
        let empty = Aabb { low: Vector3::repeat(f64::INFINITY), high: Vector3::repeat(f64::NEG_INFINITY) };
        // the smaller and the larger of two, where a value that is no number stays
        let lower = |a: f64, b: f64| if b < a || b.is_nan() { b } else { a };
        let upper = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
        let around = |b: Self, p| Aabb { low: b.low.zip_map(p, lower), high: b.high.zip_map(p, upper) };
        points.iter().fold(empty, around)
    }

    /// The box with every face moved outwards by `margin`, m.
    pub fn grown(&self, margin: f64) -> Self {
        Aabb { low: self.low.add_scalar(-margin), high: self.high.add_scalar(margin) }
    }

    /// Whether two boxes share a point.
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Whether the box has points and all its coordinates are finite.
    fn is_proper(&self) -> bool {
        (0..3).all(|k| self.low[k] <= self.high[k] && (self.high[k] - self.low[k]).is_finite())
    }
}

/// A box in any direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedBox {
    /// Its centre, m.
    pub centre: Vector3<f64>,
    /// Orthonormal directions of its edges.
    pub axes: [Vector3<f64>; 3],
    /// Half its extents along `axes`, m.
    pub half: [f64; 3],
}

impl OrientedBox {
    /// The smallest box around control points with one edge along `axis` and another, of those perpendicular to it, along
    /// the largest deviation from it. Points of the plane z = 0 give a box in that plane.
    ///
    /// An `axis` of zeros is replaced by the direction to the point farthest from the first one. The box of no points has
    /// no finite centre and counts as overlapping all others.
    pub fn around(points: &[Vector3<f64>], axis: Vector3<f64>) -> Self {
        let origin = points.first().copied().unwrap_or_default();
        let farthest = |part: &dyn Fn(Vector3<f64>) -> Vector3<f64>| {
            let longer = |best: Vector3<f64>, p: &Vector3<f64>| {
                let offset = part(p - origin);
                if offset.norm_squared() > best.norm_squared() { offset } else { best }
            };
            points.iter().fold(Vector3::zeros(), longer)
        };
        let along = axis
            .try_normalize(0.0)
            .or_else(|| farthest(&|offset| offset).try_normalize(0.0))
            .unwrap_or_else(Vector3::x);
        // twice, so that what is left is perpendicular to all digits
        let across = |offset: Vector3<f64>| {
            let once = offset - along * along.dot(&offset);
            once - along * along.dot(&once)
        };
        let size = farthest(&|offset| offset).norm();
        let second = farthest(&across).try_normalize(1e-8 * size).unwrap_or_else(|| {
            // straight: perpendicular in the plane z = const if the axis is in it
            let least = [Vector3::x(), Vector3::y(), Vector3::z()]
                .into_iter()
                .reduce(|a, b| if along.dot(&b).abs() <= along.dot(&a).abs() { b } else { a });
            across(least.unwrap_or_else(Vector3::z).cross(&along)).normalize()
        });
        let axes = [along, second, along.cross(&second)];
        let extent = Aabb::of_points(
            &points.iter().map(|p| Vector3::from(axes.map(|axis| axis.dot(p)))).collect::<Vec<_>>(),
        );
        let (middle, half) = ((extent.low + extent.high) / 2.0, (extent.high - extent.low) / 2.0);
        OrientedBox { centre: (0..3).map(|k| axes[k] * middle[k]).sum(), axes, half: half.into() }
    }

    /// The box around the control points of a curve, along its chord from the first to the last one.
    pub fn along_chord(points: &[Vector3<f64>]) -> Self {
        let chord = match points {
            [first, .., last] => last - first,
            _ => Vector3::zeros(),
        };
        Self::around(points, chord)
    }

    /// The box with every face moved outwards by `margin`, m.
    pub fn grown(&self, margin: f64) -> Self {
        OrientedBox { half: self.half.map(|half| half + margin), ..*self }
    }

    /// Whether the boxes share no point: there is a direction L, among their six axes and the nine products of two of
    /// them, with `|T . L| > sum_k a_k |A_k . L| + b_k |B_k . L|`; T joins the centres, a_k and b_k are *half* extents.
    /// In a plane scene the two axes of each box that lie in the plane are enough, and come first.
    ///
    /// A direction that rounding has spoiled, as the product of nearly parallel axes, is still a direction: boxes found
    /// apart along it are apart. The product of parallel axes is zero and shows nothing, nor is it needed.
    ///
    /// Source: S. Gottschalk, M. C. Lin, D. Manocha, OBBTree, SIGGRAPH 1996. Eq. 24 of the source on contact of beams
    /// halves the half extents once more.
    pub fn separated(&self, other: &Self) -> bool {
        let distance = other.centre - self.centre;
        let radius =
            |b: &Self, l: &Vector3<f64>| (0..3).map(|k| b.half[k] * b.axes[k].dot(l).abs()).sum::<f64>();
        let apart = |l: &Vector3<f64>| distance.dot(l).abs() > radius(self, l) + radius(other, l);
        (0..3).any(|k| apart(&self.axes[k]) || apart(&other.axes[k]))
            || self.axes.iter().any(|a| other.axes.iter().any(|b| apart(&a.cross(b))))
    }
}

/// Part of the segment from `a0` to `a1` within a convex polygon (corners counter-clockwise, at least three) in the plane
/// of x and y: the parameters (from 0 at a0 to 1 at a1) where it enters and leaves, or `None` if it stays outside.
///
/// The polygon is grown by 1e-14 of the largest coordinate, so that rounding can't lose a segment on one of its edges. A
/// segment of zero length within the polygon gives (0, 1).
///
/// Source: M. Cyrus, J. Beck, Generalized two- and three-dimensional clipping, Computers & Graphics 3 (1978) 23-28.
pub fn clip(a0: Vector3<f64>, a1: Vector3<f64>, polygon: &[Vector3<f64>]) -> Option<(f64, f64)> {
    if polygon.len() < 3 {
        return None;
    }
    let largest = polygon.iter().chain([&a0, &a1]).fold(0.0_f64, |m, p| m.max(p.x.abs()).max(p.y.abs()));
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for (from, to) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        // the outward normal n of the edge; inside, n . (a0 - from) + t n . (a1 - a0) <= 0
        let (nx, ny) = (to.y - from.y, from.x - to.x);
        let room = nx * (from.x - a0.x) + ny * (from.y - a0.y) + 1e-14 * largest * nx.hypot(ny);
        let rate = nx * (a1.x - a0.x) + ny * (a1.y - a0.y);
        if rate > 0.0 {
            leaves = leaves.min(room / rate);
        } else if rate < 0.0 {
            enters = enters.max(room / rate);
        } else if !(room >= 0.0) {
            // written so that a coordinate that is no number is outside
            return None;
        }
    }
    (enters <= leaves).then_some((enters, leaves))
}

/// Pairs `(i, j)`, i < j, in ascending order, of boxes nearer than `distance` (m) along every axis; found in a tree of the boxes.
/// Pairs of which `left_out` is true, such as neighbours on one beam, are not listed, nor any with a box that is empty or not
/// finite.
pub fn near_pairs(
    boxes: &[Aabb],
    distance: f64,
    left_out: impl Fn(usize, usize) -> bool,
) -> Vec<(usize, usize)> {
    let item = |(index, b): (usize, &Aabb)| {
        let grown = b.grown(distance / 2.0);
        let shape = Rectangle::from_corners(grown.low.into(), grown.high.into());
        b.is_proper().then(|| GeomWithData::<Rectangle<[f64; 3]>, usize>::new(shape, index))
    };
    let tree = RTree::bulk_load(boxes.iter().enumerate().filter_map(item).collect());
    let mut pairs: Vec<(usize, usize)> = tree
        .intersection_candidates_with_other_tree(&tree)
        .map(|(a, b)| (a.data, b.data))
        .filter(|&(i, j)| i < j && !left_out(i, j))
        .collect();
    pairs.sort_unstable();
    pairs
}
