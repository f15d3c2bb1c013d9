//! Detection of contact: every phase against another way to the same answer.

use nalgebra::{Rotation3, Unit, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng};
use rotor::scene::near_pairs::{Aabb, OrientedBox, bezier, bezier_cubic, clip, near_pairs};
use std::f64::consts::PI;

type Point = Vector3<f64>;

fn random() -> TestRng {
    TestRng::deterministic_rng(RngAlgorithm::ChaCha)
}

fn point(random: &mut TestRng, size: f64, planar: bool) -> Point {
    let mut coordinate = || random.random_range(-size..size);
    Point::new(coordinate(), coordinate(), if planar { 0.0 } else { coordinate() })
}

fn holds(b: &OrientedBox, p: &Point, tolerance: f64) -> bool {
    (0..3).all(|k| (p - b.centre).dot(&b.axes[k]).abs() <= b.half[k] + tolerance)
}

/// Boxes of Bezier points enclose the whole curve, along the axes and along the chord; boxes of nodes often don't.
#[test]
fn curves_lie_in_the_boxes_of_their_bezier_points() {
    let mut random = random();
    let mut out_of_nodes = 0;
    for case in 0..300 {
        let mut node = || point(&mut random, 1.0, case % 2 == 0);
        let (nodes, cubic) = ([node(), node(), node()], [node(), node(), node(), node()]);
        let (control, cubic_control) = (bezier(nodes), bezier_cubic(cubic));
        let by_nodes = Aabb::of_points(&nodes);
        let mut stuck_out = false;
        for step in 0..=200 {
            let x = -1.0 + step as f64 / 100.0;
            let quadratic =
                nodes[0] * x * (x - 1.0) / 2.0 + nodes[1] * (1.0 - x * x) + nodes[2] * x * (x + 1.0) / 2.0;
            let lagrange = |i: usize| {
                let at = |k: usize| -1.0 + 2.0 * k as f64 / 3.0;
                (0..4).filter(|&k| k != i).map(|k| (x - at(k)) / (at(i) - at(k))).product::<f64>()
            };
            let cubic_point: Point = (0..4).map(|i| cubic[i] * lagrange(i)).sum();
            for (control, p) in [(&control[..], quadratic), (&cubic_control[..], cubic_point)] {
                let p_box = Aabb { low: p, high: p };
                assert!(Aabb::of_points(control).grown(1e-12).overlaps(&p_box), "{case}, {x}");
                assert!(holds(&OrientedBox::along_chord(control), &p, 1e-12), "{case}, {x}");
            }
            stuck_out |= !by_nodes.grown(1e-9).overlaps(&Aabb { low: quadratic, high: quadratic });
        }
        out_of_nodes += usize::from(stuck_out);
    }
    assert!(out_of_nodes > 100, "{out_of_nodes} curves stick out of the boxes of their nodes");
}

/// The box around a curve touches it: no face can move inwards.
#[test]
fn boxes_are_tight_and_of_orthonormal_axes() {
    let mut random = random();
    for case in 0..200 {
        let mut points: Vec<Point> =
            (0..3 + case % 5).map(|_| point(&mut random, 1.0, case % 2 == 0)).collect();
        match case % 10 {
            // straight, straight but for rounding, and all in one place
            7 => points.iter_mut().enumerate().for_each(|(i, p)| *p = Point::new(0.3, 0.4, 0.0) * i as f64),
            8 => points
                .iter_mut()
                .enumerate()
                .for_each(|(i, p)| *p = Point::new(0.1, 0.7, 1e-9 * p.z) * i as f64),
            9 => points.iter_mut().for_each(|p| *p = Point::new(0.3, 0.4, 0.5)),
            _ => {}
        }
        let b = OrientedBox::along_chord(&points);
        for i in 0..3 {
            for j in 0..3 {
                let exact = f64::from(u8::from(i == j));
                assert!((b.axes[i].dot(&b.axes[j]) - exact).abs() < 1e-14, "{case}: {:?}", b.axes);
            }
            let reach = |sign: f64| {
                points.iter().map(|p| sign * (p - b.centre).dot(&b.axes[i])).fold(f64::NEG_INFINITY, f64::max)
            };
            assert!(
                (reach(1.0) - b.half[i]).abs() < 1e-14 && (reach(-1.0) - b.half[i]).abs() < 1e-14,
                "{case}"
            );
        }
        if points.iter().all(|p| p.z == 0.0) {
            assert!(b.half[2] == 0.0 && b.axes[1].z == 0.0 && b.centre.z == 0.0, "{case}: {b:?}");
        }
    }
    // boxes that touch at a face overlap
    let cube = |x: f64| OrientedBox {
        centre: Point::new(x, 0.0, 0.0),
        axes: [Point::x(), Point::y(), Point::z()],
        half: [0.5; 3],
    };
    assert!(!cube(0.0).separated(&cube(1.0)) && cube(0.0).separated(&cube(1.0 + 1e-12)));
    assert!(!cube(0.0).separated(&cube(1.25).grown(0.25)) && cube(0.0).grown(0.25).separated(&cube(1.26)));
    // a box of no points can't be told apart from anything
    let some = OrientedBox::along_chord(&[Point::x(), Point::y()]);
    assert!(!OrientedBox::along_chord(&[]).separated(&some));
}

