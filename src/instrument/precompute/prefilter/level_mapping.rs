//! The perceptual roughness of each level of a prefiltered map. The twin of
//! `shaders/lib/prefilter_mapping.glsl`.
//!
//! Level k of n holds the roughness r with `m(r) = k / (n - 1)`, alpha = r², and a lookup reads
//! level `(n - 1) m(r)`. A named mapping is the parabola through 0 and 1 with bend b in [0, 1],
//!
//! `m(r) = r (1 + b (1 - r))`, with inverse `r = 2 u / (1 + b + sqrt((1 - b)² + 4 b (1 - u)))`:
//!
//! a larger bend gives smooth surfaces more levels. A list of the roughness of each level is linear
//! between them, and constant outside.

use crate::base::glsl::constants::LEVELS_MAX;
use crate::base::names::{Listed, listed};
use crate::instrument::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use std::sync::Mutex;

#[derive(Debug)]
pub struct LevelMapping {
    /// A name, or the roughness of each level with colons between: `0:0.25:1`.
    pub name: &'static str,
    pub about: &'static str,
    pub rule: LevelRule,
    /// Number of levels that the engine assumes for any cube.
    pub engine_levels: Option<u32>,
}

/// How roughness becomes a level.
#[derive(Clone, Copy, Debug)]
pub enum LevelRule {
    /// b, in [0, 1].
    Bend(f64),
    /// The perceptual roughness of each level, ascending.
    Listed(&'static [f64]),
}

/// Every named mapping; the first is the default.
pub static LEVEL_MAPPINGS: &[LevelMapping] = &[
    LevelMapping {
        name: "linear",
        about: "m(r) = r: Bevy, Cesium, the Khronos sampler and viewer",
        rule: LevelRule::Bend(0.0),
        engine_levels: None,
    },
    LevelMapping {
        name: "quadratic",
        about: "m(r) = r (2 - r): Filament, its baker cmgen (levels down to 16 texels), three.js",
        rule: LevelRule::Bend(1.0),
        engine_levels: None,
    },
    LevelMapping {
        name: "unity",
        about: "m(r) = r (1.7 - 0.7 r): Unity, with 7 levels",
        rule: LevelRule::Bend(0.7),
        engine_levels: Some(7),
    },
];

listed!(LevelMapping, "level mapping", LEVEL_MAPPINGS);

/// The mappings of lists. A list is kept for the life of the process, so that settings can be
/// copied; there are as many as a user writes.
static LISTED: Mutex<Vec<&'static LevelMapping>> = Mutex::new(Vec::new());

impl PartialEq for LevelMapping {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl LevelMapping {
    /// Returns the mapping of a list: the perceptual roughness of each level, two or more values
    /// that ascend within 0 to 1.
    pub fn of_list(roughnesses: &[f64]) -> Result<&'static Self, String> {
        let ascends = roughnesses.is_sorted_by(|smooth, rough| smooth < rough);
        let are_inside = roughnesses.iter().all(|r| (0.0..=1.0).contains(r));
        if roughnesses.len() < 2 || !ascends || !are_inside {
            return Err(format!(
                "{roughnesses:?}; expected the roughness of two or more levels, ascending, each from 0 \
                 to 1"
            ));
        }
        let name = roughnesses.iter().map(f64::to_string).collect::<Vec<_>>();
        let name = name.join(":");
        let mut known = LISTED
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(mapping) = known.iter().find(|mapping| mapping.name == name) {
            return Ok(mapping);
        }
        let mapping: &'static Self = Box::leak(Box::new(Self {
            name: name.leak(),
            about: "the perceptual roughness of each level",
            rule: LevelRule::Listed(roughnesses.to_vec().leak()),
            engine_levels: None,
        }));
        known.push(mapping);
        Ok(mapping)
    }

    /// Returns the mapping of a [`Self::name`] that was checked before. Panics on other text.
    pub fn checked(name: &str) -> &'static Self {
        let list = || {
            let numbers = name.split(':').map(|number| number.parse().ok());
            Self::of_list(&numbers.collect::<Option<Vec<f64>>>()?).ok()
        };
        Self::by_name(name)
            .or_else(list)
            .unwrap_or_else(|| panic!("{name:?} is not a level mapping"))
    }

    /// Returns b of a named mapping, 0 of a list.
    pub fn bend(&self) -> f64 {
        match self.rule {
            LevelRule::Bend(bend) => bend,
            LevelRule::Listed(_) => 0.0,
        }
    }

    /// Returns the roughness of each level of a list; empty for a named mapping.
    pub fn listed_roughnesses(&self) -> &'static [f64] {
        match self.rule {
            LevelRule::Bend(_) => &[],
            LevelRule::Listed(roughnesses) => roughnesses,
        }
    }

    /// Returns the list for the device: zeros behind its end, or without a list.
    pub fn device_list(&self) -> [f32; LEVELS_MAX as usize] {
        let mut list = [0.0; LEVELS_MAX as usize];
        for (level, roughness) in list.iter_mut().zip(self.listed_roughnesses()) {
            *level = *roughness as f32;
        }
        list
    }

    /// Returns the microfacet width of level `mip`, which may be fractional. Inverse:
    /// [`Self::mip_from_alpha`].
    pub fn alpha_from_mip(&self, mip: f64, level_count: u32) -> f64 {
        let roughness = match self.rule {
            LevelRule::Bend(b) => {
                let u = mip / last_mip(level_count);
                2.0 * u / (1.0 + b + ((1.0 - b).powi(2) + 4.0 * b * (1.0 - u)).sqrt())
            }
            LevelRule::Listed(roughnesses) => {
                let fine = (mip as usize).min(roughnesses.len() - 2);
                let step = roughnesses[fine + 1] - roughnesses[fine];
                roughnesses[fine] + (mip - fine as f64) * step
            }
        };
        alpha_from_perceptual_roughness(roughness)
    }

    /// Returns the fractional level that a lookup for `alpha` reads. Outside a list it is the first
    /// or the last.
    pub fn mip_from_alpha(&self, alpha: f64, level_count: u32) -> f64 {
        let r = perceptual_roughness_from_alpha(alpha);
        match self.rule {
            LevelRule::Bend(b) => r * (1.0 + b * (1.0 - r)) * last_mip(level_count),
            LevelRule::Listed(roughnesses) => {
                let rougher = roughnesses.partition_point(|level| *level <= r);
                let fine = rougher.clamp(1, roughnesses.len() - 1) - 1;
                let step = roughnesses[fine + 1] - roughnesses[fine];
                fine as f64 + ((r - roughnesses[fine]) / step).clamp(0.0, 1.0)
            }
        }
    }

    /// Returns the narrowest width of a level that is not the mirror.
    pub fn narrowest_alpha(&self, level_count: u32) -> f64 {
        let first = self.alpha_from_mip(0.0, level_count);
        if first > 0.0 {
            first
        } else {
            self.alpha_from_mip(1.0, level_count)
        }
    }
}

