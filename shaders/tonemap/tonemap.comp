// One invocation tone-maps one pixel to 8 bits a channel.
// Set 0: 0 radiance, a vec4 a pixel, row-major; 1 packed pixels, R in the lowest byte, A = 255.

#include "lib/image_groups.glsl"
#include "lib/tone_curve.glsl"

layout(push_constant) uniform Push {
    TonemapParams params;
};

layout(std430, set = 0, binding = 0) readonly buffer Radiance {
    vec4 radiance[];
};
layout(std430, set = 0, binding = 1) writeonly buffer Packed {
    uint packed[];
};

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= params.width || pixel.y >= params.height) {
        return;
    }
    uint index = pixel.y * params.width + pixel.x;
    packed[index] = pack_rgba8(tone_curve(radiance[index].rgb, params.exposure, params.contrast));
}
