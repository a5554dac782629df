//! Tables made once per environment or BRDF model.

pub mod dfg;
#[cfg(feature = "gpu")]
pub mod filtered;
pub mod irradiance;
pub mod lobe_shape;
pub mod mips;
#[cfg(feature = "gpu")]
pub mod points;
pub mod prefilter;
mod settings;
pub mod sh9;
pub mod taps;

pub use settings::{HALF_MAX, PrecomputeSettings, PrefilterBy, SettingsError, StorageFormat};

use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::pixels::RgbImage;

/// A table of a model's lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LobeTableKind {
    /// [`lobe_shape`].
    Shapes,
    /// [`taps`], of so many taps.
    Taps(usize),
}

impl LobeTableKind {
    /// Every kind with the sampler that shaders read it from.
    pub const SAMPLERS: [(&'static str, Self); 3] =
        [("lobe_shapes", Self::Shapes), ("two_taps", Self::Taps(2)), ("four_taps", Self::Taps(4))];

    pub fn sampler(self) -> &'static str {
        Self::SAMPLERS.iter().find(|(_, kind)| *kind == self).expect("two or four taps").0
    }
}

/// Prepares an environment's map for the exact integrals of the f64 references.
pub fn exact_quadrature(image: &RgbImage) -> EquirectQuadrature {
    EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y))
}

/// Returns the table that a pass makes or fills in part: `prefilter mip 2` makes a level of `prefilter`.
pub fn table_of(pass: &str) -> &str {
    pass.split(' ').next().unwrap_or(pass)
}
