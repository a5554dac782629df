//! The rungs of the ladder that look the prefiltered map up: the split sum with exact A and B. See `ladder`.

use super::Method;
use crate::brdf::reflect;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    lookups: 1,
    ..Method::plain(
        "ladder-texels",
        "the split sum with exact A and B: the prefiltered map as looked up",
        Twin::Estimator(|surface, light, _| {
            let albedo = light.albedos.exact(surface.n.dot(surface.v));
            let r = reflect(surface.v, surface.n);
            light.mean_radiance(r, surface.alpha) * (surface.f0 * albedo.x + albedo.y)
        }),
    )
};
