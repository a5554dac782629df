//! Verdicts of the parts of a bake.

use super::cause::{Cause, Unknown};
use super::doubt::MapPart;

/// How good a part of a bake is.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    Good(Quality),
    /// Known slips explain the error.
    Wrong(Vec<Cause>),
    /// No known slip explains the error, or what black faces leave of it.
    Unexplained(Vec<Cause>),
}

/// Quality of a good part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quality {
    /// Within [`super::GOOD`] of its integral.
    Map,
    /// Within it at texels; relMSE of lookups between them is this.
    CoarseMap { between: f64 },
    /// A DFG table within a step of 8 bits.
    Table,
}

impl Verdict {
    /// Judges a part that is not good.
    pub fn from_causes(causes: Vec<Cause>) -> Self {
        if causes.iter().any(Cause::is_unknown) {
            Self::Unexplained(causes)
        } else {
            Self::Wrong(causes)
        }
    }

    pub fn is_good(&self) -> bool {
        matches!(self, Self::Good(_))
    }

    /// Lists what the verdict names; empty if the part is good.
    pub fn causes(&self) -> &[Cause] {
        match self {
            Self::Good(_) => &[],
            Self::Wrong(causes) | Self::Unexplained(causes) => causes,
        }
    }

    /// Whether it ends without a known slip.
    pub fn lacks_slip(&self) -> bool {
        self.causes().last() == Some(&Cause::Unknown(Unknown::NoSlip))
    }
}

impl Default for Verdict {
    fn default() -> Self {
        Self::Good(Quality::Map)
    }
}

/// A part of a bake in a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Level(usize),
    /// First and last of several levels with one verdict.
    Levels(usize, usize),
    Irradiance,
    Sh,
    Table,
    /// Axes and light of a map.
    Map(MapPart),
    /// Widths of all levels.
    Widths,
}

/// A part of a bake and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct PartVerdict {
    pub part: Part,
    /// Whether it is judged by the axes or the chain that fit.
    pub is_if_fixed: bool,
    pub verdict: Verdict,
}
