// The two factors of a split sum, looked up in the tables that shade/specular.comp binds.

#include "lib/prefilter_mapping.glsl"
#include "lib/surface.glsl"

// Mean radiance of the lobe of that perceptual roughness for n = v = direction.
vec3 prefiltered_radiance(vec3 direction, float perceptual_roughness) {
    float lod = lod_from_perceptual_roughness(perceptual_roughness, params.prefilter_level_count);
    return map_radiance(prefiltered, map_place(direction), lod);
}

// (A, B): of constant radiance the lobe reflects f0 A + B.
vec2 albedo_pair(Surface s) {
    return albedo_pair(dfg, s.n_dot_v, s.alpha);
}

vec3 reflectance(Surface s) {
    vec2 a_b = albedo_pair(s);
    return s.f0 * a_b.x + a_b.y;
}

// The share of the reflected light that has the weight Fc, for any f0; a colour counts by its mean.
float share_of_f90(Surface s, vec2 a_b) {
    return a_b.y / (dot(s.f0, vec3(1.0 / 3.0)) * a_b.x + a_b.y);
}
