// GGX (Trowbridge-Reitz) distribution with its exact Smith masking. Every file in brdf/ defines the
// same functions. Vectors are local (n is +z); alpha is the microfacet width in [ALPHA_MIN, 1].

#include "lib/bounded_cap.glsl"
#include "lib/sampling.glsl"
#include "lib/visible_ggx.glsl"

// D(h), 1/sr. [Walter07 eq. 33]
float d_brdf(vec3 h_local, float alpha) {
    return d_ggx(h_local, alpha);
}

// Smith masking G1 of a direction with cosine n_dot_w. [Walter07 eq. 34]
float g1_brdf(float n_dot_w, float alpha) {
    return n_dot_w > 0.0 ? n_dot_w * g1_over_cosine_ggx(n_dot_w, alpha) : 0.0;
}

// The exact Smith masking of this distribution: the model's own.
float g1_exact_brdf(float n_dot_w, float alpha) {
    return g1_brdf(n_dot_w, alpha);
}

// Half vector with density D(h) n_dot_h: cos^2 = (1 - u) / (1 + (alpha^2 - 1) u). [Walter07 eq. 35,
// 36]
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

// Half vector among the visible normals, for the reference.
vec3 sample_visible_brdf(vec2 xi, vec3 v_local, vec2 width) {
    return sample_visible_ggx(xi, v_local, width);
}

// Density of l = reflect(-v, h) per solid angle of l under sample_visible_brdf.
float pdf_visible_l_brdf(vec3 v_local, vec3 h_local, vec2 width) {
    return pdf_visible_l_ggx(v_local, h_local, width);
}

// Visible normals for the method sampled-vndf.
#define VisibleNormals BoundedNormals

VisibleNormals visible_normals_brdf(vec3 v_local, vec2 width) {
    return bounded_normals_ggx(v_local, width);
}

VisibleSample sample_visible_normal(VisibleNormals normals, vec4 point) {
    vec3 h_local = sample_bounded_ggx(normals.cap, point, normals.width);
    return VisibleSample(h_local, d_brdf(h_local, normals.width) * normals.cap.pdf_over_d, normals.d_over_pdf);
}
