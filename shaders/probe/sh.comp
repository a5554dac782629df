// One invocation evaluates lib/sh.glsl for one item.
// In: (unit direction, 0). Out: basis functions 0 to 3, 4 to 7, (basis function 8, irradiance over pi of the
// coefficients, not floored).
// Set 0: 0 inputs, 1 vec4 an item; 1 outputs, 3 vec4 an item; 2 SH9_COUNT coefficients.
// Dispatch: ceil(count / GROUP_LINEAR) groups.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/sh.glsl"

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
layout(std430, set = 0, binding = 2) readonly buffer Coefficients {
    vec4 coefficients[SH9_COUNT];
};

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    vec3 d = inputs[item].xyz;
    float[SH9_COUNT] y = sh9_basis(d);
    outputs[item * 3u] = vec4(y[0], y[1], y[2], y[3]);
    outputs[item * 3u + 1u] = vec4(y[4], y[5], y[6], y[7]);
    outputs[item * 3u + 2u] = vec4(y[8], sh9_irradiance_over_pi(coefficients, d));
}