fn corners(b: &OrientedBox, margin: f64) -> Vec<Point> {
    let (x, y) = (b.axes[0] * (b.half[0] + margin), b.axes[1] * (b.half[1] + margin));
    vec![b.centre - x - y, b.centre + x - y, b.centre + x + y, b.centre - x + y]
}

/// Whether two convex polygons (counter-clockwise) share a point: Sutherland and Hodgman's clipping of one by the other.
fn polygons_meet(a: &[Point], b: &[Point]) -> bool {
    let mut left = a.to_vec();
    for (k, from) in b.iter().enumerate() {
        let edge = b[(k + 1) % b.len()] - from;
        let inside = |p: &Point| edge.x * (p.y - from.y) - edge.y * (p.x - from.x);
        let mut next = Vec::new();
        for (i, p) in left.iter().enumerate() {
            let q = &left[(i + 1) % left.len()];
            let (at_p, at_q) = (inside(p), inside(q));
            if at_p >= 0.0 {
                next.push(*p);
            }
            if (at_p >= 0.0) != (at_q >= 0.0) {
                next.push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        left = next;
    }
    !left.is_empty()
}

/// Random boxes, every fourth pair parallel or at right angles. Two that meet grown by 1e-12 but not shrunk by as much
/// just touch and are left out.
#[test]
fn separating_axes_agree_with_clipping_in_the_plane() {
    let mut random = random();
    let (mut met, mut skipped) = (0, 0);
    for case in 0..4000 {
        let start: f64 = random.random_range(-PI..PI);
        let turn = if case % 4 == 0 { PI / 2.0 * f64::from(case % 3) } else { random.random_range(-PI..PI) };
        let mut new = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            OrientedBox {
                centre: point(&mut random, 1.0, true),
                axes: [Point::new(cos, sin, 0.0), Point::new(-sin, cos, 0.0), Point::z()],
                half: [random.random_range(0.05..1.0), random.random_range(0.05..0.5), 0.0],
            }
        };
        let (a, b) = (new(start), new(start + turn));
        let exact = polygons_meet(&corners(&a, 1e-12), &corners(&b, 1e-12));
        if exact != polygons_meet(&corners(&a, -1e-12), &corners(&b, -1e-12)) {
            skipped += 1;
            continue;
        }
        assert!(a.separated(&b) != exact && b.separated(&a) != exact, "{case}: {a:?}, {b:?}");
        met += usize::from(exact);
    }
    assert!(skipped < 5 && (1000..3000).contains(&met), "{met} met, {skipped} skipped");
}

/// Two boxes meet if and only if an edge of one passes through the other: the common part has a corner, where faces of
/// both and so an edge of one meet, or is a corner of one.
fn solids_meet(a: &OrientedBox, b: &OrientedBox) -> bool {
    let pierced = |a: &OrientedBox, b: &OrientedBox| {
        (0..12).any(|edge| {
            let (k, signs) =
                (edge / 4, [f64::from(edge % 2) * 2.0 - 1.0, f64::from(edge / 2 % 2) * 2.0 - 1.0]);
            let (k1, k2) = ((k as usize + 1) % 3, (k as usize + 2) % 3);
            let along = a.axes[k as usize] * a.half[k as usize];
            let middle =
                a.centre + a.axes[k1] * (signs[0] * a.half[k1]) + a.axes[k2] * (signs[1] * a.half[k2]);
            let (mut enters, mut leaves) = (-1.0_f64, 1.0_f64);
            for i in 0..3 {
                let (at, rate) = ((middle - b.centre).dot(&b.axes[i]), along.dot(&b.axes[i]));
                if rate == 0.0 {
                    if at.abs() > b.half[i] {
                        return false;
                    }
                    continue;
                }
                let (t, u) = ((-b.half[i] - at) / rate, (b.half[i] - at) / rate);
                enters = enters.max(t.min(u));
                leaves = leaves.min(t.max(u));
            }
            enters <= leaves
        })
    };
    pierced(a, b) || pierced(b, a)
}

/// Random boxes, some of parallel axes, some with one axis in common, some turned by a hair.
#[test]
fn separating_axes_agree_with_edges_through_solids() {
    let mut random = random();
    let (mut met, mut skipped, mut only_by_edges) = (0, 0, 0);
    for case in 0..6000 {
        let mut turned = |largest: f64| {
            let axis = Unit::try_new(point(&mut random, 1.0, false), 1e-9).unwrap_or(Vector3::x_axis());
            Rotation3::from_axis_angle(&axis, random.random_range(-largest..largest))
        };
        let first = turned(PI);
        let second = match case % 6 {
            0 => first,
            1 => first * Rotation3::from_axis_angle(&Vector3::y_axis(), turned(PI).angle()),
            2 => turned(1e-9) * first,
            _ => turned(PI),
        };
        let mut new = |rotation: &Rotation3<f64>| OrientedBox {
            centre: point(&mut random, 0.8, false),
            axes: [0, 1, 2].map(|k| rotation.matrix().column(k).into_owned()),
            half: [0, 1, 2].map(|_| random.random_range(0.05..0.8)),
        };
        let (a, b) = (new(&first), new(&second));
        let exact = solids_meet(&a.grown(1e-12), &b.grown(1e-12));
        if exact != solids_meet(&a.grown(-1e-12), &b.grown(-1e-12)) {
            skipped += 1;
            continue;
        }
        assert!(a.separated(&b) != exact && b.separated(&a) != exact, "{case}: {a:?}, {b:?}");
        met += usize::from(exact);
        // pairs for which the axes of the boxes themselves don't do
        let apart_along = |l: &Point| {
            let reach = |b: &OrientedBox| (0..3).map(|k| b.half[k] * b.axes[k].dot(l).abs()).sum::<f64>();
            (b.centre - a.centre).dot(l).abs() > reach(&a) + reach(&b)
        };
        only_by_edges += usize::from(!exact && !a.axes.iter().chain(&b.axes).any(apart_along));
    }
    assert!(skipped < 5 && (1500..4500).contains(&met), "{met} met, {skipped} skipped");
    assert!(only_by_edges > 30, "{only_by_edges} pairs need the products of edges");
}

/// Counter-clockwise polygons on an ellipse.
fn polygon(random: &mut TestRng) -> Vec<Point> {
    let count = random.random_range(3..8);
    let mut angles: Vec<f64> = (0..count).map(|_| random.random_range(0.0..2.0 * PI)).collect();
    angles.sort_by(f64::total_cmp);
    let (centre, size) = (point(random, 0.5, true), random.random_range(0.3..1.0));
    angles.iter().map(|a| centre + Point::new(size * a.cos(), 0.6 * a.sin(), 0.0)).collect()
}

/// Samples of the segment are inside where, and only where, the parameters say so.
#[test]
fn clipping_agrees_with_samples() {
    let mut random = random();
    let mut hits = 0;
    for case in 0..2000 {
        let corners = polygon(&mut random);
        let (a0, a1) = (point(&mut random, 1.0, true), point(&mut random, 1.0, true));
        let part = clip(a0, a1, &corners);
        hits += usize::from(part.is_some());
        for step in 0..=200 {
            let t = f64::from(step) / 200.0;
            let p = a0 + (a1 - a0) * t;
            let inside = |k: usize| {
                let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
                (to - from).cross(&(p - from)).z >= 0.0
            };
            let inside = (0..corners.len()).all(inside);
            match part {
                None => assert!(!inside, "{case}, {t}"),
                Some((enters, leaves)) => {
                    let near_end = (t - enters).abs() < 1e-9 || (t - leaves).abs() < 1e-9;
                    assert!(near_end || inside == (enters < t && t < leaves), "{case}, {t}: {part:?}");
                }
            }
        }
    }
    assert!((500..1500).contains(&hits), "{hits}");
}

#[test]
fn clipping_of_special_segments() {
    for angle in [0.0, 0.3, 1.1, 2.0, 4.0] {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let at = |x: f64, y: f64| turn * Point::new(x, y, 0.0);
        let square = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        let check = |a0, a1, exact: Option<(f64, f64)>| {
            let part = clip(a0, a1, &square);
            let same = match (part, exact) {
                (Some(a), Some(b)) => (a.0 - b.0).abs() < 1e-12 && (a.1 - b.1).abs() < 1e-12,
                (a, b) => a == b,
            };
            assert!(same, "{angle}: {part:?} instead of {exact:?}");
        };
        check(at(-2.0, 0.5), at(2.0, 0.5), Some((0.25, 0.75)));
        check(at(0.0, 0.0), at(4.0, 0.0), Some((0.0, 0.25)));
        // on an edge, within it, beyond both ends, and beside it
        check(at(-0.5, 1.0), at(0.5, 1.0), Some((0.0, 1.0)));
        check(at(-2.0, 1.0), at(2.0, 1.0), Some((0.25, 0.75)));
        check(at(2.0, 1.0), at(3.0, 1.0), None);
        check(at(-2.0, 1.001), at(2.0, 1.001), None);
        // of no length: inside, outside, on an edge and on a corner
        check(at(0.3, 0.2), at(0.3, 0.2), Some((0.0, 1.0)));
        check(at(1.3, 0.2), at(1.3, 0.2), None);
        check(at(1.0, 0.2), at(1.0, 0.2), Some((0.0, 1.0)));
        check(at(1.0, 1.0), at(1.0, 1.0), Some((0.0, 1.0)));
        // past a corner, and values that are no numbers
        check(at(0.0, 2.5), at(2.5, 0.0), None);
        check(at(f64::NAN, 0.0), at(0.0, 0.0), None);
        assert_eq!(clip(at(0.0, 0.0), at(1.0, 0.0), &square[..2]), None);
        assert_eq!(clip(at(0.0, 0.0), at(1.0, 0.0), &[]), None);
        // an edge twice does no harm
        let doubled = [square[0], square[1], square[1], square[2], square[3]];
        assert!(clip(at(0.0, 0.0), at(0.5, 0.0), &doubled).is_some());
    }
}

fn all_pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |i| (i + 1..count).map(move |j| (i, j)))
}

