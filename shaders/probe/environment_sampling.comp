// One invocation evaluates lib/environment_sampling.glsl for one item.
// In: (upper and lower 16 bits of both fixed-point numbers xi), (unit direction, 0), (width, height, 0, 0).
// Out: (sampled direction, its density), (its radiance, 0), (radiance from the given direction, density there).
// Set 0: 0 inputs, 3 vec4 an item; 1 outputs, 3 vec4 an item; 2 environment (level 0); 3 tables of the environment.
// Dispatch: ceil(count / GROUP_LINEAR) groups.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/environment_sampling.glsl"

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
layout(set = 0, binding = 2) uniform sampler2D environment;
layout(std430, set = 0, binding = 3) readonly buffer EnvironmentWords {
    uint environment_words[];
};

uint environment_word(uint index) {
    return environment_words[index];
}

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    uvec4 halves = uvec4(inputs[item * 3u]);
    uvec2 size = uvec2(inputs[item * 3u + 2u].xy);
    EnvironmentTables tables = environment_tables(size.x, size.y);
    EnvironmentSample light = environment_sample(environment, tables, halves.xz << 16 | halves.yw);
    EnvironmentSample given = environment_eval(environment, tables, inputs[item * 3u + 1u].xyz);
    outputs[item * 3u] = vec4(light.l, light.pdf_l);
    outputs[item * 3u + 1u] = vec4(light.li, 0.0);
    outputs[item * 3u + 2u] = vec4(given.li, given.pdf_l);
}
