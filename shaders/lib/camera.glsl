// Rays through pixel centres.

// Unit direction of the ray through a pixel's centre; row 0 is the top. `right` and `up` reach from
// the image's centre to its edges at distance 1 along `forward`; both 0 makes every ray parallel to
// `forward` (orthographic).
vec3 ray_direction(uvec2 pixel, uvec2 size, vec3 right, vec3 up, vec3 forward) {
    vec2 ndc = (2.0 * vec2(pixel) + 1.0) / vec2(size) - 1.0;
    return normalize(forward + ndc.x * right - ndc.y * up);
}
