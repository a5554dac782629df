//! How wrong a bake is, compared with exact integrals over the environment's bilinear map.
//!
//! Prefiltered radiance and irradiance are convolutions, computed in spherical harmonics (relMSE
//! below 1e-6). Means weight each texel by its solid angle.

mod bake;
mod blurred_chain;
mod cause;
mod chain;
mod clause;
mod coarse_mips;
mod cut;
mod directions;
mod doubt;
mod doubt_words;
pub mod exact;
mod faces;
mod fit;
pub mod guess;
pub mod level;
mod light;
mod lobe;
mod mip_chain;
mod negative;
mod other_filters;
mod sample;
mod sampled_lobe;
mod scores;
pub mod sh;
#[cfg(feature = "gpu")]
pub mod shader;
#[cfg(feature = "gpu")]
mod shader_words;
pub mod slip;
mod summary;
pub mod table;
mod table_borders;
mod table_slip;
mod table_texels;
mod table_words;
mod texel;
mod texel_words;
mod verdict;
mod words;

pub use bake::{Judged, Judging};
pub use cause::{Cause, ChainSlip, CutSlip, Encoding, Mips, Unknown, WidthLaw};
pub use clause::{Clause, joined};
pub use directions::{Directions, TexelGrid, texels};
pub use doubt::{Doubt, MapPart, RankedAxes, Warning};
pub use faces::FaceTurn;
pub use fit::{Fit, Gain};
pub use level::GOOD_BIAS;
pub use light::SourceSlip;
pub use mip_chain::MipSource;
pub use negative::NegativeTexels;
pub use scores::{Limits, as_json};
pub use table_slip::{TableFlags, TableSlip, WrongBorders};
pub use verdict::{Part, PartVerdict, Quality, Verdict};

use crate::bake::rgbp;
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

/// The degree at which harmonics of a level are cut off.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CutOff {
    /// As our bakes are.
    Bake,
    /// Beyond it, so that our bakes are not judged by their own cut-off.
    Judge,
}

impl CutOff {
    fn degree(self, alpha: f64) -> usize {
        match self {
            Self::Bake => harmonic::degree(alpha),
            Self::Judge => harmonic::degree_of_judge(alpha),
        }
    }
}

/// The light of a bake, and the kernel that it should have.
pub struct Truth<'a> {
    pub environment: &'a Environment,
    kernel: Kernel,
    harmonics: Harmonics,
    cut_off: CutOff,
    /// Whether the axes of the prefiltered map fit so badly that it seems to be of another light.
    is_other: bool,
    /// Whether the files are RGBP whose scale was rounded up.
    has_rounded_up_scale: bool,
}

impl<'a> Truth<'a> {
    /// Prepares the integrals for levels of these widths.
    pub fn new(environment: &'a Environment, kernel: Kernel, alphas: &[f64]) -> Self {
        Self::cut_off_at(CutOff::Bake, environment, kernel, alphas)
    }

    /// The same for a judge: our own bakes are not judged by their own cut-off.
    pub fn judging(environment: &'a Environment, kernel: Kernel, alphas: &[f64]) -> Self {
        Self::cut_off_at(CutOff::Judge, environment, kernel, alphas)
    }

    fn cut_off_at(
        cut_off: CutOff,
        environment: &'a Environment,
        kernel: Kernel,
        alphas: &[f64],
    ) -> Self {
        let widths = alphas.iter().filter(|alpha| has_width(**alpha));
        let degree = widths
            .map(|alpha| cut_off.degree(*alpha))
            .max()
            .unwrap_or_default();
        // A fit tries narrower lobes than the levels'.
        let degree = degree
            .max(cut_off.degree(1.0))
            .clamp(fit::DEGREE_MAX, harmonic::DEGREE_MAX);
        Self {
            environment,
            kernel,
            harmonics: harmonic::harmonics(&environment.image, degree),
            cut_off,
            is_other: false,
            has_rounded_up_scale: false,
        }
    }

    fn factors(&self, kernel: Kernel, alpha: f64, degree: usize) -> Vec<f64> {
        // Other kernels only explain a level.
        let is_expected =
            kernel.brdf.name() == self.kernel.brdf.name() && kernel.weight == self.kernel.weight;
        let cut_off = if is_expected {
            self.cut_off
        } else {
            CutOff::Bake
        };
        harmonic::factors(kernel, alpha, degree.min(cut_off.degree(alpha)))
    }

    /// Convolves the light for a width that [`has_width`].
    pub fn prefiltered(&self, alpha: f64) -> SmoothMap {
        self.prefiltered_by(self.kernel, alpha)
    }

    fn prefiltered_by(&self, kernel: Kernel, alpha: f64) -> SmoothMap {
        self.harmonics
            .convolved(&self.factors(kernel, alpha, self.harmonics.degree()))
    }

    /// Returns what the files hold for radiance, of which a texel of 1 is `scale`.
    fn stored(&self, values: &[DVec3], scale: f64) -> Vec<DVec3> {
        if self.has_rounded_up_scale {
            let stored = |value: &DVec3| scale * rgbp::rounded_up(*value / scale);
            values.iter().map(stored).collect()
        } else {
            values.to_vec()
        }
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

    /// Returns the ε of relative metrics under this light.
    pub fn epsilon(&self) -> Epsilon {
        Epsilon::of_light(self.environment.luminance.mean)
    }
}

/// Whether a level is wider than a mirror; others are compared with the averaged environment.
pub fn has_width(alpha: f64) -> bool {
    alpha >= harmonic::ALPHA_MIN
}

/// Errors of a map over the sphere.
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
    let mut relmse = 0.0;
    let mut whole = 0.0;
    let mut found_sum = 0.0;
    let mut exact_sum = 0.0;
    for ((weight, found), exact) in directions.weights.iter().zip(found).zip(exact) {
        let found = *found * gain;
        relmse += weight * relative_square(found, *exact, epsilon);
        whole += weight;
        found_sum += weight * found.element_sum();
        exact_sum += weight * exact.element_sum();
    }
    Errors {
        relmse: relmse / whole,
        bias_rel: if exact_sum > 0.0 {
            found_sum / exact_sum - 1.0
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
