// One invocation evaluates the functions of lib/environment_sampling.glsl for one item, on a map of
// the bound environment's size. In: (unit direction, count of slots), (xi.x high, low, xi.y high,
// low) with 16 bits a channel. Out: (radiance from the direction, its density), (sampled direction,
// its density), (radiance from the sampled direction, 0). Set 0: 0 inputs, 2 vec4 an item; 1
// outputs, 3 vec4 an item; 2 environment (sampler2D, level 0); 3 words of its distribution; 4 the
// environment through a bilinear sampler; 5 the slots of its distribution. Specialization constant
// 1: EXACT_FILTER.

#include "lib/environment_sampling.glsl"
#include "probe/item.glsl"

layout(set = 0, binding = 2) uniform sampler2D environment;
layout(set = 0, binding = 4) uniform sampler2D environment_linear;
layout(std430, set = 0, binding = 3) readonly buffer EnvironmentWords {
    uint environment_words[];
};

layout(std140, set = 0, binding = 5) uniform Slots {
    vec4 slots[CELL_COLUMNS * CELL_ROWS];
};

uint environment_word(uint index) {
    return environment_words[index];
}

// A lobe about +x with a floor.
float guide_weight(vec3 d) {
    return 0.1 + max(d.x, 0.0);
}

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    uvec2 size = uvec2(textureSize(environment, 0));
    EnvironmentTables tables = environment_tables(size.x, size.y);
    for (uint slot = 0u; slot < uint(inputs[item * 2u].w); ++slot) {
        environment_guide(slots[slot].w, guide_weight(slots[slot].xyz));
    }
    EnvironmentSample seen = environment_eval(environment, environment_linear, tables, inputs[item * 2u].xyz);
    uvec4 halves = uvec4(inputs[item * 2u + 1u]);
    EnvironmentSample light = environment_sample(environment, tables, halves.xz << 16 | halves.yw);
    outputs[item * 3u] = vec4(seen.li, seen.pdf_l);
    outputs[item * 3u + 1u] = vec4(light.l, light.pdf_l);
    outputs[item * 3u + 2u] = vec4(light.li, 0.0);
}
