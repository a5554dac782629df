// PlayCanvas: the map along r, times a Fresnel factor without masking (getFresnel, fresnelSchlick.js). It rises at grazing views to the
// largest channel of F0 times gloss², so a grey material has F0 at every angle.
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    float roughness = perceptual_roughness_from_alpha(s.alpha);
    float gloss = 1.0 - roughness;
    vec3 grazing = max(s.f0, gloss * gloss * max(s.f0.r, max(s.f0.g, s.f0.b)));
    vec3 fresnel = s.f0 + (grazing - s.f0) * pow(1.0 - s.n_dot_v, 5.0);
    return prefiltered_radiance(reflect(-s.v, s.n), roughness) * fresnel;
}
