//! How bright an environment is.

use crate::color::luminance;
use crate::pixels::RgbImage;
use std::f64::consts::PI;

/// Luminance of an environment, in its own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Luminance {
    /// Over the sphere of directions.
    pub mean: f64,
    /// Of the brightest texel.
    pub peak: f64,
}

impl Luminance {
    /// Measures a map. Rows of texels are weighted by sin(theta), their share of the sphere.
    pub fn of(image: &RgbImage) -> Self {
        let (mut sum, mut weights, mut peak) = (0.0, 0.0, 0.0f64);
        for (row, texels) in image.data.chunks(image.width as usize).enumerate() {
            let weight = (PI * (row as f64 + 0.5) / f64::from(image.height)).sin();
            for texel in texels {
                let value = luminance(*texel);
                sum += weight * value;
                peak = peak.max(value);
            }
            weights += weight * texels.len() as f64;
        }
        Self { mean: sum / weights, peak }
    }

    /// Dynamic range: log2 of peak over mean; `None` for a black environment.
    pub fn range_stops(&self) -> Option<f64> {
        Some((self.peak / self.mean).log2()).filter(|stops| stops.is_finite())
    }
}
