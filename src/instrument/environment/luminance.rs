//! Luminance of environments.

use crate::base::color::luminance;
use crate::base::pixels::RgbImage;
use std::f64::consts::PI;

/// Luminance of an environment, in its own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Luminance {
    /// Mean over the sphere.
    pub mean: f64,
    /// Brightest texel.
    pub peak: f64,
}

impl Luminance {
    /// Measures a map. Rows are weighted by sin θ.
    pub fn from_image(image: &RgbImage) -> Self {
        let mut sum = 0.0;
        let mut weights = 0.0;
        let mut peak = 0.0f64;
        for (row, texels) in image.data.chunks(image.width as usize).enumerate() {
            let weight = (PI * (row as f64 + 0.5) / f64::from(image.height)).sin();
            for texel in texels {
                let value = luminance(*texel);
                sum += weight * value;
                peak = peak.max(value);
            }
            weights += weight * texels.len() as f64;
        }
        Self {
            mean: sum / weights,
            peak,
        }
    }

    /// Returns the dynamic range in stops, log2 of peak over mean; `None` for a black environment.
    pub fn range_stops(&self) -> Option<f64> {
        Some((self.peak / self.mean).log2()).filter(|stops| stops.is_finite())
    }
}
