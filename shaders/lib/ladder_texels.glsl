// The split sum with exact A and B in place of the DFG table; the methods differ in the map.
#pragma methods ladder-texels ladder-samples ladder-storage

#include "lib/directional_albedo.glsl"
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    vec3 mean_radiance = prefiltered_radiance(reflect(-s.v, s.n), perceptual_roughness_from_alpha(s.alpha));
    vec4 albedo = directional_albedo(s.n_dot_v, s.alpha, LADDER_NODES, MASKING);
    return mean_radiance * (s.f0 * albedo.x + albedo.y);
}
