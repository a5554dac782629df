//! The rungs between the specular integral and the split sum: each replaces one exact step by its
//! approximation; docs/estimators.md ("The ladder") has the estimator of each.
//!
//! The last step, to `split-sum`, replaces A and B by the DFG table. The passes of the reference
//! estimate `ladder-fresnel` to `ladder-levels` with standard errors. They draw the same points, so
//! differences are far more precise than either rung.

use super::Method;
use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::frame::Frame;
use crate::base::math::quadrature::{Bounded, Tolerance};
use crate::instrument::brdf::{g2, reflect, schlick_weight};
use crate::instrument::precompute::dfg::reference::{Dfg, EXACT, dfg, weight_means};
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::precompute::prefilter::reference::prefilter;
use crate::instrument::precompute::{PrecomputeSettings, PrefilterBy, StorageFormat};
use crate::instrument::shade::EXACT_SPLIT;
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{SpecularTwin, Twin};
use glam::DVec3;

/// A rung estimated by the passes of the reference.
const fn rung(
    name: &'static str,
    title: &'static str,
    about: &'static str,
    twin: SpecularTwin,
) -> Method {
    Method {
        uses_samples: true,
        lobe: Some(name),
        ..Method::plain(name, title, about, twin)
    }
}

const fn weighted(rung: Method) -> Method {
    Method {
        uses_weight: true,
        ..rung
    }
}

pub const FRESNEL: Method = rung(
    "ladder-fresnel",
    "Ladder: Fresnel",
    "the reference with Fresnel outside the integral",
    Twin::Mean(|environment, surface, _, tolerance| {
        let Surface {
            model,
            masking,
            alpha,
            n,
            v,
            ..
        } = *surface;
        let frame = Frame::from_normal(n);
        let exact = exact_albedo(surface);
        let v_local = frame.to_local(v);
        let kernel = |l: DVec3| {
            let l_local = frame.to_local(l);
            let h = (v_local + l_local).normalize();
            if l_local.z <= 0.0 {
                return [0.0];
            }
            let g2 = g2(model, v_local.z, l_local.z, alpha, masking);
            [model.d(h, alpha) * g2 / (4.0 * v_local.z)]
        };
        let factor = reflectance(surface, &exact) / exact.albedo();
        surface
            .focused(|focus| environment.integrate(kernel, Some(focus), tolerance))
            .combine([factor])
    }),
);

pub const MASKING: Method = weighted(rung(
    "ladder-masking",
    "Ladder: masking",
    "as ladder-fresnel, with the weight of prefiltered maps (n.l) for the masking",
    Twin::Mean(|environment, surface, settings, tolerance| {
        unmasked(environment, surface, settings, tolerance, DVec3::ONE)
    }),
));

/// Masking approximated before Fresnel. Not a rung.
pub const MASKING_ALONE: Method = weighted(rung(
    "ladder-masking-alone",
    "Ladder: masking alone",
    "the reference with the weight of prefiltered maps (n.l) for the masking, and its own albedo",
    Twin::Mean(|environment, surface, settings, tolerance| {
        unmasked(environment, surface, settings, tolerance, surface.f0)
    }),
));

/// `(f0 A + B) <K F, L>` with `K = D n·h / (4 v·h) w(l)` and F of reflectance `inside`: 1 for `<K,
/// L>`.
fn unmasked(
    environment: &EquirectQuadrature,
    surface: &Surface,
    settings: &PrecomputeSettings,
    tolerance: Tolerance,
    inside: DVec3,
) -> Bounded {
    let Surface { alpha, n, v, .. } = *surface;
    let frame = Frame::from_normal(n);
    let kernel = kernel(surface, settings);
    let v_local = frame.to_local(v);
    let value = |l: DVec3| {
        let l_local = frame.to_local(l);
        let h = (v_local + l_local).normalize();
        let v_dot_h = v_local.dot(h);
        let weight = kernel.weight(alpha, l_local.z);
        if weight == 0.0 {
            return [0.0; 2];
        }
        let value = kernel.brdf.d(h, alpha) * h.z / (4.0 * v_dot_h) * weight;
        let fc = schlick_weight(v_dot_h);
        [value * (1.0 - fc), value * fc]
    };
    let [below, grazing] = weight_means(kernel, v_local.z, alpha, EXACT);
    let factor = reflectance(surface, &exact_albedo(surface)) / (inside * below + grazing);
    let means = surface.focused(|focus| environment.integrate(value, Some(focus), tolerance));
    means.combine([inside * factor, factor])
}

