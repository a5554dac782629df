//! f64 twins of functions of `shaders/lib/compensation.glsl`.
#![allow(dead_code, reason = "each test program uses a part")]

use glam::{DVec2, DVec3};
use splitsum::instrument::brdf::{Compensation, FresnelWeight};

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
