// Beckmann distribution with Walter's rational Smith masking. Every file in brdf/ defines the same functions.
// Vectors are local (n is +z); alpha is the microfacet width in [ALPHA_MIN, 1].
#ifndef BRDF_BECKMANN_GLSL
#define BRDF_BECKMANN_GLSL

#include "lib/gaussian.glsl"
#include "lib/sampling.glsl"
#include "lib/smith_rational.glsl"
#include "lib/visible_ggx.glsl"

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
    return n_dot_w / visible_area(n_dot_w, alpha * sin_theta);
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

// Half vector among the normals that GGX of the same alpha shows to v; weights stay bounded (src/brdf/beckmann.rs says why this
// sampler and not Beckmann's own visible normals).
vec3 sample_visible_brdf(vec2 xi, vec3 v_local, float alpha) {
    return sample_visible_ggx(xi, v_local, alpha);
}

// Density of l = reflect(-v, h) per solid angle of l under sample_visible_brdf.
float pdf_visible_l_brdf(vec3 v_local, vec3 h_local, float alpha) {
    return pdf_visible_l_ggx(v_local, h_local, alpha);
}

#endif
