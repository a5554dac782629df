// One invocation computes one texel of a level from the level above it: the mean over the texel's
// area on the sphere, so that the integral of radiance over solid angle is the same on every level,
// for any size. Set 0: 0 the level above, as a view of one level; 1 the level to write (rgba32f).

#include "lib/image_groups.glsl"
#include "lib/solid_angle_mean.glsl"

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
