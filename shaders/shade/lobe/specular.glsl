// The specular lobe of the reference: the selected microfacet model, sampled by its best known sampler.
//
// Every file in shade/lobe/ defines the same functions.
#ifndef LOBE_SPECULAR_GLSL
#define LOBE_SPECULAR_GLSL

#include "lib/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/surface.glsl"

// Separates the points of this lobe from those of the diffuse lobe: their errors are independent.
const uint LOBE_STREAM = 0u;

// BRDF times n_dot_l, and the density (1/sr) with which `lobe_sample` returns l.
struct LobeValue {
    vec3 value_cos;
    float pdf_l;
};

LobeValue lobe_eval(Surface surface, vec3 v_local, vec3 l_local) {
    // From the sum of both, not from the sampled half vector: the environment's samples have none.
    vec3 h_local = normalize(v_local + l_local);
    return LobeValue(eval_brdf(v_local, l_local, h_local, surface.alpha, surface.f0, MASKING) * l_local.z,
        pdf_visible_l_brdf(v_local, h_local, surface.alpha));
}

// The density of l that guides the environment's samples, of a lobe no narrower than the cells that it is meant for.
float lobe_guide(Surface surface, vec3 v_local, vec3 l_local) {
    vec3 h_local = normalize(v_local + l_local);
    return l_local.z > 0.0 ? pdf_visible_l_brdf(v_local, h_local, max(surface.alpha, GUIDE_ALPHA_MIN)) : 0.0;
}

vec3 lobe_sample(Surface surface, vec3 v_local, vec2 xi) {
    return reflect(-v_local, sample_visible_brdf(xi, v_local, surface.alpha));
}

// What scales the estimate and does not depend on l.
vec3 lobe_weight(Surface surface, sampler2D dfg, uint flags) {
    return vec3(1.0);
}

#endif
