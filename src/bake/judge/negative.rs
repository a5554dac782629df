//! Texels below 0, which no radiance has.

use super::directions::Directions;
use glam::DVec3;

/// Share of a level's mean below which a negative value is rounding of a series or a filter.
const ROUNDING: f64 = 1e-3;

/// The negative texels of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NegativeTexels {
    pub count: usize,
    /// Number of all texels.
    pub total: usize,
    /// Smallest channel of the lowest texel.
    pub lowest: f64,
    /// Face, column and row of the lowest texel.
    pub texel: [usize; 3],
    /// Whether the lowest is far below 0 for this level.
    pub is_large: bool,
}

impl NegativeTexels {
    /// Counts the texels with a channel below 0; `None` if there are none.
    pub fn of(directions: &Directions, found: &[DVec3]) -> Option<Self> {
        let lowest_of = |index: usize| found[index].min_element();
        let negative = || (0..found.len()).filter(|index| lowest_of(*index) < 0.0);
        let index = negative().min_by(|a, b| lowest_of(*a).total_cmp(&lowest_of(*b)))?;
        let sum: f64 = found.iter().map(|texel| texel.abs().element_sum()).sum();
        let mean = sum / (3 * found.len()) as f64;
        Some(Self {
            count: negative().count(),
            total: found.len(),
            lowest: lowest_of(index),
            texel: directions.texel(index),
            is_large: -lowest_of(index) > ROUNDING * mean,
        })
    }
}
