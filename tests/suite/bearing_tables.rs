//! Coefficients of bearings over speed: what holds between the points of a table.

use crate::mutations::{config, count};
use proptest::prelude::*;
use rotor::model::{BearingTable, Coefficients};

/// A state whose twelve entries differ by known factors.
fn state(value: f64) -> Coefficients {
    let matrix = |k: f64| [[k * value, (k + 1.0) * value], [(k + 2.0) * value, (k + 3.0) * value]];
    Coefficients { stiffness: matrix(1.0), damping: matrix(5.0), mass: matrix(9.0) }
}

fn table(speeds: &[f64], whirls: &[f64], values: &[f64]) -> BearingTable {
    let rows = values.iter().map(|v| state(*v)).collect();
    BearingTable::new(speeds.to_vec(), whirls.to_vec(), rows).expect("a table")
}

fn value(table: &BearingTable, speed: f64, whirl: f64) -> f64 {
    table.at(speed, whirl).stiffness[0][0]
}

proptest! {
    #![proptest_config(config(count(512)))]

    /// Through the points, between its neighbours, and continuous, whatever the data are.
    #[test]
    fn values_stay_between_their_neighbours(
        steps in prop::collection::vec(1e-3..1e3_f64, 1..9),
        values in prop::collection::vec(prop_oneof![-1e9..1e9_f64, Just(0.0), Just(5.0)], 10),
        s in 0.0..1.0_f64,
    ) {
        let mut speeds = vec![10.0];
        steps.iter().for_each(|step| speeds.push(speeds[speeds.len() - 1] + step));
        let list = table(&speeds, &[], &values[..speeds.len()]);
        for (k, pair) in speeds.windows(2).enumerate() {
            prop_assert_eq!(value(&list, pair[0], 0.0), values[k]);
            let x = pair[0] + s * (pair[1] - pair[0]);
            let y = value(&list, x, 7.0);
            prop_assert!(y >= values[k].min(values[k + 1]) && y <= values[k].max(values[k + 1]));
            // steep at most as three times the chord
            let after = value(&list, (x + 1e-6 * steps[k]).min(pair[1]), 7.0);
            let change = (values[k + 1] - values[k]).abs();
            prop_assert!((after - y).abs() <= 3.1e-6 * change + 1e-9 * values[k].abs().max(change));
        }
        prop_assert_eq!(value(&list, -1.0, 0.0), values[0]);
        prop_assert_eq!(value(&list, 1e9, 0.0), values[speeds.len() - 1]);
    }
}

/// Every coefficient goes its own way through the table.
#[test]
fn all_coefficients_are_read() {
    let list = table(&[0.0, 10.0, 30.0], &[], &[1.0, 2.0, 7.0]);
    for (speed, right) in [(0.0, 1.0), (10.0, 2.0), (30.0, 7.0)] {
        assert_eq!(list.at(speed, 0.0), state(right));
    }
    let factor = value(&list, 17.0, 0.0);
    let (found, right) = (list.at(17.0, 0.0), state(factor));
    for (a, b) in
        [(found.stiffness, right.stiffness), (found.damping, right.damping), (found.mass, right.mass)]
    {
        for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((a / b - 1.0).abs() < 1e-12, "{found:?}");
        }
    }
}

/// Errors of smooth data fall by 2^3 with every halving where they rise, by 2^2 around a turn; the slope over the speed has no
/// corner within the table.
#[test]
fn smooth_data_are_met_to_the_third_order() {
    let rising = |x: f64| (0.4 * x).exp() + 0.2 * x;
    let turning = |x: f64| (1.7 * x).sin();
    let error = |f: &dyn Fn(f64) -> f64, n: usize| {
        // unequal steps
        let place = |k: f64| 3.0 * (k / n as f64).powf(1.3) + 0.1;
        let speeds: Vec<f64> = (0..=n).map(|k| place(k as f64)).collect();
        let list = table(&speeds, &[], &speeds.iter().map(|x| f(*x)).collect::<Vec<_>>());
        let points = (0..40 * n).map(|k| 0.1 + 3.0 * (k as f64 + 0.5) / (40 * n) as f64);
        points.map(|x| (value(&list, x, 0.0) - f(x)).abs()).fold(0.0, f64::max)
    };
    for n in [16, 32, 64, 128] {
        let found = (error(&rising, n) / error(&rising, 2 * n)).log2();
        assert!(found > 2.85, "{n}: order {found}");
        // the place of the maximum within its interval changes with n
        assert!(error(&turning, n) < 6.0 / (n * n) as f64, "{n}");
    }
    assert!(error(&rising, 16) < 2e-4);
    let speeds: Vec<f64> = (0..=8).map(|k| f64::from(k) * 0.375 + 0.1).collect();
    let list = table(&speeds, &[], &speeds.iter().map(|x| turning(*x)).collect::<Vec<_>>());
    for x in &speeds[1..8] {
        let (before, after) = (value(&list, x - 1e-6, 0.0), value(&list, x + 1e-6, 0.0));
        let here = value(&list, *x, 0.0);
        assert!(((after - here) - (here - before)).abs() < 1e-10, "{x}");
    }
}

/// Over speed and whirl frequency a product of two rising functions is met at the points and in between; the sense of the
/// whirl does not matter.
#[test]
fn a_grid_is_read_in_both_directions() {
    let f = |speed: f64, whirl: f64| (1.0 + 0.01 * speed).sqrt() * (3.0 - (0.01 * whirl).tanh());
    let (speeds, whirls): (Vec<f64>, Vec<f64>) =
        ((0..12).map(|k| 20.0 * f64::from(k)).collect(), (0..9).map(|k| 25.0 * f64::from(k)).collect());
    let values: Vec<f64> = speeds.iter().flat_map(|s| whirls.iter().map(move |w| f(*s, *w))).collect();
    let list = table(&speeds, &whirls, &values);
    assert!(list.depends_on_whirl() && list.whirls() == Some([0.0, 200.0]) && list.speeds() == [0.0, 220.0]);
    assert_eq!(value(&list, 40.0, 75.0), f(40.0, 75.0));
    for (s, w) in [(33.0, 61.0), (201.0, 12.0), (110.0, 188.0)] {
        assert!((value(&list, s, w) / f(s, w) - 1.0).abs() < 1e-3, "{s} {w}");
        assert_eq!(value(&list, s, w), value(&list, s, -w));
    }
    assert_eq!(value(&list, 500.0, 900.0), f(220.0, 200.0));
    assert!(list.outside(221.0) && list.outside(-1.0) && !list.outside(220.0));
}

/// One row is constant; points that do not ascend or do not fill the grid are no table.
#[test]
fn what_is_no_table_is_none() {
    let one = table(&[300.0], &[], &[5.0]);
    assert!(!one.outside(9000.0) && !one.depends_on_whirl() && one.whirls().is_none());
    assert_eq!(value(&one, 0.0, 4.0), 5.0);
    let make = |speeds: &[f64], whirls: &[f64], rows: usize| {
        BearingTable::new(speeds.to_vec(), whirls.to_vec(), vec![Coefficients::default(); rows])
    };
    for (speeds, whirls, rows) in [
        (&[] as &[f64], &[] as &[f64], 0),
        (&[1.0, 1.0], &[], 2),
        (&[2.0, 1.0], &[], 2),
        (&[1.0, 2.0], &[], 3),
        (&[1.0, 2.0], &[3.0, 4.0], 2),
        (&[1.0], &[4.0, 3.0], 2),
        (&[f64::NAN], &[], 1),
    ] {
        assert!(make(speeds, whirls, rows).is_none(), "{speeds:?} {whirls:?} {rows}");
    }
}
