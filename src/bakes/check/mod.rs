//! How wrong a bake is, against exact integrals over the environment's bilinear map.
//!
//! Prefiltered radiance and irradiance are convolutions, exact in spherical harmonics up to the degree that counts (relMSE below 1e-6).
//! Every mean over directions is one over the sphere: each texel counts by its solid angle.

mod directions;
mod fit;
pub mod guess;
pub mod image;
mod judge;
pub mod level;
pub mod sh;
pub mod table;

pub use directions::Directions;
pub use fit::Fit;
pub use judge::{IRRADIANCE, Judged, Judging};

use crate::brdf::Phong;
use crate::environment::Environment;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::harmonics::{Harmonics, SmoothMap};
use crate::math::quadrature::Tolerance;
use crate::metrics::Epsilon;
use crate::precompute::prefilter::{Kernel, harmonic, reference};
use glam::DVec3;

/// relMSE up to which a level is as its integral: 3 % rms.
pub const GOOD: f64 = 1e-3;

/// The light that a bake was made of, and the kernel that it should hold.
pub struct Truth<'a> {
    pub environment: &'a Environment,
    kernel: Kernel,
    harmonics: Harmonics,
    /// Times the degree at which a bake is cut off.
    reach: usize,
}

impl<'a> Truth<'a> {
    /// Prepares the integrals for levels of these widths, cut off at the degree up to which they count.
    pub fn new(environment: &'a Environment, kernel: Kernel, alphas: &[f64]) -> Self {
        Self::reaching(1, environment, kernel, alphas)
    }

    /// The same to twice that degree: a bake of our own is not judged by its own cut-off.
    pub fn judging(environment: &'a Environment, kernel: Kernel, alphas: &[f64]) -> Self {
        Self::reaching(2, environment, kernel, alphas)
    }

    fn reaching(reach: usize, environment: &'a Environment, kernel: Kernel, alphas: &[f64]) -> Self {
        let widths = alphas.iter().filter(|alpha| has_width(**alpha));
        let degree = widths.map(|alpha| harmonic::degree(*alpha)).max().unwrap_or_default();
        // A fit asks for narrower lobes than the levels' own.
        let degree = (reach * degree.max(harmonic::degree(1.0))).clamp(fit::DEGREE_MAX, harmonic::DEGREE_MAX);
        Self { environment, kernel, harmonics: harmonic::harmonics(&environment.image, degree), reach }
    }

    fn factors(&self, kernel: Kernel, alpha: f64, degree: usize) -> Vec<f64> {
        harmonic::factors(kernel, alpha, degree.min(self.reach * harmonic::degree(alpha)))
    }

    /// Prefiltered radiance of a width that [`has_width`].
    pub fn prefiltered(&self, alpha: f64) -> SmoothMap {
        self.harmonics.convolved(&self.factors(self.kernel, alpha, self.harmonics.degree()))
    }

    /// The part of each degree of the light at directions.
    fn bands(&self, directions: &[DVec3], degree: usize) -> Vec<Vec<DVec3>> {
        self.harmonics.bands(degree, directions)
    }

    /// Prefiltered radiance from the [`Self::bands`] at directions.
    fn of_bands(&self, bands: &[Vec<DVec3>], alpha: f64) -> Vec<DVec3> {
        let degree = bands.first().map_or(0, |bands| bands.len() - 1);
        let factors = self.factors(self.kernel, alpha, degree);
        bands.iter().map(|bands| bands.iter().zip(&factors).map(|(band, factor)| *band * *factor).sum()).collect()
    }

    /// Irradiance over π.
    pub fn irradiance(&self) -> SmoothMap {
        // Of exponent 0 the distribution of Phong's model is constant, and the weight is n·l.
        self.harmonics.convolved(&self.factors(Kernel::cosine(&Phong), 1.0, self.harmonics.degree()))
    }

    /// ε of relMSE.
    pub fn epsilon(&self) -> Epsilon {
        Epsilon::of_light(self.environment.luminance.mean)
    }

    /// Largest relative difference of the convolution from adaptive cubature at directions, for a width: what the scores rest on.
    pub fn spot_check(&self, alpha: f64, directions: &[DVec3]) -> f64 {
        let image = &self.environment.image;
        let quadrature = EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y));
        let tolerance = Tolerance { relative: 1e-5, max_part_count: 100_000 };
        let map = self.prefiltered(alpha);
        let off = |direction: &DVec3| {
            let exact = reference::prefilter(&quadrature, self.kernel, alpha, *direction, tolerance).value;
            ((map.value(*direction) - exact) / (exact.abs() + self.epsilon().beside_square().sqrt()))
                .abs()
                .max_element()
        };
        directions.iter().map(off).fold(0.0, f64::max)
    }
}

/// Whether a level of that width is wider than the mirror's: narrower ones are judged as the environment itself, averaged over a texel.
pub fn has_width(alpha: f64) -> bool {
    alpha >= harmonic::ALPHA_MIN
}

/// relMSE and bias of values against exact ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// `mean d²/(r² + ε)`, over directions and channels.
    pub relmse: f64,
    /// The mean over the sphere less the exact one, over the exact one.
    pub bias_rel: f64,
}

/// The errors of `gain` times a map.
pub fn errors(directions: &Directions, found: &[DVec3], exact: &[DVec3], epsilon: Epsilon, gain: f64) -> Errors {
    let (mut relmse, mut whole, mut sums) = (0.0, 0.0, [0.0; 2]);
    for ((weight, found), exact) in directions.weights.iter().zip(found).zip(exact) {
        let found = *found * gain;
        relmse += weight * relative_square(found, *exact, epsilon);
        whole += weight;
        sums[0] += weight * found.element_sum();
        sums[1] += weight * exact.element_sum();
    }
    Errors { relmse: relmse / whole, bias_rel: if sums[1] > 0.0 { sums[0] / sums[1] - 1.0 } else { 0.0 } }
}

/// `d²/(r² + ε)`, the mean of the channels.
fn relative_square(found: DVec3, exact: DVec3, epsilon: Epsilon) -> f64 {
    let d = found - exact;
    (0..3).map(|c| epsilon.relative(d[c] * d[c], exact[c])).sum::<f64>() / 3.0
}
