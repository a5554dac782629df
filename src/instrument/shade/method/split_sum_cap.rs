//! The split sum about the mean visible normal, in closed form.

use super::Method;
use super::split_sum::shifted;
use super::split_sum_engines::share_of_r;
use crate::instrument::brdf::reflect;
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::Twin;
use glam::DVec3;

/// `a = alpha`, along the mirror direction about the mean visible normal. Unstretched by alpha,
/// visible normals are the half vectors between v' and the points of a cap about n \[Dupuy23\]; the
/// mean of the cap is `(1 - v'_z)/2` along n. Two terms are measured, not derived. The horizon and
/// shadowing, which are left out, matter to wide lobes: these go over to Frostbite's direction. The
/// part of weight Fc is the lobe's side by the horizon: its share draws the direction to r, for
/// narrow lobes less.
pub const METHOD: Method = Method {
    is_corrected: true,
    ..shifted(
        "split-sum-cap",
        "Split sum (cap)",
        "the split sum about the mean visible normal, in closed form",
        Twin::Estimator(|surface, light, _| {
            let Surface { n, v, alpha, .. } = *surface;
            let share = light.share_of_f90(surface) * (alpha / NARROW_ALPHA).min(1.0);
            let direction = cap_direction(n, v, alpha).lerp(reflect(v, n), share);
            light.split_sum(surface, direction.normalize(), alpha)
        }),
    )
};

/// Up to this alpha the direction is the mirror direction about the mean visible normal, and from
/// it on the share of Fc counts fully.
const NARROW_ALPHA: f64 = 0.4;
/// From this alpha on the direction is Frostbite's.
const WIDE_ALPHA: f64 = 0.8;

/// Returns the unit direction of the part of weight 1.
fn cap_direction(n: DVec3, v: DVec3, alpha: f64) -> DVec3 {
    let n_dot_v = n.dot(v);
    let tangential = v - n_dot_v * n;
    let stretched = (alpha * alpha * tangential.length_squared() + n_dot_v * n_dot_v).sqrt();
    let normal = (alpha * alpha / stretched * tangential + 0.5 * (1.0 + n_dot_v / stretched) * n)
        .normalize();
    let wide = n.lerp(reflect(v, n), share_of_r(alpha)).normalize();
    reflect(v, normal)
        .lerp(
            wide,
            ((alpha - NARROW_ALPHA) / (WIDE_ALPHA - NARROW_ALPHA)).clamp(0.0, 1.0),
        )
        .normalize()
}
