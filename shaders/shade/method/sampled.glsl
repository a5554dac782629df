// Method `sampled`: importance sampling of D with fixed points, each lookup filtered by its solid angle.
#ifndef METHOD_SAMPLED_GLSL
#define METHOD_SAMPLED_GLSL

#include "lib/filtering.glsl"
#include "lib/importance_sampling.glsl"

// The level at which a texel covers the solid angle of the sample, moved by lod_bias. [Colbert07 section 20.4]
vec3 sampled_radiance(vec3 l, float omega_s) {
    MapPlace place = map_place(l);
    float omega_p = texel_solid_angle(place, vec2(textureSize(filtered_environment, 0)), max(omega_s, 0.0));
    float lod = lod_from_solid_angles(max(omega_s, 0.0), omega_p) + params.lod_bias;
    return map_radiance(filtered_environment, place, clamp(lod, 0.0, LOD_MAX));
}

vec3 specular_radiance(Surface s) {
    return importance_sampled_radiance(s, params.sample_count, params.point_count);
}

#endif
