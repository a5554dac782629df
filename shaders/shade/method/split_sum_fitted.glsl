// Method `split-sum-fitted`: the split sum, looked up along the lobe's first moment at the width of least squared error.
#ifndef METHOD_SPLIT_SUM_FITTED_GLSL
#define METHOD_SPLIT_SUM_FITTED_GLSL

#include "lib/lobe_shape.glsl"

vec3 specular_radiance(Surface s) {
    return fitted_split_sum(s, SQUARE_WIDTHS);
}

#endif
