//! The lobe of cloth, whose facets lean to the horizon \[EstevezKulla17\] \[KhrSheen20\]; on the
//! device `shaders/shade/lobe/sheen.glsl`.
//!
//! `D = (2 + p)/(2π) sin^p θ_h`, `p = 1/alpha`, with `∫ D n_dot_h = 1`. Both visibilities are a
//! correlated masking `1/(1 + Λ(v) + Λ(l))` over `4 n_dot_v n_dot_l`:
//!
//! - `charlie`: `Λ = exp q(x)` for a cosine `x < 1/2`, else `exp(2 q(1/2) - q(1 - x))`, `q = a/(1 +
//!   b x^c) + d x + e`, with five numbers by alpha \[EstevezKulla17\];
//! - `ashikhmin`: `1/(4 (n_dot_l + n_dot_v - n_dot_l n_dot_v))`, the same with `Λ = 1/x - 1`
//!   \[Neubelt13\].
//!
//! Neither conserves energy if alpha is small: at n·v 0.05 the albedo exceeds 1 below alpha 0.013
//! and 0.09.

use super::{Brdf, sin2_cos2};
use crate::base::glsl::constants;
use crate::base::math::sampling::direction_from_polar;
use crate::base::names::listed;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Smallest width: below perceptual roughness 0.1 grazing views would reflect several times the
/// light.
pub const SHEEN_ALPHA_MIN: f64 = 0.01;
const _: () = assert!(SHEEN_ALPHA_MIN as f32 == constants::SHEEN_ALPHA_MIN);

/// A sheen lobe, by its visibility. It is not one of [`super::MODELS`]: no base has it. Its masking
/// is [`super::MaskingShadowing::Correlated`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SheenVisibility {
    #[default]
    Charlie,
    Ashikhmin,
}

listed!(SheenVisibility, "sheen visibility", { "charlie": Charlie, "ashikhmin": Ashikhmin });

impl Brdf for SheenVisibility {
    fn name(&self) -> &'static str {
        crate::base::names::Listed::name(self)
    }

    fn about(&self) -> &'static str {
        "sheen of cloth"
    }

    fn is_stretchable(&self) -> bool {
        false
    }

    fn d(&self, h_local: DVec3, alpha: f64) -> f64 {
        let (sin2, _) = sin2_cos2(h_local);
        if h_local.z <= 0.0 {
            0.0
        } else {
            (2.0 + 1.0 / alpha) / TAU * sin2.powf(0.5 / alpha)
        }
    }

    fn g1(&self, n_dot_w: f64, alpha: f64) -> f64 {
        match self {
            _ if n_dot_w <= 0.0 => 0.0,
            Self::Charlie => 1.0 / (1.0 + lambda(n_dot_w, alpha)),
            Self::Ashikhmin => n_dot_w,
        }
    }

    /// The published visibility: none is exact.
    fn g1_exact(&self, n_dot_w: f64, alpha: f64) -> f64 {
        self.g1(n_dot_w, alpha)
    }

    fn sample_d(&self, xi: DVec2, alpha: f64) -> DVec3 {
        let sin = xi.x.powf(alpha / (2.0 * alpha + 1.0));
        direction_from_polar(sin, ((1.0 - sin) * (1.0 + sin)).sqrt(), xi.y)
    }
}

fn lambda(x: f64, alpha: f64) -> f64 {
    let w = (1.0 - alpha).powi(2);
    let mix = |rough: f64, smooth: f64| rough * (1.0 - w) + smooth * w;
    let [a, b, c] = [
        mix(21.5473, 25.3245),
        mix(3.82987, 3.32435),
        mix(0.19823, 0.16801),
    ];
    let [d, e] = [mix(-1.97760, -1.27393), mix(-4.32054, -4.85967)];
    let q = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if x < 0.5 {
        q(x).exp()
    } else {
        (2.0 * q(0.5) - q(1.0 - x)).exp()
    }
}
