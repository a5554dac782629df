// Shared by all probes but `counted`: one invocation per item; inputs and outputs in bindings 0 and
// 1 of set 0, in vec4. Dispatch: ceil(count / GROUP_LINEAR) groups.
#include "generated/constants.glsl"
#include "generated/layout.glsl"

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
