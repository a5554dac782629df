// The reference: an unbiased estimate of the integral of a lobe (BRDF times cosine, or a rung of the ladder) and environment radiance by
// multiple importance sampling. One dispatch takes every sample of the scrambles `scramble` to `scramble + scramble_count - 1` and folds their
// results into the mean and the spread over scrambles.
//
// One invocation computes one pixel. With m = `sample_count` / 2 (rounded up) samples from the lobe and m from the environment, the balance
// heuristic [VeachGuibas95, eq. 10 with equal counts] makes every sample of either kind contribute
//
//     f(v, l) n.l L(l) / (m (p_lobe(l) + p_environment(l)))
//
// to this scramble's estimate X_k. X_1 .. X_K are independent and each is unbiased, so their mean is the result and
// sum (X_k - mean)^2 / (K (K - 1)) estimates the variance of that mean without bias [Owen97, section 4].
// Mean and squared deviations are updated in one pass [Welford62].
//
// Set 0: 0 position and mask, 1 normal and alpha, 2 albedo and metallic, 3 f0 and id (sampler2D, level 0);
// 4 environment (sampler2D, level 0 in f32); 5 tables of the environment (see lib/environment_sampling.glsl);
// 6 mean over scrambles (rgb) and their count (a); 7 sum of squared deviations (rgb). Scramble 0 overwrites 6 and 7;
// 8 as 4, through a bilinear sampler; 9 mean direction and mass of each slot of 5; 10 DFG table.
// Dispatch: ceil(width / GROUP_SIDE) x ceil(rows / GROUP_SIDE), rows counted from `first_row`.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/compensated_sum.glsl"
#include "lib/environment_sampling.glsl"
#include "lib/sobol.glsl"
#include "lib/surface.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    ShadeParams params;
};

layout(set = 0, binding = 0) uniform sampler2D gbuffer_position;
layout(set = 0, binding = 1) uniform sampler2D gbuffer_normal;
layout(set = 0, binding = 2) uniform sampler2D gbuffer_albedo;
layout(set = 0, binding = 3) uniform sampler2D gbuffer_f0;
layout(set = 0, binding = 4) uniform sampler2D environment;
layout(set = 0, binding = 8) uniform sampler2D environment_linear;
layout(std430, set = 0, binding = 5) readonly buffer EnvironmentWords {
    uint environment_words[];
};
layout(std430, set = 0, binding = 6) buffer Means {
    vec4 means[];
};
layout(std430, set = 0, binding = 7) buffer SquaredDeviations {
    vec4 squared_deviations[];
};

layout(std140, set = 0, binding = 9) uniform Slots {
    vec4 slots[CELL_COLUMNS * CELL_ROWS];
};

layout(set = 0, binding = 10) uniform sampler2D dfg;

#include "selected/lobe.glsl"

uint environment_word(uint index) {
    return environment_words[index];
}

// What one sample adds. A density of 0 is that of a value of 0: it must not become 0 / 0.
vec3 contribution(LobeValue kernel, EnvironmentSample light) {
    float density = kernel.pdf_l + light.pdf_l;
    return density > 0.0 ? kernel.value_cos * light.li / density : vec3(0.0);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    if (pixel.x >= params.width || pixel.y >= params.height) {
        return;
    }
    uint index = pixel.y * params.width + pixel.x;
    ivec2 texel = ivec2(pixel);
    Surface world;
    if (!surface_from_gbuffer(texelFetch(gbuffer_position, texel, 0), texelFetch(gbuffer_normal, texel, 0),
                              texelFetch(gbuffer_albedo, texel, 0), texelFetch(gbuffer_f0, texel, 0), params.eye, world)) {
        means[index] = vec4(0.0, 0.0, 0.0, float(params.scramble + params.scramble_count));
        squared_deviations[index] = vec4(0.0);
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
    uint pair_count = (params.sample_count + 1u) / 2u;
    vec4 mean = vec4(0.0);
    vec3 squared = vec3(0.0);
    if (params.scramble > 0u) {
        mean = means[index];
        squared = squared_deviations[index].rgb;
    }
    for (uint scramble = params.scramble; scramble < params.scramble + params.scramble_count; ++scramble) {
        uint key = sobol_key(pixel, scramble, params.seed, LOBE_STREAM);
        uvec2 lobe_key = sobol_next_pair_key(key);
        uvec2 environment_key = sobol_next_pair_key(key);

        CompensatedSum sum = CompensatedSum(vec3(0.0), vec3(0.0));
        for (uint i = 0u; i < pair_count; ++i) {
            uint second = sobol_second_reversed(i);

            vec3 l_local = lobe_sample(lobe, sobol_to_unit(sobol_point(i, second, lobe_key)));
            vec3 term = vec3(0.0);
            if (l_local.z > 0.0) {
                term = contribution(lobe_eval(lobe, l_local),
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
        vec3 estimate = ((sum.high + sum.low) / float(pair_count) + mirror) * params.environment_scale;

        float count = mean.a + 1.0;
        vec3 deviation = estimate - mean.rgb;
        mean = vec4(mean.rgb + deviation / count, count);
        squared += deviation * (estimate - mean.rgb);
    }
    means[index] = mean;
    squared_deviations[index] = vec4(squared, 0.0);
}
