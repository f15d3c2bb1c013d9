//! Following whirl branches over speed.
//!
//! A motion at one speed continues at the next where `|left_i^H right_j| |left_j^H right_i|` is largest
//! (1 for the same motion; energy-weighted, since the states are). Where that is not clear, the speed
//! interval is halved; what stays unclear is reported, never hidden. A veering narrower than a speed step,
//! in which two shapes change places completely, passes as the crossing it looks like.

use crate::analysis::campbell::reduced_basis::{Solution, Whirling};
use crate::error::Result;
use faer::{Mat, c64};

/// Likeness from which a continuation is certain: no second motion can reach it.
const CERTAIN_LIKENESS: f64 = 0.7;
/// Likeness below which a branch counts as lost.
const LOST_LIKENESS: f64 = 0.1;
/// How often an interval is halved.
const DEPTH: usize = 12;

/// Where each followed motion of the earlier speed is found at the later one.
pub struct Continuation {
    /// Motion at the later speed for each followed one; `None` where it is lost.
    pub to: Vec<Option<usize>>,
    /// Which of the followed ones stayed unclear.
    pub unclear: Vec<bool>,
    /// Extra speeds solved.
    pub extra: usize,
}

/// How alike motions (rows) are to others (columns): `1` when two are the same, near `0` when they have nothing in common.
///
/// A motion stands for its complex conjugate too: in the rotating frame a forward whirl passes through zero
/// frequency and comes out as the conjugate. Where two frequencies meet at zero and part on the real axis, the
/// products of left and right vectors would be at least one half; doubled, they are certain.
fn likenesses(from: &[&Whirling], to: &[Whirling]) -> Vec<Vec<f64>> {
    if from.is_empty() || to.is_empty() {
        return vec![Vec::new(); from.len()];
    }
    let to: Vec<&Whirling> = to.iter().collect();
    let forth = products(left, from, right, &to);
    let back = (from.iter().chain(&to).any(|motion| motion.left.is_some()))
        .then(|| products(left, &to, right, from));
    let entry = |i: usize, j: usize| {
        let (plain, conjugate) = forth(i, j);
        let (plain_back, conjugate_back) = match &back {
            Some(back) => back(j, i),
            None => (plain, conjugate),
        };
        let meets = (from[i].lambda.im == 0.0) != (to[j].lambda.im == 0.0);
        (plain * plain_back).max(conjugate * conjugate_back) * if meets { 2.0 } else { 1.0 }
    };
    (0..from.len()).map(|i| (0..to.len()).map(|j| entry(i, j)).collect()).collect()
}

/// The motion of a solution that is most like another.
pub fn most_like<'a>(solution: &'a Solution, motion: &Whirling) -> Option<&'a Whirling> {
    let likeness = likenesses(&[motion], &solution.motions).pop().unwrap_or_default();
    let best = likeness.iter().zip(&solution.motions).max_by(|a, b| a.0.total_cmp(b.0));
    best.map(|(_, motion)| motion)
}

fn right(motion: &Whirling) -> &[c64] {
    &motion.right
}

fn left(motion: &Whirling) -> &[c64] {
    motion.left.as_ref().unwrap_or(&motion.right)
}

/// `|x_i^H y_j|` and `|x_i^T y_j|` for vectors of motions, from products of their real and imaginary parts.
fn products(
    of_rows: fn(&Whirling) -> &[c64],
    rows: &[&Whirling],
    of_columns: fn(&Whirling) -> &[c64],
    columns: &[&Whirling],
) -> impl Fn(usize, usize) -> (f64, f64) {
    let part = |list: &[&Whirling], of: fn(&Whirling) -> &[c64], part: fn(&c64) -> f64| {
        let size = list.first().map_or(0, |motion| of(motion).len());
        Mat::from_fn(size, list.len(), |i, j| part(&of(list[j])[i]))
    };
    let parts = |list: &[&Whirling], of: fn(&Whirling) -> &[c64]| {
        (part(list, of, |z| z.re), part(list, of, |z| z.im))
    };
    let ((xr, xi), (yr, yi)) = (parts(rows, of_rows), parts(columns, of_columns));
    let (rr, ii) = (xr.transpose() * &yr, xi.transpose() * &yi);
    let (ri, ir) = (xr.transpose() * &yi, xi.transpose() * &yr);
    move |i, j| {
        let at = (i, j);
        ((rr[at] + ii[at]).hypot(ri[at] - ir[at]), (rr[at] - ii[at]).hypot(ri[at] + ir[at]))
    }
}

/// Continues the motions `followed` of `from` to the speed of `to`, halving the interval where needed.
///
/// # Errors
/// When an extra speed can't be solved.
pub fn follow(
    solve: &dyn Fn(f64) -> Result<Solution>,
    from: &Solution,
    to: &Solution,
    followed: &[usize],
) -> Result<Continuation> {
    follow_within(solve, from, to, followed, DEPTH)
}

