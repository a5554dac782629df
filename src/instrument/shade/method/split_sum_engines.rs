//! The shifted split sums of engines and a denoiser: lookups along `normalize(mix(n, r, t))`, with
//! t by n·v and alpha.

use super::Method;
use super::split_sum::shifted;
use crate::instrument::brdf::perceptual_roughness_from_alpha;
use crate::instrument::shade::twin::Twin;

/// `getSpecularDominantDirection` of Filament (`shaders/src/surface_light_indirect.fs`), by alpha.
pub const FILAMENT: Method = shifted(
    "split-sum-filament",
    "Split sum (Filament)",
    "Filament's shifted lookup: r to n by alpha^2",
    Twin::Estimator(|surface, light, _| {
        light.split_sum_between(surface, |_, alpha| 1.0 - alpha * alpha)
    }),
);

/// Frostbite's original [Lagarde14, listing 22]; also Bevy's `radiance_sample_direction`
/// (`light_probe/environment_map.wesl`, 2026).
pub const FROSTBITE: Method = shifted(
    "split-sum-frostbite",
    "Split sum (Frostbite)",
    "Frostbite's shifted lookup [Lagarde14, listing 22]; Bevy's, too",
    Twin::Estimator(|surface, light, _| {
        light.split_sum_between(surface, |_, alpha| share_of_r(alpha))
    }),
);

/// Returns Frostbite's share of r.
pub(super) fn share_of_r(alpha: f64) -> f64 {
    (1.0 - alpha) * ((1.0 - alpha).sqrt() + alpha)
}

/// three.js (`envmap_physical_pars_fragment.glsl.js`), copied by Godot
/// (`scene_forward_clustered.glsl`).
pub const GODOT: Method = shifted(
    "split-sum-godot",
    "Split sum (Godot)",
    "Godot's and three.js' shifted lookup: r to n by alpha",
    Twin::Estimator(|surface, light, _| light.split_sum_between(surface, |_, alpha| 1.0 - alpha)),
);

/// A fit to the peak of GGX with correlated masking [Lagarde14, listing 21], used by the denoiser
/// NRD to follow the reflected point (`_NRD_GetSpecularDominantFactor`, `NRD.hlsli`). Its roughness
/// is perceptual.
pub const NRD: Method = shifted(
    "split-sum-nrd",
    "Split sum (NRD)",
    "the shift of NRD: a fit over n.v and roughness [Lagarde14, listing 21]",
    Twin::Estimator(|surface, light, _| {
        light.split_sum_between(surface, |n_dot_v, alpha| {
            let k = 0.298475 * (39.4115 - 39.0029 * perceptual_roughness_from_alpha(alpha)).ln();
            // Rounding may leave n·v above 1.
            ((1.0 - n_dot_v).max(0.0).powf(10.8649) * (1.0 - k) + k).clamp(0.0, 1.0)
        })
    }),
);

/// `GetSpecularDominantDir` of Unity
/// (`com.unity.render-pipelines.core/ShaderLibrary/ImageBasedLighting.hlsl`): Frostbite's, bent
/// further to the normal at grazing views. The original is still there behind `USE_FB_DSD`.
pub const UNITY: Method = shifted(
    "split-sum-unity",
    "Split sum (Unity)",
    "the shifted lookup of Unity's high-definition pipeline",
    Twin::Estimator(|surface, light, _| {
        light.split_sum_between(surface, |n_dot_v, alpha| {
            let smoothness = 1.0 - alpha;
            (smoothness.sqrt() + alpha)
                * (smoothness * smoothness + smoothness * n_dot_v * n_dot_v).min(1.0)
        })
    }),
);
