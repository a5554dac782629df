//! The slips of source document 1.

use super::document_0::{f_schlick, fresnel_twice};
use super::furnace::{SEPARABLE, albedo, albedo_with};
use super::{Slip, figure, light};
use crate::brdf::{Brdf, Ggx, MaskingShadowing, alpha_from_perceptual_roughness};
use crate::precompute::dfg::reference::dfg;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub const SLIPS: &[Slip] = &[
    Slip {
        printed: "`k_s DFG/(4 n·l n·v)`, k_s = F beside k_d = 1 - k_s",
        right: "`k_s = 1`: F is in DFG",
        figures: fresnel_twice,
    },
    Slip {
        printed: "mean as `1/N Σ` from 0 to N",
        right: "N terms: from 1 to N",
        figures: || vec![light("mean of 1, N = 40", 41.0 / 40.0, 1.0)],
    },
    Slip {
        printed: "`k_d c π/(n1 n2) Σ Σ L cos θ sin θ dφ dθ`",
        right: "without `dφ dθ` (the code is right)",
        figures: || {
            const STEPS: u32 = 100;
            let step = FRAC_PI_2 / f64::from(STEPS);
            let rows: f64 = (0..STEPS).map(|j| (f64::from(j) * step).cos() * (f64::from(j) * step).sin()).sum();
            let sum = PI / f64::from(STEPS) * rows;
            vec![light("E/π of radiance 1, 100 x 100 points", sum * step * TAU / f64::from(STEPS), sum)]
        },
    },
    Slip {
        printed: "`front = up.z < 0.999 ? z : -y`",
        right: "`abs(up.z) < 0.999`",
        figures: || {
            let up = DVec3::NEG_Z;
            let length = |front: DVec3| up.cross(front).length();
            vec![figure(
                "length of the cross product at up = -z, which is normalised",
                length(DVec3::Z),
                length(-DVec3::Y),
            )]
        },
    },
    Slip {
        printed: "texel (i, j) at `i/(w - 1) 2π`, `j/(h - 1) π`",
        right: "texel centres, `(i + 0.5)/w`, `(j + 0.5)/h`",
        figures: || {
            let theta = |rows: f64| (0.0 / (rows - 1.0) * PI).to_degrees();
            vec![
                figure("azimuth against the sampler's, w = 512, i = 0, degrees", (0.5 / 512.0) * 360.0, 0.0),
                figure("θ of a level of one row, degrees", theta(1.0), (0.5 * PI).to_degrees()),
            ]
        },
    },
    Slip {
        printed: "after (2): `F_0/N Σ G ... (1 - (1 - ω_o·n)^5)`",
        right: "`(1 - (1 - ω_o·h)^5)` (the code is right)",
        figures: || {
            let scale = |quantity, n_dot_v| {
                let pair = dfg(&Ggx, SEPARABLE, n_dot_v, 0.25);
                light(quantity, (1.0 - f_schlick(0.0, n_dot_v)) * pair.albedo(), pair.f0_scale)
            };
            vec![scale("A, alpha 0.25, n·v 0.1", 0.1), scale("A, alpha 0.25, n·v 0.5", 0.5)]
        },
    },
    Slip {
        printed: "table: `NdotV = i/(width - 1)`",
        right: "`(i + 0.5)/width`",
        figures: || {
            // The part G1(v)/n·v of the summed weight; the G1 of a view along the surface is 0.
            let quotient = |n_dot_v: f64| Ggx.g1(n_dot_v, 0.25) / n_dot_v;
            vec![figure("G1(v)/n·v in the first column, alpha 0.25, width 32", quotient(0.0), quotient(0.5 / 32.0))]
        },
    },
    Slip {
        printed: "`SetPixel(i, height - 1 - j)`, read at `(NdotV, roughness)`",
        right: "row j where row 0 is v = 0, as in Vulkan",
        figures: || {
            let at = |perceptual_roughness| albedo(alpha_from_perceptual_roughness(perceptual_roughness), 0.5);
            vec![light("albedo read, perceptual roughness 0.25, n·v 0.5", at(1.0 - 0.25), at(0.25))]
        },
    },
    Slip {
        printed: "`prefilteredColor (F A + B)`, F at n·v",
        right: "`f0 A + B`",
        figures: || {
            let pair = dfg(&Ggx, MaskingShadowing::Correlated, 0.1, 0.25);
            let with = |f: f64| f * pair.f0_scale + pair.f90_scale;
            vec![light(
                "second factor, f0 0.04, alpha 0.25, n·v 0.1, correlated",
                with(f_schlick(0.04, 0.1)),
                with(0.04),
            )]
        },
    },
    Slip {
        printed: "`MAX_REFLECTION_LOD = 10`",
        right: "level count - 1",
        figures: || {
            let held = |levels: f64| (0.5f64 * 10.0).min(levels - 1.0) / (levels - 1.0);
            vec![
                figure("perceptual roughness read for 0.5, 10 levels", held(10.0), 0.5),
                figure("perceptual roughness read for 0.5, 5 levels", held(5.0), 0.5),
            ]
        },
    },
    Slip {
        printed: "`G_Smith(roughness, ...)`, not defined; `k = (r + 1)²/8` in many copies, `k = alpha/2` at best",
        right: "exact Smith, or the same G on both sides",
        figures: || {
            let schlick = |cosine: f64, k: f64| cosine / (cosine * (1.0 - k) + k);
            let with = |alpha: f64, k: f64| albedo_with(alpha, 0.1, |n_dot_l| schlick(0.1, k) * schlick(n_dot_l, k));
            let analytic = (0.01f64.sqrt() + 1.0).powi(2) / 8.0;
            vec![
                light("albedo, k = (r + 1)²/8, alpha 0.01, n·v 0.1", with(0.01, analytic), albedo(0.01, 0.1)),
                light("albedo, k = alpha/2, alpha 0.01, n·v 0.1", with(0.01, 0.005), albedo(0.01, 0.1)),
                light("albedo, k = alpha/2, alpha 0.1, n·v 0.1", with(0.1, 0.05), albedo(0.1, 0.1)),
            ]
        },
    },
];
