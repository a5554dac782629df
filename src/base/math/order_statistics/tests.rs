use super::{median, median_interval, median_order};
use fastrand::Rng;
use std::f64::consts::LN_2;

#[test]
fn a_median_lies_between_its_neighbours() {
    assert_eq!(median(&[5.0, 1.0, 4.0, 2.0, 103.0]), 4.0);
    assert_eq!(median(&[5.0, 1.0, 4.0, 103.0]), 4.5);
    assert_eq!(median(&[7.0]), 7.0);
    assert!(median(&[]).is_nan());
}

/// A number of the exponential distribution, whose median is ln 2: skewed, as times are.
fn exponential(random: &mut Rng) -> f64 {
    -random.f64().max(f64::MIN_POSITIVE).ln()
}

/// How often an interval of `n` exponential numbers contains their median.
fn coverage(n: usize, sets: usize, interval: impl Fn(&[f64]) -> [f64; 2]) -> f64 {
    let mut random = Rng::with_seed(n as u64);
    let mut covered = 0;
    for _ in 0..sets {
        let samples: Vec<f64> = (0..n).map(|_| exponential(&mut random)).collect();
        let [lo, hi] = interval(&samples);
        covered += usize::from(lo <= LN_2 && LN_2 <= hi);
    }
    covered as f64 / sets as f64
}

#[test]
fn an_interval_needs_samples_whose_range_covers_the_median() {
    // No interval within the samples is wider than from the smallest to the largest. 40,000 sets: a
    // standard error of 0.0011 at 0.95.
    let range = |samples: &[f64]| {
        samples
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| {
                [lo.min(*x), hi.max(*x)]
            })
    };
    let fewest = (2..12).find(|&n| coverage(n, 40_000, range) >= 0.95);
    assert_eq!(fewest, Some(6));
    for n in 0..6 {
        assert_eq!(median_order(n), None, "{n}");
        assert!(
            median_interval(&vec![1.0; n])[0].is_nan(),
            "{n} samples have no interval"
        );
    }
    // By the binomial distribution: 2 0.5^n sum of C(n, 0..=k) is at most 0.05.
    for (n, k) in [(6, 0), (8, 0), (9, 1), (11, 1), (12, 2), (15, 3), (25, 7)] {
        assert_eq!(median_order(n), Some(k), "{n}");
    }
}

#[test]
fn the_interval_of_a_median_has_its_stated_coverage() {
    // With 2000 sets at 0.95 a binomial count is above 0.93 except once in 10,000; order statistics
    // are discrete and cover up to 0.985.
    for n in [6, 7, 9, 11, 15, 25] {
        let covered = coverage(n, 2000, median_interval);
        assert!((0.93..=0.996).contains(&covered), "{n}: {covered}");
    }
    let samples = [5.0, 1.0, 4.0, 2.0, 103.0, 3.0];
    assert_eq!(
        median_interval(&samples),
        [1.0, 103.0],
        "of six, the smallest and the largest"
    );
}
