//! FLIP error of two views [Andersson20, section 4].

use super::view::{View, flat_lab};
use crate::base::pixels::GrayImage;
use std::sync::LazyLock;

/// Exponent `q_c` of the colour difference, section 4.1.
const COLOUR_EXPONENT: f32 = 0.7;
/// Share `p_c` of the largest colour difference, mapped to `p_t` of the range, section 4.1.
const LARGE_SHARE: f32 = 0.4;
const COMPRESSED_SHARE: f32 = 0.95;
/// Exponent `q_f` of the feature difference, section 4.2.
const FEATURE_EXPONENT: f32 = 0.5;

/// Computes FLIP at every pixel, section 4.3: `ΔE = ΔE_c^(1 - ΔE_f)`.
pub fn flip_map(test: &View, reference: &View) -> GrayImage {
    let error = |pixel: usize| {
        let feature = test
            .feature_difference(reference, pixel)
            .powf(FEATURE_EXPONENT);
        spread(hyab(test.lab(pixel), reference.lab(pixel)).powf(COLOUR_EXPONENT))
            .powf(1.0 - feature)
    };
    let [width, height] = test.size();
    GrayImage::new(
        width,
        height,
        (0..width as usize * height as usize).map(error).collect(),
    )
}

/// HyAB distance in Hunt-adjusted L*a*b*: city block in lightness, Euclidean in chroma.
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Maps a colour difference to [0, 1] and compresses large ones.
fn spread(difference: f32) -> f32 {
    // Between green and blue.
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
