// SAPIEN: level 5r along r, of levels filtered for roughness k/4, so roughness 0.8 to 1 read the last one. The diffuse term is the last
// level too, along n, and keeps the light that the specular term reflects (specularIBL, diffuseIBL in default/deferred.frag).
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    float roughness = min(1.25 * perceptual_roughness_from_alpha(s.alpha), 1.0);
    vec3 diffuse = s.albedo * (1.0 - s.metallic) * prefiltered_radiance(s.n, 1.0);
    return prefiltered_radiance(reflect(-s.v, s.n), roughness) * reflectance(s) + diffuse;
}
