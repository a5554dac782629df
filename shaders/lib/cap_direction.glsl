// A direction of a lobe without a table; docs/paste.md prints this file.

// The mirror direction about the mean visible normal; for alpha above 0.4 it goes over to
// Frostbite's direction. share: B / (f0 A + B), the share of the lobe that every f0 reflects, which
// lies closer to r.
vec3 cap_direction(vec3 n, vec3 v, float n_dot_v, float alpha, float share) {
    vec3 r = reflect(-v, n);
    vec3 tangential = v - n_dot_v * n;
    float stretched = sqrt(alpha * alpha * dot(tangential, tangential) + n_dot_v * n_dot_v);
    vec3 normal = normalize(alpha * alpha / stretched * tangential + (0.5 + 0.5 * n_dot_v / stretched) * n);
    float smoothness = 1.0 - alpha;
    vec3 wide = normalize(mix(n, r, smoothness * (sqrt(smoothness) + alpha)));
    vec3 direction = normalize(mix(reflect(-v, normal), wide, clamp((alpha - 0.4) / 0.4, 0.0, 1.0)));
    return normalize(mix(direction, r, share * min(alpha / 0.4, 1.0)));
}
