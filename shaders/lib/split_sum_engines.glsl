// The shifted split sums of engines and a denoiser;
// src/instrument/shade/method/split_sum_engines.rs has the sources.
#pragma methods split-sum-filament split-sum-frostbite split-sum-godot split-sum-nrd split-sum-unity

#include "lib/split_sum.glsl"

// The share of r.
float share_of_r(Surface s) {
    float smoothness = 1.0 - s.alpha;
#if defined(SPLIT_SUM_FILAMENT)
    return 1.0 - s.alpha * s.alpha;
#elif defined(SPLIT_SUM_FROSTBITE)
    return smoothness * (sqrt(smoothness) + s.alpha);
#elif defined(SPLIT_SUM_GODOT)
    return smoothness;
#elif defined(SPLIT_SUM_NRD)
    float k = 0.298475 * log(39.4115 - 39.0029 * sqrt(s.alpha));
    return clamp(pow(max(1.0 - s.n_dot_v, 0.0), 10.8649) * (1.0 - k) + k, 0.0, 1.0);
#elif defined(SPLIT_SUM_UNITY)
    float bent = smoothness * smoothness + smoothness * s.n_dot_v * s.n_dot_v;
    return (sqrt(smoothness) + s.alpha) * min(bent, 1.0);
#endif
}

vec3 specular_radiance(Surface s) {
    vec3 direction = normalize(mix(s.n, reflect(-s.v, s.n), share_of_r(s)));
    return prefiltered_radiance(direction, perceptual_roughness_from_alpha(s.alpha)) * reflectance(s);
}
