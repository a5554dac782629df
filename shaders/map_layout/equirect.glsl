// Map layout `equirect`: one image, filtered by the hardware (lib/equirect.glsl). Its texels shrink
// to slivers at the poles, which no isotropic filter covers: a light at a pole loses a fifth of its
// energy.

#include "lib/equirect.glsl"

#define FILTERED_MAP sampler2D

// The position of a direction in a map.
struct MapPlace {
    vec2 uv;
    float sin_theta;
};

MapPlace map_place(vec3 d) {
    vec3 uv_sin_theta = uv_sin_theta_from_direction(d);
    return MapPlace(uv_sin_theta.xy, uv_sin_theta.z);
}

// Solid angle (sr) of a texel there.
float texel_solid_angle(MapPlace place, vec2 size, float omega_s) {
    return texel_solid_angle(place.sin_theta, size);
}

// Radiance there at a real level, clamped to the chain.
vec3 map_radiance(FILTERED_MAP map, MapPlace place, float lod) {
    return textureLod(map, place.uv, lod).rgb;
}

// Direction of a place inside a texel: (0.5, 0.5) is its centre.
vec3 direction_from_texel(uvec3 texel, vec2 inside, vec2 size) {
    return direction_from_uv((vec2(texel.xy) + inside) / size);
}
