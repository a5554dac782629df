// Method `sampled`: importance sampling of D with few points, each lookup filtered by its solid
// angle.

#include "lib/filtered_sample.glsl"
#include "lib/importance_sampling.glsl"

vec3 specular_radiance(Surface s) {
    return importance_sampled_radiance(s, params.sample_count, params.point_count);
}
