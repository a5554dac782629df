// A sample's lookup in the filtered levels of the environment, at the level of its solid angle.

#include "lib/filtering.glsl"

// Coarser than any chain.
const float LOD_MAX = 32.0;

// The level at which a texel covers the solid angle of the sample (sr), moved by lod_bias.
// [Colbert07 section 20.4]
vec3 sampled_radiance(vec3 l, float omega_s) {
    MapPlace place = map_place(l);
    float omega_p = texel_solid_angle(place, vec2(textureSize(filtered_environment, 0)), max(omega_s, 0.0));
    float lod = lod_from_solid_angles(max(omega_s, 0.0), omega_p) + params.lod_bias;
    return map_radiance(filtered_environment, place, clamp(lod, 0.0, LOD_MAX));
}
