// Beckmann distribution with Walter's rational Smith masking. Every file in brdf/ defines the same
// functions. Vectors are local (n is +z); alpha is the microfacet width in [ALPHA_MIN, 1].

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

// The exact Smith masking: n_dot_w over the visible area. Relative error below 5e-7. [Walter07 eq.
// 26]
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

// Half vector among the visible normals, for the reference.
vec3 sample_visible_brdf(vec2 xi, vec3 v_local, vec2 width) {
    return sample_visible_ggx(xi, v_local, width);
}

// Density of l = reflect(-v, h) per solid angle of l under sample_visible_brdf.
float pdf_visible_l_brdf(vec3 v_local, vec3 h_local, vec2 width) {
    return pdf_visible_l_ggx(v_local, h_local, width);
}

// Beckmann's own visible normals, as the method sampled-vndf draws them.
struct VisibleNormals {
    // The unit vector along the stretched v_local.xy.
    vec2 along;
    // Cosine and sine of the stretched view, up to a common factor.
    float cos_theta;
    float sin_theta;
    // No visible slope is steeper, in units of the width.
    float end;
    // All that is visible.
    float area;
    float erf_end;
    float exponent;
    vec2 width;
};

VisibleNormals visible_normals_brdf(vec3 v_local, vec2 width) {
    float across = length(v_local.xy);
    vec2 along = across > TILT_MIN ? v_local.xy / across : vec2(1.0, 0.0);
    float sin_theta = width.y * across;
    if (ANISOTROPY != ANISOTROPY_NONE) {
        along = normalize(width * along);
        sin_theta = length(width * v_local.xy);
    }
    float end = v_local.z < SLOPE_END * sin_theta ? v_local.z / sin_theta : SLOPE_END;
    float theta = atan2_precise(sin_theta, v_local.z);
    float exponent = 1.0 + theta * (-0.876 + theta * (0.4265 - 0.0594 * theta));
    float area = visible_area(v_local.z, sin_theta);
    return VisibleNormals(along, v_local.z, sin_theta, end, area, 1.0 - erfc_precise(end), exponent, width);
}

// Slopes along and across v: the first has density (cos - t sin) exp(-t^2) up to `end`, the other
// is Gaussian [HeitzDeon14]. The first is inverted by Halley's method from the fit of [Jakob14];
// three steps leave rounding.
VisibleSample sample_visible_normal(VisibleNormals normals, vec4 point) {
    float cos_theta = normals.cos_theta;
    float sin_theta = normals.sin_theta;
    float guess = normals.erf_end - (1.0 + normals.erf_end) * pow(1.0 - point.x, normals.exponent);
    guess = clamp(guess, -1.0 + 1e-6, 1.0 - 1e-6);
    float t = erf_inverse(guess, (1.0 - guess) * (1.0 + guess));
    for (uint i = 0u; i < 3u; ++i) {
        float seen = cos_theta - t * sin_theta;
        float slope = 2.0 * HALF_INV_SQRT_PI * seen * exp(-t * t);
        float off = visible_area_up_to(t, cos_theta, sin_theta) - point.x * normals.area;
        float newton = seen > 0.0 ? off / slope : 0.0;
        float bend = seen > 0.0 ? clamp(newton * (2.0 * t + sin_theta / seen), -1.5, 1.5) : 0.0;
        t = clamp(t - newton / (1.0 + 0.5 * bend), -SLOPE_END, normals.end);
    }
    // Infinite at 2/3 of a turn, which no net of points contains; most contain 0.
    float turns = fract(atan2_precise(point.z, point.y) * (0.5 / PI) + 1.0 / 3.0);
    float y = erf_inverse(2.0 * turns - 1.0, max(4.0 * turns * (1.0 - turns), 1e-13));
    vec2 slope = normals.width * (t * normals.along + y * vec2(-normals.along.y, normals.along.x));
    vec3 h_local = normalize(vec3(-slope, 1.0));
    return VisibleSample(h_local, 0.25 * d_brdf(h_local, normals.width) / normals.area, normals.area / normals.cos_theta);
}
