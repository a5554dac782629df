// Split sums along the first moment of the lobe, by the table of precompute/lobe_shape;
// src/shade/method/split_sum_lobes.rs has the formulas.
#pragma methods split-sum-moment split-sum-fitted split-sum-relative split-sum-parted

#include "lib/lobe_lookup.glsl"
#include "lib/split_sum.glsl"

// Parts of the table.
const float SQUARE_WIDTHS = 1.0;
const float RELATIVE_WIDTHS = 2.0;

vec4 lobe_lookup(Surface s, float share, float widths) {
    return lobe_lookup(lobe_shapes, widths, s.n, s.v, s.n_dot_v, perceptual_roughness_from_alpha(s.alpha), share);
}

// Mean radiance of a lobe of that share, along its first moment.
vec3 lobe_radiance(Surface s, float share, float widths) {
    vec4 lookup = lobe_lookup(s, share, widths);
    return prefiltered_radiance(lookup.xyz, lookup.w);
}

// The split sum along the first moment at the fitted width.
vec3 fitted_split_sum(Surface s, float widths) {
    vec2 a_b = albedo_pair(s);
    return lobe_radiance(s, share_of_f90(s, a_b), widths) * (s.f0 * a_b.x + a_b.y);
}

vec3 specular_radiance(Surface s) {
#if defined(SPLIT_SUM_FITTED)
    return fitted_split_sum(s, SQUARE_WIDTHS);
#elif defined(SPLIT_SUM_RELATIVE)
    return fitted_split_sum(s, RELATIVE_WIDTHS);
#elif defined(SPLIT_SUM_MOMENT)
    vec2 a_b = albedo_pair(s);
    vec3 direction = lobe_lookup(s, share_of_f90(s, a_b), SQUARE_WIDTHS).xyz;
    return prefiltered_radiance(direction, perceptual_roughness_from_alpha(s.alpha)) * (s.f0 * a_b.x + a_b.y);
#elif defined(SPLIT_SUM_PARTED)
    vec2 a_b = albedo_pair(s);
    return s.f0 * a_b.x * lobe_radiance(s, 0.0, RELATIVE_WIDTHS) + a_b.y * lobe_radiance(s, 1.0, RELATIVE_WIDTHS);
#endif
}
