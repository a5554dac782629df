// Babylon.js' OpenPBRMaterial on a lobe of two widths: 16 lookups along r of normals that lean to the tangent, at the narrow width;
// mixed with irradiance by alpha^2; a metal's compensation as in model.glsl, since #include finds files of shaders/ only
// (sampleRadianceAnisotropic in openpbrIblFunctions, openpbrEnvironmentLighting, 9.35.0).
#include "lib/split_sum.glsl"

const int LOOKUPS = 16;

vec3 specular_radiance(Surface s) {
    mat3 frame = frame_of_surface(s);
    float anisotropy = 1.0 - s.width.y / s.width.x;
    float roughness = perceptual_roughness_from_alpha(s.width.y);
    float reach = min(4.0 * s.width.x * anisotropy, 1.0);
    float spacing = 2.0 / float(LOOKUPS - 1);
    vec3 sum = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < LOOKUPS; i++) {
        // Noise shifts them in the engine; its mean is 0.
        float t = -1.0 + float(i) * spacing;
        float weight = max(1.0 - abs(t), 0.001);
        weight *= weight;
        float lean = t * reach;
        vec3 side = lean < 0.0 ? -frame[0] : frame[0];
        // It blends from the negative tangent at -1, and to the tangent at 1.
        vec3 normal = normalize(mix(s.n, side, abs(lean)));
        sum += weight * prefiltered_radiance(reflect(-s.v, normal), roughness);
        total += weight;
    }
    vec3 irradiance = prefiltered_radiance(s.n, 1.0);
    float share = s.alpha * s.alpha * max(1.0 - anisotropy, 0.3);
    vec2 a_b = albedo_pair(s);
    float lost = 1.0 / (a_b.x + a_b.y) - 1.0;
    vec3 average = mix(s.f0, s.f0 + (1.0 - s.f0) / 21.0, s.metallic);
    vec3 gain = (1.0 + average * lost) / (1.0 + s.f0 * lost);
    return mix(sum / total, irradiance, share) * reflectance(s) * gain;
}
