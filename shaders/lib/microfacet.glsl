// Shared by all microfacet models: Fresnel, masking-shadowing, evaluation. `masking` is one of
// MASKING_*. Vectors are local (n is +z) and point away from the surface; eval never includes the
// cosine.

#include "generated/constants.glsl"
#include "lib/fresnel.glsl"
#include "lib/sampling.glsl"
#include "selected/brdf.glsl"

// Masking of one direction: the model's G1, Karis' fit with k = alpha / 2 [Karis13 eq. 4], or the
// exact Smith masking.
float g1(float n_dot_w, float alpha, uint masking) {
    if (masking == MASKING_SCHLICK) {
        float k = 0.5 * alpha;
        return n_dot_w > 0.0 ? n_dot_w / (n_dot_w * (1.0 - k) + k) : 0.0;
    }
    if (masking == MASKING_SMITH_EXACT) {
        return g1_exact_brdf(n_dot_w, alpha);
    }
    return g1_brdf(n_dot_w, alpha);
}

// Masking-shadowing of v and l from their G1: product [Walter07 eq. 23], or 1 / (1 + Lambda(v) +
// Lambda(l)) with Lambda = 1 / G1 - 1 [Heitz14 eq. 99].
float g2_from_g1(float g1_v, float g1_l, uint masking) {
    float product = g1_v * g1_l;
    if (masking == MASKING_CORRELATED) {
        // The floor avoids 0 / 0 if both are 0.
        return product / max(g1_v + g1_l - product, 1e-30);
    }
    return product;
}

// D, a half vector of density D n_dot_h and masking for two widths; Phong's has one and no
// stretched form.
float d_brdf(vec3 h_local, vec2 width) {
    if (ANISOTROPY == ANISOTROPY_NONE) {
        return d_brdf(h_local, width.y);
    }
    vec4 unit = unstretched(h_local, width);
    return h_local.z > 0.0 ? d_brdf(unit.xyz, 1.0) / (width.x * width.y * (unit.w * unit.w) * (unit.w * unit.w)) : 0.0;
}

LobeSample sample_lobe_brdf(vec4 point, vec2 width) {
    if (ANISOTROPY == ANISOTROPY_NONE) {
        return sample_lobe_brdf(point, width.y);
    }
    vec3 unit = sample_lobe_brdf(point, 1.0).h_local;
    vec3 h_local = normalize(vec3(width * unit.xy, unit.z));
    return LobeSample(h_local, d_brdf(h_local, width) * h_local.z);
}

float g1(vec3 w_local, vec2 width, uint masking) {
    return g1(w_local.z, width_along(w_local, width), masking);
}

// The specular BRDF, 1/sr; 0 below the horizon. h_local must be the half vector of v and l.
// [Walter07 eq. 20]
vec3 eval_brdf(vec3 v_local, vec3 l_local, vec3 h_local, vec2 width, vec3 f0, uint masking) {
    if (v_local.z <= 0.0 || l_local.z <= 0.0) {
        return vec3(0.0);
    }
    float masked = g2_from_g1(g1(v_local, width, masking), g1(l_local, width, masking), masking);
    float dg = d_brdf(h_local, width) * masked;
    return dg / (4.0 * v_local.z * l_local.z) * fresnel(dot(v_local, h_local), f0);
}
