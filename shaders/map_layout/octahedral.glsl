// Map layout `octahedral`: one square, every texel of the same solid angle. Its centre is +y, its
// corners are -y. [ClarbergSquare08] No hardware filter knows which texels touch across its edges:
// a lookup fetches eight texels.

#include "lib/elementary.glsl"

#define FILTERED_MAP sampler2D

// The position of a direction in a map.
struct MapPlace {
    vec2 uv;
};

MapPlace map_place(vec3 d) {
    vec2 a = abs(d.xz);
    // sqrt(1 - |y|), with all its digits at the poles.
    float r = sqrt(dot(a, a) / (1.0 + abs(d.y)));
    float turn = atan_octant(min(a.x, a.y) / max(max(a.x, a.y), 1e-30)) * (2.0 / PI);
    float v = r * (a.x >= a.y ? turn : 1.0 - turn);
    vec2 uv = vec2(r - v, v);
    uv = d.y < 0.0 ? 1.0 - uv.yx : uv;
    return MapPlace(0.5 + 0.5 * vec2(d.x < 0.0 ? -uv.x : uv.x, d.z < 0.0 ? -uv.y : uv.y));
}

// Solid angle (sr) of a texel: all are alike.
float texel_solid_angle(MapPlace place, vec2 size, float omega_s) {
    return 4.0 * PI / (size.x * size.y);
}

// The texel at a place at most one texel outside: the square's edges are folded in their middle.
ivec2 folded(ivec2 texel, int side) {
    if (texel.x < 0 || texel.x >= side) {
        texel = ivec2(clamp(texel.x, 0, side - 1), side - 1 - texel.y);
    }
    if (texel.y < 0 || texel.y >= side) {
        texel = ivec2(side - 1 - texel.x, clamp(texel.y, 0, side - 1));
    }
    return texel;
}

vec3 level_radiance(FILTERED_MAP map, vec2 uv, int level) {
    // Some drivers return the size of one level if neighbours ask for several.
    int side = textureSize(map, 0).x >> level;
    vec2 at = uv * float(side) - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 part = at - floor(at);
    vec3 top = mix(texelFetch(map, folded(low, side), level).rgb,
                   texelFetch(map, folded(low + ivec2(1, 0), side), level).rgb, part.x);
    vec3 bottom = mix(texelFetch(map, folded(low + ivec2(0, 1), side), level).rgb,
                      texelFetch(map, folded(low + ivec2(1, 1), side), level).rgb, part.x);
    return mix(top, bottom, part.y);
}

// Radiance there at a real level, clamped to the chain.
vec3 map_radiance(FILTERED_MAP map, MapPlace place, float lod) {
    int last = textureQueryLevels(map) - 1;
    float level = clamp(lod, 0.0, float(last));
    int fine = int(level);
    vec3 radiance = level_radiance(map, place.uv, fine);
    if (level > float(fine)) {
        radiance = mix(radiance, level_radiance(map, place.uv, min(fine + 1, last)), level - float(fine));
    }
    return radiance;
}

// Direction of a place inside a texel: (0.5, 0.5) is its centre.
vec3 direction_from_texel(uvec3 texel, vec2 inside, vec2 size) {
    vec2 signed_uv = 2.0 * (vec2(texel.xy) + inside) / size - 1.0;
    vec2 a = abs(signed_uv);
    float from_fold = 1.0 - (a.x + a.y);
    float r = 1.0 - abs(from_fold);
    // Below the fold the square is mirrored in it.
    vec2 b = from_fold < 0.0 ? 1.0 - a.yx : a;
    vec2 sin_cos = sin_cos_turns(r > 0.0 ? 0.25 * b.y / r : 0.0);
    float horizontal = r * sqrt(2.0 - r * r);
    float y = 1.0 - r * r;
    return vec3(signed_uv.x < 0.0 ? -horizontal * sin_cos.y : horizontal * sin_cos.y, from_fold < 0.0 ? -y : y,
                signed_uv.y < 0.0 ? -horizontal * sin_cos.x : horizontal * sin_cos.x);
}
