//! Sizes and sample counts of the precompute passes, and which of them go together.

use super::dfg::DfgAxes;
use super::prefilter::{LEVEL_MAPPINGS, LevelMapping, WEIGHTS, Weight, harmonic};
use crate::environment::layout::{LAYOUTS, MapLayout};
use crate::spelling::listed;

/// In which numbers the prefiltered map, the DFG table and the irradiance map are kept on the device.
///
/// Passes always compute in f32; `F16` rounds their results once, to the nearest half, ties to even.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StorageFormat {
    #[default]
    F32,
    /// What engines ship: 11 bits of precision, nothing above [`HALF_MAX`].
    F16,
}

listed!(StorageFormat, "storage format", { "f32": F32, "f16": F16 });

/// How the texels of the prefiltered map and of the irradiance map are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrefilterBy {
    /// By convolution in spherical harmonics on the host: without noise.
    #[default]
    Harmonic,
    /// By samples on the device, as engines do.
    Sampled,
}

listed!(PrefilterBy, "way to prefilter", { "harmonic": Harmonic, "sampled": Sampled });

/// The largest half. Brighter texels (a sun) are cut off here, as engines do: an infinite one would spoil every texel filtered with it.
pub const HALF_MAX: f32 = 65504.0;

/// Sizes and sample counts of every precompute pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrecomputeSettings {
    /// How the maps that are looked up filtered lie in texels.
    pub layout: &'static MapLayout,
    /// Width and height of a face of level 0 of the prefiltered map.
    pub prefilter_size: [u32; 2],
    /// At least 2: the smoothest is the environment itself.
    pub prefilter_level_count: u32,
    pub prefilter: PrefilterBy,
    /// Samples a texel, if `prefilter` is sampled.
    pub prefilter_sample_count: u32,
    /// Which perceptual roughness each level holds.
    pub level_mapping: &'static LevelMapping,
    /// What a direction counts in the mean that a texel is.
    pub prefilter_weight: &'static Weight,
    /// Levels added to the level of each lookup that the pass makes.
    pub prefilter_lod_bias: f32,
    /// Side of the DFG table.
    pub dfg_size: u32,
    /// Quadrature nodes a texel.
    pub dfg_sample_count: u32,
    /// Where its texels lie.
    pub dfg_axes: DfgAxes,
    /// Width and height of a face of the irradiance map.
    pub irradiance_size: [u32; 2],
    /// Azimuth and polar samples of the numerical irradiance integration.
    pub irradiance_sample_count: [u32; 2],
    pub storage: StorageFormat,
}

impl PrecomputeSettings {
    /// Samples that are drawn for a table in all; `None` for a table that takes none.
    pub fn samples_of(&self, table: &str) -> Option<f64> {
        let product = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
        let texels = |size| product(size) * f64::from(self.layout.face_count);
        match table {
            "prefilter" | "irradiance" if self.prefilter == PrefilterBy::Harmonic => None,
            "prefilter" => {
                // Each level has a quarter of the texels of the one before.
                let levels = (0..self.prefilter_level_count).map(|level| 0.25_f64.powi(level as i32)).sum::<f64>();
                Some(texels(self.prefilter_size) * levels * f64::from(self.prefilter_sample_count))
            }
            "dfg" => Some(f64::from(self.dfg_size).powi(2) * f64::from(self.dfg_sample_count)),
            "irradiance" => Some(texels(self.irradiance_size) * product(self.irradiance_sample_count)),
            _ => None,
        }
    }
}

impl Default for PrecomputeSettings {
    fn default() -> Self {
        Self {
            layout: &LAYOUTS[0],
            prefilter_size: LAYOUTS[0].prefilter_size,
            prefilter_level_count: 5,
            prefilter: PrefilterBy::default(),
            prefilter_sample_count: 256,
            level_mapping: &LEVEL_MAPPINGS[0],
            prefilter_weight: &WEIGHTS[0],
            prefilter_lod_bias: 0.0,
            dfg_size: 128,
            dfg_sample_count: 768,
            dfg_axes: DfgAxes::default(),
            irradiance_size: LAYOUTS[0].irradiance_size,
            irradiance_sample_count: [128, 32],
            storage: StorageFormat::default(),
        }
    }
}

