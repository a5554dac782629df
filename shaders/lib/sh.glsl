// Real spherical harmonics up to degree 2 in world axes: L00, L1-1, L10, L11, L2-2, L2-1, L20, L21,
// L22. [Kim22]

#include "generated/constants.glsl"

// The nine basis functions at a unit direction. [Ramamoorthi01 eq. 3]
float[SH9_COUNT] sh9_basis(vec3 d) {
    return float[SH9_COUNT](0.282094792, 0.488602512 * d.y, 0.488602512 * d.z, 0.488602512 * d.x,
                            1.09254843 * d.x * d.y, 1.09254843 * d.y * d.z, 0.315391565 * (3.0 * d.z * d.z - 1.0),
                            1.09254843 * d.x * d.z, 0.546274215 * (d.x * d.x - d.y * d.y));
}

// A_l / pi of coefficient k, from radiance to irradiance over pi: 1, 2/3, 1/4. [Ramamoorthi01 eq.
// 8]
float sh9_cosine_over_pi(uint k) {
    return k == 0u ? 1.0 : k < 4u ? 2.0 / 3.0 : 0.25;
}

// Irradiance over pi at normal n from nine radiance coefficients, not clamped. [Ramamoorthi01 eq.
// 7, over pi]
vec3 sh9_irradiance_over_pi(vec4 radiance_coefficients[SH9_COUNT], vec3 n) {
    float[SH9_COUNT] y = sh9_basis(n);
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < SH9_COUNT; ++k) {
        sum += sh9_cosine_over_pi(k) * y[k] * radiance_coefficients[k].rgb;
    }
    return sum;
}
