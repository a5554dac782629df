//! Where the error of image-based lighting comes from: its approximations as players of a game.
//!
//! Between an integral of a surface's term and what is rendered in its place stand some approximations: the steps of a [`Ladder`]. Any
//! *coalition* of them that makes sense is an estimator of its own ([`radiance`], [`diffuse`]). In the order of the list they are the
//! ladder's rungs. What each costs depends on which others were made before, so that a step has four numbers ([`attribution`]): its
//! covariance share in the ladder's order, the error that it brings first and takes away last, and the mean over all orders, its Shapley
//! value.

pub mod attribution;
pub mod diffuse;
pub mod game;
pub mod radiance;

pub use attribution::{Attribution, StepNumbers};

use crate::metrics::VIEWS;
use crate::shade::method::{ladder as rungs, ladder_texels, split_sum};
use crate::shade::{Diffuse, Method};
use game::Coalition;

/// The approximations of one term in the order in which they are told.
#[derive(Debug)]
pub struct Ladder {
    pub steps: &'static [Step],
}

/// One approximation.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub name: &'static str,
    /// The method whose frame is the rung after the step, where there is one.
    pub rung: Option<&'static Method>,
    /// The steps that must have been made before, as a coalition.
    pub needs: Coalition,
}

/// Bands of n·v by which steps are told beside all views: its ends, and what lies between.
pub const BANDS: [[f64; 2]; 3] = [VIEWS[0], [VIEWS[0][1], VIEWS[VIEWS.len() - 1][0]], VIEWS[VIEWS.len() - 1]];

pub const FRESNEL: usize = 0;
pub const MASKING: usize = 1;
pub const VIEW: usize = 2;
pub const LEVELS: usize = 3;
pub const TEXELS: usize = 4;
pub const SAMPLES: usize = 5;
pub const STORAGE: usize = 6;
pub const TABLE: usize = 7;

/// From the specular integral to the split sum. Only what depends on one direction alone can be tabulated: levels, texels, samples and
/// storage need n = v = r.
pub static SPLIT_SUM: Ladder = Ladder {
    steps: &[
        // Fresnel's factor leaves the integral: f0 A + B times a mean.
        Step { rung: Some(&rungs::FRESNEL), ..step("Fresnel", &[]) },
        // The weight of the prefiltered map, n·l by default, for masking-shadowing.
        Step { rung: Some(&rungs::MASKING), ..step("masking", &[]) },
        // The view, n = v = r: the lobe about r of a view along it.
        Step { rung: Some(&rungs::VIEW), ..step("view", &[]) },
        // A linear blend of the widths of two levels for the width.
        Step { rung: Some(&rungs::LEVELS), ..step("levels", &[VIEW]) },
        // Linear filtering between texels for the direction.
        Step { rung: Some(&ladder_texels::TEXELS), ..step("texels", &[VIEW]) },
        // The finite prefilter for the integral in each texel.
        Step { rung: Some(&ladder_texels::SAMPLES), ..step("samples", &[VIEW]) },
        // The format in which texels are kept.
        Step { rung: Some(&ladder_texels::STORAGE), ..step("storage", &[VIEW]) },
        // The DFG table as looked up for A and B.
        Step { rung: Some(&split_sum::METHOD), ..step("table", &[]) },
    ],
};

/// From the diffuse integral to nine coefficients. The first and the last step are those of the irradiance map, too.
pub static SH9: Ladder = Ladder {
    steps: &[
        // 1 - (f0 A + B) for 1 - F inside the integral.
        step("Fresnel", &[]),
        // Radiance of degree 2 for all of it.
        step("truncation", &[]),
        // Negative irradiance is set to 0.
        step("clamp", &[1]),
        // The sum over texels for the integrals of the coefficients.
        step("quadrature", &[1]),
        // The DFG table as looked up for A and B.
        step("table", &[0]),
    ],
};

/// From the diffuse integral to a map of irradiance.
pub static IRRADIANCE_MAP: Ladder = Ladder {
    steps: &[
        step("Fresnel", &[]),
        // Linear filtering between texels for the normal.
        step("texels", &[]),
        // The map as the device makes it.
        step("samples", &[1]),
        step("storage", &[1]),
        step("table", &[0]),
    ],
};

const fn step(name: &'static str, after: &[usize]) -> Step {
    let mut needs = 0;
    let mut i = 0;
    while i < after.len() {
        needs |= 1 << after[i];
        i += 1;
    }
    Step { name, rung: None, needs }
}

impl Ladder {
    /// What each step needs.
    pub fn needs(&self) -> Vec<Coalition> {
        self.steps.iter().map(|step| step.needs).collect()
    }
}

/// The ladder of what a surface reflects: of its diffuse term where that has one, else of its specular term.
pub fn ladder_of(method: &Method, diffuse: &Diffuse) -> Option<&'static Ladder> {
    of_diffuse(diffuse).or(method.has_ladder.then_some(&SPLIT_SUM))
}

/// That of a diffuse term.
pub fn of_diffuse(diffuse: &Diffuse) -> Option<&'static Ladder> {
    match () {
        () if !diffuse.has_ladder => None,
        () if diffuse.sh9.is_some() => Some(&SH9),
        () => Some(&IRRADIANCE_MAP),
    }
}
