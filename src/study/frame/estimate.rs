//! Sums of numbers with what is known of their uncertainty.
//!
//! Environments are the unit of evidence: rows under one environment share all that makes light hard, so an interval resamples
//! environments, never rows (cluster bootstrap). Below [`CLUSTERS_MIN`] environments there is no interval: print the rows.

use crate::runner::statistics::{Random, quantile};
use crate::runner::value::Value;

/// Fewer environments than this have no 95 % interval.
pub const CLUSTERS_MIN: usize = 6;
/// Draws of the bootstrap.
const RESAMPLE_COUNT: usize = 2000;
const RESAMPLE_SEED: u64 = 1;
/// An interval wider than this factor says nothing: print the rows.
const WIDTH_MAX: f64 = 10.0;

/// A number of a group of rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// 95 % interval over environments; nothing where they are too few.
    pub interval: Option<[f64; 2]>,
    /// Rows behind it.
    pub n: usize,
    /// Environments behind it.
    pub clusters: usize,
}

impl Estimate {
    /// The interval, unless it is wider than a decade.
    pub fn told_interval(&self) -> Option<[f64; 2]> {
        self.interval.filter(|[lo, hi]| *lo > 0.0 && hi / lo <= WIDTH_MAX)
    }

    /// Whether the interval lies on one side of a number.
    pub fn is_apart_from(&self, number: f64) -> bool {
        self.interval.is_some_and(|[lo, hi]| lo > number || hi < number)
    }
}

/// exp of the mean logarithm; NaN for none.
pub fn geometric_mean(values: &[f64]) -> f64 {
    (values.iter().map(|value| value.ln()).sum::<f64>() / values.len() as f64).exp()
}

/// Middle of numbers in any order, by linear interpolation; NaN for none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.5)
}

/// A statistic of values, each with the environment it comes from.
pub fn estimate(values: &[(Value, f64)], statistic: fn(&[f64]) -> f64) -> Option<Estimate> {
    let all: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
    let clusters: Vec<Vec<f64>> = super::distinct_in_order(values.iter().map(|(key, _)| key.clone()))
        .into_iter()
        .map(|key| values.iter().filter(|(of, _)| *of == key).map(|(_, value)| *value).collect())
        .collect();
    let value = statistic(&all);
    (!all.is_empty()).then(|| Estimate {
        value,
        interval: (clusters.len() >= CLUSTERS_MIN).then(|| interval(&clusters, statistic)),
        n: all.len(),
        clusters: clusters.len(),
    })
}

/// Percentile interval: whole clusters are drawn with replacement [Efron79].
fn interval(clusters: &[Vec<f64>], statistic: fn(&[f64]) -> f64) -> [f64; 2] {
    let mut random = Random::new(RESAMPLE_SEED);
    let mut draws: Vec<f64> = (0..RESAMPLE_COUNT)
        .map(|_| {
            let drawn = (0..clusters.len()).flat_map(|_| clusters[random.below(clusters.len())].iter().copied());
            statistic(&drawn.collect::<Vec<_>>())
        })
        .collect();
    draws.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|p| quantile(&draws, p))
}
