//! Importance sampling of D with N fixed points, each lookup filtered by its solid angle
//! [Colbert07, section 20.4].
//!
//! `1/N Σ_k f(v, l_k) n_dot_l_k / pdf_l(l_k) L(l_k, lod_k)`; m_k has density `D(m) n_dot_m` and
//! `l_k = reflect(-v, m_k)`. The level is `lod_k = 1/2 log2(omega_s / omega_p) + lod_bias`, with
//! `omega_s = 1/(N pdf_l)` the solid angle of the sample and `omega_p` of a texel of level 0.
//! Directions below the horizon add 0 but count in N.

use super::Method;
use crate::instrument::brdf::{Brdf, Widths, eval_without_fresnel, pdf_d_l, reflect};
use crate::instrument::environment::layout::lod_from_solid_angles;
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{Light, Samples, Twin};
use glam::{DVec2, DVec3};

pub const METHOD: Method = Method {
    uses_samples: true,
    uses_point_set: true,
    uses_lod_bias: true,
    ..Method::plain(
        "sampled",
        "Sampling",
        "per-pixel half-vector importance sampling, filtered by mip level",
        Twin::Estimator(|surface, light, samples| {
            estimate(surface, light, samples, Lookup::Filtered, BY_D)
        }),
    )
};

/// A half vector, and the density of the direction that mirrors the view about it.
pub(super) struct HalfVector {
    h: DVec3,
    pdf_l: f64,
}

/// Draws a half vector of a model for a point of the unit square, a view and widths.
type Sampler = fn(&dyn Brdf, DVec2, DVec3, Widths) -> HalfVector;

/// The map that a sample looks up.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Lookup {
    /// The environment's levels, by the solid angle of the sample.
    Filtered,
    /// The environment's finest level.
    Finest,
}

/// Half vectors of density `D n_dot_m`.
pub(super) const BY_D: Sampler = |model, xi, v_local, widths| {
    let h = widths.sample_d(model, xi);
    HalfVector {
        h,
        pdf_l: pdf_d_l(model, v_local, h, widths),
    }
};

/// Visible normals.
pub(super) const BY_VNDF: Sampler = |model, xi, v_local, widths| {
    let h = model.sample_vndf(xi, v_local, widths);
    HalfVector {
        h,
        pdf_l: model.pdf_vndf_l(v_local, h, widths),
    }
};

/// Computes the sum in the module's documentation.
pub(super) fn estimate(
    surface: &Surface,
    light: &Light,
    samples: &Samples,
    lookup: Lookup,
    draw: Sampler,
) -> DVec3 {
    let Surface {
        model,
        masking,
        f0,
        fresnel,
        v,
        ..
    } = *surface;
    let frame = surface.frame();
    let widths = surface.widths();
    let v_local = frame.to_local(v);
    let count = f64::from(samples.count);
    let term = |xi| {
        let HalfVector { h, pdf_l } = draw(model, xi, v_local, widths);
        let l_local = reflect(v_local, h);
        if l_local.z <= 0.0 || v_local.dot(h) <= 0.0 {
            return DVec3::ZERO;
        }
        let l = frame.to_world(l_local);
        let radiance = match lookup {
            Lookup::Filtered => {
                let omega_s = 1.0 / (count * pdf_l);
                let lod =
                    lod_from_solid_angles(omega_s, light.filtered.texel_solid_angle(l, omega_s));
                light.filtered.value(l, lod + samples.lod_bias)
            }
            Lookup::Finest => light.radiance(l, 0.0),
        };
        let reflected = f0 + (1.0 - f0) * fresnel.at(v_local.dot(h));
        let lobe = eval_without_fresnel(model, v_local, l_local, widths, masking);
        radiance * reflected * (lobe * l_local.z / pdf_l)
    };
    samples.points().map(term).sum::<DVec3>() / count
}
