//! Places of labels: where they cover least, and apart from one another.

use std::f64::consts::TAU;

use crate::draw::clip::{Point, Rect, between, clip_segment, distance};

/// Positions as near as possible (least squares) to the wanted ones, in the same order, at least `gap` apart and
/// within `[low, high]`; the gap shrinks if there is too little room.
pub fn spread(wanted: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    if wanted.is_empty() {
        return Vec::new();
    }
    let steps = (wanted.len() - 1) as f64;
    let gap = if steps * gap > high - low { (high - low) / steps } else { gap };
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // With the gaps subtracted, positions need only ascend: isotonic regression by pooling, then clamping.
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (rank, &index) in order.iter().enumerate() {
        let mut pool = (wanted[index] - rank as f64 * gap, 1);
        while let Some(&(mean, count)) = pools.last() {
            if mean <= pool.0 {
                break;
            }
            pools.pop();
            let total = count + pool.1;
            pool = ((mean * count as f64 + pool.0 * pool.1 as f64) / total as f64, total);
        }
        pools.push(pool);
    }
    let highest = (high - steps * gap).max(low);
    let ascending =
        pools.iter().flat_map(|&(mean, count)| std::iter::repeat_n(mean.clamp(low, highest), count));
    let mut placed = vec![0.0; wanted.len()];
    for ((rank, &index), position) in order.iter().enumerate().zip(ascending) {
        placed[index] = position + rank as f64 * gap;
    }
    placed
}

/// What labels inside the frame should not cover.
pub struct Obstacles {
    frame: Rect,
    boxes: Vec<Rect>,
    dots: Vec<Point>,
    samples: Vec<Point>,
    leaders: Vec<(Point, Point)>,
}

impl Obstacles {
    /// Labels stay inside the frame and off these points.
    pub fn new(frame: Rect, dots: Vec<Point>) -> Self {
        Self { frame, boxes: Vec::new(), dots, samples: Vec::new(), leaders: Vec::new() }
    }

    /// Adds a label that is there already.
    pub fn add_label(&mut self, place: Rect) {
        self.boxes.push(place);
    }

    /// Adds a curve. It weighs by its length, so it counts as points at equal distances.
    pub fn add_line(&mut self, line: &[Point]) {
        self.samples.extend(line.first());
        for pair in line.windows(2) {
            let pieces = (distance(pair[0], pair[1]) / 4.0).ceil().max(1.0);
            let inner = (1..=pieces as usize).map(|piece| piece as f64 / pieces);
            self.samples.extend(inner.map(|fraction| between(pair[0], pair[1], fraction)));
        }
    }

    /// Badness of a label; labels above all must not lie on one another.
    fn cost(&self, label: &Rect, leader: Option<(Point, Point)>) -> f64 {
        let covers = |points: &[Point], margin: f64| {
            let grown = label.grown(margin);
            points.iter().filter(|&&point| grown.contains(point)).count() as f64
        };
        let count = |hits: usize| hits as f64;
        let mut cost = covers(&self.samples, 1.0) + 40.0 * covers(&self.dots, 3.0);
        cost += 1000.0 * count(self.boxes.iter().filter(|other| other.overlaps(&label.grown(1.0))).count());
        cost +=
            100.0 * count(self.leaders.iter().filter(|l| clip_segment(l.0, l.1, *label).is_some()).count());
        if let Some((from, to)) = leader {
            cost +=
                100.0 * count(self.boxes.iter().filter(|b| clip_segment(from, to, **b).is_some()).count());
            cost += 30.0 * count(self.leaders.iter().filter(|l| cross(**l, (from, to))).count());
        }
        cost
    }

    /// Takes the best place for a label around a point; its leader starts there.
    pub fn near(&mut self, anchor: Point, (width, height): (f64, f64)) -> Rect {
        let mut best = (f64::INFINITY, Rect::around(anchor, width, height));
        for ring in 0..10 {
            let gap = 7.0 + 9.0 * f64::from(ring);
            for step in 0..24 {
                let (sine, cosine) = (f64::from(step) * TAU / 24.0).sin_cos();
                let away = (cosine * (gap + width / 2.0), -sine * (gap + height / 2.0));
                let place = Rect::around((anchor.0 + away.0, anchor.1 + away.1), width, height);
                if !self.frame.grown(-1.0).encloses(&place) {
                    continue;
                }
                let leader = (anchor, nearest(place, anchor));
                let cost = self.cost(&place, Some(leader)) + 0.15 * gap;
                if cost < best.0 {
                    best = (cost, place);
                }
            }
        }
        self.boxes.push(best.1);
        self.leaders.push((anchor, nearest(best.1, anchor)));
        best.1
    }

    /// Takes the best place for a label beside a straight line, near its far end.
    pub fn along(&mut self, from: Point, to: Point, (width, height): (f64, f64)) -> Option<Rect> {
        let length = distance(from, to);
        let mut best: Option<(f64, Rect)> = None;
        for step in 0..30 {
            let back = 12.0 + 8.0 * f64::from(step);
            if back > length {
                break;
            }
            let (x, y) = between(to, from, back / length);
            let (right, down) = (width / 2.0 + 4.0, height / 2.0 + 2.0);
            for (dx, dy) in
                [(-right, -down), (right, down), (-right, 0.0), (right, 0.0), (0.0, -down), (0.0, down)]
            {
                let place = Rect::around((x + dx, y + dy), width, height);
                if !self.frame.grown(-1.0).encloses(&place) {
                    continue;
                }
                let cost = self.cost(&place, None) + 0.02 * back;
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, place));
                }
            }
        }
        let place = best.map(|(_, place)| place)?;
        self.boxes.push(place);
        Some(place)
    }
}

/// The point of a rectangle nearest to another point.
pub fn nearest(rect: Rect, (x, y): Point) -> Point {
    (x.clamp(rect.left, rect.right), y.clamp(rect.top, rect.bottom))
}

/// Whether two segments cross in their insides.
fn cross((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
    let side = |from: Point, to: Point, p: Point| {
        (to.0 - from.0) * (p.1 - from.1) - (to.1 - from.1) * (p.0 - from.0)
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn spread_labels_keep_their_distance_order_and_bounds(
            wanted in proptest::collection::vec(-50.0..150.0f64, 0..60),
            gap in 0.0..5.0f64,
        ) {
            let placed = spread(&wanted, gap, 0.0, 100.0);
            prop_assert_eq!(placed.len(), wanted.len());
            let gap = gap.min(100.0 / (wanted.len() as f64 - 1.0).max(1.0));
            for (i, &a) in placed.iter().enumerate() {
                prop_assert!((-1e-9..=100.0 + 1e-9).contains(&a));
                for (j, &b) in placed.iter().enumerate().skip(i + 1) {
                    prop_assert!((a - b).abs() >= gap - 1e-9);
                    prop_assert!(wanted[i] == wanted[j] || gap == 0.0 || (a < b) == (wanted[i] < wanted[j]));
                }
            }
        }
    }

    #[test]
    fn labels_with_room_stay_where_they_belong() {
        assert_eq!(spread(&[90.0, 10.0, 50.0], 12.0, 0.0, 100.0), [90.0, 10.0, 50.0]);
        assert_eq!(spread(&[50.0, 50.0], 10.0, 0.0, 100.0), [45.0, 55.0]);
        assert_eq!(spread(&[0.0, 0.0], 10.0, 0.0, 100.0), [0.0, 10.0]);
    }
}
