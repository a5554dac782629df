//! What keeps dark pixels from deciding a relative metric.

use glam::DVec3;

/// ε of every relative metric, as a share of the light: without it a map of another brightness would have another metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epsilon {
    mean: f64,
}

impl Epsilon {
    /// ε over the mean luminance of the light, and beside a square over its square.
    pub const SHARE: f64 = 1e-2;
    /// That of light of mean luminance 1, whatever the light.
    pub const ABSOLUTE: Self = Self { mean: 1.0 };

    /// That of the environment as it lights the scene: `mean` is its luminance over the sphere, clip and scale included. A black one
    /// has the absolute ε, so that nothing divides by 0: what is seen is then lit by analytic lights, or black.
    pub fn of_light(mean: f64) -> Self {
        if mean > 0.0 { Self { mean } } else { Self::ABSOLUTE }
    }

    /// The mean luminance that counts.
    pub fn mean(self) -> f64 {
        self.mean
    }

    /// ε beside `r²`.
    pub fn beside_square(self) -> f64 {
        Self::SHARE * self.mean * self.mean
    }

    /// The term of `relmse`: `square / (r² + ε)`, of one channel.
    pub fn relative(self, square: f64, r: f64) -> f64 {
        square / (r * r + self.beside_square())
    }

    /// [`Self::relative`] of 1, of each channel: what the square of a difference from `r` counts.
    pub fn weight(self, r: DVec3) -> DVec3 {
        DVec3::from_array(r.to_array().map(|r| self.relative(1.0, r)))
    }

    /// ε beside `|r|`.
    pub fn beside_magnitude(self) -> f64 {
        Self::SHARE * self.mean
    }
}
