// Method `split-sum-nrd`: the split sum, looked up between n and r. [Lagarde14 listing 21]
#ifndef METHOD_SPLIT_SUM_NRD_GLSL
#define METHOD_SPLIT_SUM_NRD_GLSL

#include "lib/split_sum.glsl"

// The share of r.
float share_of_r(Surface s) {
    float k = 0.298475 * log(39.4115 - 39.0029 * sqrt(s.alpha));
    return clamp(pow(max(1.0 - s.n_dot_v, 0.0), 10.8649) * (1.0 - k) + k, 0.0, 1.0);
}

vec3 specular_radiance(Surface s) {
    vec3 direction = normalize(mix(s.n, reflect(-s.v, s.n), share_of_r(s)));
    return prefiltered_radiance(direction, perceptual_roughness_from_alpha(s.alpha)) * reflectance(s);
}

#endif
