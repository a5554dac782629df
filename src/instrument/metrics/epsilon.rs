//! The ε that bounds relative errors of dark pixels.

use glam::DVec3;

/// ε of relative metrics, proportional to the light, so that scores do not depend on its
/// brightness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epsilon {
    mean: f64,
}

impl Epsilon {
    /// ε of squares is this share of the squared mean luminance; ε of values, if a metric has one,
    /// this share of the mean.
    pub const SHARE: f64 = 1e-2;
    /// ε of light with mean luminance 1.
    pub const ABSOLUTE: Self = Self { mean: 1.0 };

    /// Returns ε of an environment with this mean luminance over the sphere, clip and scale
    /// included; [`Self::ABSOLUTE`] if black.
    pub fn of_light(mean: f64) -> Self {
        if mean > 0.0 {
            Self { mean }
        } else {
            Self::ABSOLUTE
        }
    }

    pub fn mean(self) -> f64 {
        self.mean
    }

    /// ε added to `r²`.
    pub fn squared_epsilon(self) -> f64 {
        Self::SHARE * self.mean * self.mean
    }

    /// Returns `square / (r² + ε)` of one channel, the term of `relmse`.
    pub fn relative(self, square: f64, r: f64) -> f64 {
        square / (r * r + self.squared_epsilon())
    }

    /// Returns `difference / sqrt(r² + ε)` of one channel.
    pub fn signed(self, difference: f64, r: f64) -> f64 {
        difference / (r * r + self.squared_epsilon()).sqrt()
    }

    /// Returns [`Self::relative`] of 1 for each channel.
    pub fn weight(self, r: DVec3) -> DVec3 {
        DVec3::from_array(r.to_array().map(|r| self.relative(1.0, r)))
    }
}
