//! Intervals over environments, held against simulated studies whose truth is known.

use splitsum::runner::statistics::Random;
use splitsum::runner::value::Value;
use splitsum::study::frame::estimate::{CLUSTERS_MIN, Estimate, estimate, geometric_mean, median};
use std::f64::consts::TAU;

/// Studies of one kind. The standard error of a coverage of 0.95 is then 0.0049: the limits below are four of them away.
const STUDIES: usize = 2000;
const LIMITS: [f64; 2] = [0.93, 0.97];

/// A normal deviate (Box-Muller).
pub fn normal(random: &mut Random) -> f64 {
    let mut uniform = || (random.below(1 << 53) as f64 + 0.5) / (1u64 << 53) as f64;
    let radius = (-2.0 * uniform().ln()).sqrt();
    radius * (TAU * uniform()).cos()
}

/// Rows of a study: the logarithm of a value is a normal effect of its environment and of its own; the median of all is 1.
fn study(random: &mut Random, environments: usize, rows: usize, spread: [f64; 2]) -> Vec<(Value, f64)> {
    let mut values = Vec::new();
    for environment in 0..environments {
        let light = spread[0] * normal(random);
        let name = Value::Text(format!("e{environment}"));
        values.extend((0..rows).map(|_| (name.clone(), (light + spread[1] * normal(random)).exp())));
    }
    values
}

fn coverage(environments: usize, rows: usize, spread: [f64; 2], statistic: fn(&[f64]) -> f64) -> f64 {
    let mut random = Random::new((environments * 1000 + rows) as u64);
    let covers = |_| {
        let [lo, hi] = estimate(&study(&mut random, environments, rows, spread), statistic).unwrap().interval.unwrap();
        lo <= 1.0 && 1.0 <= hi
    };
    (0..STUDIES).map(covers).filter(|covers| *covers).count() as f64 / STUDIES as f64
}

#[test]
fn intervals_over_environments_hold_the_truth_as_often_as_they_say() {
    for (environments, rows, spread) in [(8, 4, [1.0, 0.3]), (10, 2, [0.5, 0.5]), (12, 3, [1.5, 0.2])] {
        let found = coverage(environments, rows, spread, geometric_mean);
        assert!((LIMITS[0]..=LIMITS[1]).contains(&found), "{environments} environments: {found}");
    }
}

#[test]
fn intervals_of_medians_hold_the_truth_at_least_as_often() {
    let found = coverage(10, 3, [1.0, 0.3], median);
    assert!((LIMITS[0]..=0.995).contains(&found), "{found}");
}

/// The interval of a geometric mean is that of its environments' geometric means, however many rows each has.
#[test]
fn rows_of_one_environment_are_no_further_evidence() {
    let many = study(&mut Random::new(5), 8, 4, [1.0, 0.3]);
    let mean = |rows: &[(Value, f64)]| {
        let logs: Vec<f64> = rows.iter().map(|(_, value)| *value).collect();
        (rows[0].0.clone(), geometric_mean(&logs))
    };
    let few: Vec<(Value, f64)> = many.chunks(4).map(mean).collect();
    let [a, b] = [&few, &many].map(|rows| estimate(rows, geometric_mean).unwrap());
    assert_eq!((a.n, b.n), (8, 32));
    let ends = a.interval.unwrap().into_iter().zip(b.interval.unwrap());
    assert!(ends.into_iter().all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{a:?} {b:?}");
}

/// Of normal logarithms the interval is Student's, t s / sqrt(n) to both sides.
#[test]
fn the_interval_of_a_geometric_mean_is_as_wide_as_students() {
    const STUDIES: usize = 200;
    let mut random = Random::new(8);
    let ratio = |_| {
        let values = study(&mut random, 8, 1, [1.0, 0.0]);
        let logs: Vec<f64> = values.iter().map(|(_, value)| value.ln()).collect();
        let mean = logs.iter().sum::<f64>() / 8.0;
        let s = (logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 7.0).sqrt();
        let [lo, hi] = estimate(&values, geometric_mean).unwrap().interval.unwrap();
        (hi / lo).ln() / (2.0 * 2.365 * s / 8f64.sqrt())
    };
    let mean = (0..STUDIES).map(ratio).sum::<f64>() / STUDIES as f64;
    // Means of eight draws have thinner tails than a normal, by 1 to 2 %; a plain percentile interval would be 7 % narrower still.
    assert!((0.95..1.02).contains(&mean), "{mean}");
}

#[test]
fn few_environments_and_wide_intervals_are_not_told() {
    let mut random = Random::new(6);
    let few = estimate(&study(&mut random, CLUSTERS_MIN - 1, 10, [1.0, 0.3]), geometric_mean).unwrap();
    assert_eq!(few.interval, None);
    assert!(estimate(&study(&mut random, CLUSTERS_MIN, 10, [1.0, 0.3]), geometric_mean).unwrap().interval.is_some());
    let told = |interval| Estimate { value: 1.0, interval: Some(interval), n: 8 }.told_interval();
    assert_eq!(told([0.5, 4.0]), Some([0.5, 4.0]));
    assert_eq!(told([0.5, 5.1]), None, "wider than a decade");
    assert_eq!(told([16.0, f64::INFINITY]), None);
    assert!(estimate(&[], median).is_none());
}

#[test]
fn infinity_is_a_value_and_no_nan() {
    let upper: fn(&[f64]) -> f64 = |values| {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted[sorted.len() / 2]
    };
    let counts = [4.0, 16.0, 16.0, 64.0, f64::INFINITY, 16.0, 4.0, 64.0];
    let values: Vec<_> = counts.iter().enumerate().map(|(i, n)| (Value::Text(format!("{i}")), *n)).collect();
    let found = estimate(&values, upper).unwrap();
    let [lo, hi] = found.interval.unwrap();
    assert!(found.value == 16.0 && counts.contains(&lo) && counts.contains(&hi) && lo < 16.0 && hi > 16.0, "{found:?}");
}
