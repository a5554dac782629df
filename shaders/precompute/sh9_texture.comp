// One invocation computes one texel of the irradiance texture: irradiance over pi of the direction at
// its centre, from nine radiance coefficients, floored at 0. [Kim22] Set 0: 0 SH9_COUNT radiance
// coefficients; 1 the equirectangular texture to write (rgba32f).

#include "lib/image_groups.glsl"
#include "lib/equirect.glsl"
#include "lib/sh.glsl"

layout(push_constant) uniform Push {
    MipsParams params;
};

layout(std430, set = 0, binding = 0) readonly buffer Coefficients {
    vec4 coefficients[SH9_COUNT];
};
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2D texture_of_irradiance;

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    vec3 n = direction_from_uv(uv_from_texel(texel, size));
    imageStore(texture_of_irradiance, ivec2(texel), vec4(max(sh9_irradiance_over_pi(coefficients, n), 0.0), 1.0));
}
