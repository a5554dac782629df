//! Where the split sum's error comes from: its approximations as players of a game.
//!
//! Between the specular integral and the split sum stand eight approximations, the [`STEPS`]. Any *coalition* of them that makes sense is
//! an estimator of its own ([`radiance`]). In the order of the list they are the rungs of the ladder (`shade::method::ladder`). What
//! each costs depends on which others were made before, so that a step has four numbers ([`attribution`]): its covariance share in the
//! ladder's order, the error that it brings first and takes away last, and the mean over all orders, its Shapley value.

pub mod attribution;
pub mod game;
pub mod radiance;

pub use attribution::{Attribution, StepNumbers};

use crate::shade::Method;
use crate::shade::method::{ladder as rungs, ladder_texels, split_sum};
use game::Coalition;

/// One approximation.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub name: &'static str,
    /// The method whose frame is the rung after the step; that of texels has three rungs, by the axes of tables.
    pub rung: &'static Method,
    /// The steps that must have been made before, as a coalition.
    pub needs: Coalition,
}

pub const FRESNEL: usize = 0;
pub const MASKING: usize = 1;
pub const VIEW: usize = 2;
pub const LEVELS: usize = 3;
pub const TEXELS: usize = 4;
pub const SAMPLES: usize = 5;
pub const STORAGE: usize = 6;
pub const TABLE: usize = 7;

/// The approximations in the ladder's order. Only what depends on one direction alone can be tabulated: levels, texels, samples and
/// storage need n = v = r.
pub const STEPS: [Step; 8] = [
    // Fresnel's factor leaves the integral: f0 A + B times a mean.
    free("Fresnel", &rungs::FRESNEL),
    // The weight of the prefiltered map, n·l by default, for masking-shadowing.
    free("masking", &rungs::MASKING),
    // The view, n = v = r: the lobe about r of a view along it.
    free("view", &rungs::VIEW),
    // A linear blend of the widths of two levels for the width.
    tabulated("levels", &rungs::LEVELS),
    // Linear filtering between texels for the direction.
    tabulated("texels", &ladder_texels::METHOD),
    // The finite prefilter for the integral in each texel.
    tabulated("samples", &ladder_texels::METHOD),
    // The format in which texels are kept.
    tabulated("storage", &ladder_texels::METHOD),
    // The DFG table as looked up for A and B.
    free("table", &split_sum::METHOD),
];

const fn free(name: &'static str, rung: &'static Method) -> Step {
    Step { name, rung, needs: 0 }
}

const fn tabulated(name: &'static str, rung: &'static Method) -> Step {
    Step { name, rung, needs: 1 << VIEW }
}

/// What each step needs.
pub fn needs() -> [Coalition; STEPS.len()] {
    STEPS.map(|step| step.needs)
}
