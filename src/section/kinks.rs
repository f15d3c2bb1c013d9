//! Kinked functions of a section: what lets it deform behind a step of the diameter or of the bore.
//!
//! Beside the functions of its member a round section may have, near a step,
//!
//! ```text
//!     (<rho - R_k> / s_k)^p  wave(m theta)      outward, zero inside the radius R_k
//!     (<R_k - rho> / s_k)^p  wave(m theta)      inward, zero outside it
//! ```
//!
//! with p = 1 .. d, 0, 1, .. [`HARMONICS`] waves and a length s_k of the size of what is beyond R_k. A function that vanishes on the area that two sections share is free at the
//! face of a step. Source: docs/theory/steps.md#functions.

use crate::section::Section;

/// Largest number of waves of kinked functions.
pub const HARMONICS: usize = 2;

/// Functions of each power: one without waves, a cosine and a sine for each number of waves.
const OF_A_POWER: usize = 2 * HARMONICS + 1;

/// Most kinks of one section.
const MOST: usize = 24;

/// Least part of what is beyond a kink that stays along a taper.
const STAYS: f64 = 0.3;

/// A radius at which functions have a kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kink {
    /// R_k, m.
    pub radius: f64,
    /// s_k, above 0, m.
    pub scale: f64,
    /// Largest power d, at least 1.
    pub degree: usize,
    /// Zero outside the radius instead of inside.
    pub inward: bool,
}

impl Kink {
    /// True when its functions vanish between two radii (m).
    pub fn vanishes_on(&self, inner: f64, outer: f64) -> bool {
        if self.inward { inner >= self.radius } else { outer <= self.radius }
    }

    /// True for kinks at one radius, but for rounding, on one side of it.
    pub fn is_at(&self, other: &Self) -> bool {
        self.inward == other.inward && (self.radius - other.radius).abs() <= 1e-9 * self.radius
    }
}

/// One kinked function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinkFunction {
    /// Where it has its kink.
    pub kink: Kink,
    /// Power p.
    pub power: usize,
    /// Waves m around the axis.
    pub waves: usize,
    /// Sine instead of cosine.
    pub sine: bool,
}

impl KinkFunction {
    /// Radial factor at a radius (m), and its derivative, 1/m.
    pub fn radial(&self, rho: f64) -> (f64, f64) {
        let sign = if self.kink.inward { -1.0 } else { 1.0 };
        let at = sign * (rho - self.kink.radius) / self.kink.scale;
        if at <= 0.0 {
            return (0.0, 0.0);
        }
        let lower = at.powi(self.power as i32 - 1);
        (lower * at, self.power as f64 * lower * sign / self.kink.scale)
    }

    /// Radial factor as a polynomial in s, `rho = middle + half s` (m), between two radii that no kink parts.
    pub fn polynomial(&self, middle: f64, half: f64) -> Vec<f64> {
        if self.radial(middle).0 == 0.0 {
            return Vec::new();
        }
        let (r, scale) = (self.kink.radius, self.kink.scale);
        let sign = if self.kink.inward { -1.0 } else { 1.0 };
        let (constant, linear) = (sign * (middle - r) / scale, sign * half / scale);
        (0..self.power).fold(vec![1.0], |p, _| {
            let at = |e: usize| p.get(e).copied().unwrap_or(0.0);
            (0..=p.len()).map(|e| constant * at(e) + if e > 0 { linear * at(e - 1) } else { 0.0 }).collect()
        })
    }
}

/// The kinks of a section, by rising radius.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Kinks {
    list: [Option<Kink>; MOST],
}

impl Kinks {
    /// No kinks: the functions of the member alone.
    pub const NONE: Self = Self { list: [None; MOST] };

    /// Kinks at several radii; those at one radius and on one side become one, of the higher degree. What exceeds
    /// the most that a section takes is left out, the last ones first.
    pub fn new(kinks: &[Kink]) -> Self {
        let mut kept: Vec<Kink> = Vec::new();
        for kink in kinks.iter().filter(|k| k.degree > 0) {
            match kept.iter().position(|k| k.is_at(kink)) {
                Some(same) => kept[same].degree = kept[same].degree.max(kink.degree),
                None if kept.len() < MOST => kept.push(*kink),
                None => {}
            }
        }
        kept.sort_by(|a, b| a.radius.total_cmp(&b.radius));
        let mut list = [None; MOST];
        list.iter_mut().zip(kept).for_each(|(place, kink)| *place = Some(kink));
        Self { list }
    }

