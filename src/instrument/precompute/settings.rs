//! Sizes and sample counts of the precompute passes, and their valid combinations.

use super::dfg::DfgAxes;
use super::prefilter::{LEVEL_MAPPINGS, LevelMapping, WEIGHTS, Weight, harmonic};
use crate::base::names::listed;
use crate::instrument::environment::layout::{LAYOUTS, MapLayout};

/// Number format of the prefiltered map, the DFG table and the irradiance map on the device.
///
/// Passes always compute in f32. `F16` rounds their results once, to nearest, ties to even.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StorageFormat {
    #[default]
    F32,
    /// As engines ship: 11 bits of precision, at most [`crate::base::pixels::HALF_MAX`].
    F16,
}

listed!(StorageFormat, "storage format", { "f32": F32, "f16": F16 });

/// How the texels of the prefiltered map and of the irradiance map are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrefilterBy {
    /// By convolution in spherical harmonics on the host: no noise.
    #[default]
    Harmonic,
    /// By samples on the device, as engines do.
    Sampled,
}

listed!(PrefilterBy, "way to prefilter", { "harmonic": Harmonic, "sampled": Sampled });

/// Sizes and sample counts of all precompute passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrecomputeSettings {
    /// Texel layout of the filtered maps.
    pub layout: &'static MapLayout,
    /// Width and height of a face of level 0 of the prefiltered map.
    pub prefilter_size: [u32; 2],
    /// At least 2: the smoothest is the environment itself.
    pub prefilter_level_count: u32,
    pub prefilter: PrefilterBy,
    /// Samples per texel if `prefilter` is sampled.
    pub prefilter_sample_count: u32,
    pub level_mapping: &'static LevelMapping,
    /// Weight of a direction in a prefiltered texel.
    pub prefilter_weight: &'static Weight,
    /// Added to the level of each lookup that the pass makes.
    pub prefilter_lod_bias: f32,
    pub dfg_size: u32,
    /// Quadrature nodes per texel.
    pub dfg_sample_count: u32,
    /// Positions of its texels.
    pub dfg_axes: DfgAxes,
    pub irradiance_size: [u32; 2],
    /// Azimuth and polar samples of the numerical irradiance integration.
    pub irradiance_sample_count: [u32; 2],
    pub storage: StorageFormat,
}

impl PrecomputeSettings {
    /// Counts the samples of a whole table; `None` if it takes none.
    pub fn samples_of(&self, table: &str) -> Option<f64> {
        let product = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
        let texels = |size| product(size) * f64::from(self.layout.face_count);
        match table {
            "prefilter" | "irradiance" if self.prefilter == PrefilterBy::Harmonic => None,
            "prefilter" => {
                // Each level has a quarter of the texels of the one before.
                let levels = (0..self.prefilter_level_count)
                    .map(|level| 0.25_f64.powi(level as i32))
                    .sum::<f64>();
                Some(texels(self.prefilter_size) * levels * f64::from(self.prefilter_sample_count))
            }
            "dfg" => Some(f64::from(self.dfg_size).powi(2) * f64::from(self.dfg_sample_count)),
            "irradiance" => {
                Some(texels(self.irradiance_size) * product(self.irradiance_sample_count))
            }
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

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} is {what}")]
pub struct SettingsError {
    pub field: &'static str,
    what: String,
}

impl PrecomputeSettings {
    /// Checks that nothing is 0 and that the prefiltered map has two levels or more, none too small
    /// for the layout.
    pub fn validate(&self) -> Result<(), SettingsError> {
        self.check_counts()?;
        self.check_faces()?;
        self.check_levels()?;
        self.check_list()?;
        self.check_harmonic_degree()
    }

    fn check_counts(&self) -> Result<(), SettingsError> {
        let shorter = |[a, b]: [u32; 2]| a.min(b);
        for (field, count) in [
            ("prefilter_sample_count", self.prefilter_sample_count),
            ("dfg_sample_count", self.dfg_sample_count),
            ("dfg_size", self.dfg_size),
            ("irradiance_size", shorter(self.irradiance_size)),
            (
                "irradiance_sample_count",
                shorter(self.irradiance_sample_count),
            ),
        ] {
            if count == 0 {
                return fault(field, "0; expected at least 1".to_owned());
            }
        }
        if self.dfg_size == 1 {
            return fault(
                "dfg_size",
                "1; expected at least 2, as both ends of its axes are texels".to_owned(),
            );
        }
        Ok(())
    }

    fn check_faces(&self) -> Result<(), SettingsError> {
        for (field, [width, height]) in [
            ("prefilter_size", self.prefilter_size),
            ("irradiance_size", self.irradiance_size),
        ] {
            if self.layout.is_square && width != height {
                let layout = self.layout.name;
                return fault(
                    field,
                    format!(
                        "{width}x{height}; the faces of layout {layout} are square: \
                         {height}x{height}"
                    ),
                );
            }
        }
        Ok(())
    }

    fn check_levels(&self) -> Result<(), SettingsError> {
        let levels = self.prefilter_level_count;
        let [width, height] = self.prefilter_size;
        let least = self.layout.side_min;
        let halved = |times: u32| width.min(height).checked_shr(times).unwrap_or(0);
        if levels < 2 {
            return fault(
                "prefilter_level_count",
                format!("{levels}; expected at least 2, a smooth and a rough one"),
            );
        }
        if halved(1) < least {
            let short = 2 * least;
            return fault(
                "prefilter_size",
                format!(
                    "{width}x{height}; expected at least {short} texels on the short side: two \
                     levels, the last of {least}"
                ),
            );
        }
        let last = halved(levels - 1);
        if last < least {
            let most = (2..levels)
                .take_while(|count| halved(count - 1) >= least)
                .last()
                .unwrap_or(2);
            return fault(
                "prefilter_level_count",
                format!(
                    "{levels}, but a prefilter_size of {width}x{height} halves to {last} texels on \
                     its short side in the last level; \
                     expected at least {least} there: at most {most} levels"
                ),
            );
        }
        Ok(())
    }

    /// Checks that a list of levels is one of all levels.
    fn check_list(&self) -> Result<(), SettingsError> {
        let levels = self.prefilter_level_count;
        let listed = self.level_mapping.listed_roughnesses().len();
        if listed != 0 && listed != levels as usize {
            return fault(
                "prefilter_level_count",
                format!("{levels}, but level_mapping lists {listed} levels; expected {listed}"),
            );
        }
        Ok(())
    }

    /// Checks that harmonics can make the narrowest filtered level.
    fn check_harmonic_degree(&self) -> Result<(), SettingsError> {
        let levels = self.prefilter_level_count;
        let mapping = self.level_mapping;
        if self.prefilter == PrefilterBy::Harmonic
            && mapping.narrowest_alpha(levels) < harmonic::ALPHA_MIN
        {
            let name = mapping.name;
            let level = u32::from(mapping.alpha_from_mip(0.0, levels) == 0.0);
            let alpha = harmonic::ALPHA_MIN;
            let degree = harmonic::DEGREE_MAX;
            let is_listed = !mapping.listed_roughnesses().is_empty();
            let wider = if is_listed { "wider" } else { "fewer" };
            return fault(
                "prefilter_level_count",
                format!(
                    "{levels}, but level {level} by level_mapping {name} is narrower than alpha \
                     {alpha:.4}, which takes degree {degree}; \
                     expected {wider} levels, or prefilter = sampled"
                ),
            );
        }
        Ok(())
    }
}

fn fault(field: &'static str, what: String) -> Result<(), SettingsError> {
    Err(SettingsError { field, what })
}
