//! Finds a chain of other levels: some are missing, or their widths follow another mapping.

use super::cause::{ChainSlip, MappingSlip, WidthLaw};
use super::fit;
use super::level::LevelScore;
use super::{Cause, GOOD, has_width};
use crate::bake::convention::Convention;
use crate::instrument::precompute::prefilter::{LEVEL_MAPPINGS, LevelMapping};

/// Largest ratio of a fitted width and a level's.
const SAME: f64 = 1.06;
const MISSING_MAX: usize = 8;
/// Fewest known levels whose widths prove a factor.
const KNOWN_MIN: usize = 3;
/// The mapping k/(n - 1).
const LINEAR: &str = "linear";

const LAWS: [WidthLaw; 5] = [
    WidthLaw::NextLevel,
    WidthLaw::LevelBefore,
    WidthLaw::SquaredTwice,
    WidthLaw::NotSquared,
    WidthLaw::EveryLevel,
];

/// A chain that the widths of all levels have.
#[derive(Clone, Debug)]
pub struct Chain {
    pub slip: ChainSlip,
    pub alphas: Vec<f64>,
}

impl Chain {
    pub fn of_law(law: WidthLaw, alphas: Vec<f64>) -> Self {
        Self {
            slip: ChainSlip::Law {
                law,
                alphas: alphas.clone(),
            },
            alphas,
        }
    }
}

/// Finds the chain whose levels have the fitted widths; `None` if it is the assumed one, if no
/// known one fits, or if the widths are given.
pub fn slip(convention: &Convention, scores: &[LevelScore]) -> Option<Chain> {
    // A chain explains every level, or none.
    let is_unexplained =
        |score: &LevelScore| score.alpha >= fit::ALPHA_MIN && score.has(Cause::is_unknown);
    if !convention.has_mapping() || scores.iter().any(is_unexplained) {
        return None;
    }
    let levels = Levels::new(convention, scores);
    let assumed = |level: usize| scores[level].alpha;
    if levels.have(assumed) {
        return None;
    }
    levels.mapping_slip().or_else(|| levels.law())
}

/// Whether the engine reads level k at roughness k/(n - 1).
pub fn is_linear(convention: &Convention) -> bool {
    convention.has_mapping() && convention.mapping.name == LINEAR
}

/// A level whose width is known.
struct KnownWidth {
    level: usize,
    alpha: f64,
}

impl KnownWidth {
    /// Returns the width of a good level, or of one that another width explains.
    fn new(level: usize, score: &LevelScore) -> Option<Self> {
        if score.has(Cause::is_mips) {
            return None;
        }
        let alpha = match score.fit {
            Some(fit) => {
                let is_known = fit.explains(score.errors.relmse)
                    && score.slip.is_none()
                    && !fit.is_at_end(score.alpha);
                is_known.then_some(fit.alpha)?
            }
            None => {
                let is_known = has_width(score.alpha) && score.errors.relmse <= GOOD;
                is_known.then_some(score.alpha)?
            }
        };
        Some(Self { level, alpha })
    }
}

/// The levels of a map: their assumed widths, and the widths that are known.
struct Levels<'a> {
    convention: &'a Convention,
    assumed: Vec<f64>,
    known: Vec<KnownWidth>,
}

impl<'a> Levels<'a> {
    fn new(convention: &'a Convention, scores: &[LevelScore]) -> Self {
        Self {
            convention,
            assumed: scores.iter().map(|score| score.alpha).collect(),
            known: scores
                .iter()
                .enumerate()
                .filter_map(|(level, score)| KnownWidth::new(level, score))
                .collect(),
        }
    }

    /// Whether the known levels have these widths.
    fn have(&self, alpha: impl Fn(usize) -> f64) -> bool {
        self.known.iter().all(|known| {
            let alpha = alpha(known.level);
            alpha.max(known.alpha) <= SAME * alpha.min(known.alpha)
        })
    }

