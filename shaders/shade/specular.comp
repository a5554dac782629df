// One invocation adds the specular image-based radiance of one pixel, or the part of this
// dispatch's points; pixels with mask 0 are left alone. Set 0 after lib/shaded_pixel.glsl: 5
// environment with its mips; 6 its filtered levels; 7 prefiltered map with its levels; 8 DFG table;
// 9 table of taps; 10 sample points of this dispatch (lib/sampling.glsl); 11 radiance, a vec4 a
// pixel; 12 shifts of each pixel's points as fixed point.

#include "generated/specialization/pixel_points.glsl"
#include "lib/bend.glsl"
#include "lib/compensation.glsl"
#include "lib/sampling.glsl"
#include "lib/shaded_pixel.glsl"
#include "lib/sobol.glsl"
#include "selected/map_layout.glsl"

layout(set = 0, binding = 5) uniform sampler2D environment;
layout(set = 0, binding = 6) uniform FILTERED_MAP filtered_environment;
layout(set = 0, binding = 7) uniform FILTERED_MAP prefiltered;
layout(set = 0, binding = 8) uniform sampler2D dfg;
// A method reads one of these at most.
layout(set = 0, binding = 9) uniform sampler2D one_tap;
layout(set = 0, binding = 9) uniform sampler2D two_taps;
layout(set = 0, binding = 9) uniform sampler2D four_taps;
layout(std140, set = 0, binding = 10) uniform Points {
    vec4 points[POINTS_PER_DISPATCH];
};
layout(std430, set = 0, binding = 11) buffer Radiance {
    vec4 radiance[];
};
layout(std430, set = 0, binding = 12) readonly buffer Shifts {
    uvec2 shifts[];
};

// The keys of this pixel's scrambles, or its shift.
uvec2 pixel_keys;

vec4 sample_point(uint i) {
    if (PIXEL_POINTS == PIXEL_POINTS_SHARED) {
        return points[i];
    }
    if (PIXEL_POINTS == PIXEL_POINTS_SHIFTED) {
        return sample_point_from_xi(sobol_to_unit(uvec2(points[i].xy * exp2(32.0)) + pixel_keys));
    }
    return sample_point_from_xi(sobol_to_unit(owen_scrambled(points[i].xy, pixel_keys)));
}

// Outgoing specular radiance, for environment radiance as stored; the method reads the bindings
// above.
#include "selected/method.glsl"

void main() {
    uvec2 pixel;
    Surface world;
    if (!shaded_pixel(pixel) || !surface_of_pixel(pixel, world)) {
        return;
    }
    if (PIXEL_POINTS == PIXEL_POINTS_SHIFTED) {
        pixel_keys = shifts[index_of_pixel(pixel)];
    } else if (PIXEL_POINTS != PIXEL_POINTS_SHARED) {
        uint key = sobol_key(pixel, params.seed, 0u, PIXEL_STREAM);
        pixel_keys = sobol_next_pair_key(key);
    }
    Surface s = surface_in_environment(world, params);
    vec3 specular = params.environment_scale * specular_radiance(s);
    if (COMPENSATION != COMPENSATION_NONE) {
        float alpha = table_alpha(s);
        specular *= compensation_factor(s.f0, albedo_pair(dfg, s.n_dot_v, alpha), dfg, alpha);
    }
    radiance[index_of_pixel(pixel)] += vec4(specular, 0.0);
}