/// Index of the last level. A chain of one level has no rough end.
fn last_mip(level_count: u32) -> f64 {
    assert!(
        level_count >= 2,
        "a prefiltered map needs at least 2 levels, not {level_count}"
    );
    f64::from(level_count - 1)
}

/// Perceptual roughness of the levels of one map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelSpacing {
    pub mapping: &'static LevelMapping,
    /// Of a list, its length.
    pub level_count: u32,
}

impl LevelSpacing {
    /// Takes the perceptual roughness of each level: [`LevelMapping::of_list`].
    pub fn listed(roughnesses: &[f64]) -> Result<Self, String> {
        let mapping = LevelMapping::of_list(roughnesses);
        Ok(Self {
            mapping: mapping.map_err(|fault| format!("level_mapping: {fault}"))?,
            level_count: roughnesses.len() as u32,
        })
    }

    /// Returns the microfacet width of a level, which may be fractional. Inverse:
    /// [`Self::level_from_alpha`].
    pub fn alpha_from_level(&self, level: f64) -> f64 {
        self.mapping.alpha_from_mip(level, self.level_count)
    }

    /// Returns the fractional level that a lookup for `alpha` reads.
    pub fn level_from_alpha(&self, alpha: f64) -> f64 {
        self.mapping.mip_from_alpha(alpha, self.level_count)
    }
}
