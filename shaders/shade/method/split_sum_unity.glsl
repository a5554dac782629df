// Method `split-sum-unity`: the split sum, looked up between n and r.
#ifndef METHOD_SPLIT_SUM_UNITY_GLSL
#define METHOD_SPLIT_SUM_UNITY_GLSL

#include "lib/split_sum.glsl"

// The share of r.
float share_of_r(Surface s) {
    float smoothness = 1.0 - s.alpha;
    float bent = smoothness * smoothness + smoothness * s.n_dot_v * s.n_dot_v;
    return (sqrt(smoothness) + s.alpha) * min(bent, 1.0);
}

vec3 specular_radiance(Surface s) {
    vec3 direction = normalize(mix(s.n, reflect(-s.v, s.n), share_of_r(s)));
    return prefiltered_radiance(direction, perceptual_roughness_from_alpha(s.alpha)) * reflectance(s);
}

#endif
