// How alpha maps to the levels of a prefiltered map and to the rows of the DFG table: a pair of inverse functions each.
#ifndef PREFILTER_MAPPING_GLSL
#define PREFILTER_MAPPING_GLSL

#include "generated/constants.glsl"

// alpha = perceptual_roughness^2. [Burley12 section 5.4]
float alpha_from_perceptual_roughness(float perceptual_roughness) {
    return perceptual_roughness * perceptual_roughness;
}

// The inverse; the floor of alpha stands for the mirror, 0.
float perceptual_roughness_from_alpha(float alpha) {
    return alpha <= ALPHA_MIN ? 0.0 : sqrt(alpha);
}

// Level k of `level_count` holds perceptual roughness k / (level_count - 1).
float perceptual_roughness_from_lod(float lod, uint level_count) {
    return level_count > 1u ? lod / float(level_count - 1u) : 0.0;
}

// The inverse: the real level that holds a perceptual roughness.
float lod_from_perceptual_roughness(float perceptual_roughness, uint level_count) {
    return perceptual_roughness * float(level_count - 1u);
}

// (n_dot_v, perceptual_roughness) of the centre of a texel of the DFG table.
vec2 dfg_axes_from_texel(uvec2 texel, uvec2 size) {
    return (vec2(texel) + 0.5) / vec2(size);
}

// Texture coordinates of the DFG table: bilinear between texel centres, constant beyond the outermost ones (clamp to
// edge).
vec2 dfg_uv(float n_dot_v, float alpha) {
    return vec2(n_dot_v, perceptual_roughness_from_alpha(alpha));
}

#endif
