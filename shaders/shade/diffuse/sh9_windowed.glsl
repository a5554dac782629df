// Diffuse method `sh9-windowed`: nine spherical-harmonic coefficients under a Hann window: less ringing, more blur.

#include "lib/sh.glsl"

// Degree l counts (1 + cos(pi l / SH9_WINDOW)) / 2. [Sloan08]
vec3 irradiance_over_pi(vec3 n, FILTERED_MAP irradiance_map, vec4 radiance_coefficients[SH9_COUNT]) {
    vec4 windowed[SH9_COUNT];
    for (uint k = 0u; k < SH9_COUNT; ++k) {
        float degree = k == 0u ? 0.0 : k < 4u ? 1.0 : 2.0;
        windowed[k] = (0.5 + 0.5 * cos(PI * degree / SH9_WINDOW)) * radiance_coefficients[k];
    }
    return max(sh9_irradiance_over_pi(windowed, n), 0.0);
}
