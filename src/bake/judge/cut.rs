//! Cuts of bright texels, which relMSE hardly counts: few texels, and much of the light.

use super::cause::{Cause, CutSlip, Unknown};
use super::level::GOOD_BIAS;
use super::light::{SAME_MEAN, UNCUT};
use super::sample::Level;
use super::texel::Cut;
use glam::DVec3;

/// Largest relative difference of texels that were cut at one value, and their smallest number.
const AT_LIMIT: f64 = 1e-3;
const AT_LIMIT_COUNT: usize = 6;
/// Smallest ratio of the brightest and darkest right texel that a cut made alike.
const VARIES: f64 = 1.05;

impl Level<'_, '_> {
    /// Names why the mean of a good level is off: a cut of few bright texels, if it is one.
    pub fn bias_cause(&self, exact: &[DVec3], bias_rel: f64) -> Cause {
        let limit = self
            .found
            .iter()
            .map(|texel| texel.max_element())
            .fold(0.0, f64::max);
        let cut: Vec<DVec3> = exact
            .iter()
            .map(|texel| Cut::EachChannel.apply(*texel, limit))
            .collect();
        let found_mean = self.directions.mean(self.found).element_sum();
        let cut_mean = self.directions.mean(&cut).element_sum();
        if (found_mean / cut_mean - 1.0).abs() < SAME_MEAN {
            Cause::Cut(CutSlip {
                limit,
                bias_rel: Some(bias_rel),
            })
        } else {
            Cause::Unknown(Unknown::Mean { bias_rel })
        }
    }

    /// Returns the cut of a level that is too dark if many texels have its largest value where the
    /// right ones are brighter.
    pub fn proven_cut(&self, exact: &[DVec3], bias_rel: f64) -> Option<CutSlip> {
        if bias_rel > -GOOD_BIAS {
            return None;
        }
        let limit = self
            .found
            .iter()
            .map(|texel| texel.max_element())
            .fold(0.0, f64::max);
        let at_limit: Vec<usize> = (0..self.found.len())
            .filter(|index| self.found[*index].max_element() > (1.0 - AT_LIMIT) * limit)
            .collect();
        let right: Vec<f64> = at_limit
            .iter()
            .map(|index| exact[*index].max_element())
            .collect();
        let brighter_count = right.iter().filter(|right| **right * UNCUT > limit).count();
        // A gain leaves them alike in the right level, too.
        let least = right.iter().copied().fold(f64::INFINITY, f64::min);
        let most = right.iter().copied().fold(0.0, f64::max);
        let is_cut = at_limit.len() >= AT_LIMIT_COUNT
            && 2 * brighter_count > at_limit.len()
            && most > VARIES * least;
        is_cut.then_some(CutSlip {
            limit,
            bias_rel: Some(bias_rel),
        })
    }
}
