//! The split sums of engines whose factors are not `F0 A + B`, as pictures of the engines confirm
//! (`results/engines`). All look up along r.

use super::Method;
use super::split_sum::{several, shifted};
use crate::instrument::brdf::{perceptual_roughness_from_alpha, reflect, schlick_weight};
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{Light, Twin};
use glam::DVec3;

/// VTK raises F0 by a Fresnel factor of n·v before the table, which has that factor too (k_S in
/// `vtkOpenGLPolyDataMapper::ReplaceShaderLight`, 9.7.1, after the listing of \[FdezAguera19\]).
pub const VTK: Method = Method {
    has_other_factor: true,
    ..shifted(
        "split-sum-vtk",
        "Split sum (VTK)",
        "VTK's, PyVista's and F3D's: along r, with Fresnel's factor twice",
        Twin::Estimator(|surface, light, _| {
            let roughness = perceptual_roughness_from_alpha(surface.alpha);
            let raised = towards(surface, surface.f0.max(DVec3::splat(1.0 - roughness)));
            let pair = light.dfg(surface.n.dot(surface.v), surface.alpha);
            mirrored(surface, light) * (raised * pair.x + pair.y)
        }),
    )
};

/// PlayCanvas has neither a table nor masking: Schlick's factor at n·v alone, which rises to the
/// largest channel of F0 times gloss² (`fresnelSchlick.js`, 2.23.3). So a grey surface reflects F0
/// at every angle.
pub const PLAYCANVAS: Method = Method {
    uses_dfg: false,
    has_other_factor: true,
    ..shifted(
        "split-sum-playcanvas",
        "Split sum (PlayCanvas)",
        "PlayCanvas': along r, with Fresnel's factor at n.v in place of the table",
        Twin::Estimator(|surface, light, _| {
            let gloss = 1.0 - perceptual_roughness_from_alpha(surface.alpha);
            let most = DVec3::splat(gloss * gloss * surface.f0.max_element());
            mirrored(surface, light) * towards(surface, surface.f0.max(most))
        }),
    )
};

/// Babylon.js mixes its lookup with irradiance by alpha (`MIX_IBL_RADIANCE_WITH_IRRADIANCE` of
/// `pbrBlockReflection`, 9.35.0, on by default). The level of roughness 1 is irradiance over π.
pub const BABYLON: Method = several(
    2,
    "split-sum-babylon",
    "Split sum (Babylon.js)",
    "Babylon.js': along r, mixed with irradiance by alpha",
    Twin::Estimator(|surface, light, _| {
        let irradiance = light.mean_radiance(surface.n, 1.0);
        let pair = light.dfg(surface.n.dot(surface.v), surface.alpha);
        mirrored(surface, light).lerp(irradiance, surface.alpha) * (surface.f0 * pair.x + pair.y)
    }),
);

/// Returns the prefiltered radiance along r.
fn mirrored(surface: &Surface, light: &Light) -> DVec3 {
    light.mean_radiance(reflect(surface.v, surface.n), surface.alpha)
}

/// Returns Schlick's factor at n·v with this reflectance at grazing views.
fn towards(surface: &Surface, f90: DVec3) -> DVec3 {
    surface
        .f0
        .lerp(f90, schlick_weight(surface.n.dot(surface.v)))
}
