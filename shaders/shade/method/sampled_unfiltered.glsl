// Method `sampled-unfiltered`: importance sampling of D with fixed points, each lookup from the
// environment itself.

#include "lib/equirect.glsl"
#include "lib/importance_sampling.glsl"

vec3 sampled_radiance(vec3 l, float omega_s) {
    return textureLod(environment, uv_from_direction(l), 0.0).rgb;
}

vec3 specular_radiance(Surface s) {
    return importance_sampled_radiance(s, params.sample_count, params.point_count);
}
