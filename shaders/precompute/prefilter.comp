// One invocation computes one texel of one level of the prefiltered map: the mean radiance of the lobe for n = v = r,
//     sum L (n.l) / sum (n.l), h with density D(h) (n.h), [Karis13 eq. 7 and listing 2]
// each lookup from the level at which a texel covers the sample's solid angle. Below ALPHA_MIN: the mirror, filtered to
// the texel's size.
// Set 0: 0 environment with its mips; 1 the level to write (rgba32f); 2 sample points (lib/sampling.glsl).
// Dispatch: ceil(width / GROUP_SIDE) x ceil(rows / GROUP_SIDE) groups, from row first_row on.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/prefilter.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    PrefilterParams params;
};

layout(set = 0, binding = 0) uniform sampler2D environment;
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2D level;
layout(std430, set = 0, binding = 2) readonly buffer Points {
    vec4 points[];
};

vec4 sample_point(uint i) {
    return points[i];
}

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    vec3 r = direction_from_uv(uv_from_texel(texel, size));
    vec3 li = params.alpha < ALPHA_MIN ? mirror_radiance(r, environment, params)
                                       : prefiltered_radiance(r, environment, params);
    imageStore(level, ivec2(texel), vec4(li, 1.0));
}
