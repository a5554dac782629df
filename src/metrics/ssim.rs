//! Structural similarity [Wang04, eq. 13] of the display images, with the parameters of the paper's section III-C.
//!
//! Per pixel, over an 11×11 Gaussian window of σ = 1.5 pixels with weights that sum to 1:
//! `SSIM = (2 μt μr + C1)(2 σtr + C2) / ((μt² + μr² + C1)(σt² + σr² + C2))`, `C1 = (0.01 · 255)²`, `C2 = (0.03 · 255)²`.
//!
//! Computed on luma `0.299 R + 0.587 G + 0.114 B` of the 8-bit values, as the authors' program does; so it does not see an
//! error of hue alone (FLIP does). Departure: the paper keeps only windows that lie inside the image; here a window is cut at
//! the border and its weights are normalised again, so that every masked pixel has a value.

use super::comparison::pixel_mean;
use super::{Better, Comparison, Description, Metric, ReferenceNoise, Space};
use crate::pixels::{Pixels, Rgb8Image};

/// Pixels from the centre to the edge of the window.
const WINDOW_RADIUS: usize = 5;
/// Standard deviation of the window, pixels.
const WINDOW_SIGMA: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);
/// Rec. 601 luma weights of encoded RGB.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Mean of the SSIM map, in [-1, 1]; 1 for equal images.
pub struct Ssim;

impl Metric for Ssim {
    fn description(&self) -> &'static Description {
        &Description {
            name: "ssim",
            space: Space::Display,
            better: Better::Higher,
            version: 1,
            parameters: &[("window", 11.0), ("sigma", WINDOW_SIGMA), ("k1", 0.01), ("k2", 0.03)],
            formula: "mean structural similarity (Wang et al. 2004) of the 8-bit luma, 11x11 Gaussian window, sigma 1.5",
            power: 1.0,
        }
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let map = comparison.ssim();
        pixel_mean(pixels, |pixel| map.data[pixel])
    }

    fn noise_floor(&self, _: &ReferenceNoise) -> Option<f64> {
        None
    }
}

/// SSIM at every pixel.
pub(super) fn ssim_map(test: &Rgb8Image, reference: &Rgb8Image) -> Pixels<f64> {
    let luma = |rgb: [u8; 3]| (0..3).map(|c| LUMA[c] * f64::from(rgb[c])).sum::<f64>();
    let moments = Pixels::from_fn(test.width, test.height, |x, y| {
        let (t, r) = (luma(test.get(x, y)), luma(reference.get(x, y)));
        [t, r, t * t, r * r, t * r]
    });
    // The Gaussian is separable, and so is its cut at the image border.
    let (width, height) = (test.width as usize, test.height as usize);
    let moments = blur(&moments, |pixel| pixel % width, width, 1);
    let moments = blur(&moments, |pixel| pixel / width, height, width);
    moments.map(|[t, r, tt, rr, tr]| {
        let (variance_t, variance_r, covariance) = (tt - t * t, rr - r * r, tr - t * r);
        (2.0 * t * r + C1) * (2.0 * covariance + C2) / ((t * t + r * r + C1) * (variance_t + variance_r + C2))
    })
}

/// Local means over a window: of test, reference, their squares and their product.
type Moments = Pixels<[f64; 5]>;

/// Gaussian mean along one axis of `length` pixels that lie `stride` indices apart; `place` is a pixel's place on the axis.
fn blur(image: &Moments, place: impl Fn(usize) -> usize, length: usize, stride: usize) -> Moments {
    let weights: [f64; WINDOW_RADIUS + 1] =
        std::array::from_fn(|offset| (-0.5 * (offset as f64 / WINDOW_SIGMA).powi(2)).exp());
    let mean = |pixel: usize| {
        let centre = place(pixel);
        let (mut sum, mut weight_sum) = ([0.0; 5], 0.0);
        for other in centre.saturating_sub(WINDOW_RADIUS)..=(centre + WINDOW_RADIUS).min(length - 1) {
            let weight = weights[other.abs_diff(centre)];
            let moments = &image.data[pixel + other * stride - centre * stride];
            for (total, moment) in sum.iter_mut().zip(moments) {
                *total += weight * moment;
            }
            weight_sum += weight;
        }
        sum.map(|total| total / weight_sum)
    };
    Pixels::new(image.width, image.height, (0..image.data.len()).map(mean).collect())
}
