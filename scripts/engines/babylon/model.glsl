// Babylon.js: the map along r, mixed with irradiance by alpha (MIX_IBL_RADIANCE_WITH_IRRADIANCE, pbrBlockReflection, on by default).
// The level of roughness 1 is irradiance over pi.
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    vec3 lobe = prefiltered_radiance(reflect(-s.v, s.n), perceptual_roughness_from_alpha(s.alpha));
    return mix(lobe, prefiltered_radiance(s.n, 1.0), s.alpha) * reflectance(s);
}
