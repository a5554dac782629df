// Rung `ladder-masking`: as `ladder-fresnel`, with the weight w(l) of prefiltered maps, by default
// n.l, for the masking:
//     (f0 A + B) <D (n.h) / (4 v.h) w(l), L> at the true v.

#include "lib/directional_albedo.glsl"
#include "lib/microfacet_lobe.glsl"

Lobe lobe_at(Surface s, ShadeParams params) {
    return microfacet_lobe(frame_of_surface(s), s.v, s.width, vec3(1.0));
}

LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    return weighted_kernel(lobe, l_local);
}

vec3 lobe_weight(Surface s, sampler2D dfg, uint flags) {
    vec4 albedo = directional_albedo(s.n_dot_v, s.alpha, LADDER_NODES, MASKING);
    return (s.f0 * albedo.x + albedo.y) / albedo.z;
}
