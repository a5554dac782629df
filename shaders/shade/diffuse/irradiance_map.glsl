// Diffuse method `irradiance-map`: one bilinear lookup in a small map of irradiance over pi.

#include "generated/constants.glsl"

vec3 irradiance_over_pi(vec3 n, FILTERED_MAP irradiance_map, vec4 radiance_coefficients[SH9_COUNT], sampler2D sh9_texture) {
    return map_radiance(irradiance_map, map_place(n), 0.0);
}
