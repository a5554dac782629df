// The tone curve and its 8-bit form.

// c = (e L / (e L + 1))^(contrast / 2.2) for L >= 0, in [0, 1]. [Kim22 "Tone mapping and color
// space conversion"]
vec3 tone_curve(vec3 radiance, float exposure, float contrast) {
    vec3 x = exposure * max(radiance, 0.0);
    vec3 compressed = x / (x + 1.0);
    // pow(0, y) is 0 here; the built-in leaves it open.
    return mix(pow(compressed, vec3(contrast / 2.2)), vec3(0.0), equal(compressed, vec3(0.0)));
}

// Display values in [0, 1] to bytes R, G, B, 255 from the lowest byte up, rounded to nearest.
uint pack_rgba8(vec3 c) {
    uvec3 b = uvec3(255.0 * c + 0.5);
    return b.r | b.g << 8 | b.b << 16 | 255u << 24;
}
