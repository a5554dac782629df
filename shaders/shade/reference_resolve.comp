// One invocation adds one term of the reference, specular or diffuse, and its squared standard
// error to one pixel; pixels with mask 0 are left alone. The terms use independent points
// (LOBE_STREAM), so their squared errors add.
//
// With K = SCRAMBLE_COUNT independent estimates X_k, m X_k / environment_scale in the sums as
// shade/reference.comp leaves them (m = `pair_count`), and w the part of the term that does not
// depend on l (1 or the factor of a compensation for the specular one, the diffuse albedo for the
// other):
//
//     radiance += w mean X_k,    squared error += w^2 sum (X_k - mean)^2 / (K (K - 1))
//
// whose second sum estimates the variance of the mean without bias [Owen97, section 4].
//
// Each sum's high part becomes w X_k, for callers that read the scrambles.
//
// Set 0 after lib/shaded_pixel.glsl: 5 DFG table; 6 the sums of the dispatch's rows; 7 radiance;
// 8 squared standard error; 7 and 8 a vec4 a pixel.

#include "lib/shaded_pixel.glsl"

layout(set = 0, binding = 5) uniform sampler2D dfg;
layout(std430, set = 0, binding = 6) buffer Sums {
    vec4 sums[];
};
layout(std430, set = 0, binding = 7) buffer Radiance {
    vec4 radiance[];
};
layout(std430, set = 0, binding = 8) buffer SquaredErrors {
    vec4 squared_errors[];
};

#include "selected/lobe.glsl"
#include "lib/resolved_weight.glsl"

void main() {
    uvec2 pixel;
    Surface s;
    if (!shaded_pixel(pixel) || !surface_of_pixel(pixel, s)) {
        return;
    }
    uint index = index_of_pixel(pixel);
    vec3 weight = resolved_weight(s, dfg, params.flags);
    float scale = params.environment_scale / float(params.pair_count);
    uint first_sum = index_in_dispatch(pixel) * 2u * SCRAMBLE_COUNT;
    vec3 estimates[SCRAMBLE_COUNT];
    vec3 mean = vec3(0.0);
    for (uint k = 0u; k < SCRAMBLE_COUNT; ++k) {
        uint at = first_sum + 2u * k;
        estimates[k] = (sums[at].rgb + sums[at + 1u].rgb) * scale;
        mean += estimates[k] / float(SCRAMBLE_COUNT);
    }
    vec3 squared = vec3(0.0);
    for (uint k = 0u; k < SCRAMBLE_COUNT; ++k) {
        vec3 deviation = estimates[k] - mean;
        squared += deviation * deviation;
        sums[first_sum + 2u * k] = vec4(weight * estimates[k], 0.0);
    }
    vec3 squared_error = squared / float(SCRAMBLE_COUNT * (SCRAMBLE_COUNT - 1u));
    radiance[index] += vec4(weight * mean, 0.0);
    squared_errors[index] += vec4(weight * weight * squared_error, 0.0);
}
