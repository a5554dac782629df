// Map layout `cube`: six faces in the order of Vulkan, filtered by the hardware across their edges.

#include "generated/constants.glsl"

#define FILTERED_MAP samplerCube

// The position of a direction in a map.
struct MapPlace {
    vec3 d;
};

MapPlace map_place(vec3 d) {
    return MapPlace(d);
}

// Solid angle (sr) of a texel there: du dv / (1 + u^2 + v^2)^(3/2) on a face at distance 1, whose
// sides are 2. For unit d the denominator is 1 / max(|x|, |y|, |z|)^3, whose mean over a sample of
// omega_s (sr) counts: at edges and corners it is larger.
float texel_solid_angle(MapPlace place, vec2 size, float omega_s) {
    vec3 a = abs(place.d);
    float softness = EDGE_SOFTNESS * omega_s;
    float major = 0.5 * (a.x + a.y + sqrt((a.x - a.y) * (a.x - a.y) + softness));
    major = min(0.5 * (major + a.z + sqrt((major - a.z) * (major - a.z) + softness)), 1.0);
    return 4.0 / (size.x * size.y) * major * major * major;
}

// Radiance there at a real level, clamped to the chain.
vec3 map_radiance(FILTERED_MAP map, MapPlace place, float lod) {
    return textureLod(map, place.d, lod).rgb;
}

// Direction of a place inside a texel, whose z is the face: (0.5, 0.5) is its centre.
vec3 direction_from_texel(uvec3 texel, vec2 inside, vec2 size) {
    vec2 st = 2.0 * (vec2(texel.xy) + inside) / size - 1.0;
    float sign = (texel.z & 1u) == 0u ? 1.0 : -1.0;
    vec3 p = texel.z < 2u ? vec3(sign, -st.y, -sign * st.x)
           : texel.z < 4u ? vec3(st.x, sign, sign * st.y)
                          : vec3(sign * st.x, -st.y, sign);
    return normalize(p);
}
