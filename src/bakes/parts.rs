//! The parts of a bake as its files have them: nothing is turned or scaled.

use super::sh::Coefficients;
use crate::environment::layout::MapLayout;
use crate::pixels::RgbImage;
use serde::{Deserialize, Serialize};

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
    /// Name of the preset.
    pub preset: Option<String>,
    pub alphas: Option<Vec<f64>>,
    pub weight: Option<String>,
    pub masking: Option<String>,
}

/// The `bake.json` of a bake for an engine: names of files beside it, and what they hold.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Manifest {
    pub version: String,
    pub engine: String,
    pub preset: String,
    pub environment: String,
    /// Of the texels that were read.
    pub environment_hash: String,
    pub brdf: String,
    /// Of the table.
    pub masking_shadowing: String,
    pub prefilter_weight: String,
    pub prefilter_alphas: Vec<f64>,
    pub level_mapping: String,
    pub axes: String,
    pub table_axes: String,
    pub units: String,
    pub pixel_format: String,
    pub specular: String,
    pub irradiance: Option<String>,
    /// One table in several forms.
    pub tables: Vec<String>,
    pub sh: Option<String>,
}
