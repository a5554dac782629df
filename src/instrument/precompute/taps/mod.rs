//! Where, how wide and with which weights to look up a prefiltered map: one, two or four taps in
//! the plane of incidence.
//!
//! A tap reads the map along a direction between the normal n and the mirror direction r, at a real
//! level, and counts with a weight; the weights add up to 1. docs/estimators.md ("Split sums by
//! other lookups") has what the taps minimise, with `b =` [`AMBIENT`]`/4π`. No environment enters.
//!
//! There is a table for each model, masking and chain of levels. Its axes are `√n_dot_v` and
//! perceptual roughness, with nodes at both ends of each. It has square parts below each other: for
//! f0 = 1 a part for each two taps (place and level of one, then of the other) and, except for one
//! tap, a part with all weights, then the same for f0 = 0.04. Other f0 lie between by the share
//! that every f0 reflects ([`dielectric_share`]).
//!
//! The smoothest rows are not fitted. They use the taps of the first fitted one, drawn together as
//! the lobe is: for a mirror all taps read level 0 along r.

mod chain;
mod fit;
mod lobe;
mod nodes;
mod table;

pub use chain::{Chain, LEVEL_MIN};
pub use fit::{AMBIENT, Fit};
pub use lobe::Lobe;
pub use nodes::{SIDE, first_guess, parameters_from_node};
pub use table::{TapTable, dielectric_share};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TapCount {
    One = 1,
    Two = 2,
    Four = 4,
}

impl TapCount {
    pub const ALL: [Self; 3] = [Self::One, Self::Two, Self::Four];

    /// Returns its word in the names of files.
    pub fn word(self) -> &'static str {
        match self {
            Self::One => "one",
            Self::Two => "two",
            Self::Four => "four",
        }
    }

    /// Returns the sampler that shaders read the table from.
    pub fn sampler(self) -> &'static str {
        match self {
            Self::One => "one_tap",
            Self::Two => "two_taps",
            Self::Four => "four_taps",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// From the normal towards the mirror direction, radians.
    pub angle: f64,
    pub level: f64,
    pub weight: f64,
}

impl Tap {
    /// Returns s such that the direction is along `(1 - s) n + s r`, for a view at the angle
    /// `theta` in (0, π/2).
    pub fn mirror_share(&self, theta: f64) -> f64 {
        let of_n = (theta - self.angle).sin();
        let of_r = self.angle.sin();
        of_r / (of_n + of_r)
    }
}

/// F0 of the table's two halves: a white metal, and what most dielectrics have.
pub const F0: [f64; 2] = [1.0, 0.04];
