//! Direct lights in f64: the sums that `shaders/shade/lights.comp` computes.

use super::reference::Surface;
use crate::instrument::brdf::f_schlick;
use crate::instrument::scene::Light;
use crate::instrument::scene::light::Arrival;
use glam::DVec3;
use std::f64::consts::PI;

/// Returns the specular radiance of a surface at `place` under lights, linear RGB: `Σ f n·l E`.
/// Lights and surface are in one frame.
pub fn specular(surface: &Surface, place: DVec3, lights: &[Light]) -> DVec3 {
    let frame = surface.frame();
    let widths = surface.widths();
    let v = frame.to_local(surface.v);
    let reflected = |light: &Light| {
        let Arrival { l, irradiance } = light.at(place);
        let l = frame.to_local(l);
        let lobe = widths.lobe(surface.model, v, l, surface.masking);
        let fresnel = f_schlick(surface.f0, v.dot((v + l).normalize()));
        irradiance * fresnel * lobe
    };
    lights.iter().map(reflected).sum()
}

/// Returns the diffuse radiance of albedo 1 under lights, linear RGB: `Σ n·l E / π`.
pub fn diffuse(n: DVec3, place: DVec3, lights: &[Light]) -> DVec3 {
    weighted_diffuse(n, place, lights, |_| DVec3::ONE)
}

/// The same with a factor of the unit vector to each light.
pub fn weighted_diffuse(
    n: DVec3,
    place: DVec3,
    lights: &[Light],
    factor: impl Fn(DVec3) -> DVec3,
) -> DVec3 {
    let reflected = |light: &Light| {
        let Arrival { l, irradiance } = light.at(place);
        factor(l) * irradiance * (n.dot(l).max(0.0) / PI)
    };
    lights.iter().map(reflected).sum()
}
