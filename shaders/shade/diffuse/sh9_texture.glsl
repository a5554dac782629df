// Diffuse method `sh9-texture`: one bilinear lookup in a texture of what `sh9` evaluates.

#include "lib/equirect.glsl"

vec3 irradiance_over_pi(vec3 n, FILTERED_MAP irradiance_map, vec4 radiance_coefficients[SH9_COUNT], sampler2D sh9_texture) {
    return textureLod(sh9_texture, uv_from_direction(n), 0.0).rgb;
}
