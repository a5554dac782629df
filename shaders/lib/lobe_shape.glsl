// Where the lobe of a surface points and how wide it is, from the table of precompute/lobe_shape.
#ifndef LOBE_SHAPE_GLSL
#define LOBE_SHAPE_GLSL

#include "lib/split_sum.glsl"

// Nodes lie at both ends of both axes, sqrt(n_dot_v) and perceptual roughness; the parts of the table stand below each other.
vec4 lobe_shape(Surface s, float part) {
    const float SIDE = float(LOBE_SHAPE_SIDE);
    vec2 at = vec2(sqrt(min(s.n_dot_v, 1.0)), perceptual_roughness_from_alpha(s.alpha));
    vec2 texel = at * (SIDE - 1.0) + 0.5;
    return textureLod(lobe_shapes, vec2(texel.x, texel.y + part * SIDE) / vec2(SIDE, float(LOBE_SHAPE_PARTS) * SIDE), 0.0);
}

// How much of what the lobe reflects is the part of weight Fc, which every f0 reflects; colours by their mean.
float share_of_f90(Surface s, vec2 a_b) {
    return a_b.y / (dot(s.f0, vec3(1.0 / 3.0)) * a_b.x + a_b.y);
}

// Direction of the lobe's first moment: each part's is x r + y n.
vec3 lobe_direction(Surface s, float share) {
    vec4 moments = lobe_shape(s, 0.0);
    vec2 moment = mix(moments.xy, moments.zw, share);
    return normalize(moment.x * reflect(-s.v, s.n) + moment.y * s.n);
}

// Perceptual roughness of the kernel that fits the lobe, by a part of the table that holds widths.
float lobe_roughness(Surface s, float share, float part) {
    // At shares 0, 1/2 and 1, a parabola between.
    vec3 basis = vec3((1.0 - share) * (1.0 - 2.0 * share), 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0));
    return min(dot(lobe_shape(s, part).xyz, basis) * perceptual_roughness_from_alpha(s.alpha), 1.0);
}

// The split sum along the first moment at such a width.
vec3 fitted_split_sum(Surface s, float part) {
    vec2 a_b = albedo_pair(s);
    float share = share_of_f90(s, a_b);
    return prefiltered_radiance(lobe_direction(s, share), lobe_roughness(s, share, part)) * (s.f0 * a_b.x + a_b.y);
}

#endif
