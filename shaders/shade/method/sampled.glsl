// Method `sampled`: importance sampling of D with fixed points, each lookup filtered by its solid angle.
#ifndef METHOD_SAMPLED_GLSL
#define METHOD_SAMPLED_GLSL

#include "lib/importance_sampling.glsl"

vec3 specular_radiance(Surface s, sampler2D environment, sampler2D prefiltered, sampler2D dfg, ShadeParams params) {
    return importance_sampled_radiance(s, environment, params, true);
}

#endif
