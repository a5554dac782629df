//! The estimator as source document 0 prints it \[Kim22\]: shows what its slips do, and is in no
//! recommendation.
//!
//! `1/N Σ_k F G / (4 (w_k·n) (v·n)) L(w_k) cos θ_k`, with `cos θ_k` read as `w_k·n`, which cancels.
//! The w_k have uniform azimuths about the mirror direction, and to it the angles that the model's
//! half vectors have to n; Phong's are of [`printed_lobe_alpha`]. Directions below the horizon
//! add 0 and count in N. The level of a lookup is `1/2 (log2(W H/N) - log2 D(h))`, h the half
//! vector of v and w_k; the coarsest one where D is 0.
//!
//! It does not converge to the specular integral: it divides by D(h), which is not the density of
//! w_k, and its lobe is half as wide. One slip is left out: the printed G of GGX
//! (docs/source-documents.md).

use super::Method;
use crate::base::math::frame::Frame;
use crate::instrument::brdf::{Brdf, Phong, f_schlick, g2, reflect};
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{Light, Samples, Twin};
use glam::DVec3;

pub const METHOD: Method = Method {
    uses_samples: true,
    uses_point_set: true,
    is_as_printed: true,
    ..Method::plain(
        "printed-document-0",
        "Document 0 as printed",
        "source document 0's estimator with its slips, to show what they do",
        Twin::Estimator(estimate),
    )
};

/// Returns the width of the lobe of the document's angles. Phong's `cos θ = ξ^(1/(a + 1))` is drawn
/// by an exponent less by one, which is a width up to √2; the other models' angles are their own.
pub fn printed_lobe_alpha(model: &dyn Brdf, alpha: f64) -> f64 {
    if model.name() == Phong.name() {
        alpha * (2.0 / (2.0 - alpha * alpha)).sqrt()
    } else {
        alpha
    }
}

fn estimate(surface: &Surface, light: &Light, samples: &Samples) -> DVec3 {
    let Surface {
        model,
        masking,
        f0,
        n,
        v,
        ..
    } = *surface;
    let alpha = surface.widths().mean();
    let drawn_alpha = printed_lobe_alpha(model, alpha);
    let frame = Frame::from_normal(n);
    let v_local = frame.to_local(v);
    let mirror = Frame::from_normal(reflect(v, n));
    let count = f64::from(samples.count);
    let [width, height] = light.environment_size().map(f64::from);
    let term = |xi| {
        let l = mirror.to_world(model.sample_d(xi, drawn_alpha));
        let l_local = frame.to_local(l);
        if l_local.z <= 0.0 {
            return DVec3::ZERO;
        }
        let h = (v_local + l_local).normalize();
        let lod = 0.5 * (width * height / (count * model.d(h, alpha))).log2();
        let g = g2(model, v_local.z, l_local.z, alpha, masking);
        light.radiance(l, lod) * f_schlick(f0, v_local.dot(h)) * g
    };
    samples.points().map(term).sum::<DVec3>() / (4.0 * count * v_local.z)
}
