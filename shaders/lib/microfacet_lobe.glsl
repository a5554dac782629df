// A lobe of the selected microfacet model, sampled by its visible normals.

#include "lib/frame.glsl"
#include "lib/lobe.glsl"
#include "generated/specialization/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/prefilter_weight.glsl"
#include "lib/surface.glsl"

// Gives this lobe other points than the diffuse lobe, so that their errors are independent.
const uint LOBE_STREAM = 0u;

struct Lobe {
    mat3 frame;
    vec3 v_local;
    vec2 width;
    vec3 f0;
};

// The lobe as seen from v about the frame's n.
Lobe microfacet_lobe(mat3 frame, vec3 v, vec2 width, vec3 f0) {
    vec3 v_local = v * frame;
    // The floor of n_dot_v holds for the lobe too: at 0 it has no sampler.
    v_local.z = max(v_local.z, COSINE_MIN);
    return Lobe(frame, v_local, width, f0);
}

float lobe_guide(Lobe lobe, vec3 l_local) {
    vec3 h_local = normalize(lobe.v_local + l_local);
    return l_local.z > 0.0 ? pdf_visible_l_brdf(lobe.v_local, h_local, max(lobe.width, GUIDE_ALPHA_MIN)) : 0.0;
}

vec3 lobe_sample(Lobe lobe, vec2 xi) {
    return reflect(-lobe.v_local, sample_visible_brdf(xi, lobe.v_local, lobe.width));
}

float lobe_mirror(Lobe lobe) {
    return 0.0;
}

// The kernel f n.l of the specular integral.
LobeValue specular_kernel(Lobe lobe, vec3 l_local) {
    // From the sum of both, not from the sampled half vector: the environment's samples have none.
    vec3 h_local = normalize(lobe.v_local + l_local);
    return LobeValue(eval_brdf(lobe.v_local, l_local, h_local, lobe.width, lobe.f0, MASKING) * l_local.z,
        pdf_visible_l_brdf(lobe.v_local, h_local, lobe.width));
}

// The kernel D (n.h) / (4 v.h) w(l): no masking, the weight of prefiltered maps. At v = n it is
// theirs, D/4 w(l).
LobeValue weighted_kernel(Lobe lobe, vec3 l_local) {
    vec3 h_local = normalize(lobe.v_local + l_local);
    float v_dot_h = dot(lobe.v_local, h_local);
    float d = l_local.z > 0.0 && v_dot_h > 0.0 ? d_brdf(h_local, lobe.width) : 0.0;
    float value = d > 0.0 ? d * h_local.z / (4.0 * v_dot_h) * prefilter_weight(l_local.z, lobe.width.y) : 0.0;
    return LobeValue(vec3(value), pdf_visible_l_brdf(lobe.v_local, h_local, lobe.width));
}
