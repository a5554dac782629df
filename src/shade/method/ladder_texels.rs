//! The rungs of the ladder that look the prefiltered map up: the split sum with exact A and B. See `ladder`.

use super::Method;
use crate::brdf::reflect;
use crate::precompute::{PrefilterBy, StorageFormat};
use crate::shade::twin::{SpecularTwin, Twin};

/// A rung by a map of its own.
const fn rung(name: &'static str, about: &'static str) -> Method {
    let twin: SpecularTwin = Twin::Estimator(|surface, light, _| {
        let albedo = light.albedos.exact(surface.n.dot(surface.v));
        let r = reflect(surface.v, surface.n);
        light.mean_radiance(r, surface.alpha) * (surface.f0 * albedo.x + albedo.y)
    });
    Method { lookups: 1, ..Method::plain(name, about, twin) }
}

pub const TEXELS: Method = Method {
    prefilter: Some(PrefilterBy::Harmonic),
    storage: Some(StorageFormat::F32),
    ..rung("ladder-texels", "the split sum with exact A and B and a prefiltered map of exact texels")
};

/// Texels as they are made.
pub const SAMPLES: Method = Method {
    storage: Some(StorageFormat::F32),
    ..rung("ladder-samples", "as ladder-texels, with texels as the setting prefilter makes them")
};

/// Texels as they are kept. Only A and B are still exact.
pub const STORAGE: Method =
    rung("ladder-storage", "as ladder-samples, with texels in the numbers of storage_format; A and B are exact");
