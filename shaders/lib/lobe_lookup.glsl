// A lobe's one lookup of a prefiltered map; docs/paste.md prints this file.

// The direction, and in w its perceptual roughness. lobes: the table, square parts below each other with nodes at both ends of both axes,
// the moments first; widths: the part with the widths; share: B / (f0 A + B), the share of the lobe that every f0 reflects.
vec4 lobe_lookup(sampler2D lobes, float widths, vec3 n, vec3 v, float n_dot_v, float roughness, float share) {
    vec2 size = vec2(textureSize(lobes, 0));
    vec2 at = vec2(sqrt(clamp(n_dot_v, 0.0, 1.0)), roughness) * (size.x - 1.0) + 0.5;
    vec4 moments = textureLod(lobes, at / size, 0.0);
    vec3 ratios = textureLod(lobes, (at + vec2(0.0, widths * size.x)) / size, 0.0).xyz;
    vec2 moment = mix(moments.xy, moments.zw, share);
    // Widths are there for shares 0, 1/2 and 1; a parabola between.
    float ratio = dot(ratios, vec3((1.0 - share) * (1.0 - 2.0 * share), 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)));
    return vec4(normalize(moment.x * reflect(-v, n) + moment.y * n), min(ratio * roughness, 1.0));
}
