// Integrals of the nine functions of lib/sh.glsl over a texel of an equirectangular map.

#include "lib/equirect.glsl"
#include "lib/sh.glsl"

// The sum at texel centres: Y_lm sin(theta) 2 pi^2 / (W H). [Kim22 "Irradiance mapping"]
float[SH9_COUNT] sh9_at_centre(uvec2 texel, uvec2 size) {
    float[SH9_COUNT] y = sh9_basis(direction_from_uv(uv_from_texel(texel, size)));
    float sin_theta = sin_cos_turns(0.5 * (float(texel.y) + 0.5) / float(size.y)).x;
    float omega = sin_theta * 2.0 * PI * PI / (float(size.x) * float(size.y));
    for (uint k = 0u; k < SH9_COUNT; ++k) {
        y[k] *= omega;
    }
    return y;
}

// The exact integrals. With x = sin(theta) sin(phi), y = cos(theta), z = sin(theta) cos(phi) each
// function is a product of a power of theta's sine and cosine and one of phi's. An interval from c -
// h to c + h has, for example, the integral 2 sin(c) sin(h) of the sine; the products below cancel
// no digits at the poles.
float[SH9_COUNT] sh9_over_texel(uvec2 texel, uvec2 size) {
    vec2 uv = uv_from_texel(texel, size);
    // Sines and cosines of the centre, and of half the interval.
    vec2 theta = sin_cos_turns(0.5 * uv.y), half_theta = sin_cos_turns(0.25 / float(size.y));
    vec2 phi = sin_cos_turns(0.5 - uv.x), half_phi = sin_cos_turns(0.5 / float(size.x));

    // Over theta, times the sine of the solid angle.
    float s2 = theta.x * theta.x, h2 = half_theta.x * half_theta.x;
    float one = 2.0 * theta.x * half_theta.x;
    float cosine = one * theta.y * half_theta.y;
    float sine = 0.5 * PI / float(size.y) - (1.0 - 2.0 * s2) * half_theta.x * half_theta.y;
    float sine_squared = one * (s2 + h2 - (4.0 / 3.0) * s2 * h2);
    float sine_cosine = 2.0 * theta.y * half_theta.x * (s2 + h2 / 3.0 - (4.0 / 3.0) * s2 * h2);

    // Over phi.
    float width = 2.0 * PI / float(size.x);
    vec2 sin_cos_phi = 2.0 * phi * half_phi.x;
    float sin_times_cos_phi = sin_cos_phi.x * phi.y * half_phi.y;
    float cos_squared_phi = 0.5 * width + (1.0 - 2.0 * phi.x * phi.x) * half_phi.x * half_phi.y;

    return float[SH9_COUNT](0.282094792 * one * width, 0.488602512 * cosine * width,
                            0.488602512 * sine * sin_cos_phi.y, 0.488602512 * sine * sin_cos_phi.x,
                            1.09254843 * sine_cosine * sin_cos_phi.x, 1.09254843 * sine_cosine * sin_cos_phi.y,
                            0.315391565 * (3.0 * sine_squared * cos_squared_phi - one * width),
                            1.09254843 * sine_squared * sin_times_cos_phi,
                            // x^2 - y^2 with y^2 = 1 - (x^2 + z^2).
                            0.546274215 * (sine_squared * (2.0 * width - cos_squared_phi) - one * width));
}
