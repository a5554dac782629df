//! Statistics of samples: random numbers, order statistics, drift.

/// The random numbers of splitmix64 \[Steele14\], a hashed Weyl sequence.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// A number in `0..count`; the bias of taking a product's upper half is below count / 2^64.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }

    /// `0..count` in random order (Fisher-Yates).
    pub fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }
}

/// Quantile of ascending samples by linear interpolation (\[HyndmanFan96\] type 7); NaN for no samples.
pub fn quantile(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = p * last as f64;
    let below = place.floor() as usize;
    let (share, a, b) = (place - below as f64, sorted[below], sorted[(below + 1).min(last)]);
    // An infinity counts unless its weight is 0.
    if share == 0.0 || a == b || a.is_infinite() && b.is_finite() { a } else { a + share * (b - a) }
}

/// Median of samples in any order; NaN for no samples.
pub fn median(samples: &[f64]) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.5)
}

/// Fewer samples have no 95 % interval of their median: even the interval from the smallest to the largest misses it with probability
/// 2 0.5^n > 0.05, if all samples fall on one side.
pub const INTERVAL_SAMPLES_MIN: usize = 6;
/// Probability with which an interval holds the truth.
pub const COVERAGE: f64 = 0.95;

/// Probability with which the k-th order statistics from each end, k from 0, hold the median of any continuous distribution:
/// 1 - 2 P(B <= k), with B the heads of n fair coins.
pub fn order_coverage(n: usize, k: usize) -> f64 {
    let coins = |k: usize| (0..k).fold(0.5f64.powi(n as i32), |term, i| term * (n - i) as f64 / (i + 1) as f64);
    1.0 - 2.0 * (0..=k).map(coins).sum::<f64>()
}

/// The k of the narrowest such pair with at least 95 %; `None` if even the outermost pair has less.
pub fn median_order(n: usize) -> Option<usize> {
    (0..n.div_ceil(2)).take_while(|k| order_coverage(n, *k) >= COVERAGE).last()
}

/// 95 % interval of the median: the order statistics of [`median_order`]. NaN below [`INTERVAL_SAMPLES_MIN`].
pub fn median_interval(samples: &[f64]) -> [f64; 2] {
    let Some(outer) = median_order(samples.len()) else { return [f64::NAN; 2] };
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    [sorted[outer], sorted[samples.len() - 1 - outer]]
}

/// Median of the slopes of all pairs of points \[Sen68\]; NaN if no two x differ.
pub fn drift(points: &[(f64, f64)]) -> f64 {
    let pairs = points.iter().enumerate().flat_map(|(i, a)| points[i + 1..].iter().map(move |b| (a, b)));
    let slopes: Vec<f64> = pairs.filter(|(a, b)| a.0 != b.0).map(|(a, b)| (b.1 - a.1) / (b.0 - a.0)).collect();
    median(&slopes)
}
