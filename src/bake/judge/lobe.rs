//! Lobes that are taken for a kernel's.

use crate::instrument::precompute::prefilter::Kernel;
use glam::DVec3;

/// A lobe about r in words, and its ratio to the kernel's `D(h)`, by alpha and the cosine to r.
pub type Lobe = (&'static str, fn(&Kernel, f64, f64) -> f64);

pub static OF_RADIANCE: &[Lobe] = &[
    (
        "half vectors taken as l: reflect v about them",
        |kernel, alpha, cos| {
            kernel.weight(alpha, cos) * cos * d(kernel, alpha, cos) / d(kernel, alpha, half(cos))
        },
    ),
    ("weighted by n·l once too often", |kernel, alpha, cos| {
        kernel.weight(alpha, cos) * cos
    }),
    (
        "lobe of GTR with gamma 1, as of coats",
        |kernel, alpha, cos| {
            let lobe = 1.0 / (1.0 - (1.0 - alpha * alpha) * half(cos).powi(2));
            kernel.weight(alpha, cos) * lobe / d(kernel, alpha, half(cos))
        },
    ),
    ("lobe of sheen (Charlie)", |kernel, alpha, cos| {
        let sin = (0.5 * (1.0 - cos)).sqrt();
        kernel.weight(alpha, cos) * sin.powf(1.0 / alpha) / d(kernel, alpha, half(cos))
    }),
    (
        "Phong's lobe about r, of the exponent for h, 2/alpha² - 2",
        |kernel, alpha, cos| phong(cos, alpha) / d(kernel, alpha, half(cos)),
    ),
    (
        "Phong's lobe about r, of a quarter of the exponent for h",
        |kernel, alpha, cos| phong(cos, alpha).powf(0.25) / d(kernel, alpha, half(cos)),
    ),
];

/// Over the cosine and a constant D.
pub static OF_IRRADIANCE: &[Lobe] = &[
    ("summed over θ and φ without sin θ", |_, _, cos| {
        cos / (1.0 - cos * cos).max(1e-16).sqrt()
    }),
    ("weighted by the cosine once too often", |_, _, cos| {
        cos * cos
    }),
];

/// Cosine of the angle between n = v and the half vector.
fn half(cos: f64) -> f64 {
    (0.5 * (1.0 + cos)).sqrt()
}

fn d(kernel: &Kernel, alpha: f64, cos: f64) -> f64 {
    kernel
        .brdf
        .d(
            DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos),
            alpha,
        )
        .max(1e-200)
}

fn phong(cos: f64, alpha: f64) -> f64 {
    cos.powf(2.0 / (alpha * alpha) - 2.0)
}
