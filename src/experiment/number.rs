//! Numbers of experiment files and command lines, and the ranges that they must lie in.

use std::fmt;
pub use toml::Value as Raw;

pub(super) fn number(raw: &Raw) -> Option<f64> {
    raw.as_float().or(raw.as_integer().map(|n| n as f64))
}

#[derive(Clone, Copy, Debug)]
pub struct Range {
    pub min: f64,
    pub max: f64,
    /// Whether `min` itself is excluded.
    pub min_open: bool,
}

impl Range {
    /// `[min, max]`.
    pub const fn closed(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            min_open: false,
        }
    }

    /// `(min, max]`.
    pub const fn above(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            min_open: true,
        }
    }

    pub(super) fn holds(&self, x: f64) -> bool {
        let is_above_min = if self.min_open {
            x > self.min
        } else {
            x >= self.min
        };
        is_above_min && x <= self.max
    }

    /// Parses a number in the range.
    pub(super) fn parse(&self, raw: &Raw) -> Result<f64, String> {
        match number(raw) {
            Some(x) if self.holds(x) => Ok(x),
            Some(_) => Err(format!("{raw} is outside {self}")),
            None => Err(format!("{raw} is not a number in {self}")),
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{}{}, {}]",
            if self.min_open { '(' } else { '[' },
            self.min,
            self.max
        )
    }
}

/// A coordinate of a position or direction.
pub const COORDINATE: Range = Range::closed(-1e9, 1e9);
