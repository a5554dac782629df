//! What renderers change in a base below a clear coat. With f0 the base's reflectance in air, r its
//! perceptual roughness and c the weight of the coat, the g-buffer has (`shaders/gbuffer/surface.glsl`;
//! of the scene `design` and in tests by the functions here)
//!
//! - F0 `mix(f0, clamp(p(f0), 0, 1), c)`: below an index of 1.5 the step of the index is smaller. The
//!   polynomial p fits `((n - 1.5)/(n + 1.5))²` for `n = (1 + √f0)/(1 - √f0)`;
//! - a roughness by [`RoughnessUnderCoat`].

use crate::base::glsl::constants::{
    COAT_IOR, UNDER_COAT_AT_LEAST_COAT, UNDER_COAT_REFRACTED, UNDER_COAT_SAME,
};
use glam::DVec3;

/// The roughness of a base below a coat of weight c.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum RoughnessUnderCoat {
    #[default]
    Same = UNDER_COAT_SAME,
    /// `mix(r, max(r, r_coat), c)`: the coat's facets scatter what passes them.
    AtLeastCoat = UNDER_COAT_AT_LEAST_COAT,
    /// `2/alpha² - 2` is multiplied by η², `η = mix(1, 1/1.5, c)`: refraction widens the lobe.
    Refracted = UNDER_COAT_REFRACTED,
}

/// How a renderer changes the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnderCoatLaw {
    /// Coefficients of p, lowest power first.
    pub f0: [f32; 4],
    pub roughness: RoughnessUnderCoat,
}

impl UnderCoatLaw {
    pub const UNCHANGED: Self = Self {
        f0: [0.0, 1.0, 0.0, 0.0],
        roughness: RoughnessUnderCoat::Same,
    };

    /// Returns the base's F0 below a coat of weight `weight`.
    pub fn f0_below(&self, f0: DVec3, weight: f64) -> DVec3 {
        let [c0, c1, c2, c3] = self.f0.map(f64::from);
        let lowered = c0 + f0 * (c1 + f0 * (c2 + f0 * c3));
        f0.lerp(lowered.clamp(DVec3::ZERO, DVec3::ONE), weight)
    }

    /// Returns the base's alpha below a coat of weight `weight` and width `coat_alpha`.
    pub fn alpha_below(&self, alpha: f64, weight: f64, coat_alpha: f64) -> f64 {
        match self.roughness {
            RoughnessUnderCoat::Same => alpha,
            RoughnessUnderCoat::AtLeastCoat => {
                let more = (coat_alpha.sqrt() - alpha.sqrt()).max(0.0);
                (alpha.sqrt() + weight * more).powi(2)
            }
            RoughnessUnderCoat::Refracted => {
                let eta = 1.0 + weight * (1.0 / f64::from(COAT_IOR) - 1.0);
                let variance = 2.0 / (alpha * alpha) - 2.0;
                (2.0 / (variance * eta * eta + 2.0)).sqrt()
            }
        }
    }
}
