//! LDR-FLIP [Andersson20]: what a viewer notices when the two display images alternate in place.
//!
//! The 8-bit display values are read as sRGB. The error is a property of the viewing distance: here the authors' default, a 0.7 m
//! wide monitor of 3840 pixels seen from 0.7 m. What a viewer makes of one image does not depend on the other one ([`View`]), so that
//! a sweep prepares each reference once; that is why this is not one of the crates that wrap the authors' program, against which
//! the tests hold it pixel by pixel.

mod view;

use super::comparison::pixel_mean;
use super::{Better, Comparison, Description, Metric, ReferenceNoise, Space};
use crate::pixels::GrayImage;
use std::sync::LazyLock;
pub(super) use view::View;

/// Pixels per degree of visual angle: distance · pixels / width · π / 180, here 3840 π / 180.
pub const PIXELS_PER_DEGREE: f32 = 67.020_645;

/// Exponent of the colour difference, `q_c`, section 4.1.
const COLOUR_EXPONENT: f32 = 0.7;
/// Share of the largest colour difference, `p_c`, that is mapped to [`COMPRESSED_SHARE`] of the range, `p_t`: section 4.1.
const LARGE_SHARE: f32 = 0.4;
const COMPRESSED_SHARE: f32 = 0.95;
/// Exponent of the feature difference, `q_f`, section 4.2.
const FEATURE_EXPONENT: f32 = 0.5;

/// Mean of the FLIP error map, in [0, 1]; 0 for equal images.
pub struct Flip;

impl Metric for Flip {
    fn description(&self) -> &'static Description {
        &Description {
            name: "flip",
            space: Space::Display,
            better: Better::Lower,
            version: 2,
            parameters: &[("pixels_per_degree", PIXELS_PER_DEGREE as f64)],
            formula: "mean of the LDR-FLIP error map (Andersson et al. 2020) of the 8-bit display values at 67 pixels per degree, 0 to 1",
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

/// FLIP error at every pixel of two views of one size, section 4.3: `ΔE = ΔE_c^(1 - ΔE_f)`.
pub(super) fn flip_map(test: &View, reference: &View) -> GrayImage {
    let error = |pixel: usize| {
        let feature = test.feature_difference(reference, pixel).powf(FEATURE_EXPONENT);
        spread(hyab(test.lab(pixel), reference.lab(pixel)).powf(COLOUR_EXPONENT)).powf(1.0 - feature)
    };
    let [width, height] = test.size();
    GrayImage::new(width, height, (0..width as usize * height as usize).map(error).collect())
}

/// HyAB distance of two colours in Hunt-adjusted L*a*b*: city block in lightness, Euclidean in chroma.
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// A colour difference, after its exponent, on [0, 1]: the large ones, which all look different, share little of the range.
fn spread(difference: f32) -> f32 {
    // The largest there is: between green and blue.
    static LARGEST: LazyLock<f32> = LazyLock::new(|| {
        let [green, blue] = [[0, 255, 0], [0, 0, 255]].map(view::flat_lab);
        hyab(green, blue).powf(COLOUR_EXPONENT)
    });
    let knee = LARGE_SHARE * *LARGEST;
    if difference < knee {
        return COMPRESSED_SHARE / knee * difference;
    }
    COMPRESSED_SHARE + (difference - knee) / (*LARGEST - knee) * (1.0 - COMPRESSED_SHARE)
}
