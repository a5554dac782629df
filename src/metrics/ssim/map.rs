//! Structural similarity [Wang04, eq. 13] with the parameters of section III-C.
//!
//! Per pixel, over an 11×11 Gaussian window of σ = 1.5 pixels with weights that sum to 1:
//! `SSIM = (2 μt μr + C1)(2 σtr + C2) / ((μt² + μr² + C1)(σt² + σr² + C2))`, `C1 = (0.01 · 255)²`, `C2 = (0.03 ·
//! 255)²`.
//!
//! Computed on luma `0.299 R + 0.587 G + 0.114 B` of 8-bit values, as the authors' program does, so blind to hue.
//! Departure: the paper drops windows across the border; here they are cut and renormalised.

use crate::metrics::filter::{Border, Plane};
use crate::pixels::Rgb8Image;

/// Pixels from the window's centre to its edge.
const WINDOW_RADIUS: usize = 5;
/// Standard deviation of the window, pixels.
pub(super) const WINDOW_SIGMA: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);
/// Rec. 601 luma weights.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Local means of one image.
#[derive(Debug)]
pub struct View {
    luma: Plane<f64>,
    mean: Plane<f64>,
    mean_square: Plane<f64>,
}

impl View {
    pub fn new(image: &Rgb8Image) -> Self {
        let luma_at = |pixel: usize| (0..3).map(|c| LUMA[c] * f64::from(image.data[pixel][c])).sum();
        let luma = Plane::from_fn(image.width as usize, image.data.len(), luma_at);
        Self { mean: window_mean(&luma), mean_square: window_mean(&product(&luma, &luma)), luma }
    }
}

pub fn ssim_map(test: &View, reference: &View) -> Plane<f64> {
    let mean_product = window_mean(&product(&test.luma, &reference.luma));
    let ssim = |pixel: usize| {
        let [t, r] = [test, reference].map(|view| view.mean.data[pixel]);
        let [tt, rr] = [test, reference].map(|view| view.mean_square.data[pixel]);
        let (variance_t, variance_r, covariance) = (tt - t * t, rr - r * r, mean_product.data[pixel] - t * r);
        (2.0 * t * r + C1) * (2.0 * covariance + C2) / ((t * t + r * r + C1) * (variance_t + variance_r + C2))
    };
    Plane::from_fn(mean_product.width, mean_product.data.len(), ssim)
}

fn product(a: &Plane<f64>, b: &Plane<f64>) -> Plane<f64> {
    Plane::from_fn(a.width, a.data.len(), |pixel| a.data[pixel] * b.data[pixel])
}

/// Gaussian mean over the part of the window inside the image; window and cut are separable.
fn window_mean(plane: &Plane<f64>) -> Plane<f64> {
    let distance = |i: usize| i as f64 - WINDOW_RADIUS as f64;
    let taps: [f64; 2 * WINDOW_RADIUS + 1] =
        std::array::from_fn(|i| (-0.5 * (distance(i) / WINDOW_SIGMA).powi(2)).exp());
    let (width, height) = (plane.width, plane.data.len() / plane.width);
    let in_row = Plane { width, data: vec![1.0; width] }.filter_rows(&taps, Border::Nothing).data;
    let in_column = Plane { width: 1, data: vec![1.0; height] }.filter_columns(&taps, Border::Nothing).data;
    let mut sums = plane.filter_rows(&taps, Border::Nothing).filter_columns(&taps, Border::Nothing);
    for (row, row_weight) in sums.data.chunks_exact_mut(width).zip(in_column) {
        row.iter_mut().zip(&in_row).for_each(|(sum, weight)| *sum /= weight * row_weight);
    }
    sums
}
