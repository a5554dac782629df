use super::{Middle, estimate};
use crate::base::math::order_statistics::order_coverage;
use crate::experiment::value::Value;

#[test]
fn the_interval_of_a_median_lies_between_two_pairs_of_order_statistics() {
    // Of six, the outermost contain it except in 2/64 of cases, the next ones except in 14/64; 0.95
    // lies between the two, and so do the ends.
    assert!((order_coverage(6, 0) - (1.0 - 2.0 / 64.0)).abs() < 1e-12);
    assert!((order_coverage(6, 1) - (1.0 - 14.0 / 64.0)).abs() < 1e-12);
    // A tenth of the way by coverage is 5/14 by place: 0.1 (6 - 1) / (1 + 0.1 (6 - 2)).
    let values: Vec<_> = (0..6)
        .map(|i| (Value::from(i.to_string()), f64::from(i).exp()))
        .collect();
    let [lo, hi] = estimate(&values, Middle::Median)
        .unwrap()
        .interval
        .unwrap()
        .map(f64::ln);
    assert!(
        (lo - 5.0 / 14.0).abs() < 1e-9 && (hi - (5.0 - 5.0 / 14.0)).abs() < 1e-9,
        "{lo} {hi}"
    );
}

#[test]
fn an_infinite_break_even_is_a_value() {
    let of = |counts: &[f64]| {
        let values: Vec<_> = counts
            .iter()
            .enumerate()
            .map(|(i, n)| (Value::from(format!("{i}")), *n))
            .collect();
        let found = estimate(&values, Middle::Median).unwrap();
        (found.value, found.interval.unwrap())
    };
    const ABOVE: f64 = f64::INFINITY;
    let (middle, [lo, hi]) = of(&[4.0, 16.0, 16.0, 64.0, ABOVE, 16.0, 4.0, 64.0]);
    assert!(middle == 16.0 && lo == 4.0 && hi == ABOVE, "{lo} {hi}");
    // If half of them are above, so is the median. If all are above, so is the interval.
    assert_eq!(
        of(&[4.0, 4.0, 4.0, ABOVE, ABOVE, ABOVE]),
        (ABOVE, [4.0, ABOVE])
    );
    assert_eq!(of(&[ABOVE; 6]), (ABOVE, [ABOVE; 2]));
}
