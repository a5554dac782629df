// The taps of a lobe; docs/paste.md prints this file.

// The share of the taps for F0 0.04; the rest are the taps for F0 1. f0: the mean of the colour.
// dfg: (A, B).
float dielectric_share(float f0, vec2 dfg) {
    return clamp((1.0 - f0) * (0.04 * dfg.x + dfg.y) / (0.96 * (f0 * dfg.x + dfg.y)), 0.0, 1.0);
}

// A part of the table: the places of two taps between n (0) and r (1) in x and z, and their levels
// in y and w. The last part has the weights of two or four taps. taps: square parts below each
// other, with nodes at both ends of both axes, first for F0 1, then for 0.04.
vec4 tap_part(sampler2D taps, float part, float n_dot_v, float roughness, float dielectric) {
    vec2 size = vec2(textureSize(taps, 0));
    vec2 at = vec2(sqrt(clamp(n_dot_v, 0.0, 1.0)), roughness) * (size.x - 1.0) + vec2(0.5, 0.5 + part * size.x);
    vec4 metal = textureLod(taps, at / size, 0.0);
    return mix(metal, textureLod(taps, (at + vec2(0.0, 0.5 * size.y)) / size, 0.0), dielectric);
}
