// The environment as a light: exact bilinear radiance, and importance sampling proportional to its
// luminance above a threshold, guided to the cells of a lobe, with its exact density. If the
// density is 0, only the lobe samples the direction. The tables, their layout and the derivation:
// src/instrument/environment/distribution.rs.
//
// A texel of the environment holds radiance (rgb) and sampling weight (a). Directions are in the
// environment's frame.
//
// The filtering units of GPUs interpolate with weights of about 8 bits, which shows as steps on
// magnified suns: there the four texels are fetched and weighted in f32. A driver that filters in
// f32 (EXACT_FILTER) needs one lookup.

#include "generated/specialization/exact_filter.glsl"
#include "lib/equirect.glsl"

// The word at `index` of `EnvironmentDistribution::words`: the entry point that has the buffer
// defines it.
uint environment_word(uint index);

const uint CELL_COUNT = CELL_COLUMNS * CELL_ROWS;

// Sizes and positions of the tables.
struct EnvironmentTables {
    uint width;
    uint height;
    uint cell_width;
    uint cell_height;
    uint cells_base;
    uint slots_base;
    uint blocks_base;
};

// The guide of this invocation: of each slot its weight, and the sum of mass times weight up to it
// and with it. `environment_guide` must have been called for every slot, in order.
float environment_guide_weights[CELL_COUNT];
float environment_guide_ends[CELL_COUNT];
uint environment_guide_count = 0u;
float environment_guide_sum = 0.0;

// Gives the next slot, which holds the share `mass` of all light, its weight.
void environment_guide(float mass, float weight) {
    environment_guide_sum += mass * weight;
    environment_guide_weights[environment_guide_count] = weight;
    environment_guide_ends[environment_guide_count] = environment_guide_sum;
    environment_guide_count += 1u;
}

// Guided over plain density in a slot's cell.
float environment_guide_factor(uint slot) {
    return environment_guide_sum > 0.0 ? environment_guide_weights[slot] / environment_guide_sum : 0.0;
}

// Radiance from a direction and the density (1/sr) with which `environment_sample` returns that
// direction.
struct EnvironmentSample {
    vec3 l;
    vec3 li;
    float pdf_l;
};

EnvironmentTables environment_tables(uint width, uint height) {
    uint band_count = height + 1u;
    uint slots_base = band_count + CELL_COUNT;
    return EnvironmentTables(width, height, (width + CELL_COLUMNS - 1u) / CELL_COLUMNS,
        (band_count + CELL_ROWS - 1u) / CELL_ROWS, band_count, slots_base, slots_base + CELL_COUNT);
}

// First step of a search among `count` intervals: as many steps for every lane, without branches.
uint environment_search_step(uint count) {
    return count > 1u ? 1u << findMSB(count - 1u) : 0u;
}

// Interval of the distribution over `count` intervals at `base` that holds `xi`; `fraction`: place
// in it, in (0, 1).
uint environment_invert(uint base, uint count, uint xi, out float fraction) {
    // The largest value is the end of the last interval, which belongs to none.
    xi = min(xi, 0xfffffffeu);
    uint low = 0u;
    for (uint step = environment_search_step(count); step > 0u; step >>= 1) {
        uint next = min(low + step, count - 1u);
        low = environment_word(base + next) <= xi ? next : low;
    }
    uint start = environment_word(base + low);
    uint end = environment_word(base + low + 1u);
    fraction = (float(xi - start) + 0.5) / float(end - start);
    return low;
}

// Slot of the guide that holds `xi`; `fraction` is the place inside it as fixed point.
uint environment_invert_guide(uint xi, out uint fraction) {
    float place = float(xi >> 8) * exp2(-24.0) * environment_guide_sum;
    uint low = 0u;
    for (uint step = environment_search_step(environment_guide_count); step > 0u; step >>= 1) {
        uint next = min(low + step, environment_guide_count - 1u);
        low = environment_guide_ends[next - 1u] <= place ? next : low;
    }
    float start = low > 0u ? environment_guide_ends[low - 1u] : 0.0;
    // The bits that `place` cannot hold matter in slots with little light.
    float inside = (place - start) + (float(xi & 0xffu) + 0.5) * exp2(-32.0) * environment_guide_sum;
    float size = max(environment_guide_ends[low] - start, 1e-30);
    // Below 1, so that the product fits.
    fraction = uint(clamp(inside / size, 0.0, 1.0 - 6e-8) * 4294967296.0);
    return low;
}

