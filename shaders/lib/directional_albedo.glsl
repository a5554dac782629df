// The directional albedo of the specular lobe, split by Fresnel: f0 A + B. The second factor of the split sum.
#ifndef DIRECTIONAL_ALBEDO_GLSL
#define DIRECTIONAL_ALBEDO_GLSL

#include "lib/microfacet.glsl"
#include "lib/sampling.glsl"

// (A, B): the integral of f (n.l) over l, by sampling the visible normals, with f / F = D G / (4 n.v n.l):
//     A = mean of (1 - Fc) w, B = mean of Fc w, w = D G / (4 n.v p_l), Fc = (1 - v.h)^5. [Karis13 eq. 8]
// The integrand is the same on both sides of the plane of incidence, and xi.y in [0, 1/2) is one side.
vec2 directional_albedo(float n_dot_v, float alpha, uint sample_count, uint masking) {
    vec3 v_local = vec3(sqrt(max(1.0 - n_dot_v * n_dot_v, 0.0)), 0.0, n_dot_v);
    float g1_v = g1(n_dot_v, alpha, masking);
    vec2 sum = vec2(0.0);
    for (uint i = 0u; i < sample_count; ++i) {
        vec4 point = sample_point(i);
        // phi / 2 pi in [0, 1), halved.
        float turns = atan2_precise(point.z, point.y) * (0.5 / PI);
        vec2 xi = vec2(point.x, 0.5 * (turns < 0.0 ? turns + 1.0 : turns));

        vec3 h_local = sample_visible_brdf(xi, v_local, alpha);
        float v_dot_h = dot(v_local, h_local);
        float n_dot_l = 2.0 * v_dot_h * h_local.z - n_dot_v;
        float pdf_l = pdf_visible_l_brdf(v_local, h_local, alpha);
        if (n_dot_l > 0.0 && v_dot_h > 0.0 && pdf_l > 0.0) {
            float g = g2_from_g1(g1_v, g1(n_dot_l, alpha, masking), masking);
            float weight = d_brdf(h_local, alpha) * g / (4.0 * n_dot_v * pdf_l);
            float fc = schlick_weight(v_dot_h);
            sum += weight * vec2(1.0 - fc, fc);
        }
    }
    return sum / float(sample_count);
}

#endif