pub const VIEW: Method = weighted(rung(
    EXACT_SPLIT,
    "Ladder: view",
    "as ladder-masking for n = v = r: the split sum with exact factors",
    Twin::Mean(|environment, surface, settings, tolerance| {
        let r = reflect(surface.v, surface.n);
        let mean = prefilter(
            environment,
            kernel(surface, settings),
            surface.alpha,
            r,
            tolerance,
        );
        scaled(mean, reflectance(surface, &exact_albedo(surface)))
    }),
));

pub const LEVELS: Method = Method {
    uses_levels: true,
    ..weighted(rung(
        "ladder-levels",
        "Ladder: levels",
        "as ladder-view, blended from the widths of the prefiltered map's levels",
        Twin::Mean(|environment, surface, settings, tolerance| {
            let scale = reflectance(surface, &exact_albedo(surface));
            scaled(blended(environment, surface, settings, tolerance), scale)
        }),
    ))
};

/// Returns the mean radiance about r, blended from two levels.
fn blended(
    environment: &EquirectQuadrature,
    surface: &Surface,
    settings: &PrecomputeSettings,
    tolerance: Tolerance,
) -> Bounded {
    let count = settings.prefilter_level_count;
    let r = reflect(surface.v, surface.n);
    let mapping = settings.level_mapping;
    let mip = mapping.mip_from_alpha(surface.alpha, count);
    let low = mip.floor().min(f64::from(count) - 2.0);
    let level = |mip: f64, share: f64| {
        let alpha = mapping.alpha_from_mip(mip, count);
        if alpha == 0.0 {
            return Bounded {
                value: share * environment.radiance(r),
                error: DVec3::ZERO,
            };
        }
        let mean = prefilter(environment, kernel(surface, settings), alpha, r, tolerance);
        scaled(mean, DVec3::splat(share))
    };
    let smooth = level(low, low + 1.0 - mip);
    let rough = level(low + 1.0, mip - low);
    Bounded {
        value: smooth.value + rough.value,
        error: smooth.error + rough.error,
    }
}

/// Returns the kernel of a prefiltered map with these settings.
fn kernel(surface: &Surface, settings: &PrecomputeSettings) -> Kernel {
    Kernel::new(surface.model, settings.prefilter_weight, surface.masking)
}

fn exact_albedo(surface: &Surface) -> Dfg {
    dfg(
        surface.model,
        surface.masking,
        surface.n.dot(surface.v),
        surface.alpha,
    )
}

/// `f0 A + B`.
fn reflectance(surface: &Surface, exact: &Dfg) -> DVec3 {
    surface.f0 * exact.f0_scale + exact.f90_scale
}

fn scaled(number: Bounded, factor: DVec3) -> Bounded {
    Bounded {
        value: number.value * factor,
        error: number.error * factor.abs(),
    }
}

/// A rung that reads a map made for it.
const fn looked_up(name: &'static str, title: &'static str, about: &'static str) -> Method {
    let twin: SpecularTwin = Twin::Estimator(|surface, light, _| {
        let albedo = light.albedos.exact(surface.n.dot(surface.v));
        let r = reflect(surface.v, surface.n);
        light.mean_radiance(r, surface.alpha) * (surface.f0 * albedo.x + albedo.y)
    });
    Method {
        lookups: 1,
        ..Method::plain(name, title, about, twin)
    }
}

pub const TEXELS: Method = Method {
    prefilter: Some(PrefilterBy::Harmonic),
    storage: Some(StorageFormat::F32),
    ..looked_up(
        "ladder-texels",
        "Ladder: texels",
        "the split sum with exact A and B and a prefiltered map of exact texels",
    )
};

/// Texels as they are made.
pub const SAMPLES: Method = Method {
    storage: Some(StorageFormat::F32),
    ..looked_up(
        "ladder-samples",
        "Ladder: samples",
        "as ladder-texels, with texels as the setting prefilter makes them",
    )
};

/// Texels as they are stored. Only A and B are exact.
pub const STORAGE: Method = looked_up(
    "ladder-storage",
    "Ladder: storage",
    "as ladder-samples, with texels in the numbers of storage_format; A and B are exact",
);
