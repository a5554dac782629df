//! The slips of source document 4.

use super::document_0::f_schlick;
use super::furnace::{SEPARABLE, albedo, mean, view};
use super::{Slip, figure, light};
use crate::brdf::{self, Brdf, Ggx, alpha_from_perceptual_roughness};
use crate::precompute::dfg::reference::dfg;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

pub const SLIPS: &[Slip] = &[
    Slip {
        printed: "`L_o = ∫ (c/π + D V G) L n·l dΩ`",
        right: "`D V F`: V holds G",
        figures: || {
            let (alpha, n_dot_v, f0) = (0.5, 0.5, 0.04);
            let v = view(n_dot_v);
            let printed = mean(&Ggx, alpha, n_dot_v, |m, l| {
                brdf::g2(&Ggx, n_dot_v, l.z, alpha, SEPARABLE).powi(2) * v.dot(m) / (n_dot_v * m.z)
            });
            let pair = dfg(&Ggx, SEPARABLE, n_dot_v, alpha);
            vec![light("specular albedo, f0 0.04, alpha 0.5, n·v 0.5", printed, f0 * pair.f0_scale + pair.f90_scale)]
        },
    },
    Slip {
        printed: "`c/π` beside the specular term, without k_D",
        right: "`(1 - (f0 A + B)) c/π`",
        figures: || {
            let pair = dfg(&Ggx, SEPARABLE, 0.1, 0.25);
            let specular = 0.04 * pair.f0_scale + pair.f90_scale;
            vec![light("albedo of both, c 1, f0 0.04, alpha 0.25, n·v 0.1", 1.0 + specular, 1.0)]
        },
    },
    Slip {
        printed: "`V F ≈ n·l` in the prefilter, V = G/(4 n·l n·v)",
        right: "`F G ≈ n·l`",
        figures: || {
            // v = n, F constant; the approximation itself has 0.5.
            let g1 = Ggx.g1(0.5, 0.5);
            vec![figure("weight at 60 degrees over that at 0, alpha 0.5", g1 / 0.5, g1)]
        },
    },
    Slip {
        printed: "table: mean of `V (1 - Fc)`, of `V Fc`: the density of h divided out as that of l",
        right: "`4 V n·l v·h / n·h`: `p_l = p_h / (4 v·h)`",
        figures: || {
            let albedo = |quantity, n_dot_v: f64| {
                let printed = mean(&Ggx, 0.01, n_dot_v, |_, l| {
                    brdf::g2(&Ggx, n_dot_v, l.z, 0.01, SEPARABLE) / (4.0 * l.z * n_dot_v)
                });
                light(quantity, printed, albedo(0.01, n_dot_v))
            };
            vec![
                albedo("A + B, alpha 0.01, n·v 0.1", 0.1),
                albedo("A + B, alpha 0.01, n·v 0.5", 0.5),
                albedo("A + B, alpha 0.01, n·v 1", 1.0),
            ]
        },
    },
    Slip {
        printed: "table's axes (roughness, angle), where document 1 has (n·v, roughness)",
        right: "one order: x is n·v, y is perceptual roughness",
        figures: || {
            let at = |n_dot_v, r| albedo(alpha_from_perceptual_roughness(r), n_dot_v);
            vec![light("albedo read with swapped axes, r 0.5, n·v 0.1", at(0.5, 0.1), at(0.1, 0.5))]
        },
    },
    Slip {
        printed: "`V/N Σ f/p`",
        right: "`1/N Σ f/p`: p is normalised",
        figures: || vec![light("∫ cos/π over the hemisphere, V = 2π", TAU, 1.0)],
    },
    Slip {
        printed: "`p(θ, φ) = 2α² cos sin/((α² - 1) cos² + 1)²`",
        right: "that is p(θ); `α²/π` in place of `2α²` for (θ, φ)",
        figures: || {
            const STEPS: u32 = 10_000;
            let density = |theta: f64| {
                let (sin, cos) = theta.sin_cos();
                2.0 * 0.25 * cos * sin / ((0.25 - 1.0) * cos * cos + 1.0).powi(2)
            };
            let step = FRAC_PI_2 / f64::from(STEPS);
            let over_theta: f64 = (0..STEPS).map(|i| step * density((f64::from(i) + 0.5) * step)).sum();
            vec![light("integral over θ and φ, alpha 0.5", over_theta * TAU, over_theta)]
        },
    },
    Slip {
        printed: "`C(θ) = α²/(cos²(α² - 1)² + (α² - 1)) - 1/(α² - 1)`",
        right: "the same as `sin²/(sin² + α² cos²)`, regular at alpha 1",
        figures: || {
            let (alpha2, (sin, cos)) = (1.0f64, FRAC_PI_4.sin_cos());
            let k = alpha2 - 1.0;
            let printed = alpha2 / (cos * cos * k * k + k) - 1.0 / k;
            vec![figure("C(45 degrees), alpha 1", printed, sin * sin / (sin * sin + alpha2 * cos * cos))]
        },
    },
    Slip {
        printed: "`k_D L_d`, k_D \"calculated as before\"; often read as `1 - F(n·v)`",
        right: "`(1 - metallic)(1 - (f0 A + B))`",
        figures: || {
            let pair = dfg(&Ggx, SEPARABLE, 0.1, 1.0);
            let right = 1.0 - (0.04 * pair.f0_scale + pair.f90_scale);
            vec![light("k_D as 1 - F(n·v), f0 0.04, alpha 1, n·v 0.1", 1.0 - f_schlick(0.04, 0.1), right)]
        },
    },
];
