//! The parts of a bake as stored, neither rotated nor scaled.

use super::sh::Coefficients;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::layout::MapLayout;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A map of radiance or irradiance.
#[derive(Clone, Debug)]
pub struct Map {
    pub layout: &'static MapLayout,
    /// Smoothest level first, each with the layout's faces.
    pub levels: Vec<Vec<RgbImage>>,
}

/// How a file orders the texels of a cube with several levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelOrder {
    /// All faces of a level, then the next level: KTX.
    ByLevel,
    /// All levels of a face, then the next face: DDS.
    ByFace,
}

impl TexelOrder {
    pub const ALL: [Self; 2] = [Self::ByLevel, Self::ByFace];
}

/// A face of a level.
#[derive(Clone, Copy)]
struct Image {
    level: usize,
    face: usize,
}

impl Map {
    /// Cuts the texels of the file again as if they were in this order, and were read in the other.
    pub fn reordered(&self, order: TexelOrder) -> Self {
        let (from, to) = match order {
            TexelOrder::ByLevel => (self.images_by_face(), self.images_by_level()),
            TexelOrder::ByFace => (self.images_by_level(), self.images_by_face()),
        };
        let mut texels = from
            .iter()
            .flat_map(|image| &self.levels[image.level][image.face].data);
        let mut levels = self.levels.clone();
        for Image { level, face } in to {
            for (to, from) in levels[level][face].data.iter_mut().zip(&mut texels) {
                *to = *from;
            }
        }
        Self { levels, ..*self }
    }

    fn images_by_level(&self) -> Vec<Image> {
        let faces = 0..self.levels[0].len();
        (0..self.levels.len())
            .flat_map(|level| faces.clone().map(move |face| Image { level, face }))
            .collect()
    }

    fn images_by_face(&self) -> Vec<Image> {
        let levels = 0..self.levels.len();
        (0..self.levels[0].len())
            .flat_map(|face| levels.clone().map(move |level| Image { level, face }))
            .collect()
    }
}

/// The parts of a bake.
#[derive(Clone, Debug, Default)]
pub struct Bake {
    /// Prefiltered radiance.
    pub specular: Option<Map>,
    /// Irradiance, in one level.
    pub irradiance: Option<Map>,
    pub dfg: Option<RgbImage>,
    pub sh: Option<Coefficients>,
    /// Whether the maps are RGBP whose scale was rounded up ([`super::rgbp`]).
    pub has_rounded_up_scale: bool,
    pub stated: Stated,
    /// What reading changed or ignored.
    pub warnings: Vec<FileWarning>,
}

/// A warning of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileWarning {
    pub path: PathBuf,
    /// One sentence.
    pub text: String,
}

impl Bake {
    /// Adds the warnings of a file.
    pub(super) fn warn(&mut self, path: &Path, warnings: Vec<String>) {
        self.warnings
            .extend(warnings.into_iter().map(|text| FileWarning {
                path: path.to_owned(),
                text,
            }));
    }
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
    /// States the conventions of an engine's own file, unless something stated others before.
    pub(super) fn state(&mut self, preset: &str, alphas: Option<Vec<f64>>) {
        self.preset.get_or_insert_with(|| preset.to_owned());
        self.alphas = self.alphas.take().or(alphas);
    }

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
    /// The sharp map alone, for the background.
    #[serde(default)]
    pub skybox: Option<String>,
    pub irradiance: Option<String>,
    /// Files of one table in several formats.
    pub tables: Vec<String>,
    pub sh: Option<String>,
    /// The table of two taps (docs/paste.md).
    pub taps: Option<String>,
}
