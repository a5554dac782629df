// Phong distribution, exponent = 2 / alpha^2 - 2, with Walter's rational Smith masking. Every file
// in brdf/ defines the same functions. Vectors are local (n is +z); alpha is the microfacet width
// in [ALPHA_MIN, 1].

#include "lib/bounded_cap.glsl"
#include "lib/incomplete_beta.glsl"
#include "lib/sampling.glsl"
#include "lib/smith_rational.glsl"
#include "lib/visible_ggx.glsl"

// For `printed-document-0`, which draws Phong's lobe by another exponent.
#define BRDF_PHONG

// D(h), 1/sr: (exponent + 2) / 2 pi cos^exponent, written with alpha and ln(1 - sin^2). [Walter07
// eq. 30]
float d_brdf(vec3 h_local, float alpha) {
    if (h_local.z <= 0.0) {
        return 0.0;
    }
    float inv_alpha2 = 1.0 / (alpha * alpha);
    float sin2 = dot(h_local.xy, h_local.xy);
    // cos^2 directly if sin^2 has rounded to 1.
    float log_cos2 = sin2 < 0.75 ? log_one_minus(sin2) : log(h_local.z * h_local.z);
    return inv_alpha2 / PI * exp((inv_alpha2 - 1.0) * log_cos2);
}

// Smith masking G1 at cosine n_dot_w: sqrt(exponent / 2 + 1) is 1 / alpha. [Walter07 eq. 27,
// section 5.2]
float g1_brdf(float n_dot_w, float alpha) {
    return g1_smith_rational(n_dot_w, alpha);
}

// The exact Smith masking of this distribution, derived in src/instrument/brdf/phong.rs: with N = 1
// / alpha^2, cos / (cos (1 - I / 2) + Gamma(N + 1/2) / (sqrt(pi) Gamma(N)) sin^2N / (2 N - 1)).
// Relative error below 1e-6.
float g1_exact_brdf(float n_dot_w, float alpha) {
    if (n_dot_w <= 0.0) {
        return 0.0;
    }
    float alpha2 = alpha * alpha;
    // Below 1: there the logarithm of sin^2 is -infinity.
    float log_sin2 = log_one_minus(min(n_dot_w * n_dot_w, 1.0 - 6e-8));
    float grazing = gamma_ratio_half(alpha2) * alpha * INV_SQRT_PI * exp(log_sin2 / alpha2) / (2.0 - alpha2);
    return n_dot_w / (n_dot_w * (1.0 - 0.5 * incomplete_beta_half(alpha2, log_sin2)) + grazing);
}

// Half vector of density D(h) n_dot_h: cos = (1 - u)^(1 / (exponent + 2)) = exp(-alpha^2 w / 2).
// [Walter07 eq. 31, 32]
LobeSample sample_lobe_brdf(vec4 point, float alpha) {
    float alpha2 = alpha * alpha;
    float x = 0.5 * alpha2 * point.w;
    float cos_theta = exp(-x);
    // sin^2 = (1 - cos) (1 + cos).
    float sin_theta = sqrt(one_minus_exp(x) * (1.0 + cos_theta));
    return LobeSample(vec3(sin_theta * point.yz, cos_theta), (1.0 - point.x) / (PI * alpha2 * cos_theta));
}

// Half vector with density D(h) n_dot_h.
vec3 sample_d_brdf(float u, vec2 cos_sin_phi, float alpha) {
    return sample_lobe_brdf(sample_point_from_polar(u, cos_sin_phi), alpha).h_local;
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
    float d = d_ggx(h_local, normals.width);
    return VisibleSample(h_local, d * normals.cap.pdf_over_d, normals.d_over_pdf * d_brdf(h_local, normals.width) / d);
}
