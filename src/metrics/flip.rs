//! LDR-FLIP [Andersson20]: what a viewer notices when the two display images alternate in place.
//!
//! By the crate nv-flip (NVIDIA's program before its single-header form; 2e-5 from flip-evaluator 1.7 in the mean). The 8-bit
//! display values are read as sRGB. The error is a property of the viewing distance: here the authors' default, a 0.7 m wide
//! monitor of 3840 pixels seen from 0.7 m.

use super::comparison::pixel_mean;
use super::{Better, Comparison, Description, Metric, ReferenceNoise, Space};
use crate::pixels::{GrayImage, Rgb8Image};
use nv_flip::FlipImageRgb8;

/// Pixels per degree of visual angle: distance · pixels / width · π / 180, here 3840 π / 180. The constant of nv-flip is rounded
/// to 67, which would move scores away from those of the authors' tool.
pub const PIXELS_PER_DEGREE: f32 = 67.020_645;

/// Mean of the FLIP error map, in [0, 1]; 0 for equal images.
pub struct Flip;

impl Metric for Flip {
    fn description(&self) -> &'static Description {
        &Description {
            name: "flip",
            space: Space::Display,
            better: Better::Lower,
            version: 1,
            parameters: &[("pixels_per_degree", PIXELS_PER_DEGREE as f64)],
            formula: "mean of the LDR-FLIP error map (nv-flip) of the 8-bit display values at 67 pixels per degree, 0 to 1",
            power: 1.0,
        }
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let map = comparison.flip();
        pixel_mean(pixels, |pixel| f64::from(map.data[pixel]))
    }

    fn noise_floor(&self, _: &ReferenceNoise) -> Option<f64> {
        None
    }
}

/// FLIP error at every pixel.
pub(super) fn flip_map(test: &Rgb8Image, reference: &Rgb8Image) -> GrayImage {
    let upload = |image: &Rgb8Image| FlipImageRgb8::with_data(image.width, image.height, image.data.as_flattened());
    let map = nv_flip::flip(upload(reference), upload(test), PIXELS_PER_DEGREE);
    GrayImage::new(test.width, test.height, map.to_vec())
}
