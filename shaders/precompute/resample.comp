// One invocation computes one texel of the finest level of a filtered map: the mean of the
// environment over the texel's solid angle, by RESAMPLE_SIDE^2 cells, each weighted by its solid
// angle. Near a pole, where a cell spans many texels of the source's row, it takes their mean. a
// holds the texel's solid angle (sr). Set 0: 0 environment (level 0 is read); 1 the level to write
// (rgba32f), a layer a face.

#include "lib/image_groups.glsl"
#include "lib/equirect.glsl"
#include "selected/map_layout.glsl"

layout(push_constant) uniform Push {
    ResampleParams params;
};

layout(set = 0, binding = 0) uniform sampler2D environment;
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2DArray level;

// Bilinear; u wraps, v clamps. A hardware filter may weigh by 8 bits.
vec3 environment_radiance(vec2 uv, ivec2 size) {
    vec2 at = uv * vec2(size) - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 part = at - floor(at);
    ivec2 columns = (ivec2(low.x, low.x + 1) % size.x + size.x) % size.x;
    ivec2 rows = clamp(ivec2(low.y, low.y + 1), ivec2(0), ivec2(size.y - 1));
    vec3 top = mix(texelFetch(environment, ivec2(columns.x, rows.x), 0).rgb,
                   texelFetch(environment, ivec2(columns.y, rows.x), 0).rgb, part.x);
    vec3 bottom = mix(texelFetch(environment, ivec2(columns.x, rows.y), 0).rgb,
                      texelFetch(environment, ivec2(columns.y, rows.y), 0).rgb, part.x);
    return mix(top, bottom, part.y);
}

void main() {
    uvec3 texel = gl_GlobalInvocationID + uvec3(0u, params.first_row, 0u);
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    ivec2 source_size = ivec2(params.source_width, params.source_height);
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < RESAMPLE_SIDE * RESAMPLE_SIDE; ++i) {
        vec2 inside = (vec2(i % RESAMPLE_SIDE, i / RESAMPLE_SIDE) + 0.5) / float(RESAMPLE_SIDE);
        vec3 d = direction_from_texel(texel, inside, vec2(size));
        float omega = texel_solid_angle(map_place(d), vec2(size), 0.0) / float(RESAMPLE_SIDE * RESAMPLE_SIDE);
        vec3 uv_sin_theta = uv_sin_theta_from_direction(d);
        // Part of a turn that the cell spans, and texels in it.
        float span = min(sqrt(omega) / (2.0 * PI * max(uv_sin_theta.z, 1e-6)), 1.0);
        uint tap_count = uint(ceil(span * float(source_size.x)));
        vec3 radiance = vec3(0.0);
        for (uint k = 0u; k < tap_count; ++k) {
            float shift = ((float(k) + 0.5) / float(tap_count) - 0.5) * span;
            radiance += environment_radiance(uv_sin_theta.xy + vec2(shift, 0.0), source_size);
        }
        sum += omega * vec4(radiance / float(tap_count), 1.0);
    }
    imageStore(level, ivec3(texel), vec4(sum.rgb / sum.a, sum.a));
}
