//! Split sums of an anisotropic lobe by several lookups along its tangent, without a table.
//!
//! Unstretched by the two widths, the normals that a view sees are the half vectors between v' and
//! the points of a cap about n \[Dupuy23\]. Of a sphere cut across an axis, slices of equal height
//! have equal areas, so N strips of the cap across the tangent hold about equal shares of the lobe.
//! Each is looked up about the mean normal of its strip, at the width of the strip, and counts by
//! n·l. The three constants were found by trial over four alphas, three strengths and three maps.

use super::Method;
use super::split_sum::several;
use crate::base::glsl::constants::{
    ALPHA_MIN, COSINE_MIN, STRIP_BREADTH, STRIP_LENGTH, STRIP_REACH, TILT_MIN,
};
use crate::base::math::frame::Frame;
use crate::instrument::brdf::{Widths, reflect};
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{Light, Twin};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_2_PI;

pub const TWO: Method = several(
    2,
    "split-sum-strips-two",
    "Split sum (two strips)",
    "an anisotropic lobe by two lookups along its tangent",
    Twin::Estimator(|surface, light, _| split_sum(surface, light, 2)),
);

pub const FOUR: Method = several(
    4,
    "split-sum-strips-four",
    "Split sum (four strips)",
    "an anisotropic lobe by four lookups along its tangent",
    Twin::Estimator(|surface, light, _| split_sum(surface, light, 4)),
);

/// Computes `Σ n·l P(l, alpha) / Σ n·l (f0 A + B)`. A lobe of one width is cut along the plane of
/// incidence.
fn split_sum(surface: &Surface, light: &Light, count: u32) -> DVec3 {
    let Widths(widths) = surface.widths();
    let across = surface.v.reject_from_normalized(surface.n);
    let along = (across.length() > f64::from(TILT_MIN)).then(|| across.normalize());
    let frame = match (surface.stretch, along) {
        (None, Some(along)) => Frame::from_tangent(surface.n, along),
        _ => surface.frame(),
    };
    let v = frame.to_local(surface.v);
    let standard = (widths * v.truncate()).extend(v.z).normalize();
    let count = f64::from(count);
    let extent = DVec2::new(f64::from(STRIP_LENGTH) / count, STRIP_BREADTH.into()) * widths;
    let alpha = (0.5 * extent.length_squared())
        .sqrt()
        .clamp(ALPHA_MIN.into(), 1.0);
    let mut sum = DVec3::ZERO;
    let mut weights = 0.0;
    for i in 0..count as u32 {
        let x = f64::from(STRIP_REACH) * ((2.0 * f64::from(i) + 1.0) / count - 1.0);
        let z = FRAC_2_PI * (1.0 - standard.z) * (1.0 - x * x).sqrt();
        let normal = (widths * (DVec2::new(x, 0.0) + standard.truncate()))
            .extend(z + standard.z)
            .normalize();
        let direction = reflect(v, normal).normalize();
        let weight = direction.z.max(COSINE_MIN.into());
        sum += weight * light.mean_radiance(frame.to_world(direction), alpha);
        weights += weight;
    }
    let pair = light.dfg(v.z, surface.alpha);
    sum / weights * (surface.f0 * pair.x + pair.y)
}
