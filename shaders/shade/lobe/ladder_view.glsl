// Rung `ladder-view`: as `ladder-masking` for n = v = r: the split sum with exact factors, P(r,
// alpha) (f0 A + B).

#include "lib/directional_albedo.glsl"
#include "lib/microfacet_lobe.glsl"

Lobe lobe_at(Surface s, ShadeParams params) {
    vec3 r = normalize(reflect(-s.v, s.n));
    return microfacet_lobe(frame_from_normal(r), r, s.width, vec3(1.0));
}

LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    return weighted_kernel(lobe, l_local);
}

vec3 lobe_weight(Surface s, sampler2D dfg, uint flags) {
    vec4 albedo = directional_albedo(s.n_dot_v, s.alpha, LADDER_NODES, MASKING);
    return (s.f0 * albedo.x + albedo.y) / mirror_weight(s.alpha);
}
