//! Exact shading in f64: the integrals that every method of this stage approximates, with error bounds.
//!
//! For one point with normal n, view v and an environment's bilinear map L, over the l with `n_dot_l > 0`:
//!
//! - specular: `∫ f L n_dot_l dl`, `f n_dot_l = D(h) F(v·h) G2(v, l) / (4 n_dot_v)` [Walter07, eq. 20];
//! - diffuse of albedo 1: `1/π ∫ (1 - F(v·h)) L n_dot_l dl`; with `F = 0` it is Lambert's.
//!
//! Schlick's `F = f0 + (1 - f0) (1 - v·h)⁵` is linear in `f0`, so two integrals of each kind serve every `f0`.
//!
//! # The printed estimator of source document 0
//!
//! `1/N Σ_k F G1(v) G1(l_k) / (4 n_dot_v) L(l_k)`: the printed `G F / (4 (w_k·N)(V·N)) L(w_k) cos θ_k` with the sum's cosine read as
//! `w_k·N`, which cancels. Directions below the horizon add 0 and count in N. The directions `l_k` are drawn about the mirror direction
//! `r = 2 (n·v) n - v`, with uniform azimuth and the printed angle θ from r; for u = `xi.x` (0 at r) and the density over l:
//!
//! - GGX `tan θ = alpha √u / √(1 - u)` and Beckmann `tan² θ = -alpha² ln(1 - u)`: density `D(θ) cos θ`;
//! - Phong `cos θ = (1 - u)^(1/(exponent + 1))`, as printed: density `(exponent + 1)/(2π) cos^exponent θ`.
//!
//! G1 of GGX is the right one, `2/(1 + √(1 + alpha² tan²))`, not the misprint `1 + alpha² + tan²`. The sum converges to
//! [`seed0_literal`]. Its errors: `D` of the half vector is used as if it were the density of l, so a factor of about `1/(4 n_dot_v)`
//! is left over, and the lobe about r is half as wide as the one the half vectors make.

use crate::brdf::{Brdf, MaskingShadowing, Phong, exponent_from_alpha, g2, schlick_weight};
use crate::math::equirect_quadrature::{EquirectQuadrature, Focus};
use crate::math::frame::Frame;
use crate::math::quadrature::{Bounded, Tolerance};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// A point to shade. `n` and `v` are unit vectors in the environment's frame, `n·v > 0`; `alpha` is in (0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub model: &'static dyn Brdf,
    pub masking: MaskingShadowing,
    pub alpha: f64,
    /// Reflectance at normal incidence, linear RGB.
    pub f0: DVec3,
    pub n: DVec3,
    pub v: DVec3,
}

/// The exact answers for one [`Surface`]: outgoing radiance, linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Specular with F = 1.
    pub specular_white: Bounded,
    /// Specular with Schlick's F.
    pub specular: Bounded,
    /// Diffuse of albedo 1: irradiance over π.
    pub diffuse: Bounded,
    /// Diffuse of albedo 1 with the factor `1 - F(v·h)` in the integral.
    pub diffuse_transmitted: Bounded,
}

/// A relative error bound of 1e-5. True errors are a tenth to a thousandth of the bound.
pub const TOLERANCE: Tolerance = Tolerance { relative: 1e-5, max_part_count: 100_000 };

/// The mirror direction of `v` about `n`.
fn mirror(surface: &Surface) -> DVec3 {
    2.0 * surface.n.dot(surface.v) * surface.n - surface.v
}

/// The answers for many points, in parallel, in order.
pub fn integrate_all(environment: &EquirectQuadrature, surfaces: &[Surface], tolerance: Tolerance) -> Vec<Answer> {
    surfaces.par_iter().map(|surface| integrate(environment, surface, tolerance)).collect()
}

/// The answers for one point.
pub fn integrate(environment: &EquirectQuadrature, surface: &Surface, tolerance: Tolerance) -> Answer {
    let Surface { model, masking, alpha, f0, n, v } = *surface;
    let frame = Frame::from_normal(n);
    let v_local = frame.to_local(v);
    let specular_kernel = |l: DVec3| {
        let l_local = frame.to_local(l);
        if l_local.z <= 0.0 {
            return [0.0; 2];
        }
        let h = (v_local + l_local).normalize();
        let f = model.d(h, alpha) * g2(model, v_local.z, l_local.z, alpha, masking) / (4.0 * v_local.z);
        [f, f * schlick_weight(v_local.dot(h))]
    };
    let diffuse_kernel = |l: DVec3| {
        let n_dot_l = n.dot(l);
        if n_dot_l <= 0.0 {
            return [0.0; 2];
        }
        let f = n_dot_l / PI;
        [f, f * schlick_weight(v.dot((v + l).normalize()))]
    };
    // The lobe about the mirror direction is narrowest across the plane of incidence: 2 alpha (v·h).
    let focus = Focus { direction: mirror(surface), radius: alpha * v_local.z.max(alpha) };
    let specular = environment.integrate(specular_kernel, &[focus], tolerance);
    let diffuse = environment.integrate(diffuse_kernel, &[], tolerance);
    Answer {
        specular_white: specular.combine([DVec3::ONE, DVec3::ZERO]),
        specular: specular.combine([f0, DVec3::ONE - f0]),
        diffuse: diffuse.combine([DVec3::ONE, DVec3::ZERO]),
        diffuse_transmitted: diffuse.combine([DVec3::ONE - f0, f0 - DVec3::ONE]),
    }
}

/// What source document 0's printed estimator converges to (see the module's text), always with separable masking.
pub fn seed0_literal(environment: &EquirectQuadrature, surface: &Surface, tolerance: Tolerance) -> Bounded {
    let Surface { model, alpha, f0, n, v, .. } = *surface;
    let n_dot_v = n.dot(v);
    let r = mirror(surface);
    let lobe_frame = Frame::from_normal(r);
    let kernel = |l: DVec3| {
        let n_dot_l = n.dot(l);
        if n_dot_l <= 0.0 {
            return [0.0; 2];
        }
        let density = seed0_lobe_density(model, lobe_frame.to_local(l), alpha);
        let term = density * g2(model, n_dot_v, n_dot_l, alpha, MaskingShadowing::Separable) / (4.0 * n_dot_v);
        [term, term * schlick_weight(v.dot((v + l).normalize()))]
    };
    environment.integrate(kernel, &[Focus { direction: r, radius: alpha }], tolerance).combine([f0, DVec3::ONE - f0])
}

/// Density over l of the lobe of source document 0's printed angles; `l_lobe` is in the frame of the mirror direction.
fn seed0_lobe_density(model: &dyn Brdf, l_lobe: DVec3, alpha: f64) -> f64 {
    if model.name() == Phong.name() {
        // (exponent + 1)/(2π) cos^exponent: the printed power 1/(exponent + 1) leaves out the cosine that D's normalisation has.
        let exponent = exponent_from_alpha(alpha);
        (exponent + 1.0) / (exponent + 2.0) * model.d(l_lobe, alpha)
    } else {
        model.d(l_lobe, alpha) * l_lobe.z.max(0.0)
    }
}
