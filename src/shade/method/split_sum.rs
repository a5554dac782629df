//! The split sum [Karis13, eq. 7, 8]: the mean radiance of the lobe for `n = v = r`, times what the lobe reflects of constant radiance,
//! `P(r, alpha) (f0 A(n_dot_v, alpha) + B(n_dot_v, alpha))`. Both factors are tables.

use super::Method;
use crate::brdf::reflect;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    uses_prefiltered: true,
    uses_dfg: true,
    has_ladder: true,
    ..Method::plain(
        "split-sum",
        "prefiltered map (n = v = r, n.l weight) times the DFG table",
        Twin::Estimator(|surface, light, _| {
            let pair = light.dfg(surface.n.dot(surface.v), surface.alpha);
            light.mean_radiance(reflect(surface.v, surface.n), surface.alpha) * (surface.f0 * pair.x + pair.y)
        }),
    )
};
