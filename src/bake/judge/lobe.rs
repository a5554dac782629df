//! Lobes that are taken for a kernel's.

use crate::instrument::precompute::prefilter::Kernel;
use glam::DVec3;

/// A wrong lobe about r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// Half vectors are taken as l.
    HalfAsLight,
    /// Weighted by n·l once too often.
    CosineTwice,
    /// GTR with gamma 1, as of coats.
    Gtr1,
    /// Charlie's sheen.
    Sheen,
    /// Phong about r with the exponent for h, 2/alpha² - 2.
    PhongOfHalf,
    /// Phong about r with a quarter of the exponent for h.
    PhongQuarter,
    /// Irradiance summed over θ and φ without sin θ.
    IrradianceWithoutSine,
    /// Irradiance weighted by the cosine once too often.
    IrradianceCosineTwice,
}

impl Lobe {
    /// Lobes of prefiltered radiance.
    pub const OF_RADIANCE: &[Self] = &[
        Self::HalfAsLight,
        Self::CosineTwice,
        Self::Gtr1,
        Self::Sheen,
        Self::PhongOfHalf,
        Self::PhongQuarter,
    ];
    pub const OF_IRRADIANCE: &[Self] = &[Self::IrradianceWithoutSine, Self::IrradianceCosineTwice];

    /// Returns the lobe over the kernel's `D(h)` at a cosine to r. Irradiance has the cosine and a
    /// constant D.
    pub fn ratio(self, kernel: &Kernel, alpha: f64, cos: f64) -> f64 {
        let weight = || kernel.weight(alpha, cos);
        let d_half = || d(kernel, alpha, half(cos));
        match self {
            Self::HalfAsLight => weight() * cos * d(kernel, alpha, cos) / d_half(),
            Self::CosineTwice => weight() * cos,
            Self::Gtr1 => {
                let lobe = 1.0 / (1.0 - (1.0 - alpha * alpha) * half(cos).powi(2));
                weight() * lobe / d_half()
            }
            Self::Sheen => {
                let sin = (0.5 * (1.0 - cos)).sqrt();
                weight() * sin.powf(1.0 / alpha) / d_half()
            }
            Self::PhongOfHalf => phong(cos, alpha) / d_half(),
            Self::PhongQuarter => phong(cos, alpha).powf(0.25) / d_half(),
            Self::IrradianceWithoutSine => cos / (1.0 - cos * cos).max(1e-16).sqrt(),
            Self::IrradianceCosineTwice => cos * cos,
        }
    }
}

/// Cosine of the angle between n = v and the half vector.
fn half(cos: f64) -> f64 {
    (0.5 * (1.0 + cos)).sqrt()
}

fn d(kernel: &Kernel, alpha: f64, cos: f64) -> f64 {
    let h = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    kernel.brdf.d(h, alpha).max(1e-200)
}

fn phong(cos: f64, alpha: f64) -> f64 {
    cos.powf(2.0 / (alpha * alpha) - 2.0)
}
