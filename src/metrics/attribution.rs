//! Which step of a chain of images makes the error of its last one.

use super::Epsilon;
use crate::pixels::{GrayImage, RgbImage};

/// One step of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Covariance share: `Σ w δ e / Σ w e²`, with δ the step, e the sum of all steps, `w = 1/(r² + ε)`, r the chain's first image.
    /// Shares sum to 1; a negative one cancels error of the others.
    pub share: f64,
    /// `relmse` of the image after the step against the first.
    pub relmse: f64,
}

/// The steps between these images, over the masked pixels and their channels; one fewer than images. Where the last image is the first,
/// shares are NaN.
pub fn steps(chain: &[&RgbImage], mask: &GrayImage, epsilon: Epsilon) -> Vec<Step> {
    let pixels: Vec<usize> = (0..mask.data.len()).filter(|&pixel| mask.data[pixel] > 0.0).collect();
    // Σ w a b over (pixel, channel), with a and b differences of two images.
    let weighted = |a: [usize; 2], b: [usize; 2]| -> f64 {
        let of_pixel = |&pixel: &usize| -> f64 {
            let at = |image: usize, c: usize| f64::from(chain[image].data[pixel][c]);
            let term = |c: usize| {
                (at(a[1], c) - at(a[0], c)) * (at(b[1], c) - at(b[0], c)) / (at(0, c).powi(2) + epsilon.beside_square())
            };
            (0..3).map(term).sum()
        };
        pixels.iter().map(of_pixel).sum()
    };
    let last = chain.len() - 1;
    let whole = weighted([0, last], [0, last]);
    let step = |i: usize| Step {
        share: weighted([i - 1, i], [0, last]) / whole,
        relmse: weighted([0, i], [0, i]) / (3 * pixels.len()) as f64,
    };
    (1..=last).map(step).collect()
}
