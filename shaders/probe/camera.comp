// One invocation evaluates lib/camera.glsl for one item.
// In: (column, row, width, height), (right, 0), (up, 0), (forward, 0).
// Out: (unit direction, 0).
// Set 0: 0 inputs, 4 vec4 an item; 1 outputs, 1 vec4 an item.

#include "lib/camera.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    uvec4 pixel_size = uvec4(inputs[item * 4u]);
    vec3 d = ray_direction(pixel_size.xy, pixel_size.zw, inputs[item * 4u + 1u].xyz, inputs[item * 4u + 2u].xyz,
                           inputs[item * 4u + 3u].xyz);
    outputs[item] = vec4(d, 0.0);
}
