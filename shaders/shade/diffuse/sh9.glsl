// Diffuse method `sh9`: nine spherical-harmonic coefficients evaluated per pixel.
// Degree 2 can fall below 0 opposite to a strong light (to -4 % of its peak): floored at 0.

#include "lib/sh.glsl"

// [Ramamoorthi01 eq. 7, over pi]
vec3 irradiance_over_pi(vec3 n, FILTERED_MAP irradiance_map, vec4 radiance_coefficients[SH9_COUNT], sampler2D sh9_texture) {
    return max(sh9_irradiance_over_pi(radiance_coefficients, n), 0.0);
}
