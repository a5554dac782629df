// Method `split-sum-parted`: a split sum for each part of the Fresnel term, along its first moment at its width of least relative error.
#ifndef METHOD_SPLIT_SUM_PARTED_GLSL
#define METHOD_SPLIT_SUM_PARTED_GLSL

#include "lib/lobe_shape.glsl"

vec3 specular_radiance(Surface s) {
    vec2 a_b = albedo_pair(s);
    return s.f0 * a_b.x * lobe_radiance(s, 0.0, RELATIVE_WIDTHS) + a_b.y * lobe_radiance(s, 1.0, RELATIVE_WIDTHS);
}

#endif
