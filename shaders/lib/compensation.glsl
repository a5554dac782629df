// Compensation of the light that single scattering loses between facets;
// src/instrument/brdf/compensation.rs has the equations.

#include "generated/constants.glsl"
#include "lib/fresnel.glsl"
#include "lib/prefilter_mapping.glsl"

// The live view has no compensation.
#ifdef GL_ES
const uint COMPENSATION = COMPENSATION_NONE;
#else
#include "generated/specialization/compensation.glsl"
#endif

// Nodes of the mean over cosines.
const uint MEAN_ALBEDO_NODES = 64u;

// The albedo for F = 1 of a direction, from the DFG table; not above 1.
float albedo_of(sampler2D dfg, float cosine, float alpha) {
    vec2 a_b = albedo_pair(dfg, cosine, alpha);
    return min(a_b.x + a_b.y, 1.0);
}

// 2 times the integral of albedo and cosine.
float mean_albedo(sampler2D dfg, float alpha) {
    float sum = 0.0;
    for (uint i = 0u; i < MEAN_ALBEDO_NODES; ++i) {
        float cosine = (float(i) + 0.5) / float(MEAN_ALBEDO_NODES);
        sum += 2.0 * cosine * albedo_of(dfg, cosine, alpha);
    }
    return sum / float(MEAN_ALBEDO_NODES);
}

// The factor of single scattering.
vec3 compensation_factor(vec3 f0, vec2 a_b, sampler2D dfg, float alpha) {
    float albedo = a_b.x + a_b.y;
    float lost = (1.0 - albedo) / albedo;
    if (COMPENSATION == COMPENSATION_TURQUIN) {
        return 1.0 + f0 * lost;
    }
    if (COMPENSATION == COMPENSATION_CYCLES) {
        float mean = mean_albedo(dfg, alpha);
        vec3 average = mean_fresnel(f0);
        return 1.0 + lost * average * mean / (1.0 - average * (1.0 - mean));
    }
    return vec3(1.0);
}

// The share of irradiance over pi, or of the lobe of kulla-conty, that is added.
vec3 multiple_scattering(vec3 f0, vec2 a_b, sampler2D dfg, float alpha) {
    float lost = max(1.0 - (a_b.x + a_b.y), 0.0);
    vec3 average = mean_fresnel(f0);
    if (COMPENSATION == COMPENSATION_FDEZ_AGUERA) {
        return lost * (f0 * a_b.x + a_b.y) * average / (1.0 - average * lost);
    }
    if (COMPENSATION == COMPENSATION_KULLA_CONTY) {
        float mean = mean_albedo(dfg, alpha);
        return lost * average * average * mean / (1.0 - average * (1.0 - mean));
    }
    return vec3(0.0);
}

// The lobe of kulla-conty over Lambert's.
float multiple_lobe(sampler2D dfg, float n_dot_l, float alpha, float mean) {
    return (1.0 - albedo_of(dfg, n_dot_l, alpha)) / max(1.0 - mean, 1e-6);
}
