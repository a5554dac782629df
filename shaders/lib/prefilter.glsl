// The mean radiance of a specular lobe for n = v = r: the first factor of the split sum.
#ifndef PREFILTER_GLSL
#define PREFILTER_GLSL

#include "generated/layout.glsl"
#include "lib/equirect.glsl"
#include "lib/frame.glsl"
#include "lib/sampling.glsl"
#include "selected/brdf.glsl"

// Radiance of the mirror direction, filtered from the source's texels to the written ones (both shrink with sin(theta)
// alike).
vec3 mirror_radiance(vec3 r, sampler2D environment, PrefilterParams params) {
    float source_texels = float(params.source_width) * float(params.source_height);
    float lod = 0.5 * log2(source_texels / (float(params.width) * float(params.height)));
    return textureLod(environment, uv_from_direction(r), max(lod, 0.0)).rgb;
}

// (sum L (n.l), sum (n.l)) over the points of this dispatch, for h with density D(h) (n.h) and l = reflect(-r, h), so p_l = D / 4.
// [Karis13 eq. 7]
vec4 lobe_sum(vec3 r, sampler2D environment, PrefilterParams params) {
    mat3 frame = frame_from_normal(r);
    vec2 source_size = vec2(params.source_width, params.source_height);
    float lod_max = float(textureQueryLevels(environment) - 1);
    vec3 sum = vec3(0.0);
    float weight_sum = 0.0;
    for (uint i = 0u; i < params.point_count; ++i) {
        LobeSample lobe = sample_lobe_brdf(sample_point(i), params.alpha);
        float n_dot_h = lobe.h_local.z;
        // n.l = 2 (n.h)^2 - 1; the sine form keeps l a unit vector at small alpha.
        vec3 l_local = vec3(2.0 * n_dot_h * lobe.h_local.xy, 1.0 - 2.0 * dot(lobe.h_local.xy, lobe.h_local.xy));
        vec3 uv_sin_theta = uv_sin_theta_from_direction(frame * l_local);
        float omega_s = 4.0 * n_dot_h / (float(params.sample_count) * lobe.pdf_h);
        float omega_p = texel_solid_angle(uv_sin_theta.z, source_size);
        float lod = clamp(lod_from_solid_angles(omega_s, omega_p) + params.lod_bias, 0.0, lod_max);
        float weight = max(l_local.z, 0.0);
        sum += weight * textureLod(environment, uv_sin_theta.xy, lod).rgb;
        weight_sum += weight;
    }
    return vec4(sum, weight_sum);
}

#endif
