//! Order statistics against values worked out by hand.

use splitsum::run::statistics::{INTERVAL_SAMPLES_MIN, Random, drift, median_interval, median_order, quantile};
use splitsum::run::timing::summarize;
use std::f64::consts::LN_2;

#[test]
fn order_statistics_of_five_and_of_no_samples() {
    let s = summarize(&[5.0, 1.0, 4.0, 2.0, 103.0]);
    assert_eq!((s.n, s.median, s.min, s.mad), (5, 4.0, 1.0, 2.0));
    assert!((s.p05 - 1.2).abs() < 1e-12 && (s.p95 - 83.4).abs() < 1e-12, "{s:?}");
    assert_eq!(summarize(&[7.0]).p95, 7.0);
    assert!(summarize(&[]).median.is_nan());
}

#[test]
fn infinite_samples_are_limits_of_large_ones() {
    const INFINITY: f64 = f64::INFINITY;
    for set in [[1.0, 2.0, INFINITY], [-INFINITY, 2.0, 3.0], [2.0, INFINITY, INFINITY], [-INFINITY, -INFINITY, 2.0]] {
        let large = set.map(|x| x.clamp(-1e300, 1e300));
        for p in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let (found, limit) = (quantile(&set, p), quantile(&large, p));
            assert!(
                found == limit || found.is_infinite() && limit.abs() > 1e299 && found * limit > 0.0,
                "{set:?} {p}: {found}"
            );
        }
    }
    assert!(quantile(&[-INFINITY, INFINITY], 0.5).is_nan());
}

/// A number of the exponential distribution, whose median is ln 2: skewed, as times are.
fn exponential(random: &mut Random) -> f64 {
    -((random.below(1 << 53) as f64 + 0.5) / (1u64 << 53) as f64).ln()
}

/// How often an interval of `n` exponential numbers contains their median.
fn coverage(n: usize, sets: usize, interval: impl Fn(&[f64]) -> [f64; 2]) -> f64 {
    let mut random = Random::new(n as u64);
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
    // No interval within the samples is wider than from the smallest to the largest. 40,000 sets: a standard error of 0.0011 at 0.95.
    let range = |samples: &[f64]| {
        samples.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(*x), hi.max(*x)])
    };
    let fewest = (2..12).find(|&n| coverage(n, 40_000, range) >= 0.95);
    assert_eq!(fewest, Some(INTERVAL_SAMPLES_MIN));
    for n in 0..INTERVAL_SAMPLES_MIN {
        assert_eq!(median_order(n), None, "{n}");
        assert!(median_interval(&vec![1.0; n])[0].is_nan(), "{n} samples have no interval");
        assert!(summarize(&vec![1.0; n]).interval[1].is_nan());
    }
    // By the binomial distribution: 2 0.5^n sum of C(n, 0..=k) is at most 0.05.
    for (n, k) in [(6, 0), (8, 0), (9, 1), (11, 1), (12, 2), (15, 3), (25, 7)] {
        assert_eq!(median_order(n), Some(k), "{n}");
    }
}

#[test]
fn the_interval_of_a_median_has_its_stated_coverage() {
    // With 2000 sets at 0.95 a binomial count is above 0.93 except once in 10,000; order statistics are discrete and cover up to 0.985.
    for n in [6, 7, 9, 11, 15, 25] {
        let covered = coverage(n, 2000, median_interval);
        assert!((0.93..=0.996).contains(&covered), "{n}: {covered}");
    }
    let samples = [5.0, 1.0, 4.0, 2.0, 103.0, 3.0];
    assert_eq!(median_interval(&samples), [1.0, 103.0], "of six, the smallest and the largest");
}

#[test]
fn drift_is_the_slope_and_no_outlier_moves_it() {
    let mut points: Vec<(f64, f64)> = (0..20).map(|i| (f64::from(i), 5.0 + 0.25 * f64::from(i))).collect();
    points[7].1 = 1e6;
    assert!((drift(&points) - 0.25).abs() < 1e-12);
    assert!(drift(&[(1.0, 2.0)]).is_nan());
}

#[test]
fn an_order_is_a_permutation_and_all_are_equally_likely() {
    let mut random = Random::new(3);
    let mut counts = std::collections::BTreeMap::new();
    for _ in 0..6000 {
        *counts.entry(random.order(3)).or_insert(0) += 1;
    }
    assert_eq!(counts.len(), 6);
    // Chi-square with 5 degrees of freedom: above 25.7 once in 10,000.
    let chi2: f64 = counts.values().map(|n| f64::from(n - 1000).powi(2) / 1000.0).sum();
    assert!(chi2 < 25.7, "{counts:?}");
}
