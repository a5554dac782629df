//! Where the error of image-based lighting comes from: its approximations as players of a game.
//!
//! Several approximations lead from the specular integral to the rendered image: the [`STEPS`].
//! Each feasible *coalition* of steps is an estimator ([`radiance`]); in the list's order these are
//! the ladder's rungs. The cost of a step depends on the steps made before it, so each has four
//! numbers ([`attribution`]): its covariance share in the ladder's order, the error that it adds
//! first and removes last, and the mean over all orders, its Shapley value.

pub mod attribution;
pub mod game;
pub mod radiance;
mod setting;
mod tabulated;

pub use attribution::{Attribution, StepNumbers};

use crate::instrument::metrics::VIEWS;
use game::{Coalition, Game};

#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub name: &'static str,
    /// The steps that must be made before.
    pub needs: Coalition,
}

/// Bands of n·v reported besides all views: both ends, and the range between.
pub const BANDS: [[f64; 2]; 3] = [
    VIEWS[0],
    [VIEWS[0][1], VIEWS[VIEWS.len() - 1][0]],
    VIEWS[VIEWS.len() - 1],
];

pub const FRESNEL: usize = 0;
pub const MASKING: usize = 1;
pub const VIEW: usize = 2;
pub const LEVELS: usize = 3;
pub const TEXELS: usize = 4;
pub const SAMPLES: usize = 5;
pub const STORAGE: usize = 6;
pub const TABLE: usize = 7;

/// From the specular integral to the split sum. Levels to storage need n = v = r: maps store one
/// direction.
pub static STEPS: &[Step] = &[
    // Fresnel's factor leaves the integral: f0 A + B times a mean.
    Step {
        name: "Fresnel",
        needs: Coalition::EMPTY,
    },
    // The weight of the prefiltered map, n·l by default, replaces masking-shadowing.
    Step {
        name: "masking",
        needs: Coalition::EMPTY,
    },
    // n = v = r: the lobe about r of a view along it.
    Step {
        name: "view",
        needs: Coalition::EMPTY,
    },
    // A linear blend of two level widths replaces the width.
    Step {
        name: "levels",
        needs: Coalition::from_players(&[VIEW]),
    },
    // Linear filtering between texels replaces the direction.
    Step {
        name: "texels",
        needs: Coalition::from_players(&[VIEW]),
    },
    // The finite prefilter replaces the integral in each texel.
    Step {
        name: "samples",
        needs: Coalition::from_players(&[VIEW]),
    },
    // The number format of the texels.
    Step {
        name: "storage",
        needs: Coalition::from_players(&[VIEW]),
    },
    // The table, as looked up, replaces A and B.
    Step {
        name: "table",
        needs: Coalition::EMPTY,
    },
];

/// Returns the game whose players are the steps.
pub fn game() -> Game {
    Game::new(STEPS.iter().map(|step| step.needs).collect())
}
