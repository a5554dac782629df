// Projects an environment onto nine spherical harmonics: L_lm is the sum over all texels of L times
// the integral of Y_lm over the texel, or times its value at the centre [Kim22 "Irradiance
// mapping"], as `projection` says. One invocation sums every (64 * group_count)-th texel; each group
// leaves one partial sum a coefficient; sh9_reduce.comp adds those. The order of every addition is
// fixed, so the result is the same bits in every run. Set 0: 0 environment (level 0 is read); 1
// partial sums, SH9_COUNT vec4 a group. Dispatch: group_count groups.

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/compensated_sum.glsl"
#include "lib/sh_projection.glsl"

layout(local_size_x = GROUP_LINEAR) in;

layout(push_constant) uniform Push {
    Sh9Params params;
};

layout(set = 0, binding = 0) uniform sampler2D environment;
layout(std430, set = 0, binding = 1) writeonly buffer Partials {
    vec4 partials[];
};

shared vec3 group_sums[SH9_COUNT][GROUP_LINEAR];

void main() {
    uint texel_count = params.width * params.height;
    uint stride = GROUP_LINEAR * params.group_count;
    CompensatedSum[SH9_COUNT] sums;
    for (uint k = 0u; k < SH9_COUNT; ++k) {
        sums[k] = CompensatedSum(vec3(0.0), vec3(0.0));
    }
    for (uint index = gl_GlobalInvocationID.x; index < texel_count; index += stride) {
        uvec2 texel = uvec2(index % params.width, index / params.width);
        vec3 radiance = texelFetch(environment, ivec2(texel), 0).rgb;
        uvec2 size = uvec2(params.width, params.height);
        float[SH9_COUNT] y = params.projection == SH9_AT_CENTRES ? sh9_at_centre(texel, size) : sh9_over_texel(texel, size);
        for (uint k = 0u; k < SH9_COUNT; ++k) {
            sums[k] = compensated_add(sums[k], y[k] * radiance);
        }
    }
    for (uint k = 0u; k < SH9_COUNT; ++k) {
        group_sums[k][gl_LocalInvocationID.x] = sums[k].high + sums[k].low;
    }
    for (uint half_count = GROUP_LINEAR / 2u; half_count > 0u; half_count /= 2u) {
        barrier();
        if (gl_LocalInvocationID.x < half_count) {
            for (uint k = 0u; k < SH9_COUNT; ++k) {
                group_sums[k][gl_LocalInvocationID.x] += group_sums[k][gl_LocalInvocationID.x + half_count];
            }
        }
    }
    barrier();
    uint k = gl_LocalInvocationID.x;
    if (k < SH9_COUNT) {
        partials[gl_WorkGroupID.x * SH9_COUNT + k] = vec4(group_sums[k][0], 0.0);
    }
}
