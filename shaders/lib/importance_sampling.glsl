// The specular integral by importance sampling of D.
//
// m has density D(m) (n.m), l = reflect(-v, m), so p_l = D (n.m) / (4 v.m) and the weight is
//     f (n.l) / p_l = F G (v.m) / ((n.v) (n.m)).
// Directions below the horizon carry nothing but count in N. [Walter07 eq. 38, 41; Kim22 "IBL", corrected]
#ifndef IMPORTANCE_SAMPLING_GLSL
#define IMPORTANCE_SAMPLING_GLSL

#include "lib/equirect.glsl"
#include "lib/frame.glsl"
#include "lib/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

// What the points of this dispatch add to the outgoing specular radiance, for environment radiance as stored. Filtered: each sample reads the level at which a texel
// covers its solid angle 1 / (N p_l), moved by lod_bias; else level 0. [Colbert07 section 20.4]
vec3 importance_sampled_radiance(Surface s, sampler2D environment, ShadeParams params, bool filtered) {
    mat3 frame = frame_from_normal(s.n);
    vec3 v_local = s.v * frame;
    float g1_v = g1(s.n_dot_v, s.alpha, MASKING);
    float lod_max = float(textureQueryLevels(environment) - 1);
    vec2 size = vec2(params.environment_width, params.environment_height);
    float sample_count = float(params.sample_count);
    // Texels a sample of density p_l covers where sin(theta) is 1: lod_scale / p_l, with the 4 of p_l's Jacobian taken
    // in.
    float lod_scale = 4.0 / (sample_count * texel_solid_angle(1.0, size));
    float sin_theta_min = 0.5 * PI / size.y;

    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.point_count; ++i) {
        LobeSample lobe = sample_lobe_brdf(sample_point(i), s.alpha);
        float v_dot_h = dot(v_local, lobe.h_local);
        vec3 l_local = 2.0 * v_dot_h * lobe.h_local - v_local;
        vec3 uv_sin_theta = uv_sin_theta_from_direction(frame * l_local);
        float lod = 0.0;
        if (filtered) {
            float texel_count = lod_scale * v_dot_h / (lobe.pdf_h * max(uv_sin_theta.z, sin_theta_min));
            lod = clamp(0.5 * log2(texel_count) + params.lod_bias, 0.0, lod_max);
        }
        vec3 li = textureLod(environment, uv_sin_theta.xy, lod).rgb;
        float g = g2_from_g1(g1_v, g1(l_local.z, s.alpha, MASKING), MASKING);
        float weight = g * v_dot_h / lobe.h_local.z;
        // A select, not a branch: neighbours would wait for the lookup anyway.
        sum += li * f_schlick(v_dot_h, s.f0) * (l_local.z > 0.0 && v_dot_h > 0.0 ? weight : 0.0);
    }
    return sum / (sample_count * s.n_dot_v);
}

#endif
