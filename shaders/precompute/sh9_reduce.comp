// One invocation adds the partial sums of one coefficient that sh9.comp left, in the order of the
// groups. Set 0: 0 partial sums, SH9_COUNT vec4 a group; 1 the SH9_COUNT radiance coefficients (w =
// 0). Dispatch: one group.

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/compensated_sum.glsl"

layout(local_size_x = GROUP_LINEAR) in;

layout(push_constant) uniform Push {
    Sh9Params params;
};

layout(std430, set = 0, binding = 0) readonly buffer Partials {
    vec4 partials[];
};
layout(std430, set = 0, binding = 1) writeonly buffer Coefficients {
    vec4 coefficients[];
};

void main() {
    uint k = gl_LocalInvocationID.x;
    if (k >= SH9_COUNT) {
        return;
    }
    CompensatedSum sum = CompensatedSum(vec3(0.0), vec3(0.0));
    for (uint group = 0u; group < params.group_count; ++group) {
        sum = compensated_add(sum, partials[group * SH9_COUNT + k].rgb);
    }
    coefficients[k] = vec4(sum.high + sum.low, 0.0);
}
