// One invocation adds the radiance of every analytic light at one pixel, specular and diffuse; pixels with mask 0 are
// left alone.
// Set 0: 0 position.xyz, mask; 1 normal.xyz, alpha; 2 albedo.rgb, metallic; 3 f0.rgb, material index; 4 DFG table; 5
// lights; 6 radiance, a vec4 a pixel, row-major.
// Dispatch: ceil(width / GROUP_SIDE) x ceil(rows / GROUP_SIDE) groups, from row first_row on.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/diffuse.glsl"
#include "lib/frame.glsl"
#include "lib/light.glsl"
#include "lib/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/surface.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    ShadeParams params;
};

layout(set = 0, binding = 0) uniform sampler2D gbuffer_position;
layout(set = 0, binding = 1) uniform sampler2D gbuffer_normal;
layout(set = 0, binding = 2) uniform sampler2D gbuffer_albedo;
layout(set = 0, binding = 3) uniform sampler2D gbuffer_f0;
layout(set = 0, binding = 4) uniform sampler2D dfg;
layout(std430, set = 0, binding = 5) readonly buffer Lights {
    LightData lights[];
};
layout(std430, set = 0, binding = 6) buffer Radiance {
    vec4 radiance[];
};

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    if (pixel.x >= params.width || pixel.y >= params.height) {
        return;
    }
    ivec2 texel = ivec2(pixel);
    vec4 position = texelFetch(gbuffer_position, texel, 0);
    Surface s;
    if (!surface_from_gbuffer(position, texelFetch(gbuffer_normal, texel, 0),
                              texelFetch(gbuffer_albedo, texel, 0), texelFetch(gbuffer_f0, texel, 0), params.eye, s)) {
        return;
    }
    mat3 frame = frame_from_normal(s.n);
    vec3 v_local = s.v * frame;
    vec3 diffuse = diffuse_albedo(s, dfg, params.flags) / PI;
    vec3 factor = vec3(1.0);
    if (COMPENSATION != COMPENSATION_NONE) {
        factor = compensation_factor(s.f0, albedo_pair(dfg, s.n_dot_v, s.alpha));
    }
    bool has_specular = (params.flags & SHADE_FLAG_NO_SPECULAR) == 0u;

    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) {
        LightSample light = light_at(lights[i], position.xyz);
        vec3 l_local = light.l * frame;
        if (l_local.z > 0.0) {
            vec3 f = diffuse;
            if (has_specular) {
                f += factor * eval_brdf(v_local, l_local, normalize(v_local + l_local), s.alpha, s.f0, MASKING);
            }
            sum += f * l_local.z * light.irradiance;
        }
    }
    radiance[pixel.y * params.width + pixel.x] += vec4(sum, 0.0);
}
