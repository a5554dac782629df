// The error function and its inverse, and what they say about a Gaussian surface. Polynomials: minimax fits by this
// project.
#ifndef GAUSSIAN_GLSL
#define GAUSSIAN_GLSL

// exp(x^2) erfc(x) for 0 <= x <= 6.6; relative error below 5e-7.
float erfc_scaled(float x) {
    float q = 3.0 / (3.0 + x);
    float p = -0.12178543;
    p = p * q + 0.387686782;
    p = p * q - 0.236174692;
    p = p * q + 0.30752799;
    p = p * q + 0.100407403;
    p = p * q + 0.186741813;
    p = p * q + 0.18755255;
    return q * (p * q + 0.18804348);
}

// The t with (1 + erf t) / 2 = u, for 0 < u < 1; relative error below 2e-6.
float erf_inverse_unit(float u) {
    float w = -log(4.0 * u * (1.0 - u));
    float ratio;
    if (w < 5.0) {
        float x = w - 2.5;
        ratio = 3.1563241e-7;
        ratio = ratio * x - 3.18588188e-6;
        ratio = ratio * x - 4.09418846e-6;
        ratio = ratio * x + 0.000217336019;
        ratio = ratio * x - 0.00125463152;
        ratio = ratio * x - 0.00417625879;
        ratio = ratio * x + 0.246641421;
        ratio = ratio * x + 1.50140918;
    } else {
        float x = sqrt(w) - 3.0;
        ratio = 0.000928122498;
        ratio = ratio * x - 0.00350191798;
        ratio = ratio * x + 0.00600990717;
        ratio = ratio * x - 0.00769438125;
        ratio = ratio * x + 0.00938215006;
        ratio = ratio * x + 1.00168044;
        ratio = ratio * x + 2.83297883;
    }
    return (2.0 * u - 1.0) * ratio;
}

// Slopes beyond it (in units of alpha) do not occur in f32.
const float SLOPE_END = 6.5;
// 1 / (2 sqrt(pi)).
const float HALF_INV_SQRT_PI = 0.282094792;

// What a view (cos_theta, sin_theta up to a common factor) sees of a Gaussian surface of alpha = 1.
struct VisibleSlopes {
    // The steepest visible slope along the view.
    float end;
    // Share of all facets with a slope below `end`.
    float share;
    // Visible facet area over surface area, times the common factor.
    float area;
};

// The area is the integral of (cos - t sin) exp(-t^2) / sqrt(pi) over t up to cos / sin. [HeitzDeon14]
VisibleSlopes visible_slopes(float cos_theta, float sin_theta) {
    VisibleSlopes s;
    s.end = cos_theta < SLOPE_END * sin_theta ? cos_theta / sin_theta : SLOPE_END;
    float gauss = exp(-s.end * s.end);
    s.share = 1.0 - 0.5 * gauss * erfc_scaled(s.end);
    s.area = cos_theta * s.share + sin_theta * HALF_INV_SQRT_PI * gauss;
    return s;
}

// The slope along the view below which lies the share xi of the visible area. The unknown of Newton's method is the
// share of all facets, in which the area is smooth and concave; five steps leave 2e-6 of slope in nine cases of ten,
// 2e-3 at xi = 1 - 1e-5.
float sample_visible_slope(float xi, float cos_theta, float sin_theta) {
    VisibleSlopes visible = visible_slopes(cos_theta, sin_theta);
    float target = xi * visible.area;
    float share_max = min(visible.share, 1.0 - 6e-8);
    // Exact at cos = 1; at cos = 0 with the right square root at xi = 1.
    float share = visible.share * (1.0 - pow(1.0 - xi, 0.5 + 0.5 * cos_theta * cos_theta));
    float slope = 0.0;
    for (uint step_index = 0u; step_index <= 5u; ++step_index) {
        share = clamp(share, 1e-10, share_max);
        slope = min(erf_inverse_unit(share), visible.end);
        float area = cos_theta * share + sin_theta * HALF_INV_SQRT_PI * exp(-slope * slope);
        share -= (area - target) / max(cos_theta - slope * sin_theta, 1e-6);
    }
    return slope;
}

#endif
