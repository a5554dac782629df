// GGX (Trowbridge-Reitz) distribution with its exact Smith masking. Every file in brdf/ defines the same functions.
// Vectors are local (n is +z); alpha is the microfacet width in [ALPHA_MIN, 1].
#ifndef BRDF_GGX_GLSL
#define BRDF_GGX_GLSL

#include "lib/sampling.glsl"

// D(h), 1/sr. The sine comes from h.xy: 1 - h.z^2 has no digits left at small alpha. [Walter07 eq. 33]
float d_brdf(vec3 h_local, float alpha) {
    float alpha2 = alpha * alpha;
    float k = dot(h_local.xy, h_local.xy) + alpha2 * h_local.z * h_local.z;
    return h_local.z > 0.0 ? alpha2 / (PI * k * k) : 0.0;
}

// G1(w) over n_dot_w: finite where the cosine is 0. [Walter07 eq. 34]
float g1_over_cosine_ggx(float n_dot_w, float alpha) {
    float alpha2 = alpha * alpha;
    return 2.0 / (n_dot_w + sqrt(alpha2 + (1.0 - alpha2) * n_dot_w * n_dot_w));
}

// Smith masking G1 of a direction with cosine n_dot_w. [Walter07 eq. 34]
float g1_brdf(float n_dot_w, float alpha) {
    return n_dot_w > 0.0 ? n_dot_w * g1_over_cosine_ggx(n_dot_w, alpha) : 0.0;
}

// The exact Smith masking of this distribution: the model's own.
float g1_exact_brdf(float n_dot_w, float alpha) {
    return g1_brdf(n_dot_w, alpha);
}

// Half vector with density D(h) n_dot_h: cos^2 = (1 - u) / (1 + (alpha^2 - 1) u). [Walter07 eq. 35, 36]
LobeSample sample_lobe_brdf(vec4 point, float alpha) {
    float alpha2 = alpha * alpha;
    float k = 1.0 + (alpha2 - 1.0) * point.x;
    float inv_k = 1.0 / k;
    float cos_theta = sqrt((1.0 - point.x) * inv_k);
    float sin_theta = alpha * sqrt(point.x * inv_k);
    return LobeSample(vec3(sin_theta * point.yz, cos_theta), k * k * cos_theta / (PI * alpha2));
}

// Half vector with density D(h) n_dot_h.
vec3 sample_d_brdf(float u, vec2 cos_sin_phi, float alpha) {
    return sample_lobe_brdf(vec4(u, cos_sin_phi, 0.0), alpha).h_local;
}

// Half vector among the normals visible from v: the half vectors of the spherical cap that the stretched v reflects
// into; xi.x = 0 is the cap's centre. [Dupuy23 listing 3]
vec3 sample_visible_brdf(vec2 xi, vec3 v_local, float alpha) {
    vec3 v_standard = normalize(vec3(alpha * v_local.xy, v_local.z));
    // The cap's point is (sin phi-part, 1 - d); both its sine and z + v.z are written with d and 1 - xi.x, which cancel
    // no digits.
    float d = xi.x * (1.0 + v_standard.z);
    vec2 cap = sqrt(max(d * (2.0 - d), 0.0)) * sin_cos_turns(xi.y).yx;
    return normalize(vec3(alpha * (cap + v_standard.xy), (1.0 - xi.x) * (1.0 + v_standard.z)));
}

// Density of l = reflect(-v, h) per solid angle of l under sample_visible_brdf: D G1(v) / (4 n_dot_v). [Heitz18 eq. 17]
float pdf_visible_l_brdf(vec3 v_local, vec3 h_local, float alpha) {
    bool visible = v_local.z > 0.0 && dot(v_local, h_local) > 0.0;
    return visible ? 0.25 * d_brdf(h_local, alpha) * g1_over_cosine_ggx(v_local.z, alpha) : 0.0;
}

// Alpha of the lobe that source document 0 prints: this model's own. [Kim22 "IBL"]
float printed_lobe_alpha_brdf(float alpha) {
    return alpha;
}

#endif
