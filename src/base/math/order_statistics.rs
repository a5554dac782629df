//! Order statistics of samples.

/// Median of samples in any order, by linear interpolation; NaN for no samples.
pub fn median(samples: &[f64]) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let a = sorted[last / 2];
    let b = sorted[last.div_ceil(2)];
    if a == b || a.is_infinite() && b.is_finite() {
        a
    } else {
        a + 0.5 * (b - a)
    }
}

/// Probability with which an interval holds the truth.
pub const COVERAGE: f64 = 0.95;

/// Probability with which the k-th order statistics from each end, k from 0, hold the median of any
/// continuous distribution: 1 - 2 P(B <= k), with B the heads of n fair coins.
pub fn order_coverage(n: usize, k: usize) -> f64 {
    let coins = |k: usize| {
        (0..k).fold(0.5f64.powi(n as i32), |term, i| {
            term * (n - i) as f64 / (i + 1) as f64
        })
    };
    1.0 - 2.0 * (0..=k).map(coins).sum::<f64>()
}

/// The k of the narrowest such pair with at least 95 %; `None` below six samples: all are on one
/// side of the median with probability 2 0.5^n > 0.05.
pub fn median_order(n: usize) -> Option<usize> {
    (0..n.div_ceil(2))
        .take_while(|k| order_coverage(n, *k) >= COVERAGE)
        .last()
}

/// 95 % interval of the median: the order statistics of [`median_order`]. NaN below six samples.
pub fn median_interval(samples: &[f64]) -> [f64; 2] {
    let Some(outer) = median_order(samples.len()) else {
        return [f64::NAN; 2];
    };
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    [sorted[outer], sorted[samples.len() - 1 - outer]]
}

#[cfg(test)]
mod tests;
