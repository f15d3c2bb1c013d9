//! Points, rectangles, and lines cut at a rectangle or rid of points that nobody sees, in logical pixels (x to the right, y downwards).

/// A point in logical pixels.
pub type Point = (f64, f64);

/// An upright rectangle in logical pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Left edge, logical pixels from the left of the figure.
    pub left: f64,
    /// Upper edge, logical pixels from the top of the figure.
    pub top: f64,
    /// Right edge, logical pixels from the left of the figure.
    pub right: f64,
    /// Lower edge, logical pixels from the top of the figure.
    pub bottom: f64,
}

impl Rect {
    /// The rectangle of this width and height around a centre.
    pub fn around(center: Point, width: f64, height: f64) -> Self {
        let (x, y) = center;
        Self {
            left: x - width / 2.0,
            top: y - height / 2.0,
            right: x + width / 2.0,
            bottom: y + height / 2.0,
        }
    }
    /// Width.
    pub fn width(&self) -> f64 {
        self.right - self.left
    }
    /// Height.
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }
    /// Centre.
    pub fn center(&self) -> Point {
        ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0)
    }
    /// The rectangle with all edges moved outwards.
    pub fn grown(&self, by: f64) -> Self {
        Self { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }
    /// Whether a point lies in it, edges included.
    pub fn contains(&self, (x, y): Point) -> bool {
        self.left <= x && x <= self.right && self.top <= y && y <= self.bottom
    }
    /// Whether another rectangle lies in it.
    pub fn encloses(&self, other: &Rect) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right, other.bottom))
    }
    /// Whether both share more than an edge.
    pub fn overlaps(&self, other: &Rect) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}

/// Distance of two points.
pub fn distance(a: Point, b: Point) -> f64 {
    ((a.0 - b.0).powi(2) + (a.1 - b.1).powi(2)).sqrt()
}

/// The point a fraction of the way from one point to another.
pub fn between(a: Point, b: Point, fraction: f64) -> Point {
    (a.0 + fraction * (b.0 - a.0), a.1 + fraction * (b.1 - a.1))
}

/// The stretches of a polygonal line that lie inside a rectangle.
pub fn clip(points: &[Point], rect: Rect) -> Vec<Vec<Point>> {
    let mut stretches: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        let Some((start, end)) = clip_segment(pair[0], pair[1], rect) else { continue };
        match stretches.last_mut() {
            Some(stretch) if stretch.last() == Some(&start) => stretch.push(end),
            _ => stretches.push(vec![start, end]),
        }
    }
    stretches
}

/// The part of a segment inside a rectangle (Liang and Barsky 1984).
pub fn clip_segment(from: Point, to: Point, rect: Rect) -> Option<(Point, Point)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let edges = [
        (-dx, from.0 - rect.left),
        (dx, rect.right - from.0),
        (-dy, from.1 - rect.top),
        (dy, rect.bottom - from.1),
    ];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (towards, room) in edges {
        if towards == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if towards < 0.0 {
            enter = enter.max(room / towards);
        } else {
            leave = leave.min(room / towards);
        }
    }
    if enter > leave {
        return None;
    }
    let start = if enter == 0.0 { from } else { between(from, to, enter) };
    let end = if leave == 1.0 { to } else { between(from, to, leave) };
    Some((start, end))
}

/// The line without points that lie within `tolerance` pixels of it without them (Douglas and Peucker 1973).
pub fn simplified(points: &[Point], tolerance: f64) -> Vec<Point> {
    let Some(end) = points.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; points.len()];
    (kept[0], kept[end]) = (true, true);
    let mut stretches = vec![(0, end)];
    while let Some((from, to)) = stretches.pop() {
        let mut farthest = (from, tolerance);
        for k in from + 1..to {
            let far = distance_to_segment(points[k], points[from], points[to]);
            if far > farthest.1 {
                farthest = (k, far);
            }
        }
        if farthest.0 > from {
            kept[farthest.0] = true;
            stretches.extend([(from, farthest.0), (farthest.0, to)]);
        }
    }
    points.iter().zip(kept).filter_map(|(point, kept)| kept.then_some(*point)).collect()
}

fn distance_to_segment(point: Point, from: Point, to: Point) -> f64 {
    let (along, offset) = ((to.0 - from.0, to.1 - from.1), (point.0 - from.0, point.1 - from.1));
    let square = along.0 * along.0 + along.1 * along.1;
    let fraction = if square > 0.0 { (along.0 * offset.0 + along.1 * offset.1) / square } else { 0.0 };
    distance(point, between(from, to, fraction.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_clipped_at_the_frame() {
        let frame = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        assert_eq!(
            clip(&[(-5.0, 5.0), (5.0, 5.0), (15.0, 5.0)], frame),
            [[(0.0, 5.0), (5.0, 5.0), (10.0, 5.0)]]
        );
        assert_eq!(clip(&[(5.0, 5.0), (5.0, 20.0), (8.0, 20.0), (8.0, 5.0)], frame).len(), 2);
        assert!(clip(&[(-5.0, -1.0), (15.0, -1.0)], frame).is_empty());
    }
}
