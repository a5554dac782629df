//! The parts of a bake as stored, neither rotated nor scaled.

use super::sh::Coefficients;
use crate::environment::layout::MapLayout;
use crate::pixels::RgbImage;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug)]
pub struct Map {
    pub layout: &'static MapLayout,
    /// Smoothest level first, each with the layout's faces.
    pub levels: Vec<Vec<RgbImage>>,
}

#[derive(Clone, Debug, Default)]
pub struct Bake {
    /// Prefiltered radiance.
    pub specular: Option<Map>,
    /// Irradiance, in one level.
    pub irradiance: Option<Map>,
    pub dfg: Option<RgbImage>,
    pub sh: Option<Coefficients>,
    pub stated: Stated,
}

/// Conventions stated in the manifest of `splitsum bake`, or in the metadata of its KTX files.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Stated {
    pub preset: Option<String>,
    #[serde(rename = "prefilter_alphas")]
    pub alphas: Option<Vec<f64>>,
    #[serde(rename = "prefilter_weight")]
    pub weight: Option<String>,
    #[serde(rename = "masking_shadowing")]
    pub masking: Option<String>,
}

/// Prefix of our keys in the metadata of a KTX file.
pub const KEY: &str = "splitsum.";

impl Stated {
    /// Takes statements of a file's metadata that nothing stated before.
    pub(super) fn add(&mut self, keys: &[(String, String)]) {
        let value =
            |name: &str| keys.iter().find(|(key, _)| key.strip_prefix(KEY) == Some(name)).map(|(_, v)| v.clone());
        let alphas = || value("alphas")?.split(',').map(|alpha| alpha.parse().ok()).collect();
        self.preset = self.preset.take().or_else(|| value("preset"));
        self.alphas = self.alphas.take().or_else(alphas);
        self.weight = self.weight.take().or_else(|| value("weight"));
        self.masking = self.masking.take().or_else(|| value("masking"));
    }
}

/// The `bake.json` of a bake for an engine.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Manifest {
    pub version: String,
    pub engine: String,
    pub preset: String,
    pub environment: String,
    pub environment_hash: String,
    pub brdf: String,
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
    /// Files of one table in several formats.
    pub tables: Vec<String>,
    pub sh: Option<String>,
    /// The table of two taps (docs/paste.md).
    pub taps: Option<String>,
}
