// The equirectangular mapping of the project: y up, the image's centre is +z, u = 0.25 is +x, row 0
// is +y. u = 0.5 - atan2(x, z) / 2 pi, v = acos(y) / pi; u wraps, v clamps. [Kim22
// "Equirectangular", inverse corrected]

#include "lib/elementary.glsl"

// Texture coordinates of a unit direction, and sin(theta) in z. u in [0, 1], v in [0, 1], each
// within 1.5e-7.
vec3 uv_sin_theta_from_direction(vec3 d) {
    float sin_theta = sqrt(d.x * d.x + d.z * d.z);
    float phi = atan2_precise(d.x, d.z);
    // The smaller of sine and cosine keeps full precision at the poles and at the equator, and
    // needs no division.
    float small = asin_half_octant(min(sin_theta, abs(d.y)));
    float from_pole = sin_theta <= abs(d.y) ? small : 0.5 * PI - small;
    float theta = d.y < 0.0 ? PI - from_pole : from_pole;
    return vec3(0.5 - phi * (0.5 / PI), theta * (1.0 / PI), sin_theta);
}

// Texture coordinates of a unit direction.
vec2 uv_from_direction(vec3 d) {
    return uv_sin_theta_from_direction(d).xy;
}

// Unit direction of texture coordinates, the inverse of uv_from_direction.
vec3 direction_from_uv(vec2 uv) {
    vec2 sin_cos_phi = sin_cos_turns(0.5 - uv.x);
    vec2 sin_cos_theta = sin_cos_turns(0.5 * uv.y);
    return vec3(sin_cos_phi.x * sin_cos_theta.x, sin_cos_theta.y, sin_cos_phi.y * sin_cos_theta.x);
}

// Texture coordinates of a texel's centre.
vec2 uv_from_texel(uvec2 texel, uvec2 size) {
    return (vec2(texel) + 0.5) / vec2(size);
}

// Solid angle (sr) that a texel of a map of that size has at a direction with that sin(theta). The
// sine is floored at its value half a texel from the pole: no texel is smaller than in the first
// row.
float texel_solid_angle(float sin_theta, vec2 size) {
    return 2.0 * PI * PI * max(sin_theta, 0.5 * PI / size.y) / (size.x * size.y);
}
