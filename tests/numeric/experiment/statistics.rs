//! Break-even, order statistics and dates against values worked out by hand.

use splitsum::experiment::break_even::{BreakEven, break_even, median};
use splitsum::experiment::date_utc;
use splitsum::experiment::timing::summarize;

#[test]
fn break_even_is_the_first_count_from_which_all_are_better() {
    let curve = [(1, 0.9), (4, 0.3), (16, 0.6), (64, 0.2), (256, 0.1)];
    assert_eq!(break_even(&curve, 1.0), BreakEven::From(1));
    assert_eq!(break_even(&curve, 0.5), BreakEven::From(64), "the dip at 4 does not last");
    assert_eq!(break_even(&curve, 0.2), BreakEven::From(256), "equal is not better");
    assert_eq!(break_even(&curve, 0.05), BreakEven::Above(256));
    let shuffled = [(256, 0.1), (1, 0.9), (64, 0.2), (16, 0.6), (4, 0.3)];
    assert_eq!(break_even(&shuffled, 0.5), BreakEven::From(64));
    assert_eq!(break_even(&[(4, f64::NAN)], 0.5), BreakEven::Above(4));
    assert_eq!(break_even(&[], 0.5), BreakEven::Above(0));
}

#[test]
fn the_median_of_break_evens_puts_never_last() {
    use BreakEven::{Above, From};
    assert_eq!(median(&[Above(64), From(4), From(16)]), Some(From(16)));
    assert_eq!(median(&[Above(64), From(4)]), Some(Above(64)), "the upper one of two");
    assert_eq!(median(&[]), None);
    assert_eq!(Above(64).to_string(), "> 64");
}

#[test]
fn order_statistics_of_five_and_of_no_samples() {
    let s = summarize(&[5.0, 1.0, 4.0, 2.0, 103.0]);
    assert_eq!((s.n, s.median, s.min, s.mad), (5, 4.0, 1.0, 2.0));
    assert!((s.p05 - 1.2).abs() < 1e-12 && (s.p95 - 83.4).abs() < 1e-12, "{s:?}");
    assert_eq!(summarize(&[7.0]).p95, 7.0);
    assert!(summarize(&[]).median.is_nan());
}

#[test]
fn dates_around_leap_days_and_centuries() {
    // From `date -u -d @SECONDS`.
    assert_eq!(date_utc(0), "1970-01-01T00:00:00Z");
    assert_eq!(date_utc(951_782_400), "2000-02-29T00:00:00Z");
    assert_eq!(date_utc(1_709_251_199), "2024-02-29T23:59:59Z");
    assert_eq!(date_utc(1_709_251_200), "2024-03-01T00:00:00Z");
    assert_eq!(date_utc(1_798_761_599), "2026-12-31T23:59:59Z");
    assert_eq!(date_utc(4_107_542_400), "2100-03-01T00:00:00Z");
}
