//! Coefficients of a bearing over speed and whirl frequency, with what holds between the points.
//!
//! Over the speeds x_0 < .. < x_n runs a piecewise cubic of Hermite's form with the slopes
//!
//! ```text
//!     m_k = (h_k d_{k-1} + h_{k-1} d_k)/(h_{k-1} + h_k),   h_k = x_{k+1} - x_k,   d_k = (y_{k+1} - y_k)/h_k
//! ```
//!
//! which are zero where d changes its sign and at most `3 min(|d_{k-1}|, |d_k|)` elsewhere: with `0 <= m <= 3 d` at both ends a
//! cubic is monotone (Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238). Source: docs/theory/supports.md#bearing-tables.

/// Stiffness, damping and added mass of a bearing at one state, in the fixed directions `[[yy, yz], [zy, zz]]`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coefficients {
    /// N/m.
    pub stiffness: [[f64; 2]; 2],
    /// N s/m.
    pub damping: [[f64; 2]; 2],
    /// kg.
    pub mass: [[f64; 2]; 2],
}

impl Coefficients {
    fn flat(&self) -> [f64; 12] {
        let mut list = [0.0; 12];
        let all = [self.stiffness, self.damping, self.mass];
        list.iter_mut().zip(all.iter().flatten().flatten()).for_each(|(to, from)| *to = *from);
        list
    }

    fn of(list: [f64; 12]) -> Self {
        let matrix = |k: usize| [[list[k], list[k + 1]], [list[k + 2], list[k + 3]]];
        Self { stiffness: matrix(0), damping: matrix(4), mass: matrix(8) }
    }
}

/// Coefficients of a bearing over the spin speed, and over the whirl frequency where they depend on it.
///
/// Between the points every coefficient is monotone: it passes through them and stays between its neighbours. Smooth data
/// are met to the third order in the distance of the points where they rise or fall, to the second where they turn. The
/// values are continuous everywhere, their slopes over the speed within the table, too. Beyond the points the nearest ones hold.
#[derive(Debug, Clone, PartialEq)]
pub struct BearingTable {
    /// Spin speeds, ascending, rad/s.
    speeds: Vec<f64>,
    /// Whirl frequencies, ascending, rad/s; none where nothing depends on them.
    whirls: Vec<f64>,
    /// Coefficients speed by speed, at each speed in the order of the whirl frequencies.
    rows: Vec<Coefficients>,
}

impl BearingTable {
    /// A full grid: speeds and whirl frequencies ascending (rad/s; no frequencies for coefficients that do not depend on them),
    /// one entry of `rows` for each, speed by speed. `None` if they do not ascend, their counts do not fit, or a number is none.
    pub fn new(speeds: Vec<f64>, whirls: Vec<f64>, rows: Vec<Coefficients>) -> Option<Self> {
        let ascend =
            |list: &[f64]| list.iter().all(|x| x.is_finite()) && list.windows(2).all(|w| w[0] < w[1]);
        let fits = !speeds.is_empty() && rows.len() == speeds.len() * whirls.len().max(1);
        let fits = fits && rows.iter().all(|row| row.flat().iter().all(|c| c.is_finite()));
        (fits && ascend(&speeds) && ascend(&whirls)).then_some(Self { speeds, whirls, rows })
    }

    /// Coefficients at a spin speed and a whirl frequency, rad/s; the sense of the whirl does not matter.
    pub fn at(&self, spin_speed: f64, whirl_frequency: f64) -> Coefficients {
        let columns = self.whirls.len().max(1);
        let at_speed = |i: usize| {
            let row = &self.rows[i * columns..(i + 1) * columns];
            match row {
                [one] => one.flat(),
                row => between(&self.whirls, whirl_frequency.abs(), |j| row[j].flat()),
            }
        };
        Coefficients::of(between(&self.speeds, spin_speed, at_speed))
    }

    /// Whether coefficients change with the whirl frequency.
    pub fn depends_on_whirl(&self) -> bool {
        self.whirls.len() > 1
    }

    /// First and last speed, rad/s.
    pub fn speeds(&self) -> [f64; 2] {
        ends(&self.speeds).unwrap_or_default()
    }

    /// First and last whirl frequency, rad/s, of a table that has any.
    pub fn whirls(&self) -> Option<[f64; 2]> {
        ends(&self.whirls)
    }

    /// Whether a speed (rad/s) lies beyond the table, where its first or last coefficients hold. Those of a table with one speed
    /// hold at every speed.
    pub fn outside(&self, speed: f64) -> bool {
        let [first, last] = self.speeds();
        self.speeds.len() > 1 && !(first..=last).contains(&speed)
    }
}

fn ends(list: &[f64]) -> Option<[f64; 2]> {
    Some([*list.first()?, *list.last()?])
}

/// The monotone cubic through values at ascending places, constant beyond them.
fn between<const N: usize>(places: &[f64], x: f64, value: impl Fn(usize) -> [f64; N]) -> [f64; N] {
    let last = places.len() - 1;
    if !(x > places[0]) {
        return value(0);
    }
    if x >= places[last] {
        return value(last);
    }
    // of the interval that holds x, with one point more on either side where there is one
    let i = places.partition_point(|place| *place <= x) - 1;
    let (first, end) = (i.saturating_sub(1), (i + 2).min(last));
    let near: Vec<[f64; N]> = (first..=end).map(value).collect();
    let places = &places[first..=end];
    let i = i - first;
    let h = places[i + 1] - places[i];
    let s = (x - places[i]) / h;
    std::array::from_fn(|c| {
        let values: Vec<f64> = near.iter().map(|v| v[c]).collect();
        let (a, b) = (values[i], values[i + 1]);
        let [m, n] = [i, i + 1].map(|k| slope(places, &values, k));
        let rest = 1.0 - s;
        let cubic = a * rest * rest * (1.0 + 2.0 * s)
            + b * s * s * (3.0 - 2.0 * s)
            + h * s * rest * (m * rest - n * s);
        // within rounding it may leave its neighbours
        cubic.clamp(a.min(b), a.max(b))
    })
}

/// Slope at the k-th of two to four points.
fn slope(places: &[f64], values: &[f64], k: usize) -> f64 {
    let h = |k: usize| places[k + 1] - places[k];
    let d = |k: usize| (values[k + 1] - values[k]) / h(k);
    let last = places.len() - 1;
    let (m, left, right) = match k {
        _ if last == 1 => return d(0),
        0 => (((2.0 * h(0) + h(1)) * d(0) - h(0) * d(1)) / (h(0) + h(1)), d(0), d(0)),
        k if k == last => {
            let (a, b) = (last - 1, last - 2);
            (((2.0 * h(a) + h(b)) * d(a) - h(a) * d(b)) / (h(a) + h(b)), d(a), d(a))
        }
        k => ((h(k) * d(k - 1) + h(k - 1) * d(k)) / (h(k - 1) + h(k)), d(k - 1), d(k)),
    };
    let signed = |d: f64| if d.signum() == m.signum() { d.abs() } else { 0.0 };
    m.signum() * m.abs().min(3.0 * signed(left).min(signed(right)))
}
