//! Tables made once per environment or BRDF model.

pub mod dfg;
#[cfg(feature = "gpu")]
pub mod filtered;
pub mod given;
pub mod irradiance;
pub mod mips;
#[cfg(feature = "gpu")]
pub mod points;
pub mod prefilter;
mod settings;
pub mod sh9;
pub mod taps;

pub use crate::base::pixels::HALF_MAX;
pub use settings::{PrecomputeSettings, PrefilterBy, SettingsError, StorageFormat};

use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::pixels::RgbImage;

/// Prepares an environment's map for the exact integrals of the f64 references.
pub fn exact_quadrature(image: &RgbImage) -> EquirectQuadrature {
    EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y))
}
