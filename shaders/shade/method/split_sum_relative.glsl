// Method `split-sum-relative`: the split sum, looked up along the lobe's first moment at the width of least relative error.
#ifndef METHOD_SPLIT_SUM_RELATIVE_GLSL
#define METHOD_SPLIT_SUM_RELATIVE_GLSL

#include "lib/lobe_shape.glsl"

vec3 specular_radiance(Surface s) {
    return fitted_split_sum(s, RELATIVE_WIDTHS);
}

#endif
