// One invocation evaluates lib/sobol.glsl for one item.
// In: (index, column, row, scramble), (seed, stream, pair, 0). Out: (point in the unit square, the upper 16 bits of both fixed-point numbers).
// Set 0: 0 inputs, 2 vec4 an item; 1 outputs, 1 vec4 an item.
// Dispatch: ceil(count / GROUP_LINEAR) groups.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/sobol.glsl"

layout(local_size_x = GROUP_LINEAR) in;

layout(push_constant) uniform Push {
    ProbeParams params;
};

layout(std430, set = 0, binding = 0) readonly buffer Inputs {
    vec4 inputs[];
};
layout(std430, set = 0, binding = 1) writeonly buffer Outputs {
    vec4 outputs[];
};

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    uvec4 a = uvec4(inputs[item * 2u]);
    uvec4 b = uvec4(inputs[item * 2u + 1u]);
    uvec2 key = sobol_pair_key(sobol_key(a.yz, a.w, b.x, b.y), b.z);
    uvec2 point = sobol_point(a.x, sobol_second_reversed(a.x), key);
    outputs[item] = vec4(sobol_to_unit(point), vec2(point >> 16));
}
