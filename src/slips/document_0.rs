//! The slips of source document 0 [Kim22].

use super::furnace::{SEPARABLE, albedo, albedo_with, mean, view};
use super::{Figure, Slip, figure, light};
use crate::brdf::{self, Brdf, Ggx, MaskingShadowing, Phong};
use crate::color::srgb_encode;
use crate::math::equirect::uv_from_direction;
use crate::math::spherical_harmonics::{basis, irradiance};
use crate::pixels::RgbImage;
use crate::precompute::dfg::reference::dfg;
use crate::precompute::exact_quadrature;
use crate::shade::method::seed0_literal;
use crate::shade::reference::{Surface, TOLERANCE};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

pub const SLIPS: &[Slip] = &[
    Slip {
        printed: "`a_p = -2 + 2/a_g²`, a_g \"the roughness value\"",
        right: "right for alpha; wrong for a perceptual roughness r, alpha = r²",
        figures: || {
            let exponent = brdf::exponent_from_alpha;
            let right = exponent(brdf::alpha_from_perceptual_roughness(0.5));
            vec![figure("Phong's exponent at r = 0.5", exponent(0.5), right)]
        },
    },
    Slip {
        printed: "`G_p` is Walter's fit, made for Beckmann",
        right: "exact Smith masking of Phong's own D (`smith-exact`)",
        figures: || {
            let albedo = |masking, n_dot_v| dfg(&Phong, masking, n_dot_v, 1.0).albedo();
            let both = |quantity, n_dot_v| {
                light(quantity, albedo(SEPARABLE, n_dot_v), albedo(MaskingShadowing::SmithExact, n_dot_v))
            };
            vec![both("albedo of Phong, alpha 1, n·v 0.1", 0.1), both("albedo of Phong, alpha 1, n·v 0.01", 0.01)]
        },
    },
    Slip {
        printed: "`G_g = 2/(1 + √(1 + a² + tan²))`",
        right: "`2/(1 + √(1 + a² tan²))`",
        figures: || {
            let printed = |cosine: f64, alpha: f64| {
                let tan2 = 1.0 / (cosine * cosine) - 1.0;
                2.0 / (1.0 + (1.0 + alpha * alpha + tan2).sqrt())
            };
            let furnace = |quantity, alpha: f64, n_dot_v: f64| {
                let misprinted =
                    albedo_with(alpha, n_dot_v, |n_dot_l| printed(n_dot_v, alpha) * printed(n_dot_l, alpha));
                light(quantity, misprinted, albedo(alpha, n_dot_v))
            };
            vec![
                figure("G1, alpha 0.1, n·v 0.1", printed(0.1, 0.1), Ggx.g1(0.1, 0.1)),
                furnace("albedo, alpha 0.1, n·v 0.1", 0.1, 0.1),
                furnace("albedo, alpha 0.1, n·v 1", 0.1, 1.0),
            ]
        },
    },
    Slip {
        printed: "`(1 - F) f_lambert + F f_cook-torrance`",
        right: "`(1 - F) f_lambert + f_cook-torrance`, which holds F",
        figures: fresnel_twice,
    },
    Slip {
        printed: "`Kd`, not defined; often read as `1 - F(n·v)`",
        right: "`(1 - metallic)(1 - (f0 A + B))`",
        figures: || {
            let pair = dfg(&Ggx, SEPARABLE, 0.1, 1.0);
            let right = 1.0 - (0.04 * pair.f0_scale + pair.f90_scale);
            vec![light("Kd, f0 0.04, alpha 1, n·v 0.1", 1.0 - f_schlick(0.04, 0.1), right)]
        },
    },
    Slip {
        printed: "mean of `G F / (4 w·N V·N) L cos θ`, half vectors from D",
        right: "`G F v·m / (n·v n·m) L`",
        figures: || {
            furnaces(|alpha, n_dot_v| {
                mean(&Ggx, alpha, n_dot_v, |_, l| brdf::g2(&Ggx, n_dot_v, l.z, alpha, SEPARABLE) / (4.0 * n_dot_v))
            })
        },
    },
    Slip {
        printed: "the same sum, directions w about the mirror direction (`seed0-literal`)",
        right: "`F G D(h) / (4 n·v p_l)`, p_l the true density of w",
        figures: || {
            let white = exact_quadrature(&RgbImage::filled(16, 8, [1.0; 3]));
            furnaces(|alpha, n_dot_v| {
                let (n, v) = (DVec3::Z, view(n_dot_v));
                let surface = Surface { model: &Ggx, masking: SEPARABLE, alpha, f0: DVec3::ONE, n, v };
                seed0_literal::limit(&white, &surface, TOLERANCE).value.x
            })
        },
    },
    Slip {
        printed: "the same sum, cos θ literally the sampled angle, that of m",
        right: "cos θ is n·l and cancels",
        figures: || {
            furnaces(|alpha, n_dot_v| {
                mean(&Ggx, alpha, n_dot_v, |m, l| {
                    brdf::g2(&Ggx, n_dot_v, l.z, alpha, SEPARABLE) * m.z / (4.0 * l.z * n_dot_v)
                })
            })
        },
    },
    Slip {
        printed: "Phong: `θ = acos(ξ^(1/(a + 1)))`",
        right: "`acos(ξ^(1/(a + 2)))`, whose density is D cos",
        figures: || {
            let mean_sin2 = |exponent: f64| 2.0 / (exponent + 4.0);
            let spread = |quantity, alpha| {
                let exponent = brdf::exponent_from_alpha(alpha);
                figure(quantity, mean_sin2(exponent - 1.0), mean_sin2(exponent))
            };
            let v = view(0.5);
            let sampled = mean(&Phong, seed0_literal::lobe_alpha(&Phong, 0.5), 0.5, |m, l| {
                brdf::g2(&Phong, 0.5, l.z, 0.5, SEPARABLE) * v.dot(m) / (0.5 * m.z)
            });
            vec![
                spread("mean sin² of the lobe, alpha 1", 1.0),
                spread("mean sin² of the lobe, alpha 0.25", 0.25),
                light("albedo of Phong, alpha 0.5, n·v 0.5", sampled, dfg(&Phong, SEPARABLE, 0.5, 0.5).albedo()),
            ]
        },
    },
    Slip {
        printed: "`level = ½ (log2(W H/N) - log2 D(H))`",
        right: "`½ (log2(W H/N) - log2(p_l 2π² sin θ))`, p_l the density of l",
        figures: || {
            // Both share W H / N; the difference is ½ log2(p_l 2π² sin θ / D).
            let offset = |quantity, n_dot_v, sin_theta: f64| {
                let p_l = brdf::pdf_d_l(&Ggx, view(n_dot_v), DVec3::Z, 0.1);
                figure(quantity, 0.5 * (p_l * 2.0 * PI * PI * sin_theta / Ggx.d(DVec3::Z, 0.1)).log2(), 0.0)
            };
            vec![
                offset("levels too coarse, v = n, equator", 1.0, 1.0),
                offset("levels too coarse, n·v 0.1, equator", 0.1, 1.0),
                offset("levels too coarse, v = n, sin θ 0.1", 1.0, 0.1),
            ]
        },
    },
    Slip {
        printed: "texel to direction: `(cos φ sin θ, sin φ sin θ, cos θ)`",
        right: "`(sin φ sin θ, cos θ, cos φ sin θ)`",
        figures: || {
            let printed = |uv: DVec2| {
                let (phi, theta) = (2.0 * PI * (0.5 - uv.x), PI * uv.y);
                DVec3::new(phi.cos() * theta.sin(), phi.sin() * theta.sin(), theta.cos())
            };
            // A rotation, so its angle follows from the trace.
            let trace: f64 =
                [DVec3::X, DVec3::Y, DVec3::Z].iter().map(|d| printed(uv_from_direction(*d)).dot(*d)).sum();
            vec![figure("rotation against its own uv, degrees", (0.5 * (trace - 1.0)).acos().to_degrees(), 0.0)]
        },
    },
    Slip {
        printed: "`pixel = Σ E Y`, stored as it is",
        right: "floored at 0: nine coefficients ring",
        figures: || {
            let lamp = basis(DVec3::Z).map(DVec3::splat);
            let at = |cosine: f64| irradiance(&lamp, view(cosine)).x;
            let least = (0..1000).map(|i| at(-f64::from(i) / 1000.0)).fold(f64::INFINITY, f64::min);
            vec![
                figure("irradiance of a point light, least beyond 90 degrees", least, 0.0),
                figure("the same at 90 degrees (the floor does not help)", at(0.0), 0.0),
                light("the same at the peak", at(1.0), 1.0),
            ]
        },
    },
    Slip {
        printed: "`C_linear = C_sRGB^2.2`",
        right: "the sRGB curve, which 2.2 approximates",
        figures: || {
            let off = |code: u8| {
                let decoded = (f64::from(code) / 255.0).powf(2.2);
                (f64::from(srgb_encode(decoded as f32)) * 255.0 - f64::from(code)).abs()
            };
            vec![figure("largest error, 8-bit steps", (0..=255).map(off).fold(0.0, f64::max), 0.0)]
        },
    },
    Slip {
        printed: "\"tone mapped the output color and converts it to linear color space\"",
        right: "to sRGB: the exponent is `c/2.2`",
        figures: || vec![light("display value of 0.5, contrast 1", 0.5f64.powf(2.2), 0.5f64.powf(1.0 / 2.2))],
    },
];

