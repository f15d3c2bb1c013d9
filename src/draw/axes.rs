//! Axes: scales, ticks, labels and grids.

use crate::draw::clip::Rect;
use crate::draw::palette::{BLACK, Font, LABEL_SIZE, LIGHT_GREY, Stroke, TICK_SIZE};
use crate::draw::pen::Pen;
use crate::draw::text::{Anchor, axis_label, superscript, text_width};

/// Linear map from a quantity to logical pixels.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Quantity at `start`.
    pub low: f64,
    /// Quantity at `end`.
    pub high: f64,
    /// Pixel of `low`.
    pub start: f64,
    /// Pixel of `high`.
    pub end: f64,
}

impl Scale {
    /// Pixel of a value, bounded so that far-off values stay drawable (and clippable).
    pub fn pixel(&self, value: f64) -> f64 {
        let fraction = (value - self.low) / (self.high - self.low);
        (self.start + fraction * (self.end - self.start)).clamp(-1e6, 1e6)
    }
    /// The same pixels for the quantity in another unit.
    pub fn times(&self, factor: f64) -> Self {
        Self { low: self.low * factor, high: self.high * factor, ..*self }
    }
}

/// Tick values of an axis with the power of ten taken out of their labels.
#[derive(Debug, Clone, PartialEq)]
pub struct Ticks {
    /// Value and label of each tick, ascending.
    pub marks: Vec<(f64, String)>,
    /// Power of ten the labels are to be multiplied by; a multiple of three.
    pub exponent: i32,
}

/// At most about `count` ticks at multiples of 1, 2 or 5 times a power of ten within `[low, high]`.
pub fn ticks(low: f64, high: f64, count: f64) -> Ticks {
    let step = nice_step((high - low) / count.max(1.0));
    let largest = low.abs().max(high.abs());
    let exponent =
        if (0.01..1e5).contains(&largest) { 0 } else { 3 * (largest.log10() / 3.0).floor() as i32 };
    let unit = 10f64.powi(exponent);
    let decimals = (-(step / unit * 1.001).log10().floor()).clamp(0.0, 9.0) as usize;
    let first = (low / step - 1e-9).ceil();
    let number = ((high / step + 1e-9).floor() - first).clamp(0.0, 50.0) as usize;
    let mark = |index: usize| {
        // Adding zero turns a negative zero into a positive one.
        let value = (first + index as f64) * step + 0.0;
        (value, format!("{:.decimals$}", value / unit + 0.0))
    };
    Ticks { marks: (0..=number).map(mark).collect(), exponent }
}

fn nice_step(least: f64) -> f64 {
    if !(least.is_finite() && least > 0.0) {
        return 1.0;
    }
    let power = 10f64.powi(least.log10().floor() as i32);
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= least * 0.999).unwrap_or(10.0);
    factor * power
}

/// Side of a plot an axis stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The axis lies below the panel.
    Bottom,
    /// The axis lies above the panel.
    Top,
    /// To the left.
    Left,
    /// To the right.
    Right,
}

/// Distance of an axis' label from the axis (its centre), horizontal and vertical axes.
const LABEL_DISTANCE: (f64, f64) = (43.0, 67.0);
/// Distance of the label of a logarithmic axis from it, horizontal and vertical axes.
const DECADES_LABEL_DISTANCE: (f64, f64) = (44.0, 80.0);
/// Greatest distance of a label from a vertical axis.
const FARTHEST_LABEL: f64 = 84.0;
/// Distance of the labels of ticks from horizontal axes (their centres) and from vertical ones (their ends).
const TICK_LABEL_DISTANCE: (f64, f64) = (17.0, 9.0);

