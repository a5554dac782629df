//! Finds a chain of other levels: some are missing, or their widths follow another mapping.

use super::fit;
use super::level::LevelScore;
use super::{GOOD, has_width};
use crate::bake::convention::Convention;
use crate::instrument::precompute::prefilter::{LEVEL_MAPPINGS, LevelMapping};

/// Largest ratio of a fitted width and a level's.
const SAME: f64 = 1.06;
const MISSING_MAX: usize = 8;

#[derive(Clone, Debug)]
pub struct Chain {
    pub words: String,
    pub alphas: Vec<f64>,
}

/// Finds the chain whose levels have the fitted widths; `None` if it is the assumed one, if no
/// known one fits, or if the widths are given.
pub fn slip(convention: &Convention, scores: &[LevelScore]) -> Option<Chain> {
    // A chain explains every level, or none.
    let is_unexplained =
        |score: &LevelScore| score.alpha >= fit::ALPHA_MIN && score.names("unknown");
    if convention.alphas.is_some() || scores.iter().any(is_unexplained) {
        return None;
    }
    let width = |score: &LevelScore| match score.fit {
        _ if score.names("mips") => None,
        Some(fit)
            if !fit.explains(score.errors.relmse)
                || score.slip.is_some()
                || fit.is_at_end(score.alpha) =>
        {
            None
        }
        Some(fit) => Some(fit.alpha),
        None => (has_width(score.alpha) && score.errors.relmse <= GOOD).then_some(score.alpha),
    };
    let found: Vec<(usize, f64)> = scores
        .iter()
        .enumerate()
        .filter_map(|(level, score)| Some((level, width(score)?)))
        .collect();
    let is_same = |a: f64, b: f64| a.max(b) <= SAME * a.min(b);
    if found
        .iter()
        .all(|(level, alpha)| is_same(scores[*level].alpha, *alpha))
    {
        return None;
    }
    let alpha = |mapping: &LevelMapping, count: usize, level: usize| {
        let count = mapping.engine_levels.unwrap_or(count as u32);
        mapping.alpha_from_mip((level as u32).min(count - 1).into(), count)
    };
    let fits = |mapping: &LevelMapping, count: usize, first: usize| {
        found
            .iter()
            .all(|(level, found)| is_same(alpha(mapping, count, first + level), *found))
    };
    let count = scores.len();
    let others = LEVEL_MAPPINGS
        .iter()
        .filter(|mapping| **mapping != *convention.mapping);
    let mappings: Vec<&LevelMapping> = std::iter::once(convention.mapping).chain(others).collect();
    let chain = (0..=MISSING_MAX).find_map(|missing| {
        mappings.iter().find_map(|mapping| {
            // One width fits many chains: only the simplest counts.
            let most = if found.len() > 1 { missing } else { 0 };
            let first = (0..=most).find(|first| fits(mapping, count + missing, *first))?;
            let of = |side: &str, gone: usize| match gone {
                1 => format!("the {side} of {} levels is missing", count + missing),
                _ => format!(
                    "the {side} {gone} of {} levels are missing",
                    count + missing
                ),
            };
            let parts = [
                (**mapping != *convention.mapping)
                    .then(|| format!("widths of --level-mapping {}", mapping.name)),
                (first > 0).then(|| of("first", first)),
                (missing > first).then(|| of("last", missing - first)),
            ];
            let parts: Vec<String> = parts.into_iter().flatten().collect();
            let is_sure = found.len() > 1 || **mapping == *convention.mapping;
            let alphas = (0..count)
                .map(|level| alpha(mapping, count + missing, first + level))
                .collect();
            (!parts.is_empty() && is_sure).then(|| Chain {
                words: parts.join("; "),
                alphas,
            })
        })
    });
    let own = |level: usize| scores[level].alpha;
    let spread = |level: usize| {
        convention
            .mapping
            .alpha_from_mip(level as f64, count as u32)
    };
    let others: [(&str, &dyn Fn(usize) -> f64); 5] = [
        ("each level has the width of the next one", &|level| {
            own((level + 1).min(count - 1))
        }),
        ("each level has the width of the one before it", &|level| {
            own(level.saturating_sub(1))
        }),
        ("roughness is squared twice", &|level| own(level).powi(2)),
        ("roughness is not squared", &|level| own(level).sqrt()),
        ("the mapping covers every level of the file", &spread),
    ];
    let is_like = |alpha: &dyn Fn(usize) -> f64| {
        found
            .iter()
            .all(|(level, found)| is_same(alpha(*level), *found))
    };
    let other = others
        .iter()
        .find(|(_, alpha)| found.len() > 1 && is_like(alpha));
    chain.or_else(|| {
        other.map(|(words, alpha)| {
            let alphas: Vec<f64> = (0..count).map(alpha).collect();
            let list: Vec<String> = alphas.iter().map(|alpha| format!("{alpha:.4}")).collect();
            Chain {
                words: format!("{words}: --alphas {}", list.join(",")),
                alphas,
            }
        })
    })
}