pub fn f_schlick(f0: f64, cosine: f64) -> f64 {
    brdf::f_schlick(DVec3::splat(f0), cosine).x
}

/// A specular term with F twice, for documents 0 and 1.
pub fn fresnel_twice() -> Vec<Figure> {
    let f = f_schlick(0.04, 1.0);
    vec![light("reflectance of a mirror, f0 0.04, v = n", f * f, f)]
}

/// What an estimator shows in a white furnace, at two widths and three views.
fn furnaces(printed: impl Fn(f64, f64) -> f64) -> Vec<Figure> {
    const CASES: [(&str, f64, f64); 6] = [
        ("albedo, alpha 0.1, n·v 0.1", 0.1, 0.1),
        ("albedo, alpha 0.1, n·v 0.5", 0.1, 0.5),
        ("albedo, alpha 0.1, n·v 1", 0.1, 1.0),
        ("albedo, alpha 0.5, n·v 0.1", 0.5, 0.1),
        ("albedo, alpha 0.5, n·v 0.5", 0.5, 0.5),
        ("albedo, alpha 0.5, n·v 1", 0.5, 1.0),
    ];
    CASES.map(|(quantity, alpha, n_dot_v)| light(quantity, printed(alpha, n_dot_v), albedo(alpha, n_dot_v))).to_vec()
}
