// One invocation adds the specular image-based radiance of one pixel, or what this dispatch's points give of it; pixels with mask 0 are left alone.
// Set 0: 0 position.xyz, mask; 1 normal.xyz, alpha; 2 albedo.rgb, metallic; 3 f0.rgb, material index; 4 environment
// with its mips; 5 its filtered levels; 6 prefiltered map with its levels; 7 DFG table; 8 lobe shapes; 9 sample points of this dispatch
// (lib/sampling.glsl); 10 radiance, a vec4 a pixel, row-major.
// Dispatch: ceil(width / GROUP_SIDE) x ceil(rows / GROUP_SIDE) groups, from row first_row on.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/compensation.glsl"
#include "lib/sampling.glsl"
#include "lib/sobol.glsl"
#include "lib/surface.glsl"
#include "selected/map_layout.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    ShadeParams params;
};

layout(set = 0, binding = 0) uniform sampler2D gbuffer_position;
layout(set = 0, binding = 1) uniform sampler2D gbuffer_normal;
layout(set = 0, binding = 2) uniform sampler2D gbuffer_albedo;
layout(set = 0, binding = 3) uniform sampler2D gbuffer_f0;
layout(set = 0, binding = 4) uniform sampler2D environment;
layout(set = 0, binding = 5) uniform FILTERED_MAP filtered_environment;
layout(set = 0, binding = 6) uniform FILTERED_MAP prefiltered;
layout(set = 0, binding = 7) uniform sampler2D dfg;
layout(set = 0, binding = 8) uniform sampler2D lobe_shapes;
layout(std140, set = 0, binding = 9) uniform Points {
    vec4 points[POINTS_PER_DISPATCH];
};
layout(std430, set = 0, binding = 10) buffer Radiance {
    vec4 radiance[];
};

// Whether pixels share their points, or each scrambles them: one of PIXEL_POINTS_*.
layout(constant_id = 4) const uint PIXEL_POINTS = PIXEL_POINTS_SHARED;
// The keys of this pixel's scrambles.
uvec2 pixel_keys;

vec4 sample_point(uint i) {
    if (PIXEL_POINTS == PIXEL_POINTS_SHARED) {
        return points[i];
    }
    return sample_point_from_xi(sobol_to_unit(owen_scrambled(points[i].xy, pixel_keys)));
}

// Outgoing specular radiance, for environment radiance as stored; the method reads the bindings above.
#include "selected/method.glsl"

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    if (pixel.x >= params.width || pixel.y >= params.height) {
        return;
    }
    ivec2 texel = ivec2(pixel);
    Surface world;
    if (!surface_from_gbuffer(texelFetch(gbuffer_position, texel, 0), texelFetch(gbuffer_normal, texel, 0),
                              texelFetch(gbuffer_albedo, texel, 0), texelFetch(gbuffer_f0, texel, 0), params.eye, world)) {
        return;
    }
    if (PIXEL_POINTS != PIXEL_POINTS_SHARED) {
        uint key = sobol_key(pixel, params.seed, 0u, PIXEL_STREAM);
        pixel_keys = sobol_next_pair_key(key);
    }
    Surface s = surface_in_environment(world, params);
    vec3 specular = params.environment_scale * specular_radiance(s);
    if (COMPENSATION != COMPENSATION_NONE) {
        specular *= compensation_factor(s.f0, albedo_pair(dfg, s.n_dot_v, s.alpha));
    }
    radiance[pixel.y * params.width + pixel.x] += vec4(specular, 0.0);
}
