//! The tone curve: radiance to display values, per channel,
//!
//! `c = (e L / (e L + 1))^(contrast / 2.2)`
//!
//! with `L` linear radiance ≥ 0, `e` the exposure and `c` in [0, 1): Reinhard's global operator,
//! then the display exponent \[Kim22\]. Contrast > 1 darkens, since the base is below 1. Displays
//! take `c` as sRGB-encoded; the exponent 1/2.2 only approximates that encoding, and is kept
//! because \[Kim22\] prints it.
//!
//! The domain is finite radiance ≥ 0. A correct estimator of a non-negative integrand gives no
//! other value; the stage that made one must report it, with stage and texel. The f64 twin in
//! [`mod@reference`] asserts the domain.

pub mod reference;

/// The display gamma: the exponent is `contrast` over this.
pub const DISPLAY_GAMMA: f64 = 2.2;

#[cfg(feature = "gpu")]
pub mod pass;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneCurve {
    /// `e`, > 0.
    pub exposure: f32,
    /// Exponent over 2.2, > 0; > 1 darkens.
    pub contrast: f32,
}

impl Default for ToneCurve {
    fn default() -> Self {
        Self {
            exposure: 1.0,
            contrast: 1.0,
        }
    }
}
