// The reference: an unbiased estimate of the integral of a lobe (BRDF times cosine, or a rung of
// the ladder) and environment radiance by multiple importance sampling. One dispatch takes
// `pair_count` further points of every scramble's net and adds them to its sum.
//
// One invocation computes one pixel. A pair is one sample from the lobe and one from the
// environment. With m pairs in all, the balance heuristic [VeachGuibas95, eq. 10 with equal counts]
// makes every sample of either kind contribute
//
//     f(v, l) n.l L(l) / (m (p_lobe(l) + p_environment(l)))
//
// to its scramble's estimate X_k. X_1 .. X_K, K = SCRAMBLE_COUNT, are independent and each is
// unbiased. shade/reference_resolve.comp makes mean and variance of them. A sum is kept with its
// low part, so that a net drawn in parts has the bits of one drawn at once.
//
// Set 0 after lib/shaded_pixel.glsl: 5 environment (level 0 in f32); 6 tables of the environment
// (lib/environment_sampling.glsl); 7 m X_k of each pixel of the dispatch's rows and scramble, high
// part (rgb) and low part (rgb), which the dispatch from pair 0 on overwrites; 8 as 5, through a bilinear sampler; 9 mean
// direction and mass of each slot of 6; 10 DFG table.

#include "lib/compensated_sum.glsl"
#include "lib/environment_sampling.glsl"
#include "lib/shaded_pixel.glsl"
#include "lib/sobol.glsl"

layout(set = 0, binding = 5) uniform sampler2D environment;
layout(set = 0, binding = 8) uniform sampler2D environment_linear;
layout(std430, set = 0, binding = 6) readonly buffer EnvironmentWords {
    uint environment_words[];
};
layout(std430, set = 0, binding = 7) buffer Sums {
    vec4 sums[];
};

layout(std140, set = 0, binding = 9) uniform Slots {
    vec4 slots[CELL_COLUMNS * CELL_ROWS];
};

layout(set = 0, binding = 10) uniform sampler2D dfg;

#include "selected/lobe.glsl"

uint environment_word(uint index) {
    return environment_words[index];
}

// The contribution of one sample. Density 0 implies value 0: it must not become 0 / 0.
vec3 contribution(LobeValue kernel, EnvironmentSample light) {
    float density = kernel.pdf_l + light.pdf_l;
    return density > 0.0 ? kernel.value_cos * light.li / density : vec3(0.0);
}

void main() {
    uvec2 pixel;
    if (!shaded_pixel(pixel)) {
        return;
    }
    uint base = index_in_dispatch(pixel) * 2u * SCRAMBLE_COUNT;
    Surface world;
    if (!surface_of_pixel(pixel, world)) {
        for (uint k = 0u; k < 2u * SCRAMBLE_COUNT; ++k) {
            sums[base + k] = vec4(0.0);
        }
        return;
    }
    // Everything below lives in the environment's frame: one matrix product a sample.
    Surface surface = surface_in_environment(world, params);
    Lobe lobe = lobe_at(surface, params);
    mat3 frame = lobe.frame;

    for (uint slot = 0u; slot < params.slot_count; ++slot) {
        environment_guide(slots[slot].w, GUIDE_FLOOR + lobe_guide(lobe, slots[slot].xyz * frame));
    }
    EnvironmentTables tables = environment_tables(params.environment_width, params.environment_height);
    vec3 mirror = vec3(0.0);
    if (lobe_mirror(lobe) > 0.0) {
        mirror = lobe_mirror(lobe) * environment_eval(environment, environment_linear, tables, frame[2]).li;
    }
    uint end = params.first_pair + params.pair_count;
    for (uint scramble = 0u; scramble < SCRAMBLE_COUNT; ++scramble) {
        uint key = sobol_key(pixel, scramble, params.seed, LOBE_STREAM);
        uvec2 lobe_key = sobol_next_pair_key(key);
        uvec2 environment_key = sobol_next_pair_key(key);

        uint at = base + 2u * scramble;
        CompensatedSum sum = CompensatedSum(vec3(0.0), vec3(0.0));
        if (params.first_pair > 0u) {
            sum = CompensatedSum(sums[at].rgb, sums[at + 1u].rgb);
        }
        for (uint i = params.first_pair; i < end; ++i) {
            uint second = sobol_second_reversed(i);

            vec3 l_local = lobe_sample(lobe, sobol_to_unit(sobol_point(i, second, lobe_key)));
            vec3 term = mirror;
            if (l_local.z > 0.0) {
                term += contribution(lobe_eval(lobe, l_local),
                                     environment_eval(environment, environment_linear, tables, frame * l_local));
            }

            EnvironmentSample light =
                environment_sample(environment, tables, sobol_point(i, second, environment_key));
            l_local = light.l * frame;
            if (l_local.z > 0.0 && light.pdf_l > 0.0) {
                term += contribution(lobe_eval(lobe, l_local), light);
            }

            sum = compensated_add(sum, term);
        }
        sums[at] = vec4(sum.high, 0.0);
        sums[at + 1u] = vec4(sum.low, 0.0);
    }
}
