//! Tables made once per environment or BRDF model.
pub mod dfg;
pub mod irradiance;
pub mod mips;
pub mod points;
pub mod prefilter;
pub mod sh9;

use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::pixels::RgbImage;

/// Prepares an environment's map for the exact integrals of the f64 references.
pub fn exact_quadrature(image: &RgbImage) -> EquirectQuadrature {
    EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y))
}

/// Sizes and sample counts of every precompute pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrecomputeSettings {
    /// Width and height of level 0 of the prefiltered map.
    pub prefilter_size: [u32; 2],
    /// Number of levels; level k holds perceptual roughness k / (levels - 1).
    pub prefilter_level_count: u32,
    pub prefilter_sample_count: u32,
    /// Side of the DFG table.
    pub dfg_size: u32,
    pub dfg_sample_count: u32,
    pub irradiance_size: [u32; 2],
    /// Azimuth and polar samples of the numerical irradiance integration.
    pub irradiance_sample_count: [u32; 2],
}

impl Default for PrecomputeSettings {
    fn default() -> Self {
        Self {
            prefilter_size: [256, 128],
            prefilter_level_count: 5,
            prefilter_sample_count: 256,
            dfg_size: 128,
            dfg_sample_count: 1024,
            irradiance_size: [64, 32],
            irradiance_sample_count: [128, 32],
        }
    }
}