/// Settings that no pass can work with.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    #[error("{field} is 0; expected at least 1")]
    Zero { field: &'static str },
    #[error("dfg_size is 1; expected at least 2, as both ends of its axes are texels")]
    SmallTable,
    #[error("prefilter_level_count is {0}; expected at least 2, a smooth and a rough one")]
    TooFewLevels(u32),
    #[error(
        "prefilter_level_count is {levels}, but a prefilter_size of {}x{} halves to {last} texels on its short side in the last level; \
         expected at least {least} there: at most {most} levels",
        size[0], size[1]
    )]
    TooManyLevels { levels: u32, size: [u32; 2], last: u32, least: u32, most: u32 },
    #[error(
        "prefilter is harmonic, but level 1 of {levels} by level_mapping {mapping} is narrower than alpha {:.4}, which takes degree {}; expected \
         fewer levels, or prefilter = sampled",
        harmonic::ALPHA_MIN,
        harmonic::DEGREE_MAX
    )]
    NarrowLevel { levels: u32, mapping: &'static str },
    #[error("{field} is {}x{}; the faces of layout {layout} are square: {}x{}", size[0], size[1], size[1], size[1])]
    NotSquare { field: &'static str, layout: &'static str, size: [u32; 2] },
    #[error("prefilter_size is {}x{}; expected at least {} texels on the short side: two levels, the last of {least}", size[0], size[1], 2 * least)]
    SmallMap { size: [u32; 2], least: u32 },
}

impl SettingsError {
    /// The setting to change.
    pub fn field(&self) -> &'static str {
        match self {
            Self::Zero { field } | Self::NotSquare { field, .. } => field,
            Self::SmallTable => "dfg_size",
            Self::TooFewLevels(_) | Self::TooManyLevels { .. } | Self::NarrowLevel { .. } => "prefilter_level_count",
            Self::SmallMap { .. } => "prefilter_size",
        }
    }
}

impl PrecomputeSettings {
    /// Checks what the passes rely on: nothing is 0, and the prefiltered map has at least two levels, none too short for the layout.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let smaller = |pair: [u32; 2]| pair[0].min(pair[1]);
        for (field, count) in [
            ("prefilter_sample_count", self.prefilter_sample_count),
            ("dfg_sample_count", self.dfg_sample_count),
            ("dfg_size", self.dfg_size),
            ("irradiance_size", smaller(self.irradiance_size)),
            ("irradiance_sample_count", smaller(self.irradiance_sample_count)),
        ] {
            if count == 0 {
                return Err(SettingsError::Zero { field });
            }
        }
        if self.dfg_size == 1 {
            return Err(SettingsError::SmallTable);
        }
        for (field, size) in [("prefilter_size", self.prefilter_size), ("irradiance_size", self.irradiance_size)] {
            if self.layout.is_square && size[0] != size[1] {
                return Err(SettingsError::NotSquare { field, layout: self.layout.name, size });
            }
        }
        let (levels, size) = (self.prefilter_level_count, self.prefilter_size);
        let least = self.layout.side_min;
        let halved = |times: u32| smaller(size).checked_shr(times).unwrap_or(0);
        if levels < 2 {
            return Err(SettingsError::TooFewLevels(levels));
        }
        if halved(1) < least {
            return Err(SettingsError::SmallMap { size, least });
        }
        if halved(levels - 1) < least {
            let most = (2..levels).take_while(|count| halved(count - 1) >= least).last().unwrap_or(2);
            return Err(SettingsError::TooManyLevels { levels, size, last: halved(levels - 1), least, most });
        }
        let is_narrow = self.level_mapping.alpha_from_mip(1.0, levels) < harmonic::ALPHA_MIN;
        match self.prefilter == PrefilterBy::Harmonic && is_narrow {
            true => Err(SettingsError::NarrowLevel { levels, mapping: self.level_mapping.name }),
            false => Ok(()),
        }
    }
}
