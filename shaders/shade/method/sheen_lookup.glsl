// The lookup P(d, level) of a sheen lobe, without its albedo; src/instrument/shade/sheen.rs has the
// sources.

#include "lib/split_sum.glsl"

// Direction | level << 4, of SHEEN_TOWARD_* and SHEEN_LEVEL_*; in GLSL ES a uniform.
#ifdef GL_ES
uniform uint SHEEN_LOOKUP;
#else
layout(constant_id = 8) const uint SHEEN_LOOKUP = SHEEN_TOWARD_MOMENT;
#endif

vec3 specular_radiance(Surface s) {
    float alpha = max(s.alpha, SHEEN_ALPHA_MIN);
    float perceptual_roughness = perceptual_roughness_from_alpha(alpha);
    vec3 direction = s.n;
    if ((SHEEN_LOOKUP & 15u) == SHEEN_TOWARD_MIRROR) {
        direction = reflect(-s.v, s.n);
    } else if ((SHEEN_LOOKUP & 15u) == SHEEN_TOWARD_MOMENT) {
        // A fit of the lobe's first moment, which lies on the side of the viewer.
        float upright = mix(2.7 * perceptual_roughness + 3.48 * alpha, 1.17 * alpha, s.n_dot_v);
        direction = normalize(s.v + (upright - s.n_dot_v) * s.n);
    }
    return prefiltered_radiance(direction, (SHEEN_LOOKUP >> 4u) == SHEEN_LEVEL_ROUGHEST ? 1.0 : perceptual_roughness);
}
