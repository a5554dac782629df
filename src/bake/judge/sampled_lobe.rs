//! A lobe that importance samples cover, by rings about its middle.

use crate::instrument::precompute::prefilter::Kernel;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Number of samples that the estimate assumes, as most bakers take.
pub const SAMPLES: f64 = 1024.0;

/// A kernel, and the density of its samples.
#[derive(Clone, Copy)]
pub struct SampledLobe {
    pub kernel: Kernel,
    pub is_irradiance: bool,
}

/// Directions of light at one angle γ to the middle of a lobe.
pub struct Ring {
    pub cos: f64,
    /// Share of the lobe, up to a factor.
    pub weight: f64,
    /// Solid angle that a sample stands for.
    pub solid_angle: f64,
}

impl SampledLobe {
    /// Lists the rings of a lobe from the hemisphere's edge on, at steps of `t = ln tan(γ/2)`.
    pub fn rings(&self, alpha: f64, step: impl Fn(f64) -> f64) -> Vec<Ring> {
        let mut rings = Vec::new();
        let mut t = 0.0;
        let low = alpha.ln() - 8.0;
        while t > low {
            let step = step(t);
            let middle = t - 0.5 * step;
            let sin = 1.0 / middle.cosh();
            let cos = -middle.tanh();
            let density = self.d(alpha, cos);
            rings.push(Ring {
                cos,
                weight: step * TAU * sin * sin * density * self.kernel.weight(alpha, cos),
                solid_angle: 1.0 / (SAMPLES * self.pdf(density, cos)),
            });
            t -= step;
        }
        rings
    }

    /// Returns the density of half vectors about n for light at an angle to it.
    fn d(&self, alpha: f64, cos: f64) -> f64 {
        let n_dot_h = (0.5 * (1.0 + cos)).sqrt();
        let h = DVec3::new((1.0 - n_dot_h * n_dot_h).max(0.0).sqrt(), 0.0, n_dot_h);
        self.kernel.brdf.d(h, alpha)
    }

    fn pdf(&self, density: f64, cos: f64) -> f64 {
        if self.is_irradiance {
            cos / PI
        } else {
            0.25 * density
        }
    }
}
