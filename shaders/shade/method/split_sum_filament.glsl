// Method `split-sum-filament`: the split sum, looked up between n and r.
#ifndef METHOD_SPLIT_SUM_FILAMENT_GLSL
#define METHOD_SPLIT_SUM_FILAMENT_GLSL

#include "lib/split_sum.glsl"

// The share of r.
float share_of_r(Surface s) {
    return 1.0 - s.alpha * s.alpha;
}

vec3 specular_radiance(Surface s) {
    vec3 direction = normalize(mix(s.n, reflect(-s.v, s.n), share_of_r(s)));
    return prefiltered_radiance(direction, perceptual_roughness_from_alpha(s.alpha)) * reflectance(s);
}

#endif
