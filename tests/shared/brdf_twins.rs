//! f64 twins of functions of `shaders/brdf` and `shaders/lib/compensation.glsl`.
#![allow(dead_code, reason = "each test program uses a part")]

use glam::{DVec2, DVec3};
use splitsum::base::math::sampling::direction_from_polar;
use splitsum::instrument::brdf::{Compensation, FresnelWeight, Ggx, Widths};

/// Samples visible normals of GGX by spherical caps, for every model: the normals of the visible
/// half sphere are the half vectors of the cap that `v` reflects into \[Dupuy23\]. `xi.x = 0` is
/// the cap's centre.
pub fn sample_visible(xi: DVec2, v_local: DVec3, widths: Widths) -> DVec3 {
    let v_hemisphere = stretched(v_local, widths).normalize();
    let z = (1.0 - xi.x) * (1.0 + v_hemisphere.z) - v_hemisphere.z;
    let cap = direction_from_polar((1.0 - z * z).max(0.0).sqrt(), z, xi.y);
    let h = cap + v_hemisphere;
    stretched(h.truncate().extend(h.z.max(0.0)), widths).normalize()
}

fn stretched(w_local: DVec3, widths: Widths) -> DVec3 {
    (widths.0 * w_local.truncate()).extend(w_local.z)
}

/// Density per solid angle of `l = reflect(-v, h)` under [`sample_visible`]: `G1(v) D / (4
/// n_dot_v)`.
pub fn pdf_visible_l(v_local: DVec3, h_local: DVec3, widths: Widths) -> f64 {
    if v_local.dot(h_local) <= 0.0 {
        return 0.0;
    }
    // n_dot_v / G1(v), regular at n_dot_v = 0.
    let area = 0.5 * (v_local.z + stretched(v_local, widths).length());
    widths.d(&Ggx, h_local) / (4.0 * area)
}

/// The mean of a reflectance over cosines.
fn mean_fresnel(f0: DVec3, fresnel: FresnelWeight) -> DVec3 {
    f0 + (1.0 - f0) * fresnel.mean()
}

/// Returns the factor of single scattering.
pub fn factor(
    compensation: Compensation,
    fresnel: FresnelWeight,
    f0: DVec3,
    pair: DVec2,
    mean_albedo: f64,
) -> DVec3 {
    let lost = 1.0 / pair.element_sum() - 1.0;
    match compensation {
        Compensation::Turquin => 1.0 + f0 * lost,
        Compensation::Cycles => {
            // The sum over bounces between facets: each reflects `mean_albedo` out, the rest again.
            let average = mean_fresnel(f0, fresnel);
            1.0 + lost * average * mean_albedo / (1.0 - average * (1.0 - mean_albedo))
        }
        _ => DVec3::ONE,
    }
}

/// Returns the added share of irradiance over π, or of the compensation's own lobe.
pub fn multiple(
    compensation: Compensation,
    fresnel: FresnelWeight,
    f0: DVec3,
    pair: DVec2,
    mean_albedo: f64,
) -> DVec3 {
    // Fitted masking may reflect more than it receives: nothing is lost then.
    let lost = (1.0 - pair.element_sum()).max(0.0);
    let average = mean_fresnel(f0, fresnel);
    match compensation {
        Compensation::FdezAguera => {
            lost * (f0 * pair.x + pair.y) * average / (1.0 - average * lost)
        }
        Compensation::KullaConty => {
            lost * average * average * mean_albedo / (1.0 - average * (1.0 - mean_albedo).max(0.0))
        }
        _ => DVec3::ZERO,
    }
}

/// Returns the albedo of the whole specular term: its reflection of constant radiance 1.
pub fn reflectance(
    compensation: Compensation,
    fresnel: FresnelWeight,
    f0: DVec3,
    pair: DVec2,
    mean_albedo: f64,
) -> DVec3 {
    (f0 * pair.x + pair.y) * factor(compensation, fresnel, f0, pair, mean_albedo)
        + multiple(compensation, fresnel, f0, pair, mean_albedo)
}
