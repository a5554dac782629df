// `ladder-masking-alone`: the weight w(l) of prefiltered maps for the masking with Fresnel left
// inside,
//     (f0 A + B) <K F, L>, K = D (n.h) / (4 v.h) w(l).

#include "lib/directional_albedo.glsl"
#include "lib/microfacet_lobe.glsl"

Lobe lobe_at(Surface s, ShadeParams params) {
    return microfacet_lobe(frame_of_surface(s), s.v, s.width, s.f0);
}

LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    LobeValue found = weighted_kernel(lobe, l_local);
    float fc = schlick_weight(dot(lobe.v_local, normalize(lobe.v_local + l_local)));
    found.value_cos *= mix(lobe.f0, vec3(1.0), fc);
    return found;
}

vec3 lobe_weight(Surface s, sampler2D dfg, uint flags) {
    vec4 albedo = directional_albedo(s.n_dot_v, s.alpha, LADDER_NODES, MASKING);
    return (s.f0 * albedo.x + albedo.y) / (s.f0 * (albedo.z - albedo.w) + albedo.w);
}