    /// The kinks that stay within the wall of a round section as it changes from one face to the other, on both sides of
    /// their radius at least [`STAYS`] of what is there at most.
    pub fn within(&self, faces: [&Section; 2]) -> Self {
        let [a, b] = faces;
        let (least, most) = (a.outer[0].min(b.outer[0]), a.outer[0].max(b.outer[0]));
        let (narrow, wide) = (a.inner[0].min(b.inner[0]), a.inner[0].max(b.inner[0]));
        let stays = |k: &Kink| {
            least - k.radius >= STAYS * (most - k.radius) && k.radius - wide >= STAYS * (k.radius - narrow)
        };
        Self::new(&self.iter().filter(stays).collect::<Vec<_>>())
    }

    /// The kinks by rising radius.
    pub fn iter(&self) -> impl Iterator<Item = Kink> + '_ {
        self.list.iter().flatten().copied()
    }

    /// True without kinks.
    pub fn is_empty(&self) -> bool {
        self.list[0].is_none()
    }

    /// Number of functions.
    pub fn count(&self) -> usize {
        self.iter().map(|k| k.degree * OF_A_POWER).sum()
    }

    /// The functions, kink by kink, power by power: without waves, then cosine and sine of each number of waves.
    pub fn functions(&self) -> Vec<KinkFunction> {
        let mut list = Vec::with_capacity(self.count());
        for kink in self.iter() {
            for power in 1..=kink.degree {
                let of = |waves, sine| KinkFunction { kink, power, waves, sine };
                list.push(of(0, false));
                (1..=HARMONICS).for_each(|m| list.extend([of(m, false), of(m, true)]));
            }
        }
        list
    }

    /// For every function whether it changes its sign under y -> -y and under z -> -z.
    pub fn odd(&self) -> Vec<[bool; 2]> {
        let odd = |f: KinkFunction| [(f.waves + usize::from(f.sine)) % 2 == 1, f.sine];
        self.functions().into_iter().map(odd).collect()
    }

    /// Name of every vector: "K20mm^2cos1" for the outward kink at a radius of 20 mm, "k.." for an inward one.
    pub fn names(&self) -> Vec<String> {
        let name = |f: KinkFunction| {
            let letter = if f.kink.inward { "k" } else { "K" };
            let millimetres: f64 =
                format!("{:.4e}", 1e3 * f.kink.radius).parse().unwrap_or(1e3 * f.kink.radius);
            let wave = match (f.waves, f.sine) {
                (0, _) => String::new(),
                (m, sine) => format!("{}{m}", if sine { "sin" } else { "cos" }),
            };
            format!("{letter}{millimetres}mm^{}{wave}", f.power)
        };
        self.functions().into_iter().map(name).collect()
    }

    /// Radii that part a section between two radii (m) into cells without kinks, both ends among them.
    pub fn cells(&self, inner: f64, outer: f64) -> Vec<[f64; 2]> {
        let inside = |r: &f64| *r > inner * (1.0 + 1e-12) && *r < outer * (1.0 - 1e-12);
        let mut radii = vec![inner];
        radii.extend(self.iter().map(|k| k.radius).filter(inside));
        radii.push(outer);
        radii.dedup_by(|a, b| (*a - *b).abs() <= 1e-12 * outer);
        radii.windows(2).map(|r| [r[0], r[1]]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_their_polynomials_on_every_cell() {
        let kinks = Kinks::new(&[
            Kink { radius: 0.03, scale: 0.02, degree: 3, inward: false },
            Kink { radius: 0.02, scale: 0.01, degree: 2, inward: true },
        ]);
        let list = kinks.functions();
        assert_eq!((list.len(), kinks.count()), (25, 25));
        assert_eq!(kinks.names()[0], "k20mm^1");
        let cells = kinks.cells(0.01, 0.05);
        assert_eq!(cells, [[0.01, 0.02], [0.02, 0.03], [0.03, 0.05]]);
        for [a, b] in cells {
            let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
            for (f, s) in list.iter().flat_map(|f| [-0.7, 0.1, 0.9].map(|s| (f, s))) {
                let rho = middle + half * s;
                let sum = f.polynomial(middle, half).iter().rev().fold(0.0, |sum, c| sum * s + c);
                let (value, slope) = f.radial(rho);
                assert!((value - sum).abs() < 1e-14, "{f:?} at {rho}");
                let step = 1e-6 * half;
                let by_difference = (f.radial(rho + step).0 - f.radial(rho - step).0) / (2.0 * step);
                assert!((slope - by_difference).abs() < 1e-6 * (1.0 + slope.abs()));
            }
        }
    }

    #[test]
    fn kinks_at_one_radius_are_one() {
        let at = |radius, degree| Kink { radius, scale: 1.0, degree, inward: false };
        let kinks = Kinks::new(&[at(2.0, 1), at(1.0, 2), at(2.0, 3)]);
        assert_eq!(kinks.iter().collect::<Vec<_>>(), [at(1.0, 2), at(2.0, 3)]);
        assert!(at(2.0, 1).vanishes_on(0.0, 2.0) && !at(1.0, 1).vanishes_on(0.0, 2.0));
    }
}
