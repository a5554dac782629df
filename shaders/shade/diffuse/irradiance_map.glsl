// Diffuse method `irradiance-map`: one bilinear lookup in a small map of irradiance over pi.
#ifndef DIFFUSE_IRRADIANCE_MAP_GLSL
#define DIFFUSE_IRRADIANCE_MAP_GLSL

#include "generated/constants.glsl"
#include "lib/equirect.glsl"

vec3 irradiance_over_pi(vec3 n, sampler2D irradiance_map, vec4 radiance_coefficients[SH9_COUNT]) {
    return textureLod(irradiance_map, uv_from_direction(n), 0.0).rgb;
}

#endif
