//! The tone curve in f64: the twin of the device pass, also used by the display metrics.

use super::{DISPLAY_GAMMA, ToneCurve};
use crate::base::pixels::{Rgb8Image, RgbImage};

const CODE_MAX: f64 = 255.0;

impl ToneCurve {
    /// Returns the display values of linear radiance, each in [0, 1); radiance above 2^53 /
    /// exposure rounds to 1.
    ///
    /// Panics if radiance is negative or not finite, or if exposure or contrast is not positive and
    /// finite.
    pub fn apply(&self, radiance: [f64; 3]) -> [f64; 3] {
        let exposure = f64::from(self.exposure);
        let contrast = f64::from(self.contrast);
        let positive = |x: f64| x.is_finite() && x > 0.0;
        assert!(
            positive(exposure) && positive(contrast),
            "tone curve parameters must be positive: {self:?}"
        );
        radiance.map(|l| {
            assert!(
                l.is_finite() && l >= 0.0,
                "radiance {l} reached the tone curve; it must be finite and not negative"
            );
            let exposed = exposure * l;
            (exposed / (exposed + 1.0)).powf(contrast / DISPLAY_GAMMA)
        })
    }

    /// Returns display values as 8-bit codes: `255 c` rounded to nearest, halves up. Panics as
    /// [`Self::apply`] does.
    pub fn apply_rgb8(&self, radiance: [f32; 3]) -> [u8; 3] {
        // The cast cannot truncate: c is in [0, 1].
        self.apply(radiance.map(f64::from))
            .map(|c| (c * CODE_MAX).round() as u8)
    }

    /// Returns the 8-bit display image of a radiance image. Panics as [`Self::apply`] does.
    pub fn apply_image(&self, radiance: &RgbImage) -> Rgb8Image {
        radiance.map(|pixel| self.apply_rgb8(pixel))
    }
}
