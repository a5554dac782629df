//! The parts of a bake as its files have them: nothing is turned or scaled.

use super::sh::Coefficients;
use crate::environment::layout::MapLayout;
use crate::pixels::RgbImage;

/// A map with its levels.
#[derive(Clone, Debug)]
pub struct Map {
    pub layout: &'static MapLayout,
    /// Levels, smoothest first, each with the layout's faces.
    pub levels: Vec<Vec<RgbImage>>,
}

/// What was found in the files of a bake.
#[derive(Clone, Debug, Default)]
pub struct Bake {
    /// Prefiltered radiance.
    pub specular: Option<Map>,
    /// Irradiance, in one level.
    pub irradiance: Option<Map>,
    /// The second factor of the split sum.
    pub dfg: Option<RgbImage>,
    pub sh: Option<Coefficients>,
    pub told: Told,
}

/// What files say of themselves: the manifest of `splitsum bake`.
#[derive(Clone, Debug, Default)]
pub struct Told {
    pub alphas: Option<Vec<f64>>,
    pub weight: Option<String>,
    pub masking: Option<String>,
}
