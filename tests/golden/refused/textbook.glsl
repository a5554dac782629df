#include "lib/split_sum.glsl"
vec3 specular_radiance(Surface s) {
    return prefiltered_radiance(reflect(-s.v, s.n), perceptual_roughness_from_alpha(s.alpha)) * reflectance(s);
}
