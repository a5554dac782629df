// One invocation computes one texel of the irradiance map: irradiance over pi from nine radiance coefficients. [Kim22
// "Irradiance mapping"] Degree 2 can fall below 0 opposite to a strong light (to -4 % of its peak): floored at 0.
// Set 0: 0 the SH9_COUNT radiance coefficients; 1 the map to write (rgba32f).
// Dispatch: ceil(width / GROUP_SIDE) x ceil(height / GROUP_SIDE) groups.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/equirect.glsl"
#include "lib/sh.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    IrradianceParams params;
};

layout(std430, set = 0, binding = 0) readonly buffer Coefficients {
    vec4 coefficients[SH9_COUNT];
};
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2D irradiance_map;

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    vec3 n = direction_from_uv(uv_from_texel(texel, size));
    vec3 irradiance_over_pi = max(sh9_irradiance_over_pi(coefficients, n), 0.0);
    imageStore(irradiance_map, ivec2(texel), vec4(irradiance_over_pi, 1.0));
}
