// The lookup P(d, level) of a sheen lobe, without its albedo; src/instrument/shade/sheen.rs has the
// sources.

#include "generated/specialization/sheen_lookup.glsl"
#include "lib/split_sum.glsl"

// The parts of SHEEN_LOOKUP (src/base/glsl/specialization.rs).
#define SHEEN_TOWARD (SHEEN_LOOKUP & 15u)
#define SHEEN_LEVEL (SHEEN_LOOKUP >> 4u)

vec3 specular_radiance(Surface s) {
    float alpha = max(s.alpha, SHEEN_ALPHA_MIN);
    float perceptual_roughness = perceptual_roughness_from_alpha(alpha);
    vec3 direction = s.n;
    if (SHEEN_TOWARD == SHEEN_TOWARD_MIRROR) {
        direction = reflect(-s.v, s.n);
    } else if (SHEEN_TOWARD == SHEEN_TOWARD_MOMENT) {
        // A fit of the lobe's first moment, which lies on the side of the viewer.
        float upright = mix(2.7 * perceptual_roughness + 3.48 * alpha, 1.17 * alpha, s.n_dot_v);
        direction = normalize(s.v + (upright - s.n_dot_v) * s.n);
    }
    return prefiltered_radiance(direction, SHEEN_LEVEL == SHEEN_LEVEL_ROUGHEST ? 1.0 : perceptual_roughness);
}
