// Method `split-sum`: the mean radiance of the lobe for n = v = r, times the albedo of the lobe for
// constant radiance.

#include "lib/split_sum.glsl"

// [Karis13 eq. 7, 8]
vec3 specular_radiance(Surface s) {
    return prefiltered_radiance(reflect(-s.v, s.n), perceptual_roughness_from_alpha(s.alpha)) * reflectance(s);
}