    /// Lists the assumed mapping, then the others.
    fn mappings(&self) -> impl Iterator<Item = &'static LevelMapping> {
        let assumed = self.convention.mapping;
        let others = LEVEL_MAPPINGS
            .iter()
            .filter(move |mapping| **mapping != *assumed);
        std::iter::once(assumed).chain(others)
    }

    /// Finds the fewest missing levels under which a mapping gives the known widths.
    fn mapping_slip(&self) -> Option<Chain> {
        (0..=MISSING_MAX).find_map(|missing| {
            self.mappings()
                .find_map(|mapping| self.chain_of(mapping, missing))
        })
    }

    fn chain_of(&self, mapping: &'static LevelMapping, missing: usize) -> Option<Chain> {
        // One width fits many chains: only the simplest counts.
        let has_several = self.known.len() > 1;
        let is_assumed = *mapping == *self.convention.mapping;
        if !has_several && !is_assumed {
            return None;
        }
        let first_max = if has_several { missing } else { 0 };
        let level_count = self.assumed.len() + missing;
        let first = (0..=first_max)
            .find(|first| self.have(|level| mapped(mapping, level_count, first + level)))?;
        if is_assumed && missing == 0 {
            return None;
        }
        let alphas: Vec<f64> = (0..self.assumed.len())
            .map(|level| mapped(mapping, level_count, first + level))
            .collect();
        // The widths of a chain without its last level, but a slip that is far more usual.
        if mapping.name == LINEAR && missing == 1 && first == 0 {
            return Some(Chain::of_law(WidthLaw::OverCount, alphas));
        }
        Some(Chain {
            slip: ChainSlip::Mapping(MappingSlip {
                mapping: (!is_assumed).then_some(mapping),
                first_missing: first,
                last_missing: missing - first,
                level_count,
            }),
            alphas,
        })
    }

    /// Finds the first law of widths that the known levels follow.
    fn law(&self) -> Option<Chain> {
        if self.known.len() < 2 {
            return None;
        }
        LAWS.into_iter()
            .chain(is_linear(self.convention).then_some(WidthLaw::OverHalfCount))
            .chain(self.roughness_times())
            .map(|law| Chain::of_law(law, alphas_by(law, self.convention, &self.assumed)))
            .find(|chain| self.have(|level| chain.alphas[level]))
    }

    /// Returns the factor on roughness of the middle known level.
    fn roughness_times(&self) -> Option<WidthLaw> {
        if self.known.len() < KNOWN_MIN {
            return None;
        }
        let mut factors: Vec<f64> = self
            .known
            .iter()
            .map(|known| (known.alpha / self.assumed[known.level]).sqrt())
            .collect();
        factors.sort_by(f64::total_cmp);
        Some(WidthLaw::RoughnessTimes(factors[factors.len() / 2]))
    }
}

/// Returns the width of each level by a law, from the assumed widths.
pub fn alphas_by(law: WidthLaw, convention: &Convention, assumed: &[f64]) -> Vec<f64> {
    let count = assumed.len();
    let linear = |level: usize, last: f64| (level as f64 / last).powi(2);
    let alpha = |level: usize| match law {
        WidthLaw::NextLevel => assumed[(level + 1).min(count - 1)],
        WidthLaw::LevelBefore => assumed[level.saturating_sub(1)],
        WidthLaw::SquaredTwice => assumed[level].powi(2),
        WidthLaw::NotSquared => assumed[level].sqrt(),
        WidthLaw::OverCount => linear(level, count as f64),
        WidthLaw::OverHalfCount => linear(level, count as f64 - 0.5),
        WidthLaw::RoughnessTimes(factor) => assumed[level] * factor * factor,
        WidthLaw::EveryLevel => {
            let mapping = convention.mapping;
            mapping.alpha_from_mip(level as f64, count as u32)
        }
    };
    (0..count).map(alpha).collect()
}

/// Returns the width of a level in a chain of `level_count` levels.
fn mapped(mapping: &LevelMapping, level_count: usize, level: usize) -> f64 {
    let count = mapping.engine_levels.unwrap_or(level_count as u32);
    mapping.alpha_from_mip((level as u32).min(count - 1).into(), count)
}
