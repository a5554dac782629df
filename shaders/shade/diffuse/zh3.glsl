// Diffuse method `zh3`: four spherical-harmonic coefficients, and a quadratic part guessed about the axis of luminance.

#include "lib/sh.glsl"

const vec3 LUMINANCE = vec3(LUMINANCE_RED, LUMINANCE_GREEN, LUMINANCE_BLUE);

// With r the ratio of linear part along the axis to constant, the zonal one is L00 (0.08 r + 0.6 r^2). [Roughton24]
vec3 irradiance_over_pi(vec3 n, FILTERED_MAP irradiance_map, vec4 radiance_coefficients[SH9_COUNT]) {
    vec3 constant = radiance_coefficients[0].rgb;
    mat3 linear = mat3(radiance_coefficients[3].rgb, radiance_coefficients[1].rgb, radiance_coefficients[2].rgb);
    vec3 axis = LUMINANCE * linear;
    float axis_length = length(axis);
    // Without a direction there is no quadratic part.
    axis = axis_length > 0.0 ? axis / axis_length : vec3(0.0);
    vec3 along = abs(linear * axis);
    vec3 zonal = along * (0.08 + 0.6 * along / max(constant, 1e-30));
    float cosine = dot(axis, n);
    vec3 sum = 0.282094792 * constant + (2.0 / 3.0) * 0.488602512 * (linear * n);
    return max(sum + 0.25 * 0.315391565 * (3.0 * cosine * cosine - 1.0) * zonal, 0.0);
}
