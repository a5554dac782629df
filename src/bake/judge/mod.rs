//! How wrong a bake is, compared with exact integrals over the environment's bilinear map.
//!
//! Prefiltered radiance and irradiance are convolutions, computed in spherical harmonics (relMSE
//! below 1e-6). Means weight each texel by its solid angle.

mod bake;
mod chain;
mod directions;
pub mod exact;
mod faces;
mod fit;
pub mod guess;
pub mod level;
mod light;
mod lobe;
mod sample;
mod scores;
pub mod sh;
pub mod slip;
pub mod table;
mod texel;

pub use bake::{IRRADIANCE, Judged, Judging};
pub use directions::{Directions, texels};
pub use fit::{Fit, gain_in_words};
pub use scores::{Limits, as_json};

use crate::base::math::harmonics::{Harmonics, SmoothMap};
use crate::instrument::brdf::Phong;
use crate::instrument::environment::Environment;
use crate::instrument::metrics::Epsilon;
use crate::instrument::precompute::prefilter::{Kernel, harmonic};
use glam::DVec3;

/// Largest relMSE of a good level: 3 % rms.
pub const GOOD: f64 = 1e-3;

/// Largest share of the error that an explanation may leave.
const EXPLAINED: f64 = 0.25;

/// A slip in words, with the flag or setting that fixes it if there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    pub kind: &'static str,
    pub words: String,
}

fn words(causes: &[Cause]) -> String {
    causes
        .iter()
        .map(|cause| cause.words.as_str())
        .collect::<Vec<_>>()
        .join("; ")
}

/// The light of a bake, and the kernel that it should have.
pub struct Truth<'a> {
    pub environment: &'a Environment,
    kernel: Kernel,
    harmonics: Harmonics,
    /// Multiple of the degree at which a bake is cut off.
    reach: usize,
    /// Whether the axes of the prefiltered map fit so badly that it seems to be of another light.
    is_other: bool,
}

impl<'a> Truth<'a> {
    /// Prepares the integrals for levels of these widths.
    pub fn new(environment: &'a Environment, kernel: Kernel, alphas: &[f64]) -> Self {
        Self::reaching(1, environment, kernel, alphas)
    }

    /// Doubles the degree, so that our own bakes are not judged by their own cut-off.
    pub fn judging(environment: &'a Environment, kernel: Kernel, alphas: &[f64]) -> Self {
        Self::reaching(2, environment, kernel, alphas)
    }

    fn reaching(
        reach: usize,
        environment: &'a Environment,
        kernel: Kernel,
        alphas: &[f64],
    ) -> Self {
        let widths = alphas.iter().filter(|alpha| has_width(**alpha));
        let degree = widths
            .map(|alpha| harmonic::degree(*alpha))
            .max()
            .unwrap_or_default();
        // A fit tries narrower lobes than the levels'.
        let degree = (reach * degree.max(harmonic::degree(1.0)))
            .clamp(fit::DEGREE_MAX, harmonic::DEGREE_MAX);
        Self {
            environment,
            kernel,
            harmonics: harmonic::harmonics(&environment.image, degree),
            reach,
            is_other: false,
        }
    }

    fn factors(&self, kernel: Kernel, alpha: f64, degree: usize) -> Vec<f64> {
        // Other kernels only explain a level.
        let is_own =
            kernel.brdf.name() == self.kernel.brdf.name() && kernel.weight == self.kernel.weight;
        let reach = if is_own { self.reach } else { 1 };
        harmonic::factors(kernel, alpha, degree.min(reach * harmonic::degree(alpha)))
    }

    /// Convolves the light for a width that [`has_width`].
    pub fn prefiltered(&self, alpha: f64) -> SmoothMap {
        self.prefiltered_by(self.kernel, alpha)
    }

    fn prefiltered_by(&self, kernel: Kernel, alpha: f64) -> SmoothMap {
        self.harmonics
            .convolved(&self.factors(kernel, alpha, self.harmonics.degree()))
    }

    /// Sums prefiltered radiance from bands of the light.
    fn of_bands(&self, bands: &[Vec<DVec3>], alpha: f64) -> Vec<DVec3> {
        let degree = bands.first().map_or(0, |bands| bands.len() - 1);
        let factors = self.factors(self.kernel, alpha, degree);
        bands
            .iter()
            .map(|bands| {
                bands
                    .iter()
                    .zip(&factors)
                    .map(|(band, factor)| *band * *factor)
                    .sum()
            })
            .collect()
    }

    /// Kernel and width of irradiance over π: at exponent 0 Phong's distribution is constant, so
    /// the weight is n·l.
    pub fn of_irradiance() -> (Kernel, f64) {
        (Kernel::cosine(&Phong), 1.0)
    }

    pub fn epsilon(&self) -> Epsilon {
        Epsilon::of_light(self.environment.luminance.mean)
    }
}

/// Whether a level is wider than a mirror; others are compared with the averaged environment.
pub fn has_width(alpha: f64) -> bool {
    alpha >= harmonic::ALPHA_MIN
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// `mean d²/(r² + ε)` over directions and channels.
    pub relmse: f64,
    /// Mean over the sphere, relative to the exact mean, minus 1.
    pub bias_rel: f64,
}

/// Scores `gain` times a map.
pub fn errors(
    directions: &Directions,
    found: &[DVec3],
    exact: &[DVec3],
    epsilon: Epsilon,
    gain: f64,
) -> Errors {
    let (mut relmse, mut whole, mut sums) = (0.0, 0.0, [0.0; 2]);
    for ((weight, found), exact) in directions.weights.iter().zip(found).zip(exact) {
        let found = *found * gain;
        relmse += weight * relative_square(found, *exact, epsilon);
        whole += weight;
        sums[0] += weight * found.element_sum();
        sums[1] += weight * exact.element_sum();
    }
    Errors {
        relmse: relmse / whole,
        bias_rel: if sums[1] > 0.0 {
            sums[0] / sums[1] - 1.0
        } else {
            0.0
        },
    }
}

/// Averages `d²/(r² + ε)` over channels.
fn relative_square(found: DVec3, exact: DVec3, epsilon: Epsilon) -> f64 {
    let d = found - exact;
    (0..3)
        .map(|c| epsilon.relative(d[c] * d[c], exact[c]))
        .sum::<f64>()
        / 3.0
}
