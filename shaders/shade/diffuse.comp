// One invocation adds the diffuse image-based radiance of one pixel; pixels with mask 0 are left alone.
// Set 0: 0 position.xyz, mask; 1 normal.xyz, alpha; 2 albedo.rgb, metallic; 3 f0.rgb, material index; 4 map of
// irradiance over pi; 5 DFG table; 6 SH9_COUNT radiance coefficients; 7 radiance, a vec4 a pixel, row-major.
// Dispatch: ceil(width / GROUP_SIDE) x ceil(rows / GROUP_SIDE) groups, from row first_row on.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/diffuse.glsl"
#include "lib/surface.glsl"
#include "selected/map_layout.glsl"
#include "selected/diffuse.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    ShadeParams params;
};

layout(set = 0, binding = 0) uniform sampler2D gbuffer_position;
layout(set = 0, binding = 1) uniform sampler2D gbuffer_normal;
layout(set = 0, binding = 2) uniform sampler2D gbuffer_albedo;
layout(set = 0, binding = 3) uniform sampler2D gbuffer_f0;
layout(set = 0, binding = 4) uniform FILTERED_MAP irradiance_map;
layout(set = 0, binding = 5) uniform sampler2D dfg;
layout(std430, set = 0, binding = 6) readonly buffer Coefficients {
    vec4 coefficients[SH9_COUNT];
};
layout(std430, set = 0, binding = 7) buffer Radiance {
    vec4 radiance[];
};

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    if (pixel.x >= params.width || pixel.y >= params.height) {
        return;
    }
    ivec2 texel = ivec2(pixel);
    Surface s;
    if (!surface_from_gbuffer(texelFetch(gbuffer_position, texel, 0), texelFetch(gbuffer_normal, texel, 0),
                              texelFetch(gbuffer_albedo, texel, 0), texelFetch(gbuffer_f0, texel, 0), params.eye, s)) {
        return;
    }
    vec3 irradiance = irradiance_over_pi(environment_from_world(s.n, params), irradiance_map, coefficients);
    vec3 diffuse = params.environment_scale * diffuse_albedo(s, dfg, params.flags) * irradiance;
    radiance[pixel.y * params.width + pixel.x] += vec4(diffuse, 0.0);
}
