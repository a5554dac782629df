// Method `split-sum-moment`: the split sum, looked up along the lobe's first moment.
#ifndef METHOD_SPLIT_SUM_MOMENT_GLSL
#define METHOD_SPLIT_SUM_MOMENT_GLSL

#include "lib/lobe_shape.glsl"

vec3 specular_radiance(Surface s) {
    vec2 a_b = albedo_pair(s);
    vec3 direction = lobe_lookup(s, share_of_f90(s, a_b), SQUARE_WIDTHS).xyz;
    return prefiltered_radiance(direction, perceptual_roughness_from_alpha(s.alpha)) * (s.f0 * a_b.x + a_b.y);
}

#endif
