// One invocation evaluates lib/tone_curve.glsl for one item.
// In: (linear RGB, 0), (exposure, contrast, 0, 0). Out: (display RGB, the packed pixel without A as a number).
// Set 0: 0 inputs, 2 vec4 an item; 1 outputs, 1 vec4 an item.
// Dispatch: ceil(count / GROUP_LINEAR) groups.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/tone_curve.glsl"

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
    vec4 exposure_contrast = inputs[item * 2u + 1u];
    vec3 c = tone_curve(inputs[item * 2u].rgb, exposure_contrast.x, exposure_contrast.y);
    outputs[item] = vec4(c, float(pack_rgba8(c) & 0xffffffu));
}
