//! Means over a lobe, for estimators that are not right.

use crate::brdf::{Brdf, Ggx, MaskingShadowing, reflect};
use crate::math::sampling::hammersley;
use crate::precompute::dfg::reference::dfg;
use glam::DVec3;

pub const SEPARABLE: MaskingShadowing = MaskingShadowing::Separable;

/// The view at a cosine to n = +z.
pub fn view(n_dot_v: f64) -> DVec3 {
    DVec3::new(((1.0 - n_dot_v) * (1.0 + n_dot_v)).sqrt(), 0.0, n_dot_v)
}

/// Mean of `f(m, l)` over half vectors m of density `D n_dot_h`, `l = reflect(-v, m)`; 0 for l below the horizon. Within about 1e-4.
pub fn mean(model: &dyn Brdf, alpha: f64, n_dot_v: f64, f: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    const COUNT: u32 = 1 << 17;
    // Light along the horizon has quotients 0/0.
    const HORIZON: f64 = 1e-9;
    let v = view(n_dot_v);
    let sum: f64 = (0..COUNT)
        .map(|i| {
            let m = model.sample_d(hammersley(i, COUNT), alpha);
            let l = reflect(v, m);
            if l.z > HORIZON { f(m, l) } else { 0.0 }
        })
        .sum();
    sum / f64::from(COUNT)
}

/// Directional albedo with another masking-shadowing `g2(n_dot_l)`: the mean of `G2 v·m / (n·v n·m)`.
pub fn albedo_with(alpha: f64, n_dot_v: f64, g2: impl Fn(f64) -> f64) -> f64 {
    let v = view(n_dot_v);
    mean(&Ggx, alpha, n_dot_v, |m, l| g2(l.z) * v.dot(m) / (n_dot_v * m.z))
}

/// Directional albedo of GGX with separable masking.
pub fn albedo(alpha: f64, n_dot_v: f64) -> f64 {
    dfg(&Ggx, SEPARABLE, n_dot_v, alpha).albedo()
}
