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

/// Finds the chain whose levels have the fitted widths; `None` if it is the assumed one, if no
/// known one fits, or if the widths are given.
pub fn slip(convention: &Convention, scores: &[LevelScore]) -> Option<Chain> {
    // A chain explains every level, or none.
    let is_unexplained =
        |score: &LevelScore| score.alpha >= fit::ALPHA_MIN && score.has(Cause::is_unknown);
    if convention.alphas.is_some() || scores.iter().any(is_unexplained) {
        return None;
    }
    let levels = Levels::new(convention, scores);
    let assumed = |level: usize| scores[level].alpha;
    if levels.have(assumed) {
        return None;
    }
    levels.mapping_slip().or_else(|| levels.law())
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
        Some(Chain {
            slip: ChainSlip::Mapping(MappingSlip {
                mapping: (!is_assumed).then_some(mapping),
                first_missing: first,
                last_missing: missing - first,
                level_count,
            }),
            alphas: (0..self.assumed.len())
                .map(|level| mapped(mapping, level_count, first + level))
                .collect(),
        })
    }

    /// Finds the first law of widths that the known levels follow.
    fn law(&self) -> Option<Chain> {
        if self.known.len() < 2 {
            return None;
        }
        let law = LAWS
            .into_iter()
            .find(|law| self.have(|level| self.alpha_by(*law, level)))?;
        let alphas: Vec<f64> = (0..self.assumed.len())
            .map(|level| self.alpha_by(law, level))
            .collect();
        Some(Chain {
            slip: ChainSlip::Law {
                law,
                alphas: alphas.clone(),
            },
            alphas,
        })
    }

    fn alpha_by(&self, law: WidthLaw, level: usize) -> f64 {
        let count = self.assumed.len();
        match law {
            WidthLaw::NextLevel => self.assumed[(level + 1).min(count - 1)],
            WidthLaw::LevelBefore => self.assumed[level.saturating_sub(1)],
            WidthLaw::SquaredTwice => self.assumed[level].powi(2),
            WidthLaw::NotSquared => self.assumed[level].sqrt(),
            WidthLaw::EveryLevel => {
                let mapping = self.convention.mapping;
                mapping.alpha_from_mip(level as f64, count as u32)
            }
        }
    }
}

/// Returns the width of a level in a chain of `level_count` levels.
fn mapped(mapping: &LevelMapping, level_count: usize, level: usize) -> f64 {
    let count = mapping.engine_levels.unwrap_or(level_count as u32);
    mapping.alpha_from_mip((level as u32).min(count - 1).into(), count)
}
