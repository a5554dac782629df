// The diffuse lobe with Fresnel inside the integral: facets scatter the light they don't reflect,
// (1 - F) n.l / pi.

#include "lib/frame.glsl"
#include "lib/fresnel.glsl"
#include "lib/lobe.glsl"
#include "lib/surface.glsl"

struct Lobe {
    mat3 frame;
    vec3 v_local;
    vec3 f0;
};

#include "lib/cosine_lobe.glsl"

Lobe lobe_at(Surface s, ShadeParams params) {
    mat3 frame = frame_from_normal(s.n);
    return Lobe(frame, s.v * frame, f0_over_diffuse(s, params.flags));
}

LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    float cos_over_pi = max(l_local.z, 0.0) / PI;
    float v_dot_h = dot(lobe.v_local, normalize(lobe.v_local + l_local));
    return LobeValue((1.0 - fresnel(v_dot_h, lobe.f0)) * cos_over_pi, cos_over_pi);
}

vec3 lobe_weight(Surface s, sampler2D dfg, uint flags) {
    return (1.0 - s.metallic) * s.albedo;
}
