//! Mean square error parted into bias and variance, by repeated renders with independent sample points.
//!
//! Over `K` images `t_1 ... t_K` of one method, with the mean `m` and the unbiased sample variance `s²` of each pixel and channel, and a
//! reference with standard error `se`:
//!
//! `var_hat = mean s²`, the expected square noise of one image;
//! `bias2_hat = mean((m - r)² - s²/K - se²)`, since `E(m - r)² = bias² + Var/K + se²`.
//!
//! Both are unbiased where the images are independent; `bias2_hat` can come out below 0 where the bias is small. The relative forms
//! divide each term by `r² + ε`, so that their sum is what `relmse` of one image is expected to be, the reference's noise aside.

use super::comparison::{check_size, check_values, masked_pixels};
use super::{Epsilon, MetricsError};
use crate::pixels::{GrayImage, RgbImage};

/// The four figures by their names in tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasVariance {
    /// In squared radiance, as `rmse` squared.
    pub var_hat: f64,
    pub bias2_hat: f64,
    /// In units of `relmse`.
    pub relative_var_hat: f64,
    pub relative_bias2_hat: f64,
}

impl BiasVariance {
    /// Column names, in the order of [`BiasVariance::values`].
    pub const NAMES: [&'static str; 4] = ["var_hat", "bias2_hat", Self::RELATIVE_NAMES[0], Self::RELATIVE_NAMES[1]];
    /// Of them the parts of relMSE.
    pub const RELATIVE_NAMES: [&'static str; 2] = ["var_hat_rel", "bias2_hat_rel"];

    /// The figures in the order of [`BiasVariance::NAMES`].
    pub fn values(&self) -> [f64; 4] {
        [self.var_hat, self.bias2_hat, self.relative_var_hat, self.relative_bias2_hat]
    }
}

/// Collects repeated images over a mask: mean and sum of squared deviations of each masked pixel \[Welford62\].
pub struct Repeats {
    size: [u32; 2],
    pixels: Vec<usize>,
    count: usize,
    moments: Vec<[[f64; 2]; 3]>,
}

impl Repeats {
    /// No images yet.
    pub fn new(mask: &GrayImage) -> Result<Self, MetricsError> {
        let size = [mask.width, mask.height];
        let pixels = masked_pixels(mask, size)?;
        let moments = vec![[[0.0; 2]; 3]; pixels.len()];
        Ok(Self { size, pixels, count: 0, moments })
    }

    /// Takes one image.
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

    /// The figures against a reference; without its standard error it counts as exact. `None` below two images.
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
