// One invocation computes one texel of a level of a filtered map from the four below it, each
// weighted by its solid angle in a: the integral of radiance over solid angle is the same on every
// level. Set 0: 0 the finer level, as a view of one level; 1 the level to write (rgba32f). A layer
// a face.

#include "lib/image_groups.glsl"

layout(push_constant) uniform Push {
    MipsParams params;
};

layout(set = 0, binding = 0) uniform sampler2DArray source;
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2DArray level;

void main() {
    uvec3 texel = gl_GlobalInvocationID;
    if (texel.x >= params.width || texel.y >= params.height) {
        return;
    }
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        vec4 one = texelFetch(source, ivec3(2 * ivec2(texel.xy) + ivec2(i & 1, i >> 1), texel.z), 0);
        sum += vec4(one.a * one.rgb, one.a);
    }
    imageStore(level, ivec3(texel), vec4(sum.rgb / sum.a, sum.a));
}
