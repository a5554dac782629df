//! Relative bias: light gained or lost in total.

use super::{Better, Comparison, Description, Metric, ReferenceNoise};

/// `sum d / sum r`, positive if the test is too bright. A black reference gives 0 for a black test, else infinity.
pub struct RelativeBias;

impl Metric for RelativeBias {
    fn description(&self) -> &'static Description {
        const DESCRIPTION: Description = Description {
            better: Better::NearerZero,
            ..Description::linear("bias_rel", "sum d / sum r: energy gained (+) or lost (-)")
        };
        &DESCRIPTION
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let (mut difference, mut energy) = (0.0, 0.0);
        for &pixel in pixels {
            let [t, r] = comparison.radiance(pixel);
            difference += (0..3).map(|c| t[c] - r[c]).sum::<f64>();
            energy += r.iter().sum::<f64>();
        }
        ratio(difference, energy)
    }

    /// Standard error of the sum over the sum. Pixels count as independent, channels as fully correlated, which raises
    /// the floor
    /// by at most sqrt(3).
    fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        let (mut variance, mut energy) = (0.0, 0.0);
        for [r, se] in noise.samples() {
            variance += se.iter().sum::<f64>().powi(2);
            energy += r.iter().sum::<f64>();
        }
        Some(ratio(variance.sqrt(), energy))
    }
}

/// Divides, with 0/0 = 0.
fn ratio(numerator: f64, denominator: f64) -> f64 {
    if numerator == 0.0 { 0.0 } else { numerator / denominator }
}
