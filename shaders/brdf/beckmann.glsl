// Beckmann distribution with Walter's rational Smith masking. Every file in brdf/ defines the same functions.
// Vectors are local (n is +z); alpha is the microfacet width in [ALPHA_MIN, 1].
#ifndef BRDF_BECKMANN_GLSL
#define BRDF_BECKMANN_GLSL

#include "lib/gaussian.glsl"
#include "lib/sampling.glsl"
#include "lib/smith_rational.glsl"

// D(h), 1/sr. [Walter07 eq. 25]
float d_brdf(vec3 h_local, float alpha) {
    // Below this cosine the exponential is 0 in f32 for every alpha, and 1 / cos^4 would overflow.
    if (h_local.z <= COSINE_MIN) {
        return 0.0;
    }
    float alpha2 = alpha * alpha;
    float cos2 = h_local.z * h_local.z;
    return exp(-dot(h_local.xy, h_local.xy) / (cos2 * alpha2)) / (PI * alpha2 * cos2 * cos2);
}

// Smith masking G1 of a direction with cosine n_dot_w. [Walter07 eq. 27]
float g1_brdf(float n_dot_w, float alpha) {
    return g1_smith_rational(n_dot_w, alpha);
}

// The exact Smith masking of this distribution: n_dot_w over the visible area. Relative error below 5e-7. [Walter07 eq. 26]
float g1_exact_brdf(float n_dot_w, float alpha) {
    if (n_dot_w <= 0.0) {
        return 0.0;
    }
    float sin_theta = sqrt(max((1.0 - n_dot_w) * (1.0 + n_dot_w), 0.0));
    return n_dot_w / visible_slopes(n_dot_w, alpha * sin_theta).area;
}

// Half vector with density D(h) n_dot_h: tan^2 = -alpha^2 ln(1 - u). [Walter07 eq. 28, 29]
LobeSample sample_lobe_brdf(vec4 point, float alpha) {
    float alpha2 = alpha * alpha;
    float tan2 = alpha2 * point.w;
    float inv_cos2 = 1.0 + tan2;
    float cos_theta = inversesqrt(inv_cos2);
    float sin_theta = sqrt(tan2) * cos_theta;
    return LobeSample(vec3(sin_theta * point.yz, cos_theta),
                      (1.0 - point.x) * inv_cos2 * inv_cos2 * cos_theta / (PI * alpha2));
}

// Half vector with density D(h) n_dot_h.
vec3 sample_d_brdf(float u, vec2 cos_sin_phi, float alpha) {
    return sample_lobe_brdf(sample_point_from_polar(u, cos_sin_phi), alpha).h_local;
}

// Half vector among the normals visible from v, by the exact Smith masking: stretch to alpha = 1, draw the slope along
// the view by xi.x and the slope across by xi.y, stretch back. This mapping has no polar angle. [HeitzDeon14]
vec3 sample_visible_brdf(vec2 xi, vec3 v_local, float alpha) {
    vec3 v_standard = normalize(vec3(alpha * v_local.xy, v_local.z));
    float sin_theta = length(v_standard.xy);
    vec2 azimuth = sin_theta > 0.0 ? v_standard.xy / sin_theta : vec2(1.0, 0.0);
    float along = sample_visible_slope(xi.x, v_standard.z, sin_theta);
    float across = erf_inverse_unit(clamp(xi.y, 1e-10, 1.0 - 6e-8));
    vec2 slope = alpha * (along * azimuth + across * vec2(-azimuth.y, azimuth.x));
    return normalize(vec3(-slope, 1.0));
}

// Density of l = reflect(-v, h) per solid angle of l under sample_visible_brdf: D over 4 times the visible area, which
// is n_dot_v / G1(v) with the exact Smith G1 (the rational fit is the model's, not the sampler's). [HeitzDeon14]
float pdf_visible_l_brdf(vec3 v_local, vec3 h_local, float alpha) {
    if (v_local.z <= 0.0 || dot(v_local, h_local) <= 0.0) {
        return 0.0;
    }
    return d_brdf(h_local, alpha) / (4.0 * visible_slopes(v_local.z, alpha * length(v_local.xy)).area);
}

// Alpha of the lobe that source document 0 prints: this model's own. [Kim22 "IBL"]
float printed_lobe_alpha_brdf(float alpha) {
    return alpha;
}

#endif
