//! Signed error of the mean brightness: light gained or lost in total.

use super::{Better, Metric, Pooling};

/// `sum d / sum r`, positive if the test is too bright. A black reference gives 0 for a black test,
/// else infinity.
pub static BIAS: Metric = Metric {
    better: Better::NearerZero,
    pooling: Pooling::OverReference,
    // Standard error of the sum over the sum. Pixels count as independent, channels as fully
    // correlated, which raises the floor by at most sqrt(3).
    noise_floor: |noise| {
        let mut variance = 0.0;
        let mut energy = 0.0;
        for [r, se] in noise.samples() {
            variance += se.iter().sum::<f64>().powi(2);
            energy += r.iter().sum::<f64>();
        }
        Some(ratio(variance.sqrt(), energy))
    },
    ..Metric::linear(
        "bias_rel",
        "sum d / sum r: error of the mean brightness",
        |comparison, pixels| {
            let mut difference = 0.0;
            let mut energy = 0.0;
            for &pixel in pixels {
                let [t, r] = comparison.radiance(pixel);
                difference += (0..3).map(|c| t[c] - r[c]).sum::<f64>();
                energy += r.iter().sum::<f64>();
            }
            ratio(difference, energy)
        },
    )
};

/// Divides, with 0/0 = 0.
fn ratio(numerator: f64, denominator: f64) -> f64 {
    if numerator == 0.0 {
        0.0
    } else {
        numerator / denominator
    }
}
