// One invocation sets the radiance of one pixel with mask 0 to the environment behind it; pixels
// with mask 1 are left alone. Set 0: 0 position.xyz, mask; 1 normal.xyz, alpha; 2 albedo.rgb,
// metallic; 3 f0.rgb, material index; 5 environment (level 0 is read); 6 radiance, a vec4 a pixel,
// row-major.

#include "lib/image_groups.glsl"
#include "lib/camera.glsl"
#include "lib/equirect.glsl"

layout(push_constant) uniform Push {
    BackgroundParams params;
};

layout(set = 0, binding = 0) uniform sampler2D gbuffer_position;
layout(set = 0, binding = 5) uniform sampler2D environment;
layout(std430, set = 0, binding = 6) buffer Radiance {
    vec4 radiance[];
};

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    if (pixel.x >= params.width || pixel.y >= params.height) {
        return;
    }
    if (texelFetch(gbuffer_position, ivec2(pixel), 0).w != 0.0) {
        return;
    }
    uvec2 size = uvec2(params.width, params.height);
    vec3 d = ray_direction(pixel, size, params.right.xyz, params.up.xyz, params.forward.xyz);
    vec3 li = textureLod(environment, uv_from_direction(d), 0.0).rgb;
    radiance[pixel.y * params.width + pixel.x] = vec4(params.environment_scale * li, 0.0);
}
