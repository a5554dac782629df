// Split sums by one or several lookups, from the tables of precompute/taps.
#pragma methods split-sum-one split-sum-two split-sum-four

#include "lib/split_sum.glsl"
#include "lib/tap_lookup.glsl"

#if defined(SPLIT_SUM_ONE)
#define TAPS one_tap
#elif defined(SPLIT_SUM_TWO)
#define TAPS two_taps
#else
#define TAPS four_taps
#endif

vec4 tap_part(Surface s, float part, float dielectric) {
    return tap_part(TAPS, part, s.n_dot_v, perceptual_roughness_from_alpha(s.alpha), dielectric);
}

vec3 tap_radiance(Surface s, float place, float level) {
    vec3 direction = normalize(mix(s.n, reflect(-s.v, s.n), place));
    return map_radiance(prefiltered, map_place(direction), level);
}

vec3 pair_radiance(Surface s, float part, float dielectric, vec2 weights) {
    vec4 taps = tap_part(s, part, dielectric);
    return weights.x * tap_radiance(s, taps.x, taps.y) + weights.y * tap_radiance(s, taps.z, taps.w);
}

vec3 specular_radiance(Surface s) {
    vec2 a_b = albedo_pair(s);
    float dielectric = dielectric_share(dot(s.f0, vec3(1.0 / 3.0)), a_b);
#if defined(SPLIT_SUM_ONE)
    vec4 one = tap_part(s, 0.0, dielectric);
    vec3 mean = tap_radiance(s, one.x, one.y);
#elif defined(SPLIT_SUM_TWO)
    vec4 weights = tap_part(s, 1.0, dielectric);
    vec3 mean = max(pair_radiance(s, 0.0, dielectric, weights.xy), 0.0);
#else
    vec4 weights = tap_part(s, 2.0, dielectric);
    vec3 sum = pair_radiance(s, 0.0, dielectric, weights.xy) + pair_radiance(s, 1.0, dielectric, weights.zw);
    vec3 mean = max(sum, 0.0);
#endif
    return mean * (s.f0 * a_b.x + a_b.y);
}