/// Draws ticks, tick labels and the axis label; the axis runs along `at` (a y for horizontal, an x for vertical axes).
pub fn axis(pen: &mut Pen, side: Side, at: f64, scale: Scale, quantity: &str, unit: &str) {
    let horizontal = matches!(side, Side::Bottom | Side::Top);
    let spacing = if horizontal { 85.0 } else { 48.0 };
    let ticks = ticks(scale.low, scale.high, (scale.end - scale.start).abs() / spacing);
    let words = axis_label(quantity, unit, ticks.exponent);
    let marks = ticks.marks.into_iter();
    let marks: Vec<Tick> =
        marks.map(|(value, label)| Tick { at: scale.pixel(value), length: TICK, label }).collect();
    // wide labels push the words away, as far as there is room
    let widest = marks.iter().map(|tick| text_width(&tick.label, TICK_SIZE)).fold(0.0, f64::max);
    let clear = TICK_LABEL_DISTANCE.1 + widest + 0.7 * LABEL_SIZE;
    let distances = (LABEL_DISTANCE.0, clear.clamp(LABEL_DISTANCE.1, FARTHEST_LABEL));
    draw(pen, side, at, (scale.start + scale.end) / 2.0, marks, &words, distances);
}

/// Length of a tick with a label, and of one without.
const TICK: f64 = 6.0;
const SHORT_TICK: f64 = 3.0;

/// A tick at a pixel along its axis; a label may be empty.
struct Tick {
    at: f64,
    length: f64,
    label: String,
}

/// Draws an axis with its words at the middle; `distances` of the words from horizontal and vertical axes.
fn draw(
    pen: &mut Pen,
    side: Side,
    at: f64,
    middle: f64,
    ticks: Vec<Tick>,
    words: &str,
    distances: (f64, f64),
) {
    let horizontal = matches!(side, Side::Bottom | Side::Top);
    let outwards = if matches!(side, Side::Bottom | Side::Right) { 1.0 } else { -1.0 };
    // a place along the axis and away from it
    let place = |along: f64, away: f64| {
        if horizontal { (along, at + away * outwards) } else { (at + away * outwards, along) }
    };
    pen.group("axis", "", |pen| {
        for tick in &ticks {
            pen.path(&[place(tick.at, 0.0), place(tick.at, tick.length)], Stroke::solid(BLACK, 1.0));
        }
        let (away, anchor) = match side {
            Side::Bottom | Side::Top => (TICK_LABEL_DISTANCE.0, Anchor::Center),
            Side::Left => (TICK_LABEL_DISTANCE.1, Anchor::Right),
            Side::Right => (TICK_LABEL_DISTANCE.1, Anchor::Left),
        };
        for tick in &ticks {
            pen.text(place(tick.at, away), &tick.label, Font::new(TICK_SIZE), anchor);
        }
        let font = Font::new(LABEL_SIZE);
        if horizontal {
            pen.text(place(middle, distances.0), words, font, Anchor::Center);
        } else {
            pen.vertical_text(place(middle, distances.1), words, font);
        }
    });
}

/// Draws light lines across the frame at the ticks of both scales.
pub fn grid(pen: &mut Pen, frame: Rect, across: Scale, up: Scale) {
    let stroke = Stroke::solid(LIGHT_GREY, 1.0);
    pen.group("grid", "", |pen| {
        for (value, _) in ticks(across.low, across.high, frame.width() / 85.0).marks {
            let x = across.pixel(value);
            pen.path(&[(x, frame.top), (x, frame.bottom)], stroke);
        }
        for (value, _) in ticks(up.low, up.high, frame.height() / 48.0).marks {
            let y = up.pixel(value);
            pen.path(&[(frame.left, y), (frame.right, y)], stroke);
        }
    });
}

