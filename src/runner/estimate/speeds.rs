//! Seconds of a unit of work: lines fitted to measurements.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How much an item of work is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Amount {
    pub pixels: f64,
    /// Of all pixels together.
    pub samples: f64,
}

/// Seconds of an item: `fixed + per_pixel * pixels + per_sample * samples`.
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

    /// The line without a fixed part that misses measurements least, in squares over their size: an error of a hundredth then counts
    /// the more the longer the item takes. No cost is negative.
    fn fit(measured: &[(Amount, f64)]) -> Self {
        let sum = |term: &dyn Fn(Amount, f64) -> f64| -> f64 {
            measured.iter().map(|(amount, seconds)| term(*amount, *seconds) / seconds.max(f64::MIN_POSITIVE)).sum()
        };
        let (pp, ps, ss) =
            (sum(&|a, _| a.pixels * a.pixels), sum(&|a, _| a.pixels * a.samples), sum(&|a, _| a.samples * a.samples));
        let (pt, st) = (sum(&|a, t| a.pixels * t), sum(&|a, t| a.samples * t));
        let determinant = pp * ss - ps * ps;
        // All measurements at one sample count tell nothing of a second slope.
        if determinant > 1e-9 * pp * ss {
            let (per_pixel, per_sample) = ((pt * ss - st * ps) / determinant, (st * pp - pt * ps) / determinant);
            if per_pixel >= 0.0 && per_sample >= 0.0 {
                return Self { fixed: 0.0, per_pixel, per_sample };
            }
        }
        let slope = |along: f64, square: f64| if square > 0.0 { along / square } else { 0.0 };
        let of_samples = Self { per_sample: slope(st, ss), ..Self::default() };
        let of_pixels = Self { per_pixel: slope(pt, pp), ..Self::default() };
        let missed = |line: &Self| sum(&|amount, seconds| (line.at(amount) - seconds).powi(2));
        if missed(&of_samples) <= missed(&of_pixels) { of_samples } else { of_pixels }
    }
}

/// Lines by kind of work. A kind is words from the general to the special, such as `image sampled none ggx`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Speeds(BTreeMap<String, Line>);

impl Speeds {
    /// The lines that fit measurements: one for each kind, and one for what kinds with the same first two words have in common.
    pub fn fit(measured: &[(String, Amount, f64)]) -> Self {
        let mut by_kind: BTreeMap<String, Vec<(Amount, f64)>> = BTreeMap::new();
        for (kind, amount, seconds) in measured {
            let words: Vec<&str> = kind.split(' ').collect();
            for length in words.len().min(2)..=words.len() {
                by_kind.entry(words[..length].join(" ")).or_default().push((*amount, *seconds));
            }
        }
        Self(by_kind.into_iter().map(|(kind, measured)| (kind, Line::fit(&measured))).collect())
    }

    /// Given lines.
    pub fn of(lines: &[(&str, Line)]) -> Self {
        Self(lines.iter().map(|(kind, line)| ((*kind).to_owned(), *line)).collect())
    }

    /// Sets the line of a kind.
    pub fn set(&mut self, kind: &str, line: Line) {
        self.0.insert(kind.to_owned(), line);
    }

    /// Adds lines, in the place of known ones of their kinds.
    pub fn extend(&mut self, more: Self) {
        self.0.extend(more.0);
    }

    /// The line of the most special known kind that holds this one.
    pub fn line(&self, kind: &str) -> Option<&Line> {
        let mut kind = kind;
        loop {
            if let Some(line) = self.0.get(kind) {
                return Some(line);
            }
            kind = kind.rsplit_once(' ')?.0;
        }
    }
}
