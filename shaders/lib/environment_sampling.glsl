// The environment as a light: exact bilinear radiance, and importance sampling proportional to its luminance above a threshold,
// with the density of the bilinear map itself. Where the density is 0 the lobe must sample. The tables, their layout and the derivation: src/environment/distribution.rs.
//
// A texel of the environment holds its radiance (rgb) and its sampling weight (a). Directions are in the environment's frame.
//
// The filtering units of GPUs interpolate with weights of about 8 bits, which shows as steps on magnified suns: there the four texels
// are fetched and weighted in f32. A driver that filters in full f32 (EXACT_FILTER) does the same in one lookup.
#ifndef ENVIRONMENT_SAMPLING_GLSL
#define ENVIRONMENT_SAMPLING_GLSL

#include "lib/equirect.glsl"

// The word at `index` of `EnvironmentDistribution::words`: the entry point that has the buffer defines it.
uint environment_word(uint index);

// 1 when the driver's bilinear filter computes in f32.
layout(constant_id = 1) const uint EXACT_FILTER = 0u;

// Where the tables lie.
struct EnvironmentTables {
    uint width;
    uint height;
    uint band_shift;
    uint column_shift;
    uint conditional_base;
    uint conditional_stride;
};

// Radiance from a direction and the density (1/sr) with which `environment_sample` returns that direction.
struct EnvironmentSample {
    vec3 l;
    vec3 li;
    float pdf_l;
};

// log2 of the guide entries of a distribution over `count` intervals; the twin is `guide_bits`.
uint environment_guide_bits(uint count) {
    return uint(max(findMSB(count - 1u) + 1, 1));
}

EnvironmentTables environment_tables(uint width, uint height) {
    uint band_count = height + 1u;
    uint band_bits = environment_guide_bits(band_count);
    uint column_bits = environment_guide_bits(width);
    return EnvironmentTables(width, height, 32u - band_bits, 32u - column_bits,
        band_count + (band_count + 1u) + (1u << band_bits), (width + 1u) + (1u << column_bits));
}

// Interval of the distribution at `base` that holds `xi`; `fraction` is the place inside it, in (0, 1).
uint environment_invert(uint base, uint count, uint shift, uint xi, out float fraction) {
    // The largest value is the end of the last interval, which belongs to none.
    xi = min(xi, 0xfffffffeu);
    uint span = environment_word(base + count + 1u + (xi >> shift));
    uint low = span & 0xffffu;
    uint high = span >> 16;
    while (low < high) {
        uint middle = (low + high + 1u) >> 1;
        if (environment_word(base + middle) <= xi) {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    uint start = environment_word(base + low);
    uint end = environment_word(base + low + 1u);
    fraction = (float(xi - start) + 0.5) / float(end - start);
    return low;
}

// The four texels around cell `column` of `band`: (x0, y0), (x1, y0), (x0, y1), (x1, y1).
void environment_cell(sampler2D environment, EnvironmentTables tables, uint band, uint column, out vec4 texels[4]) {
    int x0 = int(column);
    int x1 = column + 1u == tables.width ? 0 : x0 + 1;
    int y0 = max(int(band) - 1, 0);
    int y1 = min(int(band), int(tables.height) - 1);
    texels[0] = texelFetch(environment, ivec2(x0, y0), 0);
    texels[1] = texelFetch(environment, ivec2(x1, y0), 0);
    texels[2] = texelFetch(environment, ivec2(x0, y1), 0);
    texels[3] = texelFetch(environment, ivec2(x1, y1), 0);
}

// Density per solid angle where the interpolated weight is `weight`.
float environment_pdf(float weight, uint band, float sin_theta) {
    return weight * uintBitsToFloat(environment_word(band)) / max(sin_theta, ENVIRONMENT_SIN_THETA_MIN);
}

vec4 environment_bilinear(vec4 texels[4], vec2 t) {
    return mix(mix(texels[0], texels[1], t.x), mix(texels[2], texels[3], t.x), t.y);
}

// Inverse of the distribution of x in [0, 1] whose density is linear from `p0` at 0 to `p1` at 1 (each >= 0, any scale),
// for xi in (0, 1].
float environment_invert_linear(float p0, float p1, float xi) {
    float total = p0 + p1;
    // Both ends 0: the cell holds no light, any point will do.
    if (total <= 0.0) {
        return xi;
    }
    // x = xi / (q0 + sqrt(mix(q0^2, q1^2, xi))) with q = p / total: the root of the quadratic that does not cancel.
    float q0 = p0 / total;
    float q1 = p1 / total;
    return xi / (q0 + sqrt(mix(q0 * q0, q1 * q1, xi)));
}

// Radiance from the unit direction `l` and the density of `environment_sample` there. `environment` is read by texel,
// `environment_linear` is the same level through a bilinear sampler (u repeats, v clamps).
EnvironmentSample environment_eval(sampler2D environment, sampler2D environment_linear, EnvironmentTables tables, vec3 l) {
    vec3 uv_sin_theta = uv_sin_theta_from_direction(l);
    vec2 texel = uv_sin_theta.xy * vec2(tables.width, tables.height) - 0.5;
    vec2 corner = floor(texel);
    uint band = uint(clamp(int(corner.y) + 1, 0, int(tables.height)));
    vec4 light;
    if (EXACT_FILTER != 0u) {
        light = textureLod(environment_linear, uv_sin_theta.xy, 0.0);
    } else {
        int x0 = int(corner.x);
        x0 = x0 < 0 ? x0 + int(tables.width) : min(x0, int(tables.width) - 1);
        vec4 texels[4];
        environment_cell(environment, tables, band, uint(x0), texels);
        light = environment_bilinear(texels, texel - corner);
    }
    return EnvironmentSample(l, light.rgb, environment_pdf(light.a, band, uv_sin_theta.z));
}

// A direction from a fixed-point pair: x selects the column, y the band. Density 0 means that no light is above the threshold
// anywhere: the sample must not be used.
EnvironmentSample environment_sample(sampler2D environment, EnvironmentTables tables, uvec2 xi) {
    vec2 fraction;
    uint band_count = tables.height + 1u;
    uint band = environment_invert(band_count, band_count, tables.band_shift, xi.y, fraction.y);
    uint row = tables.conditional_base + band * tables.conditional_stride;
    uint column = environment_invert(row, tables.width, tables.column_shift, xi.x, fraction.x);

    vec4 texels[4];
    environment_cell(environment, tables, band, column, texels);
    vec2 t;
    t.y = environment_invert_linear(texels[0].a + texels[1].a, texels[2].a + texels[3].a, fraction.y);
    t.x = environment_invert_linear(mix(texels[0].a, texels[2].a, t.y), mix(texels[1].a, texels[3].a, t.y), fraction.x);
    vec4 light = environment_bilinear(texels, t);

    // The first and the last band are half a texel high: v clamps there.
    float top = max(float(band) - 0.5, 0.0);
    float bottom = min(float(band) + 0.5, float(tables.height));
    vec3 l = direction_from_uv(
        vec2((float(column) + 0.5 + t.x) / float(tables.width), mix(top, bottom, t.y) / float(tables.height)));
    return EnvironmentSample(l, light.rgb, environment_pdf(light.a, band, length(l.xz)));
}

#endif