/// Draws grid, ticks and labels of a logarithmic axis, below the frame or to its left; `scale` maps decimal logarithms. An empty unit is
/// left out.
pub fn decades(pen: &mut Pen, frame: Rect, side: Side, scale: Scale, quantity: &str, unit: &str) {
    let upwards = matches!(side, Side::Left | Side::Right);
    let (low, high) = (scale.low.min(scale.high), scale.low.max(scale.high));
    let room = (scale.end - scale.start).abs() / (high - low).max(1e-9);
    // labels between the powers where a decade has room for them, fewer powers where it has none
    let digits: &[i32] = if room > 260.0 { &[1, 2, 5] } else { &[1] };
    let stride = (40.0 / room).ceil().max(1.0) as i32;
    let powers = low.floor() as i32..=high.ceil() as i32;
    let steps = powers.flat_map(|power| (1..10).map(move |digit| (digit, power)));
    let value = |(digit, power): (i32, i32)| f64::from(power) + f64::from(digit).log10();
    let steps: Vec<(i32, i32)> = steps.filter(|step| (low..=high).contains(&value(*step))).collect();
    pen.group("grid", "", |pen| {
        for whole in [false, true] {
            let stroke = Stroke::solid(LIGHT_GREY, if whole { 1.2 } else { 0.6 });
            for step in steps.iter().filter(|(digit, _)| (*digit == 1) == whole) {
                let at = scale.pixel(value(*step));
                let line = if upwards {
                    [(frame.left, at), (frame.right, at)]
                } else {
                    [(at, frame.top), (at, frame.bottom)]
                };
                pen.path(&line, stroke);
            }
        }
    });
    let tick = |&(digit, power): &(i32, i32)| {
        let labelled = digits.contains(&digit) && (digit > 1 || power % stride == 0);
        Tick {
            at: scale.pixel(value((digit, power))),
            length: if labelled { TICK } else { SHORT_TICK },
            label: if labelled { decimal_label(digit, power, upwards) } else { String::new() },
        }
    };
    let words = if unit.is_empty() { quantity.to_owned() } else { axis_label(quantity, unit, 0) };
    let (middle, at) = match side {
        Side::Left => (frame.center().1, frame.left),
        Side::Right => (frame.center().1, frame.right),
        Side::Top => (frame.center().0, frame.top),
        Side::Bottom => (frame.center().0, frame.bottom),
    };
    draw(pen, side, at, middle, steps.iter().map(tick).collect(), &words, DECADES_LABEL_DISTANCE);
}

/// Short numbers as they are, others as powers of ten.
fn decimal_label(digit: i32, power: i32, as_power: bool) -> String {
    if as_power || !(-4..5).contains(&power) {
        let raised = format!("10{}", superscript(power));
        return if digit == 1 { raised } else { format!("{digit}·{raised}") };
    }
    let decimals = usize::try_from(-power).unwrap_or(0);
    format!("{:.decimals$}", f64::from(digit) * 10f64.powi(power))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(low: f64, high: f64, count: f64) -> Vec<String> {
        ticks(low, high, count).marks.into_iter().map(|(_, label)| label).collect()
    }

    proptest! {
        #[test]
        fn ticks_are_few_and_inside(low in -1e3..1e3f64, power in -12..12i32, count in 2.0..12.0f64) {
            let high = low + 10f64.powi(power);
            let marks = ticks(low, high, count).marks;
            let slack = 1e-6 * (high - low) + 1e-9 * low.abs();
            prop_assert!(marks.len() <= 52);
            prop_assert!(marks.iter().all(|(value, _)| low - slack <= *value && *value <= high + slack));
        }
    }

    #[test]
    fn ticks_have_round_labels() {
        assert_eq!(labels(0.0, 1.0, 5.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(0.0, 10000.0, 5.0), ["0", "2000", "4000", "6000", "8000", "10000"]);
        assert_eq!(labels(-1.0, 1.0, 2.0), ["-1", "0", "1"]);
        assert_eq!(ticks(0.0, 9.5e6, 5.0).exponent, 6);
        assert_eq!(axis_label("Speed", "rpm", ticks(0.0, 1e-3, 5.0).exponent), "Speed (10⁻³ rpm)");
    }
}
