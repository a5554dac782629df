//! Finds a chain of other widths in which something else is wrong as well, such as mips that are too
//! coarse: neither slip explains its levels alone.

use super::cause::{Cause, WidthLaw};
use super::chain::{Chain, alphas_by, is_linear};
use super::coarse_mips::{CoarseSearch, MipMeans};
use super::directions::{Directions, texels};
use super::level::LevelScore;
use super::mip_chain::{MipChain, MipSource};
use super::sampled_lobe::SampledLobe;
use super::{EXPLAINED, GOOD, Truth, errors, fit, has_width};
use crate::bake::convention::Convention;
use crate::bake::parts::Map;
use glam::DVec3;
use std::cell::LazyCell;

/// Laws of roughness that real bakers have beside other slips.
const LAWS: [WidthLaw; 2] = [WidthLaw::OverCount, WidthLaw::OverHalfCount];
/// Approximate number of texels that are compared.
const TEXELS: usize = 600;
/// Approximate number of them on which mips of maps are tried.
const MIP_TEXELS: usize = 120;
/// The laws make no level narrower by a smaller factor: a middle one of three.
const NARROWER: f64 = 0.4;
/// Fewest levels with a width that prove a law.
const LEVELS_MIN: usize = 2;
/// Largest relMSE that the law may leave in a level: 10 % rms.
const CLOSE: f64 = 0.01;
/// Gains beside a law: values are cut or rounded down.
const GAIN: std::ops::RangeInclusive<f64> = 0.9..=1.1;

/// Finds the law under which every level is nearly right, or its mips are too coarse; `None` unless
/// the engine's widths are linear and leave far more, and the causes of each level alone as much.
pub fn slip(
    truth: &Truth,
    map: &Map,
    convention: &Convention,
    scores: &[LevelScore],
) -> Option<Chain> {
    let wrong_count = scores.iter().filter(|score| may_be_blurred(score)).count();
    if !is_linear(convention) || truth.is_other || wrong_count < LEVELS_MIN {
        return None;
    }
    let mips = [MipSource::Cube, MipSource::LatLong]
        .map(|source| LazyCell::new(move || MipChain::new(truth.environment, source)));
    let mips = || mips.iter().map(|mips| &**mips);
    let levels: Vec<WideLevel> = scores
        .iter()
        .enumerate()
        .filter(|(_, score)| has_width(score.alpha))
        .map(|(level, score)| WideLevel::new(truth, map, convention, level, score))
        .collect();
    let alone: f64 = levels.iter().map(|level| level.left_alone).sum();
    let assumed: Vec<f64> = scores.iter().map(|score| score.alpha).collect();
    let by_assumed: f64 = levels
        .iter()
        .map(|level| level.left(truth, mips(), &assumed))
        .sum();
    let most = alone.min(EXPLAINED * by_assumed);
    let candidate = |law: WidthLaw| {
        let alphas = alphas_by(law, convention, &assumed);
        let mut left = 0.0;
        for level in &levels {
            let of_level = level.left(truth, mips(), &alphas);
            left += level.allows(of_level).then_some(of_level)?;
        }
        (left <= most).then(|| (left, Chain::of_law(law, alphas)))
    };
    LAWS.into_iter()
        .filter_map(candidate)
        .min_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, chain)| chain)
}

/// Whether a level has no cause, or one that another width beside coarse mips may imitate.
fn may_be_blurred(score: &LevelScore) -> bool {
    score.has(|cause| {
        cause.is_unknown()
            || matches!(
                cause,
                Cause::Width(_) | Cause::CoarseMips { .. } | Cause::SlightlyOff | Cause::Noise
            )
    })
}

/// Compared texels of a level.
struct Compared {
    directions: Directions,
    found: Vec<DVec3>,
}

/// A level that is wider than a mirror.
struct WideLevel {
    index: usize,
    all: Compared,
    /// Those on which mips of maps are tried.
    few: Compared,
    lobe: SampledLobe,
    search: CoarseSearch,
    /// Radiance of a texel of 1.
    scale: f64,
    is_good: bool,
    /// relMSE that the level's own causes leave.
    left_alone: f64,
}

impl WideLevel {
    fn new(
        truth: &Truth,
        map: &Map,
        convention: &Convention,
        index: usize,
        score: &LevelScore,
    ) -> Self {
        let faces = &map.levels[index];
        let size = [faces[0].width, faces[0].height];
        let directions = Directions::new(map.layout, convention.axes, size);
        let chosen = directions.grid(TEXELS);
        let all = Compared {
            directions: directions.only(&chosen),
            found: fit::picked(&texels(faces, convention.scale), &chosen),
        };
        let lobe = SampledLobe {
            kernel: truth.kernel,
            is_irradiance: false,
        };
        Self {
            index,
            search: CoarseSearch::new(truth, lobe, NARROWER * score.alpha, &all.directions),
            few: all.every((chosen.len() / MIP_TEXELS).max(1)),
            all,
            lobe,
            scale: convention.scale,
            is_good: score.errors.relmse <= GOOD,
            left_alone: score.left().unwrap_or(score.errors.relmse),
        }
    }

    /// Returns the relMSE that the level's width in a chain leaves, beside a gain or coarse mips, as
    /// even blurs or as mips of maps.
    fn left<'m>(
        &self,
        truth: &Truth,
        mips: impl Iterator<Item = &'m MipChain>,
        alphas: &[f64],
    ) -> f64 {
        let alpha = alphas[self.index];
        let of_all = |values: &[DVec3]| self.all.relmse(truth, self.scale, values);
        let plain = of_all(&self.search.plain(truth, alpha));
        let even = plain.min(self.search.least(alpha, &of_all).relmse);
        // Means of mips take far longer.
        if even <= GOOD {
            return even;
        }
        let of_few = |values: &[DVec3]| self.few.relmse(truth, self.scale, values);
        let by_mips = |mips: &MipChain| {
            let means = MipMeans {
                mips,
                lobe: self.lobe,
                directions: &self.few.directions,
            };
            means.least_of_all(alpha, &of_few).relmse
        };
        mips.map(by_mips).fold(even, f64::min)
    }

    /// Whether a chain may leave this relMSE: good levels stay good.
    fn allows(&self, left: f64) -> bool {
        left <= if self.is_good { GOOD } else { CLOSE }
    }
}

impl Compared {
    /// Returns every `step`-th of the texels.
    fn every(&self, step: usize) -> Self {
        let chosen: Vec<usize> = (0..self.found.len()).step_by(step).collect();
        Self {
            directions: self.directions.only(&chosen),
            found: fit::picked(&self.found, &chosen),
        }
    }

    /// Returns the relMSE of the texels over radiances, of which a texel of 1 is `scale`, beside a
    /// gain.
    fn relmse(&self, truth: &Truth, scale: f64, values: &[DVec3]) -> f64 {
        let epsilon = truth.epsilon();
        let values = truth.stored(values, scale);
        let gain = fit::gain(&self.directions, &self.found, &values, epsilon);
        let gain = 1.0 / gain.clamp(*GAIN.start(), *GAIN.end());
        errors(&self.directions, &self.found, &values, epsilon, gain).relmse
    }
}
