// Shared by all microfacet models: Fresnel, masking-shadowing, evaluation. `masking` is one of MASKING_*.
// Vectors are local (n is +z) and point away from the surface; eval never includes the cosine.

#include "generated/constants.glsl"
#include "lib/fresnel.glsl"
#include "selected/brdf.glsl"

// Masking of one direction: the model's G1, Karis' fit with k = alpha / 2 [Karis13 eq. 4], or the exact Smith masking.
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

// Masking-shadowing of v and l from their G1: product [Walter07 eq. 23], or 1 / (1 + Lambda(v) + Lambda(l)) with Lambda
// = 1 / G1 - 1 [Heitz14 eq. 99].
float g2_from_g1(float g1_v, float g1_l, uint masking) {
    float product = g1_v * g1_l;
    if (masking == MASKING_CORRELATED) {
        // The floor avoids 0 / 0 if both are 0.
        return product / max(g1_v + g1_l - product, 1e-30);
    }
    return product;
}

// Masking-shadowing of v and l.
float g2(float n_dot_v, float n_dot_l, float alpha, uint masking) {
    return g2_from_g1(g1(n_dot_v, alpha, masking), g1(n_dot_l, alpha, masking), masking);
}

// The specular BRDF, 1/sr; 0 below the horizon. h_local must be the half vector of v and l. [Walter07 eq. 20]
vec3 eval_brdf(vec3 v_local, vec3 l_local, vec3 h_local, float alpha, vec3 f0, uint masking) {
    if (v_local.z <= 0.0 || l_local.z <= 0.0) {
        return vec3(0.0);
    }
    float dg = d_brdf(h_local, alpha) * g2(v_local.z, l_local.z, alpha, masking);
    return dg / (4.0 * v_local.z * l_local.z) * f_schlick(dot(v_local, h_local), f0);
}
