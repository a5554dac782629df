//! The perceptual roughness of each level of a prefiltered map. The twin of
//! `shaders/lib/prefilter_mapping.glsl`.
//!
//! Level k of n holds the roughness r with `m(r) = k / (n - 1)`, alpha = r², and a lookup reads
//! level `(n - 1) m(r)`. Every mapping is the parabola through 0 and 1 with bend b in [0, 1],
//!
//! `m(r) = r (1 + b (1 - r))`, with inverse `r = 2 u / (1 + b + sqrt((1 - b)² + 4 b (1 - u)))`:
//!
//! a larger bend gives smooth surfaces more levels.

use crate::base::names::listed;
use crate::instrument::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};

#[derive(Debug)]
pub struct LevelMapping {
    pub name: &'static str,
    pub about: &'static str,
    /// b, in [0, 1].
    pub bend: f64,
    /// Number of levels that the engine assumes for any cube.
    pub engine_levels: Option<u32>,
}

/// Every mapping; the first is the default.
pub static LEVEL_MAPPINGS: &[LevelMapping] = &[
    LevelMapping {
        name: "linear",
        about: "m(r) = r: Bevy, Cesium, the Khronos sampler and viewer",
        bend: 0.0,
        engine_levels: None,
    },
    LevelMapping {
        name: "quadratic",
        about: "m(r) = r (2 - r): Filament, its baker cmgen (levels down to 16 texels), three.js",
        bend: 1.0,
        engine_levels: None,
    },
    LevelMapping {
        name: "unity",
        about: "m(r) = r (1.7 - 0.7 r): Unity, with 7 levels",
        bend: 0.7,
        engine_levels: Some(7),
    },
];

listed!(LevelMapping, "level mapping", LEVEL_MAPPINGS);

impl PartialEq for LevelMapping {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl LevelMapping {
    /// Returns the microfacet width of level `mip`, which may be fractional. Inverse:
    /// [`Self::mip_from_alpha`].
    pub fn alpha_from_mip(&self, mip: f64, level_count: u32) -> f64 {
        let b = self.bend;
        let u = mip / last_mip(level_count);
        alpha_from_perceptual_roughness(
            2.0 * u / (1.0 + b + ((1.0 - b).powi(2) + 4.0 * b * (1.0 - u)).sqrt()),
        )
    }

    /// Returns the fractional level that a lookup for `alpha` reads.
    pub fn mip_from_alpha(&self, alpha: f64, level_count: u32) -> f64 {
        let r = perceptual_roughness_from_alpha(alpha);
        r * (1.0 + self.bend * (1.0 - r)) * last_mip(level_count)
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
#[derive(Clone, Debug, PartialEq)]
pub enum LevelSpacing {
    Mapped {
        mapping: &'static LevelMapping,
        level_count: u32,
    },
    /// The perceptual roughness of each level; a lookup between two levels is linear in it.
    Listed(Vec<f64>),
}

impl LevelSpacing {
    /// Takes at least 2 values of perceptual roughness that ascend from 0 to 1.
    pub fn listed(roughnesses: Vec<f64>) -> Result<Self, String> {
        let ascends = roughnesses.is_sorted_by(|smooth, rough| smooth < rough);
        let are_inside = roughnesses.iter().all(|r| (0.0..=1.0).contains(r));
        if roughnesses.len() < 2 || !ascends || !are_inside {
            return Err(format!(
                "level_mapping: {roughnesses:?}; expected the roughness of two or more levels, \
                 ascending, each from 0 to 1"
            ));
        }
        Ok(Self::Listed(roughnesses))
    }

    pub fn level_count(&self) -> u32 {
        match self {
            Self::Mapped { level_count, .. } => *level_count,
            Self::Listed(roughnesses) => roughnesses.len() as u32,
        }
    }

    /// Returns the microfacet width of a level, which may be fractional. Inverse:
    /// [`Self::level_from_alpha`].
    pub fn alpha_from_level(&self, level: f64) -> f64 {
        match self {
            Self::Mapped {
                mapping,
                level_count,
            } => mapping.alpha_from_mip(level, *level_count),
            Self::Listed(roughnesses) => {
                let fine = (level as usize).min(roughnesses.len() - 2);
                let step = roughnesses[fine + 1] - roughnesses[fine];
                alpha_from_perceptual_roughness(roughnesses[fine] + (level - fine as f64) * step)
            }
        }
    }

    /// Returns the fractional level that a lookup for `alpha` reads. Outside a list it is the first
    /// or the last.
    pub fn level_from_alpha(&self, alpha: f64) -> f64 {
        match self {
            Self::Mapped {
                mapping,
                level_count,
            } => mapping.mip_from_alpha(alpha, *level_count),
            Self::Listed(roughnesses) => {
                let r = perceptual_roughness_from_alpha(alpha);
                let rougher = roughnesses.partition_point(|level| *level <= r);
                let fine = rougher.clamp(1, roughnesses.len() - 1) - 1;
                let step = roughnesses[fine + 1] - roughnesses[fine];
                fine as f64 + ((r - roughnesses[fine]) / step).clamp(0.0, 1.0)
            }
        }
    }
}
