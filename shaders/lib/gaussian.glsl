// The error function, and areas of Gaussian surfaces. Polynomials: minimax fits by this project.

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

// 1 - erf(x) for |x| < 6.6; relative error below 6e-7.
float erfc_precise(float x) {
    float tail = exp(-x * x) * erfc_scaled(abs(x));
    return x < 0.0 ? 2.0 - tail : tail;
}

// The x with erf(x) = y; `complement` is (1 - y) (1 + y) with all digits. Relative error below
// 4e-7. [Giles12, table 5]
float erf_inverse(float y, float complement) {
    float w = -log(complement);
    if (w < 5.0) {
        w -= 2.5;
        float p = 2.81022636e-8;
        p = p * w + 3.43273939e-7;
        p = p * w - 3.5233877e-6;
        p = p * w - 4.39150654e-6;
        p = p * w + 0.00021858087;
        p = p * w - 0.00125372503;
        p = p * w - 0.00417768164;
        p = p * w + 0.246640727;
        return y * (p * w + 1.50140941);
    }
    w = sqrt(w) - 3.0;
    float p = -0.000200214257;
    p = p * w + 0.000100950558;
    p = p * w + 0.00134934322;
    p = p * w - 0.00367342844;
    p = p * w + 0.00573950773;
    p = p * w - 0.0076224613;
    p = p * w + 0.00943887047;
    p = p * w + 1.00167406;
    return y * (p * w + 2.83297682);
}

// The part of the facet area below that is seen of slopes up to `slope`. [HeitzDeon14]
float visible_area_up_to(float slope, float cos_theta, float sin_theta) {
    return 0.5 * cos_theta * erfc_precise(-slope) + sin_theta * HALF_INV_SQRT_PI * exp(-slope * slope);
}

// The facet area of a Gaussian surface of alpha = 1 that a view sees, over surface area;
// `cos_theta` and `sin_theta` up to a common factor, which the area has too. It is the integral of
// (cos - t sin) exp(-t^2) / sqrt(pi) over t up to cos / sin. [HeitzDeon14]
float visible_area(float cos_theta, float sin_theta) {
    float end = cos_theta < SLOPE_END * sin_theta ? cos_theta / sin_theta : SLOPE_END;
    float gauss = exp(-end * end);
    float share = 1.0 - 0.5 * gauss * erfc_scaled(end);
    return cos_theta * share + sin_theta * HALF_INV_SQRT_PI * gauss;
}
