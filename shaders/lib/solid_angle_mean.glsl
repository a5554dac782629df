// Means over the sphere of the texels that a coarser texel covers.

#include "lib/elementary.glsl"

// cos(pi v0) - cos(pi v1) as a product: the difference of cosines has no digits left at the poles.
float cosine_difference(float v0, float v1) {
    return 2.0 * sin_cos_turns(0.25 * (v0 + v1)).x * sin_cos_turns(0.25 * (v1 - v0)).x;
}

// Mean of the source texels under one texel of a map of `size`, each weighted by the solid angle of
// the overlap. Overlaps are counted in units of 1 / (source size * size), where both grids have
// integer edges.
vec4 solid_angle_mean(sampler2D source, uvec2 source_size, uvec2 texel, uvec2 size) {
    uvec2 low = texel * source_size;
    uvec2 high = low + source_size;
    uvec2 first = low / size;
    uvec2 last = (high - 1u) / size;
    float v_unit = 1.0 / (float(source_size.y) * float(size.y));
    vec4 sum = vec4(0.0);
    float weight_sum = 0.0;
    for (uint y = first.y; y <= last.y; ++y) {
        float v0 = float(max(y * size.y, low.y)) * v_unit;
        float v1 = float(min((y + 1u) * size.y, high.y)) * v_unit;
        float row_weight = cosine_difference(v0, v1);
        vec4 row_sum = vec4(0.0);
        uint overlap_sum = 0u;
        for (uint x = first.x; x <= last.x; ++x) {
            uint overlap = min((x + 1u) * size.x, high.x) - max(x * size.x, low.x);
            row_sum += float(overlap) * texelFetch(source, ivec2(x, y), 0);
            overlap_sum += overlap;
        }
        sum += row_weight * row_sum;
        weight_sum += row_weight * float(overlap_sum);
    }
    return sum / weight_sum;
}
