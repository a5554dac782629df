//! The FLIP error of two views, pixel by pixel [Andersson20, section 4].

use super::view::{View, flat_lab};
use crate::pixels::GrayImage;
use std::sync::LazyLock;

/// Exponent of the colour difference, `q_c`, section 4.1.
const COLOUR_EXPONENT: f32 = 0.7;
/// Share of the largest colour difference, `p_c`, that is mapped to [`COMPRESSED_SHARE`] of the range, `p_t`: section 4.1.
const LARGE_SHARE: f32 = 0.4;
const COMPRESSED_SHARE: f32 = 0.95;
/// Exponent of the feature difference, `q_f`, section 4.2.
const FEATURE_EXPONENT: f32 = 0.5;

/// FLIP error at every pixel of two views of one size, section 4.3: `ΔE = ΔE_c^(1 - ΔE_f)`.
pub fn flip_map(test: &View, reference: &View) -> GrayImage {
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
        let [green, blue] = [[0, 255, 0], [0, 0, 255]].map(flat_lab);
        hyab(green, blue).powf(COLOUR_EXPONENT)
    });
    let knee = LARGE_SHARE * *LARGEST;
    if difference < knee {
        return COMPRESSED_SHARE / knee * difference;
    }
    COMPRESSED_SHARE + (difference - knee) / (*LARGEST - knee) * (1.0 - COMPRESSED_SHARE)
}
