//! The parts of a bake as stored, neither rotated nor scaled.

use super::sh::Coefficients;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::layout::MapLayout;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug)]
pub struct Map {
    pub layout: &'static MapLayout,
    /// Smoothest level first, each with the layout's faces.
    pub levels: Vec<Vec<RgbImage>>,
}

impl Map {
    /// Cuts the texels of the file again as if its levels and faces were in the other order: of a
    /// file by faces, and of one by levels.
    pub fn reordered(&self) -> Vec<(&'static str, Self)> {
        let (levels, faces) = (0..self.levels.len(), 0..self.levels[0].len());
        let by_face: Vec<[usize; 2]> = faces
            .clone()
            .flat_map(|face| levels.clone().map(move |level| [level, face]))
            .collect();
        let by_level: Vec<[usize; 2]> = levels
            .flat_map(|level| faces.clone().map(move |face| [level, face]))
            .collect();
        let cut = |words, from: &[[usize; 2]], to: &[[usize; 2]]| {
            let mut texels = from
                .iter()
                .flat_map(|[level, face]| &self.levels[*level][*face].data);
            let mut levels = self.levels.clone();
            for [level, face] in to {
                levels[*level][*face]
                    .data
                    .iter_mut()
                    .zip(&mut texels)
                    .for_each(|(to, from)| *to = *from);
            }
            (words, Self { levels, ..*self })
        };
        vec![
            cut(
                "its data are level by level, as in KTX; a DDS file has all levels of a face \
                 before the next face",
                &by_face,
                &by_level,
            ),
            cut(
                "its data are face by face, as in DDS; a KTX file has all faces of a level before \
                 the next level",
                &by_level,
                &by_face,
            ),
        ]
    }
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
        let value = |name: &str| {
            keys.iter()
                .find(|(key, _)| key.strip_prefix(KEY) == Some(name))
                .map(|(_, v)| v.clone())
        };
        let alphas = || {
            value("alphas")?
                .split(',')
                .map(|alpha| alpha.parse().ok())
                .collect()
        };
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
