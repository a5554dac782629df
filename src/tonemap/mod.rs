//! The tone curve: radiance to display values, per channel,
//!
//! `c = (e L / (e L + 1))^(contrast / 2.2)`
//!
//! with `L` linear radiance ≥ 0, `e` the exposure and `c` in [0, 1): Reinhard's global operator, then the display exponent
//! (source document 0). Contrast > 1 darkens, because its base is below 1. Displays take `c` as sRGB-encoded; the exponent
//! 1/2.2 only approximates that encoding, and it is kept because the document prints it.
//!
//! The domain is finite radiance ≥ 0. A negative or non-finite value cannot come from a correct estimator of a non-negative
//! integrand; the stage that made it must report it, with stage and texel. The f64 twin in [`mod@reference`] asserts the domain.

pub mod reference;

/// The display exponent that `contrast` multiplies the inverse of.
pub const DISPLAY_GAMMA: f64 = 2.2;

#[cfg(feature = "gpu")]
pub mod pass;

/// Parameters of the tone curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneCurve {
    /// `e`, > 0.
    pub exposure: f32,
    /// Exponent over 2.2, > 0; > 1 darkens.
    pub contrast: f32,
}

impl Default for ToneCurve {
    fn default() -> Self {
        Self { exposure: 1.0, contrast: 1.0 }
    }
}
