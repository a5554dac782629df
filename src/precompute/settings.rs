//! Sizes and sample counts of the precompute passes, and which of them go together.

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

impl StorageFormat {
    /// Every format with its name.
    pub const ALL: &[(&str, Self)] = &[(Self::F32.name(), Self::F32), (Self::F16.name(), Self::F16)];

    /// Name in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F16 => "f16",
        }
    }
}

/// The largest half. Brighter texels (a sun) are cut off here, as engines do: an infinite one would spoil every texel filtered with it.
pub const HALF_MAX: f32 = 65504.0;

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
    pub storage: StorageFormat,
}

impl PrecomputeSettings {
    /// Samples that are drawn for a table in all; `None` for a table that takes none.
    pub fn samples_of(&self, table: &str) -> Option<f64> {
        let texels = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
        match table {
            "prefilter" => {
                // Each level has a quarter of the texels of the one before.
                let levels = (0..self.prefilter_level_count).map(|level| 0.25_f64.powi(level as i32)).sum::<f64>();
                Some(texels(self.prefilter_size) * levels * f64::from(self.prefilter_sample_count))
            }
            "dfg" => Some(f64::from(self.dfg_size).powi(2) * f64::from(self.dfg_sample_count)),
            "irradiance" => Some(texels(self.irradiance_size) * texels(self.irradiance_sample_count)),
            _ => None,
        }
    }
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
            storage: StorageFormat::default(),
        }
    }
}

/// The smallest side a prefiltered level may have: fewer texels cannot hold even the roughest lobe.
const PREFILTER_SIDE_MIN: u32 = 8;

/// Settings that no pass can work with.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    #[error("{field} is 0; expected at least 1")]
    Zero { field: &'static str },
    #[error("prefilter_level_count is {0}; expected at least 2, a smooth and a rough one")]
    TooFewLevels(u32),
    #[error(
        "prefilter_level_count is {levels}, but a prefilter_size of {}x{} halves to {last} texels on its short side in the last level; \
         expected at least {PREFILTER_SIDE_MIN} there: at most {most} levels",
        size[0], size[1]
    )]
    TooManyLevels { levels: u32, size: [u32; 2], last: u32, most: u32 },
    #[error("prefilter_size is {}x{}; expected at least {} texels on the short side, for two levels", size[0], size[1], 2 * PREFILTER_SIDE_MIN)]
    SmallMap { size: [u32; 2] },
}

impl SettingsError {
    /// The setting to change.
    pub fn field(&self) -> &'static str {
        match self {
            Self::Zero { field } => field,
            Self::TooFewLevels(_) | Self::TooManyLevels { .. } => "prefilter_level_count",
            Self::SmallMap { .. } => "prefilter_size",
        }
    }
}

impl PrecomputeSettings {
    /// Checks what the passes rely on: nothing is 0, and the prefiltered map has at least two levels, none shorter than 8 texels.
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
        let (levels, size) = (self.prefilter_level_count, self.prefilter_size);
        let halved = |times: u32| smaller(size).checked_shr(times).unwrap_or(0);
        if levels < 2 {
            return Err(SettingsError::TooFewLevels(levels));
        }
        if halved(1) < PREFILTER_SIDE_MIN {
            return Err(SettingsError::SmallMap { size });
        }
        if halved(levels - 1) < PREFILTER_SIDE_MIN {
            let most = (2..levels).take_while(|count| halved(count - 1) >= PREFILTER_SIDE_MIN).last().unwrap_or(2);
            return Err(SettingsError::TooManyLevels { levels, size, last: halved(levels - 1), most });
        }
        Ok(())
    }
}
