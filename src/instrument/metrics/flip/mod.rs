//! LDR-FLIP [Andersson20]: visible difference of two alternating images.
//!
//! Reads the display values as sRGB, at the authors' default distance: a 0.7 m wide monitor of 3840
//! pixels seen from 0.7 m. A sweep computes [`view::View`] of each reference once, which crates
//! around the authors' program cannot; tests compare with it.

pub(super) mod map;
pub(super) mod view;

use super::mean::pixel_mean;
use super::{Metric, NoiseEffect, Space};

/// Pixels per degree of visual angle: distance · pixels / width · π / 180.
pub const PIXELS_PER_DEGREE: f32 = 67.020_645;

/// Mean of the FLIP error map, in [0, 1]; 0 for equal images.
pub static FLIP: Metric = Metric {
    space: Space::Display,
    version: 2,
    noise: NoiseEffect::Fades,
    parameters: &[("pixels_per_degree", PIXELS_PER_DEGREE as f64)],
    ..Metric::linear(
        "flip",
        "mean of the LDR-FLIP error map (Andersson et al. 2020) of the 8-bit display values at 67 \
         pixels per degree, 0 to 1",
        |comparison, pixels| {
            let map = comparison.flip();
            pixel_mean(pixels, |pixel| f64::from(map.data[pixel]))
        },
    )
};
