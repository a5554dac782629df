// Visible normals of GGX within the cap that reflects above the horizon (sampled-vndf).
// [EtoTokuyoshi23]

// The cap of the stretched sphere that holds every direction which leaves above the horizon.
// [EtoTokuyoshi23]
struct BoundedCap {
    vec3 v_standard;
    float height;
    // v_standard.z minus z at the cap's end.
    float above;
    // Density of l over D.
    float pdf_over_d;
};

// It ends at z = -k v_standard.z; the density is D / (2 (k n_dot_v + length of stretched v)).
// [EtoTokuyoshi23 eq. 5, 8]
BoundedCap bounded_cap(vec3 v_local, vec2 width) {
    vec3 stretched = vec3(width * v_local.xy, v_local.z);
    float length_v = length(stretched);
    vec3 v_standard = stretched / length_v;
    float s = 1.0 + length(v_local.xy);
    float narrow = min(width.x, width.y);
    float alpha2 = narrow * narrow;
    float z2 = v_local.z * v_local.z;
    float inv = 1.0 / (s * s + alpha2 * z2);
    float k = (1.0 - alpha2) * s * s * inv;
    // 1 - k without its cancellation.
    float above = alpha2 * (s * s + z2) * inv * v_standard.z;
    return BoundedCap(v_standard, 1.0 + k * v_standard.z, above, 0.5 / (k * v_local.z + length_v));
}

// Half vector of sample_visible_ggx from that cap. [EtoTokuyoshi23 listing 1]
vec3 sample_bounded_ggx(BoundedCap cap, vec4 point, vec2 width) {
    float depth = point.x * cap.height;
    vec2 across = sqrt(max(depth * (2.0 - depth), 0.0)) * point.yz + cap.v_standard.xy;
    return normalize(vec3(width * across, (1.0 - point.x) * cap.height + cap.above));
}

// The normals that GGX of those widths shows to v, within the cap; a model weighs their samples.
struct BoundedNormals {
    BoundedCap cap;
    vec2 width;
    float d_over_pdf;
};

BoundedNormals bounded_normals_ggx(vec3 v_local, vec2 width) {
    BoundedCap cap = bounded_cap(v_local, width);
    return BoundedNormals(cap, width, 0.25 / (v_local.z * cap.pdf_over_d));
}
