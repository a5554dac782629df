// One invocation adds the light of all direct lights that one lobe of the reference reflects at one
// pixel: the sum of f(v, l) n.l E over the lights, without samples; pixels with mask 0 are left
// alone. Everything is in world axes. Set 0 after lib/shaded_pixel.glsl: 5 DFG table; 6 lights; 7
// radiance, a vec4 a pixel.

#include "lib/light.glsl"
#include "lib/shaded_pixel.glsl"

layout(set = 0, binding = 5) uniform sampler2D dfg;
layout(std430, set = 0, binding = 6) readonly buffer Lights {
    LightData lights[];
};
layout(std430, set = 0, binding = 7) buffer Radiance {
    vec4 radiance[];
};

#include "selected/lobe.glsl"
#include "lib/resolved_weight.glsl"

void main() {
    uvec2 pixel;
    Surface s;
    if (!shaded_pixel(pixel) || !surface_of_pixel(pixel, s)) {
        return;
    }
    vec3 position = texelFetch(gbuffer_position, ivec2(pixel), 0).xyz;
    Lobe lobe = lobe_at(s, params);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) {
        LightSample light = light_at(lights[i], position);
        vec3 l_local = light.l * lobe.frame;
        if (l_local.z > 0.0) {
            sum += lobe_eval(lobe, l_local).value_cos * light.irradiance;
        }
    }
    radiance[index_of_pixel(pixel)] += vec4(resolved_weight(s, dfg, params.flags) * sum, 0.0);
}
