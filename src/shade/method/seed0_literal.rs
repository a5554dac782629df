//! The estimator that source document 0 prints, to show what its slips cost.
//!
//! `1/N Σ_k F G1(v) G1(l_k) / (4 n_dot_v) L(l_k)`: the printed `G F / (4 (w_k·N)(V·N)) L(w_k) cos θ_k` with the sum's cosine read as
//! `w_k·N`, which cancels. Directions below the horizon add 0 and count in N. The directions `l_k` are drawn about the mirror direction
//! `r = 2 (n·v) n - v`, with uniform azimuth and the printed angle θ from r; for u = `xi.x` (0 at r) and the density over l:
//!
//! - GGX `tan θ = alpha √u / √(1 - u)` and Beckmann `tan² θ = -alpha² ln(1 - u)`: density `D(θ) cos θ`;
//! - Phong `cos θ = (1 - u)^(1/(exponent + 1))`, as printed: density `(exponent + 1)/(2π) cos^exponent θ`.
//!
//! That of Phong is `D(θ) cos θ` of an exponent less by one, so [`lobe_alpha`] is all that models differ in. A model that the document
//! does not have is drawn as GGX and Beckmann are.
//!
//! The level of each lookup is `1/2 (log2(W H / N) - log2 D(h))`, h the half vector of v and l, and the coarsest one where D is 0.
//!
//! G1 of GGX is the right one, `2/(1 + √(1 + alpha² tan²))`, not the misprint `1 + alpha² + tan²`. The sum converges to [`limit`]. Its
//! errors: `D` of the half vector is used as if it were the density of l, so a factor of about `1/(4 n_dot_v)` is left over, and
//! the lobe about r is half as wide as the one the half vectors make.

use super::Method;
use crate::brdf::{
    Brdf, MaskingShadowing, Phong, alpha_from_exponent, exponent_from_alpha, f_schlick, g2, reflect, schlick_weight,
};
use crate::math::equirect_quadrature::{EquirectQuadrature, Focus};
use crate::math::frame::Frame;
use crate::math::quadrature::{Bounded, Tolerance};
use crate::shade::reference::Surface;
use crate::shade::twin::{Light, Samples, Twin};
use glam::DVec3;

pub const METHOD: Method = Method {
    uses_samples: true,
    uses_point_set: true,
    ..Method::plain(
        "seed0-literal",
        "source document 0's estimator as printed, but for the misprinted G of GGX, to show what its slips cost",
        Twin::Estimator(estimate),
    )
};

/// Width of the lobe of `model` that the document's angles make; that of Phong is above `alpha`, at most √2.
pub fn lobe_alpha(model: &dyn Brdf, alpha: f64) -> f64 {
    if model.name() == Phong.name() { alpha_from_exponent(exponent_from_alpha(alpha) - 1.0) } else { alpha }
}

fn estimate(surface: &Surface, light: &Light, samples: &Samples) -> DVec3 {
    let Surface { model, masking, alpha, f0, n, v } = *surface;
    let [width, height] = light.environment_size().map(f64::from);
    let frame = Frame::from_normal(n);
    let v_local = frame.to_local(v);
    let (lobe_frame, lobe_alpha) = (Frame::from_normal(reflect(v, n)), lobe_alpha(model, alpha));
    let count = f64::from(samples.count);
    let term = |xi| {
        let l = lobe_frame.to_world(model.sample_d(xi, lobe_alpha));
        let l_local = frame.to_local(l);
        let h = (v_local + l_local).normalize();
        // Infinite where D is 0: the coarsest level.
        let lod = 0.5 * (width * height / (count * model.d(h, alpha))).log2();
        let g = g2(model, v_local.z, l_local.z, alpha, masking);
        light.radiance(l, lod) * f_schlick(f0, v_local.dot(h)) * g
    };
    samples.points().map(term).sum::<DVec3>() / (4.0 * count * v_local.z)
}

/// What the estimator converges to, always with separable masking.
pub fn limit(environment: &EquirectQuadrature, surface: &Surface, tolerance: Tolerance) -> Bounded {
    let Surface { model, alpha, f0, n, v, .. } = *surface;
    let n_dot_v = n.dot(v);
    let r = reflect(v, n);
    let (lobe_frame, lobe_alpha) = (Frame::from_normal(r), lobe_alpha(model, alpha));
    let kernel = |l: DVec3| {
        let n_dot_l = n.dot(l);
        if n_dot_l <= 0.0 {
            return [0.0; 2];
        }
        let l_lobe = lobe_frame.to_local(l);
        let density = model.d(l_lobe, lobe_alpha) * l_lobe.z.max(0.0);
        let term = density * g2(model, n_dot_v, n_dot_l, alpha, MaskingShadowing::Separable) / (4.0 * n_dot_v);
        [term, term * schlick_weight(v.dot((v + l).normalize()))]
    };
    environment.integrate(kernel, &[Focus { direction: r, radius: alpha }], tolerance).combine([f0, DVec3::ONE - f0])
}
