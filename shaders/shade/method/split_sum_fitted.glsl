// Method `split-sum-fitted`: the split sum, looked up along the lobe's first moment at the width that is closest to the lobe.
#ifndef METHOD_SPLIT_SUM_FITTED_GLSL
#define METHOD_SPLIT_SUM_FITTED_GLSL

#include "lib/lobe_shape.glsl"

vec3 specular_radiance(Surface s) {
    vec2 a_b = albedo_pair(s);
    float share = share_of_f90(s, a_b);
    // At shares 0, 1/2 and 1, a parabola between.
    vec3 ratios = lobe_shape(s, 1.0).xyz;
    float ratio = dot(ratios, vec3((1.0 - share) * (1.0 - 2.0 * share), 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)));
    float roughness = min(ratio * perceptual_roughness_from_alpha(s.alpha), 1.0);
    return prefiltered_radiance(lobe_direction(s, share), roughness) * (s.f0 * a_b.x + a_b.y);
}

#endif
