// Method `split-sum`: the mean radiance of the lobe for n = v = r, times the albedo of the lobe for constant radiance.
#ifndef METHOD_SPLIT_SUM_GLSL
#define METHOD_SPLIT_SUM_GLSL

#include "lib/prefilter_mapping.glsl"
#include "lib/surface.glsl"

// [Karis13 eq. 7, 8]
vec3 specular_radiance(Surface s) {
    vec3 r = reflect(-s.v, s.n);
    float lod = lod_from_perceptual_roughness(perceptual_roughness_from_alpha(s.alpha), params.prefilter_level_count);
    vec3 mean_radiance = map_radiance(prefiltered, map_place(r), lod);
    vec2 a_b = textureLod(dfg, dfg_uv(s.n_dot_v, s.alpha), 0.0).rg;
    return mean_radiance * (s.f0 * a_b.x + a_b.y);
}

#endif
