// One invocation evaluates lib/frame.glsl for one item.
// In: (n, 0).
// Out: (tangent, 0), (bitangent, 0), (normal, 0).
// Set 0: 0 inputs, 1 vec4 an item; 1 outputs, 3 vec4 an item.

#include "lib/frame.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    mat3 frame = frame_from_normal(inputs[item].xyz);
    outputs[item * 3u] = vec4(frame[0], 0.0);
    outputs[item * 3u + 1u] = vec4(frame[1], 0.0);
    outputs[item * 3u + 2u] = vec4(frame[2], 0.0);
}
