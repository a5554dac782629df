// One invocation computes one texel of a level from the level above it: the mean over the texel's area on the sphere,
// so that the integral of radiance over solid angle is the same on every level, for any size.
// Set 0: 0 the level above, as a view of one level; 1 the level to write (rgba32f).
// Dispatch: ceil(width / GROUP_SIDE) x ceil(height / GROUP_SIDE) groups.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/solid_angle_mean.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    MipsParams params;
};

layout(set = 0, binding = 0) uniform sampler2D source;
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2D level;

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    vec4 mean = solid_angle_mean(source, uvec2(params.source_width, params.source_height), texel, size);
    imageStore(level, ivec2(texel), mean);
}
