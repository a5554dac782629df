//! Finds a chain of other levels: some are missing, or their widths follow another mapping.

use super::level::LevelScore;
use super::{EXPLAINED, GOOD, has_width};
use crate::bakes::convention::Convention;
use crate::precompute::prefilter::{LEVEL_MAPPINGS, LevelMapping};

/// Largest ratio of a fitted width and a level's.
const SAME: f64 = 1.06;
/// Most levels that may be missing.
const MISSING_MAX: usize = 8;

/// A chain of other levels.
#[derive(Clone, Debug)]
pub struct Chain {
    pub words: String,
    pub alphas: Vec<f64>,
}

/// Finds the chain whose levels have the fitted widths; `None` if it is the assumed one, if no known one fits, or if the
/// widths are given.
pub fn slip(convention: &Convention, scores: &[LevelScore]) -> Option<Chain> {
    // A chain explains every level, or none.
    let is_unexplained = |score: &LevelScore| {
        let is_fitted = score.slip.is_some() || score.fit.is_some_and(|fit| fit.left <= EXPLAINED);
        has_width(score.alpha) && score.errors.relmse > GOOD && !is_fitted
    };
    if convention.alphas.is_some() || scores.iter().any(is_unexplained) {
        return None;
    }
    let width = |score: &LevelScore| match score.fit {
        Some(fit) if fit.left > EXPLAINED || score.slip.is_some() || fit.is_at_end(score.alpha) => None,
        Some(fit) => Some(fit.alpha),
        None => (has_width(score.alpha) && score.errors.relmse <= GOOD).then_some(score.alpha),
    };
    let found: Vec<(usize, f64)> =
        scores.iter().enumerate().filter_map(|(level, score)| Some((level, width(score)?))).collect();
    let is_same = |a: f64, b: f64| a.max(b) <= SAME * a.min(b);
    if found.iter().all(|(level, alpha)| is_same(scores[*level].alpha, *alpha)) {
        return None;
    }
    let fits = |mapping: &LevelMapping, count: usize, first: usize| {
        let alpha = |level: usize| mapping.alpha_from_mip((first + level) as f64, count as u32);
        found.iter().all(|(level, found)| is_same(alpha(*level), *found))
    };
    let count = scores.len();
    let others = LEVEL_MAPPINGS.iter().filter(|mapping| **mapping != *convention.mapping);
    let mappings: Vec<&LevelMapping> = std::iter::once(convention.mapping).chain(others).collect();
    (0..=MISSING_MAX).find_map(|missing| {
        mappings.iter().find_map(|mapping| {
            // One width fits many chains: only the simplest counts.
            let most = if found.len() > 1 { missing } else { 0 };
            let first = (0..=most).find(|first| fits(mapping, count + missing, *first))?;
            let of = format!("of {} levels", count + missing);
            let parts = [
                (**mapping != *convention.mapping).then(|| format!("widths of --level-mapping {}", mapping.name)),
                (first > 0).then(|| format!("the first {first} {of} missing")),
                (missing > first).then(|| format!("the last {} {of} missing", missing - first)),
            ];
            let parts: Vec<String> = parts.into_iter().flatten().collect();
            let is_sure = found.len() > 1 || **mapping == *convention.mapping;
            let alpha = |level: usize| mapping.alpha_from_mip((first + level) as f64, (count + missing) as u32);
            (!parts.is_empty() && is_sure)
                .then(|| Chain { words: parts.join("; "), alphas: (0..count).map(alpha).collect() })
        })
    })
}
