//! Scores of a cell by n·v.
//!
//! A run has more of these numbers than of all others together. So they are packed: what the cells
//! of a run have in common is shared, and metrics without a number take no room.

use super::MetricValues;
use crate::instrument::metrics::METRICS;
use std::sync::Arc;

/// The pixels with `n_dot_v` in [`lo`, `hi`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinRange {
    pub lo: f64,
    pub hi: f64,
    pub pixel_count: u64,
}

/// The pixels of a range of n·v and their scores.
#[derive(Clone, Debug, PartialEq)]
pub struct Bin {
    pub range: BinRange,
    /// RGB mean of the reference; `None` in runs of older programs, which also lack the noise
    /// floors.
    pub reference_mean: Option<f64>,
    pub scores: MetricValues,
    /// Only for metrics whose bins determine the whole.
    pub noise_floors: MetricValues,
}

/// The bins of a cell in the order of their table; clones share the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Bins {
    layout: Arc<Layout>,
    /// Of each bin: mean of the reference, scores, noise floors; NaN if missing.
    numbers: Arc<[f64]>,
}

/// Where the numbers of bins are; equal for all cells of a scene.
#[derive(Debug, Default, PartialEq)]
struct Layout {
    ranges: Vec<BinRange>,
    /// The metrics with a score in some bin, as indices of [`METRICS`].
    scored: Vec<usize>,
    /// The metrics with a noise floor in some bin.
    floored: Vec<usize>,
}

impl Layout {
    fn new(bins: &[Bin]) -> Self {
        let metrics_with = |number: &dyn Fn(&Bin, &str) -> Option<f64>| {
            let is_known = |index: &usize| {
                let name = METRICS[*index].name;
                bins.iter().any(|bin| number(bin, name).is_some())
            };
            (0..METRICS.len()).filter(is_known).collect()
        };
        Self {
            ranges: bins.iter().map(|bin| bin.range).collect(),
            scored: metrics_with(&|bin, name| bin.scores.get(name)),
            floored: metrics_with(&|bin, name| bin.noise_floors.get(name)),
        }
    }

    /// The numbers of a bin in their order.
    fn numbers_of<'b>(&'b self, bin: &'b Bin) -> impl Iterator<Item = f64> + 'b {
        let scores = self.scored.iter().map(|index| bin.scores.0[*index]);
        let noise_floors = self.floored.iter().map(|index| bin.noise_floors.0[*index]);
        std::iter::once(bin.reference_mean.unwrap_or(f64::NAN))
            .chain(scores)
            .chain(noise_floors)
    }

    fn numbers_per_bin(&self) -> usize {
        1 + self.scored.len() + self.floored.len()
    }
}

impl Default for Bins {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl From<Vec<Bin>> for Bins {
    fn from(bins: Vec<Bin>) -> Self {
        let layout = Layout::new(&bins);
        let numbers = bins.iter().flat_map(|bin| layout.numbers_of(bin)).collect();
        Self {
            layout: Arc::new(layout),
            numbers,
        }
    }
}

impl FromIterator<Bin> for Bins {
    fn from_iter<I: IntoIterator<Item = Bin>>(bins: I) -> Self {
        bins.into_iter().collect::<Vec<_>>().into()
    }
}

impl Bins {
    pub fn is_empty(&self) -> bool {
        self.layout.ranges.is_empty()
    }

    pub fn ranges(&self) -> &[BinRange] {
        &self.layout.ranges
    }

    pub fn iter(&self) -> impl Iterator<Item = Bin> {
        (0..self.layout.ranges.len()).map(|index| self.bin(index))
    }

    fn bin(&self, index: usize) -> Bin {
        let Layout {
            ranges,
            scored,
            floored,
        } = &*self.layout;
        let count = self.layout.numbers_per_bin();
        let numbers = &self.numbers[index * count..][..count];
        let (mean, numbers) = numbers.split_first().expect("each bin has a mean or a NaN");
        let (scores, noise_floors) = numbers.split_at(scored.len());
        Bin {
            range: ranges[index],
            reference_mean: Some(*mean).filter(|mean| !mean.is_nan()),
            scores: MetricValues::at(scored, scores),
            noise_floors: MetricValues::at(floored, noise_floors),
        }
    }

    /// Shares what is equal with the bins of another cell.
    pub fn share_layout(&mut self, other: &Self) {
        if self.layout == other.layout {
            self.layout = other.layout.clone();
        }
    }
}
