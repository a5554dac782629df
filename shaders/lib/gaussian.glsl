// The error function, and what it says about a Gaussian surface. Polynomials: minimax fits by this
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

// Slopes beyond it (in units of alpha) do not occur in f32.
const float SLOPE_END = 6.5;
// 1 / (2 sqrt(pi)).
const float HALF_INV_SQRT_PI = 0.282094792;

// The facet area of a Gaussian surface of alpha = 1 that a view sees, over surface area; `cos_theta` and `sin_theta` up to a common
// factor, which the area has too. It is the integral of (cos - t sin) exp(-t^2) / sqrt(pi) over t up to cos / sin. [HeitzDeon14]
float visible_area(float cos_theta, float sin_theta) {
    float end = cos_theta < SLOPE_END * sin_theta ? cos_theta / sin_theta : SLOPE_END;
    float gauss = exp(-end * end);
    float share = 1.0 - 0.5 * gauss * erfc_scaled(end);
    return cos_theta * share + sin_theta * HALF_INV_SQRT_PI * gauss;
}

#endif
