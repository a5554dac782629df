// The regularised incomplete beta function I_x(n, 1/2) for n = 1 / t, t in (0, 1]. Polynomials: our
// minimax fits.

#include "lib/gaussian.glsl"

// 1 / sqrt(pi).
const float INV_SQRT_PI = 0.564189584;

// Gamma(n + 1/2) / (Gamma(n) sqrt(n)); relative error below 2e-7.
float gamma_ratio_half(float t) {
    float p = 0.000291437047;
    p = p * t - 0.00234258391;
    p = p * t + 0.00558740098;
    p = p * t + 0.00768262460;
    p = p * t - 0.124992103;
    return p * t + 1.0;
}

// I_x(n, 1/2) at the x in [6e-8, 1) with this logarithm; absolute error below 5e-7.
//
// With x = exp(-w^2) it is in proportion to the integral from w of exp(-(n - 1/4) u^2) S(u^2), S(y)
// = sqrt((y/2) / sinh(y/2)). S(y) exp(0.475 y) is fitted by a polynomial, whose integrals follow
// from erfc by parts.
float incomplete_beta_half(float t, float log_x) {
    // In units of the width of the Gaussian: z^2 = k w^2, k = n + 0.225.
    float inv_k = t / (1.0 + 0.225 * t);
    float z2 = -log_x / inv_k;
    float z = min(sqrt(z2), 6.6);
    float gauss = exp(-z2);
    // The integral of y^j exp(-y^2) over the rest, for j = 0, 2, 4 ..., each divided by k^(j/2).
    float moment = 0.5 * gauss * erfc_scaled(z) / INV_SQRT_PI;
    float edge = 0.5 * gauss * z;
    const float[6] COEFFICIENTS =
        float[6](0.475004114, 0.0919361822, 0.00807263758, 5.94375297e-5, 5.83557032e-5, 5.57434780e-7);
    float sum = moment;
    for (uint j = 0u; j < 6u; ++j) {
        moment = (edge + (float(j) + 0.5) * moment) * inv_k;
        edge *= -log_x;
        sum += COEFFICIENTS[j] * moment;
    }
    // 2 Gamma(n + 1/2) / (sqrt(pi) Gamma(n) sqrt(k)), with sqrt(n / k).
    return 2.0 * INV_SQRT_PI * gamma_ratio_half(t) * sqrt(inv_k / t) * sum;
}
