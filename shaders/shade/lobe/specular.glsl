// The specular lobe of the reference.

#include "lib/microfacet_lobe.glsl"

Lobe lobe_at(Surface s, ShadeParams params) {
    return microfacet_lobe(frame_of_surface(s), s.v, s.width, s.f0);
}

LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    return specular_kernel(lobe, l_local);
}

vec3 lobe_weight(Surface surface, sampler2D dfg, uint flags) {
    return vec3(1.0);
}
