// Split sums by the table of precompute/lobe_shape.
#ifndef LOBE_SHAPE_GLSL
#define LOBE_SHAPE_GLSL

#include "lib/lobe_lookup.glsl"
#include "lib/split_sum.glsl"

// Parts of the table.
const float SQUARE_WIDTHS = 1.0;
const float RELATIVE_WIDTHS = 2.0;

vec4 lobe_lookup(Surface s, float share, float widths) {
    return lobe_lookup(lobe_shapes, widths, s.n, s.v, s.n_dot_v, perceptual_roughness_from_alpha(s.alpha), share);
}

// How much of what the lobe reflects is the part of weight Fc, which every f0 reflects; colours by their mean.
float share_of_f90(Surface s, vec2 a_b) {
    return a_b.y / (dot(s.f0, vec3(1.0 / 3.0)) * a_b.x + a_b.y);
}

// Mean radiance of a lobe of that share, along its first moment.
vec3 lobe_radiance(Surface s, float share, float widths) {
    vec4 lookup = lobe_lookup(s, share, widths);
    return prefiltered_radiance(lookup.xyz, lookup.w);
}

// The split sum along the first moment at such a width.
vec3 fitted_split_sum(Surface s, float widths) {
    vec2 a_b = albedo_pair(s);
    return lobe_radiance(s, share_of_f90(s, a_b), widths) * (s.f0 * a_b.x + a_b.y);
}

#endif
