//! Tail of the relative error per pixel, `sqrt(RGB mean of d² / (r² + ε))`, by nearest rank: the smallest error of a
//! real pixel that the stated fraction of pixels does not exceed.

use super::noise::{LARGEST_ERROR, error_tail};
use super::{Comparison, Epsilon, Metric, ReferenceNoise};

pub static P95: Metric = percentile::<950>(
    "err_p95",
    &[("epsilon_share", Epsilon::SHARE), ("fraction", 0.95)],
    "95th percentile (nearest rank) of the per-pixel error sqrt(RGB mean of d^2 / (r^2 + 0.01 m^2)), m as in relmse",
);

pub static P99: Metric = percentile::<990>(
    "err_p99",
    &[("epsilon_share", Epsilon::SHARE), ("fraction", 0.99)],
    "99th percentile (nearest rank) of the per-pixel error sqrt(RGB mean of d^2 / (r^2 + 0.01 m^2)), m as in relmse",
);

pub static MAXIMUM: Metric = percentile::<1000>(
    "err_max",
    &[("epsilon_share", Epsilon::SHARE), ("fraction", 1.0)],
    "largest per-pixel error sqrt(RGB mean of d^2 / (r^2 + 0.01 m^2)), m as in relmse",
);

/// In thousandths, for an exact rank.
const fn percentile<const THOUSANDTHS: usize>(
    name: &'static str,
    parameters: &'static [(&'static str, f64)],
    formula: &'static str,
) -> Metric {
    let noise_floor = noise_floor::<THOUSANDTHS>;
    Metric { version: 2, parameters, noise_floor, ..Metric::linear(name, formula, evaluate::<THOUSANDTHS>) }
}

fn evaluate<const THOUSANDTHS: usize>(comparison: &Comparison, pixels: &[usize]) -> f64 {
    let squares = comparison.relative_squares();
    let mut selected: Vec<f64> = pixels.iter().map(|&pixel| squares[pixel]).collect();
    let rank = (selected.len() * THOUSANDTHS).div_ceil(1000);
    let (_, value, _) = selected.select_nth_unstable_by(rank - 1, f64::total_cmp);
    value.sqrt()
}

/// Bisections for a quantile: 2^-20 of the largest scale.
const BISECTION_STEPS: usize = 20;

/// Takes a pixel's error as one value with standard error sqrt(RGB mean of `se² / (r² + ε)`), since channels share
/// samples. The floor is the percentile of the mixture over pixels; for the maximum, the median of its distribution.
fn noise_floor<const THOUSANDTHS: usize>(noise: &ReferenceNoise) -> Option<f64> {
    let scales: Vec<f64> = noise.relative_squares().iter().map(|square| square.sqrt()).collect();
    let largest = scales.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 {
        return Some(0.0);
    }
    let tail = |error: f64, scale: f64| if scale == 0.0 { 0.0 } else { error_tail(error / scale) };
    let fraction = THOUSANDTHS as f64 / 1000.0;
    let is_below = |error: f64| {
        if THOUSANDTHS < 1000 {
            scales.iter().map(|&scale| tail(error, scale)).sum::<f64>() > (1.0 - fraction) * scales.len() as f64
        } else {
            scales.iter().map(|&scale| (-tail(error, scale)).ln_1p()).sum::<f64>() < 0.5f64.ln()
        }
    };
    let (mut lo, mut hi) = (0.0, largest * LARGEST_ERROR);
    for _ in 0..BISECTION_STEPS {
        let middle = 0.5 * (lo + hi);
        if is_below(middle) { lo = middle } else { hi = middle }
    }
    Some(0.5 * (lo + hi))
}
