// Maps alpha to levels of a prefiltered map, and n_dot_v and alpha to the DFG table, each with its
// inverse.

#include "generated/constants.glsl"
#include "generated/specialization/dfg_axes.glsl"
#include "generated/specialization/level_bend.glsl"
#include "generated/specialization/level_roughnesses.glsl"

// alpha = perceptual_roughness^2. [Burley12 section 5.4]
float alpha_from_perceptual_roughness(float perceptual_roughness) {
    return perceptual_roughness * perceptual_roughness;
}

// The inverse; the floor of alpha means the mirror, 0.
float perceptual_roughness_from_alpha(float alpha) {
    return alpha <= ALPHA_MIN ? 0.0 : sqrt(alpha);
}

// Whether LEVEL_ROUGHNESSES lists the levels: it ascends, so the second is above 0.
bool levels_are_listed() {
    return LEVEL_ROUGHNESSES[1] > 0.0;
}

// Level k of `level_count` holds LEVEL_ROUGHNESSES[k], between them linear; if none are listed, the
// r with r (1 + b (1 - r)) = k / (level_count - 1), b = LEVEL_BEND
// (precompute/prefilter/level_mapping.rs).
float perceptual_roughness_from_lod(float lod, uint level_count) {
    if (levels_are_listed()) {
        uint fine = min(uint(lod), level_count - 2u);
        return mix(LEVEL_ROUGHNESSES[fine], LEVEL_ROUGHNESSES[fine + 1u], lod - float(fine));
    }
    float u = level_count > 1u ? lod / float(level_count - 1u) : 0.0;
    float at_end = 1.0 - LEVEL_BEND;
    return 2.0 * u / (1.0 + LEVEL_BEND + sqrt(at_end * at_end + 4.0 * LEVEL_BEND * (1.0 - u)));
}

// The inverse: the real level that holds a perceptual roughness; beyond a list its first or last.
float lod_from_perceptual_roughness(float perceptual_roughness, uint level_count) {
    if (levels_are_listed()) {
        float lod = 0.0;
        for (uint k = 1u; k < level_count; ++k) {
            float fine = LEVEL_ROUGHNESSES[k - 1u];
            lod += clamp((perceptual_roughness - fine) / (LEVEL_ROUGHNESSES[k] - fine), 0.0, 1.0);
        }
        return lod;
    }
    return perceptual_roughness * (1.0 + LEVEL_BEND * (1.0 - perceptual_roughness)) * float(level_count - 1u);
}

// Fourth roots of the least n_dot_v and of the least alpha.
vec2 least_fourth_roots() {
    return sqrt(sqrt(vec2(COSINE_MIN, ALPHA_MIN)));
}

// (n_dot_v, alpha) of a texel of the DFG table.
vec2 dfg_parameters_from_texel(uvec2 texel, uvec2 size) {
    if (DFG_AXES == DFG_AXES_CENTRES) {
        vec2 at = (vec2(texel) + 0.5) / vec2(size);
        return vec2(at.x, max(alpha_from_perceptual_roughness(at.y), ALPHA_MIN));
    }
    vec2 root = mix(least_fourth_roots(), vec2(1.0), vec2(texel) / vec2(size - 1u));
    vec2 square = root * root;
    return square * square;
}

// The inverse, as texture coordinates: bilinear between texels, constant beyond the outermost ones
// (clamp to edge).
vec2 dfg_uv(float n_dot_v, float alpha, vec2 size) {
    if (DFG_AXES == DFG_AXES_CENTRES) {
        return vec2(n_dot_v, perceptual_roughness_from_alpha(alpha));
    }
    vec2 low = least_fourth_roots();
    vec2 at = (sqrt(sqrt(vec2(n_dot_v, alpha))) - low) / (1.0 - low);
    return (at * (size - 1.0) + 0.5) / size;
}

// (A, B) of the DFG table: of constant radiance the lobe reflects f0 A + B.
vec2 albedo_pair(sampler2D dfg, float n_dot_v, float alpha) {
    return textureLod(dfg, dfg_uv(n_dot_v, alpha, vec2(textureSize(dfg, 0))), 0.0).rg;
}