fn follow_within(
    solve: &dyn Fn(f64) -> Result<Solution>,
    from: &Solution,
    to: &Solution,
    followed: &[usize],
    depth: usize,
) -> Result<Continuation> {
    let table = likenesses(&followed.iter().map(|&i| &from.motions[i]).collect::<Vec<_>>(), &to.motions);
    let assigned = assign(&table);
    let value = |k: usize| assigned[k].map_or(0.0, |j| table[k][j]);
    let certain = (0..followed.len()).all(|k| value(k) >= CERTAIN_LIKENESS);
    if certain || depth == 0 {
        return Ok(Continuation {
            to: (0..followed.len()).map(|k| assigned[k].filter(|_| value(k) >= LOST_LIKENESS)).collect(),
            unclear: (0..followed.len()).map(|k| value(k) < CERTAIN_LIKENESS).collect(),
            extra: 0,
        });
    }
    let middle = solve((from.speed + to.speed) / 2.0)?;
    let first = follow_within(solve, from, &middle, followed, depth - 1)?;
    let alive: Vec<usize> = (0..followed.len()).filter(|&k| first.to[k].is_some()).collect();
    let onward: Vec<usize> = first.to.iter().flatten().copied().collect();
    let second = follow_within(solve, &middle, to, &onward, depth - 1)?;
    let mut result = Continuation {
        to: vec![None; followed.len()],
        unclear: first.unclear,
        extra: first.extra + second.extra + 1,
    };
    for (k, &branch) in alive.iter().enumerate() {
        result.to[branch] = second.to[k];
        result.unclear[branch] |= second.unclear[k];
    }
    Ok(result)
}

/// Pairs rows with columns, the largest entries first.
fn assign(table: &[Vec<f64>]) -> Vec<Option<usize>> {
    let mut entries: Vec<(f64, usize, usize)> = Vec::new();
    for (i, row) in table.iter().enumerate() {
        entries.extend(row.iter().enumerate().filter(|(_, v)| **v > 1e-3).map(|(j, v)| (*v, i, j)));
    }
    entries.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut result = vec![None; table.len()];
    let mut taken = vec![false; table.first().map_or(0, Vec::len)];
    for (_, i, j) in entries {
        if result[i].is_none() && !taken[j] {
            result[i] = Some(j);
            taken[j] = true;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(frequency: f64, right: &[f64]) -> Whirling {
        Whirling {
            lambda: c64::new(0.0, frequency),
            right: right.iter().map(|&v| c64::new(v, 0.0)).collect(),
            left: None,
            noise: 0.0,
        }
    }

    fn solution(speed: f64, motions: Vec<Whirling>) -> Solution {
        Solution { speed, oscillating: motions.len(), motions, overdamped: Vec::new(), unsettled: 0 }
    }

    /// Two motions whose shapes turn into each other by 45 degrees around speed 1 are as much alike one
    /// way as the other at the ends of the interval; halving it settles their order.
    #[test]
    fn a_veering_is_followed_through_extra_speeds() {
        let solve = |speed: f64| -> Result<Solution> {
            let angle = ((speed - 1.0) / 0.02).tanh() * std::f64::consts::FRAC_PI_8;
            let (s, c) = angle.sin_cos();
            Ok(solution(speed, vec![motion(1.0, &[c, s]), motion(2.0, &[-s, c])]))
        };
        let (a, b) = (solve(0.0).unwrap(), solve(2.0).unwrap());
        let found = follow(&solve, &a, &b, &[0, 1]).unwrap();
        assert_eq!(found.to, [Some(0), Some(1)]);
        assert!(found.extra > 0 && found.unclear.iter().all(|u| !u));
    }

    /// Two motions that cross without touching change their order at once.
    #[test]
    fn a_crossing_changes_the_order() {
        let a = solution(0.0, vec![motion(1.0, &[1.0, 0.0]), motion(2.0, &[0.0, 1.0])]);
        let b = solution(1.0, vec![motion(1.0, &[0.0, 1.0]), motion(2.0, &[1.0, 0.0])]);
        let found = follow(&|_| Ok(b.clone()), &a, &b, &[0, 1]).unwrap();
        assert_eq!(found.to, [Some(1), Some(0)]);
    }

    /// A motion with no continuation is reported as lost and unclear.
    #[test]
    fn what_stays_unclear_is_said() {
        let a = solution(0.0, vec![motion(1.0, &[1.0, 0.0, 0.0])]);
        let b = solution(1.0, vec![motion(1.0, &[0.0, 0.0, 1.0])]);
        let found = follow(&|speed| Ok(Solution { speed, ..b.clone() }), &a, &b, &[0]).unwrap();
        assert_eq!((found.to[0], found.unclear[0]), (None, true));
    }
}
