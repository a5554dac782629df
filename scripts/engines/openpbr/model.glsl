// Babylon.js' OpenPBRMaterial: the lookup of `split-sum-babylon`, with the mean Fresnel factor where compensation `turquin` has F0, if
// the surface is a metal (computeConductorIblFresnel in openpbrIblFunctions, 9.35.0). To be used with `turquin`, whose factor it undoes.
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    vec3 lobe = prefiltered_radiance(reflect(-s.v, s.n), perceptual_roughness_from_alpha(s.alpha));
    vec2 a_b = albedo_pair(s);
    float lost = 1.0 / (a_b.x + a_b.y) - 1.0;
    vec3 average = mix(s.f0, s.f0 + (1.0 - s.f0) / 21.0, s.metallic);
    vec3 gain = (1.0 + average * lost) / (1.0 + s.f0 * lost);
    return mix(lobe, prefiltered_radiance(s.n, 1.0), s.alpha) * reflectance(s) * gain;
}
