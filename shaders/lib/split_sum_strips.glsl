// Split sums of a lobe of two widths by several lookups;
// src/instrument/shade/method/split_sum_strips.rs has the formula.
#pragma methods split-sum-strips-two split-sum-strips-four

#include "lib/split_sum.glsl"

#if defined(SPLIT_SUM_STRIPS_TWO)
const uint STRIP_COUNT = 2u;
#else
const uint STRIP_COUNT = 4u;
#endif

vec3 specular_radiance(Surface s) {
    mat3 frame = frame_of_surface(s);
    if (ANISOTROPY == ANISOTROPY_NONE) {
        // Along the plane of incidence.
        vec3 tangential = s.v - s.n_dot_v * s.n;
        vec3 t = dot(tangential, tangential) > TILT_MIN * TILT_MIN ? normalize(tangential) : frame[0];
        frame = mat3(t, cross(s.n, t), s.n);
    }
    vec3 v = vec3((s.v * frame).xy, s.n_dot_v);
    vec3 v_standard = normalize(vec3(s.width * v.xy, v.z));
    vec2 extent = vec2(STRIP_LENGTH / float(STRIP_COUNT), STRIP_BREADTH) * s.width;
    float alpha = clamp(sqrt(0.5 * dot(extent, extent)), ALPHA_MIN, 1.0);
    float perceptual_roughness = perceptual_roughness_from_alpha(alpha);
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < STRIP_COUNT; ++i) {
        float x = STRIP_REACH * ((2.0 * float(i) + 1.0) / float(STRIP_COUNT) - 1.0);
        float z = 2.0 / PI * (1.0 - v_standard.z) * sqrt(1.0 - x * x);
        vec3 normal = normalize(vec3(s.width * (vec2(x, 0.0) + v_standard.xy), z + v_standard.z));
        vec3 direction = reflect(-v, normal);
        // Rounding of a grazing view may leave no strip above the horizon.
        float weight = max(direction.z, COSINE_MIN);
        sum += weight * vec4(prefiltered_radiance(frame * normalize(direction), perceptual_roughness), 1.0);
    }
    return sum.rgb / sum.a * reflectance(s);
}
