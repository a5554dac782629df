// One invocation adds the diffuse image-based radiance of one pixel; pixels with mask 0 are left
// alone. Set 0 after lib/shaded_pixel.glsl: 5 map of irradiance over pi; 6 DFG table; 7 SH9_COUNT
// radiance coefficients; 8 texture of their irradiance over pi; 9 radiance, a vec4 a pixel.

#include "lib/diffuse.glsl"
#include "lib/shaded_pixel.glsl"
#include "selected/map_layout.glsl"
#include "selected/diffuse.glsl"

layout(set = 0, binding = 5) uniform FILTERED_MAP irradiance_map;
layout(set = 0, binding = 6) uniform sampler2D dfg;
layout(std430, set = 0, binding = 7) readonly buffer Coefficients {
    vec4 coefficients[SH9_COUNT];
};
layout(set = 0, binding = 8) uniform sampler2D sh9_texture;
layout(std430, set = 0, binding = 9) buffer Radiance {
    vec4 radiance[];
};

void main() {
    uvec2 pixel;
    Surface s;
    if (!shaded_pixel(pixel) || !surface_of_pixel(pixel, s)) {
        return;
    }
    vec3 irradiance = irradiance_over_pi(environment_from_world(s.n, params), irradiance_map, coefficients, sh9_texture);
    vec3 diffuse = params.environment_scale * diffuse_albedo(s, dfg, params.flags) * irradiance;
    radiance[index_of_pixel(pixel)] += vec4(diffuse, 0.0);
}
