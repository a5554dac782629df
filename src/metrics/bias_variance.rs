//! Separates mean square error into bias and variance, by repeated renders with independent points.
//!
//! For `K` images with mean `m` and unbiased variance `s²`, and a reference with standard error `se`:
//!
//! `var_hat = mean s²`, the expected square noise of one image;
//! `bias2_hat = mean((m - r)² - s²/K - se²)`, since `E(m - r)² = bias² + Var/K + se²`.
//!
//! Both are unbiased for independent images; a small `bias2_hat` may be negative. Relative forms divide by `r² + ε`, so
//! they sum to the expected `relmse` of one image, apart from the reference's noise.

use super::comparison::{check_size, check_values, masked_pixels};
use super::{Epsilon, MetricsError};
use crate::pixels::{GrayImage, RgbImage};

/// The four estimates by their names in tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasVariance {
    /// Squared radiance, as `rmse` squared.
    pub var_hat: f64,
    pub bias2_hat: f64,
    /// In units of `relmse`.
    pub relative_var_hat: f64,
    pub relative_bias2_hat: f64,
}

impl BiasVariance {
    /// Columns of [`BiasVariance::values`].
    pub const NAMES: [&'static str; 4] = ["var_hat", "bias2_hat", Self::RELATIVE_NAMES[0], Self::RELATIVE_NAMES[1]];
    /// The parts of relMSE.
    pub const RELATIVE_NAMES: [&'static str; 2] = ["var_hat_rel", "bias2_hat_rel"];

    pub fn values(&self) -> [f64; 4] {
        [self.var_hat, self.bias2_hat, self.relative_var_hat, self.relative_bias2_hat]
    }
}

/// Collects repeated images: mean and squared deviations of each masked pixel \[Welford62\].
pub struct Repeats {
    size: [u32; 2],
    pixels: Vec<usize>,
    count: usize,
    moments: Vec<[[f64; 2]; 3]>,
}

impl Repeats {
    pub fn new(mask: &GrayImage) -> Result<Self, MetricsError> {
        let size = [mask.width, mask.height];
        let pixels = masked_pixels(mask, size)?;
        let moments = vec![[[0.0; 2]; 3]; pixels.len()];
        Ok(Self { size, pixels, count: 0, moments })
    }

    pub fn add(&mut self, image: &RgbImage) -> Result<(), MetricsError> {
        check_size("repeated image", image, self.size)?;
        check_values("repeated image", image, &self.pixels)?;
        self.count += 1;
        for (&pixel, moments) in self.pixels.iter().zip(&mut self.moments) {
            for (value, [mean, squares]) in image.data[pixel].iter().zip(moments) {
                let step = f64::from(*value) - *mean;
                *mean += step / self.count as f64;
                *squares += step * (f64::from(*value) - *mean);
            }
        }
        Ok(())
    }

    /// Estimates against a reference, exact unless it has a standard error. `None` below two images.
    pub fn finish(
        &self,
        reference: &RgbImage,
        standard_error: Option<&RgbImage>,
        epsilon: Epsilon,
    ) -> Result<Option<BiasVariance>, MetricsError> {
        check_size("reference", reference, self.size)?;
        check_values("reference", reference, &self.pixels)?;
        if let Some(image) = standard_error {
            check_size("standard error image", image, self.size)?;
            check_values("standard error image", image, &self.pixels)?;
        }
        if self.count < 2 {
            return Ok(None);
        }
        let count = self.count as f64;
        let mut sums = [0.0; 4];
        for (&pixel, moments) in self.pixels.iter().zip(&self.moments) {
            for (c, [mean, squares]) in moments.iter().enumerate() {
                let r = f64::from(reference.data[pixel][c]);
                let se = standard_error.map_or(0.0, |image| f64::from(image.data[pixel][c]));
                let variance = squares / (count - 1.0);
                let bias2 = (mean - r).powi(2) - variance / count - se * se;
                let relative = [variance, bias2].map(|square| epsilon.relative(square, r));
                for (sum, term) in sums.iter_mut().zip([variance, bias2, relative[0], relative[1]]) {
                    *sum += term;
                }
            }
        }
        let [var_hat, bias2_hat, relative_var_hat, relative_bias2_hat] =
            sums.map(|sum| sum / (3 * self.pixels.len()) as f64);
        Ok(Some(BiasVariance { var_hat, bias2_hat, relative_var_hat, relative_bias2_hat }))
    }
}
