// One invocation adds the radiance of every analytic light at one pixel, specular and diffuse; pixels with mask 0 are
// left alone.
// Set 0 after lib/shaded_pixel.glsl: 5 DFG table; 6 lights; 7 radiance, a vec4 a pixel.

#include "lib/diffuse.glsl"
#include "lib/frame.glsl"
#include "lib/light.glsl"
#include "lib/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/shaded_pixel.glsl"

layout(set = 0, binding = 5) uniform sampler2D dfg;
layout(std430, set = 0, binding = 6) readonly buffer Lights {
    LightData lights[];
};
layout(std430, set = 0, binding = 7) buffer Radiance {
    vec4 radiance[];
};

void main() {
    uvec2 pixel;
    Surface s;
    if (!shaded_pixel(pixel) || !surface_of_pixel(pixel, s)) {
        return;
    }
    vec3 position = texelFetch(gbuffer_position, ivec2(pixel), 0).xyz;
    mat3 frame = frame_of_surface(s);
    vec3 v_local = s.v * frame;
    vec3 diffuse = diffuse_albedo(s, dfg, params.flags) / PI;
    vec3 factor = vec3(1.0);
    if (COMPENSATION != COMPENSATION_NONE) {
        factor = compensation_factor(s.f0, albedo_pair(dfg, s.n_dot_v, s.alpha));
    }
    bool has_specular = (params.flags & SHADE_FLAG_NO_SPECULAR) == 0u;

    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) {
        LightSample light = light_at(lights[i], position);
        vec3 l_local = light.l * frame;
        if (l_local.z > 0.0) {
            vec3 f = diffuse;
            if (has_specular) {
                f += factor * eval_brdf(v_local, l_local, normalize(v_local + l_local), s.width, s.f0, MASKING);
            }
            sum += f * l_local.z * light.irradiance;
        }
    }
    radiance[index_of_pixel(pixel)] += vec4(sum, 0.0);
}