// The four texels around the place right of `column` in `band`: (x0, y0), (x1, y0), (x0, y1), (x1,
// y1).
void environment_texels(sampler2D environment, EnvironmentTables tables, uint band, uint column, out vec4 texels[4]) {
    int x0 = int(column);
    int x1 = column + 1u == tables.width ? 0 : x0 + 1;
    int y0 = max(int(band) - 1, 0);
    int y1 = min(int(band), int(tables.height) - 1);
    texels[0] = texelFetch(environment, ivec2(x0, y0), 0);
    texels[1] = texelFetch(environment, ivec2(x1, y0), 0);
    texels[2] = texelFetch(environment, ivec2(x0, y1), 0);
    texels[3] = texelFetch(environment, ivec2(x1, y1), 0);
}

// Density per solid angle for the interpolated weight `weight`.
float environment_pdf(float weight, uint band, float sin_theta) {
    return weight * uintBitsToFloat(environment_word(band)) / max(sin_theta, ENVIRONMENT_SIN_THETA_MIN);
}

vec4 environment_bilinear(vec4 texels[4], vec2 t) {
    return mix(mix(texels[0], texels[1], t.x), mix(texels[2], texels[3], t.x), t.y);
}

// The x in [0, 1] at xi in (0, 1] of the distribution with density linear from `p0` to `p1` (each
// >= 0, any scale).
float environment_invert_linear(float p0, float p1, float xi) {
    float total = p0 + p1;
    // Both ends 0: the cell holds no light, any point will do.
    if (total <= 0.0) {
        return xi;
    }
    // x = xi / (q0 + sqrt(mix(q0^2, q1^2, xi))) with q = p / total: the root of the quadratic that
    // does not cancel.
    float q0 = p0 / total;
    float q1 = p1 / total;
    return xi / (q0 + sqrt(mix(q0 * q0, q1 * q1, xi)));
}

// Radiance from the unit direction `l` and the density of `environment_sample` there. `environment`
// is read by texel, `environment_linear` is the same level through a bilinear sampler (u repeats, v
// clamps).
EnvironmentSample environment_eval(sampler2D environment, sampler2D environment_linear, EnvironmentTables tables, vec3 l) {
    vec3 uv_sin_theta = uv_sin_theta_from_direction(l);
    vec2 texel = uv_sin_theta.xy * vec2(tables.width, tables.height) - 0.5;
    vec2 corner = floor(texel);
    uint band = uint(clamp(int(corner.y) + 1, 0, int(tables.height)));
    int column = int(corner.x);
    column = column < 0 ? column + int(tables.width) : min(column, int(tables.width) - 1);
    uint cell = band / tables.cell_height * CELL_COLUMNS + uint(column) / tables.cell_width;
    vec4 light;
    if (EXACT_FILTER != 0u) {
        light = textureLod(environment_linear, uv_sin_theta.xy, 0.0);
    } else {
        vec4 texels[4];
        environment_texels(environment, tables, band, uint(column), texels);
        light = environment_bilinear(texels, texel - corner);
    }
    float factor = environment_guide_factor(environment_word(tables.slots_base + cell));
    return EnvironmentSample(l, light.rgb, factor * environment_pdf(light.a, band, uv_sin_theta.z));
}

// A direction from a fixed-point pair: y selects slot and band, x the column. Density 0 means that
// no light is above the threshold anywhere: the sample must not be used.
EnvironmentSample environment_sample(sampler2D environment, EnvironmentTables tables, uvec2 xi) {
    uint fraction_in_slot;
    uint slot = environment_invert_guide(xi.y, fraction_in_slot);
    uint cell = environment_word(tables.cells_base + slot);
    uint row_len = tables.cell_width + 1u;
    uint block = tables.blocks_base + slot * (tables.cell_height + 1u + tables.cell_height * row_len);
    vec2 fraction;
    uint row = environment_invert(block, tables.cell_height, fraction_in_slot, fraction.y);
    uint row_base = block + tables.cell_height + 1u + row * row_len;
    uint column = cell % CELL_COLUMNS * tables.cell_width
        + environment_invert(row_base, tables.cell_width, xi.x, fraction.x);
    uint band = cell / CELL_COLUMNS * tables.cell_height + row;

    vec4 texels[4];
    environment_texels(environment, tables, band, column, texels);
    vec2 t;
    t.y = environment_invert_linear(texels[0].a + texels[1].a, texels[2].a + texels[3].a, fraction.y);
    t.x = environment_invert_linear(mix(texels[0].a, texels[2].a, t.y), mix(texels[1].a, texels[3].a, t.y), fraction.x);
    vec4 light = environment_bilinear(texels, t);

    // The first and the last band are half a texel high: v clamps there.
    float top = max(float(band) - 0.5, 0.0);
    float bottom = min(float(band) + 0.5, float(tables.height));
    vec3 l = direction_from_uv(
        vec2((float(column) + 0.5 + t.x) / float(tables.width), mix(top, bottom, t.y) / float(tables.height)));
    float pdf_l = environment_guide_factor(slot) * environment_pdf(light.a, band, length(l.xz));
    return EnvironmentSample(l, light.rgb, pdf_l);
}