#[test]
fn candidates_are_the_pairs_of_overlapping_grown_boxes() {
    let mut random = random();
    for planar in [true, false] {
        let mut boxes: Vec<Aabb> = (0..300)
            .map(|_| {
                let at = point(&mut random, 1.0, planar);
                Aabb::of_points(&[at, at + point(&mut random, 0.1, planar)])
            })
            .collect();
        let margin = 0.02;
        let near = |boxes: &[Aabb], i: usize, j: usize| {
            j != i + 1 && boxes[i].grown(margin).overlaps(&boxes[j].grown(margin))
        };
        let pairs = near_pairs(&boxes, 2.0 * margin, |i, j| j == i + 1);
        let exact: Vec<_> = all_pairs(300).filter(|&(i, j)| near(&boxes, i, j)).collect();
        assert!(exact.len() > 30);
        assert_eq!(pairs, exact);

        // boxes without points or of no number take part in nothing
        boxes[7] = Aabb::of_points(&[]);
        boxes[8] = Aabb::of_points(&[Point::zeros(), Point::new(f64::NAN, 0.0, 0.0), Point::zeros()]);
        let pairs = near_pairs(&boxes, 2.0 * margin, |_, _| false);
        assert!(!pairs.is_empty());
        assert!(pairs.iter().all(|&(i, j)| ![7, 8].contains(&i) && ![7, 8].contains(&j)));
    }
    assert!(near_pairs(&[], 0.1, |_, _| false).is_empty());
}
