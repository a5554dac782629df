//! Seconds of a unit of work, by kind: the stated ones, and how measurements scale them.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How much an item of work is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Amount {
    pub pixels: f64,
    /// Of all pixels together.
    pub samples: f64,
}

/// Seconds (or bytes) of an item: `fixed + per_pixel * pixels + per_sample * samples`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Line {
    pub fixed: f64,
    pub per_pixel: f64,
    pub per_sample: f64,
}

impl Line {
    /// Seconds of one item.
    pub fn at(&self, amount: Amount) -> f64 {
        self.fixed + self.per_pixel * amount.pixels + self.per_sample * amount.samples
    }

    /// The line of work that takes this many times as long.
    pub fn times(self, factor: f64) -> Self {
        Self { fixed: self.fixed * factor, per_pixel: self.per_pixel * factor, per_sample: self.per_sample * factor }
    }
}

/// Lines by kind of work. A kind is words from the general to the special, such as `image sampled none ggx`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Speeds(pub BTreeMap<String, Line>);

impl Speeds {
    /// These lines times what measurements took over what they should have taken: one factor for each kind, and one for all kinds with the
    /// same first two words.
    pub fn scaled_to(&self, measured: &[(String, Amount, f64)]) -> Self {
        let mut sums: BTreeMap<String, [f64; 2]> = BTreeMap::new();
        for (kind, amount, taken) in measured {
            let expected = self.line(kind).map_or(0.0, |line| line.at(*amount));
            let words: Vec<&str> = kind.split(' ').collect();
            for length in words.len().min(2)..=words.len() {
                let sum = sums.entry(words[..length].join(" ")).or_default();
                *sum = [sum[0] + taken, sum[1] + expected];
            }
        }
        let scaled = |(kind, [taken, expected]): (String, [f64; 2])| {
            let line = self.line(&kind)?.times(taken / expected);
            Some((kind, line)).filter(|_| expected > 0.0)
        };
        Self(sums.into_iter().filter_map(scaled).collect())
    }

    /// The line of the most special known kind that holds this one; a timed frame without one is reckoned as an image.
    pub fn line(&self, kind: &str) -> Option<&Line> {
        let holding = |kind: &str| {
            let kinds = std::iter::successors(Some(kind.to_owned()), |kind| Some(kind.rsplit_once(' ')?.0.to_owned()));
            kinds.into_iter().find_map(|kind| self.0.get(&kind))
        };
        holding(kind).or_else(|| holding(&format!("image {}", kind.strip_prefix("frame ")?)))
    }
}
